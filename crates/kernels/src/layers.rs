//! What the camera's rays meet first: layers beside a picture, to mask it, to measure in it, or to remove its noise.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::bsdf::kernel::*;
    use crate::bump::kernel::*;
    use crate::camera::kernel::*;
    use crate::coordinates::kernel::*;
    use crate::hit::kernel::*;
    use crate::mesh::kernel::*;
    use crate::random::kernel::*;
    use crate::records::kernel::*;
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
        let mut point = hit_surface::<S>(scene, ray, hit);
        let wo = -ray.direction;
        let front = dot(point.normal, wo) >= 0.0;
        let material = sided_material::<S>(scene, shape.material, front);
        let mut at = uv_point(point.uv);
        let looks_at_position =
            (material.flags & MATERIAL_USES_POSITION) != 0u32 || material.normal_map != NONE;
        if has::<S>(scene, FEATURE_POSITIONS) && looks_at_position {
            let p = hit_unit_point::<S>(scene, ray, hit);
            at = texture_point::<S>(scene, hit.instance, shape, surface, material, p, point.uv);
            point = with_normal_maps::<S>(scene, hit, material, p, at, point);
        }
        let normal = facing_normal(point, wo);
        let mut eta: f32 = 1.0;
        if material.refractive_index > 0.0 {
            eta = select(material.refractive_index, 1.0 / material.refractive_index, front);
        }
        let bsdf = material_bsdf::<S>(scene, material, at, eta, dot(normal, wo));
        layers.albedo += bsdf_albedo(bsdf);
        layers.normal += normal;
        layers.position += point.position;
        layers.depth += view_depth(S::header(scene), point.position);
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
            let ray = sampled_camera_ray(header, settings, key, x, y);
            layers = add_first_hit::<S>(scene, key, ray, layers);
        }
        layers
    }
}
