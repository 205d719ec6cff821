//! What holds for the camera of four views whatever the person does.

use std::sync::LazyLock;

use glam::Vec2;
use proptest::prelude::*;

use super::testing::{forest, hilly, land_with, trunk};
use super::*;
use crate::input::Controls;
use crate::scene::{Asset, AssetVertex, Part, Range, Shape, ShapeLevel, StartView};

/// Four dense forests on four different lands, many times over.
static FORESTS: LazyLock<Vec<[Land; 4]>> = LazyLock::new(|| {
    (0..24)
        .map(|set| {
            // From open to nearly impassable: 150 to 1,000 trunks of all four on 60 m × 60 m.
            let count = 40 + 10 * set as u32;
            std::array::from_fn(|view| {
                let seed = 4 * set + view as u64;
                let extent_m = if set % 3 == 0 { 63.5 } else { 30.0 };
                let mut land = hilly(seed, forest(seed, count, extent_m));
                land.water_level_m = (view == 1).then_some(-5.0);
                land
            })
        })
        .collect()
});

fn borrowed(lands: &[Land; 4]) -> [&Land; 4] {
    lands.each_ref()
}

prop_compose! {
    fn controls()(forward in -1f32..=1., right in -1f32..=1., up in -1f32..=1., run: bool,
                  turn in (-400f32..400., -200f32..200.), rate in (-1f32..=1., -1f32..=1.), wheel in -2f32..2.)
        -> Controls {
        Controls {
            forward, right, up, run, wheel,
            turn_px: Vec2::new(turn.0, turn.1),
            turn_rate: Vec2::new(rate.0, rate.1),
        }
    }
}

/// A frame: its length, the wishes, and how many frames they last.
/// A file with a box in it, or several in one place.
fn boxed(bounds_m: [glam::Vec3; 2], copies: usize) -> Asset {
    let corner = |n: u32| [0, 1, 2].map(|axis| bounds_m[(n >> axis & 1) as usize][axis]);
    let vertices = (0..8).map(|n| AssetVertex { position_m: corner(n), ..AssetVertex::default() }).collect();
    let parts = vec![Part { surface: 0, range: Range { first: 0, count: 8 } }];
    let levels = vec![ShapeLevel { error_m: 0.0, parts }];
    let shape = Shape { levels, copies: vec![glam::DAffine3::IDENTITY; copies], ..Shape::default() };
    Asset { bounds_m, shapes: vec![shape], vertices, indices: (0..8).collect(), ..Asset::default() }
}

fn frames() -> impl Strategy<Value = Vec<(f32, Controls, u8)>> {
    let dt_s = prop_oneof![4 => 0.002f32..0.04, 1 => 0.04f32..2.0];
    prop::collection::vec((dt_s, controls(), 1u8..4), 1..4)
}

