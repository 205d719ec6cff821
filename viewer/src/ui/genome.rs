//! The genome panel: every gene of the chosen landscape by category, what the last bake reused, and what is wrong with
//! the person's files.

use egui::{Align, Frame, Layout, Margin, Rect, RichText, ScrollArea, Ui, pos2, vec2};
use genescape_schema::{Category, INDIVIDUALS, Parameter};

use super::icon::Icon;
use super::model::{Genes, Model};
use super::theme::{self, Palette};
use super::widgets::{Asks, ask, close_button, ends, painted_button, segmented, sized_icon_button};
use super::{bake_log, gene_row};
use crate::event::{Event, Panel};

/// Width of the panel at first, in points.
const WIDTH: f32 = 340.0;

/// What the panel remembers.
#[derive(Clone, Debug, Default)]
pub struct State {
    /// What was typed into the search field.
    pub search: String,
    /// Only genes in which the four differ.
    pub only_different: bool,
    /// Categories whose genes are not listed.
    pub folded: [bool; 3],
    /// What is being dragged or typed.
    pub row: gene_row::State,
}

/// Draws it at the right of `ui`.
pub fn show(ui: &mut Ui, model: &Model, state: &mut State) {
    let palette = Palette::of(ui.visuals());
    let frame =
        Frame::NONE.fill(palette.panel).inner_margin(Margin { left: 14, right: 6, top: 4, bottom: 8 });
    let widest = (ui.available_width() * 0.5).max(240.0);
    egui::Panel::right("genome")
        .default_size(WIDTH.min(widest))
        .size_range(240.0f32.min(widest)..=widest.min(560.0))
        .frame(frame)
        .show_separator_line(false)
        .show(ui, |ui| {
            header(ui, model);
            ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
                // Room for the scroll bar, so that it never lies on the locks.
                ui.set_width(ui.available_width() - 10.0);
                bake_log::errors(ui, &model.errors);
                match &model.genes {
                    Some(genes) => body(ui, genes, model.chosen.min(INDIVIDUALS - 1), state),
                    None => {
                        ui.add_space(20.0);
                        ui.weak("Genes appear here as soon as a world is read.");
                    }
                }
                bake_log::show(ui, &model.bake_log);
                ui.add_space(12.0);
            });
        });
}

fn header(ui: &mut Ui, model: &Model) {
    let chosen = model.chosen.min(INDIVIDUALS - 1);
    ui.horizontal(|ui| {
        ui.set_min_height(34.0);
        ends(
            ui,
            |ui| ui.add(egui::Label::new(RichText::new(&model.views[chosen].name).heading()).truncate()),
            |ui| close_button(ui, "Close the genes", Panel::Genome),
        );
    });
    ui.scope(|ui| {
        ui.set_width(ui.available_width() - 10.0);
        let names = ["1", "2", "3", "4"];
        let choices: [(usize, &str, &str); INDIVIDUALS] =
            std::array::from_fn(|view| (view, names[view], model.views[view].name.as_str()));
        let mut view = model.chosen;
        segmented(ui, "Genes of", &choices, &mut view);
        if view != model.chosen {
            ask(ui, Event::Choose(view));
        }
    });
    ui.add_space(4.0);
}

fn body(ui: &mut Ui, genes: &Genes, individual: usize, state: &mut State) {
    search(ui, state);
    let mut none = true;
    for category in Category::ALL {
        let is_listed = |gene: &&Parameter| {
            gene_row::matches(gene, &state.search) && (!state.only_different || genes.differ(gene))
        };
        let listed: Vec<&Parameter> = genes.space.category(category).filter(is_listed).collect();
        if listed.is_empty() {
            continue;
        }
        none = false;
        category_head(ui, genes, individual, category, state);
        if !state.folded[category as usize] || !state.search.is_empty() {
            for parameter in listed {
                gene_row::show(ui, genes, individual, parameter, &mut state.row);
            }
        }
    }
    if none {
        ui.add_space(12.0);
        ui.weak(match state.only_different {
            true => "No gene that matches differs between the four.",
            false => "No gene matches.",
        });
    }
}

fn search(ui: &mut Ui, state: &mut State) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let width = ui.available_width() - 96.0;
        let field = egui::TextEdit::singleline(&mut state.search)
            .hint_text("Search genes")
            .margin(Margin::symmetric(8, 4))
            .desired_width(width);
        let _ = ui.add(field).accessible_name("Search genes");
        let palette = Palette::of(ui.visuals());
        let on = state.only_different;
        let text = RichText::new("differing").color(if on { palette.on_accent } else { palette.text });
        let fill = if on { palette.accent } else { palette.button };
        let button = ui.add_sized([92.0, 26.0], egui::Button::new(text).fill(fill));
        if button.on_hover_text("Only genes in which the four landscapes differ").clicked() {
            state.only_different = !on;
        }
    });
}

fn category_head(ui: &mut Ui, genes: &Genes, individual: usize, category: Category, state: &mut State) {
    let palette = Palette::of(ui.visuals());
    let (color, title) = (palette.category(category), theme::title(category));
    ui.add_space(10.0);
    let (_, rect) = ui.allocate_space(vec2(ui.available_width(), 30.0));
    let fold = Rect::from_min_max(rect.min, pos2(rect.right() - 62.0, rect.bottom()));
    let folded = &mut state.folded[category as usize];
    let (response, _) = painted_button(ui, fold, ("fold", category.name()), title, !*folded);
    *folded ^= response.clicked();
    let fill = if response.hovered() { palette.hovered } else { color.gamma_multiply(0.16) };
    ui.painter().rect_filled(rect, theme::RADIUS, fill);
    Icon::from(category).paint_at(ui.painter(), rect.left_center() + vec2(18.0, 0.0), 17.0, color);
    let (at, font) = (rect.left_center() + vec2(34.0, 0.0), egui::FontId::proportional(15.0));
    ui.painter().text(at, egui::Align2::LEFT_CENTER, title, font, palette.text);
    let layout = Layout::right_to_left(Align::Center);
    let mut corner = ui.new_child(egui::UiBuilder::new().max_rect(rect.shrink(2.0)).layout(layout));
    corner.spacing_mut().item_spacing.x = 2.0;
    let locked = genes.locked_categories[category as usize];
    let (icon, verb) = if locked { (Icon::Locked, "Unlock all") } else { (Icon::Unlocked, "Lock all") };
    let label = format!("{verb}: {}", title.to_lowercase());
    sized_icon_button(&mut corner, icon, &label, locked, 26.0)
        .asks(Event::LockCategory { category, locked: !locked });
    reset_category(&mut corner, genes, individual, category);
}

fn reset_category(ui: &mut Ui, genes: &Genes, individual: usize, category: Category) {
    let (now, bred) = (&genes.now[individual], &genes.bred[individual]);
    let changed: Vec<_> =
        genes.space.category(category).filter(|gene| now.code(gene) != bred.code(gene)).collect();
    if changed.is_empty() {
        return;
    }
    let label = format!("Reset {} to how it was bred", theme::title(category).to_lowercase());
    if sized_icon_button(ui, Icon::Reset, &label, false, 26.0).clicked() {
        let free = changed.iter().filter(|gene| !genes.is_locked(gene));
        let values = free.map(|gene| (gene.name.clone(), gene.value(bred.code(gene)))).collect();
        ask(ui, Event::Genes { individual, values });
    }
    let text = RichText::new(format!("{} changed", changed.len())).small();
    ui.add(egui::Label::new(text.color(Palette::of(ui.visuals()).weak)).selectable(false));
}
