//! What is wrong with a file, told so that a person can mend it: every fault with its line, the way rustc shows it.

use std::fmt;
use std::ops::Range;

/// Characters of a line that are shown; of longer ones the part around the fault.
const WIDEST: usize = 120;

/// One fault of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// The file's name as it was given.
    pub file: String,
    /// From 1.
    pub line: usize,
    /// From 1, in characters.
    pub column: usize,
    /// What is wrong and what would be right.
    pub message: String,
    /// That line of the file.
    pub source: String,
    /// How many characters of it are meant; at least 1.
    pub length: usize,
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, line, column, message, source, length } = self;
        writeln!(f, "{file}:{line}:{column}: {message}")?;
        let from = if source.chars().count() > WIDEST { column.saturating_sub(WIDEST / 2) } else { 0 };
        let cut = if from > 0 { "…" } else { "" };
        let shown: String = source.chars().skip(from).take(WIDEST).collect();
        writeln!(f, "{line:>5} | {cut}{shown}")?;
        // Tabs are kept so that the marks stand under what they mean.
        let before = cut.chars().chain(source.chars().skip(from).take(column - 1 - from));
        let indent: String = before.map(|c| if c == '\t' { c } else { ' ' }).collect();
        let marks = (*length).min(from + WIDEST + 1 - column).max(1);
        write!(f, "{:>5} | {indent}{}", "", "^".repeat(marks))
    }
}

/// All faults of a file, in the order of the file. Never empty when it is an error.
#[derive(Clone, Debug, Default, PartialEq, Eq, thiserror::Error)]
pub struct Report {
    /// The faults.
    pub diagnostics: Vec<Diagnostic>,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for diagnostic in &self.diagnostics {
            writeln!(f, "{diagnostic}")?;
        }
        match self.diagnostics.len() {
            1 => write!(f, "1 error"),
            count => write!(f, "{count} errors"),
        }
    }
}

/// Line and column, from 1, of a byte of a text; of its end when `at` lies beyond.
pub(crate) fn place(text: &str, at: usize) -> (usize, usize) {
    let before = &text[..floor_char(text, at)];
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
}

impl Diagnostic {
    /// A fault of the bytes `span` of `text`.
    pub(crate) fn at(file: &str, text: &str, span: Range<usize>, message: String) -> Self {
        let (line, column) = place(text, span.start);
        let source = text.lines().nth(line - 1).unwrap_or_default().to_owned();
        let meant =
            &text[floor_char(text, span.start)..floor_char(text, span.end).max(floor_char(text, span.start))];
        let on_line = source.chars().count().saturating_sub(column - 1);
        let length = meant.chars().count().clamp(1, on_line.max(1));
        Self { file: file.to_owned(), line, column, message, source, length }
    }
}

fn floor_char(text: &str, at: usize) -> usize {
    text.floor_char_boundary(at.min(text.len()))
}
