//! Walks a RON tree and collects every fault instead of stopping at the first.

use std::fmt::Display;
use std::ops::Range;

use ron::error::SpannedError;
use serde::de::DeserializeOwned;

use crate::printable::steers;
use crate::report::{Diagnostic, MAX_FAULTS, Report, place, shortened};
use crate::ron_tree::{Field, MAX_DEPTH, Node, Value, parse, prepare};

/// Reads the text of a file, whose name is for messages: what `read` makes of it, or everything that is wrong.
pub(crate) fn read<T>(
    file: &str,
    text: &str,
    read: impl FnOnce(&mut Checker<'_>, &Node<'_>) -> Option<T>,
) -> Result<T, Report> {
    let text = prepare(text);
    let mut checker = Checker::new(file, &text);
    let root = checker.parse()?;
    let result = read(&mut checker, &root);
    checker.finish(result)
}

/// The faults found so far in one file.
pub(crate) struct Checker<'a> {
    file: &'a str,
    text: &'a str,
    faults: Vec<(usize, Diagnostic)>,
    /// Faults beyond these.
    more: usize,
}

/// Characters that the name of something may have.
pub(crate) const MAX_NAME: usize = 200;
/// Characters that are quoted of a name that should not be there.
const MAX_QUOTED: usize = 60;

impl<'a> Checker<'a> {
    /// `text` comes from [`crate::ron_tree::prepare`].
    pub fn new(file: &'a str, text: &'a str) -> Self {
        Self { file, text, faults: Vec::new(), more: 0 }
    }

    /// The file as a tree, or the one place where it stops being RON.
    pub fn parse(&self) -> Result<Node<'a>, Report> {
        parse(self.text).map_err(|error| self.syntax(error))
    }

    pub fn error(&mut self, span: Range<usize>, message: impl Into<String>) {
        self.error_with(span, || message.into());
    }

    /// The same for a message that takes work: of very many faults most are only counted.
    pub fn error_with(&mut self, span: Range<usize>, message: impl FnOnce() -> String) {
        if self.faults.len() == MAX_FAULTS {
            self.more += 1;
            return;
        }
        self.faults.push((span.start, Diagnostic::at(self.file, self.text, span, &message())));
    }

    /// The same in place of a value.
    pub fn refuse<T>(&mut self, span: Range<usize>, message: impl Into<String>) -> Option<T> {
        self.error(span, message);
        None
    }

    /// A remark on a node that is no fault: "g0000.ron:12:5: message".
    pub fn note(&self, node: &Node<'_>, message: impl Display) -> String {
        let (line, column) = place(self.text, node.start);
        format!("{}:{line}:{column}: {message}", self.file)
    }

    /// The result if there was no fault.
    fn finish<T>(mut self, result: Option<T>) -> Result<T, Report> {
        match result {
            Some(result) if self.faults.is_empty() => Ok(result),
            _ => {
                self.faults.sort_by_key(|(at, _)| *at);
                let diagnostics = self.faults.into_iter().map(|(_, fault)| fault).collect();
                Err(Report { diagnostics, more: self.more })
            }
        }
    }

    /// The fields of a struct; unknown and repeated ones are faults. `None`, and a fault, if it is no struct.
    pub fn fields<'n, 't>(
        &mut self,
        node: &'n Node<'t>,
        what: &str,
        known: &[&str],
        hint: impl Fn(&str) -> Option<String>,
    ) -> Option<Vec<&'n Field<'t>>> {
        let Value::Struct(fields) = &node.value else {
            return self.wrong_kind(
                node,
                what,
                &format!("named values in brackets, as ({}: …)", known.first()?),
            );
        };
        let mut unique: Vec<&Field<'t>> = Vec::new();
        for field in fields {
            let span = field.name_start..field.name_start + field.name.len();
            if !known.contains(&field.name) {
                self.error_with(span, || {
                    let hint = hint(field.name).unwrap_or_else(|| did_you_mean(field.name, known));
                    format!("{what} has no {}{hint}", quoted(field.name))
                });
            } else if let Some(first) = unique.iter().find(|first| first.name == field.name) {
                let (line, _) = place(self.text, first.node.start);
                self.error(span, format!("{} is given twice; first in line {line}", field.name));
            } else {
                unique.push(field);
            }
        }
        Some(unique)
    }

    /// The fields of a struct of fixed shape.
    pub fn record<'n, 't>(
        &mut self,
        node: &'n Node<'t>,
        what: &str,
        known: &[&str],
    ) -> Option<Vec<&'n Field<'t>>> {
        self.fields(node, what, known, |_| None)
    }

    /// The struct `name(…)` that is the whole file; the name may be left out.
    pub fn root<'n, 't>(
        &mut self,
        node: &'n Node<'t>,
        name: &str,
        known: &[&str],
    ) -> Option<Vec<&'n Field<'t>>> {
        let found = node.struct_name();
        if !found.is_empty() && found != name {
            let message = format!("expected {name}(…), found {}", quoted(found));
            return self.refuse(node.start..node.start + found.len(), message);
        }
        self.record(node, name, known)
    }

    /// One field; a fault if it is missing.
    pub fn need<'n, 't>(
        &mut self,
        fields: &[&'n Field<'t>],
        node: &Node<'_>,
        what: &str,
        name: &str,
    ) -> Option<&'n Node<'t>> {
        let found = optional(fields, name);
        found.or_else(|| self.refuse(node.start..node.start + 1, format!("{what} lacks {name}")))
    }

    pub fn number(&mut self, node: &Node<'_>, what: &str) -> Option<f64> {
        match node.value {
            Value::Number(number) => Some(number),
            _ => self.wrong_kind(node, what, "a number"),
        }
    }

    /// A whole number that fits `T`.
    pub fn whole<T: DeserializeOwned + Display>(&mut self, node: &Node<'_>, what: &str, max: T) -> Option<T> {
        let whole = matches!(node.value, Value::Number(_)).then(|| ron::from_str(node.text).ok()).flatten();
        whole.or_else(|| self.wrong_kind(node, what, &format!("a whole number from 0 to {max}")))
    }

    pub fn text<'n>(&mut self, node: &'n Node<'_>, what: &str) -> Option<&'n str> {
        match &node.value {
            Value::Text(text) => Some(text),
            _ => self.wrong_kind(node, what, "a text in quotes"),
        }
    }

    /// A text in one line for people to read.
    pub fn line<'n>(&mut self, node: &'n Node<'_>, what: &str, max: usize) -> Option<&'n str> {
        let text = self.text(node, what)?;
        let count = text.chars().count();
        if count > max {
            return self
                .refuse(node.span(), format!("{what}: {count} characters; at most {max} are allowed"));
        }
        if let Some(place) = text.chars().position(steers) {
            let code = text.chars().nth(place).map_or(0, u32::from);
            let message = format!("{what}: character {} is a control character (U+{code:04X})", place + 1);
            return self.refuse(node.span(), message);
        }
        Some(text)
    }

    pub fn list<'n, 't>(&mut self, node: &'n Node<'t>, what: &str) -> Option<&'n [Node<'t>]> {
        match &node.value {
            Value::List(items) => Some(items),
            _ => self.wrong_kind(node, what, "a list"),
        }
    }

    /// A word out of a few.
    pub fn word<T>(
        &mut self,
        node: &Node<'_>,
        what: &str,
        known: &[&str],
        find: impl Fn(&str) -> Option<T>,
    ) -> Option<T> {
        find(node.text).or_else(|| {
            let hint = did_you_mean(node.text, known);
            self.refuse(node.span(), format!("{what}: {} is none of {}{hint}", given(node), known.join(", ")))
        })
    }

    pub fn wrong_kind<T>(&mut self, node: &Node<'_>, what: &str, expected: &str) -> Option<T> {
        let message = format!("{what}: expected {expected}, found {}: {}", node.kind(), given(node));
        self.refuse(node.span(), message)
    }

    fn syntax(&self, error: SpannedError) -> Report {
        // ron's place after the failed step is where the eye should go.
        let (line, column) = (error.span.end.line, error.span.end.col);
        let line_start: usize = self.text.split_inclusive('\n').take(line - 1).map(str::len).sum();
        let in_line = self.text[line_start..].char_indices().nth(column - 1).map_or(usize::MAX, |(at, _)| at);
        let mut at = line_start.saturating_add(in_line);
        let mut message = syntax_message(&error.code);
        if self.text.get(at..).is_none_or(|rest| rest.trim().is_empty()) {
            at = self.text.trim_end().len();
            message = format!("the file ends too early: {message}");
        }
        Report { diagnostics: vec![Diagnostic::at(self.file, self.text, at..at, &message)], more: 0 }
    }
}

