//! Land → land with valleys, and the drained area of each place. Rivers cut by the stream power law, solved implicitly
//! from mouth to spring (Braun & Willett, "A very efficient O(n), implicit and parallel method to solve the stream
//! power equation", 2013), over drainage that leaves every hollow (priority flood, Barnes et al. 2014). Heights in
//! metres, drained areas in square metres.

use super::LandParams;
use super::grid::{self, Grid};
use crate::noise::hash01;
use crate::seed::noise_seed;

/// Erodibility times the time of one step.
const STEP: f32 = 0.16;
/// Metres from the border to the plain that all rivers run to.
const OUTSIDE_M: f32 = 400.0;
/// Part of a hollow's depth that sediment fills in one step.
const FILLING: f32 = 0.25;
/// Square metres that drain into a place where water begins to gather: four cells of the finest grid of rivers, and no more on
/// coarser ones, so that a sketch is as wet as the land.
const SPRING_M2: f32 = 64.0;
/// Buckets of the flood's queue: heights within one are drained in order of arrival.
const BUCKETS: usize = 4096;
/// The eight neighbours as (east, south) steps; odd entries are diagonal.
const NEIGHBOURS: [(i32, i32); 8] = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];

/// Cuts valleys on each of `sides` in turn, coarse to fine, wide valleys before their tributaries.
pub(super) fn carve_valleys(land: &mut Grid, loose: &mut Grid, params: &LandParams, sides: [u32; 2]) {
    let seed = noise_seed(params.terrain_seed.into(), "land", 3);
    // Finer grids cost four times as much a step and have less to add.
    let steps = [params.stream_power_steps, params.stream_power_steps.div_ceil(5)];
    for (side, steps) in sides.into_iter().zip(steps) {
        let before = land.resized(side);
        let mut after = before.clone();
        let base_m = before.range().0;
        for step in 0..steps {
            let drainage = Drainage::new(&after, seed.wrapping_add(step));
            drainage.cut(&mut after, base_m);
            creep(&mut after, params.talus_angle_deg + 10.0);
        }
        let gained = after.zip(&before, |after, before| (after - before).max(0.0)).resized(land.side);
        grid::add_change(land, &before, &after);
        *loose = loose.zip(&gained, |loose, gained| loose + gained.max(0.0));
    }
}

/// Drained area of every sample of the land at `side`, log-scaled to [0, 1].
pub(super) fn flow(land: &Grid, side: u32) -> Grid {
    let coarse = land.resized(side);
    let areas = Drainage::new(&coarse, 0).spread_areas(&coarse);
    let greatest = areas.iter().fold(SPRING_M2, |a, &b| a.max(b));
    let scale = 1.0 / libm::logf(greatest / SPRING_M2).max(1.0);
    let values = areas.iter().map(|a| (libm::logf((a / SPRING_M2).max(1.0)) * scale).min(1.0)).collect();
    Grid { values, ..coarse }.smoothed()
}

/// Where the water of each sample goes.
struct Drainage {
    side: usize,
    spacing_m: f32,
    /// Samples from the border inwards, each after the one it drains into.
    order: Vec<u32>,
    /// Each sample's place in `order`.
    rank: Vec<u32>,
    /// The sample each drains into; the border drains into itself.
    receiver: Vec<u32>,
    /// Height in metres of the water that would fill the hollows to their brims.
    filled: Vec<f32>,
}

impl Drainage {
    fn new(land: &Grid, seed: u32) -> Self {
        let count = land.values.len();
        let mut drainage = Self {
            side: land.side as usize,
            spacing_m: land.spacing_m,
            order: Vec::with_capacity(count),
            rank: vec![u32::MAX; count],
            receiver: (0..count as u32).collect(),
            filled: land.values.clone(),
        };
        drainage.flood(land);
        drainage.steer(seed);
        drainage
    }

    /// Visits samples from the border inwards, lowest first, filling hollows as it goes.
    fn flood(&mut self, land: &Grid) {
        let n = self.side;
        let (lo, hi) = land.range();
        let scale = (BUCKETS - 1) as f32 / (hi - lo).max(1e-3);
        let bucket = |h: f32| (((h - lo) * scale) as usize).min(BUCKETS - 1);
        // Buckets of samples, first come first served within each.
        let mut queue: Vec<Vec<u32>> = vec![Vec::new(); BUCKETS];
        let mut seen = vec![false; n * n];
        for k in (0..n * n).filter(|k| k % n == 0 || k % n == n - 1 || k / n == 0 || k / n == n - 1) {
            seen[k] = true;
            queue[bucket(self.filled[k])].push(k as u32);
        }
        for at in 0..BUCKETS {
            let mut next = 0;
            while let Some(&k) = queue[at].get(next) {
                next += 1;
                self.rank[k as usize] = self.order.len() as u32;
                self.order.push(k);
                let level = self.filled[k as usize];
                for_neighbours(n, k as usize, |_, m| {
                    if !std::mem::replace(&mut seen[m], true) {
                        self.receiver[m] = k;
                        self.filled[m] = self.filled[m].max(level);
                        queue[bucket(self.filled[m]).max(at)].push(m as u32);
                    }
                });
            }
        }
    }

