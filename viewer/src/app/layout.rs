//! What the window shows beside one another: how the four landscapes share it, which of them is chosen, which panels are
//! open.

use genescape_schema::INDIVIDUALS;

use crate::event::{Arrangement, Panel};
use crate::ui::model::Panels;

#[derive(Clone, Copy, Debug, Default)]
pub struct Layout {
    pub arrangement: Arrangement,
    /// The landscape that the genome panel is about.
    pub chosen: usize,
    pub panels: Panels,
}

impl Layout {
    /// One landscape alone, or all again.
    pub fn maximise(&mut self, view: usize) {
        self.chosen = view;
        let one = Arrangement::One(view);
        self.arrangement = if self.arrangement == one { Arrangement::Grid } else { one };
    }

    /// The chosen landscape beside the next; again: beside the one after.
    pub fn compare(&mut self) {
        let (left, last) = match self.arrangement {
            Arrangement::Compare { left, right } => (left, right),
            _ => (self.chosen, self.chosen),
        };
        let right = (last + 1) % INDIVIDUALS;
        self.arrangement =
            if right == left { Arrangement::Grid } else { Arrangement::Compare { left, right } };
    }

    /// Opens or closes a panel.
    pub fn toggle(&mut self, panel: Panel) {
        self.panels.set(panel, !self.panels.is_open(panel));
    }

    /// The landscapes on the screen, in the order of their places.
    pub fn shown(&self) -> Vec<usize> {
        match self.arrangement {
            Arrangement::Grid => (0..INDIVIDUALS).collect(),
            Arrangement::One(view) => vec![view],
            Arrangement::Compare { left, right } => vec![left, right],
        }
    }
}
