//! What trees tell of the season → what it does to the colours of what grows on the ground.
//!
//! No gene is the season: trees that are bare, coloured or in blossom show it, and the ground agrees with them.

use serde::{Deserialize, Serialize};

use super::LitterParams;
use super::palette::{Ramp, Rgb};
use crate::math::{lerp, lerp_array};

/// How far the year is from summer; all 0 in summer and among evergreens, and one of them above 0 at other times.
///
/// In whole steps, so that trees that differ by a little leave the ground, and what is kept of it, as it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Season {
    /// 1 where trees are bare.
    pub winter: f32,
    /// 1 where leaves are yellow or red.
    pub autumn: f32,
    /// 1 where trees are in blossom.
    pub spring: f32,
}

/// Steps from summer to another season.
const STEPS: f32 = 8.0;
/// Hues in degrees between which leaves turn from green to yellow.
const TURNING_DEG: [f32; 2] = [75.0, 55.0];
/// Part of a crown's leaves that are flowers in full blossom.
const FULL_BLOSSOM: f32 = 0.25;

/// Grass that sleeps, from where it is moist to where it is dry.
const DORMANT: [Rgb; 2] = [[0.112, 0.098, 0.043], [0.268, 0.214, 0.114]];
/// Young grass.
const FRESH: [Rgb; 2] = [[0.040, 0.092, 0.016], [0.090, 0.140, 0.032]];
/// Bare twigs, and bracken that has turned.
const TWIGS: Rgb = [0.105, 0.078, 0.055];
const BRACKEN: Rgb = [0.140, 0.086, 0.045];

/// How far leaves of a hue have turned: 1 where they are yellow or red, 0 where they are green.
pub(super) fn turned(leaf_hue_deg: f32) -> f32 {
    let [green, yellow] = TURNING_DEG;
    ((green - leaf_hue_deg) / (green - yellow)).clamp(0.0, 1.0)
}

impl Season {
    /// The season that trees of these genes show.
    pub fn of(trees: &LitterParams) -> Self {
        let whole = |part: f32| (part.min(1.0) * STEPS).round() / STEPS;
        if trees.is_dead() {
            return Self::default();
        }
        if trees.is_asleep() {
            return Self { winter: 1.0, ..Self::default() };
        }
        let autumn = whole(turned(trees.leaf_hue_deg));
        Self { winter: 0.0, autumn, spring: whole(trees.blossom / FULL_BLOSSOM) * (1.0 - autumn) }
    }

    /// Colours of growth, from lush to dry; the soil under it has no season.
    pub(super) fn growth(&self, mut ramp: Ramp) -> Ramp {
        let last = ramp.len() - 1;
        for (k, color) in ramp[..last].iter_mut().enumerate() {
            let dry = k as f32 / last as f32;
            let sleeps = 0.8 * self.winter + 0.34 * self.autumn;
            *color = lerp_array(*color, lerp_array(DORMANT[0], DORMANT[1], dry), sleeps);
            *color =
                lerp_array(*color, lerp_array(FRESH[0], FRESH[1], dry), 0.45 * self.spring * (1.0 - dry));
        }
        ramp
    }

    /// Factor on how many flowers there are.
    pub(super) fn bloom(&self) -> f32 {
        (1.0 - self.winter) * lerp(1.0, 0.15, self.autumn)
    }

    /// How deep the winter is, 0 to 1.
    pub(super) fn winter(&self) -> f32 {
        self.winter
    }

    /// Leaves of bushes, which fall, and of those some that stay green.
    pub(super) fn bush(&self, leaf: Rgb) -> Rgb {
        let turned = lerp_array(leaf, BRACKEN, 0.55 * self.autumn);
        lerp_array(turned, TWIGS, 0.8 * self.winter)
    }

    /// Fronds, which turn before they fall.
    pub(super) fn fern(&self, frond: Rgb) -> Rgb {
        lerp_array(frond, BRACKEN, 0.85 * self.winter + 0.6 * self.autumn)
    }
}
