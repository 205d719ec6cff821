//! Anyone's file as it is drawn: colours, sides, holes, what shines through, levels of detail.

use std::process::Command;

use genescape_viewer::camera::Camera;
use genescape_viewer::headless::Headless;
use genescape_viewer::lod_mode::TreeLodMode;
use genescape_viewer::options::{FrameInput, Options};
use genescape_viewer::view::View;
use glam::Vec3;
use image::RgbaImage;
use serde_json::{Value, json};

use crate::files::{self, File, SQUARE};
use crate::made_up;

const SIZE_PX: [u32; 2] = [96, 96];

/// A view of a file.
fn view(studio: &Headless, file: &File) -> View {
    let asset = file.read().expect("a file that can be drawn");
    studio.view(studio.upload_asset(&asset).expect("small enough"), SIZE_PX)
}

/// From that far in front of the middle of a square, or behind it.
fn eye(z_m: f32) -> Camera {
    let yaw_rad = if z_m > 0.0 { 0.0 } else { std::f32::consts::PI };
    Camera { position_m: Vec3::new(0.0, 1.0, z_m), yaw_rad, pitch_rad: 0.0, fov_y_rad: 1.0 }
}

fn shoot(studio: &Headless, file: &File, camera: &Camera) -> RgbaImage {
    let frame = FrameInput {
        options: Options { draw_terrain: false, ..Options::default() },
        ..FrameInput::default()
    };
    studio.shoot(&mut view(studio, file), &frame, camera, camera).expect("a picture")
}

/// A square of one material.
fn square(material: Value) -> File {
    let mut file = File::square();
    file.add("materials", material);
    file.primitive()["material"] = json!(0);
    file
}

fn unlit(color: [f32; 4], more: Value) -> File {
    let mut material = json!({
        "extensions": { "KHR_materials_unlit": {} }, "pbrMetallicRoughness": { "baseColorFactor": color },
    });
    let more = more.as_object().cloned().unwrap_or_default();
    material.as_object_mut().expect("an object").extend(more);
    square(material)
}

fn srgb(linear: f32) -> f32 {
    255.0 * if linear < 0.003_130_8 { 12.92 * linear } else { 1.055 * libm::powf(linear, 1.0 / 2.4) - 0.055 }
}

fn middle(image: &RgbaImage) -> [f32; 3] {
    let [r, g, b, _] = image.get_pixel(SIZE_PX[0] / 2 + 3, SIZE_PX[1] / 2 + 3).0;
    [r, g, b].map(f32::from)
}

