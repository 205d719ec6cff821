//! Votes → the next generation: a genetic algorithm on chromosomes as codes, each category for itself (thesis,
//! section 1: the person says which scene has the best trees, the best terrain, the best sky).
//!
//! Child 0 unites the favourites. Children 1, 2 and 3 keep the favourite trees, terrain and sky respectively and
//! vary the other two categories, so each shows what a change does beside something known, and the cache has it.

use genescape_schema::{Category, Chromosome, Genome, INDIVIDUALS, Individual, Parent, Population, Space};
use rand::Rng;
use rand_pcg::Pcg64Mcg;

use crate::seed;

/// Chance that a gene changes when a favourite is varied a little.
const GENTLE: f32 = 0.15;
/// Chance that a gene changes when nothing pleased.
const STRONG: f32 = 0.3;
/// Chance that a changed gene gets any value instead of one nearby.
const LEAP: f32 = 0.12;
/// Chance that a crossover goes on with the other parent at a gene: neighbours in the space often belong together.
const SWITCH: f32 = 0.3;

/// Why there is no next generation.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "nobody has voted on generation {generation} yet: in its file, say which of 0 … 3 has the best of each, \
     as votes: Some((tree: Some(0), terrain: Some(2), sky: None)), where Some(0) is the first and None means none of them"
)]
pub struct NoVotes {
    pub generation: u32,
}

/// Generation `next` from the votes on `parents`: the same genes for the same seed, generation, genes and votes of
/// the parents.
///
/// # Errors
/// When votes are `None`.
pub fn breed(space: &Space, parents: &Population, next: u32) -> Result<Population, NoVotes> {
    let generation = parents.generation;
    let votes = parents.votes.ok_or(NoVotes { generation })?;
    let mut rng = seed::rng(parents.seed, "breed", u64::from(generation));
    let children = Category::ALL.map(|category| {
        // A vote for an individual that is not there (the loader lets none pass) counts as none.
        let favourite = votes.get(category).filter(|&vote| vote < INDIVIDUALS);
        let mut breeder = Breeder { space, category, parents, rng: &mut rng };
        std::array::from_fn::<_, INDIVIDUALS, _>(|child| {
            let (mut chromosome, origin) = match favourite {
                Some(favourite) => breeder.descendant(favourite, child),
                None => (breeder.newcomer(), Origin::New),
            };
            // Locked genes are those of the favourite or, without one, of the parent in the child's place.
            let kept = &parents.individuals[favourite.unwrap_or(child)].genome;
            for gene in space.category(category).filter(|gene| parents.is_locked(gene)) {
                chromosome.set_code(gene, kept.code(gene));
            }
            (chromosome, origin)
        })
    });
    let individuals = std::array::from_fn(|child| {
        let chromosomes = children.each_ref().map(|category| category[child].0.clone());
        let origins = children.each_ref().map(|category| category[child].1);
        Individual { name: child_name(parents, origins), genome: Genome { chromosomes } }
    });
    let parent = Some(Parent { generation, votes });
    let locked = parents.locked.clone();
    Ok(Population { generation: next, seed: parents.seed, parent, individuals, votes: None, locked })
}

/// Where a chromosome comes from; parents count from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Origin {
    Of(usize),
    /// A variation.
    Like(usize),
    /// A crossover, of the favourite first.
    Crossed(usize, usize),
    New,
}

impl Origin {
    fn favourite(self) -> Option<usize> {
        match self {
            Self::Of(one) | Self::Like(one) | Self::Crossed(one, _) => Some(one),
            Self::New => None,
        }
    }
}

/// What parts of a landscape are called in names of children, as in [`Category::ALL`].
const PARTS: [&str; 3] = ["trees", "land", "sky"];
/// Between the parts of a child's name.
const SEPARATOR: &str = " · ";

