//! Lineage: the fields of a population file that say which generation it comes from, readable even when its genes are
//! not, and the generations that votes ask for.

use crate::check::{Checker, MAX_NAME, given, optional, read};
use crate::parameter::Category;
use crate::population::{INDIVIDUALS, Parent, Votes};
use crate::report::Report;
use crate::ron_tree::{Field, Node, Value};
use crate::strategy::Strategy;
use crate::variety::Variety;

/// Fields that a population file may have.
const FIELDS: [&str; 9] =
    ["generation", "seed", "parent", "strategy", "bred_from", "votes", "variety", "locked", "individuals"];

/// A population file without its genes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lineage {
    pub generation: u32,
    /// What it was bred from; `None` for one that was made otherwise.
    pub parent: Option<Parent>,
    /// The votes on it.
    pub votes: Option<Votes>,
    /// How different its children are to be, if anybody said.
    pub variety: Option<Variety>,
}

impl Lineage {
    /// Reads these fields and no others, whatever the genes are like: a change of the space must not make children
    /// unknown to their parents.
    ///
    /// # Errors
    /// What is wrong with these fields.
    pub fn read(file: &str, text: &str) -> Result<Self, Report> {
        read(file, text, |checker, root| read_lineage(checker, root)?.1)
    }

    /// The record that a child bred now would carry; `None` while there are no votes.
    pub fn wanted(&self) -> Option<Parent> {
        let Self { generation, variety, .. } = *self;
        self.votes.map(|votes| Parent { generation, votes, variety })
    }
}

/// The children that are wanted and not there: one for each population with votes that no population says it was
/// bred from, see [`Parent::is_answered_by`]. In the order of generations.
pub fn unanswered(lineages: &[Lineage]) -> Vec<Parent> {
    let mut wanted: Vec<Parent> = lineages.iter().filter_map(Lineage::wanted).collect();
    let parents: Vec<Parent> = lineages.iter().filter_map(|child| child.parent).collect();
    wanted.retain(|wanted| !parents.iter().any(|parent| wanted.is_answered_by(parent)));
    wanted.sort_by_key(|parent| parent.generation);
    wanted.dedup();
    wanted
}

/// The fields of a population file, and the lineage that they give.
pub(crate) fn read_lineage<'n, 't>(
    checker: &mut Checker<'_>,
    root: &'n Node<'t>,
) -> Option<(Vec<&'n Field<'t>>, Option<Lineage>)> {
    let fields = checker.root(root, "Population", &FIELDS)?;
    let generation = checker.need(&fields, root, "Population", "generation");
    let generation = generation.and_then(|node| checker.whole(node, "generation", u32::MAX));
    // A file without these lines is one that was not bred, one without votes.
    let parent = optional(&fields, "parent").and_then(|node| read_parent(checker, node));
    let votes = optional(&fields, "votes").and_then(|node| read_votes(checker, node));
    let variety = optional(&fields, "variety").and_then(|node| read_variety(checker, node));
    let lineage = generation.map(|generation| Lineage { generation, parent, votes, variety });
    Some((fields, lineage))
}

/// `Some((generation: 3, votes: (…)))`, with or without the `Some`, or `None`.
fn read_parent(checker: &mut Checker<'_>, node: &Node<'_>) -> Option<Parent> {
    let node = unwrapped(node)?;
    let fields = checker.record(node, "parent", &["generation", "votes", "variety"])?;
    let generation = checker.need(&fields, node, "parent", "generation");
    let generation = generation.and_then(|node| checker.whole(node, "parent: generation", u32::MAX));
    let votes = checker.need(&fields, node, "parent", "votes");
    let votes = votes.and_then(|node| read_votes(checker, node)).unwrap_or_default();
    let variety = optional(&fields, "variety").and_then(|node| read_variety(checker, node));
    Some(Parent { generation: generation?, votes, variety })
}

/// `0.3`, with or without a `Some`, or `None`.
fn read_variety(checker: &mut Checker<'_>, node: &Node<'_>) -> Option<Variety> {
    let node = unwrapped(node)?;
    let number = checker.number(node, "variety")?;
    Variety::of(number).or_else(|| {
        let text = format!("variety: {} is outside 0, close variations, … 1, anything", given(node));
        checker.refuse(node.span(), text)
    })
}

/// `"classic"`.
pub(crate) fn read_strategy(checker: &mut Checker<'_>, node: &Node<'_>) -> Option<Strategy> {
    let name = checker.text(node, "strategy")?;
    name.parse().map_or_else(
        |known| checker.refuse(node.span(), format!("strategy: {} is none; there is {known}", given(node))),
        Some,
    )
}

