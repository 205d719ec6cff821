//! Anyone's glTF files as the viewer reads them: what is in them arrives, what cannot be drawn is told, and nothing that a
//! file says makes the viewer fall.

use genescape_viewer::lod::tree::{Control, lod_number};
use genescape_viewer::lod_mode::TreeLodMode;
use genescape_viewer::options::MESH_ERROR_PX;
use genescape_viewer::scene::Asset;
use glam::{DVec3, Vec3};
use serde_json::{Value, json};

use crate::files::{self, F32, File, I8, I16, SQUARE, U8, U16, U32};

/// Corners of all triangles of the finest levels, where copies of each shape stand.
pub fn corners(asset: &Asset) -> Vec<[Vec3; 3]> {
    let mut found = Vec::new();
    for (shape, copy) in
        asset.shapes.iter().flat_map(|shape| shape.copies.iter().map(move |copy| (shape, copy)))
    {
        for part in &shape.levels[0].parts {
            let range = part.range.first as usize..(part.range.first + part.range.count) as usize;
            let place = |index: u32| {
                let place = DVec3::from(Vec3::from(asset.vertices[index as usize].position_m));
                copy.transform_point3(place).as_vec3()
            };
            found.extend(
                asset.indices[range].chunks_exact(3).map(|t| [place(t[0]), place(t[1]), place(t[2])]),
            );
        }
    }
    found
}

/// Twice the area of the triangles, all together, as a vector along their normals.
fn area(asset: &Asset) -> Vec3 {
    corners(asset).iter().map(|[a, b, c]| (*b - *a).cross(*c - *a)).sum()
}

#[test]
fn lists_strips_and_fans_are_the_same_square_and_lines_are_told() {
    for (mode, indices) in [(4, vec![0, 1, 2, 0, 2, 3]), (5, vec![0, 1, 3, 2]), (6, vec![0, 1, 2, 3])] {
        let mut file = File::square();
        let triangles = file.indices(&indices);
        file.primitive()["indices"] = json!(triangles);
        file.primitive()["mode"] = json!(mode);
        let asset = file.read().expect("a square");
        assert_eq!((area(&asset), asset.facts.triangles), (Vec3::Z * 8.0, 2), "mode {mode}");
        assert!(asset.facts.notes.is_empty(), "{:?}", asset.facts.notes);
    }
    for mode in [0, 1, 2, 3, 99] {
        let mut file = File::square();
        let mut second = file.primitive().clone();
        second["mode"] = json!(mode);
        file.json["meshes"][0]["primitives"].as_array_mut().expect("a list").push(second.clone());
        let asset = file.read().expect("a square");
        assert_eq!(asset.facts.triangles, 2);
        assert!(asset.facts.notes[0].contains("lines are not drawn"), "{:?}", asset.facts.notes);
        *file.primitive() = second;
        file.json["meshes"][0]["primitives"].as_array_mut().expect("a list").truncate(1);
        let told = file.read().expect_err("nothing to draw");
        assert!(told.contains("nothing in it can be drawn. Points and lines"), "{told}");
    }
}

#[test]
fn without_indices_corners_follow_upon_each_other() {
    let mut file = File::square();
    file.primitive()["indices"] = Value::Null;
    let asset = file.read().expect("four corners: one triangle");
    assert_eq!(
        (asset.facts.triangles, &corners(&asset)[..]),
        (1, &[[0, 1, 2].map(|n| Vec3::from(SQUARE[n]))][..])
    );
}

