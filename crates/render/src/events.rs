//! What happens on the paths of a single pixel, in words, for whoever wonders about a picture.

use crate::cpu::Slices;
use crate::{CompiledScene, RenderSettings};
use kernels::bsdf::kernel::{EVENT_ABSORBED, EVENT_MIRRORED, EVENT_PASSED, EVENT_SCATTERED};
use kernels::camera::kernel::sample_camera;
use kernels::hit::kernel::hit_surface;
use kernels::mesh::kernel::facing_normal;
use kernels::path::kernel::{EVENT_ESCAPED, EVENT_STOPPED, PathState, extend_path, start_path};
use kernels::random::kernel::sample_key;
use kernels::records::kernel::NONE;
use kernels::shape::kernel::Ray;
use kernels::traversal::kernel::{Hit, closest_hit};
use std::fmt::{self, Write};
use wgsl_rs::std::Vec3f;

/// Follows the first `samples` paths of the pixel in column `x` and row `y`, counted from the top left, on the
/// processor, and tells of every ray: what it meets, which light it finds, and how the path goes on. They are the
/// paths of a picture with the same settings.
///
/// Lengths are in metres, positions and directions those of the world, radiance in W/(m² sr) for red, green and blue.
pub fn pixel_events(
    scene: &CompiledScene,
    settings: &RenderSettings,
    (x, y): (u32, u32),
    samples: u32,
) -> String {
    let mut text = String::new();
    for sample in 0..samples {
        // Text in memory takes whatever is written.
        let _ = path_events(&mut text, scene, settings, (x, y), sample);
    }
    text
}

fn path_events(
    text: &mut String,
    scene: &CompiledScene,
    settings: &RenderSettings,
    (x, y): (u32, u32),
    sample: u32,
) -> fmt::Result {
    let slices = Slices::of(scene);
    let launch = settings.launch();
    let key = sample_key(launch, x, y, sample);
    let first = sample_camera(scene.header, launch, key, x, y);
    writeln!(text, "pixel {x},{y} sample {sample}")?;
    let mut path = start_path(first);
    while path.goes_on {
        let hit = closest_hit(slices, path.ray, key, path.segment);
        let next = extend_path(slices, key, settings.depth, launch.background, path);
        ray_events(text, scene, &path, &hit, &next)?;
        path = next;
    }
    writeln!(text, "  radiance {}, {} rays", Numbers(path.radiance), path.rays)
}

fn ray_events(
    text: &mut String,
    scene: &CompiledScene,
    before: &PathState,
    hit: &Hit,
    after: &PathState,
) -> fmt::Result {
    let Ray { origin, direction } = before.ray;
    let place = |local: Vec3f| World(local, scene);
    writeln!(text, "  ray {} from {} towards {}", before.segment, place(origin), Numbers(direction))?;
    if hit.object != NONE {
        let slices = Slices::of(scene);
        let point = hit_surface(slices, before.ray, *hit);
        let object = &scene.objects[hit.object as usize];
        let towards =
            direction.to_array().iter().zip(point.normal.to_array()).map(|(d, n)| d * n).sum::<f32>();
        let side = if towards <= 0.0 { "front" } else { "back" };
        let source = if object.surface.source == NONE { hit.instance } else { NONE };
        let of_mesh = scene.objects.get(source as usize).map(|instance| instance.surface.source);
        writeln!(
            text,
            "    meets the {side} of {} in {:.6} at {}",
            Node(of_mesh.unwrap_or(object.surface.source), scene),
            hit.shape.t,
            place(point.position)
        )?;
        if let Some(instance) = scene.objects.get(hit.instance as usize) {
            writeln!(text, "    part of the instance {}", Node(instance.surface.source, scene))?;
        }
        let normal = facing_normal(point, -direction);
        writeln!(
            text,
            "    normal {}, texture coordinates {:.4},{:.4}, material {}",
            Numbers(normal),
            point.uv.x,
            point.uv.y,
            object.shape.material
        )?;
    }
    let found = after.radiance - before.radiance - after.direct;
    if found.to_array() != [0.0; 3] {
        writeln!(text, "    finds light {}", Numbers(found))?;
    }
    if after.direct.to_array() != [0.0; 3] {
        writeln!(text, "    is lit with {} by a light that was chosen", Numbers(after.direct))?;
    } else if after.rays > before.rays + 1 {
        writeln!(text, "    stands in the shadow of the light that was chosen")?;
    }
    let event = match after.event {
        EVENT_ABSORBED => "absorbed",
        EVENT_SCATTERED => "scattered",
        EVENT_MIRRORED => "reflected or refracted by an ideal surface",
        EVENT_PASSED => "passed undisturbed",
        EVENT_ESCAPED => "left the scene",
        EVENT_STOPPED => "stopped by Russian roulette",
        _ => "under way",
    };
    match after.goes_on {
        true => writeln!(text, "    {event}, throughput {}", Numbers(after.throughput)),
        false => writeln!(text, "    {event}: the end"),
    }
}

/// Three numbers.
struct Numbers(Vec3f);

impl fmt::Display for Numbers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.0.to_array();
        write!(f, "({x:.6} {y:.6} {z:.6})")
    }
}

/// A position of the compiled scene.
struct World<'a>(Vec3f, &'a CompiledScene);

impl fmt::Display for World<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let origin = self.1.origin.to_array();
        let [x, y, z] = self.0.to_array().map(f64::from);
        write!(f, "({:.6} {:.6} {:.6})", x + origin[0], y + origin[1], z + origin[2])
    }
}

/// What something comes from.
struct Node<'a>(u32, &'a CompiledScene);

impl fmt::Display for Node<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(origin) = self.1.origins.get(self.0 as usize) else {
            return f.write_str("something unknown");
        };
        let name = self.1.type_names.get(origin.type_name.index()).map_or("", String::as_str);
        write!(f, "{name} (node {})", origin.node)
    }
}
