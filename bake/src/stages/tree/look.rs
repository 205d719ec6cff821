//! Ignored tests that write trees for people to look at (to the folder named by `TREE_LOOK`), and time them.

use std::fs;
use std::path::PathBuf;
use std::time::Instant;

use super::presets;
use super::{TreeParams, template, textures};
use crate::model::{Image8, Material, TreeTemplate, TreeTextures};

fn folder() -> PathBuf {
    let folder = std::env::var_os("TREE_LOOK").map_or_else(std::env::temp_dir, PathBuf::from);
    fs::create_dir_all(&folder).expect("the folder can be made");
    folder
}

fn write_png(path: PathBuf, image: &Image8) {
    let file = fs::File::create(path).expect("the picture can be made");
    let mut encoder = png::Encoder::new(file, image.width, image.height);
    encoder.set_color(if image.channels == 4 { png::ColorType::Rgba } else { png::ColorType::Rgb });
    let mut writer = encoder.write_header().expect("the header can be written");
    writer.write_image_data(&image.data).expect("the pixels can be written");
}

fn write(name: &str, tree: &TreeTemplate, textures: &TreeTextures<crate::model::Image8>) {
    let folder = folder();
    let mesh = &tree.mesh;
    let raw =
        |what: &str, bytes: &[u8]| fs::write(folder.join(format!("{name}.{what}")), bytes).expect("written");
    raw("positions", bytemuck::cast_slice(&mesh.positions));
    raw("normals", bytemuck::cast_slice(&mesh.normals));
    raw("uvs", bytemuck::cast_slice(&mesh.uvs));
    raw("colors", bytemuck::cast_slice(&mesh.colors));
    for material in [Material::Bark, Material::Leaf, Material::Blossom] {
        let part = mesh.parts.iter().find(|part| part.material == material);
        let triangles = part.map_or(&[][..], |part| &part.triangles);
        raw(&format!("{material:?}").to_lowercase(), bytemuck::cast_slice(triangles));
    }
    write_png(folder.join(format!("{name}-bark.png")), &textures.bark_color);
    write_png(folder.join(format!("{name}-normal.png")), &textures.bark_normal);
    write_png(folder.join(format!("{name}-leaf.png")), &textures.leaf[0]);
    write_png(folder.join(format!("{name}-blossom.png")), &textures.blossom[0]);
}

#[expect(clippy::print_stdout, reason = "a report for whoever runs this by hand")]
fn report(name: &str, params: &TreeParams, tree: &TreeTemplate) {
    let best = (0..15)
        .map(|_| {
            let start = Instant::now();
            std::hint::black_box(template(std::hint::black_box(params), 0));
            start.elapsed()
        })
        .min();
    let parts: Vec<_> = tree.mesh.parts.iter().map(|part| part.triangles.len()).collect();
    println!(
        "{name:8} {:6} triangles {parts:?} {:6} vertices {best:?} trunk {:.2} m crown {:.1} m top {:.1} m",
        tree.mesh.triangle_count(),
        tree.mesh.positions.len(),
        tree.trunk_radius_m,
        tree.crown_radius_m,
        tree.bounds.max.y,
    );
}

#[test]
#[ignore = "writes files to look at"]
fn presets_to_look_at() {
    for (name, params, leaf_aspect) in presets::all() {
        let tree = template(&params, 0);
        report(name, &params, &tree);
        write(name, &tree, &textures(&presets::texture_params(&params, leaf_aspect)));
    }
}

#[test]
#[ignore = "writes files to look at"]
fn random_genomes_to_look_at() {
    for seed in 0..12 {
        let (params, leaf_aspect) = presets::random(seed);
        let tree = template(&params, 0);
        let name = format!("random{seed}");
        report(&name, &params, &tree);
        write(&name, &tree, &textures(&presets::texture_params(&params, leaf_aspect)));
    }
}

#[test]
#[ignore = "prints times"]
#[expect(clippy::print_stdout, reason = "a report for whoever runs this by hand")]
fn time_of_textures() {
    for (name, params, leaf_aspect) in presets::all() {
        let params = presets::texture_params(&params, leaf_aspect);
        let time = |f: &dyn Fn()| {
            (0..5)
                .map(|_| {
                    let start = Instant::now();
                    f();
                    start.elapsed()
                })
                .min()
        };
        let leaf = time(&|| drop(super::leaf_texture::paint_leaves(&params)));
        let blossom = time(&|| drop(super::leaf_texture::paint_blossom(&params)));
        let bark = time(&|| drop(super::bark_texture::paint(&params)));
        let coverage = super::leaf_texture::leaves(&params).coverage(0.5);
        println!("{name:8} leaf {leaf:?} blossom {blossom:?} bark {bark:?} coverage {coverage:.2}");
    }
}
