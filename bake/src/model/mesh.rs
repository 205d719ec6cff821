//! Indexed triangles with the attributes that glTF knows.

use glam::Vec3;
use serde::{Deserialize, Serialize};

/// An axis-aligned box in metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bounds {
    /// Least corner.
    pub min: Vec3,
    /// Greatest corner.
    pub max: Vec3,
}

impl Bounds {
    /// The box around all points; all zeros if there are none.
    pub fn of(points: &[[f32; 3]]) -> Self {
        let mut points = points.iter().map(|&p| Vec3::from_array(p));
        let Some(first) = points.next() else { return Self { min: Vec3::ZERO, max: Vec3::ZERO } };
        let (min, max) = points.fold((first, first), |(lo, hi), p| (lo.min(p), hi.max(p)));
        Self { min, max }
    }
}

/// What a part's surface is made of; which textures that means is decided where files are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Material {
    /// Bark of trunk and branches: opaque.
    Bark,
    /// Leaf cards: alpha-masked, two-sided.
    Leaf,
    /// Blossom cards: alpha-masked, two-sided.
    Blossom,
    /// The ground.
    Ground,
    /// The surface of a lake.
    Water,
    /// The nth material of someone's own file (`bake lod`).
    Foreign(u32),
    /// Cards with pictures of many leaves or blossoms: alpha-masked, two-sided. Caches know materials by their order here.
    Cluster,
}

impl Material {
    /// Alpha-masked cards.
    pub fn is_card(self) -> bool {
        matches!(self, Self::Leaf | Self::Blossom | Self::Cluster)
    }
}

/// How a part is simplified.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum PartKind {
    /// One connected skin: edges collapse.
    Surface,
    /// Many like elements of `vertices` consecutive vertices and `triangles` consecutive triangles each (leaf
    /// cards): elements go, the rest grow (Cook et al. 2007).
    Aggregate {
        /// Vertices an element.
        vertices: u32,
        /// Triangles an element.
        triangles: u32,
    },
}

/// A run of triangles with one material. Parts do not share vertices.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// What it is made of.
    pub material: Material,
    /// How it is simplified.
    pub kind: PartKind,
    /// Vertex indices, counter-clockwise from the front.
    pub triangles: Vec<[u32; 3]>,
}

/// Vertices and the parts that use them. All attribute lists have one entry a vertex.
///
/// A position where attributes are discontinuous (a texture seam, a crease) is given by several vertices with
/// bit-identical positions.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Mesh {
    /// Metres.
    pub positions: Vec<[f32; 3]>,
    /// Unit vectors.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates, origin top left.
    pub uvs: Vec<[f32; 2]>,
    /// Linear RGB factor on the base colour and, in alpha, 255; empty when the mesh has none.
    pub colors: Vec<[u8; 4]>,
    /// Triangles by material.
    pub parts: Vec<Part>,
}

impl Mesh {
    /// Whether any part is made of cards.
    pub fn has_cards(&self) -> bool {
        self.parts.iter().any(|part| part.material.is_card())
    }

    /// Triangles of all parts.
    pub fn triangle_count(&self) -> usize {
        self.parts.iter().map(|part| part.triangles.len()).sum()
    }

    /// The box around all vertices; all zeros for an empty mesh.
    pub fn bounds(&self) -> Bounds {
        Bounds::of(&self.positions)
    }
}
