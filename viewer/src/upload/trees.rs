//! Trees: one vertex buffer and one index buffer for all templates and levels, instances, and the commands that draw
//! them.

use std::borrow::Cow;
use std::sync::Arc;

use glam::Vec3;
use half::f16;

use super::clusters::{self, ClusterSheet};
use super::far_sun::FarSun;
use super::{ImageUse, ImpostorSet, PICTURE_VERTICES, Uploader};
use crate::scene::{Crown, Image, Instance, Material, Range, Template, TreeVertex, Trees};

pub use crate::lod::tree::MAX_LEVELS;
/// The most materials that all trees of a landscape may have: each is one draw.
pub const MATERIALS_PER_TREE_SET: usize = 4;

/// A tree, as the shaders read it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct TreeData {
    /// World from the template's space, by rows.
    pub rows: [[f32; 4]; 3],
    /// Number of its template, and the share of the sun that the land around leaves, 0 to 65535 for 0 to 1, for trees beyond the field.
    pub template_and_sun: [u16; 2],
    /// Greatest singular value of the linear part.
    pub scale: f32,
    /// Of the ellipsoid around its template's leaves: height of its middle, semi-axes along x, y and z; 0 if nothing is known.
    pub crown: [f16; 4],
}

/// A template, as the shaders read it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct TemplateData {
    /// Of a sphere around it.
    pub center: [f32; 3],
    /// Of that sphere.
    pub radius: f32,
    /// Error of each level in metres.
    pub errors: [f32; MAX_LEVELS],
    /// Number of levels.
    pub levels: u32,
    /// Where its first list of visible trees starts.
    pub first: u32,
    /// Entries that each of its lists has room for.
    pub capacity: u32,
    /// Error of the simple mode, [`crate::lod::tree::simple_error_m`].
    pub simple_error: f32,
    /// Error of its pictures in metres; beyond all errors if it has none.
    pub picture_error: f32,
    /// The first level in which clusters stand for leaves; beyond all if there is none.
    pub clusters: u32,
    /// Unused.
    pub pad: [f32; 2],
}

/// The arguments of an indexed indirect draw.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct DrawCommand {
    /// How many indices of a mesh.
    pub indices: u32,
    /// Number of trees, written by the device, or of plants.
    pub instances: u32,
    /// Where the mesh's indices start.
    pub first_index: u32,
    /// What is added to each.
    pub base_vertex: i32,
    /// Where they start in the list of those that are visible.
    pub first_instance: u32,
}

impl DrawCommand {
    /// Draws some instances with these indices, if either are any.
    pub fn of(indices: &std::ops::Range<u32>, instances: std::ops::Range<u32>) -> Option<Self> {
        let command = Self {
            indices: indices.end - indices.start,
            instances: instances.end - instances.start,
            first_index: indices.start,
            first_instance: instances.start,
            ..Self::default()
        };
        (command.indices > 0 && command.instances > 0).then_some(command)
    }
}

/// What a material looks like, as the shaders read it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct MaterialUniform {
    /// Factor on the albedo.
    pub factor: [f32; 4],
    /// Below this alpha nothing is drawn.
    pub alpha_cutoff: f32,
    /// 1 if there is a normal texture.
    pub has_normal: f32,
    /// Unused.
    pub unused: [f32; 2],
}

/// All trees of a landscape on the device.
#[derive(Debug)]
pub struct TreeSet {
    /// [`TreeVertex`] of all templates and levels.
    pub vertices: wgpu::Buffer,
    /// 32-bit.
    pub indices: wgpu::Buffer,
    /// [`TreeData`] of each tree.
    pub trees: wgpu::Buffer,
    /// Number of trees.
    pub count: u32,
    /// How many of them stand on the field, whose shadows are drawn: the first ones.
    pub field_count: u32,
    /// [`TemplateData`] of each template.
    pub templates: wgpu::Buffer,
    /// Number of templates.
    pub template_count: u32,
    /// Levels of the template that has most.
    pub level_count: u32,
    /// One for each of [`Self::mesh_draws`], level and template, in this order of significance, nearest levels first, with no
    /// trees yet; then one for the pictures of the field's trees and one for those of the others.
    pub commands: Vec<DrawCommand>,
    /// Draws of meshes that there are commands for: lists of each material; then, if all trees have some, strips of each closed
    /// material, in the same order.
    pub mesh_draws: u32,
    /// Triangles of one tree for each level and template, all materials together: index level · templates + template.
    /// Then those of a picture, twice.
    pub triangles: Vec<u32>,
    /// What the trees are made of.
    pub materials: Vec<TreeMaterial>,
    /// Pictures of the templates, if all have some.
    pub impostors: Option<ImpostorSet>,
    /// Entries of all lists of visible trees together. The first two lists are those of pictures, together as long as there are
    /// trees.
    pub list_capacity: u32,
}

/// A material on the device.
#[derive(Debug)]
pub struct TreeMaterial {
    /// "leaf".
    pub name: String,
    /// True if it has holes and two sides.
    pub masked: bool,
    /// True if its alpha is the share that is covered.
    pub thin: bool,
    /// True if it shows pictures of clusters of leaves.
    pub clusters: bool,
    /// [`MaterialUniform`].
    pub uniform: wgpu::Buffer,
    /// Colour.
    pub color: Arc<wgpu::Texture>,
    /// Normals.
    pub normal: Arc<wgpu::Texture>,
}

