//! What levels of detail must reach here: rows with reached or not, of what the laboratory measures.

use anyhow::Result;

use super::open;
use super::series::{Series, mean_of};
use crate::lab::experiment::{CONTINUOUS, Experiment, NONE, ROAM, ROUGHNESS, SIMPLE, USUAL};
use crate::lab::page::{Finding, Section, rounded};
use crate::lab::store::Store;

/// Levels pay at least so much, in processor time.
const MIN_PAY: f64 = 6.0;
/// What the worst frame may change by its levels alone, in FLIP.
const MAX_POP: f64 = 0.005;

pub fn section(store: &Store) -> Result<Section> {
    let read = |experiment: Experiment| Series::read(store, experiment);
    let wholes = Experiment::of_all().into_iter().map(read).collect::<Result<Vec<_>>>()?;
    let trees = Experiment::of_trees().into_iter().map(read).collect::<Result<Vec<_>>>()?;
    let lands = Experiment::of_land().into_iter().map(read).collect::<Result<Vec<_>>>()?;
    let mut findings = Vec::new();

    let cpu = |one: &Series, scheme: &str| one.mean(scheme, |frame| Some(frame.processor_ms));
    let pays: Vec<f64> = wholes.iter().map(|one| cpu(one, NONE) / cpu(one, USUAL)).collect();
    let pay = mean_of(pays.iter().copied());
    findings.push(Finding::new(
        pay >= MIN_PAY,
        "Levels pay at least 6 times in processor time, on the mean of four landscapes",
        format!("Over the scenes of figure 28: {} times ({}).", rounded(pay), list(&pays)),
    ));
    let l2 = |one: &Series, scheme: &str| one.mean(scheme, |frame| frame.l2);
    let ratios: Vec<f64> = trees.iter().map(|one| l2(one, CONTINUOUS) / l2(one, SIMPLE)).collect();
    findings.push(Finding::new(
        ratios.iter().all(|ratio| *ratio <= 1.0),
        "L2 at equal triangles, quality over simple: at most 1",
        format!("Among few and among many trees: {}.", list(&ratios)),
    ));
    let worst = |one: &Series, scheme: &str| {
        one.pops.iter().filter(|pop| pop.scheme == scheme).map(|pop| pop.flip).fold(0.0, f64::max)
    };
    let pops: Vec<f64> = trees.iter().map(|one| worst(one, SIMPLE)).collect();
    findings.push(Finding::new(
        pops.iter().all(|pop| *pop <= MAX_POP),
        "From frame to frame of a walk, FLIP is at most 0.005 above that of full resolution, in the worst frame",
        format!("FLIP by the levels of trees alone, few and many, as the window chooses them: {}.", list(&pops)),
    ));
    let recording = |one: &Series, scheme: &str| one.mean(scheme, |frame| Some(frame.recording_ms));
    let ratios: Vec<f64> = lands.iter().map(|one| recording(one, ROUGHNESS) / recording(one, ROAM)).collect();
    findings.push(Finding::new(
        ratios.iter().all(|ratio| *ratio < 1.0),
        "CPU time of the terrain below that of the thesis's algorithms",
        format!("Vertex morph by roughness over ROAM, flat and hilly: {}.", list(&ratios)),
    ));
    for (claim, command) in [
        (
            "Coverage of trees within 1 ± 0.02 at each level, FLIP at 1/16, halves of vertices",
            "viewer lab trees",
        ),
        ("Recording a frame flat to 100,000 trees", "viewer bench --only record"),
        ("Land within 1 px from 200 cameras, with a quarter of the triangles", "viewer bench --only land"),
        ("Progressive mesh at 0.5 million triangles a second and core", "cargo xtask bench"),
        ("No cracks in the land at any morph", "cargo xtask test"),
    ] {
        findings.push(open(claim, &format!("Not measured here: {command} tells.")));
    }
    Ok(Section {
        title: "What levels of detail must reach".into(),
        said: "Targets of this project, beyond the thesis.".into(),
        findings,
        ..Section::default()
    })
}

fn list(values: &[f64]) -> String {
    values.iter().map(|value| rounded(*value)).collect::<Vec<_>>().join(", ")
}
