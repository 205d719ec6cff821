//! The person's steps, and the way back: ballots, changes of population files, generations asked for. A change of a file
//! is one span of its text, comments stay, and what the file said before is remembered. Nothing that an editor has written
//! meanwhile is ever lost: a change is taken back only if the file still says what the change has made it say.

use std::collections::BTreeSet;

use genescape_cache::Digest;
use genescape_schema::edit::{EditError, set_gene, set_locked, set_variety, set_votes};
use genescape_schema::{Category, Space, Variety, Votes};
use genescape_world::{World, WorldError, names};
use serde::{Deserialize, Serialize};

use crate::ballots::Ballots;

/// Steps that are remembered of a world: so many lines of the settings file.
const STEPS: usize = 100;

/// One change of a population file.
#[derive(Clone, Debug, PartialEq)]
pub enum Edit {
    /// The votes become these.
    Votes(Option<Votes>),
    /// Breeding leaves these genes and categories as they are, and no others.
    Locked(BTreeSet<String>),
    /// The next landscapes are to be so different from the best guess.
    Variety(Variety),
    /// Genes of one landscape get other values, in their units.
    Genes { individual: usize, values: Vec<(String, f64)> },
}

impl Edit {
    /// What it is, in a few words.
    pub fn name(&self) -> String {
        match self {
            Self::Votes(Some(_)) => "votes".into(),
            Self::Votes(None) => "removal of votes".into(),
            Self::Locked(_) => "locks".into(),
            Self::Variety(_) => "variety".into(),
            Self::Genes { values, individual } => match &values[..] {
                [(name, _)] => format!("{name} of landscape {}", individual + 1),
                several => format!("{} genes of landscape {}", several.len(), individual + 1),
            },
        }
    }

    /// The text of a file after this change; `file` is its name for messages.
    ///
    /// # Errors
    /// Text that is no population, a gene that is not there, a value out of range.
    pub fn apply(&self, space: &Space, file: &str, text: &str) -> Result<String, EditError> {
        match self {
            Self::Votes(votes) => set_votes(file, text, *votes),
            Self::Locked(locked) => set_locked(space, file, text, locked),
            Self::Variety(variety) => set_variety(file, text, Some(*variety)),
            Self::Genes { individual, values } => {
                values.iter().try_fold(text.to_owned(), |text, (name, value)| {
                    set_gene(space, file, &text, *individual, name, *value)
                })
            }
        }
    }
}

/// Why a step could not be taken back or made again.
#[derive(Debug, thiserror::Error)]
#[error("cannot {what} {step}: {why}")]
pub struct UndoError {
    /// "undo" or "redo".
    what: &'static str,
    step: String,
    why: Why,
}

#[derive(Debug, thiserror::Error)]
enum Why {
    /// The file says something else than the step has left.
    #[error("{0} was changed elsewhere since, and that would be lost")]
    Foreign(String),
    #[error(transparent)]
    File(#[from] WorldError),
}

/// A change that was made in a population file, and can be taken back and made again: one span of its text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Change {
    pub generation: u32,
    /// In a few words: "height_m of landscape 2".
    pub name: String,
    /// The byte at which the span begins.
    at: usize,
    before: String,
    after: String,
    /// Digests of the whole text without and with the change.
    digests: [String; 2],
}

impl Change {
    /// Changes a generation's population file; `None` if it says so already.
    ///
    /// # Errors
    /// A change that the file does not allow, a file that cannot be read or written.
    pub fn make(
        files: &World,
        space: &Space,
        generation: u32,
        edit: &Edit,
    ) -> Result<Option<Self>, WorldError> {
        let path = files.population_path(generation);
        let before = files.population_text(generation)?;
        let after = edit
            .apply(space, &path.display().to_string(), &before)
            .map_err(|error| WorldError::Edit { path, error })?;
        if after == before {
            return Ok(None);
        }
        files.replace_population(generation, &before, &after)?;
        Ok(Some(Self::between(generation, edit.name(), &before, &after)))
    }

