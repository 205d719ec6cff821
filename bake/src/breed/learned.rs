//! Votes of all generations → the next one: a model of what the person wants says which four to show.
//!
//! The first landscape is the best guess at what is wanted, and the others differ so that the next choice tells most. Of
//! what is like no kind, four generations of five only ask: all four differ, for beside a good guess nothing else is
//! chosen, and little is learned.

use genescape_schema::{
    Bounds, Category, Chromosome, Genome, INDIVIDUALS, Individual, Kinds, Parent, Population, Space, Variety,
    Votes,
};
use rayon::prelude::*;

use super::Chosen;
use super::descent::{self, Origin};
use super::evidence::{Evidence, point};
use super::locked;
use super::pairing::pair;
use super::places::Settings;
use super::prior::Prior;
use super::spread::{Mean, Spread};
use super::taste::{Ideal, ideals};
use super::variety::Varied;
use crate::kinds::{Company, Home, ORDER};
use crate::phenotype::visibility::{Seen, Visibility};
use crate::seed::Dice;

/// Of what is like no kind, the best guess is shown once in so many generations.
const GUESSES_EVERY: u32 = 5;

/// From here on two of a category look clearly different, where 1 is what two landscapes by chance differ by. Relatives are 0.1 to 0.4
/// apart, members of different kinds mostly 0.7 and more. Among what goes together much is similar: at 1.0 four of one climate
/// now and then look like two places.
const CLEARLY_DIFFERENT: f32 = 1.1;

/// Votes after which new chromosomes cost something: before, who has seen little sees as much as there is.
const SETTLING: usize = 6;
/// What a new chromosome of each category must tell, in nats, to be shown instead of the best guess: 0.05 for each stage that
/// runs for it, which are textures and templates of trees, the land and its mesh, the sky's light and pictures, and about two
/// of those that read several categories. More makes later guesses worse, less bakes more.
const NEW_COSTS: [f32; 3] = [0.4, 0.2, 0.2];

/// What is known of somebody who voted so.
pub struct Learned<'a> {
    space: &'a Space,
    kinds: &'a Kinds,
    parents: &'a Population,
    votes: Votes,
    /// Whether a person chose the parents: then they are the best guess.
    chosen: Option<&'a Chosen>,
    tastes: Vec<Taste<'a>>,
}

/// Of one category.
pub struct Taste<'a> {
    pub prior: Prior<'a>,
    pub ideals: Vec<Ideal>,
    means: Vec<Mean>,
    /// How many votes it rests on.
    pub votes: usize,
    /// What was chosen, the latest last.
    chosen: Vec<Chromosome>,
}

impl<'a> Taste<'a> {
    /// What votes on these populations say, which are in the order of generations.
    pub fn of(space: &Space, kinds: &'a Kinds, category: Category, populations: &[&Population]) -> Self {
        let evidence = Evidence::of(space, kinds, category, populations);
        let prior = Prior::of(space, kinds, category, &evidence);
        let Evidence { choices, chosen, .. } = evidence;
        let kind = chosen.last().and_then(|one| Home::of(space, kinds, category, one).id());
        let seen = Visibility::shipped().log_weights(space, category, kind);
        let ideals = plausible(&prior, ideals(&prior, &choices, &seen));
        let means = Mean::all(&prior, &ideals);
        Self { prior, ideals, means, votes: choices.len(), chosen }
    }
}

impl<'a> Learned<'a> {
    /// `past` holds the populations before `parents`, in the order of generations.
    pub fn new(
        space: &'a Space,
        kinds: &'a Kinds,
        past: &[Population],
        parents: &'a Population,
        votes: Votes,
        chosen: Option<&'a Chosen>,
    ) -> Self {
        let voted = Population { votes: Some(votes), ..parents.clone() };
        let all: Vec<&Population> = past.iter().chain([&voted]).collect();
        let of = |category: &Category| Taste::of(space, kinds, *category, &all);
        let tastes = Category::ALL.par_iter().map(of).collect();
        Self { space, kinds, parents, votes, chosen, tastes }
    }

