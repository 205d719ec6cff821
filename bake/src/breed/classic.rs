//! The last votes → the next generation: a genetic algorithm on chromosomes as codes.
//!
//! Child 0 unites the favourites. Children 1, 2 and 3 keep the favourite trees, terrain and sky respectively and
//! vary the other two categories, so each shows what a change does beside something known, and the cache has it.
//!
//! What varies stays what it is: steps are those that its kind may stray, crossings are between kinds that mix, and what is
//! new is of a kind that goes with the rest. What is like no kind varies near itself.

use genescape_schema::{
    Bounds, Category, Chromosome, Genome, INDIVIDUALS, Individual, Kind, Kinds, Parent, Population, Space,
    Variety, Votes,
};

use super::descent::{self, Origin};
use super::{cross, locked, step};
use crate::kinds::pick::Picker;
use crate::kinds::{Company, Home, ORDER};
use crate::seed::Dice;

/// Generation `next` from the votes on `parents`; without votes nobody is a favourite.
pub fn bred(space: &Space, kinds: &Kinds, parents: &Population, next: u32) -> Population {
    let generation = parents.generation;
    let votes = parents.votes.unwrap_or_default();
    let family = Family::new(space, kinds, parents, votes);
    let mut newcomers = Vec::new();
    let individuals = std::array::from_fn(|child| family.child(child, &mut newcomers));
    let (variety, locked) = (parents.variety, parents.locked.clone());
    let parent = Some(Parent { generation, votes, variety });
    Population { parent, variety, locked, ..Population::new(next, parents.seed, individuals) }
}

/// The parents, and what is known of them.
struct Family<'a> {
    space: &'a Space,
    kinds: &'a Kinds,
    parents: &'a Population,
    votes: Votes,
    /// By category and parent.
    homes: [[Home<'a>; INDIVIDUALS]; 3],
    /// 1 is the usual.
    variety: f32,
}

/// The least part of the usual pace.
const MIN_PACE: f32 = 0.2;

/// How a child comes by a chromosome, in the order in which they are made: what is free must suit what is not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Role {
    Kept,
    Varied,
    Crossed,
    New,
}

impl<'a> Family<'a> {
    fn new(space: &'a Space, kinds: &'a Kinds, parents: &'a Population, votes: Votes) -> Self {
        let homes = Category::ALL.map(|category| {
            parents
                .individuals
                .each_ref()
                .map(|one| Home::of(space, kinds, category, one.genome.chromosome(category)))
        });
        let variety = parents.variety.unwrap_or(Variety::USUAL).part() / Variety::USUAL.part();
        Self { space, kinds, parents, votes, homes, variety }
    }

    /// The favourite itself for child 0 and for the child that keeps this category; of the other two, the first is a
    /// variation and the second a crossover with another parent.
    fn role(&self, child: usize, category: Category) -> Role {
        let keeper = category as usize + 1;
        let first = if keeper == 1 { 2 } else { 1 };
        match self.votes.favourite(category) {
            _ if self.parents.locked.contains(category.name()) => Role::Kept,
            None => Role::New,
            Some(_) if child == 0 || child == keeper => Role::Kept,
            Some(_) if child == first => Role::Varied,
            // The less variety, the fewer strangers.
            Some(_) if self.variety < 0.5 => Role::Varied,
            Some(_) if self.variety > 1.5 => Role::New,
            Some(_) => Role::Crossed,
        }
    }

    /// How much changes at once.
    fn pace(&self, home: Home<'_>) -> step::Pace {
        let step::Pace { chance, reach } = step::Pace::of(home);
        let scale = self.variety.max(MIN_PACE);
        step::Pace { chance: (chance * scale).min(1.0), reach: (reach * scale).min(1.0) }
    }

