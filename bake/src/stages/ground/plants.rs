//! Traits of places and what covers them → how densely small plants and stones stand, and the kinds that grow in a land.

use glam::Vec2;

use super::GroundParams;
use super::cover::{Cover, MOSS, Noise, Painter, RICE, SNOW, in_patches};
use super::grain::Grain;
use super::palette::Palette;
use super::palette::{Rgb, UMBELS, petals, spires, step};
use super::shapes;
use super::stones;
use super::traits::{Traits, TraitsMap};
use super::woody::{self, Foliage};
use crate::math::lerp_array as lerp;
use crate::model::{GroundPlants, Image8, Landform, Lookout, PlantKind, PlantShape};
use crate::raster::square_image;

/// Channels of the maps, four in each.
const FLOWER: usize = 0;
const FERN: usize = 1;
const SHRUB: usize = 2;
const REED: usize = 3;
const STONE: usize = 4;
const BOULDER: usize = 5;
const LITTER: usize = 6;
const TUSSOCK: usize = 7;
const BUSH: usize = 8;
const SAPLING: usize = 9;
const LOG: usize = 10;
const STUMP: usize = 11;
const SPIRE: usize = 12;
const UMBEL: usize = 13;
const HAY: usize = 14;
const HERB: usize = 15;
const CHANNELS: usize = 16;
/// Of a map.
const IN_MAP: usize = 4;

/// Those that stand in no water.
const ON_LAND: [usize; 13] =
    [FLOWER, FERN, SHRUB, TUSSOCK, LITTER, BUSH, SAPLING, LOG, STUMP, SPIRE, UMBEL, HAY, HERB];

/// Those that cannot stand in each other; the first of them stay where they are.
pub(super) const SOLID: [usize; 3] = [BOULDER, STUMP, LOG];

/// Those that are as large as their trees make them.
const OF_TREES: [usize; 3] = [SAPLING, LOG, STUMP];

/// Those that are of rock, or as rough and cracked as it, as old wood is; and the number of rock among the ground's textures.
const ROUGH: [usize; 4] = [STONE, BOULDER, LOG, STUMP];
const ROCK_TEXTURE: u32 = 1;

/// How a kind stands, see [`PlantKind`].
struct Habit {
    name: &'static str,
    per_m2: f32,
    scale: [f32; 2],
    reach_m: f32,
    sway: f32,
}

const HABITS: [Habit; CHANNELS] = [
    Habit { name: "flower", per_m2: 3.0, scale: [0.7, 1.4], reach_m: 24.0, sway: 0.25 },
    Habit { name: "fern", per_m2: 0.9, scale: [0.6, 1.5], reach_m: 36.0, sway: 0.06 },
    Habit { name: "shrub", per_m2: 0.6, scale: [0.5, 1.6], reach_m: 70.0, sway: 0.03 },
    Habit { name: "reed", per_m2: 2.2, scale: [0.6, 1.2], reach_m: 50.0, sway: 0.12 },
    Habit { name: "stone", per_m2: 1.6, scale: [0.05, 0.30], reach_m: 22.0, sway: 0.0 },
    Habit { name: "boulder", per_m2: 0.03, scale: [0.5, 2.6], reach_m: 160.0, sway: 0.0 },
    Habit { name: "litter", per_m2: 3.0, scale: [0.8, 1.2], reach_m: 11.0, sway: 0.0 },
    Habit { name: "tussock", per_m2: 1.4, scale: [0.45, 1.5], reach_m: 60.0, sway: 0.15 },
    Habit { name: "bush", per_m2: 0.09, scale: [0.6, 1.9], reach_m: 120.0, sway: 0.03 },
    Habit { name: "sapling", per_m2: 0.07, scale: [0.3, 1.0], reach_m: 90.0, sway: 0.04 },
    Habit { name: "log", per_m2: 0.008, scale: [0.6, 1.3], reach_m: 90.0, sway: 0.0 },
    Habit { name: "stump", per_m2: 0.006, scale: [0.6, 1.2], reach_m: 70.0, sway: 0.0 },
    Habit { name: "spire", per_m2: 2.0, scale: [0.5, 1.15], reach_m: 56.0, sway: 0.08 },
    Habit { name: "umbel", per_m2: 1.1, scale: [0.6, 1.3], reach_m: 50.0, sway: 0.10 },
    Habit { name: "hay", per_m2: 1.6, scale: [0.6, 1.3], reach_m: 44.0, sway: 0.14 },
    Habit { name: "herb", per_m2: 0.9, scale: [0.45, 1.1], reach_m: 40.0, sway: 0.05 },
];

