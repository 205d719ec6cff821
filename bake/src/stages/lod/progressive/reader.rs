//! The reference reader of `GSC_progressive_mesh`, which proves in tests that the payload holds what it should: at any
//! number of vertices a sound mesh, at a mark's the distinguished mesh, at all the original bit for bit.

use thiserror::Error;

use super::super::log::{Log, Record, Vertex};
use super::super::state::{Attributes, NONE, PartSpan, State};
use super::{MAGIC, Mark, VERSION};
use crate::model::{Material, Mesh, PartKind};

/// Why a payload can't be read.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum ProgressiveError {
    /// It ends too early.
    #[error("progressive mesh ends too early, at byte {0}")]
    Truncated(usize),
    /// It isn't one.
    #[error("not a progressive mesh: it doesn't start with \"GSCPMESH\"")]
    Magic,
    /// It is of another version.
    #[error("progressive mesh is of version {0}; this program reads version {VERSION}")]
    Version(u32),
    /// It contradicts itself.
    #[error("progressive mesh is damaged near byte {at}: {what}")]
    Damaged {
        /// Where.
        at: usize,
        /// What is wrong.
        what: &'static str,
    },
}

/// A progressive mesh that can be rebuilt at any number of vertices.
#[derive(Clone, Debug)]
pub struct Progressive {
    base: State,
    log: Log,
    marks: Vec<Mark>,
}

impl Progressive {
    /// Vertices of the coarsest and of the original mesh.
    pub fn vertex_range(&self) -> (usize, usize) {
        (self.base.vertex_count, self.base.vertices.len())
    }

    /// The distinguished meshes, D_0 first.
    pub fn marks(&self) -> &[Mark] {
        &self.marks
    }

    /// The finest mesh of at most so many vertices; the coarsest if that has more. With all vertices it is the
    /// original, bit for bit; with a mark's vertices it is that distinguished mesh.
    pub fn rebuild(&self, vertices: usize) -> Mesh {
        let mut state = self.base.clone();
        for index in 0..self.log.len() {
            let record = self.log.record(index);
            if state.vertex_count + record.removed.len() > vertices {
                break;
            }
            apply(&mut state, &record);
        }
        let sizes: Vec<_> = (0..state.parts.len()).map(|part| self.size(&state, part)).collect();
        state.to_mesh(&sizes).0
    }

    /// Between marks, the square of an element's scale is linear in the inverse of the number of elements, and the
    /// growth of a surface in the number of vertices.
    fn size(&self, state: &State, part: usize) -> f32 {
        let span = &state.parts[part];
        let lives = |e: &u32| state.vertex_lives[span.element(*e)[0].start];
        let now = match span.elements() {
            Some((elements, ..)) => (0..elements).filter(lives).count() as u32,
            None => state.vertex_count as u32,
        };
        let at = |mark: &Mark| {
            let (elements, size) = mark.parts[part];
            (if span.elements().is_some() { elements } else { mark.vertices }, size)
        };
        let Some(coarse) = self.marks.iter().position(|mark| at(mark).0 <= now) else {
            return self.marks.last().map_or(1.0, |mark| at(mark).1);
        };
        let (few, large) = at(&self.marks[coarse]);
        if few == now || coarse == 0 {
            return large;
        }
        let (many, small) = at(&self.marks[coarse - 1]);
        if span.elements().is_none() {
            let t = f64::from(many - now) / f64::from(many - few);
            return (f64::from(small) + t * (f64::from(large) - f64::from(small))) as f32;
        }
        let inverse = |count: u32| 1.0 / f64::from(count.max(1));
        let t = (inverse(now) - inverse(many)) / (inverse(few) - inverse(many));
        let square = |scale: f32| f64::from(scale) * f64::from(scale);
        (square(small) + t * (square(large) - square(small))).sqrt() as f32
    }
}

/// Reads a payload; checks that every record refers to what is there when its turn comes.
pub fn decode(bytes: &[u8]) -> Result<Progressive, ProgressiveError> {
    let mut reader = Reader::new(bytes);
    let head = reader.header()?;
    let mut base = State {
        attributes: head.attributes,
        parts: Vec::new(),
        vertices: vec![Vertex::default(); head.vertices],
        vertex_lives: vec![false; head.vertices],
        triangles: vec![[0; 3]; head.triangles],
        triangle_lives: vec![false; head.triangles],
        vertex_count: 0,
        log: Log::default(),
        merged_into: Vec::new(),
        collapsed_to: Vec::new(),
    };
    for _ in 0..head.parts {
        let span = reader.part(&head)?;
        base.parts.push(span);
    }
    let marks = (0..head.levels).map(|_| reader.mark(&base.parts)).collect::<Result<Vec<_>, _>>()?;
    reader.base(&head, &mut base)?;
    let mut log = Log::default();
    let mut now = base.clone();
    for _ in 0..head.records {
        reader.record(&mut log)?;
        let record = log.record(log.len() - 1);
        if let Some(what) = fault(&now, &record) {
            return Err(reader.damaged(what));
        }
        apply(&mut now, &record);
    }
    if now.vertex_count != head.vertices || now.triangle_lives.contains(&false) {
        return Err(reader.damaged("the records don't lead back to the whole mesh"));
    }
    Ok(Progressive { base, log, marks })
}

