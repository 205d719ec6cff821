//! What other programs rely on, checked by reading the files back with the `gltf` crate.

use std::collections::BTreeSet;

use glam::{DMat3, DQuat, Vec3};
use serde_json::Value;

use super::synthetic::*;
use super::*;
use crate::model::{Clusters, Image8, LevelledMesh, Material, Mesh, TreeTextures};

pub(super) fn gltf_of(glb: &[u8]) -> (gltf::Document, Vec<u8>) {
    let gltf = gltf::Gltf::from_slice(glb).expect("the gltf crate reads it");
    (gltf.document, gltf.blob.unwrap_or_default())
}

/// All accessors lie inside their views and those inside their buffers.
pub(super) fn check_ranges(document: &gltf::Document, lengths: &[usize]) {
    for view in document.views() {
        assert!(view.offset() + view.length() <= lengths[view.buffer().index()]);
        assert_eq!(view.offset() % 4, 0, "view {} is not aligned", view.index());
    }
    for accessor in document.accessors() {
        let Some(view) = accessor.view() else { continue };
        let stride = view.stride().unwrap_or(accessor.size());
        let end = accessor.offset() + stride * (accessor.count() - 1) + accessor.size();
        assert!(end <= view.length(), "accessor {} ends beyond its view", accessor.index());
    }
}

fn images(pictures: &[Vec<u8>; 3]) -> TreeTextures<Picture<'_>> {
    let embedded = |bytes| Picture::Embedded { bytes, mime_type: "image/png" };
    TreeTextures {
        bark_color: embedded(&pictures[0]),
        bark_normal: embedded(&pictures[1]),
        leaf: vec![embedded(&pictures[2])],
        blossom: Vec::new(),
        bark_linear: [0.1; 3],
        is_thin: false,
        leaf_small: Image8::default(),
        blossom_small: Image8::default(),
        alpha_cutoff: 0.5,
    }
}

pub(super) fn tree_file(mesh: &LevelledMesh) -> Vec<u8> {
    tree_glb(
        "tree",
        mesh,
        &images(&tree_images()),
        &TreePictures { impostor: Some(&impostor()), clusters: None },
    )
    .unwrap()
}

