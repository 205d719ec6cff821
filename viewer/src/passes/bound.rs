//! A landscape as bound for one view: bind groups, and the buffers that are written for each frame.

use std::ops::Range;
use std::sync::Arc;

use super::{Binding, BoundMirror, BoundShade, CullUniform, Layouts, bind};
use crate::gpu::Gpu;
use crate::upload::{PICTURE_LISTS, SceneBuffers, TreeSet};

/// What the passes draw for one view.
#[derive(Debug)]
pub struct BoundScene {
    pub scene: Arc<SceneBuffers>,
    pub view_group: wgpu::BindGroup,
    pub ground_group: wgpu::BindGroup,
    trees: Option<BoundTrees>,
    /// Shade of near trees on the ground.
    pub shade: BoundShade,
    /// None without a lake.
    pub mirror: Option<BoundMirror>,
    /// Blocks, or sample numbers of a strip, as the LOD mode has it.
    pub terrain: Elements,
    /// Whether one copy of the clouds fades into the other.
    pub clouds_fade: bool,
    /// Clumps of grass.
    pub clumps: Elements,
    /// Which of them are drawn with fine blades, and which with coarse ones: [`crate::upload::DrawCommand`].
    pub clump_draws: Elements,
    /// What is drawn of the ring's indices.
    pub ring: Vec<Range<u32>>,
    /// Small plants and stones.
    pub plants: Elements,
    /// Which of them are drawn together: [`crate::upload::DrawCommand`].
    pub plant_draws: Elements,
    /// How many of these draws are of plants without a texture: the first ones.
    pub plain_plants: u32,
    /// Of the ground around their feet.
    pub feet_draws: Elements,
}

/// A buffer of vertices, instances, indices or draws that is written anew for each frame and grows as needed.
#[derive(Debug)]
pub struct Elements {
    pub buffer: wgpu::Buffer,
    pub count: u32,
}

/// The trees of a landscape, with room for what culling finds.
#[derive(Debug)]
pub struct BoundTrees {
    uniform: wgpu::Buffer,
    pub(super) cull_group: wgpu::BindGroup,
    pub(super) trees_group: wgpu::BindGroup,
    pub(super) material_groups: Vec<wgpu::BindGroup>,
    /// Of the pictures, if there are any.
    pub(super) impostors_group: Option<wgpu::BindGroup>,
    /// Trees for each level and template: u32 at level · templates + template; then pictures.
    pub counts: wgpu::Buffer,
    /// Number of each visible tree, its λ, and the share of its pixels that are drawn.
    pub visible: wgpu::Buffer,
    /// [`TreeSet::commands`] with numbers of trees.
    pub commands: wgpu::Buffer,
    /// Levels × templates.
    pub buckets: u32,
    pub(super) instances: u32,
    pub(super) command_count: u32,
}

impl BoundScene {
    /// `uniform` holds the view's [`super::ViewUniform`]; `turn`: which of the four views it is.
    pub fn new(
        gpu: &Gpu,
        layouts: &Layouts,
        scene: Arc<SceneBuffers>,
        uniform: &wgpu::Buffer,
        turn: usize,
    ) -> Self {
        use Binding::{Buffer, Sampler};
        let (sky, land) = (&scene.sky_textures, &scene.land);
        let shade = BoundShade::new(gpu, layouts, &scene, turn);
        let view = |uniform: &wgpu::Buffer| {
            let bound = [
                Buffer(uniform),
                Sampler(&layouts.repeating),
                Sampler(&layouts.clamped),
                Binding::cube(&sky.cube),
                Binding::texture(&sky.clear_dome),
                Binding::texture(&sky.cumulus),
                Binding::texture(&sky.cirrus),
                Binding::texture(&scene.shadow_map),
                Sampler(&layouts.nearest),
                Binding::texture(&land.heights),
                Binding::texture(&land.light),
                Binding::texture(&land.bounds),
                Binding::texture(&shade.texture),
            ];
            bind(gpu, "view", &layouts.view, (0..).zip(bound))
        };
        let ground: [&wgpu::Texture; 5] =
            [&land.color, &land.weights, &land.details, &land.normals, &land.far_shade];
        let ground = (0..).zip(ground.map(Binding::texture));
        Self {
            view_group: view(uniform),
            ground_group: bind(gpu, "ground", &layouts.ground, ground),
            trees: scene.trees.as_ref().map(|set| BoundTrees::new(gpu, layouts, set)),
            mirror: BoundMirror::new(gpu, layouts, &scene, view),
            shade,
            terrain: Elements::new(gpu, "terrain"),
            clouds_fade: false,
            clumps: Elements::new(gpu, "clumps of grass"),
            clump_draws: Elements::new(gpu, "draws of grass"),
            ring: Vec::new(),
            plants: Elements::new(gpu, "small plants"),
            plant_draws: Elements::new(gpu, "draws of small plants"),
            plain_plants: 0,
            feet_draws: Elements::new(gpu, "draws of feet"),
            scene,
        }
    }

