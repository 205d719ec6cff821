//! Where a walk begins: on high ground near the middle, "which generally allows the user to gain an impression of the
//! whole scene" (thesis section 6), and facing what there is to see.
//!
//! Four landscapes share the place, so it cannot be the highest in each. A place's worth in one landscape is its height
//! as a part of that landscape's range, 0 in its deepest hollow and 1 on its top; the place with the greatest sum is
//! taken. So a hilly landscape does not outvote three gentle ones, and level land, where it makes no difference, has no
//! vote. A lake's bed is worth nothing.

use std::f32::consts::{FRAC_PI_4, TAU};

use glam::{Vec2, Vec3};

use super::{BODY_RADIUS_M, EYE_HEIGHT_M, Land, Mode, Pose, nearest_free, reach_m};

/// Radius around the middle within which walks start: the thesis's "certain distance".
pub const START_RADIUS_M: f32 = 128.0;
/// Air around a walker at the start, so that no trunk fills the picture.
const ROOM_M: f32 = 1.5;
/// Candidates lie on a grid no finer than this.
const GRID_M: f32 = 1.0;
/// Angle between the direction of view and the sun: behind and to the side, where light models the land best.
const SUN_RAD: f32 = 3.0 * FRAC_PI_4;

/// Where to begin: the best place within `radius_m` of the middle, clear of trunks, looking across the middle of the
/// land; with the sun behind and to the side if its direction (towards it) is given.
pub fn start_pose(lands: &[&Land], radius_m: f32, sun: Option<Vec3>) -> Pose {
    let place_m = high_place(lands, radius_m);
    let top_m = lands.iter().map(|land| land.footing_m(place_m)).fold(f32::NEG_INFINITY, f32::max);
    Pose {
        x_m: place_m.x,
        z_m: place_m.y,
        yaw_rad: yaw(place_m, reach_m(lands), sun),
        pitch_rad: -0.06,
        mode: Mode::Walk,
        altitude_m: if top_m.is_finite() { top_m + EYE_HEIGHT_M } else { EYE_HEIGHT_M },
        ..Pose::default()
    }
}

/// The most worthy place with room around it; where trunks leave no room, the free place nearest to the middle.
fn high_place(lands: &[&Land], radius_m: f32) -> Vec2 {
    let radius_m = if radius_m.is_finite() { radius_m.clamp(0.0, 1000.0).min(reach_m(lands)) } else { 0.0 };
    let spacing_m = lands.iter().map(|land| land.field.spacing_m).fold(GRID_M, f32::max);
    let lines = (radius_m / spacing_m) as i32;
    let mut best: Option<(f32, Vec2)> = None;
    for j in -lines..=lines {
        for i in -lines..=lines {
            let place_m = Vec2::new(i as f32, j as f32) * spacing_m;
            if place_m.length() > radius_m {
                continue;
            }
            let worth: f32 = lands.iter().map(|land| worth(land, place_m)).sum();
            // Only a strictly better place moves it, so the order of the search decides between equals.
            let better = best.is_none_or(|(most, _)| worth > most);
            if better && has_room(lands, place_m) {
                best = Some((worth, place_m));
            }
        }
    }
    match best {
        Some((worth, place_m)) if worth > 0.0 => place_m,
        // All is level: nothing is better than the middle.
        _ => nearest_free(lands, Vec2::ZERO).unwrap_or(Vec2::ZERO),
    }
}

fn has_room(lands: &[&Land], place_m: Vec2) -> bool {
    lands.iter().all(|land| land.trunks.clear(place_m, BODY_RADIUS_M + ROOM_M))
}

/// 0 to 1.
fn worth(land: &Land, place_m: Vec2) -> f32 {
    let [low_m, high_m] = land.field.range_m();
    let height_m = land.ground_m(place_m);
    if high_m - low_m < 1e-3 || land.water_level_m.is_some_and(|water_m| height_m <= water_m) {
        return 0.0;
    }
    ((height_m - low_m) / (high_m - low_m)).clamp(0.0, 1.0)
}

/// The direction among 72 that is best for both wishes: towards the middle, the more so the farther it is, and the sun
/// behind to the side.
fn yaw(place_m: Vec2, reach_m: f32, sun: Option<Vec3>) -> f32 {
    const DIRECTIONS: u32 = 72;
    let off_middle = if reach_m > 0.0 { (place_m.length() / reach_m).min(1.0) } else { 0.0 };
    let inwards = -place_m.normalize_or_zero() * (0.5 + off_middle);
    let level_sun = sun.map_or(Vec2::ZERO, |sun| Vec2::new(sun.x, sun.z)).normalize_or_zero();
    let worth = |yaw_rad: f32| {
        let ahead = Pose { yaw_rad, ..Pose::default() }.ahead();
        let off_sun_rad = libm::acosf(ahead.dot(level_sun).clamp(-1.0, 1.0));
        let lit = if level_sun == Vec2::ZERO { 0.0 } else { 2.0 * libm::cosf(off_sun_rad - SUN_RAD) };
        ahead.dot(inwards) + lit
    };
    let mut best = (f32::NEG_INFINITY, 0.0);
    for i in 0..DIRECTIONS {
        let yaw_rad = super::wrapped(i as f32 * (TAU / DIRECTIONS as f32));
        let here = worth(yaw_rad);
        if here > best.0 {
            best = (here, yaw_rad);
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::walk::testing::{hilly, trunk};
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]
        #[test]
        fn no_place_nearby_is_worth_more(seed in 0u64..1000, x in -60f32..60., z in -60f32..60.) {
            let (one, other) = (hilly(seed, []), hilly(seed + 1, []));
            let lands = [&one, &other];
            let start = start_pose(&lands, 40.0, None);
            prop_assert!(start.place_m().length() <= 40.0);
            let of = |place_m| lands.iter().map(|land| worth(land, place_m)).sum::<f32>();
            let sample = (Vec2::new(x, z) / one.field.spacing_m).round() * one.field.spacing_m;
            prop_assume!(sample.length() <= 40.0);
            prop_assert!(of(sample) <= of(start.place_m()));
        }

        #[test]
        fn the_sun_is_behind_to_the_side_and_the_middle_ahead(seed in 0u64..1000, sun_angle in 0f32..6.3) {
            let land = hilly(seed, []);
            let (sin, cos) = libm::sincosf(sun_angle);
            let lit = start_pose(&[&land], 40.0, Some(Vec3::new(sin, 0.7, cos)));
            prop_assert!(lit.ahead().dot(Vec2::new(sin, cos)) < 0.2, "into the sun");
            let dark = start_pose(&[&land], 40.0, None);
            prop_assume!(dark.place_m().length() > 1.0);
            prop_assert!(dark.ahead().dot(-dark.place_m().normalize()) > 0.99);
        }
    }

    #[test]
    fn no_trunk_stands_at_the_start_and_none_makes_it_fail() {
        let bare = hilly(3, []);
        let top = start_pose(&[&bare], 40.0, None).place_m();
        let wooded = hilly(3, [trunk(top, 0.3)]);
        let start = start_pose(&[&bare, &wooded], 40.0, None).place_m();
        assert_ne!(start, top);
        assert!(has_room(&[&wooded], start));
        let full = hilly(3, [trunk(Vec2::ZERO, 500.0)]);
        assert_eq!(start_pose(&[&full], 40.0, None).place_m(), Vec2::ZERO);
        assert_eq!(start_pose(&[], 40.0, None).place_m(), Vec2::ZERO);
    }
}
