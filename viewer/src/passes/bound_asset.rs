//! Anyone's file as bound for one view: bind groups, and the list of copies that is written for each frame.

use std::ops::Range;
use std::sync::Arc;

use super::bound::Elements;
use super::{Binding, Layouts, bind};
use crate::gpu::Gpu;
use crate::scene::Part;
use crate::upload::{AssetBuffers, SurfaceData};

/// What the passes draw of a file in one view.
#[derive(Debug)]
pub struct BoundAsset {
    pub asset: Arc<AssetBuffers>,
    pub(super) studio_group: wgpu::BindGroup,
    pub(super) surface_groups: Vec<wgpu::BindGroup>,
    /// A [`VisibleCopy`] for each that is drawn.
    pub visible: Elements,
}

/// A copy as it is drawn.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct VisibleCopy {
    pub number: u32,
    /// Number of its level, and how far it has gone to the next.
    pub lambda: f32,
    /// Of its surface, about.
    pub error_m: f32,
}

/// Some copies of one part of a level.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AssetDraw {
    pub surface: usize,
    pub indices: Range<u32>,
    /// In the list of visible copies.
    pub copies: Range<u32>,
}

impl AssetDraw {
    pub fn of(part: &Part, copies: Range<u32>) -> Self {
        let indices = part.range.first..part.range.first + part.range.count;
        Self { surface: part.surface, indices, copies }
    }
}

impl BoundAsset {
    pub fn new(gpu: &Gpu, layouts: &Layouts, asset: Arc<AssetBuffers>) -> Self {
        let studio = [
            Binding::Buffer(&asset.studio),
            Binding::Buffer(&asset.places),
            Binding::layers(&asset.lamp_maps),
            Binding::Sampler(&layouts.nearest),
        ];
        Self {
            studio_group: bind(gpu, "studio", &layouts.studio, (0..).zip(studio)),
            surface_groups: surface_groups(gpu, layouts, &asset),
            visible: Elements::new(gpu, "visible copies"),
            asset,
        }
    }
}

/// Materials, by their numbers.
pub(super) fn surface_groups(gpu: &Gpu, layouts: &Layouts, asset: &AssetBuffers) -> Vec<wgpu::BindGroup> {
    let group = |surface: &SurfaceData| {
        let buffer = std::iter::once(Binding::Buffer(&surface.uniform));
        let textures = surface.textures.iter().map(|texture| Binding::texture(texture));
        let samplers = surface.samplers.iter().map(Binding::Sampler);
        bind(gpu, &surface.name, &layouts.surface, (0..).zip(buffer.chain(textures).chain(samplers)))
    };
    asset.surfaces.iter().map(group).collect()
}
