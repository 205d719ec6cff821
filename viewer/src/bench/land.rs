//! What it takes to draw the land with a given error at 1920 × 1080: triangles and the processor's work of morphing that
//! follows distance and roughness, of morphing by distance alone as near to the land, and of ROAM, from cameras all over
//! it. The error is measured: the distance between the land and what is drawn there, as it looks from the eye, the greatest
//! of all samples that a picture shows and, as more of a picture than its worst place counts, the root of the mean square.

use std::time::Instant;

use anyhow::Result;
use glam::{Vec2, Vec3};

use super::Bench;
use super::report::Aim;
use crate::camera::{Camera, Frustum};
use crate::lod::nested::{Nested, Sight};
use crate::lod::quadtree;
use crate::lod::roam;
use crate::measure::quantile;
use crate::options::Options;
use crate::scene::{Scene, TerrainLod};
use crate::view::MAX_BLOCK_M;
use crate::walk::{EYE_HEIGHT_M, Land};

const CAMERAS: u32 = 200;
const PICTURE: [f32; 2] = [1920.0, 1080.0];
/// Errors that are allowed, in pixels: the aim's, and what is allowed by default.
const ERRORS_PX: [f32; 2] = [1.0, 2.0];
/// Steps by which the error of morphing by distance is brought to the other's.
const BISECTIONS: u32 = 7;

pub(super) fn measure(bench: &mut Bench) -> Result<()> {
    for path in bench.paths.clone() {
        let scene = bench.headless.read(&path)?;
        for error_px in ERRORS_PX {
            let title =
                format!("Land of {}, {error_px} px allowed: {CAMERAS} cameras, 1920 × 1080", scene.name);
            bench.report.section(title);
            tell(bench, &scene, error_px);
        }
    }
    Ok(())
}

fn tell(bench: &mut Bench, scene: &Scene, error_px: f32) {
    let lod = &scene.ground.lod;
    let cameras = cameras(scene);
    let nested = Nested::of(&lod.field);
    let focal_px = cameras[0].focal_px(PICTURE[1]);
    let adaptive = Run::of(lod, &cameras, by_roughness(lod, &nested, focal_px / error_px));
    let by_distance = |as_near: fn(&Run) -> f64| {
        // The largest error allowed by distance alone that looks no worse.
        let (mut low, mut high) = (1.0 / 64.0, 8.0_f32);
        for _ in 0..BISECTIONS {
            let middle = (low * high).sqrt();
            let run = Run::of(lod, &cameras, by_distance_alone(lod, &nested, middle * focal_px));
            *(if as_near(&run) > as_near(&adaptive) { &mut low } else { &mut high }) = middle;
        }
        Run::of(lod, &cameras, by_distance_alone(lod, &nested, high * focal_px))
    };
    let [by_greatest, by_mean] = [by_distance(Run::greatest_px), by_distance(Run::mean_px)];
    let (mut strip, mut counts) = (Vec::new(), Vec::<f64>::new());
    let start = Instant::now();
    let picture = (PICTURE[0] / PICTURE[1], PICTURE[1]);
    for camera in &cameras {
        counts.push(f64::from(roam::triangulate(lod, camera, picture, error_px, true, None, &mut strip)));
    }
    let roam_ms = start.elapsed().as_secs_f64() * 1e3 / f64::from(CAMERAS);
    let mean = |counts: &Vec<f64>| counts.iter().sum::<f64>() / counts.len() as f64;
    let [ours, theirs, roam] = [&adaptive.triangles, &by_greatest.triangles, &counts].map(mean);
    let theirs_by_mean = mean(&by_mean.triangles);
    let report = &mut bench.report;
    report.aimed("greatest error in any picture", adaptive.greatest_px(), "px", Aim::AtMost(error_px.into()));
    report.figure("greatest error of a picture, median", quantile(&adaptive.errors_px, 0.5), "px");
    report.figure("root of the mean square error of all pictures", adaptive.mean_px(), "px");
    report.figure("by distance alone, greatest error in any picture", by_greatest.greatest_px(), "px");
    report.figure("triangles a picture", ours, "");
    report.figure("the same by distance alone, as near to the land", theirs, "");
    report.aimed("triangles, by roughness / by distance alone", ours / theirs, "×", Aim::AtMost(0.25));
    let title = "the same, both as near by the mean square";
    report.aimed(title, ours / theirs_by_mean, "×", Aim::AtMost(0.25));
    report.figure("triangles of ROAM", roam, "");
    report.aimed("processor, by roughness / ROAM", adaptive.choose_ms / roam_ms, "×", Aim::AtMost(1.0));
}

/// What is drawn for a camera.
struct Drawn {
    triangles: Vec<[Vec3; 3]>,
    /// What choosing them took.
    seconds: f64,
}

/// Triangles that rise, where a radian has `pixels` for each that is allowed.
fn by_roughness<'a>(
    lod: &'a TerrainLod,
    nested: &'a Nested,
    pixels: f32,
) -> impl Fn(&Camera, &Frustum) -> Drawn + 'a {
    move |camera, frustum| {
        let (field, sight) = (&*lod.field, Sight { eye_m: camera.position_m, pixels });
        let mut chosen = Vec::new();
        let start = Instant::now();
        nested.select(field, &sight, Some(frustum), &mut chosen);
        let seconds = start.elapsed().as_secs_f64();
        Drawn { triangles: nested.drawn(field, &sight, &chosen), seconds }
    }
}

