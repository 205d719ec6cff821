//! Traits of a place and noise → how much grass, rock, scree, snow and earth cover it, and its colour as linear
//! reflectance.

use super::GroundParams;
use super::palette::{Palette, Rgb, UMBELS, petals, spires, step};
use super::snow::Snow;
use super::traits::Traits;
use super::woods::{Litter, Offspring, Woods};
use crate::math::lerp_array as lerp;
use crate::model::{Climate, Landform};
use crate::noise::hash01;
use crate::seed::noise_seed;

/// Noise at one texel, about [-1, 1], except `grain`, which is uniform in [-0.5, 0.5].
pub(super) struct Noise {
    /// Features of 2 to 8 texels.
    pub fine: f32,
    /// Features of 8 to 40 texels.
    pub broad: f32,
    /// One value a texel.
    pub grain: f32,
}

impl Noise {
    /// One of sixteen samples that stand for all texels of an area.
    pub fn sample(k: u32) -> Self {
        let even = |salt: i32| hash01(91, k as i32, salt, 0) - 0.5;
        Self { fine: even(1) * 1.2, broad: even(2) * 1.2, grain: 0.0 }
    }
}

/// Grass, rock, scree, snow and earth.
pub(super) const KINDS: usize = 5;

/// Parts of the ground.
#[derive(Default)]
pub(super) struct Cover {
    /// Rock, scree, snow and earth, which sum to 1 with grass.
    parts: [f32; KINDS - 1],
    /// How much of the earth is dry soil or sand, and how much is what trees shed; the rest is the mud of shores and beds.
    soil: f32,
    litter: f32,
}

impl Cover {
    /// The part of each kind, grass first.
    #[inline]
    pub fn parts(&self) -> [f32; KINDS] {
        let [rock, scree, snow, earth] = self.parts;
        [1.0 - rock - scree - snow - earth, rock, scree, snow, earth]
    }

    /// Blend weights as bytes: rock, scree, snow, earth; their sum is at most 255.
    #[inline]
    pub fn bytes(&self) -> [u8; 4] {
        // Rounded down, so that four of them cannot pass 255.
        self.parts.map(|w| (w * 255.0) as u8)
    }

    pub fn soil(&self) -> f32 {
        self.soil
    }

    pub fn litter(&self) -> f32 {
        self.litter
    }

    /// Lays `part` of a kind over the others.
    #[inline]
    fn over(&mut self, kind: usize, part: f32) {
        self.parts = self.parts.map(|other| other * (1.0 - part));
        self.parts[kind] += part;
        self.soil *= 1.0 - part;
        self.litter *= 1.0 - part;
    }
}

const ROCK: usize = 0;
const SCREE: usize = 1;
pub(super) const SNOW: usize = 2;
const EARTH: usize = 3;

/// Part of the ground that is gravel where wind takes the snow away, and with it what shelters plants.
const FELL_FIELD: f32 = 0.85;
const SNOW_WHITE: Rgb = [0.80, 0.83, 0.87];
const WET_MUD: Rgb = [0.062, 0.054, 0.037];
const SAND: Rgb = [0.37, 0.30, 0.20];
const GRAVEL: Rgb = [0.185, 0.176, 0.150];
/// Heath and moss, which grow in patches of their own.
const HEATH: Rgb = [0.086, 0.066, 0.036];
pub(super) const MOSS: Rgb = [0.040, 0.060, 0.014];
/// Rice from the planting to the harvest.
pub(super) const RICE: [Rgb; 5] = [
    [0.058, 0.074, 0.040],
    [0.080, 0.136, 0.032],
    [0.056, 0.104, 0.024],
    [0.122, 0.144, 0.036],
    [0.265, 0.205, 0.058],
];
/// How far rice has come when its field is drained, and the part of a flooded field where none stands.
const FLOODED_TILL: f32 = 0.36;
const FLOODED_MUD: f32 = 0.5;
/// Part of its ground that is mud, between stalks that stand apart: turf does not grow under water.
const UNDER_WATER: f32 = 0.95;
/// From when on rice has ears.
const IN_EAR: f32 = 0.7;
/// Trodden earth along the fields' edges.
const PATH: Rgb = [0.150, 0.125, 0.068];
/// Part of the light from a meadow in full bloom that comes from petals, most of which stand beyond where they are drawn.
const IN_BLOOM: f32 = 0.05;
/// The same of a drift of tall flowers.
const IN_DRIFT: f32 = 0.09;
/// Part of the ground that tussocks hide where they stand densest, seen from far away.
const IN_TUSSOCKS: f32 = 0.45;
/// Dead blades of last year, which tussocks keep.
const STRAW: Rgb = [0.330, 0.270, 0.150];
/// Kinds of rock: granite, limestone, basalt, sandstone, slate.
const ROCKS: [Rgb; 5] = [
    [0.205, 0.195, 0.185],
    [0.290, 0.275, 0.240],
    [0.120, 0.115, 0.112],
    [0.290, 0.205, 0.135],
    [0.150, 0.158, 0.165],
];