/// One field, if it is there.
pub(crate) fn optional<'n, 't>(fields: &[&'n Field<'t>], name: &str) -> Option<&'n Node<'t>> {
    fields.iter().find(|field| field.name == name).map(|field| &field.node)
}

/// A value as it was written, cut short.
pub(crate) fn given(node: &Node<'_>) -> String {
    let first = node.text.lines().next().unwrap_or_default();
    let mut short: String = first.chars().take(32).collect();
    if short.len() < node.text.len() {
        short.push('…');
    }
    short
}

/// A name that should not be there, cut short.
pub(crate) fn quoted(name: &str) -> String {
    shortened(name, MAX_QUOTED)
}

/// `; did you mean height_m?` if a known name is near.
pub(crate) fn did_you_mean(name: &str, known: &[&str]) -> String {
    if name.len() > MAX_QUOTED {
        return String::new();
    }
    let near = known.iter().map(|&known| (strsim::osa_distance(name, known), known)).min();
    let limit = 2.max(name.chars().count() / 3);
    near.filter(|&(distance, _)| distance <= limit)
        .map_or(String::new(), |(_, known)| format!("; did you mean {known}?"))
}

/// ron's messages in the words of a person who edits a file, to stand after a colon.
fn syntax_message(error: &ron::Error) -> String {
    match error {
        ron::Error::Eof => "a bracket or a quotation mark is still open".into(),
        ron::Error::ExceededRecursionLimit => {
            format!("brackets stand within brackets here, more than {MAX_DEPTH} deep; our files need six")
        }
        ron::Error::ExpectedComma => "expected a comma or a closing bracket before this".into(),
        ron::Error::ExpectedMapColon => "expected a colon after the name".into(),
        ron::Error::TrailingCharacters => "the file should end here; is one bracket too many closed?".into(),
        ron::Error::ExpectedIdentifier | ron::Error::SuggestRawIdentifier(_) => {
            "expected a name (decimals are written with a point: 7.4)".into()
        }
        other => {
            let message = other.to_string();
            let mut chars = message.chars();
            chars.next().map_or(String::new(), |first| first.to_lowercase().chain(chars).collect())
        }
    }
}
