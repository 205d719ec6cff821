//! A wish to move → where a walker's feet can go among the trunks of all landscapes (thesis 6.2), on the (x, z) plane.
//!
//! The four views share one horizontal position. A trunk of one landscape therefore stops the walker in all of them:
//! were each view to collide with its own trees only, the four walkers would drift apart at the first tree. So a step
//! collides with the *union* of the trunks.
//!
//! What is guaranteed and why: a step is cut into pieces no longer than [`PIECE_M`], far below a body's diameter, so
//! nothing is jumped over at any speed; and a piece ends at a candidate place only after that very place, in the
//! numbers that the camera gets, was found clear of every trunk. Of several candidates (straight on, around the trunk,
//! along the trunks next to it, up to the trunk) the first clear one is taken, and if none is clear the walker stays. So
//! from a clear place every step ends in a clear place, whatever cluster the trunks form. How a walker gets out of a
//! pocket between trunks is told in [`super::detour`].

use glam::Vec2;

use super::detour::{Detour, Side};
use super::land::{BODY_RADIUS_M, Land, within};
use super::trunks::Trunk;

/// The longest piece of a step.
const PIECE_M: f32 = 0.1;
/// Air that is kept between body and trunk, so that rounding never makes them touch.
const SKIN_M: f32 = 1e-3;
/// Slowest slide around a trunk as a part of the speed. To run straight into a trunk is an unstable equilibrium of
/// sliding: this is what pushes off it. One that is hit dead on is passed on the right.
const LEAST_SLIDE: f32 = 0.3;
/// In one piece a walker goes along at most this many trunks.
const MOST_TRUNKS: u32 = 4;
/// A step is cut into at most this many pieces, 400 m in all; what is left of a longer one is not walked.
const MOST_PIECES: u32 = 4000;

/// True if a walker can stand here: clear of all trunks of all landscapes.
pub fn free(lands: &[&Land], place_m: Vec2) -> bool {
    lands.iter().all(|land| land.trunks.clear(place_m, BODY_RADIUS_M))
}

/// Where a walker at `from_m` gets that wants to move by `by_m`. `from_m` must be free; what comes back is. `detour`:
/// what the walker remembers from step to step.
pub fn advance(lands: &[&Land], from_m: Vec2, by_m: Vec2, detour: &mut Detour) -> Vec2 {
    let length_m = by_m.length();
    if !length_m.is_finite() || length_m == 0.0 {
        return from_m;
    }
    detour.wish(by_m / length_m);
    let pieces = (length_m / PIECE_M).ceil().clamp(1.0, MOST_PIECES as f32);
    let piece_m = by_m / length_m * (length_m / pieces).min(PIECE_M);
    (0..pieces as u32).fold(from_m, |place_m, _| {
        let next_m = piece(lands, place_m, piece_m, detour);
        detour.walked(place_m, next_m);
        next_m
    })
}

/// The free place nearest to `place_m`, which lies on the land: itself, or the first found on rings around it, each a
/// tenth wider than the last and at least 5 cm apart. `None` if the trunks leave no place anywhere.
pub fn nearest_free(lands: &[&Land], place_m: Vec2) -> Option<Vec2> {
    let start_m = within(lands, if place_m.is_finite() { place_m } else { Vec2::ZERO });
    if free(lands, start_m) {
        return Some(start_m);
    }
    // Across the whole square, from corner to corner.
    let farthest_m = (2.0 * 1.5 * super::land::reach_m(lands)).min(1e4);
    let mut ring_m = 0.05f32;
    while ring_m <= farthest_m {
        if let Some(found) = on_ring(lands, start_m, ring_m) {
            return Some(found);
        }
        ring_m += (0.1 * ring_m).max(0.05);
    }
    None
}

/// The first free place on a ring, eastwards first.
fn on_ring(lands: &[&Land], center_m: Vec2, ring_m: f32) -> Option<Vec2> {
    const PLACES: u32 = 64;
    (0..PLACES)
        .map(|i| {
            let (sin, cos) = libm::sincosf(i as f32 * (std::f32::consts::TAU / PLACES as f32));
            center_m + ring_m * Vec2::new(cos, sin)
        })
        .find(|&place_m| stands(lands, place_m))
}

