//! The person's work on a world: the generation shown, votes, genes, and the bake's progress. Takes events and
//! changes of files, writes what the person decides, and says what has to be shown.

mod bake_progress;
mod edits;
mod family;
mod model;
#[cfg(test)]
mod tests;
mod votes;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use genescape_schema::{Genome, INDIVIDUALS, Parent, Population, Space};
use genescape_world::{Change, Source, Stamp, World, names};

use crate::baker;
use crate::ballots::Ballots;
use crate::edit_history::Steps;
use crate::event::Event;
use crate::settings::WorldSettings;
use crate::ui::Tone;
use crate::ui::model::{FileError, Kin};
use bake_progress::BakeProgress;

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

/// Something the application has to do.
#[derive(Clone, Debug, PartialEq)]
pub enum Task {
    /// Read a scene for a view.
    Load { view: usize, generation: u32, path: PathBuf },
    /// Tell the person.
    Tell(Tone, String),
    /// Tell them, and do this if they click on it.
    Offer(String, Event),
    /// A new generation is on show: walks begin at its start.
    BeginWalk,
}

pub struct Editor {
    source: Source,
    world: World,
    space: Arc<Space>,
    /// The generation that is shown.
    generation: u32,
    generations: Vec<u32>,
    /// What they were bred from.
    parents: BTreeMap<u32, Parent>,
    /// Names of the landscapes that those on show were bred from.
    ancestors: Option<[String; INDIVIDUALS]>,
    population: Option<Population>,
    /// All generations that can be read.
    family: Arc<Vec<Kin>>,
    /// Landscapes with a star.
    favourites: BTreeSet<(u32, usize)>,
    /// Genes as they were when the generation was first shown.
    bred: Option<[Genome; INDIVIDUALS]>,
    pub(super) ballots: Ballots,
    steps: Steps,
    /// A newer generation is shown as soon as it is born.
    follows: bool,
    /// Views that show their scene of that generation.
    loaded: [bool; INDIVIDUALS],
    /// Views whose scene of that generation is being read.
    asked: [bool; INDIVIDUALS],
    /// The state of the world's file that was asked for last; none of one that cannot be shown.
    read: [Option<Stamp>; INDIVIDUALS],
    faults: BTreeMap<Fault, FileError>,
    pub(super) bake: BakeProgress,
    /// Remarks on files that were reported and still hold: a file is read again for many reasons.
    noticed: BTreeSet<String>,
    tasks: Vec<Task>,
}

impl Editor {
    /// An editor of that source, with what was kept of it.
    pub fn open(source: Source, kept: &WorldSettings) -> Self {
        let root = match &source {
            Source::World(root) => root.clone(),
            Source::Scenes(_) => PathBuf::new(),
        };
        let mut editor = Self {
            world: World::new(root),
            space: Arc::new(Space::builtin()),
            generation: 0,
            generations: Vec::new(),
            parents: BTreeMap::new(),
            ancestors: None,
            family: Arc::default(),
            favourites: BTreeSet::new(),
            population: None,
            bred: None,
            ballots: Ballots::default(),
            steps: kept.steps.value.clone(),
            follows: true,
            loaded: [false; INDIVIDUALS],
            asked: [false; INDIVIDUALS],
            read: Default::default(),
            faults: BTreeMap::new(),
            bake: BakeProgress::default(),
            noticed: BTreeSet::new(),
            tasks: Vec::new(),
            source,
        };
        editor.begin();
        editor
    }

    fn begin(&mut self) {
        if let Source::Scenes(scenes) = &self.source {
            return (0..scenes.len().min(INDIVIDUALS)).for_each(|view| self.load(view));
        }
        self.read_space();
        self.read_generations();
        self.read_favourites();
        let current = self.world.current().ok().flatten().map(|current| current.generation);
        let newest = self.generations.last().copied();
        if let Some(generation) = current.filter(|g| self.generations.contains(g)).or(newest) {
            self.go_to(generation);
        }
    }

