//! The slim bar on top: the line of generations, undo and the next generation at the left; progress in the middle;
//! arrangement, screenshot and panels at the right.

use egui::text::{LayoutJob, TextFormat};
use egui::{Align, Frame, Id, Layout, Margin, Rect, Response, Sense, Stroke, TextStyle, Ui, vec2};
use genescape_schema::{Category, Parent, Variety};

use super::icon::Icon;
use super::model::{Baking, Model};
use super::theme::{self, Palette};
use super::votes;
use super::widgets::{
    Asks, ICON_BUTTON, ask, bar_button, flat_button, icon_button, primary_button, progress_bar,
};
use crate::event::{Arrangement, Event, Panel};
use crate::input::Command;

/// Height of the bar, in points.
const HEIGHT: f32 = 40.0;
/// Width of the slider for variety, in points.
const VARIETY: f32 = 84.0;
/// A window narrower than this gets no words in the bar, in points.
const WORDS_FROM: f32 = 940.0;

/// Draws it across the top of `ui`.
pub fn show(ui: &mut Ui, model: &Model) {
    let palette = Palette::of(ui.visuals());
    let frame = Frame::NONE.fill(palette.panel).inner_margin(Margin::symmetric(8, 0));
    egui::Panel::top("top bar").exact_size(HEIGHT).frame(frame).show_separator_line(false).show(ui, |ui| {
        let words = ui.available_width() >= WORDS_FROM;
        ui.spacing_mut().item_spacing.x = 4.0;
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            panels(ui, model);
            arrangements(ui, model);
            ui.add_space(4.0);
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                if model.votable {
                    generations(ui, model, words);
                } else if model.studied {
                    ui.add_space(6.0);
                    let text = model.with_key("Answer when you have seen enough", Command::Questions);
                    primary_button(ui, &text, Icon::Next).asks(Command::Questions);
                } else if model.count == 1 {
                    let name = model.file.as_ref().map_or(&model.views[0].name, |file| &file.name);
                    ui.add_space(6.0);
                    ui.add(egui::Label::new(egui::RichText::new(name).strong()).truncate());
                }
            });
        });
    });
}

fn panels(ui: &mut Ui, model: &Model) {
    let known = if model.file.is_some() { "About this file" } else { "Genes" };
    let all = [
        (Panel::Help, Icon::Help, "Help and keys", Command::Help),
        (Panel::Settings, Icon::Settings, "Settings", Command::Settings),
        (Panel::Stats, Icon::Stats, "Frame times", Command::Stats),
        (Panel::Genome, Icon::Genome, known, Command::Genome),
        (Panel::Family, Icon::Family, "Family tree", Command::Family),
    ];
    let all = all.into_iter().filter(|(panel, ..)| match panel {
        Panel::Help => true,
        Panel::Family => model.votable,
        _ => !model.studied,
    });
    for (panel, icon, label, command) in all {
        let open = model.panels.is_open(panel);
        let response = bar_button(ui, icon, label, open, &model.with_key(label, command));
        if panel == Panel::Genome && !model.errors.is_empty() {
            let center = response.rect.right_top() + vec2(-6.0, 6.0);
            ui.painter().circle_filled(center, 4.0, Palette::of(ui.visuals()).danger);
        }
        response.asks(Event::Panel { panel, open: !open });
    }
    divider(ui);
    let label = "Save a screenshot";
    bar_button(ui, Icon::Camera, label, false, &model.with_key(label, Command::Screenshot))
        .asks(Command::Screenshot);
}

fn arrangements(ui: &mut Ui, model: &Model) {
    if model.count < 2 {
        return;
    }
    divider(ui);
    let (left, right) = (model.chosen, (model.chosen + 1) % model.count);
    let one = Command::Maximise(model.chosen as u8 + 1);
    let all = [
        (Arrangement::Compare { left, right }, Icon::Compare, "Compare two", Command::Compare),
        (Arrangement::One(model.chosen), Icon::Single, "One alone", one),
        (Arrangement::Grid, Icon::Grid, "All four", Command::ShowAll),
    ];
    for (arrangement, icon, label, command) in all {
        let same = std::mem::discriminant(&arrangement) == std::mem::discriminant(&model.arrangement);
        if bar_button(ui, icon, label, same, &model.with_key(label, command)).clicked() && !same {
            ask(ui, Event::Arrange(arrangement));
        }
    }
}

fn divider(ui: &mut Ui) {
    let (rect, _) = ui.allocate_exact_size(vec2(9.0, 18.0), Sense::hover());
    let line = Stroke::new(1.0, Palette::of(ui.visuals()).line);
    ui.painter().vline(rect.center().x, rect.y_range(), line);
}

fn generations(ui: &mut Ui, model: &Model, words: bool) {
    step(ui, model, Icon::Undo, "Undo", model.undo.as_deref(), Command::Undo);
    if model.redo.is_some() {
        step(ui, model, Icon::Redo, "Redo", model.redo.as_deref(), Command::Redo);
    }
    divider(ui);
    let way_on = if words { 330.0 + VARIETY } else { 36.0 };
    strip(ui, model, (ui.available_width() - way_on).max(40.0));
    next(ui, model, words);
    if words {
        variety(ui, model);
    }
    if words && let Some(baking) = &model.baking {
        ui.add_space(6.0);
        let (Baking { generation, done, total }, part) = (baking, baking.part());
        let (rect, response) = ui.allocate_exact_size(vec2(90.0, 18.0), Sense::hover());
        let bar = Rect::from_center_size(rect.center(), vec2(90.0, 5.0));
        let palette = Palette::of(ui.visuals());
        progress_bar(ui.painter(), bar, part, palette.accent, palette.button);
        response.on_hover_text(format!("Growing generation {generation}: {done} of {total} stages"));
        ui.small(format!("g{generation} {}%", (part * 100.0) as u32));
    }
}

