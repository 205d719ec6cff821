//! The land.

use bytemuck::{Pod, Zeroable};
use genescape_schema::scene::{Heightfield, floats};
use glam::Vec2;
use serde::{Deserialize, Serialize};

use super::Mesh;

/// The finished land: heights and what the forces that shaped it left behind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Landform {
    /// The walkable land, 1024 m from edge to edge.
    pub field: Heightfield,
    /// Drained area per sample, log-scaled to [0, 1]: 0 on a ridge, 1 in the greatest river bed.
    #[serde(with = "floats")]
    pub flow: Vec<f32>,
    /// Loose material laid down by erosion, per sample, [0, 1].
    #[serde(with = "floats")]
    pub deposit: Vec<f32>,
    /// How much of each sample is farmed, in level fields that are cut into the slope, [0, 1]; `None` where nothing is.
    pub paddies: Option<Vec<f32>>,
    /// Surface of the lake in metres; `None` when the land is dry.
    pub water_level_m: Option<f32>,
    /// Altitude in metres above which snow lies; above the highest point when there is none.
    pub snow_line_m: f32,
    /// The same land, coarse and several times as wide, to stand at the horizon: only its part outside `field` is
    /// drawn. Its heights agree with `field` along the border of `field`.
    pub apron: Heightfield,
}

impl Landform {
    /// Land of these heights that no force has shaped: without water, snow, deposits or fields.
    pub fn bare(field: Heightfield, apron: Heightfield) -> Self {
        let none = vec![0.0; field.heights_m.len()];
        Self {
            flow: none.clone(),
            deposit: none,
            paddies: None,
            water_level_m: None,
            snow_line_m: 1e4,
            field,
            apron,
        }
    }

    /// Height of the ground at a place (x, z) in metres, on the field or around it.
    pub fn height_m(&self, place: Vec2) -> f32 {
        let is_near = place.abs().max_element() <= 0.5 * self.field.extent_m();
        let heights = if is_near { &self.field } else { &self.apron };
        heights.height_m(place.x, place.y)
    }

    /// How much of a sample of the field is farmed, [0, 1].
    pub fn farmed(&self, sample: usize) -> f32 {
        self.paddies.as_ref().map_or(0.0, |paddies| paddies[sample])
    }
}

/// What the ground around a sample of `Landform::apron` is like.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct FarGround {
    /// Albedo: linear red, green and blue, 0 to 255 for 0 to 1, and 255.
    pub color: [u8; 4],
    /// Parts of rock, scree, snow and earth, as `GroundMaps::weights` has them: at most 255 in all, the rest is grass.
    pub weights: [u8; 4],
}

/// The land as triangles for any viewer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TerrainMesh {
    /// The adaptive mesh of `Landform::field`; uv 0..1 over the field (u = east, v = south).
    pub near: Mesh,
    /// The ring of `Landform::apron` around it, joined to its border without a crack; uv continues beyond 0..1.
    pub apron: Mesh,
    /// Of each of its vertices, [`FarGround::weights`].
    pub apron_weights: Vec<[u8; 4]>,
    /// The water surface: two triangles or empty.
    pub water: Mesh,
    /// Greatest vertical distance in metres between `near` and the heightfield, as verified.
    pub error_m: f32,
}
