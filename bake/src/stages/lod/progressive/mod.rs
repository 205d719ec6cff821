//! The payload of `GSC_progressive_mesh`: the coarsest mesh and the records that lead back to the original, one
//! vertex split (or one piece that appears) each. Specified in `schema/docs/GSC_progressive_mesh.md`.
//!
//! After Hoppe, "Progressive meshes" (1996). All values are stored exactly, so at full count the original comes back
//! bit for bit, every vertex and triangle in its own place. Metres; little-endian.

#[cfg(test)]
pub mod reader;

use super::log::{Record, Vertex};
use super::sequence::Sequence;
use super::state::{Attributes, NONE, PartSpan, State};
use crate::model::{Material, PartKind};

const MAGIC: [u8; 8] = *b"GSCPMESH";
const VERSION: u32 = 2;

/// A distinguished mesh's place in the sequence.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    pub vertices: u32,
    pub triangles: u32,
    /// Records to apply to the coarsest mesh to get to it.
    pub records: u32,
    /// Its error in metres.
    pub error_m: f32,
    /// For each part, the elements of it that live and their scale; for surfaces 0 and how far they have grown along
    /// their normals, in metres.
    pub parts: Vec<(u32, f32)>,
}

impl Mark {
    /// The current state with the greatest cost so far, and with records counted from the original.
    pub fn of(sequence: &Sequence) -> Self {
        let state = &sequence.state;
        let part = |span: &PartSpan| span.elements().map_or((0, 0.0), |(elements, ..)| (elements, 1.0));
        Self {
            vertices: state.vertex_count as u32,
            triangles: count(&state.triangle_lives),
            records: state.log.len() as u32,
            error_m: sequence.error_m as f32,
            parts: state.parts.iter().map(part).collect(),
        }
    }

    /// The current state with sizes at which coverage is kept.
    pub fn calibrated(sequence: &mut Sequence) -> Self {
        let parts = sequence.sizes();
        Self { parts, ..Self::of(sequence) }
    }

    /// Size of each part: the scale of its elements, or the growth of its surface in metres.
    pub fn sizes(&self) -> Vec<f32> {
        self.parts.iter().map(|part| part.1).collect()
    }
}

/// Writes a payload. `state` is the coarsest mesh, whose log leads from the original to it; `marks` are in the order of
/// levels with records counted from the original.
pub fn encode(state: &State, marks: &[Mark]) -> Vec<u8> {
    let log = &state.log;
    let mut out = Writer { bytes: MAGIC.to_vec(), attributes: state.attributes, vertex: 0, triangle: 0 };
    out.bytes.reserve((log.removed.len() + log.changed.len()) * size_of::<Vertex>());
    let flags = [state.attributes.normals, state.attributes.uvs, state.attributes.colors];
    let flags = flags.iter().enumerate().map(|(bit, &flag)| u32::from(flag) << bit).sum();
    let whole = [state.vertices.len(), state.triangles.len(), state.parts.len(), marks.len()];
    out.words(&[VERSION, flags]);
    out.words(&whole.map(|count| count as u32));
    out.words(&[state.vertex_count as u32, count(&state.triangle_lives), log.len() as u32, 0]);
    for span in &state.parts {
        let (_, per_vertices, per_triangles) = span.elements().unwrap_or((0, 0, 0));
        let kind = u32::from(span.kind != PartKind::Surface);
        let material = material_code(span.material);
        out.words(&[material, kind, span.first_triangle, span.triangles]);
        out.words(&[span.first_vertex, per_vertices, per_triangles, 0]);
    }
    for mark in marks {
        let records = log.len() as u32 - mark.records;
        out.words(&[mark.vertices, mark.triangles, records, mark.error_m.to_bits()]);
        mark.parts.iter().for_each(|&(elements, scale)| out.words(&[elements, scale.to_bits()]));
    }
    for id in (0..state.vertices.len()).filter(|&id| state.vertex_lives[id]) {
        out.vertex_id(id as u32);
        out.vertex(&state.vertices[id]);
    }
    for id in (0..state.triangles.len()).filter(|&id| state.triangle_lives[id]) {
        out.triangle(id as u32, state.triangles[id]);
    }
    (0..log.len()).rev().for_each(|index| out.record(&log.record(index)));
    out.bytes
}

fn count(lives: &[bool]) -> u32 {
    lives.iter().filter(|&&lives| lives).count() as u32
}

fn material_code(material: Material) -> u32 {
    match material {
        Material::Bark => 0,
        Material::Leaf => 1,
        Material::Blossom => 2,
        Material::Ground => 3,
        Material::Water => 4,
        Material::Cluster => 5,
        Material::Foreign(n) => n.saturating_add(16),
    }
}

/// Bytes with the running numbers from which ids are counted.
struct Writer {
    bytes: Vec<u8>,
    attributes: Attributes,
    vertex: u32,
    triangle: u32,
}

impl Writer {
    fn words(&mut self, words: &[u32]) {
        words.iter().for_each(|word| self.bytes.extend(word.to_le_bytes()));
    }

    fn floats(&mut self, values: &[f32]) {
        values.iter().for_each(|value| self.bytes.extend_from_slice(&value.to_le_bytes()));
    }

    fn varint(&mut self, mut value: u32) {
        while value >= 0x80 {
            self.bytes.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.bytes.push(value as u8);
    }

    fn delta(&mut self, value: u32, from: u32) {
        let difference = value.wrapping_sub(from) as i32;
        self.varint((difference << 1 ^ difference >> 31) as u32);
    }

    fn vertex_id(&mut self, id: u32) {
        self.delta(id, self.vertex);
        self.vertex = id;
    }

    fn vertex(&mut self, vertex: &Vertex) {
        self.floats(&vertex.position);
        if self.attributes.normals {
            self.floats(&vertex.normal);
        }
        if self.attributes.uvs {
            self.floats(&vertex.uv);
        }
        if self.attributes.colors {
            self.bytes.extend_from_slice(&vertex.color);
        }
    }

    fn triangle(&mut self, id: u32, triangle: [u32; 3]) {
        self.delta(id, self.triangle);
        self.triangle = id;
        triangle.iter().for_each(|&v| self.vertex_id(v));
    }

    fn record(&mut self, record: &Record<'_>) {
        let counts =
            [record.changed.len(), record.removed.len(), record.corners.len(), record.triangles.len()];
        counts.iter().for_each(|&count| self.varint(count as u32));
        for (id, vertex) in record.changed {
            self.vertex_id(*id);
            self.vertex(vertex);
        }
        for (id, parent, vertex) in record.removed {
            self.vertex_id(*id);
            // A vertex is never its own parent, so no distance means no parent.
            self.delta(if *parent == NONE { *id } else { *parent }, *id);
            self.vertex(vertex);
        }
        for &(corner, vertex) in record.corners {
            self.delta(corner / 3, self.triangle);
            self.triangle = corner / 3;
            self.varint(corner % 3);
            self.vertex_id(vertex);
        }
        record.triangles.iter().for_each(|&(id, triangle)| self.triangle(id, triangle));
    }
}
