//! A family → one HTML page that needs no other file and no network: a row for each generation, lines from parents to
//! children, a search by name. Without scripts it can be read as well.

use std::fmt::{self, Display, Write};

use genescape_schema::html::{Escaped, base64};
use genescape_schema::lanes::{self, Line};
use genescape_schema::{Category, INDIVIDUALS, Individual, Population, Strategy, Votes, landscape_named};

use super::{Family, Generation};

/// What a page begins with that this program made, and may replace.
pub const BEGINNING: &str = "<!doctype html>\n<!-- made by bake lineage -->\n";

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// Pixels from lane to lane, and from the top of a row to its dot.
const LANE_PX: usize = 18;
const DOT_PX: usize = 14;
/// A column of the lines from parents to children, and the height of these, in units of their drawing.
const COLUMN: usize = 100;
const HEIGHT: usize = 50;

/// The whole page.
pub fn page(family: &Family) -> String {
    let mut out = String::new();
    // A String takes whatever is written.
    let _ = write_page(&mut out, family);
    out
}

fn write_page(out: &mut String, family: &Family) -> fmt::Result {
    let Family { name, generations, skipped } = family;
    let numbers: Vec<(u32, Option<u32>)> = generations
        .iter()
        .map(|one| (one.population.generation, one.population.parent_generations().pop()))
        .collect();
    let rows = lanes::rows(&numbers);
    let lanes = rows.iter().map(|row| row.lane + 1).max().unwrap_or(0);
    let (title, count) = (Escaped(name), generations.len());
    let s = if count == 1 { "" } else { "s" };
    write!(
        out,
        "{BEGINNING}<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}: family tree</title>\n<style>\n{STYLE}</style>\n<header>\n<h1><bdi>{title}</bdi></h1>\n\
         <p>{count} generation{s} of four landscapes, found by choosing.</p>\n\
         <p class=\"legend\">Lines lead from parents to children: <span class=\"tree\">trees</span> \
         <span class=\"terrain\">land</span> <span class=\"sky\">sky</span></p>\n</header>\n\
         <form class=\"search\" role=\"search\" onsubmit=\"return false\" hidden><input type=\"search\" \
         placeholder=\"Search by name\" aria-label=\"Search by name\"> <output></output></form>\n<ol>\n"
    )?;
    let mut before: Option<&Population> = None;
    for (one, row) in generations.iter().zip(&rows) {
        let number = one.population.generation;
        write!(out, "<li class=\"generation\" id=\"g{number}\">")?;
        write_lanes(out, row, lanes)?;
        write!(
            out,
            "<div>\n<h2><span>Generation {number}<small>{}</small></span></h2>\n",
            Origin { family, one }
        )?;
        write_descent(out, &one.population, before.map(|before| before.generation))?;
        out.push_str("<div class=\"four\">\n");
        for landscape in 0..INDIVIDUALS {
            write_landscape(out, one, landscape)?;
        }
        out.push_str("</div></div></li>\n");
        before = Some(&one.population);
    }
    out.push_str("</ol>\n");
    if !skipped.is_empty() {
        writeln!(out, "<section class=\"skipped\"><h2>Left out, for these files cannot be read</h2>")?;
        skipped.iter().try_for_each(|fault| writeln!(out, "<pre>{}</pre>", Escaped(fault)))?;
        out.push_str("</section>\n");
    }
    write!(out, "<script>\n{SCRIPT}</script>\n</html>\n")
}

/// What stands beside a generation's number.
struct Origin<'a> {
    family: &'a Family,
    one: &'a Generation,
}

impl Display for Origin<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Population { seed, parent, strategy, votes, .. } = &self.one.population;
        let chosen = self.one.population.bred_from.as_ref().filter(|_| parent.is_none());
        if let Some([tree, terrain, sky]) = chosen {
            let [tree, terrain, sky] = [tree, terrain, sky].map(|name| self.linked(name));
            write!(f, "bred from chosen parents: trees of {tree}, land of {terrain}, sky of {sky}, ")?;
        }
        if *strategy == Strategy::Classic {
            f.write_str("as in the thesis, ")?;
        }
        match parent.map(|parent| parent.generation) {
            Some(parent) if self.has(parent) => {
                write!(f, "bred from <a href=\"#g{parent}\">generation {parent}</a>, ")?;
            }
            Some(parent) => write!(f, "bred from generation {parent}, which is not here, ")?,
            None => {}
        }
        write!(f, "seed {seed}")?;
        match votes {
            None => f.write_str(", no votes yet"),
            Some(votes) => {
                let none = Category::ALL.into_iter().filter(|category| votes.favourite(*category).is_none());
                let none: Vec<&str> = none.map(part).collect();
                if none.is_empty() { Ok(()) } else { write!(f, ", none had the best {}", none.join(" or ")) }
            }
        }
    }
}

