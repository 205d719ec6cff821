//! The order in which passes draw a landscape.

use super::Drawn;
use super::mirror::MirrorChoice;
use super::targets::Targets;
use super::terrain::{TerrainChoice, sight};
use crate::camera::Camera;
use crate::gpu::Gpu;
use crate::options::{FrameInput, Options};
use crate::passes::grass::GrassChoice;
use crate::passes::plants::PlantChoice;
use crate::passes::{BoundScene, Cull, CullUniform, Passes, ViewUniform};

/// Lists that are kept from frame to frame.
#[derive(Debug, Default)]
pub(super) struct LandscapeChoice {
    terrain: TerrainChoice,
    mirror: MirrorChoice,
    grass: GrassChoice,
    /// Small plants and stones.
    plants: PlantChoice,
}

impl LandscapeChoice {
    /// Records one picture of a landscape; the view's numbers are written to `uniform`.
    #[expect(clippy::too_many_arguments, reason = "what a frame is drawn from")]
    pub fn record(
        &mut self,
        bound: &mut BoundScene,
        gpu: &Gpu,
        uniform: &wgpu::Buffer,
        scope: &mut wgpu_profiler::Scope<'_, wgpu::CommandEncoder>,
        passes: &Passes,
        targets: &Targets,
        frame: &FrameInput,
        [camera, lod_camera]: [&Camera; 2],
    ) -> Drawn {
        let (options, size_px) = (&frame.options, targets.size_px);
        let size = size_px.map(|side| side as f32);
        let frustum = lod_camera.frustum(size[0] / size[1]);

        // Where frames are slow, not while one moves: it is as long as one.
        let may_move = frame.part >= 1.0 || !gpu.software;
        if bound.shade.follow(gpu, &bound.scene, lod_camera.position_m, may_move) {
            passes.shade.record(scope, passes, &bound.scene, &bound.shade);
        }
        let (detail, triangles) = self.terrain.choose(bound, gpu, lod_camera, size, options);
        let numbers =
            ViewUniform::new(&bound.scene, camera, lod_camera, size_px, frame, &detail, bound.shade.place());
        gpu.queue.write_buffer(uniform, 0, bytemuck::bytes_of(&numbers));

        if let Some((set, trees)) = bound.trees() {
            let (eye_m, focal_px) = (lod_camera.position_m, lod_camera.focal_px(size[1]));
            let culling = CullUniform::for_view(set, &frustum, eye_m, focal_px, options);
            trees.set(&gpu.queue, &culling);
            passes.cull.dispatch(&mut scope.scoped_compute_pass(Cull::NAME), trees);
        }
        self.grass.clear();
        self.plants.clear();
        if options.draws_grass() {
            let (ground, eye_m) = (&bound.scene.ground, lod_camera.position_m);
            self.grass.choose(ground, eye_m, &frustum, frame.part);
            self.plants.choose(ground, &bound.scene.land.plants.kinds, eye_m, &frustum, frame.part);
        }
        bound.clouds_fade = numbers.other_clouds > 0.0;
        bound.clumps.write(gpu, &self.grass.clumps);
        bound.clump_draws.write(gpu, &self.grass.draws);
        bound.plants.write(gpu, &self.plants.instances);
        bound.plant_draws.write(gpu, &self.plants.draws);
        bound.plain_plants = self.plants.plain;
        bound.feet_draws.write(gpu, &self.plants.feet);
        bound.scene.land.ring.seen(&camera.frustum(size[0] / size[1]), &mut bound.ring);
        let drawn = sight(&detail, lod_camera, options);
        let mirrored =
            self.mirror.record(bound, gpu, scope, passes, size_px, frame, [camera, lod_camera], drawn);
        let draws = mirrored + draw(scope, passes, bound, targets, options);
        Drawn { draws, triangles, copies_by_level: Vec::new() }
    }
}

/// Records what draws radiance, and tells how many draws there are with that of the tone.
fn draw(
    scope: &mut wgpu_profiler::Scope<'_, wgpu::CommandEncoder>,
    passes: &Passes,
    bound: &BoundScene,
    targets: &Targets,
    options: &Options,
) -> u32 {
    let mut draws = 1;
    let mut picture = targets.picture(scope);
    picture.set_bind_group(0, &bound.view_group, &[]);
    if let Some(statistics) = &targets.statistics {
        picture.begin_pipeline_statistics_query(statistics, 0);
    }
    for (name, pass) in passes.picture.iter().filter(|(_, pass)| pass.is_needed(bound, options)) {
        draws += pass.draw(&mut picture.scope(*name), bound, options);
    }
    if targets.statistics.is_some() {
        picture.end_pipeline_statistics_query();
    }
    draws
}
