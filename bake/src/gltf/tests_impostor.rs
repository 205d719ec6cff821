//! Pictures of trees in a tree's own file, in a scene and in a scene's single file.

use genescape_schema::scene::{GSC_IMPOSTOR, ImpostorExtension, Resource};
use glam::Vec3;
use serde_json::Value;

use super::synthetic::{Synthetic, impostor, synthetic, tree};
use super::tests::{buffers, check_ranges, gltf_of, tree_file};
use super::*;
use crate::model::{Image8, Impostor, TreeTextures};

/// The impostors in a file: for each its extension, the cards' mesh, and the PNG files of colours and relief.
fn impostors(json: &Value, buffers: &[Vec<u8>]) -> Vec<(ImpostorExtension, Value, Vec<u8>, Vec<u8>)> {
    let bytes = |view: &Value| {
        let view = &json["bufferViews"][view.as_u64().unwrap() as usize];
        let number = |key: &str| view.get(key).map_or(0, |n| n.as_u64().unwrap() as usize);
        buffers[number("buffer")][number("byteOffset")..][..number("byteLength")].to_vec()
    };
    let item = |list: &str, index: &Value| json[list][index.as_u64().unwrap() as usize].clone();
    let extensions =
        json["meshes"].as_array().unwrap().iter().filter_map(|m| m["extensions"].get(GSC_IMPOSTOR));
    let read = |extension: &Value| {
        let typed: ImpostorExtension = serde_json::from_value(extension.clone()).unwrap();
        let cards = json["meshes"][typed.mesh].clone();
        let material = item("materials", &cards["primitives"][0]["material"]);
        assert_eq!((&material["alphaMode"], &material["doubleSided"]), (&"MASK".into(), &true.into()));
        let texture = item("textures", &material["pbrMetallicRoughness"]["baseColorTexture"]["index"]);
        assert_eq!(item("samplers", &texture["sampler"])["wrapS"], 33071);
        let image = item("images", &texture["source"]);
        let Resource { buffer_view: Some(relief), uri: None, .. } = typed.relief else {
            panic!("the relief lies in a buffer")
        };
        (typed, cards, bytes(&image["bufferView"]), bytes(&relief.into()))
    };
    extensions.map(read).collect()
}

/// Whether that is what [`impostor`] became.
fn check(found: &(ImpostorExtension, Value, Vec<u8>, Vec<u8>), name: &str) {
    let (extension, cards, colors, relief) = found;
    let Impostor { axis_m, low_m, size_m, error_m, .. } = impostor();
    assert_eq!(cards["name"], name);
    assert_eq!((extension.axis_m, extension.low_m), (axis_m, low_m));
    assert_eq!((extension.size_m, extension.error_m), (size_m, error_m));
    assert_eq!(*colors, png::encode(&impostor().colors));
    assert_eq!(*relief, png::encode_linear(&impostor().relief));
}

#[test]
fn pictures_follow_a_trees_levels() {
    let tree = tree(false);
    let glb = tree_file(&tree);
    let (document, bin) = gltf_of(&glb);
    check_ranges(&document, &[bin.len()]);
    let json = super::glb::read_glb("tree", &glb).unwrap().json;
    let [found] = &impostors(&json, std::slice::from_ref(&bin))[..] else { panic!("D_0 has one") };
    check(found, "tree impostor");
    assert!(json["meshes"][0]["extensions"].get(GSC_IMPOSTOR).is_some());
    assert!(json["extensionsUsed"].as_array().unwrap().contains(&GSC_IMPOSTOR.into()));
    let finished = document.default_scene().unwrap().nodes().next().unwrap();
    let lod = finished.extension_value("MSFT_lod").unwrap();
    let last = lod["ids"].as_array().unwrap().last().unwrap().as_u64().unwrap() as usize;
    assert_eq!(document.nodes().nth(last).unwrap().mesh().unwrap().index(), found.0.mesh);
}

#[test]
fn no_mesh_is_shown_that_is_farther_from_the_tree_than_its_pictures() {
    let tree = tree(false);
    let finer = Impostor { error_m: 0.5 * tree.levels[1].error_m, ..impostor() };
    let picture = || Picture::Embedded { bytes: &[], mime_type: "" };
    let textures = TreeTextures {
        bark_color: picture(),
        bark_normal: picture(),
        leaf: vec![picture()],
        blossom: Vec::new(),
        bark_linear: [0.1; 3],
        is_thin: false,
        leaf_small: Image8::default(),
        blossom_small: Image8::default(),
        alpha_cutoff: 0.5,
    };
    let (document, _) = gltf_of(
        &tree_glb("tree", &tree, &textures, &TreePictures { impostor: Some(&finer), clusters: None })
            .unwrap(),
    );
    let finished = document.default_scene().unwrap().nodes().next().unwrap();
    let ids = finished.extension_value("MSFT_lod").unwrap()["ids"].as_array().unwrap();
    let names = ids.iter().map(|id| document.nodes().nth(id.as_u64().unwrap() as usize).unwrap());
    assert_eq!(names.map(|node| node.name().unwrap()).collect::<Vec<_>>(), ["tree impostor"]);
    let extras: Value = serde_json::from_str(finished.extras().as_ref().unwrap().get()).unwrap();
    assert_eq!(extras["MSFT_screencoverage"].as_array().unwrap().len(), 2);
    // The row of scene 1 has all of them.
    let row = document.scenes().nth(1).unwrap().nodes().next().unwrap();
    assert_eq!(row.children().count(), tree.levels.len() + 1);
}

