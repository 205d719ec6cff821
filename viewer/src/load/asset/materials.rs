//! Materials of a file → surfaces: the metallic-roughness model, with the extensions that change what it looks like most.

use gltf::json::Index;
use gltf::json::material::{AlphaCutoff, AlphaMode, Material};
use gltf::json::texture::{MagFilter, Sampler, Texture as JsonTexture, WrappingMode};
use gltf::json::validation::Checked;
use serde::Deserialize;
use serde_json::{Map, Value};

use super::file::AssetFile;
use super::notes::Notes;
use super::pictures::Pictures;
use crate::scene::{Alpha, Sampling, Surface, Texture, Transmission, Wrap};

/// Extensions of materials without which they look different, each with what is missing.
const REFINEMENTS: [(&str, &str); 8] = [
    ("KHR_materials_anisotropy", "brushed surfaces"),
    ("KHR_materials_clearcoat", "clear coats"),
    ("KHR_materials_iridescence", "iridescence"),
    ("KHR_materials_pbrSpecularGlossiness", "specular-glossiness materials"),
    ("KHR_materials_sheen", "the sheen of cloth"),
    ("KHR_materials_transmission", "refraction in glass (drawn as plain transparency)"),
    ("KHR_materials_volume", "the depth of glass"),
    ("MSFT_lod", "levels of detail of materials"),
];

/// How much a pane of perfect glass still hides: its reflections have to be seen.
const GLASS_ALPHA: f32 = 0.15;

/// All materials, and after them the one of parts that have none.
pub(super) fn read(file: &AssetFile, pictures: &mut Pictures<'_>, notes: &mut Notes) -> Vec<Surface> {
    let mut surfaces: Vec<Surface> =
        file.root.materials.iter().map(|material| surface(file, material, pictures, notes)).collect();
    surfaces.push(Surface {
        name: "default".to_owned(),
        roughness: 0.8,
        metallic: 0.0,
        ..Surface::default()
    });
    surfaces
}

fn surface(file: &AssetFile, material: &Material, pictures: &mut Pictures<'_>, notes: &mut Notes) -> Surface {
    let none = Map::new();
    let others = material.extensions.as_ref().map_or(&none, |extensions| &extensions.others);
    for (name, what) in REFINEMENTS.iter().filter(|(name, _)| others.contains_key(*name)) {
        notes.add(format!("Not drawn: {what} ({name})"));
    }
    let number = |pointer: &str| {
        let (extension, field) = pointer.split_once('/')?;
        others.get(extension)?.get(field)?.as_f64().map(|value| value as f32)
    };
    let transmitted = others.get(DIFFUSE_TRANSMISSION);
    let transmitted =
        transmitted.map(|value| diffuse_transmission(value, material, notes)).unwrap_or_default();
    let strength = number("KHR_materials_emissive_strength/emissiveStrength").unwrap_or(1.0);
    let transmission = number("KHR_materials_transmission/transmissionFactor").unwrap_or(0.0).clamp(0.0, 1.0);
    let tinted = ["specularTexture", "specularColorFactor", "specularColorTexture"];
    if others.get(SPECULAR).is_some_and(|told| tinted.iter().any(|field| told.get(field).is_some())) {
        notes.add(format!("Not drawn: colours of what is mirrored ({SPECULAR})"));
    }
    let pbr = &material.pbr_metallic_roughness;
    let mut texture = |index: Index<JsonTexture>, set: u32, transform: Option<&Value>| {
        self::texture(file, index, set, transform, pictures, notes)
    };
    let mut plain = |info: &Option<gltf::json::texture::Info>| {
        let info = info.as_ref()?;
        let others = info.extensions.as_ref().map(|extensions| &extensions.others);
        texture(info.index, info.tex_coord, others.and_then(|all| all.get(TRANSFORM)))
    };
    let (color, metal, glow) = (
        plain(&pbr.base_color_texture),
        plain(&pbr.metallic_roughness_texture),
        plain(&material.emissive_texture),
    );
    let normal = material.normal_texture.as_ref().and_then(|info| {
        let others = info.extensions.as_ref().map(|extensions| &extensions.others);
        texture(info.index, info.tex_coord, others.and_then(|all| all.get(TRANSFORM)))
    });
    let occlusion = material.occlusion_texture.as_ref().and_then(|info| {
        let others = info.extensions.as_ref().map(|extensions| &extensions.others);
        texture(info.index, info.tex_coord, others.and_then(|all| all.get(TRANSFORM)))
    });
    let mut factor = pbr.base_color_factor.0;
    let mut alpha = match material.alpha_mode {
        Checked::Valid(AlphaMode::Mask) => Alpha::Mask(material.alpha_cutoff.unwrap_or(AlphaCutoff(0.5)).0),
        Checked::Valid(AlphaMode::Blend) => Alpha::Blend,
        _ => Alpha::Opaque,
    };
    if transmission > 0.0 && alpha == Alpha::Opaque {
        alpha = Alpha::Blend;
        factor[3] = 1.0 - transmission * (1.0 - GLASS_ALPHA);
    }
    Surface {
        name: material.name.clone().unwrap_or_default(),
        color: factor,
        metallic: pbr.metallic_factor.0,
        roughness: pbr.roughness_factor.0,
        normal_scale: material.normal_texture.as_ref().map_or(1.0, |info| info.scale),
        occlusion_strength: material.occlusion_texture.as_ref().map_or(1.0, |info| info.strength.0),
        emissive: material.emissive_factor.0.map(|value| value * strength),
        alpha,
        double_sided: material.double_sided,
        unlit: others.contains_key("KHR_materials_unlit"),
        specular: number("KHR_materials_specular/specularFactor").unwrap_or(1.0).clamp(0.0, 1.0),
        transmission: transmitted,
        textures: [color, metal, normal, occlusion, glow],
    }
}

