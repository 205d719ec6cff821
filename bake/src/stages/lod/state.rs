//! A mesh whose vertices and triangles can go and come back, and the log of every such step.
//!
//! Vertices and triangles keep the numbers they have in the original mesh for ever; what is gone is only marked.
//! So the log read backwards gives the original back bit for bit, in its own order. Metres.

use crate::model::{Material, Mesh, Part, PartKind};

/// No vertex.
pub const NONE: u32 = u32::MAX;

/// All that a vertex carries; attributes that the mesh lacks are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vertex {
    /// Metres.
    pub position: [f32; 3],
    /// Unit vector.
    pub normal: [f32; 3],
    /// Texture coordinates.
    pub uv: [f32; 2],
    /// Factor on the base colour.
    pub color: [u8; 4],
}

impl Vertex {
    /// Whether every bit is the same (−0 differs from 0).
    pub fn same_bits(&self, other: &Self) -> bool {
        let bits = |v: &Self| {
            let [x, y, z] = v.position.map(f32::to_bits);
            let [i, j, k] = v.normal.map(f32::to_bits);
            let [s, t] = v.uv.map(f32::to_bits);
            [x, y, z, i, j, k, s, t]
        };
        bits(self) == bits(other) && self.color == other.color
    }
}

/// Which optional attributes a mesh has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Attributes {
    /// Normals.
    pub normals: bool,
    /// Texture coordinates.
    pub uvs: bool,
    /// Colours.
    pub colors: bool,
}

/// A part's place in the common list of triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct PartSpan {
    /// What it is made of.
    pub material: Material,
    /// How it is simplified.
    pub kind: PartKind,
    /// Its first triangle in the common list.
    pub first_triangle: u32,
    /// Its triangles at full detail.
    pub triangles: u32,
    /// For aggregates: its first vertex.
    pub first_vertex: u32,
}

impl PartSpan {
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
            vertices,
            triangle_lives: vec![true; triangles.len()],
            triangles,
        }
    }

    /// What lives, in the original order, with aggregates' elements scaled about their centres by one factor a
    /// part; and which vertex of the mesh each original vertex became (`NONE` if gone).
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
            let first = span.first_triangle as usize;
            let ids = first..first + span.triangles as usize;
            let living = ids.filter(|&t| self.triangle_lives[t]);
            let triangles = living.map(|t| self.triangles[t].map(|v| now[v as usize])).collect();
            mesh.parts.push(Part { material: span.material, kind: span.kind, triangles });
            self.scale_elements(span, scale, &now, &mut mesh);
        }
        (mesh, now)
    }

    fn scale_elements(&self, span: &PartSpan, scale: f32, now: &[u32], mesh: &mut Mesh) {
        let Some((elements, per, _)) = span.elements() else { return };
        if scale == 1.0 {
            return;
        }
        for e in 0..elements {
            let ids = (span.first_vertex + e * per) as usize..(span.first_vertex + (e + 1) * per) as usize;
            if !self.vertex_lives[ids.start] {
                continue;
            }
            let centre = self.centre(ids.clone());
            for id in ids {
                let p = self.vertices[id].position;
                mesh.positions[now[id] as usize] =
                    std::array::from_fn(|k| centre[k] + (p[k] - centre[k]) * scale);
            }
        }
    }

    /// The mean of consecutive vertices' positions.
    pub fn centre(&self, ids: std::ops::Range<usize>) -> [f32; 3] {
        let mut sum = [0.0_f32; 3];
        for vertex in &self.vertices[ids.clone()] {
            (0..3).for_each(|k| sum[k] += vertex.position[k]);
        }
        sum.map(|s| s / ids.len().max(1) as f32)
    }
}

/// What one step took away, so that it can be given back: a vertex split, or a piece that appears whole.
#[derive(Clone, Copy, Debug)]
pub struct Record<'a> {
    /// Vertices that stay but were changed, with what they were.
    pub restored: &'a [(u32, Vertex)],
    /// Vertices that went, the vertex that each merged into (or `NONE`), and what they were.
    pub born: &'a [(u32, u32, Vertex)],
    /// Corners (3·triangle + 0…2) that were given another vertex, and the vertex they had.
    pub corners: &'a [(u32, u32)],
    /// Triangles that went, and their vertices.
    pub triangles: &'a [(u32, [u32; 3])],
}