/// Where there are fields, which are warm and wet, rice grows in them instead of these, which like it dry: in leaf and in ear.
const RICE_IN_LEAF: usize = TUSSOCK;
const RICE_IN_EAR: usize = HAY;

const RICE_HABITS: [(usize, Habit); 2] = [
    (RICE_IN_LEAF, Habit { name: "rice", per_m2: 6.0, scale: [0.65, 1.0], reach_m: 32.0, sway: 0.16 }),
    (RICE_IN_EAR, Habit { name: "ripe rice", per_m2: 6.0, scale: [0.8, 1.1], reach_m: 32.0, sway: 0.12 }),
];

/// Metres uphill of a place where a cliff may stand from which stones fell.
const FALL_M: [f32; 2] = [8.0, 26.0];

/// The maps, of half as many pixels a side as the painter's, and the kinds that they have anywhere.
pub(super) fn plants(
    params: &GroundParams,
    painter: &Painter,
    traits: &TraitsMap,
    grain: &Grain,
    land: &Landform,
    weights: &Image8,
) -> GroundPlants<Image8> {
    let side = (weights.width / 2).max(1) as usize;
    let place = |k: usize| (k as f32 + 0.5) / side as f32;
    let is_snowy = weights.data.chunks_exact(usize::from(weights.channels)).any(is_snow);
    let mut all = square_image::<CHANNELS, _>(side, |j| {
        let (row, place) = (traits.row(place(j)), &place);
        move |i| {
            let (here, noise) = (row.at(place(i)), grain.at(2 * i, 2 * j));
            let at = [place(i), place(j)].map(|part| (part - 0.5) * land.field.extent_m());
            let cover = painter.cover(&here, &noise);
            let grass = cover.parts()[0].min(grass_around(weights, [2 * i as u32, 2 * j as u32]));
            let mut growth = painter.growth(&here, &cover, grass, &noise, &|| below_a_cliff(land, at));
            let is_under_snow = is_snowy && reaches_snow(weights, [2 * i, 2 * j]);
            if is_under_snow || reaches_water(land, at, land.field.extent_m() / side as f32) {
                ON_LAND.into_iter().for_each(|kind| growth[kind] = 0.0);
            }
            growth.map(byte)
        }
    });
    clear_lookouts(&mut all, land.field.extent_m());
    let map = |number: usize| {
        let channels = IN_MAP * number..IN_MAP * (number + 1);
        let pixels = all.data.chunks_exact(CHANNELS);
        let data = pixels.flat_map(|pixel| &pixel[channels.clone()]).copied().collect();
        Image8 { channels: IN_MAP as u8, data, ..all }
    };
    let grows =
        |kind: &PlantKind| all.data.iter().skip(kind.channel as usize).step_by(CHANNELS).any(|&d| d > 0);
    let kinds = kinds(params, painter).into_iter().filter(grows).collect();
    GroundPlants { maps: (0..CHANNELS / IN_MAP).map(map).collect(), kinds }
}

/// All kinds, whether they grow in a land or not.
#[cfg(test)]
pub(super) fn all_kinds(params: &GroundParams, land: &Landform) -> Vec<PlantKind> {
    kinds(params, &Painter::new(params, land, &super::Woods::none(super::Season::default())))
}

/// Those that would hide a landscape from who stands before them.
const HIGH: [usize; 5] = [BOULDER, BUSH, SAPLING, LOG, STUMP];

/// None of them stands in the clearing around a lookout.
fn clear_lookouts(all: &mut Image8, extent_m: f32) {
    let pixel_m = extent_m / all.width as f32;
    // What is read between pixels is 0 where all four around are.
    let reach = Lookout::CLEARING_M / pixel_m + 1.0;
    for place in Lookout::places_m(extent_m) {
        let middle = place / pixel_m + 0.5 * all.width as f32;
        let lines =
            |at: f32| ((at - reach).max(0.0) as usize)..((at + reach + 1.0) as usize).min(all.width as usize);
        for j in lines(middle.y) {
            for i in lines(middle.x) {
                if Vec2::new(i as f32 + 0.5, j as f32 + 0.5).distance(middle) < reach {
                    let pixel = &mut all.data[CHANNELS * (j * all.width as usize + i)..][..CHANNELS];
                    HIGH.into_iter().for_each(|kind| pixel[kind] = 0);
                }
            }
        }
    }
}

