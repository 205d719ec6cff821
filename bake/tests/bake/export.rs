//! Landscapes as files for other programs, as a person exports them.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use genescape_schema::scene::{FAR_TREES_NODE, GSC_INSTANCES};
use serde_json::Value;

use crate::world::{World, damage};

/// Exports a landscape; what was said, if it succeeded.
fn export(world: &World, words: &[&str]) -> Result<String, String> {
    let output = world.run(&[&["export"], words].concat());
    let text = |bytes| String::from_utf8_lossy(bytes).into_owned();
    match output.status.code() {
        Some(0) => Ok(text(&output.stdout)),
        Some(2) => Err(text(&output.stderr)),
        code => panic!("{code:?}: {}", text(&output.stderr)),
    }
}

/// Exports landscape 1 into a file and reads that.
fn exported(world: &World, options: &[&str]) -> (gltf::Document, Value, Vec<u8>) {
    let path = world.file("x.glb");
    export(world, &[&["1", path.to_str().expect("a path")], options].concat()).expect("exported");
    let bytes = fs::read(path).expect("written");
    let json = gltf::binary::Glb::from_slice(&bytes).expect("a .glb").json;
    let json = serde_json::from_slice(&json).expect("JSON");
    let gltf = gltf::Gltf::from_slice(&bytes).expect("glTF");
    (gltf.document, json, gltf.blob.expect("a binary chunk"))
}

fn names(folder: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect()
}

fn set(names: &[&str]) -> BTreeSet<String> {
    names.iter().map(|name| (*name).into()).collect()
}

#[test]
fn a_folder_gets_the_scene_the_sky_and_the_trees() {
    let world = World::starters();
    let folder = world.file("out/valley");
    let said = export(&world, &["1", folder.to_str().expect("a path")]).expect("exported");
    let files =
        ["oak-valley-in-june.glb", "oak-valley-in-june-sky.exr", "oak-valley-in-june-sky.jpg", "trees"];
    assert_eq!(names(&folder), set(&files));
    assert_eq!(names(&folder.join("trees")), (1..=5).map(|n| format!("oak-{n}.glb")).collect());
    assert_eq!(said.matches("wrote").count(), 8, "{said}");

    let blobs: BTreeSet<Vec<u8>> = world.blobs().iter().map(|blob| fs::read(blob).expect("a blob")).collect();
    for file in ["oak-valley-in-june-sky.exr", "trees/oak-1.glb", "trees/oak-5.glb"] {
        assert!(blobs.contains(&fs::read(folder.join(file)).expect("written")), "{file} is what was baked");
    }
    let tree = gltf::Gltf::open(folder.join("trees/oak-2.glb")).expect("glTF");
    assert!(tree.meshes().next().and_then(|mesh| mesh.name()).is_some_and(|name| name.ends_with("D0")));
    let picture = fs::read(folder.join("oak-valley-in-june-sky.jpg")).expect("written");
    assert!(picture.starts_with(&[0xFF, 0xD8, 0xFF]));
}

#[test]
fn a_second_export_replaces_the_first_but_nothing_of_a_persons() {
    let world = World::starters();
    let folder = world.file("out");
    let out = folder.to_str().expect("a path");
    export(&world, &["1", out]).expect("exported");
    export(&world, &["1", out, "--apron"]).expect("replaced");
    let scene = folder.join("oak-valley-in-june.glb");
    let before = fs::read(&scene).expect("written");

    let painted = folder.join("oak-valley-in-june-sky.jpg");
    fs::write(&painted, "mine").expect("written");
    let error = export(&world, &["1", out]).expect_err("a person's file is in the way");
    assert!(error.contains("oak-valley-in-june-sky.jpg is there already"), "{error}");
    assert_eq!(fs::read_to_string(&painted).expect("there"), "mine");
    assert_eq!(fs::read(&scene).expect("there"), before, "nothing was written");

    fs::remove_file(&painted).expect("removed");
    world.edit(0, |text| {
        text.replace("Oak valley in June", "Oaks").replacen("height_m: ", "height_m: 9, //", 1)
    });
    world.bake(&[]).ok();
    let error = export(&world, &["1", out]).expect_err("another landscape's oaks are there");
    assert!(error.contains("oak-1.glb is there already"), "{error}");
}

#[test]
fn a_file_needs_no_other_and_no_one_can_be_exported_over_a_strangers() {
    let world = World::starters();
    let (document, _, bin) = exported(&world, &[]);
    assert_eq!(document.buffers().count(), 1);
    assert!(document.images().all(|image| matches!(image.source(), gltf::image::Source::View { .. })));
    assert!(document.views().all(|view| view.offset() + view.length() <= bin.len()));

    let stranger = world.file("stranger.glb");
    fs::write(&stranger, "not ours").expect("written");
    export(&world, &["1", stranger.to_str().expect("a path")]).expect_err("it is someone's");
    assert_eq!(fs::read_to_string(stranger).expect("there"), "not ours");
}

