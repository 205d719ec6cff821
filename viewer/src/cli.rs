//! What can be asked for on the command line.

use std::path::PathBuf;

use clap::{Parser, Subcommand};
use clap_complete::Shell;

use crate::baker::BakerOptions;
use crate::image_file::parse_size;
use crate::options::{Options, folder, number};

/// Shows four landscapes at once: walk through all of them, say which has the best trees, terrain and sky, and breed
/// four new ones. Shows any glTF file, too, alone
#[derive(Clone, Debug, Parser)]
#[command(name = "viewer", version, after_help = EXAMPLES, args_conflicts_with_subcommands = true)]
pub struct Cli {
    /// A world, a baked folder, or any .glb or .gltf file [default: the world in ./world, made if absent]
    pub path: Option<PathBuf>,

    /// The world folder: populations and everything baked
    #[arg(long, value_name = "DIR", default_value = "world", conflicts_with = "path")]
    pub world: PathBuf,

    /// Do not bake: another program does, `bake --watch` for instance
    #[arg(long)]
    pub no_bake: bool,

    #[command(flatten)]
    pub bake: BakerOptions,

    /// Keep settings in this file instead of the platform's folder for settings
    #[arg(long, value_name = "FILE")]
    pub settings: Option<PathBuf>,

    /// Read shaders from this folder, and again whenever one is saved; what is missing there is built in
    #[arg(long, value_name = "DIR", value_parser = folder())]
    pub shaders: Option<PathBuf>,

    /// Folder for screenshots
    #[arg(long, value_name = "DIR", default_value = "pictures")]
    pub pictures: PathBuf,

    /// Write what happens in the window to this file, a JSON object a line
    #[arg(long, value_name = "FILE")]
    pub log: Option<PathBuf>,

    /// Open the window for one walk of a study: drawn as the drawing options say, answers go into this file, and then it
    /// closes; what tells levels of detail is hidden
    #[arg(long, value_name = "FILE.ron", conflicts_with = "screenshot")]
    pub answers: Option<PathBuf>,

    /// Draw to a PNG file instead of a window
    #[arg(long, value_name = "OUT.png")]
    pub screenshot: Option<PathBuf>,

    /// Size of the window or the picture
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<[u32; 2]>,

    /// With --screenshot: which landscape, 1 to 4
    #[arg(long, value_name = "N", conflicts_with = "all", value_parser = clap::value_parser!(u8).range(1..=4))]
    pub landscape: Option<u8>,

    /// With --screenshot: all landscapes in one picture, two by two
    #[arg(long)]
    pub all: bool,

    /// With --screenshot: where the eye is. X and Z in metres east and south of the middle (of a file's bounds, if it is
    /// no landscape), HEIGHT above the ground and never under water, YAW to the left of north and PITCH upwards in
    /// degrees [default: where walks start]
    #[arg(long, value_name = "X,Z,HEIGHT,YAW,PITCH", value_parser = place, allow_hyphen_values = true)]
    pub camera: Option<Place>,

    /// With --screenshot: seconds for which clouds have drifted
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0, value_parser = seconds)]
    pub time: f32,

    #[command(flatten)]
    pub drawing: Options,

    #[command(subcommand)]
    pub command: Option<Command>,
}

#[derive(Clone, Debug, Subcommand)]
pub enum Command {
    /// Measure how long pictures take, as ratios of one run
    Bench(crate::bench::BenchArgs),
    /// Repeat the thesis's experiments on this renderer, and write a report
    Lab(crate::lab::LabArgs),
    /// Lead a participant of a study through walks in balanced order, with questions after each
    Study(crate::study::StudyArgs),
    /// Print what makes a shell complete this command line
    Completions {
        /// The shell
        shell: Shell,
    },
    /// Print the man page, or write one for each command
    Man {
        /// Write viewer.1, viewer-bench.1 and so on here
        #[arg(value_name = "DIR")]
        folder: Option<PathBuf>,
    },
}

