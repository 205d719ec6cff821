//! Camera → what the lake mirrors in one picture, chosen and recorded before that picture.

use crate::camera::Camera;
use crate::gpu::Gpu;
use crate::lod::nested::Sight;
use crate::lod::quadtree;
use crate::options::FrameInput;
use crate::passes::{BoundMirror, BoundScene, Cull, CullUniform, Mirror, Passes, Reflection, ViewUniform};
use crate::upload::SceneBuffers;

use super::terrain::{MAX_BLOCK_M, pixels};

/// The smallest error of the mirrored land in pixels of the mirror, also where the picture allows none.
const MIN_ERROR_PX: f32 = 1.0;

/// Lists that are kept from frame to frame.
#[derive(Debug, Default)]
pub(super) struct MirrorChoice {
    triangles: Vec<[u32; 3]>,
}

impl MirrorChoice {
    /// Records what the lake mirrors and tells how many draws that takes: none where the picture, whose land is drawn for that sight,
    /// does not show the lake.
    #[expect(clippy::too_many_arguments, reason = "what a frame is drawn from")]
    pub fn record(
        &mut self,
        bound: &mut BoundScene,
        gpu: &Gpu,
        scope: &mut wgpu_profiler::Scope<'_, wgpu::CommandEncoder>,
        passes: &Passes,
        size_px: [u32; 2],
        frame: &FrameInput,
        [camera, lod_camera]: [&Camera; 2],
        drawn: Sight,
    ) -> u32 {
        let (scene, Some(mirror)) = (&bound.scene, &mut bound.mirror) else { return 0 };
        let lake = scene.land.lake.as_ref().filter(|_| frame.options.draw_terrain);
        mirror.reflection = lake.and_then(|lake| Reflection::of(lake, camera, size_px, drawn));
        let Some(reflection) = mirror.reflection.clone() else { return 0 };
        let error_px = frame.options.terrain_error_px.max(MIN_ERROR_PX);
        let (lod, eye_m) = (&scene.ground.lod, lod_camera.position_m);
        let focal_px = reflection.focal_px(lod_camera.focal_px(size_px[1] as f32));
        let (nested, pixels) = (&scene.land.nested, pixels(focal_px, error_px));
        let detail = quadtree::detail(lod, &nested.levels_m, pixels, eye_m, false, MAX_BLOCK_M);
        let numbers =
            ViewUniform::new(scene, camera, lod_camera, size_px, frame, &detail, bound.shade.place());
        let numbers = reflection.numbers(numbers);
        mirror.set(gpu, &passes.layouts, size_px, &numbers);
        let sight = Sight { eye_m: numbers.lod_eye.into(), pixels };
        nested.select(&lod.field, &sight, Some(&reflection.frustum), &mut self.triangles);
        mirror.land.write(gpu, self.triangles.as_flattened());
        scene.land.ring.seen(&reflection.frustum, &mut mirror.ring);
        if frame.options.draw_trees {
            cull(gpu, scope, passes, scene, mirror, &reflection);
        }
        draw(scope, passes, bound, &reflection, frame)
    }
}

fn cull(
    gpu: &Gpu,
    scope: &mut wgpu_profiler::Scope<'_, wgpu::CommandEncoder>,
    passes: &Passes,
    scene: &SceneBuffers,
    mirror: &BoundMirror,
    reflection: &Reflection,
) {
    if let Some((set, trees)) = scene.trees.as_ref().zip(mirror.trees.as_ref()) {
        trees.set(&gpu.queue, &CullUniform::for_mirror(set, &reflection.frustum));
        passes.cull.dispatch(&mut scope.scoped_compute_pass(Cull::NAME), trees);
    }
}

fn draw(
    scope: &mut wgpu_profiler::Scope<'_, wgpu::CommandEncoder>,
    passes: &Passes,
    bound: &BoundScene,
    reflection: &Reflection,
    frame: &FrameInput,
) -> u32 {
    let Some(mirror) = &bound.mirror else { return 0 };
    let Some(mut pass) = mirror.begin(Mirror::NAME, scope) else { return 0 };
    // From below nothing is mirrored.
    match reflection.is_from_above() {
        true => passes.mirror.draw(&mut pass, bound, mirror, reflection, &frame.options),
        false => 0,
    }
}
