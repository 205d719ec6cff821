//! Job → stage function → outputs: binds the plan to the stages, and says in which files results are kept.
//!
//! What only other stages read is postcard (`.bin`); what other programs read is glTF, PNG and EXR.

use std::panic::{AssertUnwindSafe, catch_unwind};

use genescape_cache::{BlobRef, Bytes, Output};
use rayon::prelude::*;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::gltf::{
    self, Blob, CloudSheet, ExportError, GlbBlob, GroundBlobs, GroundDetailBlobs, HeightfieldBlobs, Picture,
    SceneParts, SkyBlobs, TreeImages, TreeTemplateBlob, exr, png,
};
use crate::model::{
    Foreground, GroundMaps, GroundTextures, Image8, Landform, Mesh, Placement, SkyLight, StartView,
    TreeTextures,
};
use crate::plan::{Job, TEMPLATES};
use crate::run::Inputs;
use crate::stages::ground::GroundParams;
use crate::stages::placement::TreeFootprint;
use crate::stages::{ground, land, light, lod, placement, sky, start, terrain_lod, tree};

/// The scene stage's output: the text of `scene.gltf`.
pub const SCENE: &str = "scene";

/// Why a stage gave no result.
#[derive(Debug, thiserror::Error)]
pub enum StageError {
    /// A blob it reads was damaged or went missing; the cache has forgotten it, and a new run makes it again.
    #[error("a cached result was damaged while it was needed")]
    InputLost,
    /// The plan and the stage disagree: a bug.
    #[error("no input {0}; this is a bug in Genescape")]
    NoSuchInput(String),
    /// An intermediate result of another version.
    #[error("cannot read {0}: {1}; `bake cache verify` finds damage")]
    Decode(String, postcard::Error),
    /// A file could not be made.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// The cache failed.
    #[error(transparent)]
    Cache(#[from] genescape_cache::Error),
    /// A bug.
    #[error("the stage panicked: {0}; this is a bug in Genescape, please report it with the population file")]
    Panicked(String),
}

/// Whether a job reads an output of its input `name`: then its action key depends on it.
pub fn reads(job: &Job, name: &str, output: &str) -> bool {
    // A scene names every file.
    if matches!(job, Job::Scene { .. }) {
        return !matches!(output, "footprint" | "caster");
    }
    let tree = name.starts_with("tree ") && name != "tree textures";
    match job {
        Job::Placement { .. } if tree => output == "footprint",
        Job::LightMap { .. } if tree => output == "caster",
        Job::LightMap { .. } | Job::Start if name == "placement" => output == "placement",
        Job::Foreground { .. } if name == "terrain" => output == "mesh",
        Job::Tree { .. } => !output.contains("mip"),
        _ => true,
    }
}

/// Runs the stage of a job. Does no I/O but through `inputs`.
pub fn execute(job: &Job, inputs: &Inputs<'_>) -> Result<Vec<Output>, StageError> {
    // A bug in one stage must not take the threads of the others with it.
    catch_unwind(AssertUnwindSafe(|| dispatch(job, inputs))).unwrap_or_else(|payload| {
        let text = payload.downcast_ref::<String>().cloned();
        let text = text.or_else(|| payload.downcast_ref::<&str>().map(|s| (*s).to_owned()));
        Err(StageError::Panicked(text.unwrap_or_else(|| "no message".into())))
    })
}

fn dispatch(job: &Job, inputs: &Inputs<'_>) -> Result<Vec<Output>, StageError> {
    match job {
        Job::Landform { params, side } => Ok(vec![encode("landform", &land::landform(params, *side))]),
        Job::Terrain { params } => terrain(params, &read(inputs, "landform", "landform")?),
        Job::Start => {
            let land: Landform = read(inputs, "landform", "landform")?;
            let sun = read::<SkyLight>(inputs, "sky light", "light")?.sun_direction;
            let placed: Placement = read(inputs, "placement", "placement")?;
            Ok(vec![encode("view", &start::start_view(&land.field, land.water_level_m, &placed, sun))])
        }
        Job::Foreground { params, map_px } => foreground(params, *map_px, inputs),
        Job::GroundMaps { params, side_px } => {
            let GroundMaps { color_srgb, weights } =
                ground::maps(params, &read(inputs, "landform", "landform")?, *side_px);
            Ok(pngs(vec![("color".into(), &color_srgb, true), ("weights".into(), &weights, false)]))
        }
        Job::GroundTextures => Ok(ground_textures(&ground::textures())),
        Job::TreeTextures { params } => Ok(tree_textures(&tree::textures(params))),
        Job::Tree { params, index } => make_tree(params, *index, inputs),
        Job::SkyLight { params } => Ok(vec![encode("light", &sky::light(params))]),
        Job::SkyPictures { params, face_px, equirect_px } => {
            let light: SkyLight = read(inputs, "sky light", "light")?;
            Ok(sky_pictures(&sky::images(params, &light, *face_px, *equirect_px)))
        }
        Job::Placement { params } => {
            let footprints = for_trees(|name| read::<TreeFootprint>(inputs, name, "footprint"))?;
            let placed = placement::place(params, &read(inputs, "landform", "landform")?, &footprints);
            let instances = gltf::instances_bin(&placed);
            Ok(vec![encode("placement", &placed), Output::new("instances", "bin", instances)])
        }
        Job::LightMap { side_px } => {
            let casters = for_trees(|name| read::<Mesh>(inputs, name, "caster"))?;
            let map = light::light_map(
                &read(inputs, "sky light", "light")?,
                &read::<Landform>(inputs, "landform", "landform")?,
                &read::<Placement>(inputs, "placement", "placement")?,
                &casters,
                *side_px,
            );
            Ok(pngs(vec![("light".into(), &map.image, false)]))
        }
        Job::Scene { name, genes } => scene(name, genes, inputs),
    }
}

// ---- intermediate results ----

fn encode<T: Serialize>(name: &str, value: &T) -> Output {
    let bytes = postcard::to_allocvec(value).expect("models are plain data of known length");
    Output::new(name, "bin", bytes)
}

fn read<T: DeserializeOwned>(inputs: &Inputs<'_>, input: &str, output: &str) -> Result<T, StageError> {
    let bytes = inputs.bytes(input, output)?;
    postcard::from_bytes(&bytes).map_err(|error| StageError::Decode(format!("{input}: {output}"), error))
}

/// Something of each template, in order.
fn for_trees<T>(mut get: impl FnMut(&str) -> Result<T, StageError>) -> Result<Vec<T>, StageError> {
    (0..TEMPLATES).map(|index| get(&format!("tree {index}"))).collect()
}

// ---- files ----

/// PNG files of pictures by name; `true` where the values are sRGB.
fn pngs(images: Vec<(String, &Image8, bool)>) -> Vec<Output> {
    let file = |image, srgb| if srgb { png::encode(image) } else { png::encode_linear(image) };
    images.into_par_iter().map(|(name, image, srgb)| Output::new(name, "png", file(image, srgb))).collect()
}

fn terrain(params: &GroundParams, landform: &Landform) -> Result<Vec<Output>, StageError> {
    let field = &landform.field;
    let colors = ground::apron_colors(params, landform);
    let ((mesh, lod), heights) = rayon::join(
        || {
            rayon::join(
                || {
                    let mesh = terrain_lod::mesh(
                        landform,
                        terrain_lod::default_error_m(field),
                        ground::BLOCK_M,
                        &colors,
                    );
                    gltf::terrain_glb(&mesh)
                },
                || terrain_lod::encode(field, &terrain_lod::lod(field)),
            )
        },
        || {
            let (low, high) = field.range_m();
            let scale = if high > low { 65535.0 / (high - low) } else { 0.0 };
            let heights: Vec<u16> =
                field.heights_m.iter().map(|h| ((h - low) * scale + 0.5) as u16).collect();
            png::encode_gray16(field.side, field.side, &heights)
        },
    );
    Ok(vec![
        Output::new("mesh", "glb", mesh?),
        Output::new("lod", "bin", lod),
        Output::new("heights", "png", heights),
    ])
}

fn foreground(params: &GroundParams, map_px: u32, inputs: &Inputs<'_>) -> Result<Vec<Output>, StageError> {
    let land: Landform = read(inputs, "landform", "landform")?;
    let view: StartView = read(inputs, "start", "view")?;
    let (positions, triangles) = gltf::near_mesh(&inputs.bytes("terrain", "mesh")?)?;
    let made: Foreground = ground::foreground(params, &land, map_px, &view, &positions, &triangles);
    let glb = gltf::foreground_glb(&made, &ground::TEXTURES, ground::BLADE_WHITE)?;
    Ok(vec![Output::new("mesh", "glb", glb)])
}

/// What is known of a texture besides its pictures.
#[derive(Serialize, Deserialize)]
struct GroundTextureIndex {
    name: String,
    tile_m: f32,
}

fn ground_textures(GroundTextures { textures }: &GroundTextures) -> Vec<Output> {
    let index: Vec<_> =
        textures.iter().map(|t| GroundTextureIndex { name: t.name.clone(), tile_m: t.tile_m }).collect();
    let images = textures.iter().flat_map(|t| {
        [
            (format!("{} detail", t.name), &t.detail_srgb, true),
            (format!("{} normal", t.name), &t.normal, false),
        ]
    });
    let mut outputs = pngs(images.collect());
    let tiles: Vec<_> =
        textures.iter().enumerate().map(|(k, t)| ground::tile_srgb(k, &t.detail_srgb)).collect();
    outputs.extend(pngs(
        textures.iter().zip(&tiles).map(|(t, tile)| (format!("{} tile", t.name), tile, true)).collect(),
    ));
    outputs.push(encode("index", &index));
    outputs
}

/// How many mip levels each card brings, and where its alpha is cut.
#[derive(Serialize, Deserialize)]
struct TreeTextureIndex {
    leaf_levels: usize,
    blossom_levels: usize,
    alpha_cutoff: f32,
}

/// Levels of a card smaller than this are left to whoever draws it: so far away, a crown is a few pixels.
const LEAST_MIP_PX: u32 = 16;

fn tree_textures(textures: &TreeTextures) -> Vec<Output> {
    let kept = |levels: &[Image8]| levels.iter().filter(|level| level.width >= LEAST_MIP_PX).count();
    let index = TreeTextureIndex {
        leaf_levels: kept(&textures.leaf_srgb),
        blossom_levels: kept(&textures.blossom_srgb),
        alpha_cutoff: textures.alpha_cutoff,
    };
    let mut images = vec![
        ("bark color".to_owned(), &textures.bark_color_srgb, true),
        ("bark normal".to_owned(), &textures.bark_normal, false),
    ];
    for (name, levels, count) in [
        ("leaf", &textures.leaf_srgb, index.leaf_levels),
        ("blossom", &textures.blossom_srgb, index.blossom_levels),
    ] {
        images.extend(
            levels[..count].iter().enumerate().map(|(level, image)| (mip_name(name, level), image, true)),
        );
    }
    let mut outputs = pngs(images);
    outputs.push(encode("index", &index));
    outputs
}

fn mip_name(card: &str, level: usize) -> String {
    if level == 0 { card.to_owned() } else { format!("{card} mip {level}") }
}

fn make_tree(params: &tree::TreeParams, index: u32, inputs: &Inputs<'_>) -> Result<Vec<Output>, StageError> {
    let template = tree::template(params, index);
    let levels = lod::levels(&template.mesh, &lod::LodOptions::default());
    let textures: TreeTextureIndex = read(inputs, "textures", "index")?;
    let [bark_color, bark_normal] = ["bark color", "bark normal"].map(|name| inputs.bytes("textures", name));
    let (bark_color, bark_normal) = (bark_color?, bark_normal?);
    let card = |name, levels| (levels > 0).then(|| inputs.bytes("textures", name)).transpose();
    let (leaf, blossom) = (card("leaf", textures.leaf_levels)?, card("blossom", textures.blossom_levels)?);
    let images = TreeImages {
        bark_color: embedded(&bark_color),
        bark_normal: embedded(&bark_normal),
        leaf: leaf.as_ref().map(embedded),
        blossom: blossom.as_ref().map(embedded),
        alpha_cutoff: textures.alpha_cutoff,
    };
    let glb = gltf::tree_glb(&format!("tree-{index}"), &levels, &images)?;
    let footprint = TreeFootprint {
        height_m: template.bounds.max.y,
        trunk_radius_m: template.trunk_radius_m,
        crown_radius_m: template.crown_radius_m,
        root_depth_m: -template.bounds.min.y,
    };
    Ok(vec![
        Output::new("glb", "glb", glb),
        encode("footprint", &footprint),
        encode("caster", &caster(levels)),
    ])
}

fn embedded(bytes: &Bytes) -> Picture<'_> {
    Picture::Embedded { bytes, mime_type: "image/png" }
}

