//! `GSC_lookouts`, on the node of the start camera: how good a landscape looks from each of a fixed list of places and
//! headings, the same list for all landscapes. So the view that suits several of them best is found from their files
//! alone, by one rule for whoever asks, and no landscape has to be made anew because another one changed.

use glam::{Vec2, Vec3};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::{Heightfield, Resource, StartView};

/// The extension's name.
pub const GSC_LOOKOUTS: &str = "GSC_lookouts";

/// Cells a side of the square in which one place each is chosen.
const CELLS: usize = 16;
/// Part of the field's extent that this square has: whoever starts there has land on all sides.
const INNER: f32 = 0.8;
/// Part of a cell's side within which its place lies, around the cell's middle.
const SCATTER: f32 = 0.7;
/// Headings at each place, evenly spaced.
const HEADINGS: usize = 24;
const PLACES: usize = CELLS * CELLS;

/// Scores of the landscape that a shared view suits worst that are as good as each other, while the rest see the more.
const NEARLY: u8 = 12;

const MAGIC: &[u8; 4] = b"GSCL";
const VERSION: u32 = 1;
const HEADER_BYTES: usize = 16;

/// A place and a heading to look from: one of the fixed list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Lookout(usize);

impl Lookout {
    /// How many there are.
    pub const COUNT: usize = PLACES * HEADINGS;
    /// How many share a place: they follow one another in the list.
    pub const HEADINGS: usize = HEADINGS;
    /// Metres around each in which nothing stands that would hide the landscape.
    pub const CLEARING_M: f32 = 6.0;

    /// All of them, in order.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..Self::COUNT).map(Self)
    }

    /// The places of all, as x and z in metres on land of that extent: one in each cell of a square grid, moved off its
    /// middle by a low-discrepancy sequence (R2, Roberts 2018), so that they stand in no lines.
    pub fn places_m(extent_m: f32) -> impl Iterator<Item = Vec2> {
        (0..PLACES).map(move |place| place_m(place, extent_m))
    }

    /// Where to stand, as x and z in metres on land of that extent.
    pub fn place_m(self, extent_m: f32) -> Vec2 {
        place_m(self.0 / HEADINGS, extent_m)
    }

    /// Number of the heading, clockwise from north (−z).
    pub fn heading(self) -> usize {
        self.0 % HEADINGS
    }

    /// Unit vector of the heading in the (x, z) plane.
    pub fn ahead(self) -> Vec2 {
        let (sin, cos) = libm::sincosf(self.heading() as f32 * (core::f32::consts::TAU / HEADINGS as f32));
        Vec2::new(sin, -cos)
    }

    /// The lookout nearest to a view, for a place first and then for its heading.
    pub fn nearest(place_m: Vec2, ahead: Vec2, extent_m: f32) -> Self {
        let distance = |place: &Vec2| place.distance_squared(place_m);
        let places = Self::places_m(extent_m).enumerate();
        let nearest = places.min_by(|(_, a), (_, b)| distance(a).total_cmp(&distance(b)));
        let first = nearest.map_or(0, |(place, _)| place) * HEADINGS;
        let along = |lookout: &Self| lookout.ahead().dot(ahead);
        let headings = (first..first + HEADINGS).map(Self);
        headings.max_by(|a, b| along(a).total_cmp(&along(b))).unwrap_or(Self(first))
    }
}

fn place_m(place: usize, extent_m: f32) -> Vec2 {
    const R2: Vec2 = Vec2::new(0.754_877_7, 0.569_840_3);
    let cell = Vec2::new((place % CELLS) as f32, (place / CELLS) as f32);
    let scatter = (R2 * (place + 1) as f32).fract() - 0.5;
    ((cell + 0.5 + SCATTER * scatter) / CELLS as f32 - 0.5) * (INNER * extent_m)
}

/// What a landscape looks like from one lookout.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Prospect {
    /// 0 is nothing to see or nowhere to stand, 255 could not be better.
    pub score: u8,
    /// How many degrees the look goes up, or down, from level.
    pub pitch_deg: i8,
}

/// The prospects from all lookouts of a landscape.
#[derive(Clone, Debug, PartialEq)]
pub struct Lookouts(Vec<Prospect>);

/// The view that suits several landscapes best.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SharedView {
    pub lookout: Lookout,
    /// Slope of the look: the mean of what suits each.
    pub pitch_rad: f32,
    /// Score of the landscape that it suits worst.
    pub worst: u8,
}

impl Lookouts {
    /// Those of a prospect for each lookout; `None` unless there are as many.
    pub fn new(prospects: Vec<Prospect>) -> Option<Self> {
        (prospects.len() == Lookout::COUNT).then_some(Self(prospects))
    }

    /// The landscape as seen from there.
    pub fn prospect(&self, lookout: Lookout) -> Prospect {
        self.0[lookout.0]
    }

    /// The view that suits all of these landscapes together best, of those that suit the worst of them nearly as well as any;
    /// of equal ones the first. `None` of no landscapes.
    pub fn shared(lands: &[&Self]) -> Option<SharedView> {
        let best = Lookout::all().filter_map(|lookout| Self::worst(lands, lookout)).max()?;
        let bearable = |lookout: &Lookout| Self::worst(lands, *lookout) >= Some(best.saturating_sub(NEARLY));
        let sum = |lookout: &Lookout| {
            lands.iter().map(|land| u32::from(land.prospect(*lookout).score)).sum::<u32>()
        };
        // Of equal ones `max_by_key` takes the last.
        let lookout =
            Lookout::all().filter(bearable).collect::<Vec<_>>().into_iter().rev().max_by_key(sum)?;
        let worst = Self::worst(lands, lookout)?;
        let sum: i32 = lands.iter().map(|land| i32::from(land.prospect(lookout).pitch_deg)).sum();
        Some(SharedView { lookout, pitch_rad: (sum as f32 / lands.len() as f32).to_radians(), worst })
    }