    /// What should be kept of this world between runs, besides places.
    pub fn keep(&self, kept: &mut WorldSettings) {
        kept.steps.value.clone_from(&self.steps);
    }

    /// What has to be done since the last call.
    pub fn take_tasks(&mut self) -> Vec<Task> {
        std::mem::take(&mut self.tasks)
    }

    /// The world's folder, if this is a world.
    pub fn world(&self) -> Option<&Path> {
        matches!(self.source, Source::World(_)).then(|| self.world.root())
    }

    fn tell(&mut self, tone: Tone, text: impl Into<String>) {
        self.tasks.push(Task::Tell(tone, text.into()));
    }

    /// Reports a remark on a file unless it was reported already, by the bake for instance.
    fn notice(&mut self, text: String) {
        if self.noticed.insert(text.clone()) {
            self.tell(Tone::Info, text);
        }
    }

    /// All remarks on the world's file of that name. Those that no longer hold may be reported again.
    fn notices(&mut self, name: &str, notices: Vec<String>) {
        let file = self.world.root().join(name).display().to_string();
        self.noticed.retain(|old| !old.starts_with(&file) || notices.contains(old));
        notices.into_iter().for_each(|text| self.notice(text));
    }

    fn fault(&mut self, kind: Fault, title: impl Into<String>, report: impl Into<String>) {
        // The bake reports faults in a person's files, too, but less well: whichever comes first, this one stays.
        if matches!(kind, Fault::Space | Fault::Population) {
            self.faults.remove(&Fault::Bake);
        }
        self.faults.insert(kind, FileError { title: title.into(), report: report.into() });
    }

    fn read_space(&mut self) {
        match self.world.space() {
            Ok((space, notices)) => {
                self.space = Arc::new(space);
                self.faults.remove(&Fault::Space);
                self.notices(names::SPACE, notices);
            }
            Err(error) => self.fault(Fault::Space, "space.ron is wrong", error.to_string()),
        }
    }

    fn read_generations(&mut self) {
        match self.world.generations() {
            Ok(generations) => {
                for generation in generations.iter().filter(|known| !self.generations.contains(known)) {
                    let parent = self.world.parent_of(*generation);
                    self.parents.extend(parent.map(|parent| (*generation, parent)));
                }
                self.generations = generations;
                self.read_family(None);
                self.faults.remove(&Fault::Folder);
            }
            Err(error) => self.fault(Fault::Folder, "the world cannot be read", error.to_string()),
        }
    }

    fn read_population(&mut self) {
        let name = names::population(self.generation);
        match self.world.population(&self.space, self.generation) {
            Ok(file) => {
                self.notices(&name, file.notices);
                let genomes = file.population.individuals.each_ref().map(|one| one.genome.clone());
                self.bred.get_or_insert(genomes);
                self.population = Some(file.population);
                self.faults.remove(&Fault::Population);
            }
            Err(error) => self.fault(Fault::Population, format!("{name} is wrong"), error.to_string()),
        }
    }

    /// Shows a generation.
    fn go_to(&mut self, generation: u32) {
        self.generation = generation;
        self.follows = self.generations.last() == Some(&generation);
        (self.population, self.bred) = (None, None);
        self.ballots = self.steps.ballots(generation);
        (self.loaded, self.asked, self.read) = Default::default();
        self.faults.retain(|fault, _| !matches!(fault, Fault::Scene(_)));
        self.read_population();
        let names = |parent: &Parent| {
            let file = self.world.population(&self.space, parent.generation).ok()?;
            Some(file.population.individuals.map(|one| one.name))
        };
        self.ancestors = self.parents.get(&generation).and_then(names);
        (0..INDIVIDUALS).for_each(|view| self.load(view));
    }

    /// The scene file of a landscape on show; it need not exist.
    pub fn scene(&self, view: usize) -> Option<PathBuf> {
        match &self.source {
            Source::World(_) => Some(self.world.scene_path(self.generation, view)),
            Source::Scenes(scenes) => scenes.get(view).cloned(),
        }
    }