    /// Generation `next`, where chance depends on `seed`.
    pub fn bred(&self, next: u32, seed: u64) -> Population {
        let mut parts: [Vec<Chromosome>; 3] = Default::default();
        for category in ORDER {
            let mut four = self.part(category, next, seed, &self.settings(category, &parts));
            four.iter_mut().enumerate().for_each(|(child, one)| self.keep_locked(category, child, one));
            parts[category as usize] = four;
        }
        let distance = |category, a: &_, b: &_| {
            let [at_a, at_b] = [a, b].map(|one| point(self.space, category, one));
            let [a, b] =
                [(a, &at_a), (b, &at_b)].map(|(one, at)| Seen { at, kind: self.kind(category, one) });
            self.distance(category, a, b)
        };
        pair(self.space, self.kinds, &mut parts, &distance, CLEARLY_DIFFERENT);
        let individuals = std::array::from_fn(|child| {
            let chromosomes = parts.each_ref().map(|part| part[child].clone());
            self.individual(child, chromosomes)
        });
        let Population { generation, seed, variety, ref locked, .. } = *self.parents;
        let parent = Some(Parent { generation, votes: self.votes, variety });
        Population { parent, variety, locked: locked.clone(), ..Population::new(next, seed, individuals) }
    }

    /// Four of what votes leave possible, by chance.
    pub fn sampled(&self, next: u32, seed: u64) -> Population {
        let mut dice = Dice::new(seed, "samples", next.into());
        let mut any = |category: Category| {
            let taste = &self.tastes[category as usize];
            dice.one(&taste.ideals).map(|ideal| self.member(category, ideal))
        };
        let mut individuals = self.parents.individuals.clone();
        for one in &mut individuals {
            for category in Category::ALL {
                if let Some(chromosome) = any(category) {
                    *one.genome.chromosome_mut(category) = chromosome;
                }
            }
        }
        Population::new(next, seed, individuals)
    }

