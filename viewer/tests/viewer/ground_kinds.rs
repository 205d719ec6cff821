//! Where two kinds of ground meet, one lies beside the other, and no mist of both between them.

use genescape_viewer::camera::Camera;
use genescape_viewer::options::{FrameInput, Options};
use genescape_viewer::scene::Trees;
use glam::Vec3;
use image::RgbaImage;

use crate::made_up;

const TURF: [f32; 3] = [0.05, 0.08, 0.03];
const SNOW: [f32; 3] = [0.7, 0.72, 0.75];

/// Turf in the west, snow in the east, and 16 m of both in between, seen from above.
fn border(grain: u8) -> RgbaImage {
    let side = 65_u32;
    let mut scene = made_up::scene(made_up::land(side, 1.0, |_, _| 0.0), [0; 4], [0.6; 3], Trees::default());
    let snow = |i: u32| ((i as f32 - 0.5 * side as f32) / 16.0 + 0.5).clamp(0.0, 1.0);
    let byte = |linear: f32| (255.0 * libm::powf(linear, 1.0 / 2.2)) as u8;
    let surface = &mut scene.ground.surface;
    surface.color = made_up::picture("border", side, |i, _| {
        let [r, g, b] = std::array::from_fn(|c| byte(TURF[c] + snow(i) * (SNOW[c] - TURF[c])));
        [r, g, b, 255]
    });
    surface.weights = made_up::picture("parts", side, |i, _| [0, 0, (255.0 * snow(i)) as u8, 0]);
    for (layer, detail) in surface.details.iter_mut().enumerate() {
        let tone = |i, j| 128 - grain + (2.0 * f32::from(grain) * made_up::hash(i, j, layer as u32)) as u8;
        detail.detail = made_up::picture(&format!("grain {layer}"), 64, |i, j| [tone(i, j); 4]);
        detail.normal = made_up::picture(&format!("level {layer}"), 64, |_, _| [128, 128, 255, 255]);
    }
    let studio = made_up::studio();
    let camera = Camera {
        position_m: Vec3::new(0.0, 24.0, 0.0),
        yaw_rad: 0.0,
        pitch_rad: -std::f32::consts::FRAC_PI_2,
        fov_y_rad: 0.8,
    };
    let frame =
        FrameInput { options: Options { grass: false, ..Options::default() }, ..FrameInput::default() };
    let mut view = studio.view(made_up::upload(&studio, &scene), [480, 320]);
    studio.shoot(&mut view, &frame, &camera, &camera).expect("a picture")
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn snow_and_turf_meet_without_mist_between_them() {
    let picture = border(48);
    let (width, height) = picture.dimensions();
    let mean = |from: u32, to: u32| {
        let pixels = (from..to).flat_map(|x| (0..height).map(move |y| (x, y)));
        pixels.map(|(x, y)| f32::from(picture.get_pixel(x, y)[0])).sum::<f32>()
            / ((to - from) * height) as f32
    };
    let (turf, snow) = (mean(0, width / 8), mean(width * 7 / 8, width));
    assert!(snow > turf + 80.0, "snow {snow}, turf {turf}");
    let is_mist = |value: u8| (0.3..0.7).contains(&((f32::from(value) - turf) / (snow - turf)));
    let mist = picture.pixels().filter(|pixel| is_mist(pixel[0])).count();
    let share = mist as f32 / (width * height) as f32;
    genescape_bake::say!("mist {share:.3}");
    // 16 m are 160 pixels of 480; of a mixture, two fifths of them are between.
    assert!(share < 0.05, "{share} of the picture is neither");
    // What lies alone has the map's colour, and half of the border is of each.
    let middle = mean(width / 2 - 80, width / 2 + 80);
    let of_snow = (middle - turf) / (snow - turf);
    assert!((0.35..0.65).contains(&of_snow), "{of_snow} of the border is snow");
}
