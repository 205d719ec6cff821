//! Events of the bake → its progress, for each scene, and what became of each stage.

use std::array::from_fn;

use genescape_cache::Cache;
use genescape_schema::INDIVIDUALS;
use genescape_world::{World, names};

use crate::baker::Event;
use crate::ui::model::{Baking, StageEntry, ViewState};

#[derive(Default)]
pub struct BakeProgress {
    pub baking: Option<Baking>,
    /// The generation that was planned last, and how far its scenes are.
    generation: Option<u32>,
    scenes: [SceneProgress; INDIVIDUALS],
    pub log: Vec<StageEntry>,
}

#[derive(Clone, Default)]
struct SceneProgress {
    /// Stages that are finished, of all.
    done: usize,
    total: usize,
    /// The one that was started last.
    stage: String,
    /// All of its files are in place.
    ready: bool,
}

impl BakeProgress {
    pub fn take(&mut self, event: Event, world: &World) {
        match event {
            Event::Planned { generation, stages, of_scenes } => {
                self.baking = Some(Baking { generation, done: 0, total: stages });
                self.generation = Some(generation);
                let total = |scene: usize| of_scenes.get(scene).copied().unwrap_or(0);
                self.scenes =
                    from_fn(|scene| SceneProgress { total: total(scene), ..SceneProgress::default() });
                self.log.clear();
            }
            Event::Started { stage, scenes } => {
                self.of(&scenes, |scene| scene.stage.clone_from(&stage));
            }
            Event::Finished { stage, scenes, reused, ms } => {
                if let Some(baking) = &mut self.baking {
                    baking.done += 1;
                }
                self.of(&scenes, |scene| scene.done += 1);
                let scene = if let [one] = scenes[..] { Some(one) } else { None };
                self.log.push(StageEntry { stage, scene, reused, ms, why: String::new() });
            }
            Event::SceneReady { scene, .. } => self.of(&[scene], |scene| scene.ready = true),
            Event::Done { .. } => {
                if let Some(baking) = self.baking.take() {
                    self.explain(world, baking.generation);
                }
            }
            // The next bake goes on from what was finished.
            Event::Superseded => self.baking = None,
            Event::Failed { .. } => (self.baking, self.generation) = (None, None),
            Event::Notice { .. } | Event::Bred { .. } => {}
            Event::Exporting { .. } | Event::Written { .. } => {}
        }
    }

    fn of(&mut self, scenes: &[usize], change: impl Fn(&mut SceneProgress)) {
        scenes.iter().filter_map(|scene| self.scenes.get_mut(*scene).map(&change)).for_each(drop);
    }

    /// How far the bake of a scene is that nobody has begun to read.
    pub fn state(&self, generation: u32, scene: usize) -> ViewState {
        let SceneProgress { done, total, stage, ready } = &self.scenes[scene];
        match self.generation == Some(generation) {
            // It is read as soon as the watch has seen it.
            true if *ready => ViewState::Loading,
            true if *done > 0 || !stage.is_empty() => {
                ViewState::Baking { done: *done, total: *total, stage: stage.clone() }
            }
            _ => ViewState::Waiting,
        }
    }

    /// Looks up in the cache why each stage was built.
    fn explain(&mut self, world: &World, generation: u32) {
        let Ok(cache) = Cache::open(world.baked()) else { return };
        for scene in 0..INDIVIDUALS {
            let Ok(history) = cache.history(&names::scene_id(generation, scene)) else { continue };
            for (stage, explanation) in history.last() {
                let of_scene = |entry: &&mut StageEntry| {
                    entry.stage == stage && !entry.reused && entry.scene.is_none_or(|own| own == scene)
                };
                for entry in self.log.iter_mut().filter(of_scene) {
                    entry.why = explanation.to_string();
                }
            }
        }
    }
}
