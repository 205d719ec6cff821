//! Small inputs for the tests: a tree of two levels, rolling land with a lake, sheared instances, plain pictures.

use std::collections::BTreeMap;

use glam::Vec3;
use serde_json::json;

use genescape_schema::scene::{GroundSurface, Resource, SkyImages, write_instances};

use super::*;
use crate::model::TreeFootprint;
use crate::model::{
    CloudLayer, GroundDetail, Heightfield, Image8, Impostor, Instance, Landform, Level, LevelledMesh,
    Material, Mesh, Morph, Part, PartKind, Placement, SkyLight, TerrainMesh, TreeTextures,
};
use crate::noise::{gradient2, hash01};
use crate::stages::start::first_look;

/// Of the two templates.
const FOOTPRINTS: [TreeFootprint; 2] = [TreeFootprint {
    height_m: 8.0,
    trunk_radius_m: 0.3,
    crown_radius_m: 3.0,
    root_depth_m: 0.2,
    clear_trunk: 0.2,
}; 2];

/// Files by URI, as the cache would hold them.
#[derive(Default)]
pub struct Files(pub BTreeMap<String, Vec<u8>>);

impl Files {
    pub fn add(&mut self, name: &str, bytes: Vec<u8>) -> Blob {
        let blob = Blob { uri: format!("blobs/{name}"), byte_length: bytes.len() };
        self.0.insert(blob.uri.clone(), bytes);
        blob
    }

    pub fn resolve(&self, uri: &str) -> Result<Vec<u8>, String> {
        self.0.get(uri).cloned().ok_or_else(|| "not there".into())
    }
}

pub fn png(side: u32, channels: u32, sixteen: bool, value: impl Fn(u32, u32, u32) -> f32) -> Vec<u8> {
    let mut out = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut out, side, side);
    encoder.set_color(match channels {
        1 => ::png::ColorType::Grayscale,
        3 => ::png::ColorType::Rgb,
        _ => ::png::ColorType::Rgba,
    });
    encoder.set_depth(if sixteen { ::png::BitDepth::Sixteen } else { ::png::BitDepth::Eight });
    let mut data = Vec::new();
    for (y, x) in (0..side).flat_map(|y| (0..side).map(move |x| (y, x))) {
        for c in 0..channels {
            let v = value(x, y, c).clamp(0.0, 1.0);
            if sixteen {
                data.extend_from_slice(&((v * 65535.0) as u16).to_be_bytes());
            } else {
                data.push((v * 255.0) as u8);
            }
        }
    }
    encoder.write_header().unwrap().write_image_data(&data).unwrap();
    out
}

const SIDES: u32 = 8;

