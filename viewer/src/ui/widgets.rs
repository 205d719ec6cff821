//! The few controls that egui does not bring: buttons of a pictogram, switches, choices in a row, progress rings, keys.
//! Each has a name for those who use a screen reader (and for the tests).

use egui::{
    Align2, Color32, CornerRadius, FontId, Painter, Pos2, Rect, Response, Role, Sense, Shape, Stroke,
    StrokeKind, TextStyle, Ui, WidgetInfo, vec2,
};

use super::icon::{Icon, arc};
use super::theme::Palette;

/// Side of a button that shows a pictogram, in points.
pub const ICON_BUTTON: f32 = 28.0;

/// A flat button that shows a pictogram; `label` is its tooltip and its name. `active` colours it.
pub fn icon_button(ui: &mut Ui, icon: Icon, label: &str, active: bool) -> Response {
    sized_icon_button(ui, icon, label, active, ICON_BUTTON)
}

/// The same of another size, in points.
pub fn sized_icon_button(ui: &mut Ui, icon: Icon, label: &str, active: bool, side: f32) -> Response {
    let (rect, response) = ui.allocate_exact_size(vec2(side, side), Sense::click());
    let palette = Palette::of(ui.visuals());
    let fill = match (active, response.hovered() || response.has_focus()) {
        (_, true) => palette.hovered,
        (true, false) => palette.button,
        (false, false) => Color32::TRANSPARENT,
    };
    let color = if active { palette.accent } else { palette.text };
    ui.painter().rect_filled(rect, CornerRadius::same(super::theme::RADIUS), fill);
    icon.paint(ui.painter(), rect.shrink(side * 0.24), color);
    name_button(ui, &response, label, active);
    response.on_hover_text(label)
}

/// Tells a hand-painted button's name and state.
pub fn name_button(ui: &Ui, response: &Response, label: &str, selected: bool) {
    let enabled = ui.is_enabled();
    response.widget_info(|| WidgetInfo::selected(Role::Button, enabled, selected, label));
}

/// The one button that leads on: filled with the accent. `icon` stands after the text.
pub fn primary_button(ui: &mut Ui, text: &str, icon: Icon) -> Response {
    let palette = Palette::of(ui.visuals());
    let font = TextStyle::Button.resolve(ui.style());
    let galley = ui.painter().layout_no_wrap(text.to_owned(), font, palette.on_accent);
    let size = vec2(galley.size().x + 42.0, ICON_BUTTON);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let (fill, ink) = match (ui.is_enabled(), response.hovered() || response.has_focus()) {
        (false, _) => (palette.button, palette.text),
        (true, true) => (palette.accent.lerp_to_gamma(palette.text, 0.25), palette.on_accent),
        (true, false) => (palette.accent, palette.on_accent),
    };
    ui.painter().rect_filled(rect, CornerRadius::same(14), fill);
    let at = Pos2::new(rect.left() + 14.0, rect.center().y - 0.5 * galley.size().y);
    ui.painter().galley_with_override_text_color(at, galley, ink);
    let icon_rect = Rect::from_center_size(Pos2::new(rect.right() - 18.0, rect.center().y), vec2(12.0, 12.0));
    icon.paint(ui.painter(), icon_rect, ink);
    name_button(ui, &response, text, false);
    response
}

/// A switch with its text on the left, over the whole width; true if it was flipped.
pub fn switch(ui: &mut Ui, on: &mut bool, text: &str, help: &str) -> bool {
    let size = vec2(ui.available_width(), ui.spacing().interact_size.y);
    let (rect, mut response) = ui.allocate_exact_size(size, Sense::click());
    let palette = Palette::of(ui.visuals());
    if response.clicked() {
        *on = !*on;
        response.mark_changed();
    }
    let font = TextStyle::Body.resolve(ui.style());
    ui.painter().text(rect.left_center(), Align2::LEFT_CENTER, text, font, palette.text);
    let track = Rect::from_center_size(Pos2::new(rect.right() - 16.0, rect.center().y), vec2(32.0, 18.0));
    let part = ui.ctx().animate_bool_responsive(response.id, *on);
    let rest = if response.hovered() { palette.hovered } else { palette.button };
    ui.painter().rect(
        track,
        CornerRadius::same(9),
        rest.lerp_to_gamma(palette.accent, part),
        Stroke::new(1.0, if *on { palette.accent } else { palette.line }),
        StrokeKind::Inside,
    );
    let knob = Pos2::new(egui::lerp(track.left() + 9.0..=track.right() - 9.0, part), track.center().y);
    let knob_color = palette.weak.lerp_to_gamma(palette.on_accent, part);
    ui.painter().circle_filled(knob, 6.0, knob_color);
    let (enabled, state) = (ui.is_enabled(), *on);
    response.widget_info(|| WidgetInfo::selected(Role::Switch, enabled, state, text));
    let changed = response.changed();
    if !help.is_empty() {
        response.on_hover_text(help);
    }
    changed
}