/// Ten times as many where `GENESCAPE_LONG` is set.
fn walks() -> u32 {
    if std::env::var_os("GENESCAPE_LONG").is_some() { 10_000 } else { 1000 }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: walks(), max_shrink_iters: 2000, ..ProptestConfig::default() })]
    #[test]
    fn walks_end_outside_every_trunk_and_on_the_ground(
        set in 0usize..24, x in -70f32..70., z in -70f32..70., yaw_rad in -9f32..9., speed in 0.5f32..40.,
        frames in frames()
    ) {
        let lands = borrowed(&FORESTS[set]);
        let feel = Feel { walk_mps: speed, ..Feel::default() };
        let mut rig = Rig::new(Pose { x_m: x, z_m: z, yaw_rad, ..Pose::default() }, &lands);
        for (dt_s, controls, times) in &frames {
            for _ in 0..*times {
                rig.step(*dt_s, controls, &feel, &lands);
                let place = rig.pose().place_m();
                for land in lands {
                    // One by one, without the index.
                    for trunk in &land.trunks.trunks {
                        prop_assert!(trunk.clears(place, BODY_RADIUS_M), "{place} is inside {trunk:?}");
                    }
                    let eye = rig.camera(land, 1.0).position_m;
                    let feet = land.field.height_m(place.x, place.y).max(land.water_level_m.map_or(-1e9, |w| w - 1.2));
                    prop_assert_eq!(eye.y, feet + 1.6);
                }
                prop_assert!(place.abs().max_element() <= 63.0, "off the land at {place}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]
    #[test]
    fn all_views_have_gone_the_same_way_and_none_looks_from_below_its_ground(
        set in 0usize..24, frames in frames(), changes in prop::collection::vec(0u8..3, 4), begun in any::<bool>()
    ) {
        let lands = &FORESTS[set];
        let begin = |(number, land): (usize, &Land)| {
            let turn = number as f32;
            let direction = Vec3::new(libm::sinf(turn), 0.1 * turn - 0.1, libm::cosf(turn)).normalize();
            let place_m = Vec2::new(9.0 * turn, -5.0 * turn);
            let position_m = place_m.extend(land.ground_m(place_m) + EYE_HEIGHT_M).xzy();
            Land { start: StartView { position_m, direction }, ..land.clone() }.from_its_start()
        };
        let laid: Vec<Land> =
            if begun { lands.iter().enumerate().map(begin).collect() } else { lands.to_vec() };
        let lands = [0, 1, 2, 3].map(|number| &laid[number]);
        let mut rig = Rig::new(Pose::default(), &lands);
        for ((dt_s, controls, _), changes) in frames.iter().zip(changes) {
            for _ in 0..changes {
                rig.cycle_mode(&lands);
            }
            rig.step(*dt_s, controls, &Feel::default(), &lands);
            let cameras = lands.map(|land| rig.camera(land, 1.0));
            let pose = rig.pose();
            for (camera, land) in cameras.iter().zip(lands) {
                let gone_m = land.anchor.in_walk(Vec2::new(camera.position_m.x, camera.position_m.z));
                let edge_m = WALKABLE * 0.5 * land.field.extent_m() - 1e-2;
                let is_at_edge = land.anchor.in_land(pose.place_m()).abs().max_element() > edge_m;
                prop_assert!(gone_m.distance(pose.place_m()) < 1e-3 || is_at_edge, "{gone_m} {pose:?}");
                prop_assert!(wrapped(camera.yaw_rad - land.anchor.yaw_rad - pose.yaw_rad).abs() < 1e-5);
                prop_assert!(camera.pitch_rad.abs() <= MAX_PITCH_RAD);
                let ground_m = land.field.height_m(camera.position_m.x, camera.position_m.z);
                prop_assert!(camera.position_m.y >= ground_m + MIN_HEIGHT_M - 1e-3, "{camera:?} {ground_m}");
            }
        }
    }

    #[test]
    fn one_long_frame_leads_where_many_short_ones_do(
        dt_s in 0.01f32..MAX_STEP_S, pieces in 2u32..40, mut wish in controls(), mode in 0u8..2,
        before in (-8f32..8., -8f32..8.)
    ) {
        let land = land_with([]);
        let mode = [Mode::Walk, Mode::Fly][mode as usize];
        // The direction stays: who turns while walking walks an arc, and a long frame is its chord.
        (wish.turn_px, wish.turn_rate, wish.wheel) = (Vec2::ZERO, Vec2::ZERO, 0.0);
        let mut once = Rig::new(Pose { mode, altitude_m: 50.0, ..Pose::default() }, &[&land]);
        once.velocity_mps = Vec3::new(before.0, 0.0, before.1);
        let mut often = once.clone();
        once.step(dt_s, &wish, &Feel::default(), &[&land]);
        for _ in 0..pieces {
            often.step(dt_s / pieces as f32, &wish, &Feel::default(), &[&land]);
        }
        prop_assert!(once.pose.place_m().distance(often.pose.place_m()) < 1e-3, "{once:?} {often:?}");
        prop_assert!((once.pose.altitude_m - often.pose.altitude_m).abs() < 1e-3);
        prop_assert!(once.velocity_mps.distance(often.velocity_mps) < 1e-3);
    }

    #[test]
    fn a_mode_passed_through_keeps_the_place_and_no_eye_jumps(
        set in 0usize..24, x in -40f32..40., z in -40f32..40., dt_s in 0f32..0.25
    ) {
        let lands = borrowed(&FORESTS[set]);
        let mut rig = Rig::new(Pose { x_m: x, z_m: z, ..Pose::default() }, &lands);
        let place = rig.pose().place_m();
        for _ in 0..3 {
            let before = lands.map(|land| rig.camera(land, 1.0).position_m);
            rig.cycle_mode(&lands);
            let after = lands.map(|land| rig.camera(land, 1.0).position_m);
            for (before, after) in before.iter().zip(after) {
                prop_assert!(before.distance(after) < 0.02, "from {before} to {after}");
            }
            rig.step(dt_s, &Controls::default(), &Feel::default(), &lands);
        }
        prop_assert_eq!(rig.mode(), Mode::Walk);
        prop_assert!(rig.pose().place_m().distance(place) < 0.2);
    }

    #[test]
    fn an_orbit_looks_at_its_point_from_its_distance(
        frames in frames(), x in -40f32..40., z in -40f32..40.
    ) {
        let land = land_with([]);
        let lands = [&land];
        let mut rig = Rig::new(Pose { x_m: x, z_m: z, mode: Mode::Orbit, ..Pose::default() }, &lands);
        for (dt_s, controls, _) in &frames {
            rig.step(*dt_s, controls, &Feel::default(), &lands);
            let camera = rig.camera(&land, 1.0);
            let seen = camera.position_m + camera.forward() * rig.pose().distance_m;
            let target_m = Vec2::new(rig.target_m.x, rig.target_m.z);
            // Low and near, the eye is lifted to keep off the ground.
            let lifted = (MIN_HEIGHT_M - rig.pose().distance_m * libm::sinf(-rig.pose().pitch_rad)).max(0.0);
            prop_assert!((seen.y - lifted).abs() < 0.01 && within(&lands, target_m) == target_m);
            prop_assert!(Vec2::new(seen.x, seen.z).distance(target_m) < 0.01, "{seen} {target_m}");
        }
    }

    #[test]
    fn all_of_a_file_is_in_the_picture_at_first_and_an_orbit_stays_around_it(
        frames in frames(), size in prop::array::uniform3(-3f32..4.5), x in -1e4f32..1e4, turn in -2000f32..2000., copies in 1usize..32
    ) {
        let size_m = glam::Vec3::from(size.map(libm::exp10f));
        let low_m = glam::Vec3::new(x, 3.0, -x);
        let asset = boxed([low_m, low_m + size_m], copies);
        let land = Land::under(&asset);
        let lands = [&land];
        let mut rig = Rig::new(start_pose(&lands), &lands);
        let camera = rig.camera(&land, 60f32.to_radians());
        let (clip, staging) = (camera.clip_from_world(1.0), asset.staging());
        let [low, high] = asset.bounds_m.map(|corner| staging.world_from_file.transform_point3(corner.as_dvec3()).as_vec3());
        for corner in 0..8u32 {
            let pick = |axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
            let seen = clip * glam::Vec4::new(pick(0), pick(1), pick(2), 1.0);
            prop_assert!(seen.x.abs() < 1.01 * seen.w && seen.y.abs() < 1.01 * seen.w, "{seen}");
        }
        let middle = glam::Vec3::Y * staging.middle_m;
        for (dt_s, controls, _) in &frames {
            // Not aside: that moves the point.
            let turn_px = Vec2::new(turn, -turn);
            let controls = Controls { wheel: controls.wheel, up: controls.up, turn_px, ..Controls::default() };
            rig.step(*dt_s, &controls, &Feel::default(), &lands);
            let camera = rig.camera(&land, 1.0);
            let seen = camera.position_m + camera.forward() * rig.pose().distance_m;
            prop_assert!(seen.distance(middle) < 1e-3 * (rig.pose().distance_m + 1.0), "{seen} {middle}");
        }
        prop_assert!(turn < 500.0 || frames.is_empty() || rig.pose().pitch_rad > 0.0, "also from below");
    }

    #[test]
    fn a_swapped_forest_moves_a_walker_out_of_its_trunks(set in 0usize..24, other in 0usize..24, x in -25f32..25., z in -25f32..25.) {
        let (before, after) = (borrowed(&FORESTS[set]), borrowed(&FORESTS[other]));
        let mut rig = Rig::new(Pose { x_m: x, z_m: z, ..Pose::default() }, &before);
        let place = rig.pose().place_m();
        rig.step(0.016, &Controls::default(), &Feel::default(), &after);
        prop_assert!(free(&after, rig.pose().place_m()));
        if free(&after, place) {
            prop_assert_eq!(rig.pose().place_m(), place);
        }
    }
}

#[test]
fn nothing_that_comes_in_is_bad_enough_to_panic() {
    let bad = Pose {
        x_m: f32::NAN,
        z_m: f32::INFINITY,
        yaw_rad: 1e30,
        pitch_rad: -f32::INFINITY,
        altitude_m: f32::NAN,
        distance_m: f32::NAN,
        ..Pose::default()
    };
    let full = land_with([trunk(Vec2::ZERO, 500.0)]);
    let broken = Land { field: Default::default(), ..land_with([]) };
    let wish = Controls {
        forward: f32::NAN,
        turn_px: Vec2::NAN,
        wheel: f32::NAN,
        up: f32::INFINITY,
        ..Controls::default()
    };
    for mode in [Mode::Walk, Mode::Fly, Mode::Orbit] {
        for lands in [&[][..], &[&full], &[&broken], &[&full, &broken]] {
            let mut rig = Rig::new(Pose { mode, ..bad }, lands);
            for dt_s in [0.016, f32::NAN, -1.0, 1e9, f32::INFINITY] {
                rig.step(dt_s, &wish, &Feel::default(), lands);
                rig.step(
                    dt_s,
                    &Controls { forward: 1.0, run: true, ..Controls::default() },
                    &Feel::default(),
                    lands,
                );
                assert!(rig.camera(&full, 1.0).position_m.is_finite(), "{rig:?}");
                rig.cycle_mode(lands);
            }
        }
    }
}

#[test]
fn who_finds_no_free_place_stays() {
    let full = land_with([trunk(Vec2::ZERO, 500.0)]);
    let mut rig = Rig::new(Pose { x_m: 3.0, z_m: 4.0, ..Pose::default() }, &[&full]);
    rig.step(0.1, &Controls { forward: 1.0, ..Controls::default() }, &Feel::default(), &[&full]);
    assert_eq!(rig.pose().place_m(), Vec2::new(3.0, 4.0));
}

#[test]
fn the_mouse_looks_where_it_moves() {
    let look = |x: f32, y: f32, invert: bool| {
        let mut rig = Rig::new(Pose::default(), &[]);
        let turn = Controls { turn_px: Vec2::new(x, y), ..Controls::default() };
        rig.step(0.016, &turn, &Feel { invert, ..Feel::default() }, &[]);
        rig.pose()
    };
    assert!(look(10.0, 0.0, false).ahead().x > 0.0, "to the right is east, facing north");
    assert!(look(0.0, -10.0, false).pitch_rad > 0.0, "up is up");
    assert!(look(0.0, -10.0, true).pitch_rad < 0.0, "unless inverted");
    assert_eq!(look(0.0, 1e6, false).pitch_rad, -MAX_PITCH_RAD);
}

#[test]
fn a_lake_carries_and_does_not_drown() {
    let mut lake = land_with([]);
    lake.water_level_m = Some(10.0);
    let rig = Rig::new(Pose::default(), &[&lake]);
    assert_eq!(rig.camera(&lake, 1.0).position_m.y, 10.0 - WADING_DEPTH_M + EYE_HEIGHT_M);
    lake.water_level_m = Some(0.5);
    assert_eq!(rig.camera(&lake, 1.0).position_m.y, EYE_HEIGHT_M, "shallow water is waded through");
}

/// Walks east; where that leads no farther, turns aside for a moment, as a person does: a little to the left, to the
/// right, more to the left, and so on.
fn crosses(rig: &mut Rig, lands: &[&Land], to_x_m: f32) -> bool {
    const ASIDE: [f32; 6] = [0.3, -0.3, 0.5, -0.5, 0.8, -0.8];
    const EAST_RAD: f32 = -0.5 * PI;
    let wish = Controls { forward: 1.0, ..Controls::default() };
    let walk = |rig: &mut Rig, yaw_rad: f32| {
        let from = rig.pose();
        rig.pose.yaw_rad = yaw_rad;
        (0..30).for_each(|_| rig.step(1.0 / 60.0, &wish, &Feel::default(), lands));
        rig.pose().place_m().distance(from.place_m())
    };
    let mut turns = 0;
    for _ in 0..2000 {
        if rig.pose().x_m > to_x_m {
            return true;
        }
        if walk(rig, EAST_RAD) < 0.3 {
            let aside_rad = ASIDE[turns % ASIDE.len()] * PI;
            (0..2 + turns / ASIDE.len()).for_each(|_| _ = walk(rig, EAST_RAD + aside_rad));
            turns += 1;
        }
    }
    false
}

#[test]
fn a_walker_that_turns_aside_where_it_is_stuck_crosses_four_forests() {
    // A trunk each 7 m²: straight on alone ends in a pocket.
    let lands: [Land; 4] = std::array::from_fn(|view| land_with(forest(900 + view as u64, 500, 60.0)));
    let lands = borrowed(&lands);
    for line in 0..40 {
        let start = Pose { x_m: -58.0, z_m: 2.0 * line as f32 - 40.0, ..Pose::default() };
        let mut rig = Rig::new(start, &lands);
        assert!(crosses(&mut rig, &lands, 2.0), "line {line} ended at {}", rig.pose().place_m());
    }
}

#[test]
fn the_same_wishes_lead_to_the_same_place() {
    let lands = borrowed(&FORESTS[7]);
    let walked = || {
        let mut rig = Rig::new(Pose::default(), &lands);
        for frame in 0..600 {
            let controls =
                Controls { forward: 1.0, turn_px: Vec2::new(frame as f32 % 7.0, 0.0), ..Controls::default() };
            rig.step(0.01 + 0.0001 * frame as f32, &controls, &Feel::default(), &lands);
        }
        rig
    };
    assert_eq!(walked(), walked());
}
