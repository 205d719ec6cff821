//! All parts of a landscape → `scene.gltf`.

use genescape_schema::scene::{GroundSurface, Resource, SkyImages};
use serde::Serialize;
use serde_json::Value;

use super::ground::GroundTextureFiles;
use super::placement::PlacementFiles;
use super::start::StartFiles;
use super::terrain_lod::TerrainFiles;
use crate::gltf::{Blob, GlbBlob, Picture, SceneParts, scene_gltf};
use crate::graph::{Context, File, Input, Stage, StageError};
use crate::model::{GroundMaps, Landform, SkyLight, TreeTextures};

/// Extension of the blobs that `scene.gltf` files are copies of.
pub const SCENE_EXT: &str = "json";

/// Everything → the text of `scene.gltf`.
#[derive(Serialize)]
pub struct SceneStage {
    /// The individual's name.
    pub name: String,
    /// All genes by name with their values, for the scene's `extras`.
    pub genes: Vec<(String, f32)>,
    pub landform: Input<Landform>,
    pub terrain: Input<TerrainFiles>,
    pub foreground: Input<File>,
    pub start: Input<StartFiles>,
    pub ground_maps: Input<GroundMaps<File>>,
    pub ground_textures: Vec<Input<GroundTextureFiles>>,
    pub light_map: Input<File>,
    /// The templates' files.
    pub trees: Vec<Input<File>>,
    pub tree_textures: Input<TreeTextures<File>>,
    pub placed: Input<PlacementFiles>,
    pub far_trees: Input<File>,
    pub light: Input<SkyLight>,
    pub sky: Input<SkyImages<File>>,
}

impl Stage for SceneStage {
    const NAME: &'static str = "scene";
    const VERSION: u32 = 12;
    type Output = File;

    fn run(&self, context: &Context<'_>) -> Result<File, StageError> {
        let terrain = context.get(&self.terrain)?;
        let maps = context.get(&self.ground_maps)?;
        let textures =
            self.ground_textures.iter().map(|one| context.get(one)).collect::<Result<Vec<_>, _>>()?;
        let surface = GroundSurface {
            color: maps.color.clone(),
            weights: maps.weights.clone(),
            light: (*context.get(&self.light_map)?).clone(),
            details: textures.iter().map(|files| files.detail.clone()).collect(),
            plants: maps.plants.clone(),
        };
        let trees = context.get_all(&self.trees)?;
        let tree_bytes = trees.iter().map(|tree| context.bytes(tree)).collect::<Result<Vec<_>, _>>()?;
        let templates = trees.iter().zip(&tree_bytes);
        let placed = context.get(&self.placed)?;
        let (start, light) = (context.get(&self.start)?, context.get(&self.light)?);
        let (foreground, near) = (context.get(&self.foreground)?, &terrain.mesh);
        let parts = SceneParts {
            name: self.name.clone(),
            genome: self.genes.iter().map(|(gene, value)| (gene.clone(), Value::from(*value))).collect(),
            land: &*context.get(&self.landform)?,
            terrain: GlbBlob { uri: uri(near), bytes: &context.bytes(near)? },
            foreground: Some(GlbBlob { uri: uri(&foreground), bytes: &context.bytes(&foreground)? }),
            view: start.view,
            heights: resource(&terrain.heights)?,
            lod: resource(&terrain.lod)?,
            surface: surface.try_map(resource)?,
            tiles: textures.iter().map(|files| resource(&files.tile)).collect::<Result<_, _>>()?,
            templates: templates.map(|(file, bytes)| GlbBlob { uri: uri(file), bytes }).collect(),
            tree_images: context
                .get(&self.tree_textures)?
                .map(|file| Picture::File { uri: uri(file), mipmaps: Vec::new() }),
            trees: &placed.placement.instances,
            instances: blob(&placed.instances),
            far_trees: blob(&*context.get(&self.far_trees)?),
            light: &SkyLight { exposure: light.exposure * start.exposure, ..(*light).clone() },
            sky: context.get(&self.sky)?.try_map(resource, resource, resource)?,
        };
        Ok(context.file(SCENE_EXT, scene_gltf(&parts)?))
    }
}

/// Folders between a scene's file and `baked/`.
const FOLDERS_TO_BAKED: usize = 2;

fn uri(file: &File) -> String {
    file.blob().uri(FOLDERS_TO_BAKED)
}

fn blob(file: &File) -> Blob {
    Blob { uri: uri(file), byte_length: file.blob().len as usize }
}

fn resource(file: &File) -> Result<Resource, StageError> {
    let mime_type = match file.blob().ext.as_str() {
        "png" => "image/png",
        "exr" => "image/x-exr",
        _ => "application/octet-stream",
    };
    Ok(Resource::file(uri(file), mime_type))
}