#[test]
fn numbers_of_every_kind_are_places() {
    for (component, normalized, scale) in
        [(F32, false, 1.0), (I8, false, 50.0), (I8, true, 127.0), (I16, false, 3000.0), (I16, true, 32_767.0)]
    {
        let mut file = File::square();
        let rows = SQUARE.map(|place| place.map(|x| x * scale).to_vec());
        let places = file.rows(component, normalized, &rows);
        file.primitive()["attributes"]["POSITION"] = json!(places);
        file.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
        let half = if normalized { 1.0 } else { scale };
        let corner = file.read().expect("a square").bounds_m[1];
        assert!(corner.distance(Vec3::new(half, half, 0.0)) < 1e-4 * half, "{component}: {corner}");
    }
    for (component, max) in [(U8, 255.0), (U16, 65_535.0)] {
        let mut file = File::square();
        let colors: Vec<Vec<f32>> = (0..4).map(|_| vec![max, 0.0, max / 2.0, max / 4.0]).collect();
        let colors = file.rows(component, true, &colors);
        file.primitive()["attributes"]["COLOR_0"] = json!(colors);
        let asset = file.read().expect("a square");
        assert!(asset.vertices.iter().all(|vertex| vertex.color[0] == 255 && vertex.color[1] == 0));
        assert!(asset.vertices[0].color[2].abs_diff(127) < 2 && asset.vertices[0].color[3].abs_diff(64) < 2);
    }
}

#[test]
fn indices_of_every_width_and_interleaved_vertices_are_read() {
    for component in [U8, U16, U32] {
        let mut file = File::square();
        let rows = [0.0, 1.0, 2.0, 0.0, 2.0, 3.0].map(|index| vec![index]);
        let indices = file.rows(component, false, &rows);
        file.primitive()["indices"] = json!(indices);
        assert_eq!(area(&file.read().expect("a square")), Vec3::Z * 8.0, "{component}");
    }
    // A place in three shorts and a short of nothing, then a normal in four bytes of which one is nothing.
    let mut file = File::square();
    let bytes = SQUARE.iter().flat_map(|place| {
        let place = place.map(|x| ((x + 2.0) * 100.0) as u16);
        place.into_iter().chain([7]).flat_map(u16::to_le_bytes).chain([0, 0, 127, 99])
    });
    let view = file.view(&bytes.collect::<Vec<u8>>());
    file.json["bufferViews"][view]["byteStride"] = json!(12);
    for (name, offset, component) in [("POSITION", 0, U16), ("NORMAL", 8, I8)] {
        let accessor = file.add("accessors", json!({
            "bufferView": view, "byteOffset": offset, "componentType": component, "count": 4, "type": "VEC3",
            "normalized": name == "NORMAL",
        }));
        file.primitive()["attributes"][name] = json!(accessor);
    }
    file.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let asset = file.read().expect("a square");
    assert_eq!(asset.bounds_m, [Vec3::new(100.0, 100.0, 200.0), Vec3::new(300.0, 300.0, 200.0)]);
    let up = asset.vertices.iter().all(|vertex| vertex.normal_oct == [0, 0] && vertex.tangent[3] != 0);
    assert!(up && asset.facts.notes.is_empty(), "{:?} {:?}", asset.vertices, asset.facts.notes);
}

#[test]
fn parts_that_share_their_vertices_keep_one_copy_of_them() {
    let mut file = File::square();
    let mut upper = file.primitive().clone();
    upper["indices"] = json!(file.indices(&[0, 2, 3]));
    file.primitive()["indices"] = json!(file.indices(&[0, 1, 2]));
    file.json["meshes"][0]["primitives"].as_array_mut().expect("a list").push(upper.clone());
    file.add("meshes", json!({ "primitives": [upper] }));
    file.json["nodes"] =
        json!([{ "mesh": 0, "children": [1] }, { "mesh": 1, "translation": [0.0, 0.0, 1.0] }]);
    let asset = file.read().expect("three triangles");
    assert_eq!((asset.vertices.len(), asset.facts.triangles, area(&asset)), (4, 3, Vec3::Z * 12.0));
    let second = &asset.shapes[1];
    assert!(second.center_m.distance(Vec3::ZERO) < 1e-6 && (second.radius_m - 2f32.sqrt()).abs() < 1e-6);
}