/// What all places of a land share.
pub(super) struct Painter {
    pub palette: Palette,
    pub litter: Litter,
    pub offspring: Option<Offspring>,
    pub water_m: f32,
    pub rock: Rgb,
    pub rock_band: Rgb,
    climate: Climate,
    dryness: f32,
    snow: Snow,
    relief_m: f32,
    lowest_m: f32,
    talus: f32,
    /// Tangent of the slope beyond which grass finds no hold.
    bare_slope: f32,
    /// How dry it is beside other lands of its climate: 0 lush, 1 arid.
    thirst: f32,
    /// Whether there are fields.
    pub is_farmed: bool,
    /// How far rice has come, 0 planted, 1 ripe.
    ripe: f32,
    rice_seed: u32,
    /// Most flowers of the land.
    bloom: Rgb,
    /// How many tall flowers there are, and the petals of most of them.
    spires: f32,
    spire: Rgb,
    umbels: f32,
    /// How many tussocks there are, and the colour of their tips.
    tussocks: f32,
    pub tussock: Rgb,
    /// How many boulders lie about that ice or floods have left.
    erratics: f32,
    shore: Rgb,
    /// Shores of low lands are lower: 1 or more.
    shore_scale: f32,
}

impl Painter {
    pub fn new(params: &GroundParams, land: &Landform, woods: &Woods) -> Self {
        let seed = noise_seed(params.terrain_seed.into(), "ground climate", 0);
        let [lo, hi] = land.field.range_m();
        let chance = |salt| hash01(seed, salt, 0, 0);
        let climate = Climate::new(params.temperature_c, params.rain_mm, land);
        let palette = Palette::new(&climate, woods.season);
        // Where snow lies low it is cold and moist.
        let thirst = (chance(1) * 0.95 - 0.35 * (0.8 - params.snow_line).max(0.0)).clamp(0.0, 1.0);
        let kind = (chance(2) * ROCKS.len() as f32) as usize;
        let other = (kind + 1 + (chance(3) * 4.0) as usize) % ROCKS.len();
        let [rock, other] = [kind.min(ROCKS.len() - 1), other].map(|kind| palette.rock(ROCKS[kind]));
        let talus = libm::tanf(params.talus_angle_deg.to_radians());
        let wet = 1.0 - palette.thirst;
        let mild = wet * wet * (1.0 - 0.6 * palette.frost) * (1.0 - 0.5 * palette.rain);
        let tall = palette.season.bloom() * mild;
        // Where grass has the land to itself: it is too dry or too cold for other plants to cover it.
        let poor = (3.0 * palette.thirst * (1.0 - 0.65 * palette.thirst)).max(0.9 * palette.frost).min(1.0);
        let many = 0.5 + 0.5 * step(0.1, 0.6, chance(8));
        let tussocks = (0.3 + 0.7 * poor) * (1.0 - 0.7 * palette.rain) * many;
        let shore = lerp(lerp(WET_MUD, GRAVEL, 0.5), SAND, step(0.25, 0.6, thirst));
        Self {
            litter: woods.litter,
            offspring: woods.offspring,
            dryness: climate.dryness(),
            snow: Snow::new(land),
            water_m: land.water_level_m.unwrap_or(lo - 1e4),
            relief_m: (hi - lo).max(1.0),
            lowest_m: lo,
            talus,
            bare_slope: 0.42 + 0.5 * talus,
            thirst,
            is_farmed: land.paddies.is_some(),
            ripe: 0.05 + 0.75 * chance(5),
            rice_seed: seed,
            rock,
            rock_band: lerp(rock, other, 0.3),
            shore_scale: (80.0 / (hi - lo).max(1.0)).clamp(1.6, 3.2),
            shore: palette.shore(shore),
            bloom: petals(params.terrain_seed)[0],
            spires: tall * step(0.15, 0.7, chance(6)),
            spire: spires(params.terrain_seed)[0],
            umbels: tall * step(0.2, 0.8, chance(7)),
            tussocks,
            tussock: lerp(palette.growth[2], STRAW, 0.35 + 0.4 * poor),
            erratics: (0.5 + 0.5 * palette.frost) * step(0.4, 0.8, chance(9)),
            climate,
            palette,
        }
    }