/// All records in the order in which they were made, in flat lists.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Log {
    pub restored: Vec<(u32, Vertex)>,
    pub born: Vec<(u32, u32, Vertex)>,
    pub corners: Vec<(u32, u32)>,
    pub triangles: Vec<(u32, [u32; 3])>,
    /// Where each record ends in each of the four lists.
    ends: Vec<[usize; 4]>,
}

impl Log {
    /// Ends a record: what was pushed onto the lists since the last one.
    pub fn finish_record(&mut self) {
        self.ends.push([self.restored.len(), self.born.len(), self.corners.len(), self.triangles.len()]);
    }

    /// Records finished.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// One record.
    pub fn record(&self, index: usize) -> Record<'_> {
        let start = if index == 0 { [0; 4] } else { self.ends[index - 1] };
        let end = self.ends[index];
        Record {
            restored: &self.restored[start[0]..end[0]],
            born: &self.born[start[1]..end[1]],
            corners: &self.corners[start[2]..end[2]],
            triangles: &self.triangles[start[3]..end[3]],
        }
    }
}

/// A mesh made sound, or `None` if it is already.
pub fn repaired(mesh: &Mesh) -> Option<Mesh> {
    let count = mesh.positions.len();
    let right = |len: usize| len == count || len == 0;
    let lists_fit = right(mesh.normals.len()) && right(mesh.uvs.len()) && right(mesh.colors.len());
    let fits = |t: &[u32; 3]| t.iter().all(|&v| (v as usize) < count);
    if lists_fit && mesh.parts.iter().all(|p| p.triangles.iter().all(fits)) && kinds_hold(mesh) {
        return None;
    }
    let mut mesh = mesh.clone();
    if !right(mesh.normals.len()) {
        mesh.normals.clear();
    }
    if !right(mesh.uvs.len()) {
        mesh.uvs.clear();
    }
    if !right(mesh.colors.len()) {
        mesh.colors.clear();
    }
    mesh.parts.iter_mut().for_each(|part| part.triangles.retain(fits));
    if !kinds_hold(&mesh) {
        mesh.parts.iter_mut().for_each(|part| part.kind = PartKind::Surface);
    }
    Some(mesh)
}

/// Whether aggregates are laid out as they say and have their vertices for themselves.
fn kinds_hold(mesh: &Mesh) -> bool {
    let mut owner = vec![NONE; mesh.positions.len()];
    for (index, part) in mesh.parts.iter().enumerate() {
        let PartKind::Aggregate { vertices, triangles } = part.kind else { continue };
        if !is_aggregate(part) {
            return false;
        }
        let first = part.triangles.iter().flatten().copied().min().unwrap_or(0) as usize;
        let last = first + part.triangles.len() / triangles as usize * vertices as usize;
        if last > owner.len() || owner[first..last].iter().any(|&o| o != NONE) {
            return false;
        }
        owner[first..last].fill(index as u32);
    }
    let own = |(index, part): (usize, &Part)| match part.kind {
        PartKind::Aggregate { .. } => true,
        PartKind::Surface => part.triangles.iter().flatten().all(|&v| {
            let owner = owner[v as usize];
            owner == NONE || owner == index as u32
        }),
    };
    mesh.parts.iter().enumerate().all(own)
}

/// Whether a part is laid out as its kind says: the nth element has the nth run of vertices and of triangles.
fn is_aggregate(part: &Part) -> bool {
    let PartKind::Aggregate { vertices, triangles } = part.kind else { return false };
    if vertices == 0 || triangles == 0 || !part.triangles.len().is_multiple_of(triangles as usize) {
        return false;
    }
    let first = part.triangles.iter().flatten().copied().min().unwrap_or(0);
    part.triangles.chunks_exact(triangles as usize).enumerate().all(|(e, chunk)| {
        let start = u64::from(first) + e as u64 * u64::from(vertices);
        chunk.iter().flatten().all(|&v| (start..start + u64::from(vertices)).contains(&u64::from(v)))
    })
}
