//! Figures 21 to 27: levels of detail of terrain, and of trees.

use anyhow::Result;

use super::series::{Series, cost};
use crate::lab::equal_cost::{self, Allowed};
use crate::lab::equal_cost_table;
use crate::lab::experiment::{CONTINUOUS, DISCRETE, Experiment, MORPH, ROAM, SIMPLE};
use crate::lab::page::{Block, Finding, Plot, Scale, Section, rounded};
use crate::lab::store::Store;
use crate::lab::walk::Frame;

/// Ratios within this of 1 are "the same".
const SAME: f64 = 0.15;

fn is_same(ratio: f64) -> bool {
    (1.0 - SAME..=1.0 / (1.0 - SAME)).contains(&ratio)
}

fn recording_ms(frame: &Frame) -> Option<f64> {
    Some(frame.recording_ms)
}

fn triangles(frame: &Frame) -> Option<f64> {
    Some(frame.triangles())
}

fn l2(frame: &Frame) -> Option<f64> {
    frame.l2
}

fn plots(series: &[Series], of: impl Fn(&Series) -> Plot) -> Block {
    Block::Plots(series.iter().map(of).collect())
}

/// Figures 21 to 24.
pub fn of_land(store: &Store, software: bool) -> Result<Vec<Section>> {
    let (cost_label, frame_ms) = cost(software);
    let [flat, hills] = Experiment::of_land();
    let both = [Series::read(store, flat)?, Series::read(store, hills)?];
    let ratio = |value: fn(&Frame) -> Option<f64>| {
        [0, 1].map(|n| both[n].mean(ROAM, value) / both[n].mean(MORPH, value))
    };
    let (times, cpu, counts, errors) = (ratio(frame_ms), ratio(recording_ms), ratio(triangles), ratio(l2));
    let share = both.each_ref().map(|one| one.mean(MORPH, recording_ms) / one.mean(MORPH, frame_ms));
    let means = |one: &Series, value: fn(&Frame) -> Option<f64>| {
        [ROAM, MORPH].map(|scheme| rounded(one.mean(scheme, value)))
    };
    let [flat_ms, hills_ms] = both.each_ref().map(|one| means(one, frame_ms));
    let [flat_cpu, _] = both.each_ref().map(|one| means(one, recording_ms));
    let [flat_count, hills_count] = both.each_ref().map(|one| means(one, triangles));
    let [flat_l2, hills_l2] = both.each_ref().map(|one| means(one, l2));
    let speed = Section {
        title: "Figure 21: frame times of the terrain's schemes".into(),
        said: "The land alone. Left flat, right hilly; above whole frames, below what the thesis calls CPU only: all work \
               but drawing. The thesis plots frame rates."
            .into(),
        blocks: vec![
            plots(&both, |one| one.plot("figure-21", cost_label, Scale::Logarithmic, frame_ms)),
            plots(&both, |one| one.plot("figure-21-cpu", "Milliseconds, CPU only", Scale::Logarithmic, recording_ms)),
            Block::Table(both[0].table()),
            Block::Table(both[1].table()),
        ],
        findings: vec![
            Finding::new(
                is_same(times[0]),
                "On flat land ROAM “has performance that is essentially the same as the vertex program algorithm”",
                format!(
                    "ROAM takes {} ms a frame, vertex morph {} ms: {} times as long.",
                    flat_ms[0], flat_ms[1], rounded(times[0])
                ),
            ),
            Finding::new(
                times[1] > 1.0 + SAME,
                "On big hills “the vertex program algorithm heavily out-performs ROAM”",
                format!(
                    "ROAM takes {} ms a frame, vertex morph {} ms: {} times as long.",
                    hills_ms[0], hills_ms[1], rounded(times[1])
                ),
            ),
            Finding::new(
                (0.5..=2.0).contains(&cpu[0]),
                "“Despite the low triangle count, ROAM produces a CPU load comparable to that of the vertex program algorithm”",
                format!(
                    "CPU only, flat: {} ms with ROAM, {} ms with vertex morph: {} times as much.",
                    flat_cpu[0], flat_cpu[1], rounded(cpu[0])
                ),
            ),
            Finding::new(
                share.iter().all(|share| *share > 0.5),
                "“In all cases, the CPU is a bottleneck”",
                format!(
                    "All work but drawing is {} % of a frame with vertex morph on flat land, {} % on hills.",
                    rounded(100.0 * share[0]), rounded(100.0 * share[1])
                ),
            ),
        ],
    };
    let count = Section {
        title: "Figure 22: triangles of the terrain's schemes".into(),
        blocks: vec![plots(&both, |one| one.plot("figure-22", "Triangles", Scale::Logarithmic, triangles))],
        findings: vec![
            Finding::new(
                counts[0] < 1.0,
                "On flat land ROAM “produces few triangles compared to the vertex program algorithm”",
                format!("{} against {}: {} times as many.", flat_count[0], flat_count[1], rounded(counts[0])),
            ),
            Finding::new(
                counts[1] < 1.0 && counts[1] > 0.1,
                "On big hills both “have triangle counts of the same order of magnitude (with fewer triangles for ROAM)”",
                format!(
                    "{} against {}: {} times as many.",
                    hills_count[0],
                    hills_count[1],
                    rounded(counts[1])
                ),
            ),
        ],
        ..Section::default()
    };
    let quality = Section {
        title: "Figure 23: quality of the terrain's schemes".into(),
        said: "Pictures on the way there against pictures of every sample.".into(),
        blocks: vec![
            plots(&both, |one| one.plot("figure-23", "L2 error", Scale::Linear, l2)),
            plots(&both, |one| one.plot("figure-23-flip", "FLIP", Scale::Linear, |frame| frame.flip)),
        ],
        findings: vec![Finding::new(
            errors.iter().all(|ratio| *ratio >= 1.0),
            "“The quality of the vertex program algorithm equals or exceeds that of ROAM”",
            format!(
                "Mean L2 with ROAM and with vertex morph: {} and {} on flat land, {} and {} on hills.",
                flat_l2[0], flat_l2[1], hills_l2[0], hills_l2[1]
            ),
        )],
    };
    let worst = both.each_ref().map(|one| [ROAM, MORPH].map(|scheme| one.popping(scheme).1));
    let popping = Section {
        title: "Figure 24: popping of the terrain's schemes".into(),
        said: "Every frame: the geometry of one frame under the camera of the next against that frame, without culling. The \
               thesis compared every twentieth frame."
            .into(),
        blocks: vec![plots(&both, |one| one.popping_plot("figure-24"))],
        findings: vec![Finding::new(
            worst.iter().all(|[roam, morph]| morph < roam),
            "“Graphics hardware can be used to eliminate the popping effect often associated with level-of-detail schemes” (abstract)",
            format!(
                "The worst frame with ROAM and with vertex morph: {} and {} on flat land, {} and {} on hills.",
                rounded(worst[0][0]), rounded(worst[0][1]), rounded(worst[1][0]), rounded(worst[1][1])
            ),
        )],
    };
    Ok(vec![speed, count, quality, popping])
}

