//! `bake cache gc` with no room at all: whatever happened before, and whatever happens meanwhile, the current scenes stay
//! whole.

use std::fs;
use std::process::Output;

use proptest::prelude::*;

use crate::world::{World, damage};

fn gc(world: &World) -> Output {
    world.run(&["cache", "gc", "--max-size", "0"])
}

fn said(output: &Output) -> String {
    [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text)).concat()
}

/// Gives one scene another sky, and so a few stages to do.
fn turn_the_sun(world: &World, scene: usize, azimuth_deg: u32) {
    world.edit(0, |text| {
        let mut parts: Vec<&str> = text.split("sun_azimuth_deg: ").collect();
        let turned = format!("{azimuth_deg}, // {}", parts[scene + 1]);
        parts[scene + 1] = &turned;
        parts.join("sun_azimuth_deg: ")
    });
}

/// Bakes until the first scene is in place, and no further.
fn bake_and_kill(world: &World) {
    let (mut child, mut lines) = world.spawn(&["--threads", "1"]);
    assert!(lines.any(|line| line.contains("scene_ready")), "a scene");
    child.kill().expect("killed");
    child.wait().expect("ended");
}

#[test]
fn a_scene_whose_bake_was_killed_stays_whole() {
    let world = World::starters();
    for scene in 0..4 {
        turn_the_sun(&world, scene, 200);
    }
    bake_and_kill(&world);
    let changed = (0..4).filter(|&scene| {
        fs::read(world.scene(scene)).expect("there")
            != fs::read(World::starters().scene(scene)).expect("there")
    });
    assert!((1..4).contains(&changed.count()), "some scenes are new, others are old");
    world.age();
    let output = gc(&world);
    assert!(output.status.success() && !said(&output).contains("removed 0 blobs"), "{}", said(&output));
    assert!(world.holes().is_empty(), "{:?}", world.holes());
}

#[test]
fn what_is_current_does_not_depend_on_histories_and_records() {
    let world = World::starters();
    fs::remove_dir_all(world.file("baked/history")).expect("removed");
    world.age();
    let before = world.files();
    assert!(gc(&world).status.success());
    assert!(world.files() == before, "everything is in use");
    assert!(world.bake(&[]).ok().built().is_empty(), "nothing is to be done again");

    for action in fs::read_dir(world.file("baked/actions")).expect("a folder").step_by(2) {
        damage(&action.expect("an entry").path(), |_| b"spoilt".to_vec());
    }
    assert!(gc(&world).status.success());
    assert!(world.holes().is_empty(), "{:?}", world.holes());
    world.bake(&[]).ok();
    assert!(world.files() == before);
}

