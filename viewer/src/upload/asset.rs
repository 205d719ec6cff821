//! Anyone's file on the device: one vertex buffer and one index buffer for all shapes, where copies stand, materials,
//! and the light of the room that it is shown in.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};

use super::studio::{exposure, studio};
use super::{ImageUse, LAMPS, Lamp, TreeData, Uploader};
use crate::gpu::flat;
use crate::lod::tree::simple_error_m;
use crate::scene::{Alpha, Asset, Facts, Image, Part, Sampling, Shape, Slot, Staging, Surface, Wrap};

/// Texels a side of what a lamp sees.
const LAMP_MAP_SIDE: u32 = 1024;

/// A file on the device.
#[derive(Debug)]
pub struct AssetBuffers {
    /// The file's name.
    pub name: String,
    pub facts: Facts,
    /// Lower and upper corner in the file's own metres.
    pub bounds_m: [Vec3; 2],
    pub staging: Staging,
    pub shapes: Vec<ShapeData>,
    /// Where copies stand, in the order of the shapes: places and sizes to choose levels of detail by.
    pub copies: Vec<CopyData>,
    pub vertices: wgpu::Buffer,
    pub indices: wgpu::Buffer,
    /// [`TreeData`] of each copy.
    pub places: wgpu::Buffer,
    /// [`super::StudioUniform`].
    pub studio: wgpu::Buffer,
    /// So that it is neither dark nor washed out.
    pub exposure: f32,
    pub lamps: [Lamp; LAMPS],
    /// Depths that they see, a layer each; drawn into once.
    pub lamp_maps: wgpu::Texture,
    pub surfaces: Vec<SurfaceData>,
}

/// A shape as levels are chosen for it.
#[derive(Clone, Debug)]
pub struct ShapeData {
    /// Errors in metres and parts of each level, finest first.
    pub errors_m: Vec<f32>,
    pub parts: Vec<Vec<Part>>,
    /// [`simple_error_m`].
    pub simple_error_m: f32,
    /// Levels go over into each other.
    pub morphs: bool,
    /// Number of its first copy.
    pub first_copy: u32,
    pub copies: u32,
}

/// A sphere around a copy in the viewer's world, and by how much the shape is scaled there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CopyData {
    pub center_m: Vec3,
    pub radius_m: f32,
    pub scale: f32,
}

/// A material on the device.
#[derive(Debug)]
pub struct SurfaceData {
    pub name: String,
    pub alpha: Alpha,
    pub double_sided: bool,
    /// [`SurfaceUniform`].
    pub uniform: wgpu::Buffer,
    /// By [`Slot`].
    pub textures: [Arc<wgpu::Texture>; 5],
    pub samplers: [wgpu::Sampler; 5],
}

/// `Surface` of `asset.wgsl`, which says what each field is; a test compares the two.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct SurfaceUniform {
    pub color: [f32; 4],
    pub emissive: [f32; 3],
    pub alpha_cutoff: f32,
    pub metallic: f32,
    pub roughness: f32,
    pub normal_scale: f32,
    pub occlusion_strength: f32,
    pub unlit: f32,
    pub has_normal: f32,
    pub transmission: f32,
    pub transmission_textured: f32,
    pub transmission_tint: [f32; 3],
    pub specular: f32,
    pub uv_maps: [UvMap; 5],
}

/// `UvMap` of `asset.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct UvMap {
    pub matrix: [f32; 4],
    pub offset: [f32; 2],
    pub uv_set: f32,
    pub unused: f32,
}

impl Uploader {
    /// Uploads a file. May run on any thread.
    ///
    /// # Errors
    /// If the device has no room for it.
    pub fn asset(&self, asset: &Asset) -> Result<AssetBuffers, String> {
        use wgpu::BufferUsages as Usage;
        let staging = asset.staging();
        let (mut shapes, mut copies, mut places) = (Vec::new(), Vec::new(), Vec::new());
        for shape in &asset.shapes {
            shapes.push(shape_data(shape, places.len() as u32));
            for copy in &shape.copies {
                let world_from_shape = staging.world_from_file * *copy;
                copies.push(copy_data(shape, &world_from_shape));
                places.push(place_data(&world_from_shape));
            }
        }
        let largest =
            (asset.vertices.len() * size_of::<crate::scene::AssetVertex>()).max(4 * asset.indices.len());
        let limit = self.gpu.device.limits().max_buffer_size;
        if largest as u64 > limit {
            return Err(format!(
                "it takes {} MB at a time, and {} has {limit} bytes",
                largest / 1_000_000,
                self.gpu.name
            ));
        }
        let mut samplers = HashMap::new();
        let surfaces = asset.surfaces.iter().map(|surface| self.surface(surface, &mut samplers));
        let studio = studio(asset, &staging);
        Ok(AssetBuffers {
            name: asset.name.clone(),
            facts: asset.facts.clone(),
            bounds_m: asset.bounds_m,
            shapes,
            copies,
            vertices: self.gpu.buffer("vertices", &asset.vertices, Usage::VERTEX),
            indices: self.gpu.buffer("triangles", &asset.indices, Usage::INDEX),
            places: self.gpu.buffer("places", &places, Usage::STORAGE),
            studio: self.gpu.buffer("studio", &[studio], Usage::UNIFORM),
            exposure: exposure(asset),
            lamps: studio.lamps,
            lamp_maps: self.lamp_maps(),
            surfaces: surfaces.collect(),
            staging,
        })
    }

