//! Nothing → the shapes of what has wood: bushes, young trees, fallen trunks and stumps. Metres.

use glam::Vec3;

use super::shapes::{Drawing, heading};
use crate::math::lerp;
use crate::model::PlantShape;

use std::f32::consts::TAU;

/// By which turns neighbours along a stem differ, so that no two stand above each other.
const GOLDEN: f32 = 2.4;

/// What a young tree bears.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Foliage {
    Leaves,
    Needles,
    Fronds,
    Bare,
}

/// A bush of a metre: some stems, and sprays all over a crown of lobes, each with leaves around its end. Tint 0 is that of its inside.
pub(super) fn bush() -> PlantShape {
    const SPRAYS: u32 = 46;
    let mut d = Drawing::new(71);
    for k in 0..3 {
        let aim = heading(GOLDEN * k as f32) * 0.25 + Vec3::Y * 0.6;
        d.stalk(Vec3::ZERO, aim, 0.02);
    }
    let sprays: Vec<(Vec3, Vec3)> = (0..SPRAYS)
        .map(|k| {
            let up = 1.0 - 1.5 * (k as f32 + 0.5) / SPRAYS as f32;
            let out =
                heading(GOLDEN * k as f32 + 0.9 * d.unit()) * (1.0 - up * up).max(0.0).sqrt() + Vec3::Y * up;
            // Not round: lobes of different heights.
            let lobe =
                0.75 + 0.3 * libm::sinf(2.6 * out.x + 1.0) * libm::cosf(3.4 * out.z + 0.5) + 0.3 * d.unit();
            let middle =
                Vec3::Y * 0.42 + Vec3::new(0.56, 0.5, 0.56) * out * lobe * lerp(0.55, 1.0, d.unit().sqrt());
            let [aside, _] = tangents(out, d.unit() * TAU);
            (middle, (0.8 * aside + 0.55 * out).normalize_or(out))
        })
        .collect();
    let outward = |at: Vec3| (at - 0.3 * Vec3::Y).normalize_or(Vec3::Y);
    let depth = |at: Vec3| ((at - 0.42 * Vec3::Y).length() / 0.6).min(1.0);
    // What is deep inside or below is in the shade of the rest.
    let lit = |at: Vec3| 0.02 + 0.55 * depth(at) * depth(at) * lerp(0.4, 1.0, (at.y / 0.8).clamp(0.0, 1.0));
    // Within, in the shade of the leaves.
    for &(middle, aim) in &sprays {
        let inner = middle - 0.08 * outward(middle);
        let [_, wide] = tangents(aim, d.unit() * TAU);
        let (long, tint) = (0.13 + 0.05 * d.unit(), 0.12 + 0.3 * depth(inner) + 0.12 * d.unit());
        let along = [inner - long * aim, inner + 0.02 * wide, inner + long * aim];
        d.diamond(along, 0.07 * wide, outward(inner) + 0.4 * Vec3::Y, [0.6 * tint, tint, 1.3 * tint]);
    }
    d.coarse();
    for &(middle, aim) in &sprays {
        for k in 0..4 {
            let from = middle + (0.08 * k as f32 - 0.12) * aim;
            let [aside, _] = tangents(aim, d.unit() * TAU);
            let along = (aside + 0.5 * aim + 0.5 * outward(middle)).normalize_or(aim);
            // In the light of its own face, and of the bush's.
            let normal = |face: Vec3| {
                let front = if face.dot(outward(middle)) < 0.0 { -face } else { face };
                front + 0.25 * outward(middle)
            };
            twig_leaf(&mut d, [from, along], normal, [0.12, 0.05, 0.05], [lit(from), 0.45], 0.7);
        }
    }
    d.done()
}

/// A young tree of two metres, from afar as well. Tint 0 is that of its stem, 1 that of its leaves.
pub(super) fn sapling(foliage: Foliage) -> PlantShape {
    let mut d = Drawing::new(72);
    match foliage {
        Foliage::Needles => spire(&mut d),
        Foliage::Fronds => rosette(&mut d),
        Foliage::Leaves | Foliage::Bare => whip(&mut d, foliage == Foliage::Leaves),
    }
    d.done()
}

