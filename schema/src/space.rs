//! The parameter space: `space.ron` read and checked. Mutation, decoding, sliders and tables derive from it.

use crate::check::{Checker, MAX_NAME, did_you_mean, optional, read};
use crate::parameter::{Category, Parameter, Scale};
use crate::report::Report;
use crate::ron_tree::{Node, Value};

/// Every gene, in the order of the file, which is their order in a chromosome.
#[derive(Clone, Debug, PartialEq)]
pub struct Space {
    parameters: Vec<Parameter>,
}

impl Space {
    /// The text of the space that Genescape brings along (`configs/space.ron`).
    pub const BUILTIN: &str = include_str!("../../configs/space.ron");

    /// The space that Genescape brings along.
    pub fn builtin() -> Self {
        Self::parse("space.ron", Self::BUILTIN).expect("a test proves configs/space.ron valid")
    }

    /// Reads the text of a `space.ron`; `file` is its name for messages.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub fn parse(file: &str, text: &str) -> Result<Self, Report> {
        read(file, text, |checker, root| read_space(checker, root, |_, _, _| {}))
    }

    /// Reads the `space.ron` of a world, which may have been made before some of the genes were known: those that it
    /// lacks are declared as in the built-in space, with a notice for each. So are those that it has and nothing reads:
    /// files may lack these.
    ///
    /// # Errors
    /// Everything that is wrong with it, genes of another kind than the landscapes are made from included.
    pub fn load(file: &str, text: &str) -> Result<(Self, Vec<String>), Report> {
        let (builtin, mut notices) = (Self::builtin(), Vec::new());
        let mut space = read(file, text, |checker, root| {
            read_space(checker, root, |checker, node, gene| {
                notices.extend(compare(checker, node, gene, &builtin));
            })
        })?;
        for gene in builtin.parameters {
            if space.find(&gene.name).is_none() {
                let default = gene.default.map(|code| format!(", default {}", gene.text(code)));
                let (name, range, default) = (&gene.name, gene.range_text(), default.unwrap_or_default());
                notices
                    .push(format!("{file} lacks {name}; the built-in declaration is used: {range}{default}"));
                space.add(gene);
            }
        }
        Ok((space, notices))
    }

    /// Puts a gene behind the others of its category.
    fn add(&mut self, gene: Parameter) {
        let offset = self.bits(gene.category);
        self.parameters.push(Parameter { offset, ..gene });
    }

    /// All genes.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// The genes of one category, in order.
    pub fn category(&self, category: Category) -> impl Iterator<Item = &Parameter> {
        self.parameters.iter().filter(move |parameter| parameter.category == category)
    }

    /// The genes of one category but the seed, in order: what a kind can have.
    pub fn traits(&self, category: Category) -> impl Iterator<Item = &Parameter> {
        self.category(category).filter(|gene| !gene.is_seed())
    }

    /// A gene by name.
    pub fn find(&self, name: &str) -> Option<&Parameter> {
        self.parameters.iter().find(|parameter| parameter.name == name)
    }

    /// Bits of one category's chromosome.
    pub fn bits(&self, category: Category) -> u32 {
        self.category(category).map(|parameter| parameter.bits).sum()
    }
}

/// Finds what is wrong with a gene of a world that the program also declares; a notice of one that it does not, which may
/// then be lacking in a file.
fn compare(
    checker: &mut Checker<'_>,
    node: &Node<'_>,
    gene: &mut Parameter,
    builtin: &Space,
) -> Option<String> {
    let Some(known) = builtin.find(&gene.name) else {
        gene.default.get_or_insert(0);
        gene.is_unread = true;
        let names: Vec<&str> = builtin.parameters().iter().map(|known| known.name.as_str()).collect();
        let near = did_you_mean(&gene.name, &names);
        return Some(checker.note(node, format!("{} is a gene that nothing reads{near}", gene.name)));
    };
    if gene.group.is_empty() {
        gene.group.clone_from(&known.group);
    }
    if known.scale == Scale::Choice && gene.scale == Scale::Integer {
        gene.scale = Scale::Choice;
    }
    let (is_whole, must_be) = (gene.scale.is_whole(), known.scale.is_whole());
    let fault = match (is_whole, must_be) {
        (false, true) => "landscapes are made from whole numbers here: the scale must be integer",
        (true, false) => "the scale must be linear or logarithmic here; integer is for what is counted",
        (true, true) if gene.range.0 < 0.0 => "what is counted cannot be negative",
        _ => return None,
    };
    checker.error(node.span(), format!("{}: {fault}", gene.name));
    None
}

/// Reads the file; `look` sees each gene before it is taken in.
fn read_space(
    checker: &mut Checker<'_>,
    root: &Node<'_>,
    mut look: impl FnMut(&mut Checker<'_>, &Node<'_>, &mut Parameter),
) -> Option<Space> {
    let fields = checker.root(root, "Space", &["version", "parameters"])?;
    if let Some(node) = checker.need(&fields, root, "Space", "version")
        && let Some(version) = checker.whole(node, "version", u32::MAX)
        && version != 1
    {
        checker.error(node.span(), format!("version: {version} is unknown; this program reads version 1"));
    }
    let list = checker.need(&fields, root, "Space", "parameters")?;
    let nodes = checker.list(list, "parameters")?;
    let mut space = Space { parameters: Vec::new() };
    for node in nodes {
        let Some(mut gene) = read_parameter(checker, node) else { continue };
        look(checker, node, &mut gene);
        match space.find(&gene.name) {
            Some(_) => checker.error(node.span(), format!("{} is declared twice", gene.name)),
            None => space.add(gene),
        }
    }
    for category in Category::ALL {
        if space.parameters.len() == nodes.len() && space.category(category).next().is_none() {
            checker.error(list.start..list.start + 1, format!("no parameter has category {category}"));
        }
    }
    Some(space)
}

