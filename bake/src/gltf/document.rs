//! A glTF document under construction, and its JSON text: one line an object, numbers as short as they can be.

use std::collections::BTreeSet;
use std::io;

use serde::Serialize;
use serde_json::ser::Formatter;
use serde_json::{Map, Value, json};

use super::GENERATOR;

/// `bufferView.target` of vertex attributes.
pub const ARRAY_BUFFER: u32 = 34962;
/// `bufferView.target` of indices.
pub const ELEMENT_ARRAY_BUFFER: u32 = 34963;
/// `componentType`s.
pub const UNSIGNED_BYTE: u32 = 5121;
pub const UNSIGNED_SHORT: u32 = 5123;
pub const UNSIGNED_INT: u32 = 5125;
pub const FLOAT: u32 = 5126;

/// A node. Transforms stay f32 so that thousands of them print short and fast.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Node {
    pub name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub translation: Option<[f32; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotation: Option<[f32; 4]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scale: Option<[f32; 3]>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub children: Vec<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extensions: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extras: Option<Value>,
}

/// The arrays of a glTF file, and the bytes of its first buffer if that is a BIN chunk.
#[derive(Clone, Debug, Default)]
pub struct Document {
    pub scenes: Vec<Value>,
    pub nodes: Vec<Node>,
    pub cameras: Vec<Value>,
    pub meshes: Vec<Value>,
    pub materials: Vec<Value>,
    pub textures: Vec<Value>,
    pub samplers: Vec<Value>,
    pub images: Vec<Value>,
    pub accessors: Vec<Value>,
    pub buffer_views: Vec<Value>,
    pub buffers: Vec<Value>,
    /// Top-level `extensions`.
    pub extensions: Map<String, Value>,
    pub extensions_used: BTreeSet<String>,
    /// Contents of the BIN chunk.
    pub bin: Vec<u8>,
}

