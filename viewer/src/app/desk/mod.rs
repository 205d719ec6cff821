//! What the person works on: a world's files, the generation on show, votes, genes, and how the bake gets on. Takes
//! events and changes of files, writes what the person decides, and says what has to be shown.

mod running_votes;
mod shown;
mod source;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use genescape_cache::Cache;
use genescape_schema::{Category, Genome, INDIVIDUALS, Parent, Population, Space, names};

use crate::baker;
use crate::edit_history::{Edit, History};
use crate::event::{Ballot, Ballots};
use crate::settings::WorldSettings;
use crate::ui::Tone;
use crate::ui::model::{Baking, FileError, StageEntry};
use crate::world_files::WorldFiles;
use crate::world_watch::Change;
use running_votes::{ballots, running};
pub use source::Source;

/// A step that can be taken back.
#[derive(Clone, Debug, PartialEq)]
enum Step {
    /// A ballot was another one before.
    Ballot { category: Category, before: Ballot },
    /// A population file was changed.
    File { generation: u32 },
    /// A generation was asked for; `wrote`: votes were written into its parents' file.
    Bred { from: u32, ballots: Ballots, wrote: bool },
}

/// What went wrong where; one of each kind at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Fault {
    Space,
    Population,
    Folder,
    Shaders,
    Settings,
    Bake,
    Scene(usize),
}

/// Something the application has to do or tell.
#[derive(Clone, Debug, PartialEq)]
pub enum Task {
    /// Read a scene for a view.
    Load {
        /// Which view.
        view: usize,
        /// Its generation.
        generation: u32,
        /// Its file.
        path: PathBuf,
    },
    /// Tell the person.
    Tell(Tone, String),
}

/// The desk.
pub struct Desk {
    source: Source,
    files: WorldFiles,
    space: Arc<Space>,
    /// The generation on show.
    generation: u32,
    generations: Vec<u32>,
    population: Option<Population>,
    /// Genes as they were when the generation came on show.
    bred: Option<[Genome; INDIVIDUALS]>,
    ballots: Ballots,
    history: History,
    steps: Vec<Step>,
    /// A newer generation comes on show by itself.
    follows: bool,
    /// Generation of the scene that each view shows.
    shown: [Option<u32>; INDIVIDUALS],
    faults: BTreeMap<Fault, FileError>,
    baking: Option<Baking>,
    scene_progress: [(usize, String); INDIVIDUALS],
    bake_log: Vec<StageEntry>,
    /// Values of the file on show that were rounded, as they were told.
    rounded: BTreeSet<String>,
    tasks: Vec<Task>,
}

impl Desk {
    /// A desk for that source, with what was kept of it.
    pub fn open(source: Source, kept: &WorldSettings) -> Self {
        let root = match &source {
            Source::World(root) => root.clone(),
            Source::Scenes(_) => PathBuf::new(),
        };
        let mut desk = Self {
            files: WorldFiles::new(root),
            space: Arc::new(Space::builtin()),
            generation: 0,
            generations: Vec::new(),
            population: None,
            bred: None,
            ballots: Ballots::default(),
            history: History::default(),
            steps: Vec::new(),
            follows: true,
            shown: [None; INDIVIDUALS],
            faults: BTreeMap::new(),
            baking: None,
            scene_progress: Default::default(),
            bake_log: Vec::new(),
            rounded: BTreeSet::new(),
            tasks: Vec::new(),
            source,
        };
        desk.begin(kept);
        desk
    }

    fn begin(&mut self, kept: &WorldSettings) {
        if let Source::Scenes(scenes) = &self.source {
            let load =
                |(view, path): (usize, &PathBuf)| Task::Load { view, generation: 0, path: path.clone() };
            self.tasks.extend(scenes.iter().take(INDIVIDUALS).enumerate().map(load));
            return;
        }
        self.read_space();
        self.read_generations();
        let current = self.files.current().ok().flatten().map(|current| current.generation);
        let newest = self.generations.last().copied();
        if let Some(generation) = current.filter(|g| self.generations.contains(g)).or(newest) {
            self.go_to(generation);
            self.follows = Some(generation) == newest;
        }
        if let Some(running) = kept.running_votes.as_ref().filter(|votes| votes.generation == self.generation)
        {
            self.ballots = ballots(running);
        }
    }

