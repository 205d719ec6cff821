//! What was measured → a page beside what the thesis found.

mod bark;
mod figures;
mod preprocessing;
mod series;
mod system;
mod targets;

use std::path::Path;

use anyhow::Result;

use super::page::{Finding, Page, Section, Verdict, html, markdown};
use super::store::{self, Configuration, Store};

pub use series::{FIGURES, Series};

/// Writes `report.html`, `report.md` and the plots of the latter from the tables of a folder.
///
/// # Errors
/// Tables that are damaged, a folder that cannot be written to.
pub fn write(store: &Store, configuration: &Configuration) -> Result<()> {
    keep(store.root(), "report", &page(store, configuration)?)
}

/// Writes a page as `NAME.html`, and as `NAME.md` with its plots.
///
/// # Errors
/// A folder that cannot be written to.
pub fn keep(folder: &Path, name: &str, page: &Page) -> Result<()> {
    store::write(folder, &format!("{name}.html"), html(page))?;
    let (text, files) = markdown(page);
    store::write(folder, &format!("{name}.md"), text)?;
    files.into_iter().try_for_each(|(name, bytes)| store::write(folder, &name, bytes))
}

fn page(store: &Store, configuration: &Configuration) -> Result<Page> {
    let mut sections = figures::of_land(store, configuration.machine.software)?;
    sections.extend(figures::of_trees(store, configuration.machine.software)?);
    sections.push(bark::section(store, configuration.machine.software)?);
    sections.push(system::section(store)?);
    sections.push(preprocessing::section(store)?);
    sections.push(targets::section(store)?);
    sections.insert(0, summary(&sections));
    let title = "The thesis's experiments on this renderer".to_owned();
    Ok(Page { title, facts: configuration.facts(), sections })
}

/// How many findings hold.
fn summary(sections: &[Section]) -> Section {
    let findings = || sections.iter().flat_map(|section| &section.findings);
    let count = |verdict: Verdict| findings().filter(|finding| finding.verdict == verdict).count();
    let said = format!(
        "{} of the thesis's findings and of our targets hold, {} do not, {} were not measured. Frame times are of one view of \
         the thesis's size, waited for; L2 is the root of the mean square difference of colours in 0 … 1 from the picture \
         without levels of detail, FLIP what a person sees of it. What follows ± is the standard deviation over all frames.",
        count(Verdict::Holds),
        count(Verdict::HoldsNot),
        count(Verdict::Open)
    );
    Section { title: "In short".into(), said, ..Section::default() }
}

/// A claim that needs what was not measured.
fn open(claim: &str, why: &str) -> Finding {
    Finding { verdict: Verdict::Open, claim: claim.to_owned(), sentence: why.to_owned() }
}