#[test]
fn a_tree_reads_back_as_it_was() {
    let tree = tree(false);
    let (document, bin) = gltf_of(&tree_file(&tree));
    check_ranges(&document, &[bin.len()]);
    assert_eq!(document.scenes().count(), 2);
    assert_eq!(document.default_scene().unwrap().index(), 0);
    for (mesh, level) in document.meshes().zip(&tree.levels) {
        let (mut positions, mut uvs, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
        for primitive in mesh.primitives() {
            let reader = primitive.reader(|_| Some(&bin));
            let first = positions.len() as u32;
            positions.extend(reader.read_positions().unwrap());
            uvs.extend(reader.read_tex_coords(0).unwrap().into_f32());
            triangles.extend(reader.read_indices().unwrap().into_u32().map(|i| i + first));
            let colors = reader.read_colors(0).unwrap().into_rgba_u8();
            let count = colors.len();
            assert!(colors.eq(level.mesh.colors[first as usize..].iter().copied().take(count)));
            let run = &positions[first as usize..];
            let bounds = primitive.bounding_box();
            for axis in 0..3 {
                assert_eq!(bounds.min[axis], run.iter().map(|p| p[axis]).fold(f32::MAX, f32::min));
                assert_eq!(bounds.max[axis], run.iter().map(|p| p[axis]).fold(f32::MIN, f32::max));
            }
        }
        assert_eq!(positions, level.mesh.positions);
        assert_eq!(uvs, level.mesh.uvs);
        let all: Vec<u32> =
            level.mesh.parts.iter().flat_map(|p| p.triangles.as_flattened()).copied().collect();
        assert_eq!(triangles, all);
    }
}

#[test]
fn coarser_levels_take_the_trees_place() {
    let tree = tree(false);
    let (document, _) = gltf_of(&tree_file(&tree));
    let finished = document.default_scene().unwrap().nodes().next().unwrap();
    let lod = finished.extension_value("MSFT_lod").unwrap();
    let ids: Vec<usize> = serde_json::from_value(lod["ids"].clone()).unwrap();
    let levels: Vec<_> = ids.iter().map(|&id| document.nodes().nth(id).unwrap()).collect();
    let meshes = levels.iter().map(|node| node.mesh().unwrap().index());
    // The pictures' mesh comes after them.
    assert_eq!(meshes.collect::<Vec<_>>(), (1..=tree.levels.len()).collect::<Vec<_>>());
    let (translation, rotation, scale) = finished.transform().decomposed();
    assert!(levels.iter().all(|node| node.transform().decomposed() == (translation, rotation, scale)));
    // Every node is in a scene, for Blender shows those that are in none.
    let held: usize = document.nodes().map(|node| node.children().count()).sum();
    let roots: usize = document.scenes().map(|scene| scene.nodes().count()).sum();
    assert_eq!(held + roots, document.nodes().count());
    let extras: Value = serde_json::from_str(finished.extras().as_ref().unwrap().get()).unwrap();
    let coverage: Vec<f32> = serde_json::from_value(extras["MSFT_screencoverage"].clone()).unwrap();
    assert_eq!(coverage.len(), ids.len() + 1);
    assert!(
        coverage.is_sorted_by(|a, b| a > b) && coverage[0] <= 1.0 && coverage.ends_with(&[0.0]),
        "{coverage:?}"
    );
}

#[test]
fn geomorphs_lead_to_the_next_level() {
    for still in [false, true] {
        let tree = tree(still);
        let glb = tree_file(&tree);
        let (document, bin) = gltf_of(&glb);
        let vec3 = gltf::accessor::Dimensions::Vec3;
        let sparse = document.accessors().filter(|a| a.sparse().is_some() && a.dimensions() == vec3).count();
        // The trunk's deltas are sparse in both, those of the leaves only if most of them stay as they are.
        assert_eq!(sparse, if still { 2 } else { 1 });
        let goals: Vec<[u32; 3]> = tree.levels[1]
            .mesh
            .positions
            .iter()
            .map(|p| p.map(|x| (x * 1e4).round() as i32 as u32))
            .collect();
        let mesh = document.meshes().next().unwrap();
        assert_eq!(mesh.weights(), Some(&[0.0][..]));
        let bark = mesh.primitives().next().unwrap();
        let reader = bark.reader(|_| Some(&bin));
        let (deltas, normals, _) = reader.read_morph_targets().next().unwrap();
        assert!(normals.is_none(), "normals of the trunk do not change, so none are written");
        for (p, d) in reader.read_positions().unwrap().zip(deltas.unwrap()) {
            let moved = [0, 1, 2].map(|i| ((p[i] + d[i]) * 1e4).round() as i32 as u32);
            assert!(goals.contains(&moved), "{moved:?} is no vertex of D_1");
        }
        // Every vertex, against the morph itself.
        let morph = tree.levels[0].morph.as_ref().unwrap();
        let mut at = 0;
        for primitive in mesh.primitives() {
            let reader = primitive.reader(|_| Some(&bin));
            for delta in reader.read_morph_targets().next().unwrap().0.unwrap() {
                assert_eq!(delta, morph.positions[at]);
                at += 1;
            }
        }
        assert_eq!(at, morph.positions.len());
        assert_eq!(document.meshes().nth(1).unwrap().primitives().next().unwrap().morph_targets().count(), 0);
    }
}

#[test]
fn sparse_indices_state_their_offset() {
    // The gltf crate takes it as optional; F3D does not.
    let glb = tree_file(&tree(true));
    let json = super::glb::read_glb("tree", &glb).unwrap().json;
    let sparse: Vec<_> =
        json["accessors"].as_array().unwrap().iter().filter_map(|a| a.get("sparse")).collect();
    assert!(!sparse.is_empty());
    assert!(sparse.iter().all(|s| s["indices"]["byteOffset"] == 0));
}

/// The scene's JSON, and the lengths of its buffers.
pub(super) fn scene(count: u32) -> (Synthetic, Vec<u8>) {
    let synthetic = synthetic(count);
    let bytes = scene_gltf(&synthetic.parts()).unwrap();
    (synthetic, bytes)
}

pub(super) fn buffers(synthetic: &Synthetic, document: &gltf::Document) -> Vec<Vec<u8>> {
    let uri = |buffer: gltf::Buffer<'_>| match buffer.source() {
        gltf::buffer::Source::Uri(uri) => uri.to_owned(),
        gltf::buffer::Source::Bin => panic!("a scene has no chunk of its own"),
    };
    document.buffers().map(|b| synthetic.files.resolve(&uri(b)).unwrap()).collect()
}

