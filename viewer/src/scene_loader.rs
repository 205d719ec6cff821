//! `scene.gltf` → a landscape on the device, with its shadows drawn, and the land to walk on. What two landscapes have in
//! common is read and uploaded once.

use std::path::Path;
use std::sync::Arc;

use anyhow::{Error, Result};
use glam::{Vec2, Vec3Swizzles};

use crate::gpu::Gpu;
use crate::load::{self, Store};
use crate::passes::Passes;
use crate::scene::Scene;
use crate::upload::{SceneBuffers, Uploader};
use crate::walk::Land;

/// A landscape that can be drawn and walked in.
#[derive(Clone, Debug)]
pub struct Loaded {
    pub buffers: Arc<SceneBuffers>,
    pub land: Arc<Land>,
    /// Only trees near by throw shadows on others yet.
    pub lacks_shadows: bool,
}

/// How far around the eye shadows are drawn before a landscape is shown: what is farther is a few pixels high.
const NEAR_M: f32 = 150.0;

/// Reads landscapes and brings them to one device.
pub struct SceneLoader {
    gpu: Gpu,
    store: Store,
    uploader: Uploader,
}

impl SceneLoader {
    pub fn new(gpu: &Gpu) -> Self {
        Self { gpu: gpu.clone(), store: Store::default(), uploader: Uploader::new(gpu) }
    }

    /// Reads the landscape of a `scene.gltf`.
    pub fn read(&self, path: &Path) -> Result<Scene> {
        Ok(load::load(path, &self.store)?)
    }

    /// Brings a landscape to the device. Its shadows are done when this returns: no picture has to wait for them.
    pub fn upload(&self, scene: &Scene, passes: &Passes) -> Result<Arc<SceneBuffers>> {
        let buffers = self.uploader.upload(scene).map_err(Error::msg)?;
        passes.shadow.begin(&self.gpu, passes, &buffers).all();
        Ok(Arc::new(buffers))
    }

    /// Both.
    pub fn load(&self, path: &Path, passes: &Passes) -> Result<Loaded> {
        let scene = self.read(path)?;
        let buffers = self.upload(&scene, passes)?;
        Ok(Loaded { buffers, land: Arc::new(Land::of(&scene)), lacks_shadows: false })
    }

    /// Both, with those shadows only that are seen from `eye_m` (x and z), or from where walks start.
    pub fn load_with_near_shadows(
        &self,
        path: &Path,
        passes: &Passes,
        eye_m: Option<Vec2>,
    ) -> Result<Loaded> {
        let scene = self.read(path)?;
        let buffers = self.uploader.upload(&scene).map_err(Error::msg)?;
        let bake = passes.shadow.begin(&self.gpu, passes, &buffers);
        bake.land();
        bake.trees_around(eye_m.unwrap_or(scene.start.position_m.xz()), NEAR_M);
        drop(bake);
        let land = Arc::new(Land::of(&scene));
        Ok(Loaded { buffers: Arc::new(buffers), land, lacks_shadows: true })
    }
}
