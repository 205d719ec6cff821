//! Two hundred random genomes: every one must bake.

mod common;

use common::World;

#[test]
fn two_hundred_random_genomes_bake() {
    for seed in 0..50 {
        let world = World::new();
        let baked = world.bake(&["random", "--seed", &seed.to_string()]);
        assert_eq!(baked.code, Some(0), "seed {seed}: {}", baked.stderr);
        assert_eq!(baked.of("scene_ready").count(), 4);
    }
}
