//! The four pictures: two by two, one alone, or two over each other with a splitter; on each its name, its state and
//! its vote buttons. Says which rectangles the renderer has to fill and where the pointer is.

use egui::{
    Color32, CursorIcon, FontId, Pos2, Rect, Response, Sense, Stroke, StrokeKind, Ui, Vec2, pos2, vec2,
};

use super::arrange::{Slot, slots};
use super::model::{Model, ViewState};
use super::theme::{self, Palette};
use super::widgets::ask;
use super::{viewport, votes};
use crate::event::{Arrangement, Event};
use crate::input::Command;

/// What the application has to know about the views.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Views {
    /// The views that are on the screen, with the size of their render targets.
    pub slots: Vec<Slot>,
    /// The landscape under the pointer, whatever lies on it.
    pub pointed: Option<usize>,
    /// Nothing lies between the pointer and that picture: wheel and drags are the camera's.
    pub free: bool,
    /// The pointer was pressed on a picture and moved so far in this frame, in points.
    pub dragged: Vec2,
    /// A press on a picture began in this frame.
    pub pressed: bool,
}

/// Draws them into what is left of `ui`.
pub fn show(ui: &mut Ui, model: &Model, split: &mut f32) -> Views {
    let area = ui.available_rect_before_wrap();
    ui.allocate_rect(area, Sense::hover());
    let slots = slots(area.shrink(4.0), model.arrangement, ui.pixels_per_point());
    let mut views = Views::default();
    match (model.arrangement, &slots[..]) {
        (Arrangement::Compare { .. }, &[left, right]) => {
            compare(ui, model, [left, right], split, &mut views);
        }
        _ => {
            for slot in &slots {
                let response = picture(ui, model, slot.view, slot.rect, slot.rect, &mut views);
                let lively = !model.captured && response.contains_pointer();
                frame(ui, model, slot, lively);
                viewport::show(ui, model, slot.view, slot.rect, lively);
                vote_bar(ui, model, slot.view, slot.rect, lively);
            }
        }
    }
    if model.votable {
        let (anchor, beside) = hub_place(model, area, &slots, *split);
        votes::hub(ui, model, anchor, beside);
    }
    if model.greets {
        greeting(ui, model, area);
    }
    views.slots = slots;
    views
}

/// The middle of the hub's lower edge, and the width of the pictures whose vote buttons are beside it.
fn hub_place(model: &Model, area: Rect, slots: &[Slot], split: f32) -> (Pos2, f32) {
    let (first, last) = (slots[0].rect, slots[slots.len() - 1].rect);
    match model.arrangement {
        // Just below the crossing, where the name of the lower right picture begins.
        Arrangement::Grid => (pos2(0.5 * (first.right() + last.left()), last.top() + 2.0), first.width()),
        // On the splitter, between the vote buttons of the two pictures, as long as it is inside.
        Arrangement::Compare { .. } => {
            let beside = 0.5 * area.width();
            let half = 0.5 * votes::hub_size(model, beside).0.x + 4.0;
            let x = egui::lerp(first.x_range(), split).clamp(first.left() + half, first.right() - half);
            (pos2(x, area.bottom() - 9.0), beside)
        }
        Arrangement::One(_) => (pos2(area.center().x, area.top() + 50.0), first.width()),
    }
}

/// Paints one picture, cut to `clip`, and listens to the pointer there.
fn picture(ui: &mut Ui, model: &Model, view: usize, rect: Rect, clip: Rect, views: &mut Views) -> Response {
    let response = ui.interact(clip, ui.scope_id().with(("picture", view)), Sense::click_and_drag());
    paint_picture(ui, model, view, rect, clip);
    let name = format!("Landscape {}: {}", view + 1, model.views[view].name);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &name));
    if response.contains_pointer() {
        views.pointed = Some(view);
        views.free = response.hovered();
    }
    if response.dragged() {
        views.dragged += response.drag_delta();
        views.free = true;
    }
    views.pressed |= response.drag_started();
    if response.double_clicked() {
        let arrangement = match model.arrangement {
            Arrangement::Grid => Arrangement::One(view),
            _ => Arrangement::Grid,
        };
        ask(ui, Event::Arrange(arrangement));
    } else if response.clicked() && model.chosen != view {
        ask(ui, Event::Choose(view));
    } else if response.secondary_clicked() {
        ask(ui, Event::Capture(true));
    }
    response.on_hover_cursor(CursorIcon::Default)
}

fn paint_picture(ui: &Ui, model: &Model, view: usize, rect: Rect, clip: Rect) {
    let corner = theme::RADIUS;
    let painter = ui.painter().with_clip_rect(clip.intersect(ui.clip_rect()));
    match model.views[view].picture {
        Some(texture) => {
            let tint = match model.views[view].state {
                ViewState::Ready => Color32::WHITE,
                _ => Color32::from_gray(110),
            };
            let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            let shape = egui::epaint::RectShape::filled(rect, corner, tint).with_texture(texture, whole);
            painter.add(shape.with_round_to_pixels(false));
        }
        None => _ = painter.rect_filled(rect, corner, Color32::from_rgb(30, 34, 33)),
    }
}