    /// What covers a place.
    #[inline]
    pub fn cover(&self, t: &Traits, n: &Noise) -> Cover {
        if rice(t) > 0.5 {
            // Young rice stands apart in mud.
            let mut field = Cover::default();
            field.over(EARTH, UNDER_WATER * self.flooded(t));
            return field;
        }
        let broken = 0.55 * n.broad + 0.35 * n.fine;
        // Grass holds on to about 37°, less on crests and outcrops, more where soil has gathered.
        let bare = t.slope + 0.10 * broken + 0.09 * t.outcrop - 0.10 * t.hollow - 0.06 * t.deposit;
        // Turf ends at an edge, and a ragged one: where both were mixed over many metres, rock was like fog on the grass.
        let rock =
            step(self.bare_slope + 0.06, self.bare_slope + 0.12, bare + 0.04 * n.fine + 0.06 * n.grain);
        let loose = t.deposit + 0.22 * broken + 0.1 * t.outcrop;
        let scree = if loose < 0.46 {
            0.0
        } else {
            step(0.46, 0.62, loose) * step(0.52, 0.74, (t.slope + 0.10 * broken) * 0.62 / self.talus.max(0.3))
        };
        let above_water = t.height_m - self.water_m;
        let wetness = (above_water - 0.3 * self.thirst) * self.shore_scale - 0.5 * broken - 0.3 * t.tuft;
        let shore = if wetness > 0.75 { 0.0 } else { 1.0 - step(0.35, 0.75, wetness) };
        let wash = t.flow + 0.05 * broken;
        let bed = if wash < 0.84 { 0.0 } else { step(0.84, 0.92, wash) * (1.0 - step(0.25, 0.6, t.slope)) };
        let mud = shore.max(bed);
        // Each lies over the ones before it.
        let mut cover = self.bare(t, broken);
        let litter = self.shed(t, n);
        cover.over(EARTH, litter);
        cover.litter += litter;
        cover.over(EARTH, mud);
        cover.over(SCREE, scree);
        cover.over(ROCK, rock);
        let [snow, blown] = self.snow.parts(t, broken);
        cover.over(SCREE, FELL_FIELD * blown);
        cover.over(SNOW, snow);
        cover
    }

    /// Soil and stones where water or warmth is too short for growth to close.
    #[inline]
    fn bare(&self, t: &Traits, broken: f32) -> Cover {
        let Palette { thirst, frost, heat, .. } = self.palette;
        if thirst + frost == 0.0 {
            return Cover::default();
        }
        let patchy = 0.35 * t.patch + 0.45 * t.tuft + 0.5 * broken;
        let parched = step(1.1, 2.4, self.dryness + 0.4 * t.sunny + patchy - 1.8 * self.damp(t)) * thirst;
        // Less where snow and rain leave more than a desert's share of water.
        let chill = -4.0 - self.climate.at_c(t.height_m) - 2.0 * t.sunny + 1.5 * self.dryness;
        let frozen = step(0.0, 1.0, 0.12 * chill + 0.5 * patchy + 0.3 * t.slope - 0.1) * frost;
        let bare = 0.97 * (1.0 - (1.0 - parched) * (1.0 - frozen));
        // Frost heaves stones up, wind blows sand away from them; dunes bury them.
        let stones =
            step(0.0, 0.8, t.outcrop + 0.4 * t.patch + 0.6 * broken + 0.5 * frost - 0.5 * heat + 0.2);
        let (scree, soil) = (bare * stones, bare * (1.0 - stones));
        Cover { parts: [0.0, scree, 0.0, soil], soil, litter: 0.0 }
    }

