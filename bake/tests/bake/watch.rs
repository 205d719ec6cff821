//! `bake --watch`: what is saved is baked, what is voted on is bred, and the newest wins.

use std::fs;
use std::sync::mpsc::TryRecvError;
use std::time::Duration;

use crate::whole_bake::set_gene;
use crate::world::World;

/// `bake --watch`, with its events as they come.
struct Watching {
    child: std::process::Child,
    lines: std::io::Lines<std::io::BufReader<std::process::ChildStdout>>,
}

impl Watching {
    fn new(world: &World) -> Self {
        let mut command = world.command(&["--watch", "--size", "65", "--json", "--threads", "1"]);
        let mut child = command.stdout(std::process::Stdio::piped()).spawn().expect("bake runs");
        let lines = std::io::BufRead::lines(std::io::BufReader::new(child.stdout.take().expect("piped")));
        Self { child, lines }
    }

    /// The next event of one of the kinds.
    fn next(&mut self, kinds: &[&str]) -> serde_json::Value {
        loop {
            let line = self.lines.next().expect("it goes on watching").expect("text");
            let event: serde_json::Value = serde_json::from_str(&line).expect("JSON");
            if kinds.iter().any(|kind| event["event"] == *kind) {
                return event;
            }
        }
    }

    /// Stages built by the next bake that builds any: a save may be seen as more than one event, and the first bake
    /// after it does the work.
    fn work(&mut self) -> u64 {
        let built = (0..5).map(|_| self.next(&["done"])["built"].as_u64().expect("a number"));
        built.into_iter().find(|built| *built != 0).expect("a bake that does something")
    }
}

