//! A panorama and a heading → the part of it that a picture shows, looking so far up or down that the skyline lies a
//! little above the middle.

use genescape_schema::scene::Lookout;

use super::panorama::{COLUMNS, Panorama, ROWS, Seen, slope_of};

/// Columns of the panorama in half a picture: ±41°, the viewer's 60° upright at 16:10.
pub(super) const HALF_COLUMNS: usize = 11;
/// Slope from the middle of a picture to its upper edge: tan 30°.
pub(super) const HALF_HEIGHT: f32 = 0.577;
/// Where the skyline should be, from the picture's upper edge, as a part of its height.
const SKYLINE_AT: f32 = 0.45;
/// The look goes no steeper up or down.
const MAX_PITCH: f32 = 0.17;

/// A heading's part of the panorama.
pub(super) struct Picture<'a> {
    columns: Vec<&'a [Seen; ROWS]>,
    /// Mean slope of the skyline.
    pub skyline: f32,
    /// Slope of the look.
    pub pitch: f32,
}

impl<'a> Picture<'a> {
    pub fn new(panorama: &'a Panorama, lookout: Lookout) -> Self {
        let middle = lookout.heading() * COLUMNS / Lookout::HEADINGS;
        let columns = panorama.columns(middle, HALF_COLUMNS);
        let skyline = columns.clone().map(|(_, slope)| slope).sum::<f32>() / (2 * HALF_COLUMNS + 1) as f32;
        let pitch = (skyline - 2.0 * HALF_HEIGHT * (0.5 - SKYLINE_AT)).clamp(-MAX_PITCH, MAX_PITCH);
        Self { columns: columns.map(|(seen, _)| seen).collect(), skyline, pitch }
    }

    /// From left to right.
    pub fn columns(&self) -> &[&'a [Seen; ROWS]] {
        &self.columns
    }

    /// All of it: slope and what is seen.
    pub fn rays(&self) -> impl Iterator<Item = (f32, &Seen)> {
        self.rays_between([self.pitch - HALF_HEIGHT, self.pitch + HALF_HEIGHT])
    }

    fn rays_between(&self, [low, high]: [f32; 2]) -> impl Iterator<Item = (f32, &Seen)> {
        let rows = (0..ROWS).map(|row| (row, slope_of(row)));
        let rows = rows.filter(move |(_, slope)| (low..=high).contains(slope));
        rows.flat_map(|(row, slope)| self.columns.iter().map(move |column| (slope, &column[row])))
    }

    /// Part of the rays with slopes between two bounds that meet what `wanted` says.
    pub fn part(&self, slopes: [f32; 2], wanted: impl Fn(f32, &Seen) -> bool) -> f32 {
        part(self.rays_between(slopes), wanted)
    }

    /// Part of the picture.
    pub fn share(&self, wanted: impl Fn(&Seen) -> bool) -> f32 {
        part(self.rays(), |_, seen| wanted(seen))
    }
}

fn part<'a>(rays: impl Iterator<Item = (f32, &'a Seen)>, wanted: impl Fn(f32, &Seen) -> bool) -> f32 {
    let (mut all, mut met) = (0_u32, 0_u32);
    for (slope, seen) in rays {
        (all, met) = (all + 1, met + u32::from(wanted(slope, seen)));
    }
    met as f32 / all.max(1) as f32
}