/// Choices in a row, one of which is chosen; the new one if it was changed. `name` stands before each choice's own
/// for screen readers.
pub fn segmented<T: Copy + PartialEq>(
    ui: &mut Ui,
    name: &str,
    choices: &[(T, &str, &str)],
    current: T,
) -> Option<T> {
    let palette = Palette::of(ui.visuals());
    let size = vec2(ui.available_width(), ui.spacing().interact_size.y);
    let (_, rect) = ui.allocate_space(size);
    ui.painter().rect_filled(rect, CornerRadius::same(super::theme::RADIUS), palette.sunken);
    let step = rect.width() / choices.len().max(1) as f32;
    let font = TextStyle::Button.resolve(ui.style());
    let mut chosen = None;
    for (at, &(value, text, help)) in choices.iter().enumerate() {
        let corner = rect.left_top() + vec2(at as f32 * step, 0.0);
        let cell = Rect::from_min_size(corner, vec2(step, rect.height())).shrink(2.0);
        let response = ui.interact(cell, ui.scope_id().with((name, text)), Sense::click());
        let selected = value == current;
        if selected || response.hovered() || response.has_focus() {
            let fill = if selected { palette.hovered } else { palette.button };
            ui.painter().rect_filled(cell, CornerRadius::same(5), fill);
        }
        let color = if selected { palette.text } else { palette.weak };
        ui.painter().text(cell.center(), Align2::CENTER_CENTER, text, font.clone(), color);
        let label = format!("{name}: {text}");
        name_button(ui, &response, &label, selected);
        if response.clicked() && !selected {
            chosen = Some(value);
        }
        if !help.is_empty() {
            response.on_hover_text(help);
        }
    }
    chosen
}

/// A ring that is filled clockwise from the top, as far as `part` (0 to 1).
pub fn progress_ring(painter: &Painter, center: Pos2, radius: f32, part: f32, color: Color32, rest: Color32) {
    painter.circle_stroke(center, radius, Stroke::new(3.5, rest));
    let part = if part.is_finite() { part.clamp(0.0, 1.0) } else { 0.0 };
    if part > 0.0 {
        let points = arc(center, radius, -90.0, -90.0 + 360.0 * part);
        painter.add(Shape::line(points, Stroke::new(3.5, color)));
    }
}

/// A thin bar that is filled from the left, as far as `part` (0 to 1).
pub fn progress_bar(painter: &Painter, rect: Rect, part: f32, color: Color32, rest: Color32) {
    let radius = CornerRadius::same((rect.height() * 0.5) as u8);
    painter.rect_filled(rect, radius, rest);
    let part = if part.is_finite() { part.clamp(0.0, 1.0) } else { 0.0 };
    if part > 0.0 {
        let width = (rect.width() * part).max(rect.height());
        painter.rect_filled(Rect::from_min_size(rect.min, vec2(width, rect.height())), radius, color);
    }
}

/// A heading above a group of controls.
pub fn section(ui: &mut Ui, text: &str) {
    ui.add_space(6.0);
    ui.label(egui::RichText::new(text).small().strong().color(Palette::of(ui.visuals()).weak));
}

/// A keyboard's keys as caps, one for each word of `keys`.
pub fn key_caps(ui: &mut Ui, keys: &str) {
    let palette = Palette::of(ui.visuals());
    let font = FontId::new(12.0, egui::FontFamily::Monospace);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for key in keys.split_whitespace() {
            let galley = ui.painter().layout_no_wrap(key.to_owned(), font.clone(), palette.text);
            let size = vec2((galley.size().x + 12.0).max(22.0), 21.0);
            let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
            let line = Stroke::new(1.0, palette.line);
            ui.painter().rect(rect, CornerRadius::same(5), palette.sunken, line, StrokeKind::Inside);
            ui.painter().galley(rect.center() - 0.5 * galley.size(), galley, palette.text);
            response.widget_info(|| WidgetInfo::labeled(Role::Label, true, key));
        }
    });
}
