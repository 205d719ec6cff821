//! What the window shows beside one another: how the four landscapes share it, which of them is chosen, which panels are
//! open.

use genescape_schema::INDIVIDUALS;

use crate::event::{Arrangement, Panel};
use crate::ui::model::Panels;

#[derive(Clone, Copy, Debug)]
pub struct Layout {
    /// How many landscapes there are.
    count: usize,
    pub arrangement: Arrangement,
    /// The landscape that the genome panel is about.
    pub chosen: usize,
    pub panels: Panels,
}

impl Layout {
    /// All of `count` landscapes; one stands alone, and stays alone.
    pub fn of(count: usize, panels: Panels) -> Self {
        let arrangement = if count == 1 { Arrangement::One(0) } else { Arrangement::Grid };
        Self { count, arrangement, chosen: 0, panels }
    }

    pub fn arrange(&mut self, arrangement: Arrangement) {
        if self.count > 1 {
            self.arrangement = arrangement;
        }
    }

    /// One landscape alone, or all again.
    pub fn maximise(&mut self, view: usize) {
        if view < self.count {
            self.chosen = view;
            let one = Arrangement::One(view);
            self.arrange(if self.arrangement == one { Arrangement::Grid } else { one });
        }
    }

    /// The chosen landscape beside the next; again: beside the one after.
    pub fn compare(&mut self) {
        let (left, last) = match self.arrangement {
            Arrangement::Compare { left, right } => (left, right),
            _ => (self.chosen, self.chosen),
        };
        let right = (last + 1) % self.count;
        let both = Arrangement::Compare { left, right };
        self.arrange(if right == left { Arrangement::Grid } else { both });
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_landscape_stands_alone_whatever_is_pressed() {
        let mut layout = Layout::of(1, Panels::default());
        let acts: [fn(&mut Layout); 3] =
            [|layout| layout.maximise(0), |layout| layout.maximise(2), Layout::compare];
        for act in acts {
            act(&mut layout);
            layout.arrange(Arrangement::Grid);
            assert_eq!((layout.arrangement, layout.chosen), (Arrangement::One(0), 0));
        }
    }

    #[test]
    fn one_is_compared_with_each_other_that_there_is() {
        let mut layout = Layout::of(3, Panels::default());
        let shown = std::iter::repeat_with(|| {
            layout.compare();
            layout.shown()
        });
        assert_eq!(shown.take(3).collect::<Vec<_>>(), [vec![0, 1], vec![0, 2], vec![0, 1, 2, 3]]);
    }
}
