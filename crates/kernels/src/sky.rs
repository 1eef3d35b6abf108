//! Skies: their radiance, and how directions are drawn in proportion to it.
//!
//! Every sky has axes of its own, in which its radiance is given, for the eye and for the light alike. (In GroIMP
//! the picture of a sky follows the node's axes and its light the world's, so that a turned sky disagrees with
//! itself.)

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::channel::kernel::*;
    use crate::coordinates::kernel::*;
    use crate::records::kernel::*;
    use crate::shape::kernel::*;
    use crate::warp::kernel::*;
    use wgsl_rs::std::*;

    /// A direction and the density with which it was drawn.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct SkyDirection {
        pub direction: Vec3f,
        pub pdf: f32,
    }

    /// A world direction in the axes of a sky or a physical light.
    pub fn to_light_axes(light: LightRecord, direction: Vec3f) -> Vec3f {
        vec3f(dot(light.edge_u, direction), dot(light.edge_v, direction), dot(light.axis, direction))
    }

    /// The inverse of `to_light_axes`.
    pub fn out_of_light_axes(light: LightRecord, local: Vec3f) -> Vec3f {
        normalize(light.edge_u * local.x + light.edge_v * local.y + light.axis * local.z)
    }

    /// The function of Perez, Seals and Michalsky (1993) with coefficients A to D and E; `over_cos` is 1 over the
    /// cosine of the zenith angle, `gamma` the angle to the sun.
    pub fn perez(a_to_d: Vec4f, e: f32, over_cos: f32, gamma: f32) -> f32 {
        let cos_gamma = cos(gamma);
        (1.0 + a_to_d.x * exp(a_to_d.y * over_cos))
            * (1.0 + a_to_d.z * exp(a_to_d.w * gamma) + e * cos_gamma * cos_gamma)
    }

    /// Linear Rec. 709 colour of CIE XYZ. Where a channel would be negative, all are raised by as much, as in GroIMP.
    pub fn rgb_from_xyz(xyz: Vec3f) -> Vec3f {
        let rgb = vec3f(
            3.2404542 * xyz.x - 1.5371385 * xyz.y - 0.4985314 * xyz.z,
            -0.9692660 * xyz.x + 1.8760108 * xyz.y + 0.0415560 * xyz.z,
            0.0556434 * xyz.x - 0.2040259 * xyz.y + 1.0572252 * xyz.z,
        );
        let lack = max(0.0, -smallest(rgb));
        rgb + vec3f(lack, lack, lack)
    }

    /// Radiance of a clear sky in a direction of its axes: luminance and chromaticity after Preetham et al. (1999).
    ///
    /// The attributes from `program` on: direction of the sun; A to D of luminance, x and y; the three E; zenith
    /// values over the function's value there.
    pub fn daylight_radiance<S: SceneAccess + Copy>(scene: S, program: u32, local: Vec3f) -> Vec3f {
        if local.z < 0.0 {
            return vec3f(0.0, 0.0, 0.0);
        }
        let sun = S::attribute(scene, program);
        let e = S::attribute(scene, program + 4u32);
        let zenith = S::attribute(scene, program + 5u32);
        let gamma = acos(clamp(dot(vec3f(sun.x, sun.y, sun.z), local), -1.0, 1.0));
        let over_cos = 1.0 / max(local.z, 0.001);
        let luminance = zenith.x * perez(S::attribute(scene, program + 1u32), e.x, over_cos, gamma);
        let x = zenith.y * perez(S::attribute(scene, program + 2u32), e.y, over_cos, gamma);
        let y = zenith.z * perez(S::attribute(scene, program + 3u32), e.z, over_cos, gamma);
        let scale = max(luminance, 0.0) / max(y, 1.0e-3);
        rgb_from_xyz(vec3f(x * scale, max(luminance, 0.0), (1.0 - x - y) * scale))
    }

    /// True if a world direction points into the disc of the sun.
    pub fn is_in_sun(light: LightRecord, direction: Vec3f) -> bool {
        // The chord is exact where the cosine would be lost to rounding.
        let chord = direction + light.axis;
        dot(chord, chord) <= 2.0 * light.cos_inner
    }

    /// Radiance that arrives from a light that is infinitely far away when looking in a world direction; lights
    /// without extent cannot be seen.
    pub fn distant_radiance<S: SceneAccess + Copy>(scene: S, light: LightRecord, direction: Vec3f) -> Vec3f {
        if light.kind == LIGHT_SKY {
            return light.emission;
        }
        if light.kind == LIGHT_SUN {
            if is_in_sun(light, direction) {
                return light.emission;
            }
            return vec3f(0.0, 0.0, 0.0);
        }
        let tables = has::<S>(scene, FEATURE_LIGHT_TABLES);
        if tables && (light.kind == LIGHT_SKY_MAP || light.kind == LIGHT_DAYLIGHT) {
            let local = to_light_axes(light, direction);
            if light.kind == LIGHT_DAYLIGHT {
                return daylight_radiance::<S>(scene, light.program, local);
            }
            // The mapping of a sphere, scene-format.md chapter 4.1.
            let uv = vec2f(turn_fraction(local), acos(clamp(-local.z, -1.0, 1.0)) * INVERSE_PI);
            let at = TexturePoint { uv, local, world: direction };
            let color = channel_value::<S>(scene, light.program, at, vec4f(0.0, 0.0, 0.0, 1.0));
            return light.emission * max(vec3f(color.x, color.y, color.z), vec3f(0.0, 0.0, 0.0));
        }
        vec3f(0.0, 0.0, 0.0)
    }

    /// True for lights that surround the whole scene and have extent.
    pub fn is_sky(kind: u32) -> bool {
        kind == LIGHT_SKY || kind == LIGHT_SKY_MAP || kind == LIGHT_DAYLIGHT
    }

    /// The background where nothing is hit: black if there is a sky.
    pub fn background_radiance<S: SceneAccess + Copy>(scene: S, background: Vec3f) -> Vec3f {
        let lights = S::header(scene).distant_lights;
        let mut radiance = background;
        #[wgsl_allow(non_literal_loop_bounds)]
        for i in 0..lights {
            if is_sky(S::light(scene, i).kind) {
                radiance = vec3f(0.0, 0.0, 0.0);
            }
        }
        radiance
    }

    /// Density with which the uniform sky is sampled in `direction` at a surface: by the cosine, on the side of
    /// `normal` or on both.
    pub fn uniform_sky_pdf(normal: Vec3f, direction: Vec3f, both_sides: bool) -> f32 {
        let cosine = dot(normal, direction);
        if both_sides {
            return 0.5 * abs(cosine) * INVERSE_PI;
        }
        cosine_hemisphere_pdf(cosine)
    }

    /// A direction for the uniform sky.
    pub fn sample_uniform_sky(normal: Vec3f, both_sides: bool, u: Vec2f) -> SkyDirection {
        let mut side = 1.0;
        let mut first = u.x;
        if both_sides {
            // One number chooses the side and, stretched, the angle.
            let behind = first >= 0.5;
            first = stretched(first, select(0.0, 0.5, behind), 0.5);
            side = select(1.0, -1.0, behind);
        }
        let direction = around_axis(normal * side, cosine_hemisphere(vec2f(first, u.y)));
        SkyDirection { direction, pdf: uniform_sky_pdf(normal, direction, both_sides) }
    }

    /// Density of the directions within the disc of the sun.
    pub fn sun_pdf(light: LightRecord) -> f32 {
        1.0 / (TWO_PI * light.cos_inner)
    }

    /// A direction towards a point of the sun.
    pub fn sample_sun(light: LightRecord, u: Vec2f) -> SkyDirection {
        // 1 minus the cosine; written so that nothing is lost for the tiny angle.
        let versine = u.x * light.cos_inner;
        let sine = sqrt(versine * (2.0 - versine));
        let turned = on_circle(u.y);
        let local = vec3f(turned.x * sine, turned.y * sine, 1.0 - versine);
        SkyDirection { direction: around_axis(-light.axis, local), pdf: sun_pdf(light) }
    }

    /// The first of `count` intervals whose upper end is above `u`. The attributes from `first` on hold lower and
    /// upper ends in x and y, rising from 0 to 1.
    pub fn find_interval<S: SceneAccess + Copy>(scene: S, first: u32, count: u32, u: f32) -> u32 {
        let mut low: u32 = 0;
        let mut high = count - 1u32;
        while low < high {
            let middle = (low + high) / 2u32;
            if S::attribute(scene, first + middle).y > u {
                high = middle;
            } else {
                low = middle + 1u32;
            }
        }
        low
    }

    /// Density in which a direction is drawn from a table of cells of equal solid angle: rows by the height above
    /// the horizon, from the zenith down, columns by the azimuth. The table starts with an interval for every
    /// row; then come, row by row, the intervals of the cells with their density in z.
    pub fn table_pdf<S: SceneAccess + Copy>(scene: S, light: LightRecord, direction: Vec3f) -> f32 {
        let columns = light.count & 65535u32;
        let rows = light.count >> 16u32;
        let local = to_light_axes(light, direction);
        let row = min(u32(max(0.5 * (1.0 - local.z), 0.0) * f32(rows)), rows - 1u32);
        let column = min(u32(turn_fraction(local) * f32(columns)), columns - 1u32);
        S::attribute(scene, light.first + rows + row * columns + column).z
    }

    /// A direction drawn from the table.
    pub fn sample_table<S: SceneAccess + Copy>(scene: S, light: LightRecord, u: Vec2f) -> SkyDirection {
        let columns = light.count & 65535u32;
        let rows = light.count >> 16u32;
        let row = find_interval::<S>(scene, light.first, rows, u.x);
        let band = S::attribute(scene, light.first + row);
        let cells = light.first + rows + row * columns;
        let column = find_interval::<S>(scene, cells, columns, u.y);
        let cell = S::attribute(scene, cells + column);
        let down = clamp((u.x - band.x) / max(band.y - band.x, 1.0e-20), 0.0, 1.0);
        let along = clamp((u.y - cell.x) / max(cell.y - cell.x, 1.0e-20), 0.0, 1.0);
        let z = 1.0 - 2.0 * (f32(row) + down) / f32(rows);
        let local = polar_direction(clamp(z, -1.0, 1.0), (f32(column) + along) / f32(columns));
        SkyDirection { direction: out_of_light_axes(light, local), pdf: cell.z }
    }

    /// Density per solid angle with which a light that is infinitely far away is sampled in a direction, at a
    /// surface with unit normal `normal`; 0 for lights without extent.
    pub fn distant_pdf<S: SceneAccess + Copy>(
        scene: S,
        light: LightRecord,
        normal: Vec3f,
        both_sides: bool,
        direction: Vec3f,
    ) -> f32 {
        if light.kind == LIGHT_SKY {
            return uniform_sky_pdf(normal, direction, both_sides);
        }
        if light.kind == LIGHT_SUN {
            return sun_pdf(light);
        }
        let tables = has::<S>(scene, FEATURE_LIGHT_TABLES);
        if tables && (light.kind == LIGHT_SKY_MAP || light.kind == LIGHT_DAYLIGHT) {
            return table_pdf::<S>(scene, light, direction);
        }
        0.0
    }
}