    pub fn trees(&self) -> Option<(&TreeSet, &BoundTrees)> {
        self.scene.trees.as_ref().zip(self.trees.as_ref())
    }
}

impl Elements {
    const USAGE: wgpu::BufferUsages = wgpu::BufferUsages::VERTEX
        .union(wgpu::BufferUsages::INDEX)
        .union(wgpu::BufferUsages::INDIRECT)
        .union(wgpu::BufferUsages::COPY_DST);

    pub(super) fn new(gpu: &Gpu, label: &str) -> Self {
        Self { buffer: gpu.empty_buffer(label, 64 * 1024, Self::USAGE), count: 0 }
    }

    /// Draws what its numbers are the indices of.
    pub(super) fn draw_as_indices(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_index_buffer(self.buffer.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..self.count, 0, 0..1);
    }

    pub fn write<T: bytemuck::NoUninit>(&mut self, gpu: &Gpu, elements: &[T]) {
        let bytes: &[u8] = bytemuck::cast_slice(elements);
        if bytes.len() as u64 > self.buffer.size() {
            self.buffer = gpu.empty_buffer("elements", (bytes.len() as u64).next_power_of_two(), Self::USAGE);
        }
        gpu.queue.write_buffer(&self.buffer, 0, bytes);
        self.count = elements.len() as u32;
    }
}

impl BoundTrees {
    pub fn new(gpu: &Gpu, layouts: &Layouts, set: &TreeSet) -> Self {
        use wgpu::BufferUsages as Usage;
        let buckets = set.template_count * set.level_count;
        let uniform = gpu.buffer("culling", &[CullUniform::default()], Usage::STORAGE | Usage::COPY_DST);
        let written = Usage::STORAGE | Usage::COPY_SRC;
        let counts = gpu.empty_buffer("counts", 4 * u64::from(buckets + PICTURE_LISTS), written);
        let room = 12 * u64::from(set.list_capacity);
        let visible = gpu.empty_buffer("visible trees", room, written | Usage::VERTEX);
        let commands = gpu.buffer("commands", &set.commands, written | Usage::INDIRECT);
        let culled = [&uniform, &set.trees, &set.templates, &counts, &visible, &commands];
        let culled = (0..).zip(culled.map(Binding::Buffer));
        let material = |material: &crate::upload::TreeMaterial| {
            let [color, normal] = [&material.color, &material.normal].map(|t| Binding::texture(t));
            let bound = [Binding::Buffer(&material.uniform), color, normal];
            bind(gpu, &material.name, &layouts.material, (0..).zip(bound))
        };
        let impostors_group = set.impostors.as_ref().map(|pictures| {
            let [colors, reliefs, lights] = [&pictures.colors, &pictures.reliefs, &pictures.leaf_lights]
                .map(|layers| Binding::layers(layers));
            let [trees, frames, visible] = [&set.trees, &pictures.frames, &visible].map(Binding::Buffer);
            let drawn = [trees, frames, colors, reliefs, visible, lights];
            bind(gpu, "pictures of trees", &layouts.impostors, (0..).zip(drawn))
        });
        Self {
            cull_group: bind(gpu, "culling", &layouts.cull, culled),
            impostors_group,
            trees_group: bind(gpu, "trees", &layouts.trees, [(0, Binding::Buffer(&set.trees))]),
            material_groups: set.materials.iter().map(material).collect(),
            uniform,
            counts,
            visible,
            commands,
            buckets,
            instances: set.count,
            command_count: set.commands.len() as u32,
        }
    }

    /// Says what to cull by.
    pub fn set(&self, queue: &wgpu::Queue, uniform: &CullUniform) {
        queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(uniform));
    }
}
