//! Genes → the density of cumulus and stratus clouds in space: a shape given as an approximate signed depth in metres
//! (flat base, domed tops, from a tiling cover map), displaced by billows. Metres; x east, z south, y above the
//! clouds' base. The density of a cloud's inside is 1.

use super::SkyParams;
use super::billow::{BILLOWS, Billows};
use super::math::{bilinear, range};
use crate::math::{lerp, smoothstep};
use crate::noise;
use crate::raster::square;
use crate::seed::noise_seed;

const MAP: usize = 128;
/// Clouds along one side of the cover map.
const CELLS: i32 = 8;

/// A field of clouds around the eye.
pub struct CloudField {
    /// Height of the flat base in metres.
    pub base_m: f32,
    /// Greatest height of a top above the base.
    pub height_m: f32,
    /// Size of the largest billows.
    pub billow_m: f32,
    /// Metres after which the cover map repeats.
    pub tile_m: f32,
    /// How much the sky is closed by a deck rather than by single clouds, [0, 1].
    pub deck: f32,
    scale_m: f32,
    /// Texels of the cover map a metre.
    texels_per_m: f32,
    cover: f32,
    threshold: f32,
    macro_weight: f32,
    fine_factor: f32,
    offset: [f32; 2],
    map: Vec<f32>,
    billows: &'static Billows,
}

/// A place in the field.
#[derive(Clone, Copy)]
pub struct Shape {
    /// Depth inside the undisplaced cloud in metres, negative outside.
    pub depth_m: f32,
    /// Height of the top above the base here.
    pub top_m: f32,
}

impl CloudField {
    /// The field of these genes, or `None` when the sky is clear. A second, turned copy of the map hides
    /// that it repeats.
    pub fn new(params: &SkyParams) -> Option<Self> {
        let cover = params.cloud_cover.clamp(0.0, 1.0);
        if cover < 0.01 {
            return None;
        }
        let scale_m = params.cloud_scale_m.max(100.0);
        // A tower stands no higher than a few times its width.
        let height_m = params.cloud_thickness_m.clamp(60.0, 60.0 + 1.9 * scale_m);
        let seed = noise_seed(u64::from(params.sky_seed), "sky.clouds", 0);
        let mut field = Self {
            base_m: params.cloud_base_m,
            height_m,
            billow_m: (0.42 * scale_m.min(1.2 * height_m)).clamp(40.0, 650.0),
            tile_m: scale_m * CELLS as f32,
            texels_per_m: MAP as f32 / (scale_m * CELLS as f32),
            deck: smoothstep(0.7, 1.0, cover),
            scale_m,
            cover,
            threshold: 0.0,
            macro_weight: 0.3,
            fine_factor: 3.37,
            offset: [0, 1].map(|i| noise::hash01(seed, i, 7, 7) * scale_m * CELLS as f32),
            map: cover_map(seed),
            billows: &BILLOWS,
        };
        field.set_threshold();
        Some(field)
    }

    /// The field without the turned copy and with billows that fit: it repeats exactly after `tile_m`.
    pub fn into_tiling(mut self) -> Self {
        self.macro_weight = 0.0;
        self.billow_m = self.tile_m / (4.0 * (0.25 * self.tile_m / self.billow_m).ceil());
        self.fine_factor = 3.0;
        self.set_threshold();
        self
    }

    fn set_threshold(&mut self) {
        self.threshold = self.quantile(1.0 - self.cover) - 0.35 * self.deck;
    }

    /// The value that a given share of the map lies below.
    fn quantile(&self, share: f32) -> f32 {
        let mut values: Vec<f32> = (0..4096)
            .map(|i| {
                let (i, span) = (i as f32, self.tile_m * 11.0);
                self.cover_at((i * 0.754_877_7).fract() * span, (i * 0.569_840_3).fract() * span)
            })
            .collect();
        values.sort_unstable_by(f32::total_cmp);
        values[(share.clamp(0.0, 1.0) * 4095.0) as usize]
    }

