//! Files of other programs: what must come through, what must be refused, and that nothing panics.

use std::io;

use serde_json::{Value, json};

use super::{ImportError, Imported, Repair, read_mesh};
use crate::model::{Material, Mesh, PartKind};
use crate::stages::lod::progressive::reader;
use crate::stages::lod::{LodOptions, levels};

fn nothing(name: &str) -> io::Result<Vec<u8>> {
    Err(io::Error::new(io::ErrorKind::NotFound, format!("no {name}")))
}

/// A .glb of one primitive with the given positions and indices and some changes to its JSON.
fn glb(positions: &[[f32; 3]], indices: &[u16], change: impl Fn(&mut Value)) -> Vec<u8> {
    let mut bin: Vec<u8> = positions.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    let split = bin.len();
    bin.extend(indices.iter().flat_map(|i| i.to_le_bytes()));
    let indices_len = bin.len() - split;
    bin.resize(bin.len().next_multiple_of(4), 0);
    let mut root = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "translation": [0.0, 1.0, 0.0] }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": positions.len(), "type": "VEC3",
              "min": [-1e9, -1e9, -1e9], "max": [1e9, 1e9, 1e9] },
            { "bufferView": 1, "componentType": 5123, "count": indices.len(), "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": split },
            { "buffer": 0, "byteOffset": split, "byteLength": indices_len },
        ],
        "buffers": [{ "byteLength": bin.len() }],
    });
    change(&mut root);
    let mut text = root.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut out = b"glTF".to_vec();
    for word in [2, (28 + text.len() + bin.len()) as u32, text.len() as u32] {
        out.extend(word.to_le_bytes());
    }
    out.extend(b"JSON");
    out.extend(text);
    out.extend((bin.len() as u32).to_le_bytes());
    out.extend(b"BIN\0");
    out.extend(bin);
    out
}

const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

fn read_glb(bytes: &[u8]) -> Result<Imported, ImportError> {
    read_mesh(bytes, "GLB", &nothing)
}

