//! The questionnaire: what is pressed becomes answers, and nothing empty is kept.

use egui_kittest::kittest::Queryable;

use super::behaviour::{WINDOW, press};
use super::*;
use crate::event::Panel;
use crate::questionnaire::{Aspect, Question};

fn asked(answers: Answers) -> Model {
    let mut model = model();
    model.panels.questions = true;
    model.answers = answers;
    model
}

#[test]
fn a_rating_is_added_to_those_before() {
    let before = Answers { ratings: [(Question::GroundSudden, 1)].into(), ..Answers::default() };
    let mut harness = bench(asked(before.clone()), WINDOW, 1.0);
    let mut after = before;
    after.ratings.insert(Question::Jerkiness, 2);
    assert_eq!(press(&mut harness, "jerkiness: 2"), [Event::Answers(after)]);
    let closed = Event::Panel { panel: Panel::Questions, open: false };
    assert_eq!(press(&mut harness, "Close the questions"), [closed]);
}

#[test]
fn nothing_is_kept_before_something_is_answered() {
    let mut harness = bench(asked(Answers::default()), [900.0, 1600.0], 1.0);
    assert_eq!(press(&mut harness, "Keep the answers"), []);
    let some = Answers { best: [(Aspect::Sky, 3)].into(), ..Answers::default() };
    harness.state_mut().model.answers = some;
    harness.run();
    assert_eq!(press(&mut harness, "Keep the answers"), [Event::KeepAnswers]);
}

#[test]
fn a_file_alone_has_no_best_of_four() {
    let mut model = asked(Answers::default());
    assert!(bench(model.clone(), [900.0, 1600.0], 1.0).query_by_label("overall: 4").is_some());
    model.count = 1;
    assert!(bench(model, [900.0, 1600.0], 1.0).query_by_label("overall: 1").is_none());
}
