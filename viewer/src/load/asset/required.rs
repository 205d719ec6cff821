//! Extensions that a file says cannot be done without: known ones are taken from the list, of others a person is told what
//! would help.

use serde_json::Value;

use super::notes::quoted;

/// What is drawn as it is meant, or, of materials, nearly so.
const KNOWN: [&str; 8] = [
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "KHR_lights_punctual",
    "KHR_materials_unlit",
    "KHR_materials_emissive_strength",
    "EXT_texture_webp",
    "EXT_mesh_gpu_instancing",
    "MSFT_lod",
];

/// Extensions by the beginnings of their names, and how to do without.
const ADVICE: [(&str, &str); 6] = [
    ("KHR_draco_mesh_compression", "`gltf-transform copy IN.glb OUT.glb` unpacks its meshes"),
    ("EXT_meshopt_compression", "`gltf-transform copy IN.glb OUT.glb` unpacks its meshes"),
    ("KHR_meshopt_compression", "`gltf-transform copy IN.glb OUT.glb` unpacks its meshes"),
    ("KHR_texture_basisu", "`gltf-transform ktxdecompress IN.glb OUT.glb` turns its KTX2 pictures into PNG"),
    ("MSFT_texture_dds", "export it with PNG, JPEG or WebP pictures"),
    (
        "KHR_materials_pbrSpecularGlossiness",
        "`gltf-transform metalrough IN.glb OUT.glb` converts its materials",
    ),
];

/// How to do without an extension.
pub(super) fn advice(name: &str) -> Option<&'static str> {
    ADVICE.iter().find(|(known, _)| *known == name).map(|(_, advice)| *advice)
}

/// Refuses what is not known, with advice.
pub(super) fn check(json: &mut Value) -> Result<(), String> {
    let Some(object) = json.as_object_mut() else { return Err("its JSON is no object".to_owned()) };
    let required = object.remove("extensionsRequired");
    let names = required.as_ref().and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str);
    // A material looks nearly right without what refines it.
    let is_known =
        |name: &str| KNOWN.contains(&name) || name.starts_with("KHR_materials_") && advice(name).is_none();
    let unknown: Vec<&str> = names.filter(|name| !is_known(name)).collect();
    let Some(first) = unknown.first() else { return Ok(()) };
    let all: Vec<String> = unknown.iter().take(5).map(|name| quoted(name)).collect();
    let advice = advice(first).unwrap_or("export it without");
    Err(format!("it requires {}, which this viewer does not know; {advice}", all.join(", ")))
}
