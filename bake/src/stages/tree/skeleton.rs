//! Genes → stems: polylines with a radius at every node, in metres, after Weber & Penn (1995).
//!
//! A stem that forks becomes several `Stem`s: the arms after the first start at the node where the stem forks, with
//! the rest of its length. Lengths, radii and the crown's envelope follow the paper; pulls up and down act on
//! direction vectors, so no rotation accumulates twist.

use std::f32::consts::{PI, TAU};
use std::ops::Range;

use glam::Vec3;

use super::budget::Budget;
use super::culms;
use super::params::{Habit, TreeParams};
use crate::math::{lerp, ramp};
use crate::seed::Dice;

/// Where along a trunk the leader of a weeping tree begins to nod, and how far it turns until its tip, in degrees.
const NODS_FROM: f32 = 0.6;
const NODS_BY_DEG: f32 = 105.0;

/// Branches keep this far above the ground, in metres.
const GROUND_CLEARANCE_M: f32 = 0.25;

/// A point of a stem.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub at: Vec3,
    pub radius_m: f32,
}

/// A run of nodes with shrinking radius.
#[derive(Clone, Debug)]
pub(super) struct Stem {
    /// 0 trunk, 1 primary, …
    pub level: u32,
    /// Radius in metres of the parent where it starts; 0 for the trunk.
    pub parent_radius_m: f32,
    pub nodes: Range<usize>,
    /// Where its first node lies along the stem before it forked, 0 to 1; its last lies at 1.
    pub from: f32,
    /// Length in metres, including the part below a fork.
    pub length_m: f32,
    /// Radius in metres at its start, below any fork.
    pub radius_m: f32,
    /// Which primary branch it belongs to, for masses of foliage; 0 is the trunk.
    pub clump: u32,
    /// Whether it is an arm of a fork.
    pub is_arm: bool,
}

/// All stems, parents before children.
#[derive(Clone, Debug, Default)]
pub(super) struct Skeleton {
    pub nodes: Vec<Node>,
    pub stems: Vec<Stem>,
    /// Number of clumps.
    pub clumps: u32,
}

impl Skeleton {
    /// Place, unit direction and radius at `z`, the fraction of the whole stem (`Stem::from` to 1).
    pub fn along(&self, stem: &Stem, z: f32) -> (Vec3, Vec3, f32) {
        let nodes = &self.nodes[stem.nodes.clone()];
        let last = nodes.len() - 1;
        let t = ((z - stem.from) / (1.0 - stem.from)).clamp(0.0, 1.0) * last as f32;
        let i = (t as usize).min(last - 1);
        let (a, b, f) = (nodes[i], nodes[i + 1], t - i as f32);
        let direction = (b.at - a.at).normalize_or(Vec3::Y);
        (a.at.lerp(b.at, f), direction, lerp(a.radius_m, b.radius_m, f))
    }

    /// Drops stems of the last level, evenly chosen, until three-sided tubes fit the budget.
    fn prune(&mut self, budget: &Budget) {
        let cost = |stem: &Stem| 6 * (stem.nodes.len() - 1);
        let last = budget.levels - 1;
        let (thin, thick): (Vec<&Stem>, Vec<&Stem>) = self.stems.iter().partition(|stem| stem.level == last);
        let max = budget.max_bark_triangles as usize;
        let thick: usize = thick.iter().map(|stem| 3 * cost(stem) / 2).sum();
        let thin: usize = thin.iter().map(|stem| cost(stem)).sum();
        if thick + thin <= max || last == 0 {
            return;
        }
        let part = max.saturating_sub(thick) as f32 / thin as f32;
        let mut error = 0.5;
        self.stems.retain(|stem| {
            if stem.level < last {
                return true;
            }
            error += part;
            let keep = error >= 1.0;
            error -= if keep { 1.0 } else { 0.0 };
            keep
        });
    }

    /// Radius in metres that holds the trunk and its arms at breast height.
    pub fn trunk_radius_m(&self, height_m: f32) -> f32 {
        let breast_m = if height_m < 13.0 { 0.1 * height_m } else { 1.3 };
        let mut radius_m = 0.0_f32;
        for stem in self.stems.iter().filter(|stem| stem.level == 0) {
            for pair in self.nodes[stem.nodes.clone()].windows(2) {
                let (a, b) = (pair[0], pair[1]);
                if a.at.y <= breast_m && b.at.y > breast_m {
                    let f = (breast_m - a.at.y) / (b.at.y - a.at.y);
                    let at = a.at.lerp(b.at, f);
                    let aside = (at.x * at.x + at.z * at.z).sqrt();
                    radius_m = radius_m.max(aside.min(0.5) + a.radius_m + (b.radius_m - a.radius_m) * f);
                }
            }
        }
        radius_m.max(0.02)
    }
}

