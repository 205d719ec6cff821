//! The few controls that egui does not bring: buttons of a pictogram, switches, choices in a row, progress rings, keys.
//! Each has a name for those who use a screen reader (and for the tests).

use egui::{Align, Align2, AsIdSalt, Color32, Context, FontId, Id, Layout, Painter, Pos2, Rect, RectAlign};
use egui::{Response, RichText, Role, Sense, Shape, Stroke, StrokeKind, TextStyle, Tooltip, Ui, Vec2};
use egui::{WidgetInfo, WidgetText, vec2};

use super::icon::{Icon, arc};
use super::theme::{self, Palette};
use crate::event::{Event, Panel};

/// Side of a button that shows a pictogram, in points.
pub const ICON_BUTTON: f32 = 28.0;

/// A flat button that shows a pictogram; `label` is its tooltip and its name. `active` colours it.
pub fn icon_button(ui: &mut Ui, icon: Icon, label: &str, active: bool) -> Response {
    sized_icon_button(ui, icon, label, active, ICON_BUTTON)
}

/// The same of another size, in points.
pub fn sized_icon_button(ui: &mut Ui, icon: Icon, label: &str, active: bool, side: f32) -> Response {
    told_button(ui, icon, label, active, side, label)
}

/// A button of the bar, whose tooltip says more than its name.
pub fn bar_button(ui: &mut Ui, icon: Icon, label: &str, active: bool, tooltip: &str) -> Response {
    told_button(ui, icon, label, active, ICON_BUTTON, tooltip)
}

fn told_button(ui: &mut Ui, icon: Icon, label: &str, active: bool, side: f32, tooltip: &str) -> Response {
    let color = if active { Palette::of(ui.visuals()).accent } else { Palette::of(ui.visuals()).text };
    let (rect, response) = flat_button(ui, vec2(side, side), label, active);
    icon.paint(ui.painter(), rect.shrink(side * 0.24), color);
    response.on_hover_text(tooltip)
}

/// The ground of a button that is invisible at rest unless it is `active`; its caller paints what is on it.
pub fn flat_button(ui: &mut Ui, size: Vec2, name: &str, active: bool) -> (Rect, Response) {
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let palette = Palette::of(ui.visuals());
    let fill = match (active, is_lit(&response)) {
        (_, true) => palette.hovered,
        (true, false) => palette.button,
        (false, false) => Color32::TRANSPARENT,
    };
    ui.painter().rect_filled(rect, theme::RADIUS, fill);
    name_button(ui, &response, name, active);
    (rect, response)
}

/// A button that its caller paints, `on` or not; the flag says whether it is to look as under the pointer. `id` tells it
/// from the others of this [`Ui`].
pub fn painted_button(ui: &Ui, rect: Rect, id: impl AsIdSalt, name: &str, on: bool) -> (Response, bool) {
    let response = ui.interact(rect, ui.scope_id().with(id), Sense::click());
    name_button(ui, &response, name, on);
    let lit = is_lit(&response);
    (response, lit)
}

/// What a click asks for.
pub trait Asks {
    fn asks(&self, event: impl Into<Event>);
}

impl Asks for Response {
    fn asks(&self, event: impl Into<Event>) {
        if self.clicked() {
            ask(&self.ctx, event.into());
        }
    }
}

/// A tooltip above the widget: below it lies something that has to be read.
pub fn tooltip_above(response: &Response, text: impl Into<WidgetText>) {
    let mut tooltip = Tooltip::for_enabled(response);
    tooltip.popup = tooltip.popup.align(RectAlign::TOP);
    tooltip.show(|ui| ui.label(text));
}

/// Asks for something. Until [`asked`] takes it egui keeps it, so that no function has to pass it on.
pub fn ask(ctx: &Context, event: Event) {
    ctx.data_mut(|data| data.get_temp_mut_or_default::<Vec<Event>>(Id::NULL).push(event));
}