/// Characters that a gene's help may have.
const MAX_HELP: usize = 1000;
/// No landscape is made of greater numbers, in whatever unit.
const MAX_VALUE: f64 = 1e9;

const FIELDS: [&str; 9] = ["name", "category", "group", "bits", "range", "scale", "unit", "help", "default"];

fn read_parameter(checker: &mut Checker<'_>, node: &Node<'_>) -> Option<Parameter> {
    let fields = checker.record(node, "a parameter", &FIELDS)?;
    let mut need = |name| checker.need(&fields, node, "the parameter", name);
    let [name, category, bits, range] = ["name", "category", "bits", "range"].map(&mut need);
    let [scale, unit, help] = ["scale", "unit", "help"].map(need);
    let name = name.and_then(|node| read_name(checker, node));
    let category = category.and_then(|node| {
        checker.word(node, "category", &Category::ALL.map(Category::name), Category::from_name)
    });
    let bits = bits.and_then(|node| read_bits(checker, node));
    let scale =
        scale.and_then(|node| checker.word(node, "scale", &Scale::ALL.map(Scale::name), Scale::from_name));
    let ends = range.and_then(|node| read_range(checker, node));
    let unit = unit.and_then(|node| checker.line(node, "unit", MAX_NAME))?.to_owned();
    let help = help.and_then(|node| checker.line(node, "help", MAX_HELP))?.to_owned();
    let group = optional(&fields, "group").map(|node| checker.line(node, "group", MAX_NAME));
    let group = group.map_or(Some(""), |group| group)?.to_owned();
    let (name, category, bits, scale) = (name?, category?, bits?, scale?);
    let mut gene = Parameter {
        name,
        category,
        group,
        bits,
        range: ends?,
        scale,
        unit,
        help,
        default: None,
        is_unread: false,
        offset: 0,
    };
    if let Some(fault) = range_fault(&gene) {
        return checker.refuse(range?.span(), format!("{}: {fault}", gene.name));
    }
    if let Some(node) = optional(&fields, "default") {
        let default = checker.number(node, "default")?;
        if !gene.contains(default) {
            let range = gene.range_text();
            let message = format!("{}: the default {default} is outside {range}", gene.name);
            return checker.refuse(node.span(), message);
        }
        gene.default = Some(gene.snap(default));
    }
    Some(gene)
}

fn read_name(checker: &mut Checker<'_>, node: &Node<'_>) -> Option<String> {
    let name = checker.line(node, "name", MAX_NAME)?;
    let letters = name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
    if letters && name.starts_with(|c: char| c.is_ascii_lowercase()) {
        return Some(name.to_owned());
    }
    checker.refuse(node.span(), format!("name: {name:?} must be lower_case letters, digits and underscores"))
}

fn read_bits(checker: &mut Checker<'_>, node: &Node<'_>) -> Option<u32> {
    let bits = checker.whole(node, "bits", 16)?;
    match bits {
        1..=16 => Some(bits),
        _ => checker.refuse(node.span(), format!("bits: {bits} is outside 1 … 16")),
    }
}

fn read_range(checker: &mut Checker<'_>, node: &Node<'_>) -> Option<(f64, f64)> {
    if let Value::List(ends) = &node.value
        && let [low, high] = &ends[..]
    {
        let (low, high) = (checker.number(low, "range"), checker.number(high, "range"));
        return low.zip(high);
    }
    checker.wrong_kind(node, "range", "two numbers, as (0.0, 1.0)")
}

/// What is wrong with a range, if anything.
fn range_fault(parameter: &Parameter) -> Option<String> {
    let (low, high) = parameter.range;
    let codes = parameter.last_code();
    if !low.is_finite() || !high.is_finite() {
        return Some("the range must be finite".into());
    }
    if low.abs().max(high.abs()) > MAX_VALUE {
        return Some(format!("the range must lie within ±{MAX_VALUE:e}"));
    }
    if low >= high {
        return Some(format!("the range must rise, but {low} is not below {high}"));
    }
    match parameter.scale {
        Scale::Logarithmic if low <= 0.0 => {
            return Some(format!("a logarithmic range must be above 0, but begins at {low}"));
        }
        Scale::Integer | Scale::Choice if low.fract() != 0.0 || high.fract() != 0.0 => {
            return Some("an integer range must have whole ends".into());
        }
        Scale::Integer | Scale::Choice if high - low != f64::from(codes) => {
            let (bits, count, fit) = (parameter.bits, high - low + 1.0, low + f64::from(codes));
            let all = u64::from(codes) + 1;
            return Some(format!(
                "{low} … {high} are {count} whole numbers, but {bits} bits hold {all}: {low} … {fit}"
            ));
        }
        _ => {}
    }
    // The bake computes with f32: two codes that look the same there would be a gene without effect.
    let same = (0..codes).any(|code| parameter.value(code) as f32 == parameter.value(code + 1) as f32);
    same.then(|| format!("{} bits are finer than single precision in this range", parameter.bits))
}
