//! Land → land whose slopes hold: they slide until they do (Musgrave, Kolb & Mace 1989): loose material to its angle of
//! repose, bare rock to a steeper angle that varies from place to place, so that cliffs stand above their scree. Metres
//! throughout.

use rayon::prelude::*;

use super::LandParams;
use super::grid::Grid;
use crate::math::{lerp, smoothstep};
use crate::noise::{fbm2, gradient2};
use crate::seed::noise_seed;

/// Height in metres of ledges and ribs in bare rock.
const RIBS_M: f32 = 2.2;

/// Slides the land and adds the material that came to rest to the `loose` layer.
pub(super) fn slide(land: &mut Grid, loose: &mut Grid, params: &LandParams) {
    let hardness = hardness(land.side, params);
    for _ in 0..6 {
        let steepest = steepest_drops(&hardness, loose, land.spacing_m, params.talus_angle_deg);
        let before = land.clone();
        for sweep in 0..4 {
            relax(land, &steepest, sweep % 2 == 1);
        }
        settle(loose, &before, land);
    }
    roughen(land, loose, params);
}

/// Adds to the loose layer the height that `after` has gained over `before`, or takes away the height lost.
pub(super) fn settle(loose: &mut Grid, before: &Grid, after: &Grid) {
    for ((l, b), a) in loose.values.iter_mut().zip(&before.values).zip(&after.values) {
        *l = (*l + a - b).max(0.0);
    }
}

/// Gives bare rock on steep slopes its ledges and ribs, which stand up to `RIBS_M`.
fn roughen(land: &mut Grid, loose: &Grid, params: &LandParams) {
    let n = land.side as usize;
    let seed = noise_seed(params.terrain_seed.into(), "land", 6);
    let old = land.values.clone();
    let (spacing_m, talus) = (land.spacing_m, libm::tanf(params.talus_angle_deg.to_radians()));
    land.values.par_chunks_mut(n).enumerate().skip(1).take(n - 2).for_each(|(j, row)| {
        for (i, h) in row.iter_mut().enumerate().take(n - 1).skip(1) {
            let k = j * n + i;
            let (dx, dz) = (old[k + 1] - old[k - 1], old[k + n] - old[k - n]);
            let slope = (dx * dx + dz * dz).sqrt() / (2.0 * spacing_m);
            let bare =
                smoothstep(0.85 * talus, 1.4 * talus, slope) * (1.0 - smoothstep(0.1, 0.5, loose.values[k]));
            if bare > 0.0 {
                let (x, z) = (i as f32 * spacing_m, j as f32 * spacing_m);
                let broad = gradient2(seed, x / 19.0 + old[k] / 40.0, z / 19.0, 0);
                let fine = gradient2(seed ^ 1, x / 9.0, z / 9.0 + old[k] / 25.0, 0);
                *h += RIBS_M * bare * ((0.5 - broad.abs() * 1.6) + 0.3 * (0.5 - fine.abs() * 1.6));
            }
        }
    });
}

/// How much steeper than loose stone the rock stands here, 0 to 1.
fn hardness(side: u32, params: &LandParams) -> Grid {
    let seed = noise_seed(params.terrain_seed.into(), "land", 5);
    let coarse =
        Grid::from_field(129, |x, z| smoothstep(-0.45, 0.5, fbm2(seed, x / 110.0, z / 110.0, 3, 0.5, 0)));
    coarse.resized(side)
}

/// The greatest drop in metres from a sample to its neighbour that holds.
fn steepest_drops(hardness: &Grid, loose: &Grid, spacing_m: f32, talus_deg: f32) -> Vec<f32> {
    let drop_m = |deg: f32| libm::tanf(deg.to_radians()) * spacing_m;
    let (talus, soft, hard) =
        (drop_m(talus_deg), drop_m(talus_deg + 5.0), drop_m((talus_deg + 15.0).min(54.0)));
    hardness.zip(loose, |h, l| lerp(lerp(soft, hard, h), talus, (l * 4.0).min(1.0))).values
}

/// One Jacobi sweep over four neighbours, the straight or the diagonal ones: material that lies too steeply moves.
/// Beyond the edge, its own samples repeat.
fn relax(land: &mut Grid, steepest: &[f32], diagonal: bool) {
    let n = land.side as usize;
    let old = land.values.clone();
    let reach = if diagonal { std::f32::consts::SQRT_2 } else { 1.0 };
    land.values.par_chunks_mut(n).enumerate().for_each(|(j, out)| {
        let row = |r: usize| Row { heights: &old[r * n..][..n], holds: &steepest[r * n..][..n] };
        let (north, here, south) = (row(j.saturating_sub(1)), row(j), row((j + 1).min(n - 1)));
        let straight = [(&north, 1), (&here, 0), (&here, 2), (&south, 1)];
        let across = [(&north, 0), (&north, 2), (&south, 0), (&south, 2)];
        for (other, shift) in if diagonal { across } else { straight } {
            here.take_from(other, shift, reach, out);
        }
    });
}

/// One row of heights and of the drops that hold there.
struct Row<'a> {
    heights: &'a [f32],
    holds: &'a [f32],
}

impl Row<'_> {
    /// Moves the surplus between this row and `other`, shifted by `shift` − 1 samples, into `out`.
    fn take_from(&self, other: &Row, shift: usize, reach: f32, out: &mut [f32]) {
        let inner = self.heights.len() - 2;
        let (h, t) = (&self.heights[1..][..inner], &self.holds[1..][..inner]);
        let (g, s) = (&other.heights[shift..][..inner], &other.holds[shift..][..inner]);
        for (i, out) in out[1..][..inner].iter_mut().enumerate() {
            *out += 0.24 * surplus(g[i] - h[i], reach * t[i], reach * s[i]);
        }
        for i in [0, inner + 1] {
            let k = (i + shift).saturating_sub(1).min(inner + 1);
            let rise = other.heights[k] - self.heights[i];
            out[i] += 0.24 * surplus(rise, reach * self.holds[i], reach * other.holds[k]);
        }
    }
}

/// How much the rise to a neighbour exceeds what the higher of the two holds, with its sign.
#[inline]
fn surplus(rise: f32, here_holds: f32, there_holds: f32) -> f32 {
    let above = rise - there_holds;
    let below = rise + here_holds;
    let above = if above > 0.0 { above } else { 0.0 };
    let below = if below < 0.0 { below } else { 0.0 };
    above + below
}
