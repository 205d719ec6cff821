//! Reads population and preset files: every fault of a file at once, every rounded or missing value told.

use std::collections::BTreeSet;

use crate::check::{Checker, MAX_NAME, did_you_mean, given, optional, quoted, read};
use crate::genome::{Chromosome, Genome};
use crate::lineage::{Lineage, read_bred_from, read_lineage, read_strategy};
use crate::parameter::{Category, Parameter};
use crate::population::{INDIVIDUALS, Individual, Loaded, LoadedPreset, Population, TreePreset};
use crate::report::Report;
use crate::ron_tree::{Node, Value};
use crate::space::Space;

impl Population {
    /// Reads the text of a population file; `file` is its name for messages.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub fn load(space: &Space, file: &str, text: &str) -> Result<Loaded, Report> {
        read(file, text, |checker, root| {
            let mut loader = Loader { space, checker, notices: Vec::new() };
            let population = loader.population(root)?;
            Some(Loaded { population, notices: loader.notices })
        })
    }
}

impl TreePreset {
    /// Reads the text of a tree preset; `file` is its name for messages.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub fn load(space: &Space, file: &str, text: &str) -> Result<LoadedPreset, Report> {
        read(file, text, |checker, root| {
            let mut loader = Loader { space, checker, notices: Vec::new() };
            let preset = loader.preset(root)?;
            Some(LoadedPreset { preset, notices: loader.notices })
        })
    }
}

struct Loader<'a, 't> {
    space: &'a Space,
    checker: &'a mut Checker<'t>,
    notices: Vec<String>,
}

impl Loader<'_, '_> {
    fn population(&mut self, root: &Node<'_>) -> Option<Population> {
        let (fields, lineage) = read_lineage(self.checker, root)?;
        let seed = self.checker.need(&fields, root, "Population", "seed");
        let seed = seed.and_then(|node| self.checker.whole(node, "seed", u64::MAX));
        let strategy = optional(&fields, "strategy").map(|node| read_strategy(self.checker, node));
        let bred_from = optional(&fields, "bred_from").and_then(|node| read_bred_from(self.checker, node));
        let locked = optional(&fields, "locked").map(|node| self.locked(node)).unwrap_or_default();
        let list = self.checker.need(&fields, root, "Population", "individuals")?;
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
            (0..INDIVIDUALS).zip(nodes).filter_map(|(index, node)| self.individual(index, node)).collect();
        let Lineage { generation, parent, votes, variety } = lineage?;
        Some(Population {
            generation,
            seed: seed?,
            parent,
            strategy: strategy.flatten().unwrap_or_default(),
            bred_from,
            individuals: individuals.try_into().ok()?,
            votes,
            variety,
            locked,
        })
    }

    /// `["height_m", "sky"]`: names of genes and of whole categories.
    fn locked(&mut self, node: &Node<'_>) -> BTreeSet<String> {
        let genes = self.space.parameters().iter().map(|parameter| parameter.name.as_str());
        let known: Vec<&str> = genes.chain(Category::ALL.map(Category::name)).collect();
        let mut locked = BTreeSet::new();
        for node in self.checker.list(node, "locked").unwrap_or_default() {
            let Some(name) = self.checker.text(node, "locked") else { continue };
            if known.contains(&name) {
                locked.insert(name.to_owned());
            } else {
                self.checker.error_with(node.span(), || {
                    let near = did_you_mean(name, &known);
                    format!("locked: {} is neither a gene nor a category{near}", quoted(name))
                });
            }
        }
        locked
    }

    fn individual(&mut self, index: usize, node: &Node<'_>) -> Option<Individual> {
        let what = format!("landscape {}", index + 1);
        let fields = self.checker.record(node, &what, &["name", "descent", "tree", "terrain", "sky"])?;
        let [name, descent] = ["name", "descent"].map(|what| {
            let line = optional(&fields, what).and_then(|node| self.checker.line(node, what, MAX_NAME));
            line.unwrap_or_default().to_owned()
        });
        let [tree, terrain, sky] = Category::ALL.map(|category| {
            let node = self.checker.need(&fields, node, &what, category.name())?;
            self.chromosome(category, node)
        });
        Some(Individual { name, descent, genome: Genome { chromosomes: [tree?, terrain?, sky?] } })
    }

    fn preset(&mut self, root: &Node<'_>) -> Option<TreePreset> {
        let fields = self.checker.root(root, "TreePreset", &["name", "tree"])?;
        let name = self.checker.need(&fields, root, "TreePreset", "name");
        let name = name.and_then(|node| self.checker.line(node, "name", MAX_NAME));
        let tree = self.checker.need(&fields, root, "TreePreset", "tree");
        let tree = tree.and_then(|node| self.chromosome(Category::Tree, node));
        Some(TreePreset { name: name?.to_owned(), tree: tree? })
    }

    fn chromosome(&mut self, category: Category, node: &Node<'_>) -> Option<Chromosome> {
        let space = self.space;
        let known: Vec<&str> = space.category(category).map(|parameter| parameter.name.as_str()).collect();
        let hint = |name: &str| unknown_gene(space, name, category, &known);
        let fields = self.checker.fields(node, category.name(), &known, hint)?;
        let mut chromosome = Chromosome::zero(space, category);
        let (mut missing, mut filled_in) = (Vec::new(), Vec::new());
        for parameter in space.category(category) {
            let name = &parameter.name;
            let code = match (optional(&fields, name), parameter.default) {
                (Some(node), _) => self.gene(parameter, node),
                // What is wrong with the space is told once, there.
                (None, Some(code)) if parameter.is_unread => Some(code),
                (None, Some(code)) => {
                    filled_in.push(format!("{name} {}", parameter.value_text(code)));
                    Some(code)
                }
                (None, None) => {
                    missing.push(format!("{name} ({})", parameter.range_text()));
                    None
                }
            };
            chromosome.set_code(parameter, code.unwrap_or(0));
        }
        let told = |genes: &[String], remedy: &str| {
            let count = if genes.len() == 1 { "1 gene is" } else { &format!("{} genes are", genes.len()) };
            format!("{category}: {count} missing{remedy}: {}", genes.join(", "))
        };
        if !missing.is_empty() {
            self.checker.error(node.start..node.start + 1, told(&missing, ""));
        }
        if !filled_in.is_empty() {
            self.notices.push(self.checker.note(node, told(&filled_in, "; defaults are used")));
        }
        Some(chromosome)
    }

    fn gene(&mut self, parameter: &Parameter, node: &Node<'_>) -> Option<u32> {
        let (name, range) = (&parameter.name, parameter.range_text());
        let Value::Number(value) = node.value else {
            return self.checker.wrong_kind(node, name, &format!("a number, {range}"));
        };
        if !parameter.contains(value) {
            return self.checker.refuse(node.span(), format!("{name}: {} is outside {range}", given(node)));
        }
        let code = parameter.snap(value);
        if !parameter.is_written_as(value, code) {
            let (given, used) = (given(node), parameter.value_text(code));
            let message = format!("{name}: for {given} the nearest value {used} is used");
            self.notices.push(self.checker.note(node, message));
        }
        Some(code)
    }
}

/// What to say to a name that is no gene of its chromosome.
pub(crate) fn unknown_gene(space: &Space, name: &str, category: Category, known: &[&str]) -> Option<String> {
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