    /// What lies under crowns and a little beyond them.
    #[inline]
    fn shed(&self, t: &Traits, n: &Noise) -> f32 {
        if t.shade == 0.0 {
            return 0.0;
        }
        self.litter.amount * step(0.1, 1.2, t.shade + 0.45 * n.fine + 0.35 * n.broad + 0.2 * t.tuft)
    }

    /// How densely flowers stand in the grass, 0 to 1: in drifts, in the sun, where it is neither dry nor cold.
    #[inline]
    pub fn bloom(&self, t: &Traits, n: &Noise) -> f32 {
        let Palette { thirst, frost, .. } = self.palette;
        let drift = step(-0.5, 0.5, in_patches(t, n));
        self.palette.season.bloom()
            * drift
            * (1.0 - 0.75 * thirst)
            * (1.0 - 0.35 * frost)
            * (1.0 - step(0.1, 0.6, t.shade))
    }

    /// How densely flowers on tall spikes stand, 0 to 1: in drifts of their own, at the edge of woods, too; some lands have many
    /// and some have none.
    #[inline]
    pub fn spires(&self, t: &Traits, n: &Noise) -> f32 {
        let drift = step(0.15, 0.6, 0.75 * n.broad + 0.45 * n.fine + 0.3 * t.tuft);
        self.spires * drift * (1.0 - step(0.5, 0.9, t.shade))
    }

    /// How densely flowers in flat heads on tall stalks stand, 0 to 1: where it is neither dry nor dark, and spikes don't.
    #[inline]
    pub fn umbels(&self, t: &Traits, n: &Noise) -> f32 {
        let drift = step(0.12, 0.75, 0.45 * n.fine - 0.75 * n.broad + 0.6 * self.damp(t));
        self.umbels * drift * (1.0 - step(0.3, 0.8, t.shade))
    }

    /// How densely tussocks stand, 0 to 1: in patches, in the sun.
    #[inline]
    pub fn tussocks(&self, t: &Traits, n: &Noise) -> f32 {
        let patch = step(-0.5, 0.4, 0.55 * n.broad + 0.4 * n.fine + 0.35 * t.tuft - 0.2 * t.patch);
        self.tussocks * patch * (1.0 - step(0.2, 0.7, t.shade))
    }

    /// How densely boulders lie that no cliff has dropped, 0 to 1: in groups.
    #[inline]
    pub fn erratics(&self, t: &Traits, n: &Noise) -> f32 {
        self.erratics * step(0.0, 0.6, 0.5 * t.tuft + 0.4 * t.outcrop + 0.45 * n.broad)
    }

    /// Where heath grows, 0 to 1.
    #[inline]
    pub fn heath(&self, t: &Traits, n: &Noise) -> f32 {
        let Palette { thirst, heat, .. } = self.palette;
        step(0.45, 0.85, t.outcrop - 0.5 * t.patch + 0.3 * n.broad) * (1.0 - thirst.max(heat))
    }

    /// How much more water a place has than the land around: above 0 in hollows, by streams and shores.
    #[inline]
    pub fn damp(&self, t: &Traits) -> f32 {
        let by_water = 1.0 - step(0.4, 5.0, t.height_m - self.water_m);
        0.75 * t.flow + 0.35 * t.hollow + 0.12 * t.deposit - 0.25 + 0.5 * by_water
    }

