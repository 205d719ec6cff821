//! The next part of a landscape: a kind that goes with the parts that are there, and is not what was seen before.

use genescape_schema::{Category, Chromosome, Kind, Kinds, Space};

use super::{Company, Home, draw};
use crate::seed::Dice;

/// Chance that what is drawn lies between two kinds, where two mix.
const BLEND: f32 = 0.25;
/// How far such a one is from the first kind, as a part of the way to the other: at least, and at most.
const BLEND_PARTS: (f32, f32) = (0.15, 0.5);
/// Kinds overlap: what is drawn of one may be more typical of another. Tries until it is not.
const TRIES: u32 = 8;

/// What a part is drawn from.
pub struct Picker<'a> {
    pub space: &'a Space,
    /// All kinds, by which chromosomes are recognised.
    pub kinds: &'a Kinds,
    /// Those that may be drawn.
    pub pool: Vec<&'a Kind>,
}

/// A part that was drawn.
pub struct Picked<'a> {
    pub chromosome: Chromosome,
    pub home: Home<'a>,
    /// Whether it is recognised as of the kind that it was drawn from, and that was not seen before.
    pub is_new: bool,
    /// Whether it goes with the rest.
    pub suits: bool,
}

impl<'a> Picker<'a> {
    /// A member of a kind that goes with `company` and, if there is one, was not seen. Those that share no group with what
    /// was seen come first. `None` if the pool has no kind of that category.
    pub fn pick(
        &self,
        category: Category,
        company: &Company<'a>,
        seen: &[&Kind],
        dice: &mut Dice,
    ) -> Option<Picked<'a>> {
        let all: Vec<&Kind> = self.pool.iter().copied().filter(|kind| kind.category == category).collect();
        let suitable: Vec<&Kind> = all.iter().copied().filter(|kind| company.suits(kind)).collect();
        let suits = !suitable.is_empty();
        let candidates = if suits { suitable } else { all };
        let newest = candidates.iter().map(|kind| familiarity(kind, seen)).min()?;
        let freshest: Vec<&Kind> =
            candidates.iter().copied().filter(|kind| familiarity(kind, seen) == newest).collect();
        let kind = *dice.one(&freshest)?;
        let partners: Vec<&Kind> = candidates
            .into_iter()
            .filter(|other| other.id != kind.id && kind.mixes_with(other) && !is_in(seen, other))
            .collect();
        let other = dice.chance(BLEND).then(|| dice.one(&partners).copied()).flatten();
        let (chromosome, home) = self.draw(kind, other, company, dice);
        let is_new = is_of(home, kind) && !is_in(seen, kind);
        Some(Picked { chromosome, home, is_new, suits })
    }

    /// A member of a kind, or something between it and another, that is recognised as such.
    fn draw(
        &self,
        kind: &'a Kind,
        other: Option<&'a Kind>,
        company: &Company<'a>,
        dice: &mut Dice,
    ) -> (Chromosome, Home<'a>) {
        let mut tries = 0;
        loop {
            let mut bounds = match other {
                Some(other) => {
                    let part = BLEND_PARTS.0 + (BLEND_PARTS.1 - BLEND_PARTS.0) * dice.unit();
                    kind.bounds.blend(&other.bounds, part)
                }
                None => kind.bounds.clone(),
            };
            company.demand(&mut bounds);
            let chromosome = draw::member(self.space, &bounds, dice);
            let home = Home::of(self.space, self.kinds, kind.category, &chromosome);
            tries += 1;
            if is_of(home, kind) && company.suits_all(home) || tries == TRIES {
                return (chromosome, home);
            }
        }
    }
}

/// How much of a kind was seen: itself counts more than any number of its relatives.
fn familiarity(kind: &Kind, seen: &[&Kind]) -> usize {
    let itself = seen.iter().filter(|one| one.id == kind.id && one.category == kind.category).count();
    itself * 1000 + seen.iter().filter(|one| one.mixes_with(kind)).count()
}

fn is_of(home: Home<'_>, kind: &Kind) -> bool {
    home.main().is_some_and(|main| main.id == kind.id)
}

fn is_in(seen: &[&Kind], kind: &Kind) -> bool {
    seen.iter().any(|one| one.id == kind.id && one.category == kind.category)
}
