//! What is shown where there is nothing to show yet: that landscapes are growing, or why they can't be shown and what
//! to do about it.

use egui::{Align2, Color32, FontId, Rect, RichText, Sense, Ui, UiBuilder, vec2};
use genescape_schema::Category;

use super::icon::Icon;
use super::model::{Baking, Model, Situation};
use super::theme::{self, Palette};
use super::widgets::{Asks, primary_button, progress_bar, small};
use crate::event::Event;

/// Draws it into what is left of `ui`; false if there is something to look at, and nothing was drawn.
pub fn show(ui: &mut Ui, model: &Model) -> bool {
    if model.situation == Situation::Ready {
        return false;
    }
    let area = ui.available_rect_before_wrap();
    ui.allocate_rect(area, Sense::hover());
    let width = (area.width() - 48.0).clamp(120.0, 460.0);
    let height = if model.situation == Situation::Growing { 210.0 } else { 290.0 };
    let card = Rect::from_center_size(area.center(), vec2(width, height)).intersect(area);
    let mut ui = ui.new_child(UiBuilder::new().max_rect(card));
    ui.vertical_centered(|ui| match &model.situation {
        Situation::Stuck { title, what, remedy } => stuck(ui, title, what, remedy),
        Situation::Growing | Situation::Ready => growing(ui, model),
    });
    true
}

fn growing(ui: &mut Ui, model: &Model) {
    let palette = Palette::of(ui.visuals());
    let (rect, _) = ui.allocate_exact_size(vec2(150.0, 44.0), Sense::hover());
    for (at, category) in Category::ALL.into_iter().enumerate() {
        let center = rect.left_center() + vec2(25.0 + 50.0 * at as f32, 0.0);
        Icon::from(category).paint_at(ui.painter(), center, 32.0, palette.category(category));
    }
    ui.add_space(12.0);
    if !model.votable {
        ui.label(RichText::new("Loading…").size(21.0));
        return;
    }
    let baking = model.baking.as_ref();
    ui.label(RichText::new("Growing four landscapes…").size(21.0));
    ui.add_space(2.0);
    ui.weak("Each appears as soon as it is ready. What has grown once is kept.");
    ui.add_space(14.0);
    let (rect, _) = ui.allocate_exact_size(vec2(260.0f32.min(ui.available_width()), 6.0), Sense::hover());
    let part = baking.map_or(0.0, Baking::part);
    progress_bar(ui.painter(), rect, part, palette.accent, palette.button);
    if let Some(Baking { done, total, .. }) = baking.filter(|baking| baking.total > 0) {
        ui.add_space(4.0);
        small(ui, format!("{done} of {total} stages"));
    }
}

fn stuck(ui: &mut Ui, title: &str, what: &str, remedy: &str) {
    let palette = Palette::of(ui.visuals());
    Icon::Warning.show(ui, 40.0, 40.0, palette.warning);
    ui.add_space(8.0);
    ui.label(RichText::new(title).size(21.0));
    ui.add_space(4.0);
    ui.label(RichText::new(what).color(palette.weak));
    ui.add_space(8.0);
    ui.label(remedy);
    ui.add_space(14.0);
    primary_button(ui, "Try again", Icon::Reset).asks(Event::Retry);
}

/// A sign over the window while a folder is held over it.
pub fn drop_target(ui: &Ui) {
    let hovering = ui.input(|input| !input.raw.hovered_files.is_empty());
    if !hovering {
        return;
    }
    let window = ui.ctx().content_rect();
    let layer = egui::LayerId::new(egui::Order::Tooltip, egui::Id::unique("drop target"));
    let painter = ui.ctx().layer_painter(layer);
    painter.rect_filled(window, 0, Color32::from_black_alpha(150));
    let line = egui::Stroke::new(3.0, theme::DARK.accent);
    painter.rect_stroke(window.shrink(14.0), 12, line, egui::StrokeKind::Inside);
    let font = FontId::proportional(22.0);
    let text = "Drop a world, a baked folder or a glTF file to open it";
    painter.text(window.center(), Align2::CENTER_CENTER, text, font, theme::ON_SCRIM);
}
