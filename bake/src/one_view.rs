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

use crate::audition::Sketch;
use crate::model::SkyLight;
use crate::stages::land::Brush;
use crate::stages::sky;
use crate::stages::start::Appraisal;

/// Lands of each landscape among which one is chosen.
const LANDS: u32 = 5;
/// From one land's seed to the next: prime to the number of seeds, and far from a simple part of it.
const STEP: u32 = 37;
/// Of the places that a landscape may be looked at from, one in so many is asked about.
const ONE_IN: usize = 2;
/// Of places that score less in one landscape, none is wanted for the four.
const LEAST: f32 = 0.4;
/// Places that one may hope to find as good in the landscapes themselves.
const PLACES: usize = 3;
/// Their score from which no better ones are looked for.
const ENOUGH: f32 = 0.7;

/// For each of four lands, how good it looks from each lookout that is asked about.
type Lands = [Vec<f32>; INDIVIDUALS];

/// The population with such lands; as it is if one view suits it well, or a genome cannot be read, which others tell.
pub fn suited(space: &Space, mut population: Population) -> Population {
    let lands = chosen_lands(space, &population).unwrap_or_default();
    for (one, number) in population.individuals.iter_mut().zip(lands) {
        one.genome = other_land(space, &one.genome, number);
    }
    population
}

/// The numbers of the lands that are best seen from one place.
fn chosen_lands(space: &Space, population: &Population) -> Option<[u32; INDIVIDUALS]> {
    let lights = population.individuals.par_iter().map(|one| Ok(sky::light(&one.genome.read(space)?)));
    let lights = lights.collect::<Result<Vec<SkyLight>, GenomeError>>().ok()?;
    let scores = |numbers: Range<u32>| -> Option<Vec<Lands>> {
        let lands: Vec<(u32, usize)> =
            numbers.flat_map(|number| (0..INDIVIDUALS).map(move |k| (number, k))).collect();
        let scores = lands.par_iter().map(|&(number, k)| {
            let genome = other_land(space, &population.individuals[k].genome, number);
            Some(scores(&Sketch::under(lights[k].clone(), space, &genome, Brush::Fine).ok()?))
        });
        let scores = scores.collect::<Option<Vec<_>>>()?;
        scores.chunks_exact(INDIVIDUALS).map(|four| four.to_vec().try_into().ok()).collect()
    };
    let mut lands = scores(0..1)?;
    if best(&lands).0 >= ENOUGH {
        return None;
    }
    lands.extend(scores(1..LANDS)?);
    Some(best(&lands).1)
}

/// Of the ways to give each of four landscapes one of its lands, the best, and how good the places are that suit the worst of
/// the four best there: a sketch leaves gullies out, so that one place alone is no promise.
fn best(lands: &[Lands]) -> (f32, [u32; INDIVIDUALS]) {
    let ways = lands.len().pow(INDIVIDUALS as u32);
    let way = |way: usize| -> [u32; INDIVIDUALS] {
        std::array::from_fn(|k| (way / lands.len().pow(k as u32) % lands.len()) as u32)
    };
    let score = |way: [u32; INDIVIDUALS]| shared(std::array::from_fn(|k| &lands[way[k] as usize][k][..]));
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
fn scores(sketch: &Sketch) -> Vec<f32> {
    sketch.looks(ONE_IN, LEAST).iter().map(Appraisal::score).collect()
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
        let four = population.individuals.each_ref().map(|one| scores(&sketch(&one.genome)));
        best(&[four]).0
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
        let four = |a: [f32; 2], b: [f32; 2]| [at(a), at(b), at([0.9; 2]), at([0.9; 2])];
        // What is best for each of the first two is the other's worst.
        let lands = [four([0.8, 0.2], [0.1, 0.7]), four([0.5, 0.6], [0.15, 0.5])];
        assert_eq!(best(&lands).1, [1, 0, 0, 0]);
        assert_eq!(best(&lands[..1]).1, [0; INDIVIDUALS]);
    }
}