/// A stem about to grow.
#[derive(Clone, Copy, Default)]
struct Sprout {
    level: u32,
    parent_radius_m: f32,
    at: Vec3,
    along: Vec3,
    /// Axis that a positive bend turns around: away from the parent.
    axis: Vec3,
    /// Segment to start at.
    segment: u32,
    length_m: f32,
    radius_m: f32,
    /// Factor on the radius after forks.
    thickness: f32,
    clump: u32,
    is_arm: bool,
}

struct Grower<'a> {
    params: &'a TreeParams,
    budget: &'a Budget,
    dice: &'a mut Dice,
    skeleton: Skeleton,
    /// The trunk's length in metres.
    trunk_m: f32,
    /// How many more arms the stem that is growing may fork into.
    arms_left: u32,
    /// The forks that this stem owes (or, below 0, has too many of), by error diffusion.
    fork_error: f32,
}

/// Grows the stems of one individual.
pub(super) fn grow(params: &TreeParams, budget: &Budget, dice: &mut Dice) -> Skeleton {
    let trunk_m = params.height_m * (1.0 + params.height_variation * 0.7 * dice.signed());
    let skeleton = Skeleton::default();
    let mut grower = Grower { params, budget, dice, skeleton, trunk_m, arms_left: 0, fork_error: 0.0 };
    if culms::count(params) > 1 {
        grower.clump()
    } else {
        grower.trunk()
    }
    for level in 1..budget.levels {
        grower.branches(level);
    }
    grower.skeleton.prune(budget);
    grower.skeleton
}

/// The crown's envelope: length of a branch over the longest, at `ratio` = 1 at the crown's base and 0 at its top
/// (Weber & Penn, ShapeRatio). A cone comes to a point, within its top quarter; theirs ends a fifth as wide as it began.
fn envelope(shape: u32, ratio: f32) -> f32 {
    let flame = if ratio <= 0.7 { ratio / 0.7 } else { (1.0 - ratio) / 0.3 };
    match shape {
        0 => (0.2 + 0.8 * ratio).min(1.5 * ratio),
        1 => 0.2 + 0.8 * libm::sinf(PI * ratio),
        2 => 0.2 + 0.8 * libm::sinf(0.5 * PI * ratio),
        3 => 1.0,
        4 => 0.5 + 0.5 * ratio,
        5 => flame,
        6 => 1.0 - 0.8 * ratio,
        _ => 0.5 + 0.5 * flame,
    }
}

/// Radius at `z` in 0..1 over that at 0. Up to 1, `taper` leaves 1 − taper at the tip; beyond, the stem thins early.
fn taper_at(taper: f32, z: f32) -> f32 {
    if taper <= 1.0 {
        return 1.0 - taper * z;
    }
    libm::powf((1.0 - z).max(0.0), 1.0 + 2.0 * (taper - 1.0))
}

/// `v` turned by `angle_rad` around the unit `axis` (Rodrigues).
fn turned(v: Vec3, axis: Vec3, angle_rad: f32) -> Vec3 {
    let (sin, cos) = libm::sincosf(angle_rad);
    v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos))
}

/// A unit vector at right angles to the unit vector `v`.
pub(super) fn perpendicular(v: Vec3) -> Vec3 {
    let helper = if v.x.abs() < 0.8 { Vec3::X } else { Vec3::Z };
    v.cross(helper).normalize_or(Vec3::Z)
}

