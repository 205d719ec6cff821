//! Links lead somewhere, in the repository and in the book that mdbook makes of `docs/`.

use std::path::Path;

use crate::docs::pages::{Page, normal, root};

const SUMMARY: &str = "docs/SUMMARY.md";

#[test]
fn every_link_leads_to_a_file_and_a_heading() {
    let mut faults = Vec::new();
    for page in Page::all() {
        let is_external = |link: &str| link.contains("://") || link.starts_with("mailto:");
        for link in page.links().filter(|link| !is_external(link)) {
            if let Some(fault) = fault(&page, link) {
                faults.push(format!("{}: {link}: {fault}", page.path.display()));
            }
        }
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

fn fault(page: &Page, link: &str) -> Option<&'static str> {
    let (file, anchor) = link.split_once('#').map_or((link, None), |(file, anchor)| (file, Some(anchor)));
    let to =
        if file.is_empty() { page.path.clone() } else { normal(&page.path.with_file_name("").join(file)) };
    if !root().join(&to).exists() {
        return Some("no such file");
    }
    if page.path.starts_with("docs") && !to.starts_with("docs") {
        return Some("leads out of the book");
    }
    let is_known = anchor.is_none_or(|anchor| Page::read(&to).anchors().contains(anchor));
    (!is_known).then_some("no such heading")
}

#[test]
fn every_page_is_in_the_book_once() {
    let summary = Page::read(SUMMARY);
    let listed: Vec<_> = summary.links().map(|link| Path::new("docs").join(link)).collect();
    for page in Page::of_book().iter().filter(|page| page.path != Path::new(SUMMARY)) {
        let times = listed.iter().filter(|path| **path == page.path).count();
        assert_eq!(times, 1, "{} in {SUMMARY}", page.path.display());
    }
}

/// A newcomer's two minutes.
#[test]
fn readme_is_short() {
    let text = std::fs::read_to_string(root().join("README.md")).expect("a README");
    let words = text.split_whitespace().count();
    assert!(words < 450, "{words} words");
}
