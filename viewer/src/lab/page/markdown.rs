//! A page → Markdown, with plots and pictures as files beside it.

use std::fmt::{self, Write};

use super::{Block, Page, Section, Table};

/// Where plots and pictures lie, from the page.
const FOLDER: &str = "plots";

/// The page, and the files that it shows: names and bytes.
pub fn markdown(page: &Page) -> (String, Vec<(String, Vec<u8>)>) {
    let (mut out, mut files) = (String::new(), Vec::new());
    // A String takes whatever is written.
    let _ = write_page(&mut out, &mut files, page);
    (out, files)
}

fn write_page(out: &mut String, files: &mut Vec<(String, Vec<u8>)>, page: &Page) -> fmt::Result {
    writeln!(out, "# {}\n", line(&page.title))?;
    page.facts.iter().try_for_each(|(name, value)| writeln!(out, "- {}: {}", line(name), line(value)))?;
    page.sections.iter().try_for_each(|section| write_section(out, files, section))
}

fn write_section(out: &mut String, files: &mut Vec<(String, Vec<u8>)>, section: &Section) -> fmt::Result {
    writeln!(out, "\n## {}\n\n{}", line(&section.title), line(&section.said))?;
    let mut file = |name: String, caption: &str, bytes: Vec<u8>| {
        let shown = format!("\n![{}]({name})", line(caption));
        files.push((name, bytes));
        shown
    };
    for block in &section.blocks {
        match block {
            Block::Plots(plots) => plots.iter().try_for_each(|plot| {
                let name = format!("{FOLDER}/{}.svg", plot.name);
                writeln!(out, "{}", file(name, &plot.title, plot.svg_file().into_bytes()))
            })?,
            Block::Pictures(pictures) => pictures.iter().try_for_each(|picture| {
                let name = format!("{FOLDER}/{}.png", picture.name);
                writeln!(out, "{}", file(name, &picture.caption, picture.png.clone()))
            })?,
            Block::Table(table) => write_table(out, table)?,
        }
    }
    out.push('\n');
    for finding in &section.findings {
        let (word, claim, sentence) = (finding.verdict.word(), line(&finding.claim), line(&finding.sentence));
        writeln!(out, "- **{word}** ({claim}): {sentence}")?;
    }
    Ok(())
}

fn write_table(out: &mut String, table: &Table) -> fmt::Result {
    if !table.caption.is_empty() {
        writeln!(out, "\n{}", line(&table.caption))?;
    }
    let row = |cells: &[String]| {
        let cells: Vec<String> = cells.iter().map(|cell| line(cell).replace('|', "\\|")).collect();
        format!("| {} |", cells.join(" | "))
    };
    writeln!(out, "\n{}\n|{}", row(&table.head), "---|".repeat(table.head.len()))?;
    table.rows.iter().try_for_each(|cells| writeln!(out, "{}", row(cells)))
}

/// One line, in which nothing is markup.
fn line(text: &str) -> String {
    let one = text.replace(['\n', '\r'], " ");
    one.replace('\\', "\\\\").replace('<', "&lt;").replace('*', "\\*").replace('[', "\\[")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::page::Plot;

    #[test]
    fn plots_are_files_and_cells_stay_in_their_columns() {
        let table = Table {
            head: vec!["a".into(), "b".into()],
            rows: vec![vec!["1|2".into(), "x\ny".into()]],
            ..Table::default()
        };
        let plot = Plot { name: "figure-21".into(), title: "T".into(), ..Plot::default() };
        let blocks = vec![Block::Table(table), Block::Plots(vec![plot])];
        let page = Page { sections: vec![Section { blocks, ..Section::default() }], ..Page::default() };
        let (text, files) = markdown(&page);
        assert!(text.contains("| 1\\|2 | x y |") && text.contains("![T](plots/figure-21.svg)"), "{text}");
        assert_eq!(files[0].0, "plots/figure-21.svg");
        assert!(String::from_utf8_lossy(&files[0].1).contains("<style>"), "it has its colours with it");
    }
}