#[test]
fn cards_show_each_picture_from_its_side() {
    let (document, bin) = gltf_of(&tree_file(&tree(false)));
    let mesh = document.meshes().find(|mesh| mesh.name() == Some("tree impostor")).unwrap();
    let primitive = mesh.primitives().next().unwrap();
    let reader = primitive.reader(|_| Some(&bin));
    let positions: Vec<Vec3> = reader.read_positions().unwrap().map(Vec3::from_array).collect();
    let uvs: Vec<[f32; 2]> = reader.read_tex_coords(0).unwrap().into_f32().collect();
    let normals: Vec<Vec3> = reader.read_normals().unwrap().map(Vec3::from_array).collect();
    let indices: Vec<usize> = reader.read_indices().unwrap().into_u32().map(|i| i as usize).collect();
    assert_eq!((positions.len(), indices.len()), (16, 24));
    let Impostor { axis_m: [x, z], low_m, size_m: [width_m, height_m], .. } = impostor();
    for (place, triangle) in indices.chunks(3).enumerate() {
        let (k, [a, b, c]) = (place / 2, [0, 1, 2].map(|i| positions[triangle[i]]));
        let (sin, cos) = libm::sincosf(std::f32::consts::FRAC_PI_4 * k as f32);
        let (eye, right) = (Vec3::new(sin, 0.0, cos), Vec3::new(cos, 0.0, -sin));
        assert!((b - a).cross(c - a).normalize().distance(eye) < 1e-5, "card {k} faces elsewhere");
        for &i in triangle {
            let from_foot = positions[i] - Vec3::new(x, low_m, z);
            let u = (0.5 + from_foot.dot(right) / width_m + k as f32) / 4.0;
            assert!((uvs[i][0] - u).abs() < 1e-5 && (uvs[i][1] - 1.0 + from_foot.y / height_m).abs() < 1e-5);
            let outwards = normals[i].dot(right) * from_foot.dot(right);
            assert!(outwards > 0.0 && normals[i].y > 0.0 && normals[i].dot(eye) > 0.0, "{:?}", normals[i]);
        }
    }
}

fn scene() -> (Synthetic, Value, Vec<Vec<u8>>) {
    let synthetic = synthetic(20);
    let bytes = scene_gltf(&synthetic.parts()).unwrap();
    let buffers = buffers(&synthetic, &gltf::Gltf::from_slice(&bytes).unwrap().document);
    (synthetic, serde_json::from_slice(&bytes).unwrap(), buffers)
}

#[test]
fn a_scene_finds_pictures_in_its_trees_files() {
    let (_, json, buffers) = scene();
    let [first, second] = &impostors(&json, &buffers)[..] else { panic!("two templates") };
    check(first, "tree-0 impostor");
    check(second, "tree-1 impostor");
    let material = |cards: &Value| cards["primitives"][0]["material"].clone();
    assert_ne!(material(&first.1), material(&second.1), "each template has pictures of its own");
}

#[test]
fn a_single_file_keeps_pictures() {
    let (synthetic, mut json, _) = scene();
    // As when something is left out before them, which all indices have to follow.
    json["meshes"].as_array_mut().unwrap().insert(0, serde_json::json!({ "primitives": [] }));
    let glb = single_glb(shifted(json), |uri| synthetic.files.resolve(uri)).unwrap();
    let (document, bin) = gltf_of(&glb);
    check_ranges(&document, &[bin.len()]);
    let json = super::glb::read_glb("scene", &glb).unwrap().json;
    let found = impostors(&json, &[bin]);
    assert_eq!(found.len(), 2);
    check(&found[0], "tree-0 impostor");
    check(&found[1], "tree-1 impostor");
}

/// With all indices of meshes one higher.
fn shifted(mut json: Value) -> Value {
    let more: Result<(), std::convert::Infallible> = for_each_object(&mut json, &mut |object| {
        if let Some(mesh) = object.get("mesh").and_then(Value::as_u64) {
            object.insert("mesh".into(), (mesh + 1).into());
        }
        Ok(())
    });
    let Ok(()) = more;
    json
}
