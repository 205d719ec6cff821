//! How long a person waits for the children of a vote: a test of the viewer, in the release build, for many rounds.

use anyhow::Result;

use crate::setup;
use crate::tools::{cargo, in_a_session, run};

const TEST: &str = "waits::children_of_a_vote_come_once";

/// Prints what each of `rounds` took, and the medians.
pub fn waits(rounds: u32) -> Result<()> {
    setup::window()?;
    let arguments = ["test", "--release", "--quiet", "--package", "genescape-viewer", "--test", "viewer"];
    let mut test = cargo(&arguments);
    test.args(["--", "--ignored", "--exact", TEST, "--nocapture"])
        .env("GENESCAPE_ROUNDS", rounds.to_string());
    run(in_a_session(&mut test))
}
