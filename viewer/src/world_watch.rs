//! Watches what a world folder is made of, and tells what changed: population files, the space, scenes, which scenes
//! are ready, and shaders.
//!
//! Folders are watched, never files: an atomic save replaces the file, and a watch on it would end there. Events may
//! be lost, or come before their folder is watched; so an event is only the occasion to look at everything that
//! matters, a few hundred names, times and sizes, and what differs from the last look is what changed. Folders that
//! send no events are simply looked at more often.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, TryIter, channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, SystemTime};

use genescape_schema::{INDIVIDUALS, names};
use notify_debouncer_full::notify::{Config, EventKind, RecommendedWatcher, RecursiveMode};
use notify_debouncer_full::{DebounceEventResult, Debouncer, NoCache, new_debouncer_opt};

/// A save is several events; they are gathered for this long, and never longer.
const SETTLE: Duration = Duration::from_millis(40);
/// How often a folder that sends no events is looked at.
const POLL: Duration = Duration::from_millis(300);
/// How often one is looked at that should send events: some systems lose them without a word.
const DOUBT: Duration = Duration::from_secs(3);

/// What changed. The same change may be told more often than it happened, never less often than once after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Change {
    /// `space.ron` came, went or has another text.
    Space,
    /// A population file came, went or was saved.
    Population(u32),
    /// A `scene.gltf` came, went or was replaced.
    Scene {
        /// The generation.
        generation: u32,
        /// Which of its scenes, 0 … 3.
        index: usize,
    },
    /// `current.ron` names other scenes.
    Current,
    /// A `.wgsl` file of the folder of shaders was saved.
    Shaders,
}

/// What to watch.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WatchOptions {
    /// A folder with WGSL files, for those who write shaders.
    pub shaders: Option<PathBuf>,
    /// Look several times a second instead of waiting for events, for network folders that send none.
    pub poll: bool,
}

/// A watch on a world. Dropped, it ends.
pub struct WorldWatch {
    changes: Receiver<Change>,
    hints: Sender<Hint>,
    thread: Option<JoinHandle<()>>,
}

/// What the watching thread reacts to.
enum Hint {
    /// Something happened to these paths; perhaps to others, too.
    Paths(Vec<PathBuf>),
    End,
}

impl WorldWatch {
    /// Watches the world in `root`, which is made if it is not there. What is there already is not told. `wake` is
    /// called when there is something new in [`WorldWatch::changes`]. Where the system has no watches left, folders
    /// are looked at several times a second.
    ///
    /// # Errors
    /// If `root` can be neither found nor made, or the system gives no thread.
    pub fn start(root: &Path, options: WatchOptions, wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        fs::create_dir_all(root)?;
        // Events name files by their full paths.
        let root = fs::canonicalize(root)?;
        let shaders = options.shaders.and_then(|folder| fs::canonicalize(folder).ok());
        let places = Places { root, shaders };
        let (sender, changes) = channel();
        let (hints, hinted) = channel();
        let watcher = if options.poll { None } else { watcher(hints.clone()) };
        let mut looker = Looker { watched: BTreeSet::new(), seen: Snapshot::default(), places, watcher };
        looker.look();
        let thread = thread::Builder::new()
            .name("world watch".into())
            .spawn(move || watch(looker, &hinted, &sender, &wake))?;
        Ok(Self { changes, hints, thread: Some(thread) })
    }

    /// What changed since the last call. Never waits.
    pub fn changes(&self) -> TryIter<'_, Change> {
        self.changes.try_iter()
    }
}

