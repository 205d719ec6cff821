//! Genes that a person has locked: children have them from one of the parents.

use genescape_schema::{Category, Chromosome, Population, Space, Votes};

/// Which parent a child has the locked genes of a category from: the favourite or, without one, that in the child's place.
pub fn source(votes: Votes, category: Category, child: usize) -> usize {
    votes.favourite(category).unwrap_or(child)
}

/// Gives `child` the locked genes of one of `parents`; all of them where the category is locked.
pub fn keep(space: &Space, parents: &Population, category: Category, from: usize, child: &mut Chromosome) {
    let kept = parents.individuals[from].genome.chromosome(category);
    for gene in space.category(category).filter(|gene| parents.is_locked(gene)) {
        child.set_code(gene, kept.code(gene));
    }
}