/// Everything that was asked for since the last call.
pub fn asked(ui: &Ui) -> Vec<Event> {
    ui.data_mut(|data| data.remove_temp(Id::NULL).unwrap_or_default())
}

/// Under the pointer, or reached by the keyboard.
fn is_lit(response: &Response) -> bool {
    response.hovered() || response.has_focus()
}

/// Tells a hand-painted button's name and state.
fn name_button(ui: &Ui, response: &Response, label: &str, selected: bool) {
    let enabled = ui.is_enabled();
    response.widget_info(|| WidgetInfo::selected(Role::Button, enabled, selected, label));
}

/// The cross that closes a panel.
pub fn close_button(ui: &mut Ui, label: &str, panel: Panel) {
    icon_button(ui, Icon::Close, label, false).asks(Event::Panel { panel, open: false });
}

/// Something at the right end of a row, and something that fills the rest from the left.
pub fn ends<T>(ui: &mut Ui, left: impl FnOnce(&mut Ui) -> T, right: impl FnOnce(&mut Ui)) {
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        right(ui);
        ui.with_layout(Layout::left_to_right(Align::Center), left);
    });
}

/// Text that matters less.
pub fn small(ui: &mut Ui, text: impl Into<String>) {
    ui.label(RichText::new(text).small().color(Palette::of(ui.visuals()).weak));
}

/// A list that scrolls and takes up to `room` points; in an [`egui::Area`], which offers no more than it had, it has to
/// say so itself.
pub fn scrolled(ui: &mut Ui, room: f32, list: impl FnOnce(&mut Ui)) {
    let area = egui::ScrollArea::vertical().max_height(room).min_scrolled_height(room);
    area.auto_shrink([false, true]).show(ui, list);
}

/// The button for the next step: filled with the accent. `icon` stands after the text.
pub fn primary_button(ui: &mut Ui, text: &str, icon: Icon) -> Response {
    let palette = Palette::of(ui.visuals());
    let font = TextStyle::Button.resolve(ui.style());
    let galley = ui.painter().layout_no_wrap(text.to_owned(), font, palette.on_accent);
    let size = vec2(galley.size().x + 42.0, ICON_BUTTON);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let (fill, ink) = match (ui.is_enabled(), is_lit(&response)) {
        (false, _) => (palette.button, palette.text),
        (true, true) => (palette.accent.lerp_to_gamma(palette.text, 0.25), palette.on_accent),
        (true, false) => (palette.accent, palette.on_accent),
    };
    ui.painter().rect_filled(rect, 14, fill);
    let at = Pos2::new(rect.left() + 14.0, rect.center().y - 0.5 * galley.size().y);
    ui.painter().galley_with_override_text_color(at, galley, ink);
    icon.paint_at(ui.painter(), rect.right_center() - vec2(18.0, 0.0), 12.0, ink);
    name_button(ui, &response, text, false);
    response
}

/// A switch with its text on the left, over the whole width.
pub fn switch(ui: &mut Ui, on: &mut bool, text: &str, help: &str) {
    let size = vec2(ui.available_width(), ui.spacing().interact_size.y);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let palette = Palette::of(ui.visuals());
    *on ^= response.clicked();
    let font = TextStyle::Body.resolve(ui.style());
    ui.painter().text(rect.left_center(), Align2::LEFT_CENTER, text, font, palette.text);
    let track = Rect::from_center_size(Pos2::new(rect.right() - 16.0, rect.center().y), vec2(32.0, 18.0));
    let part = ui.ctx().animate_bool_responsive(response.id, *on);
    let rest = if response.hovered() { palette.hovered } else { palette.button };
    let line = (1.0, if *on { palette.accent } else { palette.line });
    ui.painter().rect(track, 9, rest.lerp_to_gamma(palette.accent, part), line, StrokeKind::Inside);
    let knob = Pos2::new(egui::lerp(track.left() + 9.0..=track.right() - 9.0, part), track.center().y);
    let knob_color = palette.weak.lerp_to_gamma(palette.on_accent, part);
    ui.painter().circle_filled(knob, 6.0, knob_color);
    let (enabled, state) = (ui.is_enabled(), *on);
    response.widget_info(|| WidgetInfo::selected(Role::Switch, enabled, state, text));
    if !help.is_empty() {
        response.on_hover_text(help);
    }
}