/// Undoes the step that a record was made of.
fn apply(state: &mut State, record: &Record<'_>) {
    record.changed.iter().for_each(|&(id, vertex)| state.vertices[id as usize] = vertex);
    for &(id, _, vertex) in record.removed {
        state.vertices[id as usize] = vertex;
        state.vertex_lives[id as usize] = true;
        state.vertex_count += 1;
    }
    for &(corner, vertex) in record.corners {
        state.triangles[corner as usize / 3][corner as usize % 3] = vertex;
    }
    for &(id, triangle) in record.triangles {
        state.triangles[id as usize] = triangle;
        state.triangle_lives[id as usize] = true;
    }
}

/// What is wrong with a record, if anything.
fn fault(state: &State, record: &Record<'_>) -> Option<&'static str> {
    let known = |id: u32| (id as usize) < state.vertices.len();
    let lives = |id: u32| known(id) && state.vertex_lives[id as usize];
    let added = |id: u32| record.removed.iter().any(|vertex| vertex.0 == id);
    let triangle_lives = |id: u32| state.triangle_lives.get(id as usize).copied();
    if !record.changed.iter().all(|vertex| lives(vertex.0)) {
        return Some("it changes a vertex that isn't there");
    }
    if !record.removed.iter().all(|vertex| known(vertex.0) && !lives(vertex.0)) {
        return Some("it adds a vertex that can't be added");
    }
    if !record.corners.iter().all(|&(c, v)| triangle_lives(c / 3) == Some(true) && (lives(v) || added(v))) {
        return Some("it changes a corner that isn't there");
    }
    let whole = |triangle: &[u32; 3]| triangle.iter().all(|&v| lives(v) || added(v));
    if !record.triangles.iter().all(|(id, triangle)| triangle_lives(*id) == Some(false) && whole(triangle)) {
        return Some("it adds a triangle that can't be added");
    }
    None
}

fn material_of(code: u32) -> Option<Material> {
    let known = [Material::Bark, Material::Leaf, Material::Blossom, Material::Ground, Material::Water];
    known.get(code as usize).copied().or_else(|| code.checked_sub(16).map(Material::Foreign))
}

struct Header {
    attributes: Attributes,
    vertices: usize,
    triangles: usize,
    parts: u32,
    levels: u32,
    base_vertices: u32,
    base_triangles: u32,
    records: u32,
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    attributes: Attributes,
    vertex: u32,
    triangle: u32,
}

type Read<T> = Result<T, ProgressiveError>;

impl<'a> Reader<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, attributes: Attributes::default(), vertex: 0, triangle: 0 }
    }

    fn damaged(&self, what: &'static str) -> ProgressiveError {
        ProgressiveError::Damaged { at: self.at, what }
    }

    fn take<const N: usize>(&mut self) -> Read<[u8; N]> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let chunk = *rest.first_chunk::<N>().ok_or(ProgressiveError::Truncated(self.at))?;
        self.at += N;
        Ok(chunk)
    }

    fn word(&mut self) -> Read<u32> {
        Ok(u32::from_le_bytes(self.take()?))
    }

    fn words<const N: usize>(&mut self) -> Read<[u32; N]> {
        let mut words = [0; N];
        for word in &mut words {
            *word = self.word()?;
        }
        Ok(words)
    }

    fn floats<const N: usize>(&mut self) -> Read<[f32; N]> {
        Ok(self.words::<N>()?.map(f32::from_bits))
    }

    fn varint(&mut self) -> Read<u32> {
        let mut value = 0_u32;
        for shift in [0, 7, 14, 21, 28] {
            let [byte] = self.take()?;
            value |= u32::from(byte & 0x7F) << shift;
            if byte < 0x80 {
                return Ok(value);
            }
        }
        Err(self.damaged("a number is longer than five bytes"))
    }

    fn delta(&mut self, from: u32) -> Read<u32> {
        let code = self.varint()?;
        Ok(from.wrapping_add(code >> 1 ^ (code & 1).wrapping_neg()))
    }

    fn header(&mut self) -> Read<Header> {
        if self.bytes.len() < MAGIC.len() && MAGIC.starts_with(self.bytes) {
            return Err(ProgressiveError::Truncated(self.bytes.len()));
        }
        if self.take::<8>()? != MAGIC {
            return Err(ProgressiveError::Magic);
        }
        let version = self.word()?;
        if version != VERSION {
            return Err(ProgressiveError::Version(version));
        }
        let [flags, vertices, triangles, parts, levels, base_vertices, base_triangles, records, _] =
            self.words()?;
        self.attributes = Attributes { normals: flags & 1 != 0, uvs: flags & 2 != 0, colors: flags & 4 != 0 };
        // Each vertex, triangle, part and level takes more than so many bytes: no count is believed beyond that.
        let room = self.bytes.len() as u64;
        let least = 13 * u64::from(vertices)
            + 4 * u64::from(triangles)
            + 32 * u64::from(parts)
            + 16 * u64::from(levels)
            + 4 * u64::from(records);
        if least > room {
            return Err(ProgressiveError::Truncated(self.bytes.len()));
        }
        Ok(Header {
            attributes: self.attributes,
            vertices: vertices as usize,
            triangles: triangles as usize,
            parts,
            levels,
            base_vertices,
            base_triangles,
            records,
        })
    }

    fn part(&mut self, head: &Header) -> Read<PartSpan> {
        let [material, kind, first_triangle, triangles, first_vertex, per_vertices, per_triangles, _] =
            self.words()?;
        let material = material_of(material).ok_or_else(|| self.damaged("unknown material"))?;
        let kind = match kind {
            0 => PartKind::Surface,
            1 if per_vertices > 0 && per_triangles > 0 => {
                PartKind::Aggregate { vertices: per_vertices, triangles: per_triangles }
            }
            _ => return Err(self.damaged("unknown kind of part")),
        };
        let span = PartSpan { material, kind, first_triangle, triangles, first_vertex };
        let vertices = span.elements().map_or(0, |(count, per, _)| u64::from(count) * u64::from(per));
        let fits = u64::from(first_triangle) + u64::from(triangles) <= head.triangles as u64
            && u64::from(first_vertex) + vertices <= head.vertices as u64;
        if fits { Ok(span) } else { Err(self.damaged("a part is larger than the mesh")) }
    }

    fn mark(&mut self, parts: &[PartSpan]) -> Read<Mark> {
        let [vertices, triangles, records, error] = self.words()?;
        let mut mark =
            Mark { vertices, triangles, records, error_m: f32::from_bits(error), parts: Vec::new() };
        for _ in parts {
            let [elements, scale] = self.words()?;
            mark.parts.push((elements, f32::from_bits(scale)));
        }
        Ok(mark)
    }

    fn vertex_id(&mut self) -> Read<u32> {
        self.vertex = self.delta(self.vertex)?;
        Ok(self.vertex)
    }

    fn vertex(&mut self) -> Read<Vertex> {
        Ok(Vertex {
            position: self.floats()?,
            normal: if self.attributes.normals { self.floats()? } else { [0.0; 3] },
            uv: if self.attributes.uvs { self.floats()? } else { [0.0; 2] },
            color: if self.attributes.colors { self.take()? } else { [0; 4] },
        })
    }

    fn triangle(&mut self) -> Read<(u32, [u32; 3])> {
        self.triangle = self.delta(self.triangle)?;
        Ok((self.triangle, [self.vertex_id()?, self.vertex_id()?, self.vertex_id()?]))
    }

    fn base(&mut self, head: &Header, base: &mut State) -> Read<()> {
        let mut log = Log::default();
        for _ in 0..head.base_vertices {
            let id = self.vertex_id()?;
            log.removed.push((id, NONE, self.vertex()?));
        }
        for _ in 0..head.base_triangles {
            log.triangles.push(self.triangle()?);
        }
        log.finish_record();
        let record = log.record(0);
        for &(id, _, vertex) in record.removed {
            let lives = base.vertex_lives.get_mut(id as usize);
            match lives {
                Some(lives) if !*lives => *lives = true,
                _ => return Err(self.damaged("the coarsest mesh has a vertex that can't be")),
            }
            base.vertices[id as usize] = vertex;
            base.vertex_count += 1;
        }
        for &(id, triangle) in record.triangles {
            let whole = triangle.iter().all(|&v| base.vertex_lives.get(v as usize) == Some(&true));
            if !whole || base.triangle_lives.get(id as usize) != Some(&false) {
                return Err(self.damaged("the coarsest mesh has a triangle that can't be"));
            }
            base.triangles[id as usize] = triangle;
            base.triangle_lives[id as usize] = true;
        }
        Ok(())
    }

    fn record(&mut self, log: &mut Log) -> Read<()> {
        let counts = [self.varint()?, self.varint()?, self.varint()?, self.varint()?];
        for _ in 0..counts[0] {
            let id = self.vertex_id()?;
            log.changed.push((id, self.vertex()?));
        }
        for _ in 0..counts[1] {
            let id = self.vertex_id()?;
            let parent = self.delta(id)?;
            log.removed.push((id, if parent == id { NONE } else { parent }, self.vertex()?));
        }
        for _ in 0..counts[2] {
            self.triangle = self.delta(self.triangle)?;
            let (triangle, k) = (self.triangle, self.varint()?);
            let corner = triangle.checked_mul(3).and_then(|c| c.checked_add(k)).filter(|_| k < 3);
            let corner = corner.ok_or_else(|| self.damaged("a corner that can't be"))?;
            log.corners.push((corner, self.vertex_id()?));
        }
        for _ in 0..counts[3] {
            log.triangles.push(self.triangle()?);
        }
        log.finish_record();
        Ok(())
    }
}
