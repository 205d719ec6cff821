//! `docs/walking.md` against the keys that are bound.

use std::collections::BTreeSet;

use genescape_viewer::input::Command;

use crate::docs::pages::{Page, Part};

#[test]
fn every_key_is_in_the_table() {
    let page = Page::read("docs/walking.md");
    let named: BTreeSet<&str> = page
        .parts
        .iter()
        .filter_map(|part| match part {
            Part::Code(code) => Some(code.as_str()),
            _ => None,
        })
        .collect();
    for command in Command::all() {
        // Of a row of numbers the page names the first and the last.
        let is_within = matches!(
            command,
            Command::Maximise(2..=3) | Command::SetBookmark(2..=8) | Command::GoToBookmark(2..=8)
        );
        for keys in command.default_keys().split(" or ").filter(|_| !is_within) {
            assert!(named.contains(keys), "{keys} for {command} is missing in docs/walking.md");
        }
    }
}
