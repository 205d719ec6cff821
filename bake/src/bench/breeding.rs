//! `bake bench --breeding`: how near strategies of breeding come to what simulated persons want.

use std::time::Instant;

use anyhow::{Context, Result};
use genescape_schema::{Category, INDIVIDUALS, Kinds, Parent, Population, Space, Strategy};
use rayon::prelude::*;

use super::person::{Person, Taste};
use crate::breed::Breeder;
use crate::random;
use crate::say;
use crate::seed::Dice;

/// Noise of choices.
const TEMPERATURES: [f32; 3] = [0.0, 0.02, 0.06];
/// Rounds after which distances are told.
const TOLD: [u32; 6] = [0, 2, 5, 10, 30, 60];
/// Seeds of persons; those below were used for tuning.
const FIRST_SEED: u64 = 10_000;

/// Where persons search.
struct Place {
    name: &'static str,
    space: Space,
    kinds: Kinds,
    rounds: u32,
}

impl Place {
    fn all() -> Result<Vec<Self>> {
        let flat = |name, genes: usize, rounds| -> Result<Self> {
            let space = Space::parse("flat.ron", &flat_space(genes)).context("a made space")?;
            Ok(Self { name, space, kinds: Kinds::default(), rounds })
        };
        let space = Space::builtin();
        let (kinds, _) = Kinds::shipped(&space);
        Ok(vec![
            flat("16 genes", 16, 30)?,
            flat("48 genes", 48, 60)?,
            Self { name: "real space, uniform", space: space.clone(), kinds: Kinds::default(), rounds: 30 },
            Self { name: "real space, kinds", space, kinds, rounds: 60 },
        ])
    }

    fn random(&self, seed: u64, generation: u32) -> Population {
        match random::population(&self.space, &self.kinds, &[], seed, generation) {
            Some(drawn) => drawn.population,
            None => Population::random(&self.space, seed, generation),
        }
    }
}

/// Three categories of as many genes.
fn flat_space(genes: usize) -> String {
    let gene = |category: Category, number: usize| {
        format!(
            "(name: \"{category}_{number}\", category: {category}, bits: 8, range: (0.0, 1.0), scale: linear, unit: \"\", help: \"made\"),"
        )
    };
    let all = Category::ALL.iter().flat_map(|category| (0..genes).map(move |number| gene(*category, number)));
    format!("Space(version: 1, parameters: [{}])", all.collect::<String>())
}

/// Ways to go from votes to the next four.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    Learned,
    /// Four of what the votes leave possible, by chance.
    Samples,
    Classic,
    /// Three bits of the favourite changed.
    BitFlips,
    /// The favourite, and three by chance.
    RandomWithFavourite,
    /// See [`super::cma_es`].
    #[cfg(feature = "cmaes")]
    CmaEs,
    /// Four by chance.
    NoVotes,
}

impl Way {
    const ALL: &[Self] = &[
        Self::Learned,
        Self::Samples,
        Self::Classic,
        Self::BitFlips,
        Self::RandomWithFavourite,
        #[cfg(feature = "cmaes")]
        Self::CmaEs,
        Self::NoVotes,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Learned => "learned",
            Self::Samples => "samples of the model",
            Self::Classic => "classic",
            Self::BitFlips => "bit flips",
            Self::RandomWithFavourite => "random with favourite",
            #[cfg(feature = "cmaes")]
            Self::CmaEs => "CMA-ES",
            Self::NoVotes => "no votes",
        }
    }

    fn next(self, place: &Place, history: &[Population]) -> Result<Population> {
        let (parents, past) = history.split_last().context("there is a first population")?;
        let next = parents.generation + 1;
        let breeder = |strategy| Breeder::new(&place.space, &place.kinds, strategy, past, parents);
        match self {
            Self::Learned => Ok(breeder(Strategy::Learned)?.bred(next, parents.seed)),
            Self::Samples => breeder(Strategy::Learned)?.sampled(next).context("it learns"),
            Self::Classic => Ok(breeder(Strategy::Classic)?.bred(next, parents.seed)),
            _ => Ok(self.by_chance(place, parents, next)),
        }
    }

    fn by_chance(self, place: &Place, parents: &Population, next: u32) -> Population {
        let mut children = place.random(parents.seed, next);
        let votes = parents.votes.unwrap_or_default();
        let mut dice = Dice::new(parents.seed, "bit flips", u64::from(next));
        if self != Self::NoVotes {
            for category in Category::ALL {
                let favourite = votes.favourite(category).unwrap_or_default();
                let favourite = parents.individuals[favourite].genome.chromosome(category);
                let kept = if self == Self::BitFlips { INDIVIDUALS } else { 1 };
                for (child, one) in children.individuals.iter_mut().take(kept).enumerate() {
                    let chromosome = one.genome.chromosome_mut(category);
                    chromosome.clone_from(favourite);
                    let genes: Vec<_> = place.space.category(category).collect();
                    for _ in 0..3 * usize::from(child > 0) {
                        let gene = genes[dice.below(genes.len() as u32) as usize];
                        chromosome.set_code(gene, chromosome.code(gene) ^ 1 << dice.below(gene.bits));
                    }
                }
            }
        }
        let parent = Some(Parent { generation: parents.generation, votes, variety: None });
        Population { seed: parents.seed, parent, ..children }
    }
}

