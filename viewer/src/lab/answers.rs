//! `viewer lab answers`: the thesis's analysis of its questionnaire (8.5, table 3) over files of answers.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, ensure};
use clap::Args;
use genescape_world::{names, regular_file};
use strum::VariantArray;

use super::page::{Block, Finding, Line, Page, Plot, Section, Table, rounded};
use super::report;
use crate::lod_mode::LodMode;
use crate::measure::{deviation, mean, t_test};
use crate::questionnaire::{AnswerSheet, Aspect, MAX_BYTES, MAX_RATING, Question};
use crate::say;

/// What `viewer lab answers` can be asked for.
#[derive(Clone, Debug, Args)]
pub struct AnswersArgs {
    /// Folders of answers, or worlds with answers beside them
    #[arg(value_name = "FOLDER", required = true)]
    pub folders: Vec<PathBuf>,

    /// The folder for the page
    #[arg(long, value_name = "DIR", default_value = "laboratory-answers")]
    pub out: PathBuf,
}

/// Results that chance gives less often are called significant.
const SIGNIFICANT: f64 = 0.05;
/// The thesis's ten users, and those of them who saw bark slide.
const THESIS_USERS: [f64; 2] = [10.0, 3.0];

/// What is rated, and the same of the sky, which has no levels of detail.
const RELATIVE: [(&str, Question, Question); 4] = [
    ("Sudden change in ground", Question::GroundSudden, Question::SkySudden),
    ("Smooth change in ground", Question::GroundSmooth, Question::SkySmooth),
    ("Sudden change in trees", Question::TreesSudden, Question::SkySudden),
    ("Smooth change in trees", Question::TreesSmooth, Question::SkySmooth),
];

/// Writes `answers.html` and `answers.md`.
///
/// # Errors
/// Folders that cannot be read or have no answers, files that are no answers, a folder that cannot be written to.
pub fn run(args: &AnswersArgs) -> Result<()> {
    let mut sheets = Vec::new();
    for folder in &args.folders {
        sheets.extend(read(folder)?);
    }
    ensure!(!sheets.is_empty(), "there are no answers in these folders");
    report::keep(&args.out, "answers", &page(&sheets))?;
    say!("{} answered; wrote {}", sheets.len(), args.out.join("answers.html").display());
    Ok(())
}

/// All answers of a folder, or of a world's.
fn read(folder: &Path) -> Result<Vec<AnswerSheet>> {
    let of_world = folder.join(names::ANSWERS);
    let folder = if of_world.is_dir() { &of_world } else { folder };
    let entries = fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))?;
    let paths = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>()?;
    let mut paths: Vec<PathBuf> =
        paths.into_iter().filter(|path| path.extension().is_some_and(|ending| ending == "ron")).collect();
    paths.sort();
    paths.iter().map(|path| read_sheet(path)).collect()
}

/// One file of answers.
///
/// # Errors
/// A file that cannot be read or is no sheet of answers.
pub fn read_sheet(path: &Path) -> Result<AnswerSheet> {
    let bytes =
        regular_file::read(path, MAX_BYTES).with_context(|| format!("cannot read {}", path.display()))?;
    let text = String::from_utf8(bytes).with_context(|| format!("{} is no text", path.display()))?;
    AnswerSheet::parse(&text).map_err(|fault| anyhow!("{}: {fault}", path.display()))
}

fn page(sheets: &[AnswerSheet]) -> Page {
    let mut conditions: Vec<String> = Vec::new();
    for sheet in sheets {
        let condition = condition(sheet);
        if !conditions.contains(&condition) {
            conditions.push(condition);
        }
    }
    let mut sections = vec![ratings(sheets), relative(sheets)];
    if conditions.len() > 1 {
        sections.push(by_condition(sheets, &conditions));
    }
    sections.push(best(sheets));
    sections.push(problems(sheets));
    let facts = vec![
        ("Answers".to_owned(), sheets.len().to_string()),
        ("Levels of detail".to_owned(), conditions.join("; ")),
    ];
    Page { title: "What people noticed".into(), facts, sections }
}

fn condition(sheet: &AnswerSheet) -> String {
    let AnswerSheet { tree_lod, terrain_lod, tree_error_px, terrain_error_px, .. } = sheet;
    let [trees, land] = [tree_lod.label(), terrain_lod.label()];
    format!("trees {trees} {tree_error_px} px, land {land} {terrain_error_px} px")
}

