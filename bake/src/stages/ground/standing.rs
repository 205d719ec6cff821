//! Maps of small plants and the foreground → those around the eye as plain triangles among the blades of grass, where a
//! viewer of `GSC_heightfield` has them, too. Metres.

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};

use super::cover::KINDS;
use super::grass::BLADE_WHITE;
use super::patch::{Patch, SIDE_M, plan};
use super::textures::{TILE_MEAN, factor_on};
use crate::math::{lerp, lerp_array};
use crate::model::{
    DensityMap, GroundPlants, Image8, Material, Mesh, Part, PartKind, Plant, PlantKind, StartView, Tiled,
    ground_m,
};

/// Metres from the eye to the last of them: files are to stay small.
const REACH_M: f32 = 40.0;
/// Metres around the eye that stay free.
const FREE_M: f32 = 0.8;
/// Part of its reach up to which a kind shows all its triangles.
const FINE: f32 = 0.35;
/// Triangles of all of them, for the same reason.
pub(super) const MAX_TRIANGLES: usize = 36_000;

/// Leaves let light through, which glTF's core cannot say, and stand in each other's shade, so that green tufts would be nearly
/// black: they are lighter by this factor, petals less.
const THROUGH: f32 = 1.25;
/// Albedo of what is as light as it is.
const PALE: f32 = 0.5;

/// A plant near the eye.
struct Standing<'a> {
    kind: &'a PlantKind,
    plant: Plant,
    triangles: &'a [[u32; 3]],
}

/// Adds the plants on the piece of ground to the mesh of its grass, as a part of their own: `Material::Foreign(6)`. Gives what is
/// textured among them.
pub(super) fn stand(
    plants: &GroundPlants<Image8>,
    patch: &Patch<'_>,
    view: &StartView,
    grass: &mut Mesh,
) -> Tiled {
    let mut near: Vec<Standing<'_>> =
        plants.kinds.iter().flat_map(|kind| around(plants, kind, patch, view)).collect();
    // Where there are too many, those of the lowest ranks stand for all.
    near.sort_by(|a, b| a.plant.rank.total_cmp(&b.plant.rank));
    let material = Material::Foreign(KINDS as u32 + 1);
    grass.parts.push(Part { material, kind: PartKind::Surface, triangles: Vec::new() });
    let mut left = MAX_TRIANGLES;
    near.retain(|standing| {
        let rest = left.checked_sub(standing.triangles.len());
        left = rest.unwrap_or(0);
        rest.is_some()
    });
    let (rough, leafy): (Vec<_>, Vec<_>) =
        near.into_iter().partition(|standing| standing.kind.texture.is_some());
    leafy.iter().for_each(|standing| add(grass, standing, patch, view.position_m));
    tiled(&rough, patch)
}

/// Those of one kind.
fn around<'a>(
    plants: &GroundPlants<Image8>,
    kind: &'a PlantKind,
    patch: &Patch<'_>,
    view: &StartView,
) -> Vec<Standing<'a>> {
    let Some(map) = plants.maps.get(kind.channel as usize / 4) else { return Vec::new() };
    let map = DensityMap { width_px: map.width, height_px: map.height, rgba: &map.data };
    let extent_m = patch.land.field.extent_m();
    let density = |x: f32, z: f32| map.at(kind.channel, x / extent_m + 0.5, z / extent_m + 0.5);
    let eye = plan(view.position_m.to_array());
    let reach_m = kind.reach_m.min(REACH_M);
    let lines = |from: f32| (from / kind.cell_m()) as i32 - 1..=((from + SIDE_M) / kind.cell_m()) as i32 + 1;
    let cells = lines(patch.corner.y).flat_map(|j| lines(patch.corner.x).map(move |i| [i, j]));
    let standing = |plant: Plant| {
        let place = Vec2::new(plant.x_m, plant.z_m);
        let away_m = place.distance(eye);
        let is_here = (FREE_M..reach_m).contains(&away_m)
            && patch.inward(place) > 0.0
            // Fewer the farther away.
            && plant.rank < 1.5 - away_m / reach_m;
        let count = if away_m < FINE * kind.reach_m {
            kind.shape.triangles.len()
        } else {
            kind.shape.coarse as usize
        };
        is_here.then(|| Standing { kind, plant, triangles: &kind.shape.triangles[..count] })
    };
    cells.filter_map(|cell| kind.in_cell(cell, density)).filter_map(standing).collect()
}

/// Factor on the albedo of a leaf.
fn through(albedo: [f32; 3]) -> f32 {
    let palest = albedo.into_iter().fold(0.0, f32::max);
    lerp(THROUGH, 1.0, (palest / PALE).min(1.0))
}

/// How a plant stands on a piece of ground.
struct Pose<'a> {
    patch: &'a Patch<'a>,
    cos_sin: [f32; 2],
    scale: f32,
    middle: Vec2,
    middle_m: f32,
}

impl<'a> Pose<'a> {
    fn of(plant: &Plant, patch: &'a Patch<'a>) -> Self {
        let (sin, cos) = libm::sincosf(plant.turn_rad);
        let middle = Vec2::new(plant.x_m, plant.z_m);
        Self { patch, cos_sin: [cos, sin], scale: plant.scale, middle, middle_m: patch.height_m(middle) }
    }