/// A tapering trunk of `rings` rings `step` apart in height, and cards around its upper half.
fn tree_level(rings: &[f32], cards: &[(u32, f32)]) -> Mesh {
    let mut mesh = Mesh::default();
    for &y in rings {
        for k in 0..=SIDES {
            let angle = k as f32 * core::f32::consts::TAU / SIDES as f32;
            let out = Vec3::new(libm::cosf(angle), 0.0, -libm::sinf(angle));
            mesh.positions.push((out * (0.25 * (1.0 - y / 7.0)) + Vec3::Y * y).to_array());
            mesh.normals.push(out.to_array());
            mesh.uvs.push([k as f32 / SIDES as f32, y]);
            mesh.colors.push([255, 255, 255, 255]);
        }
    }
    let mut bark = Vec::new();
    for r in 0..rings.len() as u32 - 1 {
        for k in 0..SIDES {
            let a = r * (SIDES + 1) + k;
            let b = a + SIDES + 1;
            bark.extend([[a, a + 1, b + 1], [a, b + 1, b]]);
        }
    }
    let mut leaves = Vec::new();
    for &(card, size) in cards {
        let first = mesh.positions.len() as u32;
        let [x, y, z] = [1, 2, 3].map(|i| hash01(7, card as i32, i, 0));
        let middle = Vec3::new(3.0 * x - 1.5, 2.0 + 4.0 * y, 3.0 * z - 1.5);
        let normal = Vec3::new(middle.x, middle.y - 4.0, middle.z).normalize();
        let right = Vec3::Y.cross(normal).normalize();
        let up = normal.cross(right) * 0.3 * size;
        let right = right * 0.3 * size;
        for (u, v) in [(0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0)] {
            mesh.positions.push((middle + right * (2.0 * u - 1.0) - up * (2.0 * v - 1.0)).to_array());
            mesh.normals.push(normal.to_array());
            mesh.uvs.push([u, v]);
            mesh.colors.push([200, 255, 180, 255]);
        }
        leaves.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    mesh.parts = vec![
        Part { material: Material::Bark, kind: PartKind::Surface, triangles: bark },
        Part {
            material: Material::Leaf,
            kind: PartKind::Aggregate { vertices: 4, triangles: 2 },
            triangles: leaves,
        },
    ];
    mesh
}

/// Strips of degenerate triangles: right, if long.
fn strips(mesh: &Mesh) -> Vec<Vec<u32>> {
    let strip = |part: &Part| part.triangles.iter().flat_map(|&[a, b, c]| [a, a, b, c, c, c]).collect();
    mesh.parts.iter().map(strip).collect()
}

/// D_1 has half the rings and half the cards of D_0; cards that stay grow, those that go shrink to their middles.
/// `still` many of the cards do neither, so that deltas are mostly 0 and written sparsely.
pub fn tree(still: bool) -> LevelledMesh {
    let (fine, coarse) = ([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0], [0.0, 2.0, 4.0, 6.0]);
    let all: Vec<(u32, f32)> = (0..200).map(|card| (card, 1.0)).collect();
    let goes = |card: u32| if still { card < 8 } else { card % 2 == 1 };
    let grown = if still { 1.0 } else { 1.4 };
    let some: Vec<(u32, f32)> = all.iter().filter(|(c, _)| !goes(*c)).map(|&(c, _)| (c, grown)).collect();
    let (d0, d1) = (tree_level(&fine, &all), tree_level(&coarse, &some));
    // Where each vertex of D_0 goes in D_1.
    let target = tree_level(
        &fine.map(|y| y - y % 2.0),
        &all.iter().map(|&(c, _)| (c, if goes(c) { 0.0 } else { grown })).collect::<Vec<_>>(),
    );
    let mut morph = Morph::default();
    let difference = |a: [f32; 3], b: [f32; 3]| [0, 1, 2].map(|i| a[i] - b[i]);
    for i in 0..d0.positions.len() {
        morph.positions.push(difference(target.positions[i], d0.positions[i]));
        morph.normals.push(difference(target.normals[i], d0.normals[i]));
        morph.uvs.push([target.uvs[i][0] - d0.uvs[i][0], target.uvs[i][1] - d0.uvs[i][1]]);
    }
    let level = |mesh: Mesh, morph, error_m| Level { strips: strips(&mesh), mesh, morph, error_m };
    LevelledMesh {
        levels: vec![level(d0, Some(morph), 0.01), level(d1, None, 0.1)],
        progressive: (0..101).collect(),
        coverage: Some(0.25),
    }
}

pub fn landform() -> Landform {
    let field = |side: u32, spacing_m: f32| {
        let last = (side - 1) as f32;
        let at = |i: u32| (i as f32 - 0.5 * last) * spacing_m;
        let height = |x: f32, z: f32| 60.0 * gradient2(3, x / 300.0, z / 300.0, 0) + 20.0;
        let heights_m = (0..side * side).map(|n| height(at(n % side), at(n / side))).collect();
        Heightfield { side, spacing_m, heights_m }
    };
    let bare = Landform::bare(field(65, 16.0), field(65, 64.0));
    Landform { water_level_m: Some(8.0), snow_line_m: 1000.0, ..bare }
}

/// A grid mesh, of all cells (`hole` false) or those outside the middle quarter of the width.
fn grid(field: &Heightfield, hole: bool) -> Mesh {
    let mut mesh = Mesh::default();
    let extent = field.extent_m();
    for j in 0..field.side {
        for i in 0..field.side {
            let at = |i: u32| (i as f32 - 0.5 * (field.side - 1) as f32) * field.spacing_m;
            mesh.positions.push([at(i), field.at(i, j), at(j)]);
            mesh.normals.push(field.normal_at(i, j).to_array());
            mesh.uvs.push([at(i) / extent + 0.5, at(j) / extent + 0.5]);
            if hole {
                mesh.colors.push([60, 80, 40, 255]);
            }
        }
    }
    let (lo, hi) = (field.side / 8 * 3, field.side / 8 * 5);
    let inside = |i: u32| hole && (lo..hi).contains(&i);
    let mut triangles = Vec::new();
    for (j, i) in (0..field.side - 1).flat_map(|j| (0..field.side - 1).map(move |i| (j, i))) {
        if !(inside(i) && inside(j)) {
            let a = j * field.side + i;
            let b = a + field.side;
            triangles.extend([[a, b, a + 1], [a + 1, b, b + 1]]);
        }
    }
    mesh.parts = vec![Part { material: Material::Ground, kind: PartKind::Surface, triangles }];
    mesh
}

pub fn terrain(land: &Landform) -> TerrainMesh {
    let level = land.water_level_m.unwrap();
    let corner = |x: f32, z: f32| [x * 2000.0, level, z * 2000.0];
    let water = Mesh {
        positions: vec![corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)],
        normals: vec![[0.0, 1.0, 0.0]; 4],
        uvs: vec![[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]],
        colors: Vec::new(),
        parts: vec![Part {
            material: Material::Water,
            kind: PartKind::Surface,
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        }],
    };
    TerrainMesh {
        near: grid(&land.field, false),
        apron: grid(&land.apron, true),
        apron_weights: Vec::new(),
        water,
        error_m: 0.5,
    }
}