/// Takes a step back or does it again; `what` says which, `None` that there is none.
fn step(ui: &mut Ui, model: &Model, icon: Icon, verb: &str, what: Option<&str>, command: Command) {
    let label = match what {
        Some(what) => format!("{verb}: {what}"),
        None => format!("Nothing to {}", verb.to_lowercase()),
    };
    let tooltip = model.with_key(&label, command);
    let button = |ui: &mut Ui| bar_button(ui, icon, &label, false, &tooltip);
    ui.add_enabled_ui(what.is_some(), button).inner.asks(command);
}

/// The line of generations, the newest at the right; scrolls when it is longer than `room`, to the one on show when that
/// is another.
fn strip(ui: &mut Ui, model: &Model, room: f32) {
    let wanted = model.generations.len() as f32 * 44.0;
    let size = vec2(room.min(wanted.max(40.0)), ICON_BUTTON);
    ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
        let area = egui::ScrollArea::horizontal()
            .id_salt("generations")
            .scroll_bar_visibility(egui::scroll_area::ScrollBarVisibility::AlwaysHidden)
            .max_width(size.x)
            .auto_shrink([true, true]);
        area.show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 2.0;
                let now = (model.generation, model.generations.len());
                let seen = ui.data_mut(|data| {
                    data.get_temp_mut_or_insert_with(Id::unique("seen generation"), || None).replace(now)
                });
                for &generation in &model.generations {
                    let tab = generation_tab(ui, model, generation);
                    if generation == model.generation && seen != Some(now) {
                        tab.scroll_to_me(Some(Align::Center));
                    }
                }
            });
        });
    });
}

fn generation_tab(ui: &mut Ui, model: &Model, generation: u32) -> Response {
    let palette = Palette::of(ui.visuals());
    let current = generation == model.generation;
    let color = if current { palette.text } else { palette.weak };
    let format = |style: TextStyle, color| TextFormat::simple(style.resolve(ui.style()), color);
    let mut job = LayoutJob::default();
    job.append(&format!("g{generation}"), 0.0, format(TextStyle::Button, color));
    // A branch: it does not descend from the one before it.
    let parent = model.parents.get(&generation);
    if let Some(parent) = parent.filter(|parent| parent.generation + 1 != generation) {
        job.append(&format!("‹{}", parent.generation), 2.0, format(TextStyle::Small, palette.weak));
    }
    let galley = ui.painter().layout_job(job);
    let size = vec2(galley.size().x + 16.0, ICON_BUTTON);
    let (rect, response) = flat_button(ui, size, &format!("Generation {generation}"), current);
    ui.painter().galley(rect.center() - 0.5 * galley.size(), galley, color);
    if current {
        let y = rect.bottom() - 2.5;
        ui.painter().hline(rect.x_range().shrink(8.0), y, Stroke::new(2.0, palette.accent));
    }
    if response.clicked() && !current {
        ask(ui, Event::GoToGeneration(generation));
    }
    let first = if current {
        format!("Generation {generation}, shown now")
    } else {
        format!("Go to generation {generation}")
    };
    response.on_hover_text(parent.map_or(first.clone(), |parent| format!("{first}\n{}", descent(parent))))
}

/// "Bred from generation 3: trees of 1, terrain of 2, sky of none".
fn descent(parent: &Parent) -> String {
    let vote = |category: Category| {
        let best = parent.votes.get(category).map_or("none".to_owned(), |best| (best + 1).to_string());
        format!("{} of {best}", theme::title(category).to_lowercase())
    };
    format!("Bred from generation {}: {}", parent.generation, Category::ALL.map(vote).join(", "))
}

fn next(ui: &mut Ui, model: &Model, words: bool) {
    ui.add_space(4.0);
    let hindrance = votes::hindrance(model);
    let response = ui
        .add_enabled_ui(hindrance.is_none(), |ui| match words {
            true => primary_button(ui, "Next generation", Icon::Next),
            false => icon_button(ui, Icon::Next, "Next generation", true),
        })
        .inner;
    response.asks(Command::NextGeneration);
    match hindrance {
        Some(text) => response.on_disabled_hover_text(text),
        None => {
            let text = "Breed four new landscapes from what you chose";
            response.on_hover_text(model.with_key(text, Command::NextGeneration))
        }
    };
}

/// How different the next landscapes are to be. What is dragged is asked for when it is let go.
fn variety(ui: &mut Ui, model: &Model) {
    let id = Id::unique("variety that is dragged");
    let dragged = ui.data(|data| data.get_temp::<f32>(id));
    let mut part = dragged.unwrap_or(model.variety.part());
    ui.add_space(4.0);
    ui.spacing_mut().slider_width = VARIETY - 16.0;
    let slider = egui::Slider::new(&mut part, 0.0..=1.0).show_value(false).step_by(0.05);
    let response = ui.add(slider).accessible_name("Variety");
    if response.dragged() {
        ui.data_mut(|data| data.insert_temp(id, part));
    } else {
        ui.data_mut(|data| data.remove::<f32>(id));
        let wanted = Variety::of(part.into()).filter(|wanted| *wanted != model.variety);
        if let Some(variety) = wanted.filter(|_| response.drag_stopped() || response.changed()) {
            ask(ui, Event::Variety(variety));
        }
    }
    let text = "Variety of the next landscapes: close variations at the left, anything at the right";
    response.on_hover_text(format!("{text}\nNow {}", model.variety));
}