/// Ratings of a question by those who answered it.
fn rated(sheets: &[AnswerSheet], question: Question) -> Vec<f64> {
    sheets
        .iter()
        .filter_map(|sheet| sheet.answers.ratings.get(&question))
        .map(|rating| f64::from(*rating))
        .collect()
}

/// A rating less that of the sky, of those who gave both.
fn differences(sheets: &[AnswerSheet], question: Question, sky: Question) -> Vec<f64> {
    let of = |sheet: &AnswerSheet, question: Question| sheet.answers.ratings.get(&question).copied();
    let pairs = sheets.iter().filter_map(|sheet| Some((of(sheet, question)?, of(sheet, sky)?)));
    pairs.map(|(rating, sky)| f64::from(rating) - f64::from(sky)).collect()
}

fn standard_error(values: &[f64]) -> f64 {
    deviation(values) / (values.len().max(1) as f64).sqrt()
}

fn ratings(sheets: &[AnswerSheet]) -> Section {
    let row = |question: &Question| {
        let rated = rated(sheets, *question);
        let [low, high] = question.ends();
        let figures = [mean(&rated), deviation(&rated)].map(rounded);
        let scale = format!("1 {low}, {MAX_RATING} {high}");
        [vec![question.text().to_owned(), scale, rated.len().to_string()], figures.to_vec()].concat()
    };
    let line = |(style, question): (usize, Question)| {
        let rated = rated(sheets, question);
        let count = |rating: f64| rated.iter().filter(|one| **one == rating).count() as f64;
        let points = (1..=MAX_RATING).map(|rating| (f64::from(rating), count(f64::from(rating)))).collect();
        let name = question.name().split('_').next().unwrap_or_default().to_owned();
        Line { name, style, points }
    };
    let plot = |name: &str, title: &str, questions: [Question; 3]| Plot {
        name: format!("answers-{name}"),
        title: title.to_owned(),
        x_label: "Rating: 1 none at all, 5 extremely noticeable".into(),
        y_label: "Answers".into(),
        lines: (1..).zip(questions).map(line).collect(),
        ..Plot::default()
    };
    use Question::*;
    let plots = vec![
        plot("sudden", "Sudden changes", [GroundSudden, SkySudden, TreesSudden]),
        plot("smooth", "Smooth changes", [GroundSmooth, SkySmooth, TreesSmooth]),
    ];
    let head = ["Question", "Scale", "Answers", "Mean", "Deviation"].map(str::to_owned).into();
    let table = Table { head, rows: Question::VARIANTS.iter().map(row).collect(), ..Table::default() };
    Section {
        title: "Ratings".into(),
        blocks: vec![Block::Plots(plots), Block::Table(table)],
        ..Section::default()
    }
}

/// Table 3.
fn relative(sheets: &[AnswerSheet]) -> Section {
    let all = RELATIVE.map(|(name, question, sky)| (name, differences(sheets, question, sky)));
    let row = |(name, values): &(&str, Vec<f64>)| {
        let test = t_test(values);
        let figures = [mean(values), deviation(values), standard_error(values)].map(rounded);
        let tested = test.map_or(["–".into(), "–".into()], |test| [test.t, test.p].map(rounded));
        [vec![(*name).to_owned(), values.len().to_string()], figures.to_vec(), tested.to_vec()].concat()
    };
    let head = ["Question", "Pairs", "Mean", "Deviation", "Deviation of the mean", "t", "p"];
    let table = Table {
        caption: "Ratings less those of the sky; Student's t of pairs, two-sided".into(),
        head: head.map(str::to_owned).into(),
        rows: all.iter().map(row).collect(),
    };
    let noticed: Vec<&str> = all
        .iter()
        .filter(|(_, values)| mean(values) > 0.0 && t_test(values).is_some_and(|test| test.p < SIGNIFICANT))
        .map(|(name, _)| *name)
        .collect();
    let told = if noticed.is_empty() {
        format!("None is rated above the sky with p below {SIGNIFICANT}.")
    } else {
        format!("Above the sky with p below {SIGNIFICANT}: {}.", noticed.join(", ").to_lowercase())
    };
    let bark: Vec<bool> = sheets.iter().filter_map(|sheet| sheet.answers.bark_shifts).collect();
    let saw = bark.iter().filter(|shifts| **shifts).count();
    let share = saw as f64 / bark.len().max(1) as f64;
    let [users, of_them] = THESIS_USERS;
    Section {
        title: "Table 3: relative to the sky".into(),
        said: "The sky has no levels of detail: what people notice there comes from elsewhere, and is subtracted.".into(),
        blocks: vec![Block::Table(table)],
        findings: vec![
            Finding::new(
                noticed.is_empty(),
                "“None of these results is significant enough to indicate that level-of-detail effects were noticeable to users”",
                told,
            ),
            Finding::new(
                share >= of_them / users,
                "“Of the ten users, three were aware of texture sliding on the trees”",
                format!("{saw} of {} saw bark shift.", bark.len()),
            ),
        ],
    }
}

