//! How long a person waits for the children of a vote: keys in a real window, four landscapes at full size, and what is
//! likely baked ahead, as it is by default. `cargo xtask waits` measures many rounds in the release build; without
//! GENESCAPE_ROUNDS it is one round without a pause, of which only the outcome counts.
#![expect(clippy::print_stdout, reason = "tells what it measures")]

use std::time::{Duration, Instant};

use genescape_schema::{Category, Space, Votes};
use genescape_viewer::measure::median;
use genescape_world::World;

use crate::display::{Display, keys};
use crate::program::Viewer;

const SIZE: [u16; 2] = [1280, 800];
/// What somebody takes to look at four landscapes, and then for each vote.
const LOOKS: Duration = Duration::from_secs(8);
const VOTES: Duration = Duration::from_secs(2);
/// By category and landscape.
const KEYS: [[u8; 4]; 3] = [
    [keys::U, keys::I, keys::O, keys::P],
    [keys::J, keys::K, keys::L, keys::SEMICOLON],
    [keys::M, keys::COMMA, keys::DOT, keys::SLASH],
];

#[test]
#[ignore = "needs Xvfb and a Vulkan driver: `cargo xtask test` runs it"]
fn children_of_a_vote_come_once() {
    let rounds = std::env::var("GENESCAPE_ROUNDS").map(|rounds| rounds.parse().expect("a number"));
    let (is_test, rounds) = (rounds.is_err(), rounds.unwrap_or(1));
    let (display, folder) = (Display::start(SIZE), tempfile::tempdir().expect("a temporary folder"));
    let files = World::new(folder.path().join("world"));
    let size = if is_test { ["--heightfield", "65"].as_slice() } else { &[] };
    let usual = ["--world", "world", "--settings", "settings.ron", "--size", "1280x800"];
    let mut viewer = Viewer::start(&display, folder.path(), &[&usual, size].concat());
    viewer.until("the first landscapes", |viewer| viewer.shows(0));
    let mut waits_s = [Vec::new(), Vec::new()];
    for generation in 1..=rounds {
        // As good as by chance, and the same each time.
        let wanted = [3, 5, 7].map(|step| (generation * step / 2 % 4) as usize);
        rest(LOOKS, is_test);
        for (keys, landscape) in KEYS.iter().zip(wanted) {
            display.tap(keys[landscape]);
            rest(VOTES, is_test);
        }
        let before = viewer.read();
        let pressed = Instant::now();
        display.tap(keys::N);
        let waits = [1, 4].map(|count| {
            viewer.until("the children", |viewer| shown(viewer, generation) >= count);
            pressed.elapsed().as_secs_f64()
        });
        viewer.until("the bake's end", |viewer| viewer.shows(generation));
        viewer.frames(5);
        for view in 0..4 {
            let of_view = |line: &&serde_json::Value| {
                line["what"] == "landscape" && line["generation"] == generation && line["view"] == view
            };
            assert_eq!(viewer.lines[before..].iter().filter(of_view).count(), 1, "landscape {}", view + 1);
        }
        let parents = files.population(&Space::builtin(), generation - 1).expect("valid").population;
        let mut votes = Votes::default();
        for (category, landscape) in Category::ALL.into_iter().zip(wanted) {
            votes.set(category, Some(landscape));
        }
        assert_eq!(parents.votes, Some(votes));
        println!(
            "generation {generation}: the first after {:.2} s, the last after {:.2} s",
            waits[0], waits[1]
        );
        waits_s.iter_mut().zip(waits).for_each(|(all, one)| all.push(one));
    }
    let [first, last] = waits_s.each_ref().map(|waits| median(waits));
    println!(
        "median of {rounds}: the first after {first:.2} s (aim 0.5), the last after {last:.2} s (aim 2)"
    );
}

fn rest(pause: Duration, is_test: bool) {
    if !is_test {
        std::thread::sleep(pause);
    }
}

fn shown(viewer: &Viewer, generation: u32) -> usize {
    viewer.landscapes.iter().filter(|landscape| landscape["generation"] == generation).count()
}
