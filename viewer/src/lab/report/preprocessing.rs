//! Tables 1 and 2: preprocessing.

use std::collections::BTreeMap;

use anyhow::Result;

use super::open;
use crate::baker::laboratory::OF_TERRAIN;
use crate::lab::PREPROCESSING;
use crate::lab::page::{Block, Finding, Section, Table, rounded, with_deviation};
use crate::lab::preprocessing::Task;
use crate::lab::store::Store;
use crate::measure::{deviation, mean, quantile};

/// Seconds for one scene, on the thesis's machine: least, mean, and greatest.
const THESIS_S: [f64; 3] = [2.0, 3.12, 4.0];
/// Seconds that the thesis wants it to take at most ("about a second", section 1).
const WANTED_S: f64 = 1.0;

pub fn section(store: &Store) -> Result<Section> {
    let tasks: Vec<Task> = store.rows(PREPROCESSING)?;
    let claim = "“The total preprocessing time for a scene ranges from 2 seconds to 4 seconds, with a mean of 3.12 seconds”, \
                 where “about a second” was wanted";
    let title = "Tables 1 and 2: preprocessing".to_owned();
    if tasks.is_empty() {
        let findings = vec![open(claim, "Preprocessing was not measured.")];
        return Ok(Section { title, findings, ..Section::default() });
    }
    let stages = || tasks.iter().filter(|task| !task.of_template);
    let wholes: Vec<f64> = by_scene(stages()).into_values().map(|ms| ms / 1e3).collect();
    let (mean_s, most_s) = (mean(&wholes), quantile(&wholes, 1.0));
    let steps: Vec<&Task> = tasks.iter().filter(|task| task.of_template).collect();
    let sum_of = |task: &str| steps.iter().filter(|one| one.task == task).map(|one| one.ms).sum::<f64>();
    let all: f64 = steps.iter().map(|one| one.ms).sum();
    let progressive = sum_of("progressive mesh");
    Ok(Section {
        title,
        said: format!(
            "On one core, over {} scenes bred with the first of the four always chosen, the first four left out. The \
             thesis's scenes had five templates as well; its preprocessing began with finished meshes and heights, and had \
             neither pictures of trees nor clouds to make.",
            wholes.len()
        ),
        blocks: vec![
            Block::Table(table("Table 1: one tree template", &steps)),
            Block::Table(table(
                "Table 2: terrain",
                &stages().filter(|task| OF_TERRAIN.contains(&&*task.task)).collect::<Vec<_>>(),
            )),
            Block::Table(table("All stages of a scene", &stages().collect::<Vec<_>>())),
        ],
        findings: vec![
            Finding::new(
                mean_s <= WANTED_S && most_s < THESIS_S[2],
                claim,
                format!(
                    "One scene takes {} s, {} s at most; the thesis's mean is {} times as much.",
                    with_deviation(mean_s, deviation(&wholes)),
                    rounded(most_s),
                    rounded(THESIS_S[1] / mean_s)
                ),
            ),
            Finding::new(
                progressive > 0.5 * all,
                "Creating the progressive mesh is the greater part of a tree's preprocessing (table 1 and its text)",
                format!("It is {} % of what a template takes.", rounded(100.0 * progressive / all)),
            ),
        ],
    })
}

/// Milliseconds of each scene.
fn by_scene<'a>(tasks: impl Iterator<Item = &'a Task>) -> BTreeMap<u32, f64> {
    let mut sums = BTreeMap::new();
    tasks.for_each(|task| *sums.entry(task.scene).or_default() += task.ms);
    sums
}

/// As the thesis's tables: what a task takes once, and in a whole scene.
fn table(caption: &str, tasks: &[&Task]) -> Table {
    let mut names: Vec<&str> = Vec::new();
    for task in tasks {
        if !names.contains(&&*task.task) {
            names.push(&task.task);
        }
    }
    let cells = |once: &[f64], of: Vec<&Task>| {
        let scenes: Vec<f64> = by_scene(of.into_iter()).into_values().collect();
        let figures = [mean(once), deviation(once), mean(&scenes), deviation(&scenes)];
        figures.map(rounded).to_vec()
    };
    let row = |name: &&str| {
        let of: Vec<&Task> = tasks.iter().copied().filter(|task| task.task == *name).collect();
        let once: Vec<f64> = of.iter().map(|task| task.ms).collect();
        [vec![(*name).to_owned()], cells(&once, of)].concat()
    };
    let mut rows: Vec<Vec<String>> = names.iter().map(row).collect();
    let scenes: Vec<f64> = by_scene(tasks.iter().copied()).into_values().collect();
    let total = [mean(&scenes), deviation(&scenes)].map(rounded);
    rows.push([vec!["Total".into(), String::new(), String::new()], total.to_vec()].concat());
    let head = ["Task", "Once, ms", "deviation", "A scene, ms", "deviation"].map(str::to_owned);
    Table { caption: caption.to_owned(), head: head.into(), rows }
}