#[test]
fn landscapes_are_counted_from_one_or_named_by_file() {
    let world = World::starters();
    let out = world.file("out");
    let out = out.to_str().expect("a path");
    for wrong in ["0", "5", "-1"] {
        let error = export(&world, &[wrong, out]).expect_err("there is no such landscape");
        assert!(error.contains("there are landscapes 1 to 4"), "{error}");
    }
    export(&world, &[world.scene(3).to_str().expect("a path"), out]).expect("exported");
    assert!(names(Path::new(out)).contains("bare-trees-in-november-mist.glb"));
    assert!(names(&Path::new(out).join("trees")).contains("winter-oak-1.glb"));
}

/// Half the width of all that a file shows, in metres.
fn half_width_m(document: &gltf::Document) -> f32 {
    let mut widest = 0.0f32;
    for node in document.default_scene().expect("a scene").nodes() {
        let (_, _, [scale, ..]) = node.transform().decomposed();
        for primitive in node.mesh().into_iter().flat_map(|mesh| mesh.primitives()) {
            widest = widest.max(scale * primitive.bounding_box().max[0]);
        }
    }
    widest
}

#[test]
fn viewers_get_the_field_alone_unless_they_ask_for_more() {
    let world = World::starters();
    let (narrow, wide) = (exported(&world, &[]), exported(&world, &["--apron"]));
    assert_eq!(half_width_m(&narrow.0), 512.0);
    assert!(half_width_m(&wide.0) > 4000.0);
    assert!(narrow.2.len() < wide.2.len(), "bytes that nothing uses are left out");
    let has_far_trees =
        |document: &gltf::Document| document.nodes().any(|node| node.name() == Some(FAR_TREES_NODE));
    assert!(!has_far_trees(&narrow.0) && has_far_trees(&wide.0), "trees beyond the field need land");
    assert!(
        narrow.0.materials().all(|material| material.emissive_factor() != [0.0; 3]),
        "the sky's light is in it"
    );
}

#[test]
fn level_ground_gets_half_of_the_skys_light_from_a_lamp_above_and_half_from_itself() {
    let world = World::starters();
    let (document, json, _) = exported(&world, &[]);
    let lamp = document.nodes().find(|node| node.name() == Some("sky from above")).expect("a lamp");
    let (_, rotation, _) = lamp.transform().decomposed();
    assert!((glam::Quat::from_array(rotation) * glam::Vec3::NEG_Z).abs_diff_eq(glam::Vec3::NEG_Y, 1e-6));
    let lights = |json: &Value| json["extensions"]["KHR_lights_punctual"]["lights"].clone();
    let lamp = &lights(&json)[1];
    let number = |value: &Value| value.as_f64().expect("a number") as f32;
    for material in document.materials() {
        let glow = material.emissive_factor();
        let colors = &json["materials"][material.index().expect("listed")];
        let texture = &colors["pbrMetallicRoughness"]["baseColorTexture"];
        if material.name() == Some("ground") {
            for (channel, glow) in glow.into_iter().enumerate() {
                let color = number(&lamp["color"][channel]);
                let lamp = number(&lamp["intensity"]) * color / std::f32::consts::PI;
                assert!((glow / lamp - 1.0).abs() < 1e-3, "{glow} and {lamp}");
            }
        }
        // With coordinates of its own, VTK would take others for it.
        assert_eq!(colors["emissiveTexture"], *texture, "{:?}", material.name());
    }
    let (_, json, _) = exported(&world, &["--for", "blender"]);
    assert_eq!(lights(&json).as_array().map(Vec::len), Some(1), "in Blender the sky is the world's");
}

