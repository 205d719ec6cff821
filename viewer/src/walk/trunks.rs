//! Trunks of a landscape → an index that answers in microseconds which of them a walker would touch. A trunk is a
//! vertical cylinder without ends (thesis 6.2), so all of it happens on the (x, z) plane, in metres.
//!
//! Trunks are sorted from west to east. A query looks at a strip as wide as its reach and the thickest trunk: of n trunks
//! that stand evenly some √n.

use glam::{DVec2, Vec2};

use crate::scene::Instance;

/// A vertical cylinder without ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trunk {
    /// Its axis: (x, z).
    pub center_m: Vec2,
    /// Its radius.
    pub radius_m: f32,
}

impl Trunk {
    /// True if a disc that touches nothing farther than `reach_m` from `place_m` stays outside. Computed in f64, so
    /// that the answer is that for the very numbers that a camera gets.
    #[inline]
    pub fn clears(&self, place_m: Vec2, reach_m: f32) -> bool {
        let apart = DVec2::new(
            f64::from(place_m.x) - f64::from(self.center_m.x),
            f64::from(place_m.y) - f64::from(self.center_m.y),
        );
        let reach = f64::from(self.radius_m) + f64::from(reach_m);
        apart.length_squared() >= reach * reach
    }
}

/// All trunks of a landscape.
#[derive(Clone, Debug, Default)]
pub struct Trunks {
    /// From west to east.
    pub(super) trunks: Vec<Trunk>,
    max_radius_m: f32,
}

impl Trunks {
    /// Index of the trunks of a landscape's trees.
    pub fn of(instances: &[Instance]) -> Self {
        Self::new(instances.iter().map(|instance| {
            let [x, z, radius_m] = instance.trunk_cylinder_m;
            Trunk { center_m: Vec2::new(x, z), radius_m }
        }))
    }

    /// Index of any trunks. Those that are not finite or have no radius are left out: nothing can touch them.
    pub fn new(trunks: impl IntoIterator<Item = Trunk>) -> Self {
        let touchable = |t: &Trunk| t.center_m.is_finite() && t.radius_m.is_finite() && t.radius_m > 0.0;
        let mut trunks: Vec<Trunk> = trunks.into_iter().filter(touchable).collect();
        trunks.sort_by(|a, b| a.center_m.x.total_cmp(&b.center_m.x));
        let max_radius_m = trunks.iter().fold(0.0, |max: f32, trunk| max.max(trunk.radius_m));
        Self { trunks, max_radius_m }
    }

    /// At least those trunks that come nearer than `reach_m` to `place_m`, with others as far east as these.
    pub fn near(&self, place_m: Vec2, reach_m: f32) -> impl Iterator<Item = &Trunk> {
        let reach_m = reach_m + self.max_radius_m;
        let first = self.trunks.partition_point(|trunk| trunk.center_m.x < place_m.x - reach_m);
        self.trunks[first..].iter().take_while(move |trunk| trunk.center_m.x <= place_m.x + reach_m)
    }

    /// True if a disc of `reach_m` around `place_m` touches no trunk.
    pub fn clear(&self, place_m: Vec2, reach_m: f32) -> bool {
        self.near(place_m, reach_m).all(|trunk| trunk.clears(place_m, reach_m))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn trunk(extent_m: f32) -> impl Strategy<Value = Trunk> {
        (-extent_m..extent_m, -extent_m..extent_m, 0.01f32..3.0)
            .prop_map(|(x, z, radius_m)| Trunk { center_m: Vec2::new(x, z), radius_m })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]
        #[test]
        fn the_index_finds_what_a_look_at_every_trunk_finds(
            trunks in prop::collection::vec(trunk(40.0), 0..120),
            x in -60f32..60., z in -60f32..60., reach_m in 0f32..5.
        ) {
            let place = Vec2::new(x, z);
            let all = trunks.iter().all(|trunk| trunk.clears(place, reach_m));
            let index = Trunks::new(trunks.iter().copied());
            prop_assert_eq!(index.clear(place, reach_m), all);
            prop_assert_eq!(index.trunks.len(), trunks.len());
        }
    }

    #[test]
    fn what_no_file_should_hold_does_no_harm() {
        let trunk = |x, z, radius_m| Trunk { center_m: Vec2::new(x, z), radius_m };
        let bad = [
            trunk(f32::NAN, 0.0, 1.0),
            trunk(0.0, f32::INFINITY, 1.0),
            trunk(0.0, 0.0, f32::NAN),
            trunk(0.0, 0.0, -1.0),
            trunk(f32::MAX, -f32::MAX, 0.1),
            trunk(-f32::MAX, f32::MAX, 0.1),
            trunk(1.0, 2.0, 0.5),
        ];
        let index = Trunks::new(bad);
        assert_eq!(index.trunks.len(), 3);
        assert!(!index.clear(Vec2::new(1.0, 2.6), 0.2));
        assert!(index.clear(Vec2::new(f32::NAN, 0.0), 0.2), "nowhere touches nothing");
        assert!(Trunks::default().clear(Vec2::ZERO, 1.0));
    }

    #[test]
    fn few_are_looked_at() {
        let at = |i: u32| Vec2::new((i % 316) as f32 * 3.0, (i / 316) as f32 * 3.0);
        let index = Trunks::new((0..100_000).map(|i| Trunk { center_m: at(i), radius_m: 0.3 }));
        let looked_at = index.near(Vec2::new(399.0, 400.0), 0.3).count();
        assert!((1..=317).contains(&looked_at), "{looked_at}");
    }
}