impl Origin<'_> {
    fn has(&self, generation: u32) -> bool {
        self.family.generations.iter().any(|one| one.population.generation == generation)
    }

    /// What a chosen parent is called, as a link to it if it is here.
    fn linked(&self, name: &str) -> String {
        let text = Escaped(name);
        match landscape_named(name) {
            Some((generation, landscape)) if self.has(generation) => {
                format!("<a href=\"#g{generation}-{landscape}\">{text}</a>")
            }
            _ => text.to_string(),
        }
    }
}

fn part(category: Category) -> &'static str {
    match category {
        Category::Tree => "trees",
        Category::Terrain => "land",
        Category::Sky => "sky",
    }
}

/// A dot for the generation, and what leads from it to others or past it.
fn write_lanes(out: &mut String, row: &lanes::Row, lanes: usize) -> fmt::Result {
    let middle = |lane: usize| LANE_PX * lane + LANE_PX / 2 + 2;
    let (width, x) = (LANE_PX * lanes + 14, middle(row.lane));
    write!(out, "<div class=\"lanes\" style=\"width:{width}px\"><svg aria-hidden=\"true\">")?;
    for line in &row.lines {
        let (from, to, top, bottom) = match *line {
            Line::Past(lane) => (middle(lane), middle(lane), "0".into(), "100%"),
            Line::In => (x, x, "0".into(), "14"),
            Line::Out => (x, x, DOT_PX.to_string(), "100%"),
            Line::Branch(lane) => (x, middle(lane), DOT_PX.to_string(), "100%"),
        };
        write!(out, "<line x1=\"{from}\" y1=\"{top}\" x2=\"{to}\" y2=\"{bottom}\"/>")?;
    }
    write!(out, "<circle cx=\"{x}\" cy=\"{DOT_PX}\" r=\"6\"/></svg></div>")
}

/// Lines from the four landscapes of the parents' generation, which stand above, to these four.
fn write_descent(out: &mut String, population: &Population, above: Option<u32>) -> fmt::Result {
    let Some(parent) = population.parent else { return Ok(()) };
    let is_joined = above == Some(parent.generation);
    if !is_joined {
        out.push_str("<div class=\"parents\">");
        for landscape in 1..=INDIVIDUALS {
            let generation = parent.generation;
            write!(out, "<a href=\"#g{generation}-{landscape}\">{generation}.{landscape} ↓</a>")?;
        }
        out.push_str("</div>\n");
    }
    let (width, height) = (COLUMN * INDIVIDUALS, HEIGHT);
    write!(
        out,
        "<div class=\"descent{}\"><svg viewBox=\"0 0 {width} {height}\" preserveAspectRatio=\"none\" aria-hidden=\"true\">",
        if is_joined { " joined" } else { "" }
    )?;
    for (child, one) in population.individuals.iter().enumerate() {
        for (category, parents) in Category::ALL.into_iter().zip(one.parents()) {
            for parent in parents {
                // Three lines side by side arrive at each landscape.
                let at = |column: usize| COLUMN * column + COLUMN / 2 - 8 + 8 * category as usize;
                let (from, to, half) = (at(parent - 1), at(child), HEIGHT / 2);
                write!(
                    out,
                    "<path class=\"{category}\" d=\"M{from} 0C{from} {half} {to} {half} {to} {height}\"/>"
                )?;
            }
        }
    }
    out.push_str("</svg></div>\n");
    Ok(())
}

fn write_landscape(out: &mut String, generation: &Generation, landscape: usize) -> fmt::Result {
    let Generation { population, thumbnails } = generation;
    let Individual { name, descent, .. } = &population.individuals[landscape];
    let (number, id) = (landscape + 1, population.generation);
    write!(out, "<article class=\"landscape\" id=\"g{id}-{number}\">")?;
    match &thumbnails[landscape] {
        Some(jpeg) => {
            let (name, data) = (Escaped(name), base64(jpeg));
            write!(out, "<img alt=\"{name}\" src=\"data:image/jpeg;base64,{data}\">")?;
        }
        None => out.push_str(PLACEHOLDER),
    }
    let name = if name.is_empty() { "without a name" } else { name };
    write!(out, "<h3><b>{number}</b><bdi>{}</bdi></h3>", Escaped(name))?;
    if !descent.is_empty() {
        write!(out, "<p>{}</p>", Escaped(descent))?;
    }
    out.push_str("<ul>");
    for category in population.votes.iter().flat_map(|votes| won(votes, landscape)) {
        write!(out, "<li class=\"{category}\">best {}</li>", part(category))?;
    }
    out.push_str("</ul></article>\n");
    Ok(())
}

