//! Reads population and preset files: every fault of a file at once, every rounded value told.

use std::collections::BTreeSet;

use crate::check::{Checker, did_you_mean, given};
use crate::genome::{Chromosome, Genome};
use crate::lineage::{read_parent, read_votes};
use crate::parameter::{Category, Parameter};
use crate::population::{INDIVIDUALS, Individual, Loaded, LoadedPreset, Population, Snap, TreePreset};
use crate::report::Report;
use crate::ron_tree::{Node, Value, prepare};
use crate::space::Space;

/// Fields that a population file may have.
pub(crate) const FIELDS: [&str; 6] = ["generation", "seed", "parent", "votes", "locked", "individuals"];

impl Population {
    /// Reads the text of a population file; `file` is its name for messages.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub fn load(space: &Space, file: &str, text: &str) -> Result<Loaded, Report> {
        let text = prepare(text);
        let checker = Checker::new(file, &text);
        let root = checker.parse()?;
        let mut loader = Loader { space, file, checker, snaps: Vec::new() };
        let population = loader.population(&root);
        let snaps = std::mem::take(&mut loader.snaps);
        loader.checker.finish(population.map(|population| Loaded { population, snaps }))
    }
}

impl TreePreset {
    /// Reads the text of a tree preset; `file` is its name for messages.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub fn load(space: &Space, file: &str, text: &str) -> Result<LoadedPreset, Report> {
        let text = prepare(text);
        let checker = Checker::new(file, &text);
        let root = checker.parse()?;
        let mut loader = Loader { space, file, checker, snaps: Vec::new() };
        let preset = loader.preset(&root);
        let snaps = std::mem::take(&mut loader.snaps);
        loader.checker.finish(preset.map(|preset| LoadedPreset { preset, snaps }))
    }
}

struct Loader<'a> {
    space: &'a Space,
    file: &'a str,
    checker: Checker<'a>,
    snaps: Vec<Snap>,
}

impl<'a> Loader<'a> {
    fn population(&mut self, root: &Node<'a>) -> Option<Population> {
        const WHAT: &str = "Population";
        let fields = self.checker.root(root, WHAT, &FIELDS)?;
        let generation = self.checker.need(&fields, root, WHAT, "generation");
        let generation = generation.and_then(|node| self.checker.whole(node, "generation", u32::MAX));
        let seed = self.checker.need(&fields, root, WHAT, "seed");
        let seed = seed.and_then(|node| self.checker.whole(node, "seed", u64::MAX));
        // A file without these lines is one that was not bred, one on which nobody voted.
        let optional = |name| fields.iter().find(|field| field.name == name).map(|field| &field.node);
        let parent = optional("parent").and_then(|node| read_parent(&mut self.checker, node));
        let votes = optional("votes").and_then(|node| read_votes(&mut self.checker, node));
        let locked = optional("locked").map(|node| self.locked(node)).unwrap_or_default();
        let list = self.checker.need(&fields, root, WHAT, "individuals")?;
        let nodes = self.checker.list(list, "individuals")?;
        if nodes.len() != INDIVIDUALS {
            let found = match nodes.len() {
                0 => "the population is empty".to_owned(),
                count => format!("found {count}"),
            };
            let end = list.start + 1;
            self.checker.error(list.start..end, format!("individuals: {found}; there must be {INDIVIDUALS}"));
        }
        let individuals: Vec<_> =
            nodes.iter().enumerate().filter_map(|(index, node)| self.individual(index, node)).collect();
        let individuals = individuals.try_into().ok()?;
        Some(Population { generation: generation?, seed: seed?, parent, individuals, votes, locked })
    }

    /// `["height_m", "sky"]`: names of genes and of whole categories.
    fn locked(&mut self, node: &Node<'a>) -> BTreeSet<String> {
        let genes = self.space.parameters().iter().map(|parameter| parameter.name.as_str());
        let known: Vec<&str> = genes.chain(Category::ALL.map(Category::name)).collect();
        let mut locked = BTreeSet::new();
        for node in self.checker.list(node, "locked").unwrap_or_default() {
            let Some(name) = self.checker.text(node, "locked") else { continue };
            if known.contains(&name) {
                locked.insert(name.to_owned());
            } else {
                let near = did_you_mean(name, &known);
                self.checker
                    .error(node.span(), format!("locked: {name} is neither a gene nor a category{near}"));
            }
        }
        locked
    }

