//! Materials with their textures, for trees and for anyone's meshes.

use std::convert::Infallible;

use serde_json::{Map, Value, json};

use super::ExportError;
use super::document::{Document, for_each_object, push};
use super::levels::{Surface, levelled_glb};
use crate::model::{LevelledMesh, Material, TreeTextures};

/// Trilinear filtering, repeating.
pub const REPEATING: (u32, u32) = (9987, 10497);
/// Trilinear filtering, clamped to the edge.
pub const CLAMPED: (u32, u32) = (9987, 33071);

/// A sampler's JSON from minification filter and wrap mode.
pub fn sampler((minify, wrap): (u32, u32)) -> Value {
    json!({ "magFilter": 9729, "minFilter": minify, "wrapS": wrap, "wrapT": wrap })
}

/// An image file's bytes, to embed, or its place beside the glTF file.
#[derive(Clone, Debug, PartialEq)]
pub enum Picture<'a> {
    /// A whole PNG or JPEG file; no bytes at all stand for one white pixel.
    Embedded {
        /// The file's bytes.
        bytes: &'a [u8],
        /// `image/png` or `image/jpeg`; may be empty where `bytes` begin as one of these.
        mime_type: &'a str,
    },
    /// A PNG file by relative URI, and its smaller mip levels likewise (level 1 first) if they are not plain
    /// averages: they go into the image's `extras.mipmaps`.
    File {
        /// Level 0.
        uri: String,
        /// Levels 1, 2, …
        mipmaps: Vec<String>,
    },
}

/// Materials, and which part's material each is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MaterialSet<'a> {
    /// What `materials[i]` is for; parts of any other kind get no material.
    pub slots: Vec<Material>,
    /// glTF material objects; their texture indices refer to `textures`.
    pub materials: Vec<Value>,
    /// glTF texture objects; they refer to `samplers` and `images`.
    pub textures: Vec<Value>,
    /// glTF sampler objects.
    pub samplers: Vec<Value>,
    /// Images with their names.
    pub images: Vec<(String, Picture<'a>)>,
}

impl MaterialSet<'_> {
    /// Adds materials, textures and samplers; the images must follow before anyone else adds one. Gives the number
    /// that the first material got.
    pub(super) fn add_to(&self, document: &mut Document) -> usize {
        let first = document.materials.len();
        let (textures, samplers, images) =
            (document.textures.len(), document.samplers.len(), document.images.len());
        document.materials.extend_from_slice(&self.materials);
        document.textures.extend_from_slice(&self.textures);
        document.samplers.extend_from_slice(&self.samplers);
        // Numbers with these names are indices, at whatever depth.
        let added = [
            (&mut document.materials[first..], &[("index", textures)][..]),
            (&mut document.textures[textures..], &[("sampler", samplers), ("source", images)]),
            (&mut document.samplers[samplers..], &[]),
        ];
        for (objects, indices) in added {
            let mut shift = |object: &mut Map<String, Value>| -> Result<(), Infallible> {
                for &(name, by) in indices {
                    if let Some(index) = object.get(name).and_then(Value::as_u64) {
                        object.insert(name.into(), (index + by as u64).into());
                    }
                }
                let extensions = object.get("extensions").and_then(Value::as_object);
                document.extensions_used.extend(extensions.into_iter().flat_map(Map::keys).cloned());
                Ok(())
            };
            let Ok(()) = objects.iter_mut().try_for_each(|object| for_each_object(object, &mut shift));
        }
        first
    }

    /// Adds the images; in a .glb after all meshes, so that vertices come first in the file.
    pub(super) fn add_images_to(&self, document: &mut Document) {
        for (name, picture) in &self.images {
            let mut image = picture_json(document, picture);
            image["name"] = name.as_str().into();
            document.images.push(image);
        }
    }

    /// A part's material and what it needs.
    pub(super) fn surface_of(&self, material: Material) -> Surface {
        let index = self.slots.iter().position(|&slot| slot == material);
        let normal_map = index
            .and_then(|i| self.materials.get(i))
            .is_some_and(|m| m.get("normalTexture").is_some() || m.pointer(CLEARCOAT).is_some());
        Surface { material: index, normal_map }
    }
}

/// The other place where a material may have a normal map.
const CLEARCOAT: &str = "/extensions/KHR_materials_clearcoat/clearcoatNormalTexture";