impl Uploader {
    /// With the sun in that direction; `None` if there are no trees to draw.
    pub(super) fn trees(&self, trees: &Trees, sun: Vec3, far_sun: &FarSun) -> Option<TreeSet> {
        if trees.all().next().is_none() || trees.templates.is_empty() {
            return None;
        }
        use wgpu::BufferUsages as Usage;
        let sheet = ClusterSheet::of(&trees.templates);
        let plain = sheet.is_none() && trees.templates.iter().any(|template| template.clusters.is_some());
        let plain = plain.then(|| Trees {
            templates: trees.templates.iter().map(|template| Arc::new(clusters::without(template))).collect(),
            ..trees.clone()
        });
        let trees = plain.as_ref().unwrap_or(trees);
        let (gpu, materials) = (&self.gpu, common_materials(trees, sheet.as_ref()));
        let lists = arrange(trees, &materials);
        let all_trees: Vec<TreeData> = trees.all().map(|tree| tree_data(trees, tree, far_sun)).collect();
        let vertices = trees.templates.iter().enumerate().map(|(number, template)| match &sheet {
            Some(sheet) => Cow::Owned(sheet.moved(number, template)),
            None => Cow::Borrowed(&template.vertices),
        });
        let vertices: Vec<Cow<'_, Vec<TreeVertex>>> = vertices.collect();
        let vertices: Vec<&[TreeVertex]> = vertices.iter().map(|vertices| &vertices[..]).collect();
        let indices: Vec<&[u32]> = trees.templates.iter().map(|template| &template.indices[..]).collect();
        Some(TreeSet {
            vertices: gpu.buffer("tree vertices", &vertices.concat(), Usage::VERTEX),
            indices: gpu.buffer("tree indices", &indices.concat(), Usage::INDEX),
            trees: gpu.buffer("trees", &all_trees, Usage::STORAGE),
            count: all_trees.len() as u32,
            field_count: trees.instances.len() as u32,
            templates: gpu.buffer("templates of trees", &lists.templates, Usage::STORAGE),
            template_count: lists.templates.len() as u32,
            level_count: level_count(trees) as u32,
            commands: lists.commands,
            mesh_draws: lists.mesh_draws as u32,
            triangles: lists.triangles,
            materials: materials.iter().map(|material| self.material(material)).collect(),
            impostors: self.impostors(&trees.templates, all_trees.len(), sun),
            list_capacity: lists.capacity,
        })
    }

    fn material(&self, material: &Material) -> TreeMaterial {
        let uniform = MaterialUniform {
            factor: material.color_factor,
            alpha_cutoff: material.alpha_cutoff.unwrap_or(0.0),
            has_normal: if material.normal.is_some() { 1.0 } else { 0.0 },
            unused: [0.0; 2],
        };
        let image = |image: &Option<Image>, otherwise: [u8; 4], kind: ImageUse| match image {
            Some(image) if material.clusters => self.sheet(image, kind),
            Some(image) => self.image(image, kind),
            None => self.image(&Image::of_one_pixel(otherwise), kind),
        };
        let masked = material.alpha_cutoff.is_some();
        let cutout_or_color = if masked && !material.thin { ImageUse::Cutout } else { ImageUse::Albedo };
        TreeMaterial {
            name: material.name.clone(),
            masked,
            thin: material.thin,
            clusters: material.clusters,
            uniform: self.gpu.buffer("material", &[uniform], wgpu::BufferUsages::UNIFORM),
            color: image(&material.color, [255; 4], cutout_or_color),
            normal: image(&material.normal, [128, 128, 255, 255], ImageUse::Data),
        }
    }
}

/// The lists that say how to draw the trees, as in [`TreeSet`].
struct Lists {
    templates: Vec<TemplateData>,
    commands: Vec<DrawCommand>,
    mesh_draws: usize,
    triangles: Vec<u32>,
    capacity: u32,
}

