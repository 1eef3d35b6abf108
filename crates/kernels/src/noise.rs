//! GroIMP's lattice noise (materials-and-lights.md 2.7): every corner of the lattice of whole numbers has a random
//! value and slope, in between they are joined smoothly.
//!
//! The random numbers stand in the texel table from a given place on: a permutation of 0..65536, then 512 floats
//! as bit patterns, in all `NOISE_TABLE_SIZE` words.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::records::kernel::*;
    use wgsl_rs::std::*;

    /// Length of the permutation.
    pub const NOISE_PERMUTATION: u32 = 65536;
    /// Number of the random floats behind it.
    pub const NOISE_VALUES: u32 = 512;
    /// Words of both together.
    pub const NOISE_TABLE_SIZE: u32 = 66048;

    /// One number: the sum of octaves.
    pub const NOISE_SCALAR: u32 = 0;
    /// Three numbers, of half the size and not limited to [-1, 1].
    pub const NOISE_VECTOR: u32 = 1;
    /// One number: octaves folded at 0, GroIMP's `Granite`.
    pub const NOISE_GRANITE: u32 = 2;

    /// The value that a corner with hash `m` spreads to a point at `offset` from it.
    pub fn corner_value<S: SceneAccess + Copy>(scene: S, table: u32, m: u32, offset: Vec3f) -> f32 {
        let factors = vec4f(0.5, offset.x, offset.y, offset.z);
        let mut sum: f32 = 0.0;
        for k in 0..4 {
            let value = bitcast_f32(S::texel(scene, table + NOISE_PERMUTATION + ((m + u32(k)) & 511u32)));
            let mut factor = factors.x;
            if k == 1 {
                factor = factors.y;
            }
            if k == 2 {
                factor = factors.z;
            }
            if k == 3 {
                factor = factors.w;
            }
            sum += value * factor;
        }
        sum
    }

    /// The joined values at a point, the first 1 or 3 components.
    pub fn lattice_noise<S: SceneAccess + Copy>(
        scene: S,
        table: u32,
        point: Vec3f,
        components: u32,
    ) -> Vec3f {
        // Floats are whole numbers long before, so the limits only keep the conversions to integers in range.
        let limit = vec3f(1.0e9, 1.0e9, 1.0e9);
        let p = clamp(point, -limit, limit);
        let cell = floor(p);
        let d = p - cell;
        let s = d * d * (vec3f(3.0, 3.0, 3.0) - d * 2.0);
        let ix = bitcast_u32(i32(cell.x));
        let iy = bitcast_u32(i32(cell.y));
        let iz = bitcast_u32(i32(cell.z));
        let mut sum = vec3f(0.0, 0.0, 0.0);
        for corner in 0..8 {
            let cx = u32(corner) & 1u32;
            let cy = (u32(corner) >> 1u32) & 1u32;
            let cz = u32(corner) >> 2u32;
            let weight = select(1.0 - s.x, s.x, cx == 1u32)
                * select(1.0 - s.y, s.y, cy == 1u32)
                * select(1.0 - s.z, s.z, cz == 1u32);
            let a = S::texel(scene, table + ((ix + cx) & 65535u32));
            let b = S::texel(scene, table + (a ^ ((iy + cy) & 65535u32)));
            let m = S::texel(scene, table + (b ^ ((iz + cz) & 65535u32)));
            let offset = d - vec3f(f32(cx), f32(cy), f32(cz));
            #[wgsl_allow(non_literal_loop_bounds)]
            for component in 0..components {
                let value = weight * corner_value::<S>(scene, table, m + 8u32 * component, offset);
                let axis = vec3f(
                    select(0.0, 1.0, component == 0u32),
                    select(0.0, 1.0, component == 1u32),
                    select(0.0, 1.0, component == 2u32),
                );
                sum += axis * value;
            }
        }
        sum
    }

    /// Noise of one octave after the other, each `frequency_ratio` finer and `noise_ratio` as strong as the one
    /// before. Of a single number x is the result.
    pub fn octaves_of_noise<S: SceneAccess + Copy>(
        scene: S,
        table: u32,
        point: Vec3f,
        octaves: u32,
        frequency_ratio: f32,
        noise_ratio: f32,
        kind: u32,
    ) -> Vec3f {
        let mut p = point;
        let mut amplitude: f32 = 1.0;
        let mut sum = vec3f(0.0, 0.0, 0.0);
        #[wgsl_allow(non_literal_loop_bounds)]
        for _octave in 0..octaves {
            let values = lattice_noise::<S>(scene, table, p, select(1u32, 3u32, kind == NOISE_VECTOR));
            if kind == NOISE_VECTOR {
                sum += values * amplitude;
            } else {
                let noise = clamp(2.0 * values.x, -1.0, 1.0);
                let folded = select(-0.5 - noise, noise - 0.5, noise > 0.0);
                sum.x += amplitude * select(noise, folded, kind == NOISE_GRANITE);
            }
            p *= frequency_ratio;
            amplitude *= noise_ratio;
        }
        sum
    }
}
