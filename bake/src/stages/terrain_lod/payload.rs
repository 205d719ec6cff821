//! Heightfield and its level-of-detail data → the binary data of `GSC_heightfield`, whose form the schema knows.

use std::borrow::Cow;

use genescape_schema::gltf::{HeightfieldData, write_heightfield};

use crate::model::{Heightfield, TerrainLod};

/// The payload's bytes.
pub fn encode(field: &Heightfield, lod: &TerrainLod) -> Vec<u8> {
    write_heightfield(&HeightfieldData {
        side: field.side,
        spacing_m: field.spacing_m,
        heights_m: Cow::Borrowed(&field.heights_m),
        wedgies_m: Cow::Borrowed(&lod.wedgies_m),
        displacements_m: Cow::Borrowed(&lod.displacements_m),
        block_ranges_m: Cow::Borrowed(&lod.block_ranges_m),
        levels: Cow::Borrowed(&lod.levels),
    })
}
