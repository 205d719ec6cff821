//! What lies on one picture besides the votes: its number and name, the ways to see it larger or against another, and,
//! when it does not show what it should, why and what to do.

use egui::text::{LayoutJob, TextFormat, TextWrapping};
use egui::{Align2, Color32, CursorIcon, FontId, Pos2, Rect, Sense, Stroke, StrokeKind, Ui, pos2, vec2};
use genescape_schema::INDIVIDUALS;

use super::icon::Icon;
use super::model::{Model, ViewModel, ViewState};
use super::theme;
use super::widgets::{Asks, ask, painted_button, progress_ring};
use crate::event::{Arrangement, Event, Panel};
use crate::input::Command;

/// Side of a button on a picture, in points.
const BUTTON: f32 = 26.0;
/// A part of a picture narrower than this, beside a splitter, has no handle to export it by, in points.
const NARROW: f32 = 140.0;

/// A picture narrower than this has no buttons to breed by, in points.
const BREEDS_FROM: f32 = 300.0;

/// Draws name, buttons and state over the picture in `rect`; `lively` when the pointer is over it. Where the name ends.
pub fn show(ui: &mut Ui, model: &Model, view: usize, rect: Rect, lively: bool) -> Pos2 {
    if view >= model.count {
        return rect.min;
    }
    let compared = Arrangement::Compare { left: view, right: (view + 1) % INDIVIDUALS };
    let alone = Command::Maximise(view as u8 + 1);
    let tools: &[(Icon, &str, Arrangement, Command)] = match model.arrangement {
        Arrangement::Grid => &[
            (Icon::Maximise, "Show this one alone", Arrangement::One(view), alone),
            (Icon::Compare, "Compare with another", compared, Command::Compare),
        ],
        Arrangement::One(_) if model.count > 1 => {
            &[(Icon::Grid, "Show all four", Arrangement::Grid, Command::ShowAll)]
        }
        Arrangement::One(_) | Arrangement::Compare { .. } => &[],
    };
    // Where they would be, so that the name stays as it is when they come.
    let exports = rect.width() >= NARROW && model.file.is_none() && !model.studied;
    let breeds = model.votable && rect.width() >= BREEDS_FROM;
    let buttons = (tools.len() + usize::from(exports) + 2 * usize::from(breeds)) as f32 * (BUTTON + 4.0);
    let below = name_tag(ui, model, view, rect, rect.width() - 20.0 - buttons);
    match &model.views[view].state {
        ViewState::Ready => {}
        ViewState::Waiting => progress(ui, rect, 0.0, "…", "waiting to grow".to_owned()),
        ViewState::Baking { done, total, stage } => baking(ui, rect, *done, *total, stage),
        ViewState::Loading => progress(ui, rect, 1.0, "100%", "loading".to_owned()),
        ViewState::Failed { what, remedy } => failed(ui, view, rect, what, remedy),
    }
    let mut corner = rect.right_top() + vec2(-10.0 - BUTTON, 10.0);
    for &(icon, label, arrangement, command) in tools.iter().filter(|_| lively) {
        let rect = Rect::from_min_size(corner, vec2(BUTTON, BUTTON));
        let name = format!("{label}: {}", view + 1);
        let (response, lit) = painted_button(ui, rect, (label, view), &name, false);
        ui.painter().rect_filled(rect, 13, scrim(lit));
        icon.paint(ui.painter(), rect.shrink(7.0), theme::ON_SCRIM);
        response.on_hover_text(model.with_key(label, command)).asks(Event::Arrange(arrangement));
        corner.x -= BUTTON + 4.0;
    }
    if lively && exports && matches!(model.views[view].state, ViewState::Ready) {
        export_handle(ui, model, view, Rect::from_min_size(corner, vec2(BUTTON, BUTTON)));
        corner.x -= BUTTON + 4.0;
    }
    if breeds && lively && matches!(model.views[view].state, ViewState::Ready) {
        more_like(ui, view, Rect::from_min_size(corner, vec2(BUTTON, BUTTON)));
    }
    let at = rect.right_top() + vec2(-10.0 - buttons + 4.0, 10.0);
    if breeds && (lively || is_starred(model, view)) {
        star(ui, model, view, Rect::from_min_size(at, vec2(BUTTON, BUTTON)));
    }
    below
}