/// Choices in a row, one of which is `chosen`. `name` stands before each choice's own for screen readers.
pub fn segmented<T: Copy + PartialEq>(ui: &mut Ui, name: &str, choices: &[(T, &str, &str)], chosen: &mut T) {
    let palette = Palette::of(ui.visuals());
    let size = vec2(ui.available_width(), ui.spacing().interact_size.y);
    let (_, rect) = ui.allocate_space(size);
    ui.painter().rect_filled(rect, theme::RADIUS, palette.sunken);
    let step = rect.width() / choices.len().max(1) as f32;
    let font = TextStyle::Button.resolve(ui.style());
    let current = *chosen;
    for (at, &(value, text, help)) in choices.iter().enumerate() {
        let corner = rect.left_top() + vec2(at as f32 * step, 0.0);
        let cell = Rect::from_min_size(corner, vec2(step, rect.height())).shrink(2.0);
        let selected = value == current;
        let label = format!("{name}: {text}");
        let (response, lit) = painted_button(ui, cell, (name, text), &label, selected);
        if selected || lit {
            let fill = if selected { palette.hovered } else { palette.button };
            ui.painter().rect_filled(cell, 5, fill);
        }
        let color = if selected { palette.text } else { palette.weak };
        ui.painter().text(cell.center(), Align2::CENTER_CENTER, text, font.clone(), color);
        if response.clicked() {
            *chosen = value;
        }
        if !help.is_empty() {
            response.on_hover_text(help);
        }
    }
}

/// A ring that is filled clockwise from the top, as far as `part` (0 to 1).
pub fn progress_ring(painter: &Painter, center: Pos2, radius: f32, part: f32, color: Color32, rest: Color32) {
    painter.circle_stroke(center, radius, Stroke::new(3.5, rest));
    if part > 0.0 {
        let points = arc(center, radius, -90.0, -90.0 + 360.0 * part.min(1.0));
        painter.add(Shape::line(points, Stroke::new(3.5, color)));
    }
}

/// A thin bar that is filled from the left, as far as `part` (0 to 1).
pub fn progress_bar(painter: &Painter, rect: Rect, part: f32, color: Color32, rest: Color32) {
    let radius = (0.5 * rect.height()) as u8;
    painter.rect_filled(rect, radius, rest);
    if part > 0.0 {
        let width = (rect.width() * part.min(1.0)).max(rect.height());
        painter.rect_filled(Rect::from_min_size(rect.min, vec2(width, rect.height())), radius, color);
    }
}

/// A heading above a group of controls.
pub fn section(ui: &mut Ui, text: &str) {
    ui.add_space(6.0);
    ui.label(RichText::new(text).small().strong().color(Palette::of(ui.visuals()).weak));
}

/// A keyboard's keys as caps, one for each word of `keys`.
pub fn key_caps(ui: &mut Ui, keys: &str) {
    let palette = Palette::of(ui.visuals());
    let font = FontId::new(12.0, egui::FontFamily::Monospace);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for key in keys.split(' ') {
            let galley = ui.painter().layout_no_wrap(key.to_owned(), font.clone(), palette.text);
            let size = vec2((galley.size().x + 12.0).max(22.0), 21.0);
            let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
            let line = Stroke::new(1.0, palette.line);
            ui.painter().rect(rect, 5, palette.sunken, line, StrokeKind::Inside);
            ui.painter().galley(rect.center() - 0.5 * galley.size(), galley, palette.text);
            response.widget_info(|| WidgetInfo::labeled(Role::Label, true, key));
        }
    });
}
