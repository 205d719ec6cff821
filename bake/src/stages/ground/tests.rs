//! Properties of the ground.

use super::*;

#[test]
#[ignore = "writes pictures"]
fn texture_pictures() {
    for (name, make) in [("grass", patterns::grass as fn() -> patterns::Pattern), ("rock", patterns::rock), ("scree", patterns::scree), ("snow", patterns::snow), ("mud", patterns::mud)] {
        let begin = crate::stages::land::cpu_s();
        make();
        eprintln!("textures {name} {:.0} ms", 1e3 * (crate::stages::land::cpu_s() - begin));
    }
    let begin = crate::stages::land::cpu_s();
    let made = textures();
    eprintln!("textures {:.0} ms", 1e3 * (crate::stages::land::cpu_s() - begin));
    let folder = std::env::temp_dir().join("genescape-land");
    std::fs::create_dir_all(&folder).expect("folder for pictures");
    for t in &made.textures {
        for (what, image) in [("detail", &t.detail_srgb), ("normal", &t.normal)] {
            let path = folder.join(format!("{}-{what}.png", t.name));
            let mut encoder = png::Encoder::new(std::fs::File::create(path).expect("picture"), 512, 512);
            encoder.set_color(png::ColorType::Rgb);
            encoder.write_header().and_then(|mut w| w.write_image_data(&image.data)).expect("picture");
        }
    }
}
