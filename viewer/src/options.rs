//! What one frame is drawn from, for all views alike: time, choices of the person.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::ArgAction;
use clap::builder::{PathBufValueParser, TypedValueParser};
use genescape_schema::scene::START_FOV_Y_DEG;
use serde::{Deserialize, Serialize};

use crate::lod_mode::{TerrainLodMode, TreeLodMode};

/// The usual error of [`Options::mesh_error_px`].
pub const MESH_ERROR_PX: f32 = 0.5;

/// What is drawn, and how: chosen in the settings panel, or on the command line, whose help these comments are.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, clap::Args)]
#[serde(default)]
#[command(next_help_heading = "Drawing (with --screenshot)")]
pub struct Options {
    /// Levels of detail of trees
    #[serde(rename = "tree_scheme")]
    #[arg(long, value_enum, default_value_t)]
    pub tree_lod: TreeLodMode,
    /// Levels of detail of a file that is no landscape
    // By error: what stands alone is looked at from near, and no forest has tuned its numbers.
    #[arg(long, value_enum, default_value_t = Self::default().mesh_lod)]
    pub mesh_lod: TreeLodMode,
    /// Levels of detail of the terrain
    #[serde(rename = "terrain_scheme")]
    #[arg(long, value_enum, default_value_t)]
    pub terrain_lod: TerrainLodMode,
    /// Error that trees may have on the screen, in pixels; large ones may have less
    #[arg(long = "tree-error", value_name = "PIXELS", default_value_t = Self::default().tree_error_px, value_parser = pixels)]
    pub tree_error_px: f32,
    /// Error that a file that is no landscape may have on the screen, in pixels
    #[arg(long = "mesh-error", value_name = "PIXELS", default_value_t = Self::default().mesh_error_px, value_parser = pixels)]
    pub mesh_error_px: f32,
    /// Error that the terrain may have on the screen, in pixels
    #[arg(long = "terrain-error", value_name = "PIXELS", default_value_t = Self::default().terrain_error_px, value_parser = pixels)]
    pub terrain_error_px: f32,
    /// Triangles that the terrain may have in a picture: where they don't suffice, its error is larger
    // Thesis 3.2.4. By distance alone and without levels of detail they are what they are.
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1000..))]
    pub terrain_triangles: Option<u32>,
    /// Edges of triangles only
    #[arg(long)]
    pub wireframe: bool,
    /// Colours that say the level of detail
    #[arg(long = "tint")]
    pub tint_levels: bool,
    /// From above, with what was chosen for the eye
    // Thesis, figures 12 and 13.
    #[arg(long)]
    pub overhead: bool,
    /// Sides of pictures while the camera moves, as a part of full resolution; `None` follows the frame time
    #[arg(skip)]
    pub moving_resolution: Option<f32>,
    /// One picture, not the mean of several with their pixels' middles a little beside
    #[arg(long = "no-refine", action = ArgAction::SetFalse)]
    pub refine: bool,
    /// Clouds move
    #[arg(skip = true)]
    pub drift_clouds: bool,
    #[arg(skip = true)]
    pub draw_trees: bool,
    /// No blades of grass around the eye
    #[arg(long = "no-grass", action = ArgAction::SetFalse)]
    pub grass: bool,
    /// No land; under a file that is no landscape, no grid
    #[arg(long = "no-ground", action = ArgAction::SetFalse)]
    pub draw_terrain: bool,
    /// Trees and land out of sight are drawn, too, as measurements of popping need it
    // Thesis section 7.
    #[arg(long = "no-culling", action = ArgAction::SetFalse)]
    pub cull: bool,
    /// Bark as triangle strips, not lists: the same pictures
    // Thesis section 4.4.1; `viewer lab` measures which pays.
    #[arg(long)]
    pub bark_strips: bool,
    /// Factor on the landscape's own exposure
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = factor)]
    pub exposure: f32,
    /// Samples a pixel
    #[arg(long, default_value_t = 4, value_parser = parse_samples)]
    pub samples: u32,
    /// Vertical field of view in degrees
    #[arg(long = "fov", value_name = "DEGREES", default_value_t = Self::default().fov_y_deg, value_parser = degrees)]
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

const REFINE_HELP: &str = "While nothing moves, edges and fine twigs become smooth";

/// What is in the picture.
pub const PICTURE_SWITCHES: [Switch; 5] = [
    ("Trees", "", |options| &mut options.draw_trees),
    ("Terrain", "", |options| &mut options.draw_terrain),
    ("Grass", GRASS_HELP, |options| &mut options.grass),
    ("Clouds drift", "", |options| &mut options.drift_clouds),
    ("Refine at rest", REFINE_HELP, |options| &mut options.refine),
];

/// The same of a file that is no landscape.
pub const FILE_SWITCHES: [Switch; 1] =
    [("Grid on the ground", "Its squares say how large things are", |options| &mut options.draw_terrain)];

fn pixels(text: &str) -> Result<f32, String> {
    number(text, 0.0..=1e4, "pixels")
}

fn factor(text: &str) -> Result<f32, String> {
    number(text, 0.0..=1e6, "times")
}

fn degrees(text: &str) -> Result<f32, String> {
    number(text, 1.0..=170.0, "degrees")
}

/// A number in a range that the command line takes.
pub(crate) fn number(text: &str, range: RangeInclusive<f32>, unit: &str) -> Result<f32, String> {
    let number = text.parse().ok().filter(|number| range.contains(number));
    number.ok_or_else(|| format!("a number from {} to {} {unit}", range.start(), range.end()))
}

/// A folder that must be there.
pub(crate) fn folder() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new()
        .try_map(|path| if path.is_dir() { Ok(path) } else { Err("there is no such folder") })
}

fn parse_samples(text: &str) -> Result<u32, String> {
    let samples = text.parse().ok().filter(|samples| [1, 4].contains(samples));
    samples.ok_or_else(|| "1 or 4 samples a pixel".to_owned())
}

impl Default for Options {
    fn default() -> Self {
        Self {
            tree_lod: TreeLodMode::default(),
            mesh_lod: TreeLodMode::Quality,
            terrain_lod: TerrainLodMode::default(),
            tree_error_px: 2.3,
            mesh_error_px: MESH_ERROR_PX,
            terrain_error_px: 2.0,
            terrain_triangles: None,
            wireframe: false,
            bark_strips: false,
            tint_levels: false,
            overhead: false,
            moving_resolution: None,
            refine: true,
            drift_clouds: true,
            draw_trees: true,
            grass: true,
            draw_terrain: true,
            cull: true,
            exposure: 1.0,
            samples: 1,
            fov_y_deg: START_FOV_Y_DEG,
        }
    }
}

impl Options {
    /// Whether blades of grass and small plants are drawn: in pictures that explain levels of detail they would only hide them.
    pub fn draws_grass(&self) -> bool {
        self.grass && !self.wireframe && !self.tint_levels && !self.overhead
    }
}

/// What one frame is drawn from; the same for all views.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameInput {
    pub options: Options,
    /// Seconds for which clouds have drifted and waves have run.
    pub time_s: f32,
    /// Sides of the picture as a part of full resolution, (0, 1]: less of what its pixels do not show is drawn, too.
    pub part: f32,
    /// How many pictures of the same have been drawn before: the mean of them and this one is shown.
    pub accumulated: u32,
}

impl Default for FrameInput {
    fn default() -> Self {
        Self { options: Options::default(), time_s: 0.0, part: 1.0, accumulated: 0 }
    }
}
