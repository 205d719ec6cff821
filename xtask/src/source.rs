//! The workspace's Rust, line by line: code, test, comment or blank.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::tools::{files, root};

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Code,
    Test,
    Comment,
    Blank,
}

/// A file.
pub struct Source {
    /// From the workspace's folder on, with `/`: "cache/src/lib.rs".
    pub path: String,
    pub lines: Vec<(Kind, String)>,
}

impl Source {
    /// The package's folder: "cache".
    pub fn package(&self) -> &str {
        self.path.split('/').next().unwrap_or_default()
    }
}

/// All files, sorted by path. Test is what lies in folders `tests` and `examples`, and what is behind `cfg(test)`.
pub fn sources() -> Result<Vec<Source>> {
    let read = |path: PathBuf| -> Result<_> {
        let text = fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
        Ok((path.strip_prefix(root())?.to_owned(), text))
    };
    let files = files(&root(), &[".rs"])?.into_iter().map(read).collect::<Result<Vec<_>>>()?;
    let tests: BTreeSet<PathBuf> = files.iter().flat_map(|(path, text)| test_modules(path, text)).collect();
    let source = |(path, text): (PathBuf, String)| {
        let folders = path.parent().into_iter().flat_map(Path::iter);
        let is_test = folders.into_iter().any(|folder| folder == "tests" || folder == "examples")
            || path.ancestors().any(|ancestor| tests.contains(&ancestor.with_extension("")));
        let kinds = kinds(&text.lines().collect::<Vec<_>>(), is_test);
        let lines = kinds.into_iter().zip(text.lines().map(str::to_owned)).collect();
        Source { path: path.to_string_lossy().replace('\\', "/"), lines }
    };
    Ok(files.into_iter().map(source).collect())
}

fn is_test_attribute(line: &str) -> bool {
    let line = line.trim_start();
    line.starts_with("#[cfg(test") || line.starts_with("#[cfg(all(test")
}

/// Paths, without extension, of the modules that a file declares for tests only.
fn test_modules(path: &Path, text: &str) -> Vec<PathBuf> {
    let is_root = ["mod.rs", "lib.rs", "main.rs"].iter().any(|name| path.ends_with(name));
    let folder = if is_root { path.with_file_name("") } else { path.with_extension("") };
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let attributes = (0..lines.len()).filter(|&i| is_test_attribute(lines[i]));
    let names = attributes.filter_map(|i| {
        let item = lines[i..].iter().find(|line| !line.starts_with("#["))?;
        let (visibility, name) = item.strip_suffix(';')?.split_once("mod ")?;
        (visibility.is_empty() || visibility.starts_with("pub")).then_some(name)
    });
    names.map(|name| folder.join(name)).collect()
}

fn kinds(lines: &[&str], is_test: bool) -> Vec<Kind> {
    let mut kinds = Vec::with_capacity(lines.len());
    // The last line of the item behind cfg(test) that we are in.
    let mut end = None;
    for (i, line) in lines.iter().enumerate() {
        if end.is_none() && !is_test && is_test_attribute(line) {
            end = Some(end_of_item(lines, i));
        }
        kinds.push(match line.trim() {
            "" => Kind::Blank,
            line if line.starts_with("//") => Kind::Comment,
            _ if is_test || end.is_some() => Kind::Test,
            _ => Kind::Code,
        });
        end = end.filter(|end| i < *end);
    }
    kinds
}

/// The line of the closing brace of the item whose attributes begin at `first`; without one, the line of the item.
fn end_of_item(lines: &[&str], first: usize) -> usize {
    let is_item = |i: &usize| !lines.get(*i).is_some_and(|line| line.trim_start().starts_with("#["));
    let item = (first..).find(is_item).unwrap_or(first);
    if !lines.get(item).is_some_and(|line| line.trim_end().ends_with('{')) {
        return item;
    }
    let indent = lines[first].len() - lines[first].trim_start().len();
    let closes = |line: &&str| {
        line.get(..indent).is_some_and(|i| i.trim().is_empty()) && line[indent..].starts_with('}')
    };
    item + 1 + lines[item + 1..].iter().take_while(|line| !closes(line)).count()
}
