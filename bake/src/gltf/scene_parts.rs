//! What a scene file is written from.

use genescape_schema::scene::{GroundSurface, Instance, Resource, SkyImages, SkyLight, StartView};
use serde_json::Value;

use super::materials::Picture;
use crate::model::{Landform, TreeTextures};

/// A file that the scene names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Blob {
    /// URI relative to the scene file, `../../blobs/ab/abcdef….png`.
    pub uri: String,
    /// Its length.
    pub byte_length: usize,
}

/// A .glb made by this crate that serves as a plain buffer: accessors of the scene point into its BIN chunk.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GlbBlob<'a> {
    /// URI relative to the scene file.
    pub uri: String,
    /// The whole file, to read its table of accessors.
    pub bytes: &'a [u8],
}

/// All that a scene is made of.
#[derive(Clone, Debug)]
pub struct SceneParts<'a> {
    /// The scene's name: "g0003 scene-2".
    pub name: String,
    /// The genome's values in their units, by parameter name; goes into `extras` as it is.
    pub genome: Value,
    /// The land, to stand on and to look over.
    pub land: &'a Landform,
    /// What [`super::terrain_glb`] made.
    pub terrain: GlbBlob<'a>,
    /// What [`super::foreground_glb`] made of the ground around the start, if there is any.
    pub foreground: Option<GlbBlob<'a>>,
    /// Where a person first stands.
    pub view: StartView,
    /// 16-bit grey PNG: 0 is the lowest sample, 65535 the highest.
    pub heights: Resource,
    /// `TerrainLod` as bytes.
    pub lod: Resource,
    /// What covers the ground.
    pub surface: GroundSurface<Resource>,
    /// The surface's details as base colours, see `ground::tile_srgb`.
    pub tiles: Vec<Resource>,
    /// The templates, made by [`super::tree_glb`], in the order of `Instance::template`.
    pub templates: Vec<GlbBlob<'a>>,
    /// The textures that all trees share, by URI.
    pub tree_images: TreeTextures<Picture<'a>>,
    pub trees: &'a [Instance],
    /// The same as the binary data of `GSC_instances`.
    pub instances: Blob,
    /// Those on the land beyond the field, in the same form.
    pub far_trees: Blob,
    /// Sun, sky and haze.
    pub light: &'a SkyLight,
    pub sky: SkyImages<Resource>,
}
