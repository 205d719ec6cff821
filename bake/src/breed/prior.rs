//! What somebody may want before any vote: a member of some kind, something between two that mix, or anything.

use genescape_schema::{Allowed, Bounds, Category, Kind, Kinds, Parameter, Scale, Space};

use super::evidence::Evidence;
use crate::kinds::Home;
use crate::seed::Dice;

/// Steps in which densities over 0 … 1 are tabulated.
const BINS: usize = 64;
/// How much of the prior lies between kinds, and how far from the first of the two.
const BLENDS: f32 = 0.25;
const BLEND_PART: f32 = 0.33;
/// What is like no kind is at most so much of it, where there are kinds.
const MAX_WILD: f32 = 0.98;
/// How much less likely a kind is of which nothing was ever chosen and something passed over when none of four pleased.
const REJECTED: f32 = 0.1;
/// Of a kind's density: what is typical, what is allowed, and what is neither.
const TYPICAL: f32 = 0.7;
const STRAYED: f32 = 0.02;

/// A mixture of components. In each, genes are independent of each other.
pub struct Prior<'a> {
    components: Vec<Component<'a>>,
    /// Of genes whose values are names, the last code.
    choices: Vec<Option<f32>>,
    /// The share of all components up to each.
    shares: Vec<f32>,
}

/// A kind, a blend of two, or what is wild.
pub struct Component<'a> {
    pub home: Home<'a>,
    /// Of its home: `None` for what is wild.
    pub bounds: Option<Bounds>,
    log_share: f32,
    genes: Vec<Density>,
}

/// A density over 0 … 1.
struct Density {
    /// Logarithms, a value for each bin.
    log: Vec<f32>,
    /// The probability of all bins up to each.
    up_to: Vec<f32>,
}

impl Density {
    /// Of any weights for the bins.
    fn new(mut weights: Vec<f32>) -> Self {
        let sum: f32 = weights.iter().sum();
        weights.iter_mut().for_each(|weight| *weight /= sum);
        let log = weights.iter().map(|weight| libm::logf(weight * BINS as f32)).collect();
        let up_to = weights.iter().scan(0.0, |sum, weight| {
            *sum += weight;
            Some(*sum)
        });
        Self { up_to: up_to.collect(), log }
    }

    fn flat() -> Self {
        Self::new(vec![1.0; BINS])
    }

    /// Of what a kind allows a gene.
    fn of(gene: &Parameter, allowed: &Allowed) -> Self {
        let last = gene.last_code() as f32;
        let centre = |bin: usize| (bin as f32 + 0.5) / BINS as f32 * last;
        let mut weights = vec![STRAYED / BINS as f32; BINS];
        let mut add = |share: f32, weigh: &dyn Fn(f32) -> f32| {
            let all: Vec<f32> = (0..BINS).map(|bin| weigh(centre(bin)).max(0.0)).collect();
            let sum: f32 = all.iter().sum();
            weights.iter_mut().zip(all).for_each(|(weight, one)| *weight += share * one / sum.max(1e-9));
        };
        // A code is as wide as what is nearest to it, and a bin at least.
        let half = (0.5f32).max(0.5 * last / BINS as f32);
        match allowed {
            Allowed::OneOf(codes) => add(1.0, &|code| {
                codes.iter().map(|one| f32::from((code - *one as f32).abs() <= half)).sum::<f32>()
            }),
            Allowed::Anywhere { min, max } => {
                add(1.0, &|code| f32::from(code >= *min as f32 - half && code <= *max as f32 + half));
            }
            Allowed::Near { min, typical, max } => {
                let (low, middle, high) = (*min as f32 - half, *typical as f32, *max as f32 + half);
                add(TYPICAL, &|code| {
                    let room = 0.7 * if code < middle { middle - low } else { high - middle };
                    1.0 - (code - middle).abs() / room.max(half)
                });
                add(1.0 - TYPICAL, &|code| f32::from(code >= low && code <= high));
            }
        }
        Self::new(weights)
    }

    fn draw(&self, dice: &mut Dice) -> f32 {
        let part = dice.unit();
        let bin = self.up_to.partition_point(|sum| *sum <= part).min(BINS - 1);
        (bin as f32 + dice.unit()) / BINS as f32
    }
}

