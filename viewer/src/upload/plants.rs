//! Shapes of small plants and stones → two buffers, and where each kind grows at all.

use std::f32::consts::TAU;
use std::ops::Range;

use genescape_schema::scene::{PlantKind, PlantShape};
use glam::{Vec2, Vec3, Vec3Swizzles};

use super::{Uploader, leaves};
use crate::scene::Ground;

/// Metres a side of the blocks in which plants are looked for.
pub const PLANT_BLOCK_M: f32 = 8.0;

/// The shapes of a landscape's plants.
#[derive(Debug)]
pub struct PlantBuffers {
    /// [`PlantVertex`].
    pub vertices: wgpu::Buffer,
    /// Triangles of all kinds, 32-bit.
    pub indices: wgpu::Buffer,
    /// In the order of the scene's kinds.
    pub kinds: Vec<PlantBuffersOfKind>,
}

/// The part of one kind.
#[derive(Debug)]
pub struct PlantBuffersOfKind {
    /// Its indices.
    pub fine: Range<u32>,
    /// Those that are enough from afar.
    pub coarse: Range<u32>,
    /// Those of its leaves, several in the place of each; empty where none of them is a triangle by itself.
    pub leafy: Range<u32>,
    /// Those of the ground around its foot, see [`foot`]; empty of what is no rock or old wood.
    pub foot: Range<u32>,
    /// Blocks a side of the field.
    side: i32,
    /// Whether it grows in a block, row by row from the north-west.
    grows: Vec<bool>,
}

/// A corner of a shape.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct PlantVertex {
    /// Metres.
    pub position: [f32; 3],
    /// Unit length.
    pub normal: [f32; 3],
    /// 0 has the first colour, 1 the second.
    pub tint: f32,
}

impl PlantBuffersOfKind {
    /// `indices`: those of its shape within all.
    pub fn new(ground: &Ground, kind: &PlantKind, indices: Range<u32>) -> Self {
        let side = 2 * (0.5 * ground.field.extent_m() / PLANT_BLOCK_M).ceil() as i32;
        let coarse = indices.start..(indices.start + 3 * kind.shape.coarse).min(indices.end);
        let none = indices.end..indices.end;
        let (leafy, foot) = (none.clone(), none);
        Self { fine: indices, coarse, leafy, foot, side, grows: grows(ground, kind, side) }
    }

    /// Whether the kind grows in a block, which is numbered from the middle of the field.
    pub fn grows_in(&self, [x, z]: [i32; 2]) -> bool {
        let (column, row) = (x + self.side / 2, z + self.side / 2);
        let inside = (0..self.side).contains(&column) && (0..self.side).contains(&row);
        inside && self.grows[(row * self.side + column) as usize]
    }
}

impl Uploader {
    pub(super) fn plants(&self, ground: &Ground) -> PlantBuffers {
        let (mut vertices, mut indices, mut kinds) = (Vec::new(), Vec::new(), Vec::new());
        for kind in &ground.surface.plants.kinds {
            let (base, first) = (vertices.len() as u32, indices.len() as u32);
            let shape = &kind.shape;
            let points = shape.positions_m.iter().zip(&shape.normals).zip(&shape.tints);
            vertices.extend(points.map(|((&position, &normal), &tint)| PlantVertex {
                position,
                normal,
                tint,
            }));
            indices.extend(shape.triangles.as_flattened().iter().map(|v| v + base));
            let mut buffers = PlantBuffersOfKind::new(ground, kind, first..indices.len() as u32);
            if kind.texture.is_some() {
                let base = vertices.len() as u32;
                vertices.extend(foot(shape));
                indices.extend(ring().map(|v| v + base));
                buffers.foot.end = indices.len() as u32;
            } else {
                let triangles = triangles(&vertices[base as usize..], shape);
                let (coarse, fine) = triangles.split_at(triangles.len().min(shape.coarse as usize));
                if !fine.is_empty() {
                    buffers.coarse = append(&mut vertices, &mut indices, &as_bright(coarse, &triangles));
                }
                let leafy = leaves::several_for_each(coarse, fine).unwrap_or_default();
                buffers.leafy = append(&mut vertices, &mut indices, &leafy);
            }
            kinds.push(buffers);
        }
        PlantBuffers {
            vertices: self.gpu.buffer("plants", &vertices, wgpu::BufferUsages::VERTEX),
            indices: self.gpu.buffer("triangles of plants", &indices, wgpu::BufferUsages::INDEX),
            kinds,
        }
    }
}

