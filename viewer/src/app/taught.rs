//! What votes have taught of genes, for the gene panel: found out beside the loop, once a generation.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::mpsc::Receiver;

use super::{App, Wake};
use crate::baker;

#[derive(Default)]
pub struct Taught {
    /// The generation that was asked of, and what is known of it.
    generation: Option<u32>,
    told: Arc<BTreeMap<String, String>>,
    coming: Option<Receiver<BTreeMap<String, String>>>,
}

impl Taught {
    /// Lines by the names of genes; none until they are known.
    pub fn of(&self, generation: u32) -> Arc<BTreeMap<String, String>> {
        if self.generation == Some(generation) { self.told.clone() } else { Arc::default() }
    }
}

impl App {
    /// Asks what votes have taught where the gene panel shows another generation, and takes in the answer.
    pub(super) fn hear_votes(&mut self) {
        if let Some(told) = self.taught.coming.as_ref().and_then(|coming| coming.try_recv().ok()) {
            (self.taught.told, self.taught.coming) = (Arc::new(told), None);
        }
        let (generation, Some(world)) = (self.editor.generations().0, self.editor.world()) else { return };
        if !self.layout.panels.genome || self.taught.generation == Some(generation) {
            return;
        }
        let world = genescape_world::World::new(world);
        let coming = baker::taught(world, self.editor.space(), generation, self.wake(Wake::Soon)).ok();
        self.taught = Taught { generation: Some(generation), told: Arc::default(), coming };
    }
}
