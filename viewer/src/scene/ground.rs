//! The land as plain values: its heights, what its levels of detail need, and what covers it.

use std::sync::Arc;

use genescape_schema::scene::{DensityMap, GroundSurface, Heightfield, PlantKind, TerrainLod};

use super::Image;

/// All of the land.
#[derive(Clone, Debug)]
pub struct Ground {
    /// Blob that the heights came from: equal names are equal heights.
    pub name: String,
    pub field: Arc<Heightfield>,
    /// What the levels of detail of `field` need.
    pub lod: Arc<TerrainLod>,
    /// Surface of the lake in metres; `None` when the land is dry.
    pub water_level_m: Option<f32>,
    /// What covers it.
    pub surface: GroundSurface<Image>,
    /// The coarse land around the field, to the horizon.
    pub apron: Arc<Apron>,
}

impl Ground {
    /// The map that says how densely a kind of plant stands.
    pub fn plant_map(&self, kind: &PlantKind) -> Option<DensityMap<'_>> {
        let image = self.surface.plants.maps.get(kind.channel as usize / 4)?;
        let rgba = image.levels.first()?;
        Some(DensityMap { width_px: image.width_px, height_px: image.height_px, rgba })
    }
}

/// The ring of coarse land around the field as triangles; its inner edge joins the field's border as the near mesh
/// of the file has it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Apron {
    /// Metres.
    pub positions_m: Vec<[f32; 3]>,
    /// Unit length.
    pub normals: Vec<[f32; 3]>,
    /// Linear albedo in 8 bits a channel, alpha unused.
    pub colors: Vec<[u8; 4]>,
    /// Triangles, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
}