/// Figures 25 to 27.
pub fn of_trees(store: &Store, software: bool) -> Result<Vec<Section>> {
    let (cost_label, frame_ms) = cost(software);
    let mut both = Vec::new();
    let mut errors = Vec::new();
    for mut experiment in Experiment::of_trees() {
        let allowed: Vec<Allowed> = store.rows(&equal_cost_table(experiment.name))?;
        equal_cost::apply(&mut experiment, &allowed);
        let told = allowed.iter().map(|one| {
            format!(
                "{} {} px, {} triangles",
                one.scheme,
                rounded(f64::from(one.error_px)),
                rounded(one.triangles)
            )
        });
        errors.push(format!("{}: {}", experiment.scene.title(), told.collect::<Vec<_>>().join("; ")));
        both.push(Series::read(store, experiment)?);
    }
    let pairs = |a: &str, b: &str, value: fn(&Frame) -> Option<f64>| -> Vec<f64> {
        both.iter().map(|one| one.mean(a, value) / one.mean(b, value)).collect()
    };
    let told = |ratios: &[f64]| {
        let [few, many] = [0, 1].map(|n| rounded(ratios.get(n).copied().unwrap_or(f64::NAN)));
        format!("{few} times as much among few trees, {many} times among many")
    };
    let pays: Vec<f64> = pairs(crate::lab::experiment::NONE, CONTINUOUS, frame_ms);
    let discrete = pairs(DISCRETE, CONTINUOUS, frame_ms);
    let speed = Section {
        title: "Figure 25: frame times of the trees' schemes".into(),
        said: format!(
            "Trees alone. All schemes draw as many triangles, by the error that they are allowed, so that they differ in \
             where and how levels change, not in cost. {}.",
            errors.join(". ")
        ),
        blocks: vec![
            plots(&both, |one| one.plot("figure-25", cost_label, Scale::Logarithmic, frame_ms)),
            plots(&both, |one| {
                one.plot("figure-25-triangles", "Triangles of trees", Scale::Logarithmic, triangles)
            }),
        ]
        .into_iter()
        .chain(both.iter().map(|one| Block::Table(one.table())))
        .collect(),
        findings: vec![
            Finding::new(
                pays.iter().all(|ratio| *ratio > 1.0 + SAME),
                "Levels of detail of trees raise the frame rate in both scenes",
                format!("A frame without them takes, against one with continuous levels, {}.", told(&pays)),
            ),
            Finding::new(
                discrete.iter().all(|ratio| is_same(*ratio)),
                "The continuous scheme “has similar frame rate” to the discrete one",
                format!(
                    "A frame of discrete levels takes, against one of continuous ones, {}.",
                    told(&discrete)
                ),
            ),
        ],
    };
    let simple = pairs(SIMPLE, CONTINUOUS, l2);
    let same_quality = pairs(DISCRETE, CONTINUOUS, l2);
    let [_, hills] = Experiment::of_land();
    let land = Series::read(store, hills)?.mean(MORPH, l2);
    let trees = both.get(1).map_or(f64::NAN, |many| many.mean(CONTINUOUS, l2));
    let quality = Section {
        title: "Figure 26: quality of the trees' schemes".into(),
        said: "Pictures on the way there against pictures of all trees at their finest.".into(),
        blocks: vec![
            plots(&both, |one| one.plot("figure-26", "L2 error", Scale::Linear, l2)),
            plots(&both, |one| one.plot("figure-26-flip", "FLIP", Scale::Linear, |frame| frame.flip)),
        ],
        findings: vec![
            Finding::new(
                simple.iter().all(|ratio| *ratio > 1.0),
                "The simple scheme must “produce more triangles to obtain the same quality”, and “despite this, the quality is lower”",
                format!(
                    "At as many triangles the L2 error of simple is, against that of continuous, {}.",
                    told(&simple)
                ),
            ),
            Finding::new(
                same_quality.iter().all(|ratio| is_same(*ratio)),
                "The continuous scheme has “similar […] quality” to the discrete one",
                format!("The L2 error of discrete is, against that of continuous, {}.", told(&same_quality)),
            ),
            Finding::new(
                (5.0..=20.0).contains(&(trees / land)),
                "“The quality of the level-of-detail scheme for trees is an order of magnitude lower than that of terrain”",
                format!(
                    "Among big hills the L2 error of trees is {}, that of the land {}: {} times as much.",
                    rounded(trees),
                    rounded(land),
                    rounded(trees / land)
                ),
            ),
        ],
    };
    let worst: Vec<[f64; 2]> =
        both.iter().map(|one| [DISCRETE, CONTINUOUS].map(|scheme| one.popping(scheme).1)).collect();
    let ratios: Vec<f64> = worst.iter().map(|[discrete, continuous]| discrete / continuous).collect();
    let popping = Section {
        title: "Figure 27: popping of the trees' schemes".into(),
        said: "As figure 24, at equal cost.".into(),
        blocks: vec![plots(&both, |one| one.popping_plot("figure-27"))],
        findings: vec![Finding::new(
            ratios.iter().all(|ratio| *ratio > 1.0 + SAME),
            "The continuous scheme “does not produce the severe popping that the discrete scheme does”",
            format!(
                "The worst frame of discrete levels pops, against that of continuous ones, {}.",
                told(&ratios)
            ),
        )],
    };
    Ok(vec![speed, quality, popping])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_is_the_same_both_ways() {
        for ratio in [0.86, 1.0, 1.17] {
            assert!(is_same(ratio) && is_same(1.0 / ratio), "{ratio}");
        }
        assert!(!is_same(0.8) && !is_same(1.25) && !is_same(f64::NAN));
    }
}
