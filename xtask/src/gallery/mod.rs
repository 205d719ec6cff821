//! Contact sheets for the eye: random landscapes as they come, generations bred by random votes, or one landscape of each kind,
//! each with its name.
//! Every population has a world of its own below `target/gallery`, whose cache makes the next gallery quick, and takes some
//! 250 MB.

mod sheet;

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::{Instant, SystemTime};

use anyhow::{Context, Result, ensure};
use clap::Args;

use crate::tools::{fresh, program, release, root};
use sheet::Sheet;

/// Landscapes in a population.
const LANDSCAPES: u64 = 4;
/// Folders of kinds, one a category.
const CATEGORIES: [&str; 3] = ["tree", "terrain", "sky"];
/// Kinds in a row of their sheet.
const KINDS_A_ROW: u32 = 6;

#[derive(Debug, Args)]
pub struct Options {
    /// Seed of the first population; the others follow.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// How many random landscapes: four a population.
    #[arg(long, default_value_t = 48, value_parser = clap::value_parser!(u64).range(1..=4000))]
    count: u64,
    /// Also breed that many generations from the first population, by random votes.
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=1000))]
    generations: u32,
    /// Instead, one landscape of each kind of trees, of lands and of skies.
    #[arg(long, conflicts_with_all = ["count", "generations"])]
    kinds: bool,
    /// Width of one picture; it is two thirds as high.
    #[arg(long, value_name = "PX", default_value_t = 480, value_parser = clap::value_parser!(u32).range(90..=1920))]
    width: u32,
    /// Folder for the sheets [default: target/gallery].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Folder with programs `bake` and `viewer` to use, instead of building them in release.
    #[arg(long, value_name = "DIR")]
    programs: Option<PathBuf>,
}

/// The programs that make it.
struct Gallery<'a> {
    options: &'a Options,
    folder: PathBuf,
    bake: PathBuf,
    viewer: PathBuf,
}

/// Makes the sheets and says where they are.
pub fn run(options: &Options) -> Result<()> {
    let find = |package: &str, name: &str| match &options.programs {
        Some(folder) => Ok(folder.join(format!("{name}{}", std::env::consts::EXE_SUFFIX))),
        None => release(package, name),
    };
    let gallery = Gallery {
        options,
        folder: root().join("target/gallery"),
        bake: find("genescape-bake", "bake")?,
        viewer: find("genescape-viewer", "viewer")?,
    };
    let out = options.out.clone().unwrap_or_else(|| gallery.folder.clone());
    std::fs::create_dir_all(&out).with_context(|| format!("cannot make {}", out.display()))?;
    if options.kinds {
        let hang = |category| gallery.kinds(category)?.write(&out.join(format!("kinds-{category}.jpg")));
        return CATEGORIES.into_iter().try_for_each(hang);
    }
    gallery.random()?.write(&out.join(format!("random-{}-{}.jpg", options.seed, options.count)))?;
    if options.generations > 0 {
        let name = format!("bred-{}-{}.jpg", options.seed, options.generations);
        gallery.bred()?.write(&out.join(name))?;
    }
    Ok(())
}

