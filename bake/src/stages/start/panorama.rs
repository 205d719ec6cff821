//! Land, water, trees, and a place → what can be seen around it: a coarse picture of depths, by one ray a column that
//! marches over the heightfield, with trees as ellipsoids before it. Metres; no renderer.

use core::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::sunlight::Sunlight;
use crate::math::ramp;
use crate::model::TreeFootprint;
use crate::model::{Instance, Landform, SkyLight, StartView};

/// Columns around, the first towards north (−z), clockwise.
pub(super) const COLUMNS: usize = 96;
/// Rows from bottom to top, evenly spaced by slope, as pixels of an upright picture are.
pub(super) const ROWS: usize = 28;
/// Slope of the lower edge of the lowest row; the picture is as high as deep.
const REACH: f32 = 0.84;
pub(super) const ROW_STEP: f32 = 2.0 * REACH / ROWS as f32;

/// The ray's first step and its growth: about 80 steps to the end.
const FIRST_M: f32 = 1.5;
const GROWTH: f32 = 1.09;
/// Farthest land that counts.
const FAR_M: f32 = 3000.0;
/// Metres along x and z from the middle to the farthest water that one would miss.
const AROUND_M: f32 = 1024.0;
/// Metres between the low and the high ground of which nobody misses the slopes, and of which everybody does.
const HILLS_M: [f32; 2] = [15.0, 90.0];
/// Metres to slopes that show their whole shape.
const SLOPES_M: f32 = 250.0;
/// Farthest tree that can be told from the ground.
const FAR_TREE_M: f32 = 250.0;
/// Farthest stem that is wide enough to count.
const FAR_STEM_M: f32 = 16.0;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Sky,
    Ground,
    /// Ground above the snow line.
    Snow,
    Water,
    Tree,
}

impl Kind {
    pub const ALL: [Self; 5] = [Self::Sky, Self::Ground, Self::Snow, Self::Water, Self::Tree];

    /// Also water.
    pub fn is_land(self) -> bool {
        !matches!(self, Self::Sky | Self::Tree)
    }
}

/// What a ray meets first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Seen {
    pub kind: Kind,
    /// Metres along the ground; infinite for sky.
    pub depth_m: f32,
    /// How much of its light is the sun's, as a part of what a slope that is well lit has. Of land under trees as if they
    /// were not there.
    pub sun: f32,
}

const SKY: Seen = Seen { kind: Kind::Sky, depth_m: f32::INFINITY, sun: 0.0 };

/// The land with what stands on it.
pub(super) struct Surroundings<'a> {
    pub land: &'a Landform,
    trees: Vec<Tree>,
    /// Part of what lies within `AROUND_M` that is under water.
    pub wet: f32,
    /// Nothing but trees is higher.
    highest_m: f32,
    /// How much of a land is missed where none of its slopes are in sight, 0 … 1: nothing of level land, or in fog.
    pub relief: f32,
    pub stature: Stature,
    pub sunlight: Sunlight,
}

/// How the trees are shaped, on the mean.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Stature {
    pub height_m: f32,
    /// Width of the crown as a part of the height.
    pub breadth: f32,
}

impl Stature {
    fn of(footprints: &[TreeFootprint]) -> Self {
        let mean = |value: fn(&TreeFootprint) -> f32| {
            footprints.iter().map(value).sum::<f32>() / footprints.len().max(1) as f32
        };
        Self {
            height_m: mean(|tree| tree.height_m),
            breadth: mean(|tree| 2.0 * tree.crown_radius_m / tree.height_m),
        }
    }
}

/// A tree as an ellipsoid on a stem, which counts only where it is near.
pub(super) struct Tree {
    foot: Vec2,
    stem_radius_m: f32,
    radius_m: f32,
    bottom_m: f32,
    top_m: f32,
}

impl Tree {
    fn of(instance: &Instance, footprints: &[TreeFootprint]) -> Option<Self> {
        let footprint = footprints.get(instance.template as usize)?;
        let rows = &instance.world_from_tree;
        let (foot_m, height_m) = (rows[1][3], footprint.height_m * rows[1][1]);
        Some(Self {
            foot: Vec2::new(rows[0][3], rows[2][3]),
            stem_radius_m: footprint.trunk_radius_m * rows[1][1],
            radius_m: footprint.crown_radius_m * libm::hypotf(rows[0][0], rows[2][0]),
            bottom_m: foot_m + footprint.clear_trunk * height_m,
            top_m: foot_m + height_m,
        })
    }

    /// Whether it stands before a point on the way along a unit vector.
    pub fn hides(&self, from: Vec3, towards: Vec3) -> bool {
        let middle = Vec3::new(self.foot.x, 0.5 * (self.bottom_m + self.top_m), self.foot.y);
        let radii = Vec3::new(self.radius_m, 0.5 * (self.top_m - self.bottom_m), self.radius_m);
        // Where the ellipsoid is the unit sphere.
        let (way, along) = ((middle - from) / radii, towards / radii);
        let ahead = way.dot(along);
        ahead > 0.0 && ahead * ahead > along.length_squared() * (way.length_squared() - 1.0)
    }
}