/// Adds triangles, three corners each; their indices.
fn append(vertices: &mut Vec<PlantVertex>, indices: &mut Vec<u32>, corners: &[PlantVertex]) -> Range<u32> {
    let (start, base) = (indices.len() as u32, vertices.len() as u32);
    indices.extend(base..base + corners.len() as u32);
    vertices.extend(corners);
    start..indices.len() as u32
}

/// The triangles of a shape with these corners.
fn triangles(corners: &[PlantVertex], shape: &PlantShape) -> Vec<[PlantVertex; 3]> {
    let corner = |number: u32| corners.get(number as usize).copied();
    shape.triangles.iter().filter_map(|&[a, b, c]| Some([corner(a)?, corner(b)?, corner(c)?])).collect()
}

/// The corners of the triangles that are enough from afar, tinted as the whole is on the mean: inside a bush it is dark, and what
/// hides that is left out there.
fn as_bright(coarse: &[[PlantVertex; 3]], whole: &[[PlantVertex; 3]]) -> Vec<PlantVertex> {
    let (whole, part) = (mean_tint(whole), mean_tint(coarse));
    let lift = ((whole - part) / (1.0 - part).max(1e-3)).clamp(0.0, 1.0);
    let lifted =
        |corner: &PlantVertex| PlantVertex { tint: corner.tint + lift * (1.0 - corner.tint), ..*corner };
    coarse.as_flattened().iter().map(lifted).collect()
}

/// Weighted with areas.
fn mean_tint(triangles: &[[PlantVertex; 3]]) -> f32 {
    let (mut sum, mut area) = (0.0, 0.0);
    for triangle in triangles {
        let [a, b, c] = triangle.map(|corner| Vec3::from(corner.position));
        let doubled = (b - a).cross(c - a).length();
        sum += doubled * triangle.iter().map(|corner| corner.tint).sum::<f32>() / 3.0;
        area += doubled;
    }
    sum / area.max(f32::MIN_POSITIVE)
}

/// Corners of the edge of a foot.
const FOOT_CORNERS: u32 = 8;
/// How far the ring around a foot reaches under what stands there, as a part of its width, and beyond, as a part of its height.
const UNDER: f32 = 0.4;
const BEYOND: f32 = 0.9;

/// The ground around the foot of a shape, which it shades: a ring of which the inner corners, with a tint of 1, and the outer
/// ones, with 0, take turns.
fn foot(shape: &PlantShape) -> Vec<PlantVertex> {
    let places = || shape.positions_m.iter().copied().map(Vec3::from);
    let height_m = places().fold(0.0, |highest: f32, place| highest.max(place.y));
    let low = || places().filter(|place| place.y < 0.5 * height_m).map(Vec3::xz);
    let corners = |number: u32| {
        let way = Vec2::from_angle(number as f32 / FOOT_CORNERS as f32 * TAU);
        let reach_m = low().fold(0.0, |farthest: f32, place| farthest.max(place.dot(way)));
        [(reach_m * (1.0 - UNDER), 1.0), (reach_m + BEYOND * height_m, 0.0)].map(|(away_m, tint)| {
            PlantVertex { position: [way.x * away_m, 0.0, way.y * away_m], normal: [0.0, 1.0, 0.0], tint }
        })
    };
    (0..FOOT_CORNERS).flat_map(corners).collect()
}

