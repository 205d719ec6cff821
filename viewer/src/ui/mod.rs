//! The user interface as one pure function: plain values in, events and the rectangles of the pictures out. Nothing in
//! here touches disk, GPU, window or clock; what a panel remembers between frames is in [`State`].

pub mod arrange;
mod bake_log;
mod empty;
mod gene_row;
mod genome;
mod help;
pub mod icon;
pub mod model;
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
use egui_notify::{Anchor, Toasts};

pub use views::Views;

use crate::event::{Event, Panel};
use model::Model;
use widgets::{Asks, ask, asked};

/// Notices that are shown at a time: more would reach up to the next picture's buttons.
const NOTICES: usize = 3;
/// Space between notices and the lower left corner of the pictures: there are vote buttons.
const NOTICES_AT: egui::Vec2 = egui::vec2(14.0, 56.0);

/// What the panels remember between frames.
pub struct State {
    /// Where the splitter is, as a part of the pictures' width.
    pub split: f32,
    /// Search field and what is being dragged.
    pub genome: genome::State,
    toasts: Toasts,
}

impl Default for State {
    fn default() -> Self {
        let toasts = Toasts::default().with_anchor(Anchor::BottomLeft).with_margin(NOTICES_AT);
        Self { split: 0.5, genome: genome::State::default(), toasts }
    }
}

/// How a notice looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// For information.
    Info,
    /// Something was done.
    Success,
    /// Something deserves attention.
    Warning,
    /// Something failed; stays longer.
    Error,
}

impl State {
    /// Shows a notice for some seconds.
    pub fn notify(&mut self, tone: Tone, text: impl Into<String>) {
        let text = text.into();
        if self.toasts.len() >= NOTICES {
            self.toasts.dismiss_oldest_toast();
        }
        let (toast, seconds) = match tone {
            Tone::Info => (self.toasts.info(text), 4),
            Tone::Success => (self.toasts.success(text), 4),
            Tone::Warning => (self.toasts.warning(text), 7),
            Tone::Error => (self.toasts.error(text), 12),
        };
        toast.duration(std::time::Duration::from_secs(seconds)).show_progress_bar(false);
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
    if model.panels.genome {
        genome::show(ui, model, &mut state.genome);
    }
    let docked = model.panels.stats && stats::show_docked(ui, &model.stats);
    let area = ui.available_rect_before_wrap();
    if !empty::show(ui, model) {
        output.views = views::show(ui, model, &mut state.split);
        banner(ui, model, area);
    }
    if model.panels.stats && !docked {
        stats::show_card(ui, &model.stats, area);
    }
    if model.panels.settings {
        settings::show(ui, model, area);
    }
    if model.panels.help {
        help::show(ui, model);
    }
    empty::drop_target(ui);
    let dropped = ui.input(|input| input.raw.dropped_files.clone());
    dropped.into_iter().for_each(|file| ask(ui, Event::OpenFolder(file.path().to_path_buf())));
    let below = ui.ctx().content_rect().bottom() - area.bottom();
    let margin = NOTICES_AT + egui::vec2(area.left(), below);
    state.toasts = std::mem::take(&mut state.toasts).with_margin(margin);
    state.toasts.show(ui.ctx());
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
                    ui.label(format!("{} – the last good landscapes stay", error.title));
                    ui.button("Show").asks(Event::Panel { panel: Panel::Genome, open: true });
                });
            });
        });
}
