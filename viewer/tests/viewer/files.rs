//! Small glTF files made by hand, as anyone's might be.

use std::fs;
use std::path::{Path, PathBuf};

use genescape_viewer::load::{self, Content, Store};
use genescape_viewer::scene::Asset;
use serde_json::{Value, json};

/// A file in the making: its JSON, and one buffer.
#[derive(Clone)]
pub struct File {
    pub json: Value,
    pub bin: Vec<u8>,
}

/// Component types.
pub const I8: u32 = 5120;
pub const U8: u32 = 5121;
pub const I16: u32 = 5122;
pub const U16: u32 = 5123;
pub const U32: u32 = 5125;
pub const F32: u32 = 5126;

/// Corners of a square of 2 m that looks towards +z, counter-clockwise.
pub const SQUARE: [[f32; 3]; 4] = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];

impl File {
    /// Nothing yet.
    pub fn new() -> Self {
        let json = json!({
            "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [],
            "meshes": [], "accessors": [], "bufferViews": [], "materials": [], "textures": [], "images": [],
        });
        Self { json, bin: Vec::new() }
    }

    /// A square of one material, if one is added.
    pub fn square() -> Self {
        let mut file = Self::new();
        let places = file.floats(&SQUARE.map(|place| place.to_vec()));
        let triangles = file.indices(&[0, 1, 2, 0, 2, 3]);
        file.add(
            "meshes",
            json!({ "primitives": [{ "attributes": { "POSITION": places }, "indices": triangles }] }),
        );
        file.add("nodes", json!({ "mesh": 0 }));
        file
    }

    /// Appends to a list; its number there.
    pub fn add(&mut self, list: &str, value: Value) -> usize {
        let list = self.json[list].as_array_mut().expect("a list");
        list.push(value);
        list.len() - 1
    }

    /// A part of the buffer.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let offset = self.bin.len();
        self.bin.extend(bytes);
        self.add("bufferViews", json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }))
    }

    /// Rows of numbers of a component type.
    pub fn rows(&mut self, component: u32, normalized: bool, rows: &[Vec<f32>]) -> usize {
        let bytes: Vec<u8> = rows.iter().flatten().flat_map(|number| encoded(component, *number)).collect();
        let view = self.view(&bytes);
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][rows[0].len() - 1];
        self.add("accessors", json!({
            "bufferView": view, "componentType": component, "count": rows.len(), "type": kind, "normalized": normalized,
        }))
    }

    pub fn floats(&mut self, rows: &[Vec<f32>]) -> usize {
        self.rows(F32, false, rows)
    }

    pub fn indices(&mut self, indices: &[u16]) -> usize {
        let rows: Vec<Vec<f32>> = indices.iter().map(|index| vec![f32::from(*index)]).collect();
        self.rows(U16, false, &rows)
    }

    /// The first primitive of the first mesh.
    pub fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    /// As a .glb.
    pub fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{ "byteLength": self.bin.len() }]);
        let mut text = json.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut bin = self.bin.clone();
        bin.resize(bin.len().next_multiple_of(4), 0);
        let mut glb = b"glTF\x02\0\0\0".to_vec();
        glb.extend((12 + 8 + text.len() as u32 + 8 + bin.len() as u32).to_le_bytes());
        for (kind, part) in [(b"JSON", &text), (b"BIN\0", &bin)] {
            glb.extend((part.len() as u32).to_le_bytes());
            glb.extend(kind);
            glb.extend(part);
        }
        glb
    }

    /// What the viewer reads from it.
    pub fn read(&self) -> Result<Asset, String> {
        read_bytes(&self.glb())
    }
}

fn encoded(component: u32, number: f32) -> Vec<u8> {
    match component {
        I8 => (number as i8).to_le_bytes().to_vec(),
        U8 => vec![number as u8],
        I16 => (number as i16).to_le_bytes().to_vec(),
        U16 => (number as u16).to_le_bytes().to_vec(),
        U32 => (number as u32).to_le_bytes().to_vec(),
        _ => number.to_le_bytes().to_vec(),
    }
}

/// Writes a file into a folder.
pub fn write(folder: &Path, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.join(name);
    fs::write(&path, bytes).expect("written");
    path
}

/// What the viewer reads from these bytes.
pub fn read_bytes(bytes: &[u8]) -> Result<Asset, String> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    read_path(&write(folder.path(), "model.glb", bytes))
}

/// What the viewer reads from this file.
pub fn read_path(path: &Path) -> Result<Asset, String> {
    match load::load(path, &Store::default()).map_err(|error| error.to_string())? {
        Content::Asset(asset, _) => Ok(*asset),
        Content::Landscape(scene) => panic!("{} is no landscape", scene.name),
    }
}

/// A picture, red at the left and blue at the right.
pub fn two_colors() -> image::RgbaImage {
    image::RgbaImage::from_fn(16, 16, |x, _| {
        image::Rgba(if x < 8 { [200, 30, 30, 255] } else { [20, 40, 220, 255] })
    })
}

/// The same as a file of that format.
pub fn encoded_as(format: image::ImageFormat) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let picture = image::DynamicImage::from(two_colors());
    // A JPEG has no alpha.
    let picture = if format == image::ImageFormat::Jpeg { picture.to_rgb8().into() } else { picture };
    picture.write_to(&mut bytes, format).expect("encoded");
    bytes.into_inner()
}

/// A square whose colour is that texture.
pub fn with_material(texture: Value) -> File {
    let mut file = File::square();
    file.add("textures", texture);
    file.add("materials", json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }));
    file.primitive()["material"] = json!(0);
    file
}