    /// What leads from one text to another.
    fn between(generation: u32, name: String, before: &str, after: &str) -> Self {
        let same = |(a, b): &(char, char)| a == b;
        let length = |pairs: &mut dyn Iterator<Item = (char, char)>| {
            pairs.take_while(same).map(|(char, _)| char.len_utf8()).sum::<usize>()
        };
        let at = length(&mut before.chars().zip(after.chars()));
        let tail = length(&mut before[at..].chars().rev().zip(after[at..].chars().rev()));
        let span = |text: &str| text[at..text.len() - tail].to_owned();
        let digests = [before, after].map(digest);
        Self { generation, name, at, before: span(before), after: span(after), digests }
    }

    /// Takes it back.
    ///
    /// # Errors
    /// If the file says something else than this change has left; then it is left as it is.
    pub fn undo(&self, files: &World) -> Result<(), UndoError> {
        let [without, with] = &self.digests;
        self.replace(files, "undo", [with, without], [&self.after, &self.before])
    }

    /// Makes it again.
    ///
    /// # Errors
    /// As [`Change::undo`].
    pub fn redo(&self, files: &World) -> Result<(), UndoError> {
        let [without, with] = &self.digests;
        self.replace(files, "redo", [without, with], [&self.before, &self.after])
    }

    fn replace(
        &self,
        files: &World,
        what: &'static str,
        [now, then]: [&String; 2],
        [old, new]: [&str; 2],
    ) -> Result<(), UndoError> {
        let foreign = || {
            let file = names::population(self.generation);
            UndoError { what, step: self.name.clone(), why: Why::Foreign(file) }
        };
        let failed = |error: WorldError| match error {
            WorldError::Changed(_) => foreign(),
            other => UndoError { what, step: self.name.clone(), why: Why::File(other) },
        };
        let text = files.population_text(self.generation).map_err(failed)?;
        let (head, rest) = text.split_at_checked(self.at).ok_or_else(foreign)?;
        let changed = rest.strip_prefix(old).map(|tail| format!("{head}{new}{tail}"));
        let changed = changed.filter(|changed| digest(&text) == *now && digest(changed) == *then);
        files.replace_population(self.generation, &text, &changed.ok_or_else(foreign)?).map_err(failed)
    }
}

fn digest(text: &str) -> String {
    Digest::of(text.as_bytes()).to_string()
}

/// A step that can be taken back and made again.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Step {
    /// The ballots on a generation, which are written nowhere yet, became others.
    Ballots { generation: u32, before: Ballots, after: Ballots },
    /// A population file was changed.
    File(Change),
    /// The next generation was asked for by these ballots; with the change of its parents' file, unless that held
    /// these votes already.
    Bred { from: u32, ballots: Ballots, change: Option<Change> },
}

impl Step {
    /// What it did, in a few words.
    pub fn name(&self) -> String {
        match self {
            Self::Ballots { before, after, .. } => {
                let changed = |category: &Category| before.get(*category) != after.get(*category);
                let names: Vec<_> = Category::ALL.into_iter().filter(changed).map(Category::name).collect();
                format!("vote on {}", names.join(", "))
            }
            Self::File(change) => change.name.clone(),
            Self::Bred { from, .. } => format!("breeding from generation {from}"),
        }
    }
}

/// The person's steps in one world, kept between runs.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Steps {
    /// Oldest first.
    pub done: Vec<Step>,
    /// Those that were taken back, the one to make again first at the end.
    pub undone: Vec<Step>,
}

impl Steps {
    /// Adds a step that was made. From here on there is nothing to make again.
    pub fn push(&mut self, step: Step) {
        self.undone.clear();
        self.done.push(step);
        if self.done.len() > STEPS {
            self.done.remove(0);
        }
    }

    /// The ballots on a generation that were cast and not yet written down.
    pub fn ballots(&self, generation: u32) -> Ballots {
        let of = |step: &Step| match step {
            Step::Ballots { generation: of, after, .. } if *of == generation => Some(*after),
            Step::Bred { from, .. } if *from == generation => Some(Ballots::default()),
            _ => None,
        };
        self.done.iter().rev().find_map(of).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ballots::Ballot;
    use genescape_schema::Population;
    use genescape_world::atomic_write::replace as save;
    use proptest::prelude::*;

    fn world() -> (tempfile::TempDir, World) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let files = World::new(folder.path());
        let space = Space::builtin();
        let text = Population::random(&space, 3, 0).to_ron(&space).replacen("seed", "/* mine */ seed", 1);
        save(&files.population_path(0), &text).expect("saved");
        (folder, files)
    }