#[test]
fn nothing_goes_as_long_as_it_cannot_be_told_what_is_current() {
    type Harm = (&'static str, fn(&World));
    let harms: [Harm; 5] = [
        ("current.ron is missing", |world| {
            fs::remove_file(world.file("baked/current.ron")).expect("removed")
        }),
        ("current.ron", |world| damage(&world.file("baked/current.ron"), |_| b"Current(gener".to_vec())),
        ("current.ron: ", |world| {
            fs::remove_file(world.file("baked/current.ron")).expect("removed");
            fs::create_dir(world.file("baked/current.ron")).expect("made");
        }),
        ("scene.gltf is missing", |world| fs::remove_file(world.scene(2)).expect("removed")),
        ("is not as it was baked", |world| {
            damage(&world.scene(2), |bytes| {
                String::from_utf8(bytes).expect("text").replacen("blobs/", "bloos/", 1).into()
            })
        }),
    ];
    for (words, harm) in harms {
        let world = World::starters();
        harm(&world);
        let before = world.files();
        let output = gc(&world);
        assert!(!output.status.success(), "{words}");
        assert!(
            said(&output).contains(words) && said(&output).contains("nothing was removed"),
            "{}",
            said(&output)
        );
        assert!(world.files() == before);
        world.bake(&[]).ok();
        assert!(gc(&world).status.success(), "{words}: `bake` puts it right, as it says");
        assert!(world.files() == World::starters().files());
    }
}

/// As if the clock jumped, or the bake took longer than any grace: all that it counts on looks old.
#[test]
fn gc_waits_for_a_bake() {
    let world = World::new();
    let (mut child, mut lines) = world.spawn(&[]);
    assert!(lines.any(|line| line.contains("\"finished\"")), "a stage");
    world.age();
    let collector =
        world.command(&["cache", "gc", "--max-size", "0"]).stderr(std::process::Stdio::piped()).spawn();
    let lines: Vec<String> = lines.inspect(|_| world.age()).collect();
    assert!(child.wait().expect("ended").success(), "{lines:?}");
    assert!(!lines.iter().any(|line| line.contains("\"notice\"")), "{lines:?}");
    let output = collector.expect("runs").wait_with_output().expect("ended");
    assert!(output.status.success() && said(&output).contains("waiting until no bake"), "{}", said(&output));
    assert!(world.holes().is_empty(), "{:?}", world.holes());
    assert!(world.files() == World::starters().files());
}

#[test]
fn what_killed_programs_left_goes_and_what_a_person_left_stays() {
    let world = World::starters();
    let old = |name: &str| {
        fs::create_dir_all(world.file(name).parent().expect("a folder")).expect("made");
        let file = fs::File::create(world.file(name)).expect("made");
        file.set_modified(std::time::SystemTime::now() - std::time::Duration::from_secs(3600)).expect("set");
    };
    let ours = ["population/.draft-Ab3xYz", ".draft-Cd4wXy", "baked/staged/file-Ef5vWx"];
    let theirs = [
        "population/.draft-mine",
        "baked/actions/notes.txt",
        "baked/actions/ab.aside-1/notes.txt",
        "baked/blobs/ab/x.png#1",
    ];
    ours.iter().chain(&theirs).for_each(|name| old(name));
    let output = gc(&world);
    assert!(output.status.success() && said(&output).contains("3 half-written files"), "{}", said(&output));
    let verify = world.run(&["cache", "verify"]);
    assert!(
        verify.status.success() && said(&verify).contains("actions/notes.txt: none of ours, left alone"),
        "{}",
        said(&verify)
    );
    assert!(!ours.iter().any(|name| world.file(name).exists()));
    assert!(theirs.iter().all(|name| world.file(name).exists()));
}

#[test]
fn a_scene_that_lost_parts_goes_and_what_is_no_scene_of_ours_stays() {
    let world = World::starters();
    // Another generation, with scenes of its own, and a person's file where a scene might be.
    fs::copy(world.population(0), world.population(1)).expect("copied");
    world.edit(1, |text| text.replacen("generation: 0", "generation: 1", 1));
    world.edit(1, |text| text.replacen("sun_azimuth_deg: ", "sun_azimuth_deg: 0.0, // ", 1));
    world.bake(&[]).ok();
    let population = world.population(0);
    world.bake(&[population.to_str().expect("text")]).ok();
    let scene = |scene: usize| world.file(&format!("baked/g0001/scene-{scene}/scene.gltf"));
    fs::write(scene(3), "a person's").expect("written");
    let output = gc(&world);
    assert!(output.status.success() && said(&output).contains("parts of it are gone"), "{}", said(&output));
    let stays = [0, 1, 2, 3].map(|index| scene(index).exists());
    assert_eq!(stays, [false, true, true, true], "the others share all their parts with current ones");
    assert!(world.holes().is_empty(), "{:?}", world.holes());
}

/// Things that happen to a world.
#[derive(Clone, Debug)]
enum Step {
    /// Another sky for a scene.
    Edit(usize, u32),
    Bake,
    /// A bake that is killed when it has told so many events.
    Kill(usize),
    Collect,
    ForgetHistories,
}

fn step() -> impl Strategy<Value = Step> {
    prop_oneof![
        3 => (0_usize..4, 0_u32..4).prop_map(|(scene, sky)| Step::Edit(scene, 90 * sky)),
        1 => Just(Step::Bake),
        2 => (0_usize..120).prop_map(Step::Kill),
        3 => Just(Step::Collect),
        1 => Just(Step::ForgetHistories),
    ]
}

fn take(world: &World, step: &Step) {
    match *step {
        Step::Edit(scene, azimuth_deg) => turn_the_sun(world, scene, azimuth_deg),
        Step::Bake => {
            world.bake(&[]).ok();
        }
        Step::Kill(events) => {
            let (mut child, lines) = world.spawn(&[]);
            assert!(lines.take(events).count() <= events);
            child.kill().expect("killed");
            child.wait().expect("ended");
        }
        Step::Collect => {
            world.age();
            let output = gc(world);
            assert!(output.status.success(), "{}", said(&output));
        }
        Step::ForgetHistories => {
            let _ = fs::remove_dir_all(world.file("baked/history"));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 6, failure_persistence: None, ..Default::default() })]

    #[test]
    fn the_current_scenes_are_whole_whatever_happens(steps in prop::collection::vec(step(), 4..9)) {
        let world = World::starters();
        for step in &steps {
            take(&world, step);
            prop_assert!(world.holes().is_empty(), "after {:?} of {:?}: {:?}", step, steps, world.holes());
        }
    }
}
