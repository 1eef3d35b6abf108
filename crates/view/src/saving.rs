//! Saves a picture as `sunshine render` does.

use crate::events::{Event, Report, explained};
use render::{
    BAND_BYTES, CompiledScene, ControlFlow, Device, Layers, Origins, PictureTarget, Provenance,
    RenderSettings, Sampling, ToneCurve, render_bands, stream_picture,
};
use scene::Camera;
use std::error::Error;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// A picture to save.
#[derive(Clone, Debug, PartialEq)]
pub struct SaveOrder {
    /// The file; its extension chooses the format.
    pub path: PathBuf,
    /// Its size and how it is computed.
    pub settings: RenderSettings,
    /// Where it is taken from.
    pub camera: Camera,
    /// Brightness of a PNG in stops; chosen from the picture if missing.
    pub exposure: Option<f32>,
    /// What becomes of bright parts of a PNG.
    pub tone_curve: ToneCurve,
    /// The command that makes the same picture.
    pub words: Vec<String>,
}

/// Renders the picture into its file and tells how it goes; `record` is what is known beforehand of what the picture
/// tells of itself.
pub fn save(
    device: &dyn Device,
    scene: Arc<CompiledScene>,
    order: &SaveOrder,
    record: Provenance,
    report: &Report,
) {
    let start = Instant::now();
    let path = order.path.clone();
    let event = match write(device, scene, order, record, report) {
        Ok(()) => Event::Saved { path, seconds: start.elapsed().as_secs_f64() },
        Err(error) => Event::SaveFailed { path, reason: explained(error.as_ref()) },
    };
    report(event);
}

fn write(
    device: &dyn Device,
    scene: Arc<CompiledScene>,
    order: &SaveOrder,
    record: Provenance,
    report: &Report,
) -> Result<(), Box<dyn Error>> {
    let SaveOrder { path, settings, camera, exposure, tone_curve, words: _ } = order;
    render::check_writable(path)?;
    let view = scene.view(camera)?;
    let provenance = Provenance {
        scene_hash: scene.hash_through(&view),
        device: device.kind(),
        samples: settings.samples,
        ..record
    };
    let mut loaded = device.load(scene)?;
    loaded.set_view(&view)?;
    let target = PictureTarget {
        path,
        width: settings.window().width,
        height: settings.window().height,
        exposure: *exposure,
        tone_curve: *tone_curve,
        layers: &Layers::default(),
        origins: &Origins::default(),
        provenance: Some(&provenance),
    };
    let total = settings.total_samples().max(1);
    let told = AtomicU64::new(0);
    let progress = |done: u64| {
        let percent = (u128::from(done) * 100 / u128::from(total)) as u64;
        if percent > told.fetch_max(percent, Ordering::Relaxed) {
            report(Event::Saving { path: path.clone(), share: percent as f32 / 100.0 });
        }
        ControlFlow::Continue(())
    };
    stream_picture(&target, |sink| {
        render_bands(loaded.as_ref(), settings, Sampling::Uniform, false, BAND_BYTES, &progress, sink)
            .map(|_| ())
    })?;
    Ok(())
}
