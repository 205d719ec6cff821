//! Slopes slide until they hold (Musgrave, Kolb & Mace 1989): loose material to its angle of repose, bare rock to
//! a steeper angle that varies from place to place, so that cliffs stand above their scree. Metres throughout.

use rayon::prelude::*;

use super::LandParams;
use super::grid::{Grid, smoothstep};
use crate::noise::fbm2;
use crate::seed::noise_seed;

/// Slides the land and adds what came to rest to the `loose` layer.
pub(super) fn slide(land: &mut Grid, loose: &mut Grid, guard: &Grid, params: &LandParams) {
    let hardness = hardness(land.side, params);
    for sweeps in [8, 8, 10] {
        let steepest = steepest_drops(&hardness, loose, land.spacing_m, params.talus_angle_deg);
        let before = land.clone();
        for sweep in 0..sweeps {
            relax(land, &steepest, guard, sweep % 2 == 1);
        }
        settle(loose, &before, land);
    }
}

/// Adds to the loose layer what `after` has gained over `before`; what has gone is gone.
pub(super) fn settle(loose: &mut Grid, before: &Grid, after: &Grid) {
    for ((l, b), a) in loose.values.iter_mut().zip(&before.values).zip(&after.values) {
        *l = (*l + a - b).max(0.0);
    }
}

/// How much steeper than loose stone the rock stands here, 0 to 1.
fn hardness(side: u32, params: &LandParams) -> Grid {
    let seed = noise_seed(params.terrain_seed.into(), "land", 5);
    let coarse = Grid::from_field(129, |x, z| smoothstep(-0.45, 0.5, fbm2(seed, x / 110.0, z / 110.0, 3, 0.5, 0)));
    coarse.resized(side)
}

/// The greatest drop in metres from a sample to its neighbour that holds.
fn steepest_drops(hardness: &Grid, loose: &Grid, spacing_m: f32, talus_deg: f32) -> Vec<f32> {
    let drop_m = |deg: f32| libm::tanf(deg.to_radians()) * spacing_m;
    let (talus, soft, hard) = (drop_m(talus_deg), drop_m(talus_deg + 6.0), drop_m((talus_deg + 26.0).min(66.0)));
    let pairs = hardness.values.iter().zip(&loose.values);
    pairs
        .map(|(h, l)| {
            let bare = soft + (hard - soft) * h;
            bare + (talus - bare) * (l * 4.0).min(1.0)
        })
        .collect()
}

/// One Jacobi sweep over four neighbours, the straight or the diagonal ones: what is steeper than it holds moves.
fn relax(land: &mut Grid, steepest: &[f32], guard: &Grid, diagonal: bool) {
    let n = land.side as usize;
    let old = land.values.clone();
    let reach = if diagonal { std::f32::consts::SQRT_2 } else { 1.0 };
    land.values.par_chunks_mut(n).enumerate().skip(1).take(n - 2).for_each(|(j, out)| {
        let row = |r: usize| (&old[r * n..][..n], &steepest[r * n..][..n]);
        let ((north, t_north), (here, t_here), (south, t_south)) = (row(j - 1), row(j), row(j + 1));
        let guard = &guard.values[j * n..][..n];
        for i in 1..n - 1 {
            let moved = |other: f32, t: f32| {
                let holds = 0.5 * reach * (t + t_here[i]);
                let rise = other - here[i];
                rise - rise.max(-holds).min(holds)
            };
            let sum = if diagonal {
                moved(north[i - 1], t_north[i - 1])
                    + moved(north[i + 1], t_north[i + 1])
                    + moved(south[i - 1], t_south[i - 1])
                    + moved(south[i + 1], t_south[i + 1])
            } else {
                moved(north[i], t_north[i])
                    + moved(south[i], t_south[i])
                    + moved(here[i - 1], t_here[i - 1])
                    + moved(here[i + 1], t_here[i + 1])
            };
            out[i] = here[i] + 0.22 * guard[i] * sum;
        }
    });
}
