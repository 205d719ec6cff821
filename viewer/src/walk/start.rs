//! Where a walk begins: where the bake says, in the camera of a landscape's file (`StartView`).
//!
//! Four landscapes share one place, and each file names its own. The one taken is the start at which most of the four
//! have dry ground without trunks; of several the first.

use genescape_schema::scene::StartView;
use glam::Vec2;

use super::{BODY_RADIUS_M, EYE_HEIGHT_M, Land, Pose, nearest_free};

/// Air around a walker at the start, so that no trunk fills the picture.
const ROOM_M: f32 = 1.5;

/// Where to begin: one of the landscapes' own starts, moved no farther than trunks make necessary.
pub fn start_pose(lands: &[&Land]) -> Pose {
    // Of equal ones `max_by_key` would take the last.
    let starts = lands.iter().rev().map(|land| land.start);
    let Some(start) = starts.max_by_key(|start| agreement(lands, place_m(start))) else {
        return Pose { altitude_m: EYE_HEIGHT_M, ..Pose::default() };
    };
    let wanted_m = place_m(&start);
    let place_m = nearest_free(lands, wanted_m).unwrap_or(wanted_m);
    let top_m = lands.iter().map(|land| land.footing_m(place_m)).fold(f32::NEG_INFINITY, f32::max);
    let [x, y, z] = start.direction.to_array();
    Pose {
        x_m: place_m.x,
        z_m: place_m.y,
        yaw_rad: libm::atan2f(-x, -z),
        pitch_rad: libm::asinf(y.clamp(-1.0, 1.0)),
        altitude_m: top_m + EYE_HEIGHT_M,
        ..Pose::default()
    }
}

fn place_m(start: &StartView) -> Vec2 {
    Vec2::new(start.position_m.x, start.position_m.z)
}

/// How many of the landscapes have dry ground with room to stand at a place.
fn agreement(lands: &[&Land], place_m: Vec2) -> usize {
    let suits = |land: &&&Land| {
        let dry = land.water_level_m.is_none_or(|water_m| land.ground_m(place_m) > water_m);
        dry && land.trunks.clear(place_m, BODY_RADIUS_M + ROOM_M)
    };
    lands.iter().filter(suits).count()
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use proptest::prelude::*;

    use super::*;
    use crate::walk::testing::{hilly, trunk};

    fn with_start(mut land: Land, place_m: Vec2, direction: Vec3) -> Land {
        let position_m = Vec3::new(place_m.x, land.ground_m(place_m) + EYE_HEIGHT_M, place_m.y);
        land.start = StartView { position_m, direction: direction.normalize() };
        land
    }

    proptest! {
        #[test]
        fn one_stands_and_looks_as_the_file_says(
            seed in 0u64..1000, x in -50f32..50., z in -50f32..50., turn in 0f32..6.3, rise in -0.3f32..0.3,
        ) {
            let direction = Vec3::new(libm::sinf(turn), rise, libm::cosf(turn)).normalize();
            let land = with_start(hilly(seed, []), Vec2::new(x, z), direction);
            let pose = start_pose(&[&land]);
            prop_assert!(pose.place_m().distance(Vec2::new(x, z)) < 1e-4);
            prop_assert!((pose.altitude_m - land.start.position_m.y).abs() < 1e-3);
            let seen = crate::camera::Camera {
                position_m: Vec3::ZERO, yaw_rad: pose.yaw_rad, pitch_rad: pose.pitch_rad, fov_y_rad: 1.0,
            };
            prop_assert!(seen.forward().distance(direction) < 1e-4);
        }
    }

    #[test]
    fn the_start_that_suits_most_landscapes_is_taken() {
        let (here, there) = (Vec2::new(10.0, 5.0), Vec2::new(-20.0, 0.0));
        let one = with_start(hilly(3, []), here, Vec3::X);
        let other = with_start(hilly(4, [trunk(here, 0.5)]), there, Vec3::Z);
        assert_eq!(start_pose(&[&one, &other]).place_m(), there);
        assert_eq!(start_pose(&[&one]).place_m(), here);
    }

    #[test]
    fn no_trunk_stands_at_the_start_and_none_makes_it_fail() {
        let wooded = with_start(hilly(3, [trunk(Vec2::ZERO, 0.3)]), Vec2::ZERO, Vec3::X);
        assert!(wooded.trunks.clear(start_pose(&[&wooded]).place_m(), BODY_RADIUS_M));
        let full = with_start(hilly(3, [trunk(Vec2::ZERO, 500.0)]), Vec2::ZERO, Vec3::X);
        assert_eq!(start_pose(&[&full]).place_m(), Vec2::ZERO);
        assert_eq!(start_pose(&[]).place_m(), Vec2::ZERO);
    }
}
