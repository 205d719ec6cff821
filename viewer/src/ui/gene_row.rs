//! One gene of the genome panel: name, value that can be typed, lock, reset, and a slider over the gene's codes (so it
//! snaps by itself, and is linear or logarithmic as declared), with marks where the other landscapes stand.

use egui::{
    Align, Align2, Color32, CornerRadius, FontId, Layout, Rect, Response, Sense, Stroke, Ui, pos2, vec2,
};
use genescape_schema::{Category, Genome, INDIVIDUALS, Parameter};

use super::icon::Icon;
use super::model::Genes;
use super::theme::Palette;
use super::widgets::sized_icon_button;
use crate::event::Event;

/// What is being dragged or typed just now; the model hears of it by events only.
#[derive(Clone, Debug, Default)]
pub struct State {
    /// Landscape, gene and code under the pointer.
    dragged: Option<(usize, String, u32)>,
    /// Landscape, gene and text as it stands in the field.
    typed: Option<(usize, String, String)>,
}

/// Draws the row of one gene of landscape `individual`.
pub fn show(
    ui: &mut Ui,
    genes: &Genes,
    individual: usize,
    parameter: &Parameter,
    state: &mut State,
    events: &mut Vec<Event>,
) {
    let locked = genes.is_locked(parameter);
    let code = match &state.dragged {
        Some((of, name, code)) if *of == individual && *name == parameter.name && !locked => *code,
        _ => genes.now[individual].code(parameter),
    };
    let bred = genes.bred[individual].code(parameter);
    ui.push_id((individual, &parameter.name), |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        ui.horizontal(|ui| {
            ui.set_min_height(24.0);
            name(ui, parameter, code != bred);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                ui.spacing_mut().item_spacing.x = 2.0;
                lock(ui, genes, parameter, events);
                match code != bred {
                    true => reset(ui, individual, parameter, bred, locked, events),
                    false => ui.add_space(26.0),
                }
                value(ui, individual, parameter, code, locked, state, events);
            });
        });
        let others = genes.now.each_ref().map(|genome| genome.code(parameter));
        slider(ui, individual, parameter, code, others, locked, state, events);
    });
}

