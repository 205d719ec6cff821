//! Land and sea level → cliffs: the land breaks off where it meets the sea, in bays less steeply.
//!
//! Waves cut sideways at one level, so how high a cliff rises at a place follows from how far it is from the sea, and hardly
//! from how the land lay before. Made after all other erosion, which would take cliffs for slopes that must slide.

use std::collections::VecDeque;

use super::LandParams;
use super::grid::Grid;
use crate::math::{lerp, ramp, smoothstep};
use crate::noise::gradient2;
use crate::raster::square;
use crate::seed::noise_seed;

/// Part of the land's height above the sea that cliffs have at most.
const MAX_PART: f32 = 0.6;
/// Metres of rock behind the shoreline, from the foot of a cliff to its edge, for each metre that it is high.
const FACE: f32 = 0.34;
/// Metres from the sea to the top of the slope, in a bay.
const BAY_M: f32 = 90.0;
/// Metres from the shoreline to the foot of a cliff.
const FOOT_M: f32 = 1.5;
/// Metres from bay to bay, from buttress to buttress and from crag to crag.
const BAYS_M: f32 = 360.0;
const BUTTRESSES_M: f32 = 46.0;
const CRAGS_M: f32 = 13.0;
/// Ledges between the foot and the edge.
const LEDGES: f32 = 3.0;

/// The coast of a land.
pub(super) struct Coast {
    water_m: f32,
    cliff_m: f32,
    /// Factor on heights above the sea, so that the highest point stays where it was.
    rest: f32,
    /// How far the land has come from the foot of the cliff, and on the sea's side of it (0), to the edge and behind it (1).
    edge: Grid,
    /// How much of a bay a place is in, 0 on headlands to 1.
    bay: Grid,
}

impl Coast {
    /// The coast of `land` by a sea that lies at `water_m`, on as many samples a side as the land or `side`, whichever is more.
    /// `None` without cliffs, or if no water reaches the border: a lake is no sea.
    pub fn new(params: &LandParams, land: &Grid, side: u32, water_m: Option<f32>) -> Option<Self> {
        let water_m = water_m.filter(|_| params.cliff_m > 0.0)?;
        let away_m = distance_to_sea_m(land, water_m)?.resized(side.max(land.side));
        let above_m = land.range().1 - water_m;
        let cliff_m = params.cliff_m.min(MAX_PART * above_m);
        let rest = 1.0 - cliff_m / above_m;
        let shore = Shore { cliff_m, seed: noise_seed(params.terrain_seed.into(), "land", 20) };
        let bay = Grid::from_field(away_m.side, |x, z| shore.bay(x, z));
        let n = away_m.side as usize;
        let edge = square(n, |i, j| {
            let k = j * n + i;
            shore.edge(away_m.values[k], bay.values[k], away_m.place_m(i), away_m.place_m(j))
        });
        Some(Self { water_m, cliff_m, rest, edge: Grid { values: edge, ..away_m }, bay })
    }

    /// Raises the land behind the shoreline.
    pub fn raise(&self, field: &mut Grid) {
        let edge = self.edge.resized(field.side);
        field.values.iter_mut().zip(edge.values).for_each(|(h, edge)| *h = self.raised(*h, edge));
    }

    /// Raises the land around, on whose coarse grid no face is to be seen.
    pub fn raise_apron(&self, apron: &mut Grid) {
        let dry = apron.values.iter_mut().filter(|h| **h > self.water_m);
        dry.for_each(|h| *h = self.raised(*h, 1.0));
    }

    /// Loose stone lies on no cliff.
    pub fn sweep(&self, loose: &mut Grid) {
        let [edge, bay] = [&self.edge, &self.bay].map(|grid| grid.resized(loose.side));
        for ((loose, edge), bay) in loose.values.iter_mut().zip(edge.values).zip(bay.values) {
            let face = smoothstep(0.0, 0.1, edge) * (1.0 - smoothstep(0.9, 1.0, edge));
            *loose *= 1.0 - face * (1.0 - bay);
        }
    }

    /// A height behind the shoreline, raised as far as the land has come there from the foot of the cliff (0) to its edge (1).
    /// Hollows that are no part of the sea rise, too.
    fn raised(&self, height_m: f32, edge: f32) -> f32 {
        let above_m = height_m - self.water_m;
        let rest = if above_m > 0.0 { lerp(1.0, self.rest, edge) } else { 1.0 };
        self.water_m + rest * above_m + self.cliff_m * edge
    }
}

