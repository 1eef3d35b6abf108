//! The experiments of chapter 5, each as a table beside the thesis's figures, curves and pictures.

use crate::measure::{ExperimentError, Machine, Scale, render_timed};
use crate::plot::Plot;
use crate::reference::{BUSH, CORNELL, CYLINDER_TWILIGHT, SOFT_SHADOW};
use crate::scenes::{ThesisScene, scene};
use crate::table::{Table, seconds};
use render::{Acceleration, Film, RenderSettings, Renderer};

/// One experiment.
#[derive(Clone, Copy, Debug)]
pub struct Experiment {
    /// Name for files.
    pub name: &'static str,
    /// What it is about, with the figure or table of the thesis.
    pub title: &'static str,
    run: fn(&Machine, Scale) -> Result<Outcome, ExperimentError>,
}

/// What an experiment found.
#[derive(Default)]
pub struct Outcome {
    /// Measured figures beside those of the thesis.
    pub table: Table,
    /// Curves by name for files.
    pub plots: Vec<(String, Plot)>,
    /// Pictures by name for files.
    pub pictures: Vec<(String, Film)>,
}

impl Experiment {
    /// Runs it on every device of the machine.
    ///
    /// # Errors
    /// If a device fails.
    pub fn run(&self, machine: &Machine, scale: Scale) -> Result<Outcome, ExperimentError> {
        (self.run)(machine, scale)
    }
}

/// All experiments in the order of the thesis.
pub fn all() -> [Experiment; 6] {
    [
        Experiment {
            name: "antialiasing",
            title: "anti-aliasing of a cylinder, figure 5.1",
            run: antialiasing,
        },
        Experiment {
            name: "shadows",
            title: "hard shadow and shadow of a leaf, figures 5.2 and 5.5",
            run: shadows,
        },
        Experiment {
            name: "soft-shadow",
            title: "soft shadow of a lamp, figures 5.3 and 5.4",
            run: soft_shadow,
        },
        Experiment { name: "cornell-box", title: "Cornell box, figure 5.6", run: cornell_box },
        Experiment {
            name: "bush-objects",
            title: "bush by number of objects, table 5.2",
            run: bush_by_objects,
        },
        Experiment {
            name: "bush-rays",
            title: "bush with 25 objects by rays per pixel, figure 5.11",
            run: bush_by_rays,
        },
    ]
}

const ACCELERATIONS: [(Acceleration, &str); 2] = [(Acceleration::Bvh, "bvh"), (Acceleration::None, "none")];

fn settings(scale: Scale, width: u32, height: u32, samples: u32, depth: u32) -> RenderSettings {
    RenderSettings {
        width: scale.of(width),
        height: scale.of(height),
        samples,
        depth,
        ..RenderSettings::default()
    }
}

fn antialiasing(machine: &Machine, scale: Scale) -> Result<Outcome, ExperimentError> {
    let scene = scene(ThesisScene::Cylinder);
    let mut outcome =
        Outcome { table: Table::new(["rays per pixel", "device", "seconds", "2008"]), ..Outcome::default() };
    let mut curves = Vec::new();
    for (name, device) in &machine.devices {
        let mut curve = Vec::new();
        for samples in [1, 4, 9, 16, 36, 64] {
            let settings = settings(scale, 640, 480, samples, 1);
            let timed = render_timed(device.as_ref(), &scene, &settings, Acceleration::Bvh)?;
            let reference =
                if samples == 16 { format!("{CYLINDER_TWILIGHT} (Twilight)") } else { "-".to_owned() };
            outcome.table.push([samples.to_string(), name.clone(), seconds(timed.seconds), reference]);
            curve.push((f64::from(samples), timed.seconds));
            if [1, 9, 64].contains(&samples) {
                outcome.pictures.push((format!("cylinder-{samples}-{name}"), timed.film));
            }
        }
        curves.push((name.clone(), curve));
    }
    outcome.plots.push(("antialiasing".into(), over_rays("anti-aliasing of a cylinder", curves)));
    Ok(outcome)
}

fn over_rays(title: &str, curves: Vec<(String, Vec<(f64, f64)>)>) -> Plot {
    Plot { title: title.into(), x: "rays per pixel".into(), y: "seconds".into(), curves }
}

fn shadows(machine: &Machine, scale: Scale) -> Result<Outcome, ExperimentError> {
    let mut outcome = Outcome { table: Table::new(["scene", "device", "seconds"]), ..Outcome::default() };
    for (which, name) in
        [(ThesisScene::PointShadow, "point-shadow"), (ThesisScene::LeafShadow, "leaf-shadow")]
    {
        for (device_name, device) in &machine.devices {
            let settings = settings(scale, 715, 458, 16, 1);
            let timed = render_timed(device.as_ref(), &scene(which), &settings, Acceleration::Bvh)?;
            outcome.table.push([name.to_owned(), device_name.clone(), seconds(timed.seconds)]);
            outcome.pictures.push((format!("{name}-{device_name}"), timed.film));
        }
    }
    Ok(outcome)
}

