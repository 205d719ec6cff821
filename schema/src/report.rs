//! What is wrong with a file, told so that a person can mend it: every fault with its line, the way rustc shows it. A file
//! may come from a stranger, so what is quoted of it is short and steers no terminal.

use std::fmt;
use std::ops::Range;

use crate::printable::printable;

/// Characters of a line that are shown; of longer ones the part around the fault.
const WIDEST: usize = 120;
/// Faults of a file that are told one by one.
pub(crate) const MAX_FAULTS: usize = 100;
/// Characters of a message.
const MAX_MESSAGE: usize = 2000;

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
    /// What is shown of that line of the file.
    pub excerpt: String,
    /// Which characters of the excerpt are meant; at least one.
    pub meant: Range<usize>,
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, line, column, message, excerpt, meant } = self;
        writeln!(f, "{file}:{line}:{column}: {message}")?;
        writeln!(f, "{line:>5} | {excerpt}")?;
        // Tabs are kept so that the marks stand under what they mean.
        let before = excerpt.chars().chain(std::iter::repeat(' ')).take(meant.start);
        let indent: String = before.map(|c| if c == '\t' { c } else { ' ' }).collect();
        write!(f, "{:>5} | {indent}{}", "", "^".repeat(meant.len()))
    }
}

/// All faults of a file, in the order of the file. Never empty when it is an error.
#[derive(Clone, Debug, Default, PartialEq, Eq, thiserror::Error)]
pub struct Report {
    /// The faults, or the first of very many.
    pub diagnostics: Vec<Diagnostic>,
    /// How many more there are.
    pub more: usize,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for diagnostic in &self.diagnostics {
            writeln!(f, "{diagnostic}")?;
        }
        match (self.diagnostics.len(), self.more) {
            (1, 0) => write!(f, "1 error"),
            (count, 0) => write!(f, "{count} errors"),
            (count, more) => write!(f, "{count} errors, and {more} more"),
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
    pub(crate) fn at(file: &str, text: &str, span: Range<usize>, message: &str) -> Self {
        let (line, column) = place(text, span.start);
        let start = floor_char(text, span.start);
        let line_start = text[..start].rfind('\n').map_or(0, |newline| newline + 1);
        let source = text[line_start..].split('\n').next().unwrap_or_default().trim_end_matches('\r');
        let is_wide = source.chars().nth(WIDEST).is_some();
        let from = if is_wide { column.saturating_sub(WIDEST / 2) } else { 0 };
        let cut = if from > 0 { "…" } else { "" };
        let shown: String = cut.chars().chain(source.chars().skip(from).take(WIDEST)).collect();
        let first = column - 1 - from + cut.chars().count();
        let length = text[start..floor_char(text, span.end).max(start)].chars().take(WIDEST).count();
        let last = (first + length).min(shown.chars().count()).max(first + 1);
        Self {
            file: file.to_owned(),
            line,
            column,
            message: printable(&shortened(message, MAX_MESSAGE)).replace('\n', "␊"),
            excerpt: printable(&shown).into_owned(),
            meant: first..last,
        }
    }
}

/// A text of so many characters at most.
pub(crate) fn shortened(text: &str, max: usize) -> String {
    match text.char_indices().nth(max) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

fn floor_char(text: &str, at: usize) -> usize {
    text.floor_char_boundary(at.min(text.len()))
}
