//! What the bind groups of all passes look like, and the samplers they share.

use crate::gpu::Gpu;
use wgpu::{AddressMode, FilterMode, MipmapFilterMode, Sampler, ShaderStages};
use wgpu::{BindGroupLayout, BindGroupLayoutEntry, BindingType, BufferBindingType, SamplerBindingType};
use wgpu::{TextureSampleType, TextureViewDimension};

/// Bind group layouts by what they hold; each pass names the groups it needs.
#[derive(Debug)]
pub struct Layouts {
    /// Group 0 of every picture: view, light, aerial perspective. See `common.wgsl`.
    pub view: BindGroupLayout,
    /// Group 0 of shadow maps' passes, which cannot read what it writes: a part of `view`.
    pub sun_view: BindGroupLayout,
    /// Group 0 of what needs the camera alone: a file that is no landscape, tone mapping.
    pub camera: BindGroupLayout,
    /// Group 1 of a file that is no landscape: the room, where copies stand, what lamps see.
    pub studio: BindGroupLayout,
    /// Group 1 of what draws that: a part of `studio`.
    pub places: BindGroupLayout,
    /// Group 2 of the same: a material.
    pub surface: BindGroupLayout,
    /// Group 1 of the terrain, of grass and of plants with a texture: what covers the land.
    pub ground: BindGroupLayout,
    /// Group 1 of trees: where they stand.
    pub trees: BindGroupLayout,
    /// Group 1 of pictures of trees.
    pub impostors: BindGroupLayout,
    /// Group 2 of trees: a material.
    pub material: BindGroupLayout,
    /// Group 1 of culling.
    pub cull: BindGroupLayout,
    /// Group 1 of water: what it mirrors, and how far away that is.
    pub mirror: BindGroupLayout,
    /// Group 1 of the shade of near trees: what the sun sees of them.
    pub seen_by_sun: BindGroupLayout,
    /// Group 1 of its coarser versions: the next finer one.
    pub finer: BindGroupLayout,
    /// Group 1 of tone mapping: radiance.
    pub radiance: BindGroupLayout,
    /// Repeats, with mip levels.
    pub repeating: wgpu::Sampler,
    /// Ends at the edge, with mip levels.
    pub clamped: wgpu::Sampler,
    /// Ends at the edge, and gives texels as they are: what gathers depth must not filter it.
    pub nearest: wgpu::Sampler,
}

/// The bindings of `common.wgsl` that are read while a shadow map is drawn.
pub(super) const SUN_VIEW: [u32; 4] = [0, 2, 8, 9];

const UNIFORM: BindingType = buffer(BufferBindingType::Uniform);
const READ: BindingType = buffer(BufferBindingType::Storage { read_only: true });
const WRITE: BindingType = buffer(BufferBindingType::Storage { read_only: false });
const FILTERING: BindingType = BindingType::Sampler(SamplerBindingType::Filtering);
const UNFILTERING: BindingType = BindingType::Sampler(SamplerBindingType::NonFiltering);
const FILTERED: TextureSampleType = TextureSampleType::Float { filterable: true };
const IMAGE: BindingType = texture(FILTERED, TextureViewDimension::D2);
const LAYERS: BindingType = texture(FILTERED, TextureViewDimension::D2Array);
const CUBE: BindingType = texture(FILTERED, TextureViewDimension::Cube);
const UNFILTERED: TextureSampleType = TextureSampleType::Float { filterable: false };
const DATA: BindingType = texture(UNFILTERED, TextureViewDimension::D2);
const DEPTH_MAP: BindingType = texture(TextureSampleType::Depth, TextureViewDimension::D2);
const DEPTH_MAPS: BindingType = texture(TextureSampleType::Depth, TextureViewDimension::D2Array);

const fn buffer(ty: BufferBindingType) -> BindingType {
    BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None }
}

const fn texture(sample_type: TextureSampleType, view_dimension: TextureViewDimension) -> BindingType {
    BindingType::Texture { sample_type, view_dimension, multisampled: false }
}

