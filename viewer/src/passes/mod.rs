//! The passes: each an immutable set of pipelines that records its part of a picture, with its WGSL beside it.
//!
//! Order of a picture: the shade of near trees when the eye has come to another place, culling, where it shows a lake what
//! that mirrors, then in one render pass what [`Passes::picture`] lists, of a still picture its mean with those before, then tone mapping. Shadows are drawn once for each
//! landscape, before its first picture. A file that is no landscape has two passes of its own. A new pass is a file here with its WGSL, a line in [`SHADERS`],
//! and a line in [`Passes::picture`].

pub mod asset;
mod bound;
mod bound_asset;
mod bound_mirror;
mod bound_shade;
mod cull;
mod drift;
mod feet;
pub mod grass;
pub mod impostors;
mod lamps;
mod layouts;
mod mean;
mod mirror;
mod pipeline;
pub mod plants;
mod shade;
mod shaders;
mod shadow;
mod sky;
mod studio;
mod sun_view;
pub mod terrain;
mod tone;
pub mod trees;
mod view_uniform;
mod water;

pub use asset::AssetPass;
pub use bound::{BoundScene, BoundTrees, Elements};
pub use bound_asset::{AssetDraw, BoundAsset, VisibleCopy};
pub use bound_mirror::{BoundMirror, Reflection};
pub use bound_shade::BoundShade;
pub use cull::{Cull, CullUniform};
pub use lamps::Lamps;
pub use layouts::{Binding, Layouts, bind};
pub use mean::{Mean, Shift, pictures};
pub use mirror::Mirror;
pub use pipeline::Shader;
pub use shade::Shade;
pub use shaders::{ShaderError, Shaders};
pub use shadow::{Shadow, ShadowBake};
pub use studio::Studio;
pub use sun_view::SunView;
pub use tone::Tone;
pub use view_uniform::ViewUniform;

use pipeline::{Compiler, FilledOrWire, PipelineDesc, Target, buffer_layout};

use crate::gpu::Gpu;
use crate::options::Options;

/// Format of radiance.
pub const RADIANCE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Format of depth: floating point, reversed.
pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Format of finished pictures: encoded values, as the user interface expects them.
pub const DISPLAY: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Format of shadow maps.
pub const SHADOW: wgpu::TextureFormat = wgpu::TextureFormat::Depth16Unorm;
/// Format of the part of the sun's light that arrives.
pub const SHADE: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

/// The shaders of all passes.
pub static SHADERS: [&Shader; 13] = [
    &cull::SHADER,
    &trees::SHADER,
    &impostors::SHADER,
    &grass::SHADER,
    &plants::SHADER,
    &terrain::SHADER,
    &sky::SHADER,
    &water::SHADER,
    &mean::SHADER,
    &tone::SHADER,
    &shadow::SHADER,
    &shade::SHADER,
    &asset::SHADER,
];

/// A pass that draws a part of the picture.
pub trait DrawPass: std::fmt::Debug + Send + Sync {
    /// Whether there is anything to draw.
    fn is_needed(&self, _scene: &BoundScene, _options: &Options) -> bool {
        true
    }

    /// Records its draws and tells how many they are. Group 0 is set.
    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, scene: &BoundScene, options: &Options) -> u32;
}

/// All passes.
#[derive(Debug)]
pub struct Passes {
    pub layouts: Layouts,
    pub shadow: Shadow,
    /// Of near trees on the ground, before the picture.
    pub shade: Shade,
    pub cull: Cull,
    /// What a lake mirrors, before the picture.
    pub mirror: Mirror,
    /// By name, in the order in which they draw.
    pub picture: [(&'static str, Box<dyn DrawPass>); 8],
    /// Of files that are no landscapes.
    pub asset: AssetPass,
    pub studio: Studio,
    /// What throws shadows in them, before the first picture.
    pub lamps: Lamps,
    pub mean: Mean,
    pub tone: Tone,
    /// Samples a pixel that they draw.
    pub samples: u32,
}

impl Passes {
    /// Compiles everything. `samples` is 1 or 4.
    pub fn new(gpu: &Gpu, shaders: &Shaders, samples: u32) -> Result<Self, ShaderError> {
        let layouts = Layouts::new(gpu);
        let compiler = Compiler { gpu, layouts: &layouts, shaders, samples };
        Ok(Self {
            shadow: Shadow::new(&compiler)?,
            shade: Shade::new(&compiler)?,
            cull: Cull::new(&compiler)?,
            mirror: Mirror::new(&compiler)?,
            picture: [
                (trees::SHADER.name, Box::new(trees::Trees::new(&compiler)?)),
                // Before the terrain: what it hides needs no light.
                (grass::SHADER.name, Box::new(grass::Grass::new(&compiler)?)),
                (plants::SHADER.name, Box::new(plants::Plants::new(&compiler)?)),
                (terrain::SHADER.name, Box::new(terrain::Terrain::new(&compiler)?)),
                (feet::NAME, Box::new(feet::Feet::new(&compiler)?)),
                // After the terrain: many far trees are behind hills.
                (impostors::SHADER.name, Box::new(impostors::Impostors::new(&compiler)?)),
                (sky::SHADER.name, Box::new(sky::Sky::new(&compiler)?)),
                (water::SHADER.name, Box::new(water::Water::new(&compiler)?)),
            ],
            asset: AssetPass::new(&compiler)?,
            studio: Studio::new(&compiler)?,
            lamps: Lamps::new(&compiler)?,
            mean: Mean::new(&compiler)?,
            tone: Tone::new(&compiler)?,
            layouts,
            samples,
        })
    }
}
