//! The command line: words → one [`Command`] for each thing that can be asked for.

use std::path::PathBuf;

use bytesize::ByteSize;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, CommandFactory, Parser, Subcommand};
use clap_complete::Shell;
use genescape_schema::{Strategy, Variety};

use crate::bad_input::BadInput;
use crate::chosen_parents::ChosenParents;
use crate::export::{Audience, Options};
use crate::landscape::{Landscape, Reference, SceneArg};
use crate::plan::Resolution;
use crate::stages::lod::Placement;

const EXAMPLES: &str = "\
Examples:
  bake                             the newest population of ./world
  bake world/population/g0003.ron  this population
  bake --watch                     whatever is saved; breeds from votes
  bake random --seed 7             four random landscapes
  bake random --kind birch         four, all with birches
  bake next                        the generation bred from the votes
  bake export 2 alps/              landscape 2, its sky and its trees
  bake export 2 alps.glb           landscape 2 as one file
  bake lod bunny.obj bunny.glb     levels of detail of any model
  bake explain 1                   why landscape 1 was rebuilt

Landscapes are counted 1 to 4; their folders are scene-0 to scene-3.

Exit codes: 0 done, 1 failed, 2 wrong usage or bad input, 130
interrupted (Ctrl-C; what was finished is kept).";

const KINDS_EXAMPLES: &str = "\
Examples:
  bake kinds                      all, and what is wrong with your own
  bake kinds show fjord           the file of one
  bake kinds copy fjord my_fjord  world/kinds/terrain/my_fjord.ron
  bake random --kind my_fjord     four landscapes by that fjord";

const EXPORT_EXAMPLES: &str = "\
Examples:
  bake export 1 valley/                a landscape, its sky, its trees
  bake export 1 valley/ --for blender  and a script for Blender
  bake export 1 valley.glb             one self-contained file
  bake export world/baked/g0002/scene-1/scene.gltf alps.glb";

const COMPLETIONS_EXAMPLE: &str = "\
Example:
  bake completions fish > ~/.config/fish/completions/bake.fish";

const MAN_EXAMPLES: &str = "\
Examples:
  bake man | man -l -
  bake man ~/.local/share/man/man1  from then on: man bake-export";

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
    /// With --watch: look several times a second, for network folders that send no events.
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
    #[arg(long, value_name = "N", default_value_t, global = true, allow_negative_numbers = true)]
    pub size: Resolution,
    /// Print events as JSON, one a line, instead of a progress bar: of bakes and exports.
    #[arg(long, global = true)]
    pub json: bool,
}