/// Turned, stretched and sheared instances on dry land.
pub fn placement(land: &Landform, count: u32) -> Placement {
    let mut instances = Vec::new();
    for i in 0..20 * count as i32 {
        let r = |axis: i32| hash01(11, i, axis, 0);
        let (x, z) = (600.0 * r(0) - 300.0, 600.0 * r(1) - 300.0);
        let y = land.field.height_m(x, z);
        if y < land.water_level_m.unwrap() + 1.0 || instances.len() >= count as usize {
            continue;
        }
        let turn = glam::Mat3::from_rotation_y(core::f32::consts::TAU * r(2));
        let shear = glam::Mat3::from_cols(
            Vec3::new(1.0 + 0.5 * r(3), 0.0, 0.2 * r(4)),
            Vec3::new(0.3 * r(5) - 0.15, 1.0 + r(6), 0.3 * r(7) - 0.15),
            Vec3::new(0.0, 0.0, 0.8 + 0.5 * r(8)),
        );
        let a = shear * turn;
        let row = |k: usize, t: f32| [a.col(0)[k], a.col(1)[k], a.col(2)[k], t];
        instances.push(Instance {
            template: i as u32 % 2,
            world_from_tree: [row(0, x), row(1, y), row(2, z)],
            trunk_cylinder_m: [x, z, 0.3],
        });
    }
    Placement { instances, per_m2: 0.01 }
}

fn exr(width: usize, height: usize, sun: Vec3) -> Vec<u8> {
    let pixel = |x: usize, y: usize| {
        let azimuth = ((x as f32 + 0.5) / width as f32 - 0.5) * core::f32::consts::TAU;
        let elevation = (0.5 - (y as f32 + 0.5) / height as f32) * core::f32::consts::PI;
        let (s, c) = (libm::sinf(elevation), libm::cosf(elevation));
        let look = Vec3::new(libm::sinf(azimuth) * c, s, -libm::cosf(azimuth) * c);
        let glow = 0.5 * libm::powf(look.dot(sun).max(0.0), 30.0);
        let t = s.max(0.0);
        (0.55 - 0.4 * t + glow, 0.65 - 0.35 * t + glow, 0.75 - 0.1 * t + 0.8 * glow)
    };
    let channels =
        ::exr::prelude::SpecificChannels::rgb(|at: ::exr::prelude::Vec2<usize>| pixel(at.x(), at.y()));
    let image = ::exr::prelude::Image::from_channels((width, height), channels);
    let mut out = std::io::Cursor::new(Vec::new());
    ::exr::prelude::WritableImage::write(&image).to_buffered(&mut out).unwrap();
    out.into_inner()
}