/// One piece of a step.
fn piece(lands: &[&Land], from_m: Vec2, by_m: Vec2, detour: &mut Detour) -> Vec2 {
    // The land's edge is a wall that is slid along by dropping what leads across it.
    let straight_m = within(lands, from_m + by_m);
    let by_m = straight_m - from_m;
    if by_m == Vec2::ZERO {
        return from_m;
    }
    let beside = wall_beside(from_m, by_m, detour);
    let Some(hit) = beside.or_else(|| first_hit(lands, from_m, by_m, None)) else {
        return if stands(lands, straight_m) { straight_m } else { from_m };
    };
    if detour.given_up() {
        return from_m;
    }
    let side = detour.side().unwrap_or_else(|| hit.easier_side());
    let around_m = hit.around(side);
    if stands(lands, around_m) {
        detour.hold(hit.trunk);
        return around_m;
    }
    detour.begin(side, from_m, by_m.normalize_or_zero());
    let (place_m, wall) = along_wall(lands, from_m, hit, side);
    detour.hold(wall);
    place_m
}

/// The trunk that the hand is on, as long as the way around it leads back, away from the wish. There straight on leads
/// into the pocket again, and the trunk that stands first in that way may be one on its other side.
fn wall_beside(from_m: Vec2, by_m: Vec2, detour: &Detour) -> Option<Hit> {
    let (trunk, side) = (detour.wall()?, detour.side()?);
    let hit = Hit { trunk, touch_m: from_m, toward: by_m.normalize_or_zero(), left_m: by_m.length() };
    let touches = from_m.distance(trunk.center_m) < hit.reach_m() + PIECE_M;
    (touches && hit.tangent(side).dot(hit.toward) < 0.0).then_some(hit)
}

/// Around a trunk into the next one, around that one on the same side, and so on; up to the trunk if that is all. Gives
/// the place and the trunk beside it.
fn along_wall(lands: &[&Land], from_m: Vec2, first: Hit, side: Side) -> (Vec2, Trunk) {
    let up_to = (first.touching(), first.trunk);
    let mut hit = first;
    for _ in 0..MOST_TRUNKS {
        let (touch_m, by_m) = (hit.touching(), hit.tangent(side) * hit.slide_m());
        // Not the same trunk again, which a tangent touches or not as rounding has it.
        let Some(next) = first_hit(lands, touch_m, by_m, Some(hit.trunk)) else {
            if stands(lands, touch_m + by_m) {
                return (touch_m + by_m, hit.trunk);
            }
            break;
        };
        hit = next;
        let around_m = hit.around(side);
        if stands(lands, around_m) {
            return (around_m, hit.trunk);
        }
    }
    if stands(lands, up_to.0) { up_to } else { (from_m, up_to.1) }
}

/// True if a walker can be here: on the land and clear of all trunks.
fn stands(lands: &[&Land], place_m: Vec2) -> bool {
    within(lands, place_m) == place_m && free(lands, place_m)
}

/// A trunk in the way.
struct Hit {
    trunk: Trunk,
    /// Where the body touches it.
    touch_m: Vec2,
    /// Direction of the wish, unit length.
    toward: Vec2,
    /// What is left of the wish after touching.
    left_m: f32,
}

impl Hit {
    /// The side on which the trunk turns the walker aside; right if it turns it to neither.
    fn easier_side(&self) -> Side {
        if self.tangent(Side::Right).dot(self.toward) >= 0.0 { Side::Right } else { Side::Left }
    }

    /// Unit vector from the trunk's axis to the body.
    fn normal(&self) -> Vec2 {
        (self.touch_m - self.trunk.center_m).normalize_or(-self.toward)
    }

    /// Unit vector along the trunk.
    fn tangent(&self, side: Side) -> Vec2 {
        let normal = self.normal();
        // With x east and z south, this is what lies on the right of someone who faces the trunk.
        let right = Vec2::new(normal.y, -normal.x);
        match side {
            Side::Right => right,
            Side::Left => -right,
        }
    }

    /// How far the body slides with what is left of the wish.
    fn slide_m(&self) -> f32 {
        self.left_m * self.tangent(Side::Right).dot(self.toward).abs().max(LEAST_SLIDE)
    }

    /// Where the body touches the trunk but for the skin.
    fn touching(&self) -> Vec2 {
        self.trunk.center_m + self.reach_m() * self.normal()
    }

    /// Where the body gets around the trunk.
    fn around(&self, side: Side) -> Vec2 {
        let (sin, cos) = libm::sincosf(self.slide_m() / self.reach_m());
        self.trunk.center_m + self.reach_m() * (cos * self.normal() + sin * self.tangent(side))
    }

