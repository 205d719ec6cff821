//! What the frame of a walk takes where the processor draws: four views at the resolution that pictures have while the
//! camera moves, whole and without one thing after the other. All walk from where the window shows them first.

use anyhow::Result;

use super::Bench;
use super::report::Aim;
use crate::camera::Camera;
use crate::measure::{Cost, median, tree_triangles};
use crate::options::{FrameInput, Options};
use crate::scene::Scene;
use crate::view::View;
use crate::walk::{Land, Pose, Rig, start_pose};

/// Each picture is drawn so often; the cheapest counts.
const ROUNDS: usize = 3;
/// Sides of the pictures as a part of full resolution: the coarsest of the window.
const PART: f32 = 0.375;
/// Metres from place to place.
const STEP_M: f32 = 3.0;
/// Ten frames a second on two cores.
const AIM_MS: f64 = 200.0;

pub(super) fn measure(bench: &mut Bench) -> Result<()> {
    let [width, height] = bench.size_px;
    bench.report.section(format!(
        "A walk's frame: four views at {PART} of {width} × {height} together, milliseconds of processors, median of all places"
    ));
    let paths = bench.paths.iter().cycle().take(4);
    let scenes = paths.map(|path| bench.headless.read(path)).collect::<Result<Vec<_>>>()?;
    let places = first_steps(&scenes, bench.steps);
    let size_px = bench.size_px.map(|side| (side as f32 * PART / 2.0) as u32);
    let mut views = scenes.iter().map(|scene| bench.view(scene, size_px)).collect::<Result<Vec<_>>>()?;
    let all = Options::default();
    let kinds = [
        ("all", all),
        ("without trees", Options { draw_trees: false, ..all }),
        ("without grass", Options { grass: false, ..all }),
        ("without land and grass", Options { draw_terrain: false, grass: false, ..all }),
        ("sky and water alone", Options { draw_terrain: false, draw_trees: false, grass: false, ..all }),
    ];
    for (name, options) in kinds {
        let frame = FrameInput { options, part: PART, ..FrameInput::default() };
        let mut cheapest = |cameras: &Vec<Camera>| {
            let costs = (0..ROUNDS).map(|_| cost(bench, &mut views, &frame, cameras));
            costs.fold(Cost::MAX, Cost::least).cpu_ms
        };
        let times: Vec<f64> = places.iter().map(&mut cheapest).collect();
        if options == all {
            let triangles =
                views.iter().map(|view| tree_triangles(&bench.headless.gpu, view)).sum::<Result<u64>>()?;
            bench.report.aimed(name, median(&times), "ms", Aim::AtMost(AIM_MS));
            bench.report.figure("triangles of trees at the last place", triangles as f64, "");
        } else {
            bench.report.figure(name, median(&times), "ms");
        }
    }
    Ok(())
}

/// Straight ahead from where each of them is first seen: cameras of all, place by place.
fn first_steps(scenes: &[Scene], steps: u32) -> Vec<Vec<Camera>> {
    let lands: Vec<Land> = scenes.iter().map(|scene| Land::of(scene).from_its_start()).collect();
    let lands: Vec<&Land> = lands.iter().collect();
    let (start, fov_y_rad) = (start_pose(&lands), Options::default().fov_y_deg.to_radians());
    let at = |step: u32| {
        let rig = Rig::new(Pose { z_m: start.z_m - step as f32 * STEP_M, ..start }, &lands);
        lands.iter().map(|land| rig.camera(land, fov_y_rad)).collect()
    };
    (0..steps).map(at).collect()
}

/// What one picture of each view takes, each by its own camera, waited for.
fn cost(bench: &Bench, views: &mut [View], frame: &FrameInput, cameras: &[Camera]) -> Cost {
    let headless = &bench.headless;
    let work = || {
        let each = views.chunks_mut(1).zip(cameras);
        headless.gpu.queue.submit(each.map(|(view, camera)| headless.record(view, frame, camera, camera).0));
        headless.gpu.wait();
    };
    Cost::of(work).0
}