fn byte(density: f32) -> u8 {
    (255.0 * density.clamp(0.0, 1.0) + 0.5) as u8
}

/// How much of four texels is grass: between two grassy places may lie a crag.
fn grass_around(weights: &Image8, [i, j]: [u32; 2]) -> f32 {
    let last = weights.width - 1;
    let other = |[x, y]: [u32; 2]| {
        let pixel = weights.pixel((i + x).min(last), (j + y).min(last));
        pixel.iter().map(|&part| u32::from(part)).sum::<u32>()
    };
    1.0 - [[0, 0], [1, 0], [0, 1], [1, 1]].map(other).iter().sum::<u32>() as f32 / (4.0 * 255.0)
}

/// Whether snow is most of a texel of the weights.
fn is_snow(weights: &[u8]) -> bool {
    weights[SNOW] > 127
}

/// Whether there is snow on any texel that lies in a pixel of the maps, of twice as many texels a side, or beside it: density is
/// read between pixels, and flowers stood in the snow.
fn reaches_snow(weights: &Image8, [i, j]: [usize; 2]) -> bool {
    let near = |at: usize| at.saturating_sub(2)..(at + 4).min(weights.width as usize);
    near(j).any(|y| near(i).any(|x| is_snow(weights.pixel(x as u32, y as u32))))
}

/// Whether there is water within so many metres of a place: density is read between pixels.
fn reaches_water(land: &Landform, [x, z]: [f32; 2], around_m: f32) -> bool {
    let Some(water_m) = land.water_level_m else { return false };
    let ways = [-1.0, 0.0, 1.0].map(|way| way * around_m);
    land.field.height_m(x, z) < water_m + 4.0 * around_m
        && ways.iter().any(|dx| ways.iter().any(|dz| land.field.height_m(x + dx, z + dz) < water_m))
}

/// 1 where the land rises to a cliff close uphill, 0 where it doesn't.
fn below_a_cliff(land: &Landform, [x, z]: [f32; 2]) -> f32 {
    let height = |x: f32, z: f32| land.field.height_m(x, z);
    let (dx, dz) = (height(x + 3.0, z) - height(x - 3.0, z), height(x, z + 3.0) - height(x, z - 3.0));
    let rise = (dx * dx + dz * dz).sqrt();
    if rise < 0.3 {
        return 0.0;
    }
    let uphill = |m: f32| height(x + dx / rise * m, z + dz / rise * m);
    let [near, far] = FALL_M;
    step(0.7, 1.05, (uphill(far) - uphill(near)) / (far - near))
}

