//! How long pictures take, as ratios within one run on whatever device is there: `viewer bench`. Milliseconds of wall
//! clock, and of processor time over all threads of the process, those of a device in software included.
//!
//! What is measured: the processor's work to record a picture with few and with many trees ([`record`]); pictures with
//! levels of detail against pictures without, and how far apart they are ([`detail`]; thesis section 7); the land's triangles and their
//! greatest error ([`land`]); four views
//! against four single ones ([`views`]); a walk's frames and what they are made of ([`walk`]); those around the
//! swap of a landscape ([`swap`]); the device's time by pass ([`passes`]); memory after many frames ([`memory`]); and, where
//! there is a graphics card, the slowest frames of four large forests ([`card`]). [`serve`] lets another program measure beside
//! its own pictures.

mod card;
mod detail;
mod land;
mod memory;
mod passes;
mod record;
mod report;
mod serve;
mod swap;
mod views;
mod walk;

use std::path::PathBuf;

use anyhow::{Result, anyhow};
use clap::{Args, ValueEnum};
use genescape_world::Source;

use crate::camera::Camera;
use crate::headless::{Headless, scene_files};
use crate::image_file::parse_size;
use crate::lod_mode::{TerrainLodMode, TreeLodMode};
use crate::measure::Cost;
use crate::options::{FrameInput, Options, folder};
use crate::passes::Shaders;
use crate::scene::Scene;
use crate::view::View;

use report::Report;

/// What `viewer bench` can be asked for.
#[derive(Clone, Debug, Args)]
pub struct BenchArgs {
    /// The world folder whose landscapes are drawn
    #[arg(long, value_name = "DIR", default_value = "world", conflicts_with = "scenes")]
    pub world: PathBuf,

    /// Scene files to draw instead
    #[arg(value_name = "SCENE.gltf")]
    pub scenes: Vec<PathBuf>,

    /// Size of a single picture; of four views, that of all together
    #[arg(long, value_name = "WxH", default_value = "800x600", value_parser = parse_size)]
    pub size: [u32; 2],

    /// Places of the camera on its way across the land; it goes there and back
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u32).range(2..=1000))]
    pub steps: u32,

    /// Measure only this; may be given several times
    #[arg(long, value_enum, value_name = "WHAT")]
    pub only: Vec<Measure>,

    /// Print one line of JSON instead of text
    #[arg(long)]
    pub json: bool,

    /// Read shaders from this folder; what is missing there is built in
    #[arg(long, value_name = "DIR", value_parser = folder())]
    pub shaders: Option<PathBuf>,

    /// Draw the first scene's pictures as asked for on standard input, one line each, and answer in JSON what they
    /// took: for programs that measure others beside ours
    #[arg(long, conflicts_with_all = ["only", "json"])]
    pub serve: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Measure {
    /// Recording a picture of 100 and of 100,000 trees
    Record,
    /// Pictures with levels of detail against pictures without, at 1,500 trees
    Detail,
    /// Triangles of the land and their greatest error, from 200 cameras
    Land,
    /// Four views against four single ones
    Views,
    /// Frames of a walk, and what each thing in the picture takes of them
    Walk,
    /// Frames around the swap of a landscape
    Swap,
    /// The device's time, pass by pass
    Passes,
    /// Memory after 100 and after 2,000 frames
    Memory,
    /// Four views of 10,000 trees each at 1920 × 1080, on a graphics card
    Card,
}

/// Measures, and prints what came out.
///
/// # Errors
/// If nothing can draw, a landscape cannot be read, or nothing is baked.
pub fn run(args: &BenchArgs) -> Result<()> {
    let source = match args.scenes.is_empty() {
        true => Source::of(&args.world)?,
        false => Source::Scenes(args.scenes.clone()),
    };
    let paths = scene_files(&source)?;
    let first = paths.first().ok_or_else(|| anyhow!("there is no landscape to draw"))?;
    let headless = Headless::open(&Shaders::from(args.shaders.clone()), 1)?;
    if args.serve {
        return serve::run(&headless, first, args);
    }
    let report = Report::begin(&headless.gpu, args.json);
    let mut bench = Bench { headless, paths, size_px: args.size, steps: args.steps, report };
    let measures = Measure::value_variants().iter();
    for measure in measures.filter(|measure| args.only.is_empty() || args.only.contains(measure)) {
        match measure {
            Measure::Record => record::measure(&mut bench)?,
            Measure::Detail => detail::measure(&mut bench)?,
            Measure::Land => land::measure(&mut bench)?,
            Measure::Views => views::measure(&mut bench)?,
            Measure::Walk => walk::measure(&mut bench)?,
            Measure::Swap => swap::measure(&mut bench)?,
            Measure::Passes => passes::measure(&mut bench)?,
            Measure::Memory => memory::measure(&mut bench)?,
            Measure::Card => card::measure(&mut bench)?,
        }
    }
    bench.report.end()
}

/// What measurements have in common.
struct Bench {
    headless: Headless,
    /// Scene files; at least one.
    paths: Vec<PathBuf>,
    size_px: [u32; 2],
    /// Places on the camera's path.
    steps: u32,
    report: Report,
}

impl Bench {
    fn first_scene(&self) -> Result<Scene> {
        self.headless.read(&self.paths[0])
    }

    /// A view of a landscape.
    fn view(&self, scene: &Scene, size_px: [u32; 2]) -> Result<View> {
        Ok(self.headless.view(self.headless.upload(scene)?, size_px))
    }

    /// Landscapes for four views of together `size_px`, from the first again if they are fewer.
    fn four_views(&self, size_px: [u32; 2], of: impl Fn(Scene) -> Scene) -> Result<Vec<View>> {
        let paths = self.paths.iter().cycle().take(4);
        let half_px = size_px.map(|side| (side / 2).max(1));
        let view = |(number, path): (usize, &PathBuf)| {
            let scene = self.headless.upload(&of(self.headless.read(path)?))?;
            Ok(self.headless.view_of_four(number, scene, half_px))
        };
        paths.enumerate().map(view).collect()
    }

    /// What one picture of each view takes, waited for.
    fn frame(&self, views: &mut [View], frame: &FrameInput, camera: &Camera) -> Cost {
        Cost::of_frame(&self.headless, views, frame, camera)
    }
}

/// What a frame is drawn from with these LOD modes.
fn frame_with(tree_lod: TreeLodMode, terrain_lod: TerrainLodMode) -> FrameInput {
    FrameInput { options: Options { tree_lod, terrain_lod, ..Options::default() }, ..FrameInput::default() }
}
