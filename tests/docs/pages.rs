//! Markdown files → their parts, in reading order.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Component, Path, PathBuf};

use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd};

/// A file, with what mdbook includes in it.
pub struct Page {
    /// From the repository's folder.
    pub path: PathBuf,
    pub parts: Vec<Part>,
}

#[derive(Debug, PartialEq)]
pub enum Part {
    Heading(String),
    /// The first cell of a table's row.
    Row(String),
    Link(String),
    /// Between backticks.
    Code(String),
    Block(String),
}

pub fn root() -> PathBuf {
    normal(&Path::new(env!("CARGO_MANIFEST_DIR")).join(".."))
}

/// Without `..`, for what need not exist.
pub fn normal(path: &Path) -> PathBuf {
    let mut normal = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => _ = normal.pop(),
            Component::CurDir => {}
            _ => normal.push(part),
        }
    }
    normal
}

impl Page {
    /// By its path from the repository's folder.
    pub fn read(path: impl AsRef<Path>) -> Self {
        let path = path.as_ref();
        let full = root().join(path);
        let text = fs::read_to_string(&full).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let lines = text.lines().map(|line| match line.strip_prefix("{{#include ") {
            Some(rest) => {
                let included = full.with_file_name("").join(rest.trim_end_matches('}'));
                fs::read_to_string(&included)
                    .unwrap_or_else(|error| panic!("{}: {line}: {error}", path.display()))
            }
            None => line.to_owned(),
        });
        let text = lines.collect::<Vec<_>>().join("\n");
        Self { path: path.to_owned(), parts: parts(&text) }
    }

    /// Every page of the repository.
    pub fn all() -> Vec<Self> {
        let mut pages = Vec::new();
        collect(Path::new(""), &mut pages);
        assert!(pages.len() > 15, "pages are where they are looked for");
        pages
    }

    /// Every page of the book.
    pub fn of_book() -> Vec<Self> {
        Self::all().into_iter().filter(|page| page.path.starts_with("docs")).collect()
    }

    pub fn links(&self) -> impl Iterator<Item = &str> {
        self.parts.iter().filter_map(|part| match part {
            Part::Link(to) => Some(to.as_str()),
            _ => None,
        })
    }

    /// The ends of links that lead to its headings, as GitHub and mdbook make them.
    pub fn anchors(&self) -> BTreeSet<String> {
        let headings = self.parts.iter().filter_map(|part| match part {
            Part::Heading(text) => Some(text.to_lowercase()),
            _ => None,
        });
        let kept = |c: &char| c.is_alphanumeric() || "-_ ".contains(*c);
        headings.map(|text| text.chars().filter(kept).collect::<String>().replace(' ', "-")).collect()
    }

    /// The parts below a heading, up to the next.
    pub fn section(&self, heading: &str) -> &[Part] {
        let start = self.parts.iter().position(|part| *part == Part::Heading(heading.to_owned()));
        let start = start.unwrap_or_else(|| panic!("{} has no heading {heading}", self.path.display())) + 1;
        let length = self.parts[start..].iter().take_while(|part| !matches!(part, Part::Heading(_))).count();
        &self.parts[start..start + length]
    }
}

fn collect(folder: &Path, pages: &mut Vec<Page>) {
    for entry in fs::read_dir(root().join(folder)).expect("a folder") {
        let entry = entry.expect("an entry");
        let (name, path) = (entry.file_name(), folder.join(entry.file_name()));
        let name = name.to_string_lossy();
        if entry.path().is_dir() {
            if !name.starts_with('.') && !["target", "world", "node_modules"].contains(&&*name) {
                collect(&path, pages);
            }
        } else if name.ends_with(".md") {
            pages.push(Page::read(path));
        }
    }
}

fn parts(text: &str) -> Vec<Part> {
    let (mut parts, mut words, mut cell) = (Vec::new(), String::new(), None);
    for event in Parser::new_ext(text, Options::ENABLE_TABLES) {
        match event {
            Event::Start(Tag::Link { dest_url: to, .. } | Tag::Image { dest_url: to, .. }) => {
                parts.push(Part::Link(to.into_string()));
            }
            Event::Start(Tag::TableRow) => cell = Some(0),
            Event::Start(Tag::Heading { .. } | Tag::CodeBlock(_) | Tag::TableCell) => words.clear(),
            Event::End(TagEnd::Heading(_)) => parts.push(Part::Heading(std::mem::take(&mut words))),
            Event::End(TagEnd::CodeBlock) => parts.push(Part::Block(std::mem::take(&mut words))),
            Event::End(TagEnd::TableCell) => {
                if cell == Some(0) {
                    parts.push(Part::Row(std::mem::take(&mut words)));
                }
                cell = cell.map(|cell| cell + 1);
            }
            Event::End(TagEnd::TableRow) => cell = None,
            Event::Code(code) => {
                words += &code;
                parts.push(Part::Code(code.into_string()));
            }
            Event::Text(text) => words += &text,
            _ => {}
        }
    }
    parts
}
