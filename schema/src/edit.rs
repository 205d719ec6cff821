//! Changes one value of a population file and leaves every other byte, comments included, as the person wrote it.

use std::collections::BTreeSet;
use std::ops::Range;

use crate::check::Checker;
use crate::parameter::Category;
use crate::population::Votes;
use crate::report::Report;
use crate::ron_tree::{Field, Node, Value, prepare};
use crate::space::Space;
use crate::variety::Variety;
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
    edit(file, text, |root| {
        let fields = struct_fields(root, "Population")?;
        match find(fields, "votes") {
            Ok(node) => Ok(vote_changes(node, votes)),
            Err(_) => add_field(text, fields, &format!("votes: {}", votes_text(votes.as_ref()))),
        }
    })
}

/// The text of a population file whose children are to be so different from the best guess.
///
/// # Errors
/// Text that is no population.
pub fn set_variety(file: &str, text: &str, variety: Option<Variety>) -> Result<String, EditError> {
    let written = variety.map_or("None".to_owned(), |variety| variety.to_string());
    edit(file, text, |root| {
        let fields = struct_fields(root, "Population")?;
        match find(fields, "variety") {
            Ok(node) => Ok(vec![(node.span(), written)]),
            Err(_) if variety.is_none() => Ok(Vec::new()),
            Err(_) => add_field(text, fields, &format!("variety: {written}")),
        }
    })
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
    edit(file, text, |root| {
        let fields = struct_fields(root, "Population")?;
        match find(fields, "locked") {
            Ok(node) => Ok(vec![(node.span(), locked_text(locked))]),
            Err(_) if locked.is_empty() => Ok(Vec::new()),
            Err(_) => add_field(text, fields, &format!("locked: {}", locked_text(locked))),
        }
    })
}

/// The text of a population file with another value, in the gene's unit, for one gene of an individual 0 … 3. The
/// value is written as its nearest code is; a gene that the file lacks gets a line of its own.
///
/// # Errors
/// Text that is no population, an individual that it lacks, an unknown gene, a value out of range.
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
    let (category, value) = (parameter.category.name(), parameter.text(parameter.snap(value)));
    edit(file, text, |root| {
        let list = find(struct_fields(root, "Population")?, "individuals")?;
        let Value::List(individuals) = &list.value else {
            return Err(EditError::Missing("individuals".into()));
        };
        let what = format!("landscape {}", individual + 1);
        let node = individuals.get(individual).ok_or_else(|| EditError::Missing(what.clone()))?;
        let genes = struct_fields(find(struct_fields(node, &what)?, category)?, category)?;
        match find(genes, name) {
            Ok(gene) => Ok(vec![(gene.span(), value)]),
            Err(_) => add_field(text, genes, &format!("{name}: {value}")),
        }
    })
}

/// What to write where; the places do not overlap.
type Changes = Vec<(Range<usize>, String)>;

/// Makes the changes that `changes` finds in the file's tree.
fn edit(
    file: &str,
    text: &str,
    changes: impl FnOnce(&Node<'_>) -> Result<Changes, EditError>,
) -> Result<String, EditError> {
    let prepared = prepare(text);
    let mut changes = changes(&Checker::new(file, &prepared).parse()?)?;
    changes.sort_by_key(|(span, _)| span.start);
    let mut out = text.to_owned();
    for (span, new) in changes.into_iter().rev() {
        out.replace_range(span, &new);
    }
    Ok(out)
}

/// A field more, for an older or shorter file: before the first one, where no comma can be missing.
fn add_field(text: &str, fields: &[Field<'_>], field: &str) -> Result<Changes, EditError> {
    let first = fields.first().ok_or_else(|| EditError::Missing(field.to_owned()))?.name_start;
    let indent = &text[text[..first].rfind('\n').map_or(0, |newline| newline + 1)..first];
    let gap = if indent.trim().is_empty() { format!("\n{indent}") } else { " ".into() };
    Ok(vec![(first..first, format!("{field},{gap}"))])
}

/// If every category has its place already, only what differs is touched.
fn vote_changes(node: &Node<'_>, votes: Option<Votes>) -> Changes {
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
