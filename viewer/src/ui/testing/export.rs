//! The way out: the handle on each picture and the card that it opens, and what notices tell of it.

use egui::{Key, Rect, pos2};
use egui_kittest::kittest::Queryable;

use super::behaviour::{WINDOW, press, taken};
use super::*;
use crate::event::Panel;
use crate::export_choice::{Audience, ExportChoice, Form};
use crate::ui::Tone;

fn with_card() -> Model {
    let mut model = model();
    model.panels.export = true;
    model.chosen = 1;
    model
}

/// The handle on the second picture, which is there while the pointer is.
fn handle(harness: &mut egui_kittest::Harness<'static, Bench>) -> Rect {
    harness.hover_at(pos2(900.0, 250.0));
    harness.run();
    harness.get_by_label("Export: 2").rect()
}

#[test]
fn the_handle_on_a_picture_opens_the_card_for_that_landscape() {
    let mut harness = bench(model(), WINDOW, 1.0);
    handle(&mut harness);
    let opened = Event::Panel { panel: Panel::Export, open: true };
    assert_eq!(press(&mut harness, "Export: 2"), [Event::Choose(1), opened]);
    harness.state_mut().model.views[1].state = ViewState::Loading;
    harness.run();
    assert!(harness.query_by_label("Export: 2").is_none(), "nothing can be exported yet");
}

#[test]
fn dragging_the_handle_out_of_the_window_asks_once_and_turns_nothing() {
    let mut harness = bench(model(), WINDOW, 1.0);
    let from = handle(&mut harness).center();
    harness.drag_at(from);
    harness.run();
    for step in 1..20 {
        harness.hover_at(from + egui::vec2(40.0 * step as f32, 0.0));
        harness.step();
        assert_eq!(harness.state().output.views.dragged, egui::Vec2::ZERO);
    }
    harness.drop_at(pos2(2000.0, from.y));
    harness.run();
    assert_eq!(taken(&mut harness), [Event::DragOut(1)]);
}

#[test]
fn the_card_gives_the_whole_choice() {
    let mut harness = bench(with_card(), WINDOW, 1.0);
    let plain = ExportChoice::default();
    let chosen = |choice: ExportChoice| [Event::ExportChoice(choice)];
    let for_blender = ExportChoice { audience: Audience::Blender, apron: true, ..plain.clone() };
    assert_eq!(press(&mut harness, "Export for: Blender"), chosen(for_blender.clone()));
    let folder = ExportChoice { form: Form::Folder, ..plain.clone() };
    assert_eq!(press(&mut harness, "Export as: Folder"), chosen(folder));
    let apron = ExportChoice { apron: true, ..plain.clone() };
    assert_eq!(press(&mut harness, "Land up to the horizon"), chosen(apron));
    assert_eq!(press(&mut harness, "Choose…"), [Event::ChooseExportFolder]);
    assert_eq!(press(&mut harness, "Landscape to export: 4"), [Event::Choose(3)]);
    assert_eq!(press(&mut harness, "Close the export"), [Event::Panel { panel: Panel::Export, open: false }]);
    harness.state_mut().model.export.choice = for_blender;
    harness.run();
    assert_eq!(press(&mut harness, "Export for: Any program"), chosen(plain.clone()));
    harness.state_mut().model.export.choice = plain.clone();
    harness.get_by_label("Folder to export into").focus();
    harness.run();
    harness.get_by_label("Folder to export into").type_text("~/land");
    harness.run();
    assert!(harness.state().output.typing, "letters are no commands");
    let typed = ExportChoice { folder: "~/land".to_owned(), ..plain };
    assert_eq!(taken(&mut harness), chosen(typed));
    harness.key_press(Key::Escape);
    harness.run();
    assert!(!harness.state().output.typing);
}

#[test]
fn a_landscape_is_exported_when_it_is_there_and_no_other_is_on_its_way() {
    let mut harness = bench(with_card(), WINDOW, 1.0);
    assert_eq!(press(&mut harness, "Export"), [Event::Export(1)]);
    assert!(harness.query_by_label("Copy").is_none(), "nothing was exported yet");
    harness.state_mut().model.export.progress = Some((3, 8));
    harness.run();
    assert!(harness.query_by_label("Writing: 3 of 8 files").is_some());
    assert!(press(&mut harness, "Export").is_empty());
    let export = &mut harness.state_mut().model.export;
    (export.progress, export.written) = (None, Some("Landscape 2 is exported".to_owned()));
    harness.run();
    assert_eq!(press(&mut harness, "Copy"), [Event::CopyExported]);
    assert_eq!(press(&mut harness, "Show in folder"), [Event::ShowExported]);
    harness.state_mut().model.views[1].state = ViewState::Waiting;
    harness.run();
    assert!(press(&mut harness, "Export").is_empty());
}

const LONG: &str = "Landscape 2 is not exported: cannot write /home/someone/a/folder/with/a/long/name/exports/\
    g0003-2-birches-by-the-lake/birches-by-the-lake.glb: No space left on device (os error 28)";

#[test]
fn the_whole_sentence_of_a_notice_can_be_read() {
    for size in [[800.0, 600.0], [480.0, 320.0]] {
        let mut harness = bench(model(), size, 1.0);
        harness.state_mut().state.notify(Tone::Error, LONG, None);
        harness.run_steps(6);
        let drawn = harness.output().shapes.iter().find_map(|clipped| match &clipped.shape {
            egui::Shape::Text(shape) if shape.galley.text() == LONG => Some((shape, clipped.clip_rect)),
            _ => None,
        });
        let (shape, clip) = drawn.expect("a notice");
        let window = Rect::from_min_size(pos2(0.0, 40.0), size.into());
        assert!(shape.galley.rows.len() > 1 && !shape.galley.elided);
        let rect = shape.visual_bounding_rect();
        assert!(clip.contains_rect(rect) && window.contains_rect(rect), "{rect} in {clip}");
    }
}

#[test]
fn a_notice_goes_by_itself_or_by_a_click_and_may_lead_on() {
    let mut harness = bench(model(), WINDOW, 1.0);
    let there = |harness: &egui_kittest::Harness<'static, Bench>| harness.query_by_label("told").is_some();
    harness.state_mut().state.notify(Tone::Success, "told", Some(Event::ShowExported));
    harness.run_steps(2);
    assert_eq!(press(&mut harness, "told"), [Event::ShowExported]);
    assert!(!there(&harness));
    harness.state_mut().state.notify(Tone::Info, "told", None);
    harness.run_steps(2);
    assert!(there(&harness));
    assert!(press(&mut harness, "told").is_empty() && !there(&harness));
    harness.state_mut().state.notify(Tone::Info, "told", None);
    harness.hover_at(pos2(5.0, 5.0));
    harness.run_steps(2);
    let wait = |harness: &mut egui_kittest::Harness<'static, Bench>, seconds: usize| {
        harness.run_steps(seconds * 60 / 15);
    };
    wait(&mut harness, 1);
    assert!(there(&harness));
    wait(&mut harness, 60);
    assert!(!there(&harness));
}