    /// Turns each sample to its steepest descent, with some randomness so that no direction of the grid is favoured.
    fn steer(&mut self, seed: u32) {
        for k in 0..self.filled.len() {
            if self.receiver[k] as usize == k {
                continue;
            }
            let mut steepest = 0.0;
            for_neighbours(self.side, k, |way, m| {
                let drop = self.filled[k] - self.filled[m];
                if drop <= 0.0 || self.rank[m] >= self.rank[k] {
                    return;
                }
                let chance = 0.7 + 0.6 * hash01(seed, k as i32, way as i32, 7);
                let slope = drop * chance * if way % 2 == 1 { std::f32::consts::FRAC_1_SQRT_2 } else { 1.0 };
                if slope > steepest {
                    steepest = slope;
                    self.receiver[k] = m as u32;
                }
            });
        }
    }

    /// Drained area of each sample, all of it passed to its receiver.
    fn areas(&self) -> Vec<f32> {
        let mut areas = vec![self.spacing_m * self.spacing_m; self.filled.len()];
        for &k in self.order.iter().rev() {
            let to = self.receiver[k as usize];
            if to != k {
                areas[to as usize] += areas[k as usize];
            }
        }
        areas
    }

    /// Drained area of each sample, passed to all lower neighbours, more to steeper ones (Freeman 1991).
    fn spread_areas(&self, land: &Grid) -> Vec<f32> {
        let mut areas = vec![self.spacing_m * self.spacing_m; self.filled.len()];
        for &k in self.order.iter().rev() {
            let k = k as usize;
            let mut parts = [0.0; 8];
            let mut total = 0.0;
            for_neighbours(self.side, k, |way, m| {
                if self.rank[m] < self.rank[k] {
                    let drop = (land.values[k] - land.values[m]).max(0.0);
                    let slope = drop * if way % 2 == 1 { std::f32::consts::FRAC_1_SQRT_2 } else { 1.0 };
                    parts[way] = slope * slope;
                    total += parts[way];
                }
            });
            let to = self.receiver[k] as usize;
            if total >= 1e-9 {
                let share = areas[k] / total;
                for_neighbours(self.side, k, |way, m| areas[m] += parts[way] * share);
            } else if to != k {
                areas[to] += areas[k];
            }
        }
        areas
    }

    /// One implicit step of dh/dt = −K √A |∇h|, and sediment in the hollows. Rivers that leave the field run on for
    /// `OUTSIDE_M` to a plain at `base_m`.
    fn cut(&self, land: &mut Grid, base_m: f32) {
        let areas = self.areas();
        let h = &mut land.values;
        for &k in &self.order {
            let k = k as usize;
            let to = self.receiver[k] as usize;
            let lowered = |base_m: f32, reach_m: f32| {
                let power = STEP * areas[k].sqrt() / reach_m;
                (h[k] + power * base_m) / (1.0 + power)
            };
            h[k] = if to == k {
                lowered(base_m, OUTSIDE_M)
            } else if h[k] <= h[to] {
                h[k] + FILLING * (self.filled[k] - h[k]).max(0.0)
            } else {
                let diagonal = to % self.side != k % self.side && to / self.side != k / self.side;
                lowered(h[to], self.spacing_m * if diagonal { std::f32::consts::SQRT_2 } else { 1.0 })
            };
        }
    }
}

/// Valley sides follow their river: slopes steeper than `steepest_deg` give way, and all creep a little.
fn creep(land: &mut Grid, steepest_deg: f32) {
    let n = land.side as usize;
    let holds_m = libm::tanf(steepest_deg.to_radians()) * land.spacing_m;
    for _ in 0..2 {
        let old = land.values.clone();
        for j in 0..n {
            let row = |r: usize| &old[r * n..][..n];
            let (north, here, south) = (row(j.saturating_sub(1)), row(j), row((j + 1).min(n - 1)));
            let out = &mut land.values[j * n..][..n];
            let at = |west: usize, i: usize, east: usize| {
                let moved = |other: f32| {
                    let rise = other - here[i];
                    0.2 * (rise - rise.max(-holds_m).min(holds_m)) + 0.03 * rise
                };
                here[i] + moved(here[west]) + moved(here[east]) + moved(north[i]) + moved(south[i])
            };
            for (i, out) in out.iter_mut().enumerate().take(n - 1).skip(1) {
                *out = at(i - 1, i, i + 1);
            }
            out[0] = at(0, 0, 1);
            out[n - 1] = at(n - 2, n - 1, n - 1);
        }
    }
}

/// Calls `f` with the neighbours of sample `k` inside an n×n grid, and their index in `NEIGHBOURS`.
#[inline]
fn for_neighbours(n: usize, k: usize, mut f: impl FnMut(usize, usize)) {
    let (x, y) = ((k as u32 % n as u32) as i32, (k as u32 / n as u32) as i32);
    let inner = 1..n as i32 - 1;
    if inner.contains(&x) && inner.contains(&y) {
        // Nearly all: without a question for each neighbour.
        for (way, (dx, dy)) in NEIGHBOURS.into_iter().enumerate() {
            f(way, (k as i32 + dy * n as i32 + dx) as usize);
        }
        return;
    }
    for (way, (dx, dy)) in NEIGHBOURS.into_iter().enumerate() {
        let (x, y) = (x + dx, y + dy);
        if (0..n as i32).contains(&x) && (0..n as i32).contains(&y) {
            f(way, y as usize * n + x as usize);
        }
    }
}