    fn lamp_maps(&self) -> wgpu::Texture {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let one = flat("what lamps see", [LAMP_MAP_SIDE; 2], wgpu::TextureFormat::Depth16Unorm, usage);
        let size = wgpu::Extent3d { depth_or_array_layers: LAMPS as u32, ..one.size };
        self.gpu.device.create_texture(&wgpu::TextureDescriptor { size, ..one })
    }

    fn surface(&self, surface: &Surface, samplers: &mut HashMap<Sampling, wgpu::Sampler>) -> SurfaceData {
        let texture = |slot: Slot| {
            let (otherwise, kind) = match slot {
                Slot::Color | Slot::Emissive => ([255; 4], ImageUse::Color),
                Slot::Normal => ([128, 128, 255, 255], ImageUse::Data),
                Slot::MetallicRoughness | Slot::Occlusion => ([255; 4], ImageUse::Data),
            };
            match &surface.textures[slot as usize] {
                Some(texture) => self.image(&texture.image, kind),
                None => self.image(&Image::of_one_pixel(otherwise), kind),
            }
        };
        let sampler = |slot: Slot| {
            let sampling = surface.textures[slot as usize].as_ref().map(|texture| texture.sampling);
            let sampling = sampling.unwrap_or_default();
            samplers.entry(sampling).or_insert_with(|| self.sampler(sampling)).clone()
        };
        SurfaceData {
            name: surface.name.clone(),
            alpha: surface.alpha,
            double_sided: surface.double_sided,
            uniform: self.gpu.buffer("surface", &[surface_uniform(surface)], wgpu::BufferUsages::UNIFORM),
            textures: Slot::ALL.map(texture),
            samplers: Slot::ALL.map(sampler),
        }
    }

    fn sampler(&self, sampling: Sampling) -> wgpu::Sampler {
        let address = sampling.wrap.map(|wrap| match wrap {
            Wrap::Repeat => wgpu::AddressMode::Repeat,
            Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
            Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
        });
        let filter = if sampling.nearest { wgpu::FilterMode::Nearest } else { wgpu::FilterMode::Linear };
        // As for the ground: see `Layouts`.
        let smooth = !sampling.nearest && !self.gpu.software;
        self.gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            address_mode_u: address[0],
            address_mode_v: address[1],
            mag_filter: filter,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            anisotropy_clamp: if smooth { 8 } else { 1 },
            ..Default::default()
        })
    }
}

fn shape_data(shape: &Shape, first_copy: u32) -> ShapeData {
    let errors_m: Vec<f32> = shape.levels.iter().map(|level| level.error_m).collect();
    ShapeData {
        simple_error_m: simple_error_m(&errors_m),
        errors_m,
        morphs: shape.morphs,
        parts: shape.levels.iter().map(|level| level.parts.clone()).collect(),
        first_copy,
        copies: shape.copies.len() as u32,
    }
}

fn copy_data(shape: &Shape, world_from_shape: &DAffine3) -> CopyData {
    let scale = max_scale(world_from_shape);
    CopyData {
        center_m: world_from_shape.transform_point3(shape.center_m.as_dvec3()).as_vec3(),
        radius_m: shape.radius_m * scale,
        scale,
    }
}

/// A bound of the greatest singular value, exact where the axes are square to each other.
fn max_scale(transform: &DAffine3) -> f32 {
    let columns = [transform.matrix3.x_axis, transform.matrix3.y_axis, transform.matrix3.z_axis];
    columns.map(DVec3::length).into_iter().fold(0.0, f64::max).max(1e-12) as f32
}

fn place_data(world_from_shape: &DAffine3) -> TreeData {
    let linear = world_from_shape.matrix3.transpose();
    let shift = world_from_shape.translation;
    let row = |row: DVec3, shift: f64| [row.x, row.y, row.z, shift].map(|value| value as f32);
    TreeData {
        rows: [row(linear.x_axis, shift.x), row(linear.y_axis, shift.y), row(linear.z_axis, shift.z)],
        scale: max_scale(world_from_shape),
        ..TreeData::default()
    }
}

fn surface_uniform(surface: &Surface) -> SurfaceUniform {
    let flag = |is_so: bool| f32::from(u8::from(is_so));
    let uv_map = |slot: Slot| {
        let texture = surface.textures[slot as usize].as_ref();
        let ([a, b, x], [c, d, y]) = texture
            .map_or(([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]), |texture| (texture.uv_rows[0], texture.uv_rows[1]));
        let uv_set = texture.map_or(0.0, |texture| texture.set as f32);
        UvMap { matrix: [a, b, c, d], offset: [x, y], uv_set, unused: 0.0 }
    };
    SurfaceUniform {
        color: surface.color,
        emissive: surface.emissive,
        alpha_cutoff: if let Alpha::Mask(cutoff) = surface.alpha { cutoff } else { 0.0 },
        metallic: surface.metallic,
        roughness: surface.roughness,
        normal_scale: surface.normal_scale,
        occlusion_strength: surface.occlusion_strength,
        unlit: flag(surface.unlit),
        has_normal: flag(surface.textures[Slot::Normal as usize].is_some()),
        transmission: surface.transmission.part,
        transmission_textured: flag(surface.transmission.textured),
        transmission_tint: surface.transmission.tint,
        specular: surface.specular,
        uv_maps: Slot::ALL.map(uv_map),
    }
}
