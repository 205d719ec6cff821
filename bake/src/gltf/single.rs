//! A scene and the blobs it names → one self-contained .glb, for `bake export`.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::ExportError;
use super::document::compact;
use super::document::pad;
use super::glb::write_glb;

/// Puts all that `scene_gltf` names by URI into one .glb: parts of buffers that are used, images, and the resources
/// of our extensions. `resolve` gives a file's bytes for a relative URI.
///
/// # Errors
/// When the scene is not JSON of a glTF file, or a file cannot be had or is too short.
pub fn single_glb(
    scene_gltf: &[u8],
    mut resolve: impl FnMut(&str) -> Result<Vec<u8>, String>,
) -> Result<Vec<u8>, ExportError> {
    let bad = |why: String| ExportError::NotGltf("the scene".into(), why);
    let mut root: Value = serde_json::from_slice(scene_gltf).map_err(|e| bad(e.to_string()))?;
    let mut load = |uri: &str| resolve(uri).map_err(|why| ExportError::Missing(uri.into(), why));
    let mut bin = Vec::new();

    let mut views = take_list(&mut root, "bufferViews");
    let buffers = take_list(&mut root, "buffers");
    for (index, buffer) in buffers.iter().enumerate() {
        let uri = buffer["uri"].as_str().ok_or_else(|| bad(format!("buffer {index} has no uri")))?;
        let bytes = load(uri)?;
        for view in views.iter_mut().filter(|view| view["buffer"].as_u64() == Some(index as u64)) {
            let number = |key: &str| view[key].as_u64().unwrap_or(0) as usize;
            let (start, length) = (number("byteOffset"), number("byteLength"));
            let part = start.checked_add(length).and_then(|end| bytes.get(start..end));
            let part = part.ok_or_else(|| ExportError::Missing(uri.into(), "it is too short".into()))?;
            pad(&mut bin, 0);
            let at = bin.len();
            bin.extend_from_slice(part);
            // Marked, so that views moved before are not taken for those of a later buffer.
            view["buffer"] = Value::Null;
            view["byteOffset"] = at.into();
        }
    }
    for view in &mut views {
        view["buffer"] = 0.into();
    }
    let mut target = Target { views, bin, by_uri: BTreeMap::new() };
    inline(&mut root, &mut target, &mut load)?;
    let Target { views, mut bin, .. } = target;
    pad(&mut bin, 0);
    root["bufferViews"] = views.into();
    root["buffers"] = json!([{ "byteLength": bin.len() }]);
    let mut text = Vec::new();
    compact(&root, &mut text);
    Ok(write_glb(text, bin))
}

fn take_list(root: &mut Value, key: &str) -> Vec<Value> {
    match root.get_mut(key).map(Value::take) {
        Some(Value::Array(list)) => list,
        _ => Vec::new(),
    }
}

/// Where inlined files go.
struct Target {
    views: Vec<Value>,
    bin: Vec<u8>,
    /// Files that are there already: some are both an image and a resource.
    by_uri: BTreeMap<String, usize>,
}

impl Target {
    fn add(&mut self, uri: &str, bytes: &[u8]) -> usize {
        pad(&mut self.bin, 0);
        let view = json!({ "buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len() });
        self.bin.extend_from_slice(bytes);
        self.views.push(view);
        self.by_uri.insert(uri.into(), self.views.len() - 1);
        self.views.len() - 1
    }
}

/// Turns every object with a `uri` (images and resources) into one with a `bufferView`.
fn inline(
    value: &mut Value,
    target: &mut Target,
    load: &mut impl FnMut(&str) -> Result<Vec<u8>, ExportError>,
) -> Result<(), ExportError> {
    match value {
        Value::Object(object) => {
            if let Some(Value::String(uri)) = object.get("uri") {
                let view = match target.by_uri.get(uri) {
                    Some(&view) => view,
                    None => target.add(uri, &load(uri)?),
                };
                object.shift_remove("uri");
                object.insert("bufferView".into(), view.into());
            }
            object.values_mut().try_for_each(|child| inline(child, target, load))
        }
        Value::Array(list) => list.iter_mut().try_for_each(|child| inline(child, target, load)),
        _ => Ok(()),
    }
}
