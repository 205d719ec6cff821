//! What levels of detail must reach here: rows with reached or not, of what the laboratory measures.

use anyhow::Result;

use super::open;
use super::series::{Series, mean_of};
use crate::lab::chain::{MAX_COVERAGE_ERROR, MAX_HALF_ERROR};
use crate::lab::experiment::{CONTINUOUS, Experiment, NONE, ROAM, ROUGHNESS, SIMPLE, USUAL};
use crate::lab::fly_out::Change;
use crate::lab::page::{Finding, Section, rounded};
use crate::lab::store::Store;
use crate::lab::tree_levels::TreeLevel;
use crate::lab::{FLY_OUT, TREE_LEVELS};
use crate::lod::tree::MAX_LEVELS;
use crate::measure::{median, quantile, spearman};

/// Levels pay at least so much, in processor time.
const MIN_PAY: f64 = 6.0;
/// What the worst frame may change by its levels alone, in FLIP.
const MAX_POP: f64 = 0.005;
/// FLIP at a sixteenth of the vertices: median, worst.
const MAX_FLIPS: [f64; 2] = [0.10, 0.16];
/// Rank correlation of stored error and FLIP between templates.
const MIN_SPEARMAN: f64 = 0.95;

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
    findings.push(of_flight(&store.rows(FLY_OUT)?));
    findings.extend(of_trees(&store.rows(TREE_LEVELS)?));
    let recording = |one: &Series, scheme: &str| one.mean(scheme, |frame| Some(frame.recording_ms));
    let ratios: Vec<f64> = lands.iter().map(|one| recording(one, ROUGHNESS) / recording(one, ROAM)).collect();
    findings.push(Finding::new(
        ratios.iter().all(|ratio| *ratio < 1.0),
        "CPU time of the terrain below that of the thesis's algorithms",
        format!("Vertex morph by roughness over ROAM, flat and hilly: {}.", list(&ratios)),
    ));
    for (claim, command) in [
        ("FLIP of each level of a tree at most that of meshoptimizer", "viewer lab trees"),
        ("three.js with full trees at least twice, and 6 times with levels", "cargo xtask bench"),
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

/// Of the frames that were drawn without levels as well.
fn of_flight(changes: &[Change]) -> Finding {
    let of = |scheme: &'static str| changes.iter().filter(move |one| one.scheme == scheme);
    let more = |without: &Change| {
        of(USUAL).find(|with| with.frame == without.frame).map(|with| with.flip - without.flip)
    };
    let most = of(NONE).filter_map(more).fold(f64::MIN, f64::max);
    Finding::new(
        most <= MAX_POP,
        "Flying out, FLIP from frame to frame is at most 0.005 above that without levels, in the worst frame",
        format!(
            "It is {} more at most, in {} frames of {} that were drawn without levels as well: those with most change among them.",
            rounded(most),
            of(NONE).count(),
            of(USUAL).count()
        ),
    )
}

/// Of trees of the test scenes and of random landscapes.
fn of_trees(levels: &[TreeLevel]) -> Vec<Finding> {
    let coarse: Vec<&TreeLevel> = levels.iter().filter(|one| one.level > 0).collect();
    let kept = coarse.iter().filter(|one| (one.coverage - 1.0).abs() <= MAX_COVERAGE_ERROR).count();
    let pairs = levels.windows(2).filter(|pair| pair[1].level == pair[0].level + 1);
    let shares: Vec<f64> =
        pairs.map(|pair| f64::from(pair[1].vertices) / f64::from(pair[0].vertices.max(1))).collect();
    let halves = shares.iter().filter(|share| (*share - 0.5).abs() <= 0.5 * MAX_HALF_ERROR).count();
    let at = |level: u32| levels.iter().filter(move |one| one.level == level);
    let flips: Vec<f64> = at(4).map(|one| one.flip).collect();
    let flips = [median(&flips), quantile(&flips, 1.0)];
    let ranks = (1..=MAX_LEVELS as u32).filter_map(|level| {
        spearman(&at(level).map(|one| (one.relative_error, one.flip)).collect::<Vec<_>>())
    });
    let ranks: Vec<f64> = ranks.collect();
    vec![
        Finding::new(
            kept == coarse.len(),
            "Trees cover within 1 ± 0.02 of what the full tree covers, at each level",
            format!(
                "{kept} of {} levels do, of trees of the test scenes and of random landscapes.",
                coarse.len()
            ),
        ),
        Finding::new(
            halves == shares.len(),
            "Each level of a tree has half of the vertices before, to 1 %",
            format!("{halves} of {} do.", shares.len()),
        ),
        Finding::new(
            flips.iter().zip(MAX_FLIPS).all(|(flip, most)| *flip <= most),
            "FLIP of trees at a sixteenth of their vertices: median at most 0.10, worst 0.16",
            format!("As the laboratory draws them, in their light: {}.", list(&flips)),
        ),
        Finding::new(
            ranks.iter().all(|rank| *rank >= MIN_SPEARMAN),
            "Stored errors of trees and FLIP are in one order between templates: Spearman at least 0.95 at each level",
            format!("From D1 on: {}.", list(&ranks)),
        ),
    ]
}

fn list(values: &[f64]) -> String {
    values.iter().map(|value| rounded(*value)).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::page::Verdict;

    #[test]
    fn a_flight_pops_where_levels_change_more_than_the_camera_does() {
        let change = |scheme: &str, frame: u32, flip: f64| Change { scheme: scheme.to_owned(), frame, flip };
        // A tree close by passes in frame 2.
        let still =
            [change(NONE, 2, 0.6), change(NONE, 9, 0.01), change(USUAL, 2, 0.601), change(USUAL, 9, 0.014)];
        assert_eq!(of_flight(&still).verdict, Verdict::Holds);
        let popping = [&still[..3], &[change(USUAL, 9, 0.02)]].concat();
        assert_eq!(of_flight(&popping).verdict, Verdict::HoldsNot);
    }
}