impl Layouts {
    pub fn new(gpu: &Gpu) -> Self {
        // Ground is seen at low angles. Mesa's software driver takes fifteen times as long for a picture with it.
        let anisotropy = if gpu.software { 1 } else { 8 };
        let all = |label: &str, visibility: ShaderStages, types: &[BindingType]| {
            layout(gpu, label, visibility, (0..).zip(types.iter().copied()))
        };
        let (both, fragment) = (ShaderStages::VERTEX_FRAGMENT, ShaderStages::FRAGMENT);
        let (clamp, repeat) = (AddressMode::ClampToEdge, AddressMode::Repeat);
        let view = [
            UNIFORM,
            FILTERING,
            FILTERING,
            CUBE,
            IMAGE,
            IMAGE,
            IMAGE,
            DEPTH_MAP,
            UNFILTERING,
            DATA,
            IMAGE,
            DATA,
            IMAGE,
        ];
        let sun_view = SUN_VIEW.map(|binding| (binding, view[binding as usize]));
        Self {
            view: all("view", both, &view),
            sun_view: layout(gpu, "view of the sun", both, sun_view),
            camera: all("camera", both, &[UNIFORM]),
            studio: all("studio", both, &[UNIFORM, READ, DEPTH_MAPS, UNFILTERING]),
            places: layout(gpu, "places", ShaderStages::VERTEX, [(1, READ)]),
            surface: all("surface", fragment, &[&[UNIFORM][..], &[IMAGE; 5], &[FILTERING; 5]].concat()),
            ground: all("ground", both, &[IMAGE, IMAGE, LAYERS, IMAGE, IMAGE]),
            trees: all("trees", ShaderStages::VERTEX, &[READ]),
            impostors: all("pictures of trees", both, &[READ, READ, LAYERS, LAYERS, READ, LAYERS]),
            material: all("material", fragment, &[UNIFORM, IMAGE, IMAGE]),
            cull: all("culling", ShaderStages::COMPUTE, &[READ, READ, READ, WRITE, WRITE, WRITE]),
            mirror: all("mirror", fragment, &[IMAGE, DEPTH_MAP]),
            seen_by_sun: all("trees seen by the sun", fragment, &[DEPTH_MAP]),
            finer: layout(gpu, "finer shade", fragment, [(1, DATA)]),
            radiance: all("radiance", fragment, &[DATA]),
            repeating: sampler(gpu, repeat, FilterMode::Linear, anisotropy),
            clamped: sampler(gpu, clamp, FilterMode::Linear, 1),
            nearest: sampler(gpu, clamp, FilterMode::Nearest, 1),
        }
    }
}

fn layout(
    gpu: &Gpu,
    label: &str,
    visibility: ShaderStages,
    bindings: impl IntoIterator<Item = (u32, BindingType)>,
) -> BindGroupLayout {
    let entry = |(binding, ty)| BindGroupLayoutEntry { binding, visibility, ty, count: None };
    let entries: Vec<BindGroupLayoutEntry> = bindings.into_iter().map(entry).collect();
    let descriptor = wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries };
    gpu.device.create_bind_group_layout(&descriptor)
}

fn sampler(gpu: &Gpu, address: AddressMode, filter: FilterMode, anisotropy: u16) -> Sampler {
    gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        address_mode_u: address,
        address_mode_v: address,
        mag_filter: filter,
        min_filter: filter,
        mipmap_filter: match filter {
            FilterMode::Linear => MipmapFilterMode::Linear,
            FilterMode::Nearest => MipmapFilterMode::Nearest,
        },
        anisotropy_clamp: anisotropy,
        ..Default::default()
    })
}

/// What is bound to one binding of a group.
pub enum Binding<'a> {
    Buffer(&'a wgpu::Buffer),
    Sampler(&'a wgpu::Sampler),
    View(wgpu::TextureView),
}

impl Binding<'_> {
    /// All of a texture: an image, or several layers.
    pub fn texture(texture: &wgpu::Texture) -> Self {
        Self::View(texture.create_view(&Default::default()))
    }

    /// Any number of layers.
    pub fn layers(texture: &wgpu::Texture) -> Self {
        let dimension = Some(TextureViewDimension::D2Array);
        Self::View(texture.create_view(&wgpu::TextureViewDescriptor { dimension, ..Default::default() }))
    }

    /// Six layers as the faces of a cube.
    pub fn cube(texture: &wgpu::Texture) -> Self {
        let dimension = Some(TextureViewDimension::Cube);
        Self::View(texture.create_view(&wgpu::TextureViewDescriptor { dimension, ..Default::default() }))
    }
}

/// A bind group of that layout.
pub fn bind<'a>(
    gpu: &Gpu,
    label: &str,
    layout: &BindGroupLayout,
    bindings: impl IntoIterator<Item = (u32, Binding<'a>)>,
) -> wgpu::BindGroup {
    let bindings: Vec<_> = bindings.into_iter().collect();
    let resource = |bound| match bound {
        &Binding::Buffer(buffer) => buffer.as_entire_binding(),
        &Binding::Sampler(sampler) => wgpu::BindingResource::Sampler(sampler),
        Binding::View(view) => wgpu::BindingResource::TextureView(view),
    };
    let entries: Vec<_> = bindings
        .iter()
        .map(|(binding, bound)| wgpu::BindGroupEntry { binding: *binding, resource: resource(bound) })
        .collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}