#[test]
fn a_scene_points_into_its_blobs() {
    let (synthetic, bytes) = scene(20);
    let document = gltf::Gltf::from_slice(&bytes).unwrap().document;
    let buffers = buffers(&synthetic, &document);
    for (buffer, bytes) in document.buffers().zip(&buffers) {
        assert_eq!(buffer.length(), bytes.len());
    }
    check_ranges(&document, &buffers.iter().map(Vec::len).collect::<Vec<_>>());
    let read = |mesh: &gltf::Mesh<'_>| -> Vec<[f32; 3]> {
        let positions = |p: gltf::Primitive<'_>| -> Vec<[f32; 3]> {
            p.reader(|b| Some(&buffers[b.index()])).read_positions().unwrap().collect()
        };
        mesh.primitives().flat_map(positions).collect()
    };
    let find = |name: &str| document.meshes().find(|m| m.name() == Some(name)).unwrap();
    assert_eq!(read(&find("terrain")), terrain(&synthetic.land).near.positions);
    for (name, still) in [("tree-0", false), ("tree-1", true)] {
        for (i, level) in tree(still).levels.iter().enumerate() {
            assert_eq!(read(&find(&format!("{name}.D{i}"))), level.mesh.positions);
        }
    }
}

#[test]
fn two_nodes_give_an_instances_affine_transform() {
    let (synthetic, bytes) = scene(200);
    let document = gltf::Gltf::from_slice(&bytes).unwrap().document;
    let trees = document.nodes().find(|n| n.name() == Some("trees")).unwrap();
    assert_eq!(trees.children().count(), synthetic.placement.instances.len());
    for (parent, instance) in trees.children().zip(&synthetic.placement.instances) {
        let child = parent.children().next().unwrap();
        let (translation, left, scale) = parent.transform().decomposed();
        let (none, right, one) = child.transform().decomposed();
        assert_eq!((none, one), ([0.0; 3], [1.0; 3]));
        let a = &instance.world_from_tree;
        assert_eq!(translation, [0, 1, 2].map(|row| a[row][3]));
        let exact = [0, 1, 2].map(|c| [0, 1, 2].map(|row| f64::from(a[row][c])));
        let turn = |q: [f32; 4]| DMat3::from_quat(DQuat::from_array(q.map(f64::from)));
        let product = turn(left) * DMat3::from_diagonal(Vec3::from(scale).as_dvec3()) * turn(right);
        let exact = DMat3::from_cols_array_2d(&exact);
        assert!((product - exact).to_cols_array().iter().all(|x| x.abs() < 1e-5), "{parent:?}");
        let name = child.mesh().unwrap().name().unwrap().to_owned();
        assert!(name.starts_with(&format!("tree-{}.", instance.template)));
    }
}

#[test]
fn far_trees_are_coarser_and_the_budget_holds() {
    let (_, bytes) = scene(200);
    let document = gltf::Gltf::from_slice(&bytes).unwrap().document;
    let trees = document.nodes().find(|n| n.name() == Some("trees")).unwrap();
    let eye = document.nodes().find(|n| n.camera().is_some()).unwrap().transform().decomposed().0;
    let distance = |node: &gltf::Node<'_>| {
        let t = node.transform().decomposed().0;
        glam::Vec2::new(t[0] - eye[0], t[2] - eye[2]).length()
    };
    let mean = |level: &str| {
        let at: Vec<f32> = trees
            .children()
            .filter(|n| n.children().next().unwrap().mesh().unwrap().name().unwrap().ends_with(level))
            .map(|n| distance(&n))
            .collect();
        at.iter().sum::<f32>() / at.len() as f32
    };
    assert!(mean("D1") > mean("D0"), "{} {}", mean("D1"), mean("D0"));
}