/// The categories that a landscape has the best of.
fn won(votes: &Votes, landscape: usize) -> impl Iterator<Item = Category> {
    Category::ALL.into_iter().filter(move |category| votes.favourite(*category) == Some(landscape))
}

/// For a landscape that nobody has looked at yet: hills.
const PLACEHOLDER: &str = "<svg class=\"picture\" viewBox=\"0 0 160 100\" preserveAspectRatio=\"xMidYMid slice\" aria-hidden=\"true\">\
    <path fill=\"#8fb3cc\" d=\"M0 0h160v100H0z\"/><path fill=\"#7d9a86\" d=\"M0 62l34-26 30 20 34-30 62 40v34H0z\"/>\
    <path fill=\"#5d7a58\" d=\"M0 78q40-22 80-6t80-8v36H0z\"/></svg>";

#[cfg(test)]
mod tests {
    use super::*;
    use genescape_schema::{Parent, Space};
    use proptest::prelude::*;

    fn generation(number: u32, parent: Option<u32>, name: &str, descent: &str) -> Generation {
        let votes = Votes { tree: Some(2), terrain: None, sky: Some(2) };
        let parent = parent.map(|generation| Parent { generation, votes, variety: None });
        let mut population =
            Population { parent, votes: Some(votes), ..Population::random(&Space::builtin(), 7, number) };
        for one in &mut population.individuals {
            (one.name, one.descent) = (name.to_owned(), descent.to_owned());
        }
        Generation { population, thumbnails: [const { None }; INDIVIDUALS] }
    }

    fn family(generations: Vec<Generation>) -> Family {
        Family { name: "alps".into(), generations, skipped: Vec::new() }
    }

    proptest! {
        #[test]
        fn no_name_adds_to_the_page_but_text(name in "x[<>&\"'/a-z ]{0,30}", world in "x[<>&\"' a-z]{0,12}") {
            let page = |name: &str, world: &str| {
                let one = generation(0, None, name, name);
                page(&Family { name: world.to_owned(), skipped: vec![name.to_owned()], ..family(vec![one]) })
            };
            let marks = |page: &str| ["<", ">", "\"", "'"].map(|mark| page.matches(mark).count());
            prop_assert_eq!(marks(&page(&name, &world)), marks(&page("plain", "plain")));
        }
    }

    #[test]
    fn every_part_that_has_parents_has_a_line_from_each() {
        let first = generation(0, None, "first", "");
        let second = generation(1, Some(0), "second", "trees of 2 · land of 1 × 4 · new sky");
        let page = page(&family(vec![first, second]));
        let lines = |of: &str| page.matches(&format!("<path class=\"{of}\"")).count();
        assert_eq!(["tree", "terrain", "sky"].map(lines), [INDIVIDUALS, 2 * INDIVIDUALS, 0]);
        assert!(page.contains("<a href=\"#g0\">generation 0</a>"));
        for id in ["g0", "g1", "g0-1", "g1-4"] {
            assert_eq!(page.matches(&format!("id=\"{id}\"")).count(), 1, "{id}");
        }
        assert_eq!(page.matches("best trees</li>").count(), 2, "one in each generation");
        assert_eq!(page.matches("none had the best land").count(), 2);
    }

    #[test]
    fn parents_that_are_elsewhere_are_named_above_the_lines() {
        let generations = [(0, None), (1, Some(0)), (2, Some(0)), (3, Some(9))];
        let generations = generations.map(|(number, parent)| generation(number, parent, "", "trees of 1"));
        let page = page(&family(generations.into()));
        assert_eq!(
            page.matches(">0.1 ↓</a>").count(),
            1,
            "generation 2 alone does not stand under its parents"
        );
        assert!(page.contains("bred from generation 9, which is not here"));
    }

    #[test]
    fn the_page_needs_nothing_from_elsewhere() {
        let page = page(&family(vec![generation(0, None, "a", "")]));
        for word in ["http:", "https:", "url(", "<link", "src=\"page"] {
            assert!(!page.contains(word), "{word}");
        }
    }
}