impl Painter {
    /// How densely each channel's kind stands at a place, in [0, 1].
    fn growth(
        &self,
        t: &Traits,
        cover: &Cover,
        grass: f32,
        n: &Noise,
        cliff: &dyn Fn() -> f32,
    ) -> [f32; CHANNELS] {
        let [_, rock, scree, snow, _] = cover.parts();
        let above_m = t.height_m - self.water_m;
        let mut growth = [0.0; CHANNELS];
        if above_m < -0.5 {
            return growth;
        }
        let palette = &self.palette;
        let (damp, green) = (self.damp(t), step(0.3, 0.8, grass) * step(0.25, 0.6, above_m));
        let patch = in_patches(t, n);
        let (cold, dry) = (palette.frost, palette.thirst);
        growth[FLOWER] = green * self.bloom(t, n);
        growth[SPIRE] = green * self.spires(t, n);
        growth[UMBEL] = green * self.umbels(t, n);
        // Dead stalks stand through the winter.
        growth[HAY] = green
            * (1.0 - cold)
            * (1.0 - step(0.75, 1.0, dry))
            * (1.0 - step(0.1, 0.6, t.shade))
            * step(0.0, 0.9, 0.7 * n.fine + 0.5 * n.broad + 0.4 * t.patch + 0.8 * dry - 0.3 * palette.rain);
        let moist = (damp + 0.25 + 0.5 * palette.rain) * (1.0 - 2.0 * dry).max(0.0) * (1.0 - cold);
        // In the open they stand in rainforests alone.
        let shady = step(0.05, 0.45, t.shade).max(palette.rain * step(0.5, 1.0, palette.rain + damp - 0.3));
        growth[FERN] = (green + 0.6 * cover.litter()).min(1.0)
            * shady
            * step(0.2, 0.6, moist + 0.4 * n.broad - 0.3 * t.patch);
        growth[HERB] = green
            * (1.0 - palette.season.winter())
            * (1.0 - step(0.1, 0.5, dry))
            * (1.0 - step(0.3, 0.8, cold))
            * step(0.1, 0.7, 0.8 * moist + 0.5 * n.fine - 0.4 * n.broad - 0.2 * t.tuft + 0.3 * t.shade - 0.1);
        let heath = self.heath(t, n) * (1.0 - t.shade);
        let bushes = step(0.0, 0.8, 0.5 * t.patch - 0.4 * t.tuft + 0.5 * n.broad + 0.5 * damp);
        // Scrub belongs to where it is too dry or too cold for trees to close.
        let scrub = (dry * (1.0 - 0.7 * dry) * 2.4 + 0.7 * cold * (1.0 - 0.5 * cold)).min(1.0) * bushes;
        growth[SHRUB] = (green * heath.max(scrub)).max(0.25 * scrub * cover.soil());
        // On soil, too, but for deserts.
        let open = green.max(0.5 * cover.soil() * (1.0 - step(0.7, 1.0, dry)));
        growth[TUSSOCK] = open * self.tussocks(t, n).max(0.25 * heath);
        let shore = step(-0.45, -0.15, above_m) * (1.0 - step(0.15, 0.45, above_m));
        growth[REED] = shore
            * step(0.0, 0.5, patch + 0.15)
            * (1.0 - step(0.15, 0.4, t.slope))
            * (1.0 - step(0.5, 1.0, cold));
        let bare_stones = 0.9 * scree + 0.25 * rock + 0.12 * cover.soil() + 0.06 * t.deposit * green;
        let gravel = shore * step(-0.2, 0.4, -patch) * 0.7;
        let fallen = if t.slope > 0.08 && above_m > 0.2 { cliff() } else { 0.0 };
        // Snow covers what is low.
        let free = 1.0 - step(0.0, 0.2, snow);
        growth[STONE] = free * (bare_stones + gravel + 0.6 * fallen * (1.0 - rock)).min(1.0);
        // What is large rolls down what is steep.
        growth[BOULDER] = (1.0 - 0.85 * snow)
            * (1.0 - step(0.6, 0.95, t.slope))
            * (fallen * (1.0 - rock)
                + 0.35 * scree * step(0.2, 0.8, n.fine)
                + green * (0.03 * step(0.5, 0.9, t.outcrop)).max(0.5 * self.erratics(t, n)))
            .min(1.0);
        growth[LITTER] = cover.litter() * (0.35 + 0.65 * t.shade);
        self.wood(t, n, green, cover, &mut growth);
        let dry_land = step(0.15, 0.4, above_m) * free;
        ON_LAND.into_iter().for_each(|kind| growth[kind] *= dry_land);
        let weeded = 1.0 - t.farmed;
        growth.iter_mut().for_each(|density| *density *= weeded);
        if self.is_farmed {
            [growth[RICE_IN_LEAF], growth[RICE_IN_EAR]] = self.stands_of_rice(t, n);
        }
        growth
    }
}

impl Painter {
    /// What has wood: bushes by the woods and by water and scattered over open land, young trees and dead ones where old
    /// ones stand.
    fn wood(&self, t: &Traits, n: &Noise, green: f32, cover: &Cover, growth: &mut [f32; CHANNELS]) {
        let palette = &self.palette;
        let (cold, dry) = (palette.frost, palette.thirst);
        let holds = 1.0 - step(0.5, 0.85, t.slope);
        let soft = (green + 0.7 * cover.litter()).min(1.0) * holds;
        let fringe = step(0.0, 0.2, t.shade) * (1.0 - step(0.5, 0.9, t.shade));
        let thicket = 0.5 * t.patch - 0.5 * t.tuft + 0.6 * n.broad;
        let by_water = step(0.0, 0.5, self.damp(t)) * (1.0 - 0.6 * dry);
        let scattered = (0.16 + 0.5 * dry * (1.0 - dry)) * step(0.25, 0.8, thicket);
        let bushes = (0.6 * fringe + 0.35 * by_water) * step(-0.2, 0.6, thicket) + scattered;
        growth[BUSH] = soft * bushes * (1.0 - 0.85 * cold) * (1.0 - step(0.75, 1.0, dry));
        growth[SAPLING] = 0.8 * soft * fringe * step(-0.3, 0.5, 0.7 * n.broad - 0.4 * t.tuft);
        let dead = soft * step(0.05, 0.4, t.shade) * (0.4 + 0.6 * step(-0.2, 0.4, n.broad));
        growth[LOG] = 0.7 * dead;
        growth[STUMP] = dead;
        if self.offspring.is_none() {
            [SAPLING, LOG, STUMP].into_iter().for_each(|kind| growth[kind] = 0.0);
        }
    }
}

