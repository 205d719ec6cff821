//! What was left out of a file, or is drawn differently: said once each, however often it happened.

use std::collections::BTreeMap;

use genescape_schema::printable;

/// Enough for a person to read.
const MAX_NOTES: usize = 12;

/// Sentences, with how often each was called for.
#[derive(Debug, Default)]
pub(super) struct Notes(BTreeMap<String, usize>);

impl Notes {
    pub fn add(&mut self, text: impl Into<String>) {
        *self.0.entry(text.into()).or_default() += 1;
    }

    /// In a fixed order; only the first if there are very many.
    pub fn into_sentences(self) -> Vec<String> {
        let told = |(text, count): (String, usize)| match count {
            1 => text,
            _ => format!("{text} ({count} times)"),
        };
        self.0.into_iter().take(MAX_NOTES).map(told).collect()
    }
}

/// A name out of a file: in quotation marks, not too long.
pub(super) fn quoted(name: &str) -> String {
    const MAX_CHARS: usize = 80;
    let start: String = name.chars().take(MAX_CHARS).collect();
    let more = if start.len() < name.len() { "…" } else { "" };
    printable(&format!("“{start}{more}”")).to_string()
}