/// A PNG of one white pixel: what glTF takes for an absent texture.
const WHITE_PIXEL: [u8; 67] =
    *b"\x89\x50\x4e\x47\x0d\x0a\x1a\x0a\x00\x00\x00\x0d\x49\x48\x44\x52\x00\x00\x00\x01\x00\x00\x00\x01\
    \x08\x00\x00\x00\x00\x3a\x7e\x9b\x55\x00\x00\x00\x0a\x49\x44\x41\x54\x78\x9c\x63\xf8\x0f\x00\x01\
    \x01\x01\x00\xb1\x38\xf6\x14\x00\x00\x00\x00\x49\x45\x4e\x44\xae\x42\x60\x82";

/// A glTF image object.
fn picture_json(document: &mut Document, picture: &Picture<'_>) -> Value {
    match picture {
        Picture::Embedded { bytes, mime_type } => {
            let (bytes, mime_type) = match (bytes, mime_type) {
                ([], _) => (&WHITE_PIXEL[..], &"image/png"),
                ([0x89, b'P', b'N', b'G', ..], &"") => (*bytes, &"image/png"),
                ([0xFF, 0xD8, ..], &"") => (*bytes, &"image/jpeg"),
                _ => (*bytes, mime_type),
            };
            let view = document.view(bytes, None, None);
            json!({ "bufferView": view, "mimeType": mime_type })
        }
        Picture::File { uri, mipmaps } => {
            let file = |uri: &String| json!({ "uri": uri, "mimeType": "image/png" });
            let mut image = file(uri);
            if !mipmaps.is_empty() {
                image["extras"] = json!({ "mipmaps": mipmaps.iter().map(file).collect::<Vec<_>>() });
            }
            image
        }
    }
}

/// Bark, leaf and blossom as glTF materials; cards only as far as `used` says that parts have them.
pub(super) fn tree_materials<'a>(
    textures: &TreeTextures<Picture<'a>>,
    used: impl Fn(Material) -> bool,
) -> MaterialSet<'a> {
    let mut set = MaterialSet {
        slots: vec![Material::Bark],
        materials: vec![json!({ "name": "bark",
            "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 },
                "metallicFactor": 0, "roughnessFactor": 0.9 },
            "normalTexture": { "index": 1 } })],
        textures: vec![
            json!({ "name": "bark colour", "sampler": 0, "source": 0 }),
            json!({ "name": "bark normals", "sampler": 0, "source": 1 }),
        ],
        samplers: vec![sampler(REPEATING)],
        images: vec![
            ("bark colour".into(), textures.bark_color.clone()),
            ("bark normals".into(), textures.bark_normal.clone()),
        ],
    };
    let cards = [(Material::Leaf, "leaf", &textures.leaf), (Material::Blossom, "blossom", &textures.blossom)];
    for (slot, name, levels) in cards {
        let Some(picture) = card(levels).filter(|_| used(slot)) else { continue };
        if set.samplers.len() == 1 {
            set.samplers.push(sampler(CLAMPED));
        }
        let image = push(&mut set.images, (name.into(), picture));
        let texture = push(&mut set.textures, json!({ "name": name, "sampler": 1, "source": image }));
        set.slots.push(slot);
        set.materials.push(json!({ "name": name,
            "pbrMetallicRoughness": { "baseColorTexture": { "index": texture },
                "metallicFactor": 0, "roughnessFactor": 0.65 },
            "alphaMode": "MASK", "alphaCutoff": textures.alpha_cutoff, "doubleSided": true }));
    }
    set
}

/// A card with its mip levels, if it has any.
fn card<'a>(levels: &[Picture<'a>]) -> Option<Picture<'a>> {
    let (first, smaller) = levels.split_first()?;
    let uri_of = |level: &Picture<'_>| match level {
        Picture::File { uri, .. } => Some(uri.clone()),
        Picture::Embedded { .. } => None,
    };
    Some(match uri_of(first) {
        Some(uri) => Picture::File { uri, mipmaps: smaller.iter().filter_map(uri_of).collect() },
        None => first.clone(),
    })
}

/// One tree as a self-contained .glb (with `Picture::File`, one that shares its pictures): see [`levelled_glb`].
///
/// # Errors
/// As [`levelled_glb`].
pub fn tree_glb(
    name: &str,
    mesh: &LevelledMesh,
    textures: &TreeTextures<Picture<'_>>,
) -> Result<Vec<u8>, ExportError> {
    let parts = || mesh.levels.iter().flat_map(|level| &level.mesh.parts);
    let used = |slot| parts().any(|part| part.material == slot && !part.triangles.is_empty());
    levelled_glb(name, mesh, &tree_materials(textures, used))
}