#[test]
fn a_glb_comes_in_where_its_node_puts_it() {
    let read = read_glb(&glb(&SQUARE, &[0, 1, 2, 0, 2, 3], |_| {})).unwrap();
    assert_eq!(read.mesh.positions[2], [1.0, 2.0, 0.0]);
    assert_eq!(read.mesh.parts[0].triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(read.mesh.parts[0].material, Material::Foreign(0));
    assert_eq!(read.materials.len(), 1);
    assert_eq!(read.repairs, [Repair::MissingNormals(1)]);
}

#[test]
fn a_mirrored_node_keeps_its_outside_outside() {
    let mirror = |root: &mut Value| root["nodes"][0] = json!({ "mesh": 0, "scale": [-1.0, 1.0, 1.0] });
    let read = read_glb(&glb(&SQUARE, &[0, 1, 2, 0, 2, 3], mirror)).unwrap();
    assert_eq!(read.mesh.parts[0].triangles[0], [0, 2, 1]);
}

#[test]
fn strips_and_fans_become_triangles_and_lines_are_skipped() {
    for (mode, order) in [(5, [0_u16, 1, 3, 2]), (6, [0, 1, 2, 3])] {
        let change = |root: &mut Value| root["meshes"][0]["primitives"][0]["mode"] = json!(mode);
        let read = read_glb(&glb(&SQUARE, &order, change)).unwrap();
        assert_eq!(read.mesh.triangle_count(), 2);
        assert!(read.repairs.contains(&Repair::ConvertedPrimitives(1)));
        let normals: Vec<f32> = read.mesh.parts[0].triangles.iter().map(|t| facing(&read.mesh, t)).collect();
        assert!(normals.iter().all(|&z| z > 0.0), "{normals:?}");
    }
    let lines = |root: &mut Value| root["meshes"][0]["primitives"][0]["mode"] = json!(1);
    assert!(matches!(read_glb(&glb(&SQUARE, &[0, 1], lines)), Err(ImportError::Empty(_))));
}

fn facing(mesh: &Mesh, t: &[u32; 3]) -> f32 {
    let [p, q, r] = t.map(|v| glam::Vec3::from_array(mesh.positions[v as usize]));
    (q - p).cross(r - p).z
}

#[test]
fn bad_geometry_is_taken_out_and_said() {
    let mut points = SQUARE.to_vec();
    points.push([f32::NAN, 0.0, 0.0]);
    points.push([9.0, 9.0, 9.0]);
    let indices = [0, 1, 2, 0, 2, 3, 0, 1, 4, 0, 0, 1, 0, 1, 77];
    let read = read_glb(&glb(&points, &indices, |_| {})).unwrap();
    assert_eq!(read.mesh.triangle_count(), 2);
    assert_eq!(read.mesh.positions.len(), 4);
    for repair in [
        Repair::NonFiniteVertices(1),
        Repair::DegenerateTriangles(1),
        Repair::IndexOutOfRange(1),
        Repair::UnusedVertices(1),
    ] {
        assert!(read.repairs.contains(&repair), "{repair} in {:?}", read.repairs);
    }
    let three = [0, 1, 2, 1, 0, 3, 0, 1, 3];
    let read = read_glb(&glb(&SQUARE, &three, |_| {})).unwrap();
    assert!(read.repairs.contains(&Repair::NonManifoldEdges(1)), "{:?}", read.repairs);
}

#[test]
fn what_cannot_be_read_is_refused_in_words() {
    let refused = |change: &dyn Fn(&mut Value)| {
        read_glb(&glb(&SQUARE, &[0, 1, 2], change)).expect_err("refused").to_string()
    };
    let text = refused(&|root| root["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]));
    assert!(text.contains("KHR_draco_mesh_compression"), "{text}");
    let text = refused(&|root| root["buffers"][0]["uri"] = json!("lost%20one.bin"));
    assert!(text.contains("lost one.bin"), "{text}");
    let text = refused(&|root| root["accessors"][0]["count"] = json!(4_000_000_000_u32));
    assert!(text.contains("positions"), "{text}");
    let text = refused(&|root| root["meshes"][0]["primitives"][0]["attributes"] = json!({ "NORMAL": 0 }));
    assert!(text.contains("no triangle"), "{text}");
    assert!(matches!(read_mesh(b"", "fbx", &nothing), Err(ImportError::Extension(_))));
    assert!(read_mesh(b"", "obj", &nothing).is_err());
    assert!(read_mesh(b"", "gltf", &nothing).is_err());
}

#[test]
fn a_glb_of_impossible_length_is_refused() {
    for length in [0_u32, 11, u32::MAX] {
        let mut bytes = glb(&SQUARE, &[0, 1, 2], |_| {});
        bytes[8..12].copy_from_slice(&length.to_le_bytes());
        let error = read_glb(&bytes).expect_err("refused").to_string();
        assert!(error.contains("not a sound GLB file"), "{error}");
    }
}

#[test]
fn attributes_come_through_or_are_left_out_and_said() {
    let all_from_positions = |root: &mut Value| {
        root["meshes"][0]["primitives"][0]["attributes"] =
            json!({ "POSITION": 0, "NORMAL": 0, "COLOR_0": 0, "TEXCOORD_0": 0 });
    };
    let read = read_glb(&glb(&SQUARE, &[0, 1, 2, 0, 2, 3], all_from_positions)).unwrap();
    assert_eq!(read.mesh.normals[1], [1.0, 0.0, 0.0]);
    assert_eq!(read.mesh.colors[2], [255, 255, 0, 255]);
    assert_eq!(read.mesh.uvs, [[0.0; 2]; 0], "three numbers are no texture coordinates");
    assert_eq!(read.repairs, [Repair::AttributeMismatch("TEXCOORD_0".to_owned())]);
}

#[test]
fn parts_that_lack_attributes_get_neutral_ones() {
    let two_primitives = |root: &mut Value| {
        root["meshes"][0]["primitives"] = json!([
            { "attributes": { "POSITION": 0, "NORMAL": 0, "COLOR_0": 0 }, "indices": 1 },
            { "attributes": { "POSITION": 0 }, "indices": 1 },
        ]);
    };
    let read = read_glb(&glb(&SQUARE, &[0, 1, 2], two_primitives)).unwrap();
    assert_eq!(read.mesh.colors.len(), 6, "three vertices of each are used");
    assert_eq!(read.mesh.colors[3..], [[255; 4]; 3]);
    assert_eq!(read.mesh.normals, [[0.0; 3]; 0], "none, where one part lacks them");
    assert_eq!(read.mesh.parts[0].triangles, [[0, 1, 2], [3, 4, 5]]);
    assert!(read.repairs.contains(&Repair::MissingNormals(1)));
}

#[test]
fn nodes_in_a_circle_end() {
    let circle = |root: &mut Value| {
        root["nodes"] = json!([{ "mesh": 0, "children": [1] }, { "children": [0] }]);
    };
    let read = read_glb(&glb(&SQUARE, &[0, 1, 2], circle));
    assert!(read.is_err() || read.unwrap().mesh.triangle_count() == 1);
}

#[test]
fn gltf_with_a_data_uri_and_a_material() {
    let text = json!({
        "asset": { "version": "2.0" },
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "material": 0 }] }],
        "materials": [{ "name": "m", "pbrMetallicRoughness": { "roughnessFactor": 0.25 } }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
            "min": [0, 0, 0], "max": [1, 1, 0] }],
        "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
        "buffers": [{ "byteLength": 36, "uri":
            "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA" }],
    });
    let read = read_mesh(text.to_string().as_bytes(), "gltf", &nothing).unwrap();
    assert_eq!(read.mesh.positions, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(read.materials[0]["pbrMetallicRoughness"]["roughnessFactor"], 0.25);
}