/// What to do first, until it was done once.
fn greeting(ui: &Ui, model: &Model, area: Rect) {
    let key =
        |command| model.bindings.chords(command).next().map_or("–".to_owned(), |chord| chord.to_string());
    let walk = [Command::Forward, Command::Left, Command::Back, Command::Right].map(key).join(" ");
    let text = match &model.file {
        Some(_) => {
            format!(
                "drag to turn · wheel to come nearer · {} fly and walk · {} help",
                key(Command::WalkFlyOrbit),
                key(Command::Help)
            )
        }
        None => format!("{walk} walk · drag to look around · {} help", key(Command::Help)),
    };
    let galley = ui.painter().layout_no_wrap(text, FontId::proportional(14.0), theme::ON_SCRIM);
    // Below the names of the lower pictures.
    let tag = Rect::from_center_size(area.center() + vec2(0.0, 84.0), galley.size() + vec2(28.0, 14.0));
    ui.painter().rect_filled(tag, 15, theme::SCRIM_HOVERED);
    ui.painter().galley(tag.min + vec2(14.0, 7.0), galley, theme::ON_SCRIM);
}

/// A line around the chosen picture while the genome panel is open, and around the one under the pointer.
fn frame(ui: &Ui, model: &Model, slot: &Slot, lively: bool) {
    let color = match (model.panels.genome && model.chosen == slot.view, lively) {
        (true, _) => Palette::of(ui.visuals()).accent,
        (false, true) => Color32::from_white_alpha(110),
        (false, false) => return,
    };
    let corner = theme::RADIUS;
    ui.painter().rect_stroke(slot.rect, corner, Stroke::new(2.0, color), StrokeKind::Inside);
}

fn vote_bar(ui: &mut Ui, model: &Model, view: usize, rect: Rect, lively: bool) {
    let seen = model.views[view].picture.is_some();
    if seen && model.votable && matches!(model.views[view].state, ViewState::Ready) {
        votes::bar(ui, model, view, rect, lively);
    }
}

/// Two pictures of the whole area over each other; the splitter says where one ends and the other begins.
fn compare(ui: &mut Ui, model: &Model, [left, right]: [Slot; 2], split: &mut f32, views: &mut Views) {
    let rect = left.rect;
    let parts = rect.split_left_right_at_fraction(*split);
    let lively = [(0, left, parts.0), (1, right, parts.1)].map(|(side, slot, part)| {
        let response =
            ui.push_id(("side", side), |ui| picture(ui, model, slot.view, rect, part, views)).inner;
        !model.captured && response.contains_pointer()
    });
    let hub_x = hub_place(model, rect.expand(4.0), &[left, right], *split).0.x;
    let half_hub = 0.5 * votes::hub_size(model, 0.5 * rect.width()).0.x + 4.0;
    // Names and votes are on their pictures, however far the splitter is moved.
    for (side, (slot, part)) in [(left, parts.0), (right, parts.1)].into_iter().enumerate() {
        ui.push_id(("half", side), |ui| {
            ui.set_clip_rect(part.intersect(ui.clip_rect()));
            let below = viewport::show(ui, model, slot.view, part, lively[side]);
            viewport::choose_side(ui, model, side, below);
            let mut beside_hub = part;
            match side {
                0 => beside_hub.max.x = part.right().min(hub_x - half_hub),
                _ => beside_hub.min.x = part.left().max(hub_x + half_hub),
            }
            vote_bar(ui, model, slot.view, beside_hub, lively[side]);
        });
    }
    splitter(ui, rect, parts.0.right(), split);
}

fn splitter(ui: &mut Ui, rect: Rect, split_x: f32, split: &mut f32) {
    let grip = Rect::from_center_size(pos2(split_x, rect.center().y), vec2(14.0, rect.height()));
    let response = ui.interact(grip, ui.scope_id().with("splitter"), Sense::drag());
    if let Some(pointer) = response.interact_pointer_pos()
        && response.dragged()
    {
        *split = ((pointer.x - rect.left()) / rect.width()).clamp(0.02, 0.98);
    }
    let (enabled, value) = (ui.is_enabled(), f64::from(*split));
    response.widget_info(|| egui::WidgetInfo::slider(enabled, value, "Splitter"));
    let lit = response.hovered() || response.dragged();
    let line = Stroke::new(if lit { 3.0 } else { 2.0 }, Color32::from_white_alpha(230));
    ui.painter().vline(split_x, rect.y_range(), Stroke::new(line.width + 2.0, Color32::from_black_alpha(90)));
    ui.painter().vline(split_x, rect.y_range(), line);
    let knob = Rect::from_center_size(pos2(split_x, rect.center().y), vec2(22.0, 34.0));
    ui.painter().add(theme::card_shadow().as_shape(knob, 11));
    ui.painter().rect_filled(knob, 11, Color32::WHITE);
    for offset in [-3.0, 3.0] {
        let groove = Stroke::new(1.5, Color32::from_gray(90));
        ui.painter().vline(split_x + offset, knob.y_range().shrink(11.0), groove);
    }
    response.on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
}
