//! Crossover: a child of two chromosomes. Groups of genes that belong together come whole from one or the other:
//! form, foliage and placement of trees; shape, water and climate of a land; sun, clouds and air of a sky (`group` in
//! `space.ron`).

use genescape_schema::{Bounds, Category, Chromosome, Space};

use crate::kinds::Home;
use crate::seed::Dice;

/// The child of a favourite and another, and where it may vary. What a person set to a value outside its kind stays, unless
/// its group comes from the other.
///
/// - Of one kind, or of two that mix: groups of either, brought into what these two and all between them allow.
/// - Of two that do not mix, as a palm and an oak: the favourite, with those traits of the other that its own kind may have.
/// - Of a favourite like no kind: groups of either, as they are.
pub fn crossed(
    space: &Space,
    category: Category,
    (best, home): (&Chromosome, Home<'_>),
    (other, other_home): (&Chromosome, Home<'_>),
    dice: &mut Dice,
) -> (Chromosome, Bounds) {
    let is_taken = taken_groups(space, category, dice);
    let own = home.bounds().unwrap_or_else(|| Bounds::whole(space, category));
    let common = if home == Home::Wild { Some(own.clone()) } else { common_ground(home, other_home) };
    let is_mixed = common.is_some();
    let bounds = common.unwrap_or_else(|| own.clone());
    let mut child = best.clone();
    for ((gene, allowed), (_, own)) in bounds.genes(space).zip(own.genes(space)) {
        let (mine, theirs) = (best.code(gene), other.code(gene));
        let code = match is_taken(&gene.group) && !gene.is_seed() {
            true if is_mixed => allowed.nearest(theirs),
            true if allowed.contains(theirs) => theirs,
            _ if own.contains(mine) => allowed.nearest(mine),
            _ => mine,
        };
        child.set_code(gene, code);
    }
    (child, bounds)
}

/// What two parents' kinds and all between them allow, if they are of one kind or of two that mix.
fn common_ground(home: Home<'_>, other: Home<'_>) -> Option<Bounds> {
    let pairs = || home.kinds().flat_map(|a| other.kinds().map(move |b| (a, b)));
    let mixed = pairs().find(|(a, b)| a.id != b.id && a.mixes_with(b));
    let (a, b) = mixed.or_else(|| pairs().find(|(a, b)| a.id == b.id))?;
    Some(a.bounds.hull(&b.bounds))
}

/// Which groups come from the other parent: at least one and, of several, not all.
fn taken_groups(space: &Space, category: Category, dice: &mut Dice) -> impl Fn(&str) -> bool {
    let traits = space.category(category).filter(|gene| !gene.is_seed());
    let mut groups: Vec<String> = traits.map(|gene| gene.group.clone()).collect();
    groups.sort_unstable();
    groups.dedup();
    let mut taken: Vec<bool> = groups.iter().map(|_| dice.chance(0.5)).collect();
    if taken.iter().all(|one| *one == taken[0]) && !taken.is_empty() {
        let at = dice.below(taken.len() as u32) as usize;
        taken[at] = taken.len() == 1 || !taken[at];
    }
    move |group| groups.iter().zip(&taken).any(|(name, taken)| *taken && name == group)
}