const OBJ: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n\
    usemtl red\nf 1/1/1 2/2/1 3/3/1 4/4/1\n";

#[test]
fn obj_polygons_and_materials() {
    let files = |name: &str| match name {
        "a.mtl" => Ok(b"newmtl red\nKd 1 0 0\nmap_Kd gone.png\n".to_vec()),
        other => nothing(other),
    };
    let read = read_mesh(OBJ.as_bytes(), "obj", &files).unwrap();
    assert_eq!((read.mesh.triangle_count(), read.mesh.positions.len()), (2, 4));
    assert_eq!(read.mesh.normals.len(), 4);
    let corner = read.mesh.positions.iter().position(|&p| p == [0.0; 3]).unwrap();
    assert_eq!(read.mesh.uvs[corner], [0.0, 1.0]);
    assert_eq!(read.materials[0]["name"], "red");
    assert!(read.repairs.contains(&Repair::MissingFile("gone.png".to_owned())));
}

#[test]
fn many_cards_are_an_aggregate() {
    let mut text = String::new();
    for k in 0..80 {
        text += &format!("v {k} 0 0\nv {k} 1 0\nv {k} 1 1\nv {k} 0 1\nf -4 -3 -2 -1\n");
    }
    let read = read_mesh(text.as_bytes(), "obj", &nothing).unwrap();
    assert_eq!(read.mesh.parts[0].kind, PartKind::Aggregate { vertices: 4, triangles: 2 });
    assert!(read.repairs.contains(&Repair::FoundAggregate(80)));
}

#[test]
fn damaged_files_never_panic() {
    let good = glb(&SQUARE, &[0, 1, 2, 0, 2, 3], |_| {});
    let try_both = |bytes: &[u8], extension: &str| {
        if let Ok(read) = read_mesh(bytes, extension, &nothing) {
            let count = read.mesh.positions.len() as u32;
            assert!(read.mesh.parts.iter().flat_map(|p| &p.triangles).flatten().all(|&v| v < count));
        }
    };
    for (good, extension) in [(good.as_slice(), "glb"), (OBJ.as_bytes(), "obj")] {
        for length in 0..good.len() {
            try_both(&good[..length], extension);
        }
        for at in 0..good.len() {
            for flip in [0x01, 0x10, 0x80, 0xFF] {
                let mut broken = good.to_vec();
                broken[at] ^= flip;
                try_both(&broken, extension);
            }
        }
    }
}

