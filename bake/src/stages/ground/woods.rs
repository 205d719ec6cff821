//! Trees and their genes → what they do to the ground under them: shade, and what they shed.

use serde::{Deserialize, Serialize};

use super::Season;
use super::palette::Rgb;
use super::season::turned;
use super::woody::Foliage;
use crate::math::{lerp_array, ramp};
use crate::model::{Instance, Landform, is_dead, leaf_color};

/// The genes of trees that the ground shows; names, ranges and meanings as in the parameter space.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LitterParams {
    pub height_m: f32,
    pub leaves_per_stem: u32,
    pub secondary_branches: u32,
    pub leaf_shape: u32,
    pub leaf_size_m: f32,
    pub leaf_hue_deg: f32,
    pub blossom: f32,
}

impl LitterParams {
    /// Trees without leaves in the winter; they stand on last autumn's.
    pub(super) fn is_asleep(&self) -> bool {
        self.leaves_per_stem == 0 && !self.is_dead()
    }

    /// In which season dead trees stand is not to be seen.
    pub(super) fn is_dead(&self) -> bool {
        is_dead(self.leaves_per_stem, self.secondary_branches)
    }
}

const NEEDLES: u32 = 6;
const FRONDS: u32 = 7;

const BROWN: Rgb = [0.085, 0.062, 0.038];
const RUSSET: Rgb = [0.084, 0.058, 0.036];
const STRAW: Rgb = [0.190, 0.145, 0.085];
const PETAL: Rgb = [0.640, 0.480, 0.500];
/// Fallen leaves by the hue in degrees that they had on their tree; on the ground they soon dry.
const AUTUMN: [(f32, Rgb); 3] =
    [(20.0, [0.200, 0.062, 0.030]), (35.0, [0.245, 0.112, 0.038]), (55.0, [0.280, 0.200, 0.062])];

/// What a kind of tree sheds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Litter {
    /// Part of the ground under a crown that it covers.
    pub amount: f32,
    /// Of the carpet, and of leaves that lie on it.
    pub colors: [Rgb; 2],
    /// Length of a leaf, and its width as a part of it.
    pub leaf_m: f32,
    pub wide: f32,
}

/// What comes up under a kind of tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Offspring {
    pub foliage: Foliage,
    /// Of leaves in the light.
    pub leaf: Rgb,
    /// Factor on the size of young trees and dead ones: 1 under trees of middling height.
    pub size: f32,
}

/// Part of a leaf's albedo that a spray of leaves has, which shade each other.
const SPRAY: f32 = 0.8;

impl Offspring {
    fn new(params: &LitterParams) -> Self {
        let foliage = match params.leaf_shape {
            _ if params.is_asleep() => Foliage::Bare,
            NEEDLES => Foliage::Needles,
            FRONDS => Foliage::Fronds,
            _ => Foliage::Leaves,
        };
        let size = (params.height_m / 14.0).clamp(0.3, 1.3);
        Self { foliage, leaf: (SPRAY * leaf_color(params.leaf_hue_deg)).to_array(), size }
    }
}

impl Litter {
    fn new(params: &LitterParams) -> Self {
        let hue = params.leaf_hue_deg;
        let autumn = turned(hue);
        let above = AUTUMN.iter().position(|stop| stop.0 >= hue).unwrap_or(2).max(1);
        let ((low, a), (high, b)) = (AUTUMN[above - 1], AUTUMN[above]);
        let bright = lerp_array(a, b, ramp(low, high, hue));
        let broad = |amount: f32, colors: [Rgb; 2]| Self {
            amount,
            colors,
            leaf_m: params.leaf_size_m.clamp(0.04, 0.1),
            wide: 0.62,
        };
        match params.leaf_shape {
            _ if params.is_asleep() => broad(0.8, [BROWN, STRAW]),
            _ if params.is_dead() => broad(0.25, [BROWN, RUSSET]),
            NEEDLES => Self { leaf_m: 0.07, wide: 0.086, ..broad(0.85, [RUSSET, BROWN]) },
            FRONDS => Self { leaf_m: 0.2, wide: 0.12, ..broad(0.25, [STRAW, BROWN]) },
            _ => {
                let amount = 0.4 + 0.5 * autumn;
                let carpet = lerp_array(BROWN, bright, 0.45 * autumn);
                let leaves = lerp_array(STRAW, bright, autumn);
                broad(amount, [carpet, lerp_array(leaves, PETAL, (4.0 * params.blossom).min(1.0))])
            }
        }
    }
}