#[test]
fn of_several_scenes_the_one_is_drawn_that_the_file_opens_with() {
    let mut file = File::square();
    file.json["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0, "translation": [9.0, 0.0, 0.0] }]);
    file.json["scenes"] = json!([{ "nodes": [0] }, { "nodes": [1], "name": "far" }]);
    for (scene, x) in [(json!(1), 10.0), (json!(0), 1.0), (Value::Null, 1.0), (json!(7), 1.0)] {
        file.json["scene"] = scene.clone();
        let asset = file.read().expect("a square");
        assert_eq!((asset.bounds_m[1].x, asset.facts.copies), (x, 1), "{scene}");
        let note = &asset.facts.notes[0];
        assert!(note.contains("2 scenes") && note.contains("far") == (x > 5.0), "{note}");
    }
}

#[test]
fn sparse_numbers_replace_others_or_zeros() {
    for with_base in [true, false] {
        let mut file = File::square();
        let at = file.view(&2u16.to_le_bytes());
        let with: Vec<u8> = [5.0f32, 6.0, 7.0].iter().flat_map(|number| number.to_le_bytes()).collect();
        let with = file.view(&with);
        let accessor = &mut file.json["accessors"][0];
        accessor["sparse"] = json!({
            "count": 1,
            "indices": { "bufferView": at, "componentType": U16 },
            "values": { "bufferView": with },
        });
        if !with_base {
            accessor.as_object_mut().expect("an object").remove("bufferView");
        }
        let asset = file.read().expect("a square with one corner elsewhere");
        assert_eq!(asset.vertices[2].position_m, [5.0, 6.0, 7.0]);
        assert_eq!(asset.vertices[0].position_m, if with_base { SQUARE[0] } else { [0.0; 3] });
    }
}

#[test]
fn nodes_place_mirror_and_copy_meshes() {
    let mut file = File::square();
    file.json["nodes"] = json!([
        { "children": [1, 2], "translation": [10.0, 0.0, 0.0] },
        { "mesh": 0, "scale": [2.0, 2.0, 2.0] },
        { "mesh": 0, "scale": [-1.0, 1.0, 1.0], "translation": [0.0, 5.0, 0.0] },
    ]);
    let asset = file.read().expect("two squares");
    assert_eq!(asset.bounds_m, [Vec3::new(8.0, -2.0, 0.0), Vec3::new(12.0, 6.0, 0.0)]);
    assert_eq!(asset.facts.copies, 2);
    let looks = |triangles: &[[Vec3; 3]]| triangles.iter().all(|[a, b, c]| (*b - *a).cross(*c - *a).z > 0.0);
    assert!(looks(&corners(&asset)), "a mirrored square still looks towards +z");
}

#[test]
fn nodes_that_contain_themselves_are_drawn_once() {
    let mut file = File::square();
    file.json["nodes"] = json!([{ "mesh": 0, "children": [1] }, { "children": [0, 1] }]);
    let asset = file.read().expect("a square");
    assert_eq!(asset.facts.copies, 1);
    assert!(asset.facts.notes[0].contains("below itself"), "{:?}", asset.facts.notes);
}

#[test]
fn instances_stand_where_their_lists_say() {
    let mut file = File::square();
    let shifts = file.floats(&[vec![0.0, 0.0, 0.0], vec![10.0, 0.0, 0.0], vec![0.0, 20.0, 0.0]]);
    let scales = file.floats(&[vec![1.0; 3], vec![2.0; 3], vec![1.0; 3]]);
    let turn = vec![0.0, 0.0, 32_767.0, 0.0];
    let turns = file.rows(I16, true, &[turn.clone(), turn.clone(), turn]);
    file.json["nodes"][0]["extensions"] = json!({
        "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": shifts, "ROTATION": turns, "SCALE": scales } }
    });
    file.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    let asset = file.read().expect("three squares");
    assert_eq!((asset.facts.copies, asset.facts.triangles), (3, 6));
    assert_eq!(asset.bounds_m[1].round(), Vec3::new(12.0, 21.0, 0.0));
}

