use core::f32::consts::TAU;

use glam::Vec2;

/// Cells a side of the square in which one place each is chosen.
const CELLS: usize = 16;
/// Part of the field's extent that this square has: whoever starts there has land on all sides.
const INNER: f32 = 0.8;
/// Part of a cell's side within which its place lies, around the cell's middle.
const SCATTER: f32 = 0.7;
const PLACES: usize = CELLS * CELLS;

/// A place and a heading from which a landscape may first be seen: one of a fixed list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lookout(usize);

impl Lookout {
    /// How many share a place, evenly spaced: they follow one another in the list.
    pub const HEADINGS: usize = 24;
    /// Metres around each in which nothing stands that would hide the landscape.
    pub const CLEARING_M: f32 = 6.0;

    /// All of them, in order.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..PLACES * Self::HEADINGS).map(Self)
    }

    /// The places of all, as x and z in metres on land of that extent: one in each cell of a square grid, moved off its
    /// middle by a low-discrepancy sequence (R2, Roberts 2018), so that they stand in no lines.
    pub fn places_m(extent_m: f32) -> impl Iterator<Item = Vec2> {
        (0..PLACES).map(move |place| place_m(place, extent_m))
    }

    /// Where to stand, as x and z in metres on land of that extent.
    pub fn place_m(self, extent_m: f32) -> Vec2 {
        place_m(self.0 / Self::HEADINGS, extent_m)
    }

    /// Number of the heading, clockwise from north (−z).
    pub fn heading(self) -> usize {
        self.0 % Self::HEADINGS
    }

    /// Unit vector of the heading in the (x, z) plane.
    pub fn ahead(self) -> Vec2 {
        let (sin, cos) = libm::sincosf(self.heading() as f32 * (TAU / Self::HEADINGS as f32));
        Vec2::new(sin, -cos)
    }
}

fn place_m(place: usize, extent_m: f32) -> Vec2 {
    const R2: Vec2 = Vec2::new(0.754_877_7, 0.569_840_3);
    let cell = Vec2::new((place % CELLS) as f32, (place / CELLS) as f32);
    let scatter = (R2 * (place + 1) as f32).fract() - 0.5;
    ((cell + 0.5 + SCATTER * scatter) / CELLS as f32 - 0.5) * (INNER * extent_m)
}