impl Grower<'_> {
    fn is_palm(&self) -> bool {
        self.budget.levels == 1
    }

    fn trunk(&mut self) {
        let (sin, cos) = libm::sincosf(self.dice.unit() * TAU);
        self.stem(Sprout {
            along: Vec3::Y,
            axis: Vec3::new(cos, 0.0, sin),
            length_m: self.trunk_m,
            radius_m: self.trunk_m * self.params.radius_ratio,
            thickness: 1.0,
            ..Sprout::default()
        });
    }

    /// Grows a trunk for each culm of a clump of canes.
    fn clump(&mut self) {
        for culm in culms::set_out(self.params, self.trunk_m, self.dice) {
            let length_m = self.trunk_m * culm.length;
            self.stem(Sprout {
                at: culm.at,
                along: culm.along,
                axis: culm.axis,
                length_m,
                radius_m: length_m * self.params.radius_ratio * culm.thickness,
                thickness: 1.0,
                ..Sprout::default()
            });
        }
    }

    /// Grows a stem and all arms that it forks into.
    fn stem(&mut self, sprout: Sprout) {
        self.arms_left = self.budget.max_arms[sprout.level as usize] - 1;
        self.fork_error = self.dice.unit() - 0.5;
        let mut waiting = vec![sprout];
        while let Some(sprout) = waiting.pop() {
            self.run(sprout, &mut waiting);
        }
    }

    /// Grows one run to its tip; arms are left in `waiting`.
    fn run(&mut self, sprout: Sprout, waiting: &mut Vec<Sprout>) {
        let level = sprout.level as usize;
        let segments = self.budget.segments[level];
        let step_m = sprout.length_m / segments as f32;
        let taper = if self.is_palm() { 0.45 * self.params.taper } else { self.params.taper };
        let first = self.skeleton.nodes.len();
        let (mut at, mut along, mut thickness) = (sprout.at, sprout.along, sprout.thickness);
        for segment in sprout.segment..=segments {
            let z = segment as f32 / segments as f32;
            let mut radius_m = (sprout.radius_m * thickness * taper_at(taper, z)).max(0.0015);
            if segment == sprout.segment && sprout.parent_radius_m > 0.0 {
                // A branch starts no thicker than what it grows from.
                radius_m = radius_m.min(0.88 * sprout.parent_radius_m);
            }
            self.skeleton.nodes.push(Node { at, radius_m });
            if segment == segments {
                break;
            }
            along = self.bend(along, &sprout, z, segments);
            let forks = self.forks(&sprout, segment);
            if forks > 0 {
                thickness *= 1.0 / (0.35 + 0.65 * (forks + 1) as f32).sqrt();
                let arm =
                    Sprout { at, segment, thickness, is_arm: true, parent_radius_m: radius_m, ..sprout };
                along = self.fork(along, forks + 1, arm, waiting);
            }
            at += along * step_m;
        }
        self.finish(first, sprout);
    }

    /// Spreads arms evenly around a stem. The first continues it in the returned direction; the others are left in
    /// `waiting`.
    fn fork(&mut self, along: Vec3, arms: u32, arm: Sprout, waiting: &mut Vec<Sprout>) -> Vec3 {
        let wide = if arm.level == 0 && arms > 2 { 0.75 } else { 0.5 };
        let half_rad = (self.params.split_angle_deg * wide).max(8.0).to_radians();
        let (start, x) = (self.dice.unit() * TAU, perpendicular(along));
        let mut direction = |i: u32| {
            let axis = turned(x, along, start + TAU * i as f32 / arms as f32);
            (axis, turned(along, axis, half_rad * (0.8 + 0.4 * self.dice.unit())))
        };
        let (_, first) = direction(0);
        for i in 1..arms {
            let (axis, direction) = direction(i);
            let away = along.cross(direction).normalize_or(axis);
            let sunk_m = if arm.level == 0 && arm.segment == 0 { 0.2 } else { 0.0 };
            let axis = if arm.level == 0 { away } else { arm.axis };
            waiting.push(Sprout { at: arm.at - direction * sunk_m, along: direction, axis, ..arm });
        }
        first
    }

    /// Keeps a stem above the ground by shrinking it about its start, or drops it.
    fn finish(&mut self, first: usize, sprout: Sprout) {
        let nodes = &mut self.skeleton.nodes[first..];
        let start = nodes[0].at;
        let lowest = nodes.iter().fold(f32::MAX, |low, node| low.min(node.at.y));
        let floor = GROUND_CLEARANCE_M.min(0.06 * self.trunk_m);
        let mut length_m = sprout.length_m;
        if sprout.level > 0 && lowest < floor {
            let scale = (start.y - floor) / (start.y - lowest).max(1e-4);
            if scale < 0.15 {
                self.skeleton.nodes.truncate(first);
                return;
            }
            nodes.iter_mut().for_each(|node| node.at = start + (node.at - start) * scale);
            length_m *= scale;
        }
        let segments = self.budget.segments[sprout.level as usize];
        self.skeleton.stems.push(Stem {
            level: sprout.level,
            parent_radius_m: sprout.parent_radius_m,
            nodes: first..self.skeleton.nodes.len(),
            from: sprout.segment as f32 / segments as f32,
            length_m,
            radius_m: sprout.radius_m,
            clump: sprout.clump,
            is_arm: sprout.is_arm,
        });
    }

    /// The direction after one more segment: curve, gnarl, and the pull up or down.
    fn bend(&mut self, along: Vec3, sprout: &Sprout, z: f32, segments: u32) -> Vec3 {
        let (p, axis, level) = (self.params, sprout.axis, sprout.level as usize);
        let palm = self.is_palm();
        let nods = p.is_cane() && z >= 0.5;
        let curve_gain = [if palm { 0.3 } else { f32::from(u8::from(nods)) }, 1.0, 0.7, 0.5][level];
        let gnarl_gain = [if palm { 0.2 } else { 0.3 }, 0.9, 1.0, 0.8][level];
        let step = 1.0 / segments as f32;
        let back = if z + 0.5 * step >= 0.5 { 2.0 * p.curve_back_deg } else { 0.0 };
        let gnarl = (p.curve_variation_deg * gnarl_gain * step).to_radians();
        // Where all hangs, a leader that stood upright would stand alone above it.
        let weeping = if palm { 0.0 } else { ramp(-0.5, -0.9, p.tropism) };
        let leader = if level == 0 && z >= NODS_FROM { weeping } else { 0.0 };
        let nod_deg = leader * NODS_BY_DEG / (1.0 - NODS_FROM);
        let curve =
            (((p.curve_deg + back) * curve_gain + nod_deg) * step).to_radians() + gnarl * self.dice.signed();
        let mut next = turned(along, axis, curve);
        next = (next + axis * (gnarl * self.dice.signed())).normalize_or(along);
        // And so would a short branch near its top, which is no stiffer than a twig.
        let short = (1.0 - sprout.length_m / (self.trunk_m * p.primary_length).max(0.01)).max(0.0);
        let down = [0.0, 0.9 + 2.5 * weeping * short, 3.4, 2.6][level];
        let up = [if palm { 0.4 } else { 0.0 }, 0.5, 0.9, 0.9][level];
        let pull = if p.tropism < 0.0 { p.tropism * down } else { p.tropism * up };
        // Leaders right themselves whatever the genes say, but for the tips of canes.
        let pull = if level == 0 && !palm && !nods { 0.45 * (1.0 - leader) } else { pull };
        let level_part = Vec3::Y - next * next.y;
        (next + level_part * (pull * step)).normalize_or(next)
    }

    /// How many arms fork off at the end of this segment (Weber & Penn's error diffusion).
    fn forks(&mut self, sprout: &Sprout, segment: u32) -> u32 {
        let p = self.params;
        let segments = self.budget.segments[sprout.level as usize];
        let z = segment as f32 / segments as f32;
        // A tree without a clear trunk, a bush, forks in the ground.
        let base = u32::from(p.clear_trunk > 0.06) + (p.clear_trunk * 0.35 * segments as f32) as u32;
        let forks = if sprout.level == 0 && segment == base && !sprout.is_arm && p.base_splits > 0 {
            if p.is_cane() { 0 } else { p.base_splits }
        } else {
            let wish = match sprout.level {
                0 if z >= p.clear_trunk.max(0.2) && z < 0.8 && !self.is_palm() => 0.28 * p.segment_splits,
                1 if segment > sprout.segment && z < 0.7 => 0.22 * p.segment_splits,
                _ => 0.0,
            };
            let forks = (wish + self.fork_error + 0.5).floor().max(0.0);
            self.fork_error += wish - forks;
            forks as u32
        };
        let forks = forks.min(self.arms_left);
        self.arms_left -= forks;
        forks
    }

    /// Grows all stems of `level` on those of the level below.
    fn branches(&mut self, level: u32) {
        let below = self.skeleton.stems.iter().filter(|stem| stem.level == level - 1);
        let parents: Vec<Stem> = below.cloned().collect();
        let bare_part = if level == 1 { self.params.clear_trunk.max(0.02) } else { 0.14 };
        let bearing = |stem: &Stem| (0.97 - stem.from.max(bare_part)).max(0.0);
        let whole: f32 = parents.iter().map(bearing).sum();
        let (mut error, mut azimuth) = (0.5, self.dice.unit() * TAU);
        for parent in &parents {
            let length = bearing(parent);
            let wish = if level == 1 {
                self.budget.primaries * length / whole.max(1e-3)
            } else {
                self.wish(level, parent) * length / 0.83
            };
            error += wish;
            let count = error.floor().max(0.0) as u32;
            error -= count as f32;
            for k in 0..count {
                let place = (k as f32 + 0.5 + 0.35 * self.dice.signed()) / count as f32;
                let z = parent.from.max(bare_part) + length * place;
                azimuth += self.params.rotation_deg.to_radians() + 0.18 * self.dice.signed();
                self.branch(level, parent, z, azimuth);
            }
        }
    }

    /// Children of a stem of level 1 or 2 (Weber & Penn, Stems).
    fn wish(&self, level: u32, parent: &Stem) -> f32 {
        let max = self.budget.max_children[level as usize - 2];
        if level != 2 {
            return max;
        }
        let longest = self.trunk_m * self.params.primary_length;
        max * (0.2 + 0.8 * (parent.length_m / longest.max(0.01)).min(1.2))
    }

    fn branch(&mut self, level: u32, parent: &Stem, z: f32, azimuth: f32) {
        let (at, along, parent_radius_m) = self.skeleton.along(parent, z);
        let base = self.params.clear_trunk;
        let ratio = ((1.0 - z) / (1.0 - base)).clamp(0.0, 1.0);
        let length_m = self.length_m(level, parent, z, ratio);
        if length_m < 0.02 {
            return;
        }
        let x = perpendicular(along);
        let mut side = turned(x, along, azimuth);
        if level > 1 {
            // Twigs spread sideways towards the light rather than straight down or up.
            let flat = if self.budget.habit == Habit::Needle { 0.3 } else { 0.6 };
            side.y = side.y * flat + 0.12;
            side = (side - along * side.dot(along)).normalize_or(x);
        }
        let down = self.down_rad(level, ratio);
        let (sin, cos) = libm::sincosf(down);
        let direction = (along * cos + side * sin).normalize_or(side);
        let radius_m = self.radius_m(level, parent, length_m, parent_radius_m);
        let clump = if level == 1 {
            self.skeleton.clumps += 1;
            self.skeleton.clumps
        } else {
            parent.clump
        };
        self.stem(Sprout {
            level,
            parent_radius_m,
            at,
            along: direction,
            axis: along.cross(side).normalize_or(x),
            length_m,
            radius_m,
            thickness: 1.0,
            clump,
            ..Sprout::default()
        });
    }

    fn length_m(&mut self, level: u32, parent: &Stem, z: f32, ratio: f32) -> f32 {
        let p = self.params;
        let vary = 1.0 + 0.14 * self.dice.signed();
        match level {
            1 => parent.length_m * p.primary_length * envelope(p.crown_shape, ratio) * vary,
            2 => parent.length_m * p.secondary_length * (1.0 - 0.6 * z) * 1.25 * vary,
            _ => parent.length_m * (0.35 + 0.35 * p.secondary_length) * (1.0 - 0.6 * z) * 1.25 * vary,
        }
    }

    fn radius_m(&self, level: u32, parent: &Stem, length_m: f32, parent_radius_m: f32) -> f32 {
        let ratio = (length_m / parent.length_m.max(0.01)).min(1.0);
        let radius_m = parent.radius_m * libm::powf(ratio, self.params.radius_power);
        let thin = [0.0, 0.007, 0.0055, 0.005][level as usize];
        // Without leaves, only twigs are seen.
        let min_m = if self.budget.dead { 0.005 + 0.0003 * self.params.height_m } else { 0.0025 };
        radius_m.clamp(thin * length_m, (0.045 * length_m).max(0.004)).min(0.8 * parent_radius_m).max(min_m)
    }

    /// Angle between a new branch and its parent; `ratio` is 1 at the crown's base, 0 at its top.
    fn down_rad(&mut self, level: u32, ratio: f32) -> f32 {
        let (angle, vary) = (self.params.down_angle_deg, self.params.down_angle_variation_deg);
        let (angle, vary) = if level == 1 { (angle, vary) } else { (26.0 + 0.32 * angle, 0.3 * vary.abs()) };
        let change =
            if vary < 0.0 { vary * (1.0 - 2.0 * (0.2 + 0.8 * ratio)) } else { vary * self.dice.signed() };
        (angle + change).clamp(12.0, 150.0).to_radians()
    }
}
