//! What is drawn where, and what it says: names and votes on their pictures, notices beside them, tooltips, the first
//! hint, the line of generations.

use egui::pos2;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use genescape_schema::Category;

use super::behaviour::{WINDOW, all_voted, press};
use super::*;
use crate::ballots::Ballot;
use crate::input::Command;
use crate::scene::Facts;
use crate::ui::model::FileShown;
use crate::ui::theme::title;

/// What is drawn of a text, if anything is.
fn text_rect(harness: &Harness<'static, Bench>, text: &str) -> Option<egui::Rect> {
    harness.output().shapes.iter().find_map(|clipped| match &clipped.shape {
        egui::Shape::Text(shape) if shape.galley.text() == text => {
            Some(shape.visual_bounding_rect().intersect(clipped.clip_rect))
        }
        _ => None,
    })
}

#[test]
fn names_and_votes_stay_on_their_pictures_wherever_the_splitter_is() {
    for size in [[640.0, 400.0], [800.0, 600.0], WINDOW] {
        let mut world = all_voted();
        world.arrangement = Arrangement::Compare { left: 1, right: 3 };
        let mut harness = bench(world, size, 1.0);
        for split in [0.03, 0.2, 0.33, 0.5, 0.7, 0.97] {
            harness.state_mut().state.split = split;
            harness.run();
            let x = harness.get_by_label("Splitter").rect().center().x;
            for (view, side) in [(1, 0.0..=x), (3, x..=size[0])] {
                for category in Category::ALL {
                    let label = format!("{}: best in {}", title(category), view + 1);
                    if let Some(button) = harness.query_by_label(&label) {
                        let rect = button.rect();
                        let inside = side.contains(&rect.left()) && side.contains(&rect.right());
                        assert!(inside, "{label} at {rect}, split at {x}");
                    }
                }
            }
            if split == 0.5 {
                assert!(harness.query_by_label("Sky: best in 2").is_some());
                assert!(harness.query_by_label("Sky: best in 4").is_some());
            }
        }
    }
}

const NOTICES: [&str; 4] = [
    "a notice that is long enough to reach the buttons",
    "a second such notice that reaches the buttons, too",
    "a third such notice that reaches the buttons, too",
    "a fourth such notice that reaches the buttons, too",
];

#[test]
fn notices_lie_on_no_vote_button() {
    for size in [[640.0, 400.0], [800.0, 600.0], WINDOW] {
        for stats in [false, true] {
            let mut world = model();
            world.panels.stats = stats;
            let mut harness = bench(world, size, 1.0);
            for text in NOTICES {
                harness.state_mut().state.notify(crate::ui::Tone::Info, text, None);
            }
            harness.run_steps(6);
            let told: Vec<_> = NOTICES.iter().filter_map(|text| text_rect(&harness, text)).collect();
            assert_eq!(told.len(), 3, "the oldest has made room");
            for view in 1..=4 {
                let button = harness.get_by_label(&format!("Trees: best in {view}")).rect();
                assert!(
                    told.iter().all(|rect| !rect.expand(10.0).intersects(button)),
                    "{told:?} on {button}"
                );
            }
        }
    }
}

#[test]
fn the_hubs_tooltip_is_gone_when_its_button_was_pressed() {
    let mut harness = bench(all_voted(), WINDOW, 1.0);
    let at = harness.get_by_label("Next generation (hub)").rect().center();
    assert_eq!(press(&mut harness, "Next generation (hub)").len(), 1);
    harness.state_mut().model.baking = baking();
    harness.state_mut().model.ballots = Default::default();
    harness.run_steps(8);
    let ring = harness.get_by_label("Sky: none of the four").rect().right_center() + egui::vec2(20.0, 0.0);
    for place in [at, ring] {
        harness.hover_at(place);
        harness.run_steps(8);
    }
    assert!(text_rect(&harness, "Wait until generation 4 has grown").is_none());
    assert!(text_rect(&harness, "Breed four new landscapes from what you chose").is_none());
}

