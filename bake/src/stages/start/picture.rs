//! A panorama and a heading → the part of it that a picture shows, looking so far up or down that the skyline lies a
//! little above the middle.

use std::ops::Range;

use super::panorama::{COLUMNS, Column, Kind, Panorama, ROW_STEP, ROWS, Seen, slope_of};
use crate::math::ramp;
use crate::model::Lookout;

/// Columns of the panorama in half a picture: ±41°, of [`START_FOV_Y_DEG`](genescape_schema::scene::START_FOV_Y_DEG) upright.
pub(super) const HALF_COLUMNS: usize = 11;
/// Slope from the middle of a picture to its upper edge: tan 30°.
pub(super) const HALF_HEIGHT: f32 = 0.577;
/// Where the skyline should be, from the picture's upper edge, as a part of its height.
const SKYLINE_AT: f32 = 0.45;
/// The look goes no steeper up or down.
const MAX_PITCH: f32 = 0.17;

/// Depths in metres between which rays are counted.
const BANDS_M: [f32; 7] = [6.0, 10.0, 30.0, 60.0, 90.0, 270.0, 1e4];

/// A heading's part of the panorama.
pub(super) struct Picture<'a> {
    /// From left to right.
    columns: [Column<'a>; 2 * HALF_COLUMNS + 1],
    /// Mean slope of the skyline.
    pub skyline: f32,
    /// Slope of the look.
    pub pitch: f32,
    /// Part of the picture's width that stems near by take whose crowns its upper edge cuts off.
    pub cut_stems: f32,
    /// Rays of each kind in each band of depths.
    counts: Counts,
    /// The same of the picture's middle half.
    in_middle: Counts,
    /// How much of the light on land and trees is the sun's, on the mean: see [`Seen::sun`].
    pub sun: f32,
}

type Counts = [[u32; BANDS_M.len() + 1]; Kind::ALL.len()];

impl<'a> Picture<'a> {
    pub fn new(panorama: &'a Panorama, lookout: Lookout) -> Self {
        let middle = lookout.heading() * COLUMNS / Lookout::HEADINGS;
        let columns = std::array::from_fn(|k| panorama.column(middle + k, HALF_COLUMNS));
        let mut picture = Self {
            columns,
            skyline: 0.0,
            pitch: 0.0,
            cut_stems: 0.0,
            counts: Counts::default(),
            in_middle: Counts::default(),
            sun: 0.0,
        };
        picture.skyline = picture.mean(|column| column.skyline);
        let pitch = picture.skyline - 2.0 * HALF_HEIGHT * (0.5 - SKYLINE_AT);
        picture.pitch = pitch.clamp(-MAX_PITCH, MAX_PITCH);
        picture.cut_stems = cut_stems(panorama, middle, picture.pitch);
        let [mut counts, mut in_middle] = [Counts::default(); 2];
        let (mut sun, mut solid) = (0.0, 0_u32);
        for (k, (_, seen)) in picture.rays().enumerate() {
            let is_in_middle = (k % picture.columns.len()).abs_diff(HALF_COLUMNS) <= HALF_COLUMNS / 2;
            let (kind, band) = (seen.kind as usize, band(seen.depth_m));
            counts[kind][band] += 1;
            in_middle[kind][band] += u32::from(is_in_middle);
            if !matches!(seen.kind, Kind::Sky | Kind::Water) {
                (sun, solid) = (sun + seen.sun, solid + 1);
            }
        }
        Self { counts, in_middle, sun: sun / solid.max(1) as f32, ..picture }
    }