/// Three squares, each coarser than the one before, as one node's levels of detail.
fn with_msft_lod(coverage: Option<Vec<f32>>) -> File {
    let mut file = File::square();
    for _ in 0..2 {
        let mesh = file.json["meshes"][0].clone();
        file.add("meshes", mesh);
    }
    file.json["nodes"] = json!([
        { "mesh": 0, "extensions": { "MSFT_lod": { "ids": [1, 2] } } }, { "mesh": 1 }, { "mesh": 2 },
    ]);
    if let Some(coverage) = coverage {
        file.json["nodes"][0]["extras"] = json!({ "MSFT_screencoverage": coverage });
    }
    file
}

#[test]
fn levels_by_msft_lod_change_where_the_file_says() {
    for coverage in [vec![0.4, 0.1, 0.01], vec![0.9, 0.7, 0.0]] {
        let asset = with_msft_lod(Some(coverage.clone())).read().expect("a square");
        assert_eq!(
            (asset.facts.copies, asset.facts.levels, asset.facts.level_source),
            (1, 3, Some("MSFT_lod"))
        );
        assert_eq!(asset.facts.triangles, 2, "those of the finest level");
        let shape = &asset.shapes[0];
        let errors_m: Vec<f32> = shape.levels.iter().map(|level| level.error_m).collect();
        let level = |share: f32| {
            // A picture of 1080 rows in which the sphere covers that share of the height.
            let control = Control { mode: TreeLodMode::Discrete, focal_px: 1000.0, error_px: MESH_ERROR_PX };
            let away_m = 1000.0 * 2.0 * shape.radius_m / (share * 1080.0);
            lod_number(&control, &errors_m, 1.0, away_m, 1.0)
        };
        for (number, share) in (0u8..).zip(&coverage[..2]) {
            let (before, after) = (f32::from(number), f32::from(number + 1));
            assert_eq!((level(share * 1.01), level(share * 0.99)), (before, after), "{coverage:?}");
        }
        assert_eq!(level(1e-6), 2.0, "and never vanishes");
    }
    let asset = with_msft_lod(None).read().expect("a square");
    assert!(asset.shapes[0].levels.is_sorted_by(|a, b| a.error_m < b.error_m));
}

#[test]
fn stand_ins_of_a_scene_are_not_drawn_by_themselves() {
    let mut file = with_msft_lod(None);
    file.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    assert_eq!(file.read().expect("a square").facts.copies, 1);
    for ids in [json!([99, 0, -1, "x"]), json!(7), Value::Null] {
        file.json["nodes"][0]["extensions"]["MSFT_lod"]["ids"] = ids;
        file.read().expect("a square");
    }
}

#[test]
fn levels_of_ours_morph_and_damaged_ones_are_told() {
    let mut file = File::square();
    let moves = file.floats(&[vec![0.0, 0.0, 0.5], vec![0.0; 3], vec![0.0; 3], vec![0.0; 3]]);
    let slides = file.floats(&[vec![0.25, 0.0], vec![0.0; 2], vec![0.0; 2], vec![0.0; 2]]);
    file.primitive()["targets"] = json!([{ "POSITION": moves }]);
    let coarse = file.json["meshes"][0].clone();
    file.add("meshes", coarse);
    let level = |mesh: u32, error: f32| json!({ "mesh": mesh, "vertices": 4, "triangles": 2, "error": error, "texcoordDeltas": [slides] });
    file.json["meshes"][0]["extensions"] =
        json!({ "GSC_progressive_mesh": { "bufferView": 0, "levels": [level(0, 0.01), level(1, 0.1)] } });
    let asset = file.read().expect("a square");
    assert_eq!((asset.facts.levels, asset.facts.level_source), (2, Some("GSC_progressive_mesh")));
    let shape = &asset.shapes[0];
    assert!(shape.morphs && shape.levels[1].error_m == 0.1);
    assert_eq!(asset.vertices[0].position_delta_m, [0.0, 0.0, 0.5]);
    assert_eq!(asset.vertices[0].uv_delta, [0.25, 0.0]);
    assert_eq!(asset.vertices[4].position_delta_m, [0.0; 3], "the last level has nowhere to go");
    // Of clusters that are nearer than the leaves before them.
    file.json["meshes"][0]["extensions"]["GSC_progressive_mesh"]["levels"] =
        json!([level(0, 0.2), level(1, 0.1)]);
    let levels = &file.read().expect("a square").shapes[0].levels;
    assert!(levels.len() == 2 && levels[0].error_m < levels[1].error_m, "passed in their order all the same");
    for levels in [json!([]), json!([level(9, 0.1)]), json!([level(0, 0.2), level(1, -0.1)]), json!("x")] {
        file.json["meshes"][0]["extensions"]["GSC_progressive_mesh"]["levels"] = levels;
        let asset = file.read().expect("a square");
        assert!(
            asset.facts.levels == 1 && asset.facts.notes[0].contains("damaged"),
            "{:?}",
            asset.facts.notes
        );
    }
}

