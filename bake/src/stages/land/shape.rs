//! Position in metres → raw height in metres, for any place on the field or beyond it: a multifractal of rotated
//! octaves, folded by domain warping, on a broad massif where the relief is too great for the landforms' size.

use std::f32::consts::TAU;
use std::ops::Range;

use bytemuck::Zeroable;
use rayon::prelude::*;

use super::grid::Grid;
use super::{FIELD_M, LandParams};
use crate::math::{lerp, smoothstep};
use crate::noise::gradient2;
use crate::raster::square;
use crate::seed::noise_seed;

/// Wavelength in metres of the finest octave.
const MIN_WAVELENGTH_M: f32 = 6.0;
/// Octaves of this wavelength in metres or more are computed on every second sample only.
const BROAD_M: f32 = 40.0;
/// Greatest part of its wavelength that a landform may rise before a massif carries the rest of the relief.
const STEEPNESS: f32 = 0.21;

/// The raw land as a function of position.
pub(super) struct Shape<'a> {
    genes: &'a LandParams,
    octaves: Vec<Octave>,
    massif: [Octave; 2],
    fold: [Octave; 4],
    fold_m: f32,
    /// Part of the relief that the landforms have; the massif has the rest.
    share: f32,
    terraces: Terraces,
    /// Raw values that become the lowest and highest point of the field.
    range: (f32, f32),
    /// How far, as part of the relief, the middle is lifted so that the walk does not start under water.
    lift: f32,
    sea: Sea,
}

/// The sum so far at a place.
#[derive(Clone, Copy, Zeroable)]
struct Sum {
    /// The place in metres after folding.
    u: f32,
    v: f32,
    height: f32,
    /// How much the next octave counts.
    weight: f32,
    massif: f32,
}

/// One octave of noise: its own seed, direction and place, so that no lattice shows.
struct Octave {
    seed: u32,
    wavelength_m: f32,
    amplitude: f32,
    /// 0 rounded, 1 ridged.
    ridged: f32,
    /// Lattice units per metre along the octave's own axes, as cosine and sine.
    rotation: [f32; 2],
    shift: [f32; 2],
}

impl Octave {
    fn new(seed: u32, index: u32, wavelength_m: f32, amplitude: f32) -> Self {
        let seed = seed.wrapping_add(index.wrapping_mul(0x9E37_79B9));
        let angle = 0.4 + 2.399_963 * index as f32;
        // A lattice cell is about half a wave.
        let frequency = 2.0 / wavelength_m;
        let shift = [(seed >> 20) as f32 * 0.037, (seed >> 8 & 0xFFF) as f32 * 0.037];
        let rotation = [libm::cosf(angle) * frequency, libm::sinf(angle) * frequency];
        Self { seed, wavelength_m, amplitude, ridged: 0.0, rotation, shift }
    }

    #[inline]
    fn at(&self, x: f32, z: f32) -> f32 {
        let u = x * self.rotation[0] - z * self.rotation[1] + self.shift[0];
        let v = x * self.rotation[1] + z * self.rotation[0] + self.shift[1];
        gradient2(self.seed, u, v, 0)
    }
}

/// Where the land of a coast sinks below the sea, which is open to the horizon.
struct Sea {
    /// 0 where there is none, 1 where the land sinks all the way to its bed.
    part: f32,
    /// Direction of the sea along x and z.
    way: [f32; 2],
}

/// Soft steps in the slopes.
struct Terraces {
    strength: f32,
    steps: f32,
    bend: Octave,
    patches: Octave,
}

impl<'a> Shape<'a> {
    /// The land of these genes, not yet fitted to its relief.
    pub fn new(p: &'a LandParams) -> Self {
        let seed = |item| noise_seed(p.terrain_seed.into(), "land", item);
        let gain = libm::powf(p.lacunarity, -p.hurst);
        let share = (STEEPNESS * p.wavelength_m / p.relief_m).min(1.0);
        let mut octaves = Vec::new();
        // Every zero of the noise is a ridge: ridges stand twice as close as round tops would.
        let (mut wavelength_m, mut amplitude, mut ridged) =
            (p.wavelength_m * (1.0 + 0.7 * p.ridged), 1.0f32, p.ridged);
        // An octave lower than 2 cm is not worth its time.
        while wavelength_m >= MIN_WAVELENGTH_M && amplitude * p.relief_m > 0.04 {
            let walkable = amplitude.min(1.6 * walkable_amplitude_m(wavelength_m) / (share * p.relief_m));
            let octave = Octave::new(seed(0), octaves.len() as u32, wavelength_m, walkable);
            octaves.push(Octave { ridged, ..octave });
            ridged *= 0.88;
            wavelength_m /= p.lacunarity;
            amplitude *= gain;
        }
        let broad_m = p.wavelength_m.max(1500.0);
        let fold = |i, scale, amplitude| Octave::new(seed(2), i, p.wavelength_m * scale, amplitude);
        Self {
            genes: p,
            octaves,
            massif: [Octave::new(seed(1), 0, broad_m, 1.0), Octave::new(seed(1), 1, broad_m * 0.45, 0.4)],
            fold: [fold(0, 0.9, 1.0), fold(1, 0.9, 1.0), fold(2, 0.4, 0.4), fold(3, 0.4, 0.4)],
            fold_m: 0.32 * p.domain_warp * p.wavelength_m,
            share,
            terraces: Terraces {
                strength: p.terraces,
                steps: (p.relief_m / 13.0).clamp(4.0, 14.0),
                bend: Octave::new(seed(3), 0, 420.0, 0.5),
                patches: Octave::new(seed(3), 1, 300.0, 1.0),
            },
            range: (0.0, 1.0),
            lift: 0.0,
            sea: Sea::new(p),
        }
    }