impl<'a> Surroundings<'a> {
    pub fn new(
        land: &'a Landform,
        trees: &[Instance],
        footprints: &[TreeFootprint],
        light: &SkyLight,
    ) -> Self {
        let trees = trees.iter().filter_map(|tree| Tree::of(tree, footprints)).collect();
        let around = Around::of(land);
        let heights_m = [&land.field, &land.apron].map(|heights| heights.range_m()[1]);
        let highest_m = heights_m.into_iter().chain(land.water_level_m).fold(f32::MIN, f32::max);
        let (wet, relief) = (around.wet(), around.relief() * clear(light));
        let (stature, sunlight) = (Stature::of(footprints), Sunlight::of(land, highest_m, light));
        Self { land, trees, highest_m, wet, relief, stature, sunlight }
    }

    /// The trees whose feet are no farther from a place.
    pub fn trees_around(&self, place: Vec2, within_m: f32) -> Vec<&Tree> {
        self.trees.iter().filter(|tree| tree.foot.distance_squared(place) <= within_m * within_m).collect()
    }

    /// Height of the land, or of the water on it, near or at the horizon.
    pub fn surface_m(&self, p: Vec2) -> f32 {
        self.ground_m(p).max(self.water_m())
    }

    /// Height of the land.
    pub fn ground_m(&self, p: Vec2) -> f32 {
        self.land.height_m(p)
    }

    /// Level of the lake, far below if there is none.
    pub fn water_m(&self) -> f32 {
        self.land.water_level_m.unwrap_or(f32::MIN)
    }

    fn kind(&self, p: Vec2, surface_m: f32) -> Kind {
        if self.ground_m(p) < self.water_m() {
            Kind::Water
        } else if surface_m > self.land.snow_line_m {
            Kind::Snow
        } else {
            Kind::Ground
        }
    }
}

/// The land within `AROUND_M`.
struct Around {
    /// Ascending.
    heights_m: Vec<f32>,
    water_m: f32,
}

impl Around {
    fn of(land: &Landform) -> Self {
        let apron = &land.apron;
        let near = |k: &u32| apron.place_m(*k).abs() <= AROUND_M;
        let lines: Vec<u32> = (0..apron.side).filter(near).collect();
        let mut heights_m: Vec<f32> =
            lines.iter().flat_map(|&j| lines.iter().map(move |&i| apron.at(i, j))).collect();
        heights_m.sort_unstable_by(f32::total_cmp);
        Self { heights_m, water_m: land.water_level_m.unwrap_or(f32::MIN) }
    }

    /// Part that is under water.
    fn wet(&self) -> f32 {
        let under = self.heights_m.partition_point(|&height_m| height_m < self.water_m);
        under as f32 / self.heights_m.len().max(1) as f32
    }

    /// 0 of level land, 1 of mountains: by the metres from what a twentieth is lower than to what a twentieth is higher
    /// than. Water is as low as land gets.
    fn relief(&self) -> f32 {
        let Some(last) = self.heights_m.len().checked_sub(1) else { return 0.0 };
        let [low_m, high_m] = [last / 20, last - last / 20].map(|k| self.heights_m[k].max(self.water_m));
        ramp(HILLS_M[0], HILLS_M[1], high_m - low_m)
    }
}

/// Part of the light from slopes at a good distance that reaches the eye.
fn clear(light: &SkyLight) -> f32 {
    libm::expf(-light.haze_extinction_per_m * SLOPES_M)
}

/// What is seen around a place.
pub(super) struct Panorama {
    /// Height of the eye.
    pub eye_m: f32,
    /// Column by column, from bottom to top.
    seen: Vec<[Seen; ROWS]>,
    /// For each column the slope of the skyline: of land, not of trees.
    skyline: Vec<f32>,
    /// For each column the logarithm of the farthest land's depth, in metres.
    log_far: Vec<f32>,
    stems: Vec<Stem>,
}

/// A stem near by.
#[derive(Clone, Copy)]
pub(super) struct Stem {
    /// Where its middle stands, in columns from north.
    pub column: f32,
    /// How many columns it hides.
    pub width: f32,
    /// Slope at which its crown begins.
    pub crown_from: f32,
}

/// What is seen in one direction.
#[derive(Clone, Copy)]
pub(super) struct Column<'a> {
    /// From bottom to top.
    pub seen: &'a [Seen; ROWS],
    pub skyline: f32,
    pub log_far: f32,
}

