//! Genomes → what is seen of a landscape, in numbers, and how different two landscapes look: its *phenotype*. Two genomes
//! whose genes differ much may look alike, and one gene may change everything.
//!
//! Traits are measured on what the stages would make, coarsely: the sketch of the land by which landscapes are judged before
//! they are baked, one tree without its mesh, the light of the sky. Colours are compared in OKLab. Each trait counts by how
//! much it differs between two landscapes that are drawn by chance, so that 1 is the difference of two such.

mod color;
mod land;
mod sky;
#[cfg(test)]
mod tests;
mod tree;
pub mod visibility;

use genescape_schema::{Category, Genome, GenomeError, Space};

/// Something that is seen.
#[derive(Clone, Copy, Debug)]
struct Trait {
    name: &'static str,
    /// What it differs by between two landscapes drawn by chance, root mean square, in the trait's own unit.
    spread: f32,
}

/// What is seen of a landscape.
#[derive(Clone, Debug, PartialEq)]
pub struct Phenotype {
    /// Of each category the values of its traits: one, or several that belong together.
    traits: [Vec<Vec<f32>>; 3],
}

impl Phenotype {
    /// Takes about as long as two frames of a film.
    ///
    /// # Errors
    /// A gene that `space` does not declare.
    pub fn of(space: &Space, genome: &Genome) -> Result<Self, GenomeError> {
        let of = |category| part(space, category, genome);
        Ok(Self { traits: [of(Category::Tree)?, of(Category::Terrain)?, of(Category::Sky)?] })
    }

    /// Of one category alone: nothing is seen of the others.
    ///
    /// # Errors
    /// A gene that `space` does not declare.
    pub fn of_category(space: &Space, category: Category, genome: &Genome) -> Result<Self, GenomeError> {
        let mut traits = [const { Vec::new() }; 3];
        traits[category as usize] = part(space, category, genome)?;
        Ok(Self { traits })
    }

    /// How different two landscapes look in one category: 0 where they are alike, about 1 for two that were drawn by chance.
    pub fn distance_in(&self, other: &Self, category: Category) -> f32 {
        let all = self.differences(other, category);
        (all.iter().map(|(_, one)| one * one).sum::<f32>() / all.len() as f32).sqrt()
    }

    /// The same as a whole.
    pub fn distance(&self, other: &Self) -> f32 {
        let squares = Category::ALL.map(|category| {
            let distance = self.distance_in(other, category);
            distance * distance
        });
        (squares.iter().sum::<f32>() / squares.len() as f32).sqrt()
    }

    /// The traits of a category by name, with how much they differ: 1 as much as between two landscapes drawn by chance.
    pub fn differences(&self, other: &Self, category: Category) -> Vec<(&'static str, f32)> {
        let pairs = self.traits[category as usize].iter().zip(&other.traits[category as usize]);
        let of = |(one, (a, b)): (&Trait, (&Vec<f32>, &Vec<f32>))| (one.name, apart(a, b) / one.spread);
        table(category).iter().zip(pairs).map(of).collect()
    }
}

fn table(category: Category) -> &'static [Trait] {
    match category {
        Category::Tree => &tree::TRAITS,
        Category::Terrain => &land::TRAITS,
        Category::Sky => &sky::TRAITS,
    }
}

/// The traits of one category.
fn part(space: &Space, category: Category, genome: &Genome) -> Result<Vec<Vec<f32>>, GenomeError> {
    Ok(match category {
        Category::Tree => tree::traits(&genome.read(space)?, &genome.read(space)?),
        Category::Terrain => land::traits(&genome.read(space)?, &genome.read(space)?),
        Category::Sky => sky::traits(&genome.read(space)?),
    })
}

fn apart(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f32>().sqrt()
}
