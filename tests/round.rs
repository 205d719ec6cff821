//! The loop of files without a window: what the person does in the viewer reaches the bake, and what the bake makes
//! reaches the viewer, through nothing but the files of a world.

use std::collections::BTreeSet;
use std::time::{Duration, Instant};

use genescape_bake::plan::Resolution;
use genescape_schema::{Category, Parent, Space, Votes};
use genescape_viewer::baker::{Baker, BakerOptions, Event};
use genescape_viewer::edit_history::{Change as Edited, Edit};
use genescape_viewer::headless::{Headless, scene_files};
use genescape_viewer::scene::Scene;
use genescape_world::{Change, Scope, Source, Watch, World};

struct Round {
    _folder: tempfile::TempDir,
    files: World,
    baker: Baker,
    watch: Watch,
    edited: Vec<Edited>,
    changes: BTreeSet<Change>,
}

/// The starters, baked small.
pub fn starters(studio: &Headless) -> Vec<Scene> {
    let round = Round::new();
    round.until(|event| matches!(event, Event::Done { .. }));
    let paths = scene_files(&Source::World(round.files.root().to_owned())).expect("scenes");
    paths.iter().map(|path| studio.read(path).expect("readable")).collect()
}

/// Bakes small landscapes, and ahead at most so many bytes.
fn start_baker(files: &World, ahead: u64) -> Baker {
    let heightfield = Resolution::of_side(65).expect("a side");
    let options = BakerOptions { threads: None, heightfield, poll: false, ahead };
    Baker::start(files.root(), options, || {}).expect("a thread")
}

impl Round {
    /// A world whose baker has begun.
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let files = World::new(folder.path());
        let watch =
            Watch::start(Scope { scenes: true, ..Scope::of(files.clone()) }, false, || {}).expect("watched");
        let baker = start_baker(&files, 0);
        Self { _folder: folder, files, baker, watch, edited: Vec::new(), changes: BTreeSet::new() }
    }

    /// What the baker tells until it tells `what`; that comes last.
    fn until(&self, what: impl Fn(&Event) -> bool) -> Vec<Event> {
        let (mut told, start) = (Vec::new(), Instant::now());
        loop {
            for event in self.baker.events() {
                assert!(!matches!(event, Event::Failed { .. }), "{event:?}");
                told.push(event);
                if told.last().is_some_and(&what) {
                    return told;
                }
            }
            assert!(start.elapsed() < Duration::from_secs(120), "not told; but {told:?}");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Waits until a change was told since the last call that forgot it.
    fn told(&mut self, change: Change) {
        let start = Instant::now();
        while !self.changes.remove(&change) {
            assert!(start.elapsed() < Duration::from_secs(20), "{change:?} is not told");
            self.changes.extend(self.watch.changes());
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    fn vote(&mut self, generation: u32, votes: Votes) -> u32 {
        let edit = Edit::Votes(Some(votes));
        let edited = Edited::make(&self.files, &Space::builtin(), generation, &edit);
        self.edited.push(edited.expect("written").expect("other votes"));
        self.until(|event| matches!(event, Event::Bred { parent, .. } if *parent == generation));
        self.until(|event| matches!(event, Event::Done { .. }));
        let child = self
            .files
            .child_of(&Parent { generation, votes, variety: None })
            .expect("readable")
            .expect("a child");
        for change in (0..4).map(|index| Change::Scene { generation: child, index }) {
            self.told(change);
        }
        self.told(Change::Population(child));
        child
    }
}

#[test]
fn votes_become_generations_and_old_ones_can_be_voted_on_again() {
    let mut round = Round::new();
    round.until(|event| matches!(event, Event::Done { .. }));
    round.told(Change::Current);
    let votes = Votes { tree: Some(2), terrain: None, sky: Some(0) };
    assert_eq!(round.vote(0, votes), 1);
    round.told(Change::Current);
    let space = Space::builtin();
    let genome = |round: &Round, generation: u32, individual: usize| {
        let file = round.files.population(&space, generation).expect("valid");
        file.population.individuals[individual].genome.clone()
    };
    let (best, child) = (genome(&round, 0, 2), genome(&round, 1, 0));
    assert_eq!(child.chromosome(Category::Tree), best.chromosome(Category::Tree));

    assert_eq!(round.vote(1, Votes::default()), 2);
    let second = round.files.population_text(1).expect("there");
    assert_eq!(round.vote(0, Votes { tree: Some(3), ..votes }), 3, "back to the first, and on from there");
    assert_eq!(round.files.population_text(1).expect("there"), second);
    let current = round.files.current().expect("valid").expect("baked");
    assert_eq!(current.generation, 3);

    // Undone, the votes are the old ones, whose child is there already.
    round.edited.pop().expect("a step").undo(&round.files).expect("nobody else changed the file");
    round.told(Change::Population(0));
    round.until(|event| matches!(event, Event::Done { .. }));
    assert_eq!(round.files.generations().expect("readable"), [0, 1, 2, 3]);
}

#[test]
fn a_bake_ends_soon_after_its_baker_and_another_goes_on() {
    let round = Round::new();
    round.until(|event| matches!(event, Event::Started { .. }));
    let Round { _folder, files, baker, .. } = round;
    drop(baker);
    let baker = start_baker(&files, 0);
    let (mut done, start) = (false, Instant::now());
    while !done && start.elapsed() < Duration::from_secs(120) {
        done = baker.events().any(|event| matches!(event, Event::Done { .. }));
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(done && (0..4).all(|scene| files.scene_path(0, scene).is_file()));
}

#[test]
fn while_somebody_looks_what_may_be_voted_for_is_baked() {
    let Round { _folder, files, baker: first, .. } = Round::new();
    drop(first);
    let round = Round { baker: start_baker(&files, u64::MAX), ..Round::new() };
    let actions = || std::fs::read_dir(files.baked().join("actions")).map_or(0, Iterator::count);
    round.until(|event| matches!(event, Event::Done { .. }));
    let (asked_for, start) = (actions(), Instant::now());
    while actions() < asked_for + 20 {
        assert!(start.elapsed() < Duration::from_secs(120), "{} actions", actions());
        std::thread::sleep(Duration::from_millis(50));
    }
    assert_eq!(files.generations().expect("readable"), [0], "nobody sees what is only likely");
    let votes = Votes { tree: Some(0), terrain: Some(0), sky: Some(0) };
    Edited::make(&files, &Space::builtin(), 0, &Edit::Votes(Some(votes))).expect("written");
    round.until(|event| matches!(event, Event::Bred { .. }));
    round.until(|event| matches!(event, Event::Done { .. }));
}