/// Of one person: after each round the distance of what was chosen, a mean over categories, and how far apart the four were.
struct Course {
    chosen: Vec<f32>,
    apart: Vec<f32>,
}

fn course(place: &Place, way: Way, taste: Taste, temperature: f32, seed: u64) -> Result<Course> {
    let target = place.random(seed + 500_000, 0).individuals[0].genome.clone();
    let mut person = Person::new(&place.space, &target, taste, temperature, seed);
    #[cfg(feature = "cmaes")]
    if way == Way::CmaEs {
        let chosen = super::cma_es::distances(&place.space, &person, temperature, seed, place.rounds)?;
        return Ok(Course { chosen, apart: Vec::new() });
    }
    let mut history = vec![place.random(seed, 0)];
    let mut course = Course { chosen: Vec::new(), apart: Vec::new() };
    loop {
        let now = history.len() - 1;
        let votes = person.vote(&history[now]);
        let four = &history[now].individuals;
        let of = |category: Category| {
            let chosen = votes.favourite(category).unwrap_or_default();
            person.distances(&four[chosen].genome)[category as usize]
        };
        course.chosen.push(Category::ALL.into_iter().map(of).sum::<f32>() / 3.0);
        course.apart.push(apart(&place.space, &history[now]));
        if now as u32 == place.rounds {
            return Ok(course);
        }
        history[now].votes = Some(votes);
        history.push(way.next(place, &history)?);
    }
}

/// The mean distance between two of a population, root mean square over all genes but seeds.
fn apart(space: &Space, population: &Population) -> f32 {
    let traits: Vec<_> = space.parameters().iter().filter(|gene| !gene.is_seed()).collect();
    let (mut sum, mut pairs) = (0.0, 0);
    for (number, a) in population.individuals.iter().enumerate() {
        for b in &population.individuals[..number] {
            let squares = traits.iter().map(|gene| {
                let gap = gene.part(a.genome.code(gene)) - gene.part(b.genome.code(gene));
                gap * gap
            });
            sum += (squares.sum::<f32>() / traits.len() as f32).sqrt();
            pairs += 1;
        }
    }
    sum / pairs as f32
}

/// Prints how near `persons` persons come in each place, by each way, for each taste and temperature; only those rows that
/// have the words `only` in their name, as "16 genes, separable, 0.02, learned".
pub fn breeding(persons: u64, pool: &rayon::ThreadPool, only: Option<&str>) -> Result<()> {
    for place in Place::all()? {
        let name = |taste: Taste, temperature: f32, way: Way| {
            format!("{}, {}, {temperature}, {}", place.name, taste.name(), way.name())
        };
        let all = Taste::ALL.into_iter().flat_map(|taste| {
            TEMPERATURES.into_iter().flat_map(move |t| Way::ALL.iter().map(move |&way| (taste, t, way)))
        });
        let is_asked = |(taste, t, way): &(Taste, f32, Way)| {
            only.is_none_or(|only| name(*taste, *t, *way).contains(only))
        };
        let rows: Vec<(Taste, f32, Way)> = all.filter(is_asked).collect();
        if rows.is_empty() {
            continue;
        }
        say!("{}: median distance of what {persons} persons chose from what they want", place.name);
        let told: Vec<u32> = TOLD.into_iter().filter(|round| *round <= place.rounds).collect();
        let head: String = told.iter().map(|round| format!("{round:>8}")).collect();
        say!("{:<12}{:>5}  {:<24}{head}   apart   s a vote", "taste", "T", "votes");
        for (taste, temperature, way) in rows {
            let start = Instant::now();
            let courses: Result<Vec<Course>> = pool.install(|| {
                let seeds = (0..persons).into_par_iter().map(|seed| FIRST_SEED + seed);
                seeds.map(|seed| course(&place, way, taste, temperature, seed)).collect()
            });
            let courses = courses?;
            let at = |round: usize| median(courses.iter().map(|course| course.chosen[round]).collect());
            let distances: String =
                told.iter().map(|round| format!("{:>8.3}", at(*round as usize))).collect();
            let apart = courses.iter().filter_map(|one| one.apart.get(one.apart.len() / 2).copied());
            let apart: Vec<f32> = apart.collect();
            let apart = if apart.is_empty() { "-".to_owned() } else { format!("{:.3}", median(apart)) };
            let seconds = start.elapsed().as_secs_f64() / (persons as f64 * f64::from(place.rounds));
            let taste = taste.name();
            say!("{taste:<12}{temperature:>5}  {:<24}{distances}{apart:>8}{seconds:>9.3}", way.name());
        }
        say!("");
    }
    Ok(())
}

fn median(mut values: Vec<f32>) -> f32 {
    values.sort_unstable_by(f32::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or_default()
}
