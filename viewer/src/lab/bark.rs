//! Bark as lists of triangles and as strips (thesis section 4.4.1): how many indices each takes.

use anyhow::Result;
use serde::{Deserialize, Serialize};

use super::bench::Bench;
use super::experiment::Experiment;
use crate::scene::{Range, Template};

/// The bark of one level of one template.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Indices {
    pub template: String,
    /// 0 is the finest.
    pub level: u32,
    pub triangles: u32,
    pub list: u32,
    /// With those of triangles without area, by which a strip turns corners.
    pub strip: u32,
}

/// Of all templates of the scene.
pub fn measure(bench: &Bench) -> Result<Vec<Indices>> {
    let scene = bench.read(Experiment::of_bark().scene)?;
    bench.bar.inc(1);
    Ok(scene.trees.templates.iter().flat_map(|template| of(template)).collect())
}

fn of(template: &Template) -> Vec<Indices> {
    let count = |ranges: &[Range]| {
        let closed = ranges.iter().zip(&template.materials).filter(|(_, one)| one.alpha_cutoff.is_none());
        closed.map(|(range, _)| range.count).sum()
    };
    let of_level = |(level, one): (u32, &crate::scene::Level)| {
        let (list, strip) = (count(&one.ranges), count(&one.strips));
        Indices { template: template.name.clone(), level, triangles: list / 3, list, strip }
    };
    (0..).zip(&template.levels).map(of_level).collect()
}
