//! Writes populations as RON for people: a gene a line, its range beside it, always in the same order.

use std::collections::BTreeSet;
use std::fmt::Write;

use crate::genome::Genome;
use crate::parameter::{Category, Parameter};
use crate::population::{Individual, Parent, Population, Votes};
use crate::space::Space;
use crate::strategy::Strategy;

impl Population {
    /// The file's text. Reading it gives this population again; writing that gives this text again.
    pub fn to_ron(&self, space: &Space) -> String {
        let Self { generation, seed, .. } = self;
        let parent = self.parent.map_or(String::new(), |Parent { generation, votes, variety }| {
            let variety = variety.map_or(String::new(), |variety| format!(", variety: {variety}"));
            format!("    parent: Some((generation: {generation}, votes: {}{variety})),\n", cast_text(&votes))
        });
        let strategy = match self.strategy {
            Strategy::Learned => String::new(),
            classic @ Strategy::Classic => format!("    strategy: {},\n", quoted(classic.name())),
        };
        let bred_from = self.bred_from.as_ref().map_or(String::new(), |from| {
            let from =
                Category::ALL.map(|category| format!("{category}: {}", quoted(&from[category as usize])));
            format!("    // The parents that a person chose.\n    bred_from: ({}),\n", from.join(", "))
        });
        let variety = self.variety.map_or(String::new(), |variety| {
            let help =
                "How different the next are to be from the best guess: 0 close variations, 1 anything.";
            format!("    // {help}\n    variety: {variety},\n")
        });
        let votes = votes_text(self.votes.as_ref());
        let locked = match self.locked.is_empty() {
            true => String::new(),
            false => format!(
                "    // Genes and whole categories (tree, terrain, sky) that breeding leaves as they are.\n    \
                 locked: {},\n",
                locked_text(&self.locked)
            ),
        };
        let individual = |one: &Individual| {
            let genes = Category::ALL.map(|category| genes_text(space, category, &one.genome));
            let descent = match one.descent.is_empty() {
                true => String::new(),
                false => format!("            descent: {},\n", quoted(&one.descent)),
            };
            format!(
                "        (\n            name: {},\n{descent}{}        ),\n",
                quoted(&one.name),
                genes.concat()
            )
        };
        let individuals: String = self.individuals.iter().map(individual).collect();
        format!(
            "// Four landscapes. Edit any value within its range; the nearest value that its gene has is used.\n\
             // `bake params` says what each gene does.\n\
             Population(\n    generation: {generation},\n    seed: {seed},\n{parent}{strategy}{bred_from}    \
             // The best of each, as Some((tree: Some(0), terrain: Some(2), sky: None)): Some(0) is landscape 1, Some(3)\n    \
             // landscape 4, None no favourite.\n    \
             votes: {votes},\n{variety}{locked}    individuals: [\n{individuals}    ],\n)\n"
        )
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

/// One category's genes, a line each with its range.
fn genes_text(space: &Space, category: Category, genome: &Genome) -> String {
    // Wide enough for any value, so that a changed gene changes one line.
    let width = space.category(category).map(|gene| gene.name.len() + 9).max().unwrap_or(0);
    let line = |gene: &Parameter| {
        let value = format!("{}: {},", gene.name, gene.text(genome.code(gene)));
        format!("                {value:width$} // {}\n", gene.range_text())
    };
    let lines: String = space.category(category).map(line).collect();
    format!("            {category}: (\n{lines}            ),\n")
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
