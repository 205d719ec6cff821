//! The user interface as one pure function: plain values in, events and the rectangles of the pictures out. Nothing in
//! here touches disk, GPU, window or clock; what a panel remembers between frames is in [`State`].

mod about;
pub mod arrange;
mod bake_log;
mod empty;
mod export;
mod family;
mod gene_row;
mod genome;
mod help;
pub mod icon;
pub mod model;
mod notices;
mod questions;
mod report;
mod settings;
pub mod stats;
#[cfg(test)]
mod testing;
pub mod theme;
mod top_bar;
mod viewport;
mod views;
mod votes;
mod widgets;

use egui::{Rect, Ui};

pub use notices::Tone;
pub use views::Views;

use crate::event::{Event, Panel};
use model::Model;
use notices::Notices;
use widgets::{Asks, ask, asked};

/// Genes and the family tree stand side by side in windows that are at least so wide, in points.
const BOTH_PANELS_FROM: f32 = 1100.0;

/// What the panels remember between frames.
pub struct State {
    /// Where the splitter is, as a part of the pictures' width.
    pub split: f32,
    /// Search field and what is being dragged.
    pub genome: genome::State,
    /// Search field of the family tree.
    pub family: family::State,
    notices: Notices,
}

impl Default for State {
    fn default() -> Self {
        let (genome, family, notices) = Default::default();
        Self { split: 0.5, genome, family, notices }
    }
}

impl State {
    /// Shows a notice for some seconds; a click on it takes it away or, if there is one, asks for `event`.
    pub fn notify(&mut self, tone: Tone, text: impl Into<String>, event: Option<Event>) {
        self.notices.add(tone, text.into(), event);
    }
}

/// What the person wants, and what the application has to fill with pictures.
#[derive(Clone, Debug, Default)]
pub struct Output {
    /// In the order in which they happened.
    pub events: Vec<Event>,
    /// The pictures on the screen; none while there is nothing to look at.
    pub views: Views,
    /// The keyboard is in a text field: keys are not commands.
    pub typing: bool,
}

/// Draws everything into the window's root [`Ui`], as [`egui::Context::run_ui`] gives it. [`theme::install`] must have
/// been called once, [`theme::follow`] in each frame before.
pub fn show(ui: &mut Ui, model: &Model, state: &mut State) -> Output {
    let mut output = Output::default();
    keep_keyboard(ui.ctx());
    theme::keep_pace(ui.ctx());
    top_bar::show(ui, model);
    let family = model.panels.family && model.votable;
    // In a small window the family tree takes the place of the genes: both would leave no pictures.
    let crowded = family && ui.available_width() < BOTH_PANELS_FROM;
    match &model.file {
        _ if !model.panels.genome || crowded => {}
        Some(file) => about::show(ui, model, file),
        None => genome::show(ui, model, &mut state.genome),
    }
    let counted = if model.file.is_some() { "copies" } else { "trees" };
    let docked = model.panels.stats && stats::show_docked(ui, &model.stats, counted);
    if family {
        family::show(ui, model, &mut state.family);
    }
    let area = ui.available_rect_before_wrap();
    if !empty::show(ui, model) {
        output.views = views::show(ui, model, &mut state.split);
        banner(ui, model, area);
    }
    if model.panels.stats && !docked {
        stats::show_card(ui, &model.stats, counted, area);
    }
    if model.panels.settings {
        settings::show(ui, model, area);
    }
    if model.panels.export && model.file.is_none() {
        export::show(ui, model, area);
    }
    if model.panels.questions && model.file.is_none() {
        questions::show(ui, model, area);
    }
    if model.panels.help {
        help::show(ui, model);
    }
    empty::drop_target(ui);
    let dropped = ui.input(|input| input.raw.dropped_files.clone());
    dropped.into_iter().for_each(|file| ask(ui, Event::OpenFolder(file.path().to_path_buf())));
    state.notices.show(ui, area);
    output.events = asked(ui);
    output.typing = ui.ctx().text_edit_focused();
    output
}

/// Keys are commands and lead from no control to the next: else a key that is meant as a command would press the one that
/// they have reached, too. Tab leaves a text field, as Enter does.
fn keep_keyboard(ctx: &egui::Context) {
    let tab = ctx.input(|input| input.key_pressed(egui::Key::Tab));
    ctx.memory_mut(|memory| {
        memory.move_focus(egui::FocusDirection::None);
        if let Some(field) = memory.focused().filter(|_| tab) {
            memory.surrender_focus(field);
        }
    });
}

/// A line over the pictures while a file is broken and the panel that tells more is closed.
fn banner(ui: &mut Ui, model: &Model, area: Rect) {
    let Some(error) = model.errors.first().filter(|_| !model.panels.genome) else { return };
    egui::Area::new(egui::Id::unique("error banner"))
        .pivot(egui::Align2::CENTER_BOTTOM)
        .fixed_pos(area.center_bottom() - egui::vec2(0.0, 56.0))
        .constrain_to(area)
        .show(ui.ctx(), |ui| {
            let palette = theme::Palette::of(ui.visuals());
            let line = egui::Stroke::new(1.0, palette.danger);
            let card = theme::card(palette).stroke(line).inner_margin(egui::Margin::symmetric(12, 6));
            card.show(ui, |ui| {
                ui.set_max_width(area.width() - 60.0);
                ui.horizontal(|ui| {
                    icon::Icon::Warning.show(ui, 16.0, 24.0, palette.danger);
                    let kept = if model.file.is_some() {
                        "what was read before stays"
                    } else {
                        "the last good landscapes stay"
                    };
                    ui.label(format!("{} – {kept}", error.title));
                    ui.button("Show").asks(Event::Panel { panel: Panel::Genome, open: true });
                });
            });
        });
}
