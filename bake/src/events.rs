//! What a bake tells while it runs, as a progress bar for people or as JSON lines for programs.

use std::io::{IsTerminal, Write};
use std::sync::Mutex;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;

/// `println!` for whom it may concern: nobody may be reading any more (`bake | head`), and that is no reason to stop.
#[macro_export]
macro_rules! say {
    ($($words:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stdout().lock(), $($words)*);
    }};
}

/// What happened.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub enum Event {
    /// The plan is made.
    Planned {
        /// The population's number.
        generation: u32,
        /// How many stages it takes.
        stages: usize,
    },
    /// A stage is being computed.
    Started {
        /// "tree 3".
        stage: String,
        /// The scenes that use it.
        scenes: Vec<usize>,
    },
    /// A stage has its results.
    Finished {
        /// "tree 3".
        stage: String,
        /// The scenes that use it.
        scenes: Vec<usize>,
        /// True if they came from the cache.
        reused: bool,
        /// Milliseconds of wall-clock time that computing took; 0 if reused.
        ms: f64,
    },
    /// Something was wrong and has been put right.
    Notice {
        /// For people.
        message: String,
    },
    /// All of a scene's files are in place.
    SceneReady {
        /// Which.
        scene: usize,
        /// The individual's name.
        name: String,
        /// Its scene.gltf.
        path: String,
    },
    /// Votes were answered with a new population file.
    Bred {
        /// The generation that was voted on.
        parent: u32,
        /// The new file.
        path: String,
    },
    /// Something newer was saved: the bake that was going on ends early, and another one begins.
    Superseded,
    /// All is done.
    Done {
        /// Stages computed.
        built: usize,
        /// Stages whose results came from the cache.
        reused: usize,
        /// Milliseconds in all.
        ms: f64,
    },
    /// It ended otherwise.
    Failed {
        /// For people.
        message: String,
    },
}

/// Where events go.
pub trait Listener: Sync {
    /// Takes one event. Called from several threads.
    fn tell(&self, event: &Event);

    /// No more will be told of this run.
    fn end(&self) {}
}

/// One JSON object a line, on standard output.
pub struct JsonLines;

impl Listener for JsonLines {
    fn tell(&self, event: &Event) {
        let line = serde_json::to_string(event).expect("events are plain data");
        // Nobody may be reading any more; the bake goes on for its own sake.
        let _ = writeln!(std::io::stdout().lock(), "{line}");
    }
}

/// A progress bar on standard error, and at the end where the landscapes are.
pub struct Bar {
    bar: ProgressBar,
    running: Mutex<Vec<String>>,
}

impl Default for Bar {
    fn default() -> Self {
        Self::new()
    }
}

impl Bar {
    /// A bar that stays hidden until there is something to compute, and where standard error is no terminal.
    pub fn new() -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        let style =
            ProgressStyle::with_template("{bar:32.green/dim} {pos}/{len} {elapsed:.dim}  {wide_msg:.dim}")
                .expect("a valid template")
                .progress_chars("━━─");
        bar.set_style(style);
        Self { bar, running: Mutex::default() }
    }

    fn show(&self) {
        if self.bar.is_hidden() && std::io::stderr().is_terminal() {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
    }

    fn update(&self, change: impl FnOnce(&mut Vec<String>)) {
        let mut running = self.running.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        change(&mut running);
        self.bar.set_message(running.join(", "));
    }
}

fn name(stage: &str, scenes: &[usize]) -> String {
    match scenes {
        [one] => format!("{stage} ({one})"),
        _ => stage.to_owned(),
    }
}

impl Listener for Bar {
    fn tell(&self, event: &Event) {
        match event {
            Event::Planned { stages, .. } => self.bar.set_length(*stages as u64),
            Event::Started { stage, scenes } => {
                self.show();
                self.update(|running| running.push(name(stage, scenes)));
            }
            Event::Finished { stage, scenes, .. } => {
                let ended = name(stage, scenes);
                self.update(|running| running.retain(|r| *r != ended));
                self.bar.inc(1);
            }
            Event::Notice { message } => self.bar.suspend(|| eprintln!("note: {message}")),
            Event::Bred { parent, path } => {
                self.bar.suspend(|| eprintln!("bred {path} from the votes on generation {parent}"));
            }
            Event::SceneReady { .. } | Event::Superseded | Event::Done { .. } | Event::Failed { .. } => {}
        }
    }

    fn end(&self) {
        self.bar.finish_and_clear();
    }
}

/// Hears nothing.
pub struct Silent;

impl Listener for Silent {
    fn tell(&self, _: &Event) {}
}