    fn turned(&self, v: [f32; 3]) -> Vec3 {
        let [cos, sin] = self.cos_sin;
        Vec3::new(cos * v[0] - sin * v[2], v[1], sin * v[0] + cos * v[2])
    }

    /// Where a corner of its shape is, each on its own ground.
    fn placed(&self, position: [f32; 3]) -> [f32; 3] {
        let offset = self.scale * self.turned(position);
        let place = self.middle + Vec2::new(offset.x, offset.z);
        let height_m = ground_m(self.patch.height_m(place), self.middle_m, place.distance(self.middle));
        [place.x, height_m + offset.y, place.y]
    }
}

impl Standing<'_> {
    fn albedo(&self, tint: f32) -> [f32; 3] {
        let [root, tip] = self.kind.colors[self.plant.color as usize];
        lerp_array(root, tip, tint)
    }
}

fn add(mesh: &mut Mesh, standing: &Standing<'_>, patch: &Patch<'_>, eye: Vec3) {
    let Standing { kind, triangles, .. } = standing;
    let shape = &kind.shape;
    let pose = Pose::of(&standing.plant, patch);
    let base = mesh.positions.len() as u32;
    let corners = shape.positions_m.iter().zip(&shape.normals).zip(&shape.tints);
    let used = triangles.as_flattened().iter().max().map_or(0, |&last| last as usize + 1);
    for ((&position, &normal), &tint) in corners.take(used) {
        mesh.positions.push(pose.placed(position));
        mesh.normals.push(pose.turned(normal).to_array());
        let albedo = standing.albedo(tint);
        let light = if kind.sway > 0.0 { through(albedo) } else { 1.0 };
        mesh.colors.push(factor_on(BLADE_WHITE, albedo.map(|c| light * c)));
    }
    for corners in *triangles {
        let corners = corners.map(|v| v + base);
        let seen = if kind.sway > 0.0 { turned_to(eye, corners, mesh) } else { corners };
        mesh.parts[1].triangles.push(seen);
    }
}

/// Metres that a tile covers on a stone, which shows less of it than the ground does.
pub(super) const STONE_TILE_M: f32 = 1.3;

/// What is rough, a part for each texture, which is seen along the axis that each triangle faces most.
fn tiled(rough: &[Standing<'_>], patch: &Patch<'_>) -> Tiled {
    let Tiled { mut mesh, mut map_uvs } = Tiled::default();
    let extent_m = patch.land.field.extent_m();
    for (texture, &white) in TILE_MEAN.iter().enumerate() {
        let mut part = Vec::new();
        for standing in rough.iter().filter(|one| one.kind.texture == Some(texture as u32)) {
            let shape = &standing.kind.shape;
            let pose = Pose::of(&standing.plant, patch);
            let mut numbers = BTreeMap::new();
            for triangle in standing.triangles {
                let [a, b, c] = triangle.map(|v| Vec3::from_array(shape.positions_m[v as usize]));
                let axis = (b - a).cross(c - a).abs().max_position();
                part.push(triangle.map(|v| {
                    *numbers.entry((v, axis)).or_insert_with(|| {
                        let (v, position) = (v as usize, shape.positions_m[v as usize]);
                        let at = pose.placed(position);
                        mesh.positions.push(at);
                        mesh.normals.push(pose.turned(shape.normals[v]).to_array());
                        mesh.colors.push(factor_on(white, standing.albedo(shape.tints[v])));
                        let [x, y, z] = position.map(|along| standing.plant.scale * along / STONE_TILE_M);
                        mesh.uvs.push([[z, -y], [x, z], [x, -y]][axis]);
                        map_uvs.push((plan(at) / extent_m + 0.5).to_array());
                        mesh.positions.len() as u32 - 1
                    })
                }));
            }
        }
        let material = Material::Foreign(texture as u32);
        mesh.parts.push(Part { material, kind: PartKind::Surface, triangles: part });
    }
    Tiled { mesh, map_uvs }
}

/// A leaf with its front towards the eye, and its normals on that side, too: renderers turn the normals of what is seen from
/// behind, and a blade that is lit as if it faced upwards would then be lit from below. Leaves share no corners.
fn turned_to(eye: Vec3, [a, b, c]: [u32; 3], mesh: &mut Mesh) -> [u32; 3] {
    let [at_a, at_b, at_c] = [a, b, c].map(|v| Vec3::from_array(mesh.positions[v as usize]));
    let across = (at_b - at_a).cross(at_c - at_a).normalize_or(Vec3::Y);
    let is_seen = across.dot(eye - at_a) >= 0.0;
    let front = if is_seen { across } else { -across };
    for v in [a, b, c] {
        let normal = &mut mesh.normals[v as usize];
        let lit = Vec3::from_array(*normal);
        if lit.dot(front) < 0.0 {
            *normal = lit.reflect(front).to_array();
        }
    }
    if is_seen { [a, b, c] } else { [a, c, b] }
}
