//! Trees: templates with their distinguished meshes, and where copies of them stand.

use std::sync::Arc;

use genescape_schema::scene::Instance;

use super::{Image, Impostor};

/// All trees of a landscape.
#[derive(Clone, Debug, Default)]
pub struct Trees {
    /// What copies are made of.
    pub templates: Vec<Arc<Template>>,
    /// Where they stand.
    pub instances: Arc<[Instance]>,
    /// The same beyond the field.
    pub far: Arc<[Instance]>,
}

impl Trees {
    /// Wherever they stand.
    pub fn all(&self) -> impl Iterator<Item = &Instance> {
        self.instances.iter().chain(self.far.iter())
    }
}

/// A tree that stands in many places, with all its levels of detail.
#[derive(Clone, Debug, Default)]
pub struct Template {
    /// "tree-0".
    pub name: String,
    /// Name of the blob: equal names are equal templates.
    pub blob: String,
    /// Vertices of all levels, one after the other.
    pub vertices: Vec<TreeVertex>,
    /// Triangles of all levels as vertex numbers within their level.
    pub indices: Vec<u32>,
    /// D_0 first.
    pub levels: Vec<Level>,
    /// Bark first, then leaves, blossoms: as many as `Level::ranges` has entries.
    pub materials: Vec<Material>,
    /// Centre of a sphere around all levels, in the template's space.
    pub center_m: [f32; 3],
    /// Its radius.
    pub radius_m: f32,
    /// How many times its levels' errors in the file count, as they do in theirs.
    pub error_weight: f32,
    /// The first level in which clusters stand for single leaves, if there is one.
    pub clusters: Option<u32>,
    /// Pictures of it, if the file has any.
    pub impostor: Option<Impostor>,
}

/// A distinguished mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Its error in metres, q(i); increasing from level to level.
    pub error_m: f32,
    /// Number of its first vertex in `Template::vertices`.
    pub base_vertex: u32,
    /// For each material its triangles: part of `Template::indices`.
    pub ranges: Vec<Range>,
    /// The same triangles as one generalised strip each, where closed materials have one in the file; else empty, or not there.
    pub strips: Vec<Range>,
}

/// Part of an index list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Range {
    /// First index.
    pub first: u32,
    /// Number of indices; of lists of triangles a multiple of 3.
    pub count: u32,
}

/// A vertex of D_i and where it goes in D_{i+1}. All differences are zero on the last level.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct TreeVertex {
    /// Metres, in the template's space.
    pub position_m: [f32; 3],
    /// Linear, in 8 bits; multiplies the texture. Alpha is no transparency: on closed surfaces it is the sign of the
    /// bitangent (0 or 255), on leaves the share of their surroundings that neighbours leave open.
    pub color: [u8; 4],
    /// Added to the position at α = 1.
    pub position_delta_m: [f32; 3],
    /// Octahedral unit normal in 2 × 16 bits, signed.
    pub normal_oct: [i16; 2],
    /// Texture coordinates.
    pub uv: [f32; 2],
    /// Added to them at α = 1.
    pub uv_delta: [f32; 2],
    /// Octahedral normal at α = 1.
    pub normal_end_oct: [i16; 2],
    /// Octahedral tangent of closed surfaces.
    pub tangent_oct: [i16; 2],
}

/// What a part of a tree is made of.
#[derive(Clone, Debug)]
pub struct Material {
    /// "bark", "leaf", "blossom".
    pub name: String,
    /// Albedo, sRGB, with alpha.
    pub color: Option<Image>,
    /// Factor on the albedo, linear.
    pub color_factor: [f32; 4],
    /// Normals as in glTF.
    pub normal: Option<Image>,
    /// Pixels below this alpha are not drawn; `None` for opaque materials.
    pub alpha_cutoff: Option<f32>,
    /// Whether it shows lines thinner than its texels: its mip levels are plain averages, so that alpha is the share that is
    /// covered.
    pub thin: bool,
    /// Whether it shows pictures of clusters of leaves.
    pub clusters: bool,
}
