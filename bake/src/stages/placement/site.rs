//! Landform and genes → how well trees grow at a point, from 0 (not at all) to 1.
//!
//! Each limit has a soft edge, so that forests thin out rather than end at a line; at the limit itself the weight is
//! exactly 0, so no tree ever stands beyond it.

use crate::math::{lerp, smoothstep};
use crate::model::{Climate, Landform, SnowMap};
use crate::noise::gradient2;
use crate::seed::noise_seed;

use super::{EDGE_MARGIN_M, PlacementParams};

/// Height in metres that trees keep above the lake.
pub(super) const WATER_MARGIN_M: f32 = 0.3;
/// Drained area, as `Landform::flow` scales it, above which a bed is too wet, and from which trees get fewer.
pub(super) const MAX_FLOW: f32 = 0.9;
const EDGE_FLOW: f32 = 0.75;
/// Degrees of slope over which trees get fewer towards the limit.
const SLOPE_EDGE_DEG: f32 = 6.0;
/// Part of the relief over which trees get fewer and smaller towards the lowest tree line.
const TREE_LINE_EDGE: f32 = 0.2;
/// Metres: the size of groves, and of the bays in their edges.
const GROVE_M: f32 = 130.0;
const BAY_M: f32 = 47.0;
/// Degrees below their hardiness at which trees are thinnest and smallest, and what is left of density and size there.
const CHILL_C: f32 = 8.0;
const CHILLED: f32 = 0.08;
const STUNTED: f32 = 0.5;
/// Mean temperature that ground under snow counts as, if it is not colder.
const SNOW_C: f32 = -2.0;
/// Snow cover from which a place counts as under snow.
const SNOWY: f32 = 0.3;
/// Density far from water in a desert, as a part of that by a stream.
const PARCHED: f32 = 0.05;
/// Density on farmed land, as a part of that beside it.
const FARMED: f32 = 0.03;
/// Drained area beyond the field, where it is not known.
const FLOW_BEYOND: f32 = 0.3;
/// Density of single trees in a clearing, as a part of that in a grove.
const SOLITARY: f32 = 0.012;

/// A point where trees grow.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    /// Density there, as a part of the greatest anywhere.
    pub weight: f32,
    /// How large they grow: less at the tree line and at the edge of a grove.
    pub vigour: f32,
}

/// What trees find at a point.
struct Soil {
    /// Tangent.
    slope: f32,
    /// As in [`Landform::flow`].
    flow: f32,
    /// As in [`Landform::paddies`].
    farmed: f32,
    is_snowy: bool,
}

/// The land as trees see it.
pub(super) struct Site<'a> {
    pub land: &'a Landform,
    /// Metres from the middle to where trees end, along x and z.
    pub half_m: f32,
    clustering: f32,
    slopes: [f32; 2],
    /// Altitudes where trees begin to get fewer and where they end, in metres.
    tree_line_m: [f32; 2],
    /// Altitude where trees begin by the water.
    pub shore_m: f32,
    climate: Climate,
    hardiness_c: f32,
    snow: Option<&'a SnowMap>,
    /// How much trees keep to water: 0 where there is rain enough, 1 in a desert.
    thirst: f32,
    seed: u32,
}

impl<'a> Site<'a> {
    pub fn new(params: &PlacementParams, land: &'a Landform, snow: Option<&'a SnowMap>) -> Self {
        let climate = Climate::new(params.temperature_c, params.rain_mm, land);
        let [low, high] = land.field.range_m();
        let shore_m = land.water_level_m.map_or(f32::NEG_INFINITY, |level| level + WATER_MARGIN_M);
        // Of the relief above water: under a deep lake, a low tree line would leave no land at all.
        let base = low.max(shore_m).min(high);
        let limit = params.altitude_limit.clamp(0.0, 1.0);
        let altitude = |part: f32| base + part * (high - base);
        let tan = |degrees: f32| libm::tanf(degrees.clamp(0.0, 80.0).to_radians());
        let slope = params.steepest_slope_deg;
        let thinning = altitude(limit - TREE_LINE_EDGE * (1.0 - limit));
        let tree_line_m = if limit < 1.0 { [thinning, altitude(limit)] } else { [f32::MAX; 2] };
        Self {
            land,
            half_m: 0.5 * land.field.extent_m() - EDGE_MARGIN_M,
            clustering: params.clustering.clamp(0.0, 1.0),
            slopes: [tan(slope - SLOPE_EDGE_DEG), tan(slope)],
            tree_line_m,
            shore_m,
            thirst: smoothstep(0.4, 2.6, climate.dryness()),
            climate,
            hardiness_c: params.hardiness_c,
            snow,
            seed: noise_seed(u64::from(params.tree_seed), "placement/groves", 0),
        }
    }

