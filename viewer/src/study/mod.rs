//! `viewer study`: one participant after the other walks through the same landscapes under hidden conditions, in balanced order,
//! and answers the questionnaire after each walk; all of it becomes one table.
//!
//! [`config`] says what is studied, [`order`] in which order, [`table`] makes the table. Each walk is a window of its own.

mod config;
mod order;
mod table;

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};
use clap::{Args, ValueEnum};
use genescape_world::{Source, atomic_write};

use crate::headless::scene_files;
use crate::say;
use config::{Condition, Study};

/// What `viewer study` can be asked for.
#[derive(Clone, Debug, Args)]
pub struct StudyArgs {
    /// What is studied: landscapes, conditions, and where results go
    #[arg(value_name = "CONFIG.ron")]
    pub config: PathBuf,

    /// Go on with this participant instead of beginning with another
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_PARTICIPANTS))]
    pub participant: Option<u32>,

    /// Only write the table of what there is
    #[arg(long, conflicts_with = "participant")]
    pub table: bool,
}

const MAX_PARTICIPANTS: i64 = 999;
/// A participant's walks in their order: a file of the participant's folder.
const WALKS: &str = "walks.ron";
/// The table of all.
const TABLE: &str = "study.csv";

/// Leads one participant through all walks that are left, and writes the table.
///
/// # Errors
/// A configuration that is wrong, landscapes that are not baked, a folder that cannot be written to, a window that cannot be
/// opened.
pub fn run(args: &StudyArgs) -> Result<()> {
    let study = Study::read(&args.config)?;
    if !args.table {
        // Nobody waits for a bake in a study.
        scene_files(&Source::of(&study.world)?)?;
        let number = match args.participant {
            Some(number) => number,
            None => next_participant(&study.out)?,
        };
        lead(&study, number)?;
    }
    let rows = table::rows(&participants(&study.out)?)?;
    let path = study.out.join(TABLE);
    atomic_write::replace(&path, table::to_csv(&rows)?)
        .with_context(|| format!("cannot write {}", path.display()))?;
    say!("wrote {} ({} values)", path.display(), rows.len());
    Ok(())
}

/// Opens a window for each walk that has no answers yet.
fn lead(study: &Study, number: u32) -> Result<()> {
    let folder = folder_of(&study.out, number);
    let walks = match read_walks(&folder) {
        Ok(walks) => walks,
        Err(_) if !folder.join(WALKS).exists() => {
            let order = order::williams(study.conditions.len());
            let order = &order[(number as usize - 1) % order.len()];
            let walks: Vec<Condition> = order.iter().map(|at| study.conditions[*at].clone()).collect();
            let text = ron::ser::to_string_pretty(&walks, Default::default())?;
            atomic_write::create(&folder.join(WALKS), text)
                .with_context(|| format!("cannot write into {}", folder.display()))?;
            walks
        }
        Err(error) => return Err(error),
    };
    for (period, condition) in (1..).zip(&walks) {
        let answers = answers_of(&folder, period);
        if answers.exists() {
            continue;
        }
        say!("participant {number}, walk {period} of {}: press Q to answer", walks.len());
        let status = walk(study, condition, &folder, period)?.status().context("the window does not open")?;
        ensure!(status.success(), "the window of walk {period} failed");
        if !answers.exists() {
            say!("stopped before the answers; `viewer study CONFIG.ron --participant {number}` goes on");
            return Ok(());
        }
    }
    Ok(())
}

/// The command that opens a walk's window.
fn walk(study: &Study, condition: &Condition, folder: &Path, period: u32) -> Result<Command> {
    let mut viewer =
        Command::new(std::env::current_exe().context("the system does not say where this program is")?);
    viewer.args(["--no-bake", "--world"]).arg(&study.world);
    // Of its own, so that nothing of the participant's own settings counts.
    viewer.arg("--settings").arg(folder.join(format!("settings-{period}.ron")));
    viewer.arg("--answers").arg(answers_of(folder, period));
    viewer.arg("--log").arg(log_of(folder, period));
    let Condition { tree_lod, terrain_lod, tree_error_px, terrain_error_px, .. } = condition;
    let word = |value: Option<clap::builder::PossibleValue>| value.map(|value| value.get_name().to_owned());
    let (trees, land) = (word(tree_lod.to_possible_value()), word(terrain_lod.to_possible_value()));
    viewer.args(["--tree-lod", &trees.unwrap_or_default(), "--terrain-lod", &land.unwrap_or_default()]);
    viewer.args(["--tree-error", &tree_error_px.to_string()]);
    viewer.args(["--terrain-error", &terrain_error_px.to_string(), "--samples", "1"]);
    Ok(viewer)
}

fn folder_of(out: &Path, number: u32) -> PathBuf {
    out.join(format!("participant-{number:03}"))
}

fn answers_of(folder: &Path, period: u32) -> PathBuf {
    folder.join(format!("answers-{period}.ron"))
}

fn log_of(folder: &Path, period: u32) -> PathBuf {
    folder.join(format!("log-{period}.jsonl"))
}

/// Numbers and folders of all who began.
fn participants(out: &Path) -> Result<Vec<(u32, PathBuf)>> {
    let entries = match fs::read_dir(out) {
        Ok(entries) => entries,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(error).with_context(|| format!("cannot read {}", out.display())),
    };
    let mut found = Vec::new();
    for entry in entries {
        let name = entry?.file_name();
        let number = name.to_str().and_then(|name| name.strip_prefix("participant-")?.parse().ok());
        found.extend(number.map(|number| (number, folder_of(out, number))));
    }
    found.sort();
    Ok(found)
}

fn next_participant(out: &Path) -> Result<u32> {
    let last = participants(out)?.last().map_or(0, |(number, _)| *number);
    if i64::from(last) >= MAX_PARTICIPANTS {
        bail!(
            "{} has {MAX_PARTICIPANTS} participants; name another folder in the configuration",
            out.display()
        );
    }
    Ok(last + 1)
}

fn read_walks(folder: &Path) -> Result<Vec<Condition>> {
    let path = folder.join(WALKS);
    let text = fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
    ron::from_str(&text).with_context(|| format!("{} is damaged", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn participants_are_counted_and_each_gets_the_next_order() {
        let folder = tempfile::tempdir().expect("a folder");
        assert_eq!(next_participant(folder.path()).expect("none yet"), 1);
        fs::create_dir(folder.path().join("participant-007")).expect("made");
        fs::create_dir(folder.path().join("participant-x")).expect("made");
        assert_eq!(next_participant(folder.path()).expect("one"), 8);
        assert_eq!(participants(folder.path()).expect("one").len(), 1);
        assert_eq!(next_participant(&folder.path().join("none")).expect("none yet"), 1);
    }

    #[test]
    fn a_walk_is_drawn_by_its_condition() {
        let study = Study::parse("a.ron", config::EXAMPLE).expect("valid");
        let command = walk(&study, &study.conditions[1], Path::new("p"), 2).expect("a program");
        let words: Vec<String> = command.get_args().map(|word| word.to_string_lossy().into_owned()).collect();
        let cli =
            <crate::cli::Cli as clap::Parser>::try_parse_from([vec!["viewer".to_owned()], words].concat());
        let cli = cli.expect("a command of this program");
        let condition = &study.conditions[1];
        assert_eq!(
            (cli.drawing.tree_lod, cli.drawing.tree_error_px),
            (condition.tree_lod, condition.tree_error_px)
        );
        assert_eq!(cli.drawing.terrain_lod, condition.terrain_lod);
        assert_eq!(cli.answers, Some(PathBuf::from("p/answers-2.ron")));
    }
}
