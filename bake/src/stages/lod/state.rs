//! A mesh whose vertices and triangles can be removed, with a log of every step.
//!
//! Vertices and triangles keep the numbers that they have in the original mesh; removal only marks them. So the
//! log read backwards restores the original bit for bit, in its own order. Metres.

use std::ops::Range;

use bytemuck::bytes_of;
use glam::Vec3;

use super::log::{Log, Vertex};
use crate::model::{Material, Mesh, Part, PartKind};

/// No vertex.
pub const NONE: u32 = u32::MAX;

/// Which optional attributes a mesh has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Attributes {
    pub normals: bool,
    pub uvs: bool,
    pub colors: bool,
}

/// A part's place in the common list of triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct PartSpan {
    pub material: Material,
    pub kind: PartKind,
    pub first_triangle: u32,
    /// Its triangles at full detail.
    pub triangles: u32,
    /// For aggregates: its first vertex.
    pub first_vertex: u32,
}

impl PartSpan {
    /// Its triangles in the common list.
    pub fn range(&self) -> Range<usize> {
        self.first_triangle as usize..(self.first_triangle + self.triangles) as usize
    }

    /// Vertices and triangles of an element; none for surfaces.
    pub fn element(&self, element: u32) -> [Range<usize>; 2] {
        let (_, vertices, triangles) = self.elements().unwrap_or_default();
        [(self.first_vertex, vertices), (self.first_triangle, triangles)].map(|(first, each)| {
            let start = (first + element * each) as usize;
            start..start + each as usize
        })
    }

    /// Elements at full detail and vertices and triangles of each; `None` for surfaces.
    pub fn elements(&self) -> Option<(u32, u32, u32)> {
        match self.kind {
            PartKind::Surface => None,
            PartKind::Aggregate { vertices, triangles } => {
                Some((self.triangles / triangles.max(1), vertices, triangles))
            }
        }
    }
}

/// The mesh in some state of simplification.
#[derive(Clone, Debug)]
pub struct State {
    pub attributes: Attributes,
    pub parts: Vec<PartSpan>,
    pub vertices: Vec<Vertex>,
    pub vertex_lives: Vec<bool>,
    pub triangles: Vec<[u32; 3]>,
    pub triangle_lives: Vec<bool>,
    /// Living vertices.
    pub vertex_count: usize,
    pub log: Log,
    /// For each removed vertex the one that it merged into; `NONE` for living ones and those that went with their
    /// piece.
    pub merged_into: Vec<u32>,
    /// Where each removed vertex that merged into no other shrank to.
    pub collapsed_to: Vec<[f32; 3]>,
}

impl State {
    /// The whole of a sound mesh.
    pub fn new(mesh: &Mesh) -> Self {
        let attributes = Attributes {
            normals: !mesh.normals.is_empty(),
            uvs: !mesh.uvs.is_empty(),
            colors: !mesh.colors.is_empty(),
        };
        let vertex = |i: usize| Vertex {
            position: mesh.positions[i],
            normal: mesh.normals.get(i).copied().unwrap_or_default(),
            uv: mesh.uvs.get(i).copied().unwrap_or_default(),
            color: mesh.colors.get(i).copied().unwrap_or_default(),
        };
        let vertices: Vec<_> = (0..mesh.positions.len()).map(vertex).collect();
        let mut triangles = Vec::with_capacity(mesh.triangle_count());
        let mut parts = Vec::with_capacity(mesh.parts.len());
        for part in &mesh.parts {
            parts.push(PartSpan {
                material: part.material,
                kind: part.kind,
                first_triangle: triangles.len() as u32,
                triangles: part.triangles.len() as u32,
                first_vertex: part.triangles.iter().flatten().copied().min().unwrap_or(0),
            });
            triangles.extend_from_slice(&part.triangles);
        }
        Self {
            attributes,
            parts,
            vertex_count: vertices.len(),
            vertex_lives: vec![true; vertices.len()],
            merged_into: vec![NONE; vertices.len()],
            collapsed_to: vec![[0.0; 3]; vertices.len()],
            log: Log::default(),
            vertices,
            triangle_lives: vec![true; triangles.len()],
            triangles,
        }
    }

