//! Stems → one surface of closed tubes, in metres, with texture coordinates that follow each branch.
//!
//! Every tube is closed by a cap at its base, hidden in its parent, and a point at its tip. Rings are carried along
//! by parallel transport, so nothing twists. u counts a whole number of repeats around the stem; v grows by
//! length over local circumference, so texels stay square while the stem thins.

use std::f32::consts::TAU;

use glam::Vec3;

use super::budget::Budget;
use super::params::TreeParams;
use super::shade::Shade;
use super::skeleton::{Skeleton, Stem, perpendicular};
use crate::math::{lerp, lerp_array, smoothstep, unit_to_byte};
use crate::model::{Material, Mesh, Part, PartKind, is_dead};

/// Metres of bark that one repeat of the texture covers on the trunk.
const TILE_M: f32 = 0.9;
/// Sides of the trunk's tube when it has roots.
const ROOT_SIDES: usize = 20;
/// Pale bark comes with age: twigs up to the first radius in metres are brown, branches from the second on are as the trunk.
const TWIGS_M: [f32; 2] = [0.016, 0.06];
/// Colour of twigs as a part of that of the palest bark.
const TWIG: [f32; 3] = [0.24, 0.17, 0.155];
/// Values of `bark_tone` up to which twigs are as the trunk, and from which they are [`TWIG`].
const PALE: [f32; 2] = [0.6, 1.0];

/// A place along a stem where a ring of vertices goes.
#[derive(Clone, Copy)]
struct Station {
    at: Vec3,
    radius_m: f32,
    /// Height above the ground for the flare of roots; `None` on stems without roots.
    root_m: Option<f32>,
}

/// The shape of the roots.
struct Roots {
    flare: f32,
    lobes: f32,
    phase: f32,
    reach_m: f32,
}

impl Roots {
    /// Factor on the trunk's radius at an angle around it and a height above the ground.
    fn factor(&self, angle: f32, height_m: f32) -> f32 {
        let near = libm::expf(-(height_m / self.reach_m).max(-0.35));
        let wave = self.lobes * angle + self.phase + 0.7 * libm::sinf(angle + 2.0 * self.phase);
        let lobe = 0.5 + 0.5 * libm::cosf(wave);
        // Lobes are sharp in the ground and fade into a fluted trunk above.
        let lobe = lobe * lobe.sqrt() * near + 0.36 * (1.0 - near);
        let flute = 1.0 + 0.035 * libm::cosf(wave);
        flute * (1.0 + self.flare * near * (0.16 + 0.9 * lobe))
    }

    /// 2π times this is about the circumference of a ring.
    fn round_m(&self, ring: &Station) -> f32 {
        let swell =
            |height_m: f32| 1.0 + 0.62 * self.flare * libm::expf(-(height_m / self.reach_m).max(-0.35));
        ring.radius_m * ring.root_m.map_or(1.0, swell)
    }
}

/// How a ring of vertices lies, and its place in the texture.
struct Frame {
    /// Direction of the ring's first vertex.
    x: Vec3,
    along: Vec3,
    /// Change of radius per metre.
    slope: f32,
    /// Repeats of the texture around the stem.
    repeats: f32,
    v: f32,
}

/// The mesh being made, and what all its tubes share.
struct Skin<'a> {
    mesh: Mesh,
    triangles: Vec<[u32; 3]>,
    shade: &'a Shade,
    roots: Roots,
    moss: f32,
    /// What the bark's texture is multiplied with on twigs.
    twig: [f32; 3],
    circles: Vec<Vec<[f32; 2]>>,
}

