//! A wish to move → where a walker's feet can go among the trunks of all landscapes (thesis 6.2), on the (x, z) plane.
//!
//! The four views share one way from where each begins. A trunk of one landscape therefore stops the walker in all of them:
//! were each view to collide with its own trees only, the four walkers would drift apart at the first tree. So a step
//! collides with the *union* of the trunks.
//!
//! A step is cut into pieces no longer than [`PIECE_M`], far below a body's diameter, so nothing is jumped over at any
//! speed. Where a piece ends inside a trunk, the walker is pushed out of it the shortest way, which slides it along the
//! trunk; then out of the next one, [`MAX_PUSHES`] times at most. A place is taken only after that very place, in the
//! numbers that the camera gets, was found clear of every trunk; if none is found the walker stays. So from a clear
//! place every step ends in a clear place, whatever cluster the trunks form. A gap narrower than the body holds a walker
//! up until it turns, as in any first-person walk.

use glam::Vec2;

use super::land::{BODY_RADIUS_M, Land, across_m, within};
use super::trunks::Trunk;

/// The longest piece of a step.
const PIECE_M: f32 = 0.1;
/// Air that is kept between body and trunk, so that rounding never makes them touch.
const SKIN_M: f32 = 1e-3;
/// Slowest slide around a trunk as a part of the speed. To run straight into a trunk is an unstable equilibrium of
/// sliding: this is what pushes off it. One that is hit dead on is passed on the right.
const MIN_SLIDE: f32 = 0.3;
/// Out of how many trunks a walker is pushed in one piece.
const MAX_PUSHES: u32 = 8;
/// A step is cut into at most this many pieces, 400 m in all; what is left of a longer one is not walked.
const MAX_PIECES: u32 = 4000;

/// True if a walker can stand here: clear of all trunks of all landscapes.
pub fn free(lands: &[&Land], place_m: Vec2) -> bool {
    lands.iter().all(|land| land.is_clear(place_m))
}

/// Where a walker at `from_m` ends up who wants to move by `by_m`. `from_m` must be free; the result is, too.
pub fn advance(lands: &[&Land], from_m: Vec2, by_m: Vec2) -> Vec2 {
    let length_m = by_m.length();
    if !length_m.is_finite() || length_m == 0.0 {
        return from_m;
    }
    let pieces = (length_m / PIECE_M).ceil().clamp(1.0, MAX_PIECES as f32);
    let piece_m = by_m / length_m * (length_m / pieces).min(PIECE_M);
    (0..pieces as u32).fold(from_m, |place_m, _| piece(lands, place_m, piece_m))
}

/// The free place nearest to `place_m`, which lies on the land: itself, or the first found on rings around it, each a
/// tenth wider than the last and at least 5 cm apart. `None` if the trunks leave no place anywhere.
pub fn nearest_free(lands: &[&Land], place_m: Vec2) -> Option<Vec2> {
    let start_m = within(lands, if place_m.is_finite() { place_m } else { Vec2::ZERO });
    if free(lands, start_m) {
        return Some(start_m);
    }
    let farthest_m = across_m(lands);
    std::iter::successors(Some(0.05f32), |ring_m| Some(ring_m + (0.1 * ring_m).max(0.05)))
        .take_while(|ring_m| *ring_m <= farthest_m)
        .find_map(|ring_m| on_ring(lands, start_m, ring_m))
}

/// The first free place on a ring, eastwards first.
fn on_ring(lands: &[&Land], center_m: Vec2, ring_m: f32) -> Option<Vec2> {
    const PLACES: u32 = 64;
    (0..PLACES)
        .map(|i| {
            let (sin, cos) = libm::sincosf(i as f32 * (std::f32::consts::TAU / PLACES as f32));
            center_m + ring_m * Vec2::new(cos, sin)
        })
        .find(|&place_m| within(lands, place_m) == place_m && free(lands, place_m))
}

/// One piece of a step. The land's edge is a wall that is slid along by dropping what leads across it.
fn piece(lands: &[&Land], from_m: Vec2, by_m: Vec2) -> Vec2 {
    let mut place_m = within(lands, from_m + by_m);
    for _ in 0..MAX_PUSHES {
        let Some(trunk) = deepest(lands, place_m) else { return place_m };
        place_m = within(lands, pushed_out(&trunk, place_m, by_m));
    }
    from_m
}