impl Drop for WorldWatch {
    fn drop(&mut self) {
        let _ = self.hints.send(Hint::End);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn watch(mut looker: Looker, hints: &Receiver<Hint>, sender: &Sender<Change>, wake: &dyn Fn()) {
    loop {
        let wait = if looker.watcher.is_some() { DOUBT } else { POLL };
        let mut changes = match hints.recv_timeout(wait) {
            Ok(Hint::Paths(paths)) => {
                paths.iter().filter_map(|path| looker.places.meaning(path)).collect::<BTreeSet<_>>()
            }
            Err(RecvTimeoutError::Timeout) => BTreeSet::new(),
            Ok(Hint::End) | Err(RecvTimeoutError::Disconnected) => return,
        };
        changes.extend(looker.look());
        let news = !changes.is_empty();
        for change in changes {
            // Nobody listens only when the watch is being dropped.
            let _ = sender.send(change);
        }
        if news {
            wake();
        }
    }
}

fn watcher(hints: Sender<Hint>) -> Option<Debouncer<RecommendedWatcher, NoCache>> {
    let heard = move |result: DebounceEventResult| {
        let paths = match result {
            Ok(events) => {
                let told =
                    events.iter().filter(|e| !matches!(e.kind, EventKind::Access(_)) || e.need_rescan());
                let mut paths = told.flat_map(|event| event.paths.clone()).peekable();
                // Reading is no change, and no reason to look.
                if paths.peek().is_none() && !events.iter().any(|event| event.need_rescan()) {
                    return;
                }
                paths.collect()
            }
            // An overflowing queue, say: look at everything.
            Err(_) => Vec::new(),
        };
        let _ = hints.send(Hint::Paths(paths));
    };
    new_debouncer_opt(SETTLE, None, heard, NoCache, Config::default()).ok()
}

/// Where things are.
#[derive(Clone, Debug)]
struct Places {
    root: PathBuf,
    shaders: Option<PathBuf>,
}

impl Places {
    /// What it means that the file at `path` changed; `None` for files that mean nothing.
    fn meaning(&self, path: &Path) -> Option<Change> {
        if self.shaders.as_deref().is_some_and(|folder| path.parent() == Some(folder)) {
            return (path.extension()? == "wgsl").then_some(Change::Shaders);
        }
        let parts: Option<Vec<&str>> = path
            .strip_prefix(&self.root)
            .ok()?
            .components()
            .map(|part| match part {
                Component::Normal(name) => name.to_str(),
                _ => None,
            })
            .collect();
        let name = parts?.join("/");
        match name.as_str() {
            names::SPACE => return Some(Change::Space),
            names::CURRENT => return Some(Change::Current),
            _ => {}
        }
        if let Some(generation) = names::generation(&name)
            && names::population(generation) == name
        {
            return Some(Change::Population(generation));
        }
        let (generation, index) = scene(&name)?;
        Some(Change::Scene { generation, index })
    }

    /// Everything that matters, as it is now.
    fn snapshot(&self) -> Snapshot {
        let mut snapshot = Snapshot::default();
        snapshot.add_folder(self, &self.root);
        snapshot.add_folder(self, &self.root.join(names::POPULATIONS));
        let baked = self.root.join(names::BAKED);
        for generation in snapshot.add_folder(self, &baked) {
            if generation.file_name().and_then(|name| name.to_str()).and_then(generation_folder).is_some() {
                for index in 0..INDIVIDUALS {
                    // A scene's folder holds few other files; it is listed like the others.
                    snapshot.add_folder(self, &generation.join(format!("scene-{index}")));
                }
                snapshot.add_folder(self, &generation);
            }
        }
        if let Some(shaders) = &self.shaders {
            snapshot.add_folder(self, shaders);
        }
        snapshot
    }
}

/// "g0003" → 3.
fn generation_folder(name: &str) -> Option<u32> {
    names::generation(&format!("{name}.ron"))
}

/// "baked/g0003/scene-1/scene.gltf" → (3, 1).
fn scene(name: &str) -> Option<(u32, usize)> {
    let generation = generation_folder(name.split('/').nth(1)?)?;
    (0..INDIVIDUALS).find(|&index| names::scene(generation, index) == name).map(|index| (generation, index))
}

/// The files that mean something, and the folders that such files may come into.
#[derive(Clone, Debug, Default, PartialEq)]
struct Snapshot {
    files: BTreeMap<PathBuf, (Change, Stamp)>,
    folders: BTreeSet<PathBuf>,
}

/// By what a file that was saved differs from what it was. Where two saves share even this, an event told of the
/// second.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stamp {
    saved: Option<SystemTime>,
    length: u64,
    /// Whatever else the system tells files apart by.
    identity: u64,
}

impl Stamp {
    fn of(data: &fs::Metadata) -> Self {
        #[cfg(unix)]
        let identity = std::os::unix::fs::MetadataExt::ino(data);
        #[cfg(not(unix))]
        let identity = 0;
        Self { saved: data.modified().ok(), length: data.len(), identity }
    }
}

impl Snapshot {
    /// Lists one folder; the folders in it. One that is not there, or not readable, is empty.
    fn add_folder(&mut self, places: &Places, folder: &Path) -> Vec<PathBuf> {
        let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
        self.folders.insert(folder.to_owned());
        let mut folders = Vec::new();
        for entry in entries.flatten() {
            let path = entry.path();
            if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
                folders.push(path);
            } else if let Some(change) = places.meaning(&path)
                // Not that of a link: of what it leads to.
                && let Ok(data) = fs::metadata(&path)
            {
                self.files.insert(path, (change, Stamp::of(&data)));
            }
        }
        folders
    }

