//! The inside of a crown: dark among green leaves, bright among blossom, by sun that comes by way of other leaves.

use genescape_viewer::camera::Camera;
use genescape_viewer::headless::Headless;
use genescape_viewer::options::{FrameInput, Options};
use genescape_viewer::scene::Trees;
use glam::Vec3;

use crate::made_up;

/// Green that a leaf of this grey shows, which is so open, under a dim sky and as much of a bright sun as the land leaves to it.
fn seen(studio: &Headless, grey: u8, open: u8, past_land: u8) -> f32 {
    let leaf = made_up::one_leaf(&format!("leaf {grey} {open}"), [grey, grey, grey, open]);
    let instances = [made_up::instance(0, [0.0, 3.0, 0.0], 1.0, 0.0)].into();
    let trees = Trees { templates: vec![leaf.into()], instances, ..Trees::default() };
    let mut scene = made_up::scene(made_up::field(65, 2.0, 0.0, 0.0), [128; 4], [0.1; 3], trees);
    scene.ground.surface.light =
        made_up::picture(&format!("light {past_land}"), 1, |_, _| [255, 204, past_land, 255]);
    scene.sky.light.sun_direction = Vec3::new(0.0, 0.6, 0.8);
    scene.sky.light.sky_irradiance_linear = [0.1; 3];
    let camera =
        Camera { position_m: Vec3::new(0.0, 3.0, 2.0), yaw_rad: 0.0, pitch_rad: 0.3, fov_y_rad: 0.6 };
    let frame =
        FrameInput { options: Options { grass: false, ..Options::default() }, ..FrameInput::default() };
    let mut view = studio.view(made_up::upload(studio, &scene), [96, 64]);
    let picture = studio.shoot(&mut view, &frame, &camera, &camera).expect("a picture");
    f32::from(picture.get_pixel(48, 32)[1])
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn blossom_is_bright_inside_and_green_leaves_are_not() {
    let studio = made_up::studio();
    let inside = |grey, past_land| seen(&studio, grey, 0, past_land) / seen(&studio, grey, u8::MAX, u8::MAX);
    let [blossom, green] = [210, 60].map(|grey| inside(grey, u8::MAX));
    // .08 and .04 by the light of the sky alone.
    assert!(blossom > 0.5, "{blossom} of what it is outside");
    assert!(green < 0.3, "{green} of what it is outside");
    let in_shade = inside(210, 0);
    assert!(in_shade < 0.1, "{in_shade} of what it is outside, behind a mountain");
}
