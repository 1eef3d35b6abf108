//! Prints what a project holds: `cargo run -p sunshine-groimp --example inspect -- project.gsz`.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let Some(path) = std::env::args_os().nth(1) else {
        eprintln!("usage: inspect PROJECT");
        return ExitCode::FAILURE;
    };
    let project = match groimp::read(Path::new(&path)) {
        Ok(project) => project,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
    };
    let scene = &project.scene;
    let mut counts = BTreeMap::<_, usize>::new();
    for object in &scene.objects {
        let type_name = &scene.type_names[object.origin.type_name.index()];
        *counts.entry((object.shape.name(), type_name)).or_default() += 1;
    }
    for ((shape, type_name), count) in counts {
        println!("{count} x {shape} ({type_name})");
    }
    println!(
        "{} materials, {} channels, {} images",
        scene.materials.len(),
        scene.channels.len(),
        scene.images.len()
    );
    for light in &scene.lights {
        println!("{:?} at {}", light.kind, light.world_from_light.translation);
    }
    if let Some((low, high)) = scene.bounds() {
        println!("bounds {low} to {high}");
    }
    println!("{:?}", scene.camera.projection);
    print!("{}", project.report);
    ExitCode::SUCCESS
}
