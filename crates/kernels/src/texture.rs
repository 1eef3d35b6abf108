//! Colours that vary with the texture coordinates: pictures and checkerboards.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::bvh::kernel::*;
    use crate::records::kernel::*;
    use crate::tone::kernel::*;
    use wgsl_rs::std::*;

    /// Red, green, blue, alpha of a packed texel, red in the lowest byte, each in [0, 1].
    pub fn unpack_texel(texel: u32) -> Vec4f {
        unpack_bytes(texel) * (1.0 / 255.0)
    }

    /// A texel by column and row counted from the bottom; both wrap around.
    pub fn fetch_texel<S: SceneAccess + Copy>(
        scene: S,
        channel: ChannelRecord,
        column: u32,
        row: u32,
    ) -> Vec4f {
        let width = channel.size & 65535u32;
        let height = channel.size >> 16u32;
        let x = column % width;
        let y = height - 1u32 - row % height;
        let color = unpack_texel(S::texel(scene, channel.first + y * width + x));
        if (channel.mode & 2u32) == 0u32 {
            return color;
        }
        vec4f(srgb_decode(color.x), srgb_decode(color.y), srgb_decode(color.z), color.w)
    }

    /// GroIMP's `ImageMap`: repeats in u and v, v = 0 is the bottom row, and the corner of a texel is its
    /// sample point (materials-and-lights.md 2.3).
    pub fn image_color<S: SceneAccess + Copy>(scene: S, channel: ChannelRecord, uv: Vec2f) -> Vec4f {
        let width = f32(channel.size & 65535u32);
        let height = f32(channel.size >> 16u32);
        let x = (uv.x - floor(uv.x)) * width;
        let y = (uv.y - floor(uv.y)) * height;
        let column = u32(x);
        let row = u32(y);
        let wx = x - floor(x);
        let wy = y - floor(y);
        // One place that fetches, which keeps the code for graphics cards small.
        let corners = select(1u32, 4u32, (channel.mode & 1u32) != 0u32);
        let mut color = vec4f(0.0, 0.0, 0.0, 0.0);
        #[wgsl_allow(non_literal_loop_bounds)]
        for corner in 0..corners {
            let right = corner & 1u32;
            let up = corner >> 1u32;
            let texel = fetch_texel::<S>(scene, channel, column + right, row + up);
            let weight = select(1.0 - wx, wx, right == 1u32) * select(1.0 - wy, wy, up == 1u32);
            color += texel * select(1.0, weight, corners == 4u32);
        }
        color
    }

    /// Whether a point lies in an odd field of the checkerboard with two by two fields per unit of u and v.
    /// Computed in floats, which holds far away, too, where integers would overflow.
    pub fn in_odd_field(uv: Vec2f) -> bool {
        let fields = floor(2.0 * uv.x) + floor(2.0 * uv.y);
        fields - 2.0 * floor(0.5 * fields) >= 0.5
    }
}
