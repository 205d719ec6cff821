//! A [`Scene`]'s plain values → buffers and textures on the device. Immutable once made; shared by all views that show
//! it. What two landscapes have in common (a tree that was inherited, a texture) is uploaded once.

mod asset;
mod clusters;
mod exhibit;
mod far_shade;
mod far_sun;
mod ground;
mod ground_kinds;
mod horizon;
mod impostors;
mod lake;
mod lamps;
mod leaf_light;
mod leaves;
mod plants;
mod ring;
mod sky;
mod studio;
mod texture;
mod trees;

use std::collections::HashMap;
use std::sync::{Arc, Mutex, Weak};

use genescape_schema::scene::SkyLight;

pub use asset::{AssetBuffers, CopyData, ShapeData, SurfaceData, SurfaceUniform, UvMap};
pub use exhibit::{Exhibit, WeakExhibit};
pub use far_shade::SHADED_M;
pub use ground::{DRY_ALPHA, GroundBuffers};
pub use ground_kinds::KINDS;
pub use impostors::{ImpostorData, ImpostorSet, PICTURE_INDICES, PICTURE_LISTS, PICTURE_VERTICES};
pub use lake::{Lake, Window};
pub use lamps::{HALF_DEPTH, LAMPS, Lamp, RINGS};
pub use plants::{PLANT_BLOCK_M, PlantBuffers, PlantBuffersOfKind, PlantVertex};
pub use ring::{Ring, RingVertex};
pub use sky::SkyTextures;
pub use studio::StudioUniform;
pub use texture::ImageUse;
pub use trees::{
    DrawCommand, MATERIALS_PER_TREE_SET, MAX_LEVELS, MaterialUniform, TemplateData, TreeData, TreeMaterial,
    TreeSet,
};

use crate::gpu::{Gpu, flat};
use crate::scene::{Ground, Scene};
use far_sun::FarSun;

/// A landscape on the device.
#[derive(Debug)]
pub struct SceneBuffers {
    /// The individual's name.
    pub name: String,
    /// The plain values that a view needs besides: heights to choose levels of detail by, light.
    pub ground: Ground,
    /// Sun and air.
    pub sky: SkyLight,
    /// The land.
    pub land: GroundBuffers,
    /// Sky images.
    pub sky_textures: SkyTextures,
    /// Trees; none if the land is bare.
    pub trees: Option<TreeSet>,
    /// Shadows as seen from the sun; drawn into once.
    pub shadow_map: wgpu::Texture,
}

/// Uploads landscapes.
#[derive(Debug)]
pub struct Uploader {
    gpu: Gpu,
    textures: Mutex<HashMap<String, Weak<wgpu::Texture>>>,
}

impl Uploader {
    /// To that device.
    pub fn new(gpu: &Gpu) -> Self {
        Self { gpu: gpu.clone(), textures: Mutex::default() }
    }

    /// Uploads a landscape. May run on any thread.
    pub fn upload(&self, scene: &Scene) -> Result<SceneBuffers, String> {
        let sun_direction = scene.sky.light.sun_direction;
        let far_sun = FarSun::of(&scene.ground.field, &scene.ground.apron, sun_direction);
        let (land, (trees, sky_textures)) = rayon::join(
            || self.ground(scene, &far_sun),
            || rayon::join(|| self.trees(&scene.trees, sun_direction, &far_sun), || self.sky(&scene.sky)),
        );
        Ok(SceneBuffers {
            name: scene.name.clone(),
            ground: scene.ground.clone(),
            sky: scene.sky.light.clone(),
            land: land?,
            sky_textures,
            trees,
            shadow_map: self.shadow_map(),
        })
    }

    fn shadow_map(&self) -> wgpu::Texture {
        // A tree's crown is some metres wide: half a metre a texel shows it; a quarter is better where memory is plentiful.
        let side = if self.gpu.software { 2048 } else { 4096 };
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let format = wgpu::TextureFormat::Depth16Unorm;
        self.gpu.device.create_texture(&flat("shadow map", [side, side], format, usage))
    }

    /// The texture of that name, made if none is in use.
    fn shared(&self, name: String, make: impl FnOnce() -> wgpu::Texture) -> Arc<wgpu::Texture> {
        let lock = || self.textures.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        if let Some(known) = lock().get(&name).and_then(Weak::upgrade) {
            return known;
        }
        let made = Arc::new(make());
        let mut textures = lock();
        textures.retain(|_, texture| texture.strong_count() > 0);
        textures.insert(name, Arc::downgrade(&made));
        made
    }
}
