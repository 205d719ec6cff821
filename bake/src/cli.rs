//! The command line: words → one [`Command`] for each thing that can be asked for.

use std::path::PathBuf;

use bytesize::ByteSize;
use clap::{Args, CommandFactory, Parser, Subcommand};

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
#[command(name = "bake", version, after_help = EXAMPLES)]
pub struct Cli {
    /// What to do other than bake a population.
    #[command(subcommand)]
    pub command: Option<Command>,
    #[command(flatten)]
    pub run: RunArgs,
    /// The population file [default: the world's newest].
    #[arg(value_name = "POPULATION.ron")]
    pub population: Option<PathBuf>,
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

/// Where and how to bake: options of all commands.
#[derive(Debug, Clone, Args)]
pub struct RunArgs {
    /// Folder that holds populations and everything baked; made from the starter landscapes if absent.
    #[arg(long, value_name = "DIR", default_value = "world", global = true)]
    pub world: PathBuf,
    /// Threads to compute on [default: one a core]. The result does not depend on it.
    #[arg(long, value_name = "N", global = true, value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Samples a side of the heightfield: 65, 129, 257, 513, 1025 or 2049.
    #[arg(long, value_name = "N", default_value_t = 513, global = true, allow_negative_numbers = true)]
    pub size: u32,
    /// Print events as JSON, one a line, instead of a progress bar.
    #[arg(long, global = true)]
    pub json: bool,
}

/// Everything else.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Make a population of four random genomes and bake it.
    #[command(after_help = "Example:\n  bake random --seed 7 --world /tmp/seven")]
    Random {
        /// The same seed makes the same population [default: drawn by chance, and told].
        #[arg(long, value_name = "N", allow_negative_numbers = true)]
        seed: Option<u64>,
    },
    /// Breed the next population from votes and bake it.
    Next {
        /// The generation that was voted on [default: the newest]. The child gets the next free number.
        #[arg(long, value_name = "N")]
        from: Option<u32>,
    },
    /// Print the parameter space as a table: the world's own, if there is a world.
    Params {
        /// Markdown instead of aligned text.
        #[arg(long)]
        markdown: bool,
    },
    /// Say for each stage whether it was reused and, if not, which field of its key changed.
    Explain {
        /// Scene 0 to 3 [default: all].
        scene: Option<usize>,
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
    },
    /// Make a progressive mesh with distinguished meshes and geomorphs of any glTF or OBJ file.
    #[command(
        after_help = "Example:\n  bake lod stanford-bunny.obj bunny.glb\n\nRepairs that the input needed are listed, line by line."
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
        #[command(subcommand)]
        action: CacheCommand,
    },
    /// Time every stage on the four starters, in the manner of the thesis's tables 1 and 2.
    Bench {
        /// Times the whole is repeated.
        #[arg(long, default_value_t = 3)]
        runs: u32,
    },
}

/// `bake cache …`
#[derive(Debug, Subcommand)]
pub enum CacheCommand {
    /// Blobs, bytes and what each stage's results cost to make.
    Stats,
    /// Read everything, check every digest, and remove what is damaged, so that the next bake makes it anew.
    ///
    /// A bake by itself reads again only what was written to since it was last verified. Bytes that a failing disk
    /// changed, without a new time, are found here. Files that are none of ours are listed and left alone.
    Verify,
    /// Remove what was used least recently, never what the current scenes name or were made from.
    ///
    /// Waits while a bake of this world is running, for what that counts on stays, too. A scene of an older generation that
    /// loses parts goes with them; baking its population brings it back.
    Gc {
        /// Size to shrink to, for example 500MB or 2GiB.
        #[arg(long, value_name = "SIZE")]
        max_size: ByteSize,
    },
}

/// A number of threads: more than any machine's cores would only keep it from other work.
pub fn threads(text: &str) -> Result<usize, String> {
    const MAX_THREADS: usize = 1024;
    let threads = text.parse().ok().filter(|threads| (1..=MAX_THREADS).contains(threads));
    threads.ok_or_else(|| format!("a whole number from 1 to {MAX_THREADS}"))
}

/// The command that a word which is no population file was meant to be, if one is near.
pub fn meant_command(word: &str) -> Option<String> {
    let cli = Cli::command();
    let near = cli.get_subcommands().map(|command| (strsim::osa_distance(word, command.get_name()), command));
    let (distance, command) = near.min_by_key(|(distance, _)| *distance)?;
    (distance <= 2).then(|| command.get_name().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn options_stand_before_or_behind_the_command() {
        for words in
            [["--world", "here", "--threads", "2", "next"], ["next", "--world", "here", "--threads", "2"]]
        {
            let cli = Cli::try_parse_from([&["bake"], &words[..]].concat()).expect("valid");
            assert!(matches!(cli.command, Some(Command::Next { from: None })), "{cli:?}");
            assert_eq!((cli.run.world, cli.run.threads), ("here".into(), Some(2)));
        }
    }

    #[test]
    fn a_misspelt_command_is_recognised() {
        for (word, meant) in [("nxt", Some("next")), ("exprot", Some("export")), ("world/g0000.ron", None)] {
            assert_eq!(meant_command(word).as_deref(), meant);
        }
    }

    #[test]
    fn numbers_out_of_range_are_refused_in_words() {
        for words in [["--threads", "1000000"], ["--threads", "0"], ["--threads", "-5"], ["--size", "-5"]] {
            let told =
                Cli::try_parse_from([&["bake"], &words[..]].concat()).expect_err("refused").to_string();
            assert!(told.contains(&format!("invalid value '{}'", words[1])), "{told}");
            assert!(!told.contains("-- -5"), "{told}");
        }
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