    fn load(&mut self, view: usize) {
        let path = match &self.source {
            Source::World(_) => self.world.scene_path(self.generation, view),
            Source::Scenes(paths) => paths[view].clone(),
        };
        if self.world().is_some() {
            // A file that has come is found here and reported besides.
            let stamp = Stamp::of(&path);
            let is_news = stamp.is_some() && stamp != self.read[view];
            self.read[view] = stamp;
            if !is_news {
                return;
            }
        }
        self.asked[view] = true;
        self.tasks.push(Task::Load { view, generation: self.generation, path });
    }

    /// A view has got a landscape, or has not; `true` if it is the one that is wanted.
    pub fn loaded(&mut self, view: usize, generation: u32, result: Result<(), &str>) -> bool {
        if generation != self.generation {
            return false;
        }
        self.asked[view] = false;
        match result {
            Ok(()) => {
                self.loaded[view] = true;
                self.faults.remove(&Fault::Scene(view));
            }
            Err(error) => {
                self.read[view] = None;
                let what = match self.world() {
                    Some(_) => format!("landscape {} cannot be shown", view + 1),
                    None => "the file cannot be shown".to_owned(),
                };
                self.fault(Fault::Scene(view), what, error);
            }
        }
        result.is_ok()
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
                self.read_family(Some(generation));
                let newest = self.generations.last().copied();
                if self.population.is_none() && before.is_none() {
                    self.go_to(generation);
                } else if let (true, true, Some(newest)) = (newest > before, self.follows, newest) {
                    // Whichever file changed: the change of the parents' may be reported after the child exists.
                    self.go_to(newest);
                    self.tasks.push(Task::BeginWalk);
                    self.tell(Tone::Success, format!("Generation {newest} is born"));
                } else if generation == self.generation {
                    self.read_population();
                }
            }
            Change::Scene { generation, index } if generation == self.generation => self.load(index),
            // What is not one of the scenes' own files is what a single one is made of.
            Change::File(number) => self.load(if number < self.count() { number } else { 0 }),
            Change::Scene { .. } | Change::Current | Change::Shaders => {}
        }
    }

    /// Takes an event of the bake.
    pub fn baked(&mut self, event: baker::Event) {
        use baker::Event;
        match &event {
            Event::Planned { .. } => drop(self.faults.remove(&Fault::Bake)),
            // Faults in a person's files are reported when they are read.
            Event::Failed { message }
                if !self.faults.contains_key(&Fault::Population)
                    && !self.faults.contains_key(&Fault::Space) =>
            {
                self.fault(Fault::Bake, "the bake failed", message);
            }
            Event::Notice { message } => self.notice(message.clone()),
            _ => {}
        }
        self.bake.take(event, &self.world);
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

    /// Goes to a generation, and asks for its scenes where they are gone or stale.
    pub fn visit(&mut self, generation: u32) {
        if !self.generations.contains(&generation) {
            return self.tell(Tone::Info, format!("There is no generation {generation}"));
        }
        self.go_to(generation);
        if let Err(error) = self.world.ask_for_bake(generation) {
            self.tell(Tone::Warning, error.to_string());
        }
    }

    /// The generation `by` places later (or earlier) that exists.
    pub fn neighbour(&self, by: isize) -> Option<u32> {
        let at = self.generations.iter().position(|generation| *generation == self.generation)?;
        self.generations.get(at.checked_add_signed(by)?).copied()
    }

    /// Tries again what failed.
    pub fn retry(&mut self) {
        self.faults.remove(&Fault::Bake);
        if self.world().is_none() {
            self.faults.retain(|fault, _| !matches!(fault, Fault::Scene(_)));
            return self.begin();
        }
        if self.generations.contains(&self.generation) {
            self.visit(self.generation);
        }
    }

    /// The person has read an error.
    pub fn dismiss(&mut self, index: usize) {
        if let Some(kind) = self.faults.keys().nth(index).copied() {
            self.faults.remove(&kind);
        }
    }
}