/// The ray tracer as in the thesis, one ray per pixel with all its shadow rays, and the path tracer, which sends one
/// shadow ray per path, with as many paths.
fn soft_shadow(machine: &Machine, scale: Scale) -> Result<Outcome, ExperimentError> {
    let reference = SOFT_SHADOW;
    let columns = ["device", "renderer", "seconds", "2008 GPU", "Twilight", "Twilight path tracer"];
    let mut outcome = Outcome { table: Table::new(columns), ..Outcome::default() };
    let scene = scene(ThesisScene::AreaShadow);
    for (name, device) in &machine.devices {
        for (renderer, samples) in [(Renderer::RayTracer, 1), (Renderer::PathTracer, reference.shadow_rays)] {
            let settings = RenderSettings {
                renderer,
                shadow_samples: reference.shadow_rays,
                grid: 1,
                ..settings(scale, reference.width, reference.height, samples, 1)
            };
            let timed = render_timed(device.as_ref(), &scene, &settings, Acceleration::Bvh)?;
            let figures = [reference.sunshine_2008, reference.twilight, reference.path_tracer];
            let names = [name.clone(), renderer.name().to_owned(), seconds(timed.seconds)];
            outcome.table.push(names.into_iter().chain(figures.map(|figure| figure.to_string())));
            outcome.pictures.push((format!("area-shadow-{}-{name}", renderer.name()), timed.film));
        }
    }
    Ok(outcome)
}

fn cornell_box(machine: &Machine, scale: Scale) -> Result<Outcome, ExperimentError> {
    let reference = CORNELL;
    let mut outcome = Outcome { table: Table::new(["device", "seconds", "2008 GPU"]), ..Outcome::default() };
    for (name, device) in &machine.devices {
        let settings = settings(scale, reference.width, reference.height, reference.samples, reference.depth);
        let scene = scene(ThesisScene::CornellBox);
        let timed = render_timed(device.as_ref(), &scene, &settings, Acceleration::Bvh)?;
        outcome.table.push([name.clone(), seconds(timed.seconds), reference.sunshine_2008.to_string()]);
        outcome.pictures.push((format!("cornell-box-{name}"), timed.film));
    }
    Ok(outcome)
}

/// Table 5.2 does not say how large its pictures were; they are 1280 x 1024 here, as in its example of tiles.
fn bush_by_objects(machine: &Machine, scale: Scale) -> Result<Outcome, ExperimentError> {
    let columns = ["objects", "device", "accel", "seconds", "Twilight, flat", "2008 GPU", "Twilight, octree"];
    let mut outcome = Outcome { table: Table::new(columns), ..Outcome::default() };
    let mut curves = Vec::new();
    for (name, device) in &machine.devices {
        for (acceleration, acceleration_name) in ACCELERATIONS {
            let mut curve = Vec::new();
            for row in &BUSH {
                let settings = RenderSettings { grid: 1, ..settings(scale, 1280, 1024, 1, 1) };
                let scene = scene(ThesisScene::Bush(row.steps));
                let timed = render_timed(device.as_ref(), &scene, &settings, acceleration)?;
                let names = [row.objects.to_string(), name.clone(), acceleration_name.to_owned()];
                let measured = std::iter::once(seconds(timed.seconds));
                let figures = [row.twilight_flat, row.sunshine_2008, row.twilight];
                let figures = figures.map(|figure| figure.to_string());
                outcome.table.push(names.into_iter().chain(measured).chain(figures));
                // Lossless: a few hundred.
                curve.push((row.objects as f64, timed.seconds));
            }
            curves.push((format!("{name}, {acceleration_name}"), curve));
        }
    }
    let reference = |name: &str, of: fn(&crate::reference::BushRow) -> f64| {
        (format!("2008: {name}"), BUSH.iter().map(|row| (row.objects as f64, of(row))).collect())
    };
    curves.push(reference("Twilight, flat", |row| row.twilight_flat));
    curves.push(reference("GPU", |row| row.sunshine_2008));
    curves.push(reference("Twilight, octree", |row| row.twilight));
    let plot =
        Plot { title: "bush without anti-aliasing".into(), x: "objects".into(), y: "seconds".into(), curves };
    outcome.plots.push(("bush-objects".into(), plot));
    Ok(outcome)
}

fn bush_by_rays(machine: &Machine, scale: Scale) -> Result<Outcome, ExperimentError> {
    let scene = scene(ThesisScene::Bush(2));
    let mut outcome =
        Outcome { table: Table::new(["rays per pixel", "device", "seconds"]), ..Outcome::default() };
    let mut curves = Vec::new();
    for (name, device) in &machine.devices {
        let mut curve = Vec::new();
        for samples in [1, 2, 4, 8, 16, 32, 64] {
            let settings = settings(scale, 1280, 1024, samples, 1);
            let timed = render_timed(device.as_ref(), &scene, &settings, Acceleration::Bvh)?;
            outcome.table.push([samples.to_string(), name.clone(), seconds(timed.seconds)]);
            curve.push((f64::from(samples), timed.seconds));
            if samples == 64 {
                outcome.pictures.push((format!("bush-25-{name}"), timed.film));
            }
        }
        curves.push((name.clone(), curve));
    }
    outcome.plots.push(("bush-rays".into(), over_rays("bush with 25 objects", curves)));
    Ok(outcome)
}