    /// What has to be done since the last call.
    pub fn take_tasks(&mut self) -> Vec<Task> {
        std::mem::take(&mut self.tasks)
    }

    /// The world's folder, if this is a world.
    pub fn world(&self) -> Option<&Path> {
        matches!(self.source, Source::World(_)).then(|| self.files.root())
    }

    /// What should be kept of this world between runs, besides bookmarks.
    pub fn keep(&self, kept: &mut WorldSettings) {
        kept.running_votes = running(self.generation, &self.ballots);
    }

    fn tell(&mut self, tone: Tone, text: impl Into<String>) {
        self.tasks.push(Task::Tell(tone, text.into()));
    }

    fn fault(&mut self, kind: Fault, title: impl Into<String>, report: impl Into<String>) {
        // Whoever bakes says the same of a person's files; with the files it is told better, whichever comes first.
        if matches!(kind, Fault::Space | Fault::Population) {
            self.faults.remove(&Fault::Bake);
        }
        self.faults.insert(kind, FileError { title: title.into(), report: report.into() });
    }

    fn read_space(&mut self) {
        match self.files.space() {
            Ok(space) => {
                self.space = Arc::new(space);
                self.faults.remove(&Fault::Space);
            }
            Err(error) => self.fault(Fault::Space, "space.ron is wrong", error.to_string()),
        }
    }

    fn read_generations(&mut self) {
        match self.files.generations() {
            Ok(generations) => {
                self.generations = generations;
                self.faults.remove(&Fault::Folder);
            }
            Err(error) => self.fault(Fault::Folder, "the world cannot be read", error.to_string()),
        }
    }

    fn read_population(&mut self) {
        match self.files.population(&self.space, self.generation) {
            Ok(loaded) => {
                // The same file is read again for many reasons; a rounded value is told once.
                let rounded: BTreeSet<String> = loaded.snaps.iter().map(ToString::to_string).collect();
                let news: Vec<String> = rounded.difference(&self.rounded).cloned().collect();
                news.into_iter().for_each(|text| self.tell(Tone::Info, text));
                self.rounded = rounded;
                if self.bred.is_none() {
                    self.bred = Some(loaded.population.individuals.each_ref().map(|one| one.genome.clone()));
                }
                self.population = Some(loaded.population);
                self.faults.remove(&Fault::Population);
            }
            Err(error) => {
                let file = names::population(self.generation);
                self.fault(Fault::Population, format!("{file} is wrong"), error.to_string());
            }
        }
    }

    /// Puts a generation on show.
    fn go_to(&mut self, generation: u32) {
        self.generation = generation;
        self.follows = self.generations.last() == Some(&generation);
        self.population = None;
        self.bred = None;
        self.ballots = Ballots::default();
        self.shown = [None; INDIVIDUALS];
        self.scene_progress = Default::default();
        for view in 0..INDIVIDUALS {
            self.faults.remove(&Fault::Scene(view));
        }
        self.read_population();
        (0..INDIVIDUALS).for_each(|view| self.load(view));
    }

    fn load(&mut self, view: usize) {
        let path = self.files.scene_path(self.generation, view);
        if path.is_file() {
            self.tasks.push(Task::Load { view, generation: self.generation, path });
        }
    }

    /// A view has got a landscape, or has not; `true` if it is the one that is wanted.
    pub fn loaded(&mut self, view: usize, generation: u32, result: Result<(), &str>) -> bool {
        if generation != self.generation {
            return false;
        }
        match result {
            Ok(()) => {
                self.shown[view] = Some(generation);
                self.faults.remove(&Fault::Scene(view));
                true
            }
            Err(error) => {
                self.fault(Fault::Scene(view), format!("landscape {} cannot be shown", view + 1), error);
                false
            }
        }
    }

