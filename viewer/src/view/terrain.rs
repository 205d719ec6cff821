//! Camera and LOD mode → the blocks or triangles of the terrain that one picture draws.

use crate::camera::Camera;
use crate::gpu::Gpu;
use crate::lod::morph::Detail;
use crate::lod::{block, quadtree, roam};
use crate::lod_mode::TerrainLodMode;
use crate::options::Options;
use crate::passes::BoundScene;

/// No block of the terrain is wider, so that what is not seen can be left out.
pub const MAX_BLOCK_M: f32 = 256.0;

/// Lists that are kept from frame to frame.
#[derive(Debug, Default)]
pub(super) struct TerrainChoice {
    blocks: Vec<block::Block>,
    strip: Vec<u32>,
}

impl TerrainChoice {
    /// Chooses for `camera` what to draw and writes it to the device. Tells how detailed the terrain is where, and how
    /// many triangles that takes.
    pub fn choose(
        &mut self,
        bound: &mut BoundScene,
        gpu: &Gpu,
        camera: &Camera,
        [width, height]: [f32; 2],
        options: &Options,
    ) -> (Detail, u32) {
        let (scene, mode) = (&bound.scene, options.terrain_lod);
        let lod = &scene.ground.lod;
        let (focal_px, eye_m) = (camera.focal_px(height), camera.position_m);
        // Without levels of detail no error is allowed.
        let error_px = if mode == TerrainLodMode::Off { 0.0 } else { options.terrain_error_px };
        let is_exact = error_px.is_nan() || error_px <= 0.0;
        if mode != TerrainLodMode::Roam {
            bound.reach.set(gpu, &scene.land.roughness, mode, focal_px, error_px);
        }
        let detail = quadtree::detail(lod, &bound.reach.reach, eye_m, is_exact, MAX_BLOCK_M);
        let aspect = width / height;
        let triangles = if mode == TerrainLodMode::Roam {
            let picture = (aspect, height);
            let triangles = roam::triangulate(lod, camera, picture, error_px, options.cull, &mut self.strip);
            bound.terrain.write(gpu, &self.strip);
            triangles
        } else {
            let frustum = options.cull.then(|| camera.frustum(aspect));
            quadtree::select(lod, &bound.reach.reach, &detail, frustum.as_ref(), &mut self.blocks);
            bound.terrain.write(gpu, &self.blocks);
            quadtree::triangles(&lod.field, &self.blocks)
        };
        (detail, triangles)
    }
}
