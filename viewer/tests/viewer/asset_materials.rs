//! Pictures and materials of anyone's files arrive as they are, or it is told what is left out.

use genescape_viewer::scene::{Alpha, Slot, Wrap};
use serde_json::json;

use crate::files::{self, File};

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let digits = |three: &[u8]| {
        let bits =
            three.iter().fold(0u32, |bits, byte| bits << 8 | u32::from(*byte)) << (8 * (3 - three.len()));
        let digit = |n: usize| DIGITS[(bits >> (18 - 6 * n) & 63) as usize];
        [0, 1, 2, 3].map(|n| char::from(if n <= three.len() { digit(n) } else { b'=' }))
    };
    bytes.chunks(3).flat_map(digits).collect()
}

/// A square with a picture, which `place` puts somewhere; what arrives of it.
fn picture_of(file: &File, folder: &std::path::Path) -> Result<image::RgbaImage, Vec<String>> {
    let path = files::write(folder, "model.glb", &file.glb());
    let asset = files::read_path(&path).expect("a square");
    match &asset.surfaces[0].textures[Slot::Color as usize] {
        Some(texture) => {
            let pixels = texture.image.levels[0].to_vec();
            Ok(image::RgbaImage::from_raw(texture.image.width_px, texture.image.height_px, pixels)
                .expect("whole"))
        }
        None => Err(asset.facts.notes),
    }
}

#[test]
fn pictures_of_three_kinds_come_from_three_kinds_of_places() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (format, mime, file_name) in [
        (image::ImageFormat::Png, "image/png", "my bark.png"),
        (image::ImageFormat::Jpeg, "image/jpeg", "bark.jpg"),
        (image::ImageFormat::WebP, "image/webp", "bark.webp"),
    ] {
        let bytes = files::encoded_as(format);
        files::write(folder.path(), file_name, &bytes);
        let by_extension = json!({ "extensions": { "EXT_texture_webp": { "source": 0 } } });
        let texture = if mime == "image/webp" { by_extension } else { json!({ "source": 0 }) };
        let mut in_buffer = files::with_material(texture.clone());
        let view = in_buffer.view(&bytes);
        in_buffer.add("images", json!({ "bufferView": view, "mimeType": mime }));
        let mut in_uri = files::with_material(texture.clone());
        let data = base64(&bytes);
        in_uri.add("images", json!({ "uri": format!("data:{mime};base64,{data}") }));
        let mut in_file = files::with_material(texture);
        in_file.add("images", json!({ "uri": file_name.replace(' ', "%20") }));
        for mut file in [in_buffer, in_uri, in_file] {
            file.json["extensionsRequired"] = json!(["EXT_texture_webp"]);
            let read = picture_of(&file, folder.path()).expect("a picture");
            let differs = |(a, b): (&u8, &u8)| a.abs_diff(*b) > 12;
            let wrong = read.iter().zip(files::two_colors().iter()).filter(|pair| differs(*pair)).count();
            assert!(wrong < 40, "{mime}: {wrong} bytes differ");
        }
    }
}

#[test]
fn a_picture_that_cannot_be_read_is_told_and_left_out() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let huge = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\x01\x86\xa0\0\0\xff\xff\x08\x06\0\0\0\xe0\xd0\x24\x8c";
    files::write(folder.path(), "huge.png", huge);
    files::write(folder.path(), "words.png", b"no picture");
    for (image, why) in [
        (json!({ "uri": "huge.png" }), "is left out"),
        (json!({ "uri": "words.png" }), "neither PNG nor JPEG nor WebP"),
        (json!({ "uri": "not there.png" }), "cannot be read"),
        (json!({ "uri": "../secret.png" }), "outside the folder"),
        (json!({ "uri": "/etc/passwd" }), "outside the folder"),
        (json!({ "uri": "data:image/png;base64,!!" }), "no base64"),
        (json!({ "bufferView": 99, "mimeType": "image/png" }), "not there"),
        (json!({}), "says not where"),
    ] {
        let mut file = files::with_material(json!({ "source": 0 }));
        file.add("images", image.clone());
        let notes = picture_of(&file, folder.path()).expect_err("no picture");
        assert!(notes[0].contains(why), "{image}: {notes:?}");
    }
    let mut file = files::with_material(json!({ "extensions": { "KHR_texture_basisu": { "source": 0 } } }));
    file.add("images", json!({ "bufferView": 0, "mimeType": "image/ktx2" }));
    let notes = picture_of(&file, folder.path()).expect_err("no picture");
    assert!(notes[0].contains("KTX2"), "{notes:?}");
}

#[test]
fn materials_arrive_with_their_extensions() {
    let mut file = files::with_material(json!({ "source": 0, "sampler": 0 }));
    let view = file.view(&files::encoded_as(image::ImageFormat::Png));
    file.add("images", json!({ "bufferView": view, "mimeType": "image/png" }));
    file.json["samplers"] = json!([{ "wrapS": 33071, "wrapT": 33648, "magFilter": 9728 }]);
    file.json["materials"] = json!([{
        "alphaMode": "MASK", "alphaCutoff": 0.25, "doubleSided": true, "emissiveFactor": [0.5, 0.0, 1.0],
        "extensions": {
            "KHR_materials_unlit": {},
            "KHR_materials_emissive_strength": { "emissiveStrength": 4.0 },
            "KHR_materials_clearcoat": { "clearcoatFactor": 1.0 },
        },
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.5, "roughnessFactor": 0.6,
            "baseColorTexture": { "index": 0, "extensions": { "KHR_texture_transform": {
                "offset": [0.5, 0.25], "scale": [2.0, 3.0], "rotation": 1.570_796_4, "texCoord": 1,
            } } },
        },
    }]);
    let asset = file.read().expect("a square");
    let surface = &asset.surfaces[0];
    assert_eq!((surface.color, surface.metallic, surface.roughness), ([0.1, 0.2, 0.3, 0.4], 0.5, 0.6));
    assert_eq!((surface.alpha, surface.double_sided, surface.unlit), (Alpha::Mask(0.25), true, true));
    assert_eq!(surface.emissive, [2.0, 0.0, 4.0]);
    let texture = surface.textures[Slot::Color as usize].as_ref().expect("a texture");
    assert_eq!(
        (texture.set, texture.sampling.wrap, texture.sampling.nearest),
        (1, [Wrap::Clamp, Wrap::Mirror], true)
    );
    // A quarter turn: what grew along u now looks up along −v.
    for (row, expected) in texture.uv_rows.iter().zip([[0.0, 3.0, 0.5], [-2.0, 0.0, 0.25]]) {
        let near = row.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5);
        assert!(near, "{:?}", texture.uv_rows);
    }
    assert!(asset.facts.notes[0].contains("clear coats"), "{:?}", asset.facts.notes);
}

#[test]
fn what_a_leaf_mirrors_less_is_read_and_colours_of_it_are_told() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let read = |extension: serde_json::Value| {
        let mut file = files::with_material(json!({}));
        file.json["materials"][0]["extensions"] = json!({ "KHR_materials_specular": extension });
        let asset =
            files::read_path(&files::write(folder.path(), "model.glb", &file.glb())).expect("a square");
        let told = asset.facts.notes.iter().any(|note| note.contains("KHR_materials_specular"));
        (asset.surfaces[0].specular, told)
    };
    assert_eq!(read(json!({ "specularFactor": 0.2 })), (0.2, false));
    assert_eq!(read(json!({})), (1.0, false), "as if there were no extension");
    assert_eq!(read(json!({ "specularColorFactor": [1, 0, 0] })), (1.0, true));
}