    /// A file of the world changed.
    pub fn changed(&mut self, change: Change) {
        match change {
            Change::Space => {
                self.read_space();
                self.read_population();
            }
            Change::Population(generation) => {
                let before = self.generations.last().copied();
                self.read_generations();
                let newest = self.generations.last().copied();
                if self.population.is_none() && before.is_none() {
                    self.go_to(generation);
                } else if let (true, true, Some(newest)) = (newest > before, self.follows, newest) {
                    // Whichever file's change made us look: the parents' may be told after the child is there.
                    self.go_to(newest);
                    self.tell(Tone::Success, format!("Generation {newest} is born"));
                } else if generation == self.generation {
                    self.read_population();
                }
            }
            Change::Scene { generation, index } if generation == self.generation => self.load(index),
            Change::Scene { .. } | Change::Current | Change::Shaders => {}
        }
    }

    /// The bake told something.
    pub fn baked(&mut self, event: baker::Event) {
        use baker::Event;
        match event {
            Event::Planned { generation, stages } => {
                self.faults.remove(&Fault::Bake);
                self.baking = Some(Baking { generation, done: 0, total: stages });
                self.scene_progress = Default::default();
                self.bake_log.clear();
            }
            Event::Started { stage, scenes } => {
                for scene in scenes.into_iter().filter(|scene| *scene < INDIVIDUALS) {
                    self.scene_progress[scene].1.clone_from(&stage);
                }
            }
            Event::Finished { stage, scenes, reused, ms } => {
                if let Some(baking) = &mut self.baking {
                    baking.done += 1;
                }
                for &scene in scenes.iter().filter(|scene| **scene < INDIVIDUALS) {
                    self.scene_progress[scene].0 += 1;
                }
                let scene = if let [one] = scenes[..] { Some(one) } else { None };
                self.bake_log.push(StageEntry { stage, scene, reused, ms, why: String::new() });
            }
            Event::Done { .. } => {
                let generation = self.baking.take().map(|baking| baking.generation);
                self.explain(generation);
            }
            Event::Superseded => self.baking = None,
            Event::Failed { message } => {
                self.baking = None;
                // What a person's files say wrong is told with the files.
                if !self.faults.contains_key(&Fault::Population) && !self.faults.contains_key(&Fault::Space) {
                    self.fault(Fault::Bake, "the bake failed", message);
                }
            }
            Event::Notice { message } => self.tell(Tone::Info, message),
            Event::Bred { .. } | Event::SceneReady { .. } => {}
        }
    }

    /// Looks up in the cache why each stage was built.
    fn explain(&mut self, generation: Option<u32>) {
        let (Some(generation), Some(world)) = (generation, self.world()) else { return };
        let Ok(cache) = Cache::open(world.join(names::BAKED)) else { return };
        for scene in 0..INDIVIDUALS {
            let Ok(history) = cache.history(&baker::history_scope(generation, scene)) else { continue };
            for (stage, explanation) in history.last() {
                let of_scene = |entry: &&mut StageEntry| {
                    entry.stage == stage && !entry.reused && entry.scene.is_none_or(|own| own == scene)
                };
                for entry in self.bake_log.iter_mut().filter(of_scene) {
                    entry.why = explanation.to_string();
                }
            }
        }
    }

    /// The shaders are wrong, or right again.
    pub fn shaders(&mut self, error: Option<String>) {
        match error {
            Some(error) => self.fault(Fault::Shaders, "a shader is wrong", error),
            None => drop(self.faults.remove(&Fault::Shaders)),
        }
    }

    /// The settings had to be set aside, or cannot be saved.
    pub fn settings_fault(&mut self, report: String) {
        self.fault(Fault::Settings, "settings", report);
    }

    /// Somebody votes.
    pub fn vote(&mut self, category: Category, ballot: Ballot) {
        let before = self.ballots.get(category);
        if before != ballot {
            self.steps.push(Step::Ballot { category, before });
            self.ballots.set(category, ballot);
        }
    }

