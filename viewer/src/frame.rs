//! What one frame is drawn from, for all views alike: time, choices of the person.

use serde::{Deserialize, Serialize};

use crate::lod_mode::{TerrainLodMode, TreeLodMode};

/// What the person has chosen to see, and how.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Options {
    /// Levels of detail of trees; by its older name in files.
    #[serde(rename = "tree_scheme")]
    pub tree_lod: TreeLodMode,
    /// Levels of detail of the terrain; by its older name in files.
    #[serde(rename = "terrain_scheme")]
    pub terrain_lod: TerrainLodMode,
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

/// Name, help, and the part of [`Options`] that is on or off: a line of the settings panel.
pub type Switch = (&'static str, &'static str, fn(&mut Options) -> &mut bool);

/// What makes levels of detail visible.
pub const LOD_SWITCHES: [Switch; 3] = [
    ("Colour by level", "Colours say the level of detail", |options| &mut options.tint_levels),
    ("Wireframe", "Edges of triangles only", |options| &mut options.wireframe),
    ("From above", "The land from above, with the detail chosen for your place", |options| {
        &mut options.overhead
    }),
];

const GRASS_HELP: &str = "Blades around you; a tenth to a quarter of the time where the processor draws";

/// What is in the picture.
pub const PICTURE_SWITCHES: [Switch; 4] = [
    ("Trees", "", |options| &mut options.draw_trees),
    ("Terrain", "", |options| &mut options.draw_terrain),
    ("Grass", GRASS_HELP, |options| &mut options.grass),
    ("Clouds drift", "", |options| &mut options.drift_clouds),
];

impl Default for Options {
    fn default() -> Self {
        Self {
            tree_lod: TreeLodMode::default(),
            terrain_lod: TerrainLodMode::default(),
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