    /// Fits the land to its relief over the field and lifts a middle that would drown; the raw heights in metres.
    pub fn fit(&mut self, side: u32) -> Grid {
        let raw = self.multifractal_grid(side);
        self.range = raw.range();
        self.lift = self.needed_lift();
        let (n, shape) = (side as usize, &*self);
        let values = square(n, |i, j| shape.finish(raw.values[j * n + i], raw.place_m(i), raw.place_m(j)));
        Grid { values, ..raw }
    }

    /// The fitted land on a grid of the field, of which `known` is a part or that is part of `known`.
    pub fn sample(&self, side: u32, known: &Grid) -> Grid {
        if side <= known.side {
            known.resized(side)
        } else {
            Grid::from_field(side, |x, z| self.height_m(x, z, 0.0))
        }
    }

    /// Raw height in metres at a place; waves shorter than twice `spacing_m` are left out.
    pub fn height_m(&self, x: f32, z: f32, spacing_m: f32) -> f32 {
        self.finish(self.total(&self.sum(x, z, 0..self.octaves.len(), spacing_m)), x, z)
    }

    /// The multifractal over the field: its broad octaves at half the resolution, cubic between.
    fn multifractal_grid(&self, side: u32) -> Grid {
        let fine = self.octaves.iter().take_while(|o| o.wavelength_m >= BROAD_M).count();
        let sums = Grid::from_field(side / 2 + 1, |x, z| self.sum(x, z, 0..fine, 0.0));
        let layer = |f: fn(Sum) -> f32| sums.map(f).resized(side);
        let (u, v, weight, massif) =
            (layer(|s| s.u), layer(|s| s.v), layer(|s| s.weight), layer(|s| s.massif));
        let mut grid = layer(|s| s.height);
        grid.values.par_iter_mut().enumerate().for_each(|(k, out)| {
            let [u, v, weight, massif] = [&u, &v, &weight, &massif].map(|layer| layer.values[k]);
            let mut sum = Sum { u, v, height: *out, weight, massif };
            self.add(&mut sum, fine..self.octaves.len(), 0.0);
            *out = self.total(&sum);
        });
        grid
    }

    /// A sum of octaves, each weaker where the land so far is low (Musgrave's hybrid multifractal), at the place after
    /// domain warping.
    fn sum(&self, x: f32, z: f32, octaves: Range<usize>, spacing_m: f32) -> Sum {
        let [a, b, c, d] = &self.fold;
        let (mut u, mut v) = (x, z);
        if self.fold_m > 0.0 {
            u += self.fold_m * (a.at(x, z) + 0.4 * c.at(x, z));
            v += self.fold_m * (b.at(x, z) + 0.4 * d.at(x, z));
        }
        let massif =
            if self.share < 1.0 { self.massif[0].at(x, z) + 0.4 * self.massif[1].at(x, z) } else { 0.0 };
        let mut sum = Sum { u, v, height: 0.0, weight: 1.0, massif };
        self.add(&mut sum, octaves, spacing_m);
        sum
    }

    /// Adds some of the octaves.
    fn add(&self, sum: &mut Sum, octaves: Range<usize>, spacing_m: f32) {
        for octave in &self.octaves[octaves] {
            let kept =
                if spacing_m > 0.0 { (octave.wavelength_m / spacing_m - 2.0).clamp(0.0, 1.0) } else { 1.0 };
            if kept == 0.0 {
                break;
            }
            let round = octave.at(sum.u, sum.v) * 1.25;
            // A ridge where the noise crosses zero, rounded just enough to be walked over.
            let ridge = 1.0 - 2.4 * (round * round + 0.0009).sqrt();
            sum.height += octave.amplitude * sum.weight * kept * lerp(round, ridge, octave.ridged);
            sum.weight = lerp(1.0, smoothstep(-0.7, 0.6, sum.height), 0.35 + 0.6 * self.genes.offset);
        }
    }

