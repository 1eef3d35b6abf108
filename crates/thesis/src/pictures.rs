//! The pictures of chapter 5, small and smooth, to look at; nothing is measured.

use crate::measure::{ExperimentError, Scale};
use crate::reference::{BUSH, SOFT_SHADOW};
use crate::scenes::{ThesisScene, scene};
use render::{ControlFlow, Device, Film, RenderSettings, Renderer, Sampler, compile};
use std::sync::Arc;

/// A picture of the thesis.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Name for files.
    pub name: String,
    /// Number of the figure or table of the thesis.
    pub figure: &'static str,
    /// What it shows.
    pub title: String,
    scene: ThesisScene,
    settings: RenderSettings,
}

impl Picture {
    /// Renders it.
    ///
    /// # Errors
    /// If the device fails.
    pub fn render(&self, device: &dyn Device, scale: Scale) -> Result<Film, ExperimentError> {
        let settings = RenderSettings {
            width: scale.of(self.settings.width),
            height: scale.of(self.settings.height),
            ..self.settings.clone()
        };
        let loaded = device.load(Arc::new(compile(&scene(self.scene))?))?;
        Ok(loaded.render(&settings, &|_| ControlFlow::Continue(()))?)
    }
}

/// Rays per pixel of pictures that shall be smooth.
const MANY: u32 = 512;

/// All pictures in the order of the thesis. Proportions and depths are those of the thesis, rays per pixel those that
/// the figure is about, else many.
pub fn pictures() -> Vec<Picture> {
    let picture = |name: &str, figure, title: &str, scene, width, height, samples, depth| Picture {
        name: name.to_owned(),
        figure,
        title: title.to_owned(),
        scene,
        settings: RenderSettings { width, height, samples, depth, ..RenderSettings::default() },
    };
    let mut all = Vec::new();
    for (name, figure, rays) in
        [("cylinder-a", "5.1a", 1), ("cylinder-b", "5.1b", 9), ("cylinder-c", "5.1c", 64)]
    {
        let title = format!("cylinder with {rays} rays per pixel");
        all.push(picture(name, figure, &title, ThesisScene::Cylinder, 320, 240, rays, 1));
    }
    all.push(picture("point-shadow", "5.2", "hard shadows", ThesisScene::PointShadow, 480, 308, 64, 1));
    let rays = SOFT_SHADOW.shadow_rays;
    let title = format!("soft shadows by the ray tracer, {rays} shadow rays");
    let mut soft = picture("area-shadow", "5.3", &title, ThesisScene::AreaShadow, 480, 308, 4, 1);
    soft.settings.renderer = Renderer::RayTracer;
    soft.settings.shadow_samples = rays;
    all.push(soft);
    let title = format!("soft shadows by the path tracer, {rays} paths");
    all.push(picture("area-shadow-paths", "5.4", &title, ThesisScene::AreaShadow, 480, 308, rays, 1));
    all.push(picture("leaf-shadow", "5.5", "shadow of a leaf", ThesisScene::LeafShadow, 480, 308, 64, 1));
    let cornell = |name, figure, title: &str, width, height, rays| {
        picture(name, figure, title, ThesisScene::CornellBox, width, height, rays, 3)
    };
    all.push(cornell("cornell-box-16", "5.6", "Cornell box with 16 rays per pixel", 359, 229, 16));
    all.push(cornell("cornell-box", "5.6", "Cornell box without noise", 480, 306, MANY));
    let mut hashed =
        cornell("noise-independent", "5.7", "one ray per pixel, independent numbers", 300, 191, 1);
    hashed.settings.sampler = Sampler::Independent;
    all.push(hashed);
    all.push(cornell("noise-sobol", "5.8", "one ray per pixel, Sobol points", 300, 191, 1));
    for row in &BUSH {
        let figure = if row.steps == 2 { "table 5.2, 5.11" } else { "table 5.2" };
        let title = format!("bush with {} objects", row.objects);
        let name = format!("bush-{}", row.objects);
        all.push(picture(&name, figure, &title, ThesisScene::Bush(row.steps), 400, 320, MANY, 1));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_picture_has_a_file_of_its_own() {
        let mut names: Vec<String> = pictures().into_iter().map(|picture| picture.name).collect();
        let all = names.len();
        names.sort();
        names.dedup();
        assert_eq!((names.len(), all), (16, 16));
    }
}
