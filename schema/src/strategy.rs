//! How a generation is found from votes.

use std::fmt;
use std::str::FromStr;

/// How a generation is found from votes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Strategy {
    /// By a model of what the person wants, from all votes so far.
    #[default]
    Learned,
    /// By the thesis's genetic algorithm, from the last votes alone.
    Classic,
}

impl Strategy {
    pub const ALL: [Self; 2] = [Self::Learned, Self::Classic];

    /// As files and the command line call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Learned => "learned",
            Self::Classic => "classic",
        }
    }
}

impl fmt::Display for Strategy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Strategy {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::ALL.into_iter().find(|one| one.name() == text).ok_or("\"learned\" or \"classic\"")
    }
}
