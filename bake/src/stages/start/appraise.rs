//! A picture, its footing and light → how good it is, as terms from 0 to 1 that are multiplied.
//!
//! A term that somebody could do without (water) never falls far below 1; one that spoils all (a wall) falls
//! nearly to 0. What
//! each wants is said at [`Want`].

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::panorama::{Kind, Seen, Stature, Surroundings};
use super::picture::{HALF_HEIGHT, Picture};
use crate::math::{lerp, ramp};

/// What a view is wanted to have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Want {
    /// Dry and level ground under the feet, with a few steps of it on all sides.
    Footing,
    /// No wall: rays at eye level and below reach as far as they would on level ground.
    Open,
    /// Far land, and several distances before it.
    Depth,
    /// Of high land, its slopes at a distance: it is by them that a person tells lands from each other.
    Relief,
    /// Trees between 10 m and 60 m, or 90 m if they are tall, whole, before the sky, and others beside them; none in the face, and not
    /// nothing but trees.
    Trees,
    /// Water in sight where there is much of it, but not at the feet and not everywhere.
    Water,
    /// Sun from the side, on the ground before the eyes; if it shines at all.
    Light,
    /// The skyline in the upper part of the picture, and sky above it.
    Horizon,
    /// Something other than snow.
    Green,
}

impl Want {
    pub const ALL: [Self; 9] = [
        Self::Footing,
        Self::Open,
        Self::Depth,
        Self::Relief,
        Self::Trees,
        Self::Water,
        Self::Light,
        Self::Horizon,
        Self::Green,
    ];

    /// What is to be said of a view that lacks it.
    pub fn lack(self) -> &'static str {
        match self {
            Self::Footing => "nowhere dry and level to stand",
            Self::Open => "a wall before the eyes",
            Self::Depth => "no depth",
            Self::Relief => "high land out of sight",
            Self::Trees => "no trees at a good distance",
            Self::Water => "water at the feet, nothing but water, or none of it in sight where there is much",
            Self::Light => "no light on the ground, or the sun in the eyes",
            Self::Horizon => "no horizon in the picture",
            Self::Green => "snow from edge to edge",
        }
    }
}

/// How a view meets each of [`Want::ALL`], 0 … 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Appraisal {
    pub terms: [f32; Want::ALL.len()],
    /// Slope of the look.
    pub pitch: f32,
}

impl Appraisal {
    /// The root of the product of all terms: spread more evenly over 0 … 1 than the product.
    pub fn score(&self) -> f32 {
        self.terms.iter().product::<f32>().sqrt()
    }

    pub fn term(&self, want: Want) -> f32 {
        self.terms[want as usize]
    }

    /// What is lacking most.
    pub fn weakest(&self) -> Want {
        let weaker = |a: &Want, b: &Want| self.term(*a).total_cmp(&self.term(*b));
        Want::ALL.into_iter().min_by(weaker).unwrap_or(Want::Footing)
    }
}

/// Appraises a picture; `footing` and `light` are known from elsewhere.
pub(super) fn appraise(
    picture: &Picture<'_>,
    scene: &Surroundings<'_>,
    footing: f32,
    light: f32,
) -> Appraisal {
    let terms = [
        footing,
        picture.open(),
        picture.depth(),
        picture.relief(scene.relief),
        picture.trees(scene.stature),
        picture.water(scene.wet),
        light,
        picture.horizon(),
        picture.green(),
    ];
    Appraisal { terms, pitch: picture.pitch }
}

