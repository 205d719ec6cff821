//! A glTF file → a landscape on the device, with its shadows drawn, and the land to walk on; or anyone's file and the ground
//! under it. What two landscapes have in common is read and uploaded once.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Error, Result};
use glam::Vec2;

use crate::gpu::Gpu;
use crate::load::{self, Content, Store};
use crate::passes::Passes;
use crate::scene::{Asset, Scene};
use crate::upload::{AssetBuffers, Exhibit, SceneBuffers, Uploader};
use crate::walk::{Anchor, Land};

/// A landscape, or anyone's file, that can be drawn and walked in.
#[derive(Clone, Debug)]
pub struct Loaded {
    pub exhibit: Exhibit,
    pub land: Arc<Land>,
    /// Only trees near by throw shadows on others yet.
    pub lacks_shadows: bool,
    /// What it is made of besides its own file; only of anyone's files, for blobs never change.
    pub files: Vec<PathBuf>,
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
        Ok(load::scene(path, &self.store)?)
    }

    /// Brings a landscape to the device. Its shadows are done when this returns: no picture has to wait for them.
    pub fn upload(&self, scene: &Scene, passes: &Passes) -> Result<Arc<SceneBuffers>> {
        let buffers = self.uploader.upload(scene).map_err(Error::msg)?;
        passes.shadow.begin(&self.gpu, passes, &buffers).all();
        Ok(Arc::new(buffers))
    }

    /// Brings anyone's file to the device, with what its lamps see.
    pub fn upload_asset(&self, asset: &Asset, passes: &Passes) -> Result<Arc<AssetBuffers>> {
        let buffers = self.uploader.asset(asset).map_err(Error::msg)?;
        passes.lamps.draw(&self.gpu, &passes.layouts, &buffers);
        Ok(Arc::new(buffers))
    }

    /// Reads whatever there is and brings it to the device.
    pub fn load(&self, path: &Path, passes: &Passes) -> Result<Loaded> {
        self.load_by(path, passes, |scene| {
            let exhibit = self.upload(scene, passes)?.into();
            let land = Arc::new(Land::of(scene).from_its_start());
            Ok(Loaded { exhibit, land, lacks_shadows: false, files: Vec::new() })
        })
    }

    /// The same, of a landscape with those shadows only that are seen from `eye_m` (x and z of the walk), which lies in it
    /// where `anchor` says, or from its start.
    pub fn load_with_near_shadows(
        &self,
        path: &Path,
        passes: &Passes,
        eye_m: Vec2,
        anchor: Option<Anchor>,
    ) -> Result<Loaded> {
        self.load_by(path, passes, |scene| {
            let buffers = self.uploader.upload(scene).map_err(Error::msg)?;
            let bake = passes.shadow.begin(&self.gpu, passes, &buffers);
            bake.land();
            let land = Arc::new(Land::of(scene).from_its_start());
            bake.trees_around(anchor.unwrap_or(land.anchor).in_land(eye_m), NEAR_M);
            drop(bake);
            let exhibit = Arc::new(buffers).into();
            Ok(Loaded { exhibit, land, lacks_shadows: true, files: Vec::new() })
        })
    }

    /// Brings a landscape to the device by `landscape`, and any other file as it is.
    fn load_by(
        &self,
        path: &Path,
        passes: &Passes,
        landscape: impl FnOnce(&Scene) -> Result<Loaded>,
    ) -> Result<Loaded> {
        match load::load(path, &self.store)? {
            Content::Landscape(scene) => landscape(&scene),
            Content::Asset(asset, files) => {
                let exhibit = self.upload_asset(&asset, passes)?.into();
                let land = Arc::new(Land::under(&asset));
                Ok(Loaded { exhibit, land, lacks_shadows: false, files })
            }
        }
    }
}
