//! The person's changes to population files, and the way back: each change is one span of the file's text, comments
//! stay, and what the file said before is remembered. Nothing that an editor has written meanwhile is ever lost: a
//! step is taken back only if the file still says what the step has made it say.

use std::collections::{BTreeMap, BTreeSet};

use genescape_schema::edit::{EditError, set_gene, set_locked, set_votes};
use genescape_schema::{Space, Votes};
use genescape_world::{World, WorldError};

/// Steps that are remembered for each file.
const STEPS: usize = 200;

/// One change of a population file.
#[derive(Clone, Debug, PartialEq)]
pub enum Edit {
    /// The votes become these.
    Votes(Option<Votes>),
    /// Breeding leaves these genes and categories as they are, and no others.
    Locked(BTreeSet<String>),
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
            Self::Genes { values, individual } => match &values[..] {
                [(name, _)] => format!("{name} of {individual}"),
                several => format!("{} genes of {individual}", several.len()),
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
pub enum UndoError {
    /// There is no such step.
    #[error("there is nothing to {0}")]
    Nothing(&'static str),
    /// The file says something else than the step has left.
    #[error("cannot {what} {step}: {file} was changed elsewhere since, and that would be lost")]
    Foreign { what: &'static str, step: String, file: String },
    /// The file could not be read or written.
    #[error(transparent)]
    File(#[from] WorldError),
}

/// The steps made in this session, for each population file.
#[derive(Clone, Debug, Default)]
pub struct History {
    files: BTreeMap<u32, Steps>,
}

#[derive(Clone, Debug, Default)]
struct Steps {
    done: Vec<Step>,
    undone: Vec<Step>,
}

#[derive(Clone, Debug)]
struct Step {
    name: String,
    before: String,
    after: String,
}

impl History {
    /// Changes a generation's population file; true if that changed anything.
    ///
    /// # Errors
    /// A change that the file does not allow, a file that cannot be read or written.
    pub fn apply(
        &mut self,
        files: &World,
        space: &Space,
        generation: u32,
        edit: &Edit,
    ) -> Result<bool, WorldError> {
        let path = files.population_path(generation);
        let before = files.population_text(generation)?;
        let after = edit
            .apply(space, &path.display().to_string(), &before)
            .map_err(|error| WorldError::Edit { path, error })?;
        if after == before {
            return Ok(false);
        }
        files.replace_population(generation, &before, &after)?;
        let steps = self.files.entry(generation).or_default();
        steps.undone.clear();
        steps.done.push(Step { name: edit.name(), before, after });
        if steps.done.len() > STEPS {
            steps.done.remove(0);
        }
        Ok(true)
    }

    /// The step of a generation's file that [`History::undo`] would take back.
    pub fn next_undo(&self, generation: u32) -> Option<&str> {
        self.files.get(&generation)?.done.last().map(|step| step.name.as_str())
    }

    /// The step that [`History::redo`] would make again.
    pub fn next_redo(&self, generation: u32) -> Option<&str> {
        self.files.get(&generation)?.undone.last().map(|step| step.name.as_str())
    }

    /// Takes the last step back; its name.
    ///
    /// # Errors
    /// [`UndoError::Foreign`] if the file was changed by another program since. The step stays: when the file says again
    /// what it said, it can be taken back.
    pub fn undo(&mut self, files: &World, generation: u32) -> Result<String, UndoError> {
        let Steps { done, undone } = self.files.entry(generation).or_default();
        let back = |step: &Step| files.replace_population(generation, &step.after, &step.before);
        take_step("undo", done, undone, back)
    }

    /// Makes the step again that was taken back last; its name.
    ///
    /// # Errors
    /// As [`History::undo`].
    pub fn redo(&mut self, files: &World, generation: u32) -> Result<String, UndoError> {
        let Steps { done, undone } = self.files.entry(generation).or_default();
        let forth = |step: &Step| files.replace_population(generation, &step.before, &step.after);
        take_step("redo", undone, done, forth)
    }
}

/// Replaces the file for the last step of `from`, which then is one of `to`.
fn take_step(
    what: &'static str,
    from: &mut Vec<Step>,
    to: &mut Vec<Step>,
    replace: impl FnOnce(&Step) -> Result<(), WorldError>,
) -> Result<String, UndoError> {
    let step = from.last().ok_or(UndoError::Nothing(what))?;
    let name = step.name.clone();
    replace(step).map_err(|error| match error {
        WorldError::Changed(path) => {
            UndoError::Foreign { what, step: name.clone(), file: path.display().to_string() }
        }
        other => other.into(),
    })?;
    to.extend(from.pop());
    Ok(name)
}

#[cfg(test)]
mod tests {
    use super::*;
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
            (4f64..29.0).prop_map(gene),
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 16, ..ProptestConfig::default() })]

        #[test]
        fn undo_walks_back_through_every_text_and_redo_forth(edits in prop::collection::vec(edit(), 1..6)) {
            let (_folder, files) = world();
            let (mut history, space) = (History::default(), Space::builtin());
            let text = || files.population_text(0).expect("there");
            let mut texts = vec![text()];
            for edit in &edits {
                if history.apply(&files, &space, 0, edit).expect("allowed") {
                    texts.push(text());
                }
            }
            prop_assert!(texts.iter().all(|text| text.contains("/* mine */")));
            for before in texts.iter().rev().skip(1) {
                history.undo(&files, 0).expect("a step");
                prop_assert_eq!(&text(), before);
            }
            prop_assert!(matches!(history.undo(&files, 0), Err(UndoError::Nothing("undo"))));
            for after in texts.iter().skip(1) {
                history.redo(&files, 0).expect("a step");
                prop_assert_eq!(&text(), after);
            }
            prop_assert_eq!(history.next_redo(0), None);
        }
    }

    #[test]
    fn an_editors_change_is_never_lost() {
        let (_folder, files) = world();
        let (mut history, space) = (History::default(), Space::builtin());
        history.apply(&files, &space, 0, &gene(9.0)).expect("allowed");
        let ours = files.population_text(0).expect("there");
        let theirs = format!("// by hand\n{ours}");
        save(&files.population_path(0), &theirs).expect("saved");
        let error = history.undo(&files, 0).expect_err("a foreign change");
        assert!(error.to_string().contains("height_m of 1") && error.to_string().contains("g0000.ron"));
        assert_eq!(files.population_text(0).expect("there"), theirs);
        // A new change is made on top of theirs, and its undo leaves theirs.
        history.apply(&files, &space, 0, &gene(12.0)).expect("allowed");
        history.undo(&files, 0).expect("ours");
        assert_eq!(files.population_text(0).expect("there"), theirs);
        save(&files.population_path(0), &ours).expect("taken back in the editor");
        history.undo(&files, 0).expect("the file says again what we wrote");
    }

    #[test]
    fn a_refused_change_leaves_file_and_steps_alone() {
        let (_folder, files) = world();
        let (mut history, space) = (History::default(), Space::builtin());
        let before = files.population_text(0).expect("there");
        let both =
            Edit::Genes { individual: 0, values: vec![("height_m".into(), 9.0), ("height_m".into(), 900.0)] };
        let error = history.apply(&files, &space, 0, &both).expect_err("out of range");
        assert!(error.to_string().contains("outside 3 … 30 m"), "{error}");
        assert_eq!(files.population_text(0).expect("there"), before);
        assert_eq!(history.next_undo(0), None);
        assert!(history.apply(&files, &space, 5, &gene(9.0)).is_err(), "no such generation");
    }
}
