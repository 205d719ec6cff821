//! A landscape may be shown with the shadows of those trees that are near the eye; the rest comes later, and then it looks
//! as if all had been drawn at once.

use std::sync::Arc;

use genescape_viewer::camera::Camera;
use genescape_viewer::headless::Headless;
use genescape_viewer::options::FrameInput;
use genescape_viewer::passes::ShadowBake;
use genescape_viewer::scene::Scene;
use genescape_viewer::upload::Uploader;
use glam::{Vec2, Vec3};
use image::RgbaImage;

use crate::golden::landscape;
use crate::made_up;

/// From above, with these shadows.
fn picture(studio: &Headless, scene: &Scene, draw: impl Fn(&ShadowBake<'_>)) -> RgbaImage {
    let buffers = Uploader::new(&studio.gpu).upload(scene).expect("a landscape that can be drawn");
    draw(&studio.passes.shadow.begin(&studio.gpu, &studio.passes, &buffers));
    let camera =
        Camera { position_m: Vec3::new(0.0, 90.0, 60.0), yaw_rad: 0.0, pitch_rad: -1.0, fov_y_rad: 1.0 };
    let mut view = studio.view(Arc::new(buffers), [320, 200]);
    studio.shoot(&mut view, &FrameInput::default(), &camera, &camera).expect("a picture")
}

/// Pixels that two pictures do not share.
fn differing(a: &RgbaImage, b: &RgbaImage) -> usize {
    a.pixels().zip(b.pixels()).filter(|(a, b)| a != b).count()
}

fn finish(bake: &ShadowBake<'_>) {
    let mut next = Some(0);
    while let Some(first) = next {
        next = bake.trees_from(first);
    }
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn shadows_that_come_later_are_those_that_come_at_once() {
    let (studio, scene) = (made_up::studio(), landscape());
    let near = |bake: &ShadowBake<'_>, reach_m: f32| {
        bake.land();
        bake.trees_around(Vec2::new(20.0, -10.0), reach_m);
    };
    let all = picture(&studio, &scene, |bake| bake.all());
    let of_land = picture(&studio, &scene, |bake| bake.land());
    let of_some = picture(&studio, &scene, |bake| near(bake, 20.0));
    let (some, missing) = (differing(&of_some, &of_land), differing(&of_some, &all));
    assert!(some >= 10 && missing >= 10, "{some} pixels have got shadows, {missing} have not");
    let finished = picture(&studio, &scene, |bake| {
        near(bake, 20.0);
        finish(bake);
    });
    assert_eq!(differing(&finished, &all), 0);
    let of_near = picture(&studio, &scene, |bake| near(bake, 200.0));
    assert_eq!(differing(&of_near, &all), 0, "nothing is farther");
}