impl Drop for Watching {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn watch_bakes_what_is_saved_and_outlives_mistakes() {
    let world = World::starters();
    let mut watching = Watching::new(&world);
    assert_eq!(watching.next(&["done", "failed"])["built"], 0);
    world.edit(0, |text| set_gene(&text, 1, "cloud_cover", "0.6"));
    let most = World::first_bake().planned() as u64 / 4;
    assert!(watching.work() <= most, "no other scene is baked");
    let good = fs::read_to_string(world.population(0)).expect("a population");
    fs::write(world.population(0), &good[..good.len() / 2]).expect("written");
    assert_eq!(watching.next(&["failed"])["event"], "failed");
    fs::write(world.population(0), good.replacen("cloud_cover: 0.6", "cloud_cover: 0.8", 1))
        .expect("written");
    assert!(watching.work() <= most);
}

fn vote(world: &World, generation: u32, votes: &str) {
    world.edit(generation, |text| {
        let (before, after) = text.split_once("    votes: ").expect("votes");
        let (_, after) = after.split_once(",\n").expect("the end of the line");
        format!("{before}    votes: {votes},\n{after}")
    });
}

/// `current.ron` shows this generation, as its file is now.
fn is_shown(world: &World, generation: u32) -> bool {
    let text = fs::read_to_string(world.file("baked/current.ron")).expect("something was baked");
    let current = genescape_schema::Current::load("current.ron", &text).expect("valid");
    let bytes = fs::read(world.population(generation)).expect("a population");
    (current.generation, current.population) == (generation, blake3::hash(&bytes).to_hex().to_string())
}

#[test]
fn watch_answers_votes_once_and_on_old_generations_too() {
    let world = World::starters();
    let mut watching = Watching::new(&world);
    watching.next(&["done"]);
    let ballots = [
        (0, "Some((tree: Some(0), terrain: Some(1), sky: Some(2)))"),
        (1, "Some((tree: None, terrain: Some(3), sky: Some(0)))"),
        // Another choice on an old generation: nothing that came of it is overwritten.
        (0, "Some((tree: Some(3), terrain: Some(1), sky: Some(2)))"),
    ];
    let mut before = Vec::new();
    for (child, (parent, votes)) in (1..).zip(ballots) {
        vote(&world, parent, votes);
        assert_eq!(watching.next(&["bred"])["parent"], parent);
        assert_eq!(watching.next(&["planned"])["generation"], child, "the child comes first");
        watching.next(&["done"]);
        assert!(is_shown(&world, child));
        let text = fs::read_to_string(world.population(child)).expect("a new file");
        assert!(text.contains(&format!("parent: Some((generation: {parent},")), "{text}");
        for (generation, text) in &before {
            assert_eq!(&fs::read_to_string(world.population(*generation)).expect("kept"), text);
        }
        before.push((child, text));
        before.retain(|(generation, _)| ballots.get(child as usize).is_none_or(|next| next.0 != *generation));
    }
    // The same votes again, in other words; and a watch that starts later: no child is missing.
    vote(&world, 0, "Some((sky: Some(2), terrain: Some(1), tree: Some(3)))");
    watching.next(&["done"]);
    drop(watching);
    let mut late = Watching::new(&world);
    assert_eq!(late.next(&["bred", "planned"])["generation"], 3);
    late.next(&["done"]);
    assert!(!world.population(4).exists());
}

#[test]
fn after_breeding_the_newest_file_is_the_one_to_edit() {
    let world = World::starters();
    let mut command = world.command(&["--watch", "--size", "65", "--threads", "1"]);
    let mut child = command.stdout(std::process::Stdio::piped()).spawn().expect("bake runs");
    let mut lines = std::io::BufRead::lines(std::io::BufReader::new(child.stdout.take().expect("piped")));
    let mut until_it_waits = || -> Vec<String> {
        let lines = lines.by_ref().map(|line| line.expect("text"));
        lines.take_while(|line| !line.starts_with("watching")).collect()
    };
    until_it_waits();
    vote(&world, 0, "Some((tree: Some(0), terrain: Some(1), sky: Some(2)))");
    let told = until_it_waits();
    let _ = child.kill();
    let _ = child.wait();
    let to_edit: Vec<_> = told.iter().filter(|line| line.starts_with("Change them")).collect();
    assert!(to_edit.last().is_some_and(|line| line.contains("g0001.ron")), "{told:#?}");
}

#[test]
fn a_child_that_is_half_saved_is_not_bred_again() {
    let world = World::starters();
    let mut watching = Watching::new(&world);
    watching.next(&["done"]);
    vote(&world, 0, "Some((tree: Some(0), terrain: Some(1), sky: Some(2)))");
    assert_eq!(watching.next(&["bred"])["parent"], 0);
    watching.next(&["done"]);
    let child = fs::read_to_string(world.population(1)).expect("a child");
    for half in ["", &child[..child.len() / 2]] {
        fs::write(world.population(1), half).expect("written");
        assert_eq!(watching.next(&["failed", "bred"])["event"], "failed");
    }
    fs::write(world.population(1), &child).expect("written");
    assert_eq!(watching.next(&["done", "bred"])["event"], "done");
    assert!(!world.population(2).exists());
}

/// Lets a process run for a twentieth of the time: its clocks go on, its work hardly does.
#[cfg(unix)]
fn slowly<T>(process: u32, wait: impl FnOnce() -> T) -> T {
    let signal = |name: &str| {
        let kill = std::process::Command::new("kill").args([name, &process.to_string()]).status();
        assert!(kill.expect("kill runs").success());
    };
    let (waiting, over) = std::sync::mpsc::channel::<()>();
    std::thread::scope(|scope| {
        scope.spawn(move || {
            // Ends with `waiting`, even if that is by a panic.
            while over.try_recv() == Err(TryRecvError::Empty) {
                signal("-STOP");
                std::thread::sleep(Duration::from_millis(95));
                signal("-CONT");
                std::thread::sleep(Duration::from_millis(5));
            }
        });
        let _waiting = waiting;
        wait()
    })
}

#[cfg(unix)]
#[test]
fn a_save_during_a_bake_ends_it_and_what_was_saved_last_is_shown() {
    let world = World::new();
    let mut watching = Watching::new(&world);
    watching.next(&["started"]);
    world.edit(0, |text| set_gene(&text, 1, "turbidity", "6"));
    // However fast the machine: the watch notices long before the bake is done.
    let end = slowly(watching.child.id(), || watching.next(&["superseded", "done"]));
    assert_eq!(end["event"], "superseded");
    assert_eq!(watching.next(&["superseded", "done", "failed"])["event"], "done");
    assert!(is_shown(&world, 0));
}

#[test]
fn to_save_a_file_is_to_ask_for_its_scenes() {
    let world = World::starters();
    world.bake(&["random", "--seed", "5"]).ok();
    let mut watching = Watching::new(&world);
    assert_eq!(watching.next(&["done"])["built"], 0);
    assert!(is_shown(&world, 1));
    fs::remove_dir_all(world.file("baked/g0000")).expect("evicted");
    world.edit(0, |text| text);
    assert_eq!(watching.next(&["planned"])["generation"], 0);
    watching.next(&["done"]);
    assert!(is_shown(&world, 0));
    assert!(world.file("baked/g0000/scene-3/scene.gltf").is_file());
}
