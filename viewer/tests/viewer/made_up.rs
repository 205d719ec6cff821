//! A landscape made up for tests, without files, and a device to draw it with.

use std::sync::Arc;

use genescape_bake::stages::terrain_lod;
use genescape_schema::scene::{Heightfield, SkyImages, SkyLight};
use genescape_viewer::headless::Headless;
use genescape_viewer::passes::Shaders;
use genescape_viewer::scene::{
    Apron, Crown, Ground, GroundDetail, GroundSurface, HdrImage, IMPOSTOR_ROWS, Image, Impostor, Instance,
    LEAVES, LeafSide, Level, Material, Range, Scene, Sky, StartView, Template, TerrainLod, TreeVertex, Trees,
};
use genescape_viewer::upload::{SceneBuffers, Uploader};
use glam::Vec3;
use image::RgbaImage;

/// A device to draw with.
pub fn studio() -> Headless {
    Headless::open(&Shaders::builtin(), 1)
        .expect("a Vulkan driver; on Debian and Ubuntu, mesa-vulkan-drivers has one in software")
}

/// Brings a landscape to the device, with shadows.
pub fn upload(studio: &Headless, scene: &Scene) -> Arc<SceneBuffers> {
    let buffers = Uploader::new(&studio.gpu).upload(scene).expect("a landscape that can be drawn");
    studio.passes.shadow.begin(&studio.gpu, &studio.passes, &buffers).all();
    Arc::new(buffers)
}

/// In [0, 1), of two coordinates and a seed.
pub fn hash(i: u32, j: u32, seed: u32) -> f32 {
    let mixed = i.wrapping_mul(0x9e37_79b9) ^ j.wrapping_mul(0x85eb_ca6b) ^ seed.wrapping_mul(0x27d4_eb2f);
    let mixed = (mixed ^ mixed >> 15).wrapping_mul(0xc2b2_ae35);
    ((mixed ^ mixed >> 13).wrapping_mul(0x27d4_eb2f) >> 8) as f32 / (1 << 24) as f32
}

/// Mean and standard deviation.
pub fn mean_and_spread(values: &[f32]) -> (f32, f32) {
    let count = values.len() as f32;
    let mean = values.iter().sum::<f32>() / count;
    (mean, (values.iter().map(|value| (value - mean) * (value - mean)).sum::<f32>() / count).sqrt())
}

/// The land whose sample (i, j) is `height_m(i, j)` high.
pub fn land(side: u32, spacing_m: f32, height_m: impl Fn(u32, u32) -> f32) -> TerrainLod {
    let heights_m = (0..side * side).map(|n| height_m(n % side, n / side)).collect();
    terrain_lod::lod(&Heightfield { side, spacing_m, heights_m })
}

/// Land with waves `relief_m` high and noise of `rough_m`.
pub fn field(side: u32, spacing_m: f32, relief_m: f32, rough_m: f32) -> TerrainLod {
    let height = |i: u32, j: u32| {
        let (x, z) = (i as f32 / side as f32, j as f32 / side as f32);
        let waves = libm::sinf(8.0 * x) * libm::cosf(6.0 * z) + 0.4 * libm::sinf(19.0 * (x + z));
        relief_m * 0.5 * waves + rough_m * hash(i, j, 1)
    };
    land(side, spacing_m, height)
}

/// A square picture.
pub fn picture(name: &str, side: u32, pixel: impl Fn(u32, u32) -> [u8; 4]) -> Image {
    let pixels: Vec<u8> = (0..side * side).flat_map(|n| pixel(n % side, n / side)).collect();
    Image { name: name.to_owned(), width_px: side, height_px: side, levels: vec![pixels.into()] }
}

/// Faces of one colour each, linear.
pub fn faces(name: &str, color: impl Fn(usize) -> [f32; 3]) -> Vec<HdrImage> {
    let face = |face| {
        let [r, g, b] = color(face);
        let halves = [r, g, b, 1.0].map(|value| half::f16::from_f32(value).to_le_bytes());
        let pixels: Arc<[u8]> = halves.as_flattened().into();
        HdrImage { name: format!("{name} {face}"), width_px: 1, height_px: 1, pixels }
    };
    (0..6).map(face).collect()
}

/// Pixels that two pictures do not share.
pub fn differing(a: &RgbaImage, b: &RgbaImage) -> usize {
    a.pixels().zip(b.pixels()).filter(|(a, b)| a != b).count()
}

/// A landscape: land in one colour, evenly lit, under an even sky.
pub fn scene(lod: TerrainLod, color: [u8; 4], sky: [f32; 3], trees: Trees) -> Scene {
    let plain = |name: &str, pixel: [u8; 4]| picture(name, 1, |_, _| pixel);
    let detail = |layer: u32| GroundDetail {
        name: format!("tile {layer}"),
        detail: plain(&format!("tile {layer}"), [128; 4]),
        normal: plain(&format!("normals {layer}"), [128, 128, 255, 255]),
        tile_m: 4.0,
    };
    Scene {
        name: "made up".to_owned(),
        ground: Ground {
            name: format!("field {} {:?}", lod.field.side, lod.range_m()),
            field: lod.field.clone(),
            lod: Arc::new(lod),
            water_level_m: None,
            surface: GroundSurface {
                color: plain(&format!("color {color:?}"), color),
                weights: plain("weights", [0; 4]),
                light: plain("light", [255; 4]),
                details: (0..5).map(detail).collect(),
                plants: Default::default(),
            },
            apron: Arc::new(Apron::default()),
        },
        trees,
        sky: Sky {
            images: SkyImages {
                equirect: (),
                faces: faces(&format!("sky {sky:?}"), |_| sky),
                clear_faces: faces(&format!("clear {sky:?}"), |_| sky),
                layers: Vec::new(),
            },
            light: SkyLight {
                sun_direction: Vec3::new(0.48, 0.64, 0.6),
                sun_angular_radius_rad: 0.0046,
                sun_irradiance_linear: [3.0; 3],
                sky_irradiance_linear: [0.6; 3],
                zonal_radiance_linear: Vec::new(),
                haze_linear: sky,
                haze_extinction_per_m: 0.0,
                exposure: 1.0,
            },
        },
        start: StartView { position_m: Vec3::ZERO, direction: Vec3::NEG_Z },
    }
}

