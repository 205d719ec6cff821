//! Changes one value of a population file and leaves every other byte, comments included, as the person wrote it.

use std::collections::BTreeSet;
use std::ops::Range;

use crate::check::Checker;
use crate::parameter::Category;
use crate::population::Votes;
use crate::report::Report;
use crate::ron_tree::{Field, Node, Value, prepare};
use crate::space::Space;
use crate::write::{locked_text, vote_text, votes_text};

/// A change that cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EditError {
    /// The text is no RON.
    #[error(transparent)]
    Syntax(#[from] Report),
    /// The text is RON, but not a population.
    #[error("the file has no {0}")]
    Missing(String),
    /// The value is not allowed.
    #[error("{name}: {value} is outside {range}")]
    Range {
        /// Which gene.
        name: String,
        /// What was asked for.
        value: f64,
        /// What is allowed, with its unit.
        range: String,
    },
}

/// The text of a population file with other votes.
///
/// # Errors
/// Text that is no population.
pub fn set_votes(file: &str, text: &str, votes: Option<Votes>) -> Result<String, EditError> {
    let prepared = prepare(text);
    let root = Checker::new(file, &prepared).parse()?;
    let fields = struct_fields(&root, "Population")?;
    match find(fields, "votes") {
        Ok(node) => Ok(replace(text, vote_changes(node, votes))),
        Err(_) => add_field(text, &prepared, fields, &format!("votes: {}", votes_text(votes.as_ref()))),
    }
}

/// The text of a population file in which breeding leaves other genes and categories as they are.
///
/// # Errors
/// Text that is no population; a name that is neither a gene nor a category.
pub fn set_locked(
    space: &Space,
    file: &str,
    text: &str,
    locked: &BTreeSet<String>,
) -> Result<String, EditError> {
    let known = |name: &str| space.find(name).is_some() || Category::from_name(name).is_some();
    if let Some(unknown) = locked.iter().find(|name| !known(name)) {
        return Err(EditError::Missing(format!("gene {unknown}")));
    }
    let prepared = prepare(text);
    let root = Checker::new(file, &prepared).parse()?;
    let fields = struct_fields(&root, "Population")?;
    match find(fields, "locked") {
        Ok(node) => Ok(replace(text, vec![(node.span(), locked_text(locked))])),
        Err(_) if locked.is_empty() => Ok(text.to_owned()),
        Err(_) => add_field(text, &prepared, fields, &format!("locked: {}", locked_text(locked))),
    }
}

/// A field more, for an older or shorter file: before its first one, where no comma can be missing.
fn add_field(text: &str, prepared: &str, fields: &[Field<'_>], field: &str) -> Result<String, EditError> {
    let first = fields.first().ok_or_else(|| EditError::Missing("individuals".into()))?;
    let line = prepared[..first.name_start].rfind('\n').map_or(0, |newline| newline + 1);
    let indent = &prepared[line..first.name_start];
    let gap = if indent.trim().is_empty() { format!("\n{indent}") } else { " ".into() };
    Ok(replace(text, vec![(first.name_start..first.name_start, format!("{field},{gap}"))]))
}

/// The text of a population file with another value, in the gene's unit, for one gene of an individual 0 … 3. The
/// value is written as its nearest code is.
///
/// # Errors
/// Text that is no population, an individual or gene that it lacks, a value out of range.
pub fn set_gene(
    space: &Space,
    file: &str,
    text: &str,
    individual: usize,
    name: &str,
    value: f64,
) -> Result<String, EditError> {
    let parameter = space.find(name).ok_or_else(|| EditError::Missing(format!("gene {name}")))?;
    if !parameter.contains(value) {
        return Err(EditError::Range { name: name.into(), value, range: parameter.range_text() });
    }
    let prepared = prepare(text);
    let root = Checker::new(file, &prepared).parse()?;
    let list = find(struct_fields(&root, "Population")?, "individuals")?;
    let Value::List(individuals) = &list.value else { return Err(EditError::Missing("individuals".into())) };
    let what = format!("individual {individual}");
    let node = individuals.get(individual).ok_or_else(|| EditError::Missing(what.clone()))?;
    let chromosome = find(struct_fields(node, &what)?, parameter.category.name())?;
    let gene = find(struct_fields(chromosome, parameter.category.name())?, name)?;
    let change = (gene.span(), parameter.text(parameter.snap(value)));
    Ok(replace(text, vec![change]))
}

/// What to write where. If every category has its place already, only what differs is touched.
fn vote_changes(node: &Node<'_>, votes: Option<Votes>) -> Vec<(Range<usize>, String)> {
    let whole = vec![(node.span(), votes_text(votes.as_ref()))];
    let (Value::Some(cast), Some(votes)) = (&node.value, votes) else { return whole };
    let Value::Struct(fields) = &cast.value else { return whole };
    let mut changes = Vec::new();
    for category in Category::ALL {
        let mut places = fields.iter().filter(|field| field.name == category.name());
        let (Some(place), None) = (places.next(), places.next()) else { return whole };
        let text = vote_text(votes.get(category));
        if place.node.text != text {
            changes.push((place.node.span(), text));
        }
    }
    changes
}

/// Makes changes, which must not overlap.
fn replace(text: &str, mut changes: Vec<(Range<usize>, String)>) -> String {
    changes.sort_by_key(|(span, _)| span.start);
    let mut out = text.to_owned();
    for (span, new) in changes.into_iter().rev() {
        out.replace_range(span, &new);
    }
    out
}

fn struct_fields<'n, 'a>(node: &'n Node<'a>, what: &str) -> Result<&'n [Field<'a>], EditError> {
    match &node.value {
        Value::Struct(fields) => Ok(fields),
        _ => Err(EditError::Missing(what.to_owned())),
    }
}

fn find<'n, 'a>(fields: &'n [Field<'a>], name: &str) -> Result<&'n Node<'a>, EditError> {
    let field = fields.iter().find(|field| field.name == name);
    field.map(|field| &field.node).ok_or_else(|| EditError::Missing(name.to_owned()))
}