#[test]
fn suns_and_the_first_camera_arrive() {
    let mut file = File::square();
    file.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "directional", "intensity": 3.0, "color": [1.0, 0.5, 0.0] }, { "type": "point" },
    ] } });
    let light = |number: u32| json!({ "KHR_lights_punctual": { "light": number } });
    file.json["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.1 } }]);
    file.json["nodes"] = json!([
        { "mesh": 0, "children": [1, 2, 3] },
        { "extensions": light(0), "rotation": [-0.707_106_77, 0.0, 0.0, 0.707_106_77] },
        { "extensions": light(1) },
        { "camera": 0, "translation": [0.0, 1.0, 5.0] },
    ]);
    let asset = file.read().expect("a square");
    assert_eq!(asset.lights.len(), 1);
    assert!(asset.lights[0].direction.distance(Vec3::Y) < 1e-5, "it shines down");
    assert_eq!(asset.lights[0].irradiance, Vec3::new(3.0, 1.5, 0.0));
    assert!(asset.facts.notes[0].contains("Lamps"), "{:?}", asset.facts.notes);
    let camera = asset.camera.expect("a camera");
    assert_eq!((camera.position_m, camera.direction), (Vec3::new(0.0, 1.0, 5.0), Vec3::NEG_Z));
}

#[test]
fn a_skeleton_holds_its_mesh_where_its_joints_are() {
    let mut file = File::square();
    let joints = file.rows(
        U8,
        false,
        &SQUARE.map(|place| vec![if place[0] < 0.0 { 0.0 } else { 1.0 }, 0.0, 0.0, 0.0]),
    );
    let weights = file.rows(U8, true, &SQUARE.map(|_| vec![255.0, 0.0, 0.0, 0.0]));
    file.primitive()["attributes"]["JOINTS_0"] = json!(joints);
    file.primitive()["attributes"]["WEIGHTS_0"] = json!(weights);
    let bind: Vec<f32> = glam::Mat4::from_translation(Vec3::new(0.0, 0.0, 1.0)).to_cols_array().to_vec();
    let bytes: Vec<u8> = [&bind[..], &bind].concat().iter().flat_map(|number| number.to_le_bytes()).collect();
    let view = file.view(&bytes);
    let accessor = json!({ "bufferView": view, "componentType": F32, "count": 2, "type": "MAT4" });
    let matrices = file.add("accessors", accessor);
    file.json["skins"] = json!([{ "joints": [1, 2], "inverseBindMatrices": matrices }]);
    file.json["nodes"] = json!([
        { "mesh": 0, "skin": 0, "scale": [100.0, 100.0, 100.0], "children": [1, 2] },
        { "translation": [0.0, 0.5, 0.0], "scale": [0.01, 0.01, 0.01] },
        { "translation": [0.03, 0.0, 0.0], "scale": [0.01, 0.01, 0.01] },
    ]);
    let asset = file.read().expect("a square");
    // The first joint is at (0, 50, 0), the second at (3, 0, 0), both of unit size; both were bound a metre behind.
    let [low, high] = asset.bounds_m.map(|corner| (corner * 1e4).round() / 1e4);
    assert_eq!([low, high], [Vec3::new(-1.0, -1.0, 1.0), Vec3::new(4.0, 51.0, 1.0)]);
    assert!(asset.facts.notes[0].contains("pose"), "{:?}", asset.facts.notes);
}