/// A click shows the export card; a drag leads out of the window, to the program that gets the landscape.
fn export_handle(ui: &mut Ui, model: &Model, view: usize, rect: Rect) {
    let name = format!("Export: {}", view + 1);
    let (response, lit) = painted_button(ui, rect, ("export", view), &name, false);
    ui.painter().rect_filled(rect, 13, scrim(lit));
    Icon::Export.paint(ui.painter(), rect.shrink(7.0), theme::ON_SCRIM);
    response.asks(Event::Choose(view));
    response.asks(Event::Panel { panel: Panel::Export, open: true });
    let response = response.interact(Sense::drag()).on_hover_and_drag_cursor(CursorIcon::Grab);
    if response.drag_started() {
        ask(ui, Event::DragOut(view));
    }
    let text = model.with_key("Export as files", Command::Export);
    response.on_hover_text(format!("{text}, or drag it to another program"));
}

fn more_like(ui: &mut Ui, view: usize, rect: Rect) {
    let name = format!("More like this: {}", view + 1);
    let (response, lit) = painted_button(ui, rect, ("more", view), &name, false);
    ui.painter().rect_filled(rect, 13, scrim(lit));
    Icon::More.paint(ui.painter(), rect.shrink(6.0), theme::ON_SCRIM);
    response.asks(Event::MoreLike(view));
    response.on_hover_text("More like this: vote for all of it, and breed close variations");
}

fn is_starred(model: &Model, view: usize) -> bool {
    model.favourites.contains(&(model.generation, view))
}

/// Seen as long as it shines, else under the pointer.
fn star(ui: &mut Ui, model: &Model, view: usize, rect: Rect) {
    let starred = is_starred(model, view);
    let name = format!("Star: {}", view + 1);
    let (response, lit) = painted_button(ui, rect, ("star", view), &name, starred);
    ui.painter().rect_filled(rect, 13, scrim(lit));
    let color = if starred { theme::DARK.accent } else { theme::ON_SCRIM_WEAK };
    Icon::Star.paint(ui.painter(), rect.shrink(6.0), color);
    response.asks(Event::Star { generation: model.generation, landscape: view, starred: !starred });
    let text =
        if starred { "Take the star away" } else { "Mark with a star: it is kept among the favourites" };
    response.on_hover_text(model.with_key(text, Command::Family));
}

/// The ground of a button on a picture.
fn scrim(lit: bool) -> Color32 {
    if lit { theme::SCRIM_HOVERED } else { theme::SCRIM }
}

fn text(size: f32, color: Color32) -> TextFormat {
    TextFormat { font_id: FontId::proportional(size), color, ..Default::default() }
}

/// Four numbers below the name that choose which landscape this side of the comparison shows.
pub fn choose_side(ui: &mut Ui, model: &Model, side: usize, below: Pos2) {
    let Arrangement::Compare { left, right } = model.arrangement else { return };
    let shown = [left, right][side];
    for view in 0..INDIVIDUALS {
        let corner = below + vec2(view as f32 * 30.0, 6.0);
        let rect = Rect::from_min_size(corner, vec2(26.0, 24.0));
        let name = format!("Show {} on the {}", view + 1, ["left", "right"][side]);
        let (response, lit) = painted_button(ui, rect, ("side", view), &name, view == shown);
        let (fill, ink) = match (view == shown, lit) {
            (true, _) => (theme::ON_SCRIM, theme::ON_BRIGHT),
            (false, true) => (theme::SCRIM_HOVERED, theme::ON_SCRIM),
            (false, false) => (theme::SCRIM, theme::ON_SCRIM_WEAK),
        };
        ui.painter().rect_filled(rect, theme::RADIUS, fill);
        ui.painter().text(rect.center(), Align2::CENTER_CENTER, view + 1, FontId::proportional(13.0), ink);
        if response.clicked() && view != shown {
            let (left, right) = if side == 0 { (view, right) } else { (left, view) };
            ask(ui, Event::Arrange(Arrangement::Compare { left, right }));
        }
    }
}

/// Number and name, on two lines where one has no room for them; its lower left corner.
fn name_tag(ui: &mut Ui, model: &Model, view: usize, rect: Rect, room: f32) -> Pos2 {
    let name = &model.views[view].name;
    let mut job = LayoutJob::default();
    // Where there are no others a number means nothing.
    let number = if model.count > 1 { format!("{}", view + 1) } else { String::new() };
    job.append(&number, 0.0, text(14.0, theme::DARK.accent));
    job.append(name, if number.is_empty() { 0.0 } else { 8.0 }, text(14.0, theme::ON_SCRIM));
    job.wrap = TextWrapping { max_width: (room - 20.0).max(20.0), max_rows: 2, ..Default::default() };
    let galley = ui.painter().layout_job(job);
    let tag = Rect::from_min_size(rect.min + vec2(10.0, 10.0), galley.size() + vec2(20.0, 9.0));
    ui.painter().rect_filled(tag, 13, theme::SCRIM);
    ui.painter().galley(tag.min + vec2(10.0, 4.5), galley, theme::ON_SCRIM);
    let told = ui.interact(tag, ui.scope_id().with(("name", view)), Sense::hover());
    told.on_hover_text(legend(model, view));
    tag.left_bottom()
}

