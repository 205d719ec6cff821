//! Section 4.4.1: bark as triangle strips, or as lists.

use anyhow::Result;

use super::open;
use super::series::{Series, cost};
use crate::lab::BARK_INDICES;
use crate::lab::bark::Indices;
use crate::lab::experiment::{Experiment, LISTS, STRIPS};
use crate::lab::page::{Block, Finding, Scale, Section, Table, rounded};
use crate::lab::store::Store;

pub fn section(store: &Store, software: bool) -> Result<Section> {
    let (cost_label, cost) = cost(software);
    let walk = Series::read(store, Experiment::of_bark())?;
    let indices: Vec<Indices> = store.rows(BARK_INDICES)?;
    let (list, strip): (f64, f64) = indices
        .iter()
        .fold((0.0, 0.0), |(list, strip), one| (list + f64::from(one.list), strip + f64::from(one.strip)));
    let levels = indices.iter().map(|one| one.level + 1).max().unwrap_or(0);
    let row = |level: u32| {
        let of = |number: fn(&Indices) -> u32| {
            indices.iter().filter(|one| one.level == level).map(|one| f64::from(number(one))).sum::<f64>()
        };
        let (triangles, list, strip) = (of(|one| one.triangles), of(|one| one.list), of(|one| one.strip));
        let cells = [triangles, list, strip].map(|number| number.to_string()).into_iter();
        let name = std::iter::once(format!("D{level}"));
        name.chain(cells).chain([rounded(strip / triangles.max(1.0))]).collect()
    };
    let head = ["", "Triangles", "Indices of lists", "Indices of strips", "of strips, a triangle"];
    let table = Table {
        caption: "Bark of all templates together, level by level".into(),
        head: head.map(str::to_owned).into(),
        rows: (0..levels).map(row).collect(),
    };
    let mean_of = |value: super::series::Figure| [STRIPS, LISTS].map(|scheme| walk.mean(scheme, value.1));
    let [strips_ms, lists_ms] = mean_of(("", cost));
    let vertices = mean_of(("", |frame| frame.vertices.map(|number| number as f64)));
    let cache = "The order of strips “will improve the cache hit rate by reusing recently used vertices”";
    let is_counted = vertices[1] > 0.0;
    Ok(Section {
        title: "Section 4.4.1: bark by strips or by lists".into(),
        said: "All trees at their finest, the same pictures; leaves are lists in both. Without levels of detail, so that bark \
               is as much of a frame as it can be."
            .into(),
        blocks: vec![
            Block::Plots(vec![walk.plot("bark", cost_label, Scale::Linear, cost)]),
            Block::Table(walk.table()),
            Block::Table(table),
        ],
        findings: vec![
            Finding::new(
                strip <= 0.5 * list,
                "“If long strips are used, then only a third as much data is required” (2.2)",
                format!("Strips have {} times as many indices as lists.", rounded(strip / list)),
            ),
            if is_counted {
                Finding::new(
                    vertices[0] < vertices[1],
                    cache,
                    format!("With strips the device runs {} times as many vertices.", rounded(vertices[0] / vertices[1])),
                )
            } else {
                open(cache, "This device does not count vertices.")
            },
            Finding::new(
                strips_ms < lists_ms,
                "Strips pay, and so the thesis draws bark by them",
                format!("A frame with strips takes {} times as long as one with lists.", rounded(strips_ms / lists_ms)),
            ),
        ],
    })
}