/// `(tree: "3.2", terrain: "fjord", sky: "old.ron:1")`, with or without a `Some`, or `None`.
pub(crate) fn read_bred_from(checker: &mut Checker<'_>, node: &Node<'_>) -> Option<[String; 3]> {
    let node = unwrapped(node)?;
    let names = Category::ALL.map(Category::name);
    let fields = checker.record(node, "bred_from", &names)?;
    let [tree, terrain, sky] = names.map(|name| {
        let parent = checker.need(&fields, node, "bred_from", name)?;
        Some(checker.line(parent, &format!("bred_from: {name}"), MAX_NAME)?.to_owned())
    });
    Some([tree?, terrain?, sky?])
}

/// `Some((tree: Some(0), …))`, with or without each `Some`, or `None`.
fn read_votes(checker: &mut Checker<'_>, node: &Node<'_>) -> Option<Votes> {
    let names = Category::ALL.map(Category::name);
    let mut votes = Votes::default();
    for field in checker.record(unwrapped(node)?, "votes", &names)? {
        if let Some(category) = Category::from_name(field.name) {
            votes.set(category, read_vote(checker, category, &field.node));
        }
    }
    Some(votes)
}

fn read_vote(checker: &mut Checker<'_>, category: Category, node: &Node<'_>) -> Option<usize> {
    let number = unwrapped(node)?;
    match number.value {
        Value::Number(vote) if vote.fract() == 0.0 && (0.0..INDIVIDUALS as f64).contains(&vote) => {
            Some(vote as usize)
        }
        Value::Number(_) => {
            let (given, last) = (given(number), INDIVIDUALS - 1);
            let message = format!(
                "votes: {category}: {given} is none of the four: Some(0) is landscape 1, Some({last}) landscape {INDIVIDUALS}"
            );
            checker.refuse(number.span(), message)
        }
        _ => checker.wrong_kind(number, &format!("votes: {category}"), "None or Some(0) … Some(3)"),
    }
}

/// What is in a `Some`; a value that stands without one; nothing for `None`.
fn unwrapped<'n, 'a>(node: &'n Node<'a>) -> Option<&'n Node<'a>> {
    match &node.value {
        Value::None => None,
        Value::Some(value) => Some(value),
        _ => Some(node),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use proptest::strategy::Strategy;

    fn lineage(generation: u32, parent: Option<Parent>, votes: Option<Votes>) -> Lineage {
        Lineage { generation, parent, votes, variety: None }
    }

    fn votes() -> impl Strategy<Value = Votes> {
        let vote = || prop::option::of(0..INDIVIDUALS);
        (vote(), vote(), vote()).prop_map(|(tree, terrain, sky)| Votes { tree, terrain, sky })
    }

    proptest! {
        #[test]
        fn once_every_wish_has_its_child_nothing_more_is_wanted(
            cast in prop::collection::vec(prop::option::of(votes()), 1..6)
        ) {
            let mut all: Vec<Lineage> =
                cast.iter().zip(0..).map(|(&votes, generation)| lineage(generation, None, votes)).collect();
            let wanted = unanswered(&all);
            prop_assert_eq!(wanted.len(), cast.iter().flatten().count());
            for (number, parent) in (all.len() as u32..).zip(wanted) {
                all.push(lineage(number, Some(parent), None));
            }
            prop_assert_eq!(unanswered(&all), []);
        }

        #[test]
        fn other_votes_on_an_old_generation_want_another_child(old in votes(), new in votes()) {
            let child = lineage(1, Some(Parent { generation: 0, votes: old, variety: None }), None);
            let wanted = unanswered(&[lineage(0, None, Some(new)), child]);
            prop_assert_eq!(wanted.is_empty(), old == new);
        }
    }

    #[test]
    fn where_variety_is_asked_for_only_such_children_answer() {
        let votes = Votes { tree: Some(1), terrain: None, sky: Some(3) };
        let [none, low, high] = [None, Some(Variety::MIN), Some(Variety::MAX)];
        for (asked, bred, answers) in
            [(none, none, true), (none, low, true), (low, low, true), (low, high, false), (low, none, false)]
        {
            let child = lineage(1, Some(Parent { generation: 0, votes, variety: bred }), None);
            let parents = Lineage { variety: asked, ..lineage(0, None, Some(votes)) };
            assert_eq!(unanswered(&[parents, child]).is_empty(), answers, "{asked:?}, {bred:?}");
        }
    }

    #[test]
    fn lineage_is_read_from_a_file_whose_genes_are_wrong() {
        let text = "Population(generation: 4, seed: 1, individuals: [(tree: (height: 1))],
            parent: Some((generation: 2, votes: (tree: Some(1), sky: 3))), votes: None)";
        let votes = Votes { tree: Some(1), terrain: None, sky: Some(3) };
        let expected = lineage(4, Some(Parent { generation: 2, votes, variety: None }), None);
        assert_eq!(Lineage::read("p.ron", text), Ok(expected));
        let error =
            Lineage::read("p.ron", "(generation: 4, parent: (generaton: 3))").expect_err("a typing error");
        assert!(error.to_string().contains("did you mean generation?"), "{error}");
    }
}
