//! Camera and LOD mode → the copies of anyone's shapes that one picture draws, each at its level, and how they are drawn.

use super::Drawn;
use super::targets::Targets;
use crate::camera::{Camera, Frustum};
use crate::gpu::Gpu;
use crate::lod::tree::{COVERED_PX, Control, distance_m, lod_number};
use crate::lod_mode::TreeLodMode;
use crate::options::Options;
use crate::passes::{AssetDraw, AssetPass, BoundAsset, Passes, Studio, VisibleCopy};
use crate::scene::Alpha;
use crate::upload::{AssetBuffers, ShapeData};

/// Each takes a draw of its own; of more than these the farthest are left out.
const MAX_BLENDED: usize = 1 << 14;

/// Lists that are kept from frame to frame.
#[derive(Debug, Default)]
pub(super) struct AssetChoice {
    /// Those that are drawn together one after the other.
    visible: Vec<VisibleCopy>,
    /// Copies of one shape, before they are put in order by level.
    found: Vec<VisibleCopy>,
    solid: Vec<AssetDraw>,
    /// With the distance of each.
    blended: Vec<(f32, AssetDraw)>,
    /// Copies at each level.
    levels: Vec<u32>,
    triangles: u32,
}

impl AssetChoice {
    /// Chooses for `camera` what to draw and writes it to the device.
    pub fn choose(
        &mut self,
        bound: &mut BoundAsset,
        gpu: &Gpu,
        camera: &Camera,
        [width, height]: [f32; 2],
        options: &Options,
    ) {
        let frustum = camera.frustum(width / height);
        let control = Control {
            mode: options.mesh_lod,
            focal_px: camera.focal_px(height),
            error_px: options.mesh_error_px,
        };
        self.visible.clear();
        self.solid.clear();
        self.blended.clear();
        self.levels.clear();
        self.triangles = 0;
        for shape in &bound.asset.shapes {
            self.find(&bound.asset, shape, camera, &frustum, &control);
            self.draw(&bound.asset, shape, camera);
        }
        // What hides most first; a change of material costs most.
        self.solid.sort_by_key(|draw| draw.surface);
        self.blended.sort_by(|(near, _), (far, _)| far.total_cmp(near));
        self.blended.drain(..self.blended.len().saturating_sub(MAX_BLENDED));
        bound.visible.write(gpu, &self.visible);
    }

    /// The copies of a shape that are seen, in the order of their levels.
    fn find(
        &mut self,
        asset: &AssetBuffers,
        shape: &ShapeData,
        camera: &Camera,
        frustum: &Frustum,
        control: &Control,
    ) {
        self.found.clear();
        let control = shape.control(control, camera);
        for number in shape.first_copy..shape.first_copy + shape.copies {
            let copy = &asset.copies[number as usize];
            if frustum.sees_sphere(copy.center_m, copy.radius_m) {
                let away_m = distance_m(copy.center_m.distance(camera.position_m), copy.radius_m);
                let lambda = lod_number(&control, &shape.errors_m, shape.simple_error_m, away_m, copy.scale);
                let error_m = copy.scale * shape.error_m_at(lambda);
                self.found.push(VisibleCopy { number, lambda, error_m });
            }
        }
        self.found.sort_by_key(|copy| copy.lambda as u32);
    }

    fn draw(&mut self, asset: &AssetBuffers, shape: &ShapeData, camera: &Camera) {
        let found = std::mem::take(&mut self.found);
        for same in found.chunk_by(|a, b| a.lambda as u32 == b.lambda as u32) {
            let level = (same[0].lambda as usize).min(shape.parts.len() - 1);
            let first = self.visible.len() as u32;
            self.visible.extend_from_slice(same);
            self.levels.resize(self.levels.len().max(level + 1), 0);
            self.levels[level] += same.len() as u32;
            for part in &shape.parts[level] {
                let triangles = (part.range.count / 3).saturating_mul(same.len() as u32);
                self.triangles = self.triangles.saturating_add(triangles);
                if asset.surfaces[part.surface].alpha != Alpha::Blend {
                    self.solid.push(AssetDraw::of(part, first..first + same.len() as u32));
                    continue;
                }
                for (at, copy) in (first..).zip(same) {
                    let away_m = asset.copies[copy.number as usize].center_m.distance(camera.position_m);
                    self.blended.push((away_m, AssetDraw::of(part, at..at + 1)));
                }
            }
        }
        self.found = found;
    }
}

impl ShapeData {
    /// Between those of the levels that it is between.
    fn error_m_at(&self, lambda: f32) -> f32 {
        let of = |level: usize| self.errors_m[level.min(self.errors_m.len() - 1)];
        let (level, part) = (lambda as usize, lambda.fract());
        of(level) + part * (of(level + 1) - of(level))
    }

    /// Levels that do not morph change where their file says, whatever the mode (but for none) and the picture's size.
    fn control(&self, control: &Control, camera: &Camera) -> Control {
        match control.mode {
            TreeLodMode::Off => *control,
            _ if self.morphs => *control,
            _ => Control { mode: TreeLodMode::Discrete, focal_px: camera.focal_px(COVERED_PX), ..*control },
        }
    }
}

/// Records everything that draws a file.
pub(super) fn draw(
    scope: &mut wgpu_profiler::Scope<'_, wgpu::CommandEncoder>,
    passes: &Passes,
    bound: &BoundAsset,
    choice: &AssetChoice,
    camera_group: &wgpu::BindGroup,
    targets: &Targets,
    options: &Options,
) -> Drawn {
    let mut picture = targets.picture(scope);
    picture.set_bind_group(0, camera_group, &[]);
    let mut draws = 1;
    let blended: Vec<AssetDraw> = choice.blended.iter().map(|(_, draw)| draw.clone()).collect();
    draws += passes.asset.draw(&mut picture.scope(AssetPass::NAME), bound, &choice.solid, options.wireframe);
    draws += passes.studio.draw(&mut picture.scope(Studio::NAME), bound, options.draw_terrain);
    draws += passes.asset.draw(&mut picture.scope("transparent"), bound, &blended, options.wireframe);
    Drawn { draws, triangles: choice.triangles, copies_by_level: choice.levels.clone() }
}
