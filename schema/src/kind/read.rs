//! Reads the file of a kind: every fault at once, with its line.

use crate::check::{Checker, did_you_mean, given, optional, quoted, read};
use crate::kind::{Allowed, Bounds, Demand, Kind};
use crate::load::unknown_gene;
use crate::parameter::{Category, Parameter, Scale};
use crate::report::Report;
use crate::ron_tree::{Field, Node, Value};
use crate::space::Space;

const FIELDS: [&str; 5] = ["name", "source", "mixes", "genes", "goes_with"];
/// Characters of a kind's name, which is a part of what stands under a small picture.
const MAX_KIND_NAME: usize = 40;
/// Characters of a source and of a group's name.
const MAX_LINE: usize = 200;

impl Kind {
    /// Reads the text of a kind's file. `file` is its name for messages; category and id are those of its path.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub fn load(space: &Space, category: Category, id: &str, file: &str, text: &str) -> Result<Self, Report> {
        Self::load_as(space, category, id, file, text, false)
    }

    /// Of a kind that ships, values outside a narrower range of a world's own space are brought to its ends.
    pub(crate) fn load_as(
        space: &Space,
        category: Category,
        id: &str,
        file: &str,
        text: &str,
        ships: bool,
    ) -> Result<Self, Report> {
        read(file, text, |checker, root| Reader { space, category, checker, ships }.kind(id, root))
    }
}

struct Reader<'a, 't> {
    space: &'a Space,
    category: Category,
    checker: &'a mut Checker<'t>,
    ships: bool,
}

impl Reader<'_, '_> {
    fn kind(&mut self, id: &str, root: &Node<'_>) -> Option<Kind> {
        let fields = self.checker.root(root, "Kind", &FIELDS)?;
        let mut need = |name| self.checker.need(&fields, root, "the kind", name);
        let [name, source, mixes, genes] = ["name", "source", "mixes", "genes"].map(&mut need);
        let name = name.and_then(|node| self.line(node, "name", MAX_KIND_NAME));
        let source = source.and_then(|node| self.line(node, "source", MAX_LINE));
        let mixes = mixes.and_then(|node| self.mixes(node));
        let bounds = genes.and_then(|node| self.bounds(node));
        let goes_with = optional(&fields, "goes_with").map_or(Some(Vec::new()), |node| self.goes_with(node));
        let (category, id) = (self.category, id.to_owned());
        Some(Kind {
            id,
            category,
            ships: self.ships,
            name: name?,
            source: source?,
            mixes: mixes?,
            bounds: bounds?,
            goes_with: goes_with?,
        })
    }

    fn line(&mut self, node: &Node<'_>, what: &str, max: usize) -> Option<String> {
        let line = self.checker.line(node, what, max)?;
        if line.trim().is_empty() {
            return self.checker.refuse(node.span(), format!("{what} is empty"));
        }
        Some(line.trim().to_owned())
    }

    fn mixes(&mut self, node: &Node<'_>) -> Option<Vec<String>> {
        let groups = self.checker.list(node, "mixes")?;
        groups.iter().map(|group| self.line(group, "mixes", MAX_LINE)).collect()
    }

    fn bounds(&mut self, node: &Node<'_>) -> Option<Bounds> {
        let (space, category) = (self.space, self.category);
        let traits = space.category(category).filter(|gene| !gene.is_seed());
        let known: Vec<&str> = traits.map(|gene| gene.name.as_str()).collect();
        let hint = |name: &str| match space.find(name).is_some_and(Parameter::is_seed) {
            true => Some("; seeds are drawn for each individual".to_owned()),
            false => unknown_gene(space, name, category, &known),
        };
        let fields = self.checker.fields(node, "genes", &known, hint)?;
        let mut missing = Vec::new();
        let bounds =
            Bounds::new(space, category, |gene| match (optional(&fields, &gene.name), gene.default) {
                // A fault must not hide those of the genes behind it.
                (Some(node), _) => Some(self.gene(gene, node).unwrap_or_else(|| exactly(gene, 0))),
                (None, Some(code)) => Some(exactly(gene, code)),
                (None, None) => {
                    missing.push(format!("{} ({})", gene.name, gene.range_text()));
                    Some(exactly(gene, 0))
                }
            });
        if !missing.is_empty() {
            let count =
                if missing.len() == 1 { "1 gene is" } else { &format!("{} genes are", missing.len()) };
            let message = format!("genes: {count} missing: {}", missing.join(", "));
            self.checker.error(node.start..node.start + 1, message);
        }
        bounds
    }