/// The kinds that may grow in a land, in the order of their channels.
fn kinds(params: &GroundParams, painter: &Painter) -> Vec<PlantKind> {
    let palette = &painter.palette;
    let growth = palette.growth;
    let stone = |tone: f32| [0.75, 1.15].map(|shade| painter.rock.map(|c| c * tone * shade));
    let stone_colors = vec![stone(1.0), stone(0.85), [painter.rock_band.map(|c| 0.8 * c), painter.rock_band]];
    let litter = painter.litter;
    // In the order of the channels.
    let mut looks: [(PlantShape, Vec<[Rgb; 2]>); CHANNELS] = [
        (shapes::flower(), flowers(params.terrain_seed, growth[1])),
        (shapes::fern(), ferns(palette)),
        (shapes::shrub(), shrubs(palette)),
        (shapes::reed(), reeds()),
        (stones::stone(), stone_colors),
        (stones::boulder(), boulders(painter)),
        (
            shapes::litter(litter.leaf_m, litter.wide),
            vec![litter.colors, litter.colors.map(|c| c.map(|c| 0.7 * c))],
        ),
        (shapes::tussock(), tussocks(painter)),
        (woody::bush(), bushes(palette)),
        (woody::sapling(painter.offspring.map_or(Foliage::Bare, |young| young.foliage)), saplings(painter)),
        (woody::log(), logs(palette)),
        (woody::stump(), logs(palette).into_iter().map(|[bark, _]| [bark, HEARTWOOD]).collect()),
        (shapes::spire(), spires(params.terrain_seed).map(|petals| [growth[1], petals]).into()),
        (shapes::umbel(), UMBELS.map(|petals| [growth[1], petals]).into()),
        (shapes::hay(), hay(palette)),
        (shapes::herb(), herbs(palette)),
    ];
    let mut habits = HABITS;
    if painter.is_farmed {
        RICE_HABITS.into_iter().for_each(|(channel, habit)| habits[channel] = habit);
        looks[RICE_IN_LEAF] = (shapes::rice(false), rice(&[RICE[1], RICE[2], RICE[2]]));
        looks[RICE_IN_EAR] = (shapes::rice(true), rice(&[RICE[3], RICE[4], RICE[4]]));
    }
    let young = painter.offspring;
    let kind = |(channel, (habit, (shape, colors))): (u32, (Habit, _))| {
        let Habit { name, per_m2, mut scale, reach_m, sway } = habit;
        if OF_TREES.contains(&(channel as usize)) {
            scale = scale.map(|factor| factor * young.map_or(1.0, |young| young.size));
        }
        let texture = ROUGH.contains(&(channel as usize)).then_some(ROCK_TEXTURE);
        PlantKind { name: name.into(), channel, per_m2, scale, reach_m, sway, texture, colors, shape }
    };
    (0..).zip(habits.into_iter().zip(looks)).map(kind).collect()
}

/// Bark of young and of fallen trees, wood that the sun has faded, and wood inside.
const BARK: Rgb = [0.105, 0.085, 0.066];
const DRIFTWOOD: Rgb = [0.185, 0.168, 0.145];
const HEARTWOOD: Rgb = [0.240, 0.175, 0.100];
/// Ears of grass.
const RIPE: Rgb = [0.300, 0.235, 0.125];

/// Three greens of the climate.
fn bushes(palette: &Palette) -> Vec<[Rgb; 2]> {
    let mild = lerp([0.115, 0.180, 0.044], [0.140, 0.150, 0.052], palette.frost);
    let leaf = lerp(lerp(mild, [0.075, 0.170, 0.030], palette.heat), [0.180, 0.182, 0.105], palette.thirst);
    let leaf = palette.season.bush(leaf);
    let of = |factor: Rgb| {
        let tip = [0, 1, 2].map(|k| leaf[k] * factor[k]);
        [tip.map(|c| 0.4 * c), tip]
    };
    vec![of([1.0, 1.0, 1.0]), of([1.25, 1.12, 1.0]), of([0.78, 0.86, 1.05])]
}

