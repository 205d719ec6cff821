//! What the last bake reused and what it built and why; and the full text of what is wrong with the person's files.

use egui::{CollapsingHeader, Frame, Label, Margin, RichText, ScrollArea, Sense, Stroke, Ui, vec2};

use super::icon::Icon;
use super::model::{FileError, StageEntry};
use super::report::{self, Part};
use super::theme::{self, Palette};
use super::widgets::{Asks, ends, section, sized_icon_button, small};
use crate::event::Event;

/// Stages of the last bake; nothing if there was none.
pub fn show(ui: &mut Ui, log: &[StageEntry]) {
    if log.is_empty() {
        return;
    }
    ui.add_space(10.0);
    section(ui, "LAST BAKE");
    let text = RichText::new(summary(log)).color(Palette::of(ui.visuals()).text);
    CollapsingHeader::new(text).id_salt("last bake").default_open(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 3.0;
        for entry in log {
            row(ui, entry);
        }
    });
}

/// In one line: how many stages were reused, how many built, and how long that took.
pub fn summary(log: &[StageEntry]) -> String {
    let reused = log.iter().filter(|entry| entry.reused).count();
    let ms: f64 = log.iter().map(|entry| entry.ms).sum();
    format!("{reused} reused, {} built, {}", log.len() - reused, duration(ms))
}

/// Milliseconds for people: `4 ms`, `2.1 s`.
fn duration(ms: f64) -> String {
    if ms < 1000.0 { format!("{ms:.0} ms") } else { format!("{:.1} s", ms / 1000.0) }
}

fn row(ui: &mut Ui, entry: &StageEntry) {
    let palette = Palette::of(ui.visuals());
    ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(vec2(10.0, 18.0), Sense::hover());
        let color = if entry.reused { palette.line } else { palette.accent };
        ui.painter().circle_filled(rect.center(), 3.5, color);
        let scene = entry.scene.map_or(String::new(), |scene| format!("{} ", scene + 1));
        let name = RichText::new(format!("{scene}{}", entry.stage)).color(palette.text);
        let word = if entry.reused { "reused".to_owned() } else { duration(entry.ms) };
        ends(ui, |ui| ui.add(Label::new(name).truncate()), |ui| small(ui, word));
    });
    if !entry.reused && !entry.why.is_empty() {
        ui.horizontal(|ui| {
            ui.add_space(18.0);
            ui.add(Label::new(RichText::new(&entry.why).small().color(palette.weak)).wrap());
        });
    }
}

/// The faults of the person's files, in full.
pub fn errors(ui: &mut Ui, errors: &[FileError]) {
    for (index, error) in errors.iter().enumerate() {
        let palette = Palette::of(ui.visuals());
        let line = Stroke::new(1.0, palette.danger.gamma_multiply(0.6));
        let frame = Frame::NONE
            .fill(palette.sunken)
            .stroke(line)
            .corner_radius(theme::RADIUS)
            .inner_margin(Margin::same(8))
            .outer_margin(Margin { top: 4, bottom: 4, left: 0, right: 0 });
        frame.show(ui, |ui| {
            ui.set_width(ui.available_width());
            ui.push_id(("error", index), |ui| one(ui, index, error));
        });
    }
}

fn one(ui: &mut Ui, index: usize, error: &FileError) {
    let palette = Palette::of(ui.visuals());
    ui.horizontal(|ui| {
        Icon::Warning.show(ui, 16.0, 24.0, palette.danger);
        let title = Label::new(RichText::new(&error.title).strong()).truncate();
        ends(
            ui,
            |ui| ui.add(title),
            |ui| {
                ui.spacing_mut().item_spacing.x = 2.0;
                let label = |verb: &str| format!("{verb}: {}", error.title);
                sized_icon_button(ui, Icon::Close, &label("Dismiss"), false, 24.0)
                    .asks(Event::DismissError(index));
                if sized_icon_button(ui, Icon::Copy, &label("Copy"), false, 24.0).clicked() {
                    ui.copy_text(error.report.clone());
                }
            },
        );
    });
    ScrollArea::vertical().id_salt("report").max_height(260.0).auto_shrink([false, true]).show(ui, |ui| {
        for (index, part) in report::parts(&error.report).into_iter().enumerate() {
            ui.push_id(index, |ui| report_part(ui, part));
        }
    });
    ui.label(RichText::new("The last good landscapes stay. Save the file again when it is mended.").small());
}

fn report_part(ui: &mut Ui, part: Part) {
    let color = Palette::of(ui.visuals()).text;
    match part {
        Part::Sentence(text) => {
            ui.add(Label::new(RichText::new(text).color(color)).wrap().selectable(true));
        }
        Part::Excerpt(text) => {
            let text = Label::new(RichText::new(text).monospace().color(color)).extend().selectable(true);
            ScrollArea::horizontal().auto_shrink([false, true]).show(ui, |ui| ui.add(text));
            ui.add_space(4.0);
        }
    }
}
