//! Trees: templates with their distinguished meshes, and where copies of them stand.

use std::sync::Arc;

use genescape_schema::scene::Instance;
use glam::Vec2;

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

/// Puts trees that stand close to each other close to each other in the list, along a Z-order curve (Morton 1966): the device culls
/// and draws some at a time, which is soon done where none of them is seen, and reads what lies together.
pub fn sort_by_place(trees: &mut [Instance]) {
    let place = |tree: &Instance| Vec2::new(tree.world_from_tree[0][3], tree.world_from_tree[2][3]);
    let low = trees.iter().map(place).fold(Vec2::MAX, Vec2::min);
    let extent = trees.iter().map(place).fold(Vec2::MIN, Vec2::max) - low;
    let scale = f32::from(u16::MAX) / extent.max_element().max(f32::MIN_POSITIVE);
    trees.sort_by_cached_key(|tree| {
        let [x, z] = ((place(tree) - low) * scale).to_array().map(|along| spread(along as u16));
        x | z << 1
    });
}

/// Each bit at twice its place.
fn spread(bits: u16) -> u32 {
    let mut spread = u32::from(bits);
    for (shift, mask) in [(8, 0x00ff_00ff), (4, 0x0f0f_0f0f), (2, 0x3333_3333), (1, 0x5555_5555)] {
        spread = (spread | spread << shift) & mask;
    }
    spread
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
    /// Its error in metres, q(i), as [`crate::lod::tree::rising`] gives it: increasing from level to level.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trees_that_follow_each_other_stand_close_to_each_other() {
        // Spread evenly, each far from the one before it.
        let mut trees: Vec<Instance> = (0..1024u16)
            .map(|number| {
                let along = |step: f32| 1000.0 * (f32::from(number) * step).fract() - 300.0;
                let [x, z] = [0.754_877_7, 0.569_840_3].map(along);
                let world_from_tree = [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, 7.0], [0.0, 0.0, 1.0, z]];
                Instance { world_from_tree, template: number.into(), trunk_cylinder_m: [x, z, 0.3] }
            })
            .collect();
        let step_m = |trees: &[Instance]| {
            let place = |tree: &Instance| Vec2::from_slice(&tree.trunk_cylinder_m);
            trees.windows(2).map(|pair| place(&pair[0]).distance(place(&pair[1]))).sum::<f32>() / 1023.0
        };
        let before_m = step_m(&trees);
        sort_by_place(&mut trees);
        // Some 31 m are between a tree and the nearest one.
        assert!(before_m > 300.0 && step_m(&trees) < 60.0, "{before_m} m, then {} m", step_m(&trees));
        trees.sort_by_key(|tree| tree.template);
        assert!(trees.iter().zip(0..).all(|(tree, number)| tree.template == number), "none is lost");
        // One place, or none at all.
        trees.truncate(1);
        sort_by_place(&mut trees);
        sort_by_place(&mut []);
    }
}