impl Picture<'_> {
    fn open(&self) -> f32 {
        let land = |seen: &Seen| seen.kind.is_land();
        let wall = self.part([-0.04, HALF_HEIGHT], |_, seen| land(seen) && seen.depth_m < 40.0);
        // On level ground a ray of slope −s reaches 1.6 m / s.
        let bank = self.part([-0.28, -0.04], |slope, seen| land(seen) && seen.depth_m * -slope < 0.7);
        // Not 0: of four landscapes, all of walls, one still begins where there is least of them.
        0.02 + 0.98 * ramp(0.25, 0.03, wall) * ramp(0.7, 0.2, bank) * (1.0 - wall)
    }

    fn depth(&self) -> f32 {
        let far = ramp(libm::logf(40.0), libm::logf(600.0), self.mean(|column| column.log_far));
        let between = |low_m: f32, high_m: f32| ramp(0.0, 0.04, self.share_between(low_m..high_m, |_| true));
        let bands = between(10.0, 30.0) + between(30.0, 90.0) + between(90.0, 270.0) + between(270.0, 1e4);
        0.2 + 0.4 * far + 0.4 * ramp(0.8, 3.0, bands)
    }

    /// The more relief the land has, the more is missed where no far slopes are seen.
    fn relief(&self, relief: f32) -> f32 {
        let slopes = self.share_between(90.0..1e4, |kind| matches!(kind, Kind::Ground | Kind::Snow));
        lerp(lerp(1.0, 0.3, relief), 1.0, ramp(0.0, 0.16, slopes))
    }

    fn trees(&self, stature: Stature) -> f32 {
        let is_tree = |kind: Kind| kind == Kind::Tree;
        let between = |low_m: f32, high_m: f32| self.share_between(low_m..high_m, is_tree);
        let (near, good, far) = (between(0.0, 10.0), between(10.0, 60.0), between(60.0, 1e4));
        let none_near = 0.2 + 0.8 * ramp(0.2, 0.04, near);
        let not_all = 0.4 + 0.6 * ramp(0.7, 0.4, near + good + far);
        // One crown may fill as much of a picture as a wall.
        let not_in_the_way = 0.3 + 0.7 * ramp(0.5, 0.25, near + between(10.0, 30.0));
        // A stem without its crown is a bar across the picture.
        let not_cut = 0.35 + 0.65 * ramp(0.06, 0.015, self.cut_stems);
        // Tall trees are seen whole from farther away.
        let tall = ramp(15.0, 25.0, stature.height_m);
        let farther = tall * between(60.0, 90.0);
        // Those at the edge alone are half as good.
        let in_middle = |low_m: f32, high_m: f32| self.middle_share_between(low_m..high_m, is_tree);
        let well_placed = 0.5 * (good + farther + in_middle(10.0, 60.0) + tall * in_middle(60.0, 90.0));
        // Columns of leaves take less of a picture than crowns do.
        let wanted = lerp(0.06, 0.2, ramp(0.1, 0.32, stature.breadth));
        let some = 0.08 + 0.92 * ramp(0.0, wanted, well_placed + 0.2 * (far - farther));
        let is_at =
            |seen: &Seen, depths_m: Range<f32>| is_tree(seen.kind) && depths_m.contains(&seen.depth_m);
        // One tree alone before a view is what every other picture has.
        let columns = self.part_of_columns(|seen| is_at(seen, 10.0..200.0));
        let not_alone = 0.85 + 0.15 * ramp(0.25, 0.6, columns);
        // Crowns that are cut off farther away are small. Of a picture narrow ones take little, but may be all that it shows.
        let is_close = |seen: &Seen| is_at(seen, 0.0..60.0);
        let cut = self.part_of_upper_edge(is_close);
        let whole = (0.5 + 0.5 * ramp(0.3, 0.04, cut)) * lerp(1.0, 0.25, self.part_cut_off(is_close));
        // From above a tree is one spot of a wood; before the sky its shape is seen.
        let outlined = self.part_of_skyline(|seen| is_at(seen, 10.0..120.0));
        let before_sky = 0.7 + 0.3 * ramp(0.0, 0.15, outlined);
        some * none_near * not_all * not_in_the_way * not_cut * not_alone * whole * before_sky
    }

    /// The more of the land is under water, the more is missed where none is seen.
    fn water(&self, wet: f32) -> f32 {
        let share = self.share(|kind| kind == Kind::Water);
        let at_feet = self.share_between(0.0..6.0, |kind| kind == Kind::Water);
        let none = lerp(0.85, 0.25, ramp(0.05, 0.35, wet));
        let some = lerp(none, 1.0, ramp(0.0, 0.05, share));
        some * (0.4 + 0.6 * ramp(0.45, 0.3, share)) * (0.4 + 0.6 * ramp(0.1, 0.0, at_feet))
    }

    fn horizon(&self) -> f32 {
        let from_top = 0.5 - (self.skyline - self.pitch) / (2.0 * HALF_HEIGHT);
        let sky = self.share(|kind| kind == Kind::Sky);
        let well = ramp(0.1, 0.33, from_top) * ramp(0.75, 0.52, from_top);
        (0.15 + 0.85 * well) * (0.2 + 0.8 * ramp(0.03, 0.2, sky))
    }

    fn green(&self) -> f32 {
        let snow = self.share(|kind| kind == Kind::Snow);
        let land = self.share(Kind::is_land);
        1.0 - 0.5 * ramp(0.4, 1.0, snow / land.max(0.05))
    }
}
