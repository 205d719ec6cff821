//! The ring of coarse land around the field, in sectors, so that what is behind the eye can be left out.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;

use super::Uploader;
use super::far_sun::FarSun;
use crate::camera::Frustum;
use crate::scene::Apron;

/// How far a curtain hangs down from the ring's inner edge: more than the field's edge can lie below it.
const CURTAIN_M: f32 = 40.0;

/// Sectors of a full turn: a picture sees a quarter of it and a little more.
const SECTORS: usize = 24;

/// The ring on the device.
#[derive(Debug)]
pub struct Ring {
    /// [`RingVertex`].
    pub vertices: wgpu::Buffer,
    /// Triangles, 32-bit, sector by sector.
    pub indices: wgpu::Buffer,
    sectors: Vec<Sector>,
}

/// The box around a part of the ring, and its part of all indices.
#[derive(Clone, Debug, PartialEq)]
struct Sector {
    low_m: Vec3,
    high_m: Vec3,
    indices: Range<u32>,
}

/// A vertex of the ring.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct RingVertex {
    /// Metres.
    pub position_m: [f32; 3],
    /// Unit length.
    pub normal: [f32; 3],
    /// Linear albedo; in alpha, the share of the sun that the land around leaves.
    pub color_and_sun: [u8; 4],
    /// [`Apron::weights`].
    pub weights: [u8; 4],
}

impl Uploader {
    pub(super) fn ring(&self, apron: &Apron, half_m: f32, sun: &FarSun) -> Ring {
        let (vertices, indices) = ring(apron, half_m, sun);
        let (indices, sectors) = sectors(&vertices, &indices);
        Ring {
            vertices: self.gpu.buffer("ring", &vertices, wgpu::BufferUsages::VERTEX),
            indices: self.gpu.buffer("ring triangles", &indices, wgpu::BufferUsages::INDEX),
            sectors,
        }
    }
}

impl Ring {
    /// What of its indices may be seen, into `out`, which is emptied first.
    pub fn seen(&self, frustum: &Frustum, out: &mut Vec<Range<u32>>) {
        seen(&self.sectors, frustum, out);
    }

    /// Draws these parts of its indices and tells how many draws that takes.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, parts: &[Range<u32>]) -> u32 {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        parts.iter().for_each(|part| pass.draw_indexed(part.clone(), 0, 0..1));
        parts.len() as u32
    }
}

/// Sectors beside each other make one range.
fn seen(sectors: &[Sector], frustum: &Frustum, out: &mut Vec<Range<u32>>) {
    out.clear();
    for sector in sectors.iter().filter(|sector| frustum.sees_box(sector.low_m, sector.high_m)) {
        match out.last_mut() {
            Some(last) if last.end == sector.indices.start => last.end = sector.indices.end,
            _ => out.push(sector.indices.clone()),
        }
    }
}

/// Triangles in the order of their directions from the middle, and where each sector's are.
fn sectors(vertices: &[RingVertex], indices: &[u32]) -> (Vec<u32>, Vec<Sector>) {
    let place_m = |index: &u32| Vec3::from(vertices[*index as usize].position_m);
    let mut by_sector: [Vec<u32>; SECTORS] = Default::default();
    for triangle in indices.chunks_exact(3) {
        let middle_m: Vec3 = triangle.iter().map(place_m).sum();
        let turn = libm::atan2f(middle_m.z, middle_m.x) / std::f32::consts::TAU + 0.5;
        by_sector[((turn * SECTORS as f32) as usize).min(SECTORS - 1)].extend(triangle);
    }
    let mut end = 0;
    let sector = |indices: &Vec<u32>| {
        let start = end;
        end += indices.len() as u32;
        let places = || indices.iter().map(place_m);
        let (low_m, high_m) = (places().fold(Vec3::MAX, Vec3::min), places().fold(Vec3::MIN, Vec3::max));
        Sector { low_m, high_m, indices: start..end }
    };
    let sectors = by_sector.iter().map(sector).filter(|sector| !sector.indices.is_empty()).collect();
    (by_sector.concat(), sectors)
}

/// The ring with a curtain below its inner edge. The field's edge moves with its level of detail, the ring's doesn't:
/// where the field's sinks below, the curtain closes the gap as seen from inside the field, where walkers are.
fn ring(apron: &Apron, half_m: f32, sun: &FarSun) -> (Vec<RingVertex>, Vec<u32>) {
    let vertex = |v: usize| {
        let (position_m, [r, g, b, _]) = (apron.positions_m[v], apron.colors[v]);
        let left = (255.0 * sun.left(position_m.into()) + 0.5) as u8;
        let (normal, weights) = (apron.normals[v], apron.weights[v]);
        RingVertex { position_m, normal, color_and_sun: [r, g, b, left], weights }
    };
    let mut vertices: Vec<RingVertex> = (0..apron.positions_m.len()).into_par_iter().map(vertex).collect();
    let mut indices: Vec<u32> = apron.triangles.as_flattened().to_vec();
    for [a, b] in inner_edges(apron, half_m) {
        let first = vertices.len() as u32;
        for end in [a, b] {
            let mut below = vertices[end as usize];
            below.position_m[1] -= CURTAIN_M;
            vertices.push(below);
        }
        // Both windings: a curtain has no front.
        for [p, q, r] in [[a, b, first], [b, first + 1, first]] {
            indices.extend([p, q, r, q, p, r]);
        }
    }
    (vertices, indices)
}