    #[inline]
    fn cover_at(&self, x: f32, z: f32) -> f32 {
        let [u, v] = [x + self.offset[0], z + self.offset[1]].map(|m| m * self.texels_per_m);
        let map = |u: f32, v: f32| bilinear(&self.map, MAP, u, v);
        let fine = map(u, v);
        if self.macro_weight == 0.0 {
            return fine;
        }
        // Turned by 37° and 3.7 times as large: fields of clouds with gaps between.
        let (s, c) = (0.601_815 / 3.7, 0.798_636 / 3.7);
        fine + self.macro_weight * (map(u * c - v * s + 31.0, u * s + v * c + 77.0) - 0.5)
    }

    /// The undisplaced cloud at a point.
    #[inline]
    pub fn shape(&self, x: f32, y: f32, z: f32) -> Shape {
        let cover = self.cover_at(x, z);
        let edge = (cover - self.threshold) * 0.55 * self.scale_m;
        let (mut top_m, mut base_m) = (0.0, 0.0);
        if edge > 0.0 {
            let u = (edge / (0.3 * self.scale_m)).min(1.0);
            top_m = self.height_m * (u * (2.0 - u)).sqrt();
        }
        if self.deck > 0.0 {
            // A deck has lumps and thin places instead of gaps.
            let lump = smoothstep(0.1, 0.85, cover);
            top_m = top_m.min(self.height_m * lerp(1.0, 0.3 + 0.7 * lump, self.deck));
            base_m = self.deck * 0.22 * self.height_m * (1.0 - lump);
        }
        let depth_m = edge.min(y - base_m).min(top_m - y);
        Shape { depth_m, top_m }
    }

    /// How far billows reach out of the undisplaced cloud, at most.
    #[inline]
    pub fn reach_m(&self) -> f32 {
        0.5 * self.billow_m
    }

    /// Density in [0, 1] at a point with a known shape; `soft_m` widens the edge, for the far distance.
    #[inline]
    pub fn density(&self, shape: Shape, x: f32, y: f32, z: f32, soft_m: f32, fine: bool) -> f32 {
        let reach = self.reach_m();
        let ramp = 0.16 * self.billow_m + soft_m;
        if shape.depth_m < -reach {
            return 0.0;
        }
        if shape.depth_m > reach + ramp {
            return 1.0;
        }
        let k = 0.25 / self.billow_m;
        let coarse = self.billows.sample(x * k, y * k, z * k);
        // The base stays nearly flat.
        let rough = 2.0 * reach * (0.3 + 0.7 * smoothstep(0.0, 0.5 * self.billow_m, y));
        let min = shape.depth_m + rough * (coarse * 0.74 - 0.56);
        let mut small = coarse;
        if fine {
            // Small billows matter only where they decide.
            if min >= ramp || min + 0.26 * rough <= 0.0 {
                return if min >= ramp { 1.0 } else { 0.0 };
            }
            let f = k * self.fine_factor;
            small = self.billows.sample(z * f + 0.3, x * f, y * f + 0.7);
        }
        ((min + rough * 0.26 * small) / ramp).clamp(0.0, 1.0)
    }

    /// Density without billows, for shadows, where only the mean counts.
    #[inline]
    pub fn smooth_density(&self, shape: Shape) -> f32 {
        ((shape.depth_m + 0.1 * self.billow_m) / (0.5 * self.billow_m)).clamp(0.0, 1.0)
    }
}

/// How much cloud there is over each place, about [0, 1]: round cells of many sizes.
fn cover_map(seed: u32) -> Vec<f32> {
    let map = square(MAP, |i, j| {
        let (x, z) = (i as f32 * CELLS as f32 / MAP as f32, j as f32 * CELLS as f32 / MAP as f32);
        let bend = noise::gradient2(seed ^ 0x77, x * 2.0, z * 2.0, CELLS * 2) * 0.16;
        let (near, _, _) = noise::cellular2(seed, x + bend, z - bend, CELLS);
        let (small, _, _) = noise::cellular2(seed ^ 0x1234, x * 2.0 - bend, z * 2.0 + bend, CELLS * 2);
        let broad = noise::gradient2(seed ^ 0xABCD, x * 0.5, z * 0.5, CELLS / 2);
        let mid = noise::gradient2(seed ^ 0xBEEF, x * 1.5, z * 1.5, CELLS * 3 / 2);
        let cells = 0.62 * (1.0 - near) + 0.2 * (1.0 - small);
        cells + 0.22 * broad + 0.14 * mid
    });
    let (low, high) = range(&map);
    map.iter().map(|v| (v - low) / (high - low)).collect()
}
