//! What the four have of each category → whole landscapes, in which as much as possible goes together.

use std::cmp::Reverse;

use genescape_schema::{Category, Chromosome, INDIVIDUALS, Kinds, Space};

use crate::kinds::{Company, Home};

/// Orders of all but the first.
const ORDERS: [[usize; INDIVIDUALS]; 6] =
    [[0, 1, 2, 3], [0, 1, 3, 2], [0, 2, 1, 3], [0, 2, 3, 1], [0, 3, 1, 2], [0, 3, 2, 1]];

/// Trees and skies in the order in which no two landscapes are alike, most look different in two parts at least, for one alone
/// hardly makes another place, most parts go together, most have the land and trees of the first, whose light alone is to be
/// baked, and the two that look most alike differ most. All parts of the first, the best guess, stay together. How different
/// two parts look is told by `distance`; they look clearly different from `clearly` on.
pub fn pair(
    space: &Space,
    kinds: &Kinds,
    parts: &mut [Vec<Chromosome>; 3],
    distance: &dyn Fn(Category, &Chromosome, &Chromosome) -> f32,
    clearly: f32,
) {
    let homes: Vec<Vec<Home<'_>>> = Category::ALL
        .into_iter()
        .zip(parts.iter())
        .map(|(category, all)| all.iter().map(|one| Home::of(space, kinds, category, one)).collect())
        .collect();
    let distances: [[[f32; INDIVIDUALS]; INDIVIDUALS]; 3] = Category::ALL.map(|category| {
        let all = &parts[category as usize];
        let between = |a: usize, b: usize| if a == b { 0.0 } else { distance(category, &all[a], &all[b]) };
        std::array::from_fn(|a| std::array::from_fn(|b| between(a, b)))
    });
    let rank = |trees: &[usize; INDIVIDUALS], skies: &[usize; INDIVIDUALS]| {
        let place = |landscape: usize| [trees[landscape], landscape, skies[landscape]];
        let landscape = |number: usize| {
            let place = place(number);
            std::array::from_fn(|category| &parts[category][place[category]])
        };
        let discord = |number: usize| {
            let place = place(number);
            let homes = std::array::from_fn(|category| homes[category][place[category]]);
            Company::discord(space, landscape(number), homes)
        };
        let all: [[&Chromosome; 3]; INDIVIDUALS] = std::array::from_fn(landscape);
        let pairs = || (0..INDIVIDUALS).flat_map(|a| (0..a).map(move |b| (a, b)));
        let alike = pairs().filter(|(a, b)| all[*a] == all[*b]).count();
        let differ = |(a, b): (usize, usize)| -> [f32; 3] {
            let (a, b) = (place(a), place(b));
            std::array::from_fn(|category| distances[category][a[category]][b[category]])
        };
        let differ_in = |pair| differ(pair).iter().filter(|distance| **distance > clearly).count();
        let with = |parts: usize| pairs().filter(|pair| differ_in(*pair) == parts).count();
        let least = pairs().map(|pair| differ(pair).iter().map(|one| one * one).sum::<f32>());
        let least = least.fold(f32::MAX, f32::min);
        let planted = all.iter().filter(|one| one[..2] != all[0][..2]).count();
        let discord: usize = (1..INDIVIDUALS).map(discord).sum();
        // In thousandths, for floats are not ordered.
        (alike, with(0), with(1), discord, planted, Reverse((1000.0 * least) as u32))
    };
    let all = ORDERS.iter().flat_map(|trees| ORDERS.iter().map(move |skies| (trees, skies)));
    let Some((trees, skies)) = all.min_by_key(|(trees, skies)| rank(trees, skies)) else { return };
    for (category, order) in [(Category::Tree, trees), (Category::Sky, skies)] {
        let part = &mut parts[category as usize];
        *part = order.iter().map(|from| part[*from].clone()).collect();
    }
}
