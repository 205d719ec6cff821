//! `scene.gltf` → a landscape on the device, with its shadows drawn, and the land to walk on. What two landscapes have in
//! common is read and uploaded once.

use std::path::Path;
use std::sync::Arc;

use anyhow::{Error, Result};

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
}

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
        passes.shadow.bake(&self.gpu, &passes.layouts, &passes.cull, &buffers);
        self.gpu.wait();
        Ok(Arc::new(buffers))
    }

    /// Both.
    pub fn load(&self, path: &Path, passes: &Passes) -> Result<Loaded> {
        let scene = self.read(path)?;
        Ok(Loaded { buffers: self.upload(&scene, passes)?, land: Arc::new(Land::of(&scene)) })
    }
}
