//! Camera and LOD mode → the blocks or triangles of the terrain that one picture draws.

use crate::camera::Camera;
use crate::gpu::Gpu;
use crate::lod::morph::Detail;
use crate::lod::nested::Sight;
use crate::lod::{block, quadtree, roam};
use crate::lod_mode::TerrainLodMode;
use crate::options::Options;
use crate::passes::BoundScene;

/// No block of the terrain is wider, so that what is not seen can be left out.
pub const MAX_BLOCK_M: f32 = 256.0;
/// The smallest error that is told from none, in pixels.
const MIN_ERROR_PX: f32 = 1e-4;

/// Lists that are kept from frame to frame.
#[derive(Debug, Default)]
pub(super) struct TerrainChoice {
    blocks: Vec<block::Block>,
    strip: Vec<u32>,
    triangles: Vec<[u32; 3]>,
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
        let (lod, nested) = (&scene.ground.lod, &scene.land.nested);
        let (focal_px, eye_m) = (camera.focal_px(height), camera.position_m);
        // Without levels of detail no error is allowed.
        let error_px = if mode == TerrainLodMode::Off { 0.0 } else { options.terrain_error_px };
        let pixels = pixels(focal_px, error_px);
        let budget = options.terrain_triangles;
        let is_exact = error_px.is_nan() || error_px <= 0.0;
        let mut detail = quadtree::detail(lod, &nested.levels_m, pixels, eye_m, is_exact, MAX_BLOCK_M);
        let aspect = width / height;
        let frustum = options.cull.then(|| camera.frustum(aspect));
        let triangles = match mode {
            TerrainLodMode::Morph => {
                let (sight, triangles) = (Sight { eye_m, pixels }, &mut self.triangles);
                match budget {
                    None => nested.select(&lod.field, &sight, frustum.as_ref(), triangles),
                    Some(budget) => {
                        let within =
                            nested.select_within(&lod.field, sight, frustum.as_ref(), budget, triangles);
                        detail.pixels = within.pixels;
                    }
                }
                bound.terrain.write(gpu, triangles.as_flattened());
                triangles.len() as u32
            }
            TerrainLodMode::Roam => {
                let picture = (aspect, height);
                let triangles =
                    roam::triangulate(lod, camera, picture, error_px, options.cull, budget, &mut self.strip);
                bound.terrain.write(gpu, &self.strip);
                triangles
            }
            TerrainLodMode::Distance | TerrainLodMode::Off => {
                quadtree::select(lod, &detail, frustum.as_ref(), &mut self.blocks);
                bound.terrain.write(gpu, &self.blocks);
                quadtree::triangles(&lod.field, &self.blocks)
            }
        };
        (detail, triangles)
    }
}

/// What the land of a picture is drawn for: that of a budget with ROAM may be off by anything.
pub(super) fn sight(detail: &Detail, camera: &Camera, options: &Options) -> Sight {
    let is_unknown = options.terrain_lod == TerrainLodMode::Roam && options.terrain_triangles.is_some();
    Sight { eye_m: camera.position_m, pixels: if is_unknown { 0.0 } else { detail.pixels } }
}

/// [`Sight::pixels`] of a picture in which a radian covers `focal_px` pixels and the land may be `error_px` off.
pub(super) fn pixels(focal_px: f32, error_px: f32) -> f32 {
    focal_px / error_px.max(MIN_ERROR_PX)
}
