//! `bake explain`: why landscapes are what they are: what votes have taught, what was drawn again, and what the last bake
//! reused.

use anyhow::Result;
use genescape_cache::{Change, Explanation, How};
use genescape_schema::{Genome, Population, Space, Strategy};
use genescape_world::{World, names};
use serde_json::{Value, json};

use crate::audition::{self, Redrawn};
use crate::breed::{Account, Settled};
use crate::cli::RunArgs;
use crate::landscape::Landscape;
use crate::origin::Origin;
use crate::{cache_commands, export_command, say};

/// Explains one landscape of the current generation, or all.
pub fn run(landscape: Option<Landscape>, args: &RunArgs) -> Result<()> {
    let (world, cache) = cache_commands::open(&args.world)?;
    let current = export_command::current(&world)?;
    let (space, _) = world.space()?;
    // What was baked may be looked at still when its file is gone.
    let file = World::read_population(&space, &world.population_path(current.generation)).ok();
    let population = file.map(|file| file.population);
    let origin = population.as_ref().map(|population| (population, Origin::of(&space, population, &world)));
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
        let origin = origin.as_ref().map(|(population, origin)| origin_json(population, origin));
        say!("{}", json!({ "generation": current.generation, "origin": origin, "landscapes": landscapes }));
        return Ok(());
    }
    origin.iter().for_each(|(population, origin)| tell_origin(population, origin));
    for one in landscapes {
        say!("landscape {} ({}) in the last bake:", one.landscape, current.scenes[one.landscape.index()]);
        one.tell();
    }
    Ok(())
}

fn tell_origin(population: &Population, Origin { redrawn, taught }: &Origin) {
    if let Some([tree, terrain, sky]) = &population.bred_from {
        say!("bred from chosen parents: trees of {tree}, land of {terrain}, sky of {sky}");
    }
    if population.strategy == Strategy::Classic {
        say!("bred as in the thesis, from the last votes alone");
    }
    redrawn.iter().for_each(|redrawn| say!("{redrawn}"));
    if !taught.is_empty() {
        say!("what votes have taught, in likely kinds and genes:");
        taught.iter().for_each(|account| say!("  {account}"));
    }
}

fn origin_json(population: &Population, Origin { redrawn, taught }: &Origin) -> Value {
    let drawn = |one: &Redrawn| json!({ "landscape": one.landscape + 1, "lacked": one.lacked.lack() });
    json!({
        "parent": population.parent.map(|parent| parent.generation),
        "strategy": population.strategy.name(),
        "bred_from": population.bred_from,
        "redrawn": redrawn.iter().map(drawn).collect::<Vec<_>>(),
        "taught": taught.iter().map(account_json).collect::<Vec<_>>(),
    })
}

fn account_json(Account { category, votes, kinds, genes }: &Account) -> Value {
    let kind = |(name, share): &(Option<String>, f32)| json!({ "name": name, "share": say::rounded(*share) });
    let gene = |Settled { gene, range, part, .. }: &Settled| json!({ "gene": gene, "range": range, "settled": say::rounded(part.max(0.0)) });
    json!({
        "category": category.name(),
        "votes": votes,
        "kinds": kinds.iter().map(kind).collect::<Vec<_>>(),
        "genes": genes.iter().map(gene).collect::<Vec<_>>(),
    })
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
        let look =
            self.first_look.map(|(score, lacks)| json!({ "score": say::rounded(score), "lacks": lacks }));
        json!({
            "landscape": self.landscape.index() + 1,
            "first_look": look,
            "stages": self.stages.iter().map(stage).collect::<Vec<_>>(),
        })
    }
}

fn first_look(space: &Space, genome: &Genome) -> Option<(f32, &'static str)> {
    let first_look = audition::appraise(space, genome, 1.0).ok()?;
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
