//! A tree → one .glb: its levels of detail, the materials of bark, leaves and blossom, and pictures from four sides.

use serde_json::json;

use super::ExportError;
use super::impostor::{Cards, add_material};
use super::levels::levelled_glb;
use super::materials::{MaterialSet, Picture, REPEATING, sampler};
use super::png;
use crate::model::{Impostor, LevelledMesh, Material, TreeTextures};

/// Bark, leaf and blossom as glTF materials; cards only as far as `used` says that parts have them.
pub fn tree_materials<'a>(
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
        let Some(picture) = card_picture(levels).filter(|_| used(slot)) else { continue };
        set.slots.push(slot);
        set.add_cards(name, picture, textures.alpha_cutoff, 0.65);
    }
    set
}

/// A card with its mip levels, if it has any.
fn card_picture<'a>(levels: &[Picture<'a>]) -> Option<Picture<'a>> {
    let (first, smaller) = levels.split_first()?;
    let uri_of = |level: &Picture<'_>| match level {
        Picture::File { uri, .. } => Some(uri.clone()),
        Picture::Embedded { .. } | Picture::View { .. } => None,
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
    impostor: Option<&Impostor>,
) -> Result<Vec<u8>, ExportError> {
    let parts = || mesh.levels.iter().flat_map(|level| &level.mesh.parts);
    let used = |slot| parts().any(|part| part.material == slot && !part.triangles.is_empty());
    let mut materials = tree_materials(textures, used);
    let Some(impostor) = impostor else { return levelled_glb(name, mesh, &materials, None) };
    let (colors, relief) =
        rayon::join(|| png::encode(&impostor.colors), || png::encode_linear(&impostor.relief));
    let picture = Picture::Embedded { bytes: &colors, mime_type: "image/png" };
    let material = add_material(&mut materials, picture);
    levelled_glb(name, mesh, &materials, Some(&Cards { impostor, relief: &relief, material }))
}