/// Blocks by distance alone, likewise.
fn by_distance_alone<'a>(
    lod: &'a TerrainLod,
    nested: &'a Nested,
    pixels: f32,
) -> impl Fn(&Camera, &Frustum) -> Drawn + 'a {
    move |camera, frustum| {
        let (field, mut blocks) = (&*lod.field, Vec::new());
        let start = Instant::now();
        let detail = quadtree::detail(lod, &nested.levels_m, pixels, camera.position_m, false, MAX_BLOCK_M);
        quadtree::select(lod, &detail, Some(frustum), &mut blocks);
        let seconds = start.elapsed().as_secs_f64();
        Drawn { triangles: quadtree::drawn(field, &detail, &blocks), seconds }
    }
}

/// What all cameras are shown.
struct Run {
    /// Those that have vanished included.
    triangles: Vec<f64>,
    /// The greatest of each picture.
    errors_px: Vec<f64>,
    /// Sums over all pictures: of squared errors, by the pixels that their samples fill, and of these pixels.
    squares: [f64; 2],
    /// Milliseconds of choosing what a picture draws, mean.
    choose_ms: f64,
}

impl Run {
    fn of(lod: &TerrainLod, cameras: &[Camera], draw: impl Fn(&Camera, &Frustum) -> Drawn) -> Self {
        let (mut triangles, mut errors_px, mut seconds) = (Vec::new(), Vec::new(), 0.0);
        let mut squares = [0.0; 2];
        for camera in cameras {
            let frustum = camera.frustum(PICTURE[0] / PICTURE[1]);
            let drawn = draw(camera, &frustum);
            seconds += drawn.seconds;
            triangles.push(drawn.triangles.len() as f64);
            errors_px.push(greatest_error_px(lod, camera, &frustum, &drawn.triangles, &mut squares));
        }
        Self { triangles, errors_px, squares, choose_ms: seconds * 1e3 / cameras.len() as f64 }
    }

    fn greatest_px(&self) -> f64 {
        quantile(&self.errors_px, 1.0)
    }

    fn mean_px(&self) -> f64 {
        (self.squares[0] / self.squares[1]).sqrt()
    }
}

/// Walkers and, every fourth, somebody who flies; places as evenly as the additive recurrence of Roberts (2018) spreads
/// them.
fn cameras(scene: &Scene) -> Vec<Camera> {
    let land = Land::of(scene);
    let extent_m = scene.ground.field.extent_m();
    let camera = |k: u32| {
        let part = |step: f64| ((0.5 + f64::from(k) * step).fract() as f32 - 0.5) * extent_m * 0.96;
        let place_m = Vec2::new(part(0.754_877_666_246_692_7), part(0.569_840_290_998_053_3));
        let above_m = if k.is_multiple_of(4) { 40.0 } else { EYE_HEIGHT_M };
        Camera {
            position_m: Vec3::new(place_m.x, land.footing_m(place_m) + above_m, place_m.y),
            yaw_rad: k as f32 * 2.4,
            pitch_rad: if k.is_multiple_of(4) { -0.3 } else { 0.0 },
            fov_y_rad: Options::default().fov_y_deg.to_radians(),
        }
    };
    (0..CAMERAS).map(camera).collect()
}

/// The greatest vertical distance between samples that are seen and what is drawn there, in pixels at their distance;
/// adds to `squares`.
fn greatest_error_px(
    lod: &TerrainLod,
    camera: &Camera,
    frustum: &Frustum,
    triangles: &[[Vec3; 3]],
    squares: &mut [f64; 2],
) -> f64 {
    let field = &lod.field;
    let focal_px = camera.focal_px(PICTURE[1]);
    let half_m = 0.5 * field.extent_m();
    let line = |at_m: f32| (at_m + half_m) / field.spacing_m;
    let mut greatest_px = 0.0_f32;
    for &[a, b, c] in triangles {
        let flat = |p: Vec3| Vec2::new(p.x, p.z);
        let (u, v) = (flat(b - a), flat(c - a));
        let whole = u.perp_dot(v);
        if whole == 0.0 {
            continue;
        }
        let (low, high) = (flat(a.min(b).min(c)), flat(a.max(b).max(c)));
        for j in line(low.y).ceil() as u32..=line(high.y).floor() as u32 {
            for i in line(low.x).ceil() as u32..=line(high.x).floor() as u32 {
                let land_m = Vec3::new(field.place_m(i), field.at(i, j), field.place_m(j));
                let at = flat(land_m - a);
                let (s, t) = (at.perp_dot(v) / whole, u.perp_dot(at) / whole);
                if s < 0.0 || t < 0.0 || s + t > 1.0 || !frustum.sees_sphere(land_m, 0.0) {
                    continue;
                }
                let drawn = a.y + s * (b.y - a.y) + t * (c.y - a.y);
                let distance_m = land_m.distance(camera.position_m).max(field.spacing_m);
                let error_px = (drawn - land_m.y).abs() * focal_px / distance_m;
                greatest_px = greatest_px.max(error_px);
                let side_px = field.spacing_m * focal_px / distance_m;
                let pixels = side_px * side_px;
                squares[0] += f64::from(pixels * error_px * error_px);
                squares[1] += f64::from(pixels);
            }
        }
    }
    greatest_px.into()
}
