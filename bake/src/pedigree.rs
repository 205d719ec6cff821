//! A population, and all else that its children depend on.

use genescape_schema::{Kinds, Population, Space, Strategy, Votes};

use crate::audition::{self, Auditioned};
use crate::breed::{Breeder, NoVotes};

/// The same children for the same votes, as long as it is the same.
#[derive(Clone, Debug, PartialEq)]
pub struct Pedigree {
    pub space: Space,
    pub kinds: Kinds,
    /// The other populations that were voted on, in the order of generations.
    pub past: Vec<Population>,
    pub parents: Population,
    /// The children's generation.
    pub next: u32,
}

impl Pedigree {
    /// The children of these votes on the parents, whatever votes those have.
    ///
    /// # Errors
    /// None but for votes that are not there.
    pub fn children(&self, votes: Option<Votes>) -> Result<Auditioned, NoVotes> {
        let parents = Population { votes, ..self.parents.clone() };
        let breeder = Breeder::new(&self.space, &self.kinds, Strategy::default(), &self.past, &parents)?;
        Ok(audition::next_generation(&breeder, self.next))
    }
}
