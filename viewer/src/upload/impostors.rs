//! Pictures of trees: the strips of all templates as layers of two textures, and where each stands.

use std::sync::Arc;

use glam::Vec3;

use super::{ImageUse, Uploader};
use crate::scene::{IMPOSTOR_ROWS, Impostor, LeafSide, Template};

/// Mip levels end where a picture of a strip has so many pixels a side.
const MIN_PX: u32 = 8 * genescape_schema::scene::IMPOSTOR_PICTURES;

/// The pictures of a template, as the shader reads it. Metres in the template's space.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct ImpostorData {
    /// x and z of the vertical axis.
    pub axis: [f32; 2],
    /// Width and height.
    pub size: [f32; 2],
    /// Of the ellipsoid around the leaves.
    pub crown_middle: [f32; 3],
    /// y of the lower edge.
    pub low: f32,
    /// Semi-axes of that ellipsoid.
    pub crown_half: [f32; 3],
    /// The width of a leaf.
    pub leaf_m: f32,
    /// Where the tree's middle is in each row from the top, x and z from the axis.
    pub middles: [[f32; 2]; IMPOSTOR_ROWS],
}

/// The pictures of all templates.
#[derive(Debug)]
pub struct ImpostorSet {
    /// [`ImpostorData`] of each.
    pub frames: wgpu::Buffer,
    /// Colour, a layer for each template.
    pub colors: Arc<wgpu::Texture>,
    /// Relief, likewise.
    pub reliefs: Arc<wgpu::Texture>,
    /// How its leaves are lit, likewise.
    pub leaf_lights: Arc<wgpu::Texture>,
    /// Two triangles for each tree, of four vertices.
    pub indices: wgpu::Buffer,
}

impl ImpostorSet {
    /// Whether all of these have pictures, of one size.
    pub(super) fn suits(templates: &[Arc<Template>]) -> bool {
        let size = |template: &Arc<Template>| {
            template.impostor.as_ref().map(|pictures| [pictures.color.width_px, pictures.color.height_px])
        };
        let first = templates.first().and_then(size);
        first.is_some() && templates.iter().all(|template| size(template) == first)
    }
}

/// Corners of a picture.
pub const PICTURE_VERTICES: u32 = 4;
/// Its two triangles.
pub const PICTURE_INDICES: [u32; 6] = [0, 1, 2, 2, 1, 3];
/// Lists of trees that are seen as pictures: those of the field and those beyond.
pub const PICTURE_LISTS: u32 = 2;

impl Uploader {
    /// For so many trees of these templates, with the sun in that direction.
    pub(super) fn impostors(
        &self,
        templates: &[Arc<Template>],
        trees: usize,
        sun: Vec3,
    ) -> Option<ImpostorSet> {
        use wgpu::BufferUsages as Usage;
        if !ImpostorSet::suits(templates) {
            return None;
        }
        let all: Vec<&Impostor> =
            templates.iter().filter_map(|template| template.impostor.as_ref()).collect();
        let frames: Vec<ImpostorData> = all.iter().map(|one| frame(one)).collect();
        let [colors, reliefs]: [Vec<_>; 2] =
            [all.iter().map(|one| &one.color).collect(), all.iter().map(|one| &one.relief).collect()];
        let leaves: Vec<&[LeafSide]> = all.iter().map(|one| &one.leaves[..]).collect();
        let indices: Vec<u32> = (0..trees as u32)
            .flat_map(|tree| PICTURE_INDICES.map(|corner| PICTURE_VERTICES * tree + corner))
            .collect();
        Some(ImpostorSet {
            frames: self.gpu.buffer("frames of pictures", &frames, Usage::STORAGE),
            colors: self.strips(&colors, ImageUse::Cutout, MIN_PX),
            reliefs: self.strips(&reliefs, ImageUse::Data, MIN_PX),
            leaf_lights: self.leaf_lights(&leaves, sun),
            indices: self.gpu.buffer("triangles of pictures", &indices, Usage::INDEX),
        })
    }
}

fn frame(pictures: &Impostor) -> ImpostorData {
    ImpostorData {
        axis: pictures.axis_m,
        size: pictures.size_m,
        crown_middle: pictures.crown.middle_m,
        low: pictures.low_m,
        crown_half: pictures.crown.half_m,
        leaf_m: pictures.leaf_m,
        middles: pictures.middles_m,
    }
}