/// One of the public test meshes.
fn data(name: &str) -> Mesh {
    let beside = || concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data").to_owned();
    let path = format!("{}/{name}", std::env::var("GENESCAPE_DATA").unwrap_or_else(|_| beside()));
    let bytes = std::fs::read(&path).unwrap_or_else(|error| panic!("{path}, see GENESCAPE_DATA: {error}"));
    read_mesh(&bytes, "obj", &nothing).unwrap().mesh
}

#[test]
#[ignore = "reads public meshes in the folder GENESCAPE_DATA: `cargo xtask test` runs it where they are"]
#[expect(clippy::print_stdout, reason = "prints figures")]
fn real_meshes_keep_their_shape() {
    for name in ["spot.obj", "rocker-arm.obj", "stanford-bunny.obj"] {
        let mesh = data(name);
        let made = levels(&mesh, &LodOptions::default());
        assert_eq!(reader::decode(&made.progressive).unwrap().rebuild(usize::MAX), mesh, "{name}");
        let bounds = mesh.bounds();
        let diagonal = (bounds.max - bounds.min).length();
        for level in &made.levels {
            let far = distance(&mesh, &level.mesh) / diagonal;
            let stated = level.error_m / diagonal;
            println!(
                "{name}: {:6} vertices {:6} triangles, error {:.3} %, from samples {:.3} % of the diagonal",
                level.mesh.positions.len(),
                level.mesh.triangle_count(),
                100.0 * stated,
                100.0 * far
            );
            let most = match level.mesh.positions.len() {
                0..150 => 0.08,
                150..450 => 0.03,
                _ => 0.01,
            };
            assert!(far < most, "{name}: {far}");
        }
        assert!(made.levels.len() > 4, "{name}");
    }
}

/// The greatest of sampled distances from a mesh's vertices to another's triangles, in metres.
fn distance(mesh: &Mesh, other: &Mesh) -> f32 {
    let at = |v: u32| glam::Vec3::from_array(other.positions[v as usize]);
    let triangles: Vec<_> = other.parts.iter().flat_map(|p| &p.triangles).map(|t| t.map(at)).collect();
    let samples = mesh.positions.iter().step_by((mesh.positions.len() / 150).max(1));
    let nearest = |p: &[f32; 3]| {
        let p = glam::Vec3::from_array(*p);
        triangles.iter().map(|t| closest(p, *t).distance_squared(p)).fold(f32::MAX, f32::min)
    };
    samples.map(nearest).fold(0.0, f32::max).sqrt()
}

/// The point of a triangle nearest to p (Ericson, "Real-time collision detection", 5.1.5).
fn closest(p: glam::Vec3, [a, b, c]: [glam::Vec3; 3]) -> glam::Vec3 {
    let on = |a: glam::Vec3, b: glam::Vec3| {
        let e = b - a;
        a + e * ((p - a).dot(e) / e.length_squared().max(1e-30)).clamp(0.0, 1.0)
    };
    let normal = (b - a).cross(c - a);
    let q = p - normal * ((p - a).dot(normal) / normal.length_squared().max(1e-30));
    let inside = |a: glam::Vec3, b: glam::Vec3| (b - a).cross(q - a).dot(normal) >= 0.0;
    if inside(a, b) && inside(b, c) && inside(c, a) {
        return q;
    }
    let candidates = [on(a, b), on(b, c), on(c, a)];
    candidates.into_iter().min_by(|x, y| x.distance_squared(p).total_cmp(&y.distance_squared(p))).unwrap_or(a)
}
