//! Voting: three buttons on each picture, and the hub between the pictures, which shows how far the vote is and leads
//! to the next generation. Colour says which category; a filled button is a vote that was won here.

use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Sense, Shape, Stroke, StrokeKind, Ui, Vec2};
use egui::{pos2, vec2};
use genescape_schema::Category;

use super::icon::Icon;
use super::model::Model;
use super::theme;
use super::widgets::{Asks, painted_button, progress_ring, tooltip_above};
use crate::ballots::Ballot;
use crate::event::Event;
use crate::input::{Best, Command};

/// Height of a vote button, in points.
const PILL: f32 = 28.0;
/// A picture narrower than this shows pictograms without words, in points.
const WORDS_FROM: f32 = 400.0;
/// A picture narrower than this, beside a splitter, has no vote buttons, in points.
const NARROW: f32 = 122.0;
/// Side of a ballot in the hub, in points.
const CHIP: f32 = 26.0;
/// The hub's shorter side, in points.
const HUB: f32 = 38.0;

/// The vote buttons of one picture, at the lower edge of `within`, if there is room for them; `lively` when the pointer is
/// over the picture.
pub fn bar(ui: &mut Ui, model: &Model, view: usize, within: Rect, lively: bool) {
    if within.width() < NARROW {
        return;
    }
    let words = within.width() >= WORDS_FROM;
    let widths = Category::ALL.map(|category| if words { pill_width(ui, category) } else { 36.0 });
    let total = widths.iter().sum::<f32>() + 12.0;
    let mut x = within.center().x - 0.5 * total;
    let y = within.bottom() - PILL - 10.0;
    shade_bottom(ui.painter(), within, lively);
    for (category, width) in Category::ALL.into_iter().zip(widths) {
        let rect = Rect::from_min_size(pos2(x, y), vec2(width, PILL));
        pill(ui, model, view, category, rect, words);
        x += width + 6.0;
    }
}

/// A gradient under the buttons, stronger under the pointer.
fn shade_bottom(painter: &Painter, within: Rect, lively: bool) {
    let height = 72.0f32.min(within.height());
    let rect = Rect::from_min_max(pos2(within.left(), within.bottom() - height), within.max);
    let dark = Color32::from_black_alpha(if lively { 150 } else { 80 });
    painter.add(Shape::gradient_rect(rect, egui::Direction::TopDown, [Color32::TRANSPARENT, dark]));
}

fn pill_width(ui: &Ui, category: Category) -> f32 {
    let galley = ui.painter().layout_no_wrap(theme::title(category).to_owned(), word_font(), Color32::WHITE);
    galley.size().x + 44.0
}

fn word_font() -> FontId {
    FontId::proportional(14.0)
}

fn pill(ui: &mut Ui, model: &Model, view: usize, category: Category, rect: Rect, words: bool) {
    let (ballot, title) = (model.ballots.get(category), theme::title(category));
    let won = ballot == Ballot::For(view);
    let name = format!("{title}: best in {}", view + 1);
    let (response, lit) = painted_button(ui, rect, ("vote", view, category.name()), &name, won);
    response.asks(Event::Vote { category, ballot: if won { Ballot::Open } else { Ballot::For(view) } });
    let (bright, none, white) = (theme::bright(category), Color32::TRANSPARENT, Color32::from_white_alpha);
    let (fill, line, picture, word) = match (ballot, lit) {
        (_, false) if won => (bright, none, theme::ON_BRIGHT, theme::ON_BRIGHT),
        (_, true) if won => {
            (bright.lerp_to_gamma(Color32::WHITE, 0.25), none, theme::ON_BRIGHT, theme::ON_BRIGHT)
        }
        (_, true) => (theme::SCRIM_HOVERED, bright, bright, theme::ON_SCRIM),
        (Ballot::Open, false) => (theme::SCRIM, none, bright, theme::ON_SCRIM),
        _ => (Color32::from_black_alpha(110), none, white(120), white(150)),
    };
    let painter = ui.painter();
    painter.rect(rect, 14, fill, Stroke::new(1.5, line), StrokeKind::Inside);
    let icon_center = if words { rect.left_center() + vec2(18.0, 0.0) } else { rect.center() };
    Icon::from(category).paint_at(painter, icon_center, 16.0, picture);
    if words {
        let at = rect.left_center() + vec2(32.0, 0.0);
        painter.text(at, Align2::LEFT_CENTER, title, word_font(), word);
    }
    response.on_hover_text(if won {
        format!("{title} is best here. Click to take the vote back.")
    } else {
        let text = format!("Vote: {} has the best {}", view + 1, title.to_lowercase());
        model.with_key(&text, Command::Vote(Best { category, landscape: Some(view as u8 + 1) }))
    });
}

/// Why the next generation cannot be bred now; `None` if it can.
pub fn hindrance(model: &Model) -> Option<String> {
    if let Some(baking) = &model.baking {
        return Some(format!("Wait until generation {} has grown", baking.generation));
    }
    let open = Category::ALL.into_iter().filter(|&category| model.ballots.get(category) == Ballot::Open);
    let names: Vec<String> = open.map(|category| theme::title(category).to_lowercase()).collect();
    (!names.is_empty()).then(|| format!("Still to vote on: {}", names.join(", ")))
}

