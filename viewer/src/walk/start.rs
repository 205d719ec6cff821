//! Where a walk begins: each landscape where it looks best, which the bake has found out, for one cannot vote on a landscape
//! that is not to be seen.

use genescape_schema::scene::StartView;
use glam::{Vec2, Vec3};

use super::{Anchor, EYE_HEIGHT_M, Land, Mode, Pose, Subject, nearest_free};

/// Where to begin: in the walk's middle, moved no farther than trunks make necessary.
pub fn start_pose(lands: &[&Land]) -> Pose {
    let alone = lands.iter().find_map(|land| Some((land.subject.as_ref()?, &land.start)));
    if let Some((subject, start)) = alone {
        return before(subject, start);
    }
    let place_m = nearest_free(lands, Vec2::ZERO).unwrap_or_default();
    let top_m = lands.iter().map(|land| land.footing_m(place_m)).reduce(f32::max).unwrap_or_default();
    Pose { x_m: place_m.x, z_m: place_m.y, altitude_m: top_m + EYE_HEIGHT_M, ..Pose::default() }
}

/// Where the walk lies in a landscape that has come. One that was baked anew is seen from where it was `before`, so that one
/// sees what an edit did; one on the same ground as one of the `others`, from where that is seen.
pub fn anchor_for(land: &Land, before: Option<Anchor>, others: &[&Land]) -> Anchor {
    let beside = || others.iter().find(|other| other.is_same_ground(land)).map(|other| other.anchor);
    before.or_else(beside).unwrap_or_else(|| land.start_anchor())
}

/// Before anyone's file: it turns if it is what the start looks at from outside, and is flown through if not.
fn before(subject: &Subject, start: &StartView) -> Pose {
    let to_middle_m = Vec3::Y * subject.middle_m - start.position_m;
    let distance_m = to_middle_m.length();
    let turns = distance_m > subject.radius_m && to_middle_m.dot(start.direction) > 0.9 * distance_m;
    Pose {
        x_m: start.position_m.x,
        z_m: start.position_m.z,
        altitude_m: start.position_m.y,
        distance_m,
        mode: if turns { Mode::Orbit } else { Mode::Fly },
        ..looking(start.direction)
    }
}

fn looking(direction: Vec3) -> Pose {
    let [x, y, z] = direction.to_array();
    Pose { yaw_rad: libm::atan2f(-x, -z), pitch_rad: libm::asinf(y.clamp(-1.0, 1.0)), ..Pose::default() }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::walk::testing::{hilly, trunk};
    use crate::walk::{BODY_RADIUS_M, Rig};

    fn with_start(mut land: Land, place_m: Vec2, direction: Vec3) -> Land {
        let position_m = Vec3::new(place_m.x, land.ground_m(place_m) + EYE_HEIGHT_M, place_m.y);
        land.start = StartView { position_m, direction: direction.normalize() };
        land.from_its_start()
    }

    proptest! {
        #[test]
        fn each_is_first_seen_as_its_file_says(
            seed in 0u64..1000, x in -50f32..50., z in -50f32..50., turn in 0f32..6.3, rise in -0.3f32..0.3,
        ) {
            let direction = Vec3::new(libm::sinf(turn), rise, libm::cosf(turn)).normalize();
            let one = with_start(hilly(seed, []), Vec2::new(x, z), direction);
            let other = with_start(hilly(seed + 1, []), Vec2::new(z, -x), Vec3::X);
            let lands = [&one, &other];
            let rig = Rig::new(start_pose(&lands), &lands);
            for land in lands {
                let camera = rig.camera(land, 1.0);
                prop_assert!(camera.position_m.distance(land.start.position_m) < 1e-3, "{camera:?}");
                prop_assert!(camera.forward().distance(land.start.direction) < 1e-4, "{camera:?}");
            }
        }
    }

    #[test]
    fn an_edit_and_the_same_ground_are_seen_from_the_same_place_and_other_ground_is_not() {
        let [one, same, other] = [(3, 5.0), (3, 20.0), (4, 20.0)]
            .map(|(seed, x)| with_start(hilly(seed, []), Vec2::new(x, 0.0), Vec3::X));
        assert_eq!(anchor_for(&one, None, &[&other]), one.start_anchor());
        assert_eq!(anchor_for(&same, None, &[&other, &one]), one.anchor);
        assert_eq!(anchor_for(&other, None, &[&one, &same]), other.start_anchor());
        assert_eq!(anchor_for(&other, Some(one.anchor), &[&same]), one.anchor, "after an edit");
        assert_ne!(one.anchor, same.anchor);
    }

    #[test]
    fn no_trunk_stands_at_the_start_and_none_makes_it_fail() {
        let wooded = with_start(hilly(3, [trunk(Vec2::ZERO, 0.3)]), Vec2::ZERO, Vec3::X);
        assert!(wooded.trunks.clear(wooded.anchor.in_land(start_pose(&[&wooded]).place_m()), BODY_RADIUS_M));
        let full = with_start(hilly(3, [trunk(Vec2::ZERO, 500.0)]), Vec2::ZERO, Vec3::X);
        assert_eq!(start_pose(&[&full]).place_m(), Vec2::ZERO);
        assert_eq!(start_pose(&[]).place_m(), Vec2::ZERO);
    }
}