fn near(a: [f32; 3], b: [f32; 3], by: f32) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= by)
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn a_colour_that_is_not_lit_is_the_very_colour() {
    let studio = made_up::studio();
    for color in [[0.8, 0.1, 0.02], [0.02, 0.03, 0.01], [0.5, 0.5, 0.5], [0.0, 0.0, 0.0], [0.1, 0.6, 0.7]] {
        let [r, g, b] = color;
        let drawn = middle(&shoot(&studio, &unlit([r, g, b, 1.0], json!({})), &eye(3.0)));
        // Above what is compressed; half floats hold eleven bits.
        assert!(near(drawn, color.map(srgb), 3.0), "{color:?}: {drawn:?}, not {:?}", color.map(srgb));
    }
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn sides_are_drawn_as_the_file_says() {
    let studio = made_up::studio();
    let red = [1.0, 0.0, 0.0, 1.0];
    let is_red = |file: &File, z_m: f32| {
        let [r, g, _] = middle(&shoot(&studio, file, &eye(z_m)));
        r > 150.0 && g < 60.0
    };
    let single = unlit(red, json!({}));
    let double = unlit(red, json!({ "doubleSided": true }));
    assert_eq!([is_red(&single, 3.0), is_red(&single, -3.0)], [true, false]);
    assert_eq!([is_red(&double, 3.0), is_red(&double, -3.0)], [true, true]);
    let mut mirrored = single;
    mirrored.json["nodes"][0]["scale"] = json!([-1.0, 1.0, 1.0]);
    assert_eq!([is_red(&mirrored, 3.0), is_red(&mirrored, -3.0)], [true, false]);
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn alpha_means_what_its_mode_says() {
    let studio = made_up::studio();
    let with = |alpha: f32, mode: &str| {
        let file = unlit([0.0, 0.0, 0.0, alpha], json!({ "alphaMode": mode, "alphaCutoff": 0.5 }));
        middle(&shoot(&studio, &file, &eye(3.0)))[0]
    };
    let behind = with(0.0, "MASK");
    assert!(behind > 60.0, "the backdrop: {behind}");
    assert!(with(0.2, "OPAQUE") < 4.0 && with(0.6, "MASK") < 4.0 && with(1.0, "BLEND") < 4.0);
    assert!((with(0.0, "BLEND") - behind).abs() < 2.0);
    let half = with(0.5, "BLEND");
    // Half the light, which the tone makes a little darker than half a grey of sRGB would be light.
    assert!(half > 0.53 * behind && half < 0.7 * behind, "{half} of {behind}");
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn what_shines_through_is_drawn_from_far_to_near_whatever_the_order() {
    let studio = made_up::studio();
    for order in [[-0.5, 0.5], [0.5, -0.5]] {
        let mut file = unlit([1.0, 0.0, 0.0, 0.5], json!({ "alphaMode": "BLEND" }));
        let mut blue = file.json["materials"][0].clone();
        blue["pbrMetallicRoughness"]["baseColorFactor"] = json!([0.0, 0.0, 1.0, 0.5]);
        file.add("materials", blue);
        let mut mesh = file.json["meshes"][0].clone();
        mesh["primitives"][0]["material"] = json!(1);
        file.add("meshes", mesh);
        file.json["scenes"][0]["nodes"] = json!([0, 1]);
        file.json["nodes"] = json!([
            { "mesh": 0, "translation": [0.0, 0.0, order[0]] }, { "mesh": 1, "translation": [0.0, 0.0, order[1]] },
        ]);
        let [r, _, b] = middle(&shoot(&studio, &file, &eye(4.0)));
        assert_eq!(r > b, order[0] > order[1], "the nearer one counts more: {r} {b}");
    }
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn a_picture_stands_upright_and_a_lit_white_square_is_light() {
    let studio = made_up::studio();
    let mut file = unlit([1.0; 4], json!({}));
    let colors = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 0]];
    let picture = RgbaImage::from_fn(2, 2, |x, y| {
        let [r, g, b] = colors[(2 * y + x) as usize];
        image::Rgba([r, g, b, 255])
    });
    let mut png = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut png, image::ImageFormat::Png).expect("encoded");
    let view = file.view(&png.into_inner());
    file.add("images", json!({ "bufferView": view, "mimeType": "image/png" }));
    file.json["samplers"] = json!([{ "magFilter": 9728, "wrapS": 33071, "wrapT": 33071 }]);
    file.add("textures", json!({ "source": 0, "sampler": 0 }));
    file.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": 0 });
    // The first row of a picture is its upper one.
    let uvs = file.floats(&SQUARE.map(|[x, y, _]| vec![0.5 + 0.5 * x, 0.5 - 0.5 * y]));
    file.primitive()["attributes"]["TEXCOORD_0"] = json!(uvs);
    let drawn = shoot(&studio, &file, &eye(3.0));
    // Near the middle: its texels stay visible.
    for (number, place) in [[45, 45], [51, 45], [45, 51], [51, 51]].into_iter().enumerate() {
        let [r, g, b, _] = drawn.get_pixel(place[0], place[1]).0;
        let bright = [r, g, b].map(|part| part > 128);
        assert_eq!(bright, colors[number].map(|part| part > 128), "{place:?}");
    }
    let white = square(json!({ "pbrMetallicRoughness": { "metallicFactor": 0.0 } }));
    let [r, g, b] = middle(&shoot(&studio, &white, &eye(3.0)));
    assert!(r > 190.0 && r < 254.0 && (r - b).abs() < 12.0 && (r - g).abs() < 12.0, "{r} {g} {b}");
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn levels_follow_the_distance_and_the_controls() {
    let studio = made_up::studio();
    let mut file = unlit([1.0; 4], json!({ "doubleSided": true }));
    for _ in 0..2 {
        let mesh = file.json["meshes"][0].clone();
        file.add("meshes", mesh);
    }
    file.json["nodes"] = json!([
        { "mesh": 0, "extensions": { "MSFT_lod": { "ids": [1, 2] } } }, { "mesh": 1 }, { "mesh": 2 },
    ]);
    let mut view = view(&studio, &file);
    let mut level = |z_m: f32, options: Options| {
        let (camera, frame) = (eye(z_m), FrameInput { options, ..FrameInput::default() });
        let (commands, drawn) = studio.record(std::slice::from_mut(&mut view), &frame, &camera, &camera);
        studio.gpu.queue.submit([commands]);
        assert_eq!(drawn.triangles, if drawn.copies_by_level.is_empty() { 0 } else { 2 });
        drawn.copies_by_level.iter().position(|copies| *copies == 1)
    };
    let usual = Options::default();
    // A square of 2.8 m across: it covers half of any picture's height from 6.6 m on, and a quarter from 11.8 m on.
    assert_eq!([2.0, 6.0, 7.0, 11.0, 13.0, 100.0].map(|z_m| level(z_m, usual)), [0, 0, 1, 1, 2, 2].map(Some));
    assert_eq!(level(100.0, Options { mesh_lod: TreeLodMode::Off, ..usual }), Some(0));
    assert_eq!(level(100.0, Options { mesh_error_px: 0.001, ..usual }), Some(0));
    let behind = Camera { yaw_rad: std::f32::consts::PI, ..eye(5.0) };
    let frame = FrameInput { options: usual, ..FrameInput::default() };
    let (_, drawn) = studio.record(std::slice::from_mut(&mut view), &frame, &behind, &behind);
    assert_eq!((drawn.triangles, drawn.copies_by_level.len()), (0, 0), "nothing is seen");
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn a_picture_of_anyones_file_is_made_without_a_window_or_it_is_told_why_not() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = unlit([1.0, 0.0, 0.0, 1.0], json!({}));
    files::write(folder.path(), "red.glb", &file.glb());
    files::write(folder.path(), "words.glb", b"no file of that kind");
    let draw = |name: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_viewer"));
        command.args([name, "--screenshot", "red.png", "--size", "64x64", "--no-ground"]);
        command.current_dir(folder.path()).output().expect("the viewer is built")
    };
    let output = draw("red.glb");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let drawn = image::open(folder.path().join("red.png")).expect("a picture").into_rgba8();
    let [r, g, ..] = drawn.get_pixel(32, 32).0;
    assert!(r > 200 && g < 60, "{r} {g}");
    let output = draw("words.glb");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && said.contains("words.glb cannot be shown"), "{said}");
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn what_is_between_a_floor_and_the_light_shades_it_and_what_is_cut_out_does_not() {
    // As `upload::lamps` has it.
    const TOWARDS_KEY: Vec3 = Vec3::new(0.48, 0.64, 0.6);
    let studio = made_up::studio();
    let camera = Camera {
        position_m: Vec3::new(0.0, 14.0, 0.2),
        yaw_rad: 0.0,
        pitch_rad: 0.01 - std::f32::consts::FRAC_PI_2,
        fov_y_rad: 1.0,
    };
    // How bright the ground is in the shadow of a square 2 m above it, and as far on the other side. It is the file's own floor, or
    // what a file stands on.
    let ground = |alpha: f32, mode: &str, own_floor: bool| {
        let colored = |alpha: f32, mode: &str| {
            json!({
                "alphaMode": mode, "doubleSided": true,
                "pbrMetallicRoughness": { "metallicFactor": 0.0, "baseColorFactor": [0.5, 0.5, 0.5, alpha] },
            })
        };
        let (mut file, half) = (square(colored(1.0, "OPAQUE")), 0.5_f32.sqrt());
        let mut mesh = file.json["meshes"][0].clone();
        mesh["primitives"][0]["material"] = json!(file.add("materials", colored(alpha, mode)));
        let (mesh, size) = (file.add("meshes", mesh), if own_floor { 6.0 } else { 0.1 });
        let upwards = json!([-half, 0.0, 0.0, half]);
        file.json["nodes"] = json!([
            { "mesh": 0, "rotation": upwards, "scale": [size, size, size] },
            { "mesh": mesh, "rotation": upwards, "translation": [0.0, 2.0, 0.0] },
        ]);
        file.json["scenes"][0]["nodes"] = json!([0, 1]);
        let options = Options { draw_terrain: !own_floor, ..Options::default() };
        let frame = FrameInput { options, ..FrameInput::default() };
        let drawn = studio.shoot(&mut view(&studio, &file), &frame, &camera, &camera).expect("a picture");
        [-1.0, 1.0].map(|side| {
            let place = side * 2.0 / TOWARDS_KEY.y * TOWARDS_KEY * Vec3::new(1.0, 0.0, 1.0);
            let ndc = camera.clip_from_world(1.0).project_point3(place);
            let [x, y] = [ndc.x, -ndc.y].map(|at| ((0.5 + 0.5 * at) * SIZE_PX[0] as f32) as u32);
            // Lines of the grid are narrower.
            let green = (0..25).map(|n| drawn.get_pixel(x + n % 5 - 2, y + n / 5 - 2).0[1]);
            green.map(|byte| libm::powf(f32::from(byte) / 255.0, 2.2)).sum::<f32>() / 25.0
        })
    };
    for own_floor in [true, false] {
        let [shaded, lit] = ground(1.0, "OPAQUE", own_floor);
        assert!(lit > 0.1 && shaded < 0.65 * lit && shaded > 0.3 * lit, "{shaded} {lit}, {own_floor}");
        for (alpha, mode) in [(0.2, "MASK"), (0.5, "BLEND")] {
            let [shaded, lit] = ground(alpha, mode, own_floor);
            assert!((shaded - lit).abs() < 0.06 * lit, "{shaded} {lit}, {mode}, {own_floor}");
        }
    }
}
