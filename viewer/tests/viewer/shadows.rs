//! A landscape may be shown with the shadows of those trees that are near the eye; the rest comes later, and then it looks
//! as if all had been drawn at once.

use std::sync::Arc;

use genescape_viewer::camera::Camera;
use genescape_viewer::headless::Headless;
use genescape_viewer::options::{FrameInput, Options};
use genescape_viewer::passes::ShadowBake;
use genescape_viewer::scene::{Range, Scene, Template, TreeVertex, Trees};
use genescape_viewer::upload::Uploader;
use glam::{Vec2, Vec3};
use image::RgbaImage;

use crate::golden::landscape;
use crate::made_up::{self, differing};

/// From above, with these shadows.
fn picture(studio: &Headless, scene: &Scene, draw: impl Fn(&ShadowBake<'_>)) -> RgbaImage {
    let buffers = Uploader::new(&studio.gpu).upload(scene).expect("a landscape that can be drawn");
    draw(&studio.passes.shadow.begin(&studio.gpu, &studio.passes, &buffers));
    let camera =
        Camera { position_m: Vec3::new(0.0, 90.0, 60.0), yaw_rad: 0.0, pitch_rad: -1.0, fov_y_rad: 1.0 };
    let mut view = studio.view(Arc::new(buffers), [320, 200]);
    studio.shoot(&mut view, &FrameInput::default(), &camera, &camera).expect("a picture")
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

/// A tree of two leaves under the sun at its zenith: a level one, 4 m above the ground, and one that leads down from its western
/// edge.
fn two_leaves() -> Template {
    let leaf = |down_m: f32| {
        let corners = [[0.0, -3.0, 0.0], [0.0, 3.0, 0.0], [6.0, 3.0, down_m], [6.0, -3.0, down_m]];
        corners.map(|[x, z, down_m]| TreeVertex {
            position_m: [x, 4.0 - down_m, z],
            color: [200, 200, 200, 255],
            // Upwards.
            normal_oct: [0, i16::MAX],
            normal_end_oct: [0, i16::MAX],
            ..TreeVertex::default()
        })
    };
    let mut tree = made_up::template("two leaves", &[0.1]);
    tree.vertices = [leaf(0.0), leaf(3.0)].concat();
    tree.indices = vec![0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7];
    tree.levels[0].ranges[0] = Range { first: 0, count: 12 };
    tree.materials[0].alpha_cutoff = Some(0.5);
    (tree.center_m, tree.radius_m) = ([3.0, 3.0, 0.0], 6.0);
    tree
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn shade_sets_in_without_an_edge_across_a_leaf() {
    let studio = made_up::studio();
    let instances = Arc::new([made_up::instance(0, [0.0; 3], 1.0, 0.0)]);
    let trees = Trees { templates: vec![Arc::new(two_leaves())], instances, ..Trees::default() };
    let mut scene = made_up::scene(made_up::land(257, 0.5, |_, _| 0.0), [90, 90, 90, 255], [0.2; 3], trees);
    scene.sky.light.sun_direction = Vec3::Y;
    scene.sky.light.sky_irradiance_linear = [0.1; 3];
    let mut view = studio.view(made_up::upload(&studio, &scene), [100, 200]);
    // Seen from below, from the west, the lower leaf hides the upper one; its western edge is above its eastern one.
    let camera = Camera {
        position_m: Vec3::new(-3.0, 0.5, 0.0),
        yaw_rad: -0.5 * std::f32::consts::PI,
        pitch_rad: 0.45,
        fov_y_rad: 1.0,
    };
    let options = Options { grass: false, draw_terrain: false, ..Options::default() };
    let frame = FrameInput { options, ..FrameInput::default() };
    let drawn = studio.shoot(&mut view, &frame, &camera, &camera).expect("a picture");
    // Down the middle, some rows from both edges.
    let green: Vec<f32> = (24..150).map(|y| f32::from(drawn.get_pixel(50, y)[1])).collect();
    let (lit, shaded) = (green[0], green[green.len() - 1]);
    assert!(lit > shaded + 30.0, "lit {lit}, in shade {shaded}: {green:?}");
    let step = green.windows(2).map(|rows| (rows[0] - rows[1]).abs()).fold(0.0, f32::max);
    assert!(step < 0.15 * (lit - shaded), "{step} from row to row, {lit} to {shaded}: {green:?}");
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn a_slope_in_the_shade_is_lit_by_the_land_around_as_level_land_is_not() {
    let studio = made_up::studio();
    // Red and blue of grey land that rises so steeply, in its own shade under a blue sky.
    let seen = |rise: f32| {
        let lod = made_up::land(65, 4.0, |i, _| rise * 4.0 * (i as f32 - 32.0));
        let mut scene = made_up::scene(lod, [128; 4], [0.0, 0.0, 0.4], Trees::default());
        scene.ground.surface.light = made_up::picture("shade", 1, |_, _| [255, 0, 0, 255]);
        scene.sky.light.sky_irradiance_linear = [0.0, 0.0, 1.2];
        scene.sky.light.exposure = 6.0;
        let camera = Camera {
            position_m: Vec3::new(0.0, 30.0, 0.1),
            yaw_rad: 0.0,
            pitch_rad: 0.01 - std::f32::consts::FRAC_PI_2,
            fov_y_rad: 0.3,
        };
        let frame = FrameInput::default();
        let buffers = made_up::upload(&studio, &scene);
        let picture =
            studio.shoot(&mut studio.view(buffers, [32, 32]), &frame, &camera, &camera).expect("a picture");
        let [red, _, blue, _] = picture.get_pixel(16, 16).0;
        [red, blue]
    };
    let [[level_red, level_blue], [red, blue]] = [0.0, 1.2].map(seen);
    assert!(
        level_blue > level_red + 40 && blue > 40,
        "the sky reaches both: {level_red} {level_blue} {blue}"
    );
    assert!(red > level_red + 10, "{red} on a slope, {level_red} on level land");
}