    /// Of all columns.
    pub fn mean(&self, value: impl Fn(&Column<'_>) -> f32) -> f32 {
        self.columns.iter().map(value).sum::<f32>() / self.columns.len() as f32
    }

    /// Part of the columns that show something that is wanted.
    pub fn part_of_columns(&self, is_wanted: impl Fn(&Seen) -> bool) -> f32 {
        self.mean(|column| f32::from(u8::from(column.seen.iter().any(&is_wanted))))
    }

    /// Part of the columns in which something that is wanted is what one sees below the sky.
    pub fn part_of_skyline(&self, is_wanted: impl Fn(&Seen) -> bool) -> f32 {
        let top = |column: &Column<'_>| column.seen.iter().rev().find(|seen| seen.kind != Kind::Sky).copied();
        self.mean(|column| f32::from(u8::from(top(column).is_some_and(|seen| is_wanted(&seen)))))
    }

    /// Part of the upper edge that shows something that is wanted.
    pub fn part_of_upper_edge(&self, is_wanted: impl Fn(&Seen) -> bool) -> f32 {
        self.part(self.upper_edge(), |_, seen| is_wanted(seen))
    }

    /// Of what is wanted and shown, the part below places where the upper edge shows it, too.
    pub fn part_cut_off(&self, is_wanted: impl Fn(&Seen) -> bool) -> f32 {
        let (mut all, mut cut) = (0, 0);
        for column in &self.columns {
            let mut at_edge = rows_between(self.upper_edge());
            let is_cut = at_edge.any(|(row, _)| is_wanted(&column.seen[row]));
            let shown = rows_between(self.slopes()).filter(|&(row, _)| is_wanted(&column.seen[row])).count();
            all += shown;
            cut += if is_cut { shown } else { 0 };
        }
        cut as f32 / all.max(1) as f32
    }

    fn slopes(&self) -> [f32; 2] {
        [self.pitch - HALF_HEIGHT, self.pitch + HALF_HEIGHT]
    }

    fn upper_edge(&self) -> [f32; 2] {
        let [_, edge] = self.slopes();
        [edge - ROW_STEP, edge]
    }

    /// All of it: slope and what is seen.
    pub fn rays(&self) -> impl Iterator<Item = (f32, &Seen)> {
        self.rays_between(self.slopes())
    }

    fn rays_between(&self, slopes: [f32; 2]) -> impl Iterator<Item = (f32, &Seen)> {
        rows_between(slopes)
            .flat_map(|(row, slope)| self.columns.iter().map(move |column| (slope, &column.seen[row])))
    }

    /// Part of the rays with slopes between two bounds that meet what `wanted` says.
    pub fn part(&self, slopes: [f32; 2], wanted: impl Fn(f32, &Seen) -> bool) -> f32 {
        let (mut all, mut met) = (0_u32, 0_u32);
        for (slope, seen) in self.rays_between(slopes) {
            (all, met) = (all + 1, met + u32::from(wanted(slope, seen)));
        }
        met as f32 / all.max(1) as f32
    }

    /// Part of the picture that shows some kinds.
    pub fn share(&self, wanted: impl Fn(Kind) -> bool) -> f32 {
        self.share_between(0.0..f32::INFINITY, wanted)
    }

    /// Part of the picture that shows some kinds between two depths in metres, each one of [`BANDS_M`], 0 or infinite.
    pub fn share_between(&self, depths_m: Range<f32>, wanted: impl Fn(Kind) -> bool) -> f32 {
        share_of(&self.counts, depths_m, wanted)
    }

    /// The same part of the picture's middle half.
    pub fn middle_share_between(&self, depths_m: Range<f32>, wanted: impl Fn(Kind) -> bool) -> f32 {
        share_of(&self.in_middle, depths_m, wanted)
    }
}

/// The panorama's rows between two slopes, with theirs.
fn rows_between([low, high]: [f32; 2]) -> impl Iterator<Item = (usize, f32)> {
    (0..ROWS).map(|row| (row, slope_of(row))).filter(move |(_, slope)| (low..=high).contains(slope))
}

/// [`Picture::cut_stems`] of the picture around a column. A crown counts wholly that begins in the picture's uppermost fifth,
/// and less and less down to a tenth above the middle.
fn cut_stems(panorama: &Panorama, middle: usize, pitch: f32) -> f32 {
    let (all, half) = (COLUMNS as f32, HALF_COLUMNS as f32 + 0.5);
    let aside = |column: f32| (column - middle as f32 + 1.5 * all) % all - 0.5 * all;
    let taken = panorama.stems().iter().filter(|stem| aside(stem.column).abs() < half);
    taken.map(|stem| stem.width * ramp(0.2, 0.6, (stem.crown_from - pitch) / HALF_HEIGHT)).sum::<f32>()
        / (2.0 * half)
}

fn share_of(counts: &Counts, depths_m: Range<f32>, wanted: impl Fn(Kind) -> bool) -> f32 {
    let bands = match depths_m.end.is_finite() {
        true => band(depths_m.start)..band(depths_m.end),
        false => band(depths_m.start)..BANDS_M.len() + 1,
    };
    let met = Kind::ALL.into_iter().filter(|&kind| wanted(kind));
    let met: u32 = met.flat_map(|kind| &counts[kind as usize][bands.clone()]).sum();
    met as f32 / counts.as_flattened().iter().sum::<u32>().max(1) as f32
}

/// Number of the band in which a depth lies.
fn band(depth_m: f32) -> usize {
    BANDS_M.iter().filter(|&&band_m| band_m <= depth_m).count()
}
