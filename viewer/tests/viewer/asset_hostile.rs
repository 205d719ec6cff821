//! Whatever a stranger's file says, the viewer reads on or says why not: it never falls.

use proptest::prelude::*;
use serde_json::{Value, json};

use crate::asset::corners;
use crate::files::{self, File, SQUARE};

/// A file with something of everything.
fn rich() -> File {
    let mut file = files::with_material(json!({ "source": 0, "sampler": 0 }));
    let view = file.view(&files::encoded_as(image::ImageFormat::Png));
    file.add("images", json!({ "bufferView": view, "mimeType": "image/png" }));
    file.json["samplers"] = json!([{ "wrapS": 10497 }]);
    let normals = file.floats(&SQUARE.map(|_| vec![0.0, 0.0, 1.0]));
    let uvs = file.floats(&SQUARE.map(|place| place[..2].to_vec()));
    file.primitive()["attributes"]["NORMAL"] = json!(normals);
    file.primitive()["attributes"]["TEXCOORD_0"] = json!(uvs);
    let second = file.json["meshes"][0].clone();
    file.add("meshes", second);
    let shifts = file.floats(&[vec![0.0; 3], vec![3.0; 3]]);
    file.json["nodes"] = json!([
        { "mesh": 0, "children": [1, 2, 3], "extensions": { "MSFT_lod": { "ids": [4] } } },
        { "mesh": 1, "extensions": { "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": shifts } } } },
        { "camera": 0, "matrix": [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 4.0, 1.0] },
        { "extensions": { "KHR_lights_punctual": { "light": 0 } }, "rotation": [0.0, 0.0, 0.0, 1.0] },
        { "mesh": 1, "scale": [1.0, 1.0, 1.0] },
    ]);
    file.json["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.1 } }]);
    file.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "directional" }] } });
    file
}

/// All values within a value, each by its pointer.
fn pointers(value: &Value, at: &str, found: &mut Vec<String>) {
    found.push(at.to_owned());
    match value {
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(n, value)| pointers(value, &format!("{at}/{n}"), found));
        }
        Value::Object(map) => {
            map.iter().for_each(|(key, value)| pointers(value, &format!("{at}/{key}"), found))
        }
        _ => {}
    }
}

#[test]
fn whatever_one_value_becomes_the_viewer_reads_on_or_says_why_not() {
    let whole = rich();
    assert!(whole.read().is_ok_and(|asset| asset.facts.levels == 2 && asset.facts.pictures == 1));
    let mut places = Vec::new();
    pointers(&whole.json, "", &mut places);
    let odd = [
        json!(-1),
        json!(0),
        json!(3),
        json!(4_294_967_295u32),
        json!(u64::MAX),
        json!(1e300),
        json!(0.5),
        json!("x"),
        json!([]),
        json!({}),
        json!([[[]]]),
        json!(true),
        Value::Null,
    ];
    assert!(places.len() > 150, "{}", places.len());
    for place in &places {
        for value in &odd {
            let mut file = whole.clone();
            *file.json.pointer_mut(place).expect("it was found") = value.clone();
            if file.json.is_object() {
                let _ = file.read();
            }
        }
    }
}

/// A square whose places are that many zeros but for the first, which take hardly any bytes.
fn of_zeros(count: u64) -> File {
    let mut file = File::square();
    let (at, with) = (file.view(&[0]), file.view(&[0; 12]));
    file.json["accessors"][0]["sparse"] = json!({
        "count": 1,
        "indices": { "bufferView": at, "componentType": files::U8 },
        "values": { "bufferView": with },
    });
    file.json["accessors"][0]["count"] = json!(count);
    file.json["accessors"][0].as_object_mut().expect("an object").remove("bufferView");
    file
}