/// Edges that only one triangle has and that lie along the field's border.
fn inner_edges(apron: &Apron, half_m: f32) -> Vec<[u32; 2]> {
    let mut uses: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for &[a, b, c] in &apron.triangles {
        for edge in [[a, b], [b, c], [c, a]] {
            let [p, q] = edge;
            *uses.entry([p.min(q), p.max(q)]).or_default() += 1;
        }
    }
    let on_border = |v: u32| {
        let [x, _, z] = apron.positions_m[v as usize];
        (x.abs().max(z.abs()) - half_m).abs() < 1e-3 * half_m
    };
    uses.into_iter()
        .filter(|&([a, b], count)| count == 1 && on_border(a) && on_border(b))
        .map(|(edge, _)| edge)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;
    use crate::scene::Heightfield;

    #[test]
    fn a_curtain_hangs_from_every_inner_edge_and_from_no_other() {
        // A frame of eight vertices around a square of 2 m.
        let corners =
            |half: f32, y: f32| [[-half, y, -half], [half, y, -half], [half, y, half], [-half, y, half]];
        let positions_m = [corners(1.0, 5.0), corners(3.0, 0.0)].concat();
        let triangles = (0..4u32).flat_map(|k| {
            let next = (k + 1) % 4;
            [[k, next, 4 + k], [next, 4 + next, 4 + k]]
        });
        let apron = Apron {
            normals: vec![[0.0, 1.0, 0.0]; 8],
            colors: vec![[100; 4]; 8],
            weights: vec![[30; 4]; 8],
            triangles: triangles.collect(),
            positions_m,
        };
        assert_eq!(inner_edges(&apron, 1.0), [[0, 1], [0, 3], [1, 2], [2, 3]]);
        let sun =
            FarSun::of(&Heightfield { side: 3, spacing_m: 1.0, heights_m: vec![5.0; 9] }, &apron, Vec3::Y);
        let (vertices, indices) = ring(&apron, 1.0, &sun);
        assert_eq!((vertices.len(), indices.len()), (8 + 8, 8 * 3 + 4 * 12));
        assert!(vertices[8..].iter().all(|v| v.position_m[1] == 5.0 - CURTAIN_M));
    }

    /// A flat ring of 2 × `quads` triangles.
    fn flat_ring(quads: u32) -> (Vec<RingVertex>, Vec<u32>) {
        let vertex = |number: u32| {
            let (sin, cos) = libm::sincosf((number / 2) as f32 / quads as f32 * std::f32::consts::TAU);
            let away_m = if number & 1 == 0 { 500.0 } else { 4000.0 };
            RingVertex {
                position_m: [away_m * cos, 0.0, away_m * sin],
                normal: [0.0, 1.0, 0.0],
                color_and_sun: [0; 4],
                weights: [0; 4],
            }
        };
        let quad = |q: u32| [0, 1, 2, 2, 1, 3].map(|corner| (2 * q + corner) % (2 * quads));
        ((0..2 * quads).map(vertex).collect(), (0..quads).flat_map(quad).collect())
    }

    #[test]
    fn what_is_seen_of_the_ring_is_drawn_and_most_of_the_rest_is_not() {
        let (vertices, indices) = flat_ring(240);
        let (sorted, sectors) = sectors(&vertices, &indices);
        let triangles = |indices: &[u32]| {
            let mut all: Vec<[u32; 3]> = indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
            all.sort_unstable();
            all
        };
        assert_eq!(triangles(&sorted), triangles(&indices));
        for step in 0..40 {
            let (yaw_rad, fov_y_rad) = (step as f32 * 0.17, 1.0);
            let camera =
                Camera { position_m: Vec3::new(90.0, 2.0, -70.0), yaw_rad, pitch_rad: 0.0, fov_y_rad };
            let (frustum, mut ranges) = (camera.frustum(1.7), Vec::new());
            seen(&sectors, &frustum, &mut ranges);
            let drawn = |at: usize| ranges.iter().any(|range| range.contains(&(at as u32)));
            for (at, index) in sorted.iter().enumerate() {
                let place_m = Vec3::from(vertices[*index as usize].position_m);
                assert!(drawn(at) || !frustum.sees_sphere(place_m, 0.0), "{place_m} at {yaw_rad}");
            }
            let count: usize = ranges.iter().map(ExactSizeIterator::len).sum();
            assert!(2 * count <= sorted.len() && ranges.len() <= 2, "{count} in {ranges:?}");
        }
    }
}
