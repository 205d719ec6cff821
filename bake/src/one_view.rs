//! A population → the same with other lands of the same kinds, so that there is one view that suits all four: they are
//! first seen from the same place in the same direction, and where four lands were drawn by chance, what suits three of
//! them is often an empty slope in the fourth.
//!
//! Only the lands' seeds change: what each landscape is, and what it is called, stays. Asked is what `audition` asks, of
//! sketches.

use std::ops::Range;

use genescape_schema::scene::Lookout;
use genescape_schema::{Category, Genome, GenomeError, INDIVIDUALS, Population, Space};
use rayon::prelude::*;

use crate::model::SkyLight;
use crate::sketch::Sketch;
use crate::stages::land::Brush;
use crate::stages::sky;
use crate::stages::start::Appraisal;

/// From one land's seed to the next: prime to the number of seeds, and far from a simple part of it.
const STEP: u32 = 37;
/// Of places that score less in one landscape, none is wanted for the four.
const LEAST: f32 = 0.4;
/// Places that one may hope to find as good in the landscapes themselves.
const PLACES: usize = 3;
/// Their score from which no better ones are looked for.
const ENOUGH: f32 = 0.7;

/// How much is done for a view.
#[derive(Clone, Copy, Debug)]
struct Effort {
    /// Lands of each landscape among which one is chosen.
    lands: u32,
    /// Of the places that a landscape may be looked at from, one in so many is asked about.
    one_in: usize,
    brush: Brush,
}

impl Effort {
    /// For four new landscapes.
    const MUCH: Self = Self { lands: 5, one_in: 2, brush: Brush::Fine };
    /// For children, whom a person waits for.
    const LITTLE: Self = Self { lands: 3, one_in: 4, brush: Brush::Broad };
}

/// For each land of a landscape, how good it looks from each lookout that is asked about.
type Lands = Vec<Vec<f32>>;

/// The population with such lands; as it is if one view suits it well, or a genome cannot be read, which others tell.
pub fn suited(space: &Space, population: Population) -> Population {
    with_lands(space, population, [true; INDIVIDUALS], Effort::MUCH)
}

/// The same of children, of which only those get another land that are `open`.
pub fn suited_children(space: &Space, population: Population, open: [bool; INDIVIDUALS]) -> Population {
    with_lands(space, population, open, Effort::LITTLE)
}

fn with_lands(
    space: &Space,
    mut population: Population,
    open: [bool; INDIVIDUALS],
    effort: Effort,
) -> Population {
    let lands = chosen_lands(space, &population, open, effort).unwrap_or_default();
    for (one, number) in population.individuals.iter_mut().zip(lands) {
        one.genome = other_land(space, &one.genome, number);
    }
    population
}

/// The numbers of the lands that are best seen from one place.
fn chosen_lands(
    space: &Space,
    population: &Population,
    open: [bool; INDIVIDUALS],
    effort: Effort,
) -> Option<[u32; INDIVIDUALS]> {
    if !open.contains(&true) {
        return None;
    }
    let lights = population.individuals.par_iter().map(|one| Ok(sky::light(&one.genome.read(space)?)));
    let lights = lights.collect::<Result<Vec<SkyLight>, GenomeError>>().ok()?;
    let add = |four: &mut [Lands; INDIVIDUALS], numbers: Range<u32>| {
        let is_asked = |&(number, k): &(u32, usize)| number == 0 || open[k];
        let asked: Vec<(u32, usize)> =
            numbers.flat_map(|number| (0..INDIVIDUALS).map(move |k| (number, k))).filter(is_asked).collect();
        let scores = asked.par_iter().map(|&(number, k)| {
            let genome = other_land(space, &population.individuals[k].genome, number);
            let sketch = Sketch::under(lights[k].clone(), space, &genome, effort.brush).ok()?;
            Some(scores(&sketch, effort.one_in))
        });
        let scores = scores.collect::<Option<Vec<_>>>()?;
        asked.iter().zip(scores).for_each(|(&(_, k), scores)| four[k].push(scores));
        Some(())
    };
    let mut four = [const { Lands::new() }; INDIVIDUALS];
    add(&mut four, 0..1)?;
    if best(&four).0 >= ENOUGH {
        return None;
    }
    add(&mut four, 1..effort.lands)?;
    Some(best(&four).1)
}

