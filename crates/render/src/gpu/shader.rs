//! The kernels' view of a scene in storage buffers, and the entry point of the graphics card.
//!
//! The bindings are numbered as in [`super::scene`]. Eight storage buffers are what WebGPU guarantees.

use super::assemble::StandIn;
use crate::Renderer;
use kernels::records::kernel::ALL_FEATURES;
use kernels::traversal::kernel::MAX_BVH_DEPTH;
use wgsl_rs::wgsl;

// Rust never calls the entry point; the graphics card does. The whole is validated where it is joined.
#[allow(dead_code)]
#[wgsl(skip_validation)]
pub mod kernel {
    use kernels::bvh::kernel::*;
    use kernels::layers::kernel::*;
    use kernels::pixel::kernel::*;
    use kernels::records::kernel::*;
    use wgsl_rs::std::*;

    uniform!(group(0), binding(0), HEADER: SceneHeader);
    uniform!(group(0), binding(1), SETTINGS: LaunchSettings);
    storage!(group(0), binding(2), NODES: RuntimeArray<BvhNode>);
    storage!(group(0), binding(3), OBJECTS: RuntimeArray<ObjectRecord>);
    storage!(group(0), binding(4), MATERIALS: RuntimeArray<MaterialRecord>);
    storage!(group(0), binding(5), CHANNELS: RuntimeArray<ChannelRecord>);
    storage!(group(0), binding(6), TEXELS: RuntimeArray<u32>);
    storage!(group(0), binding(7), LIGHTS: RuntimeArray<LightRecord>);
    storage!(group(0), binding(8), ATTRIBUTES: RuntimeArray<Vec4f>);
    storage!(group(0), binding(9), read_write, FILM: RuntimeArray<FilmPixel>);
    // Another entry point, so the same place.
    storage!(group(0), binding(9), read_write, LAYERS: RuntimeArray<LayerPixel>);

    /// Stands for the storage buffers where the kernels expect a scene.
    #[derive(Copy, Clone, Wgsl)]
    pub struct Buffers {
        pub unused: u32,
    }

    /// What the scene may contain; programs for particular scenes have another number here.
    pub const FEATURES: u32 = 262143;

    impl SceneAccess for Buffers {
        fn features(_scene: Buffers) -> u32 {
            FEATURES
        }
        fn header(_scene: Buffers) -> SceneHeader {
            load!(HEADER)
        }
        fn node(_scene: Buffers, index: u32) -> BvhNode {
            get!(NODES)[index as usize]
        }
        fn reached_children(_scene: Buffers, index: u32, origin: Vec3f, inverse: Vec3f, t_max: f32) -> u32 {
            reached_boxes(get!(NODES)[index as usize], origin, inverse, t_max)
        }
        fn shape(_scene: Buffers, index: u32) -> ShapeRecord {
            get!(OBJECTS)[index as usize].shape
        }
        fn surface(_scene: Buffers, index: u32) -> SurfaceRecord {
            get!(OBJECTS)[index as usize].surface
        }
        fn material(_scene: Buffers, index: u32) -> MaterialRecord {
            get!(MATERIALS)[index as usize]
        }
        fn channel(_scene: Buffers, index: u32) -> ChannelRecord {
            get!(CHANNELS)[index as usize]
        }
        fn texel(_scene: Buffers, index: u32) -> u32 {
            get!(TEXELS)[index as usize]
        }
        fn light(_scene: Buffers, index: u32) -> LightRecord {
            get!(LIGHTS)[index as usize]
        }
        fn attribute(_scene: Buffers, index: u32) -> Vec4f {
            get!(ATTRIBUTES)[index as usize]
        }
    }

    /// One invocation adds the samples of one launch to one pixel of the tile.
    #[compute]
    #[workgroup_size(8, 8)]
    pub fn render_tile(#[builtin(global_invocation_id)] id: Vec3u) {
        let settings = load!(SETTINGS);
        if id.x < settings.tile_width && id.y < settings.tile_height {
            let index = id.y * settings.tile_width + id.x;
            let before = get!(FILM)[index as usize];
            let after = render_pixel::<Buffers>(
                Buffers { unused: 0u32 },
                settings,
                settings.tile_x + id.x,
                settings.tile_y + id.y,
                before,
            );
            get_mut!(FILM)[index as usize] = after;
        }
    }

    /// As `render_tile`, for the layers.
    #[compute]
    #[workgroup_size(8, 8)]
    pub fn render_layers(#[builtin(global_invocation_id)] id: Vec3u) {
        let settings = load!(SETTINGS);
        if id.x < settings.tile_width && id.y < settings.tile_height {
            let index = id.y * settings.tile_width + id.x;
            let before = get!(LAYERS)[index as usize];
            let after = layers_of_pixel::<Buffers>(
                Buffers { unused: 0u32 },
                settings,
                settings.tile_x + id.x,
                settings.tile_y + id.y,
                before,
            );
            get_mut!(LAYERS)[index as usize] = after;
        }
    }
}

/// The complete shader of a renderer for scenes that have no other than the given features.
///
/// # Errors
/// If the kernels use something that cannot be written in WGSL; the tests exclude it.
pub(super) fn source(renderer: Renderer, features: u32) -> Result<String, String> {
    let choice = StandIn { replaced: "add_samples", by: renderer.kernel() };
    let general = super::assemble::assemble(&kernel::WGSL_SOURCE, choice)?;
    let declaration = |features: u32| format!("const FEATURES: u32 = {features}u;\n");
    let particular = replaced(&general, &declaration(ALL_FEATURES), &declaration(features))?;
    with_private_stacks(particular)
}

/// Moves the stacks of the search, of which there is one at a time, out of their function: there WGSL has them filled
/// with zeros for every ray, here once.
fn with_private_stacks(source: String) -> Result<String, String> {
    // For the hierarchy of the scene and for that of a group. Programs run without bounds checks, so an array of
    // another length must not go unnoticed.
    let array = format!("array<u32, {}>", 2 * MAX_BVH_DEPTH);
    let stacks = ["stack_first", "stack_bits"];
    stacks.into_iter().try_fold(source, |source, stack| {
        let rest = replaced(&source, &format!("    var {stack}: {array} = {array}();\n"), "")?;
        Ok(format!("var<private> {stack}: {array};\n{rest}"))
    })
}

/// The text with the only occurrence of a piece replaced.
fn replaced(text: &str, piece: &str, by: &str) -> Result<String, String> {
    match text.split(piece).collect::<Vec<_>>()[..] {
        [before, after] => Ok(format!("{before}{by}{after}")),
        ref parts => Err(format!("`{}` occurs {} times instead of once", piece.trim(), parts.len() - 1)),
    }
}

#[cfg(test)]
mod tests {
    /// The WGSL that the graphics card runs is kept as a file, so that a reader sees it and a change of the
    /// translator shows as a difference. Set `SUNSHINE_BLESS=1` to accept a change.
    #[test]
    fn emitted_wgsl_matches_the_reviewed_snapshot() {
        for (file, source) in crate::gpu::kernel_sources().unwrap() {
            let path = format!(concat!(env!("CARGO_MANIFEST_DIR"), "/src/gpu/{}"), file);
            if std::env::var_os("SUNSHINE_BLESS").is_some() {
                std::fs::write(&path, &source).unwrap();
            }
            let reviewed = std::fs::read_to_string(&path).unwrap_or_default();
            assert!(
                source == reviewed,
                "the emitted WGSL differs from {path}; review it with SUNSHINE_BLESS=1 and git diff"
            );
        }
    }
}