/// "trees of 2 · land like 3 · new sky": where each part comes from, in few enough words to stand under a picture, and
/// with the numbers that landscapes have there, from 1. A child that has two or three parts of one parent bears that
/// parent's name, if it was given one, and says only what differs: "Spruces by a mountain lake · sky of 4".
fn child_name(parents: &Population, origins: [Origin; 3]) -> String {
    let descends = |parent: usize| origins.iter().filter(|origin| origin.favourite() == Some(parent)).count();
    let main = (0..INDIVIDUALS).find(|parent| descends(*parent) >= 2);
    let named = main.and_then(|main| Some((main, given_name(&parents.individuals[main].name)?)));
    let part = |(part, origin): (&str, Origin)| match (origin, named) {
        (Origin::Of(one), Some((main, _))) if one == main => None,
        (Origin::Like(one), Some((main, _))) if one == main => Some(format!("{part} varied")),
        (Origin::Crossed(one, other), Some((main, _))) if one == main => {
            Some(format!("{part} × {}", other + 1))
        }
        (Origin::Of(one), _) => Some(format!("{part} of {}", one + 1)),
        (Origin::Like(one), _) => Some(format!("{part} like {}", one + 1)),
        (Origin::Crossed(one, other), _) => Some(format!("{part} of {} × {}", one + 1, other + 1)),
        (Origin::New, _) => Some(format!("new {part}")),
    };
    let parts = PARTS.into_iter().zip(origins).filter_map(part);
    let name = named.map(|(_, name)| name.to_owned());
    name.into_iter().chain(parts).collect::<Vec<_>>().join(SEPARATOR)
}

/// The part of a name that a person gave; none of a name that only tells of descent, as this or an older version does.
fn given_name(name: &str) -> Option<&str> {
    let first = name.split(SEPARATOR).next().unwrap_or_default();
    let is_descent =
        name.contains(SEPARATOR) && PARTS.iter().any(|part| first.starts_with(&format!("{part} ")));
    let is_new = PARTS.iter().any(|part| first == format!("new {part}"));
    let is_older = first.starts_with(|c: char| c.is_ascii_digit()) && first.contains(": tree ");
    (!first.is_empty() && !is_descent && !is_new && !is_older).then_some(first)
}

/// Makes one category's chromosomes.
struct Breeder<'a> {
    space: &'a Space,
    category: Category,
    parents: &'a Population,
    rng: &'a mut Pcg64Mcg,
}

