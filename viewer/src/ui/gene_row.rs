//! One gene of the genome panel: name, value that can be typed, lock, reset, and a slider over the gene's codes (so it
//! snaps by itself, and is linear or logarithmic as declared), with marks where the other landscapes stand.

use egui::{Align, Align2, Color32, FontId, Layout, Rect, Response, RichText, Sense, Stroke, Ui};
use egui::{pos2, vec2};
use genescape_schema::Parameter;

use super::icon::Icon;
use super::model::Genes;
use super::theme::Palette;
use super::widgets::{Asks, ask, sized_icon_button, small};
use crate::event::Event;

/// What is being dragged or typed just now; the model hears of it by events only.
#[derive(Clone, Debug, Default)]
pub struct State {
    /// Landscape, gene and code under the pointer.
    dragged: Option<(usize, String, u32)>,
    /// Landscape, gene and text as it stands in the field.
    typed: Option<(usize, String, String)>,
}

/// One gene of one landscape.
struct Row<'a> {
    genes: &'a Genes,
    individual: usize,
    parameter: &'a Parameter,
    locked: bool,
    /// Under the pointer while it is dragged, else the landscape's own.
    code: u32,
    bred: u32,
}

/// Draws the row of one gene of landscape `individual`.
pub fn show(ui: &mut Ui, genes: &Genes, individual: usize, parameter: &Parameter, state: &mut State) {
    let locked = genes.is_locked(parameter);
    let code = match &state.dragged {
        Some((of, name, code)) if *of == individual && *name == parameter.name && !locked => *code,
        _ => genes.now[individual].code(parameter),
    };
    let bred = genes.bred[individual].code(parameter);
    let row = Row { genes, individual, parameter, locked, code, bred };
    ui.push_id((individual, &parameter.name), |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        ui.horizontal(|ui| {
            ui.set_min_height(24.0);
            row.name(ui);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                ui.spacing_mut().item_spacing.x = 2.0;
                row.lock(ui);
                row.reset(ui);
                row.value(ui, state);
            });
        });
        row.slider(ui, state);
    });
}

