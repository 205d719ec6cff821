//! What Blender needs beside a scene: every kind of tree once, marks by which a script finds things, and that script.

use anyhow::Result;
use genescape_schema::scene::SkyLight;
use serde::Serialize;
use serde_json::{Value, json};

use super::names::Names;
use super::source::{self, list};
use crate::gltf::{GRASS_MATERIAL, KHR_MATERIALS_DIFFUSE_TRANSMISSION};

/// The script, but for its settings.
const SCRIPT: &str = include_str!("blender.py");
/// Where the settings go.
const SETTINGS: &str = "SETTINGS = {}";
/// Triangles of a tree that stands for a full one while a person works: thousands of them move smoothly.
const PROXY_TRIANGLES: usize = 1500;

/// Numbers and names that the script sets up the scene by.
#[derive(Serialize)]
struct Settings<'a> {
    /// What the collection with everything is called.
    title: &'a str,
    /// What nodes are marked with, see [`prepare`].
    landscape: &'a str,
    scene_file: String,
    sky_file: String,
    /// Collections of trees, by template.
    kinds: Vec<String>,
    sun_strength: f32,
    sun_color: [f32; 3],
    sun_angle_rad: f32,
    sky_strength: f32,
    haze_extinction_per_m: f32,
}

/// The script for a scene.
///
/// # Errors
/// A scene without sky or trees of ours.
pub fn script(scene: &Value, names: &Names) -> Result<String> {
    let light = source::sky(scene)?.light;
    let SkyLight { exposure, sun_irradiance_linear: sun, .. } = light;
    let strength = sun[0].max(sun[1]).max(sun[2]);
    let templates = source::instances(scene)?.templates.len();
    let settings = Settings {
        title: source::text(&scene["scenes"][0], "name"),
        landscape: &names.stem,
        scene_file: names.scene(),
        sky_file: names.sky(),
        kinds: (0..templates).map(|template| names.kind(template)).collect(),
        sun_strength: strength * exposure,
        sun_color: sun.map(|c| if strength > 0.0 { c / strength } else { 1.0 }),
        sun_angle_rad: 2.0 * light.sun_angular_radius_rad,
        sky_strength: exposure,
        haze_extinction_per_m: light.haze_extinction_per_m,
    };
    // What JSON and Python write alike: texts, numbers, lists, objects.
    let settings = format!("SETTINGS = {}", serde_json::to_string_pretty(&settings)?);
    Ok(SCRIPT.replacen(SETTINGS, &settings, 1))
}

/// Marks what stands in the scene as this landscape's, adds a second scene with each kind of tree, finest and as proxy, and
/// tells of light through leaves where Blender's importer finds it.
///
/// # Errors
/// A scene without trees of ours.
pub fn prepare(root: &mut Value, names: &Names) -> Result<()> {
    let shown: Vec<usize> = list(&root["scenes"][0], "nodes")
        .iter()
        .filter_map(Value::as_u64)
        .map(|node| node as usize)
        .collect();
    for node in shown {
        root["nodes"][node]["extras"]["landscape"] = names.stem.as_str().into();
    }
    for material in root["materials"].as_array_mut().into_iter().flatten() {
        let transmission = &material["extensions"][KHR_MATERIALS_DIFFUSE_TRANSMISSION];
        if let Some(part) = transmission["diffuseTransmissionFactor"].as_f64() {
            let tint = transmission["diffuseTransmissionColorFactor"].clone();
            material["extras"]["light_through"] = json!({ "part": part, "tint": tint });
        } else if material["name"] == GRASS_MATERIAL {
            // Its colours are those of vertices, which the extension leaves out of what comes through.
            material["extras"]["light_through"] = json!({ "part": 0.4, "tint": [0.9, 1.0, 0.5] });
        }
    }
    let mut kinds = Vec::new();
    for (template, tree) in source::instances(root)?.templates.iter().enumerate() {
        let levels = source::levels(root, tree.mesh)?.levels;
        let light = levels.iter().find(|level| level.triangles <= PROXY_TRIANGLES).or(levels.last());
        let kind = names.kind(template);
        for (name, role, mesh) in [
            (kind.clone(), "finest", tree.mesh),
            (format!("{kind} proxy"), "proxy", light.map_or(tree.mesh, |level| level.mesh)),
        ] {
            kinds.push(json!({ "name": name, "mesh": mesh,
                "extras": { "landscape": names.stem, "template": template, "role": role } }));
        }
    }
    let first = list(root, "nodes").len();
    let scene =
        json!({ "name": "kinds of trees", "nodes": (first..first + kinds.len()).collect::<Vec<_>>() });
    for (key, items) in [("nodes", kinds), ("scenes", vec![scene])] {
        root[key].as_array_mut().into_iter().for_each(|list| list.extend(items.iter().cloned()));
    }
    Ok(())
}
