//! `bake bench --reuse`: what share of a bake's stages the cache has already, from one bred generation to the next.

use anyhow::{Context, Result};
use genescape_cache::Cache;
use genescape_schema::{Category, INDIVIDUALS, Kinds, Space, Strategy};

use super::person::{Person, Taste};
use super::{Stages, bake};
use crate::breed::Breeder;
use crate::plan::{Plan, Resolution};
use crate::random;
use crate::say;

/// Noise of a simulated person's choices.
const TEMPERATURE: f32 = 0.02;
/// Smaller lands: which stages run is the same.
const SIDE: u32 = 65;

/// What is bred: how, and what is locked.
type Row = (&'static str, Strategy, &'static [Category]);

const ROWS: [Row; 5] = [
    ("learned", Strategy::Learned, &[]),
    ("learned, trees locked", Strategy::Learned, &[Category::Tree]),
    ("learned, terrain locked", Strategy::Learned, &[Category::Terrain]),
    ("learned, sky locked", Strategy::Learned, &[Category::Sky]),
    ("classic", Strategy::Classic, &[]),
];

/// Breeds and bakes `generations` with a simulated person each, all locks set from the first vote on, and prints which part
/// of the stages was there.
pub fn reuse(generations: u32, pool: &rayon::ThreadPool) -> Result<()> {
    let resolution = Resolution::of_side(SIDE).map_err(anyhow::Error::msg)?;
    say!(
        "stages over {generations} generations: what four landscapes need one by one, what they share or was baked before"
    );
    say!("{:<26}{:>8}{:>10}; of those that differ {:>8}{:>10}", "", "needed", "reused", "stages", "reused");
    for row in ROWS {
        let Counts { needed, stages, built } = measure(row, generations, pool, resolution)?;
        let reused = |of: usize| 100.0 * (1.0 - built as f64 / of.max(1) as f64);
        say!("{:<26}{needed:>8}{:>8.0} %{stages:>28}{:>8.0} %", row.0, reused(needed), reused(stages));
    }
    Ok(())
}

/// Stages of all generations but the first.
#[derive(Default)]
struct Counts {
    /// Of each landscape for itself.
    needed: usize,
    /// Those that several landscapes of a generation share counted once.
    stages: usize,
    /// Those that were not in the cache.
    built: usize,
}

fn measure(
    (_, strategy, locked): Row,
    generations: u32,
    pool: &rayon::ThreadPool,
    resolution: Resolution,
) -> Result<Counts> {
    let space = Space::builtin();
    let (kinds, _) = Kinds::shipped(&space);
    let drawn = |seed| random::population(&space, &kinds, &[], seed, 0).context("kinds that ship");
    let target = drawn(1)?.population.individuals[INDIVIDUALS - 1].genome.clone();
    let mut person = Person::new(&space, &target, Taste::Separable, TEMPERATURE, 1);
    let mut now = drawn(2)?.population;
    now.locked = locked.iter().map(|category| category.name().to_owned()).collect();
    let folder = tempfile::tempdir()?;
    let cache = Cache::open(folder.path())?;
    bake(&space, &now, resolution, &cache, pool, &Stages::default())?;
    let (mut past, mut counts) = (Vec::new(), Counts::default());
    for next in 1..=generations {
        now.votes = Some(person.vote(&now));
        let children = Breeder::new(&space, &kinds, strategy, &past, &now)?.bred(next, now.seed);
        past.push(std::mem::replace(&mut now, children));
        let nodes = Plan::new(&space, &now, resolution)?.nodes;
        counts.stages += nodes.len();
        counts.needed += nodes.iter().map(|node| node.scenes.len()).sum::<usize>();
        counts.built += bake(&space, &now, resolution, &cache, pool, &Stages::default())?.1;
    }
    Ok(counts)
}
