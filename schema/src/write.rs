//! Writes populations and presets as RON for people: a gene a line, its range beside it, always in the same order.

use std::collections::BTreeSet;
use std::fmt::Write;

use crate::genome::Chromosome;
use crate::lineage::Parent;
use crate::parameter::Category;
use crate::population::{Population, TreePreset, Votes};
use crate::space::Space;

impl Population {
    /// The file's text. Reading it gives this population again; writing that gives this text again.
    pub fn to_ron(&self, space: &Space) -> String {
        let mut out = String::from(
            "// Four landscapes. Edit any value within its range; the nearest value that its gene has is used.\n\
             // `bake params` says what each gene does.\n\
             Population(\n",
        );
        let Self { generation, seed, .. } = self;
        let votes = votes_text(self.votes.as_ref());
        put(&mut out, 1, &format!("generation: {generation},"));
        put(&mut out, 1, &format!("seed: {seed},"));
        if let Some(Parent { generation, votes }) = &self.parent {
            let votes = cast_text(votes);
            put(&mut out, 1, &format!("parent: Some((generation: {generation}, votes: {votes})),"));
        }
        put(
            &mut out,
            1,
            "// The best of each, 0 … 3, as Some((tree: Some(0), terrain: Some(2), sky: None)); None: no favourite.",
        );
        put(&mut out, 1, &format!("votes: {votes},"));
        if !self.locked.is_empty() {
            put(
                &mut out,
                1,
                "// Genes and whole categories (tree, terrain, sky) that breeding leaves as they are.",
            );
            put(&mut out, 1, &format!("locked: {},", locked_text(&self.locked)));
        }
        put(&mut out, 1, "individuals: [");
        for individual in &self.individuals {
            put(&mut out, 2, "(");
            put(&mut out, 3, &format!("name: {},", quoted(&individual.name)));
            for category in Category::ALL {
                chromosome(&mut out, 3, space, category, individual.genome.chromosome(category));
            }
            put(&mut out, 2, "),");
        }
        put(&mut out, 1, "],");
        out.push_str(")\n");
        out
    }
}

impl TreePreset {
    /// The file's text. Reading it gives this preset again.
    pub fn to_ron(&self, space: &Space) -> String {
        let mut out = String::from("TreePreset(\n");
        put(&mut out, 1, &format!("name: {},", quoted(&self.name)));
        chromosome(&mut out, 1, space, Category::Tree, &self.tree);
        out.push_str(")\n");
        out
    }
}

/// Votes as RON.
pub(crate) fn votes_text(votes: Option<&Votes>) -> String {
    votes.map_or("None".into(), |votes| format!("Some({})", cast_text(votes)))
}

fn cast_text(votes: &Votes) -> String {
    let votes = Category::ALL.map(|category| format!("{category}: {}", vote_text(votes.get(category))));
    format!("({})", votes.join(", "))
}

/// Names of what is locked as RON.
pub(crate) fn locked_text(locked: &BTreeSet<String>) -> String {
    let names: Vec<String> = locked.iter().map(|name| quoted(name)).collect();
    format!("[{}]", names.join(", "))
}

/// One category's vote as RON.
pub(crate) fn vote_text(vote: Option<usize>) -> String {
    vote.map_or("None".into(), |vote| format!("Some({vote})"))
}

fn chromosome(out: &mut String, depth: usize, space: &Space, category: Category, genes: &Chromosome) {
    put(out, depth, &format!("{category}: ("));
    let lines: Vec<(String, String)> = space
        .category(category)
        .map(|gene| (format!("{}: {},", gene.name, gene.text(genes.code(gene))), gene.range_text()))
        .collect();
    // Wide enough for any value, so that a changed gene changes one line.
    let width = space.category(category).map(|gene| gene.name.len() + 9).max().unwrap_or(0);
    for (gene, range) in lines {
        put(out, depth + 1, &format!("{gene:width$} // {range}"));
    }
    put(out, depth, "),");
}

fn put(out: &mut String, depth: usize, line: &str) {
    // Writing to a String cannot fail.
    let _ = writeln!(out, "{:1$}{line}", "", depth * 4);
}

/// A text in quotes. Line breaks and the like are escaped.
pub(crate) fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() => {
                let _ = write!(out, "\\u{{{:x}}}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}
