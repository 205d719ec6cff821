//! Mesh files (.glb, .gltf, .obj; bytes) → a `Mesh` sound enough for every stage, with materials and images passed
//! through. Metres, y up, transforms of nodes applied. What had to be repaired is listed, not hidden.

mod accessor;
mod clean;
mod gltf_file;
mod mtl;
mod obj;

#[cfg(test)]
mod tests;

use std::fmt;
use std::io;

use serde_json::{Value, json};
use thiserror::Error;

use crate::model::Mesh;

/// Why a file can't be used at all.
#[derive(Debug, Error)]
pub enum ImportError {
    #[error("can't read .{0} files: give a .glb, .gltf or .obj file")]
    Extension(String),
    /// `format` is "glTF", "GLB" or "OBJ".
    #[error("not a sound {format} file: {reason}")]
    Malformed { format: &'static str, reason: String },
    #[error("the file requires the glTF extension {0}, which Genescape doesn't know; export it without")]
    RequiredExtension(String),
    #[error("the file needs {}, which can't be read: {source}", quoted(name))]
    Missing { name: String, source: io::Error },
    #[error("the file holds no triangle that can be used{}", listed(.0))]
    Empty(Vec<Repair>),
}

/// A name out of a stranger's file for people: in quotation marks, not too long.
fn quoted(name: &str) -> String {
    const MAX_CHARS: usize = 80;
    let end = name.char_indices().nth(MAX_CHARS).map_or(name.len(), |(at, _)| at);
    format!("\"{}{}\"", &name[..end], if end < name.len() { "…" } else { "" })
}

fn listed(repairs: &[Repair]) -> String {
    repairs.iter().map(|repair| format!("; {repair}")).collect()
}

/// Something that was left out or repaired.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Repair {
    /// Vertices with NaN or infinite positions went, with their triangles.
    NonFiniteVertices(usize),
    /// Normals, texture coordinates or colours that were NaN or infinite became zero.
    NonFiniteAttributes(usize),
    /// Triangles that named vertices that aren't there went.
    IndexOutOfRange(usize),
    /// Triangles without area went.
    DegenerateTriangles(usize),
    /// Vertices that no triangle uses went.
    UnusedVertices(usize),
    /// Edges of more than two triangles: kept, but they never collapse.
    NonManifoldEdges(usize),
    /// Points, lines and primitives without positions were skipped.
    SkippedPrimitives(usize),
    /// Strips and fans became lists of triangles.
    ConvertedPrimitives(usize),
    /// Nodes that would have contained themselves were skipped.
    CyclicNodes(usize),
    /// Parts that lacked normals, so that none were kept: make new ones.
    MissingNormals(usize),
    /// A list that didn't fit its vertices was left out.
    AttributeMismatch(String),
    /// An image or a material file that couldn't be read was left out.
    MissingFile(String),
    /// A part of many like pieces will be thinned out as leaves are: how many pieces.
    FoundAggregate(usize),
}

impl fmt::Display for Repair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NonFiniteVertices(n) => write!(f, "{n} vertices with NaN or infinite positions removed"),
            Self::NonFiniteAttributes(n) => write!(f, "{n} NaN or infinite attribute values set to zero"),
            Self::IndexOutOfRange(n) => write!(f, "{n} triangles with missing vertices removed"),
            Self::DegenerateTriangles(n) => write!(f, "{n} triangles without area removed"),
            Self::UnusedVertices(n) => write!(f, "{n} unused vertices removed"),
            Self::NonManifoldEdges(n) => write!(f, "{n} edges of more than two triangles are locked"),
            Self::SkippedPrimitives(n) => {
                write!(f, "{n} primitives of points or lines or without positions skipped")
            }
            Self::ConvertedPrimitives(n) => write!(f, "{n} strips or fans converted to triangles"),
            Self::CyclicNodes(n) => write!(f, "{n} nodes that contain themselves skipped"),
            Self::MissingNormals(n) => write!(f, "{n} parts without normals: all normals are made anew"),
            Self::AttributeMismatch(name) => write!(f, "{name} doesn't fit its vertices and was left out"),
            Self::MissingFile(name) => write!(f, "{} can't be read and was left out", quoted(name)),
            Self::FoundAggregate(n) => write!(f, "{n} like pieces will be thinned out as leaves are"),
        }
    }
}

/// An image's file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImportedImage {
    /// What the file calls it; may be empty.
    pub name: String,
    /// "image/png", "image/jpeg" or another; empty if unknown.
    pub mime_type: String,
    /// The encoded image; empty if it couldn't be read.
    pub bytes: Vec<u8>,
}

/// A mesh fit for every stage, and what belongs to it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Imported {
    /// One part for each material used, `Material::Foreign(n)`. `normals` is empty if any part lacked them.
    pub mesh: Mesh,
    /// glTF material objects: `materials[n]` belongs to `Material::Foreign(n)`. Their texture indices refer to
    /// `textures`.
    pub materials: Vec<Value>,
    /// glTF texture objects; their `source` is an index into `images`, their `sampler` into `samplers`.
    pub textures: Vec<Value>,
    /// glTF sampler objects.
    pub samplers: Vec<Value>,
    pub images: Vec<ImportedImage>,
    pub repairs: Vec<Repair>,
}

impl Imported {
    /// Lists a repair unless its count is 0.
    fn note(&mut self, repair: fn(usize) -> Repair, count: usize) {
        self.repairs.extend((count > 0).then(|| repair(count)));
    }

    /// The index of the material of primitives that have none: glTF's default.
    fn default_material(&mut self) -> usize {
        let default = json!({ "name": "default" });
        self.materials.iter().position(|material| *material == default).unwrap_or_else(|| {
            self.materials.push(default);
            self.materials.len() - 1
        })
    }
}

/// Gives the bytes of a file that the main file names.
pub type Resolve<'a> = dyn Fn(&str) -> io::Result<Vec<u8>> + 'a;

/// Reads a mesh. `extension` is that of the file's name, without the dot, in any case; `resolve` is called with the
/// names of buffers, images and material files as the file writes them (percent codes decoded).
pub fn read_mesh(bytes: &[u8], extension: &str, resolve: &Resolve<'_>) -> Result<Imported, ImportError> {
    let raw = match extension.to_ascii_lowercase().as_str() {
        "glb" | "gltf" => gltf_file::read(bytes, resolve)?,
        "obj" => obj::read(bytes, resolve)?,
        _ => return Err(ImportError::Extension(extension.to_owned())),
    };
    clean::finish(raw)
}

/// Triangles of one material as they were read, not yet checked. Each list of the mesh but `positions` is empty or as
/// long as these; the mesh has no parts.
#[derive(Debug, Default)]
struct Primitive {
    material: usize,
    mesh: Mesh,
    triangles: Vec<[u32; 3]>,
}

/// A file as it was read.
#[derive(Debug, Default)]
struct Raw {
    primitives: Vec<Primitive>,
    /// All but the mesh.
    rest: Imported,
}

/// A part of a colour, 0 to 1, as a byte.
fn color_byte(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}
