//! Parents that a person chose from anywhere → a new generation: landscapes of any generation, of other population files,
//! kinds.

use std::path::PathBuf;

use anyhow::Result;
use genescape_schema::{
    Category, Chromosome, Genome, INDIVIDUALS, Individual, Kind, Kinds, Parent, Population, Space, Variety,
    Votes,
};
use genescape_world::World;

use crate::audition::{self, Auditioned};
use crate::bad_input::BadInput;
use crate::breed::{Breeder, Chosen};
use crate::events::Listener;
use crate::kinds::pick::Picker;
use crate::kinds::{Company, Home, ORDER, called};
use crate::landscape::{Landscape, ParentArg, Reference};
use crate::seed::Dice;
use crate::session;

/// What a person says of the next generation: a part of the command line, whose help these comments are.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct ChosenParents {
    /// Where the trees come from.
    #[arg(long, value_name = "PARENT", allow_negative_numbers = true)]
    pub tree: Option<ParentArg>,
    /// Where the land comes from.
    #[arg(long, value_name = "PARENT", allow_negative_numbers = true)]
    pub terrain: Option<ParentArg>,
    /// Where the sky comes from.
    #[arg(long, value_name = "PARENT", allow_negative_numbers = true)]
    pub sky: Option<ParentArg>,
    /// How different the others are from the first: 0 close variations, 1 anything [default: what the current generation's
    /// file says, else 0.5].
    #[arg(long, value_name = "0..1", allow_negative_numbers = true)]
    pub variety: Option<Variety>,
    /// Another seed makes other children of the same parents [default: one for each generation].
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub seed: Option<u64>,
}

/// One part of the parents.
struct Part {
    chromosome: Chromosome,
    /// As population files say it.
    name: String,
    /// The world's landscape that it is of.
    of: Option<(u32, usize)>,
    /// What that landscape is called.
    called: String,
}

impl ChosenParents {
    /// Breeds them, beside the landscapes of generation `beside`, and writes the children as a new population file, whose path
    /// it returns.
    ///
    /// # Errors
    /// Parents that are not there or wrong, a word that is no kind of its category, a folder that cannot be written to.
    pub fn breed(
        &self,
        world: &World,
        space: &Space,
        kinds: &Kinds,
        beside: u32,
        listener: &dyn Listener,
    ) -> Result<PathBuf> {
        let beside = world.population(space, beside)?.population;
        world.create_next_population(space, |generation| {
            let seed = self.seed.unwrap_or_else(|| beside.seed.wrapping_add(u64::from(generation)));
            let parts = self.parts(world, space, kinds, &beside, seed)?;
            let chosen = chosen(&parts, self.variety.or(beside.variety));
            let parents =
                Population { seed, variety: self.variety.or(beside.variety), ..united(&beside, parts) };
            let past = session::votes_before(world, space, None, generation, listener);
            let breeder = Breeder::from_chosen(space, kinds, &past, &parents, &chosen);
            let Auditioned { population, redrawn } = audition::next_generation(&breeder, generation);
            audition::tell(listener, &redrawn);
            Ok(population)
        })
    }

    fn of(&self, category: Category) -> Option<&ParentArg> {
        [&self.tree, &self.terrain, &self.sky][category as usize].as_ref()
    }

    /// Landscapes first, then members of kinds that go with them, if any do.
    fn parts(
        &self,
        world: &World,
        space: &Space,
        kinds: &Kinds,
        beside: &Population,
        seed: u64,
    ) -> Result<[Part; 3]> {
        let mut parts = [None, None, None];
        let mut company = Company::new(space);
        for category in Category::ALL {
            let reference = match self.of(category) {
                Some(ParentArg::Kind(_)) => continue,
                Some(ParentArg::Landscape(reference)) => within(reference, beside),
                None => favourite(beside, category),
            };
            let part = landscape_part(world, space, &reference, category)?;
            let home = Home::of(space, kinds, category, &part.chromosome);
            company.add(category, part.chromosome.clone(), home);
            parts[category as usize] = Some(part);
        }
        for category in ORDER {
            let Some(ParentArg::Kind(word)) = self.of(category) else { continue };
            let pool = kinds_of(kinds, category, word)?;
            let picker = Picker { space, kinds, pool };
            let mut dice = Dice::new(seed, "chosen", category as u64);
            let Some(picked) = picker.pick(category, &company, &[], &mut dice) else { continue };
            company.add(category, picked.chromosome.clone(), picked.home);
            let (chromosome, name) = (picked.chromosome, word.clone());
            parts[category as usize] = Some(Part { chromosome, name, of: None, called: String::new() });
        }
        Ok(parts.map(|part| part.unwrap_or_else(|| unreachable!("a pool is never empty"))))
    }
}

/// The same with the generation's number, where it was left out.
fn within(reference: &Reference, beside: &Population) -> Reference {
    match reference {
        Reference::Current(landscape) => Reference::Of(beside.generation, *landscape),
        other => other.clone(),
    }
}

fn favourite(beside: &Population, category: Category) -> Reference {
    let favourite = beside.votes.and_then(|votes| votes.favourite(category)).unwrap_or_default();
    let landscape = Landscape::all().nth(favourite).unwrap_or_else(|| unreachable!("one of the four"));
    Reference::Of(beside.generation, landscape)
}

fn landscape_part(world: &World, space: &Space, reference: &Reference, category: Category) -> Result<Part> {
    let (_, individual) = reference.find(world, space)?;
    let of = match reference {
        Reference::Of(generation, landscape) => Some((*generation, landscape.index())),
        _ => None,
    };
    let chromosome = individual.genome.chromosome(category).clone();
    Ok(Part { chromosome, name: reference.to_string(), of, called: individual.name })
}

/// The kinds of a category that a word means.
fn kinds_of<'a>(kinds: &'a Kinds, category: Category, word: &str) -> Result<Vec<&'a Kind>, BadInput> {
    let called = called(kinds, &[word.to_owned()])?;
    let own: Vec<&Kind> = called.iter().copied().filter(|kind| kind.category == category).collect();
    match (called.first(), own.is_empty()) {
        (Some(other), true) => {
            Err(BadInput(format!("{word} is a kind of {}, not of {category}", other.category)))
        }
        _ => Ok(own),
    }
}

fn chosen(parts: &[Part; 3], variety: Option<Variety>) -> Chosen {
    let names = parts.each_ref().map(|part| part.name.clone());
    let [tree, terrain, sky] = parts.each_ref().map(|part| part.of);
    let parent = match (tree, terrain, sky) {
        (Some((generation, a)), Some((same, b)), Some((too, c)))
            if generation == same && generation == too =>
        {
            let votes = Votes { tree: Some(a), terrain: Some(b), sky: Some(c) };
            Some(Parent { generation, votes, variety })
        }
        _ => None,
    };
    Chosen { names, parent }
}

/// The landscapes beside, of which the parts take the place of the first. It is called as the landscape that it has most of.
fn united(beside: &Population, parts: [Part; 3]) -> Population {
    let most = |one: &&Part| parts.iter().filter(|other| other.called == one.called).count();
    let called = parts.iter().max_by_key(most).filter(|one| most(one) > 1);
    let name = called.map(|part| part.called.clone()).unwrap_or_default();
    let chromosomes = parts.map(|part| part.chromosome);
    let first = Individual { name, descent: String::new(), genome: Genome { chromosomes } };
    let mut individuals: [Individual; INDIVIDUALS] = beside.individuals.clone();
    individuals[0] = first;
    Population { individuals, ..beside.clone() }
}