/// A mesh of one part: the bark of all stems.
pub(super) fn skin(params: &TreeParams, budget: &Budget, skeleton: &Skeleton, shade: &Shade) -> Mesh {
    let trunk_m = skeleton.stems.first().map_or(0.1, |stem| stem.radius_m);
    let roots = Roots {
        flare: params.root_flare * 0.9,
        lobes: 4.0 + (params.tree_seed % 3) as f32,
        phase: params.tree_seed as f32 * 0.7,
        reach_m: 1.15 * trunk_m + 0.08,
    };
    let stations: Vec<Vec<Station>> =
        skeleton.stems.iter().enumerate().map(|(i, stem)| stations(skeleton, stem, i == 0, &roots)).collect();
    let sides = budgeted_sides(skeleton, &stations, budget.max_bark_triangles as usize);
    let circles = (0..=ROOT_SIDES).map(|sides| circle(sides.max(1))).collect();
    let moss = 0.5 * (1.0 - params.bark_tone);
    // Dead wood is weathered all over.
    let is_even = params.is_cane() || is_dead(params.leaves_per_stem, params.secondary_branches);
    let darker = if is_even { 0.0 } else { smoothstep(PALE[0], PALE[1], params.bark_tone) };
    let twig = lerp_array([1.0; 3], TWIG, darker);
    let mut skin = Skin { mesh: Mesh::default(), triangles: Vec::new(), shade, roots, moss, twig, circles };
    for (index, stem) in skeleton.stems.iter().enumerate() {
        skin.tube(stem, &stations[index], sides[index], index);
    }
    let parts = vec![Part { material: Material::Bark, kind: PartKind::Surface, triangles: skin.triangles }];
    Mesh { parts, ..skin.mesh }
}

/// cos and sin around a circle of `sides`; the last is the first again, to the bit.
fn circle(sides: usize) -> Vec<[f32; 2]> {
    let point = |k: usize| {
        let (sin, cos) = libm::sincosf(TAU * (k % sides) as f32 / sides as f32);
        [cos, sin]
    };
    (0..=sides).map(point).collect()
}

/// Sides of each stem's tube, fewer and fewer until the budget is met.
fn budgeted_sides(skeleton: &Skeleton, stations: &[Vec<Station>], max: usize) -> Vec<usize> {
    let mut quality = 1.0;
    loop {
        let branches = skeleton.stems.iter().skip(1).map(|stem| sides(stem, quality));
        let sides: Vec<usize> = std::iter::once(ROOT_SIDES).chain(branches).collect();
        let triangles: usize = stations.iter().zip(&sides).map(|(s, &n)| s.len() * n * 2).sum();
        if triangles <= max || quality < 0.1 {
            return sides;
        }
        quality *= 0.85;
    }
}

fn sides(stem: &Stem, quality: f32) -> usize {
    let sides = 3.0 + quality * 13.0 * (stem.radius_m - 0.012).max(0.0).sqrt();
    let min = if stem.level == 0 { 8.0 * quality } else { 3.0 };
    (sides.max(min) as usize).clamp(3, 14)
}

/// Rings of one stem: its nodes, with more of them at the roots and at the collar where it leaves its parent.
fn stations(skeleton: &Skeleton, stem: &Stem, has_roots: bool, roots: &Roots) -> Vec<Station> {
    let nodes = &skeleton.nodes[stem.nodes.clone()];
    let (a, b) = (nodes[0], nodes[1]);
    let first_m = (b.at - a.at).length();
    let on_first = |s_m: f32, swell: f32, root_m: Option<f32>| {
        let f = s_m / first_m.max(1e-4);
        Station { at: a.at.lerp(b.at, f), radius_m: lerp(a.radius_m, b.radius_m, f) * swell, root_m }
    };
    let mut rings = Vec::with_capacity(nodes.len() + 7);
    if has_roots {
        let deep_m = 0.3_f32.max(0.7 * a.radius_m);
        rings.push(Station { at: a.at - Vec3::Y * deep_m, radius_m: a.radius_m, root_m: Some(-deep_m) });
        let heights_m = [0.0, 0.25, 0.6, 1.1, 1.8, 2.8, 4.2].map(|part| part * roots.reach_m);
        let near = heights_m.into_iter().filter(|&s_m| s_m < 0.9 * first_m);
        rings.extend(near.map(|s_m| on_first(s_m, 1.0, Some(s_m))));
    } else {
        rings.push(Station { at: a.at, radius_m: a.radius_m, root_m: None });
        let out_m = stem.parent_radius_m;
        if !stem.is_arm && a.radius_m > 0.02 && out_m + 2.2 * a.radius_m < 0.9 * first_m {
            // The collar: thickest where the branch comes out of its parent's bark.
            rings.push(on_first(0.9 * out_m, 1.45, None));
            rings.push(on_first(out_m + 1.6 * a.radius_m, 1.06, None));
        }
    }
    let rooted = |at: Vec3| has_roots.then_some(at.y);
    rings.extend(nodes[1..].iter().map(|n| Station { at: n.at, radius_m: n.radius_m, root_m: rooted(n.at) }));
    rings
}