/// Triangles that are enough to cast a shadow onto a texel of a metre.
const CASTER_TRIANGLES: usize = 2_000;

/// The finest level that is small enough to be rasterised for every instance.
fn caster(levels: crate::model::LevelledMesh) -> Mesh {
    let mut coarsest = Mesh::default();
    for level in levels.levels {
        coarsest = level.mesh;
        if coarsest.triangle_count() <= CASTER_TRIANGLES {
            break;
        }
    }
    coarsest
}

#[derive(Serialize, Deserialize)]
struct SkyIndex {
    faces: usize,
    clear_faces: usize,
    /// Name, altitude and extent in metres.
    layers: Vec<(String, f32, f32)>,
}

fn sky_pictures(images: &crate::model::SkyImages) -> Vec<Output> {
    let index = SkyIndex {
        faces: images.faces.len(),
        clear_faces: images.clear_faces.len(),
        layers: images.layers.iter().map(|l| (l.name.clone(), l.altitude_m, l.extent_m)).collect(),
    };
    let mut pictures = vec![("equirect".to_owned(), &images.equirect)];
    pictures.extend(images.faces.iter().enumerate().map(|(i, face)| (format!("face {i}"), face)));
    pictures.extend(images.clear_faces.iter().enumerate().map(|(i, face)| (format!("clear face {i}"), face)));
    let mut outputs: Vec<Output> =
        pictures.into_par_iter().map(|(name, image)| Output::new(name, "exr", exr::encode(image))).collect();
    let sheets =
        images.layers.iter().enumerate().map(|(i, layer)| (format!("layer {i}"), &layer.image_srgb, true));
    outputs.extend(pngs(sheets.collect()));
    outputs.push(encode("index", &index));
    outputs
}

