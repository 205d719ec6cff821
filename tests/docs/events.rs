//! `docs/json.md` against the events that a bake can print.

use std::collections::BTreeSet;

use genescape_bake::events::Event;
use serde_json::{Map, Value};

use crate::docs::pages::{Page, Part};

/// Every name of an event, by what serde says of one that is none.
fn names() -> BTreeSet<String> {
    let error = serde_json::from_str::<Event>(r#"{"event":"?"}"#).expect_err("no event").to_string();
    let (_, list) = error.split_once("expected one of ").expect("a list of names");
    list.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

/// The example below the heading of an event.
fn example(section: &[Part]) -> &str {
    let block = section.iter().find_map(|part| match part {
        Part::Block(text) => Some(text.trim_end()),
        _ => None,
    });
    block.expect("an example line")
}

#[test]
fn every_event_has_a_section_whose_example_the_program_could_have_printed() {
    let page = Page::read("docs/json.md");
    let (names, headings) = (names(), page.anchors());
    assert!(names.len() > 10, "{names:?}");
    for name in &names {
        assert!(headings.contains(name), "docs/json.md has no section {name}");
        let section = page.section(name);
        let line = example(section);
        let event: Event = serde_json::from_str(line).unwrap_or_else(|error| panic!("{line}: {error}"));
        assert_eq!(serde_json::to_string(&event).expect("plain data"), line);

        let fields: Map<String, Value> = serde_json::from_str(line).expect("an object");
        assert_eq!(fields["event"], **name);
        let fields: BTreeSet<&str> =
            fields.keys().map(String::as_str).filter(|field| *field != "event").collect();
        let rows = section.iter().filter_map(|part| match part {
            Part::Row(field) => Some(field.as_str()),
            _ => None,
        });
        assert_eq!(rows.collect::<BTreeSet<_>>(), fields, "fields of {name} in docs/json.md");
    }
}

#[test]
fn no_section_is_of_an_event_that_there_is_not() {
    let page = Page::read("docs/json.md");
    let lines = page.parts.iter().filter_map(|part| match part {
        Part::Block(text) => Some(text.lines().filter(|line| line.starts_with("{\"event\""))),
        _ => None,
    });
    let told: BTreeSet<String> = lines
        .flatten()
        .map(|line| {
            serde_json::from_str::<Event>(line).unwrap_or_else(|error| panic!("{line}: {error}"));
            serde_json::from_str::<Value>(line).expect("JSON")["event"].as_str().expect("a name").to_owned()
        })
        .collect();
    assert_eq!(told, names());
}
