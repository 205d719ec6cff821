//! What the four have of each category → whole landscapes, in which as much as possible goes together.

use genescape_schema::{Category, Chromosome, INDIVIDUALS, Kinds, Space};

use crate::kinds::{Company, Home};

/// Orders of all but the first.
const ORDERS: [[usize; INDIVIDUALS]; 6] =
    [[0, 1, 2, 3], [0, 1, 3, 2], [0, 2, 1, 3], [0, 2, 3, 1], [0, 3, 1, 2], [0, 3, 2, 1]];

/// Trees and skies in the order in which no two landscapes are alike, most look different in two parts at least, for one alone
/// hardly makes another place, most parts go together, and most have the land and trees of the first, whose light alone is to
/// be baked. All parts of the first, the best guess, stay together.
pub fn pair(
    space: &Space,
    kinds: &Kinds,
    parts: &mut [Vec<Chromosome>; 3],
    stands_out: &dyn Fn(Category, &Chromosome, &Chromosome) -> bool,
) {
    let homes: Vec<Vec<Home<'_>>> = Category::ALL
        .into_iter()
        .zip(parts.iter())
        .map(|(category, all)| all.iter().map(|one| Home::of(space, kinds, category, one)).collect())
        .collect();
    let looks_different: [[[bool; INDIVIDUALS]; INDIVIDUALS]; 3] = Category::ALL.map(|category| {
        let all = &parts[category as usize];
        std::array::from_fn(|a| std::array::from_fn(|b| a != b && stands_out(category, &all[a], &all[b])))
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
            discord(space, landscape(number), homes)
        };
        let all: [[&Chromosome; 3]; INDIVIDUALS] = std::array::from_fn(landscape);
        let pairs = || (0..INDIVIDUALS).flat_map(|a| (0..a).map(move |b| (a, b)));
        let alike = pairs().filter(|(a, b)| all[*a] == all[*b]).count();
        let differ_in = |(a, b): (usize, usize)| {
            let (a, b) = (place(a), place(b));
            (0..3).filter(|category| looks_different[*category][a[*category]][b[*category]]).count()
        };
        let with = |parts: usize| pairs().filter(|pair| differ_in(*pair) == parts).count();
        let planted = all.iter().filter(|one| one[..2] != all[0][..2]).count();
        (alike, with(0), with(1), (1..INDIVIDUALS).map(discord).sum::<usize>(), planted)
    };
    let all = ORDERS.iter().flat_map(|trees| ORDERS.iter().map(move |skies| (trees, skies)));
    let Some((trees, skies)) = all.min_by_key(|(trees, skies)| rank(trees, skies)) else { return };
    for (category, order) in [(Category::Tree, trees), (Category::Sky, skies)] {
        let part = &mut parts[category as usize];
        *part = order.iter().map(|from| part[*from].clone()).collect();
    }
}

/// How many of a landscape's kinds do not go with its other parts.
fn discord(space: &Space, parts: [&Chromosome; 3], homes: [Home<'_>; 3]) -> usize {
    let disagrees = |category: &Category| {
        let company = Company::beside(space, *category, parts, homes);
        homes[*category as usize].kinds().any(|kind| !company.suits(kind))
    };
    Category::ALL.iter().filter(|category| disagrees(category)).count()
}