/// Of the trunks that a body at `place_m` would touch the one that it is deepest in.
fn deepest(lands: &[&Land], place_m: Vec2) -> Option<Trunk> {
    let depth_m = |trunk: &Trunk| trunk.radius_m - trunk.center_m.distance(place_m);
    let touched = lands.iter().flat_map(|land| land.touched(place_m));
    touched.max_by(|a, b| depth_m(a).total_cmp(&depth_m(b)))
}

/// The place nearest to `place_m` at which a body just does not touch a trunk, a little farther along it if the wish
/// `by_m` leads straight into it.
fn pushed_out(trunk: &Trunk, place_m: Vec2, by_m: Vec2) -> Vec2 {
    let reach_m = trunk.radius_m + BODY_RADIUS_M + SKIN_M;
    let normal = (place_m - trunk.center_m).try_normalize().unwrap_or_else(|| -by_m.normalize_or(Vec2::X));
    // With x east and z south, this is what lies on the right of a walker who faces the trunk.
    let right = Vec2::new(normal.y, -normal.x);
    let slide_m = by_m.dot(right);
    let missing_m = (MIN_SLIDE * by_m.length() - slide_m.abs()).max(0.0);
    let aside_m = if slide_m < 0.0 { -missing_m } else { missing_m };
    trunk.center_m + reach_m * (reach_m * normal + aside_m * right).normalize_or(normal)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::walk::testing::{forest, land_with, trunk};
    use proptest::prelude::*;

    /// Walks straight on in pieces as frames make them.
    fn walk(lands: &[&Land], from_m: Vec2, by_m: Vec2, steps: u32) -> Vec2 {
        (0..steps).fold(from_m, |place_m, _| advance(lands, place_m, by_m))
    }

    fn direction(angle: f32) -> Vec2 {
        let (sin, cos) = libm::sincosf(angle);
        Vec2::new(cos, sin)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]
        #[test]
        fn a_trunk_hit_head_on_is_passed(
            x in -20f32..20., z in -20f32..20., radius_m in 0.02f32..2.5, angle in 0f32..7., off_m in -1e-4f32..1e-4,
            stride_m in 0.005f32..1.0
        ) {
            let (center, toward) = (Vec2::new(x, z), direction(angle));
            let land = land_with([trunk(center, radius_m)]);
            let start = center - toward * (radius_m + 2.0) + toward.perp() * off_m;
            // Around half a circle at the slowest slide, and 4 m straight.
            let enough_m = 4.0 + 3.2 * (radius_m + 0.3) / MIN_SLIDE;
            let end = walk(&[&land], start, toward * stride_m, (enough_m / stride_m) as u32 + 4);
            prop_assert!((end - center).dot(toward) > radius_m + BODY_RADIUS_M, "stuck at {end}");
            prop_assert!(free(&[&land], end));
        }

        #[test]
        fn a_gap_wider_than_the_body_lets_it_through(
            gap_m in 0.51f32..1.5, left_m in 0.05f32..1.5, right_m in 0.05f32..1.5, aim in -0.99f32..0.99, stride_m in 0.01f32..0.7
        ) {
            // The trunks belong to different landscapes: the walker meets both.
            let one = land_with([trunk(Vec2::new(-0.5 * gap_m - left_m, 0.0), left_m)]);
            let other = land_with([trunk(Vec2::new(0.5 * gap_m + right_m, 0.0), right_m)]);
            // Aimed anywhere between the axes' middles, the trunks themselves lead into the gap.
            let x = if aim < 0.0 { aim * left_m } else { aim * right_m };
            let lands = [&one, &other];
            let start = Vec2::new(x, 4.0);
            let end = walk(&lands, start, Vec2::new(0.0, -stride_m), (30.0 / stride_m) as u32);
            prop_assert!(end.y < -3.0, "stuck at {end}");
            prop_assert!(end.x.abs() < 0.5 * gap_m, "went around: {end}");
        }

        #[test]
        fn an_open_direction_is_walked_to_its_end(
            seed in 0u64..1000, x in -40f32..40., z in -40f32..40., angle in 0f32..7., stride_m in 0.001f32..2.0
        ) {
            let land = land_with(forest(seed, 600, 60.0));
            let (from, toward) = (Vec2::new(x, z), direction(angle));
            // The longest way on which no trunk comes near, a trunk's width at a time.
            let clear = |way_m: f32| land.trunks.clear(from + toward * way_m, BODY_RADIUS_M + 0.03);
            let open_m = (0..100).map(|i| 0.1 * i as f32).take_while(|&way_m| clear(way_m)).last();
            prop_assume!(open_m.is_some_and(|open_m| open_m > stride_m));
            let steps = (open_m.unwrap_or(0.0) / stride_m) as u32;
            let end = walk(&[&land], from, toward * stride_m, steps);
            prop_assert!(end.distance(from + toward * stride_m * steps as f32) < 1e-2, "stopped at {end}");
        }

        #[test]
        fn no_stride_is_long_enough_to_jump_over_a_wall_of_trunks(
            stride_m in 0.001f32..300.0, x in -2f32..2., angle in -1f32..1.
        ) {
            let wall = land_with((-300..=300).map(|i| trunk(Vec2::new(0.5 * i as f32, 0.0), 0.05)));
            let (sin, cos) = libm::sincosf(angle);
            let end = walk(&[&wall], Vec2::new(x, 1.0), stride_m * Vec2::new(sin, -cos), 3);
            prop_assert!(end.y > 0.0, "{end}");
        }

        #[test]
        fn out_of_a_trunk_to_a_place_nearby(radius_m in 0.05f32..3.0, dx in -1f32..1., dz in -1f32..1.) {
            let land = land_with([trunk(Vec2::ZERO, radius_m)]);
            let start = 0.7 * radius_m * Vec2::new(dx, dz);
            let found = nearest_free(&[&land], start).expect("the land is nearly empty");
            prop_assert!(free(&[&land], found));
            let least = radius_m + BODY_RADIUS_M - start.length();
            prop_assert!(start.distance(found) <= 1.15 * least.max(0.0) + 0.1, "{start} to {found}, needed {least}");
        }

        #[test]
        fn a_pocket_that_was_walked_into_is_walked_out_of(
            arms in (1u32..12, 1u32..12), slant in 0f32..1.2, angle in 0f32..7., stride_m in 0.02f32..0.3
        ) {
            // A funnel of trunks: arms to both sides of the way that lean towards the walker. The trunks of an arm stand
            // 0.6 m apart however it leans, too close for a body to pass between them.
            let (toward, right) = (direction(angle), direction(angle).perp());
            let spacing_m = 0.6 / Vec2::new(1.0, slant).length();
            let at = |i: i32| trunk(spacing_m * (right * i as f32 - toward * slant * i.abs() as f32), 0.15);
            let land = land_with((-(arms.0 as i32)..=arms.1 as i32).map(at));
            let steps = (20.0 / stride_m) as u32;
            let start = -toward * 15.0;
            let pocket = walk(&[&land], start, toward * stride_m, steps);
            let end = walk(&[&land], pocket, -toward * stride_m, 2 * steps);
            prop_assert!(end.dot(toward) < -15.0, "stuck at {end}");
        }
    }

    #[test]
    fn who_is_walled_in_stays_in() {
        let ring = (0..40).map(|i| trunk(3.0 * direction(i as f32 * 0.157), 0.2));
        let land = land_with(ring);
        for turn in 0..60 {
            let end = walk(&[&land], Vec2::ZERO, 0.05 * direction(0.1 * turn as f32), 500);
            assert!((2.0..3.0).contains(&end.length()), "{end}");
            let back = advance(&[&land], end, -0.05 * end.normalize());
            assert!(back.length() < end.length(), "another wish is heard");
        }
    }

    #[test]
    fn nowhere_free_is_said_so() {
        let full = land_with([trunk(Vec2::ZERO, 500.0)]);
        assert_eq!(nearest_free(&[&full], Vec2::new(3.0, 4.0)), None);
        assert_eq!(nearest_free(&[&full], Vec2::NAN), None);
    }

    #[test]
    fn dead_on_it_goes_right() {
        let land = land_with([trunk(Vec2::ZERO, 0.4)]);
        let end = walk(&[&land], Vec2::new(0.0, 3.0), Vec2::new(0.0, -0.05), 60);
        assert!(end.x > 0.1, "facing north, right is east: {end}");
    }
}