/// Everything else.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Make a population of four random landscapes and bake it: lands of some kind, with trees and skies that go with them.
    #[command(
        after_help = "Examples:\n  bake random --seed 7 --world /tmp/seven\n  bake random --kind birch --kind fjord"
    )]
    Random {
        /// The same seed makes the same population [default: drawn by chance, and told].
        #[arg(long, value_name = "N", allow_negative_numbers = true)]
        seed: Option<u64>,
        /// Draw only this kind, as `oak` or `fjord`. Of several, lands are drawn in turn, or else trees, or else skies. `bake kinds`
        /// lists them.
        #[arg(long = "kind", value_name = "KIND", conflicts_with = "uniform")]
        kinds: Vec<String>,
        /// Every value of every gene equally likely, as in the thesis, instead of kinds.
        #[arg(long)]
        uniform: bool,
    },
    /// List the kinds of trees, lands and skies that landscapes are drawn and bred from.
    ///
    /// Those of your own are files in the world's folder: kinds/tree/NAME.ron, kinds/terrain and kinds/sky. A file with the
    /// name of a kind that ships takes its place. One that is wrong is told here, with its line, and left out.
    #[command(after_help = KINDS_EXAMPLES)]
    Kinds {
        #[command(subcommand)]
        action: Option<KindsCommand>,
    },
    /// Breed the next population from votes and bake it.
    Next {
        /// The generation that was voted on [default: the newest]. The child gets the next free number; for votes that
        /// were answered before, it is another child.
        #[arg(long, value_name = "N")]
        from: Option<u32>,
        /// How it is found.
        #[arg(long, value_parser = strategies(), default_value_t)]
        strategy: Strategy,
        /// How different the others are from the best guess: 0 close variations, 1 anything [default: what the generation's
        /// file says, else 0.5].
        #[arg(long, value_name = "0..1", allow_negative_numbers = true)]
        variety: Option<Variety>,
    },
    /// Breed from parents of your choice instead of votes, and bake the children.
    ///
    /// A parent is a landscape of the current generation, as 3, of another one, as 2.3, or of a population file, as
    /// old.ron:3; or a kind, as oak, of which a member is drawn. What is not named comes from the current generation: its
    /// favourite or, without votes, landscape 1. The first child has these very parts.
    #[command(
        after_help = "Examples:\n  bake breed --tree 2.3 --sky 4\n  bake breed --terrain fjord --variety 0.2\n  bake breed --tree old.ron:1"
    )]
    Breed(ChosenParents),
    /// Write the world's family tree as a page to look at in any browser, and to show others.
    ///
    /// It is one file with everything in it: every generation with its four landscapes, who was chosen, and what came of it.
    /// An earlier page is replaced; any other file in the way is left alone.
    #[command(after_help = "Examples:\n  bake lineage\n  bake lineage family.html")]
    Lineage {
        /// The file to write [default: lineage.html in the world's folder].
        #[arg(value_name = "OUT.html")]
        out: Option<PathBuf>,
    },
    /// Say how different two landscapes look: their trees, their land, their sky, and in what most.
    ///
    /// What is compared is not genes but what is seen: heights, shapes, colours, light, as they would be baked.
    #[command(
        after_help = "Examples:\n  bake distance 1 2\n  bake distance 1 0.3\n  bake distance 2.4 old.ron:1"
    )]
    Distance {
        /// A landscape of the current generation, as 3, of another one, as 2.3, or of a population file, as old.ron:3.
        #[arg(value_name = "LANDSCAPE", allow_negative_numbers = true)]
        one: Reference,
        /// Likewise.
        #[arg(value_name = "LANDSCAPE", allow_negative_numbers = true)]
        other: Reference,
    },
    /// Print the parameter space as a table: the world's own, if there is a world.
    Params {
        /// Markdown instead of aligned text.
        #[arg(long)]
        markdown: bool,
    },
    /// Say for each stage whether it was reused and, if not, which field of its key changed.
    Explain {
        /// Landscape 1 to 4 [default: all].
        #[arg(value_name = "LANDSCAPE", allow_negative_numbers = true)]
        landscape: Option<Landscape>,
    },
    /// Write a landscape for other programs: with its sky and trees into a folder, or as one file.
    ///
    /// A folder gets NAME.glb, the sky as NAME-sky.exr (linear, equirectangular) and NAME-sky.jpg (to look at), and
    /// trees/KIND-1.glb and so on, each with all its levels of detail. Files of an earlier export are replaced; any
    /// other file in the way is left alone and named.
    #[command(after_help = EXPORT_EXAMPLES)]
    Export {
        /// Landscape 1 to 4 of the current generation, or the path of a scene.gltf.
        #[arg(value_name = "LANDSCAPE", allow_negative_numbers = true)]
        scene: SceneArg,
        /// A folder, or a file to write.
        #[arg(value_name = "DIR|FILE.glb")]
        out: PathBuf,
        #[command(flatten)]
        options: ExportArgs,
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
        /// Where the new vertex of a collapsed edge goes.
        #[arg(long, value_name = "WHERE", value_enum, default_value_t)]
        placement: Placement,
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
        /// How near breeding brings simulated persons to what they want, instead.
        #[arg(long)]
        breeding: bool,
        /// How many persons.
        #[arg(long, value_name = "N", default_value_t = 200, requires = "breeding")]
        persons: u64,
        /// Only rows whose name has these words, as "real space" or "16 genes, separable, 0.02, learned".
        #[arg(long, value_name = "WORDS", requires = "breeding")]
        only: Option<String>,
        /// What part of a bake the cache has already from one bred generation to the next, instead.
        #[arg(long, conflicts_with = "breeding")]
        reuse: bool,
        /// How much each gene is seen in members of each kind, as JSON for `phenotype/visibility.json`, instead; takes minutes.
        #[arg(long, conflicts_with_all = ["breeding", "reuse"])]
        visibility: bool,
        /// How many generations.
        #[arg(long, value_name = "N", default_value_t = 50, requires = "reuse")]
        generations: u32,
    },
    /// Print what makes a shell complete this command line.
    #[command(after_help = COMPLETIONS_EXAMPLE)]
    Completions {
        /// The shell.
        shell: Shell,
    },
    /// Print the man page, or write one for each command.
    #[command(after_help = MAN_EXAMPLES)]
    Man {
        /// Write bake.1, bake-export.1 and so on here.
        #[arg(value_name = "DIR")]
        folder: Option<PathBuf>,
    },
}

impl Command {
    /// Whether `--json` has something to print: events, or what the command would say in words.
    pub fn has_json(&self) -> bool {
        let lists_kinds = matches!(self, Self::Kinds { action: None });
        let is_lineage = matches!(self, Self::Lineage { out: None });
        lists_kinds
            || is_lineage
            || matches!(self, Self::Distance { .. } | Self::Breed(_) | Self::Explain { .. })
            || matches!(self, Self::Random { .. } | Self::Next { .. } | Self::Export { .. })
    }
}