/// Of the ways to give each of four landscapes one of its lands, the best, and how good the places are that suit the worst of
/// the four best there: a sketch leaves gullies out, so that one place alone is no promise.
fn best(four: &[Lands; INDIVIDUALS]) -> (f32, [u32; INDIVIDUALS]) {
    let ways = four.iter().map(Vec::len).product();
    let way = |mut way: usize| -> [u32; INDIVIDUALS] {
        four.each_ref().map(|lands| {
            let number = way % lands.len();
            way /= lands.len();
            number as u32
        })
    };
    let score = |way: [u32; INDIVIDUALS]| shared(std::array::from_fn(|k| &four[k][way[k] as usize][..]));
    let scored = (0..ways).into_par_iter().map(|number| (score(way(number)), number));
    // Of equal ones the first, so that lands stay as they are if that is as good.
    let best = scored.reduce_with(|a, b| if b.0 > a.0 || b.0 == a.0 && b.1 < a.1 { b } else { a });
    best.map_or((0.0, [0; INDIVIDUALS]), |(score, number)| (score, way(number)))
}

/// The mean of the best few places' scores: at each that of the heading that suits the worst of four best.
fn shared(four: [&[f32]; INDIVIDUALS]) -> f32 {
    let worst = |look: usize| four.iter().map(|scores| scores[look]).fold(f32::INFINITY, f32::min);
    let looks: Vec<usize> = (0..four[0].len()).collect();
    let places = looks.chunks(Lookout::HEADINGS);
    let mut places: Vec<f32> =
        places.map(|looks| looks.iter().map(|&look| worst(look)).fold(0.0, f32::max)).collect();
    places.sort_by(|a, b| b.total_cmp(a));
    places.truncate(PLACES);
    places.iter().sum::<f32>() / places.len().max(1) as f32
}

/// How good a landscape looks from each lookout that is asked about.
fn scores(sketch: &Sketch, one_in: usize) -> Vec<f32> {
    sketch.looks(one_in, LEAST).iter().map(Appraisal::score).collect()
}

/// The genome with another land of its kind; number 0 is its own.
fn other_land(space: &Space, genome: &Genome, number: u32) -> Genome {
    let mut genome = genome.clone();
    for seed in space.category(Category::Terrain).filter(|gene| gene.is_seed()) {
        let code = genome.code(seed) + number * STEP;
        genome.set_code(seed, code % (seed.last_code() + 1));
    }
    genome
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::audition::is_same_kind_of_land;
    use crate::kinds::testing::{drawn, kinds};

    fn worst(space: &Space, population: &Population) -> f32 {
        let light = |genome: &Genome| sky::light(&genome.read(space).expect("valid"));
        let sketch = |genome| Sketch::under(light(genome), space, genome, Brush::Fine).expect("valid");
        let four = population.individuals.each_ref().map(|one| vec![scores(&sketch(&one.genome), 2)]);
        best(&four).0
    }

    #[test]
    fn one_view_suits_four_better_and_nothing_but_lands_changes() {
        let space = Space::builtin();
        let kinds = kinds(&space);
        let (mut before, mut after) = (0.0, 0.0);
        for seed in 0..3 {
            let population = drawn(&space, &kinds, seed, 0);
            let suited = suited(&space, population.clone());
            let (was, is) = (worst(&space, &population), worst(&space, &suited));
            assert!(is >= was, "seed {seed}: {is} after {was}");
            (before, after) = (before + was, after + is);
            for (one, other) in population.individuals.iter().zip(&suited.individuals) {
                assert!(is_same_kind_of_land(&space, &one.genome, &other.genome));
                assert_eq!(one.name, other.name);
            }
        }
        assert!(after > 1.1 * before, "{after} after {before}");
    }

    #[test]
    fn lands_are_chosen_for_the_worst_of_four() {
        // Two places, each with the same score for all headings.
        let at = |scores: [f32; 2]| scores.map(|score| [score; Lookout::HEADINGS]).as_flattened().to_vec();
        // What is best for each of the first two is the other's worst.
        let (first, second) = ([[0.8, 0.2], [0.5, 0.6]].map(at), [[0.1, 0.7], [0.15, 0.5]].map(at));
        let well = || vec![at([0.9; 2])];
        assert_eq!(best(&[first.to_vec(), second.to_vec(), well(), well()]).1, [1, 0, 0, 0]);
        assert_eq!(best(&[first[..1].to_vec(), second[..1].to_vec(), well(), well()]).1, [0; INDIVIDUALS]);
    }

    #[test]
    fn lands_that_are_not_open_stay() {
        let space = Space::builtin();
        let population = drawn(&space, &kinds(&space), 1, 0);
        let open = [false, true, false, false];
        let suited = suited_children(&space, population.clone(), open);
        for ((one, other), open) in population.individuals.iter().zip(&suited.individuals).zip(open) {
            assert!(open || one == other);
        }
        assert_eq!(chosen_lands(&space, &population, [false; INDIVIDUALS], Effort::LITTLE), None);
    }
}
