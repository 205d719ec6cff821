//! The family tree at the left: favourites, then a row for each generation with its four landscapes, lines from parents to
//! children, branches beside them. A click goes there.

use std::ops::Range;

use egui::{
    Align2, Color32, FontId, Frame, Margin, Painter, Pos2, Rect, RichText, ScrollArea, Sense, Shape, Stroke,
};
use egui::{StrokeKind, Ui, epaint::CubicBezierShape, pos2, vec2};
use genescape_schema::lanes::{self, Line, Row};
use genescape_schema::{Category, INDIVIDUALS, Strategy};

use super::icon::Icon;
use super::model::{Kin, Model};
use super::theme::{self, Palette};
use super::widgets::{Asks, ask, close_button, ends, painted_button, section, sized_icon_button};
use crate::event::{Event, Panel};

/// Width of the panel at first, in points.
const WIDTH: f32 = 330.0;
/// From lane to lane, of a generation's heading, of the lines above its landscapes, and between rows, in points.
const LANE: f32 = 12.0;
const HEADING: f32 = 18.0;
const LINES: f32 = 20.0;
const GAP: f32 = 6.0;
/// Between two landscapes, in points; a thumbnail's height over its width.
const BETWEEN: f32 = 5.0;
const ASPECT: f32 = 0.625;
/// Lanes that are drawn at most.
const MAX_LANES: usize = 6;

/// What the panel remembers.
#[derive(Clone, Debug, Default)]
pub struct State {
    /// What was typed into the search field.
    pub search: String,
    /// The generation that was last scrolled to.
    seen: Option<u32>,
}

/// Draws it at the left of `ui`.
pub fn show(ui: &mut Ui, model: &Model, state: &mut State) {
    let palette = Palette::of(ui.visuals());
    let frame =
        Frame::NONE.fill(palette.panel).inner_margin(Margin { left: 12, right: 6, top: 4, bottom: 8 });
    let widest = (ui.available_width() * 0.4).max(200.0);
    egui::Panel::left("family")
        .default_size(WIDTH.min(widest))
        .size_range(200.0f32.min(widest)..=widest.min(520.0))
        .frame(frame)
        .show_separator_line(false)
        .show(ui, |ui| {
            header(ui, state);
            favourites(ui, model);
            tree(ui, model, state);
        });
}

fn header(ui: &mut Ui, state: &mut State) {
    ui.horizontal(|ui| {
        ui.set_min_height(34.0);
        ends(
            ui,
            |ui| ui.add(egui::Label::new(RichText::new("Family tree").heading()).truncate()),
            |ui| close_button(ui, "Close the family tree", Panel::Family),
        );
    });
    let field = egui::TextEdit::singleline(&mut state.search)
        .hint_text("Search names")
        .margin(Margin::symmetric(8, 4))
        .desired_width(ui.available_width() - 24.0);
    let _ = ui.add(field).accessible_name("Search names");
}

fn favourites(ui: &mut Ui, model: &Model) {
    if model.favourites.is_empty() {
        return;
    }
    section(ui, "Favourites");
    let rows = model.favourites.len().min(4) as f32;
    ScrollArea::vertical().id_salt("favourites").max_height(30.0 * rows).show(ui, |ui| {
        ui.set_width(ui.available_width() - 10.0);
        model.favourites.iter().for_each(|&place| favourite(ui, model, place));
    });
}

/// Goes there by its name, or breeds with one part of it.
fn favourite(ui: &mut Ui, model: &Model, (generation, landscape): (u32, usize)) {
    let number = format!("{generation}.{}", landscape + 1);
    let kin = model.family.iter().find(|kin| kin.generation == generation);
    let name = kin.map_or("", |kin| kin.names[landscape].as_str());
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        let label = format!("Take the star from {number}");
        let star = Event::Star { generation, landscape, starred: false };
        sized_icon_button(ui, Icon::Star, &label, true, 24.0).asks(star);
        ends(
            ui,
            |ui| {
                let text = RichText::new(format!("{number}  {name}"));
                let button = egui::Button::new(text).frame(false).truncate();
                ui.add(button).on_hover_text(name).asks(Event::GoToGeneration(generation));
            },
            |ui| {
                for category in Category::ALL.into_iter().rev() {
                    let part = theme::title(category).to_lowercase();
                    let label = format!("Breed with the {part} of {number}");
                    let button =
                        |ui: &mut Ui| sized_icon_button(ui, Icon::from(category), &label, false, 24.0);
                    let free = model.baking.is_none() && kin.is_some();
                    let event = Event::BreedFrom { generation, landscape, category };
                    ui.add_enabled_ui(free, button).inner.asks(event);
                }
            },
        );
    });
}

