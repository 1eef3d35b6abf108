//! Colours that vary with the texture coordinates: pictures and checkerboards.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::records::kernel::*;
    use wgsl_rs::std::*;

    /// Red, green, blue, alpha of a packed texel, red in the lowest byte, each in [0, 1].
    pub fn unpack_texel(texel: u32) -> Vec4f {
        vec4f(
            f32(texel & 255u32),
            f32((texel >> 8u32) & 255u32),
            f32((texel >> 16u32) & 255u32),
            f32(texel >> 24u32),
        ) * (1.0 / 255.0)
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
        unpack_texel(S::texel(scene, channel.first + y * width + x))
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
        let corner = fetch_texel::<S>(scene, channel, column, row);
        if channel.bilinear == 0u32 {
            return corner;
        }
        let wx = x - floor(x);
        let wy = y - floor(y);
        let right = fetch_texel::<S>(scene, channel, column + 1u32, row);
        let above = fetch_texel::<S>(scene, channel, column, row + 1u32);
        let above_right = fetch_texel::<S>(scene, channel, column + 1u32, row + 1u32);
        let lower = corner * (1.0 - wx) + right * wx;
        let upper = above * (1.0 - wx) + above_right * wx;
        lower * (1.0 - wy) + upper * wy
    }

    /// Whether a point lies in an odd field of the checkerboard with two by two fields per unit of u and v.
    /// Computed in floats, which holds far away, too, where integers would overflow.
    pub fn in_odd_field(uv: Vec2f) -> bool {
        let fields = floor(2.0 * uv.x) + floor(2.0 * uv.y);
        fields - 2.0 * floor(0.5 * fields) >= 0.5
    }
}