impl Gallery<'_> {
    /// Consecutive random landscapes, a population a row.
    fn random(&self) -> Result<Sheet> {
        let Options { seed, count, width, .. } = *self.options;
        let mut sheet = Sheet::new(width, count.min(LANDSCAPES) as u32, count);
        let populations = count.div_ceil(LANDSCAPES);
        for (number, seed) in (0..populations).map(|number| (number, seed + number)) {
            let start = Instant::now();
            let world = self.folder.join(format!("seed-{seed}"));
            // Genomes depend on the kinds of today; what was baked is found again by its content.
            fresh(world.join("population"))?;
            self.bake(&world, &["random", "--seed", &seed.to_string()])?;
            self.hang(&world, 0, number * LANDSCAPES + 1, "", &mut sheet)?;
            tell(number + 1, populations, &format!("seed {seed}"), start);
        }
        Ok(sheet)
    }

    /// The first population and its descendants, a generation a row.
    fn bred(&self) -> Result<Sheet> {
        let Options { seed, generations, width, .. } = *self.options;
        let rows = u64::from(generations) + 1;
        let mut sheet = Sheet::new(width, LANDSCAPES as u32, rows * LANDSCAPES);
        let world = self.folder.join(format!("seed-{seed}"));
        for generation in 0..=generations {
            let start = Instant::now();
            if generation > 0 {
                vote(&world, seed, generation - 1)?;
                self.bake(&world, &["next", "--from", &(generation - 1).to_string()])?;
            }
            self.hang(&world, generation, 1, &format!("{generation}."), &mut sheet)?;
            tell(u64::from(generation) + 1, rows, &format!("generation {generation}"), start);
        }
        Ok(sheet)
    }

    /// One landscape of each kind of a category, four a population, with the name that one asks for it by.
    fn kinds(&self, category: &str) -> Result<Sheet> {
        let kinds = kinds(category)?;
        let mut sheet = Sheet::new(self.options.width, KINDS_A_ROW, kinds.len() as u64);
        let populations = kinds.chunks(LANDSCAPES as usize);
        let count = populations.len() as u64;
        for (number, four) in (0..).zip(populations) {
            let start = Instant::now();
            let world = self.folder.join(format!("{category}-{number}"));
            fresh(world.join("population"))?;
            let seed = (self.options.seed + number).to_string();
            let asked = four.iter().flat_map(|kind| ["--kind", kind]);
            let words: Vec<&str> = ["random", "--seed", &seed].into_iter().chain(asked).collect();
            self.bake(&world, &words)?;
            sheet.hang(&self.picture(&world, 0)?, four)?;
            tell(number + 1, count, &four.join(", "), start);
        }
        Ok(sheet)
    }

    fn bake(&self, world: &Path, words: &[&str]) -> Result<()> {
        let output = program(&self.bake).args(words).arg("--world").arg(world).output();
        let output = output.with_context(|| format!("cannot start {}", self.bake.display()))?;
        ensure!(output.status.success(), "bake failed: {}", String::from_utf8_lossy(&output.stderr));
        Ok(())
    }

    /// Puts a population's pictures on the sheet, with their numbers from `first` on.
    fn hang(&self, world: &Path, generation: u32, first: u64, prefix: &str, sheet: &mut Sheet) -> Result<()> {
        let picture = self.picture(world, generation)?;
        let captions: Vec<String> = (first..)
            .zip(names(&population(world, generation))?)
            .map(|(number, name)| format!("{prefix}{number}  {name}"))
            .collect();
        sheet.hang(&picture, &captions)
    }

    /// All four landscapes of a generation on one picture, as the viewer first shows them. One that is newer than its scenes
    /// and the viewer is taken again.
    fn picture(&self, world: &Path, generation: u32) -> Result<PathBuf> {
        let scenes = world.join(format!("baked/g{generation:04}"));
        let width = self.options.width;
        let out = world.join(format!("g{generation:04}-{width}.png"));
        let drawn_from = (0..LANDSCAPES).map(|scene| scenes.join(format!("scene-{scene}/scene.gltf")));
        let newest = drawn_from.chain([self.viewer.clone()]).map(|path| saved(&path)).max();
        if newest.is_some_and(|newest| newest.is_some() && saved(&out) > newest) {
            return Ok(out);
        }
        let size = format!("{}x{}", 2 * width, 2 * sheet::height(width));
        let mut viewer = program(&self.viewer);
        viewer.arg(&scenes).arg("--screenshot").arg(&out).args(["--all", "--size", &size]);
        let output = viewer.stdin(Stdio::null()).output();
        let output = output.with_context(|| format!("cannot start {}", self.viewer.display()))?;
        ensure!(output.status.success(), "viewer failed: {}", String::from_utf8_lossy(&output.stderr));
        Ok(out)
    }
}

fn tell(done: u64, of: u64, what: &str, start: Instant) {
    println!("{done} of {of}: {what}, {:.0} s", start.elapsed().as_secs_f64());
}

fn saved(path: &Path) -> Option<SystemTime> {
    path.metadata().and_then(|metadata| metadata.modified()).ok()
}

fn population(world: &Path, generation: u32) -> PathBuf {
    world.join(format!("population/g{generation:04}.ron"))
}

/// All kinds of a category, by the names of their files.
fn kinds(category: &str) -> Result<Vec<String>> {
    let folder = root().join("configs/kinds").join(category);
    let files = std::fs::read_dir(&folder).with_context(|| format!("cannot read {}", folder.display()))?;
    let name = |file: std::io::Result<std::fs::DirEntry>| {
        Ok(file?.path().file_stem().unwrap_or_default().to_string_lossy().into_owned())
    };
    let mut names = files.map(name).collect::<std::io::Result<Vec<_>>>()?;
    names.sort();
    Ok(names)
}

/// What the landscapes of a population file are called.
fn names(path: &Path) -> Result<Vec<String>> {
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    let name = |line: &str| Some(line.trim().strip_prefix("name: \"")?.strip_suffix("\",")?.to_owned());
    Ok(text.lines().filter_map(name).collect())
}

/// Writes votes into a population file, as a person might who likes now this, now that, and sometimes none.
fn vote(world: &Path, seed: u64, generation: u32) -> Result<()> {
    let path = population(world, generation);
    let text = std::fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
    let ballot = |category: &str| {
        let mut hasher = DefaultHasher::new();
        (seed, generation, category).hash(&mut hasher);
        let best = hasher.finish() % (2 * LANDSCAPES + 1);
        let vote = if best < 2 * LANDSCAPES { format!("Some({})", best / 2) } else { "None".to_owned() };
        format!("{category}: {vote}")
    };
    let votes = CATEGORIES.map(ballot).join(", ");
    let voted = text.replacen("votes: None", &format!("votes: Some(({votes}))"), 1);
    ensure!(voted != text, "{} has votes already", path.display());
    std::fs::write(&path, voted).with_context(|| format!("cannot write {}", path.display()))
}
