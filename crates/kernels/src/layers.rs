//! What the camera's rays meet first: layers beside a picture, to mask it, to measure in it, or to remove its noise.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::bsdf::kernel::*;
    use crate::camera::kernel::*;
    use crate::random::kernel::*;
    use crate::records::kernel::*;
    use crate::shading::kernel::*;
    use crate::shape::kernel::*;
    use crate::traversal::kernel::*;
    use wgsl_rs::std::*;

    /// Share of light that leaves a surface again, one direction with the other; the fit to be expected between a
    /// picture and its lighting, not an exact integral for glossy lobes.
    pub fn bsdf_albedo(bsdf: Bsdf) -> Vec3f {
        bsdf.diffuse + bsdf.diffuse_transmission + bsdf.glossy + bsdf.glossy_transmission + bsdf.straight
    }

    /// Distance of a point from the plane of the camera, along the direction of view.
    pub fn view_depth(header: SceneHeader, position: Vec3f) -> f32 {
        let eye = transform_point(header.world_from_view, vec3f(0.0, 0.0, 0.0));
        let forward = normalize(transform_vector(header.world_from_view, vec3f(0.0, 0.0, -1.0)));
        dot(position - eye, forward)
    }

    /// Adds to a pixel what one ray meets first.
    pub fn add_first_hit<S: SceneAccess + Copy>(
        scene: S,
        key: SampleKey,
        ray: Ray,
        before: LayerPixel,
    ) -> LayerPixel {
        let mut layers = before;
        layers.samples += 1;
        let hit = closest_hit::<S>(scene, ray, key, 0u32);
        if hit.object == NONE {
            return layers;
        }
        let shape = S::shape(scene, hit.object);
        let surface = S::surface(scene, hit.object);
        let met = shading_point::<S>(scene, ray, hit);
        let material = met.material;
        let mut eta: f32 = 1.0;
        if material.refractive_index > 0.0 {
            eta = select(material.refractive_index, 1.0 / material.refractive_index, met.cos_front >= 0.0);
        }
        let bsdf = material_bsdf::<S>(scene, material, met.at, eta, dot(met.normal, -ray.direction));
        layers.albedo += bsdf_albedo(bsdf);
        layers.normal += met.normal;
        layers.position += met.point.position;
        layers.depth += view_depth(S::header(scene), met.point.position);
        layers.hits += 1;
        if layers.object == 0u32 {
            let mut source = surface.source;
            if hit.instance != NONE {
                let placed = S::surface(scene, hit.instance).source;
                // The triangles of a mesh that is drawn several times come from what the instance comes from.
                source = select(source, placed, source == NONE);
                layers.instance = placed + 1u32;
            }
            layers.object = source + 1u32;
            layers.material = shape.material + 1u32;
        }
        layers
    }

    /// Adds samples to a pixel of the layers; the rays are those of the picture's first samples.
    pub fn layers_of_pixel<S: SceneAccess + Copy>(
        scene: S,
        settings: LaunchSettings,
        x: u32,
        y: u32,
        before: LayerPixel,
    ) -> LayerPixel {
        let header = S::header(scene);
        let mut layers = before;
        #[wgsl_allow(non_literal_loop_bounds)]
        for i in 0..settings.samples {
            let key = sample_key(settings, x, y, settings.first_sample + i);
            let ray = sample_camera(header, settings, key, x, y).ray;
            layers = add_first_hit::<S>(scene, key, ray, layers);
        }
        layers
    }
}
