//! Changes to a scene's JSON for programs that know no sky, no horizon, or other units.

use std::f32::consts::PI;

use anyhow::Result;
use genescape_schema::scene::{FAR_TREES_NODE, GSC_HEIGHTFIELD, SkyLight, rotation_from_z};
use glam::Vec3;
use serde_json::{Value, json};

use super::source::{self, list, number, text};
use crate::gltf;

/// Part of the sky's light that glows from materials under a bright sun, beside which it hardly counts: about half of the
/// sky is hidden by hills, trees and leaves. Without a sun, all of it: it is the only light.
const GLOW_IN_SUN: f32 = 0.5;
/// The part of the sky's light that a lamp gives from above; the rest glows. Under an even sky what faces sideways gets half of
/// what faces up, (1 + cos θ) / 2, and a lamp and a glow of a half each are just that. A lamp also lights colours of vertices,
/// which emission has not, and in VTK what has no texture coordinates, which emission does not.
const FROM_ABOVE: f32 = 0.5;
/// Its node, and itself: it shines down.
const SKY_LAMP: &str = "sky from above";
/// Lumens in a watt, by which Blender's importer divides.
const LUMENS_PER_WATT: f64 = 683.0;

/// Takes the land beyond the field away, and the water over it and its trees.
pub fn remove_apron(root: &mut Value) {
    let nodes = list(root, "nodes");
    let named = |name: &str| nodes.iter().position(|node| node["name"] == name);
    let (apron, water, trees) = (named("apron"), named("water"), named(FAR_TREES_NODE));
    let field = nodes.iter().map(|node| &node["extensions"][GSC_HEIGHTFIELD]).find(|field| field.is_object());
    let extent_m = field.map_or(0.0, |field| {
        number(field, "side").saturating_sub(1) as f64 * field["spacingM"].as_f64().unwrap_or(0.0)
    });
    if let Some(water) = water {
        let mesh = &root["meshes"][number(&nodes[water], "mesh")];
        let positions = number(&mesh["primitives"][0]["attributes"], "POSITION");
        let half_m = root["accessors"][positions]["max"][0].as_f64().unwrap_or(0.0);
        // It is a square around the origin.
        let scale = (0.5 * extent_m / half_m.max(1.0)).min(1.0);
        root["nodes"][water]["scale"] = json!([scale, 1, scale]);
    }
    if let Some(roots) = root["scenes"][0]["nodes"].as_array_mut() {
        let beyond: Vec<Value> = [apron, trees].into_iter().flatten().map(Value::from).collect();
        roots.retain(|node| !beyond.contains(node));
    }
}

/// Lets materials glow and a lamp shine as much as the sky would light them, for glTF has no sky: without this, whatever the sun
/// does not reach is black, and an overcast landscape is black altogether. `bytes` gives an accessor's bytes and stride.
pub fn add_sky_glow(root: &mut Value, bytes: &dyn Fn(usize) -> Result<(Vec<u8>, usize)>) -> Result<()> {
    let SkyLight { sky_irradiance_linear: sky, sun_irradiance_linear: sun, exposure, .. } =
        source::sky(root)?.light;
    let sunny = sun[1] / (sun[1] + sky[1]).max(f32::MIN_POSITIVE);
    let part = 1.0 + (GLOW_IN_SUN - 1.0) * sunny;
    add_lamp(root, gltf::directional_light(SKY_LAMP, sky, FROM_ABOVE * part * exposure));
    let glow = sky.map(|irradiance| (1.0 - FROM_ABOVE) * part * exposure * irradiance / PI);
    for index in 0..list(root, "materials").len() {
        let material = &root["materials"][index];
        let surface = &material["pbrMetallicRoughness"];
        let mut albedo = [0, 1, 2].map(|c| surface["baseColorFactor"][c].as_f64().unwrap_or(1.0) as f32);
        let texture = surface.get("baseColorTexture").cloned();
        // Tiles of the near ground are grey, and blades are nothing: their colour is their vertices', which emission has not. What
        // trees have is shades of their texture's.
        let is_tile = number(&material["occlusionTexture"], "texCoord") == 1;
        if (is_tile || texture.is_none())
            && let Some(colors) = vertex_colors(root, index)
        {
            let mean = mean_color(&root["accessors"][colors], &bytes(colors)?);
            albedo = std::array::from_fn(|c| albedo[c] * mean[c]);
        }
        let factor: [f32; 3] = std::array::from_fn(|c| (glow[c] * albedo[c]).clamp(0.0, 1.0));
        root["materials"][index]["emissiveFactor"] = json!(factor);
        if let Some(texture) = texture {
            root["materials"][index]["emissiveTexture"] = texture;
        }
    }
    Ok(())
}