impl Panorama {
    pub fn new(scene: &Surroundings<'_>, place: Vec2) -> Self {
        let eye_m = scene.surface_m(place) + StartView::EYE_HEIGHT_M;
        let mut panorama =
            Self { eye_m, seen: Vec::new(), skyline: Vec::new(), log_far: Vec::new(), stems: Vec::new() };
        for column in 0..COLUMNS {
            panorama.add_column(scene, place, column_towards(column));
        }
        for tree in &scene.trees {
            panorama.add_tree(tree, place, &scene.sunlight);
        }
        panorama.log_far = panorama.seen.iter().map(|seen| libm::logf(farthest_m(seen))).collect();
        panorama
    }

    fn add_column(&mut self, scene: &Surroundings<'_>, place: Vec2, along: Vec2) {
        let (mut seen, mut row, mut skyline) = ([SKY; ROWS], 0, -REACH);
        let mut depth_m = FIRST_M;
        while depth_m < FAR_M {
            let p = place + along * depth_m;
            let surface_m = scene.surface_m(p);
            let slope = (surface_m - self.eye_m) / depth_m;
            while row < ROWS && slope_of(row) <= slope {
                seen[row] =
                    Seen { kind: scene.kind(p, surface_m), depth_m, sun: scene.sunlight.on_ground(p) };
                row += 1;
            }
            skyline = slope.max(skyline);
            depth_m *= GROWTH;
            // Whatever comes is hidden.
            let rise_m = scene.highest_m - self.eye_m;
            if (rise_m / depth_m).max(rise_m / FAR_M) < skyline {
                break;
            }
        }
        self.seen.push(seen);
        self.skyline.push(skyline);
    }

    fn add_tree(&mut self, tree: &Tree, place: Vec2, sunlight: &Sunlight) {
        let way = tree.foot - place;
        let depth_m = way.length();
        if !(0.5..=FAR_TREE_M).contains(&depth_m) {
            return;
        }
        let step = TAU / COLUMNS as f32;
        let middle = libm::atan2f(way.x, -way.y) / step;
        let half = libm::atanf(tree.radius_m / depth_m) / step;
        let (low, high) = ((tree.bottom_m - self.eye_m) / depth_m, (tree.top_m - self.eye_m) / depth_m);
        if depth_m < FAR_STEM_M {
            let width = 2.0 * libm::atanf(tree.stem_radius_m / depth_m) / step;
            self.stems.push(Stem { column: middle, width, crown_from: low });
        }
        let sun = sunlight.on_crown(tree.foot, 0.5 * (tree.bottom_m + tree.top_m));
        let seen = Seen { kind: Kind::Tree, depth_m, sun };
        let reach = half.max(0.5) as i32 + 1;
        for offset in -reach..=reach {
            let column = libm::roundf(middle) as i32 + offset;
            let away = (column as f32 - middle).abs();
            // All of its height is in one column, or the tip of a slender tree would be between the middles of two.
            let aside = if away <= 0.5 { 0.0 } else { away / half.max(0.5) };
            if aside * aside >= 1.0 {
                continue;
            }
            let part = (1.0 - aside * aside).sqrt();
            let (centre, span) = (0.5 * (low + high), 0.5 * (high - low) * part);
            self.fill(column.rem_euclid(COLUMNS as i32) as usize, [centre - span, centre + span], seen);
        }
    }

    /// A tree before a column's rows, unless land hides it.
    fn fill(&mut self, column: usize, [low, high]: [f32; 2], tree: Seen) {
        // How many rows begin below a slope.
        let rows = |slope: f32| ((slope + REACH) / ROW_STEP + 1.0).clamp(0.0, ROWS as f32) as usize;
        for seen in &mut self.seen[column][rows(low).saturating_sub(1)..rows(high)] {
            if tree.depth_m < seen.depth_m {
                *seen = tree;
            }
        }
    }

    /// Stems near by, all around.
    pub fn stems(&self) -> &[Stem] {
        &self.stems
    }

    /// The column `index - before` from north, all round.
    pub fn column(&self, index: usize, before: usize) -> Column<'_> {
        let k = (index + COLUMNS - before) % COLUMNS;
        Column { seen: &self.seen[k], skyline: self.skyline[k], log_far: self.log_far[k] }
    }
}

/// The farthest land in a column, 1 m or more.
fn farthest_m(seen: &[Seen; ROWS]) -> f32 {
    seen.iter().filter(|seen| seen.kind.is_land()).map(|seen| seen.depth_m).fold(1.0, f32::max)
}

/// Slope of a row's middle.
pub(super) fn slope_of(row: usize) -> f32 {
    (row as f32 + 0.5) * ROW_STEP - REACH
}

/// Unit vector (x, z) of a column.
fn column_towards(column: usize) -> Vec2 {
    let (sin, cos) = libm::sincosf(column as f32 * (TAU / COLUMNS as f32));
    Vec2::new(sin, -cos)
}