#[test]
fn a_single_file_holds_the_whole_scene() {
    let (synthetic, bytes) = scene(20);
    let json: Value = serde_json::from_slice(&bytes).unwrap();
    let glb = single_glb(json.clone(), |uri| synthetic.files.resolve(uri)).unwrap();
    assert!(!String::from_utf8_lossy(&glb).contains("\"uri\""));
    let (single, bin) = gltf_of(&glb);
    check_ranges(&single, &[bin.len()]);
    let document = gltf::Gltf::from_slice(&bytes).unwrap().document;
    let buffers = buffers(&synthetic, &document);
    for (ours, theirs) in document.accessors().zip(single.accessors()) {
        let part = |a: &gltf::Accessor<'_>, buffers: &[&[u8]]| {
            a.view().map(|v| buffers[v.buffer().index()][v.offset()..v.offset() + v.length()].to_vec())
        };
        let many: Vec<&[u8]> = buffers.iter().map(Vec::as_slice).collect();
        assert_eq!(part(&ours, &many), part(&theirs, &[&bin]));
    }
    assert_eq!(single.images().count(), document.images().count());
    let missing = single_glb(json, |_| Err("gone".into()));
    assert!(matches!(missing, Err(ExportError::Missing(..))));
}

#[test]
fn the_same_parts_give_the_same_bytes() {
    assert_eq!(scene(20).1, scene(20).1);
    assert_eq!(tree_file(&tree(false)), tree_file(&tree(false)));
}

#[test]
fn nothing_is_required_and_all_our_extensions_are_named() {
    let json: Value = serde_json::from_slice(&scene(20).1).unwrap();
    assert!(json.get("extensionsRequired").is_none());
    let used = json["extensionsUsed"].as_array().unwrap();
    for name in genescape_schema::scene::EXTENSIONS {
        assert!(used.iter().any(|u| u == name), "{name} is not in extensionsUsed");
    }
    assert_eq!(json["scenes"][0]["extras"]["genome"]["height_m"], 7.4);
}

#[test]
fn what_alpha_cuts_out_is_sampled_at_full_resolution_at_any_distance() {
    let (document, _) = gltf_of(&tree_file(&tree(false)));
    let mut seen = BTreeSet::new();
    for material in document.materials() {
        let filter = |texture: gltf::Texture<'_>| texture.sampler().min_filter();
        let colors =
            material.pbr_metallic_roughness().base_color_texture().map(|info| filter(info.texture()));
        let expected = match material.alpha_mode() {
            gltf::material::AlphaMode::Mask => gltf::texture::MinFilter::Linear,
            _ => gltf::texture::MinFilter::LinearMipmapLinear,
        };
        assert_eq!(colors, Some(Some(expected)), "{:?}", material.name());
        seen.insert(expected.as_gl_enum());
    }
    assert_eq!(seen.len(), 2, "bark and leaves");
}

#[test]
fn babylon_never_replaces_a_level_whose_material_alone_lets_light_through() {
    let pictures = impostor();
    let clusters = Clusters { colors: pictures.colors, normals: pictures.relief };
    let pictures = TreePictures { impostor: None, clusters: Some(&clusters) };
    let glb = tree_glb("tree", &tree(false), &images(&tree_images()), &pictures).unwrap();
    let (document, _) = gltf_of(&glb);
    let lets_light_through = |name: &str| {
        let material = document.materials().find(|material| material.name() == Some(name));
        material.unwrap().extension_value(KHR_MATERIALS_DIFFUSE_TRANSMISSION).is_some()
    };
    assert!(lets_light_through("leaf") && !lets_light_through("clusters"));
}