/// A stem with twigs all around, each with some leaves.
fn whip(d: &mut Drawing, has_leaves: bool) {
    const TWIGS: u32 = 17;
    d.stalk(Vec3::ZERO, Vec3::new(0.05, 2.0, 0.03), 0.03);
    let twigs: Vec<(Vec3, Vec3)> = (0..TWIGS)
        .map(|k| {
            let t = k as f32 / TWIGS as f32;
            let long = lerp(0.62, 0.22, t) * (0.8 + 0.4 * d.unit());
            let out = heading(GOLDEN * k as f32 + 0.4 * d.unit()) + Vec3::Y * lerp(0.4, 1.1, t);
            let root = Vec3::new(0.05, 2.0, 0.03) * lerp(0.22, 0.97, t);
            (root, root + out.normalize_or(Vec3::Y) * long)
        })
        .collect();
    for &(root, tip) in &twigs {
        d.stalk(root, tip, 0.012);
        if !has_leaves {
            continue;
        }
        // From afar one for all leaves of a twig.
        let out = (tip - root).normalize_or(Vec3::Y);
        let [_, wide] = tangents(out, d.unit() * TAU);
        let middle = root.lerp(tip, 0.55);
        let tint = 0.85 + 0.15 * d.unit();
        let along = [root.lerp(tip, 0.15), middle, tip + 0.02 * out];
        d.diamond(along, 0.04 * wide, out + Vec3::Y, [0.4, tint, tint]);
    }
    d.coarse();
    if !has_leaves {
        return;
    }
    for &(root, tip) in &twigs {
        for k in 0..8 {
            let out = (tip - root).normalize_or(Vec3::Y);
            let from = root.lerp(tip, 0.2 + 0.1 * k as f32);
            let aim = (heading(d.unit() * TAU) + 0.35 * out + Vec3::Y * 0.15).normalize_or(out);
            twig_leaf(d, [from, aim], |_| out + Vec3::Y, [0.13, 0.05, 0.07], [0.85, 0.15], 0.8);
        }
    }
}

/// Sprays around a stem that get shorter and steeper towards the top, each turned about itself: in level whorls they would be the
/// rungs of a ladder to whoever stands beside it. Near by each has two more.
fn spire(d: &mut Drawing) {
    const SPRAYS: u32 = 45;
    d.stalk(Vec3::ZERO, Vec3::Y * 1.85, 0.035);
    let spray = |d: &mut Drawing, [root, out]: [Vec3; 2], long: f32| {
        let tip = root + out * long;
        let [side, _] = tangents(out, 1.1 * (2.0 * d.unit() - 1.0));
        let middle = root.lerp(tip, 0.45) + Vec3::Y * (0.06 * long);
        let tint = 0.55 + 0.4 * d.unit();
        d.diamond([root, middle, tip], 0.15 * long * side, out + 0.7 * Vec3::Y, [0.1, 0.8 * tint, tint]);
    };
    let main: Vec<([Vec3; 2], f32, f32)> = (0..SPRAYS)
        .map(|k| {
            let t = (k as f32 + d.unit()) / SPRAYS as f32;
            let turn = GOLDEN * k as f32 + 0.5 * d.unit();
            let rise = lerp(-0.1, 0.9, t * t) + 0.25 * d.unit();
            let out = (heading(turn) + Vec3::Y * rise).normalize_or(Vec3::Y);
            let long = lerp(0.68, 0.16, t) * (0.8 + 0.35 * d.unit());
            ([Vec3::Y * lerp(0.08, 1.78, t), out], long, turn)
        })
        .collect();
    for &(place, long, _) in &main {
        spray(d, place, long);
    }
    d.coarse();
    for &([root, out], long, turn) in &main {
        for side in [-1.0, 1.0] {
            let from = root + out * (long * (0.2 + 0.25 * d.unit()));
            let aim = (out + heading(turn + side * 1.3) * 0.8).normalize_or(out);
            let short = long * (0.5 + 0.15 * d.unit());
            spray(d, [from, aim], short);
        }
    }
}

/// Young fronds from one root.
fn rosette(d: &mut Drawing) {
    for k in 0..11 {
        let (turn, long) = (GOLDEN * k as f32, 1.0 + 0.5 * d.unit());
        d.blade(Vec3::Y * 0.02, turn, [long, 0.35 + 0.06 * k as f32, 0.14], [0.2, 1.0]);
    }
}