    /// Its colour.
    #[inline]
    pub fn color(&self, t: &Traits, cover: &Cover, n: &Noise) -> Rgb {
        let rice = rice(t);
        if rice > 0.5 {
            return lerp(self.crop(rice, t, n), WET_MUD, FLOODED_MUD * self.flooded(t));
        }
        let [grass, rock, scree, snow, earth] = cover.parts();
        let mut color = [0.0; 3];
        if grass > 0.0 {
            add(&mut color, self.grass(t, n), grass);
        }
        if rock + scree > 0.0 {
            // Beds of another stone, tilted and bent, and stains that run down.
            let bed = (t.height_m * 0.11 + 1.9 * t.outcrop + 0.8 * t.tuft + 0.8 * n.broad) * 0.5;
            let bed = (bed - bed.floor() - 0.5).abs() * 2.0;
            let stone = lerp(self.rock, self.rock_band, step(0.3, 0.7, bed));
            let stone = scale(stone, 1.0 + 0.22 * n.broad + 0.20 * n.fine + 0.25 * n.grain);
            let stone = lerp(stone, MOSS, 0.75 * self.moss(t, n));
            add(&mut color, stone, rock);
            add(&mut color, scale(lerp(stone, GRAVEL, 0.35), 1.12 + 0.35 * n.grain), scree);
        }
        let wet = earth - cover.soil - cover.litter;
        if wet > 0.0 {
            add(&mut color, self.mud(t, n), wet);
        }
        if cover.litter > 0.0 {
            // Fresh leaves over older ones, in drifts.
            let fresh = step(-0.5, 0.7, 0.6 * n.fine + 0.5 * n.broad + 0.5 * n.grain);
            let leaves = lerp(scale(self.litter.colors[0], 0.62), self.litter.colors[0], fresh);
            let leaves = lerp(leaves, MOSS, 0.5 * self.moss(t, n));
            add(&mut color, scale(leaves, 1.0 + 0.3 * n.grain), cover.litter);
        }
        if cover.soil > 0.0 {
            add(&mut color, self.soil(t, n), cover.soil);
        }
        if snow > 0.0 {
            add(&mut color, scale(SNOW_WHITE, self.snow.tone(t) + 0.03 * n.broad + 0.05 * n.grain), snow);
        }
        color.map(|c| if c > 0.0 { c } else { 0.0 })
    }

    /// Where moss grows on stone and under trees, 0 to 1: in lands with rain, where it stays wet and the sun is weak.
    #[inline]
    fn moss(&self, t: &Traits, n: &Noise) -> f32 {
        let Palette { thirst, rain, .. } = self.palette;
        let wet = 0.7 * rain + 0.8 * self.damp(t) + 0.5 * t.shade - 0.5 * t.sunny - 2.0 * thirst;
        step(0.15, 0.75, wet + 0.45 * n.broad + 0.25 * n.fine)
    }

    /// Grass: lusher where water gathers, drier on crests and high up, in large patches of its own.
    #[inline]
    pub fn grass(&self, t: &Traits, n: &Noise) -> Rgb {
        let rice = rice(t);
        if rice > 0.5 {
            return self.crop(rice, t, n);
        }
        let altitude = (t.height_m - self.lowest_m) / self.relief_m;
        let moist = 0.75 * t.flow + 0.35 * t.hollow + 0.12 * t.deposit;
        let dry = 0.6 + 1.9 * self.thirst + 1.2 * t.patch + 1.25 * t.tuft + 0.5 * altitude
            - 1.5 * (moist - 0.25)
            + 0.35 * t.slope
            + 0.55 * n.broad
            + 0.34 * n.fine
            + 0.25 * n.grain;
        // The sun dries what lacks water, and warms what lacks warmth.
        let Palette { growth, thirst, frost, .. } = &self.palette;
        let dry = (dry + t.sunny * (0.9 * thirst - 0.5 * frost)).clamp(0.0, 4.999);
        let k = dry as usize;
        let grass = lerp(growth[k], growth[k + 1], dry - k as f32);
        let grass = lerp(lerp(grass, HEATH, 0.6 * self.heath(t, n)), self.bloom, IN_BLOOM * self.bloom(t, n));
        let grass = lerp(grass, self.spire, IN_DRIFT * self.spires(t, n));
        let grass = lerp(grass, UMBELS[0], IN_DRIFT * self.umbels(t, n));
        let grass = lerp(grass, self.tussock, IN_TUSSOCKS * self.tussocks(t, n));
        scale(grass, 1.0 + 0.16 * n.fine + 0.10 * n.broad + 0.18 * n.grain)
    }

