//! Materials with their textures, for trees and for anyone's meshes, and how they go into a document.

use std::convert::Infallible;

use serde_json::{Map, Value, json};

use super::document::{Document, extensions_of, for_each_object, push};
use super::vertices::Surface;
use crate::model::Material;

/// Trilinear filtering, repeating.
pub const REPEATING: (u32, u32) = (9987, 10497);
/// Trilinear filtering, clamped to the edge.
pub const CLAMPED: (u32, u32) = (9987, 33071);
/// Linear filtering of the full picture at any distance, clamped to the edge: for what alpha cuts out. Other programs average
/// alpha for their mip levels, and of leaves of a few pixels less and less passes the cutoff: in three.js woods stood bare at the
/// other end of a meadow. Our viewer has mip levels of its own, which keep a crown's coverage.
const CUT_OUT: (u32, u32) = (9729, 33071);

/// What lets light through, as leaves do.
pub const KHR_MATERIALS_DIFFUSE_TRANSMISSION: &str = "KHR_materials_diffuse_transmission";
/// The part of a leaf's diffuse light that leaves it on the other side: broad leaves reflect and transmit about as much.
const TRANSMISSION: f64 = 0.45;

/// How strongly what is no metal mirrors.
const KHR_MATERIALS_SPECULAR: &str = "KHR_materials_specular";

/// A material that mirrors nothing. Leaves, blades and crumbs lie in all directions and hide each other; renderers, which know of a
/// plane alone, have crowns before a low sun glare like wet slate, and lay a grey veil over meadows, which send back less light
/// than a plane mirrors where it is seen at a low angle. Of a fifth of it half of the glare is left in Blender, along a plane.
pub(super) fn matte(mut material: Value) -> Value {
    material["extensions"][KHR_MATERIALS_SPECULAR] = json!({ "specularFactor": 0 });
    material
}

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
    /// A PNG file in a part of a buffer.
    View {
        /// An index into `bufferViews`.
        buffer_view: usize,
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

impl<'a> MaterialSet<'a> {
    /// Adds a material of two-sided cards that a picture's alpha cuts out; gives its number.
    pub(super) fn add_cards(
        &mut self,
        name: &str,
        picture: Picture<'a>,
        alpha_cutoff: f32,
        roughness: f64,
    ) -> usize {
        let cut_out = sampler(CUT_OUT);
        let known = self.samplers.iter().position(|sampler| *sampler == cut_out);
        let sampler = known.unwrap_or_else(|| push(&mut self.samplers, cut_out));
        let image = push(&mut self.images, (name.into(), picture));
        let texture = push(&mut self.textures, json!({ "name": name, "sampler": sampler, "source": image }));
        push(
            &mut self.materials,
            matte(json!({ "name": name,
                "pbrMetallicRoughness": { "baseColorTexture": { "index": texture },
                    "metallicFactor": 0, "roughnessFactor": roughness },
                "alphaMode": "MASK", "alphaCutoff": alpha_cutoff, "doubleSided": true })),
        )
    }

    /// Lets light through the cards of that material, which is tinted on the way; the picture colours it, too.
    pub(super) fn add_transmission(&mut self, material: usize, tint: [f64; 3]) {
        let colors = self.materials[material]["pbrMetallicRoughness"]["baseColorTexture"].clone();
        self.materials[material]["extensions"][KHR_MATERIALS_DIFFUSE_TRANSMISSION] = json!({
            "diffuseTransmissionFactor": TRANSMISSION,
            "diffuseTransmissionColorFactor": tint,
            "diffuseTransmissionColorTexture": colors });
    }

    /// Gives the material of that number, made of cards, a picture of normals.
    pub(super) fn add_normals(&mut self, material: usize, name: &str, picture: Picture<'a>) {
        let image = push(&mut self.images, (name.into(), picture));
        let colors = self.materials[material]["pbrMetallicRoughness"]["baseColorTexture"]["index"].as_u64();
        let sampler = colors.map_or(json!(0), |colors| self.textures[colors as usize]["sampler"].clone());
        let texture = push(&mut self.textures, json!({ "name": name, "sampler": sampler, "source": image }));
        self.materials[material]["normalTexture"] = json!({ "index": texture });
    }

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
                document.extensions_used.extend(extensions_of(object).cloned());
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
        Picture::View { buffer_view } => json!({ "bufferView": buffer_view, "mimeType": "image/png" }),
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