    /// What differs from an earlier look.
    fn changes_since(&self, before: &Self) -> BTreeSet<Change> {
        let differing = |from: &Self, to: &Self| {
            let changed = from.files.iter().filter(|(path, file)| to.files.get(*path) != Some(file));
            changed.map(|(_, (change, _))| *change).collect::<BTreeSet<_>>()
        };
        &differing(self, before) | &differing(before, self)
    }
}

/// Looks again and again, and watches the folders that have come.
struct Looker {
    places: Places,
    /// `None` when looking often has to do.
    watcher: Option<Debouncer<RecommendedWatcher, NoCache>>,
    watched: BTreeSet<PathBuf>,
    seen: Snapshot,
}

impl Looker {
    /// What changed since the last look.
    fn look(&mut self) -> BTreeSet<Change> {
        let mut now = self.places.snapshot();
        // What came into a new folder before it was watched is found by looking once more.
        while self.watch_folders(&now.folders) {
            now = self.places.snapshot();
        }
        let changes = now.changes_since(&self.seen);
        self.seen = now;
        changes
    }

    /// Watches exactly these folders; true if there are new ones among them.
    fn watch_folders(&mut self, folders: &BTreeSet<PathBuf>) -> bool {
        let Some(watcher) = &mut self.watcher else { return false };
        for gone in self.watched.difference(folders) {
            // It mostly ended by itself when the folder went.
            let _ = watcher.unwatch(gone);
        }
        let new: Vec<_> = folders.difference(&self.watched).collect();
        for folder in &new {
            if watcher.watch(folder, RecursiveMode::NonRecursive).is_err() && folder.is_dir() {
                // The system has no more to give.
                self.watcher = None;
                return false;
            }
        }
        let came = !new.is_empty();
        self.watched.clone_from(folders);
        came
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::save::save;
    use proptest::prelude::*;

    fn places() -> Places {
        Places { root: PathBuf::from("/w"), shaders: Some(PathBuf::from("/shaders")) }
    }

    #[test]
    fn paths_mean_what_the_world_says() {
        let meaning = |path: &str| places().meaning(Path::new(path));
        assert_eq!(meaning("/w/space.ron"), Some(Change::Space));
        assert_eq!(meaning("/w/population/g0012.ron"), Some(Change::Population(12)));
        assert_eq!(
            meaning("/w/baked/g12345/scene-3/scene.gltf"),
            Some(Change::Scene { generation: 12345, index: 3 })
        );
        assert_eq!(meaning("/w/baked/current.ron"), Some(Change::Current));
        assert_eq!(meaning("/shaders/sky.wgsl"), Some(Change::Shaders));
        for nothing in [
            "/w",
            "/space.ron",
            "/w/g0012.ron",
            "/w/population/g12.ron",
            "/w/population/.draft-x",
            "/w/population/old/g0012.ron",
            "/w/baked/g0012/scene-4/scene.gltf",
            "/w/baked/g0012/scene-03/scene.gltf",
            "/w/baked/g0012/scene-3/scene.gltf~",
            "/w/baked/blobs/ab/abcd.glb",
            "/w/../w/space.ron",
            "/shaders/notes.txt",
            "/shaders/old/sky.wgsl",
        ] {
            assert_eq!(meaning(nothing), None, "{nothing}");
        }
    }

    proptest! {
        #[test]
        fn every_name_of_the_schema_means_its_generation(generation: u32, index in 0..INDIVIDUALS) {
            let meaning = |name: String| places().meaning(&Path::new("/w").join(name));
            prop_assert_eq!(meaning(names::population(generation)), Some(Change::Population(generation)));
            prop_assert_eq!(meaning(names::scene(generation, index)), Some(Change::Scene { generation, index }));
        }

        #[test]
        fn a_look_finds_exactly_what_differs(
            before in prop::collection::btree_map(0..6u32, 0..3u64, 0..6),
            after in prop::collection::btree_map(0..6u32, 0..3u64, 0..6),
        ) {
            let snapshot = |files: &BTreeMap<u32, u64>| Snapshot {
                files: files.iter().map(|(&generation, &length)| {
                    let stamp = Stamp { saved: None, length, identity: 0 };
                    (PathBuf::from(generation.to_string()), (Change::Population(generation), stamp))
                }).collect(),
                folders: BTreeSet::new(),
            };
            let changed: BTreeSet<_> =
                (0..6).filter(|g| before.get(g) != after.get(g)).map(Change::Population).collect();
            prop_assert_eq!(snapshot(&after).changes_since(&snapshot(&before)), changed);
        }
    }

    /// Waits until all of `expected` were told; whatever else is told is returned.
    fn told(watch: &WorldWatch, expected: &[Change]) -> BTreeSet<Change> {
        let (mut missing, mut others) = (BTreeSet::from_iter(expected.iter().copied()), BTreeSet::new());
        while !missing.is_empty() {
            let change = watch.changes.recv_timeout(Duration::from_secs(20));
            let change = change.unwrap_or_else(|_| panic!("{missing:?} is not told"));
            if !missing.remove(&change) && !expected.contains(&change) {
                others.insert(change);
            }
        }
        others
    }

    fn tells_everything(poll: bool) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (root, shaders) = (folder.path().join("world"), folder.path().join("shaders"));
        fs::create_dir(&shaders).expect("a folder");
        let options = WatchOptions { shaders: Some(shaders.clone()), poll };
        let watch = WorldWatch::start(&root, options, || {}).expect("watched");
        let put = |name: String, text: &str| save(&root.join(name), text).expect("saved");

        // Folders come with their first files.
        let scene = |generation, index| Change::Scene { generation, index };
        put(names::population(0), "one");
        put(names::scene(0, 2), "a scene");
        put(names::CURRENT.into(), "now");
        let others = told(&watch, &[Change::Population(0), scene(0, 2), Change::Current]);
        assert!(others.is_empty(), "{others:?}");
        // Every atomic save is told, not only the first, and in folders that came later, too.
        for text in ["two", "six"] {
            put(names::population(0), text);
            told(&watch, &[Change::Population(0)]);
            put(names::scene(0, 2), text);
            told(&watch, &[scene(0, 2)]);
        }
        put(names::scene(7, 1), "a scene");
        put(names::SPACE.into(), "space");
        fs::write(shaders.join("sky.wgsl"), "fn sky() {}").expect("written");
        told(&watch, &[scene(7, 1), Change::Space, Change::Shaders]);
        fs::remove_dir_all(root.join("baked/g0000")).expect("removed");
        told(&watch, &[scene(0, 2)]);
        put(names::scene(0, 2), "back again");
        told(&watch, &[scene(0, 2)]);
    }

    #[test]
    fn events_tell_everything() {
        tells_everything(false);
    }

    #[test]
    fn looking_often_tells_everything() {
        tells_everything(true);
    }

    #[test]
    fn what_lies_there_already_is_not_told() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        save(&folder.path().join(names::population(3)), "old").expect("saved");
        let watch = WorldWatch::start(folder.path(), WatchOptions::default(), || {}).expect("watched");
        save(&folder.path().join(names::SPACE), "new").expect("saved");
        assert!(told(&watch, &[Change::Space]).is_empty());
    }
}
