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

    /// Where a vertex lies once its surface has grown along its normals, in metres.
    pub fn grown(&self, id: usize, offset_m: f32) -> [f32; 3] {
        let position = self.vertices[id].position;
        if offset_m == 0.0 {
            return position;
        }
        (Vec3::from_array(position) + self.vertices[id].outward() * offset_m).to_array()
    }

    /// What lives, in the original order, with each part's size: aggregates' elements scaled about their centres,
    /// surfaces grown along their normals in metres; and which vertex of the mesh each original vertex became (`NONE` if
    /// removed).
    pub fn to_mesh(&self, sizes: &[f32]) -> (Mesh, Vec<u32>) {
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
        for (span, &size) in self.parts.iter().zip(sizes) {
            let living = span.range().filter(|&t| self.triangle_lives[t]);
            let triangles: Vec<_> = living.map(|t| self.triangles[t].map(|v| now[v as usize])).collect();
            mesh.parts.push(Part { material: span.material, kind: self.kind_now(span), triangles });
            match span.kind {
                PartKind::Surface => self.grow(span, size, &now, &mut mesh),
                PartKind::Aggregate { .. } => self.scale_elements(span, size, &now, &mut mesh),
            }
        }
        (mesh, now)
    }

    /// Of what the living elements are made; where not all are alike, they are a surface like any other.
    fn kind_now(&self, span: &PartSpan) -> PartKind {
        let size = |element: u32| {
            let [ids, triangles] = span.element(element);
            let vertices = ids.filter(|&id| self.vertex_lives[id]).count() as u32;
            PartKind::Aggregate {
                vertices,
                triangles: triangles.filter(|&t| self.triangle_lives[t]).count() as u32,
            }
        };
        let mut sizes = self.living_elements(span).map(size);
        let Some(first) = sizes.next() else { return span.kind };
        if sizes.all(|size| size == first) { first } else { PartKind::Surface }
    }

    fn grow(&self, span: &PartSpan, offset_m: f32, now: &[u32], mesh: &mut Mesh) {
        for t in span.range().filter(|&t| offset_m != 0.0 && self.triangle_lives[t]) {
            for v in self.triangles[t] {
                mesh.positions[now[v as usize] as usize] = self.grown(v as usize, offset_m);
            }
        }
    }

    fn scale_elements(&self, span: &PartSpan, scale: f32, now: &[u32], mesh: &mut Mesh) {
        if scale == 1.0 {
            return;
        }
        for element in self.living_elements(span) {
            let [ids, _] = span.element(element);
            let centre = self.centre(ids.clone());
            for id in ids.filter(|&id| self.vertex_lives[id]) {
                let scaled = centre + (Vec3::from_array(self.vertices[id].position) - centre) * scale;
                mesh.positions[now[id] as usize] = scaled.to_array();
            }
        }
    }

    /// The elements of a part that live: an element's first vertex is the last to go.
    pub fn living_elements(&self, span: &PartSpan) -> impl Iterator<Item = u32> {
        let elements = span.elements().map_or(0, |(elements, ..)| elements);
        (0..elements).filter(|&element| self.vertex_lives[span.element(element)[0].start])
    }

    /// Root mean square distance of consecutive vertices from the centre of the living ones, in metres.
    pub fn radius_m(&self, ids: Range<usize>) -> f32 {
        let (centre, count) = (self.centre(ids.clone()), ids.len().max(1));
        let square = |vertex: &Vertex| Vec3::from_array(vertex.position).distance_squared(centre);
        (self.vertices[ids].iter().map(square).sum::<f32>() / count as f32).sqrt()
    }

    /// The mean of the living ones of consecutive vertices' positions.
    pub fn centre(&self, ids: Range<usize>) -> Vec3 {
        let living = ids.filter(|&id| self.vertex_lives[id]);
        let add = |(sum, count): (Vec3, usize), id: usize| {
            (sum + Vec3::from_array(self.vertices[id].position), count + 1)
        };
        let (sum, count) = living.fold((Vec3::ZERO, 0), add);
        sum / count.max(1) as f32
    }
}
