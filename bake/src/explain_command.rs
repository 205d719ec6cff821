//! `bake explain`: why landscapes are what they are: what votes have taught, what was drawn again, and what the last bake
//! reused.

use anyhow::Result;
use genescape_cache::{Change, Explanation, How};
use genescape_schema::{Genome, Kinds, Population, Space};
use genescape_world::{World, names};
use serde_json::{Value, json};

use crate::audition::{self, Redrawn};
use crate::breed::{Account, Breeder, Settled, Strategy};
use crate::cli::RunArgs;
use crate::events::Untold;
use crate::landscape::Landscape;
use crate::{cache_commands, export_command, say, session};

/// Explains one landscape of the current generation, or all.
pub fn run(landscape: Option<Landscape>, args: &RunArgs) -> Result<()> {
    let (world, cache) = cache_commands::open(&args.world)?;
    let current = export_command::current(&world)?;
    let (space, _) = world.space()?;
    // What was baked may be looked at still when its file is gone.
    let file = World::read_population(&space, &world.population_path(current.generation)).ok();
    let population = file.map(|file| file.population);
    let origin = population.as_ref().map(|population| Origin::of(&space, population, &world));
    let mut landscapes = Vec::new();
    for landscape in landscape.map_or_else(|| Landscape::all().collect(), |one| vec![one]) {
        let first_look = population
            .as_ref()
            .and_then(|population| first_look(&space, &population.individuals[landscape.index()].genome));
        let history = cache.history(&names::scene_id(current.generation, landscape.index()))?;
        let stages =
            history.last().map(|(stage, explanation)| (stage.to_owned(), as_in_files(&space, explanation)));
        landscapes.push(Explained { landscape, first_look, stages: stages.collect() });
    }
    if args.json {
        let landscapes: Vec<Value> = landscapes.iter().map(Explained::to_json).collect();
        let origin = origin.as_ref().map(Origin::to_json);
        say!("{}", json!({ "generation": current.generation, "origin": origin, "landscapes": landscapes }));
        return Ok(());
    }
    origin.iter().for_each(Origin::tell);
    for one in landscapes {
        say!("landscape {} ({}) in the last bake:", one.landscape, current.scenes[one.landscape.index()]);
        one.tell();
    }
    Ok(())
}

/// Where a generation comes from, as far as draws can be repeated: not where parents are no longer to be read, or only
/// some kinds were asked for.
struct Origin {
    population: Population,
    /// Landscapes that were drawn again because nobody would have looked at the first draw.
    redrawn: Vec<Redrawn>,
    /// What the votes have taught that it was bred from.
    taught: Vec<Account>,
}

impl Origin {
    fn of(space: &Space, population: &Population, world: &World) -> Self {
        let (redrawn, taught) = history(space, population, world).unwrap_or_default();
        Self { population: population.clone(), redrawn, taught }
    }

    fn tell(&self) {
        if let Some([tree, terrain, sky]) = &self.population.bred_from {
            say!("bred from chosen parents: trees of {tree}, land of {terrain}, sky of {sky}");
        }
        self.redrawn.iter().for_each(|redrawn| say!("{redrawn}"));
        if !self.taught.is_empty() {
            say!("what votes have taught, in likely kinds and genes:");
            self.taught.iter().for_each(|account| say!("  {account}"));
        }
    }

    fn to_json(&self) -> Value {
        let redrawn = |one: &Redrawn| json!({ "landscape": one.landscape + 1, "lacked": one.lacked.lack() });
        json!({
            "parent": self.population.parent.map(|parent| parent.generation),
            "bred_from": self.population.bred_from,
            "redrawn": self.redrawn.iter().map(redrawn).collect::<Vec<_>>(),
            "taught": self.taught.iter().map(account_json).collect::<Vec<_>>(),
        })
    }
}

fn account_json(Account { category, votes, kinds, genes }: &Account) -> Value {
    let kind = |(name, share): &(Option<String>, f32)| json!({ "name": name, "share": share });
    let gene = |Settled { gene, range, part, .. }: &Settled| json!({ "gene": gene, "range": range, "settled": part.max(0.0) });
    json!({
        "category": category.name(),
        "votes": votes,
        "kinds": kinds.iter().map(kind).collect::<Vec<_>>(),
        "genes": genes.iter().map(gene).collect::<Vec<_>>(),
    })
}

/// What was drawn again, and what votes have taught.
fn history(space: &Space, population: &Population, world: &World) -> Option<(Vec<Redrawn>, Vec<Account>)> {
    let Population { seed, generation, parent, .. } = *population;
    let kinds = world.kinds(space).kinds;
    if population.bred_from.is_some() {
        return None;
    }
    let Some(parent) = parent else {
        let of = |kinds: &Kinds| {
            let draw = |attempt| audition::drawn(space, kinds, &[], seed, generation, attempt).population;
            audition::redrawn(space, draw, population)
        };
        return Some(([of(&kinds), of(&Kinds::default())].concat(), Vec::new()));
    };
    let parents = World::read_population(space, &world.population_path(parent.generation)).ok()?.population;
    let parents = Population { votes: Some(parent.votes), variety: parent.variety, ..parents };
    let past = session::votes_before(world, space, Some(parents.generation), generation, &Untold);
    let breeder = Breeder::new(space, &kinds, Strategy::default(), &past, &parents).ok()?;
    let redrawn =
        audition::redrawn(space, |attempt| audition::bred(&breeder, generation, attempt), population);
    Some((redrawn, breeder.accounts()))
}

/// What is known of one landscape.
struct Explained {
    landscape: Landscape,
    /// How good the best first look is, of 100, and what it lacks most.
    first_look: Option<(f32, &'static str)>,
    stages: Vec<(String, Explanation)>,
}

impl Explained {
    fn tell(&self) {
        if let Some((score, lacks)) = self.first_look {
            say!("  {:<16} {score:.0} of 100 for the best view; its weakest side: {lacks}", "first look");
        }
        self.stages.iter().for_each(|(stage, explanation)| say!("  {stage:<16} {explanation}"));
    }

    fn to_json(&self) -> Value {
        let stage = |(stage, explanation): &(String, Explanation)| {
            let changes: Vec<String> = explanation.changes.iter().map(Change::to_string).collect();
            json!({ "stage": stage, "reused": explanation.how == How::Reused, "changes": changes })
        };
        let look = self.first_look.map(|(score, lacks)| json!({ "score": score, "lacks": lacks }));
        json!({
            "landscape": self.landscape.index() + 1,
            "first_look": look,
            "stages": self.stages.iter().map(stage).collect::<Vec<_>>(),
        })
    }
}

fn first_look(space: &Space, genome: &Genome) -> Option<(f32, &'static str)> {
    let first_look = audition::appraise(space, genome).ok()?;
    Some((100.0 * first_look.score(), first_look.weakest().lack()))
}

/// An explanation with genes' values as population files say them: 12.86, where a stage reads 12.857142448425293.
fn as_in_files(space: &Space, explanation: &Explanation) -> Explanation {
    let mut explanation = explanation.clone();
    for change in &mut explanation.changes {
        let Change::Parameter { name, from, to } = change else { continue };
        let Some(gene) = space.find(name) else { continue };
        for value in [from, to].into_iter().flatten() {
            if let Ok(number) = value.parse() {
                *value = gene.text(gene.snap(number));
            }
        }
    }
    explanation
}
