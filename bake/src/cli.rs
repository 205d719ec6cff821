//! The command line: words → one [`Command`] for each thing that can be asked for.

use std::path::PathBuf;

use bytesize::ByteSize;
use clap::{Args, Parser, Subcommand};

const EXAMPLES: &str = "\
Examples:
  bake                                   bake the newest population of ./world (made from the starters if absent)
  bake world/population/g0003.ron        bake this population
  bake --watch                           bake whenever a population file is saved, breed whenever one is voted on
  bake random --seed 7                   make a population of four random genomes, and bake it
  bake next                              breed the next population from the votes, and bake it
  bake export 2 alps.glb                 one self-contained file of scene 2, to send along
  bake lod bunny.obj bunny.glb           progressive mesh and distinguished meshes of any model
  bake explain 0                         why each stage of scene 0 was or was not rebuilt

Exit codes: 0 done, 1 failed, 2 wrong usage or bad input, 130 interrupted (Ctrl-C; what was finished is kept).";

/// Input that the person must correct, as against a failure of the program: exit code 2.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct BadInput(pub String);

/// Bakes landscapes from genomes: glTF, PNG and EXR files that open in Blender and in any glTF viewer.
#[derive(Debug, Parser)]
#[command(name = "bake", version, after_help = EXAMPLES, args_conflicts_with_subcommands = true)]
pub struct Cli {
    /// What to do other than bake a population.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Bake options.
    #[command(flatten)]
    pub bake: BakeArgs,
}

/// Where the person's work lives.
#[derive(Debug, Clone, Args)]
pub struct WorldArgs {
    /// Folder that holds populations and everything baked; made from the starter landscapes if absent.
    #[arg(long, value_name = "DIR", default_value = "world")]
    pub world: PathBuf,
}

/// How to bake.
#[derive(Debug, Clone, Args)]
pub struct RunArgs {
    /// The world folder.
    #[command(flatten)]
    pub world: WorldArgs,
    /// Threads to compute on [default: one a core]. The result does not depend on it.
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    /// Samples a side of the heightfield: 65, 129, 257, 513, 1025 or 2049.
    #[arg(long, value_name = "N", default_value_t = 513)]
    pub size: u32,
    /// Print events as JSON, one a line, instead of a progress bar.
    #[arg(long)]
    pub json: bool,
}

/// `bake` without a subcommand.
#[derive(Debug, Clone, Args)]
pub struct BakeArgs {
    /// The population file [default: the world's newest].
    #[arg(value_name = "POPULATION.ron")]
    pub population: Option<PathBuf>,
    /// How to bake.
    #[command(flatten)]
    pub run: RunArgs,
    /// Stay, and bake again whenever a population file or space.ron changes, even in the midst of a bake.
    ///
    /// Votes written into any of the world's population files are answered with a new generation bred from them, as
    /// `bake next` would, unless there is one already.
    #[arg(long)]
    pub watch: bool,
    /// With --watch: look every half second, for network folders that send no events.
    #[arg(long, requires = "watch")]
    pub poll: bool,
}

/// Everything else.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Make a population of four random genomes and bake it.
    #[command(after_help = "Example:\n  bake random --seed 7 --world /tmp/seven")]
    Random {
        /// The same seed makes the same population.
        #[arg(long, value_name = "N")]
        seed: u64,
        /// How to bake.
        #[command(flatten)]
        run: RunArgs,
    },
    /// Breed the next population from votes and bake it.
    Next {
        /// The generation that was voted on [default: the newest]. The child gets the next free number.
        #[arg(long, value_name = "N")]
        from: Option<u32>,
        /// How to bake.
        #[command(flatten)]
        run: RunArgs,
    },
    /// Print the parameter space as a table.
    Params {
        /// Markdown instead of aligned text.
        #[arg(long)]
        markdown: bool,
        /// The world folder, for its own space.ron.
        #[command(flatten)]
        world: WorldArgs,
    },
    /// Say for each stage whether it was reused and, if not, which field of its key changed.
    Explain {
        /// Scene 0 to 3 [default: all].
        scene: Option<usize>,
        /// The world folder.
        #[command(flatten)]
        world: WorldArgs,
    },
    /// Write a scene as one self-contained file.
    #[command(
        after_help = "Examples:\n  bake export 0 valley.glb\n  bake export world/baked/g0002/scene-1/scene.gltf alps.glb"
    )]
    Export {
        /// Scene 0 to 3 of the current generation, or the path of a scene.gltf.
        scene: String,
        /// The file to write.
        #[arg(value_name = "FILE.glb")]
        out: PathBuf,
        /// The world folder.
        #[command(flatten)]
        world: WorldArgs,
    },
    /// Make a progressive mesh with distinguished meshes and geomorphs of any glTF or OBJ file.
    #[command(
        after_help = "Example:\n  bake lod stanford-bunny.obj bunny.glb\n\nRepairs that the input needed are said, line by line."
    )]
    Lod {
        /// A .glb, .gltf or .obj file.
        #[arg(value_name = "IN")]
        input: PathBuf,
        /// The .glb file to write.
        #[arg(value_name = "OUT")]
        out: PathBuf,
        /// Where faces meet at more than this angle and the file brings no normals, a crease is made.
        #[arg(long, value_name = "DEG", default_value_t = 60.0)]
        crease_deg: f32,
    },
    /// Look after the cache.
    Cache {
        /// What to do with it.
        #[command(subcommand)]
        action: CacheCommand,
    },
    /// Time every stage on the four starters, in the manner of the thesis's tables 1 and 2.
    Bench {
        /// Times the whole is repeated.
        #[arg(long, default_value_t = 3)]
        runs: u32,
        /// Threads to compute on [default: one a core].
        #[arg(long, value_name = "N")]
        threads: Option<usize>,
        /// Samples a side of the heightfield.
        #[arg(long, value_name = "N", default_value_t = 513)]
        size: u32,
    },
}

/// `bake cache …`
#[derive(Debug, Subcommand)]
pub enum CacheCommand {
    /// Blobs, bytes and what each stage's results cost to make.
    Stats {
        /// The world folder.
        #[command(flatten)]
        world: WorldArgs,
    },
    /// Read everything, check every digest, and set damaged blobs aside so that the next bake makes them anew.
    Verify {
        /// The world folder.
        #[command(flatten)]
        world: WorldArgs,
    },
    /// Remove what was used least recently, never what the current scenes use nor what was used in the last ten minutes.
    ///
    /// A scene of an older generation that loses parts goes with them; baking its population brings it back.
    Gc {
        /// Size to shrink to, for example 500MB or 2GiB.
        #[arg(long, value_name = "SIZE")]
        max_size: ByteSize,
        /// The world folder.
        #[command(flatten)]
        world: WorldArgs,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn sizes() {
        let size = |text: &str| text.parse().map(|ByteSize(bytes)| bytes);
        assert_eq!(size("500MB"), Ok(500_000_000));
        assert_eq!(size("1.5 GiB"), Ok(3 << 29));
        assert_eq!(size("12"), Ok(12));
        assert!(size("12 parsecs").is_err());
        assert!(size("-1MB").is_err());
    }
}