    /// A child; `newcomers` are the kinds that those before it have shown, and now those of this one.
    fn child(&self, child: usize, newcomers: &mut Vec<&'a Kind>) -> Individual {
        let mut order = ORDER;
        order.sort_by_key(|category| self.role(child, *category));
        let mut company = Company::new(self.space);
        let mut genome = Genome::zero(self.space);
        let (mut origins, mut homes) = ([Origin::New; 3], [Home::Wild; 3]);
        for category in order {
            let item = u64::from(self.parents.generation) << 8 | (child << 2 | category as usize) as u64;
            let dice = Dice::new(self.parents.seed, "breed", item);
            let (chromosome, origin) =
                Birth { family: self, category, child, company: &company, dice }.give(newcomers);
            let home = Home::of(self.space, self.kinds, category, &chromosome);
            company.add(category, chromosome.clone(), home);
            *genome.chromosome_mut(category) = chromosome;
            (origins[category as usize], homes[category as usize]) = (origin, home);
        }
        let parents = descent::Parents { population: self.parents, chosen: None };
        let name = descent::name(self.kinds, parents, origins, homes);
        Individual { name, descent: descent::descent(parents, origins), genome }
    }

    fn parent(&self, category: Category, index: usize) -> (&'a Chromosome, Home<'a>) {
        (self.parents.individuals[index].genome.chromosome(category), self.homes[category as usize][index])
    }
}

/// Makes one chromosome of one child.
struct Birth<'a, 'b> {
    family: &'b Family<'a>,
    category: Category,
    child: usize,
    /// What the child has already.
    company: &'b Company<'a>,
    dice: Dice,
}

/// Tries until a chromosome differs from all parents', which the person has seen.
const TRIES: u32 = 8;

