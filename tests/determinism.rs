//! The same bytes for any number of threads. (Debug against release is `cargo xtask test`'s, which has both.)

mod common;

use common::World;

#[test]
fn bytes_do_not_depend_on_threads() {
    let bake = |threads: &str| {
        let world = World::new();
        world.bake(&["--threads", threads]).ok();
        world.files()
    };
    let one = bake("1");
    assert!(one.len() > 50);
    for threads in ["2", "8"] {
        let other = bake(threads);
        assert_eq!(one.keys().collect::<Vec<_>>(), other.keys().collect::<Vec<_>>(), "{threads} threads");
        assert!(one == other, "{threads} threads");
    }
}

#[test]
fn a_seed_makes_the_same_world_twice() {
    let bake = |seed: &str| {
        let world = World::new();
        world.bake(&["random", "--seed", seed]).ok();
        std::fs::read(world.population(0)).expect("a population")
    };
    assert_eq!(bake("7"), bake("7"));
    assert_ne!(bake("7"), bake("8"));
}
