//! Flying out of a wood: how much each frame differs from the one before, with levels of detail and without. Without them
//! it differs because the camera moves; what levels add is popping that a person can see.

use std::collections::BTreeSet;

use anyhow::Result;
use serde::{Deserialize, Serialize};

use super::bench::{Bench, Run};
use super::experiment::Experiment;
use crate::camera::Camera;
use crate::measure::{flip, fly_out_path};

/// Two frames of a scheme, one after the other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Change {
    pub scheme: String,
    /// The later of the two, from 1.
    pub frame: u32,
    pub flip: f64,
}

/// Frames of the flight where popping is measured in `popping_frames`: the target's 600 for the usual 256.
pub fn frames(popping_frames: u32) -> u32 {
    (600 * popping_frames).div_ceil(256).max(2)
}

/// A whole system of figure 28, with trees near and far.
pub fn experiment() -> Experiment {
    let [_, _, medium, _] = Experiment::of_all();
    medium
}

/// The reference takes long. It is drawn in so many frames: those in which levels change most, and a regular choice of the
/// others. Its worst is at most that of all frames, so the bar is no lower.
fn of_reference(changes: &[Change]) -> Vec<usize> {
    let mut worst: Vec<&Change> = changes.iter().collect();
    worst.sort_by(|a, b| b.flip.total_cmp(&a.flip));
    let each = changes.len().div_ceil(REFERENCES);
    let wanted = worst.into_iter().take(REFERENCES).chain(changes.iter().step_by(each));
    let frames: BTreeSet<usize> = wanted.map(|change| change.frame as usize).collect();
    frames.into_iter().collect()
}

/// Of each of both choices.
const REFERENCES: usize = 32;

/// Pairs of frames that are compared, at most.
pub fn pairs(frames: u32) -> u64 {
    u64::from(frames - 1) + 2 * REFERENCES as u64
}

pub fn measure(bench: &Bench, frames: u32) -> Result<Vec<Change>> {
    let experiment = experiment();
    let scene = bench.read(experiment.scene)?;
    let cameras = fly_out_path(&scene, frames);
    let mut runs = bench.runs(&scene, &experiment)?;
    let (references, levels) = runs.split_at_mut(1);
    let mut rows = Vec::new();
    for run in levels {
        rows.extend(changes(bench, run, &cameras, &(1..cameras.len()).collect::<Vec<_>>())?);
    }
    let wanted = of_reference(&rows);
    for run in references {
        rows.extend(changes(bench, run, &cameras, &wanted)?);
    }
    Ok(rows)
}

/// How a run's frames of these numbers, which rise, differ from those before.
fn changes(bench: &Bench, run: &mut Run, cameras: &[Camera], frames: &[usize]) -> Result<Vec<Change>> {
    let mut rows = Vec::new();
    let mut last: Option<(usize, Vec<u8>)> = None;
    for &frame in frames {
        let mut shoot = |frame: usize| bench.shoot(run, &cameras[frame], &cameras[frame]);
        let before = match last.take().filter(|(known, _)| known + 1 == frame) {
            Some((_, picture)) => picture,
            None => shoot(frame - 1)?,
        };
        let picture = shoot(frame)?;
        let flip = flip(&picture, &before, bench.size_px[0]);
        rows.push(Change { scheme: run.scheme.name.to_owned(), frame: frame as u32, flip });
        last = Some((frame, picture));
        bench.bar.inc(1);
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reference_is_drawn_where_levels_change_most() {
        let change = |frame: u32| Change {
            scheme: String::new(),
            frame,
            flip: if (500..520).contains(&frame) { 0.5 } else { 1e-3 * f64::from(frame % 7) },
        };
        let frames = of_reference(&(1..600).map(change).collect::<Vec<_>>());
        assert!((500..520).all(|frame| frames.contains(&frame)), "{frames:?}");
        assert!(frames.is_sorted() && frames.len() <= 2 * REFERENCES && frames[0] == 1, "{frames:?}");
        assert!(frames.windows(2).all(|pair| pair[1] - pair[0] <= 20), "{frames:?}");
    }
}
