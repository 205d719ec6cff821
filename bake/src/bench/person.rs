//! A simulated person: somebody who wants certain genes, more of some than of others, and chooses the nearest of
//! four, mostly.

use genescape_schema::{Category, Genome, INDIVIDUALS, Population, Space, Votes};

use crate::phenotype::Phenotype;
use crate::seed::Dice;

/// How a landscape is judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taste {
    /// Each gene for itself.
    Separable,
    /// Pairs of genes together: what is too much of one may be made good by the other.
    Coupled,
    /// What is seen: the traits of a phenotype or, of a made space, smooth functions of several genes each.
    Seen,
}

impl Taste {
    pub const ALL: [Self; 3] = [Self::Separable, Self::Coupled, Self::Seen];

    pub fn name(self) -> &'static str {
        ["separable", "coupled", "seen"][self as usize]
    }
}

/// The part of the genes that matters most, and how much it matters together.
const MATTERING: f32 = 0.3;
const MATTERS: f32 = 0.7;
/// How far apart two landscapes are in what is seen that were drawn by chance: as far as in their genes.
const APART: f32 = 0.33;
/// What is seen in each category of a made space, and of how many genes each is made.
const SEEN: usize = 12;
const GENES_SEEN: usize = 4;

pub struct Person<'a> {
    space: &'a Space,
    wants: &'a Genome,
    /// What that looks like, for somebody who judges by it.
    looks: Option<Phenotype>,
    taste: Taste,
    /// Noise of choices: distances that differ by this much are told apart in e of e + 1 cases. 0 never errs.
    temperature: f32,
    /// Of each category.
    judges: [Judge; 3],
    dice: Dice,
}

struct Judge {
    weights: Vec<f32>,
    /// Which genes stand first when they are paired.
    order: Vec<usize>,
    /// What is seen: a few genes with factors.
    seen: Vec<[(usize, f32); GENES_SEEN]>,
}

impl<'a> Person<'a> {
    /// Somebody who wants that genome. The seed says what matters, and is the source of slips.
    pub fn new(space: &'a Space, wants: &'a Genome, taste: Taste, temperature: f32, seed: u64) -> Self {
        let mut dice = Dice::new(seed, "person", 0);
        let judges = Category::ALL.map(|category| Judge::new(space.traits(category).count(), &mut dice));
        let looks = (taste == Taste::Seen).then(|| Phenotype::of(space, wants).ok()).flatten();
        Self { space, wants, looks, taste, temperature, judges, dice }
    }

    /// How far a genome is from what is wanted, of each category: root mean square by weight, of genes 0 … 1, or of what is
    /// seen.
    pub fn distances(&self, genome: &Genome) -> [f32; 3] {
        let looks = |wanted| Some((wanted, Phenotype::of(self.space, genome).ok()?));
        if let Some((wanted, shown)) = self.looks.as_ref().and_then(looks) {
            return Category::ALL.map(|category| APART * shown.distance_in(wanted, category));
        }
        Category::ALL.map(|category| {
            let genes = self.space.traits(category);
            let point: Vec<f32> = genes.map(|gene| gene.part(genome.code(gene))).collect();
            self.distance(category, &point)
        })
    }

    /// How far a point of one category is: genes 0 … 1.
    pub fn distance(&self, category: Category, point: &[f32]) -> f32 {
        let wanted = || self.space.traits(category).map(|gene| gene.part(self.wants.code(gene)));
        let pairs = || point.iter().zip(wanted());
        let gaps: Vec<f32> = pairs().map(|(shown, wanted)| shown - wanted).collect();
        let middles: Vec<f32> = pairs().map(|(shown, wanted)| 0.5 * (shown + wanted)).collect();
        self.judges[category as usize].distance(self.taste, &gaps, &middles)
    }

    /// Chooses of each category one of the four.
    pub fn vote(&mut self, population: &Population) -> Votes {
        let distances = population.individuals.each_ref().map(|one| self.distances(&one.genome));
        let mut votes = Votes::default();
        for category in Category::ALL {
            let all = distances.map(|one| one[category as usize]);
            votes.set(category, Some(self.choose(all)));
        }
        votes
    }

    /// By softmax.
    fn choose(&mut self, distances: [f32; INDIVIDUALS]) -> usize {
        let least = distances.into_iter().fold(f32::INFINITY, f32::min);
        let weigh = |distance: f32| match self.temperature > 0.0 {
            true => libm::expf((least - distance) / self.temperature),
            false => f32::from(distance == least),
        };
        self.dice.weighted(&distances.map(weigh))
    }
}

impl Judge {
    fn new(genes: usize, dice: &mut Dice) -> Self {
        let mut order: Vec<usize> = (0..genes).collect();
        for at in (1..genes).rev() {
            order.swap(at, dice.below(at as u32 + 1) as usize);
        }
        let most = ((MATTERING * genes as f32).round() as usize).clamp(1, genes);
        let mut weights = vec![(1.0 - MATTERS) / (genes - most).max(1) as f32; genes];
        order[..most].iter().for_each(|gene| weights[*gene] = MATTERS / most as f32);
        let one = |dice: &mut Dice| (dice.below(genes as u32) as usize, dice.normal());
        let seen = (0..SEEN).map(|_| std::array::from_fn(|_| one(dice))).collect();
        Self { weights, order, seen }
    }

    fn distance(&self, taste: Taste, gaps: &[f32], middles: &[f32]) -> f32 {
        let separable =
            || gaps.iter().zip(&self.weights).map(|(gap, weight)| weight * gap * gap).sum::<f32>();
        match taste {
            Taste::Separable => separable().sqrt(),
            Taste::Coupled => {
                let pairs = self.order.chunks(2).map(|pair| match *pair {
                    [a, b] => {
                        let (sum, difference) = (gaps[a] + gaps[b], gaps[a] - gaps[b]);
                        0.5 * (self.weights[a] + self.weights[b])
                            * (0.85 * sum * sum + 0.15 * difference * difference)
                    }
                    _ => pair.iter().map(|a| self.weights[*a] * gaps[*a] * gaps[*a]).sum(),
                });
                pairs.sum::<f32>().sqrt()
            }
            Taste::Seen => {
                let of = |genes: &[(usize, f32); GENES_SEEN], side: f32| {
                    let sum = |(gene, factor): &(usize, f32)| {
                        factor * (middles[*gene] + side * 0.5 * gaps[*gene] - 0.5)
                    };
                    libm::tanhf(2.0 * genes.iter().map(sum).sum::<f32>())
                };
                let squares = self.seen.iter().map(|genes| {
                    let gap = of(genes, 1.0) - of(genes, -1.0);
                    0.25 * gap * gap
                });
                (squares.sum::<f32>() / SEEN as f32).sqrt()
            }
        }
    }
}
