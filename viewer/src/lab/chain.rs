//! A tree's levels of detail drawn at equal size on the screen: what each covers, and how far it is from the full tree.

use std::sync::Arc;

use anyhow::Result;
use glam::Vec3;
use image::RgbaImage;

use crate::camera::Camera;
use crate::headless::Headless;
use crate::lod::tree::allowance;
use crate::lod_mode::TreeLodMode;
use crate::measure::flip;
use crate::options::{FrameInput, Options};
use crate::scene::{Instance, Scene, Template};
use crate::view::View;

/// Sides of a picture.
const SIDE_PX: u32 = 240;
/// Narrow, so that near and far branches are as large.
const FOV_Y_RAD: f32 = 0.2;
/// Radius that is seen, over that of the sphere around all levels, whose corners are mostly empty.
const MARGIN: f32 = 0.85;
/// Errors of levels are larger by this, so that none but the full tree is fine enough to cast a shadow.
const EXAGGERATED: f32 = 1000.0;
/// A channel that differs by more belongs to the tree.
const SEEN: u8 = 2;
/// What each level is to keep: coverage within this of that of the full tree, vertices within this of half of those before.
pub const MAX_COVERAGE_ERROR: f64 = 0.02;
pub const MAX_HALF_ERROR: f64 = 0.01;

/// A level as drawn.
pub struct Shown {
    pub triangles: u32,
    pub vertices: u32,
    pub error_m: f32,
    /// Pixels of the tree over those of D_0.
    pub coverage: f64,
    /// From D_0's picture, over all of it.
    pub flip: f64,
    pub picture: RgbaImage,
}

/// All levels of a template, drawn.
pub fn chain(headless: &Headless, scene: &Scene, tree: Instance, template: &Template) -> Result<Vec<Shown>> {
    let mut alone = scene.clone().without_far_trees();
    // Pictures would take over from coarse levels, and coarse levels cast shadows on the others.
    let blob = format!("{} of meshes alone", template.blob);
    let mut meshes = Template { impostor: None, blob, ..template.clone() };
    meshes.levels.iter_mut().for_each(|level| level.error_m *= EXAGGERATED);
    alone.trees.templates = vec![Arc::new(meshes)];
    alone.trees.instances = Arc::new([Instance { template: 0, ..tree }]);
    let mut view = headless.view(headless.upload(&alone)?, [SIDE_PX, SIDE_PX]);
    let (camera, away_m) = before(scene, &tree, template);
    let focal_px = camera.focal_px(SIDE_PX as f32);
    let radius_m = template.radius_m * tree.max_scale();
    let allowance = allowance(focal_px, away_m + radius_m, radius_m);
    let error_px_per_m = EXAGGERATED * focal_px * tree.max_scale() / (away_m * allowance);
    let usual = Options {
        tree_lod: TreeLodMode::Discrete,
        draw_terrain: false,
        grass: false,
        samples: 4,
        ..Options::default()
    };
    let shoot = |view: &mut View, options: Options| {
        let frame = FrameInput { options, ..FrameInput::default() };
        headless.shoot(view, &frame, &camera, &camera)
    };
    let empty = shoot(&mut view, Options { draw_trees: false, ..usual })?;
    let mut shown: Vec<Shown> = Vec::new();
    let mut reference = None;
    for (number, level) in template.levels.iter().enumerate() {
        // Just enough for this level, and not for the next.
        let tree_error_px = if number == 0 { 0.0 } else { level.error_m * error_px_per_m * 1.0001 };
        let picture = shoot(&mut view, Options { tree_error_px, ..usual })?;
        let (pixels, full) = (covered(&picture, &empty), reference.get_or_insert_with(|| picture.clone()));
        let end =
            template.levels.get(number + 1).map_or(template.vertices.len(), |next| next.base_vertex as usize);
        shown.push(Shown {
            triangles: level.ranges.iter().map(|range| range.count / 3).sum(),
            vertices: (end as u32).saturating_sub(level.base_vertex),
            error_m: level.error_m,
            coverage: pixels as f64 / (covered(full, &empty) as f64).max(1.0),
            flip: flip(full, &picture, SIDE_PX),
            picture,
        });
    }
    Ok(shown)
}

/// A camera that sees all of a tree, with the sun behind and to the side; and how far the tree's sphere is.
fn before(scene: &Scene, tree: &Instance, template: &Template) -> (Camera, f32) {
    let rows = tree.world_from_tree;
    let center = Vec3::from_array(template.center_m).extend(1.0);
    let center_m = Vec3::from_array(rows.map(|row| glam::Vec4::from_array(row).dot(center)));
    let radius_m = template.radius_m * tree.max_scale();
    let away_m = MARGIN * radius_m / libm::sinf(0.5 * FOV_Y_RAD);
    let [x, _, z] = scene.sky.light.sun_direction.to_array();
    let toward_sun = glam::Vec2::new(x, z).normalize_or(glam::Vec2::Y);
    let back = glam::Vec2::from_angle(0.6).rotate(toward_sun);
    let position_m = center_m + Vec3::new(back.x, 0.0, back.y) * away_m;
    let yaw_rad = libm::atan2f(back.x, back.y);
    (Camera { position_m, yaw_rad, pitch_rad: 0.0, fov_y_rad: FOV_Y_RAD }, away_m - radius_m)
}

/// Pixels in which a picture is not what it would be without the tree.
fn covered(picture: &RgbaImage, empty: &RgbaImage) -> usize {
    let differs = |(a, b): (&image::Rgba<u8>, &image::Rgba<u8>)| {
        a.0.iter().zip(b.0).take(3).any(|(a, b)| a.abs_diff(b) > SEEN)
    };
    picture.pixels().zip(empty.pixels()).filter(|pair| differs(*pair)).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_covered_is_what_differs_and_transparency_counts_not() {
        let picture =
            |values: [[u8; 4]; 3]| RgbaImage::from_raw(3, 1, values.concat()).expect("three pixels");
        let empty = picture([[10, 10, 10, 255]; 3]);
        assert_eq!(covered(&picture([[10, 10, 10, 255], [10, 13, 10, 255], [12, 8, 10, 0]]), &empty), 1);
    }
}