// ---- the scene ----

/// Folders between a scene's file and `baked/`.
const FOLDERS_TO_BAKED: usize = 2;

fn uri(blob: &BlobRef) -> String {
    blob.uri(FOLDERS_TO_BAKED)
}

fn scene(name: &str, genes: &[(String, f32)], inputs: &Inputs<'_>) -> Result<Vec<Output>, StageError> {
    let blob = |input: &str, output: &str| -> Result<Blob, StageError> {
        let blob = inputs.blob(input, output)?;
        Ok(Blob { uri: uri(blob), byte_length: blob.len as usize })
    };
    let land: Landform = read(inputs, "landform", "landform")?;
    let placed: Placement = read(inputs, "placement", "placement")?;
    let sky_light: SkyLight = read(inputs, "sky light", "light")?;
    let terrain = inputs.bytes("terrain", "mesh")?;
    let foreground = inputs.bytes("foreground", "mesh")?;
    let trees = for_trees(|tree| inputs.bytes(tree, "glb"))?;

    let index: Vec<GroundTextureIndex> = read(inputs, "ground textures", "index")?;
    let details = index.into_iter().map(|GroundTextureIndex { name, tile_m }| {
        let detail = blob("ground textures", &format!("{name} detail"))?;
        let normal = blob("ground textures", &format!("{name} normal"))?;
        let tile = blob("ground textures", &format!("{name} tile"))?;
        Ok(GroundDetailBlobs { name, detail, normal, tile, tile_m })
    });
    let ground = GroundBlobs {
        color: blob("ground maps", "color")?,
        weights: blob("ground maps", "weights")?,
        light: blob("light map", "light")?,
        details: details.collect::<Result<_, StageError>>()?,
    };
    let templates = trees.iter().enumerate().map(|(i, bytes)| {
        let uri = uri(inputs.blob(&format!("tree {i}"), "glb")?);
        Ok(TreeTemplateBlob { name: format!("tree-{i}"), glb: GlbBlob { uri, bytes } })
    });
    let parts = SceneParts {
        name: name.to_owned(),
        genome: genes.iter().map(|(gene, value)| (gene.clone(), serde_json::Value::from(*value))).collect(),
        land: &land,
        terrain: GlbBlob { uri: uri(inputs.blob("terrain", "mesh")?), bytes: &terrain },
        foreground: Some(GlbBlob { uri: uri(inputs.blob("foreground", "mesh")?), bytes: &foreground }),
        view: read(inputs, "start", "view")?,
        heightfield: HeightfieldBlobs {
            heights_png: blob("terrain", "heights")?,
            range_m: land.field.range_m(),
            lod: blob("terrain", "lod")?,
        },
        ground,
        templates: templates.collect::<Result<_, StageError>>()?,
        tree_images: tree_images(inputs)?,
        placement: &placed,
        instances: blob("placement", "instances")?,
        light: &sky_light,
        sky: sky_blobs(inputs, &blob)?,
    };
    Ok(vec![Output::new(SCENE, "json", gltf::scene_gltf(&parts)?)])
}

