//! Nothing sticks out: at every size of window, scale and set of panels, whatever can be pressed lies inside the window,
//! and nothing that can be pressed lies on another.

use egui::Rect;
use egui_kittest::kittest::{NodeT, Queryable};

use super::*;
use crate::ballots::Ballot;
use genescape_schema::Category;

const WINDOWS: [([f32; 2], f32); 3] = [([800.0, 600.0], 1.0), ([1920.0, 1080.0], 1.0), ([960.0, 540.0], 2.0)];

fn worlds() -> Vec<(&'static str, Model)> {
    let change = |change: fn(&mut Model)| {
        let mut model = model();
        change(&mut model);
        model
    };
    vec![
        ("plain", model()),
        (
            "voted",
            change(|model| Category::ALL.into_iter().for_each(|c| model.ballots.set(c, Ballot::For(1)))),
        ),
        ("genome", change(|model| model.panels.genome = true)),
        (
            "errors",
            change(|model| {
                model.panels.genome = true;
                model.errors = vec![file_error(), file_error()];
            }),
        ),
        ("banner", change(|model| model.errors = vec![file_error()])),
        (
            "stats and settings",
            change(|model| {
                model.panels.stats = true;
                model.panels.settings = true;
            }),
        ),
        ("family", change(|model| model.panels.family = true)),
        (
            "family, genome",
            change(|model| {
                model.panels = Panels { family: true, genome: true, ..Panels::default() };
                model.favourites = (0..9).map(|one| (one % 4, (one / 4) as usize)).collect();
            }),
        ),
        ("export", change(|model| model.panels.export = true)),
        ("questions", change(|model| model.panels.questions = true)),
        ("help", change(|model| model.panels.help = true)),
        (
            "all",
            change(|model| {
                model.panels = Panels { genome: true, stats: true, settings: true, ..Panels::default() };
            }),
        ),
        (
            "long",
            change(|model| {
                model.generations = (0..200).collect();
                model.baking = baking();
                for view in &mut model.views {
                    view.name = "A very long name that fits in no window ".repeat(4);
                }
            }),
        ),
        (
            "voted, genome",
            change(|model| {
                model.panels.genome = true;
                Category::ALL.into_iter().for_each(|category| model.ballots.set(category, Ballot::For(3)));
            }),
        ),
        ("compare", change(|model| model.arrangement = Arrangement::Compare { left: 3, right: 0 })),
        ("growing", change(|model| model.situation = Situation::Growing)),
    ]
}

/// Name and rectangle of all that is drawn on the window itself or on a card, scrolled parts apart.
fn pressable(harness: &egui_kittest::Harness<'_, Bench>) -> Vec<(String, Rect)> {
    let root = harness.root();
    let buttons = root.query_all_by(|node| node.role() == egui::accesskit::Role::Button);
    buttons.map(|node| (node.accesskit_node().label().unwrap_or_default(), node.rect())).collect()
}

#[test]
fn nothing_sticks_out_of_the_window() {
    for (size, scale) in WINDOWS {
        for (name, model) in worlds() {
            let harness = bench(model, size, scale);
            let window = Rect::from_min_size(egui::Pos2::ZERO, size.into());
            for slot in &harness.state().output.views.slots {
                assert!(window.contains_rect(slot.rect), "{name} at {size:?}: {slot:?}");
                assert!(slot.size_px[0] >= 60 && slot.size_px[1] >= 100, "{name} at {size:?}: {slot:?}");
            }
            for (label, rect) in pressable(&harness) {
                // What a list has scrolled away is not the window's concern; width is.
                let across = rect.left() >= -0.5 && rect.right() <= size[0] + 0.5;
                let strip = label.starts_with("Generation ");
                assert!(strip || across, "{name} at {size:?}: {label} at {rect}");
            }
        }
    }
}

#[test]
fn buttons_on_pictures_lie_apart() {
    for (size, scale) in WINDOWS {
        for (name, model) in worlds() {
            let harness = bench(model, size, scale);
            let on_pictures = |label: &str| {
                label.contains(": best in")
                    || label.contains("none of the four")
                    || label.contains("(hub)")
                    || label.starts_with("Show ")
            };
            let buttons: Vec<_> =
                pressable(&harness).into_iter().filter(|(label, _)| on_pictures(label)).collect();
            for (at, (label, rect)) in buttons.iter().enumerate() {
                for (other, other_rect) in &buttons[at + 1..] {
                    let apart = !rect.shrink(0.5).intersects(*other_rect);
                    assert!(apart, "{name} at {size:?}: {label} {rect} on {other} {other_rect}");
                }
            }
        }
    }
}