/// A trunk that fell, with stubs of branches, half sunk. Tint 1 is that of what grows on it or has faded in the sun.
pub(super) fn log() -> PlantShape {
    const RINGS: u32 = 6;
    const AROUND: u32 = 7;
    let mut d = Drawing::new(73);
    let middle = |t: f32| Vec3::new(lerp(-2.2, 2.2, t), lerp(0.17, 0.09, t), 0.14 * libm::sinf(4.0 * t));
    let grid: Vec<Vec<Vec3>> = (0..=RINGS)
        .map(|ring| {
            let t = ring as f32 / RINGS as f32;
            let radius = lerp(0.26, 0.10, t) * (0.92 + 0.16 * d.unit());
            (0..AROUND)
                .map(|k| {
                    let turn = heading(k as f32 / AROUND as f32 * TAU);
                    middle(t) + radius * (0.95 + 0.1 * d.unit()) * Vec3::new(0.0, turn.x, turn.z)
                })
                .collect()
        })
        .collect();
    for (ring, pair) in grid.windows(2).enumerate() {
        let axis = middle((ring as f32 + 0.5) / RINGS as f32);
        let tint = |p: Vec3| ((p.y - axis.y) * 3.0 + 0.2).clamp(0.0, 1.0);
        d.band(pair, |quad| (mean(quad) - axis, quad.map(tint)));
    }
    for (ring, out) in [(0, Vec3::NEG_X), (RINGS as usize, Vec3::X)] {
        let ends = &grid[ring];
        for k in 1..AROUND as usize - 1 {
            d.lit([ends[0], ends[k], ends[k + 1]], out, [0.85; 3]);
        }
    }
    d.coarse();
    for (t, turn, long) in
        [(0.35, 0.9, 0.5), (0.5, -0.7, 0.7), (0.68, 0.3, 0.6), (0.8, -1.2, 0.45), (0.9, 0.8, 0.5)]
    {
        let root = middle(t);
        let aim = Vec3::new(0.55, libm::cosf(turn), libm::sinf(turn)).normalize_or(Vec3::Y);
        d.stalk(root, root + aim * long, 0.045);
    }
    d.done()
}

/// What is left of a tree whose trunk broke: splintered at the top, with roots. Tint 1 is that of the wood inside.
pub(super) fn stump() -> PlantShape {
    const AROUND: usize = 9;
    let mut d = Drawing::new(74);
    let ring = |d: &mut Drawing, radius: f32, high: [f32; 2], flare: f32| -> Vec<Vec3> {
        (0..AROUND)
            .map(|k| {
                let root = 1.0 + flare * if k % 3 == 0 { 1.0 } else { 0.0 };
                let reach = radius * root * (0.92 + 0.16 * d.unit());
                heading(k as f32 / AROUND as f32 * TAU) * reach + Vec3::Y * lerp(high[0], high[1], d.unit())
            })
            .collect()
    };
    let rings = [
        ring(&mut d, 0.36, [-0.12, -0.06], 0.7),
        ring(&mut d, 0.25, [0.14, 0.18], 0.1),
        ring(&mut d, 0.22, [0.42, 0.75], 0.0),
    ];
    for (pair, [low, high]) in rings.windows(2).zip([[0.35, 0.15], [0.15, 0.3]]) {
        d.band(pair, |quad| (mean(quad).with_y(0.0), [low, low, high, high]));
    }
    let heart = Vec3::Y * 0.40;
    for k in 0..AROUND {
        let (a, b) = (rings[2][k], rings[2][(k + 1) % AROUND]);
        d.lit([a, b, heart], Vec3::Y, [0.8, 0.8, 1.0]);
    }
    d.done()
}

/// A leaf that a twig bears: where, along which unit vector, and lit as if it faced along what `normal` gives of the direction in
/// which it does. Its length is at least the first of two numbers and at most their sum, and so is its tint, which `shade` lessens at
/// its root; the third number is its width.
fn twig_leaf(
    d: &mut Drawing,
    [from, aim]: [Vec3; 2],
    normal: impl FnOnce(Vec3) -> Vec3,
    [long, longer, width]: [f32; 3],
    [tint, brighter]: [f32; 2],
    shade: f32,
) {
    let leaf = aim * (long + longer * d.unit());
    let [_, wide] = tangents(aim, d.unit() * TAU);
    let tint = tint + brighter * d.unit();
    let normal = normal(aim.cross(wide));
    d.lit([from, from + 0.45 * leaf + width * wide, from + leaf], normal, [shade * tint, tint, tint]);
}

fn mean([a, b, c, d]: [Vec3; 4]) -> Vec3 {
    (a + b + c + d) * 0.25
}

/// Two unit vectors along the surface that faces `out`, turned around it.
fn tangents(out: Vec3, turn: f32) -> [Vec3; 2] {
    let across = out.cross(Vec3::new(0.3, 0.9, 0.2)).normalize_or(Vec3::X);
    let up = across.cross(out);
    let (sin, cos) = libm::sincosf(turn);
    [across * cos + up * sin, up * cos - across * sin]
}