/// A whole scene's inputs, owned.
pub struct Synthetic {
    pub land: Landform,
    pub placement: Placement,
    pub light: SkyLight,
    pub trees: Vec<Vec<u8>>,
    pub terrain: Vec<u8>,
    pub files: Files,
}

pub fn tree_images() -> [Vec<u8>; 3] {
    let spot = |x: u32, y: u32| (hash01(5, x as i32, y as i32, 0) - 0.5) * 0.1;
    let bark = png(64, 3, false, |x, y, c| [0.35, 0.26, 0.18][c as usize] + spot(x, y));
    let normal = png(64, 3, false, |x, y, c| if c == 2 { 1.0 } else { 0.5 + spot(x + c, y) });
    let leaf = png(64, 4, false, |x, y, c| {
        let (dx, dy) = (x as f32 / 31.5 - 1.0, y as f32 / 31.5 - 1.0);
        if c == 3 { (1.2 - dx * dx * 2.0 - dy * dy) * 4.0 } else { [0.2, 0.4, 0.1][c as usize] }
    });
    [bark, normal, leaf]
}

/// Pictures of one colour each.
pub fn impostor() -> Impostor {
    let mut colors = Image8::new(32, 8, 4);
    for (i, pixel) in colors.data.chunks_exact_mut(4).enumerate() {
        pixel.copy_from_slice(&[0, 60 * (i as u8 % 32 / 8), 30, 255]);
    }
    let relief = Image8::new(32, 8, 3);
    Impostor { colors, relief, axis_m: [0.1, -0.3], low_m: -0.4, size_m: [5.0, 8.5], error_m: 0.13 }
}

pub fn synthetic(count: u32) -> Synthetic {
    let land = landform();
    let mut files = Files::default();
    let [bark, normal, leaf] = tree_images();
    let embedded = |bytes| Picture::Embedded { bytes, mime_type: "image/png" };
    let images = TreeTextures {
        bark_color: embedded(&bark),
        bark_normal: embedded(&normal),
        leaf: vec![embedded(&leaf)],
        blossom: Vec::new(),
        bark_linear: [0.1; 3],
        is_thin: false,
        leaf_small: Image8::default(),
        blossom_small: Image8::default(),
        alpha_cutoff: 0.5,
    };
    let trees: Vec<_> = [false, true]
        .iter()
        .enumerate()
        .map(|(i, &s)| {
            tree_glb(
                &format!("tree-{i}"),
                &tree(s),
                &images,
                &TreePictures { impostor: Some(&impostor()), clusters: None },
            )
            .unwrap()
        })
        .collect();
    for (i, glb) in trees.iter().enumerate() {
        files.add(&format!("tree-{i}.glb"), glb.clone());
    }
    let terrain = terrain_glb(&terrain(&land)).unwrap();
    files.add("terrain.glb", terrain.clone());
    let placement = placement(&land, count);
    let sun = Vec3::new(0.6, 0.5, 0.5).normalize();
    let light = SkyLight {
        sun_direction: sun,
        sun_angular_radius_rad: 0.0047,
        sun_irradiance_linear: [3.2, 2.9, 2.4],
        sky_irradiance_linear: [0.5, 0.7, 1.0],
        zonal_radiance_linear: vec![[0.5, 0.6, 0.7], [0.2, 0.3, 0.5]],
        haze_linear: [0.5, 0.6, 0.7],
        haze_extinction_per_m: 0.0002,
        exposure: 1.0,
    };
    for (name, bytes) in [
        ("bark.png", bark.clone()),
        ("bark-normal.png", normal.clone()),
        ("leaf.png", leaf.clone()),
        ("leaf-1.png", leaf.clone()),
        ("instances.bin", write_instances(&placement.instances)),
        ("far-trees.bin", write_instances(&placement.instances[..1])),
        ("lod.bin", vec![7; 100]),
        ("sky.exr", exr(128, 64, sun)),
        ("face.exr", exr(8, 8, sun)),
        ("cloud.png", png(16, 4, false, |_, _, _| 0.8)),
        ("weights.png", png(16, 4, false, |_, _, _| 0.0)),
        ("heights.png", png(65, 1, true, |x, _, _| x as f32 / 64.0)),
        (
            "color.png",
            png(256, 3, false, |x, y, c| {
                [0.35, 0.40, 0.2][c as usize] + 0.1 * gradient2(9, x as f32 / 8.0, y as f32 / 8.0, 0)
            }),
        ),
        ("light.png", png(64, 3, false, |_, _, _| 1.0)),
        ("grass.png", png(64, 3, false, |_, _, _| 0.5)),
        (
            "grass-normal.png",
            png(64, 3, false, |x, y, c| {
                if c == 2 { 0.95 } else { 0.5 + 0.2 * gradient2(c, x as f32 / 8.0, y as f32 / 8.0, 8) }
            }),
        ),
    ] {
        files.add(name, bytes);
    }
    Synthetic { land, placement, light, trees, terrain, files }
}