#[test]
fn nothing_fades_while_frames_take_long() {
    for (step_s, animated) in [(1.0 / 60.0, true), (0.5, false)] {
        let builder = Harness::builder().with_step_dt(step_s);
        let mut harness = build(model(), WINDOW, 1.0, egui::Theme::Dark, [8, 5], builder);
        harness.run_steps(3);
        assert_eq!(harness.ctx.global_style().animation_time > 0.0, animated);
    }
}

#[test]
fn a_single_scene_has_neither_votes_nor_other_landscapes_nor_generations() {
    let mut world = model();
    (world.count, world.votable, world.arrangement) = (1, false, Arrangement::One(0));
    world.ballots.set(Category::Sky, Ballot::For(0));
    let mut harness = bench(world, WINDOW, 1.0);
    harness.hover_at(pos2(600.0, 300.0));
    harness.run();
    for label in ["Sky: best in 1", "Sky: none of the four", "Next generation", "All four", "Generation 1"] {
        assert!(harness.query_by_label(label).is_none(), "{label}");
    }
    let [slot] = &harness.state().output.views.slots[..] else { panic!("one picture") };
    assert!(slot.rect.width() > 1260.0 && slot.rect.height() > 740.0, "{slot:?}");
    harness.state_mut().model.situation = Situation::Growing;
    harness.run();
    assert!(harness.query_by_label("Loading…").is_some());
    assert!(harness.query_by_label("Growing four landscapes…").is_none());
}

#[test]
fn the_generation_on_show_can_be_seen_and_tells_its_descent() {
    let mut world = model();
    world.generations = (0..60).collect();
    world.parents = (1..60).map(|generation| (generation, parent(generation - 1))).collect();
    world.parents.insert(20, parent(4));
    world.generation = 20;
    let mut harness = bench(world, [800.0, 600.0], 1.0);
    let mut shown = |generation: u32| {
        harness.state_mut().model.generation = generation;
        harness.run_steps(8);
        let rect = harness.get_by_label(&format!("Generation {generation}")).rect();
        let clip = harness.get_by_label("Next generation").rect().left();
        rect.left() > 40.0 && rect.right() < clip
    };
    assert!(shown(20) && shown(59) && shown(0) && shown(20));
    assert!(text_rect(&harness, "g20‹4").is_some() && text_rect(&harness, "g21").is_some());
    harness.get_by_label("Generation 20").hover();
    harness.run_steps(8);
    let told = "Generation 20, shown now\nBred from generation 4: trees of 1, terrain of 3, sky of none";
    assert!(text_rect(&harness, told).is_some());
}

#[test]
fn a_name_is_whole_and_its_numbers_are_explained() {
    let mut world = model();
    let name = "trees of 2 · land of 3 × 1 · sky like 4";
    world.views[0].name = name.to_owned();
    world.views[0].descent = "trees like 2".to_owned();
    let mut harness = bench(world, [640.0, 400.0], 1.0);
    let drawn = harness.output().shapes.iter().find_map(|clipped| match &clipped.shape {
        egui::Shape::Text(shape) if shape.galley.text().ends_with(name) => Some(shape.galley.clone()),
        _ => None,
    });
    assert!(drawn.is_some_and(|galley| !galley.elided && galley.rows.len() <= 2));
    harness.hover_at(pos2(40.0, 66.0));
    harness.run_steps(8);
    let legend = format!(
        "{name}\ntrees like 2\n\nNumbers are those of generation 2:\n1 Old oaks\n2 Wet birches\n3 A ridge\n4 Pines"
    );
    assert!(text_rect(&harness, &legend).is_some());
}

