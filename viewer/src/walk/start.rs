//! Where a walk begins: at the view that suits the worst of the landscapes best, for one cannot vote on a landscape that
//! is not to be seen. How good each looks from where the bake has found out, and `Lookouts::shared` chooses.

use genescape_schema::scene::StartView;
use glam::{Vec2, Vec3};

use super::{EYE_HEIGHT_M, Land, Mode, Pose, Subject, nearest_free};
use crate::scene::{Lookout, Lookouts};

/// A view that is worth at least this part of the best one is good enough to stay at.
const GOOD_ENOUGH: f32 = 0.6;

/// Where to begin: the view for all of these landscapes, moved no farther than trunks make necessary. Where no file says
/// how good views are, it is the first landscape's start.
pub fn start_pose(lands: &[&Land]) -> Pose {
    let alone = lands.iter().find_map(|land| Some((land.subject.as_ref()?, &land.start)));
    if let Some((subject, start)) = alone {
        return before(subject, start);
    }
    let Some((wanted_m, direction)) = start(lands) else {
        return Pose { altitude_m: EYE_HEIGHT_M, ..Pose::default() };
    };
    let place_m = nearest_free(lands, wanted_m).unwrap_or(wanted_m);
    let top_m = lands.iter().map(|land| land.footing_m(place_m)).fold(f32::NEG_INFINITY, f32::max);
    let altitude_m = top_m + EYE_HEIGHT_M;
    Pose { x_m: place_m.x, z_m: place_m.y, altitude_m, ..looking(direction) }
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

/// Whether no start would show the worst of these landscapes much better.
pub fn suits_all(lands: &[&Land], pose: &Pose) -> bool {
    let (known, Some(extent_m)) = lookouts(lands) else { return true };
    let here = Lookout::nearest(pose.place_m(), pose.ahead(), extent_m);
    let best = Lookouts::shared(&known).map_or(0.0, |view| f32::from(view.worst));
    Lookouts::worst(&known, here).is_none_or(|worst| f32::from(worst) >= GOOD_ENOUGH * best)
}

/// Place and direction.
fn start(lands: &[&Land]) -> Option<(Vec2, Vec3)> {
    let (known, extent_m) = lookouts(lands);
    let shared = extent_m.zip(Lookouts::shared(&known));
    let shared = shared.map(|(extent_m, view)| (view.lookout.place_m(extent_m), view.direction()));
    shared.or_else(|| {
        let start = lands.first()?.start;
        Some((Vec2::new(start.position_m.x, start.position_m.z), start.direction))
    })
}

/// What is known of these landscapes' views, and the extent that those have in common.
fn lookouts<'a>(lands: &[&'a Land]) -> (Vec<&'a Lookouts>, Option<f32>) {
    let known = |land: &&&Land| land.lookouts.is_some();
    let extent_m = lands.iter().find(known).map(|land| land.field.extent_m());
    let alike = lands.iter().filter(|land| Some(land.field.extent_m()) == extent_m);
    (alike.filter_map(|land| land.lookouts.as_deref()).collect(), extent_m)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use genescape_schema::scene::{Prospect, StartView};
    use proptest::prelude::*;

    use super::*;
    use crate::walk::BODY_RADIUS_M;
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

    /// That land, as good as `score` says from each lookout.
    fn scored(land: Land, score: impl Fn(Lookout) -> u8) -> Land {
        let prospects = Lookout::all().map(|at| Prospect { score: score(at), pitch_deg: 0 }).collect();
        Land { lookouts: Lookouts::new(prospects).map(Arc::new), ..land }
    }

    #[test]
    fn four_begin_where_the_worst_of_them_looks_best_and_one_as_its_file_says() {
        let [fine, fair] = [1000, 2000].map(|k| Lookout::all().nth(k).expect("a lookout"));
        let one = scored(hilly(3, []), |at| {
            if at == fine {
                250
            } else if at == fair {
                120
            } else {
                9
            }
        });
        let other = scored(hilly(4, []), |at| if at == fair { 100 } else { 10 });
        let extent_m = one.field.extent_m();
        let both = start_pose(&[&one, &other]);
        assert!(
            both.place_m().distance(fair.place_m(extent_m)) < 1e-3 && both.ahead().dot(fair.ahead()) > 0.999
        );
        assert!(start_pose(&[&one]).place_m().distance(fine.place_m(extent_m)) < 1e-3);
        assert!(suits_all(&[&one, &other], &both) && !suits_all(&[&one, &other], &start_pose(&[&one])));
        // What an older bake made says nothing, and is asked nothing.
        let silent = with_start(hilly(5, []), Vec2::ZERO, Vec3::X);
        assert_eq!(start_pose(&[&silent, &one, &other]).place_m(), both.place_m());
        assert_eq!(start_pose(&[&silent]).place_m(), Vec2::ZERO);
        assert!(suits_all(&[&silent], &both));
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