#[test]
fn little_files_that_stand_for_very_much_are_refused_before_they_take_memory_or_time() {
    let mut again_and_again = of_zeros(1 << 20);
    let empty = again_and_again.rows(files::U8, false, &[vec![200.0]]);
    // No two alike, and no triangle in any.
    let parts = (0..20_000).map(|number| {
        json!({ "attributes": { "POSITION": 0, (format!("TEXCOORD_{number}")): 0 }, "indices": empty })
    });
    again_and_again.json["meshes"][0]["primitives"] = parts.collect();
    let mut copies = File::square();
    let nowhere =
        copies.add("accessors", json!({ "componentType": files::F32, "count": 1 << 20, "type": "VEC3" }));
    copies.json["nodes"][0]["extensions"] =
        json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": nowhere } } });
    copies.json["nodes"][0]["children"] = json!([1]);
    copies.add("nodes", json!({ "mesh": 0 }));
    let mut fine = of_zeros(1 << 16);
    let corners =
        fine.add("accessors", json!({ "componentType": files::U16, "count": 3 << 10, "type": "SCALAR" }));
    fine.primitive()["indices"] = json!(corners);
    let places =
        fine.add("accessors", json!({ "componentType": files::F32, "count": 1 << 20, "type": "VEC3" }));
    fine.json["nodes"][0]["extensions"] =
        json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": places } } });
    let mut parts = File::square();
    let part = parts.primitive().clone();
    parts.json["meshes"][0]["primitives"] = std::iter::repeat_n(part, (1 << 18) + 1).collect();
    for (file, why) in [
        (again_and_again, "more than 16777216 vertices"),
        (copies, "more than 1048576 meshes"),
        (fine, "triangles stand in its scene"),
        (parts, "262144 parts"),
    ] {
        let told = file.read().expect_err(why);
        assert!(told.contains(why), "{told}");
    }
}

#[test]
fn a_file_that_is_cut_off_is_told_with_what_there_should_be() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    files::write(folder.path(), "corners.bin", &[0; 40]);
    let mut file = File::square();
    file.json["buffers"] = json!([{ "uri": "corners.bin", "byteLength": 60 }]);
    let path = files::write(folder.path(), "model.gltf", file.json.to_string().as_bytes());
    let told = files::read_path(&path).expect_err("20 bytes are missing");
    assert!(
        told.contains("model.gltf")
            && told.contains("“corners.bin”, is cut off: it should have 60 bytes and has 40"),
        "{told}"
    );
}

#[test]
fn whatever_the_header_of_a_glb_says_the_viewer_reads_on_or_says_why_not() {
    let whole = rich().glb();
    let json_end = 20 + u32::from_le_bytes([whole[12], whole[13], whole[14], whole[15]]) as usize;
    for at in (0..28).chain(json_end..json_end + 12) {
        for value in [0, 1, 2, 3, 4, 8, 0x7f, 0x80, 0xff] {
            let mut bytes = whole.clone();
            bytes[at] = value;
            let _ = files::read_bytes(&bytes);
        }
    }
    for end in (0..64).chain(json_end - 4..json_end + 16) {
        let _ = files::read_bytes(&whole[..end]);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn whatever_some_bytes_become_the_viewer_reads_on_or_says_why_not(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..30), end in any::<prop::sample::Index>(),
        cut in any::<bool>(),
    ) {
        let mut bytes = rich().glb();
        for (at, value) in changes {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        if cut {
            bytes.truncate(end.index(bytes.len()));
        }
        let _ = files::read_bytes(&bytes);
    }

    #[test]
    fn places_that_are_no_numbers_are_left_out(bits in prop::collection::vec(any::<u32>(), 12)) {
        let mut file = File::square();
        let bytes: Vec<u8> = bits.iter().flat_map(|bits| bits.to_le_bytes()).collect();
        file.bin[..48].copy_from_slice(&bytes);
        if let Ok(asset) = file.read() {
            let finite = corners(&asset).iter().flatten().all(|place| place.is_finite());
            prop_assert!(finite && asset.bounds_m.iter().all(|corner| corner.is_finite()));
        }
    }
}