impl Synthetic {
    pub fn blob(&self, name: &str) -> Blob {
        let uri = format!("blobs/{name}");
        Blob { byte_length: self.files.0[&uri].len(), uri }
    }

    pub fn parts(&self) -> SceneParts<'_> {
        let uri = |name: &str| self.blob(name).uri;
        let file = |name: &str| Picture::File { uri: uri(name), mipmaps: Vec::new() };
        let png = |name: &str| Resource::file(uri(name), "image/png");
        let exr = |name: &str| Resource::file(uri(name), "image/x-exr");
        let glb = |i: usize| GlbBlob { uri: format!("blobs/tree-{i}.glb"), bytes: &self.trees[i] };
        SceneParts {
            name: "g0000 scene-0".into(),
            genome: json!({ "height_m": 7.4, "relief_m": 120.0, "levels": 3 }),
            land: &self.land,
            terrain: GlbBlob { uri: "blobs/terrain.glb".into(), bytes: &self.terrain },
            foreground: None,
            view: first_look(&self.land, &self.placement.instances, &FOOTPRINTS, &self.light).view,
            heights: png("heights.png"),
            lod: Resource::file(uri("lod.bin"), "application/octet-stream"),
            surface: GroundSurface {
                color: png("color.png"),
                weights: png("weights.png"),
                light: png("light.png"),
                details: vec![GroundDetail {
                    name: "grass".into(),
                    detail: png("grass.png"),
                    normal: png("grass-normal.png"),
                    tile_m: 4.0,
                }],
                plants: Default::default(),
            },
            tiles: vec![png("grass.png")],
            templates: (0..self.trees.len()).map(glb).collect(),
            tree_images: TreeTextures {
                bark_color: file("bark.png"),
                bark_normal: file("bark-normal.png"),
                leaf: vec![file("leaf.png"), file("leaf-1.png")],
                blossom: Vec::new(),
                bark_linear: [0.1; 3],
                is_thin: false,
                leaf_small: Image8::default(),
                blossom_small: Image8::default(),
                alpha_cutoff: 0.5,
            },
            trees: &self.placement.instances,
            instances: self.blob("instances.bin"),
            far_trees: self.blob("far-trees.bin"),
            light: &self.light,
            sky: SkyImages {
                equirect: exr("sky.exr"),
                faces: vec![exr("face.exr"); 6],
                clear_faces: vec![exr("face.exr"); 6],
                layers: vec![CloudLayer {
                    name: "cumulus".into(),
                    altitude_m: 1200.0,
                    extent_m: 8000.0,
                    image: png("cloud.png"),
                }],
            },
        }
    }
}