const SPECULAR: &str = "KHR_materials_specular";

const DIFFUSE_TRANSMISSION: &str = "KHR_materials_diffuse_transmission";

/// The extension as the file has it.
#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct DiffuseTransmission {
    diffuse_transmission_factor: f32,
    diffuse_transmission_color_factor: Option<[f32; 3]>,
    diffuse_transmission_texture: Option<Value>,
    diffuse_transmission_color_texture: Option<Value>,
}

/// Its pictures are drawn only if the one of its colour is that of the base colour, as it is of leaves.
fn diffuse_transmission(value: &Value, material: &Material, notes: &mut Notes) -> Transmission {
    let told = DiffuseTransmission::deserialize(value).unwrap_or_default();
    let base = material.pbr_metallic_roughness.base_color_texture.as_ref().map(|info| info.index.value());
    let of_color = told.diffuse_transmission_color_texture.map(|info| info["index"].as_u64());
    let textured = of_color.is_some_and(|index| index == base.map(|index| index as u64));
    if told.diffuse_transmission_texture.is_some() || of_color.is_some() && !textured {
        notes.add(format!("Not drawn: pictures of light that comes through ({DIFFUSE_TRANSMISSION})"));
    }
    Transmission {
        part: told.diffuse_transmission_factor.clamp(0.0, 1.0),
        tint: told.diffuse_transmission_color_factor.unwrap_or([1.0; 3]),
        textured,
    }
}

const TRANSFORM: &str = "KHR_texture_transform";

/// `KHR_texture_transform` as the file has it.
#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Transform {
    offset: [f32; 2],
    rotation: f32,
    scale: [f32; 2],
    tex_coord: Option<u32>,
}

impl Default for Transform {
    fn default() -> Self {
        Self { offset: [0.0; 2], rotation: 0.0, scale: [1.0; 2], tex_coord: None }
    }
}

impl Transform {
    /// Scale, then rotation (clockwise in a picture whose first row is on top), then offset.
    fn rows(&self) -> [[f32; 3]; 2] {
        let (sin, cos) = libm::sincosf(self.rotation);
        let ([sx, sy], [x, y]) = (self.scale, self.offset);
        [[cos * sx, sin * sy, x], [-sin * sx, cos * sy, y]]
    }
}

fn texture(
    file: &AssetFile,
    index: Index<JsonTexture>,
    set: u32,
    transform: Option<&Value>,
    pictures: &mut Pictures<'_>,
    notes: &mut Notes,
) -> Option<Texture> {
    let json = file.root.textures.get(index.value())?;
    let transform = transform.and_then(|value| Transform::deserialize(value).ok()).unwrap_or_default();
    let set = transform.tex_coord.unwrap_or(set);
    if set > 1 {
        notes.add("Texture coordinates beyond the second set are drawn with the second");
    }
    if json.source.value() == u32::MAX as usize {
        notes.add("A texture has no picture that can be read (KTX2 or DDS?), and is left out");
    }
    let image = pictures.get(json.source, notes)?;
    let sampler = json.sampler.and_then(|index| file.root.samplers.get(index.value()));
    Some(Texture {
        image,
        sampling: sampler.map(sampling).unwrap_or_default(),
        set: set.min(1),
        uv_rows: transform.rows(),
    })
}

fn sampling(sampler: &Sampler) -> Sampling {
    let wrap = |mode: Checked<WrappingMode>| match mode {
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        _ => Wrap::Repeat,
    };
    let nearest = sampler.mag_filter == Some(Checked::Valid(MagFilter::Nearest));
    Sampling { wrap: [wrap(sampler.wrap_s), wrap(sampler.wrap_t)], nearest }
}
