//! A tree → one .glb: its levels of detail, the materials of bark, leaves, blossom and clusters, and pictures from four
//! sides.

use serde_json::json;

use super::ExportError;
use super::impostor::{Cards, add_material};
use super::levels::levelled_glb;
use super::materials::{MaterialSet, Picture, REPEATING, sampler};
use super::png;
use crate::model::{Clusters, Image8, Impostor, LevelledMesh, Material, TreeTextures};

/// How light is tinted on its way through a leaf, where chlorophyll takes red and blue, and through a petal.
pub const THROUGH_LEAVES: [f64; 3] = [0.75, 0.9, 0.3];
const THROUGH_PETALS: [f64; 3] = [0.9; 3];

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
    let cards = [
        (Material::Leaf, "leaf", &textures.leaf, THROUGH_LEAVES),
        (Material::Blossom, "blossom", &textures.blossom, THROUGH_PETALS),
    ];
    for (slot, name, levels, tint) in cards {
        let Some(picture) = card_picture(levels).filter(|_| used(slot)) else { continue };
        set.slots.push(slot);
        let number = set.add_cards(name, picture, textures.alpha_cutoff, 0.65);
        if !(slot == Material::Leaf && textures.is_thin) {
            set.add_transmission(number, tint);
        }
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

/// Name of the material of clusters of leaves, and of their image; and of that of their normals.
pub const CLUSTERS: &str = "clusters";
pub const CLUSTER_NORMALS: &str = "cluster normals";

/// Pictures of a tree that only its own file has.
#[derive(Clone, Copy, Debug, Default)]
pub struct TreePictures<'a> {
    pub impostor: Option<&'a Impostor>,
    /// Of clusters of leaves.
    pub clusters: Option<&'a Clusters>,
}

/// Adds the material of clusters of leaves with their pictures of colours and of normals; gives its number. A tree's own file
/// leaves it at that: once Babylon.js has replaced a level with a material that lets light through (MSFT_lod), it draws no other
/// such material, and the tree would stand bare.
pub fn add_clusters<'a>(
    set: &mut MaterialSet<'a>,
    [colors, normals]: [Picture<'a>; 2],
    alpha_cutoff: f32,
) -> usize {
    let number = set.add_cards(CLUSTERS, colors, alpha_cutoff, 0.65);
    set.add_normals(number, CLUSTER_NORMALS, normals);
    number
}

/// One tree as a self-contained .glb (with `Picture::File`, one that shares its pictures): see [`levelled_glb`].
///
/// # Errors
/// As [`levelled_glb`].
pub fn tree_glb(
    name: &str,
    mesh: &LevelledMesh,
    textures: &TreeTextures<Picture<'_>>,
    pictures: &TreePictures<'_>,
) -> Result<Vec<u8>, ExportError> {
    let parts = || mesh.levels.iter().flat_map(|level| &level.mesh.parts);
    let used = |slot| parts().any(|part| part.material == slot && !part.triangles.is_empty());
    let mut materials = tree_materials(textures, used);
    let encoded = |colors: &Image8, data: &Image8| {
        let (colors, data) = rayon::join(|| png::encode(colors), || png::encode_linear(data));
        [colors, data]
    };
    let (clusters, impostor) = rayon::join(
        || pictures.clusters.map(|clusters| encoded(&clusters.colors, &clusters.normals)),
        || pictures.impostor.map(|impostor| (impostor, encoded(&impostor.colors, &impostor.relief))),
    );
    fn embedded(bytes: &Vec<u8>) -> Picture<'_> {
        Picture::Embedded { bytes, mime_type: "image/png" }
    }
    if let Some(clusters) = &clusters {
        add_clusters(&mut materials, clusters.each_ref().map(embedded), textures.alpha_cutoff);
        materials.slots.push(Material::Cluster);
    }
    let cards = impostor.as_ref().map(|(impostor, [colors, relief])| {
        let material = add_material(&mut materials, embedded(colors));
        Cards { impostor, relief, material }
    });
    levelled_glb(name, mesh, &materials, cards.as_ref())
}
