//! The settings: what is drawn and how, and how the program handles. Each change is one event with the whole
//! new value.

use std::ops::RangeInclusive;

use egui::{Align2, Area, Id, Margin, Rect, RichText, Slider, Ui, vec2};

use super::icon::Icon;
use super::model::Model;
use super::theme::{self, Palette};
use super::widgets::{Asks, ask, close_button, icon_button, scrolled, section, segmented, switch};
use crate::event::{Event, Panel};
use crate::lod_mode::LodMode;
use crate::options::{FILE_SWITCHES, LOD_SWITCHES, Options, PICTURE_SWITCHES, Switch};
use crate::settings::{Comfort, Theme};

/// Width of the card, in points.
const WIDTH: f32 = 330.0;

/// Draws the card at the upper right of `area`.
pub fn show(ui: &mut Ui, model: &Model, area: Rect) {
    let width = WIDTH.min(area.width() - 24.0);
    Area::new(Id::unique("settings"))
        .pivot(Align2::RIGHT_TOP)
        .fixed_pos(area.right_top() + vec2(-12.0, 12.0))
        .constrain_to(area)
        .accessible_name("Settings")
        .show(ui.ctx(), |ui| {
            let margin = Margin { left: 14, right: 8, top: 8, bottom: 10 };
            theme::card(Palette::of(ui.visuals())).inner_margin(margin).show(ui, |ui| {
                ui.set_width(width - 22.0);
                ui.horizontal(header);
                scrolled(ui, area.height() - 80.0, |ui| {
                    ui.set_width(ui.available_width() - 10.0);
                    comfort(ui, &model.comfort);
                    options(ui, &model.options, model.file.is_some());
                });
            });
        });
}

fn header(ui: &mut Ui) {
    ui.label(RichText::new("Settings").heading());
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
        close_button(ui, "Close the settings", Panel::Settings);
        icon_button(ui, Icon::Reset, "Reset all settings", false).asks(Event::ResetSettings);
    });
}

/// A choice for each LOD mode.
fn modes<M: LodMode>() -> Vec<(M, &'static str, &'static str)> {
    M::VARIANTS.iter().map(|&mode| (mode, mode.label(), mode.help())).collect()
}

fn switches(ui: &mut Ui, all: &[Switch], options: &mut Options) {
    for (name, help, value) in all {
        switch(ui, value(options), name, help);
    }
}

fn options(ui: &mut Ui, current: &Options, of_file: bool) {
    let mut options = *current;
    section(ui, "PICTURE");
    switches(ui, if of_file { &FILE_SWITCHES } else { &PICTURE_SWITCHES[..] }, &mut options);
    number(ui, &mut options.exposure, 0.125..=8.0, "Exposure", " ×");
    number(ui, &mut options.fov_y_deg, 20.0..=110.0, "Field of view", "°");
    ui.label("Resolution while moving");
    let parts = [
        (None, "Auto", "As fine as 15 frames a second allow"),
        (Some(1.0), "Full", "As sharp as at rest"),
        (Some(0.75), "75 %", "Three quarters of the sides"),
        (Some(0.5), "50 %", "Half of the sides"),
    ];
    segmented(ui, "Resolution while moving", &parts, &mut options.moving_resolution);
    ui.label("Samples a pixel");
    let samples = [(1, "1", "Fastest"), (4, "4", "Smooth edges")];
    segmented(ui, "Samples a pixel", &samples, &mut options.samples);
    section(ui, "LEVELS OF DETAIL");
    let (what, error) =
        if of_file { ("Meshes", "Error allowed") } else { ("Trees", "Error allowed on trees") };
    ui.label(what);
    let (name, mode, error_px) = match of_file {
        true => ("Mesh detail", &mut options.mesh_lod, &mut options.mesh_error_px),
        false => ("Tree detail", &mut options.tree_lod, &mut options.tree_error_px),
    };
    segmented(ui, name, &modes(), mode);
    number(ui, error_px, 0.1..=16.0, error, " px");
    if !of_file {
        ui.label("Terrain");
        segmented(ui, "Terrain detail", &modes(), &mut options.terrain_lod);
        number(ui, &mut options.terrain_error_px, 0.1..=16.0, "Error allowed on terrain", " px");
    }
    switches(ui, &LOD_SWITCHES, &mut options);
    if options != *current {
        ask(ui, Event::Options(options));
    }
}

fn comfort(ui: &mut Ui, current: &Comfort) {
    let mut comfort = *current;
    section(ui, "APPEARANCE");
    let themes = [(Theme::System, "System", ""), (Theme::Light, "Light", ""), (Theme::Dark, "Dark", "")];
    segmented(ui, "Theme", &themes, &mut comfort.theme);
    ui.label("Scale of the interface");
    let scales =
        [(0.8, "80 %", ""), (1.0, "100 %", ""), (1.25, "125 %", ""), (1.5, "150 %", ""), (2.0, "200 %", "")];
    segmented(ui, "Scale", &scales, &mut comfort.ui_scale);
    section(ui, "HANDLING");
    number(ui, &mut comfort.mouse_sensitivity, 0.1..=5.0, "Mouse sensitivity", " ×");
    switch(ui, &mut comfort.invert_y, "Invert up and down", "Mouse up looks down");
    let help = "Otherwise each new generation is entered at its first view, as by Home";
    switch(ui, &mut comfort.stay, "Stay where you are in a new generation", help);
    if comfort != *current {
        ask(ui, Event::Comfort(comfort));
    }
}

/// A slider with its name above and its value behind; logarithmic if it spans more than a power of ten.
fn number(ui: &mut Ui, value: &mut f32, range: RangeInclusive<f32>, name: &str, unit: &str) {
    ui.label(RichText::new(name).small());
    ui.spacing_mut().slider_width = ui.available_width() - 84.0;
    let logarithmic = range.end() / range.start() > 10.0;
    let slider = Slider::new(value, range).logarithmic(logarithmic).suffix(unit.to_owned()).max_decimals(2);
    let _ = ui.add(slider).accessible_name(name);
}
