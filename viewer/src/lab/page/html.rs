//! A page → HTML that needs no other file and no network.

use std::fmt::{self, Write};

use genescape_schema::html::{Escaped, base64};

use super::plot::STYLE as PLOT_STYLE;
use super::{Block, Finding, Page, Section, Table, Verdict};

const STYLE: &str = include_str!("page.css");

/// The whole page.
pub fn html(page: &Page) -> String {
    let mut out = String::new();
    // A String takes whatever is written.
    let _ = write_page(&mut out, page);
    out
}

fn write_page(out: &mut String, page: &Page) -> fmt::Result {
    let title = Escaped(&page.title);
    write!(
        out,
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
         <style>\n{STYLE}{PLOT_STYLE}</style>\n<header>\n<h1>{title}</h1>\n<dl>"
    )?;
    for (name, value) in &page.facts {
        writeln!(out, "<dt>{}</dt><dd>{}</dd>", Escaped(name), Escaped(value))?;
    }
    out.push_str("</dl>\n</header>\n");
    page.sections.iter().try_for_each(|section| write_section(out, section))?;
    out.push_str("</html>\n");
    Ok(())
}

fn write_section(out: &mut String, section: &Section) -> fmt::Result {
    write!(out, "<section>\n<h2>{}</h2>\n", Escaped(&section.title))?;
    if !section.said.is_empty() {
        writeln!(out, "<p>{}</p>", Escaped(&section.said))?;
    }
    for block in &section.blocks {
        match block {
            Block::Plots(plots) => {
                out.push_str("<div class=\"plots\">\n");
                plots.iter().try_for_each(|plot| writeln!(out, "{}", plot.svg()))?;
                out.push_str("</div>\n");
            }
            Block::Table(table) => write_table(out, table)?,
            Block::Pictures(pictures) => {
                out.push_str("<div class=\"pictures\">\n");
                for picture in pictures {
                    let (caption, data) = (Escaped(&picture.caption), base64(&picture.png));
                    writeln!(
                        out,
                        "<figure><img alt=\"{caption}\" src=\"data:image/png;base64,{data}\">\
                         <figcaption>{caption}</figcaption></figure>"
                    )?;
                }
                out.push_str("</div>\n");
            }
        }
    }
    if !section.findings.is_empty() {
        out.push_str("<ul class=\"findings\">\n");
        section.findings.iter().try_for_each(|finding| write_finding(out, finding))?;
        out.push_str("</ul>\n");
    }
    out.push_str("</section>\n");
    Ok(())
}

fn write_table(out: &mut String, table: &Table) -> fmt::Result {
    out.push_str("<div class=\"scroll\"><table>");
    if !table.caption.is_empty() {
        write!(out, "<caption>{}</caption>", Escaped(&table.caption))?;
    }
    let mut row = |cells: &[String], tag: &str| {
        out.push_str("<tr>");
        cells.iter().try_for_each(|cell| write!(out, "<{tag}>{}</{tag}>", Escaped(cell)))?;
        out.push_str("</tr>\n");
        fmt::Result::Ok(())
    };
    row(&table.head, "th")?;
    table.rows.iter().try_for_each(|cells| row(cells, "td"))?;
    out.push_str("</table></div>\n");
    Ok(())
}

fn write_finding(out: &mut String, finding: &Finding) -> fmt::Result {
    let class = match finding.verdict {
        Verdict::Holds => "holds",
        Verdict::HoldsNot => "not",
        Verdict::Open => "open",
    };
    let (word, sentence, claim) =
        (finding.verdict.word(), Escaped(&finding.sentence), Escaped(&finding.claim));
    writeln!(out, "<li class=\"{class}\"><small>{claim}</small><b>{word}:</b> {sentence}</li>")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::page::{Picture, Plot};
    use proptest::prelude::*;

    fn page(word: &str) -> Page {
        let word = || word.to_owned();
        let table = Table { caption: word(), head: vec![word()], rows: vec![vec![word()]] };
        let plot = Plot { name: word(), title: word(), x_label: word(), y_label: word(), ..Plot::default() };
        let picture = Picture { name: word(), png: vec![1, 2], caption: word() };
        let blocks = vec![Block::Plots(vec![plot]), Block::Table(table), Block::Pictures(vec![picture])];
        let findings = vec![Finding::new(true, word(), word())];
        let section = Section { title: word(), said: word(), blocks, findings };
        Page { title: word(), facts: vec![(word(), word())], sections: vec![section] }
    }

    proptest! {
        #[test]
        fn no_word_adds_to_the_page_but_text(word in "x[<>&\"'/a-z ]{0,30}") {
            let marks = |page: &str| ["<", ">", "\"", "'"].map(|mark| page.matches(mark).count());
            prop_assert_eq!(marks(&html(&page(&word))), marks(&html(&page("plain"))));
        }
    }

    #[test]
    fn the_page_needs_nothing_from_elsewhere() {
        let page = html(&page("a")).replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
        for word in ["http:", "https:", "url(", "<link", "<script"] {
            assert!(!page.contains(word), "{word}");
        }
    }
}
