//! The settings: what is drawn and how, and how the program feels in the hand. Each change is one event with the whole
//! new value.

use egui::{
    Align2, Area, CornerRadius, Frame, Id, Margin, Order, Rect, RichText, ScrollArea, Slider, Ui, vec2,
};

use super::icon::Icon;
use super::model::Model;
use super::theme::{self, Palette};
use super::widgets::{icon_button, section, segmented, switch};
use crate::event::{Comfort, Event, Panel, Theme};
use crate::frame::Options;
use crate::lod_mode::LodMode;

/// Width of the card, in points.
const WIDTH: f32 = 330.0;

/// Draws the card at the upper right of `area`.
pub fn show(ui: &mut Ui, model: &Model, area: Rect, events: &mut Vec<Event>) {
    let width = WIDTH.min(area.width() - 24.0);
    Area::new(Id::unique("settings"))
        .order(Order::Middle)
        .pivot(Align2::RIGHT_TOP)
        .fixed_pos(area.right_top() + vec2(-12.0, 12.0))
        .constrain_to(area)
        .accessible_name("Settings")
        .show(ui.ctx(), |ui| {
            let palette = Palette::of(ui.visuals());
            let frame = Frame::NONE
                .fill(palette.raised)
                .corner_radius(CornerRadius::same(10))
                .shadow(theme::card_shadow())
                .inner_margin(Margin { left: 14, right: 8, top: 8, bottom: 10 });
            frame.show(ui, |ui| {
                ui.set_width(width - 22.0);
                header(ui, events);
                let room = area.height() - 80.0;
                ScrollArea::vertical()
                    .max_height(room)
                    .min_scrolled_height(room)
                    .auto_shrink([false, true])
                    .show(ui, |ui| {
                        ui.set_width(ui.available_width() - 10.0);
                        options(ui, &model.options, events);
                        comfort(ui, &model.comfort, events);
                    });
            });
        });
}

fn header(ui: &mut Ui, events: &mut Vec<Event>) {
    ui.horizontal(|ui| {
        ui.label(RichText::new("Settings").heading());
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if icon_button(ui, Icon::Close, "Close the settings", false).clicked() {
                events.push(Event::Panel { panel: Panel::Settings, open: false });
            }
            if icon_button(ui, Icon::Reset, "Reset all settings", false).clicked() {
                events.push(Event::ResetSettings);
            }
        });
    });
}

/// A choice for each LOD mode.
fn modes<M: LodMode>() -> Vec<(M, &'static str, &'static str)> {
    M::VARIANTS.iter().map(|&mode| (mode, mode.label(), mode.help())).collect()
}

fn options(ui: &mut Ui, current: &Options, events: &mut Vec<Event>) {
    let mut options = *current;
    section(ui, "LEVELS OF DETAIL");
    ui.label("Trees");
    if let Some(mode) = segmented(ui, "Tree detail", &modes(), options.tree_lod) {
        options.tree_lod = mode;
    }
    number(ui, &mut options.tree_error_px, 0.1..=16.0, "Error allowed on trees", " px", true);
    ui.label("Terrain");
    if let Some(mode) = segmented(ui, "Terrain detail", &modes(), options.terrain_lod) {
        options.terrain_lod = mode;
    }
    number(ui, &mut options.terrain_error_px, 0.1..=16.0, "Error allowed on terrain", " px", true);
    switch(ui, &mut options.tint_levels, "Colour by level", "Colours say the level of detail");
    switch(ui, &mut options.wireframe, "Wireframe", "Edges of triangles only");
    switch(
        ui,
        &mut options.overhead,
        "From above",
        "The land from above, with the detail chosen for your place",
    );
    section(ui, "PICTURE");
    switch(ui, &mut options.draw_trees, "Trees", "");
    switch(ui, &mut options.draw_terrain, "Terrain", "");
    switch(
        ui,
        &mut options.grass,
        "Grass",
        "Blades around you; a tenth to a quarter of the time where the processor draws",
    );
    switch(ui, &mut options.drift_clouds, "Clouds drift", "");
    number(ui, &mut options.exposure, 0.125..=8.0, "Exposure", " ×", true);
    number(ui, &mut options.fov_y_deg, 20.0..=110.0, "Field of view", "°", false);
    let samples = [(1, "1", "Fastest"), (4, "4", "Smooth edges")];
    ui.label("Samples a pixel");
    if let Some(count) = segmented(ui, "Samples a pixel", &samples, options.samples) {
        options.samples = count;
    }
    if options != *current {
        events.push(Event::Options(options));
    }
}

fn comfort(ui: &mut Ui, current: &Comfort, events: &mut Vec<Event>) {
    let mut comfort = *current;
    section(ui, "HANDLING");
    number(ui, &mut comfort.mouse_sensitivity, 0.1..=5.0, "Mouse sensitivity", " ×", true);
    switch(ui, &mut comfort.invert_y, "Invert up and down", "Mouse up looks down");
    section(ui, "APPEARANCE");
    let themes = [(Theme::System, "System", ""), (Theme::Light, "Light", ""), (Theme::Dark, "Dark", "")];
    if let Some(theme) = segmented(ui, "Theme", &themes, comfort.theme) {
        comfort.theme = theme;
    }
    ui.label("Scale of the interface");
    let scales =
        [(0.8, "80 %", ""), (1.0, "100 %", ""), (1.25, "125 %", ""), (1.5, "150 %", ""), (2.0, "200 %", "")];
    if let Some(scale) = segmented(ui, "Scale", &scales, comfort.ui_scale) {
        comfort.ui_scale = scale;
    }
    if comfort != *current {
        events.push(Event::Comfort(comfort));
    }
}

/// A slider with its name above and its value behind.
fn number(
    ui: &mut Ui,
    value: &mut f32,
    range: std::ops::RangeInclusive<f32>,
    name: &str,
    unit: &str,
    logarithmic: bool,
) {
    ui.label(RichText::new(name).small());
    ui.spacing_mut().slider_width = ui.available_width() - 84.0;
    let slider = Slider::new(value, range).logarithmic(logarithmic).suffix(unit.to_owned()).max_decimals(2);
    let _ = ui.add(slider).accessible_name(name);
}
