//! Answers to the questionnaire → files.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use genescape_world::{atomic_write, names};

use super::App;
use crate::event::Panel;
use crate::questionnaire::AnswerSheet;
use crate::ui::Tone;

/// More files than anybody fills.
const MAX_FILES: u32 = 99_999;

impl App {
    /// Writes what was answered, and begins another sheet. In a study the window closes then.
    pub(super) fn keep_answers(&mut self) {
        let (generation, _) = self.editor.generations();
        let sheet = AnswerSheet::new(generation, &self.file.settings.options, self.answers.clone());
        let kept = match (&self.cli.answers, self.editor.world()) {
            (Some(file), _) => write(file, &sheet),
            (None, Some(root)) => write_numbered(&root.join(names::ANSWERS), &sheet),
            (None, None) => return self.tell(Tone::Info, "Answers are kept beside a world; this is none"),
        };
        match kept {
            Ok(path) => {
                self.answers = Default::default();
                self.layout.panels.set(Panel::Questions, false);
                self.tell(Tone::Success, format!("Kept in {}", path.display()));
                self.answered = self.cli.answers.is_some();
            }
            Err(error) => self.tell(Tone::Error, format!("The answers are not kept: {error:#}")),
        }
    }
}

fn write(path: &Path, sheet: &AnswerSheet) -> Result<PathBuf> {
    atomic_write::create(path, sheet.to_ron()?)
        .with_context(|| format!("cannot write {}", path.display()))?;
    Ok(path.to_owned())
}

/// With the first free number.
fn write_numbered(folder: &Path, sheet: &AnswerSheet) -> Result<PathBuf> {
    let text = sheet.to_ron()?;
    for number in 1..MAX_FILES {
        let path = folder.join(format!("{number:04}.ron"));
        match atomic_write::create(&path, &text) {
            Ok(()) => return Ok(path),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error).with_context(|| format!("cannot write {}", path.display())),
        }
    }
    bail!("{} is full", folder.display())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_are_numbered_and_never_written_over() {
        let folder = tempfile::tempdir().expect("a folder");
        let sheet = |generation| AnswerSheet { generation, ..AnswerSheet::default() };
        let written: Vec<PathBuf> =
            (0..3).map(|number| write_numbered(folder.path(), &sheet(number)).expect("written")).collect();
        for (number, path) in (0..).zip(&written) {
            let text = std::fs::read_to_string(path).expect("there");
            assert_eq!(AnswerSheet::parse(&text), Ok(sheet(number)));
        }
        assert!(write(&written[0], &sheet(9)).is_err(), "what is there stays");
        let text = std::fs::read_to_string(&written[0]).expect("there");
        assert_eq!(AnswerSheet::parse(&text), Ok(sheet(0)));
    }
}
