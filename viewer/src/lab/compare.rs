//! `viewer lab compare`: two folders of measurements side by side, as ratios.

use std::path::{Path, PathBuf};

use anyhow::Result;
use clap::Args;

use super::experiment::Experiment;
use super::page::{Block, Page, Section, Table, rounded};
use super::preprocessing::Task;
use super::report::{self, Series};
use super::store::{Configuration, Store};
use super::walk::FourViews;
use super::{FOUR_VIEWS, PREPROCESSING};
use crate::measure::{deviation, mean};
use crate::say;

/// What `viewer lab compare` can be asked for.
#[derive(Clone, Debug, Args)]
pub struct CompareArgs {
    /// A folder that `viewer lab` measured into
    pub before: PathBuf,
    /// Another one, of another program or machine
    pub after: PathBuf,
    /// The folder for the page
    #[arg(long, value_name = "DIR", default_value = "laboratory-compared")]
    pub out: PathBuf,
}

/// Ratios beyond so many standard errors differ.
const CLEAR: f64 = 3.0;

/// Writes `compare.html` and `compare.md`.
///
/// # Errors
/// A folder that is no laboratory's, or tables that are damaged.
pub fn run(args: &CompareArgs) -> Result<()> {
    let page = page(&args.before, &args.after)?;
    report::keep(&args.out, "compare", &page)?;
    say!("wrote {}", args.out.join("compare.html").display());
    Ok(())
}

fn page(before: &Path, after: &Path) -> Result<Page> {
    let (a, b) = (Store::read(before)?, Store::read(after)?);
    let mut sections = Vec::new();
    for experiment in Experiment::all() {
        sections.extend(of_experiment(&a.0, &b.0, experiment)?);
    }
    sections.extend(of_the_rest(&a.0, &b.0)?);
    let facts = |name: &str, configuration: &Configuration| {
        let all = configuration.facts().into_iter();
        all.map(|(fact, value)| (format!("{name}: {}", fact.to_lowercase()), value)).collect::<Vec<_>>()
    };
    let facts = [facts("Before", &a.1), facts("After", &b.1)].concat();
    Ok(Page { title: "Two runs of the laboratory".into(), facts, sections })
}

fn of_experiment(before: &Store, after: &Store, experiment: Experiment) -> Result<Option<Section>> {
    let (a, b) = (Series::read(before, experiment.clone())?, Series::read(after, experiment)?);
    if a.frames.is_empty() || b.frames.is_empty() {
        return Ok(None);
    }
    let mut rows = Vec::new();
    for scheme in &a.experiment.schemes {
        for (name, value) in report::FIGURES {
            let [a, b] = [&a, &b].map(|one| one.of(scheme.name, value));
            rows.extend(row(format!("{}: {name}", scheme.name), &a, &b));
        }
        let pops = |one: &Series| -> Vec<f64> {
            one.pops.iter().filter(|pop| pop.scheme == scheme.name).map(|pop| pop.l2).collect()
        };
        rows.extend(row(format!("{}: popping, L2", scheme.name), &pops(&a), &pops(&b)));
    }
    Ok(Some(section(format!("{} ({})", a.experiment.scene.title(), a.experiment.name), rows)))
}

fn of_the_rest(before: &Store, after: &Store) -> Result<Vec<Section>> {
    let four = |store: &Store| -> Result<Vec<f64>> {
        Ok(store.rows::<FourViews>(FOUR_VIEWS)?.iter().map(|frame| frame.frame_ms).collect())
    };
    let rows = row("A frame of four views, ms".into(), &four(before)?, &four(after)?);
    let mut sections = vec![section("Four views".into(), rows.into_iter().collect())];
    let [a, b] = [before, after].map(|store| store.rows::<Task>(PREPROCESSING));
    let (a, b) = (a?, b?);
    let mut names: Vec<&str> = Vec::new();
    for task in &a {
        if !names.contains(&&*task.task) {
            names.push(&task.task);
        }
    }
    let of = |tasks: &[Task], name: &str| -> Vec<f64> {
        tasks.iter().filter(|task| task.task == name).map(|task| task.ms).collect()
    };
    let rows = names.iter().filter_map(|name| row(format!("{name}, ms"), &of(&a, name), &of(&b, name)));
    sections.push(section("Preprocessing".into(), rows.collect()));
    Ok(sections)
}

fn section(title: String, rows: Vec<Vec<String>>) -> Section {
    let head = ["", "Before", "After", "After / before", "Clear"].map(str::to_owned).into();
    let blocks = vec![Block::Table(Table { head, rows, ..Table::default() })];
    Section { title, blocks, ..Section::default() }
}

/// Means, their ratio, and whether they differ by more than chance would have it; nothing without numbers.
fn row(name: String, before: &[f64], after: &[f64]) -> Option<Vec<String>> {
    if before.is_empty() || after.is_empty() {
        return None;
    }
    let (a, b) = (mean(before), mean(after));
    let error = |values: &[f64]| deviation(values) / (values.len() as f64).sqrt();
    let is_clear = (a - b).abs() > CLEAR * libm::hypot(error(before), error(after));
    let clear = if is_clear { "yes" } else { "no" };
    let ratio = if a == b { 1.0 } else { b / a };
    Some(vec![name, rounded(a), rounded(b), rounded(ratio), clear.to_owned()])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_are_of_means_and_chance_is_told() {
        let (a, b) = ([1.0, 2.0, 3.0], [3.9, 4.0, 4.1]);
        let told = row("x".into(), &a, &b).expect("numbers");
        assert_eq!(told, ["x", "2.00", "4.00", "2.00", "yes"]);
        assert_eq!(row("x".into(), &a, &[2.0, 3.0, 2.5]).expect("numbers")[4], "no");
        assert_eq!(row("x".into(), &[0.0], &[0.0]).expect("numbers")[3], "1.00");
        assert_eq!(row("x".into(), &a, &[]), None);
    }
}