    fn total(&self, sum: &Sum) -> f32 {
        lerp(sum.massif * 1.4, sum.height, self.share)
    }

    /// From a raw value to metres: fitted, flattened where low, stepped, lifted in the middle.
    fn finish(&self, value: f32, x: f32, z: f32) -> f32 {
        let (lo, hi) = self.range;
        let part = soften((value - lo) / (hi - lo).max(1e-6));
        let flattened = if part > 0.0 {
            lerp(part, part * part, 0.75 * self.genes.offset)
        } else {
            part * (1.0 - 0.75 * self.genes.offset)
        };
        let stepped = self.terraces.step(flattened, x, z);
        let r = (x * x + z * z) / (300.0 * 300.0);
        let bump = (1.0 - r.min(1.0)) * (1.0 - r.min(1.0));
        self.sea.sunk(stepped + self.lift * bump, x, z) * self.genes.relief_m
    }

    /// 0 where there is land up to the horizon, 1 where there is open sea.
    pub fn seaward(&self, x: f32, z: f32) -> f32 {
        self.sea.seaward(x, z)
    }

    /// How far the middle lies below a height that is dry by a margin.
    fn needed_lift(&self) -> f32 {
        if self.genes.water_level <= 0.0 {
            return 0.0;
        }
        let samples = 7 * 7;
        let sum: f32 = (0..samples)
            .map(|k| ((k % 7 - 3) as f32 * 24.0, (k / 7 - 3) as f32 * 24.0))
            .map(|(x, z)| self.height_m(x, z, 30.0) / self.genes.relief_m)
            .sum();
        (self.genes.water_level + 0.07 - sum / samples as f32).clamp(0.0, 0.5)
    }
}

/// Greatest amplitude in metres of an octave: landforms may be steep, but not bumps underfoot.
fn walkable_amplitude_m(wavelength_m: f32) -> f32 {
    0.34 * wavelength_m * libm::powf((wavelength_m / 400.0).min(1.0), 0.75)
}

impl Sea {
    /// Metres from the middle over which land turns to sea.
    const COAST_M: [f32; 2] = [-60.0, 620.0];
    /// Height of cliffs from which on the sea is as wide as it gets.
    const WIDE_M: f32 = 9.0;
    /// Part of the relief by which the land sinks.
    const DEPTH: f32 = 0.9;
    /// How deep the sea's bed falls below the lowest land, as a part of what it would.
    const BED: f32 = 0.12;

    fn new(genes: &LandParams) -> Self {
        let turn = noise_seed(genes.terrain_seed.into(), "land", 21) as f32 * (TAU / u32::MAX as f32);
        let part = if genes.water_level > 0.0 { (genes.cliff_m / Self::WIDE_M).min(1.0) } else { 0.0 };
        Self { part, way: [libm::cosf(turn), libm::sinf(turn)] }
    }

    fn seaward(&self, x: f32, z: f32) -> f32 {
        if self.part == 0.0 {
            return 0.0;
        }
        let [from_m, to_m] = Self::COAST_M;
        self.part * smoothstep(from_m, to_m, x * self.way[0] + z * self.way[1])
    }

    /// A height, as a part of the relief.
    fn sunk(&self, part: f32, x: f32, z: f32) -> f32 {
        let seaward = self.seaward(x, z);
        if seaward == 0.0 {
            return part;
        }
        let sunk = part - Self::DEPTH * seaward;
        if sunk < 0.0 { Self::BED * sunk } else { sunk }
    }
}

impl Terraces {
    /// Flat treads and steep risers, bent and broken by noise so that they never follow one contour for long.
    fn step(&self, part: f32, x: f32, z: f32) -> f32 {
        if self.strength <= 0.0 {
            return part;
        }
        let bend = 0.8 * self.bend.at(x, z);
        let strength = self.strength * smoothstep(-0.45, 0.35, self.patches.at(x, z));
        let t = part * self.steps + bend;
        let tread = t.floor();
        let stepped = tread + smoothstep(0.3, 1.0, t - tread);
        (lerp(t, stepped, 0.8 * strength) - bend) / self.steps
    }
}

/// Leaves 0 to 1 as it is and compresses values beyond (outside the field) towards −0.4 and 1.6.
fn soften(part: f32) -> f32 {
    let over = (part - 1.0).max(0.0);
    let under = (-part).max(0.0);
    part.clamp(0.0, 1.0) + 0.6 * over / (over + 0.6) - 0.4 * under / (under + 0.4)
}

/// Metres from a place to the field, 0 inside it.
pub(super) fn distance_to_field_m(x: f32, z: f32) -> f32 {
    let (dx, dz) = ((x.abs() - 0.5 * FIELD_M).max(0.0), (z.abs() - 0.5 * FIELD_M).max(0.0));
    (dx * dx + dz * dz).sqrt()
}