/// How the shore is broken.
struct Shore {
    cliff_m: f32,
    seed: u32,
}

impl Shore {
    /// [`Coast::edge`] at a place so far from the sea.
    fn edge(&self, away_m: f32, bay: f32, x: f32, z: f32) -> f32 {
        if away_m <= 0.0 {
            return 0.0;
        }
        let noise =
            |item: u32, wave_m: f32| gradient2(self.seed.wrapping_add(item), x / wave_m, z / wave_m, 0);
        let broken_m = self.cliff_m * (0.3 * noise(1, BUTTRESSES_M) + 0.09 * noise(2, CRAGS_M));
        let width_m = lerp(FACE * self.cliff_m + 2.0, BAY_M, bay);
        let way = ramp(FOOT_M, FOOT_M + width_m, away_m + broken_m.min(0.0));
        // A smooth slope in bays, ledges on cliffs.
        let step = way * LEDGES;
        let ledge = (step.floor() + smoothstep(0.25, 0.9, step - step.floor())) / LEDGES;
        lerp(lerp(way, ledge, 0.6), smoothstep(0.0, 1.0, way), bay)
    }

    /// [`Coast::bay`] at a place.
    fn bay(&self, x: f32, z: f32) -> f32 {
        smoothstep(0.12, 0.42, gradient2(self.seed, x / BAYS_M, z / BAYS_M, 0))
    }
}

/// Metres from each place to the sea, 0 in it; `None` without a sea: water that reaches the border.
fn distance_to_sea_m(land: &Grid, water_m: f32) -> Option<Grid> {
    let n = land.side as usize;
    let mut squares = sea(land, water_m);
    if squares.iter().all(|&d| d > 0.0) {
        return None;
    }
    // Exact, first along columns, then along rows (Felzenszwalb and Huttenlocher, "Distance transforms of sampled functions",
    // 2012).
    let mut line = vec![0.0; n];
    for i in 0..n {
        (0..n).for_each(|j| line[j] = squares[j * n + i]);
        let lower = lower_envelope(&line);
        (0..n).for_each(|j| squares[j * n + i] = lower[j]);
    }
    for row in squares.chunks_exact_mut(n) {
        row.copy_from_slice(&lower_envelope(row));
    }
    let values = squares.iter().map(|square| square.sqrt() * land.spacing_m).collect();
    // The shoreline runs between samples, not along them.
    Some(Grid { values, ..*land }.smoothed().smoothed())
}

/// 0 for samples of the sea, and for others more than any distance on the grid, in samples, squared.
fn sea(land: &Grid, water_m: f32) -> Vec<f32> {
    let n = land.side as usize;
    let mut sea = vec![2.0 * (n * n) as f32; n * n];
    let border = (0..n).flat_map(|k| [k, (n - 1) * n + k, k * n, k * n + n - 1]);
    let mut next: VecDeque<usize> = border.collect();
    while let Some(k) = next.pop_front() {
        if sea[k] == 0.0 || land.values[k] >= water_m {
            continue;
        }
        sea[k] = 0.0;
        let (i, j) = (k % n, k / n);
        next.extend((i > 0).then(|| k - 1));
        next.extend((i + 1 < n).then_some(k + 1));
        next.extend((j > 0).then(|| k - n));
        next.extend((j + 1 < n).then_some(k + n));
    }
    sea
}

/// Least of (i − j)² + `line`\[j\] over all j, for each i.
fn lower_envelope(line: &[f32]) -> Vec<f32> {
    // Parabolas that are lowest somewhere, and from where on each is.
    let mut lowest: Vec<(usize, f32)> = Vec::with_capacity(line.len());
    for (j, &height) in line.iter().enumerate() {
        let meets = |&(other, _): &(usize, f32)| {
            let [a, b] = [other as f32, j as f32];
            (height + b * b - line[other] - a * a) / (2.0 * (b - a))
        };
        let from = loop {
            match lowest.last() {
                None => break f32::NEG_INFINITY,
                Some(last) if meets(last) <= last.1 => drop(lowest.pop()),
                Some(last) => break meets(last),
            }
        };
        lowest.push((j, from));
    }
    let mut k = 0;
    (0..line.len())
        .map(|i| {
            while lowest.get(k + 1).is_some_and(|next| next.1 <= i as f32) {
                k += 1;
            }
            let away = i as f32 - lowest[k].0 as f32;
            away * away + line[lowest[k].0]
        })
        .collect()
}