    fn reach_m(&self) -> f32 {
        self.trunk.radius_m + BODY_RADIUS_M + SKIN_M
    }
}

/// The first trunk, other than one, that a body meets on its way.
fn first_hit(lands: &[&Land], from_m: Vec2, by_m: Vec2, but: Option<Trunk>) -> Option<Hit> {
    let length_m = by_m.length();
    let toward = by_m.try_normalize()?;
    let mut first: Option<(f32, Trunk)> = None;
    for land in lands {
        for trunk in land.trunks.near(from_m, length_m + BODY_RADIUS_M + SKIN_M) {
            let Some(way_m) = way_to(trunk, from_m, toward) else { continue };
            if way_m < length_m && Some(*trunk) != but && first.is_none_or(|(least_m, _)| way_m < least_m) {
                first = Some((way_m, *trunk));
            }
        }
    }
    let (way_m, trunk) = first?;
    Some(Hit { trunk, touch_m: from_m + toward * way_m, toward, left_m: length_m - way_m })
}

/// Metres to go until the body touches a trunk; `None` if it passes or leaves it.
fn way_to(trunk: &Trunk, from_m: Vec2, toward: Vec2) -> Option<f32> {
    let reach_m = trunk.radius_m + BODY_RADIUS_M + SKIN_M;
    let to_center = trunk.center_m - from_m;
    let ahead_m = to_center.dot(toward);
    let aside_m = to_center.perp_dot(toward).abs();
    if ahead_m <= 0.0 || aside_m >= reach_m {
        return None;
    }
    Some((ahead_m - (reach_m * reach_m - aside_m * aside_m).sqrt()).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::walk::testing::{land_with, trunk};
    use proptest::prelude::*;

    /// Walks straight on in pieces as frames make them.
    fn walk(lands: &[&Land], from_m: Vec2, by_m: Vec2, steps: u32) -> Vec2 {
        let mut detour = Detour::default();
        (0..steps).fold(from_m, |place_m, _| advance(lands, place_m, by_m, &mut detour))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]
        #[test]
        fn a_trunk_hit_head_on_is_passed(
            x in -20f32..20., z in -20f32..20., radius_m in 0.02f32..2.5, angle in 0f32..7., off_m in -1e-4f32..1e-4,
            stride_m in 0.005f32..1.0
        ) {
            let center = Vec2::new(x, z);
            let (sin, cos) = libm::sincosf(angle);
            let toward = Vec2::new(cos, sin);
            let land = land_with([trunk(center, radius_m)]);
            let start = center - toward * (radius_m + 2.0) + toward.perp() * off_m;
            // Around half a circle at the slowest slide, and 4 m straight.
            let enough_m = 4.0 + 3.2 * (radius_m + 0.3) / LEAST_SLIDE;
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
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]
        #[test]
        fn a_pocket_is_left_around_its_shorter_or_its_longer_side(
            arms in (1u32..12, 1u32..12), slant in -0.5f32..1.2, angle in 0f32..7., stride_m in 0.02f32..0.3
        ) {
            // A funnel of trunks with no gap: arms to both sides of the way that lean towards the walker.
            let (sin, cos) = libm::sincosf(angle);
            let (toward, right) = (Vec2::new(cos, sin), Vec2::new(-sin, cos));
            let at = |i: i32| trunk(0.6 * (right * i as f32 - toward * slant * i.abs() as f32), 0.15);
            let land = land_with((-(arms.0 as i32)..=arms.1 as i32).map(at));
            let steps = (150.0 / stride_m) as u32;
            let end = walk(&[&land], -toward * 15.0, toward * stride_m, steps);
            prop_assert!(end.dot(toward) > 3.0, "stuck at {end}");
        }
    }

    #[test]
    fn who_is_walled_in_stands_still_at_last() {
        let ring = (0..40).map(|i| {
            let (sin, cos) = libm::sincosf(i as f32 * 0.157);
            trunk(3.0 * Vec2::new(cos, sin), 0.2)
        });
        let land = land_with(ring);
        let mut detour = Detour::default();
        let mut place = Vec2::ZERO;
        for _ in 0..10_000 {
            place = advance(&[&land], place, Vec2::new(0.05, 0.0), &mut detour);
            assert!(place.length() < 3.0);
        }
        let after = advance(&[&land], place, Vec2::new(0.05, 0.0), &mut detour);
        assert_eq!(after, place);
        assert!(
            advance(&[&land], place, Vec2::new(-0.05, 0.0), &mut detour) != place,
            "another wish is heard"
        );
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
