//! Shapes of small plants and stones → two buffers, and where each kind grows at all.

use std::ops::Range;

use genescape_schema::scene::PlantKind;

use super::Uploader;
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
        Self { fine: indices, coarse, side, grows: grows(ground, kind, side) }
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
            kinds.push(PlantBuffersOfKind::new(ground, kind, first..indices.len() as u32));
        }
        PlantBuffers {
            vertices: self.gpu.buffer("plants", &vertices, wgpu::BufferUsages::VERTEX),
            indices: self.gpu.buffer("triangles of plants", &indices, wgpu::BufferUsages::INDEX),
            kinds,
        }
    }
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
