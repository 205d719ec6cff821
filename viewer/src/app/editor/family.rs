//! Generations as a family, favourites, and parents that are chosen from among them.

use std::collections::BTreeSet;
use std::sync::Arc;

use genescape_schema::Category;

use super::Editor;
use crate::baker::breed_with;
use crate::ui::Tone;
use crate::ui::model::Kin;

impl Editor {
    /// All generations that can be read, rising.
    pub fn family(&self) -> Arc<Vec<Kin>> {
        self.family.clone()
    }

    /// Landscapes with a star.
    pub fn favourites(&self) -> &BTreeSet<(u32, usize)> {
        &self.favourites
    }

    /// Reads the files of generations again: of `changed`, and of those that came or went.
    pub(super) fn read_family(&mut self, changed: Option<u32>) {
        let known = self.family.clone();
        let read = |generation: &u32| {
            let old = known.iter().find(|kin| kin.generation == *generation && changed != Some(*generation));
            let new = || Some(Kin::of(&self.world.population(&self.space, *generation).ok()?.population));
            old.cloned().or_else(new)
        };
        self.family = Arc::new(self.generations.iter().filter_map(read).collect());
    }

    pub(super) fn read_favourites(&mut self) {
        match self.world.favourites() {
            Ok(favourites) => self.favourites = favourites.0,
            Err(error) => self.tell(Tone::Warning, error.to_string()),
        }
    }

    /// Gives a landscape a star, or takes it away.
    pub fn star(&mut self, generation: u32, landscape: usize, starred: bool) {
        if self.world().is_none() {
            return;
        }
        match self.world.mark(generation, landscape, starred) {
            Ok(favourites) => self.favourites = favourites.0,
            Err(error) => self.tell(Tone::Error, format!("The star is not kept: {error}")),
        }
    }

    /// Breeds with one category of a landscape of any generation, and else the favourites on show.
    pub fn breed_with(&mut self, generation: u32, landscape: usize, category: Category) {
        if self.world().is_none() {
            return;
        }
        let (world, space, beside) = (&self.world, &self.space, self.generation);
        match breed_with(world, space, beside, (generation, landscape), category) {
            Ok(_) => self.follows = true,
            Err(error) => self.tell(Tone::Error, format!("Nothing is bred: {error:#}")),
        }
    }
}