/// The triangles of a ring whose corners lie so.
fn ring() -> impl Iterator<Item = u32> {
    (0..FOOT_CORNERS).flat_map(|k| {
        let [inner, outer] = [2 * k, 2 * k + 1];
        let [next, next_outer] = [inner, outer].map(|corner| (corner + 2) % (2 * FOOT_CORNERS));
        [inner, outer, next, next, outer, next_outer]
    })
}

/// Whether a kind grows in each of the blocks or right beside it, for a cell may reach beyond its block.
fn grows(ground: &Ground, kind: &PlantKind, side: i32) -> Vec<bool> {
    let mut grows = vec![false; (side * side) as usize];
    let Some(map) = ground.plant_map(kind) else { return grows };
    let blocks = ground.field.extent_m() / PLANT_BLOCK_M;
    let [across, down] = [map.width_px, map.height_px].map(|size| blocks / size.max(1) as f32);
    let block = |pixel: usize, size: f32| {
        let from_middle = (pixel as f32 + 0.5) * size - 0.5 * blocks;
        from_middle.floor() as i32 + side / 2
    };
    let channel = kind.channel as usize % 4;
    for (k, _) in map.rgba.chunks_exact(4).enumerate().filter(|(_, pixel)| pixel[channel] > 0) {
        let width = map.width_px.max(1) as usize;
        let (x, z) = (block(k % width, across), block(k / width, down));
        for z in (z - 1).max(0)..=(z + 1).min(side - 1) {
            for x in (x - 1).max(0)..=(x + 1).min(side - 1) {
                grows[(z * side + x) as usize] = true;
            }
        }
    }
    grows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn from_afar_a_plant_is_as_bright_as_near_by() {
        let corner =
            |x: f32, tint: f32| PlantVertex { position: [x, x * x, 0.0], normal: [0.0, 0.0, 1.0], tint };
        // A dark triangle within, and a bright one before it.
        let corners = [
            corner(0.0, 0.1),
            corner(1.0, 0.2),
            corner(2.0, 0.3),
            corner(0.0, 0.8),
            corner(1.0, 0.9),
            corner(2.0, 1.0),
        ];
        let shape = PlantShape { triangles: vec![[0, 1, 2], [3, 4, 5]], ..PlantShape::default() };
        let whole = triangles(&corners, &shape);
        let mean = |corners: &[PlantVertex]| mean_tint(corners.as_chunks().0);
        let dark = as_bright(&whole[..1], &whole);
        assert_eq!(dark.len(), 3);
        assert!((mean(&dark) - mean(&corners)).abs() < 1e-5, "{} of {}", mean(&dark), mean(&corners));
        assert!(dark[0].tint < dark[2].tint, "its inside stays darker");
        assert_eq!(as_bright(&whole, &whole), corners, "nothing is left out");
    }

    #[test]
    fn the_ground_around_a_foot_begins_under_it() {
        // A trunk along x, 3 m long, half a metre high, that leans over its end at the top.
        let positions_m = [[-1.5, 0.0, 0.2], [1.5, 0.1, -0.2], [1.5, 0.0, 0.2], [9.0, 0.5, 0.0]];
        let foot = foot(&PlantShape { positions_m: positions_m.to_vec(), ..PlantShape::default() });
        let away_m = |k: usize| libm::hypotf(foot[k].position[0], foot[k].position[2]);
        for (first, reach_m) in [(0, 1.5), (4, 0.2), (8, 1.5), (12, 0.2)] {
            assert!((away_m(first) - 0.6 * reach_m).abs() < 1e-5, "{} of {reach_m}", away_m(first));
            assert!((away_m(first + 1) - reach_m - 0.45).abs() < 1e-5, "{}", away_m(first + 1));
            assert_eq!([foot[first].tint, foot[first + 1].tint], [1.0, 0.0]);
        }
        let used: std::collections::BTreeSet<u32> = ring().collect();
        assert_eq!((used.len(), ring().count()), (foot.len(), 3 * foot.len()));
    }
}