    /// Writes the votes down; whoever bakes breeds from them.
    pub fn breed(&mut self) {
        let Some(votes) = self.ballots.votes() else {
            let open: Vec<&str> = Category::ALL
                .into_iter()
                .filter(|category| self.ballots.get(*category) == Ballot::Open)
                .map(Category::name)
                .collect();
            let text = format!(
                "Vote first: who has the best {}? None of them is an answer, too.",
                open.join(" and ")
            );
            return self.tell(Tone::Info, text);
        };
        if self.world().is_none() {
            return self.tell(Tone::Warning, "Baked folders cannot breed: open a world to go on from here");
        }
        let from = self.generation;
        let ballots = self.ballots;
        // The same votes were cast before: their generation is there already.
        if let Ok(Some(child)) = self.files.child_of(&Parent { generation: from, votes }) {
            self.steps.push(Step::Bred { from, ballots, wrote: false });
            return self.visit(child);
        }
        match self.history.apply(&self.files, &self.space, from, &Edit::Votes(Some(votes))) {
            Ok(wrote) => {
                self.steps.push(Step::Bred { from, ballots, wrote });
                self.follows = true;
            }
            Err(error) => self.tell(Tone::Error, format!("The votes are not written: {error}")),
        }
    }

    /// Goes to a generation, and asks for its scenes where they are gone or stale.
    pub fn visit(&mut self, generation: u32) {
        if !self.generations.contains(&generation) {
            return self.tell(Tone::Info, format!("There is no generation {generation}"));
        }
        self.go_to(generation);
        if let Err(error) = self.files.ask_for_bake(generation) {
            self.tell(Tone::Warning, error.to_string());
        }
    }

    /// The generation `by` places later (or earlier) that exists.
    pub fn neighbour(&self, by: isize) -> Option<u32> {
        let at = self.generations.iter().position(|generation| *generation == self.generation)?;
        self.generations.get(at.checked_add_signed(by)?).copied()
    }

    /// Changes genes of one landscape for good.
    pub fn set_genes(&mut self, individual: usize, values: Vec<(String, f64)>) {
        let Some(population) = &self.population else { return };
        let free =
            |(name, _): &(String, f64)| self.space.find(name).is_some_and(|gene| !population.is_locked(gene));
        let values: Vec<_> = values.into_iter().filter(free).collect();
        if values.is_empty() || self.world().is_none() {
            return;
        }
        self.edit(&Edit::Genes { individual, values });
    }

    /// Writes a change into the file on show.
    fn edit(&mut self, edit: &Edit) {
        match self.history.apply(&self.files, &self.space, self.generation, edit) {
            Ok(true) => {
                self.steps.push(Step::File { generation: self.generation });
                self.read_population();
            }
            Ok(false) => {}
            Err(error) => self.tell(Tone::Error, format!("Nothing is changed: {error}")),
        }
    }

    /// Locks or frees a gene or, by its category's name, all genes of one: breeding leaves what is locked as it is.
    pub fn lock(&mut self, name: &str, locked: bool) {
        let Some(population) = &self.population else { return };
        let mut names = population.locked.clone();
        if locked {
            names.insert(name.to_owned())
        } else {
            names.remove(name)
        };
        if self.world().is_some() {
            self.edit(&Edit::Locked(names));
        }
    }

    /// Takes the latest step back.
    pub fn undo(&mut self) {
        match self.steps.pop() {
            None => self.tell(Tone::Info, "There is nothing to undo"),
            Some(Step::Ballot { category, before }) => self.ballots.set(category, before),
            Some(Step::File { generation }) => self.undo_file(generation),
            Some(Step::Bred { from, ballots, wrote }) => {
                if wrote {
                    self.undo_file(from);
                }
                self.visit(from);
                self.ballots = ballots;
                self.follows = false;
            }
        }
    }

