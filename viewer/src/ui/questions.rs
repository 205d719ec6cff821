//! The questionnaire after a walk: ratings, which landscape is best, and what else was wrong.

use egui::{Align2, Area, Id, Margin, Rect, RichText, TextEdit, Ui, vec2};
use strum::VariantArray;

use super::icon::Icon;
use super::model::Model;
use super::theme::{self, Palette};
use super::widgets::{Asks, ask, close_button, primary_button, scrolled, section, segmented, small};
use crate::event::{Event, Panel};
use crate::questionnaire::{Answers, Aspect, MAX_RATING, MAX_TEXT, Question};

/// Width of the card, in points.
const WIDTH: f32 = 340.0;
const NUMBERS: [&str; MAX_RATING as usize] = ["1", "2", "3", "4", "5"];

/// Draws the card at the upper right of `area`.
pub fn show(ui: &mut Ui, model: &Model, area: Rect) {
    let width = WIDTH.min(area.width() - 24.0);
    Area::new(Id::unique("questions"))
        .pivot(Align2::RIGHT_TOP)
        .fixed_pos(area.right_top() + vec2(-12.0, 12.0))
        .constrain_to(area)
        .accessible_name("Questions about the walk")
        .show(ui.ctx(), |ui| {
            let margin = Margin { left: 14, right: 8, top: 8, bottom: 10 };
            theme::card(Palette::of(ui.visuals())).inner_margin(margin).show(ui, |ui| {
                ui.set_width(width - 22.0);
                ui.horizontal(|ui| {
                    ui.label(RichText::new("How was the walk?").heading());
                    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                        close_button(ui, "Close the questions", Panel::Questions);
                    });
                });
                scrolled(ui, (area.height() - 190.0).clamp(60.0, 560.0), |ui| {
                    ui.set_width(ui.available_width() - 10.0);
                    questions(ui, model);
                });
                keep(ui, model);
            });
        });
}

fn questions(ui: &mut Ui, model: &Model) {
    let mut answers = model.answers.clone();
    for &question in Question::VARIANTS {
        ui.label(question.text());
        let numbers: Vec<_> = (1..).zip(NUMBERS).map(|(rating, text)| (Some(rating), text, "")).collect();
        let mut rating = answers.ratings.get(&question).copied();
        segmented(ui, question.name(), &numbers, &mut rating);
        if let Some(rating) = rating {
            answers.ratings.insert(question, rating);
        }
        let [low, high] = question.ends();
        small(ui, format!("1 {low}, {MAX_RATING} {high}"));
        ui.add_space(4.0);
    }
    if model.count > 1 {
        section(ui, "Which is best?");
        for &aspect in Aspect::VARIANTS {
            best(ui, model.count, aspect, &mut answers);
        }
    }
    ui.label("Did the bark on trees shift?");
    segmented(ui, "bark", &[(Some(true), "Yes", ""), (Some(false), "No", "")], &mut answers.bark_shifts);
    ui.add_space(4.0);
    ui.label("Anything else wrong with how scenes were shown?");
    let field = TextEdit::multiline(&mut answers.problems).char_limit(MAX_TEXT).desired_rows(2);
    let _ = ui.add(field.desired_width(f32::INFINITY)).accessible_name("Other problems");
    if answers != model.answers {
        ask(ui, Event::Answers(answers));
    }
}

/// Always in sight, whatever is scrolled.
fn keep(ui: &mut Ui, model: &Model) {
    ui.add_space(6.0);
    let is_empty = model.answers.is_empty();
    let response =
        ui.add_enabled_ui(!is_empty, |ui| primary_button(ui, "Keep the answers", Icon::Next)).inner;
    response.asks(Event::KeepAnswers);
    small(ui, model.answers.still_open().unwrap_or_default());
    small(
        ui,
        "A file beside the world, without a name or a date. Nothing is sent; delete it and it is gone.",
    );
}

fn best(ui: &mut Ui, count: usize, aspect: Aspect, answers: &mut Answers) {
    small(ui, aspect.name());
    let numbers: Vec<_> =
        (1..).zip(&NUMBERS[..count]).map(|(number, text)| (Some(number), *text, "")).collect();
    let mut chosen = answers.best.get(&aspect).copied();
    segmented(ui, aspect.name(), &numbers, &mut chosen);
    if let Some(chosen) = chosen {
        answers.best.insert(aspect, chosen);
    }
}