const EXAMPLES: &str = "Examples:
  viewer                             the landscapes of ./world
  viewer --world alps                those of another world
  viewer world/baked/g0003           an older generation as it was baked
  viewer tree.glb                    any glTF file, alone
  viewer --screenshot all.png --all  all four to a file, without a window
  viewer --screenshot a.png --landscape 2 --camera 0,20,1.6,45,-5";

/// Where an eye is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Metres east of the middle.
    pub x_m: f32,
    /// Metres south of the middle.
    pub z_m: f32,
    /// Metres above the ground.
    pub height_m: f32,
    /// Degrees to the left of north.
    pub yaw_deg: f32,
    /// Degrees upwards.
    pub pitch_deg: f32,
}

fn seconds(text: &str) -> Result<f32, String> {
    number(text, 0.0..=1e6, "seconds")
}

fn place(text: &str) -> Result<Place, String> {
    // Beyond it even the farthest land is less than a pixel.
    const FAR: f32 = 1e6;
    let number = |part: &str| part.trim().parse().ok().filter(|number: &f32| number.abs() <= FAR);
    let numbers: Option<Vec<f32>> = text.split(',').map(number).collect();
    match numbers.as_deref() {
        Some(&[x_m, z_m, height_m, yaw_deg, pitch_deg]) => {
            Ok(Place { x_m, z_m, height_m, yaw_deg, pitch_deg })
        }
        _ => Err("five numbers are needed: X,Z,HEIGHT,YAW,PITCH, as in 0,20,1.6,45,-5".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lod_mode::{TerrainLodMode, TreeLodMode};
    use clap::CommandFactory;

    #[test]
    fn the_command_line_holds_together() {
        Cli::command().debug_assert();
    }

    #[test]
    fn drawing_is_by_default_as_in_the_window_but_with_smooth_edges() {
        let options = |args: &[&str]| Cli::parse_from([&["viewer"], args].concat()).drawing;
        assert_eq!(options(&[]), Options { samples: 4, ..Options::default() });
        let args =
            ["--no-grass", "--tree-lod", "off", "--terrain-lod", "roam", "--tint", "--tree-error", "3"];
        let expected = Options {
            grass: false,
            tree_lod: TreeLodMode::Off,
            terrain_lod: TerrainLodMode::Roam,
            tint_levels: true,
            tree_error_px: 3.0,
            samples: 4,
            ..Options::default()
        };
        assert_eq!(options(&args), expected);
        assert!(Cli::try_parse_from(["viewer", "--samples", "2"]).is_err());
    }

    #[test]
    fn numbers_that_nothing_can_be_drawn_with_are_refused() {
        for option in ["--fov", "--exposure", "--time", "--tree-error", "--terrain-error"] {
            for wrong in ["nan", "inf", "-inf", "-1", "1e9", "x"] {
                let told = Cli::try_parse_from(["viewer", &format!("{option}={wrong}")]).expect_err(wrong);
                assert!(told.to_string().contains("a number from"), "{told}");
            }
            Cli::try_parse_from(["viewer", option, "60"]).expect("a number");
        }
        for threads in ["0", "1000000", "-3"] {
            Cli::try_parse_from(["viewer", &format!("--threads={threads}")]).expect_err(threads);
        }
    }

    #[test]
    fn places_are_read_or_refused_with_an_example() {
        let read = place("0,20,1.6,45,-5").expect("five numbers");
        assert_eq!(read, Place { x_m: 0.0, z_m: 20.0, height_m: 1.6, yaw_deg: 45.0, pitch_deg: -5.0 });
        for wrong in ["", "1,2,3,4", "1,2,3,4,5,6", "1,2,x,4,5", "1,2,nan,4,5", "1e30,2,3,4,5", "1,2,,4,5"] {
            assert!(place(wrong).is_err_and(|text| text.contains("0,20,1.6,45,-5")), "{wrong}");
        }
    }
}