    fn gene(value: f64) -> Edit {
        Edit::Genes { individual: 1, values: vec![("height_m".into(), value)] }
    }

    fn edit() -> impl Strategy<Value = Edit> {
        let vote = || prop::option::of(0..4usize);
        prop_oneof![
            (vote(), vote(), vote()).prop_map(|(tree, terrain, sky)| Edit::Votes(Some(Votes {
                tree,
                terrain,
                sky
            }))),
            Just(Edit::Votes(None)),
            (0.0..=1.0f64).prop_map(|part| Edit::Variety(Variety::of(part).expect("0 to 1"))),
            (4f64..29.0).prop_map(gene),
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 16, ..ProptestConfig::default() })]

        #[test]
        fn undo_walks_back_through_every_text_and_redo_forth(edits in prop::collection::vec(edit(), 1..6)) {
            let ((_folder, files), space) = (world(), Space::builtin());
            let text = || files.population_text(0).expect("there");
            let (mut texts, mut changes) = (vec![text()], Vec::new());
            for edit in &edits {
                if let Some(change) = Change::make(&files, &space, 0, edit).expect("allowed") {
                    texts.push(text());
                    changes.push(through_a_file(&change));
                }
            }
            prop_assert!(texts.iter().all(|text| text.contains("/* mine */")));
            for (change, before) in changes.iter().zip(&texts).rev() {
                change.undo(&files).expect("the last one");
                prop_assert_eq!(&text(), before);
            }
            for (change, after) in changes.iter().zip(&texts[1..]) {
                change.redo(&files).expect("the next one");
                prop_assert_eq!(&text(), after);
            }
        }
    }

    /// As it comes back from the settings.
    fn through_a_file(change: &Change) -> Change {
        ron::from_str(&ron::to_string(change).expect("RON")).expect("the same")
    }

    fn make(files: &World, edit: &Edit) -> Change {
        Change::make(files, &Space::builtin(), 0, edit).expect("allowed").expect("another text")
    }

    #[test]
    fn an_editors_change_is_never_lost() {
        let (_folder, files) = world();
        let first = make(&files, &gene(9.0));
        let ours = files.population_text(0).expect("there");
        let theirs = format!("// by hand\n{ours}");
        save(&files.population_path(0), &theirs).expect("saved");
        let error = first.undo(&files).expect_err("a foreign change").to_string();
        assert!(error.contains("height_m of landscape 2") && error.contains("g0000.ron"), "{error}");
        assert_eq!(files.population_text(0).expect("there"), theirs);
        // A new change is made on top of theirs, and its undo leaves theirs.
        let second = make(&files, &gene(12.0));
        second.undo(&files).expect("ours");
        assert_eq!(files.population_text(0).expect("there"), theirs);
        save(&files.population_path(0), &ours).expect("taken back in the editor");
        first.undo(&files).expect("the file says again what we wrote");
    }

    #[test]
    fn a_refused_change_leaves_the_file_alone() {
        let ((_folder, files), space) = (world(), Space::builtin());
        let before = files.population_text(0).expect("there");
        let both =
            Edit::Genes { individual: 0, values: vec![("height_m".into(), 9.0), ("height_m".into(), 900.0)] };
        let error = Change::make(&files, &space, 0, &both).expect_err("out of range");
        assert!(error.to_string().contains("outside 3 … 30 m"), "{error}");
        assert_eq!(files.population_text(0).expect("there"), before);
        assert!(Change::make(&files, &space, 5, &gene(9.0)).is_err(), "no such generation");
    }

    #[test]
    fn ballots_are_those_cast_since_the_last_breeding() {
        let mut steps = Steps::default();
        let cast = |best| {
            let mut ballots = Ballots::default();
            ballots.set(Category::Sky, Ballot::For(best));
            ballots
        };
        let ballots =
            |generation, best| Step::Ballots { generation, before: Ballots::default(), after: cast(best) };
        steps.push(ballots(0, 1));
        steps.push(ballots(2, 3));
        assert_eq!([0, 1, 2].map(|of| steps.ballots(of)), [cast(1), Ballots::default(), cast(3)]);
        steps.push(Step::Bred { from: 0, ballots: cast(1), change: None });
        assert_eq!([0, 2].map(|of| steps.ballots(of)), [Ballots::default(), cast(3)]);
    }
}