    fn individual(&mut self, index: usize, node: &Node<'a>) -> Option<Individual> {
        let what = format!("individual {index}");
        let fields = self.checker.record(node, &what, &["name", "tree", "terrain", "sky"])?;
        let name = fields.iter().find(|field| field.name == "name");
        let name =
            name.and_then(|field| self.checker.text(&field.node, "name")).unwrap_or_default().to_owned();
        let chromosomes = Category::ALL.map(|category| {
            let node = self.checker.need(&fields, node, &what, category.name())?;
            self.chromosome(index, category, node)
        });
        let [tree, terrain, sky] = chromosomes;
        Some(Individual { name, genome: Genome { chromosomes: [tree?, terrain?, sky?] } })
    }

    fn preset(&mut self, root: &Node<'a>) -> Option<TreePreset> {
        let fields = self.checker.root(root, "TreePreset", &["name", "tree"])?;
        let name = self.checker.need(&fields, root, "TreePreset", "name");
        let name = name.and_then(|node| self.checker.text(node, "name"));
        let tree = self.checker.need(&fields, root, "TreePreset", "tree");
        let tree = tree.and_then(|node| self.chromosome(0, Category::Tree, node));
        Some(TreePreset { name: name?.to_owned(), tree: tree? })
    }

    fn chromosome(&mut self, individual: usize, category: Category, node: &Node<'a>) -> Option<Chromosome> {
        let space = self.space;
        let known: Vec<&str> = space.category(category).map(|parameter| parameter.name.as_str()).collect();
        let hint = |name: &str| unknown_gene(space, name, category, &known);
        let fields = self.checker.fields(node, category.name(), &known, hint)?;
        let mut chromosome = Chromosome::zero(space, category);
        let mut missing = Vec::new();
        for parameter in space.category(category) {
            match fields.iter().find(|field| field.name == parameter.name) {
                Some(field) => {
                    if let Some(code) = self.gene(individual, parameter, &field.node) {
                        chromosome.set_code(parameter, code);
                    }
                }
                None => missing.push(format!("{} ({})", parameter.name, parameter.range_text())),
            }
        }
        if !missing.is_empty() {
            let plural = if missing.len() == 1 { "gene is" } else { "genes are" };
            let message = format!("{category}: {} {plural} missing: {}", missing.len(), missing.join(", "));
            self.checker.error(node.start..node.start + 1, message);
        }
        Some(chromosome)
    }

    fn gene(&mut self, individual: usize, parameter: &Parameter, node: &Node<'a>) -> Option<u32> {
        let (name, range) = (&parameter.name, parameter.range_text());
        let Value::Number(value) = node.value else {
            self.checker.wrong_kind(node, name, &format!("a number, {range}"));
            return None;
        };
        if !parameter.contains(value) {
            self.checker.error(node.span(), format!("{name}: {} is outside {range}", given(node)));
            return None;
        }
        let code = parameter.snap(value);
        if !parameter.is_written_as(value, code) {
            let (line, column) = self.checker.place(node);
            self.snaps.push(Snap {
                file: self.file.to_owned(),
                line,
                column,
                individual,
                parameter: name.clone(),
                given: node.text.to_owned(),
                used: parameter.text(code),
                unit: parameter.unit.clone(),
            });
        }
        Some(code)
    }
}

/// What to say to a name that is no gene of its chromosome.
fn unknown_gene(space: &Space, name: &str, category: Category, known: &[&str]) -> Option<String> {
    if let Some(parameter) = space.find(name) {
        return Some(format!("; it belongs into {}", parameter.category));
    }
    let near = did_you_mean(name, known);
    if !near.is_empty() {
        return Some(near);
    }
    let elsewhere: Vec<&str> = space.parameters().iter().map(|parameter| parameter.name.as_str()).collect();
    let near = did_you_mean(name, &elsewhere);
    Some(if near.is_empty() { format!("; `bake params` lists the genes of {category}") } else { near })
}