#[test]
fn what_a_file_requires_and_is_not_known_is_named_with_what_helps() {
    for (name, advice) in [
        ("KHR_draco_mesh_compression", "unpacks"),
        ("EXT_meshopt_compression", "unpacks"),
        ("KHR_texture_basisu", "KTX2"),
        ("KHR_materials_pbrSpecularGlossiness", "metalrough"),
        ("ACME_thing", "export it without"),
    ] {
        let mut file = File::square();
        file.json["extensionsRequired"] = json!([name]);
        let told = file.read().expect_err("it is not known");
        assert!(told.contains(&format!("“{name}”")) && told.contains(advice), "{told}");
    }
    for name in ["KHR_materials_unlit", "KHR_texture_transform", "KHR_materials_sheen", "MSFT_lod"] {
        let mut file = File::square();
        file.json["extensionsRequired"] = json!([name]);
        file.read().expect(name);
    }
}

#[test]
fn parts_that_only_a_decompressor_could_fill_are_told_with_what_helps() {
    let mut file = File::square();
    file.json["accessors"][0].as_object_mut().expect("an object").remove("bufferView");
    let told = file.read().expect_err("no places");
    assert!(told.contains("no places that can be read"), "{told}");
    file.primitive()["extensions"] =
        json!({ "KHR_draco_mesh_compression": { "bufferView": 0, "attributes": { "POSITION": 0 } } });
    let told = file.read().expect_err("no places");
    assert!(told.contains("(KHR_draco_mesh_compression)") && told.contains("gltf-transform copy"), "{told}");
}

#[test]
fn what_is_no_gltf_is_told_in_words() {
    let mut old = File::square();
    old.json["asset"]["version"] = json!("1.0");
    for (bytes, why) in [
        (b"".to_vec(), "no glTF"),
        (b"hello".to_vec(), "no glTF"),
        (b"glTF\x02\0\0\0\xff\xff\xff\xff".to_vec(), "no sound .glb"),
        (b"glTF\x01\0\0\0\x14\0\0\0\0\0\0\0\0\0\0\0".to_vec(), "glTF 1.0"),
        (b"{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":1.5}]}".to_vec(), "nodes[0].mesh"),
        (b"{}".to_vec(), "does not say that it is glTF 2.0"),
        (old.glb(), "glTF 1.0"),
        (File::new().glb(), "no node of its scene has a mesh"),
    ] {
        let told = files::read_bytes(&bytes).expect_err(why);
        assert!(told.contains(why) && told.contains("model.glb"), "{told}");
    }
}

#[test]
fn a_file_stands_on_the_ground_in_a_size_that_can_be_walked_around() {
    for (scale, expected) in [(1.0, 1.0), (0.003, 1000.0), (0.03, 100.0), (400.0, 1.0), (3e8, 1e-5)] {
        let mut file = File::square();
        file.json["nodes"][0]["scale"] = json!([scale, scale, scale]);
        file.json["nodes"][0]["translation"] = json!([5.0 * scale, 0.0, 0.0]);
        let asset = file.read().expect("a square");
        let staging = asset.staging();
        assert!((staging.scale / expected - 1.0).abs() < 1e-9, "{scale}: {}", staging.scale);
        let [low, high] =
            asset.bounds_m.map(|corner| staging.world_from_file.transform_point3(corner.as_dvec3()));
        let size = (high - low).max_element();
        assert!(low.y.abs() < 1e-5 * size && (low.x + high.x).abs() < 1e-5 * size, "{low} {high}");
        assert!((0.99..60_000.0).contains(&size), "{size}");
    }
}
