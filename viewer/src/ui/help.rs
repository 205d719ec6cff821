//! The help: first steps in three lines, and what every key does, as the bindings say it.

use egui::{Align2, Area, Color32, Id, Order, Rect, RichText, Sense, Ui, vec2};

use super::icon::Icon;
use super::model::Model;
use super::theme::{self, Palette};
use super::widgets::{ask, icon_button, key_caps, scrolled};
use crate::event::{Event, Panel};
use crate::input::KeyGroup;

/// What to do first.
const FIRST_STEPS: [(&str, &str); 3] = [
    ("Look", "Walk through all four landscapes at once: W A S D, and drag in a picture to look around."),
    ("Choose", "On the pictures, say which has the best trees, the best terrain, the best sky."),
    ("Breed", "Press “Next generation”: four new landscapes grow from what you chose."),
];

/// What the mouse does in a picture; no binding says it.
fn mouse() -> KeyGroup {
    let lines = [
        ("Drag", "look around"),
        ("Right click", "look around without a button, until Esc"),
        ("Wheel", "speed of a flight; distance of an orbit"),
        ("Double click", "one landscape alone, and back"),
    ];
    let keys = lines.map(|(key, meaning)| (key.replace(' ', "\u{a0}"), meaning.to_owned())).into();
    KeyGroup { title: "Mouse".to_owned(), keys }
}

/// Draws it in the middle of the window, over a veil that closes it.
pub fn show(ui: &mut Ui, model: &Model) {
    let window = ui.ctx().content_rect();
    let mut close = veil(ui, window) || ui.input(|input| input.key_pressed(egui::Key::Escape));
    let columns = if window.width() >= 1200.0 { 3 } else { 1 + usize::from(window.width() >= 900.0) };
    let groups = [vec![mouse()], model.bindings.help()].concat();
    let width = (380.0 * columns as f32 + 40.0).min(window.width() - 32.0);
    Area::new(Id::unique("help"))
        .order(Order::Foreground)
        .pivot(Align2::CENTER_CENTER)
        .fixed_pos(window.center())
        .constrain_to(window.shrink(8.0))
        .accessible_name("Help")
        .show(ui.ctx(), |ui| {
            theme::card(Palette::of(ui.visuals())).corner_radius(12).inner_margin(20).show(ui, |ui| {
                ui.set_width(width - 40.0);
                ui.horizontal(|ui| {
                    ui.label(RichText::new("Find a landscape by choosing").size(21.0));
                    let layout = egui::Layout::right_to_left(egui::Align::Center);
                    let button = |ui: &mut Ui| icon_button(ui, Icon::Close, "Close the help", false);
                    close |= ui.with_layout(layout, button).inner.clicked();
                });
                scrolled(ui, window.height() - 130.0, |ui| {
                    first_steps(ui);
                    ui.add_space(12.0);
                    keys(ui, &groups, columns);
                });
            });
        });
    if close {
        ask(ui, Event::Panel { panel: Panel::Help, open: false });
    }
}

/// Darkens the window; true if it was clicked.
fn veil(ui: &Ui, window: Rect) -> bool {
    let area = Area::new(Id::unique("help veil")).order(Order::Foreground).fixed_pos(window.min);
    area.show(ui.ctx(), |ui| {
        ui.painter().rect_filled(window, 0, Color32::from_black_alpha(120));
        ui.allocate_rect(window, Sense::click()).clicked()
    })
    .inner
}

fn first_steps(ui: &mut Ui) {
    let palette = Palette::of(ui.visuals());
    ui.add_space(6.0);
    for (at, (word, text)) in FIRST_STEPS.into_iter().enumerate() {
        ui.horizontal_top(|ui| {
            let (rect, _) = ui.allocate_exact_size(vec2(24.0, 26.0), Sense::hover());
            ui.painter().circle_filled(rect.center(), 11.0, palette.accent);
            let font = egui::FontId::proportional(13.0);
            ui.painter().text(rect.center(), Align2::CENTER_CENTER, at + 1, font, palette.on_accent);
            ui.vertical(|ui| {
                ui.horizontal_wrapped(|ui| {
                    ui.label(RichText::new(word).strong());
                    ui.label(text);
                });
            });
        });
    }
}

/// The groups, shared out over columns of about equal length.
fn keys(ui: &mut Ui, groups: &[KeyGroup], columns: usize) {
    let all: usize = groups.iter().map(|group| group.keys.len() + 2).sum();
    ui.columns(columns, |uis| {
        let mut before = 0;
        for group in groups {
            let length = group.keys.len() + 2;
            let column = (2 * before + length) * columns / (2 * all);
            key_group(&mut uis[column.min(columns - 1)], group);
            before += length;
        }
    });
}

fn key_group(ui: &mut Ui, group: &KeyGroup) {
    let palette = Palette::of(ui.visuals());
    ui.add_space(8.0);
    ui.label(RichText::new(&group.title).size(15.0).color(palette.accent));
    ui.add_space(2.0);
    ui.spacing_mut().item_spacing.y = 3.0;
    ui.spacing_mut().interact_size.y = 21.0;
    for (keys, meaning) in &group.keys {
        ui.horizontal(|ui| {
            let caps = ui.allocate_ui(vec2(132.0, 22.0), |ui| {
                ui.set_min_width(132.0);
                key_caps(ui, keys);
            });
            let used = caps.response.rect.width();
            ui.add_space((132.0 - used).max(0.0));
            ui.add(egui::Label::new(meaning).wrap());
        });
    }
}
