//! Anyone's file as bound for one view: bind groups, and the list of copies that is written for each frame.

use std::ops::Range;
use std::sync::Arc;

use super::bound::Elements;
use super::{Binding, Layouts, bind};
use crate::gpu::Gpu;
use crate::upload::{AssetBuffers, SurfaceData};

/// What the passes draw of a file in one view.
#[derive(Debug)]
pub struct BoundAsset {
    pub asset: Arc<AssetBuffers>,
    pub(super) studio_group: wgpu::BindGroup,
    pub(super) surface_groups: Vec<wgpu::BindGroup>,
    /// Number and λ of each copy that is drawn.
    pub visible: Elements,
}

/// Some copies of one part of a level.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AssetDraw {
    pub surface: usize,
    pub indices: Range<u32>,
    /// In the list of visible copies.
    pub copies: Range<u32>,
}

impl BoundAsset {
    pub fn new(gpu: &Gpu, layouts: &Layouts, asset: Arc<AssetBuffers>) -> Self {
        let studio = [Binding::Buffer(&asset.studio), Binding::Buffer(&asset.places)];
        let surface = |surface: &SurfaceData| {
            let buffer = std::iter::once(Binding::Buffer(&surface.uniform));
            let textures = surface.textures.iter().map(|texture| Binding::texture(texture));
            let samplers = surface.samplers.iter().map(Binding::Sampler);
            bind(gpu, &surface.name, &layouts.surface, (0..).zip(buffer.chain(textures).chain(samplers)))
        };
        Self {
            studio_group: bind(gpu, "studio", &layouts.studio, (0..).zip(studio)),
            surface_groups: asset.surfaces.iter().map(surface).collect(),
            visible: Elements::new(gpu, "visible copies"),
            asset,
        }
    }
}
