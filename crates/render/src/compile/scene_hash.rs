//! A short name for everything that decides what a compiled scene looks like.

use super::{CompiledScene, View};
use kernels::records::kernel::SceneHeader;
use rayon::prelude::*;
use sha2::{Digest, Sha256};

/// Bytes that one thread takes at a time; part of what the hash means.
const PIECE: usize = 1 << 20;
/// Bytes of the digest that are kept: two scenes in 2^64 are mistaken for each other.
const KEPT: usize = 16;

impl CompiledScene {
    /// The first 128 bits of the SHA-256 of all tables, in hexadecimal: scenes with the same hash give the same
    /// picture with the same settings. What objects are called does not count.
    pub fn hash(&self) -> String {
        self.hash_with(&self.header)
    }

    /// As [`CompiledScene::hash`], of the scene as it would be compiled with another camera.
    pub fn hash_through(&self, view: &View) -> String {
        self.hash_with(&view.header)
    }

    fn hash_with(&self, header: &SceneHeader) -> String {
        let CompiledScene {
            header: _,
            nodes,
            objects,
            materials,
            channels,
            texels,
            lights,
            attributes,
            origins: _,
            type_names: _,
            origin,
            features,
            triangles: _,
            // Of the objects.
            local_bounds: _,
        } = self;
        let mut all = Sha256::new();
        all.update(bytemuck::bytes_of(header));
        all.update(features.to_le_bytes());
        origin.to_array().iter().for_each(|coordinate| all.update(coordinate.to_le_bytes()));
        let tables: [&[u8]; 7] = [
            bytemuck::cast_slice(nodes),
            bytemuck::cast_slice(objects),
            bytemuck::cast_slice(materials),
            bytemuck::cast_slice(channels),
            bytemuck::cast_slice(texels),
            bytemuck::cast_slice(lights),
            bytemuck::cast_slice(attributes),
        ];
        for table in tables {
            all.update((table.len() as u64).to_le_bytes());
            let pieces: Vec<_> = table.par_chunks(PIECE).map(Sha256::digest).collect();
            pieces.iter().for_each(|piece| all.update(piece));
        }
        all.finalize()[..KEPT].iter().map(|byte| format!("{byte:02x}")).collect()
    }
}
