//! Votes in the making ↔ what is kept of them between runs.

use std::collections::BTreeMap;

use genescape_schema::{Category, INDIVIDUALS};

use crate::event::{Ballot, Ballots};
use crate::settings::RunningVotes;

/// Votes as they are kept between runs; none while nobody has voted.
pub(super) fn running(generation: u32, ballots: &Ballots) -> Option<RunningVotes> {
    let mut cast = BTreeMap::new();
    for category in Category::ALL {
        match ballots.get(category) {
            Ballot::Open => {}
            Ballot::Nobody => drop(cast.insert(category.name().to_owned(), None)),
            Ballot::For(best) => drop(cast.insert(category.name().to_owned(), Some(best))),
        }
    }
    (!cast.is_empty()).then_some(RunningVotes { generation, cast })
}

/// What was kept, as ballots.
pub(super) fn ballots(running: &RunningVotes) -> Ballots {
    let mut ballots = Ballots::default();
    for category in Category::ALL {
        match running.cast.get(category.name()) {
            None => {}
            Some(Some(best)) if *best < INDIVIDUALS => ballots.set(category, Ballot::For(*best)),
            Some(_) => ballots.set(category, Ballot::Nobody),
        }
    }
    ballots
}