fn arrange(trees: &Trees, materials: &[Material]) -> Lists {
    let (templates, has_pictures) = (trees.templates.len(), ImpostorSet::suits(&trees.templates));
    let buckets = level_count(trees) * templates;
    let mesh_draws = materials.len() + strips(trees, materials);
    let mut lists = Lists {
        templates: Vec::new(),
        commands: vec![DrawCommand::default(); buckets * mesh_draws],
        mesh_draws,
        triangles: vec![0; buckets],
        capacity: trees.all().count() as u32,
    };
    for first in [0, trees.instances.len()] {
        let base_vertex = (PICTURE_VERTICES as usize * first) as i32;
        lists.commands.push(DrawCommand { instances: 1, base_vertex, ..DrawCommand::default() });
        lists.triangles.push(2);
    }
    let (mut base_vertex, mut base_index) = (0, 0);
    for (index, template) in trees.templates.iter().enumerate() {
        let capacity = trees.all().filter(|tree| tree.template as usize == index).count() as u32;
        for (number, level) in template.levels.iter().take(MAX_LEVELS).enumerate() {
            let bucket = number * templates + index;
            let command = |range: &Range| DrawCommand {
                indices: range.count,
                instances: 0,
                first_index: base_index + range.first,
                base_vertex: (base_vertex + level.base_vertex) as i32,
                first_instance: lists.capacity + number as u32 * capacity,
            };
            for (part, (range, material)) in level.ranges.iter().zip(&template.materials).enumerate() {
                let slot = materials.iter().position(|known| same(known, material)).unwrap_or(0);
                lists.commands[slot * buckets + bucket] = command(range);
                let strip = level.strips.get(part).filter(|_| slot + materials.len() < mesh_draws);
                if let Some(strip) = strip {
                    lists.commands[(materials.len() + slot) * buckets + bucket] = command(strip);
                }
                lists.triangles[bucket] += range.count / 3;
            }
        }
        let picture_error =
            template.impostor.as_ref().filter(|_| has_pictures).map(|pictures| pictures.error_m);
        lists.templates.push(TemplateData {
            picture_error: picture_error.unwrap_or(f32::MAX),
            ..template_data(template, lists.capacity, capacity)
        });
        lists.capacity += depth(template) as u32 * capacity;
        base_vertex += template.vertices.len() as u32;
        base_index += template.indices.len() as u32;
    }
    lists
}

/// Closed materials, which are the first, if all their triangles are there as strips, too; else none.
fn strips(trees: &Trees, materials: &[Material]) -> usize {
    let has_strips = |template: &Template| {
        template.levels.iter().all(|level| {
            let parts = level.ranges.iter().zip(&template.materials).enumerate();
            let closed =
                parts.filter(|(_, (list, material))| list.count > 0 && material.alpha_cutoff.is_none());
            closed
                .map(|(part, _)| part)
                .all(|part| level.strips.get(part).is_some_and(|strip| strip.count > 0))
        })
    };
    let closed = materials.iter().filter(|material| material.alpha_cutoff.is_none()).count();
    if trees.templates.iter().all(|template| has_strips(template)) { closed } else { 0 }
}

/// Levels of a template that are drawn.
fn depth(template: &Template) -> usize {
    template.levels.len().min(MAX_LEVELS)
}

fn level_count(trees: &Trees) -> usize {
    trees.templates.iter().map(|template| depth(template)).max().unwrap_or(1)
}

fn template_data(template: &Template, first: u32, capacity: u32) -> TemplateData {
    let levels = depth(template);
    let mut errors = [f32::MAX; MAX_LEVELS];
    for (slot, level) in errors.iter_mut().zip(&template.levels) {
        *slot = level.error_m;
    }
    TemplateData {
        center: template.center_m,
        radius: template.radius_m,
        errors,
        levels: levels as u32,
        first,
        capacity,
        clusters: template.clusters.unwrap_or(u32::MAX),
        simple_error: crate::lod::tree::simple_error_m(&errors[..levels]),
        ..TemplateData::default()
    }
}

fn tree_data(trees: &Trees, instance: &Instance, far_sun: &FarSun) -> TreeData {
    let template = trees.templates.get(instance.template as usize);
    // Bare twigs hardly shade each other.
    let leafy = template.filter(|template| template.materials.iter().all(|material| !material.thin));
    let crown = leafy.and_then(|template| template.impostor.as_ref()).map(|pictures| pictures.crown);
    let crown =
        crown.map_or([0.0; 4], |Crown { middle_m: [_, middle, _], half_m: [x, y, z] }| [middle, x, y, z]);
    let [x, y, z] = instance.world_from_tree.map(|row| row[3]);
    let sun = 65_535.0 * far_sun.left(Vec3::new(x, y, z)) + 0.5;
    TreeData {
        rows: instance.world_from_tree,
        template_and_sun: [instance.template as u16, sun as u16],
        scale: instance.max_scale(),
        crown: crown.map(f16::from_f32),
    }
}

/// Materials of all templates, equal ones once, and all clusters as one; beyond [`MATERIALS_PER_TREE_SET`] the first is used
/// instead.
fn common_materials(trees: &Trees, sheet: Option<&ClusterSheet>) -> Vec<Material> {
    let mut materials: Vec<Material> = sheet.iter().map(|sheet| sheet.material.clone()).collect();
    for material in trees.templates.iter().flat_map(|template| &template.materials) {
        let known = materials.iter().any(|known| same(known, material));
        if !known && materials.len() < MATERIALS_PER_TREE_SET {
            materials.push(material.clone());
        }
    }
    // What has no holes first: it hides what is behind.
    materials.sort_by_key(|material| material.alpha_cutoff.is_some());
    materials
}

fn same(a: &Material, b: &Material) -> bool {
    if a.clusters || b.clusters {
        return a.clusters == b.clusters;
    }
    let name = |image: &Option<Image>| image.as_ref().map(|image| image.name.clone());
    (name(&a.color), name(&a.normal), a.color_factor, a.alpha_cutoff)
        == (name(&b.color), name(&b.normal), b.color_factor, b.alpha_cutoff)
}
