//! Anyone's glTF file as plain values: shapes with their levels of detail, where copies of them stand, what they are made
//! of, and what the file says of light and eye. Places are the file's own, in its metres.

use std::sync::Arc;

use genescape_schema::scene::StartView;
use glam::{DAffine3, DVec3, Vec3};

use super::{Image, Range};

/// A file that is no landscape of ours.
#[derive(Clone, Debug, Default)]
pub struct Asset {
    /// The file's name, without its folder.
    pub name: String,
    pub shapes: Vec<Shape>,
    /// Vertices of all shapes and levels.
    pub vertices: Vec<AssetVertex>,
    /// Their triangles, as numbers in `vertices`.
    pub indices: Vec<u32>,
    pub surfaces: Vec<Surface>,
    /// Suns, as the file has them.
    pub lights: Vec<DirectionalLight>,
    /// Where the file's first camera stands and looks.
    pub camera: Option<StartView>,
    /// Lower and upper corner of a box around all copies, in the finest levels.
    pub bounds_m: [Vec3; 2],
    pub facts: Facts,
}

/// What a person wants to know of a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Facts {
    /// Of all copies together, in the finest levels.
    pub triangles: u64,
    /// Vertices in memory.
    pub vertices: usize,
    pub meshes: usize,
    /// Copies of meshes that stand in the scene.
    pub copies: usize,
    pub materials: usize,
    pub pictures: usize,
    /// Of the shape that has most levels of detail; 1 if none has any.
    pub levels: usize,
    /// Where levels come from: an extension's name.
    pub level_source: Option<&'static str>,
    /// What was left out or is drawn differently, a sentence each.
    pub notes: Vec<String>,
}

/// What stands in one or more places.
#[derive(Clone, Debug, Default)]
pub struct Shape {
    pub name: String,
    /// The finest first; one at least.
    pub levels: Vec<ShapeLevel>,
    /// Centre of a sphere around all levels, in the shape's space.
    pub center_m: Vec3,
    pub radius_m: f32,
    /// Vertices have ways to the next level.
    pub morphs: bool,
    /// The world from the shape's space, for each copy.
    pub copies: Vec<DAffine3>,
}

/// A mesh, or several, that stand for a shape from some distance on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ShapeLevel {
    /// In metres, rising from level to level.
    pub error_m: f32,
    pub parts: Vec<Part>,
}

/// The triangles of one material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// In [`Asset::surfaces`].
    pub surface: usize,
    /// In [`Asset::indices`].
    pub range: Range,
}

/// A vertex, and where it goes in the next level; differences are zero where there is no such way.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct AssetVertex {
    /// Metres, in the shape's space.
    pub position_m: [f32; 3],
    /// Linear, with alpha; multiplies the material's.
    pub color: [u8; 4],
    /// Added to the position at α = 1.
    pub position_delta_m: [f32; 3],
    /// Octahedral unit normal in 2 × 16 bits, signed.
    pub normal_oct: [i16; 2],
    /// The first two sets of texture coordinates.
    pub uvs: [[f32; 2]; 2],
    /// Added to the first set at α = 1.
    pub uv_delta: [f32; 2],
    /// Octahedral normal at α = 1.
    pub normal_end_oct: [i16; 2],
    /// Octahedral tangent; the sign of the bitangent, 0 without a tangent; 0 without a normal.
    pub tangent: [i16; 4],
}

/// A material of the metallic-roughness model.
#[derive(Clone, Debug)]
pub struct Surface {
    pub name: String,
    /// Factor on the base colour, linear, with alpha.
    pub color: [f32; 4],
    pub metallic: f32,
    pub roughness: f32,
    pub normal_scale: f32,
    pub occlusion_strength: f32,
    /// Linear; 1 is as bright as white paper.
    pub emissive: [f32; 3],
    pub alpha: Alpha,
    pub double_sided: bool,
    /// Its colour is not lit.
    pub unlit: bool,
    /// How much of the diffuse light comes out on the other side.
    pub transmission: Transmission,
    /// Factor on what is mirrored by what is no metal.
    pub specular: f32,
    /// By [`Slot`].
    pub textures: [Option<Texture>; 5],
}

/// What a texture of a material is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Slot {
    Color,
    MetallicRoughness,
    Normal,
    Occlusion,
    Emissive,
}

impl Slot {
    pub const ALL: [Self; 5] =
        [Self::Color, Self::MetallicRoughness, Self::Normal, Self::Occlusion, Self::Emissive];
}

/// Light that comes through, as through a leaf.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Transmission {
    /// Its part of all diffuse light.
    pub part: f32,
    /// Its colour, linear.
    pub tint: [f32; 3],
    /// Whether the picture of the base colour tints it, too.
    pub textured: bool,
}

/// What alpha means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Alpha {
    /// Nothing.
    Opaque,
    /// Below this nothing is drawn.
    Mask(f32),
    /// How much it hides of what is behind.
    Blend,
}

