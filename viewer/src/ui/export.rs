//! The export card: which landscape is written as files for other programs, for whom, in which form and where; how far
//! that is, and what can be done with the files.

use egui::{Align2, Area, Id, Margin, Rect, RichText, TextEdit, Ui, vec2};

use super::icon::Icon;
use super::model::{ExportModel, Model, ViewState};
use super::theme::{self, Palette};
use super::widgets::{
    Asks, ask, close_button, primary_button, progress_bar, scrolled, segmented, small, switch,
};
use crate::event::{Event, Panel};
use crate::export_choice::{Audience, Form};

/// Width of the card, in points.
const WIDTH: f32 = 330.0;
const NUMBERS: [&str; 4] = ["1", "2", "3", "4"];

/// Draws the card at the upper right of `area`.
pub fn show(ui: &mut Ui, model: &Model, area: Rect) {
    let width = WIDTH.min(area.width() - 24.0);
    Area::new(Id::unique("export"))
        .pivot(Align2::RIGHT_TOP)
        .fixed_pos(area.right_top() + vec2(-12.0, 12.0))
        .constrain_to(area)
        .accessible_name("Export as files")
        .show(ui.ctx(), |ui| {
            let margin = Margin { left: 14, right: 8, top: 8, bottom: 10 };
            theme::card(Palette::of(ui.visuals())).inner_margin(margin).show(ui, |ui| {
                ui.set_width(width - 22.0);
                ui.horizontal(|ui| {
                    ui.label(RichText::new("Export as files").heading());
                    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                        close_button(ui, "Close the export", Panel::Export);
                    });
                });
                scrolled(ui, (area.height() - 80.0).min(400.0), |ui| {
                    ui.set_width(ui.available_width() - 10.0);
                    landscape(ui, model);
                    choice(ui, &model.export);
                    write(ui, model);
                    written(ui, &model.export);
                });
            });
        });
}

fn landscape(ui: &mut Ui, model: &Model) {
    let mut chosen = model.chosen;
    if model.count > 1 {
        let numbers: Vec<_> = NUMBERS[..model.count].iter().enumerate().map(|(at, n)| (at, *n, "")).collect();
        segmented(ui, "Landscape to export", &numbers, &mut chosen);
    }
    if chosen != model.chosen {
        ask(ui, Event::Choose(chosen));
    }
    ui.label(&model.views[model.chosen].name);
    ui.add_space(4.0);
}

fn choice(ui: &mut Ui, export: &ExportModel) {
    let mut choice = export.choice.clone();
    let mut audience = choice.audience;
    let audiences = [
        (Audience::Viewers, "Any program", "three.js, Babylon.js, F3D, engines: whatever shows glTF files"),
        (Audience::Blender, "Blender", "With a script that sets up camera, sun, sky and haze in Blender"),
    ];
    segmented(ui, "Export for", &audiences, &mut audience);
    if audience != choice.audience {
        choice = choice.made_for(audience);
    }
    let forms = [
        (Form::File, "One file", "A self-contained .glb, to send along"),
        (Form::Folder, "Folder", "The landscape, its sky, and each kind of its trees by itself"),
    ];
    segmented(ui, "Export as", &forms, &mut choice.form);
    let help = "Viewers frame the whole file, and see little of a landscape with 10 km around it";
    switch(ui, &mut choice.apron, "Land up to the horizon", help);
    ui.add_space(4.0);
    small(ui, "Into the folder");
    ui.horizontal(|ui| {
        let field = TextEdit::singleline(&mut choice.folder).hint_text(&export.default_folder);
        let _ =
            ui.add(field.desired_width(ui.available_width() - 84.0)).accessible_name("Folder to export into");
        ui.button("Choose…").asks(Event::ChooseExportFolder);
    });
    if choice != export.choice {
        ask(ui, Event::ExportChoice(choice));
    }
}

fn write(ui: &mut Ui, model: &Model) {
    ui.add_space(8.0);
    let hindrance = hindrance(model);
    let button = |ui: &mut Ui| primary_button(ui, "Export", Icon::Export);
    let response = ui.add_enabled_ui(hindrance.is_none(), button).inner;
    response.asks(Event::Export(model.chosen));
    response.on_disabled_hover_text(hindrance.unwrap_or_default());
    if let Some((done, files)) = model.export.progress {
        let palette = Palette::of(ui.visuals());
        let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 6.0), egui::Sense::hover());
        progress_bar(ui.painter(), rect, done as f32 / files.max(1) as f32, palette.accent, palette.button);
        small(ui, format!("Writing: {done} of {files} files"));
    }
}

/// Why the chosen landscape cannot be exported now.
fn hindrance(model: &Model) -> Option<String> {
    if model.export.progress.is_some() {
        return Some("Wait until the export that is on its way is done".to_owned());
    }
    let ready = matches!(model.views[model.chosen].state, ViewState::Ready);
    (!ready).then(|| format!("Landscape {} is not there yet", model.chosen + 1))
}

/// What the last export has written, and what to do with it.
fn written(ui: &mut Ui, export: &ExportModel) {
    let Some(written) = &export.written else { return };
    ui.add_space(4.0);
    ui.label(written);
    ui.horizontal(|ui| {
        ui.button("Show in folder").asks(Event::ShowExported);
        let copy = ui.button("Copy");
        copy.asks(Event::CopyExported);
        copy.on_hover_text("Copies the files: Ctrl+V in a folder puts them there");
    });
}
