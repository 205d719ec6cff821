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

    /// Indices as the smallest type that glTF viewers draw without conversion.
    pub fn indices(&mut self, indices: &[u32], vertices: usize, target: Option<u32>) -> usize {
        // 65535 itself restarts primitives, so it is no index.
        let (view, component) = if vertices <= 65535 {
            let short: Vec<u16> = indices.iter().map(|&i| i as u16).collect();
            (self.view(bytemuck::cast_slice(&short), target, None), UNSIGNED_SHORT)
        } else {
            (self.view(bytemuck::cast_slice(indices), target, None), UNSIGNED_INT)
        };
        self.accessor(view, 0, component, indices.len(), "SCALAR")
    }

    /// The JSON text. The BIN chunk, if any, becomes buffer 0: its length is filled in.
    pub fn json(&self) -> Vec<u8> {
        let mut out = Vec::new();
        let mut top = Lines { out: &mut out, first: true };
        top.entry("asset", &json!({ "version": "2.0", "generator": GENERATOR }));
        top.entry_unless_empty("extensionsUsed", &self.extensions_used.iter().collect::<Vec<_>>());
        if !self.scenes.is_empty() {
            top.entry("scene", &0);
        }
        top.list("scenes", &self.scenes);
        top.list("nodes", &self.nodes);
        top.list("cameras", &self.cameras);
        top.list("meshes", &self.meshes);
        top.list("materials", &self.materials);
        top.list("textures", &self.textures);
        top.list("samplers", &self.samplers);
        top.list("images", &self.images);
        top.list("accessors", &self.accessors);
        top.list("bufferViews", &self.buffer_views);
        if self.bin.is_empty() {
            top.list("buffers", &self.buffers);
        } else {
            let own = json!({ "byteLength": self.bin.len() });
            top.list("buffers", &std::iter::once(&own).chain(&self.buffers).collect::<Vec<_>>());
        }
        if !self.extensions.is_empty() {
            top.entry("extensions", &self.extensions);
        }
        out.extend_from_slice(b"\n}\n");
        out
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

/// The top level of a document, an entry or a list element a line.
struct Lines<'a> {
    out: &'a mut Vec<u8>,
    first: bool,
}

impl Lines<'_> {
    fn key(&mut self, key: &str) {
        self.out.extend_from_slice(if self.first { b"{\n\"" } else { b",\n\"" });
        self.out.extend_from_slice(key.as_bytes());
        self.out.extend_from_slice(b"\": ");
        self.first = false;
    }

    fn entry(&mut self, key: &str, value: &impl Serialize) {
        self.key(key);
        compact(value, self.out);
    }

    fn entry_unless_empty<T: Serialize>(&mut self, key: &str, values: &[T]) {
        if !values.is_empty() {
            self.entry(key, &values);
        }
    }

    fn list<T: Serialize>(&mut self, key: &str, values: &[T]) {
        if values.is_empty() {
            return;
        }
        self.key(key);
        for (i, value) in values.iter().enumerate() {
            self.out.extend_from_slice(if i == 0 { b"[\n  " } else { b",\n  " });
            compact(value, self.out);
        }
        self.out.extend_from_slice(b"\n]");
    }
}
