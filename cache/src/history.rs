//! The keys of a scope's last run, against which "what changed?" is answered.
//!
//! A scope is one unit of work of the caller ("g0003-scene-0"); an item is one action in it ("tree 2"). The history of
//! a scope is one small sealed file, written once a run, and only if it changed.

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};

use crate::{ActionKey, Cache, Digest, How, KeyFields, Result};

/// One difference between the key of an item now and in the last run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Change {
    /// The stage's code has another version.
    Version { from: u32, to: u32 },
    /// Another stage does this item's work.
    Stage { from: String, to: String },
    /// A named parameter; `None` where there was none of that name.
    Parameter { name: String, from: Option<String>, to: Option<String> },
    /// Parameters whose names were not given, or that differ by less than their text shows.
    UnnamedParameters,
    /// An input's bytes changed, or it came or went.
    Input { name: String },
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Version { from, to } => write!(f, "stage version {from} → {to}"),
            Self::Stage { from, to } => write!(f, "stage {from} → {to}"),
            Self::Parameter { name, from: Some(from), to: Some(to) } => write!(f, "{name}: {from} → {to}"),
            Self::Parameter { name, to: Some(to), .. } => write!(f, "{name}: new, {to}"),
            Self::Parameter { name, .. } => write!(f, "{name}: no longer read"),
            Self::UnnamedParameters => f.write_str("values not listed by name"),
            Self::Input { name } => write!(f, "input {name} changed"),
        }
    }
}

/// Why an item was built or not.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Explanation {
    /// Whether it was reused or built.
    pub how: How,
    /// No run of this scope had this item before.
    pub first: bool,
    /// What differs from the last run.
    pub changes: Vec<Change>,
}

impl fmt::Display for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let changes = self.changes_in_words();
        match (self.how, self.first, self.changes.is_empty()) {
            (How::Reused, true, _) => f.write_str("reused: built before elsewhere"),
            (How::Reused, false, true) => f.write_str("reused"),
            (How::Reused, false, false) => write!(f, "reused: built before elsewhere ({changes})"),
            (How::Built, true, _) => f.write_str("first build"),
            (How::Built, false, true) => f.write_str("rebuilt because the result was missing or damaged"),
            (How::Built, false, false) => write!(f, "rebuilt because {changes}"),
        }
    }
}

impl Explanation {
    fn changes_in_words(&self) -> String {
        let is_parameter = |c: &&Change| matches!(c, Change::Parameter { .. } | Change::UnnamedParameters);
        let (parameters, others): (Vec<&Change>, Vec<&Change>) = self.changes.iter().partition(is_parameter);
        let words = |changes: Vec<&Change>| changes.into_iter().map(Change::to_string).collect::<Vec<_>>();
        let parameters = words(parameters).join(", ");
        let lead = (!parameters.is_empty()).then(|| format!("parameters changed: {parameters}"));
        lead.into_iter().chain(words(others)).collect::<Vec<_>>().join("; ")
    }
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Item {
    key: Digest,
    fields: KeyFields,
    explanation: Explanation,
}

/// The items of a scope with their keys of the last run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct History {
    scope: String,
    saved: BTreeMap<String, Item>,
    items: BTreeMap<String, Item>,
}

impl History {
    /// Takes items that this scope hasn't yet from an earlier one, as if they had been its own: for a scope that is
    /// a child of another. The first run then says what differs from the parent.
    pub fn inherit(&mut self, parent: &History) {
        for (item, entry) in &parent.saved {
            self.items.entry(item.clone()).or_insert_with(|| entry.clone());
        }
    }

    /// Why `item`, whose key is now `key`, is `how`; the key and the explanation are remembered for the next run.
    pub fn note(&mut self, item: &str, key: &ActionKey, how: How) -> Explanation {
        let last = self.items.get(item);
        let changes = match last {
            Some(last) if last.key != key.digest() => differences(&last.fields, key.fields()),
            _ => Vec::new(),
        };
        let explanation = Explanation { how, first: last.is_none(), changes };
        let entry =
            Item { key: key.digest(), fields: key.fields().clone(), explanation: explanation.clone() };
        self.items.insert(item.to_owned(), entry);
        explanation
    }

    /// What the last run (or `note`) said of each item, by name.
    pub fn last(&self) -> impl Iterator<Item = (&str, &Explanation)> {
        self.items.iter().map(|(name, item)| (name.as_str(), &item.explanation))
    }

    /// Forgets items that `keep` doesn't want: those that the scope no longer has.
    pub fn retain(&mut self, mut keep: impl FnMut(&str) -> bool) {
        self.items.retain(|name, _| keep(name));
    }
}

fn differences(from: &KeyFields, to: &KeyFields) -> Vec<Change> {
    let mut changes = Vec::new();
    if from.stage != to.stage {
        changes.push(Change::Stage { from: from.stage.clone(), to: to.stage.clone() });
    }
    if from.version != to.version {
        changes.push(Change::Version { from: from.version, to: to.version });
    }
    if from.parameters != to.parameters {
        let named = changed_names(&from.named, &to.named);
        if named.is_empty() {
            changes.push(Change::UnnamedParameters);
        }
        changes.extend(named.into_iter().map(|(name, from, to)| Change::Parameter { name, from, to }));
    }
    let inputs = changed_names(&from.inputs, &to.inputs);
    changes.extend(inputs.into_iter().map(|(name, _, _)| Change::Input { name }));
    if changes.is_empty() {
        // Same fields by name, another key: only their order can differ.
        changes.push(Change::Input { name: "order".to_owned() });
    }
    changes
}

/// Names whose value differs between two lists, in the order of the second, then those only in the first.
fn changed_names<T: Clone + PartialEq>(
    from: &[(String, T)],
    to: &[(String, T)],
) -> Vec<(String, Option<T>, Option<T>)> {
    let value = |list: &[(String, T)], name: &String| {
        list.iter().find(|(n, _)| n == name).map(|(_, value)| value.clone())
    };
    let names = to.iter().chain(from.iter().filter(|(name, _)| value(to, name).is_none()));
    names
        .map(|(name, _)| (name.clone(), value(from, name), value(to, name)))
        .filter(|(_, from, to)| from != to)
        .collect()
}

/// A scope's file, which lies in the cache's folder whatever the scope is called.
fn path(scope: &str) -> String {
    let escaped = scope.bytes().map(|b| match b {
        b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' => char::from(b).to_string(),
        _ => format!("%{b:02X}"),
    });
    format!("history/{}.keys", escaped.collect::<String>())
}

/// Whether that is the name of a scope's file.
pub(crate) fn is_history(name: &str) -> bool {
    let scope = name.strip_prefix("history/").and_then(|name| name.strip_suffix(".keys"));
    scope.is_some_and(|scope| scope.bytes().all(|b| b.is_ascii_alphanumeric() || b"-_%".contains(&b)))
}

impl Cache {
    /// The history of a scope; empty if it never ran, or if its file was damaged (with a notice).
    ///
    /// # Errors
    /// If the file exists and cannot be read.
    pub fn history(&self, scope: &str) -> Result<History> {
        let found = self.get_sealed::<BTreeMap<String, Item>>(&path(scope))?;
        let items = found.map_or_else(BTreeMap::new, |(items, _)| items);
        Ok(History { scope: scope.to_owned(), saved: items.clone(), items })
    }

    /// Publishes a history if anything in it changed.
    ///
    /// # Errors
    /// If the folder cannot be written to.
    pub fn save_history(&self, history: &History) -> Result<()> {
        if history.items == history.saved {
            return Ok(());
        }
        self.put_sealed(&path(&history.scope), &history.items)
    }
}
