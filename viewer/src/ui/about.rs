//! What a person wants to know of a file that is shown alone, at the right of the window, where a world has its genes.

use egui::{Frame, Margin, RichText, ScrollArea, Ui};

use super::bake_log;
use super::icon::Icon;
use super::model::{FileShown, Model};
use super::stats::thousands;
use super::theme::Palette;
use super::widgets::{close_button, ends, section};
use crate::event::Panel;

/// Width of the panel, in points.
const WIDTH: f32 = 300.0;

/// Draws it at the right of `ui`.
pub fn show(ui: &mut Ui, model: &Model, file: &FileShown) {
    let palette = Palette::of(ui.visuals());
    let frame =
        Frame::NONE.fill(palette.panel).inner_margin(Margin { left: 14, right: 6, top: 4, bottom: 8 });
    let width = WIDTH.min((ui.available_width() * 0.5).max(200.0));
    egui::Panel::right("about the file")
        .exact_size(width)
        .resizable(false)
        .frame(frame)
        .show_separator_line(false)
        .show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.set_min_height(34.0);
                let name = RichText::new(&file.name).heading();
                let close = |ui: &mut Ui| close_button(ui, "Close what is known of the file", Panel::Genome);
                ends(ui, |ui| ui.add(egui::Label::new(name).truncate()).on_hover_text(&file.name), close);
            });
            ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
                ui.set_width(ui.available_width() - 10.0);
                bake_log::errors(ui, &model.errors);
                facts(ui, file);
                notes(ui, &file.facts.notes);
            });
        });
}

fn facts(ui: &mut Ui, file: &FileShown) {
    let facts = &file.facts;
    section(ui, "SIZE");
    for (axis, length_m) in ["Width", "Height", "Depth"].into_iter().zip(file.size_m) {
        line(ui, axis, &length(length_m));
    }
    line(ui, "A square of the grid", &length(file.cell_m));
    section(ui, "WHAT IT HOLDS");
    let count = |number: usize| thousands(number as u64);
    line(ui, "Triangles", &thousands(facts.triangles));
    line(ui, "Vertices", &count(facts.vertices));
    line(ui, "Meshes", &count(facts.meshes));
    line(ui, "Copies in the scene", &count(facts.copies));
    line(ui, "Materials", &count(facts.materials));
    line(ui, "Pictures", &count(facts.pictures));
    section(ui, "LEVELS OF DETAIL");
    line(ui, "Levels", &if facts.levels > 1 { count(facts.levels) } else { "none".to_owned() });
    if let Some(source) = facts.level_source {
        line(ui, "As", source);
    }
}

fn line(ui: &mut Ui, name: &str, value: &str) {
    let name = RichText::new(name).color(Palette::of(ui.visuals()).weak);
    ui.horizontal(|ui| ends(ui, |ui| ui.label(name), |ui| _ = ui.label(value)));
}

fn notes(ui: &mut Ui, notes: &[String]) {
    if notes.is_empty() {
        return;
    }
    section(ui, "DRAWN DIFFERENTLY");
    let color = Palette::of(ui.visuals()).warning;
    for note in notes {
        ui.horizontal_top(|ui| {
            Icon::Warning.show(ui, 14.0, 20.0, color);
            ui.add(egui::Label::new(note).wrap());
        });
    }
}

/// "12.3 m", "4.56 mm": three digits, in a unit that suits them.
pub fn length(length_m: f32) -> String {
    let units = [(1000.0, "km"), (1.0, "m"), (0.01, "cm"), (0.001, "mm"), (1e-6, "µm")];
    let (unit_m, name) = units.into_iter().find(|(unit_m, _)| length_m >= *unit_m).unwrap_or(units[4]);
    let value = length_m / unit_m;
    let digits = [2, 1, 0][usize::from(value >= 9.995) + usize::from(value >= 99.95)];
    let text = format!("{value:.digits$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("{text} {name}")
}

#[cfg(test)]
mod tests {
    use super::length;

    #[test]
    fn lengths_have_three_digits_and_a_unit() {
        let cases = [
            (0.0, "0 µm"),
            (0.000_012, "12 µm"),
            (0.0123, "1.23 cm"),
            (0.1, "10 cm"),
            (1.0, "1 m"),
            (9.996, "10 m"),
            (123.4, "123 m"),
            (20_480.0, "20.5 km"),
        ];
        for (length_m, text) in cases {
            assert_eq!(length(length_m), text);
        }
    }
}