/// Size of the hub beside pictures of some width, and whether its button has words; it is a column if it is high.
pub fn hub_size(model: &Model, picture_width: f32) -> (Vec2, bool) {
    let hindrance = hindrance(model);
    // Whatever leaves the vote buttons beside it free: a row with words, a row, or a column where pictures are narrow.
    let (words, column) = (picture_width >= 520.0, picture_width < 300.0);
    let way_on = match (&hindrance, &model.baking) {
        (None, _) if words => 164.0,
        (None, _) => 38.0,
        (Some(_), Some(_)) => 34.0,
        (Some(_), None) => 0.0,
    };
    let length = 3.0 * CHIP + 20.0 + way_on;
    (if column { vec2(HUB, length) } else { vec2(length, HUB) }, words)
}

/// The hub between the pictures: three ballots, and the button for the next generation. `anchor` is the middle of its
/// lower edge.
pub fn hub(ui: &mut Ui, model: &Model, anchor: Pos2, picture_width: f32) {
    let (hindrance, (size, words)) = (hindrance(model), hub_size(model, picture_width));
    let step = if size.y > HUB { vec2(0.0, CHIP + 4.0) } else { vec2(CHIP + 4.0, 0.0) };
    let rect = Rect::from_min_size(anchor - vec2(0.5 * size.x, size.y), size);
    // The hub takes clicks itself, so that none falls through to a picture.
    ui.interact(rect, ui.scope_id().with("hub"), Sense::click());
    ui.painter().add(theme::card_shadow().as_shape(rect, 19));
    let line = Stroke::new(1.0, Color32::from_white_alpha(40));
    let fill = Color32::from_rgba_unmultiplied(20, 23, 22, 244);
    ui.painter().rect(rect, 19, fill, line, StrokeKind::Inside);
    let first = Rect::from_min_size(rect.min + vec2(6.0, 6.0), vec2(CHIP, CHIP));
    for (at, category) in Category::ALL.into_iter().enumerate() {
        chip(ui, model, category, first.translate(step * at as f32));
    }
    let rest =
        Rect::from_min_max(first.min + 3.0 * step + step.normalized() * 2.0, rect.max - vec2(6.0, 6.0));
    match (&model.baking, hindrance) {
        (_, None) => next_button(ui, model, rest, words),
        // Without a tooltip: the pointer rests there since it has pressed the button, and it would hide a name.
        (Some(baking), Some(_)) => {
            let rest_color = Color32::from_white_alpha(45);
            progress_ring(ui.painter(), rest.center(), 9.0, baking.part(), DARK_ACCENT, rest_color);
        }
        (None, Some(_)) => {}
    }
}

/// The hub is dark in both themes, as everything that lies on pictures.
const DARK_ACCENT: Color32 = theme::DARK.accent;

fn next_button(ui: &mut Ui, model: &Model, rect: Rect, words: bool) {
    let name = "Next generation (hub)";
    let (response, lit) = painted_button(ui, rect, "next generation", name, false);
    let fill = if lit { DARK_ACCENT.lerp_to_gamma(Color32::WHITE, 0.3) } else { DARK_ACCENT };
    ui.painter().rect_filled(rect, 14, fill);
    let ink = theme::DARK.on_accent;
    let icon_center = if words { pos2(rect.right() - 17.0, rect.center().y) } else { rect.center() };
    Icon::Next.paint_at(ui.painter(), icon_center, 13.0, ink);
    if words {
        let at = pos2(rect.left() + 14.0, rect.center().y);
        ui.painter().text(at, Align2::LEFT_CENTER, "Next generation", word_font(), ink);
    }
    let text = model.with_key("Breed four new landscapes from what you chose", Command::NextGeneration);
    tooltip_above(&response, text);
    response.asks(Command::NextGeneration);
}

/// One category's ballot: who won, or that none pleases; a click says "none", a second takes that back.
fn chip(ui: &mut Ui, model: &Model, category: Category, rect: Rect) {
    let ballot = model.ballots.get(category);
    let title = theme::title(category);
    let (name, none) = (format!("{title}: none of the four"), ballot == Ballot::NoFavourite);
    let (response, lit) = painted_button(ui, rect, ("ballot", category.name()), &name, none);
    response.asks(Event::Vote { category, ballot: if none { Ballot::Open } else { Ballot::NoFavourite } });
    let bright = theme::bright(category);
    let painter = ui.painter();
    let icon_rect = Rect::from_center_size(rect.center(), vec2(14.0, 14.0));
    let line = Stroke::new(1.5, if lit { Color32::WHITE } else { bright.gamma_multiply(0.55) });
    match ballot {
        Ballot::For(best) => {
            painter.circle_filled(rect.center(), 0.5 * CHIP, bright);
            let font = FontId::proportional(15.0);
            painter.text(rect.center(), Align2::CENTER_CENTER, best + 1, font, theme::ON_BRIGHT);
            if lit {
                painter.circle_stroke(rect.center(), 0.5 * CHIP, line);
            }
        }
        Ballot::NoFavourite => {
            painter.circle_filled(rect.center(), 0.5 * CHIP, Color32::from_white_alpha(28));
            Icon::from(category).paint(painter, icon_rect, Color32::from_white_alpha(110));
            let slash = vec2(8.0, -8.0);
            painter.line_segment([rect.center() - slash, rect.center() + slash], Stroke::new(2.0, bright));
        }
        Ballot::Open => {
            painter.circle_stroke(rect.center(), 0.5 * CHIP - 1.0, line);
            Icon::from(category).paint(painter, icon_rect, bright);
        }
    }
    let text = match ballot {
        Ballot::Open => format!("{title}: not voted yet. Click if none of the four pleases."),
        Ballot::NoFavourite => format!("{title}: none of the four. Click to take that back."),
        Ballot::For(best) => format!("{title}: {} is best. Click if none of the four pleases.", best + 1),
    };
    tooltip_above(&response, model.with_key(&text, Command::Vote(Best { category, landscape: None })));
}