/// A node from which that light shines down on everything.
fn add_lamp(root: &mut Value, lamp: Value) {
    let lights = root.pointer_mut("/extensions/KHR_lights_punctual/lights").and_then(Value::as_array_mut);
    let Some(lights) = lights else { return };
    lights.push(lamp);
    let light = lights.len() - 1;
    let nodes = list(root, "nodes").len();
    let node = json!({ "name": SKY_LAMP, "rotation": rotation_from_z(Vec3::Y).to_array(),
        "extensions": { "KHR_lights_punctual": { "light": light } } });
    for (list, one) in [("/nodes", node), ("/scenes/0/nodes", nodes.into())] {
        if let Some(list) = root.pointer_mut(list).and_then(Value::as_array_mut) {
            list.push(one);
        }
    }
}

/// The accessor of the vertex colours of a primitive with that material.
fn vertex_colors(root: &Value, material: usize) -> Option<usize> {
    let mut primitives = list(root, "meshes").iter().flat_map(|mesh| list(mesh, "primitives"));
    let found = primitives.find(|primitive| primitive["material"] == material)?;
    Some(found["attributes"].get("COLOR_0")?.as_u64()? as usize)
}

fn mean_color(accessor: &Value, (bytes, stride): &(Vec<u8>, usize)) -> [f32; 3] {
    let count = number(accessor, "count").max(1);
    let colors = bytes.chunks((*stride).max(4)).take(count).filter_map(|vertex| vertex.first_chunk::<3>());
    let sum = colors.fold([0u64; 3], |sum, color| std::array::from_fn(|c| sum[c] + u64::from(color[c])));
    sum.map(|sum| sum as f32 / count as f32 / 255.0)
}

/// The sun in lux, as glTF means it and Blender's importer takes it: then a white surface that faces it is as bright in
/// Blender as under a sky of the same units.
pub fn sun_in_lux(root: &mut Value) {
    let lights = root.pointer_mut("/extensions/KHR_lights_punctual/lights").and_then(Value::as_array_mut);
    for light in lights.into_iter().flatten().filter(|light| text(light, "type") == "directional") {
        light["intensity"] = (LUMENS_PER_WATT * light["intensity"].as_f64().unwrap_or(1.0)).into();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_the_apron_the_water_ends_with_the_field() {
        let mut root = json!({
            "scenes": [{ "nodes": [0, 1, 2] }],
            "nodes": [
                { "name": "terrain", "extensions": { GSC_HEIGHTFIELD: { "side": 65, "spacingM": 16.0 } } },
                { "name": "apron" },
                { "name": "water", "mesh": 0 },
            ],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
            "accessors": [{ "max": [5120.0, 3.0, 5120.0] }],
        });
        remove_apron(&mut root);
        assert_eq!(root["scenes"][0]["nodes"], json!([0, 2]));
        assert_eq!(root["nodes"][2]["scale"], json!([0.1, 1, 0.1]));
    }

    #[test]
    fn the_mean_of_colours_heeds_the_stride() {
        let bytes = vec![255, 0, 51, 255, 9, 9, 9, 9, 0, 0, 51, 255];
        assert_eq!(mean_color(&json!({ "count": 2 }), &(bytes, 8)), [0.5, 0.0, 0.2]);
    }
}
