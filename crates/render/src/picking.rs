//! What is seen at a point of the picture.

use crate::cpu::Slices;
use crate::{CompiledScene, RenderSettings, View};
use kernels::camera::kernel::camera_ray;
use kernels::hit::kernel::hit_surface;
use kernels::mesh::kernel::facing_normal;
use kernels::random::kernel::independent_key;
use kernels::records::kernel::NONE;
use kernels::traversal::kernel::closest_hit;
use scene::{DVec3, Origin};

/// What is seen at a point of the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Picked {
    /// What it comes from; for a part of an instance, what that part comes from.
    pub origin: Origin,
    /// Name of the type of `origin`.
    pub type_name: String,
    /// What the instance comes from that it is part of, with the name of its type.
    pub instance: Option<(Origin, String)>,
    /// Position in [`scene::Scene::materials`]; of bodies with a refractive index that of the copy which knows it,
    /// which may lie behind all of them.
    pub material: u32,
    /// In the world, in metres.
    pub position: DVec3,
    /// Unit normal on the side of the camera, in the world.
    pub normal: DVec3,
    /// From the eye, in metres; in parallel projection from where rays start.
    pub distance: f64,
}

/// Follows one ray on the processor, through the middle of the lens and a point of the picture: `x` and `y` are in
/// pixels from its top left corner. `None` where nothing but the sky is seen.
pub fn pick(
    scene: &CompiledScene,
    view: &View,
    (width, height): (u32, u32),
    (x, y): (f64, f64),
) -> Option<Picked> {
    let launch = RenderSettings { width, height, ..RenderSettings::default() }.launch();
    let ray = camera_ray(view.header, launch, x as f32, y as f32);
    let slices = Slices::through(scene, &view.header);
    let hit = closest_hit(slices, ray, independent_key(0, 0, 0), 0);
    if hit.object == NONE {
        return None;
    }
    let point = hit_surface(slices, ray, hit);
    let object = scene.objects.get(hit.object as usize)?;
    let source = |source: u32| {
        let origin = *scene.origins.get(source as usize)?;
        let name = scene.type_names.get(origin.type_name.index()).cloned().unwrap_or_default();
        Some((origin, name))
    };
    let instance = scene.objects.get(hit.instance as usize).and_then(|object| source(object.surface.source));
    // Triangles of a group have no source of their own: what places them has.
    let (origin, type_name) = source(object.surface.source).or_else(|| instance.clone())?;
    let world = |v: [f32; 3]| DVec3::from(v.map(f64::from));
    Some(Picked {
        origin,
        type_name,
        instance: instance.filter(|(other, _)| *other != origin),
        material: object.shape.material,
        position: world(point.position.to_array()) + scene.origin,
        normal: world(facing_normal(point, -ray.direction).to_array()),
        distance: f64::from(hit.shape.t),
    })
}
