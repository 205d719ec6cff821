//! How large each package is, in lines of Rust.

use std::collections::BTreeMap;

use anyhow::Result;

use crate::source::{Kind, Source, sources};

const KINDS: [(Kind, &str); 4] =
    [(Kind::Code, "code"), (Kind::Test, "tests"), (Kind::Comment, "comments"), (Kind::Blank, "blank")];

/// Prints a table of lines by package and kind, then the files with the most code.
pub fn run(largest: usize) -> Result<()> {
    let sources = sources()?;
    let counts =
        |source: &Source| KINDS.map(|(kind, _)| source.lines.iter().filter(|(k, _)| *k == kind).count());
    let mut packages = BTreeMap::<&str, [usize; 4]>::new();
    for source in &sources {
        let counts = counts(source);
        for name in [source.package(), "~ all"] {
            let sums = packages.entry(name).or_default();
            *sums = std::array::from_fn(|i| sums[i] + counts[i]);
        }
    }
    println!("{:<14}{}{:>10}", "", KINDS.map(|(_, name)| format!("{name:>10}")).concat(), "together");
    for (name, counts) in packages {
        let columns = counts.map(|count| format!("{count:>10}")).concat();
        println!("{name:<14}{columns}{:>10}", counts.iter().sum::<usize>());
    }
    let mut files: Vec<_> = sources.iter().map(|source| (counts(source)[0], &source.path)).collect();
    files.sort_by(|a, b| b.cmp(a));
    files.iter().take(largest).for_each(|(code, path)| println!("{code:>6}  {path}"));
    Ok(())
}