    /// The vertex at a corner (3·triangle + 0…2).
    #[inline]
    pub fn vertex_at(&self, corner: u32) -> u32 {
        self.triangles[corner as usize / 3][corner as usize % 3]
    }

    /// Removes a vertex that merges into another, or into `NONE`.
    pub fn remove_vertex(&mut self, vertex: u32, into: u32) {
        let was = self.vertices[vertex as usize];
        self.log.removed.push((vertex, into, was));
        self.vertex_lives[vertex as usize] = false;
        self.vertex_count -= 1;
        self.merged_into[vertex as usize] = into;
        self.collapsed_to[vertex as usize] = was.position;
    }

    pub fn remove_triangle(&mut self, t: u32) {
        self.log.triangles.push((t, self.triangles[t as usize]));
        self.triangle_lives[t as usize] = false;
    }

    /// Gives a vertex other attributes; nothing happens if every bit is the same.
    pub fn change_vertex(&mut self, id: u32, vertex: Vertex) {
        let old = &mut self.vertices[id as usize];
        if bytes_of(old) != bytes_of(&vertex) {
            self.log.changed.push((id, *old));
            *old = vertex;
        }
    }

    /// Gives a corner another vertex.
    pub fn change_corner(&mut self, corner: u32, vertex: u32) {
        self.log.corners.push((corner, self.vertex_at(corner)));
        self.triangles[corner as usize / 3][corner as usize % 3] = vertex;
    }

    /// What lives, in the original order, with aggregates' elements scaled about their centres by one factor a
    /// part; and which vertex of the mesh each original vertex became (`NONE` if removed).
    pub fn to_mesh(&self, scales: &[f32]) -> (Mesh, Vec<u32>) {
        let mut now = vec![NONE; self.vertices.len()];
        let mut mesh = Mesh::default();
        mesh.positions.reserve(self.vertex_count);
        for (id, vertex) in self.vertices.iter().enumerate().filter(|&(id, _)| self.vertex_lives[id]) {
            now[id] = mesh.positions.len() as u32;
            mesh.positions.push(vertex.position);
            if self.attributes.normals {
                mesh.normals.push(vertex.normal);
            }
            if self.attributes.uvs {
                mesh.uvs.push(vertex.uv);
            }
            if self.attributes.colors {
                mesh.colors.push(vertex.color);
            }
        }
        for (span, &scale) in self.parts.iter().zip(scales) {
            let living = span.range().filter(|&t| self.triangle_lives[t]);
            let triangles = living.map(|t| self.triangles[t].map(|v| now[v as usize])).collect();
            mesh.parts.push(Part { material: span.material, kind: span.kind, triangles });
            self.scale_elements(span, scale, &now, &mut mesh);
        }
        (mesh, now)
    }

    fn scale_elements(&self, span: &PartSpan, scale: f32, now: &[u32], mesh: &mut Mesh) {
        let Some((elements, ..)) = span.elements().filter(|_| scale != 1.0) else { return };
        for element in 0..elements {
            let [ids, _] = span.element(element);
            if !self.vertex_lives[ids.start] {
                continue;
            }
            let centre = self.centre(ids.clone());
            for id in ids {
                let scaled = centre + (Vec3::from_array(self.vertices[id].position) - centre) * scale;
                mesh.positions[now[id] as usize] = scaled.to_array();
            }
        }
    }

    /// The mean of consecutive vertices' positions.
    pub fn centre(&self, ids: Range<usize>) -> Vec3 {
        let positions = self.vertices[ids.clone()].iter().map(|vertex| Vec3::from_array(vertex.position));
        positions.sum::<Vec3>() / ids.len().max(1) as f32
    }
}