fn by_condition(sheets: &[AnswerSheet], conditions: &[String]) -> Section {
    let row = |name: &String| {
        let of: Vec<AnswerSheet> = sheets.iter().filter(|sheet| condition(sheet) == *name).cloned().collect();
        let figures = RELATIVE.map(|(_, question, sky)| {
            let values = differences(&of, question, sky);
            format!("{} ± {}", rounded(mean(&values)), rounded(standard_error(&values)))
        });
        [vec![name.clone(), of.len().to_string()], figures.to_vec()].concat()
    };
    let mut head = vec!["Condition".to_owned(), "Answers".to_owned()];
    head.extend(RELATIVE.map(|(name, ..)| name.to_owned()));
    let caption = "Relative to the sky: mean ± deviation of the mean".to_owned();
    let table = Table { caption, head, rows: conditions.iter().map(row).collect() };
    Section { title: "By levels of detail".into(), blocks: vec![Block::Table(table)], ..Section::default() }
}

fn best(sheets: &[AnswerSheet]) -> Section {
    let row = |aspect: &Aspect| {
        let count = |landscape: u8| {
            sheets
                .iter()
                .filter(|sheet| sheet.answers.best.get(aspect) == Some(&landscape))
                .count()
                .to_string()
        };
        [vec![aspect.name().to_owned()], (1..=4).map(count).collect()].concat()
    };
    let head = ["Best", "1", "2", "3", "4"].map(str::to_owned).into();
    let table = Table { head, rows: Aspect::VARIANTS.iter().map(row).collect(), ..Table::default() };
    Section { title: "Best of the four".into(), blocks: vec![Block::Table(table)], ..Section::default() }
}

fn problems(sheets: &[AnswerSheet]) -> Section {
    let told = sheets.iter().map(|sheet| sheet.answers.problems.trim()).filter(|text| !text.is_empty());
    let rows: Vec<Vec<String>> = told.map(|text| vec![text.to_owned()]).collect();
    let said = format!("{} of {} wrote something.", rows.len(), sheets.len());
    let table = Table { head: vec!["In their words".into()], rows, ..Table::default() };
    Section { title: "Other problems".into(), said, blocks: vec![Block::Table(table)], ..Section::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet(ground: u8, sky: u8) -> AnswerSheet {
        let mut sheet = AnswerSheet::default();
        sheet.answers.ratings = [(Question::GroundSudden, ground), (Question::SkySudden, sky)].into();
        sheet
    }

    #[test]
    fn ratings_are_told_relative_to_the_sky_and_only_pairs_count() {
        let mut sheets = vec![sheet(3, 1), sheet(4, 1), sheet(5, 2), sheet(2, 1)];
        sheets.push(AnswerSheet::default());
        let section = relative(&sheets);
        let Block::Table(table) = &section.blocks[0] else { panic!("a table") };
        assert_eq!(table.rows[0][..3], ["Sudden change in ground", "4", "2.25"]);
        assert_eq!(section.findings[0].verdict, super::super::page::Verdict::HoldsNot, "p is about 0.02");
        let same = relative(&[sheet(1, 1), sheet(2, 2)]);
        assert_eq!(same.findings[0].verdict, super::super::page::Verdict::Holds);
    }

    #[test]
    fn files_of_a_world_are_read_and_damaged_ones_named() {
        let world = tempfile::tempdir().expect("a folder");
        let folder = world.path().join(names::ANSWERS);
        genescape_world::atomic_write::replace(&folder.join("0001.ron"), sheet(1, 2).to_ron().expect("text"))
            .expect("written");
        assert_eq!(read(world.path()).expect("one"), read(&folder).expect("the same"));
        genescape_world::atomic_write::replace(
            &folder.join("0002.ron"),
            "Answers(answers: (ratings: {realism: 9}))",
        )
        .expect("written");
        let told = read(&folder).expect_err("9").to_string();
        assert!(told.contains("0002.ron") && told.contains("1 to 5"), "{told}");
    }
}