fn tree(ui: &mut Ui, model: &Model, state: &mut State) {
    section(ui, "Generations");
    let words: Vec<String> = state.search.to_lowercase().split_whitespace().map(str::to_owned).collect();
    let numbers: Vec<(u32, Option<u32>)> =
        model.family.iter().map(|kin| (kin.generation, kin.bred_from.last().copied())).collect();
    let rows = lanes::rows(&numbers);
    let lanes = rows.iter().map(|row| row.lane + 1).max().unwrap_or(1).min(MAX_LANES);
    let shown: Vec<usize> = (0..rows.len())
        .filter(|at| (0..INDIVIDUALS).any(|one| is_found(&model.family[*at], one, &words)))
        .collect();
    let gutter = LANE * lanes as f32 + 4.0;
    let width = ui.available_width() - 10.0;
    let cell = ((width - gutter - 3.0 * BETWEEN) / INDIVIDUALS as f32).max(10.0);
    let height = HEADING + LINES + cell * ASPECT + GAP;
    ui.spacing_mut().item_spacing.y = 0.0;
    let mut area = ScrollArea::vertical().id_salt("generations of the family").auto_shrink([false, false]);
    if state.seen != Some(model.generation)
        && let Some(at) = shown.iter().position(|at| model.family[*at].generation == model.generation)
    {
        state.seen = Some(model.generation);
        area = area.vertical_scroll_offset((at as f32 * height - 0.5 * ui.available_height()).max(0.0));
    }
    area.show_rows(ui, height, shown.len(), |ui, visible: Range<usize>| {
        for place in visible {
            let at = shown[place];
            let (rect, _) = ui.allocate_exact_size(vec2(width, height), Sense::hover());
            // What stands above is the row before only where nothing was left out between.
            let above = place.checked_sub(1).map(|before| model.family[shown[before]].generation);
            let one = Generation { model, kin: &model.family[at], above, words: &words, gutter, cell };
            lines_beside(ui.painter(), Palette::of(ui.visuals()), rect, &rows[at]);
            one.show(ui, rect);
        }
    });
    if shown.is_empty() {
        ui.weak("No name matches.");
    }
}

fn is_found(kin: &Kin, landscape: usize, words: &[String]) -> bool {
    let name = kin.names[landscape].to_lowercase();
    words.iter().all(|word| name.contains(word.as_str()))
}

/// The branches that lead to this generation, from it and past it.
fn lines_beside(painter: &Painter, palette: &Palette, rect: Rect, row: &Row) {
    let x = |lane: usize| rect.left() + LANE * (lane.min(MAX_LANES - 1) as f32 + 0.5);
    let dot = pos2(x(row.lane), rect.top() + 0.5 * HEADING);
    let stroke = Stroke::new(1.5, palette.weak);
    for line in &row.lines {
        let (from, to) = match *line {
            Line::Past(lane) => (pos2(x(lane), rect.top()), pos2(x(lane), rect.bottom())),
            Line::In => (pos2(dot.x, rect.top()), dot),
            Line::Out => (dot, pos2(dot.x, rect.bottom())),
            Line::Branch(lane) => (dot, pos2(x(lane), rect.bottom())),
        };
        painter.line_segment([from, to], stroke);
    }
    painter.circle(dot, 3.5, palette.panel, Stroke::new(1.5, palette.text));
}

/// One row.
struct Generation<'a> {
    model: &'a Model,
    kin: &'a Kin,
    /// The generation in the row above.
    above: Option<u32>,
    words: &'a [String],
    gutter: f32,
    /// Width of a landscape, in points.
    cell: f32,
}

