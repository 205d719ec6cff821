//! Trunks of a landscape → an index that answers in microseconds which of them a walker would touch. A trunk is a
//! vertical cylinder without ends (thesis 6.2), so all of it happens on the (x, z) plane, in metres.
//!
//! Trunks lie in a uniform grid by their centres, sorted by cell (a counting sort: two passes, no allocation per cell).
//! A query widens its reach by the thickest trunk's radius instead of each trunk being listed in every cell it touches:
//! so the index never holds more than one entry a trunk, whatever a file says.

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
    /// Sorted by cell.
    trunks: Vec<Trunk>,
    /// Cell c holds `trunks[starts[c]..starts[c + 1]]`; row by row from the north-west.
    starts: Vec<u32>,
    grid: Grid,
    thickest_m: f32,
}

impl Trunks {
    /// Index of the trunks of a landscape's trees.
    pub fn of(instances: &[Instance]) -> Self {
        Self::new(instances.iter().map(|instance| {
            let [x, z, radius_m] = instance.trunk_cylinder_m;
            Trunk { center_m: Vec2::new(x, z), radius_m }
        }))
    }

    /// Index of any trunks. Those that are not finite or have no radius are left out: nobody can touch them.
    pub fn new(trunks: impl IntoIterator<Item = Trunk>) -> Self {
        let touchable = |t: &Trunk| t.center_m.is_finite() && t.radius_m.is_finite() && t.radius_m > 0.0;
        let given: Vec<Trunk> = trunks.into_iter().filter(touchable).collect();
        let thickest_m = given.iter().fold(0.0f32, |most, trunk| most.max(trunk.radius_m));
        let grid = Grid::around(&given, thickest_m);
        let cells: Vec<u32> = given.iter().map(|trunk| grid.cell(trunk.center_m)).collect();
        let mut starts = vec![0u32; grid.len() + 1];
        for &cell in &cells {
            starts[cell as usize + 1] += 1;
        }
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        let mut next = starts.clone();
        let mut sorted = given.clone();
        for (trunk, &cell) in given.iter().zip(&cells) {
            let place = &mut next[cell as usize];
            sorted[*place as usize] = *trunk;
            *place += 1;
        }
        Self { trunks: sorted, starts, grid, thickest_m }
    }

    /// Number of trunks.
    pub fn len(&self) -> usize {
        self.trunks.len()
    }

    /// True if nothing stands here.
    pub fn is_empty(&self) -> bool {
        self.trunks.is_empty()
    }

    /// All trunks, in no order that means anything.
    pub fn iter(&self) -> impl Iterator<Item = &Trunk> {
        self.trunks.iter()
    }

    /// At least those trunks that come nearer than `reach_m` to `place_m`, with a few more from cells nearby.
    pub fn near(&self, place_m: Vec2, reach_m: f32) -> impl Iterator<Item = &Trunk> {
        let reach_m = reach_m + self.thickest_m;
        let (columns, rows) = if self.trunks.is_empty() || !place_m.is_finite() {
            (0..0, 0..0)
        } else {
            self.grid.window(place_m - reach_m, place_m + reach_m)
        };
        rows.flat_map(move |row| {
            // The cells of a row lie one after the other, and so do their trunks.
            let row = row * self.grid.columns;
            let first = self.starts[(row + columns.start) as usize] as usize;
            let last = self.starts[(row + columns.end) as usize] as usize;
            &self.trunks[first..last]
        })
    }

    /// True if a disc of `reach_m` around `place_m` touches no trunk.
    pub fn clear(&self, place_m: Vec2, reach_m: f32) -> bool {
        self.near(place_m, reach_m).all(|trunk| trunk.clears(place_m, reach_m))
    }
}

/// Cells of equal size over the box that holds all centres.
#[derive(Clone, Copy, Debug, Default)]
struct Grid {
    low_m: Vec2,
    cells_per_m: f32,
    columns: u32,
    rows: u32,
}

impl Grid {
    /// About one trunk a cell where they stand evenly, but no cell thinner than the thickest trunk.
    fn around(trunks: &[Trunk], thickest_m: f32) -> Self {
        let Some(first) = trunks.first() else { return Self::default() };
        let (low_m, high_m) = trunks.iter().fold((first.center_m, first.center_m), |(low, high), trunk| {
            (low.min(trunk.center_m), high.max(trunk.center_m))
        });
        // Halved first, so that even the widest of finite boxes has a finite size.
        let size_m = (high_m * 0.5 - low_m * 0.5) * 2.0;
        let size_m = size_m.min(Vec2::splat(f32::MAX)).max(Vec2::ZERO);
        let side = (trunks.len() as f32).sqrt().ceil().min(4096.0);
        let cell_m = (size_m.max_element() / side).max(2.0 * thickest_m).max(0.5);
        let lines = |size_m: f32| ((size_m / cell_m) as u32).min(side as u32) + 1;
        Self { low_m, cells_per_m: 1.0 / cell_m, columns: lines(size_m.x), rows: lines(size_m.y) }
    }

    fn len(&self) -> usize {
        self.columns as usize * self.rows as usize
    }

    /// Column and row of a place; of the nearest cell if it lies outside.
    fn column_row(&self, place_m: Vec2) -> (u32, u32) {
        let at = (place_m - self.low_m) * self.cells_per_m;
        // `as` saturates: below zero is 0.
        ((at.x as u32).min(self.columns - 1), (at.y as u32).min(self.rows - 1))
    }

    fn cell(&self, place_m: Vec2) -> u32 {
        let (column, row) = self.column_row(place_m);
        row * self.columns + column
    }

    /// Columns and rows that a box touches. A box outside gets the cells of the border: their trunks are then refused
    /// one by one.
    fn window(&self, low_m: Vec2, high_m: Vec2) -> (std::ops::Range<u32>, std::ops::Range<u32>) {
        let ((left, top), (right, bottom)) = (self.column_row(low_m), self.column_row(high_m));
        (left..right + 1, top..bottom + 1)
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
            prop_assert_eq!(index.len(), trunks.len());
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
        assert_eq!(index.len(), 3);
        assert!(!index.clear(Vec2::new(1.0, 2.6), 0.2));
        assert!(index.clear(Vec2::new(f32::NAN, 0.0), 0.2), "nowhere touches nothing");
        assert!(Trunks::default().clear(Vec2::ZERO, 1.0));
    }

    #[test]
    fn one_entry_a_trunk_and_few_looked_at() {
        let at = |i: u32| Vec2::new((i % 316) as f32 * 3.0, (i / 316) as f32 * 3.0);
        let index = Trunks::new((0..100_000).map(|i| Trunk { center_m: at(i), radius_m: 0.3 }));
        let looked_at = index.near(Vec2::new(400.0, 400.0), 0.3).count();
        assert!((1..=9).contains(&looked_at), "{looked_at}");
        assert!(index.grid.len() < 4 * index.len());
    }
}