#[test]
fn the_first_screen_says_how_to_begin_until_one_has() {
    let mut world = model();
    world.greets = true;
    let mut harness = bench(world, [640.0, 400.0], 1.0);
    let hint = "W A S D walk · drag to look around · F1 help";
    let rect = text_rect(&harness, hint).expect("a hint");
    for view in 1..=4 {
        assert!(!harness.get_by_label(&format!("Trees: best in {view}")).rect().intersects(rect));
    }
    harness.state_mut().model.greets = false;
    harness.run();
    assert!(text_rect(&harness, hint).is_none());
}

#[test]
fn tooltips_name_keys_and_settings_begin_with_what_people_look_for() {
    let mut world = model();
    world.panels.settings = true;
    let mut harness = bench(world, [1280.0, 1400.0], 1.0);
    let y = |label: &str| harness.query_all_by_label(label).next().expect(label).rect().top();
    let order = ["Theme: Dark", "Scale: 100 %", "Mouse sensitivity", "Wireframe"].map(y);
    assert!(order.is_sorted(), "{order:?}");
    assert!(y("Grass") < y("Tree detail: Quality"));
    harness.get_by_label("Help and keys").hover();
    harness.run_steps(8);
    assert!(text_rect(&harness, "Help and keys (F1)").is_some());
}

#[test]
fn a_file_has_facts_instead_of_genes_and_no_generations() {
    let mut world = model();
    (world.count, world.votable, world.arrangement) = (1, false, Arrangement::One(0));
    world.panels.genome = true;
    world.file = Some(FileShown {
        name: "avocado.glb".to_owned(),
        facts: Facts {
            triangles: 12_345,
            levels: 3,
            level_source: Some("MSFT_lod"),
            notes: vec!["Points and lines are not drawn".to_owned()],
            ..Facts::default()
        },
        size_m: [0.04, 0.063, 0.03],
        cell_m: 0.01,
    });
    for size in [[640.0, 400.0], WINDOW] {
        let harness = bench(world.clone(), size, 1.0);
        let all = ["avocado.glb", "6.3 cm", "12\u{a0}345", "MSFT_lod", "Points and lines are not drawn"];
        // In a small window one scrolls to the others.
        for text in &all[..if size == WINDOW { 5 } else { 2 }] {
            assert!(text_rect(&harness, text).is_some(), "{text}");
        }
        assert!(harness.query_by_label("About this file").is_some());
        for label in ["Genes", "Trees: best in 1", "Next generation", "Nothing to undo"] {
            assert!(harness.query_by_label(label).is_none(), "{label}");
        }
    }
    for file in [world.file.clone(), None] {
        let exports = file.is_none();
        let mut harness = bench(Model { file, ..world.clone() }, WINDOW, 1.0);
        // Pictures have their buttons only under the pointer.
        harness.hover_at(egui::pos2(300.0, 300.0));
        harness.run();
        assert_eq!(harness.query_by_label("Export: 1").is_some(), exports);
    }
}

#[test]
fn a_study_shows_landscapes_and_questions_and_nothing_else() {
    let usual = bench(model(), WINDOW, 1.0);
    let studied = Model { votable: false, studied: true, ..model() };
    let mut harness = bench(studied, WINDOW, 1.0);
    // Pictures have their buttons only under the pointer.
    harness.hover_at(pos2(300.0, 300.0));
    harness.run();
    for label in ["Genes", "Settings", "Frame times", "Family tree", "Trees: best in 1"] {
        assert!(usual.query_by_label(label).is_some(), "{label}");
        assert!(harness.query_by_label(label).is_none(), "{label}");
    }
    for label in ["Export: 1", "Star: 1", "More like this: 1", "Next generation (hub)"] {
        assert!(harness.query_by_label(label).is_none(), "{label}");
    }
    assert!(harness.query_by_label("Help and keys").is_some());
    assert!(harness.query_by_label("Show this one alone: 1").is_some());
    let asked = press(&mut harness, "Answer when you have seen enough (Q)");
    assert_eq!(asked, [Event::Command(Command::Questions)]);
}