impl<'a> Birth<'a, '_> {
    fn give(mut self, newcomers: &mut Vec<&'a Kind>) -> (Chromosome, Origin) {
        let kept = locked::source(self.family.votes, self.category, self.child);
        let (mut chromosome, origin) = match self.family.role(self.child, self.category) {
            Role::Kept => (self.family.parent(self.category, kept).0.clone(), Origin::Of(kept)),
            Role::Varied => self.varied(kept),
            Role::Crossed => self.crossed(kept),
            Role::New => (self.newcomer(newcomers), Origin::New),
        };
        locked::keep(self.family.space, self.family.parents, self.category, kept, &mut chromosome);
        (chromosome, origin)
    }

    /// As the favourite, with some steps within what its kind may be; it stays the same individual. Where there is nothing
    /// to step to, another one.
    fn varied(&mut self, favourite: usize) -> (Chromosome, Origin) {
        let (best, home) = self.family.parent(self.category, favourite);
        let mut bounds = home.bounds().unwrap_or_else(|| Bounds::whole(self.family.space, self.category));
        self.company.demand(&mut bounds);
        match self.fresh(|birth| birth.stepped(best, &bounds, birth.family.pace(home))) {
            Some(varied) => (varied, Origin::Like(favourite)),
            None => (self.another(best), Origin::Another(favourite)),
        }
    }

    /// From the favourite and a parent whose kind mixes with its own or, where there is none, something new that does: else
    /// a population that agrees would become four times the same. Another individual, as children are. See [`cross`].
    fn crossed(&mut self, favourite: usize) -> (Chromosome, Origin) {
        let (_, home) = self.family.parent(self.category, favourite);
        let of = |index: usize| self.family.parent(self.category, index).1;
        let others: Vec<usize> = (0..INDIVIDUALS).filter(|&index| index != favourite).collect();
        let mixes = |index: &usize| {
            home.main().is_some_and(|kind| of(*index).kinds().any(|other| is_apart(kind, other)))
        };
        let mixing: Vec<usize> = others.iter().copied().filter(mixes).collect();
        if mixing.is_empty()
            && let Some(kind) = home.main()
            && let Some((stranger, home)) = self.stranger(kind)
        {
            return (self.child_of(favourite, (&stranger, home)), Origin::Widened(favourite));
        }
        let candidates = if mixing.is_empty() { others } else { mixing };
        let other = *self.dice.one(&candidates).unwrap_or(&favourite);
        let parent = self.family.parent(self.category, other);
        (self.child_of(favourite, parent), Origin::Crossed(favourite, other))
    }

    /// A member of a kind that mixes with this one, and goes with the rest of the child.
    fn stranger(&mut self, kind: &Kind) -> Option<(Chromosome, Home<'a>)> {
        let Family { space, kinds, .. } = *self.family;
        let pool = kinds.iter().filter(|other| is_apart(kind, other));
        let picker = Picker { space, kinds, pool: pool.collect() };
        let picked = picker.pick(self.category, self.company, &[], &mut self.dice)?;
        picked.suits.then_some((picked.chromosome, picked.home))
    }

    fn child_of(&mut self, favourite: usize, other: (&Chromosome, Home<'_>)) -> Chromosome {
        let (best, home) = self.family.parent(self.category, favourite);
        let space = self.family.space;
        let (child, mut bounds) = cross::crossed(space, self.category, (best, home), other, &mut self.dice);
        self.company.demand(&mut bounds);
        let pace = self.family.pace(home);
        let child = self.stepped(&child, &bounds, step::Pace { chance: 0.5 * pace.chance, ..pace });
        self.another(&child)
    }

    /// Of a kind that neither the parents nor the children before have shown, and that goes with the rest of this child.
    fn newcomer(&mut self, newcomers: &mut Vec<&'a Kind>) -> Chromosome {
        let Family { space, kinds, homes, .. } = *self.family;
        let shown = homes[self.category as usize].into_iter().flat_map(Home::kinds);
        let seen: Vec<&Kind> = shown.chain(newcomers.iter().copied()).collect();
        let picker = Picker { space, kinds, pool: kinds.iter().collect() };
        if let Some(picked) = picker.pick(self.category, self.company, &seen, &mut self.dice) {
            newcomers.extend(picked.home.main());
            // A narrow kind that a parent is of may give its very individual.
            let is_seen = self.is_seen(&picked.chromosome);
            return if is_seen { self.another(&picked.chromosome) } else { picked.chromosome };
        }
        // Without any kind: from two parents, much changed.
        let mother = self.dice.below(INDIVIDUALS as u32) as usize;
        let father = (mother + 1 + self.dice.below(INDIVIDUALS as u32 - 1) as usize) % INDIVIDUALS;
        let parent = |index| self.family.parent(self.category, index);
        let (child, bounds) =
            cross::crossed(space, self.category, parent(mother), parent(father), &mut self.dice);
        let child = self.another(&child);
        step::stepped(space, &child, &bounds, step::Pace::STRONG, &mut self.dice)
    }

    fn stepped(&mut self, from: &Chromosome, bounds: &Bounds, pace: step::Pace) -> Chromosome {
        step::stepped(self.family.space, from, bounds, pace, &mut self.dice)
    }

    /// What `make` makes, when it differs from all parents'; a narrow kind may not allow that.
    fn fresh(&mut self, mut make: impl FnMut(&mut Self) -> Chromosome) -> Option<Chromosome> {
        (0..TRIES).find_map(|_| {
            let chromosome = make(self);
            (!self.is_seen(&chromosome)).then_some(chromosome)
        })
    }

    fn is_seen(&self, chromosome: &Chromosome) -> bool {
        (0..INDIVIDUALS).any(|index| self.family.parent(self.category, index).0 == chromosome)
    }

    /// Another individual with the same genes.
    fn another(&mut self, from: &Chromosome) -> Chromosome {
        let mut chromosome = from.clone();
        for seed in self.family.space.category(self.category).filter(|gene| gene.is_seed()) {
            let code = (from.code(seed) + 1 + self.dice.below(seed.last_code())) % (seed.last_code() + 1);
            chromosome.set_code(seed, code);
        }
        chromosome
    }
}

/// Whether two kinds mix and are not the same.
fn is_apart(kind: &Kind, other: &Kind) -> bool {
    kind.id != other.id && kind.mixes_with(other)
}