#[test]
fn only_water_and_bark_mirror_the_sky() {
    let (_, bytes) = scene(3);
    let json: Value = serde_json::from_slice(&bytes).unwrap();
    let shiny = |material: &&Value| material["extensions"]["KHR_materials_specular"]["specularFactor"] != 0;
    let materials = json["materials"].as_array().unwrap();
    let names: BTreeSet<&str> =
        materials.iter().filter(shiny).filter_map(|material| material["name"].as_str()).collect();
    assert_eq!(names, BTreeSet::from(["bark", "water"]));
    let named = |name: &Value| name == "KHR_materials_specular";
    assert!(json["extensionsUsed"].as_array().unwrap().iter().any(named));
}

#[test]
fn bad_input_is_an_error() {
    let good = tree(false);
    let pictures = tree_images();
    let glb = |tree: &LevelledMesh| tree_glb("tree", tree, &images(&pictures), &TreePictures::default());
    let empty = LevelledMesh { levels: Vec::new(), progressive: Vec::new(), coverage: None };
    assert!(matches!(glb(&empty), Err(ExportError::Empty(_))));
    let mut nan = good.clone();
    nan.levels[0].mesh.positions[3][1] = f32::NAN;
    assert!(matches!(glb(&nan), Err(ExportError::NotFinite(_))));
    let mut beyond = good.clone();
    beyond.levels[0].mesh.parts[0].triangles[0][0] = u32::MAX;
    assert!(matches!(glb(&beyond), Err(ExportError::Inconsistent(..))));
    let mut short = good.clone();
    short.levels[0].mesh.uvs.pop();
    assert!(matches!(glb(&short), Err(ExportError::Inconsistent(..))));

    let mut synthetic = synthetic(3);
    synthetic.placement.instances[1].world_from_tree[0] = [-1.0, 0.0, 0.0, 0.0];
    synthetic.placement.instances[1].world_from_tree[1] = [0.0, 1.0, 0.0, 0.0];
    synthetic.placement.instances[1].world_from_tree[2] = [0.0, 0.0, 1.0, 0.0];
    assert!(matches!(scene_gltf(&synthetic.parts()), Err(ExportError::Transform(..))));
    synthetic.placement.instances[1].template = 9;
    assert!(matches!(scene_gltf(&synthetic.parts()), Err(ExportError::Template(..))));
    synthetic.terrain.truncate(30);
    assert!(matches!(scene_gltf(&synthetic.parts()), Err(ExportError::NotGltf(..))));
}

#[test]
fn foreign_materials_pass_through() {
    let triangle = Mesh {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        parts: vec![crate::model::Part {
            material: Material::Foreign(1),
            kind: crate::model::PartKind::Surface,
            triangles: vec![[0, 1, 2]],
        }],
        ..Mesh::default()
    };
    let level = crate::model::Level { mesh: triangle, morph: None, error_m: 0.0, strips: Vec::new() };
    let mesh = LevelledMesh { levels: vec![level], progressive: Vec::new(), coverage: None };
    let set = MaterialSet {
        slots: vec![Material::Foreign(0), Material::Foreign(1)],
        materials: vec![
            serde_json::json!({ "name": "a", "extensions": { "KHR_materials_unlit": {} } }),
            serde_json::json!({ "name": "b", "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }),
        ],
        textures: vec![serde_json::json!({ "source": 0 })],
        images: vec![("lost".into(), Picture::Embedded { bytes: &[], mime_type: "" })],
        ..MaterialSet::default()
    };
    let (document, bin) = gltf_of(&levelled_glb("thing", &mesh, &set, None).unwrap());
    assert!(document.extensions_used().any(|name| name == "KHR_materials_unlit"));
    let gltf::image::Source::View { view, mime_type } = document.images().next().unwrap().source() else {
        panic!("images are embedded");
    };
    assert_eq!(mime_type, "image/png");
    let png = std::io::Cursor::new(&bin[view.offset()..view.offset() + view.length()]);
    assert_eq!(::png::Decoder::new(png).read_info().unwrap().info().size(), (1, 1));
    let primitive = document.meshes().next().unwrap().primitives().next().unwrap();
    assert_eq!(primitive.material().name(), Some("b"));
}