impl Skin<'_> {
    /// One closed tube.
    fn tube(&mut self, stem: &Stem, rings: &[Station], sides: usize, index: usize) {
        let last = rings.len() - 1;
        let middle_m = rings[last / 3].radius_m;
        let repeats = (TAU * middle_m / TILE_M).round().max(1.0);
        let start = self.mesh.positions.len() as u32;
        // Each stem shows another part of the bark.
        let mut v = (index as f32 * 0.618_034).fract();
        let mut x = Vec3::ZERO;
        for (i, ring) in rings[..last].iter().enumerate() {
            let after = (rings[i + 1].at - ring.at).normalize_or(Vec3::Y);
            let before = if i == 0 { after } else { (ring.at - rings[i - 1].at).normalize_or(after) };
            let along = (before + after).normalize_or(after);
            x = if i == 0 { perpendicular(along) } else { x };
            x = (x - along * x.dot(along)).normalize_or(perpendicular(along));
            if i > 0 {
                let step_m = (ring.at - rings[i - 1].at).length();
                let mean_m = 0.5 * (self.roots.round_m(ring) + self.roots.round_m(&rings[i - 1]));
                v += step_m * repeats / (TAU * mean_m).max(1e-4);
            }
            let light = self.light(stem, ring, i);
            let frame = Frame { x, along, slope: slope_at(rings, i), repeats, v };
            self.ring(ring, &frame, light, sides);
        }
        self.tip(rings, sides, (repeats, v));
        self.triangles_of_tube(start, sides as u32, last as u32);
        if rings[0].root_m.is_some() {
            self.smooth_root_normals(start as usize, sides, last);
        }
    }

    fn ring(&mut self, ring: &Station, frame: &Frame, light: f32, sides: usize) {
        let &Frame { x, along, slope, repeats, v } = frame;
        let z = along.cross(x);
        let old = smoothstep(TWIGS_M[0], TWIGS_M[1], ring.radius_m);
        let bark = lerp_array(self.twig, [1.0; 3], old);
        for k in 0..=sides {
            let [cos, sin] = self.circles[sides][k];
            let out = x * cos + z * sin;
            let angle = TAU * (k % sides) as f32 / sides as f32;
            let swell = ring.root_m.map_or(1.0, |height_m| self.roots.factor(angle, height_m));
            let position = (ring.at + out * (ring.radius_m * swell)).to_array();
            self.mesh.positions.push(position);
            self.mesh.normals.push((out - along * slope).normalize_or(out).to_array());
            self.mesh.uvs.push([repeats * k as f32 / sides as f32, v]);
            self.mesh.colors.push(self.mossy(light, bark, out, ring));
        }
    }

    /// The last ring shrunk to a point: one vertex a side, all at the same place.
    fn tip(&mut self, rings: &[Station], sides: usize, (repeats, v): (f32, f32)) {
        let (end, before) = (rings[rings.len() - 1], rings[rings.len() - 2]);
        let along = (end.at - before.at).normalize_or(Vec3::Y);
        let length_m = (end.at - before.at).length();
        let v = v + length_m * repeats / (TAU * (0.6 * before.radius_m).max(0.001));
        let first = self.mesh.positions.len() - (sides + 1);
        for k in 0..sides {
            let [a, b] = [k, k + 1].map(|k| Vec3::from_array(self.mesh.normals[first + k]));
            let out = (a + b).normalize_or(along);
            self.mesh.positions.push(end.at.to_array());
            self.mesh.normals.push((out + along * 0.8).normalize_or(along).to_array());
            self.mesh.uvs.push([repeats * (k as f32 + 0.5) / sides as f32, v]);
            self.mesh.colors.push(self.mesh.colors[first + k]);
        }
    }

    /// Base cap, sides and tip of a tube of `rings` rings before its tip.
    fn triangles_of_tube(&mut self, start: u32, sides: u32, rings: u32) {
        let row = sides + 1;
        self.triangles.extend((1..sides - 1).map(|k| [start, start + k + 1, start + k]));
        for a in (0..rings - 1).map(|ring| start + ring * row) {
            let side = |k: u32| [[k, k + 1, k + row + 1], [k, k + row + 1, k + row]];
            self.triangles.extend((a..a + sides).flat_map(side));
        }
        let a = start + (rings - 1) * row;
        self.triangles.extend((a..a + sides).map(|k| [k, k + 1, k + row]));
    }

    /// Normals of lobed rings from their neighbours in the grid.
    fn smooth_root_normals(&mut self, start: usize, sides: usize, rings: usize) {
        let row = sides + 1;
        let at =
            |mesh: &Mesh, ring: usize, k: usize| Vec3::from_array(mesh.positions[start + ring * row + k]);
        for ring in 0..rings {
            let (below, above) = (ring.saturating_sub(1), (ring + 1).min(rings - 1));
            for k in 0..sides {
                let around = at(&self.mesh, ring, k + 1) - at(&self.mesh, ring, (k + sides - 1) % sides);
                let up = at(&self.mesh, above, k) - at(&self.mesh, below, k);
                let normal = &mut self.mesh.normals[start + ring * row + k];
                *normal = around.cross(up).normalize_or(Vec3::from_array(*normal)).to_array();
            }
            self.mesh.normals[start + ring * row + sides] = self.mesh.normals[start + ring * row];
        }
    }

    /// Light on a ring, darker in a crotch and near the ground.
    fn light(&self, stem: &Stem, ring: &Station, number: usize) -> f32 {
        let mut light = 0.25 + 0.75 * self.shade.at(ring.at);
        if stem.level > 0 && number < 2 {
            light *= 0.82;
        }
        if let Some(height_m) = ring.root_m {
            light *= 0.72 + 0.28 * (height_m.max(0.0) / (2.5 * ring.radius_m + 0.1)).min(1.0);
        }
        light
    }

    /// Moss on bark of a colour, near the ground on the north side (−z) and on top of branches.
    fn mossy(&self, light: f32, bark: [f32; 3], out: Vec3, ring: &Station) -> [u8; 4] {
        let low = (1.0 - ring.at.y / 2.5).clamp(0.0, 1.0);
        let moss = self.moss * (low * (0.35 - 0.65 * out.z).max(0.0) + 0.18 * out.y.max(0.0));
        let parts = [0.55, 0.15, 0.7];
        let [r, g, b] = [0, 1, 2].map(|k| unit_to_byte(light * (1.0 - parts[k] * moss) * bark[k]));
        [r, g, b, 255]
    }
}

/// Change of radius per metre along the stem.
fn slope_at(rings: &[Station], i: usize) -> f32 {
    let (a, b) = (&rings[i.saturating_sub(1)], &rings[(i + 1).min(rings.len() - 2)]);
    let length_m = (b.at - a.at).length();
    if length_m < 1e-4 { 0.0 } else { ((b.radius_m - a.radius_m) / length_m).clamp(-1.0, 1.0) }
}