/// The most samples a side for which traits are kept.
const MAX_SIDE: u32 = 513;

/// Steps of the field's samples between those for which traits are kept.
pub(super) fn stride(land: &Landform) -> u32 {
    ((land.field.side - 1) / (MAX_SIDE - 1)).max(1)
}

/// What trees do to the ground.
pub struct Woods {
    pub(super) litter: Litter,
    /// None without trees.
    pub(super) offspring: Option<Offspring>,
    pub(super) season: Season,
    /// Of each tree x, z and the radius of its trunk, in metres.
    pub(super) stems_m: Vec<[f32; 3]>,
    /// Samples a side; 0 if there are no trees.
    side: usize,
    /// How much lies under crowns, 0 to 1, row by row.
    shade: Vec<f32>,
}

impl Woods {
    /// Land without trees.
    pub fn none(season: Season) -> Self {
        Self {
            litter: Litter::default(),
            offspring: None,
            season,
            stems_m: Vec::new(),
            side: 0,
            shade: Vec::new(),
        }
    }

    /// The woods of a land; `crowns_m` gives the radius of each template's crown at scale 1.
    pub fn new(params: &LitterParams, land: &Landform, trees: &[Instance], crowns_m: &[f32]) -> Self {
        let step = stride(land);
        let side = ((land.field.side - 1) / step + 1) as usize;
        let spacing_m = land.field.spacing_m * step as f32;
        let mut shade = vec![0.0f32; side * side];
        for tree in trees {
            let column = tree.world_from_tree.map(|row| row[0]);
            let scale = column.iter().map(|c| c * c).sum::<f32>().sqrt();
            let crown_m = crowns_m.get(tree.template as usize).copied().unwrap_or(0.0) * scale;
            let [x, z, _] = tree.trunk_cylinder_m;
            lay(
                &mut shade,
                side,
                [x, z].map(|m| m / spacing_m + 0.5 * (side - 1) as f32),
                crown_m / spacing_m,
            );
        }
        let (litter, offspring) = (Litter::new(params), Some(Offspring::new(params)));
        let stems_m = trees.iter().map(|tree| tree.trunk_cylinder_m).collect();
        Self { litter, offspring, season: Season::of(params), stems_m, side, shade }
    }

    /// Shade at a sample of the traits' grid.
    #[inline]
    pub(super) fn shade(&self, i: usize, j: usize) -> f32 {
        if self.side == 0 { 0.0 } else { self.shade[j * self.side + i] }
    }
}

/// Lays the shade of one crown, in samples: full over its inner half, none where its outermost leaves hang.
fn lay(shade: &mut [f32], side: usize, middle: [f32; 2], radius: f32) {
    let reach = 1.15 * radius + 0.5;
    let span = |m: f32| {
        let last = side as i32 - 1;
        (((m - reach) as i32).clamp(0, last) as usize)..=(((m + reach) as i32).clamp(0, last) as usize)
    };
    for j in span(middle[1]) {
        for i in span(middle[0]) {
            let (x, z) = (i as f32 - middle[0], j as f32 - middle[1]);
            let away = (x * x + z * z).sqrt() / reach;
            let here = (2.0 - 2.0 * away).clamp(0.0, 1.0);
            let sample = &mut shade[j * side + i];
            *sample = sample.max(here);
        }
    }
}
