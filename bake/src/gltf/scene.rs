//! All that a scene is made of → `scene.gltf`: small JSON whose buffers and images are blobs by relative URI, and
//! which shows the scene in any viewer, without any extension but KHR_lights_punctual and KHR_texture_transform.

use genescape_schema::scene::{
    GSC_HEIGHTFIELD, GSC_SKY, HeightfieldExtension, Resource, START_ASPECT, START_FOV_Y_DEG, START_NODE,
    SkyExtension, SkyLight, rotation_from_z,
};
use glam::Vec3;
use serde_json::{Value, json};

use super::ExportError;
use super::document::{Document, Node, push};
use super::foreground::tiled_material;
use super::materials::{CLAMPED, REPEATING, sampler};
use super::scene_import::GlbImport;
use super::scene_parts::SceneParts;
use super::scene_trees::add_trees;
use super::terrain::{TERRAIN_MESHES, apron_material, ground_material, water_material};

/// The text of `scene.gltf`: the same bytes for the same parts.
///
/// # Errors
/// When a .glb is none, or an instance is mirrored or of an unknown template.
pub fn scene_gltf(parts: &SceneParts<'_>) -> Result<Vec<u8>, ExportError> {
    let view = parts.view;
    let mut document = Document::default();
    let mut roots = vec![add_camera(&mut document, parts), add_sun(&mut document, parts.light)];
    roots.extend(add_terrain(&mut document, parts)?);
    roots.extend(add_trees(&mut document, parts, &view)?);
    document.extensions_used.insert(GSC_SKY.into());
    document.scenes.push(json!({
        "name": parts.name, "nodes": roots,
        "extensions": { GSC_SKY: SkyExtension { images: parts.sky.clone(), light: parts.light.clone() } },
        "extras": { "genome": parts.genome },
    }));
    Ok(document.json())
}

/// The first look.
fn add_camera(document: &mut Document, parts: &SceneParts<'_>) -> usize {
    let view = parts.view;
    let camera = push(
        &mut document.cameras,
        json!({ "name": START_NODE, "type": "perspective",
            "perspective": { "aspectRatio": rounded(START_ASPECT), "yfov": rounded(START_FOV_Y_DEG.to_radians()),
                "znear": 0.1, "zfar": 30000 } }),
    );
    document.node(Node {
        name: START_NODE.into(),
        camera: Some(camera),
        translation: Some(view.position_m.to_array()),
        rotation: Some(view.rotation().to_array()),
        ..Node::default()
    })
}

/// As a person would write it: 1.6, not the 1.60000002 of the nearest number of single precision.
fn rounded(number: f32) -> f64 {
    (f64::from(number) * 1e6).round() / 1e6
}

/// The sun as a directional light. See `schema/docs/GSC_sky.md` on its intensity.
fn add_sun(document: &mut Document, light: &SkyLight) -> usize {
    document.extensions_used.insert("KHR_lights_punctual".into());
    document.extensions.insert(
        "KHR_lights_punctual".into(),
        json!({ "lights": [directional_light("sun", light.sun_irradiance_linear, light.exposure)] }),
    );
    // A glTF light shines along its own −z.
    let rotation = rotation_from_z(light.sun_direction.normalize_or(Vec3::Y));
    document.node(Node {
        name: "sun".into(),
        rotation: Some(rotation.to_array()),
        extensions: Some(json!({ "KHR_lights_punctual": { "light": 0 } })),
        extras: Some(json!({ "angle_rad": 2.0 * light.sun_angular_radius_rad })),
        ..Node::default()
    })
}

/// A light of KHR_lights_punctual that gives what faces it `exposure` times that irradiance, linear RGB.
pub fn directional_light(name: &str, irradiance: [f32; 3], exposure: f32) -> Value {
    let [r, g, b] = irradiance;
    let greatest = r.max(g).max(b);
    let color = if greatest > 0.0 { irradiance.map(|c| (c / greatest).clamp(0.0, 1.0)) } else { [1.0; 3] };
    json!({ "name": name, "type": "directional", "color": color, "intensity": greatest.max(0.0) * exposure })
}

