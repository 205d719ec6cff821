//! An opened .glb or .gltf of anyone: its JSON, and the bytes of its buffers and pictures. What the JSON refers to is looked
//! up with care and never taken for granted: the `gltf` crate's own readers panic over references that lead nowhere.

use std::cell::Cell;
use std::path::{Path, PathBuf};

use data_url::DataUrl;
use genescape_world::NamedFiles;
use gltf::json::{Index, Root, buffer};
use serde_json::{Map, Value};

use super::notes::quoted;
use super::required;
use crate::load::{LoadError, Result};

/// Rows that are read of all accessors together: any number of parts may name the same large one.
pub(super) const MAX_ROWS: usize = 1 << 28;

/// The JSON's objects of one kind.
type Others = Map<String, Value>;

pub(super) struct AssetFile {
    path: PathBuf,
    pub root: Root,
    files: NamedFiles,
    /// As long as they say at least; empty if nothing that is drawn needs them.
    buffers: Vec<Vec<u8>>,
    /// Of [`MAX_ROWS`]; at 0 nothing more is read.
    pub(super) rows_left: Cell<usize>,
}

/// The parts of a file, not yet looked into.
struct Parts {
    json: Value,
    /// The binary part of a .glb.
    embedded: Option<Vec<u8>>,
}

impl AssetFile {
    /// Parses a file, whose bytes these are, and reads its buffers.
    pub fn open(path: &Path, bytes: &[u8]) -> Result<Self> {
        let wrong = |what: String| LoadError::Asset { path: path.to_owned(), what };
        let Parts { mut json, embedded } = split(bytes).map_err(wrong)?;
        required::check(&mut json).map_err(wrong)?;
        take_webp(&mut json);
        let root: Root = serde_path_to_error::deserialize(json)
            .map_err(|error| wrong(format!("it is no glTF 2.0: {error}")))?;
        let files = NamedFiles::of(path);
        let rows_left = Cell::new(MAX_ROWS);
        let mut file = Self { path: path.to_owned(), root, files, buffers: Vec::new(), rows_left };
        file.buffers = file.read_buffers(embedded)?;
        Ok(file)
    }

    /// An error about this file.
    pub fn wrong(&self, what: impl Into<String>) -> LoadError {
        LoadError::Asset { path: self.path.clone(), what: what.into() }
    }

    /// The files that it names and that were read.
    pub fn named_files(&self) -> Vec<PathBuf> {
        self.files.files()
    }

    fn read_buffers(&self, mut embedded: Option<Vec<u8>>) -> Result<Vec<Vec<u8>>> {
        let is_compressed =
            |index: usize| self.root.buffers[index].extensions.as_ref().is_some_and(is_fallback);
        let read = |(index, buffer): (usize, &buffer::Buffer)| {
            let bytes = match &buffer.uri {
                Some(uri) => self.bytes_of_uri(uri).map_err(|what| self.wrong(what))?,
                None if index == 0 => embedded.take().unwrap_or_default(),
                None => Vec::new(),
            };
            let (there, said) = (bytes.len(), buffer.byte_length.0);
            if (there as u64) < said && !is_compressed(index) {
                let name = buffer.uri.as_deref().filter(|uri| !uri.starts_with("data:")).map(quoted);
                let name = name.map_or(String::new(), |name| format!(", {name},"));
                return Err(self.wrong(format!(
                    "buffer {index}{name} is cut off: it should have {said} bytes and has {there}; copy it anew"
                )));
            }
            Ok(bytes)
        };
        self.root.buffers.iter().enumerate().map(read).collect()
    }

    /// What a URI stands for: a file of the model's folder, or itself.
    pub fn bytes_of_uri(&self, uri: &str) -> Result<Vec<u8>, String> {
        if uri.starts_with("data:") {
            let data = DataUrl::process(uri).map_err(|_| "a data URI is cut off".to_owned())?;
            return data
                .decode_to_vec()
                .map(|(bytes, _)| bytes)
                .map_err(|_| "a data URI is no base64".to_owned());
        }
        self.files.read_uri(uri).map_err(|error| format!("{} cannot be read: {error}", quoted(uri)))
    }

    /// The bytes of a part of a buffer.
    pub fn view(&self, index: Index<buffer::View>) -> Option<&[u8]> {
        let view = self.root.buffer_views.get(index.value())?;
        let start = usize::try_from(view.byte_offset.map_or(0, |offset| offset.0)).ok()?;
        let end = start.checked_add(usize::try_from(view.byte_length.0).ok()?)?;
        self.buffers.get(view.buffer.value())?.get(start..end)
    }
}

/// The extensions that a file says it uses.
pub(super) fn used(bytes: &[u8]) -> Option<Vec<String>> {
    let used = split(bytes).ok()?.json.get_mut("extensionsUsed")?.take();
    serde_json::from_value(used).ok()
}

const OLD: &str = "it is glTF 1.0: convert it to 2.0, with `gltf-pipeline -i IN.glb -o OUT.glb`";

fn split(bytes: &[u8]) -> Result<Parts, String> {
    if bytes.starts_with(b"glTF\x01\0\0\0") {
        return Err(OLD.to_owned());
    }
    let (json, embedded) = if bytes.starts_with(b"glTF") {
        let glb = gltf::Glb::from_slice(bytes).map_err(|error| format!("it is no sound .glb: {error}"))?;
        (glb.json, glb.bin.map(|bin| bin.into_owned()))
    } else {
        (bytes.into(), None)
    };
    let json: Value = serde_json::from_slice(&json).map_err(|error| format!("it is no glTF: {error}"))?;
    let version = json.pointer("/asset/version").and_then(Value::as_str).unwrap_or_default();
    match version.split('.').next() {
        Some("2") => Ok(Parts { json, embedded }),
        Some("1") => Err(OLD.to_owned()),
        _ => Err("it does not say that it is glTF 2.0: `asset.version` should be \"2.0\"".to_owned()),
    }
}

/// Lets textures that offer a WebP picture take it, and gives those without any picture one that is not there, which the
/// parser asks for.
fn take_webp(json: &mut Value) {
    let textures = json.get_mut("textures").and_then(Value::as_array_mut);
    for texture in textures.into_iter().flatten().filter_map(Value::as_object_mut) {
        let webp = texture.get("extensions").and_then(|all| all.pointer("/EXT_texture_webp/source")).cloned();
        match webp {
            Some(source) => drop(texture.insert("source".to_owned(), source)),
            None => drop(texture.entry("source").or_insert(u32::MAX.into())),
        }
    }
}

/// A buffer that stands for what only a decompressor would fill.
fn is_fallback(extensions: &gltf::json::extensions::buffer::Buffer) -> bool {
    let is_so = |name: &str, others: &Others| {
        others.get(name).and_then(|value| value.get("fallback")) == Some(&true.into())
    };
    ["EXT_meshopt_compression", "KHR_meshopt_compression"].iter().any(|name| is_so(name, &extensions.others))
}