fn saplings(painter: &Painter) -> Vec<[Rgb; 2]> {
    let leaf = painter.offspring.map_or(BARK, |young| young.leaf);
    [0.8, 1.0, 1.2].map(|light| [BARK, leaf.map(|c| light * c)]).into()
}

/// Under moss where it rains, faded where it doesn't.
fn logs(palette: &Palette) -> Vec<[Rgb; 2]> {
    let top = lerp(DRIFTWOOD, MOSS, step(0.0, 1.0, 0.35 + palette.rain - palette.thirst));
    vec![[BARK, top], [BARK.map(|c| 1.3 * c), lerp(DRIFTWOOD, top, 0.4)]]
}

/// Flowers of a land, most of them of one kind, and the green of their stalks.
fn flowers(terrain_seed: u32, stalk: Rgb) -> Vec<[Rgb; 2]> {
    petals(terrain_seed).map(|petals| [stalk, petals]).into()
}

/// Meadow grass in seed.
fn hay(palette: &Palette) -> Vec<[Rgb; 2]> {
    let growth = palette.growth;
    [RIPE, lerp(RIPE, growth[3], 0.5)].map(|head| [lerp(growth[2], growth[3], 0.5), head]).into()
}

/// Dark between the stalks.
fn rice(leaves: &[Rgb]) -> Vec<[Rgb; 2]> {
    leaves.iter().map(|leaf| [leaf.map(|c| 0.5 * c), leaf.map(|c| 1.1 * c)]).collect()
}

/// Rock, in rainy lands under moss.
fn boulders(painter: &Painter) -> Vec<[Rgb; 2]> {
    let top = |rock: Rgb, more: f32| {
        let moss = (0.5 * painter.palette.rain + more - painter.palette.thirst).clamp(0.0, 0.7);
        lerp(rock.map(|c| 1.15 * c), MOSS, moss)
    };
    [(painter.rock, 0.0), (painter.rock, 0.25), (painter.rock_band, 0.1)]
        .map(|(rock, more)| [rock.map(|c| 0.42 * c), top(rock, more)])
        .into()
}

/// Green at the root, and at the tips as pale as the land's are, or half so.
fn tussocks(painter: &Painter) -> Vec<[Rgb; 2]> {
    let (growth, tip) = (painter.palette.growth, painter.tussock);
    let root = growth[1].map(|c| 0.55 * c);
    vec![[root, tip], [growth[2].map(|c| 0.55 * c), lerp(growth[2], tip, 0.5)], [root, tip.map(|c| 1.2 * c)]]
}

/// Broad leaves in the green of lush grass.
fn herbs(palette: &Palette) -> Vec<[Rgb; 2]> {
    let leaf = lerp(palette.growth[1], [0.075, 0.120, 0.032], 0.3);
    [1.0, 1.3].map(|light| [leaf.map(|c| 0.7 * light * c), leaf.map(|c| 1.2 * light * c)]).into()
}

fn ferns(palette: &Palette) -> Vec<[Rgb; 2]> {
    let lush = palette.season.fern(palette.growth[1]);
    let tip = |other: Rgb| lerp(lush, palette.season.fern(other), 0.6);
    vec![
        [lush.map(|c| 0.6 * c), tip([0.055, 0.095, 0.020])],
        [lush.map(|c| 0.75 * c), tip([0.085, 0.105, 0.030])],
    ]
}

/// Heather; crimson and gold of the tundra; grey scrub of dry lands; evergreens of hot ones.
fn shrubs(palette: &Palette) -> Vec<[Rgb; 2]> {
    let tips = |heather: Rgb, cold: Rgb, dry: Rgb, hot: Rgb| {
        let tip = lerp(lerp(heather, cold, palette.frost), hot, palette.heat);
        lerp(tip, dry, (1.6 * palette.thirst).min(1.0))
    };
    let leaves = lerp([0.050, 0.050, 0.024], [0.110, 0.110, 0.070], palette.thirst);
    vec![
        [leaves, tips([0.165, 0.080, 0.115], [0.26, 0.07, 0.03], [0.20, 0.21, 0.14], [0.06, 0.14, 0.02])],
        [leaves, tips([0.120, 0.085, 0.065], [0.27, 0.16, 0.03], [0.24, 0.20, 0.11], [0.10, 0.16, 0.03])],
    ]
}

fn reeds() -> Vec<[Rgb; 2]> {
    vec![[[0.06, 0.085, 0.025], [0.095, 0.055, 0.030]], [[0.10, 0.10, 0.04], [0.125, 0.080, 0.046]]]
}
