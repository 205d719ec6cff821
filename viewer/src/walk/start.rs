//! Where a walk begins: where the bake says, in the camera of a landscape's file (`StartView`).
//!
//! Four landscapes share one place, and each file names its own. The one taken is the start that suits the worst of the
//! four best, for one cannot vote on a landscape that is not to be seen; then the one that suits all of them best, and of
//! several the first.

use genescape_schema::scene::StartView;
use glam::Vec2;

use super::{BODY_RADIUS_M, EYE_HEIGHT_M, Land, Pose, nearest_free};

/// Air around a walker at the start, so that no trunk fills the picture.
const ROOM_M: f32 = 1.5;
/// Ground that rises by more than [`WALL_SLOPE`] above the eye within this distance fills the picture.
const WALL_M: f32 = 25.0;
const WALL_SLOPE: f32 = 0.27;
/// A tree between these distances, no farther to the side than [`SIDEWARDS`] of it, can be judged.
const TREE_M: [f32; 2] = [6.0, 60.0];
const SIDEWARDS: f32 = 0.5;

/// Where to begin: one of the landscapes' own starts, moved no farther than trunks make necessary.
pub fn start_pose(lands: &[&Land]) -> Pose {
    let merit = |start: &StartView| {
        let merits = lands.iter().map(|land| merit(land, place_m(start), ahead(start)));
        (merits.clone().min(), merits.sum::<u32>())
    };
    // Of equal ones `max_by_key` would take the last.
    let starts = lands.iter().rev().map(|land| land.start);
    let Some(start) = starts.max_by_key(merit) else {
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

/// Whether a walker there stands in all landscapes on dry ground with room around, and before no wall.
pub fn suits_all(lands: &[&Land], pose: &Pose) -> bool {
    lands.iter().all(|land| stands(land, pose.place_m()) && !faces_a_wall(land, pose.place_m(), pose.ahead()))
}

fn place_m(start: &StartView) -> Vec2 {
    Vec2::new(start.position_m.x, start.position_m.z)
}

/// Level unit vector (x, z) of the direction of view.
fn ahead(start: &StartView) -> Vec2 {
    Vec2::new(start.direction.x, start.direction.z).normalize_or(Vec2::NEG_Y)
}

/// How well a landscape suits a walker who begins there: to stand weighs more than to see, land more than trees.
fn merit(land: &Land, place_m: Vec2, ahead: Vec2) -> u32 {
    4 * u32::from(stands(land, place_m))
        + 2 * u32::from(!faces_a_wall(land, place_m, ahead))
        + u32::from(sees_a_tree(land, place_m, ahead))
}

/// Whether the ground is dry and has room to stand.
fn stands(land: &Land, place_m: Vec2) -> bool {
    let dry = land.water_level_m.is_none_or(|water_m| land.ground_m(place_m) > water_m);
    dry && land.trunks.clear(place_m, BODY_RADIUS_M + ROOM_M)
}

fn faces_a_wall(land: &Land, place_m: Vec2, ahead: Vec2) -> bool {
    let eye_m = land.footing_m(place_m) + EYE_HEIGHT_M;
    let rises = |distance_m: f32| {
        land.ground_m(place_m + ahead * distance_m) - eye_m > WALL_SLOPE * distance_m.max(0.25 * WALL_M)
    };
    (1..=5u8).any(|step| rises(WALL_M * f32::from(step) / 5.0))
}

fn sees_a_tree(land: &Land, place_m: Vec2, ahead: Vec2) -> bool {
    let [near_m, far_m] = TREE_M;
    land.trunks.near(place_m, far_m).any(|trunk| {
        let way_m = trunk.center_m - place_m;
        let along_m = way_m.dot(ahead);
        (near_m..far_m).contains(&along_m) && way_m.perp_dot(ahead).abs() < SIDEWARDS * along_m
    })
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use proptest::prelude::*;

    use super::*;
    use crate::walk::testing::{hilly, land_with, ramp, trunk};

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
    fn a_start_before_a_wall_or_without_a_tree_gives_way_to_one_with_a_view() {
        let level = |tree: Vec2| land_with([trunk(tree, 0.3)]);
        let (here, there) = (Vec2::ZERO, Vec2::new(0.0, 20.0));
        // From here, the second landscape's tree is behind.
        let first = with_start(level(Vec2::new(0.0, -30.0)), here, Vec3::NEG_Z);
        let second = with_start(level(Vec2::new(0.0, 10.0)), there, Vec3::NEG_Z);
        assert_eq!(start_pose(&[&first, &second]).place_m(), there);
        // Uphill to the east.
        let slope = ramp(0.5);
        let up = with_start(slope.clone(), here, Vec3::X);
        let down = with_start(slope, there, Vec3::NEG_X);
        assert_eq!(start_pose(&[&up, &down]).place_m(), there);
        assert!(!suits_all(&[&up, &down], &start_pose(&[&up])) && suits_all(&[&up], &start_pose(&[&down])));
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
