//! Landform → what one sees of the ground as a whole, in a few numbers, without its maps.

use super::cover::{KINDS, Noise, Painter};
use super::traits::{self, Patches};
use super::{GroundParams, Season, Woods};
use crate::model::Landform;

/// Places a side that are looked at.
const SIDE: usize = 24;

/// The ground where it is dry.
#[derive(Clone, Debug, PartialEq)]
pub struct Glimpse {
    /// Parts of it that are grass, rock, scree, snow and earth; they sum to 1.
    pub cover: [f32; KINDS],
    /// The colour of each place, linear RGB.
    pub colors_linear: Vec<[f32; 3]>,
}

/// Looks at places all over the field in summer, but for those under water.
pub fn glimpse(params: &GroundParams, land: &Landform) -> Glimpse {
    let painter = Painter::new(params, land, &Woods::none(Season::default()));
    let patches = Patches::new(params.terrain_seed, land.field.extent_m(), 0.0..=1.0);
    let place = |k: usize| (k as f32 + 0.5) / SIDE as f32;
    let look = |k: usize| {
        let (i, j) = (k % SIDE, k / SIDE);
        let here = traits::near(&patches, land, place(i), place(j));
        let is_dry = land.water_level_m.is_none_or(|water_m| here.height_m > water_m);
        let noise = Noise::sample((i * 7 + j * 3) as u32 % 16);
        let cover = painter.cover(&here, &noise);
        is_dry.then(|| (cover.parts(), painter.color(&here, &cover, &noise)))
    };
    let looks: Vec<_> = (0..SIDE * SIDE).filter_map(look).collect();
    let count = looks.len().max(1) as f32;
    let cover = std::array::from_fn(|kind| looks.iter().map(|(parts, _)| parts[kind]).sum::<f32>() / count);
    Glimpse { cover, colors_linear: looks.into_iter().map(|(_, color)| color).collect() }
}
