//! What the person thinks of the four landscapes, before it is written down as [`Votes`].

use genescape_schema::{Category, INDIVIDUALS, Votes};
use serde::{Deserialize, Serialize};

/// What the person thinks about one category.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Ballot {
    /// Not voted yet.
    #[default]
    Open,
    /// None of the four pleases.
    NoFavourite,
    /// This one is the best: 0 to 3.
    For(usize),
}

impl Ballot {
    /// The best landscape, or `Some(None)` for none of them; `None` while this is open.
    pub fn cast(self) -> Option<Option<usize>> {
        match self {
            Self::Open => None,
            Self::NoFavourite => Some(None),
            Self::For(best) => Some(Some(best)),
        }
    }
}

/// The ballots of all three categories.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "[Ballot; 3]", into = "[Ballot; 3]")]
pub struct Ballots([Ballot; 3]);

impl TryFrom<[Ballot; 3]> for Ballots {
    type Error = String;

    fn try_from(ballots: [Ballot; 3]) -> Result<Self, String> {
        let known = |ballot: &Ballot| !matches!(ballot, Ballot::For(INDIVIDUALS..));
        let refusal = || format!("a ballot is for 0 to {}", INDIVIDUALS - 1);
        ballots.iter().all(known).then_some(Self(ballots)).ok_or_else(refusal)
    }
}

impl From<Ballots> for [Ballot; 3] {
    fn from(ballots: Ballots) -> Self {
        ballots.0
    }
}

impl Ballots {
    /// One category's ballot.
    pub fn get(&self, category: Category) -> Ballot {
        self.0[category as usize]
    }

    /// Changes one category's ballot.
    pub fn set(&mut self, category: Category, ballot: Ballot) {
        self.0[category as usize] = ballot;
    }

    /// The votes for the population's file; `None` while a category is open.
    pub fn votes(&self) -> Option<Votes> {
        let mut votes = Votes::default();
        for category in Category::ALL {
            votes.set(category, self.get(category).cast()?);
        }
        Some(votes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn votes_are_complete_only_when_no_category_is_open_and_name_the_best_of_each() {
        let choices = [Ballot::Open, Ballot::NoFavourite, Ballot::For(0), Ballot::For(3)];
        for (tree, terrain, sky) in
            (0..64).map(|code: usize| (choices[code % 4], choices[code / 4 % 4], choices[code / 16]))
        {
            let ballots = Ballots([tree, terrain, sky]);
            let open = [tree, terrain, sky].contains(&Ballot::Open);
            assert_eq!(ballots.votes().is_none(), open);
            for (category, vote) in
                ballots.votes().into_iter().flat_map(|votes| Category::ALL.map(|c| (c, votes.get(c))))
            {
                assert_eq!(vote.map_or(Ballot::NoFavourite, Ballot::For), ballots.get(category));
            }
        }
    }
}
