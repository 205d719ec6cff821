//! Figure 28: the whole system.

use anyhow::Result;

use super::open;
use super::series::{self, Series};
use crate::lab::FOUR_VIEWS;
use crate::lab::experiment::{Experiment, USUAL};
use crate::lab::page::{Block, Finding, Line, Mark, Plot, Scale, Section, rounded};
use crate::lab::store::Store;
use crate::lab::walk::{FourViews, Frame};
use crate::measure::mean;

/// Frames a second that the thesis wants of four views; of one, four times as many.
const WANTED_FPS: f64 = 15.0;

pub fn section(store: &Store) -> Result<Section> {
    let all = Experiment::of_all().map(|one| Series::read(store, one));
    let all = all.into_iter().collect::<Result<Vec<_>>>()?;
    let four: Vec<FourViews> = store.rows(FOUR_VIEWS)?;
    let rate = |frame: &Frame| 1e3 / frame.frame_ms;
    let lines = |value: &dyn Fn(&Frame) -> Option<f64>| {
        let line = |(style, one): (usize, &Series)| {
            let frames = one.frames.iter().filter(|frame| frame.scheme == USUAL);
            let points = frames.filter_map(|frame| Some((f64::from(frame.frame), value(frame)?))).collect();
            Line { name: short(one), style: style + 1, points }
        };
        (0..).zip(&all).map(line).collect::<Vec<_>>()
    };
    let plot = |name: &str, title: &str, y_label: &str| Plot {
        name: name.to_owned(),
        title: title.to_owned(),
        x_label: "Frame".into(),
        y_label: y_label.to_owned(),
        ..Plot::default()
    };
    let mark = |y: f64| vec![Mark { name: format!("the thesis's aim, {y}"), y }];
    let rates = Plot {
        lines: lines(&|frame| Some(rate(frame))),
        marks: mark(4.0 * WANTED_FPS),
        scale: Scale::Logarithmic,
        ..plot("figure-28", "Frame rates of single views", "Frames a second")
    };
    let quality =
        Plot { lines: lines(&|frame| frame.l2), ..plot("figure-28-quality", "Quality", "L2 error") };
    let points = four.iter().map(|frame| (f64::from(frame.frame), 1e3 / frame.frame_ms)).collect();
    let together = Plot {
        lines: vec![Line { name: "four views".into(), style: 2, points }],
        marks: mark(WANTED_FPS),
        scale: Scale::Logarithmic,
        ..plot("figure-28-four", "All four in one frame", "Frames a second")
    };
    let slowest = |rates: &mut dyn Iterator<Item = f64>| rates.fold(f64::MAX, f64::min);
    let singles = all.iter().flat_map(|one| &one.frames).filter(|frame| frame.scheme == USUAL).map(rate);
    let single = slowest(&mut singles.collect::<Vec<_>>().into_iter());
    let rates_of_four: Vec<f64> = four.iter().map(|frame| 1e3 / frame.frame_ms).collect();
    let claim = "“The target frame rate was easily achieved”: 15 frames a second of four views, 60 of one";
    let finding = if four.is_empty() {
        open(claim, "Four views were not measured.")
    } else {
        let least = slowest(&mut rates_of_four.iter().copied());
        Finding::new(
            least >= WANTED_FPS && single >= 4.0 * WANTED_FPS,
            claim,
            format!(
                "Four views reach {} frames a second on average and {} at worst; single ones {} at worst.",
                rounded(mean(&rates_of_four)),
                rounded(least),
                rounded(single)
            ),
        )
    };
    let columns = all.iter().map(|one| one.figures(USUAL)).collect();
    let table = series::table("As the window draws", all.iter().map(short), columns);
    Ok(Section {
        title: "Figure 28: the whole system".into(),
        said:
            "Land, trees, grass and sky as the window draws them, one scene at a time; and all four at once."
                .into(),
        blocks: vec![Block::Plots(vec![rates, quality, together]), Block::Table(table)],
        findings: vec![finding],
    })
}

fn short(series: &Series) -> String {
    let title = series.experiment.scene.title();
    title.split(',').next().unwrap_or(title).to_owned()
}