fn add_terrain(document: &mut Document, parts: &SceneParts<'_>) -> Result<Vec<usize>, ExportError> {
    let glb = GlbImport::open(document, &parts.terrain)?;
    let names = glb.mesh_names();
    let foreground = parts.foreground.as_ref().map(|blob| GlbImport::open(document, blob)).transpose()?;
    let occurs = foreground.as_ref().map_or(Vec::new(), GlbImport::materials_in_use);
    let ground = add_ground(document, parts, &occurs);
    let first_material = document.materials.len();
    for name in &names {
        document.materials.push(match name.as_str() {
            "apron" => apron_material(),
            "water" => water_material(),
            _ => ground.far.clone(),
        });
    }
    // The file has a material a mesh, in the same order.
    let first_mesh = glb.import_meshes(document, &|material| Some(first_material + material.index))?;
    let mut nodes = Vec::new();
    if let Some(foreground) = &foreground {
        let grass = add_foreground(document, foreground, first_mesh, &ground.near)?;
        nodes.extend(
            grass.map(|mesh| {
                document.node(Node { name: "grass".into(), mesh: Some(mesh), ..Node::default() })
            }),
        );
    }
    for (i, name) in names.into_iter().enumerate() {
        let mut node = Node { name, mesh: Some(first_mesh + i), ..Node::default() };
        if node.name == TERRAIN_MESHES[0] {
            let extension = heightfield_extension(parts);
            node.extras = Some(json!({ "heightfield": {
                "side": extension.side, "spacing_m": extension.spacing_m,
                "min_m": extension.min_m, "max_m": extension.max_m, "png": extension.heights } }));
            node.extensions = Some(json!({ GSC_HEIGHTFIELD: extension }));
            document.extensions_used.insert(GSC_HEIGHTFIELD.into());
        }
        nodes.push(document.node(node));
    }
    Ok(nodes)
}

/// The cut-out piece becomes further primitives of the terrain mesh, whose first one loses the triangles under it.
/// Gives the mesh of the grass that stands on it, if any does.
fn add_foreground(
    document: &mut Document,
    glb: &GlbImport,
    terrain: usize,
    materials: &[Option<Value>],
) -> Result<Option<usize>, ExportError> {
    let rest = document.meshes[terrain]["primitives"][0]["indices"].as_u64().unwrap_or(0) as usize;
    glb.replace_accessor(document, rest)?;
    let mut places = Vec::new();
    for material in materials {
        places.push(material.as_ref().map(|material| push(&mut document.materials, material.clone())));
    }
    let blades = glb.material_json(materials.len());
    places.push(blades.map(|material| push(&mut document.materials, material)));
    let first = glb.import_meshes(document, &|material| places.get(material.index).copied().flatten())?;
    let mut piece = document.meshes.remove(first);
    if let (Some(all), Some(more)) =
        (document.meshes[terrain]["primitives"].as_array_mut(), piece["primitives"].as_array_mut())
    {
        all.append(more);
    }
    Ok((document.meshes.len() > first).then_some(first))
}

/// The ground's materials.
struct GroundMaterials {
    far: Value,
    /// For each texture one, if it is there to be seen.
    near: Vec<Option<Value>>,
}

/// The ground's textures, and its materials; `occurs` lists the kinds of ground near the start.
fn add_ground(document: &mut Document, parts: &SceneParts<'_>, occurs: &[usize]) -> GroundMaterials {
    let surface = &parts.surface;
    let clamped = push(&mut document.samplers, sampler(CLAMPED));
    let mut texture = |name: &str, image: &Resource, sampler: usize| {
        let image = json!({ "name": name, "uri": image.uri, "mimeType": image.mime_type });
        let source = push(&mut document.images, image);
        push(&mut document.textures, json!({ "name": name, "sampler": sampler, "source": source }))
    };
    let color = texture("ground colour", &surface.color, clamped);
    let light = texture("light map", &surface.light, clamped);
    let repeating = clamped + 1;
    let (mut grass_normal, mut near) = (None, Vec::new());
    for (kind, (detail, tile)) in surface.details.iter().zip(&parts.tiles).enumerate() {
        let here = occurs.contains(&kind);
        let normal = (kind == 0 || here)
            .then(|| texture(&format!("{} normals", detail.name), &detail.normal, repeating));
        if let (0, Some(normal)) = (kind, normal) {
            grass_normal = Some((normal, parts.land.field.extent_m() / detail.tile_m));
        }
        near.push(normal.filter(|_| here).map(|normal| {
            let tile = texture(&detail.name, tile, repeating);
            tiled_material(&detail.name, tile, normal, light)
        }));
    }
    if grass_normal.is_some() {
        document.samplers.push(sampler(REPEATING));
        document.extensions_used.insert("KHR_texture_transform".into());
    }
    GroundMaterials { far: ground_material(color, light, grass_normal), near }
}

fn heightfield_extension(parts: &SceneParts<'_>) -> HeightfieldExtension {
    let field = &parts.land.field;
    let [min_m, max_m] = field.range_m();
    HeightfieldExtension {
        side: field.side,
        spacing_m: field.spacing_m,
        min_m,
        max_m,
        water_level_m: parts.land.water_level_m,
        heights: parts.heights.clone(),
        lod: parts.lod.clone(),
        surface: parts.surface.clone(),
    }
}