impl Row<'_> {
    fn event(&self, code: u32) -> Event {
        let (name, value) = (self.parameter.name.clone(), self.parameter.value(code));
        Event::Genes { individual: self.individual, values: vec![(name, value)] }
    }

    fn name(&self, ui: &mut Ui) {
        let (parameter, palette) = (self.parameter, Palette::of(ui.visuals()));
        let text = RichText::new(spoken(parameter)).color(palette.text);
        let label = egui::Label::new(text).truncate().sense(Sense::hover());
        let room = (ui.available_width() - 170.0).max(40.0);
        let response = ui
            .scope(|ui| {
                ui.set_max_width(room);
                ui.add(label)
            })
            .inner;
        if self.code != self.bred {
            let dot = pos2(response.rect.left() - 6.0, response.rect.center().y);
            ui.painter().circle_filled(dot, 2.5, palette.category(parameter.category));
        }
        response.on_hover_ui(|ui| {
            ui.set_max_width(300.0);
            ui.label(&parameter.help);
            let scale = parameter.scale.name();
            let text = format!("{} · {} · {scale}", parameter.name, parameter.range_text());
            small(ui, text);
            if let Some(taught) = self.genes.taught.get(&parameter.name) {
                ui.label(taught);
            }
        });
    }

    fn lock(&self, ui: &mut Ui) {
        let (name, locked) = (&self.parameter.name, self.locked);
        let by_category = self.genes.locked_categories[self.parameter.category as usize];
        let (icon, verb) = if locked { (Icon::Locked, "Unlock") } else { (Icon::Unlocked, "Lock") };
        ui.scope(|ui| {
            if !locked {
                ui.multiply_opacity(0.5);
            }
            let button = |ui: &mut Ui| sized_icon_button(ui, icon, &format!("{verb} {name}"), locked, 24.0);
            let response = ui.add_enabled_ui(!by_category, button).inner;
            response.asks(Event::LockGene { name: name.clone(), locked: !locked });
            if by_category {
                response.on_disabled_hover_text("Locked with its whole category");
            }
        });
    }

    fn reset(&self, ui: &mut Ui) {
        if self.code == self.bred {
            return ui.add_space(26.0);
        }
        let Parameter { name, unit, .. } = self.parameter;
        let label = format!("Reset {name} to {} {unit}", self.parameter.text(self.bred));
        let button = |ui: &mut Ui| sized_icon_button(ui, Icon::Reset, label.trim_end(), false, 24.0);
        ui.add_enabled_ui(!self.locked, button).inner.asks(self.event(self.bred));
    }

    /// The value as text, with its unit behind it; Enter or leaving the field takes what was typed.
    fn value(&self, ui: &mut Ui, state: &mut State) {
        let (individual, parameter, palette) = (self.individual, self.parameter, Palette::of(ui.visuals()));
        let (rect, _) = ui.allocate_exact_size(vec2(30.0, 22.0), Sense::hover());
        let unit = if parameter.unit == "deg" { "°" } else { &parameter.unit };
        let font = FontId::proportional(12.0);
        ui.painter().text(rect.left_center(), Align2::LEFT_CENTER, unit, font, palette.weak);
        let mine = |(of, name, _): &&(usize, String, String)| *of == individual && *name == parameter.name;
        let typed = state.typed.as_ref().filter(mine).map(|(_, _, text)| text.clone());
        let mine = typed.is_some();
        let mut text = typed.unwrap_or_else(|| parameter.text(self.code));
        let understood = parse(&text, parameter).is_some();
        let field = egui::TextEdit::singleline(&mut text)
            .id(ui.scope_id().with("value"))
            .font(egui::TextStyle::Body)
            .margin(egui::Margin::symmetric(5, 2))
            .align(Align2::RIGHT_CENTER)
            .text_color(if understood { palette.text } else { palette.danger })
            .background_color(if mine { palette.sunken } else { Color32::TRANSPARENT })
            .frame(egui::Frame::NONE)
            .desired_width(58.0);
        let response = ui.add_enabled(!self.locked, field);
        let response = response.accessible_name(format!("Value of {}", parameter.name));
        if response.has_focus() {
            state.typed = Some((individual, parameter.name.clone(), text));
        } else if mine {
            state.typed = None;
            let given_up = ui.input(|input| input.key_pressed(egui::Key::Escape));
            let typed = parse(&text, parameter).map(|value| parameter.snap(value));
            if let Some(typed) = typed.filter(|&typed| typed != self.code && !self.locked && !given_up) {
                ask(ui, self.event(typed));
            }
        }
        response.on_hover_text(format!("Type a value: {}", parameter.range_text()));
    }

    fn slider(&self, ui: &mut Ui, state: &mut State) {
        let (parameter, mut chosen) = (self.parameter, self.code);
        let palette = Palette::of(ui.visuals());
        let color = palette.category(parameter.category);
        let response = ui
            .add_enabled_ui(!self.locked, |ui| {
                ui.spacing_mut().slider_width = ui.available_width();
                ui.spacing_mut().interact_size.y = 20.0;
                let visuals = ui.visuals_mut();
                visuals.selection.bg_fill = color.gamma_multiply(0.75);
                let widgets = &mut visuals.widgets;
                widgets.inactive.bg_fill = palette.button;
                for state in [&mut widgets.inactive, &mut widgets.hovered, &mut widgets.active] {
                    state.fg_stroke = Stroke::new(2.0, color);
                    state.bg_stroke = Stroke::new(2.0, color);
                    state.corner_radius = 2.into();
                }
                let range = 0..=parameter.last_code();
                ui.add(egui::Slider::new(&mut chosen, range).show_value(false).smart_aim(false))
            })
            .inner
            .accessible_name(parameter.name.clone());
        self.marks(ui, &response);
        if self.locked {
            return;
        }
        let moving = response.dragged() || response.is_pointer_button_down_on();
        if response.drag_stopped() {
            // A press that moved nothing asks for nothing.
            if state.dragged.take().is_some() || chosen != self.code {
                ask(ui, self.event(chosen));
            }
        } else if chosen != self.code {
            // While it moves only the panel shows it; it is written when it is let go.
            state.dragged = moving.then(|| (self.individual, parameter.name.clone(), chosen));
            if !moving {
                ask(ui, self.event(chosen));
            }
        }
    }

    /// Ticks under the rail where the other three landscapes stand.
    fn marks(&self, ui: &Ui, response: &Response) {
        let palette = Palette::of(ui.visuals());
        let rail = response.rect.x_range().shrink(response.rect.height() / 2.5);
        let codes = self.genes.now.each_ref().map(|genome| genome.code(self.parameter));
        for (view, &code) in codes.iter().enumerate().filter(|&(_, &code)| code != codes[self.individual]) {
            let part = code as f32 / self.parameter.last_code() as f32;
            let at = pos2(egui::lerp(rail, part), response.rect.center().y + 4.0);
            let tick = Rect::from_min_max(at - vec2(0.75, 0.0), at + vec2(0.75, 5.0));
            ui.painter().rect_filled(tick, 0, palette.weak);
            if response.hovered() || response.dragged() {
                let (place, font) = (at + vec2(0.0, 4.0), FontId::proportional(9.0));
                ui.painter().text(place, Align2::CENTER_TOP, view + 1, font, palette.weak);
            }
        }
    }
}

/// A gene's name for people: without the unit, with spaces.
pub fn spoken(parameter: &Parameter) -> String {
    let units = ["_m", "_deg", "_per_ha", "_ev", "_px", "_s"];
    let name = parameter.name.as_str();
    let stem = units.iter().find_map(|unit| name.strip_suffix(unit)).unwrap_or(name).replace('_', " ");
    let mut letters = stem.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// A number in range, with or without the unit; comma or point.
fn parse(text: &str, parameter: &Parameter) -> Option<f64> {
    let text = text.trim();
    let number = text.strip_suffix(parameter.unit.as_str()).unwrap_or(text).trim().replace(',', ".");
    number.parse().ok().filter(|&value| parameter.contains(value))
}

/// Whether a gene is meant by what was typed into the search field.
pub fn matches(parameter: &Parameter, search: &str) -> bool {
    let haystack = format!("{} {} {} {}", parameter.name, spoken(parameter), parameter.help, parameter.unit);
    let haystack = haystack.to_lowercase();
    search.to_lowercase().split_whitespace().all(|word| haystack.contains(word))
}