impl Document {
    /// Adds a node and returns its index.
    pub fn node(&mut self, node: Node) -> usize {
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    /// Adds bytes to the BIN chunk, on a multiple of four, and returns the index of their view.
    pub fn view(&mut self, bytes: &[u8], target: Option<u32>, stride: Option<usize>) -> usize {
        pad(&mut self.bin, 0);
        let mut view = json!({ "buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len() });
        if let Some(stride) = stride {
            view["byteStride"] = stride.into();
        }
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.bin.extend_from_slice(bytes);
        push(&mut self.buffer_views, view)
    }

    /// Adds an accessor of a whole view or a part of it and returns its index.
    pub fn accessor(
        &mut self,
        view: usize,
        offset: usize,
        component: u32,
        count: usize,
        kind: &str,
    ) -> usize {
        let accessor = json!({ "bufferView": view, "byteOffset": offset, "componentType": component,
            "count": count, "type": kind });
        push(&mut self.accessors, accessor)
    }

    /// Adds an accessor of `count` elements that are 0 but for the elements `at`, whose bytes are `values`.
    pub fn sparse_accessor(&mut self, count: usize, kind: &str, at: &[u32], values: &[u8]) -> usize {
        let (indices, component) = self.index_view(at, count <= 65536, None);
        let values = self.view(values, None, None);
        // `byteOffset` is optional, but F3D fails without it.
        let accessor = json!({ "componentType": FLOAT, "count": count, "type": kind,
            "sparse": { "count": at.len(),
                "indices": { "bufferView": indices, "byteOffset": 0, "componentType": component },
                "values": { "bufferView": values, "byteOffset": 0 } } });
        push(&mut self.accessors, accessor)
    }

    /// Indices as the smallest type that glTF viewers draw without conversion.
    pub fn indices(&mut self, indices: &[u32], vertices: usize, target: Option<u32>) -> usize {
        // 65535 itself restarts primitives, so it is no index.
        let (view, component) = self.index_view(indices, vertices <= 65535, target);
        self.accessor(view, 0, component, indices.len(), "SCALAR")
    }

    /// A view of indices, and their component type.
    fn index_view(&mut self, indices: &[u32], short: bool, target: Option<u32>) -> (usize, u32) {
        if !short {
            return (self.view(bytemuck::cast_slice(indices), target, None), UNSIGNED_INT);
        }
        let short: Vec<u16> = indices.iter().map(|&i| i as u16).collect();
        (self.view(bytemuck::cast_slice(&short), target, None), UNSIGNED_SHORT)
    }

    /// The JSON text: an entry or a list element a line. The BIN chunk, if any, becomes buffer 0: its length is filled
    /// in.
    pub fn json(&self) -> Vec<u8> {
        let own = (!self.bin.is_empty()).then(|| json!({ "byteLength": self.bin.len() }));
        let buffers: Vec<&Value> = own.iter().chain(&self.buffers).collect();
        let materials = self.materials.iter().filter_map(Value::as_object);
        let used: BTreeSet<&String> =
            materials.flat_map(extensions_of).chain(&self.extensions_used).collect();
        let entries = [
            Some(entry("asset", &json!({ "version": "2.0", "generator": GENERATOR }))),
            (!used.is_empty()).then(|| entry("extensionsUsed", &used)),
            (!self.scenes.is_empty()).then(|| entry("scene", &0)),
            list("scenes", &self.scenes),
            list("nodes", &self.nodes),
            list("cameras", &self.cameras),
            list("meshes", &self.meshes),
            list("materials", &self.materials),
            list("textures", &self.textures),
            list("samplers", &self.samplers),
            list("images", &self.images),
            list("accessors", &self.accessors),
            list("bufferViews", &self.buffer_views),
            list("buffers", &buffers),
            (!self.extensions.is_empty()).then(|| entry("extensions", &self.extensions)),
        ];
        let entries: Vec<_> = entries.into_iter().flatten().collect();
        [b"{\n", &entries.join(&b",\n"[..])[..], b"\n}\n"].concat()
    }
}

/// The names of an object's extensions.
pub(super) fn extensions_of(object: &Map<String, Value>) -> impl Iterator<Item = &String> {
    object.get("extensions").and_then(Value::as_object).into_iter().flat_map(Map::keys)
}

fn entry(key: &str, value: &impl Serialize) -> Vec<u8> {
    let mut out = format!("\"{key}\": ").into_bytes();
    compact(value, &mut out);
    out
}

/// Nothing for an empty list.
fn list<T: Serialize>(key: &str, values: &[T]) -> Option<Vec<u8>> {
    let mut out = format!("\"{key}\": [").into_bytes();
    for (i, value) in values.iter().enumerate() {
        out.extend_from_slice(if i == 0 { b"\n  " } else { b",\n  " });
        compact(value, &mut out);
    }
    out.extend_from_slice(b"\n]");
    (!values.is_empty()).then_some(out)
}

/// Calls `f` with every object in a JSON value, outer ones first.
pub fn for_each_object<E>(
    value: &mut Value,
    f: &mut impl FnMut(&mut Map<String, Value>) -> Result<(), E>,
) -> Result<(), E> {
    match value {
        Value::Object(object) => {
            f(object)?;
            object.values_mut().try_for_each(|child| for_each_object(child, f))
        }
        Value::Array(list) => list.iter_mut().try_for_each(|child| for_each_object(child, f)),
        _ => Ok(()),
    }
}

/// Adds to a list and returns the index.
pub fn push<T>(list: &mut Vec<T>, item: T) -> usize {
    list.push(item);
    list.len() - 1
}

/// Fills up to a multiple of four.
pub fn pad(bytes: &mut Vec<u8>, with: u8) {
    bytes.resize(bytes.len().next_multiple_of(4), with);
}

/// JSON without spaces in which a number that is an f32 prints as one: 0.1 rather than 0.10000000149011612.
pub fn compact(value: &impl Serialize, out: &mut Vec<u8>) {
    let mut serializer = serde_json::Serializer::with_formatter(out, ShortNumbers);
    value.serialize(&mut serializer).expect("plain data always has a JSON form");
}

struct ShortNumbers;

impl Formatter for ShortNumbers {
    fn write_f64<W: ?Sized + io::Write>(&mut self, writer: &mut W, value: f64) -> io::Result<()> {
        let short = value as f32;
        if f64::from(short) == value {
            self.write_f32(writer, short)
        } else {
            serde_json::ser::CompactFormatter.write_f64(writer, value)
        }
    }

    fn write_f32<W: ?Sized + io::Write>(&mut self, writer: &mut W, value: f32) -> io::Result<()> {
        if value.abs() < 1e6 && value == value.trunc() {
            // Integers need no point; this also turns −0 into 0.
            write!(writer, "{}", value as i32)
        } else {
            serde_json::ser::CompactFormatter.write_f32(writer, value)
        }
    }
}