/// A whole name, what descends from whom, and who is meant by the numbers.
fn legend(model: &Model, view: usize) -> String {
    let ViewModel { name, descent, .. } = &model.views[view];
    let name = if descent.is_empty() { name.clone() } else { format!("{name}\n{descent}") };
    let Some((parent, ancestors)) = model.parents.get(&model.generation).zip(model.ancestors.as_ref()) else {
        return name;
    };
    let line = |(index, name): (usize, &String)| format!("\n{} {name}", index + 1);
    let lines: String = ancestors.iter().enumerate().map(line).collect();
    format!("{name}\n\nNumbers are those of generation {}:{lines}", parent.generation)
}

fn baking(ui: &Ui, rect: Rect, done: usize, total: usize, stage: &str) {
    let part = done as f32 / total.max(1) as f32;
    let line = if stage.is_empty() { "growing" } else { stage };
    progress(ui, rect, part, &format!("{}%", (part * 100.0) as u32), format!("{line} · {done} of {total}"));
}

/// A ring with a word in it and a line below.
fn progress(ui: &Ui, rect: Rect, part: f32, word: &str, line: String) {
    let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
    let center = rect.center() - vec2(0.0, 16.0);
    let radius = 24.0f32.min(rect.height() * 0.18);
    painter.circle_filled(center, radius + 10.0, theme::SCRIM);
    progress_ring(&painter, center, radius, part, theme::DARK.accent, Color32::from_white_alpha(40));
    let font = FontId::proportional(13.0);
    painter.text(center, Align2::CENTER_CENTER, word, font.clone(), theme::ON_SCRIM);
    let mut job = LayoutJob::simple_singleline(line, font, theme::ON_SCRIM);
    job.wrap = TextWrapping::truncate_at_width((rect.width() - 44.0).max(20.0));
    let galley = painter.layout_job(job);
    let place = pos2(center.x, center.y + radius + 26.0);
    let tag = Rect::from_center_size(place, galley.size() + vec2(20.0, 8.0));
    painter.rect_filled(tag, 12, theme::SCRIM);
    painter.galley(tag.min + vec2(10.0, 4.0), galley, theme::ON_SCRIM);
}

fn failed(ui: &mut Ui, view: usize, rect: Rect, what: &str, remedy: &str) {
    let width = (rect.width() - 40.0).clamp(80.0, 420.0);
    let mut job = LayoutJob::default();
    job.append(what, 0.0, text(14.0, theme::ON_SCRIM));
    job.append("\n\n", 0.0, text(5.0, theme::ON_SCRIM));
    job.append(remedy, 0.0, text(13.0, theme::ON_SCRIM_WEAK));
    job.wrap = TextWrapping { max_width: width - 52.0, max_rows: 7, ..Default::default() };
    let galley = ui.painter().layout_job(job);
    let card = Rect::from_center_size(rect.center(), vec2(width, galley.size().y + 62.0));
    let line = Stroke::new(1.0, theme::DARK.danger.gamma_multiply(0.7));
    let fill = Color32::from_rgba_unmultiplied(20, 20, 20, 235);
    ui.painter().rect(card, 10, fill, line, StrokeKind::Inside);
    let icon_rect = Rect::from_min_size(card.min + vec2(14.0, 15.0), vec2(18.0, 18.0));
    Icon::Warning.paint(ui.painter(), icon_rect, theme::DARK.danger);
    ui.painter().galley(card.min + vec2(42.0, 14.0), galley, theme::ON_SCRIM);
    let button = Rect::from_min_size(card.left_bottom() + vec2(40.0, -38.0), vec2(92.0, 26.0));
    let name = format!("Try again: {}", view + 1);
    let (response, lit) = painted_button(ui, button, ("retry", view), &name, false);
    let fill = Color32::from_white_alpha(if lit { 60 } else { 32 });
    ui.painter().rect_filled(button, theme::RADIUS, fill);
    let font = FontId::proportional(13.0);
    ui.painter().text(button.center(), Align2::CENTER_CENTER, "Try again", font, theme::ON_SCRIM);
    response.asks(Event::Retry);
    let full = format!("{what}\n{remedy}");
    ui.interact(card, ui.scope_id().with(("failed", view)), Sense::hover())
        .on_hover_text(&full)
        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &full));
}
