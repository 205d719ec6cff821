//! What a bake reports while it runs. As JSON (`bake --json`), an event is an object whose field `event` is its name.
//! `docs/json.md` says what each means and is held to this file by a test.

use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub enum Event {
    /// The bake of a population begins; it has `stages` stages. Each scene needs `of_scenes` of them, several scenes some.
    Planned { generation: u32, stages: usize, of_scenes: Vec<usize> },
    /// A stage ("tree 3") that these scenes use is being computed.
    Started { stage: String, scenes: Vec<usize> },
    /// A stage has its results after `ms` of wall-clock time; `reused` from the cache, it takes 0.
    Finished { stage: String, scenes: Vec<usize>, reused: bool, ms: f64 },
    /// Something was wrong and has been mended.
    Notice { message: String },
    /// All files of a scene are in place; `path` is its scene.gltf, `name` its individual's.
    SceneReady { scene: usize, name: String, path: String },
    /// The votes on a generation were answered with the new population file `path`.
    Bred { parent: u32, path: String },
    /// Something newer was saved: the bake that was going on ends early, and another one begins.
    Superseded,
    /// An export of `files` files begins.
    Exporting { files: usize },
    /// One of them is in place.
    Written { path: String, bytes: u64 },
    /// The bake has ended well.
    Done { built: usize, reused: usize, ms: f64 },
    /// It ended with an error.
    Failed { message: String },
}

/// Where events go.
pub trait Listener: Sync {
    /// Takes one event. Called from several threads.
    fn tell(&self, event: &Event);

    /// The last event of a run has been told.
    fn end(&self) {}
}

/// For work of which nobody wants to hear.
pub struct Untold;

impl Listener for Untold {
    fn tell(&self, _: &Event) {}
}
