//! A `scene.gltf` with the blobs that it names, and where in its JSON things are.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use genescape_cache::Digest;
use genescape_schema::scene::{
    FAR_TREES_NODE, GSC_INSTANCES, GSC_PROGRESSIVE_MESH, GSC_SKY, Instance, InstancesExtension,
    ProgressiveMeshExtension, Resource, SkyExtension, read_instances,
};
use genescape_world::{MAX_MODEL_BYTES, regular_file};
use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::bad_input::BadInput;

/// Where scenes find their blobs.
const BLOBS: &str = "../../blobs/";

/// An open scene.
pub struct SceneFile {
    pub path: PathBuf,
    pub json: Value,
}

impl SceneFile {
    /// # Errors
    /// A file that cannot be read, or is no JSON.
    pub fn open(path: &Path) -> Result<Self> {
        let text =
            regular_file::read(path, MAX_MODEL_BYTES).map_err(|error| BadInput::unread(path, &error))?;
        let json = serde_json::from_slice(&text).map_err(|error| {
            BadInput(format!("{} is no scene.gltf as bake writes it: {error}", path.display()))
        })?;
        Ok(Self { path: path.to_owned(), json })
    }

    fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new("."))
    }

    /// The folder of all that was baked with it: scenes lie two folders below.
    pub fn baked(&self) -> PathBuf {
        self.folder().join("../..")
    }

    /// A blob by its URI: all that is read of a scene is read here, and nothing but blobs is, whoever wrote the scene. Its
    /// bytes are those that it is named after.
    ///
    /// # Errors
    /// What is no blob, or one that is missing or damaged.
    pub fn read(&self, uri: &str) -> Result<Vec<u8>> {
        let blob = uri.strip_prefix(BLOBS).filter(|blob| !blob.contains(".."));
        let name = blob.and_then(|blob| Path::new(blob).file_stem()?.to_str()?.parse::<Digest>().ok());
        let name = name.with_context(|| format!("{} names {uri}, which is no blob", self.path.display()))?;
        let path = self.folder().join(uri);
        let bytes = regular_file::read(&path, MAX_MODEL_BYTES)
            .with_context(|| format!("cannot read {}; bake again", path.display()))?;
        let damaged = || format!("{} is damaged; `bake cache verify`, then bake again", path.display());
        ensure!(name == Digest::of(&bytes), damaged());
        Ok(bytes)
    }

    /// What a resource of a scene holds: these are always files of their own.
    pub fn resource(&self, resource: &Resource) -> Result<Vec<u8>> {
        let uri = resource.uri.as_deref();
        self.read(uri.with_context(|| format!("{} is no scene.gltf as bake writes it", self.path.display()))?)
    }

    /// The bytes from an accessor's first element to its view's end, and its stride (0 if it is packed).
    pub fn accessor_bytes(&self, accessor: usize) -> Result<(Vec<u8>, usize)> {
        let accessor = &self.json["accessors"][accessor];
        let view = &self.json["bufferViews"][number(accessor, "bufferView")];
        let file = self.read(text(&self.json["buffers"][number(view, "buffer")], "uri"))?;
        let first = number(view, "byteOffset");
        let last = first + number(view, "byteLength");
        let bytes = file
            .get(first + number(accessor, "byteOffset")..last)
            .context("an accessor ends beyond its file")?;
        Ok((bytes.to_vec(), number(view, "byteStride")))
    }

    /// The trees' exact transforms.
    pub fn instances(&self) -> Result<Vec<Instance>> {
        self.records(&instances(&self.json)?)
    }

    /// Those of the trees beyond the field.
    pub fn far_instances(&self) -> Result<Vec<Instance>> {
        let node = far_trees_node(&self.json);
        let extension = node.map(|node| extension(&self.json["nodes"][node], GSC_INSTANCES));
        extension.map_or(Ok(Vec::new()), |extension| self.records(&extension?))
    }

    fn records(&self, extension: &InstancesExtension) -> Result<Vec<Instance>> {
        let view = &self.json["bufferViews"][extension.buffer_view];
        Ok(read_instances(&self.read(text(&self.json["buffers"][number(view, "buffer")], "uri"))?)?)
    }

    /// For each template, how far it reaches along x, y and z.
    pub fn tree_sizes_m(&self) -> Result<Vec<[f64; 3]>> {
        let size = |mesh: usize| {
            let mut size = [0.0f64; 3];
            for primitive in list(&self.json["meshes"][mesh], "primitives") {
                let bounds = &self.json["accessors"][number(&primitive["attributes"], "POSITION")];
                for (axis, size) in size.iter_mut().enumerate() {
                    let side = |end: &str| bounds[end][axis].as_f64().unwrap_or(0.0).abs();
                    *size = size.max(side("min")).max(side("max"));
                }
            }
            size
        };
        Ok(instances(&self.json)?.templates.iter().map(|template| size(template.mesh)).collect())
    }
}

/// The sky.
pub fn sky(scene: &Value) -> Result<SkyExtension> {
    extension(&scene["scenes"][0], GSC_SKY)
}

/// Where trees stand, and of which templates.
pub fn instances(scene: &Value) -> Result<InstancesExtension> {
    extension(&scene["nodes"][trees_node(scene)?], GSC_INSTANCES)
}

/// The node with all trees below it.
pub fn trees_node(scene: &Value) -> Result<usize> {
    let has =
        |node: &Value| node["extensions"].get(GSC_INSTANCES).is_some() && node["name"] != FAR_TREES_NODE;
    let found = list(scene, "nodes").iter().position(has);
    found.with_context(|| format!("no node has {GSC_INSTANCES}; is this a scene.gltf of bake?"))
}

/// The node of those beyond the field.
pub fn far_trees_node(scene: &Value) -> Option<usize> {
    list(scene, "nodes").iter().position(|node| node["name"] == FAR_TREES_NODE)
}

/// A template's levels of detail.
pub fn levels(scene: &Value, mesh: usize) -> Result<ProgressiveMeshExtension> {
    extension(&scene["meshes"][mesh], GSC_PROGRESSIVE_MESH)
}

/// The file of each template of trees: the buffer that its finest mesh lies in.
pub fn tree_files(scene: &Value) -> Result<Vec<Resource>> {
    let file = |mesh: usize| {
        let positions = number(&scene["meshes"][mesh]["primitives"][0]["attributes"], "POSITION");
        let view = &scene["bufferViews"][number(&scene["accessors"][positions], "bufferView")];
        Resource::file(text(&scene["buffers"][number(view, "buffer")], "uri"), "model/gltf-binary")
    };
    Ok(instances(scene)?.templates.iter().map(|template| file(template.mesh)).collect())
}

fn extension<T: DeserializeOwned>(owner: &Value, name: &str) -> Result<T> {
    let found = owner["extensions"][name].clone();
    serde_json::from_value(found).with_context(|| format!("no sound {name}; is this a scene.gltf of bake?"))
}

/// A list by its key; empty if it is not there.
pub fn list<'a>(owner: &'a Value, key: &str) -> &'a [Value] {
    owner[key].as_array().map_or(&[], Vec::as_slice)
}

/// A whole number by its key; 0 if it is not there.
pub fn number(owner: &Value, key: &str) -> usize {
    owner[key].as_u64().unwrap_or(0) as usize
}

/// A text by its key; empty if it is not there.
pub fn text<'a>(owner: &'a Value, key: &str) -> &'a str {
    owner[key].as_str().unwrap_or_default()
}