/// A kind of tree whose meshes are stacks of cones, each level with half the sides of the one before, and with these
/// errors.
pub fn template(name: &str, errors_m: &[f32]) -> Template {
    let (mut vertices, mut indices, mut levels) = (Vec::new(), Vec::new(), Vec::new());
    for (number, &error_m) in errors_m.iter().enumerate() {
        let (base_vertex, first) = (vertices.len() as u32, indices.len() as u32);
        let sides = (24 >> number).max(3);
        for storey in 0..3u32 {
            let (low, high, wide) =
                (0.8 + 1.4 * storey as f32, 3.2 + 1.4 * storey as f32, 1.6 - 0.4 * storey as f32);
            let start = vertices.len() as u32 - base_vertex;
            for side in 0..sides {
                let (sin, cos) = libm::sincosf(side as f32 / sides as f32 * std::f32::consts::TAU);
                vertices.push(cone_vertex([wide * cos, low, wide * sin], [cos, sin]));
                let next = (side + 1) % sides;
                indices.extend([start + side, start + sides, start + next]);
            }
            vertices.push(cone_vertex([0.0, high, 0.0], [0.0, 0.0]));
        }
        let range = Range { first, count: indices.len() as u32 - first };
        levels.push(Level { error_m, base_vertex, ranges: vec![range], strips: Vec::new() });
    }
    Template {
        error_weight: 1.0,
        name: name.to_owned(),
        blob: name.to_owned(),
        vertices,
        indices,
        levels,
        materials: vec![Material {
            name: "needles".to_owned(),
            color: None,
            color_factor: [1.0; 4],
            normal: None,
            alpha_cutoff: None,
            thin: false,
            clusters: false,
        }],
        clusters: None,
        center_m: [0.0, 3.4, 0.0],
        radius_m: 3.1,
        impostor: None,
    }
}

/// A tree of one upright leaf, wide and high enough to fill a picture taken from up to 3 m south of it. The alpha of its colour
/// tells how open it is.
pub fn one_leaf(name: &str, color: [u8; 4]) -> Template {
    let corner = |[x, y]: [f32; 2]| TreeVertex { position_m: [x, y, 0.0], color, ..TreeVertex::default() };
    let mut tree = template(name, &[0.1]);
    tree.vertices = [[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]].map(corner).to_vec();
    tree.indices = vec![0, 1, 2, 0, 2, 3];
    tree.levels[0].ranges[0] = Range { first: 0, count: 6 };
    tree.materials[0].alpha_cutoff = Some(0.5);
    tree
}

/// Pictures of any such tree: green discs in front of the axis, with that error.
pub fn impostor(name: &str, error_m: f32) -> Impostor {
    let strip = |name: String, pixel: &dyn Fn(f32) -> [u8; 4]| {
        let disc = |n: u32| libm::hypotf((n % 128 % 32) as f32 - 15.5, (n / 128) as f32 - 15.5) / 12.0;
        let pixels: Vec<u8> = (0..128 * 32).flat_map(|n| pixel(disc(n))).collect();
        Image { name, width_px: 128, height_px: 32, levels: vec![pixels.into()] }
    };
    Impostor {
        color: strip(format!("{name} colour"), &|r| [60, 120, 50, if r < 1.0 { 255 } else { 0 }]),
        relief: strip(format!("{name} relief"), &|r| [160, 255, if r < 1.0 { 255 } else { 0 }, 255]),
        axis_m: [0.0; 2],
        low_m: 0.4,
        size_m: [5.0, 6.0],
        error_m,
        crown: Crown { middle_m: [0.0, 3.4, 0.0], half_m: [1.6, 2.6, 1.6] },
        leaves: [LeafSide { normal: Vec3::Y, face: Vec3::Z }; LEAVES],
        middles_m: [[0.0; 2]; IMPOSTOR_ROWS],
        leaf_m: 0.1,
    }
}

fn cone_vertex(position_m: [f32; 3], [x, y]: [f32; 2]) -> TreeVertex {
    // Octahedral, about half way up.
    let normal_oct = [x, y].map(|part| (part * 0.7 * 32767.0) as i16);
    TreeVertex {
        position_m,
        color: [40, 90, 30, 255],
        normal_oct,
        normal_end_oct: normal_oct,
        ..TreeVertex::default()
    }
}

/// A tree turned and scaled alike in all directions.
pub fn instance(template: u32, [x, y, z]: [f32; 3], scale: f32, turn_rad: f32) -> Instance {
    let (sin, cos) = libm::sincosf(turn_rad);
    Instance {
        world_from_tree: [
            [scale * cos, 0.0, scale * sin, x],
            [0.0, scale, 0.0, y],
            [-scale * sin, 0.0, scale * cos, z],
        ],
        template,
        trunk_cylinder_m: [x, z, 0.2],
    }
}