impl<'a> Prior<'a> {
    /// Kinds and their blends, alike but for those that were shown when none of the four pleased. As much is wild as
    /// of what was shown so far.
    pub fn of(space: &Space, kinds: &'a Kinds, category: Category, evidence: &Evidence) -> Self {
        let genes: Vec<&Parameter> = space.traits(category).collect();
        let of = |bounds: &Bounds| -> Vec<Density> {
            let all = bounds.genes(space).filter(|(gene, _)| !gene.is_seed());
            all.map(|(gene, allowed)| Density::of(gene, allowed)).collect()
        };
        let all: Vec<_> = kinds.of(category).collect();
        let wild = if all.is_empty() { 1.0 } else { evidence.wild.min(MAX_WILD) };
        let rejected = |kind: &Kind| if evidence.rejected.contains(&kind.id) { REJECTED } else { 1.0 };
        let sum: f32 = all.iter().map(|kind| rejected(kind)).sum();
        let component = |home: Home<'a>, share: f32, genes: Vec<Density>| {
            let (bounds, log_share) = (home.bounds(), libm::logf(share));
            Component { home, bounds, log_share, genes }
        };
        let mut components =
            vec![component(Home::Wild, wild, genes.iter().map(|_| Density::flat()).collect())];
        for (number, kind) in all.iter().enumerate() {
            let partners: Vec<usize> =
                (0..all.len()).filter(|&other| other != number && kind.mixes_with(all[other])).collect();
            let share = (1.0 - wild) * rejected(kind) / sum;
            let pure = if partners.is_empty() { share } else { share * (1.0 - BLENDS) };
            components.push(component(Home::Of(kind), pure, of(&kind.bounds)));
            for &other in &partners {
                let blend = kind.bounds.blend(&all[other].bounds, BLEND_PART);
                let share = (share - pure) / partners.len() as f32;
                components.push(component(Home::Between(kind, all[other]), share, of(&blend)));
            }
        }
        let shares = components.iter().scan(0.0, |sum, component| {
            *sum += libm::expf(component.log_share);
            Some(*sum)
        });
        let shares = shares.collect();
        Self { components, choices: genes.iter().map(|gene| choice(gene)).collect(), shares }
    }

    /// Whether most of it is like no kind.
    pub fn is_wild(&self) -> bool {
        self.shares[0] > 0.5
    }

    /// Whether there is one component only: without kinds.
    pub fn is_one(&self) -> bool {
        self.components.len() == 1
    }

    pub fn genes(&self) -> usize {
        self.choices.len()
    }

    pub fn is_choice(&self, gene: usize) -> bool {
        self.choices[gene].is_some()
    }

    pub fn component(&self, number: usize) -> &Component<'a> {
        &self.components[number]
    }

    /// A component by its share.
    pub fn any(&self, dice: &mut Dice) -> usize {
        let part = dice.unit();
        self.shares.partition_point(|sum| *sum <= part).min(self.components.len() - 1)
    }

    pub fn draw(&self, component: usize, gene: usize, dice: &mut Dice) -> f32 {
        let at = self.components[component].genes[gene].draw(dice);
        // Nothing is between two names.
        self.choices[gene].map_or(at, |last| (at * last).round() / last)
    }

    pub fn log_density(&self, component: usize, gene: usize, at: f32) -> f32 {
        self.components[component].genes[gene].log[bin(at)]
    }

    /// One that a point may belong to, by how well each explains it.
    pub fn component_of(&self, point: &[f32], dice: &mut Dice) -> usize {
        if self.is_one() {
            return 0;
        }
        let bins: Vec<usize> = point.iter().map(|x| bin(*x)).collect();
        let logs: Vec<f32> = self
            .components
            .iter()
            .map(|component| {
                let genes = component.genes.iter().zip(&bins);
                component.log_share + genes.map(|(gene, bin)| gene.log[*bin]).sum::<f32>()
            })
            .collect();
        let best = logs.iter().copied().fold(f32::MIN, f32::max);
        let weights: Vec<f32> = logs.iter().map(|log| libm::expf(log - best)).collect();
        dice.weighted(&weights)
    }
}

fn choice(gene: &Parameter) -> Option<f32> {
    (gene.scale == Scale::Choice).then_some(gene.last_code() as f32)
}

fn bin(at: f32) -> usize {
    ((at * BINS as f32) as usize).min(BINS - 1)
}
