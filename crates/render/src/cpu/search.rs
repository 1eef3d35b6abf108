//! Single rays on the calling thread: what they meet first, and what light passes along them. Benchmarks of the hierarchy
//! and the shapes measure this; pictures go the same way.

use super::slices::PLAIN_FEATURES;
use super::{Cpu, CpuScene};
use crate::CompiledScene;
use kernels::random::kernel::independent_key;
use kernels::records::kernel::{ALL_FEATURES, SceneAccess};
use kernels::shape::kernel::Ray;
use kernels::traversal::kernel::{Hit, closest_hit, shadow_transmittance};
use std::sync::Arc;
use wgsl_rs::std::Vec3f;

/// A ray with an end.
#[derive(Clone, Copy, Debug)]
pub struct ShadowRay {
    /// Relative to [`CompiledScene::origin`], in metres.
    pub ray: Ray,
    /// Where it ends, as a multiple of its direction.
    pub t_max: f32,
}

/// A scene, prepared as for pictures, that answers for single rays.
pub struct RaySearch {
    scene: CpuScene,
}

impl RaySearch {
    /// Prepares a scene with the threads of a device; rays are then followed on the thread that asks.
    pub fn new(cpu: &Cpu, scene: Arc<CompiledScene>) -> Self {
        RaySearch { scene: CpuScene::new(cpu, scene) }
    }

    /// What every ray meets first. Rays are relative to [`CompiledScene::origin`], in metres; partly transparent
    /// surfaces are met by chance, the same way every time.
    pub fn first_hits(&self, rays: &[Ray]) -> Vec<Hit> {
        if self.scene.is_plain() {
            first_hits(self.scene.slices::<PLAIN_FEATURES>(), rays)
        } else {
            first_hits(self.scene.slices::<ALL_FEATURES>(), rays)
        }
    }

    /// The share of light in every channel that passes along every ray.
    pub fn transmittances(&self, rays: &[ShadowRay]) -> Vec<Vec3f> {
        if self.scene.is_plain() {
            transmittances(self.scene.slices::<PLAIN_FEATURES>(), rays)
        } else {
            transmittances(self.scene.slices::<ALL_FEATURES>(), rays)
        }
    }
}

fn first_hits<S: SceneAccess + Copy>(scene: S, rays: &[Ray]) -> Vec<Hit> {
    // More rays than 32 bits can count repeat the random numbers of the first ones.
    let numbered = (0..=u32::MAX).cycle().zip(rays);
    numbered.map(|(number, ray)| closest_hit(scene, *ray, independent_key(number, 0, 0), 0)).collect()
}

fn transmittances<S: SceneAccess + Copy>(scene: S, rays: &[ShadowRay]) -> Vec<Vec3f> {
    rays.iter().map(|shadow| shadow_transmittance(scene, shadow.ray, shadow.t_max, false)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::records::kernel::NONE;
    use scene::{DAffine3, Material, Object, Origin, Scene, Shape, TypeNameId};
    use wgsl_rs::std::vec3f;

    #[test]
    fn a_sphere_is_met_and_stops_light() {
        let mut scene = Scene { type_names: vec!["test".to_owned()], ..Scene::default() };
        let material = scene.add_material(Material::Rgba { color: [0.5; 3], opacity: 1.0 });
        scene.objects.push(Object {
            shape: Shape::Sphere { radius: 1.0 },
            world_from_object: DAffine3::IDENTITY,
            material,
            emission: None,
            interior: None,
            origin: Origin { node: 1, type_name: TypeNameId(0) },
        });
        let compiled = Arc::new(crate::compile(&scene).unwrap());
        let search = RaySearch::new(&Cpu::new(Some(1)).unwrap(), compiled);
        let ray = |x| Ray { origin: vec3f(x, 0.0, 3.0), direction: vec3f(0.0, 0.0, -1.0) };
        let hits = search.first_hits(&[ray(0.0), ray(2.0)]);
        assert_eq!((hits[0].object, hits[1].object), (0, NONE));
        assert!((hits[0].shape.t - 2.0).abs() < 1e-5);
        let shadow = |x, t_max| ShadowRay { ray: ray(x), t_max };
        let passed = search.transmittances(&[shadow(0.0, 9.0), shadow(0.0, 1.0), shadow(2.0, 9.0)]);
        assert_eq!(passed.iter().map(|share| share.x).collect::<Vec<_>>(), [0.0, 1.0, 1.0]);
    }
}
