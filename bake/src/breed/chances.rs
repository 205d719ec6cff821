//! What is known of a person → how they may vote on landscapes that they have not voted on yet.

use genescape_schema::{Category, INDIVIDUALS, Kinds, Population, Space, Votes};
use rayon::prelude::*;

use super::evidence::point;
use super::learned::Taste;

/// All votes that name a favourite in each category, the likeliest first. `past` holds the populations that were voted
/// on, in the order of generations.
///
/// The first of them name each landscape once in each category: whatever is voted for, something of it is among these.
pub fn likely_votes(space: &Space, kinds: &Kinds, past: &[Population], shown: &Population) -> Vec<Votes> {
    let chances: Vec<[f32; INDIVIDUALS]> =
        Category::ALL.par_iter().map(|category| chances(space, kinds, past, shown, *category)).collect();
    let orders = chances.iter().map(|chances| {
        let mut order: [usize; INDIVIDUALS] = std::array::from_fn(|landscape| landscape);
        order.sort_by(|a, b| chances[*b].total_cmp(&chances[*a]));
        order
    });
    let orders: Vec<[usize; INDIVIDUALS]> = orders.collect();
    // Places in these orders, of trees, land and sky.
    let places = (0..INDIVIDUALS * INDIVIDUALS * INDIVIDUALS)
        .map(|k| [k % INDIVIDUALS, k / INDIVIDUALS % INDIVIDUALS, k / (INDIVIDUALS * INDIVIDUALS)]);
    let (mut first, mut others): (Vec<[usize; 3]>, Vec<_>) =
        places.partition(|[tree, terrain, sky]| tree == terrain && terrain == sky);
    let chance =
        |places: &[usize; 3]| -> f32 { (0..3).map(|of| chances[of][orders[of][places[of]]]).product() };
    others.sort_by(|a, b| chance(b).total_cmp(&chance(a)));
    first.append(&mut others);
    let votes = first.into_iter().map(|places| {
        let [tree, terrain, sky] = [0, 1, 2].map(|of| Some(orders[of][places[of]]));
        Votes { tree, terrain, sky }
    });
    votes.collect()
}

/// Of one category: how likely each landscape is the favourite.
fn chances(
    space: &Space,
    kinds: &Kinds,
    past: &[Population],
    shown: &Population,
    category: Category,
) -> [f32; INDIVIDUALS] {
    let taste = Taste::of(space, kinds, category, &past.iter().collect::<Vec<_>>());
    let points =
        shown.individuals.each_ref().map(|one| point(space, category, one.genome.chromosome(category)));
    let mut chances = [0.0; INDIVIDUALS];
    for ideal in &taste.ideals {
        let missed = points.each_ref().map(|point| ideal.missed(&taste.prior, point));
        let least = missed.into_iter().fold(f32::INFINITY, f32::min);
        let weights = missed.map(|missed| libm::expf(least - missed));
        let sum: f32 = weights.iter().sum();
        chances.iter_mut().zip(weights).for_each(|(chance, weight)| *chance += weight / sum);
    }
    chances.map(|chance| chance / taste.ideals.len() as f32)
}
