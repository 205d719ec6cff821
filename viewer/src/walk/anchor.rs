//! Where the walk lies in a landscape. Each is first seen from where it looks best, and from there on all four walkers go
//! the same way: so places, headings and heights of a walk are measured from that view.

use genescape_schema::scene::StartView;
use glam::{Vec2, Vec3, Vec3Swizzles};

/// What the walk's middle, level, north and horizon are in a landscape. By default, the same.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Anchor {
    /// The walk's middle, in the landscape's metres.
    middle_m: Vec3,
    /// From the landscape's north to the walk's, to the left.
    pub yaw_rad: f32,
    /// From the landscape's horizon up to what the walk takes for it.
    pub pitch_rad: f32,
}

impl Anchor {
    /// The walk's middle is what one stands on there, and its north is ahead.
    pub fn at(start: &StartView) -> Self {
        let [x, y, z] = start.direction.to_array();
        Self {
            middle_m: start.position_m - Vec3::Y * StartView::EYE_HEIGHT_M,
            yaw_rad: libm::atan2f(-x, -z),
            pitch_rad: libm::asinf(y.clamp(-1.0, 1.0)),
        }
    }

    /// Height of the walk's level above the landscape's zero, in metres.
    pub fn level_m(&self) -> f32 {
        self.middle_m.y
    }

    /// A place of the walk, x and z, in the landscape.
    pub fn in_land(&self, place_m: Vec2) -> Vec2 {
        let (sin, cos) = libm::sincosf(self.yaw_rad);
        let [x, z] = place_m.to_array();
        self.middle_m.xz() + Vec2::new(x * cos + z * sin, z * cos - x * sin)
    }

    /// A place of the landscape, x and z, in the walk.
    pub fn in_walk(&self, place_m: Vec2) -> Vec2 {
        let (sin, cos) = libm::sincosf(self.yaw_rad);
        let [x, z] = (place_m - self.middle_m.xz()).to_array();
        Vec2::new(x * cos - z * sin, z * cos + x * sin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn there_and_back_is_the_same_place_and_ahead_stays_ahead(
            x in -600f32..600., y in -50f32..500., z in -600f32..600., turn in -3.1f32..3.1, rise in -0.4f32..0.4,
            place in (-900f32..900., -900f32..900.)
        ) {
            let direction = Vec3::new(libm::sinf(turn), rise, libm::cosf(turn)).normalize();
            let start = StartView { position_m: Vec3::new(x, y, z), direction };
            let (anchor, place) = (Anchor::at(&start), Vec2::from(place));
            prop_assert!(anchor.in_walk(anchor.in_land(place)).distance(place) < 1e-3);
            prop_assert_eq!(anchor.in_land(Vec2::ZERO), start.position_m.xz());
            let ahead = anchor.in_land(Vec2::NEG_Y) - anchor.in_land(Vec2::ZERO);
            prop_assert!(ahead.distance(direction.xz().normalize()) < 1e-3);
        }
    }

    #[test]
    fn by_default_nothing_is_elsewhere() {
        let place = Vec2::new(0.1, -700.3);
        assert_eq!([Anchor::default().in_land(place), Anchor::default().in_walk(place)], [place; 2]);
    }
}
