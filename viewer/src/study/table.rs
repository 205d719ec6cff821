//! All walks of all participants → one table in long form: a row for each value.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde::Serialize;
use serde_json::Value;

use super::{answers_of, log_of, read_walks};
use crate::lab::read_sheet;
use crate::measure::mean;
use crate::questionnaire::Answers;

/// One value of one walk.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    pub participant: u32,
    /// Which walk of the participant, from 1.
    pub period: u32,
    pub condition: String,
    /// The condition of the walk before; empty for the first.
    pub previous: String,
    /// "trees_sudden", "best_sky", "frame_ms".
    pub measure: String,
    pub value: String,
}

/// Everything that was answered and logged.
///
/// # Errors
/// Files that are damaged.
pub fn rows(participants: &[(u32, PathBuf)]) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for (participant, folder) in participants {
        let walks = read_walks(folder)?;
        let mut previous = String::new();
        for (period, condition) in (1..).zip(&walks) {
            let path = answers_of(folder, period);
            if path.exists() {
                let mut values = answered(&read_sheet(&path)?.answers);
                values.extend(frames(&log_of(folder, period))?);
                rows.extend(values.into_iter().map(|(measure, value)| Row {
                    participant: *participant,
                    period,
                    condition: condition.name.clone(),
                    previous: previous.clone(),
                    measure,
                    value,
                }));
            }
            previous.clone_from(&condition.name);
        }
    }
    Ok(rows)
}

/// As CSV with a line of names, also of no rows.
///
/// # Errors
/// None: all of it can be written.
pub fn to_csv(rows: &[Row]) -> Result<String> {
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
    writer.write_record(["participant", "period", "condition", "previous", "measure", "value"])?;
    rows.iter().try_for_each(|row| writer.serialize(row))?;
    Ok(String::from_utf8(writer.into_inner().context("memory can be written to")?)?)
}

fn answered(answers: &Answers) -> Vec<(String, String)> {
    let ratings =
        answers.ratings.iter().map(|(question, rating)| (question.name().to_owned(), rating.to_string()));
    let best =
        answers.best.iter().map(|(aspect, best)| (format!("best_{}", aspect.name()), best.to_string()));
    let mut values: Vec<_> = ratings.chain(best).collect();
    values.extend(answers.bark_shifts.map(|shifts| ("bark_shifts".to_owned(), u8::from(shifts).to_string())));
    let problems = answers.problems.trim();
    values.extend((!problems.is_empty()).then(|| ("problems".to_owned(), problems.to_owned())));
    values
}

/// What the log tells of frames: milliseconds on average and at worst, while frames were drawn. Nothing without a log.
fn frames(path: &Path) -> Result<Vec<(String, String)>> {
    let Ok(text) = fs::read_to_string(path) else { return Ok(Vec::new()) };
    // The last line of a program that was stopped may be cut off.
    let lines = text.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let lines: Vec<Value> = lines.collect();
    let of = |name: &str| -> Vec<f64> {
        let frames = lines.iter().filter(|line| line["what"] == "frames");
        frames.filter_map(|line| line[name].as_f64()).collect()
    };
    let rates = of("fps");
    if rates.is_empty() {
        return Ok(Vec::new());
    }
    let times: Vec<f64> = rates.iter().filter(|fps| **fps > 0.0).map(|fps| 1e3 / fps).collect();
    let worst = of("worst_ms").into_iter().fold(0.0, f64::max);
    let seconds = lines.iter().filter_map(|line| line["t_s"].as_f64()).fold(0.0, f64::max);
    let values = [("frame_ms", mean(&times)), ("worst_frame_ms", worst), ("walk_s", seconds)];
    Ok(values.map(|(name, value)| (name.to_owned(), format!("{value:.3}"))).into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::Options;
    use crate::questionnaire::{AnswerSheet, Question};

    #[test]
    fn the_table_has_a_row_for_each_value_and_says_what_came_before() {
        let folder = tempfile::tempdir().expect("a folder");
        let conditions = ["a", "b"].map(|name| format!("(name: \"{name}\")"));
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("written");
        write("walks.ron", &format!("[{}]", conditions.join(",")));
        let answers = Answers {
            ratings: [(Question::Realism, 4)].into(),
            bark_shifts: Some(true),
            problems: "slow, \"very\"".into(),
            ..Answers::default()
        };
        let sheet = AnswerSheet::new(0, &Options::default(), answers);
        write("answers-2.ron", &sheet.to_ron().expect("text"));
        write("log-2.jsonl", "{\"what\":\"frames\",\"t_s\":3,\"fps\":10,\"worst_ms\":250}\n{\"what\":\"fra");
        let rows = rows(&[(7, folder.path().to_owned())]).expect("whole");
        let csv = to_csv(&rows).expect("text");
        let expected = [
            "participant,period,condition,previous,measure,value",
            "7,2,b,a,realism,4",
            "7,2,b,a,bark_shifts,1",
            "7,2,b,a,problems,\"slow, \"\"very\"\"\"",
            "7,2,b,a,frame_ms,100.000",
            "7,2,b,a,worst_frame_ms,250.000",
            "7,2,b,a,walk_s,3.000",
        ];
        assert_eq!(csv.lines().collect::<Vec<_>>(), expected);
        assert_eq!(to_csv(&[]).expect("text").lines().count(), 1);
    }
}