/// A gene's name for people: without the unit, with spaces.
pub fn spoken(parameter: &Parameter) -> String {
    let units = ["_m", "_deg", "_per_ha", "_ev", "_px", "_s"];
    let name = parameter.name.as_str();
    let stem = units.iter().find_map(|unit| name.strip_suffix(unit)).unwrap_or(name).replace('_', " ");
    let mut letters = stem.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// Whether the four landscapes do not agree on a gene.
pub fn differs(genomes: &[Genome; INDIVIDUALS], parameter: &Parameter) -> bool {
    genomes.iter().any(|genome| genome.code(parameter) != genomes[0].code(parameter))
}

fn name(ui: &mut Ui, parameter: &Parameter, changed: bool) {
    let palette = Palette::of(ui.visuals());
    let text = egui::RichText::new(spoken(parameter)).color(palette.text);
    let label = egui::Label::new(text).truncate().sense(Sense::hover());
    let room = (ui.available_width() - 170.0).max(40.0);
    let response = ui
        .scope(|ui| {
            ui.set_max_width(room);
            ui.add(label)
        })
        .inner;
    if changed {
        let dot = pos2(response.rect.left() - 6.0, response.rect.center().y);
        ui.painter().circle_filled(dot, 2.5, palette.category(parameter.category));
    }
    response.on_hover_ui(|ui| {
        ui.set_max_width(300.0);
        ui.label(&parameter.help);
        let scale = parameter.scale.name();
        let text = format!("{} · {} · {scale}", parameter.name, parameter.range_text());
        ui.label(egui::RichText::new(text).small().color(Palette::of(ui.visuals()).weak));
    });
}

fn lock(ui: &mut Ui, genes: &Genes, parameter: &Parameter, events: &mut Vec<Event>) {
    let by_category = genes.locked_categories[parameter.category as usize];
    let locked = genes.is_locked(parameter);
    let (icon, verb) = if locked { (Icon::Locked, "Unlock") } else { (Icon::Unlocked, "Lock") };
    let label = format!("{verb} {}", parameter.name);
    ui.scope(|ui| {
        if !locked {
            ui.multiply_opacity(0.5);
        }
        let response =
            ui.add_enabled_ui(!by_category, |ui| sized_icon_button(ui, icon, &label, locked, 24.0)).inner;
        if response.clicked() {
            events.push(Event::LockGene { name: parameter.name.clone(), locked: !locked });
        }
        if by_category {
            response.on_disabled_hover_text("Locked with its whole category");
        }
    });
}

fn reset(
    ui: &mut Ui,
    individual: usize,
    parameter: &Parameter,
    bred: u32,
    locked: bool,
    events: &mut Vec<Event>,
) {
    let label = format!("Reset {} to {} {}", parameter.name, parameter.text(bred), parameter.unit);
    let response =
        ui.add_enabled_ui(!locked, |ui| sized_icon_button(ui, Icon::Reset, label.trim_end(), false, 24.0));
    if response.inner.clicked() {
        events.push(gene(individual, parameter, bred));
    }
}

fn gene(individual: usize, parameter: &Parameter, code: u32) -> Event {
    Event::Genes { individual, values: vec![(parameter.name.clone(), parameter.value(code))] }
}

/// The value as text, with its unit behind it; Enter or leaving the field takes what was typed.
fn value(
    ui: &mut Ui,
    individual: usize,
    parameter: &Parameter,
    code: u32,
    locked: bool,
    state: &mut State,
    events: &mut Vec<Event>,
) {
    let palette = Palette::of(ui.visuals());
    let (rect, _) = ui.allocate_exact_size(vec2(30.0, 22.0), Sense::hover());
    let unit = if parameter.unit == "deg" { "°" } else { &parameter.unit };
    ui.painter().text(
        rect.left_center(),
        Align2::LEFT_CENTER,
        unit,
        FontId::proportional(12.0),
        palette.weak,
    );
    let mine = matches!(&state.typed, Some((of, name, _)) if *of == individual && *name == parameter.name);
    let mut text = match &state.typed {
        Some((_, _, text)) if mine => text.clone(),
        _ => parameter.text(code),
    };
    let understood = parse(&text, parameter).is_some();
    let field = egui::TextEdit::singleline(&mut text)
        .id(ui.scope_id().with("value"))
        .font(egui::TextStyle::Body)
        .margin(egui::Margin::symmetric(5, 2))
        .align(egui::Align2::RIGHT_CENTER)
        .text_color(if understood { palette.text } else { palette.danger })
        .background_color(if mine { palette.sunken } else { Color32::TRANSPARENT })
        .frame(egui::Frame::NONE)
        .desired_width(58.0);
    let response = ui.add_enabled(!locked, field);
    let response = response.accessible_name(format!("Value of {}", parameter.name));
    if response.has_focus() {
        state.typed = Some((individual, parameter.name.clone(), text));
    } else if mine {
        let typed = parse(&text, parameter).map(|value| parameter.snap(value));
        state.typed = None;
        let given_up = ui.input(|input| input.key_pressed(egui::Key::Escape));
        if let Some(typed) = typed.filter(|&typed| typed != code && !locked && !given_up) {
            events.push(gene(individual, parameter, typed));
        }
    }
    response.on_hover_text(format!("Type a value: {}", parameter.range_text()));
}

/// A number in range, with or without the unit; comma or point.
fn parse(text: &str, parameter: &Parameter) -> Option<f64> {
    let text = text.trim();
    let number = text.strip_suffix(parameter.unit.as_str()).unwrap_or(text).trim().replace(',', ".");
    number.parse().ok().filter(|&value| parameter.contains(value))
}

#[expect(clippy::too_many_arguments, reason = "a row's own values, all small")]
fn slider(
    ui: &mut Ui,
    individual: usize,
    parameter: &Parameter,
    code: u32,
    others: [u32; INDIVIDUALS],
    locked: bool,
    state: &mut State,
    events: &mut Vec<Event>,
) {
    let mut chosen = code;
    let color = Palette::of(ui.visuals()).category(parameter.category);
    let response = ui
        .add_enabled_ui(!locked, |ui| {
            ui.spacing_mut().slider_width = ui.available_width();
            ui.spacing_mut().interact_size.y = 20.0;
            ui.visuals_mut().selection.bg_fill = color.gamma_multiply(0.75);
            let sunken = Palette::of(ui.visuals()).button;
            ui.visuals_mut().widgets.inactive.bg_fill = sunken;
            handle_colors(ui, color);
            let range = 0..=parameter.last_code();
            ui.add(egui::Slider::new(&mut chosen, range).show_value(false).smart_aim(false))
        })
        .inner
        .accessible_name(parameter.name.clone());
    marks(ui, &response, individual, parameter, others);
    if locked {
        return;
    }
    let moving = response.dragged() || response.is_pointer_button_down_on();
    if response.drag_stopped() {
        // A press that moved nothing asks for nothing.
        if state.dragged.take().is_some() || chosen != code {
            events.push(gene(individual, parameter, chosen));
        }
    } else if chosen != code {
        // While it moves only the panel shows it; it is written when it is let go.
        state.dragged = moving.then(|| (individual, parameter.name.clone(), chosen));
        if !moving {
            events.push(gene(individual, parameter, chosen));
        }
    }
}

fn handle_colors(ui: &mut Ui, color: Color32) {
    let widgets = &mut ui.visuals_mut().widgets;
    for state in [&mut widgets.inactive, &mut widgets.hovered, &mut widgets.active] {
        state.fg_stroke = Stroke::new(2.0, color);
        state.bg_stroke = Stroke::new(2.0, color);
        state.corner_radius = CornerRadius::same(2);
    }
}

/// Ticks under the rail where the other three landscapes stand.
fn marks(ui: &Ui, response: &Response, individual: usize, parameter: &Parameter, others: [u32; INDIVIDUALS]) {
    let palette = Palette::of(ui.visuals());
    let radius = response.rect.height() / 2.5;
    let rail = response.rect.x_range().shrink(radius);
    let font = FontId::proportional(9.0);
    let near = response.hovered() || response.dragged();
    for (view, &code) in others.iter().enumerate().filter(|&(view, _)| view != individual) {
        if code == others[individual] {
            continue;
        }
        let part = code as f32 / parameter.last_code() as f32;
        let at = pos2(egui::lerp(rail, part), response.rect.center().y + 4.0);
        let tick = Rect::from_min_max(at - vec2(0.75, 0.0), at + vec2(0.75, 5.0));
        ui.painter().rect_filled(tick, CornerRadius::ZERO, palette.weak);
        if near {
            let place = at + vec2(0.0, 4.0);
            ui.painter().text(place, Align2::CENTER_TOP, view + 1, font.clone(), palette.weak);
        }
    }
}

/// Whether a gene is meant by what was typed into the search field.
pub fn matches(parameter: &Parameter, search: &str) -> bool {
    let haystack = format!("{} {} {} {}", parameter.name, spoken(parameter), parameter.help, parameter.unit);
    let haystack = haystack.to_lowercase();
    search.to_lowercase().split_whitespace().all(|word| haystack.contains(word))
}

/// The genes of a category that are listed.
pub fn listed<'g>(
    genes: &'g Genes,
    category: Category,
    search: &'g str,
    only_different: bool,
) -> impl Iterator<Item = &'g Parameter> {
    genes
        .space
        .category(category)
        .filter(move |parameter| matches(parameter, search))
        .filter(move |parameter| !only_different || differs(&genes.now, parameter))
}