    /// How far the rice of a field has come: neighbours plant and cut it at other times. A field has one height; wide ones are
    /// several people's.
    #[inline]
    fn ripe(&self, t: &Traits) -> f32 {
        let plot = [libm::roundf(2.5 * t.height_m), (2.2 * t.tuft).floor()].map(|part| part as i32);
        self.ripe + 0.45 * (hash01(self.rice_seed, plot[0], plot[1], 1) - 0.5)
    }

    /// How much of a place is under the water of a field with young rice, 0 to 1.
    #[inline]
    pub fn flooded(&self, t: &Traits) -> f32 {
        let rice = rice(t);
        if rice <= 0.5 || self.ripe(t) > FLOODED_TILL {
            return 0.0;
        }
        // Where terraces are narrower than samples of the land are apart, water would stand on a slope.
        step(0.7, 0.8, rice) * (1.0 - step(0.07, 0.11, t.slope))
    }

    /// How densely rice stands in leaf and in ear, of which a field has one: young rice stands apart.
    #[inline]
    pub fn stands_of_rice(&self, t: &Traits, n: &Noise) -> [f32; 2] {
        let part = rice(t);
        if part <= 0.5 {
            return [0.0; 2];
        }
        let ripe = self.ripe(t);
        let density = planted(part, n) * step(0.0, FLOODED_TILL, ripe + 0.2);
        if ripe > IN_EAR { [0.0, density] } else { [density, 0.0] }
    }

    /// The colour of a place so much of which is rice. Paths lead along fields.
    #[inline]
    fn crop(&self, part: f32, t: &Traits, n: &Noise) -> Rgb {
        let ripe = (self.ripe(t) + 0.06 * n.broad).clamp(0.0, 0.999) * (RICE.len() - 1) as f32;
        let rice = lerp(RICE[ripe as usize], RICE[ripe as usize + 1], ripe.fract());
        scale(lerp(PATH, rice, planted(part, n)), 1.0 + 0.1 * n.fine + 0.15 * n.grain)
    }

    /// Bare earth or sand, paler on crests.
    #[inline]
    fn soil(&self, t: &Traits, n: &Noise) -> Rgb {
        let [.., below, bare] = self.palette.growth;
        let pale = (0.75 + 0.25 * t.patch - 0.3 * t.hollow + 0.12 * n.broad).clamp(0.0, 1.2);
        scale(lerp(below, bare, pale), 1.0 + 0.04 * n.fine + 0.08 * n.grain)
    }

    /// Shores and beds: wet and dark at the water, paler above and in deeper water.
    #[inline]
    fn mud(&self, t: &Traits, n: &Noise) -> Rgb {
        let above = t.height_m - self.water_m;
        let wet = 1.0 - step(0.05, 0.55, above + 0.15 * n.broad);
        let dry_shore = lerp(self.shore, GRAVEL, step(0.3, 0.9, n.broad + 0.5 * t.tuft) * 0.6);
        let mud = lerp(dry_shore, lerp(self.shore, WET_MUD, 0.6), wet.min(1.0));
        let mud = lerp(mud, lerp(WET_MUD, self.shore, 0.35), step(0.5, 4.0, -above));
        scale(mud, 1.0 + 0.12 * n.fine + 0.22 * n.grain)
    }
}

/// Part of a place on which rice grows: fields, and not the banks between them.
#[inline]
fn rice(t: &Traits) -> f32 {
    if t.farmed == 0.0 { 0.0 } else { t.farmed * (1.0 - step(0.16, 0.34, t.slope)) }
}

/// About [-1, 1] in patches of several sizes, by which plants gather.
#[inline]
pub(super) fn in_patches(t: &Traits, n: &Noise) -> f32 {
    0.6 * t.tuft + 0.4 * t.patch + 0.4 * n.broad
}

/// The share of a place so much of which is a field that is not a path along it.
#[inline]
fn planted(part: f32, n: &Noise) -> f32 {
    step(0.62, 0.82, part + 0.05 * n.fine)
}

#[inline]
fn scale(a: Rgb, s: f32) -> Rgb {
    [a[0] * s, a[1] * s, a[2] * s]
}

#[inline]
fn add(sum: &mut Rgb, a: Rgb, weight: f32) {
    for k in 0..3 {
        sum[k] += a[k] * weight;
    }
}
