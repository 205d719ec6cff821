//! Popping (figures 24 and 27): the geometry of one frame under the camera of the next, against that frame. Without culling,
//! for else there would be holes where the camera has turned to.

use anyhow::Result;
use serde::{Deserialize, Serialize};

use super::bench::Bench;
use super::experiment::Experiment;
use crate::measure::{camera_path, flip, l2};

/// How much one frame changes by its levels of detail alone.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pop {
    pub scheme: String,
    /// The later of two frames, from 1.
    pub frame: u32,
    pub l2: f64,
    pub flip: f64,
}

/// Every frame of a walk across the land, for each scheme but the reference, which has no levels.
pub fn measure(bench: &Bench, experiment: &Experiment, frames: u32) -> Result<Vec<Pop>> {
    let scene = bench.read(experiment.scene)?;
    let cameras = camera_path(&scene, frames);
    let mut runs = bench.runs(&scene, experiment)?;
    let mut pops = Vec::new();
    for run in &mut runs {
        run.frame.options.cull = false;
    }
    for (frame, pair) in (1..).zip(cameras.windows(2)) {
        for run in &mut runs[1..] {
            let old_levels = bench.shoot(run, &pair[1], &pair[0])?;
            let new_levels = bench.shoot(run, &pair[1], &pair[1])?;
            let (l2, same) = (l2(&new_levels, &old_levels), new_levels == old_levels);
            let flip = if same { 0.0 } else { flip(&new_levels, &old_levels, bench.size_px[0]) };
            pops.push(Pop { scheme: run.scheme.name.to_owned(), frame, l2, flip });
        }
        bench.bar.inc(1);
    }
    Ok(pops)
}
