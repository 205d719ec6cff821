//! The snow line and the traits of a place → how much snow lies there.

use super::Season;
use super::palette::step;
use super::traits::{Patches, Traits, TraitsMap};
use super::woods::Woods;
use crate::model::{Landform, SnowMap};
use crate::raster::raster;

/// Samples a side of a [`SnowMap`]: one in four metres.
const SIDE: usize = 257;
/// Noise of single texels is unknown to a map: wherever they might be white, it says so.
const BROKEN: f32 = 0.9;

/// Where snow may lie on the field; `None` if it lies nowhere.
pub fn snow_map(terrain_seed: u32, land: &Landform) -> Option<SnowMap> {
    let highest = land.field.range_m()[1];
    let snow = Snow::new(land);
    // As far below its line as snow lies in any hollow.
    if land.snow_line_m > highest + 6.0 * snow.spread_m {
        return None;
    }
    let extent_m = land.field.extent_m();
    let traits = TraitsMap::new(
        &Patches::new(terrain_seed, extent_m, 0.0..=1.0),
        land,
        &Woods::none(Season::default()),
        0.0..=1.0,
    );
    let place = |k: usize| k as f32 / (SIDE - 1) as f32;
    let parts = raster(SIDE, SIDE, |j| {
        let (row, snow) = (traits.row(place(j)), &snow);
        move |i| snow.parts(&row.at(place(i)), BROKEN)[0]
    });
    Some(SnowMap { side: SIDE, extent_m, parts })
}

/// Where snow begins, and where it hides all that is under it, as parts of the height over which its line strays. A patch that
/// melts is thin at its edge alone: on level land a wider one looked like fog on the grass.
const EDGE: [f32; 2] = [0.02, 0.13];

/// [`Traits::lee`] of usual land: drifts take as much snow from elsewhere as they add.
const MEAN_LEE: f32 = 0.15;

pub(super) struct Snow {
    line_m: f32,
    spread_m: f32,
    water_m: f32,
}

impl Snow {
    pub fn new(land: &Landform) -> Self {
        let [low, high] = land.field.range_m();
        Self {
            line_m: land.snow_line_m,
            spread_m: 0.05 * (high - low).max(1.0) + 2.0,
            water_m: land.water_level_m.unwrap_or(low - 1e4),
        }
    }

    /// How much of a place is under snow, and from how much the wind has blown it off. Snow fills hollows and drifts below its
    /// line, slides off what is steep above it, and is held up by crowns. `broken` is noise of about [-1, 1].
    #[inline]
    pub fn parts(&self, t: &Traits, broken: f32) -> [f32; 2] {
        let wander = 1.1 * t.patch + 0.8 * t.tuft + 0.9 * broken + 1.2 * t.hollow + 1.4 * (t.lee - MEAN_LEE)
            - 1.0 * (t.slope - 0.6)
            - 0.9 * t.shade;
        let depth = (t.height_m - self.line_m) / self.spread_m + wander;
        if depth <= EDGE[0] {
            return [0.0; 2];
        }
        let high = ((t.height_m - self.line_m) / (6.0 * self.spread_m)).clamp(0.0, 1.0);
        // Higher up, snow clings to steeper rock.
        let holds = 0.95 + 0.5 * high + 0.16 * broken + 0.15 * t.hollow + 0.2 * t.lee.max(0.0);
        let fallen = step(EDGE[0], EDGE[1], depth)
            * (1.0 - step(holds, holds + 0.16, t.slope))
            * step(0.0, 0.4, t.height_m - self.water_m);
        let blown = step(0.0, 0.18, self.blown(t) - 0.24 * broken);
        [fallen * (1.0 - blown), fallen * blown]
    }

    /// How far wind bares a place, above 0 on crests and on slopes that face it, in patches.
    fn blown(&self, t: &Traits) -> f32 {
        -1.3 * t.lee - 0.6 * t.hollow + 0.3 * t.tuft - 0.32
    }

    /// A factor on its colour: crust that the wind has polished is greyer than a fresh drift.
    #[inline]
    pub fn tone(&self, t: &Traits) -> f32 {
        0.94 + 0.08 * step(-0.25, 0.25, t.lee + 0.4 * t.hollow + 0.2 * t.tuft)
    }
}