    /// How trees grow at (x, z); `None` where they don't.
    pub fn at(&self, x_m: f32, z_m: f32) -> Option<Spot> {
        if x_m.abs().max(z_m.abs()) > self.half_m {
            return None;
        }
        let y_m = self.land.field.height_m(x_m, z_m);
        self.grows([x_m, y_m, z_m], || Soil {
            slope: self.slope(x_m, z_m),
            flow: self.flow(x_m, z_m),
            farmed: self.land.farmed(self.sample(x_m, z_m)),
            is_snowy: self.snow.is_some_and(|snow| snow.at(x_m, z_m) > SNOWY),
        })
    }

    /// The same on the land beyond the field, where it is so high and so steep (as a tangent).
    pub fn beyond(&self, place_m: [f32; 3], slope: f32) -> Option<Spot> {
        let is_snowy = place_m[1] > self.land.snow_line_m;
        self.grows(place_m, || Soil { slope, flow: FLOW_BEYOND, farmed: 0.0, is_snowy })
    }

    fn grows(&self, [x_m, y, z_m]: [f32; 3], soil: impl Fn() -> Soil) -> Option<Spot> {
        if y < self.shore_m || y >= self.tree_line_m[1] {
            return None;
        }
        let Soil { slope, flow, farmed, is_snowy } = soil();
        let gentle = 1.0 - smoothstep(self.slopes[0], self.slopes[1], slope);
        let dry = 1.0 - smoothstep(EDGE_FLOW, MAX_FLOW, flow);
        let mild = 1.0 - smoothstep(self.tree_line_m[0], self.tree_line_m[1], y);
        let limits = gentle * dry * mild;
        if limits <= 0.0 {
            return None;
        }
        let cold = self.cold(y, is_snowy)?;
        let limits = limits * lerp(1.0, CHILLED, cold) * self.watered(y, flow) * lerp(1.0, FARMED, farmed);
        let grove = self.grove(x_m, z_m);
        let weight = limits * (1.0 - self.clustering * (1.0 - SOLITARY) * (1.0 - grove));
        let sheltered = 1.0 - 0.3 * self.clustering * (1.0 - grove);
        Some(Spot { weight, vigour: sheltered * (0.5 + 0.5 * mild) * lerp(1.0, STUNTED, cold) })
    }

    /// 0 where it is as warm as these trees need, 1 where it is far too cold; `None` on snow that they do not bear.
    fn cold(&self, y_m: f32, is_snowy: bool) -> Option<f32> {
        let air_c = self.climate.at_c(y_m);
        if is_snowy && self.hardiness_c > air_c.min(SNOW_C) {
            return None;
        }
        Some(smoothstep(self.hardiness_c, self.hardiness_c - CHILL_C, air_c))
    }

    /// Part of the density that water allows: where rain is short, trees stand by streams and shores.
    fn watered(&self, y_m: f32, flow: f32) -> f32 {
        if self.thirst == 0.0 {
            return 1.0;
        }
        let damp = smoothstep(0.3, 0.65, flow).max(1.0 - smoothstep(1.0, 6.0, y_m - self.shore_m));
        lerp(1.0, lerp(PARCHED, 1.0, damp), self.thirst)
    }

    /// Tangent of the slope, over the two metres around the point.
    pub fn slope(&self, x_m: f32, z_m: f32) -> f32 {
        let field = &self.land.field;
        let step = field.spacing_m.clamp(0.5, 2.0);
        let dx = field.height_m(x_m + step, z_m) - field.height_m(x_m - step, z_m);
        let dz = field.height_m(x_m, z_m + step) - field.height_m(x_m, z_m - step);
        (dx * dx + dz * dz).sqrt() / (2.0 * step)
    }

    /// The greatest flow of the four samples around the point: beds are narrow.
    pub fn flow(&self, x_m: f32, z_m: f32) -> f32 {
        let at = self.sample(x_m, z_m);
        let flow = |k: usize| self.land.flow.get(k).copied().unwrap_or(0.0);
        let below = at + self.land.field.side as usize;
        flow(at).max(flow(at + 1)).max(flow(below)).max(flow(below + 1))
    }

    /// Number of the sample north-west of a point.
    fn sample(&self, x_m: f32, z_m: f32) -> usize {
        let field = &self.land.field;
        let last = (field.side - 1) as f32;
        let cell = |m: f32| ((m / field.spacing_m + 0.5 * last).clamp(0.0, last) as u32).min(field.side - 2);
        (cell(z_m) * field.side + cell(x_m)) as usize
    }

    /// 1 inside a grove, 0 in a clearing.
    fn grove(&self, x_m: f32, z_m: f32) -> f32 {
        let large = gradient2(self.seed, x_m / GROVE_M, z_m / GROVE_M, 0);
        let small = gradient2(self.seed.wrapping_add(1), x_m / BAY_M, z_m / BAY_M, 0);
        smoothstep(-0.02, 0.16, large + 0.35 * small)
    }
}