/// What an export is for.
#[derive(Debug, Clone, Copy, Args)]
pub struct ExportArgs {
    /// The program that the file is for.
    ///
    /// Glb viewers take the sun's intensity as it is and know no sky, so there materials glow as if under one. Blender
    /// takes it for lux; its file comes with a sky and a script, NAME-blender.py, that sets up the whole scene.
    #[arg(long = "for", value_enum, value_name = "PROGRAM", default_value_t = Audience::Viewers)]
    audience: Audience,
    /// With the 10 km of land around: the default for Blender.
    #[arg(long, overrides_with = "no_apron")]
    apron: bool,
    /// Without it: the default for viewers, which aim their camera at the whole.
    #[arg(long, overrides_with = "apron")]
    no_apron: bool,
    /// Trees by EXT_mesh_gpu_instancing: a node for each mesh instead of two for each tree.
    ///
    /// For three.js, Babylon.js and engines. Others show one tree of each kind. Instances cannot shear, so trees lean
    /// and stretch a little less; how much is said.
    #[arg(long)]
    instancing: bool,
}

impl ExportArgs {
    /// # Errors
    /// Blender with instancing.
    pub fn options(self) -> Result<Options, BadInput> {
        let Self { audience, apron, no_apron, instancing } = self;
        if instancing && audience == Audience::Blender {
            let text =
                "--instancing is not for Blender, where the script makes the trees instances of collections";
            return Err(BadInput(text.into()));
        }
        let apron = apron || audience == Audience::Blender && !no_apron;
        Ok(Options { audience, apron, instancing })
    }
}

/// `bake kinds …`
#[derive(Debug, Subcommand)]
pub enum KindsCommand {
    /// Print a kind's file.
    Show {
        /// As `bake kinds` lists it.
        kind: String,
    },
    /// Copy a kind's file into the world, to change it or to start a kind of your own from it.
    Copy {
        /// As `bake kinds` lists it.
        kind: String,
        /// The new kind's name [default: the same, whose place it takes].
        name: Option<String>,
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
        #[arg(long, value_name = "SIZE", value_parser = bytes)]
        max_size: u64,
    },
}

/// Their names with what they do.
fn strategies() -> impl TypedValueParser<Value = Strategy> {
    let told = |strategy: Strategy| {
        PossibleValue::new(strategy.name()).help(match strategy {
            Strategy::Learned => "By a model of what the person wants, from all votes so far",
            Strategy::Classic => "By the thesis's genetic algorithm, from the last votes alone",
        })
    };
    PossibleValuesParser::new(Strategy::ALL.map(told)).try_map(|name| name.parse())
}

/// A number of threads: more than any machine's cores would only keep it from other work.
pub fn threads(text: &str) -> Result<usize, String> {
    const MAX_THREADS: usize = 1024;
    let threads = text.parse().ok().filter(|threads| (1..=MAX_THREADS).contains(threads));
    threads.ok_or_else(|| format!("a whole number from 1 to {MAX_THREADS}"))
}

/// A size in bytes, with or without a unit.
pub fn bytes(text: &str) -> Result<u64, String> {
    text.parse().map(|ByteSize(bytes)| bytes)
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

    /// A man page leaves 71 columns of a terminal's 80.
    #[test]
    fn examples_are_not_wrapped() {
        for text in [EXAMPLES, KINDS_EXAMPLES, EXPORT_EXAMPLES, COMPLETIONS_EXAMPLE, MAN_EXAMPLES] {
            assert!(text.lines().all(|line| line.chars().count() <= 71), "{text}");
        }
    }

    #[test]
    fn options_stand_before_or_behind_the_command() {
        for words in
            [["--world", "here", "--threads", "2", "next"], ["next", "--world", "here", "--threads", "2"]]
        {
            let cli = Cli::try_parse_from([&["bake"], &words[..]].concat()).expect("valid");
            assert!(
                matches!(
                    cli.command,
                    Some(Command::Next { from: None, strategy: Strategy::Learned, variety: None })
                ),
                "{cli:?}"
            );
            assert_eq!((cli.run.world, cli.run.threads), ("here".into(), Some(2)));
        }
    }

    #[test]
    fn the_land_around_is_for_blender_unless_told_otherwise() {
        for (words, apron) in [
            (&[][..], false),
            (&["--apron"], true),
            (&["--for", "blender"], true),
            (&["--for", "blender", "--no-apron"], false),
            (&["--no-apron", "--apron"], true),
        ] {
            let cli =
                Cli::try_parse_from([&["bake", "export", "1", "x.glb"], words].concat()).expect("valid");
            let Some(Command::Export { options, .. }) = cli.command else { panic!("{cli:?}") };
            assert_eq!(options.options().expect("valid").apron, apron, "{words:?}");
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
        assert_eq!(bytes("500MB"), Ok(500_000_000));
        assert_eq!(bytes("1.5 GiB"), Ok(3 << 29));
        assert_eq!(bytes("12"), Ok(12));
        assert!(bytes("12 parsecs").is_err());
        assert!(bytes("-1MB").is_err());
    }
}
