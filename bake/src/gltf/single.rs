//! A scene and the blobs it names → one self-contained .glb, for `bake export`.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::ExportError;
use super::document::{Document, compact, for_each_object, pad};
use super::glb::write_glb;
use super::prune::prune;

/// Puts all that a scene, given as JSON, names by URI into one .glb: parts of buffers that are used, images, and the
/// resources of our extensions; what no scene of it uses is left out. `resolve` gives a file's bytes for a relative URI.
///
/// # Errors
/// When the scene is not glTF, or a file cannot be had or is too short.
pub fn single_glb(
    mut root: Value,
    mut resolve: impl FnMut(&str) -> Result<Vec<u8>, String>,
) -> Result<Vec<u8>, ExportError> {
    let bad = |why: String| ExportError::NotGltf("the scene".into(), why);
    prune(&mut root);
    let mut load = |uri: &str| resolve(uri).map_err(|why| ExportError::Missing(uri.into(), why));
    let mut buffers = Vec::new();
    for (index, buffer) in take_list(&mut root, "buffers").iter().enumerate() {
        let uri = buffer["uri"].as_str().ok_or_else(|| bad(format!("buffer {index} has no uri")))?;
        buffers.push((uri.to_owned(), load(uri)?));
    }
    let mut views = take_list(&mut root, "bufferViews");
    let mut document = Document::default();
    for view in &mut views {
        let number = |key: &str| view[key].as_u64().unwrap_or(0) as usize;
        let (start, length, buffer) = (number("byteOffset"), number("byteLength"), number("buffer"));
        let (uri, bytes) = buffers.get(buffer).ok_or_else(|| bad(format!("it has no buffer {buffer}")))?;
        let part = start.checked_add(length).and_then(|end| bytes.get(start..end));
        let part = part.ok_or_else(|| ExportError::Missing(uri.clone(), "it is too short".into()))?;
        pad(&mut document.bin, 0);
        view["buffer"] = 0.into();
        view["byteOffset"] = document.bin.len().into();
        document.bin.extend_from_slice(part);
    }
    document.buffer_views = views;
    // Some files are both an image and a resource.
    let mut known = BTreeMap::new();
    for_each_object(&mut root, &mut |object| {
        let Some(Value::String(uri)) = object.get("uri") else { return Ok(()) };
        let view = match known.get(uri) {
            Some(&view) => view,
            None => document.view(&load(uri)?, None, None),
        };
        known.insert(uri.clone(), view);
        object.shift_remove("uri");
        object.insert("bufferView".into(), view.into());
        Ok(())
    })?;
    pad(&mut document.bin, 0);
    root["bufferViews"] = document.buffer_views.into();
    root["buffers"] = json!([{ "byteLength": document.bin.len() }]);
    let mut text = Vec::new();
    compact(&root, &mut text);
    Ok(write_glb(text, document.bin))
}

fn take_list(root: &mut Value, key: &str) -> Vec<Value> {
    match root.get_mut(key).map(Value::take) {
        Some(Value::Array(list)) => list,
        _ => Vec::new(),
    }
}