    /// The lowest score that any of these landscapes has from there; `None` of no landscapes.
    pub fn worst(lands: &[&Self], lookout: Lookout) -> Option<u8> {
        lands.iter().map(|land| land.prospect(lookout).score).min()
    }

    /// As `schema/docs/GSC_lookouts.md` says.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::with_capacity(HEADER_BYTES + 2 * self.0.len());
        out.extend_from_slice(MAGIC);
        for word in [VERSION, PLACES as u32, HEADINGS as u32] {
            out.extend_from_slice(&word.to_le_bytes());
        }
        out.extend(self.0.iter().flat_map(|prospect| [prospect.score, prospect.pitch_deg as u8]));
        out
    }

    /// The inverse of [`Self::to_bytes`].
    ///
    /// # Errors
    /// The bytes are none of this format, version, and number of lookouts.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, LookoutsError> {
        let words = [VERSION, PLACES as u32, HEADINGS as u32].map(u32::to_le_bytes);
        let header = [MAGIC.as_slice(), words.as_flattened()].concat();
        let error = || LookoutsError { found: bytes.len(), expected: HEADER_BYTES + 2 * Lookout::COUNT };
        let prospects = bytes.strip_prefix(header.as_slice()).ok_or_else(error)?;
        let (prospects, []) = prospects.as_chunks::<2>() else { return Err(error()) };
        let prospect = |&[score, pitch]: &[u8; 2]| Prospect { score, pitch_deg: pitch as i8 };
        Self::new(prospects.iter().map(prospect).collect()).ok_or_else(error)
    }
}

/// Why lookouts could not be read.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error(
    "not GSC_lookouts version {VERSION} data of {PLACES} places with {HEADINGS} headings each: \
     {found} bytes, which should be {expected}"
)]
pub struct LookoutsError {
    found: usize,
    expected: usize,
}

/// The extension's object on a node.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LookoutsExtension {
    /// [`Lookouts`] as bytes.
    pub prospects: Resource,
}

impl SharedView {
    /// The view on a land: its eye stands on the ground there, or on the water.
    pub fn on(&self, land: &Heightfield, water_level_m: Option<f32>) -> StartView {
        let place = self.lookout.place_m(land.extent_m());
        let surface_m = land.height_m(place.x, place.y).max(water_level_m.unwrap_or(f32::MIN));
        let eye_m = Vec3::new(place.x, surface_m + StartView::EYE_HEIGHT_M, place.y);
        StartView { position_m: eye_m, direction: self.direction() }
    }

    /// Unit vector of the look.
    pub fn direction(&self) -> Vec3 {
        let (level, (sin, cos)) = (self.lookout.ahead(), libm::sincosf(self.pitch_rad));
        Vec3::new(level.x * cos, sin, level.y * cos)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lookouts(score: impl Fn(usize) -> u8) -> Lookouts {
        let prospect = |lookout: Lookout| Prospect { score: score(lookout.0), pitch_deg: -3 };
        Lookouts::new(Lookout::all().map(prospect).collect()).unwrap()
    }

    #[test]
    fn the_shared_view_suits_the_worst_nearly_best_and_then_all() {
        let with = |scores: &[(usize, u8)], rest: u8| {
            lookouts(|k| scores.iter().find(|(lookout, _)| *lookout == k).map_or(rest, |(_, score)| *score))
        };
        // What each likes best the other cannot stand; 70 suits the worst best, 90 nearly so and the other far better; 95 suits
        // both together best, but one of them too badly.
        let one = with(&[(5, 255), (70, 100), (90, 200), (95, 255)], 1);
        let other = with(&[(8, 255), (70, 100), (90, 100 - NEARLY), (95, 99 - NEARLY)], 2);
        assert_eq!(Lookouts::shared(&[&one]).unwrap().lookout, Lookout(5));
        let shared = Lookouts::shared(&[&one, &other]).unwrap();
        assert_eq!((shared.lookout, shared.worst), (Lookout(90), 100 - NEARLY));
        assert_eq!(
            Lookouts::shared(&[&lookouts(|_| 7)]).unwrap().lookout,
            Lookout(0),
            "the first of equal ones"
        );
        assert_eq!(Lookouts::shared(&[]), None);
    }

    #[test]
    fn a_view_is_its_own_nearest_lookout() {
        for lookout in Lookout::all().step_by(17) {
            let (place, ahead) = (lookout.place_m(1024.0), lookout.ahead());
            assert_eq!(Lookout::nearest(place + 3.0, ahead, 1024.0), lookout);
            assert!(place.abs().max_element() < 410.0);
        }
    }

    #[test]
    fn bytes_come_back_and_others_are_refused() {
        let land = lookouts(|k| (k % 251) as u8);
        let bytes = land.to_bytes();
        assert_eq!(Lookouts::from_bytes(&bytes).unwrap(), land);
        assert!(Lookouts::from_bytes(&bytes[..bytes.len() - 2]).is_err());
        assert!(Lookouts::from_bytes(&[bytes.as_slice(), &[0]].concat()).is_err());
        let mut later = bytes;
        later[4] = 2;
        assert!(Lookouts::from_bytes(&later).is_err() && Lookouts::from_bytes(&[]).is_err());
    }
}
