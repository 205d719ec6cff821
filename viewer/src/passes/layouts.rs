//! What the bind groups of all passes look like, and the samplers they share.

use crate::gpu::Gpu;
use wgpu::{BindGroupLayout, BindGroupLayoutEntry, BindingType, Device, ShaderStages, TextureViewDimension};

/// Bind group layouts by what they hold; each pass names the groups it needs.
#[derive(Debug)]
pub struct Layouts {
    /// Group 0 of every picture: view, light, air. See `common.wgsl`.
    pub view: BindGroupLayout,
    /// Group 0 of the shadow pass, which cannot read what it writes.
    pub sun_view: BindGroupLayout,
    /// Group 1 of the terrain and of grass: what covers the land.
    pub ground: BindGroupLayout,
    /// Group 1 of trees: where they stand.
    pub trees: BindGroupLayout,
    /// Group 2 of trees: a material.
    pub material: BindGroupLayout,
    /// Group 1 of the choice of trees.
    pub cull: BindGroupLayout,
    /// Group 1 of tones: radiance.
    pub radiance: BindGroupLayout,
    /// Repeats, with mip levels.
    pub repeating: wgpu::Sampler,
    /// Ends at the edge, with mip levels.
    pub clamped: wgpu::Sampler,
    /// Compares depth.
    pub comparing: wgpu::Sampler,
}

const BOTH: ShaderStages = ShaderStages::VERTEX_FRAGMENT;

fn uniform() -> BindingType {
    BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    }
}

fn storage(read_only: bool) -> BindingType {
    let ty = wgpu::BufferBindingType::Storage { read_only };
    BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None }
}

fn texture(view_dimension: TextureViewDimension) -> BindingType {
    let sample_type = wgpu::TextureSampleType::Float { filterable: true };
    BindingType::Texture { sample_type, view_dimension, multisampled: false }
}

fn of_type(sample_type: wgpu::TextureSampleType) -> BindingType {
    BindingType::Texture { sample_type, view_dimension: TextureViewDimension::D2, multisampled: false }
}

fn layout(
    device: &Device,
    label: &str,
    visibility: ShaderStages,
    bindings: &[(u32, BindingType)],
) -> BindGroupLayout {
    let entries: Vec<BindGroupLayoutEntry> = bindings
        .iter()
        .map(|&(binding, ty)| BindGroupLayoutEntry { binding, visibility, ty, count: None })
        .collect();
    device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

impl Layouts {
    /// Makes them.
    pub fn new(gpu: &Gpu) -> Self {
        let device = &gpu.device;
        // Ground is seen at low angles. Mesa's software driver takes fifteen times as long for a picture with it.
        let anisotropy = if gpu.software { 1 } else { 8 };
        use TextureViewDimension::{Cube, D2, D2Array};
        let filtering = BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let comparison = BindingType::Sampler(wgpu::SamplerBindingType::Comparison);
        let unfilterable = of_type(wgpu::TextureSampleType::Float { filterable: false });
        let view = [
            (0, uniform()),
            (1, filtering),
            (2, filtering),
            (3, texture(Cube)),
            (4, texture(Cube)),
            (5, texture(D2)),
            (6, texture(D2)),
            (7, of_type(wgpu::TextureSampleType::Depth)),
            (8, comparison),
            (9, unfilterable),
            (10, texture(D2)),
        ];
        let compute: Vec<(u32, BindingType)> = vec![
            (0, uniform()),
            (1, storage(true)),
            (2, storage(true)),
            (3, storage(false)),
            (4, storage(false)),
            (5, storage(false)),
        ];
        let ground = [(0, texture(D2)), (1, texture(D2)), (2, texture(D2Array)), (3, texture(D2Array))];
        let fragment = ShaderStages::FRAGMENT;
        Self {
            view: layout(device, "view", BOTH, &view),
            sun_view: layout(
                device,
                "view of the sun",
                BOTH,
                &[(0, uniform()), (2, filtering), (9, unfilterable)],
            ),
            ground: layout(device, "ground", BOTH, &ground),
            trees: layout(device, "trees", ShaderStages::VERTEX, &[(0, storage(true))]),
            material: layout(
                device,
                "material",
                fragment,
                &[(0, uniform()), (1, texture(D2)), (2, texture(D2))],
            ),
            cull: layout(device, "choice of trees", ShaderStages::COMPUTE, &compute),
            radiance: layout(device, "radiance", fragment, &[(0, unfilterable)]),
            repeating: sampler(device, wgpu::AddressMode::Repeat, anisotropy),
            clamped: sampler(device, wgpu::AddressMode::ClampToEdge, 1),
            comparing: device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("comparing"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                compare: Some(wgpu::CompareFunction::LessEqual),
                ..Default::default()
            }),
        }
    }
}

fn sampler(device: &Device, address: wgpu::AddressMode, anisotropy_clamp: u16) -> wgpu::Sampler {
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: None,
        address_mode_u: address,
        address_mode_v: address,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        anisotropy_clamp,
        ..Default::default()
    })
}

/// A view of a whole texture.
pub fn texture_view(texture: &wgpu::Texture, dimension: wgpu::TextureViewDimension) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor { dimension: Some(dimension), ..Default::default() })
}

/// A bind group of that layout.
pub fn bind(
    device: &Device,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    bound: &[(u32, wgpu::BindingResource<'_>)],
) -> wgpu::BindGroup {
    let entries: Vec<wgpu::BindGroupEntry<'_>> = bound
        .iter()
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding: *binding, resource: resource.clone() })
        .collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}