    fn undo_file(&mut self, generation: u32) {
        match self.history.undo(&self.files, generation) {
            Ok(name) => self.tell(Tone::Info, format!("Taken back: {name}")),
            Err(error) => self.tell(Tone::Warning, error.to_string()),
        }
        if generation == self.generation {
            self.read_population();
        }
    }

    /// Makes again what was taken back last in the file on show.
    pub fn redo(&mut self) {
        match self.history.redo(&self.files, self.generation) {
            Ok(name) => {
                self.steps.push(Step::File { generation: self.generation });
                self.tell(Tone::Info, format!("Made again: {name}"));
                self.read_population();
            }
            Err(error) => self.tell(Tone::Info, error.to_string()),
        }
    }

    /// Tries again what failed.
    pub fn retry(&mut self) {
        self.faults.remove(&Fault::Bake);
        if self.world().is_some() && self.generations.contains(&self.generation) {
            self.visit(self.generation);
        }
    }

    /// An error was read.
    pub fn dismiss(&mut self, index: usize) {
        if let Some(kind) = self.faults.keys().nth(index).copied() {
            self.faults.remove(&kind);
        }
    }

    /// What redo would make again, in a few words.
    pub fn next_redo(&self) -> Option<String> {
        self.history.next_redo(self.generation).map(str::to_owned)
    }

    /// What undo would take back, in a few words.
    pub fn next_undo(&self) -> Option<String> {
        self.steps.last().map(|step| match step {
            Step::Ballot { category, .. } => format!("vote on {}", category.name()),
            Step::File { generation } => {
                self.history.next_undo(*generation).unwrap_or("change of genes").to_owned()
            }
            Step::Bred { from, .. } => format!("breeding from generation {from}"),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use genescape_bake::world::World;

    #[test]
    fn a_mistake_in_the_first_file_is_told_until_it_is_mended() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join(names::population(0));
        World::open_or_create(folder.path()).expect("a world").begin().expect("its first generation");
        let good = std::fs::read_to_string(&path).expect("there");
        std::fs::write(&path, "Population(").expect("written");
        let mut desk = Desk::open(Source::World(folder.path().to_owned()), &WorldSettings::default());
        assert!(desk.is_hindered() && desk.errors()[0].report.contains("g0000.ron:1:"));
        std::fs::write(&path, good).expect("written");
        desk.changed(Change::Population(0));
        assert!(!desk.is_hindered() && desk.errors().is_empty());
    }

    #[test]
    fn a_mistake_is_told_once_whoever_finds_it_first() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join(names::population(0));
        World::open_or_create(folder.path()).expect("a world").begin().expect("its first generation");
        for bake_first in [true, false] {
            let mut desk = Desk::open(Source::World(folder.path().to_owned()), &WorldSettings::default());
            let good = std::fs::read_to_string(&path).expect("there");
            std::fs::write(&path, "Population(").expect("written");
            let failed = baker::Event::Failed { message: "g0000.ron:1: wrong".into() };
            if bake_first {
                desk.baked(failed.clone());
            }
            desk.changed(Change::Population(0));
            if !bake_first {
                desk.baked(failed);
            }
            assert_eq!(desk.errors().len(), 1, "{bake_first}");
            std::fs::write(&path, good).expect("written");
        }
    }

    #[test]
    fn a_new_generation_comes_on_show_whichever_change_is_told_first() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for (place, told) in [[0, 1], [1, 0]].into_iter().enumerate() {
            let root = folder.path().join(place.to_string());
            World::open_or_create(&root).expect("a world").begin().expect("its first generation");
            let mut desk = Desk::open(Source::World(root.clone()), &WorldSettings::default());
            assert_eq!(desk.generations(), (0, [0].as_slice()));
            let first = std::fs::read_to_string(root.join(names::population(0))).expect("there");
            let second = first.replacen("generation: 0", "generation: 1", 1);
            std::fs::write(root.join(names::population(1)), second).expect("written");
            told.into_iter().for_each(|generation| desk.changed(Change::Population(generation)));
            assert_eq!(desk.generations(), (1, [0, 1].as_slice()), "{told:?}");
        }
    }
}