    /// `20`, `(14, 20, 28)`, `(14, 28)`, or `[1, 2]` for a choice: the four forms of a gene.
    fn gene(&mut self, gene: &Parameter, node: &Node<'_>) -> Option<Allowed> {
        let Value::List(items) = &node.value else { return Some(exactly(gene, self.code(gene, node)?)) };
        let is_choice = gene.scale == Scale::Choice;
        if is_choice != node.text.starts_with('[') {
            let name = &gene.name;
            let message = match is_choice {
                true => {
                    format!("{name}: values between two choices mean something else; list them, as [1, 4]")
                }
                false => format!("{name}: a range stands in round brackets, as (min, typical, max)"),
            };
            return self.checker.refuse(node.span(), message);
        }
        let codes: Vec<Option<u32>> = items.iter().map(|item| self.code(gene, item)).collect();
        let mut codes = codes.into_iter().collect::<Option<Vec<u32>>>()?;
        if is_choice && !codes.is_empty() {
            codes.sort_unstable();
            codes.dedup();
            return Some(Allowed::OneOf(codes));
        }
        if !codes.is_sorted() {
            return self.checker.refuse(node.span(), format!("{}: {} must rise", gene.name, given(node)));
        }
        match codes[..] {
            [min, max] => Some(Allowed::Anywhere { min, max }),
            [min, typical, max] => Some(Allowed::Near { min, typical, max }),
            _ => {
                let forms = if is_choice { "[1, 4]" } else { "20, (14, 28) or (14, 20, 28)" };
                self.checker.wrong_kind(node, &gene.name, &format!("one of these forms: {forms}"))
            }
        }
    }

    fn code(&mut self, gene: &Parameter, node: &Node<'_>) -> Option<u32> {
        let (name, range) = (&gene.name, gene.range_text());
        let Value::Number(value) = node.value else {
            return self.checker.wrong_kind(node, name, &format!("a number, {range}"));
        };
        if !gene.contains(value) && !self.ships {
            return self.checker.refuse(node.span(), format!("{name}: {} is outside {range}", given(node)));
        }
        Some(gene.snap(value))
    }

    /// `(temperature_c: (4, 16), rain_mm: (500, 1600))`
    fn goes_with(&mut self, node: &Node<'_>) -> Option<Vec<Demand>> {
        let (space, own) = (self.space, self.category);
        let foreign = |gene: &&Parameter| gene.category != own && !gene.is_seed();
        let known: Vec<&str> =
            space.parameters().iter().filter(foreign).map(|gene| gene.name.as_str()).collect();
        let hint = |name: &str| Some(unknown_companion(space, own, name, &known));
        let fields = self.checker.fields(node, "goes_with", &known, hint)?;
        Some(fields.into_iter().filter_map(|field| self.demand(field)).collect())
    }

    fn demand(&mut self, field: &Field<'_>) -> Option<Demand> {
        let gene = self.space.find(field.name)?;
        let what = format!("goes_with: {}", gene.name);
        let ends = match &field.node.value {
            Value::List(items) => &items[..],
            _ => &[],
        };
        let [low, high] = ends else {
            return self.checker.wrong_kind(&field.node, &what, "a range, as (4, 16)");
        };
        let (low, high) = (self.code(gene, low)?, self.code(gene, high)?);
        if low > high {
            return self
                .checker
                .refuse(field.node.span(), format!("{what}: {} must rise", given(&field.node)));
        }
        Some(Demand { gene: gene.name.clone(), category: gene.category, codes: low..=high })
    }
}

fn exactly(gene: &Parameter, code: u32) -> Allowed {
    match gene.scale {
        Scale::Choice => Allowed::OneOf(vec![code]),
        _ => Allowed::Near { min: code, typical: code, max: code },
    }
}

fn unknown_companion(space: &Space, own: Category, name: &str, known: &[&str]) -> String {
    match space.find(name) {
        Some(gene) if gene.is_seed() => "; a seed says nothing of what a place is like".to_owned(),
        Some(_) => format!("; it is a gene of {own} itself: say what it may be under genes"),
        None => match did_you_mean(name, known) {
            near if near.is_empty() => format!("; {} is no gene: `bake params` lists them", quoted(name)),
            near => near,
        },
    }
}
