//! Events of the bake → its progress, for each scene, and what became of each stage.

use genescape_cache::Cache;
use genescape_schema::INDIVIDUALS;
use genescape_world::{World, names};

use crate::baker::Event;
use crate::ui::model::{Baking, StageEntry};

#[derive(Default)]
pub struct BakeProgress {
    pub baking: Option<Baking>,
    /// For each scene the stages that are finished, and the one that was started last.
    pub scenes: [(usize, String); INDIVIDUALS],
    pub log: Vec<StageEntry>,
}

impl BakeProgress {
    pub fn take(&mut self, event: Event, world: &World) {
        match event {
            Event::Planned { generation, stages } => {
                self.baking = Some(Baking { generation, done: 0, total: stages });
                self.forget_scenes();
                self.log.clear();
            }
            Event::Started { stage, scenes } => {
                for scene in scenes.into_iter().filter(|scene| *scene < INDIVIDUALS) {
                    self.scenes[scene].1.clone_from(&stage);
                }
            }
            Event::Finished { stage, scenes, reused, ms } => {
                if let Some(baking) = &mut self.baking {
                    baking.done += 1;
                }
                for &scene in scenes.iter().filter(|scene| **scene < INDIVIDUALS) {
                    self.scenes[scene].0 += 1;
                }
                let scene = if let [one] = scenes[..] { Some(one) } else { None };
                self.log.push(StageEntry { stage, scene, reused, ms, why: String::new() });
            }
            Event::Done { .. } => {
                if let Some(baking) = self.baking.take() {
                    self.explain(world, baking.generation);
                }
            }
            Event::Superseded | Event::Failed { .. } => self.baking = None,
            Event::Notice { .. } | Event::Bred { .. } | Event::SceneReady { .. } => {}
            Event::Exporting { .. } | Event::Written { .. } => {}
        }
    }

    pub fn forget_scenes(&mut self) {
        self.scenes = Default::default();
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