impl Generation<'_> {
    fn show(&self, ui: &mut Ui, rect: Rect) {
        let (kin, palette) = (self.kin, Palette::of(ui.visuals()));
        let current = kin.generation == self.model.generation;
        let color = if current { palette.text } else { palette.weak };
        let mut text = format!("Generation {}", kin.generation);
        // That it was bred from the row above is what one takes for granted.
        if !kin.bred_from.is_empty() && kin.bred_from != Vec::from_iter(self.above) {
            let generations: Vec<String> = kin.bred_from.iter().map(u32::to_string).collect();
            text = format!("{text}, bred from {}", generations.join(" and "));
        }
        if kin.strategy == Strategy::Classic {
            text.push_str(", as in the thesis");
        }
        let at = pos2(rect.left() + self.gutter, rect.top() + 0.5 * HEADING);
        ui.painter().text(at, Align2::LEFT_CENTER, text, FontId::proportional(12.0), color);
        let top = rect.top() + HEADING + LINES;
        let cells: [Rect; INDIVIDUALS] = std::array::from_fn(|one| {
            let left = rect.left() + self.gutter + one as f32 * (self.cell + BETWEEN);
            Rect::from_min_size(pos2(left, top), vec2(self.cell, self.cell * ASPECT))
        });
        for (child, parents) in kin.parents.iter().enumerate() {
            for category in Category::ALL {
                for parent in &parents[category as usize] {
                    descent(ui.painter(), palette, category, cells[parent - 1], cells[child]);
                }
            }
        }
        cells.into_iter().enumerate().for_each(|(one, cell)| self.landscape(ui, one, cell, current));
    }

    fn landscape(&self, ui: &mut Ui, one: usize, cell: Rect, current: bool) {
        let (kin, palette) = (self.kin, Palette::of(ui.visuals()));
        let generation = kin.generation;
        let number = format!("{generation}.{}", one + 1);
        let label = format!("Landscape {number}: {}", kin.names[one]);
        let (response, lit) = painted_button(ui, cell, ("kin", generation, one), &label, current);
        let fade = if is_found(kin, one, self.words) { 1.0 } else { 0.25 };
        let painter = ui.painter();
        match self.model.thumbnails.get(&(generation, one)) {
            Some(texture) => {
                let uv = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
                painter.image(*texture, cell, uv, Color32::WHITE.gamma_multiply(fade));
            }
            None => {
                painter.rect_filled(cell, 4, palette.sunken);
                let color = palette.weak.gamma_multiply(fade);
                painter.text(
                    cell.center(),
                    Align2::CENTER_CENTER,
                    one + 1,
                    FontId::proportional(13.0),
                    color,
                );
            }
        }
        let line = match (lit, current) {
            (true, _) => Stroke::new(1.5, palette.text),
            (false, true) => Stroke::new(1.5, palette.accent),
            (false, false) => Stroke::new(1.0, palette.line),
        };
        painter.rect(cell, 4, Color32::TRANSPARENT, line, StrokeKind::Inside);
        self.won(painter, one, cell);
        if self.model.favourites.contains(&(generation, one)) {
            Icon::Star.paint_at(painter, cell.left_top() + vec2(8.0, 8.0), 10.0, theme::DARK.accent);
        }
        if response.clicked() {
            ask(ui, Event::Choose(one));
            if !current {
                ask(ui, Event::GoToGeneration(generation));
            }
        }
        let descent = &kin.descents[one];
        let text = [&format!("{number}  {}", kin.names[one]), descent];
        response.on_hover_text(text.map(String::as_str).join("\n").trim_end());
    }

    /// A dot for each category that a landscape has the best of.
    fn won(&self, painter: &Painter, one: usize, cell: Rect) {
        let Some(votes) = self.kin.votes else { return };
        let won = Category::ALL.into_iter().filter(|category| votes.favourite(*category) == Some(one));
        for (place, category) in won.enumerate() {
            let at = cell.right_bottom() - vec2(7.0 + 10.0 * place as f32, 7.0);
            painter.circle(
                at,
                4.0,
                theme::bright(category),
                Stroke::new(1.0, Color32::from_black_alpha(120)),
            );
        }
    }
}

/// A line from where a parent stands in the row above to its child.
fn descent(painter: &Painter, palette: &Palette, category: Category, parent: Rect, child: Rect) {
    let aside = 4.0 * (category as usize as f32 - 1.0);
    let (from, to) = (parent.center().x + aside, child.center().x + aside);
    let (top, bottom) = (child.top() - LINES, child.top());
    let middle = 0.5 * (top + bottom);
    let points = [pos2(from, top), pos2(from, middle), pos2(to, middle), pos2(to, bottom)];
    let stroke = Stroke::new(1.5, palette.category(category));
    painter.add(Shape::CubicBezier(CubicBezierShape::from_points_stroke(
        points,
        false,
        Color32::TRANSPARENT,
        stroke,
    )));
}