impl Breeder<'_> {
    /// From the favourite: itself for child 0 and for the child that keeps this category; of the other two, the
    /// first is a variation and the second a crossover with another parent.
    fn descendant(&mut self, favourite: usize, child: usize) -> (Chromosome, Origin) {
        let keeper = self.category as usize + 1;
        let best = self.parent(favourite);
        if child == 0 || child == keeper {
            return (best, Origin::Of(favourite));
        }
        let first = if keeper == 1 { 2 } else { 1 };
        if child == first {
            return (self.fresh(best, GENTLE), Origin::Like(favourite));
        }
        let other = (favourite + 1 + self.below(INDIVIDUALS as u32 - 1) as usize) % INDIVIDUALS;
        let crossed = self.crossed(&best, &self.parent(other));
        (self.mutated(crossed, 0.5 * GENTLE), Origin::Crossed(favourite, other))
    }

    /// From any two parents, much changed.
    fn newcomer(&mut self) -> Chromosome {
        let mother = self.below(INDIVIDUALS as u32) as usize;
        let father = (mother + 1 + self.below(INDIVIDUALS as u32 - 1) as usize) % INDIVIDUALS;
        let crossed = self.crossed(&self.parent(mother), &self.parent(father));
        self.fresh(crossed, STRONG)
    }

    fn parent(&self, index: usize) -> Chromosome {
        self.parents.individuals[index].genome.chromosome(self.category).clone()
    }

    /// Runs of genes from one and the other.
    fn crossed(&mut self, a: &Chromosome, b: &Chromosome) -> Chromosome {
        let mut child = a.clone();
        let mut from_b = self.chance(0.5);
        for gene in self.space.category(self.category) {
            from_b ^= self.chance(SWITCH);
            if from_b {
                child.set_code(gene, b.code(gene));
            }
        }
        child
    }

    /// Mutated until it differs from all parents, which the person has seen; a space of few codes may not allow that.
    fn fresh(&mut self, mut chromosome: Chromosome, chance: f32) -> Chromosome {
        for _ in 0..8 {
            chromosome = self.mutated(chromosome, chance);
            let seen = |other: &Individual| other.genome.chromosome(self.category) == &chromosome;
            if !self.parents.individuals.iter().any(seen) {
                break;
            }
        }
        chromosome
    }

    /// With each gene changed by `chance`; at least one is.
    fn mutated(&mut self, mut chromosome: Chromosome, chance: f32) -> Chromosome {
        let genes: Vec<_> = self.space.category(self.category).collect();
        let Some(last) = genes.len().checked_sub(1) else { return chromosome };
        let certain = self.below(last as u32 + 1) as usize;
        for (index, gene) in genes.into_iter().enumerate() {
            if self.chance(chance) || index == certain {
                let code = self.changed(chromosome.code(gene), gene.last_code());
                chromosome.set_code(gene, code);
            }
        }
        chromosome
    }

    /// Another code in 0 ..= last: mostly within an eighth of the range, near ones likelier, reflected at its ends.
    fn changed(&mut self, code: u32, last: u32) -> u32 {
        if self.chance(LEAP) {
            return (code + 1 + self.below(last)) % (last + 1);
        }
        let max = (last / 8).max(1);
        let step = 1 + self.below(max).min(self.below(max));
        let up = self.chance(0.5) && code + step <= last || code < step;
        if up { code + step } else { code - step }
    }

    fn below(&mut self, count: u32) -> u32 {
        ((u64::from(self.rng.next_u32()) * u64::from(count)) >> 32) as u32
    }

    fn chance(&mut self, chance: f32) -> bool {
        (self.rng.next_u32() as f32) < chance * 4_294_967_296.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use genescape_schema::Votes;
    use proptest::prelude::*;

    fn voted(space: &Space, seed: u64, generation: u32, votes: [Option<usize>; 3]) -> Population {
        let [tree, terrain, sky] = votes;
        let votes = Some(Votes { tree, terrain, sky });
        Population { votes, ..Population::random(space, seed, generation) }
    }

    #[test]
    fn without_votes_there_is_a_helpful_error() {
        let space = Space::builtin();
        let error = breed(&space, &Population::random(&space, 1, 3), 4).expect_err("nobody voted");
        assert_eq!(error, NoVotes { generation: 3 });
        assert!(error.to_string().contains("votes: Some((tree: Some(0)"));
    }

    #[test]
    fn names_tell_of_descent_as_pictures_count_and_keep_what_a_person_called_a_landscape() {
        let space = Space::builtin();
        let mut parents = voted(&space, 1, 0, [Some(1), Some(1), Some(3)]);
        parents.individuals[1].name = "Spruces by a lake".into();
        let names = |parents: &Population| {
            breed(&space, parents, 1).expect("votes").individuals.map(|child| child.name)
        };
        let children = names(&parents);
        assert_eq!(children[0], "Spruces by a lake · sky of 4");
        assert!(children.iter().all(|name| name.starts_with("Spruces by a lake · ")), "{children:?}");
        parents.votes = Some(Votes { tree: Some(1), terrain: Some(0), sky: None });
        let children = names(&parents);
        assert_eq!(children[0], "trees of 2 · land of 1 · new sky");
        // Their children, and those of an older version's, have no name to keep.
        for name in
            [children[0].as_str(), "1.0: tree of 0.1, terrain like 0.2, sky new", "new trees · land of 1"]
        {
            parents.individuals[1].name = name.into();
            parents.votes = Some(Votes { tree: Some(1), terrain: Some(1), sky: Some(1) });
            assert_eq!(names(&parents)[0], "trees of 2 · land of 2 · sky of 2", "{name}");
        }
    }

    #[test]
    fn what_is_locked_stays_and_the_rest_still_changes() {
        let space = Space::builtin();
        for (seed, favourite) in (0..40).map(|seed| (seed, if seed % 2 == 0 { Some(2) } else { None })) {
            let mut parents = voted(&space, seed, 0, [favourite, Some(1), None]);
            parents.locked = ["height_m", "sky"].map(str::to_owned).into();
            let children = breed(&space, &parents, 1).expect("votes");
            assert_eq!(children.locked, parents.locked);
            let height = space.find("height_m").expect("a gene");
            for (place, child) in children.individuals.iter().enumerate() {
                let kept = &parents.individuals[favourite.unwrap_or(place)].genome;
                assert_eq!(child.genome.code(height), kept.code(height));
                let sky = |one: &Individual| one.genome.chromosome(Category::Sky).clone();
                assert_eq!(sky(child), sky(&parents.individuals[place]));
            }
            let trees = |one: &Individual| one.genome.chromosome(Category::Tree).clone();
            let fresh =
                |child: &Individual| !parents.individuals.iter().any(|parent| trees(parent) == trees(child));
            assert!(children.individuals.iter().any(fresh), "only what is locked stays");
        }
    }

    #[test]
    fn small_steps_are_likelier_than_leaps() {
        let space = Space::builtin();
        let gene = space.find("height_m").expect("a gene");
        let mut distances = [0; 64];
        for seed in 0..200 {
            let parents = voted(&space, seed, 0, [Some(0); 3]);
            let code = parents.individuals[0].genome.code(gene);
            let child = breed(&space, &parents, 1).expect("votes").individuals[2].genome.code(gene);
            distances[code.abs_diff(child) as usize] += 1;
        }
        let (near, far): (u32, u32) = (distances[1..=7].iter().sum(), distances[8..].iter().sum());
        assert!(distances[0] > 120 && near > 3 * far && far > 0, "{distances:?}");
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 32, ..ProptestConfig::default() })]

        #[test]
        fn favourites_live_on_and_everything_else_is_new(
            seed: u64, generation in 0..99u32, later in 1..9u32, tree in 0..4usize, terrain in prop::option::of(0..4usize), sky in 0..4usize,
        ) {
            let space = Space::builtin();
            let parents = voted(&space, seed, generation, [Some(tree), terrain, Some(sky)]);
            let next = generation + later;
            let children = breed(&space, &parents, next).expect("votes");
            prop_assert_eq!(&breed(&space, &parents, next).expect("votes"), &children);
            prop_assert_eq!((children.generation, children.votes, children.seed), (next, None, seed));
            prop_assert_eq!(children.parent, parents.votes.map(|votes| Parent { generation, votes }));
            for (category, vote) in Category::ALL.into_iter().zip([Some(tree), terrain, Some(sky)]) {
                let kept: Vec<bool> = children.individuals.iter().map(|child| {
                    let genes = child.genome.chromosome(category);
                    vote.is_some_and(|vote| genes == parents.individuals[vote].genome.chromosome(category))
                }).collect();
                let expected = [0, 1, 2, 3].map(|child| vote.is_some() && (child == 0 || child == category as usize + 1));
                prop_assert_eq!(kept, expected);
                for (index, child) in children.individuals.iter().enumerate() {
                    let same = |other: &Individual| other.genome.chromosome(category) == child.genome.chromosome(category);
                    prop_assert!(expected[index] || !parents.individuals.iter().any(same));
                }
            }
            // What it wrote, it can read.
            let text = children.to_ron(&space);
            prop_assert_eq!(Population::load(&space, "p.ron", &text).expect("valid").population, children);
        }
    }
}
