use super::{CompileError, CompiledScene, affine};
use crate::cpu::Slices;
use kernels::camera::kernel::camera_ray;
use kernels::random::kernel::independent_key;
use kernels::records::kernel::{CAMERA_PARALLEL, CAMERA_PERSPECTIVE, NONE, SceneHeader};
use kernels::traversal::kernel::closest_hit;
use scene::{Camera, DAffine3, DVec3, Projection};

/// The header with the camera filled in and all tables empty.
pub(super) fn compile_camera(
    camera: &Camera,
    local_from_world: &DAffine3,
    local_bounds: Option<(DVec3, DVec3)>,
) -> Result<SceneHeader, CompileError> {
    let local_from_view = *local_from_world * camera.view_from_world.inverse();
    let (kind, scale_x, aspect) = match camera.projection {
        Projection::Perspective { fov_x, aspect } => {
            // GroIMP clamps the angle to a little less than pi.
            (CAMERA_PERSPECTIVE, (0.5 * fov_x.clamp(1e-6, std::f64::consts::PI - 1e-3)).tan(), aspect)
        }
        Projection::Parallel { width, aspect } => (CAMERA_PARALLEL, 0.5 * width, aspect),
    };
    let usable = local_from_view.is_finite()
        && camera.view_from_world.matrix3.determinant() != 0.0
        && scale_x.is_finite()
        && scale_x > 0.0
        && aspect.is_finite()
        && aspect > 0.0;
    if !usable {
        return Err(CompileError::DegenerateCamera);
    }
    let (lens_radius, vergence) = match camera.lens {
        None => (0.0, 0.0),
        Some(lens) => {
            let vergence = lens.focus.map_or(0.0, f64::recip);
            let radius = lens.radius;
            if !(radius >= 0.0 && radius.is_finite() && vergence >= 0.0 && vergence.is_finite()) {
                return Err(CompileError::DegenerateLens);
            }
            (radius, vergence)
        }
    };
    Ok(SceneHeader {
        world_from_view: affine(&local_from_view),
        view_scale_x: scale_x as f32,
        view_scale_y: (scale_x * aspect) as f32,
        start_distance: start_distance(&local_from_view.inverse(), local_bounds) as f32,
        camera: kind,
        unbounded_objects: 0,
        nodes: 0,
        lights: 0,
        distant_lights: 0,
        ambient: wgsl_rs::std::vec3f(0.0, 0.0, 0.0),
        all_lights: 0,
        lens_radius: lens_radius as f32,
        vergence: vergence as f32,
        reserved0: 0,
        reserved1: 0,
    })
}

/// A camera for a scene that was compiled with another one.
#[derive(Clone, Debug)]
pub struct View {
    /// That of the scene, with this camera in it.
    pub(crate) header: SceneHeader,
}

impl CompiledScene {
    /// The scene through another camera: exactly the picture of the scene compiled with it. (But for scenes of
    /// unbounded objects alone: they are rounded relative to the camera that they were compiled with.)
    ///
    /// # Errors
    /// If the numbers of the camera make no picture.
    pub fn view(&self, camera: &Camera) -> Result<View, CompileError> {
        let local_from_world = DAffine3::from_translation(-self.origin);
        let seen = compile_camera(camera, &local_from_world, self.local_bounds)?;
        let mut header = SceneHeader {
            world_from_view: seen.world_from_view,
            view_scale_x: seen.view_scale_x,
            view_scale_y: seen.view_scale_y,
            start_distance: seen.start_distance,
            camera: seen.camera,
            lens_radius: seen.lens_radius,
            vergence: seen.vergence,
            ..self.header
        };
        if camera.lens.is_some_and(|lens| lens.focus.is_none()) {
            header.vergence = middle_vergence(self, &header);
        }
        Ok(View { header })
    }
}

/// 1 / distance of the surface that the middle of the picture shows; 0 if there is none.
pub(super) fn middle_vergence(compiled: &CompiledScene, header: &SceneHeader) -> f32 {
    let settings = crate::RenderSettings { width: 2, height: 2, ..Default::default() }.launch();
    let ray = camera_ray(*header, settings, 1.0, 1.0);
    let hit = closest_hit(Slices::through(compiled, header), ray, independent_key(0, 0, 0), 0);
    let mut distance = f64::from(hit.shape.t);
    if header.camera == CAMERA_PARALLEL {
        // These rays start behind the view plane.
        distance -= f64::from(header.start_distance);
    }
    if hit.object == NONE || distance == 0.0 { 0.0 } else { distance.recip() as f32 }
}

/// Height above the view plane from which parallel rays see all finite objects, in metres.
fn start_distance(view_from_local: &DAffine3, local_bounds: Option<(DVec3, DVec3)>) -> f64 {
    let Some((low, high)) = local_bounds else {
        return 1000.0;
    };
    let centre = view_from_local.transform_point3(0.5 * (low + high));
    let radius = 0.5 * (high - low).length() * view_from_local.matrix3.z_axis.length().max(1.0);
    centre.z + 1.01 * radius + 1e-3
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compile;
    use scene::{Lens, MaterialId, Object, Origin, Scene, Shape, TypeNameId};

    #[test]
    fn another_camera_is_that_of_the_scene_compiled_with_it() {
        let mut scene = Scene::default();
        scene.materials.push(scene::Material::Rgba { color: [0.5; 3], opacity: 1.0 });
        scene.type_names.push("Box".to_owned());
        scene.objects.push(Object {
            shape: Shape::Box { width: 1.0, height: 2.0, length: 3.0 },
            world_from_object: DAffine3::from_translation(DVec3::new(100.0, 7.0, -3.0)),
            material: MaterialId(0),
            emission: None,
            interior: None,
            origin: Origin { node: 1, type_name: TypeNameId(0) },
        });
        let compiled = compile(&scene).unwrap();
        let eye = DVec3::new(90.0, -5.0, 4.0);
        let perspective = Camera::look_at(eye, DVec3::new(100.0, 7.0, -1.0), DVec3::Z, 0.7);
        let lens = Some(Lens { radius: 0.1, focus: None });
        let parallel = Projection::Parallel { width: 5.0, aspect: 1.5 };
        for camera in [
            perspective.clone(),
            Camera { lens, ..perspective.clone() },
            Camera { projection: parallel, lens, ..perspective },
        ] {
            let with_it = compile(&Scene { camera: camera.clone(), ..scene.clone() }).unwrap();
            let view = compiled.view(&camera).unwrap();
            assert_eq!(bytemuck::bytes_of(&view.header), bytemuck::bytes_of(&with_it.header));
        }
    }
}