#[test]
fn blender_gets_lux_kinds_of_trees_and_a_script() {
    let world = World::starters();
    let (plain, _, _) = exported(&world, &[]);
    let (document, json, _) = exported(&world, &["--for", "blender"]);
    let sun = |document: &gltf::Document| json_of_sun(document);
    assert!((sun(&document) / sun(&plain) - 683.0).abs() < 0.1);
    assert!(half_width_m(&document) > 4000.0);
    assert!(document.materials().all(|material| material.emissive_factor() == [0.0; 3]));
    let kinds = document.scenes().nth(1).expect("a second scene");
    let kinds: BTreeSet<String> = kinds.nodes().filter_map(|node| node.name().map(str::to_owned)).collect();
    assert_eq!(kinds.len(), 10);
    assert!(kinds.contains("oak-1") && kinds.contains("oak-5 proxy"), "{kinds:?}");
    let marked =
        json["nodes"].as_array().expect("nodes").iter().filter(|node| node["extras"]["landscape"] == "x");
    assert!(marked.count() >= 10 + 5);

    let script = fs::read_to_string(world.file("x-blender.py")).expect("written");
    assert!(
        script.contains(r#""scene_file": "x.glb""#) && script.contains(r#""sky_file": "x-sky.exr""#),
        "{script}"
    );
    assert!(world.file("x-sky.exr").is_file());
    let error = export(&world, &["1", "y.glb", "--for", "blender", "--instancing"]).expect_err("at odds");
    assert!(error.contains("--instancing"), "{error}");
}

fn json_of_sun(document: &gltf::Document) -> f64 {
    let lights = document.extension_value("KHR_lights_punctual").expect("a sun");
    lights["lights"][0]["intensity"].as_f64().expect("a number")
}

#[test]
fn instancing_keeps_every_tree() {
    let world = World::starters();
    let (_, pairs, _) = exported(&world, &[]);
    let (document, json, bin) = exported(&world, &["--instancing"]);
    let trees = |json: &Value| {
        let nodes = json["nodes"].as_array().expect("nodes").clone();
        nodes.into_iter().find(|node| node["extensions"].get(GSC_INSTANCES).is_some()).expect("trees")
    };
    let count = trees(&pairs)["children"].as_array().expect("children").len();
    let mut feet = BTreeSet::new();
    for node in trees(&json)["children"].as_array().expect("children") {
        let node = &json["nodes"][node.as_u64().expect("a number") as usize];
        let attributes = &node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
        let accessor = |name: &str| {
            let index = attributes[name].as_u64().expect("an accessor") as usize;
            document.accessors().nth(index).expect("an accessor")
        };
        assert_eq!(accessor("ROTATION").count(), accessor("SCALE").count());
        let mesh = &json["meshes"][node["mesh"].as_u64().expect("a mesh") as usize];
        assert!(mesh["primitives"][0].get("targets").is_none());
        let places = accessor("TRANSLATION");
        let view = places.view().expect("a view");
        let bytes = &bin[view.offset() + places.offset()..][..12 * places.count()];
        feet.extend(bytes.chunks(12).map(<[u8]>::to_vec));
    }
    let exact: BTreeSet<Vec<u8>> = trees(&pairs)["children"]
        .as_array()
        .expect("children")
        .iter()
        .map(|node| &pairs["nodes"][node.as_u64().expect("a number") as usize]["translation"])
        .map(|at| {
            (0..3).flat_map(|axis| (at[axis].as_f64().expect("a number") as f32).to_le_bytes()).collect()
        })
        .collect();
    assert_eq!(exact.len(), count);
    assert!(feet == exact, "trees stand elsewhere");
    assert!(json["nodes"].as_array().expect("nodes").len() < 100);
}

#[test]
fn instances_stand_beyond_the_field_too() {
    let world = World::starters();
    let (_, json, _) = exported(&world, &["--instancing", "--apron"]);
    let nodes = json["nodes"].as_array().expect("nodes");
    let node = nodes.iter().find(|node| node["name"] == FAR_TREES_NODE).expect("far trees");
    let child = |child: &Value| &nodes[child.as_u64().expect("a number") as usize];
    let groups = node["children"].as_array().expect("children").iter().map(child);
    let count = |group: &Value| {
        let places = &group["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"];
        json["accessors"][places.as_u64().expect("an accessor") as usize]["count"].as_u64().expect("a count")
    };
    assert_eq!(groups.clone().count(), 5, "one for each kind of tree");
    assert_eq!(groups.map(count).sum::<u64>(), node["extensions"][GSC_INSTANCES]["count"], "all of them");
}

#[test]
fn a_damaged_blob_is_not_exported() {
    let world = World::starters();
    for blob in world.blobs().iter().filter(|blob| blob.extension().is_some_and(|ending| ending == "exr")) {
        damage(blob, |mut bytes| {
            *bytes.last_mut().expect("not empty") ^= 1;
            bytes
        });
    }
    let output = world.run(&["export", "1", world.file("out").to_str().expect("a path")]);
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stderr).contains("is damaged"));
}

#[test]
fn nothing_but_blobs_is_read_whoever_wrote_the_scene() {
    let world = World::starters();
    let text = fs::read_to_string(world.scene(0)).expect("a scene");
    let from = text.find("../../blobs/").expect("a blob");
    let to = from + text[from..].find('"').expect("its end");
    for secret in ["../../../space.ron", "../../current.ron", "../../blobs/../current.ron"] {
        fs::write(world.scene(0), [&text[..from], secret, &text[to..]].concat()).expect("written");
        let out = world.file("x.glb");
        let [scene, to] = [world.scene(0), out.clone()].map(|path| path.to_str().expect("a path").to_owned());
        let output = world.run(&["export", &scene, &to]);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(error.contains("which is no blob") && !out.exists(), "{error}");
    }
}
