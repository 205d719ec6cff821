//! The land's textures and the ring of coarse land around it.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::{ImageUse, PlantBuffers, Uploader};
use crate::lod::quadtree;
use crate::scene::{Apron, Ground, GroundDetail, Image};

/// How far a curtain hangs down from the ring's inner edge: more than the field's edge can lie below it.
const CURTAIN_M: f32 = 40.0;

/// The land on the device.
#[derive(Debug)]
pub struct GroundBuffers {
    /// How far its coarser triangulations are from it.
    pub errors: quadtree::Errors,
    /// One float a sample.
    pub heights: Arc<wgpu::Texture>,
    /// Albedo over the field.
    pub color: Arc<wgpu::Texture>,
    /// Parts of the tiling textures 1 to 4.
    pub weights: Arc<wgpu::Texture>,
    /// Light that arrives: sky, sun, visibility of the sun.
    pub light: Arc<wgpu::Texture>,
    /// Tiling textures, a layer each.
    pub details: Arc<wgpu::Texture>,
    /// Their normals.
    pub detail_normals: Arc<wgpu::Texture>,
    /// Metres that each tile covers.
    pub tiles_m: [f32; 5],
    /// The ring's vertices: [`RingVertex`].
    pub ring_vertices: wgpu::Buffer,
    /// Its triangles, 32-bit.
    pub ring_indices: wgpu::Buffer,
    /// How many.
    pub ring_index_count: u32,
    /// What stands and lies on it.
    pub plants: PlantBuffers,
}

/// A vertex of the ring.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct RingVertex {
    /// Metres.
    pub position_m: [f32; 3],
    /// Unit length.
    pub normal: [f32; 3],
    /// Linear albedo.
    pub color: [u8; 4],
}

impl Uploader {
    pub(super) fn ground(&self, ground: &Ground) -> Result<GroundBuffers, String> {
        let surface = &ground.surface;
        let half_m = 0.5 * ground.field.extent_m();
        let (vertices, indices) = ring(&ground.apron, half_m);
        let pick = |choose: fn(&GroundDetail<Image>) -> &Image| {
            surface.details.iter().map(choose).collect::<Vec<_>>()
        };
        if surface.details.len() != 5 {
            return Err(format!("the ground has {} tiling textures instead of 5", surface.details.len()));
        }
        if ground.field.side <= 1 << quadtree::BLOCK_BITS {
            let side = ground.field.side;
            return Err(format!("a heightfield of {side} samples a side is too small to be drawn"));
        }
        Ok(GroundBuffers {
            errors: quadtree::Errors::of(&ground.field),
            heights: self.heights(&ground.name, ground.field.side, &ground.field.heights_m),
            color: self.image(&surface.color, ImageUse::Color),
            weights: self.image(&surface.weights, ImageUse::Data),
            light: self.image(&surface.light, ImageUse::Data),
            details: self.layers(&pick(|detail| &detail.detail), ImageUse::Data)?,
            detail_normals: self.layers(&pick(|detail| &detail.normal), ImageUse::Data)?,
            tiles_m: std::array::from_fn(|layer| surface.details[layer].tile_m),
            ring_vertices: self.gpu.buffer("ring", &vertices, wgpu::BufferUsages::VERTEX),
            ring_indices: self.gpu.buffer("ring triangles", &indices, wgpu::BufferUsages::INDEX),
            ring_index_count: indices.len() as u32,
            plants: self.plants(ground),
        })
    }
}

/// The ring with a curtain below its inner edge. The field's edge moves with its level of detail, the ring's doesn't:
/// where the field's sinks below, the curtain closes the gap as seen from inside the field, where walkers are.
fn ring(apron: &Apron, half_m: f32) -> (Vec<RingVertex>, Vec<u32>) {
    let vertex = |v: usize| RingVertex {
        position_m: apron.positions_m[v],
        normal: apron.normals[v],
        color: apron.colors[v],
    };
    let mut vertices: Vec<RingVertex> = (0..apron.positions_m.len()).map(vertex).collect();
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
            triangles: triangles.collect(),
            positions_m,
        };
        assert_eq!(inner_edges(&apron, 1.0), [[0, 1], [0, 3], [1, 2], [2, 3]]);
        let (vertices, indices) = ring(&apron, 1.0);
        assert_eq!((vertices.len(), indices.len()), (8 + 8, 8 * 3 + 4 * 12));
        assert!(vertices[8..].iter().all(|v| v.position_m[1] == 5.0 - CURTAIN_M));
    }
}