    pub fn taste(&self, category: Category) -> &Taste<'a> {
        &self.tastes[category as usize]
    }

    /// What a sample wants, as a chromosome of its kind; its seed is 0.
    pub fn member(&self, category: Category, ideal: &Ideal) -> Chromosome {
        let mut at = ideal.at.clone();
        self.legalise(category, ideal.component, &mut at);
        self.encoded(category, &at)
    }

    /// What parts of one category are to go with, where the four have these others so far. Of what they do not have yet, the
    /// favourite stands in the second landscape, so that it is seen again with what goes with it: in the first it stands with
    /// the other favourites, whatever goes with it.
    fn settings(&self, category: Category, parts: &[Vec<Chromosome>; 3]) -> Settings<'a> {
        let companies = std::array::from_fn(|landscape| {
            let mut company = Company::new(self.space);
            for other in Category::ALL.into_iter().filter(|other| *other != category) {
                let favourite = self.tastes[other as usize].chosen.last();
                let is_there = landscape == 1 || self.is_locked(other);
                let part = parts[other as usize].get(landscape).or(favourite.filter(|_| is_there));
                if let Some(part) = part {
                    company.add(other, part.clone(), Home::of(self.space, self.kinds, other, part));
                }
            }
            company
        });
        Settings { companies }
    }

    /// What the four have of one category. Seeds of what is no longer the favourite's kind are another individual's.
    fn part(&self, category: Category, next: u32, seed: u64, settings: &Settings<'_>) -> Vec<Chromosome> {
        let taste = &self.tastes[category as usize];
        let item = u64::from(next) << 2 | category as u64;
        let mut dice = Dice::new(seed, "spread", item);
        let legal = |component: usize, at: &mut Vec<f32>| self.legalise(category, component, at);
        let known: Vec<Vec<f32>> = taste.chosen.iter().map(|one| point(self.space, category, one)).collect();
        let home = |at: &[f32]| Home::of(self.space, self.kinds, category, &self.encoded(category, at));
        let stands_out = |a: Seen<'_>, b: Seen<'_>| self.distance(category, a, b) > CLEARLY_DIFFERENT;
        let variety = self.parents.variety.unwrap_or(Variety::USUAL);
        let is_settling = taste.votes >= SETTLING && variety == Variety::USUAL && !taste.prior.is_wild();
        let spread = Spread {
            prior: &taste.prior,
            ideals: &taste.ideals,
            means: &taste.means,
            legal: &legal,
            home: &home,
            settings,
            repeats: is_settling,
            stands_out: &stands_out,
        };
        let favourite = known.last().map(|one| spread.kind(one));
        let is_like = |at: &[f32]| Some(spread.kind(at)) == favourite;
        let mut four = match (self.chosen, known.last()) {
            (Some(_), Some(chosen)) => vec![chosen.clone()],
            _ if self.asks(category, next) => Vec::new(),
            _ => vec![spread.best(&known, &is_like)],
        };
        let mut others = spread.others(&four, &mut dice);
        if let Some(best) = four.first().filter(|_| is_settling) {
            others = spread.sparing(best, others, NEW_COSTS[category as usize], self.least_new(category));
        }
        four.extend(Varied { spread: &spread }.others(variety, &four, others, &mut dice));
        let mut made: Vec<Chromosome> = Vec::new();
        for one in &four {
            let same = four.iter().zip(&made).find(|(other, _)| *other == one).map(|(_, made)| made.clone());
            made.push(same.unwrap_or_else(|| self.chromosome(category, one, &mut dice)));
        }
        made
    }

    /// How many new ones of a category there are, at least. Three in all differ from the first landscape: what is locked, the
    /// category makes up for that costs least.
    fn least_new(&self, category: Category) -> usize {
        let mut open: Vec<Category> = Category::ALL.to_vec();
        open.retain(|one| !self.is_locked(*one));
        let is_cheapest = open.last() == Some(&category);
        if is_cheapest { INDIVIDUALS - open.len() } else { 1 }
    }

    fn is_locked(&self, category: Category) -> bool {
        self.parents.locked.contains(category.name())
    }

    /// Whether all four are for asking: not where close variations are wanted. Kinds say so much of what may be wanted that
    /// there a choice tells enough anyway.
    fn asks(&self, category: Category, next: u32) -> bool {
        let is_usual = self.parents.variety.is_none_or(|variety| variety >= Variety::USUAL);
        is_usual && !next.is_multiple_of(GUESSES_EVERY) && self.tastes[category as usize].prior.is_wild()
    }

    /// Whole codes, of the component's kind.
    fn legalise(&self, category: Category, component: usize, at: &mut [f32]) {
        let bounds = self.tastes[category as usize].prior.component(component).bounds.as_ref();
        let mut allowed = bounds.map(|bounds| bounds.genes(self.space).filter(|(gene, _)| !gene.is_seed()));
        for (gene, x) in self.space.traits(category).zip(at) {
            let code = gene.code_at(*x);
            let near =
                allowed.as_mut().and_then(Iterator::next).map_or(code, |(_, allowed)| allowed.nearest(code));
            *x = gene.part(near);
        }
    }

    /// What was chosen before where it is that; else with the favourite's seed, unless it is of another kind.
    fn chromosome(&self, category: Category, at: &[f32], dice: &mut Dice) -> Chromosome {
        let chosen = &self.tastes[category as usize].chosen;
        let mut new = self.encoded(category, at);
        let is_same =
            |one: &&Chromosome| self.space.traits(category).all(|gene| one.code(gene) == new.code(gene));
        if let Some(known) = chosen.iter().rev().find(is_same) {
            return known.clone();
        }
        let kind = self.kind(category, &new);
        let like = chosen.last().filter(|favourite| self.kind(category, favourite) == kind);
        if let Some(favourite) = like {
            self.keep_what_was_meant(category, favourite, &mut new);
        }
        for gene in self.space.category(category).filter(|gene| gene.is_seed()) {
            new.set_code(gene, like.map_or_else(|| dice.below(gene.last_code() + 1), |like| like.code(gene)));
        }
        new
    }

    fn encoded(&self, category: Category, at: &[f32]) -> Chromosome {
        let mut chromosome = Chromosome::zero(self.space, category);
        self.space.traits(category).zip(at).for_each(|(gene, x)| chromosome.set_code(gene, gene.code_at(*x)));
        chromosome
    }

    /// What a chromosome is like most.
    fn kind(&self, category: Category, chromosome: &Chromosome) -> Option<&'a str> {
        Home::of(self.space, self.kinds, category, chromosome).id()
    }

    /// How different two parts look.
    fn distance(&self, category: Category, a: Seen<'_>, b: Seen<'_>) -> f32 {
        Visibility::shipped().distance(self.space, category, a, b)
    }

    /// Genes that the favourite has outside its kind: a person set them.
    fn keep_what_was_meant(&self, category: Category, favourite: &Chromosome, new: &mut Chromosome) {
        let Some(bounds) = Home::of(self.space, self.kinds, category, favourite).bounds() else { return };
        for (gene, allowed) in bounds.genes(self.space) {
            if !gene.is_seed() && !allowed.contains(favourite.code(gene)) {
                new.set_code(gene, favourite.code(gene));
            }
        }
    }

    fn homes(&self, parts: [&Chromosome; 3]) -> [Home<'a>; 3] {
        Category::ALL.map(|category| Home::of(self.space, self.kinds, category, parts[category as usize]))
    }

    fn individual(&self, child: usize, mut parts: [Chromosome; 3]) -> Individual {
        // What somebody chose stays as it is, whatever goes with it.
        if child > 0 {
            self.reconcile(&mut parts);
        }
        for (category, part) in Category::ALL.into_iter().zip(&mut parts) {
            self.keep_locked(category, child, part);
        }
        let homes = self.homes(parts.each_ref());
        let origins = Category::ALL.map(|category| self.origin(category, &parts[category as usize], homes));
        let chosen = self.chosen.map(|chosen| &chosen.names);
        let parents = descent::Parents { population: self.parents, chosen };
        let name = descent::name(self.kinds, parents, origins, homes);
        Individual {
            name,
            descent: descent::descent(parents, origins),
            genome: Genome { chromosomes: parts },
        }
    }

    fn keep_locked(&self, category: Category, child: usize, part: &mut Chromosome) {
        let from = locked::source(self.votes, category, child);
        locked::keep(self.space, self.parents, category, from, part);
    }

    /// Moves genes to what the other parts go with, as far as their kinds may be that.
    fn reconcile(&self, parts: &mut [Chromosome; 3]) {
        for category in ORDER {
            let homes = self.homes(parts.each_ref());
            let company = Company::beside(self.space, category, parts.each_ref(), homes);
            let mut bounds =
                homes[category as usize].bounds().unwrap_or_else(|| Bounds::whole(self.space, category));
            let free = bounds.clone();
            company.demand(&mut bounds);
            let part = &mut parts[category as usize];
            for ((gene, demanded), (_, free)) in bounds.genes(self.space).zip(free.genes(self.space)) {
                if demanded != free && !gene.is_seed() {
                    part.set_code(gene, demanded.nearest(part.code(gene)));
                }
            }
        }
    }

    fn origin(&self, category: Category, part: &Chromosome, homes: [Home<'_>; 3]) -> Origin {
        let parent = |index: usize| self.parents.individuals[index].genome.chromosome(category);
        if let Some(same) = (0..INDIVIDUALS).find(|index| parent(*index) == part) {
            return Origin::Of(same);
        }
        let kind = homes[category as usize].id();
        let favourite = self.votes.favourite(category);
        let like = favourite.filter(|vote| self.kind(category, parent(*vote)) == kind);
        like.map_or(Origin::New, Origin::Like)
    }
}

/// Without what is like no kind, unless most is.
fn plausible(prior: &Prior<'_>, mut ideals: Vec<Ideal>) -> Vec<Ideal> {
    let is_wild = |ideal: &Ideal| prior.component(ideal.component).bounds.is_none();
    if 2 * ideals.iter().filter(|one| is_wild(one)).count() < ideals.len() {
        ideals.retain(|one| !is_wild(one));
    }
    ideals
}