/// A picture as a material uses it.
#[derive(Clone, Debug)]
pub struct Texture {
    pub image: Arc<Image>,
    pub sampling: Sampling,
    /// Which set of texture coordinates: 0 or 1.
    pub set: u32,
    /// Texture coordinates as they are looked up, by rows: 2 × 2, then what is added.
    pub uv_rows: [[f32; 3]; 2],
}

/// How texels are mixed, and what comes beyond the picture's edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Sampling {
    pub wrap: [Wrap; 2],
    /// Texels stay visible.
    pub nearest: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    #[default]
    Repeat,
    Mirror,
    Clamp,
}

/// A sun.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionalLight {
    /// Unit vector towards it.
    pub direction: Vec3,
    /// Linear; in the file's unit, lux as the standard has it.
    pub irradiance: Vec3,
}

impl Default for Surface {
    fn default() -> Self {
        Self {
            name: String::new(),
            color: [1.0; 4],
            metallic: 1.0,
            roughness: 1.0,
            normal_scale: 1.0,
            occlusion_strength: 1.0,
            emissive: [0.0; 3],
            alpha: Alpha::Opaque,
            double_sided: false,
            unlit: false,
            transmission: Transmission::default(),
            specular: 1.0,
            textures: Default::default(),
        }
    }
}

/// How a file is put before the camera: its middle above the origin, its foot on the ground, and by a power of ten as large
/// as eyes and legs are made for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Staging {
    /// The viewer's world from the file's.
    pub world_from_file: DAffine3,
    /// What one metre of the file is in the viewer's world: a power of ten.
    pub scale: f64,
    /// Half the height of what stands there, in the viewer's world.
    pub middle_m: f32,
    /// Of a sphere around it, in the viewer's world.
    pub radius_m: f32,
    /// Side of a square of the ground's grid, in the viewer's world.
    pub cell_m: f32,
}

/// What is smaller is enlarged, and what is larger shrunk: sides in metres.
const SIZES_M: [f64; 2] = [1.0, 50_000.0];

/// Of shapes with more copies, boxes are looked at instead of vertices.
const FEW_COPIES: usize = 16;

impl Asset {
    /// How far anything of it reaches in a direction from the origin of a world, times the direction's length, in the finest levels.
    pub fn reach_m(&self, direction: Vec3, world_from_file: &DAffine3) -> f64 {
        let direction = direction.as_dvec3();
        let of_shape = |shape: &Shape| {
            let points = || shape.levels.iter().take(1).flat_map(|level| self.corners(level));
            let is_many = shape.copies.len() > FEW_COPIES;
            let of_all =
                is_many.then(|| points().fold([Vec3::MAX, Vec3::MIN], |[a, b], p| [a.min(p), b.max(p)]));
            let along = |axis: DVec3| match of_all {
                Some([low, high]) => (low.as_dvec3() * axis).max(high.as_dvec3() * axis).element_sum(),
                None => points().map(|p| p.as_dvec3().dot(axis)).fold(f64::NEG_INFINITY, f64::max),
            };
            let of_copy = |copy: &DAffine3| {
                let place = *world_from_file * *copy;
                along(place.matrix3.transpose() * direction) + place.translation.dot(direction)
            };
            shape.copies.iter().map(of_copy).fold(f64::NEG_INFINITY, f64::max)
        };
        self.shapes.iter().map(of_shape).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Where the corners of a level's triangles lie, in its shape's space.
    pub fn corners<'a>(&'a self, level: &'a ShapeLevel) -> impl Iterator<Item = Vec3> + 'a {
        let indices = level.parts.iter().flat_map(|part| {
            let first = part.range.first as usize;
            &self.indices[first..first + part.range.count as usize]
        });
        indices.map(|index| self.vertices[*index as usize].position_m.into())
    }

    pub fn staging(&self) -> Staging {
        let [low, high] = self.bounds_m.map(|corner| corner.as_dvec3());
        let size = high - low;
        let longest_m = size.max_element();
        let mut scale = 1.0;
        while longest_m > 0.0 && longest_m * scale < SIZES_M[0] {
            scale *= 10.0;
        }
        while longest_m * scale > SIZES_M[1] {
            scale /= 10.0;
        }
        let middle = 0.5 * (low + high);
        let foot = DVec3::new(middle.x, low.y, middle.z);
        let radius_m = (0.5 * size.length() * scale).max(0.01) as f32;
        // Some ten to a hundred squares beside it.
        let cell_m = libm::exp10f(libm::floorf(libm::log10f(radius_m)));
        Staging {
            world_from_file: DAffine3::from_scale(DVec3::splat(scale)) * DAffine3::from_translation(-foot),
            scale,
            middle_m: (0.5 * size.y * scale) as f32,
            radius_m,
            cell_m,
        }
    }
}
