//! A glTF document as JSON → the same without what nothing refers to.

use serde_json::Value;

use super::document::for_each_object;

/// Where one list's indices stand; `*` is any item of a list or an object.
type Places = &'static [&'static str];

/// Calls a function with each place where an index of a list stands.
type Visit = dyn Fn(&mut Value, &mut dyn FnMut(&mut Value));

const NODES: Places = &["scenes/*/nodes/*", "nodes/*/children/*"];
const MESHES: Places = &[
    "nodes/*/mesh",
    "nodes/*/extensions/GSC_instances/templates/*/mesh",
    "meshes/*/extensions/GSC_progressive_mesh/levels/*/mesh",
    "meshes/*/extensions/GSC_impostor/mesh",
];
const MATERIALS: Places = &["meshes/*/primitives/*/material"];
const ACCESSORS: Places = &[
    "meshes/*/primitives/*/attributes/*",
    "meshes/*/primitives/*/indices",
    "meshes/*/primitives/*/targets/*/*",
    "meshes/*/extensions/GSC_progressive_mesh/levels/*/texcoordDeltas/*",
    "meshes/*/extensions/GSC_progressive_mesh/levels/*/strips/*",
    "nodes/*/extensions/EXT_mesh_gpu_instancing/attributes/*",
];

/// Takes nodes, meshes, materials, accessors and buffer views out that are not in use, and numbers the rest anew.
pub fn prune(root: &mut Value) {
    // What a node held goes when the node has gone.
    while prune_list(root, "nodes", &at(NODES)) {}
    prune_list(root, "meshes", &at(MESHES));
    prune_list(root, "materials", &at(MATERIALS));
    prune_list(root, "accessors", &at(ACCESSORS));
    prune_list(root, "bufferViews", &|root, f| {
        let every =
            &mut |object: &mut serde_json::Map<String, Value>| -> Result<(), std::convert::Infallible> {
                object.get_mut("bufferView").into_iter().for_each(&mut *f);
                Ok(())
            };
        let Ok(()) = for_each_object(root, every);
    });
}

/// Whether anything was taken out.
fn prune_list(root: &mut Value, list: &str, visit: &Visit) -> bool {
    let mut used = vec![false; root[list].as_array().map_or(0, Vec::len)];
    visit(root, &mut |index| {
        if let Some(used) = index.as_u64().and_then(|index| used.get_mut(index as usize)) {
            *used = true;
        }
    });
    if used.iter().all(|used| *used) {
        return false;
    }
    let numbers: Vec<usize> = (used.iter())
        .scan(0, |next, used| Some(std::mem::replace(next, *next + usize::from(*used))))
        .collect();
    visit(root, &mut |index| {
        if let Some(number) = index.as_u64().and_then(|index| numbers.get(index as usize)) {
            *index = (*number).into();
        }
    });
    let mut used = used.into_iter();
    if let Some(items) = root[list].as_array_mut() {
        items.retain(|_| used.next().unwrap_or(true));
    }
    true
}

fn at(places: Places) -> impl Fn(&mut Value, &mut dyn FnMut(&mut Value)) {
    move |root, f| {
        for place in places {
            each(root, &place.split('/').collect::<Vec<_>>(), f);
        }
    }
}

fn each(value: &mut Value, place: &[&str], f: &mut dyn FnMut(&mut Value)) {
    match (place, value) {
        ([], value) => f(value),
        (["*", rest @ ..], Value::Array(items)) => items.iter_mut().for_each(|item| each(item, rest, f)),
        (["*", rest @ ..], Value::Object(items)) => items.values_mut().for_each(|item| each(item, rest, f)),
        ([key, rest @ ..], value) => value.get_mut(key).into_iter().for_each(|item| each(item, rest, f)),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::prune;

    #[test]
    fn what_a_removed_node_held_goes_with_it() {
        let mut root = json!({
            "scenes": [{ "nodes": [2] }],
            "nodes": [{ "children": [1] }, { "mesh": 0 }, { "mesh": 1 }],
            "meshes": [
                { "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1, "material": 0 }] },
                { "primitives": [{ "attributes": { "POSITION": 3 }, "indices": 2, "material": 1,
                    "targets": [{ "POSITION": 4 }] }],
                  "extensions": { "GSC_progressive_mesh": { "bufferView": 4, "levels": [{ "mesh": 1, "strips": [2] }] } } },
            ],
            "materials": [{ "name": "gone" }, { "name": "stays" }],
            "accessors": [{ "bufferView": 0 }, { "bufferView": 1 }, { "bufferView": 1 }, { "bufferView": 2 },
                { "sparse": { "indices": { "bufferView": 3 } } }],
            "bufferViews": [{ "n": 0 }, { "n": 1 }, { "n": 2 }, { "n": 3 }, { "n": 4 }, { "n": 5 }],
            "images": [{ "bufferView": 5 }],
        });
        prune(&mut root);
        let expected = json!({
            "scenes": [{ "nodes": [0] }],
            "nodes": [{ "mesh": 0 }],
            "meshes": [
                { "primitives": [{ "attributes": { "POSITION": 1 }, "indices": 0, "material": 0,
                    "targets": [{ "POSITION": 2 }] }],
                  "extensions": { "GSC_progressive_mesh": { "bufferView": 3, "levels": [{ "mesh": 0, "strips": [0] }] } } },
            ],
            "materials": [{ "name": "stays" }],
            "accessors": [{ "bufferView": 0 }, { "bufferView": 1 },
                { "sparse": { "indices": { "bufferView": 2 } } }],
            "bufferViews": [{ "n": 1 }, { "n": 2 }, { "n": 3 }, { "n": 4 }, { "n": 5 }],
            "images": [{ "bufferView": 4 }],
        });
        assert_eq!(root, expected);
    }
}
