//! What a bake takes for scenes bred as in the thesis (its tables 1 and 2).

use anyhow::Result;
use serde::{Deserialize, Serialize};

use super::bench::Bench;
use crate::baker::laboratory;

/// One task, once.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Task {
    /// Whether it belongs to one tree template; else to a landscape.
    pub of_template: bool,
    pub task: String,
    /// Which scene, from 0.
    pub scene: u32,
    /// On one core.
    pub ms: f64,
}

/// Breeds and bakes that many scenes.
pub fn measure(bench: &Bench, scenes: u32) -> Result<Vec<Task>> {
    let mut done = 0;
    let samples = laboratory::preprocessing(scenes, |now| {
        bench.bar.inc(u64::from(now - done));
        done = now;
    })?;
    let task = |one: laboratory::Sample| Task {
        of_template: one.of_template,
        task: one.task,
        scene: one.scene,
        ms: one.ms,
    };
    Ok(samples.into_iter().map(task).collect())
}
