//! What the parts of the application know → what the user interface shows.

use std::array;

use super::desk::Desk;
use super::show::Show;
use crate::event::{Arrangement, Comfort};
use crate::frame::Options;
use crate::input::Bindings;
use crate::ui::model::{KeyGroup, Model, Panels, Situation, Stats, ViewModel, ViewState};

/// The parts.
pub struct Parts<'a> {
    /// The person's work.
    pub desk: &'a Desk,
    /// The pictures, once there is a window.
    pub show: Option<&'a Show>,
    /// What keys mean.
    pub bindings: &'a Bindings,
    /// What is drawn, and how.
    pub options: Options,
    /// How the program feels in the hand.
    pub comfort: Comfort,
    /// How the four share the window.
    pub arrangement: Arrangement,
    /// The landscape that the genome panel is about.
    pub chosen: usize,
    /// The panels that are shown.
    pub panels: Panels,
    /// The pointer steers the view.
    pub captured: bool,
    /// This program bakes.
    pub baking_here: bool,
}

/// Fills the model for one frame.
pub fn fill(parts: &Parts<'_>) -> Model {
    let Parts { desk, show, .. } = parts;
    let (generation, generations) = desk.generations();
    let views = array::from_fn(|view| {
        let own_name = || show.and_then(|show| show.scene(view)).map(|scene| scene.name.clone());
        ViewModel {
            name: desk.name(view).map(str::to_owned).or_else(own_name).unwrap_or_default(),
            picture: show.and_then(|show| show.picture(view)),
            state: desk.state(view),
        }
    });
    Model {
        situation: situation(parts, &views),
        generation,
        generations: generations.to_vec(),
        baking: desk.baking(),
        undo: desk.next_undo(),
        views,
        ballots: desk.ballots(),
        arrangement: parts.arrangement,
        chosen: parts.chosen,
        genes: desk.genes(),
        bake_log: desk.bake_log().to_vec(),
        errors: desk.errors(),
        stats: show.map_or_else(Stats::default, |show| show.stats().clone()),
        keys: keys(parts.bindings),
        options: parts.options,
        comfort: parts.comfort,
        panels: parts.panels,
        captured: parts.captured,
        redo: desk.next_redo(),
    }
}

fn situation(parts: &Parts<'_>, views: &[ViewModel]) -> Situation {
    // A landscape gets its picture in the first frame that has a place for it.
    if (0..views.len()).any(|view| parts.show.is_some_and(|show| show.scene(view).is_some())) {
        return Situation::Ready;
    }
    let failed = views.iter().all(|view| matches!(view.state, ViewState::Failed { .. }));
    if let (true, Some(error)) = (failed || parts.desk.is_hindered(), parts.desk.errors().first()) {
        return Situation::Stuck {
            title: "Nothing to show".to_owned(),
            what: error.report.clone(),
            remedy: "Mend what the message names, or drop another world's folder here.".to_owned(),
        };
    }
    if parts.desk.world().is_some() && !parts.baking_here && parts.desk.generations().1.is_empty() {
        return Situation::Stuck {
            title: "No landscapes yet".to_owned(),
            what: "The world is empty, and this viewer was started with --no-bake.".to_owned(),
            remedy: "Run `bake --watch` with the same --world, or start the viewer without --no-bake."
                .to_owned(),
        };
    }
    Situation::Growing
}

/// Keys by group.
fn keys(bindings: &Bindings) -> Vec<KeyGroup> {
    let mut groups: Vec<KeyGroup> = Vec::new();
    for line in bindings.help() {
        let title = line.group.title();
        if groups.last().is_none_or(|group| group.title != title) {
            groups.push(KeyGroup { title: title.to_owned(), keys: Vec::new() });
        }
        if let Some(group) = groups.last_mut() {
            group.keys.push((line.keys, line.meaning));
        }
    }
    groups
}
