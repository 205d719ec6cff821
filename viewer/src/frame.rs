//! What one frame is drawn from, for all views alike: time, choices of the person, level-of-detail schemes.

use serde::{Deserialize, Serialize};

/// How trees get their level of detail (thesis 4.3.2 and 4.3.3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum TreeScheme {
    /// Continuous, by each mesh's error in metres: q(f(d)) ∝ d.
    Quality,
    /// Continuous, by the number of vertices alone: 2·log₂ d + β. Of leafy trees it shows more for less, see
    /// `viewer bench --only detail`.
    #[default]
    Simple,
    /// By error, but without morphing between levels.
    Discrete,
    /// Always the finest mesh.
    Off,
}

/// How the terrain gets its level of detail (thesis 3.2).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum TerrainScheme {
    /// Blocks of a quadtree that morph in the vertex shader.
    #[default]
    Morph,
    /// Triangles of a bintree, split by wedgies on the CPU, drawn as one strip.
    Roam,
    /// Every sample.
    Off,
}

/// What the person has chosen to see, and how.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Options {
    /// Levels of detail of trees.
    pub tree_scheme: TreeScheme,
    /// Levels of detail of the terrain.
    pub terrain_scheme: TerrainScheme,
    /// Error that trees may have on the screen, in pixels.
    pub tree_error_px: f32,
    /// Error that the terrain may have on the screen, in pixels.
    pub terrain_error_px: f32,
    /// Edges of triangles only.
    pub wireframe: bool,
    /// Colours say the level of detail.
    pub tint_levels: bool,
    /// The land from above, with what the walking camera's choice of detail drew (thesis figures 12 and 13).
    pub overhead: bool,
    /// Clouds move.
    pub drift_clouds: bool,
    /// Trees are drawn.
    pub draw_trees: bool,
    /// Grass is drawn near by.
    pub grass: bool,
    /// The land is drawn.
    pub draw_terrain: bool,
    /// Factor on the scene's own exposure.
    pub exposure: f32,
    /// Samples a pixel: 1 or 4.
    pub samples: u32,
    /// Vertical field of view in degrees.
    pub fov_y_deg: f32,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            tree_scheme: TreeScheme::default(),
            terrain_scheme: TerrainScheme::default(),
            tree_error_px: 1.5,
            terrain_error_px: 2.0,
            wireframe: false,
            tint_levels: false,
            overhead: false,
            drift_clouds: true,
            draw_trees: true,
            grass: true,
            draw_terrain: true,
            exposure: 1.0,
            samples: 1,
            fov_y_deg: 60.0,
        }
    }
}

/// What one frame is drawn from; the same for all views.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameInput {
    /// The person's wishes.
    pub options: Options,
    /// Seconds for which clouds have drifted and waves have run.
    pub time_s: f32,
}