fn tree_images<'a>(inputs: &Inputs<'_>) -> Result<TreeImages<'a>, StageError> {
    let index: TreeTextureIndex = read(inputs, "tree textures", "index")?;
    let file = |name: &str, levels: usize| -> Result<Picture<'a>, StageError> {
        let path = |level| Ok::<_, StageError>(uri(inputs.blob("tree textures", &mip_name(name, level))?));
        Ok(Picture::File { uri: path(0)?, mipmaps: (1..levels).map(path).collect::<Result<_, _>>()? })
    };
    let card = |name, levels| (levels > 0).then(|| file(name, levels)).transpose();
    Ok(TreeImages {
        bark_color: file("bark color", 1)?,
        bark_normal: file("bark normal", 1)?,
        leaf: card("leaf", index.leaf_levels)?,
        blossom: card("blossom", index.blossom_levels)?,
        alpha_cutoff: index.alpha_cutoff,
    })
}

fn sky_blobs(
    inputs: &Inputs<'_>,
    blob: &dyn Fn(&str, &str) -> Result<Blob, StageError>,
) -> Result<SkyBlobs, StageError> {
    let index: SkyIndex = read(inputs, "sky pictures", "index")?;
    let all = |name: &str, count: usize| -> Result<Vec<Blob>, StageError> {
        (0..count).map(|i| blob("sky pictures", &format!("{name} {i}"))).collect()
    };
    let sheets = all("layer", index.layers.len())?;
    let layers = index
        .layers
        .into_iter()
        .zip(sheets)
        .map(|((name, altitude_m, extent_m), image)| CloudSheet { name, altitude_m, extent_m, image });
    Ok(SkyBlobs {
        equirect: blob("sky pictures", "equirect")?,
        faces: all("face", index.faces)?,
        clear_faces: all("clear face", index.clear_faces)?,
        layers: layers.collect(),
    })
}
