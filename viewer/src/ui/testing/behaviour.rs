//! What is pressed, dragged and typed gives exactly its event, and nothing else.

use egui::accesskit::Role;
use egui::{Key, pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use genescape_schema::Category;

use super::*;
use crate::ballots::Ballot;
use crate::event::Panel;
use crate::input::Command;
use crate::settings::Theme;
use crate::ui::theme::title;

pub const WINDOW: [f32; 2] = [1280.0, 800.0];

pub fn taken(harness: &mut Harness<'static, Bench>) -> Vec<Event> {
    std::mem::take(&mut harness.state_mut().events)
}

/// Presses what has that name; what was asked by it.
pub fn press(harness: &mut Harness<'static, Bench>, label: &str) -> Vec<Event> {
    harness.state_mut().events.clear();
    harness.get_by_label(label).click();
    harness.run();
    taken(harness)
}

pub fn all_voted() -> Model {
    let mut model = model();
    for category in Category::ALL {
        model.ballots.set(category, Ballot::For(category as usize));
    }
    model
}

fn with_genome(change: impl FnOnce(&mut Genes)) -> Model {
    let mut model = model();
    model.panels.genome = true;
    change(model.genes.as_mut().expect("the model has genes"));
    model
}

#[test]
fn each_vote_button_gives_its_vote_and_takes_it_back_where_it_won() {
    let mut harness = bench(model(), WINDOW, 1.0);
    for category in Category::ALL {
        for view in 0..4 {
            let label = format!("{}: best in {}", title(category), view + 1);
            let vote = |ballot| vec![Event::Vote { category, ballot }];
            assert_eq!(press(&mut harness, &label), vote(Ballot::For(view)));
            harness.state_mut().model.ballots.set(category, Ballot::For(view));
            harness.run();
            assert_eq!(press(&mut harness, &label), vote(Ballot::Open));
        }
        let none = format!("{}: none of the four", title(category));
        assert_eq!(press(&mut harness, &none), [Event::Vote { category, ballot: Ballot::NoFavourite }]);
        harness.state_mut().model.ballots.set(category, Ballot::NoFavourite);
        harness.run();
        assert_eq!(press(&mut harness, &none), [Event::Vote { category, ballot: Ballot::Open }]);
    }
}

#[test]
fn the_next_generation_is_offered_exactly_when_all_is_voted_and_nothing_is_baked() {
    let mut harness = bench(model(), WINDOW, 1.0);
    assert!(press(&mut harness, "Next generation").is_empty(), "not voted yet");
    assert!(harness.query_by_label("Next generation (hub)").is_none());
    harness.state_mut().model = all_voted();
    harness.run();
    assert_eq!(press(&mut harness, "Next generation"), [Event::Command(Command::NextGeneration)]);
    assert_eq!(press(&mut harness, "Next generation (hub)"), [Event::Command(Command::NextGeneration)]);
    harness.state_mut().model.baking = baking();
    harness.run();
    assert!(press(&mut harness, "Next generation").is_empty(), "still baking");
    assert!(harness.query_by_label("Next generation (hub)").is_none());
}

#[test]
fn the_bar_leads_back_in_time_and_undoes() {
    let mut harness = bench(model(), WINDOW, 1.0);
    assert_eq!(press(&mut harness, "Generation 1"), [Event::GoToGeneration(1)]);
    assert!(press(&mut harness, "Generation 3").is_empty(), "it is shown already");
    assert_eq!(press(&mut harness, "Undo: vote on trees"), [Event::Command(Command::Undo)]);
    harness.state_mut().model.undo = None;
    harness.run();
    assert!(press(&mut harness, "Nothing to undo").is_empty());
    harness.state_mut().model.redo = Some("vote on sky".to_owned());
    harness.run();
    assert_eq!(press(&mut harness, "Redo: vote on sky"), [Event::Command(Command::Redo)]);
    let panels = [
        ("Genes", Panel::Genome),
        ("Frame times", Panel::Stats),
        ("Settings", Panel::Settings),
        ("Help and keys", Panel::Help),
        ("Family tree", Panel::Family),
    ];
    for (label, panel) in panels {
        assert_eq!(press(&mut harness, label), [Event::Panel { panel, open: true }]);
    }
    assert_eq!(press(&mut harness, "Save a screenshot"), [Event::Command(Command::Screenshot)]);
}

#[test]
fn pictures_are_chosen_maximised_and_compared() {
    let mut harness = bench(model(), WINDOW, 1.0);
    assert_eq!(press(&mut harness, "Landscape 2: Birches by the lake"), [Event::Choose(1)]);
    harness.get_by_label("Landscape 2: Birches by the lake").click_secondary();
    harness.run();
    assert_eq!(taken(&mut harness), [Event::Capture(true)]);
    harness.hover_at(pos2(900.0, 200.0));
    harness.run();
    let output = &harness.state().output;
    assert_eq!((output.views.pointed, output.views.free), (Some(1), true));
    assert_eq!(press(&mut harness, "Show this one alone: 2"), [Event::Arrange(Arrangement::One(1))]);
    let star = |starred| Event::Star { generation: 3, landscape: 1, starred };
    assert_eq!(press(&mut harness, "Star: 2"), [star(true)]);
    harness.state_mut().model.favourites.insert((3, 1));
    assert_eq!(press(&mut harness, "Star: 2"), [star(false)]);
    assert_eq!(press(&mut harness, "More like this: 2"), [Event::MoreLike(1)]);
    let compare = Arrangement::Compare { left: 1, right: 2 };
    assert_eq!(press(&mut harness, "Compare with another: 2"), [Event::Arrange(compare)]);
    harness.state_mut().model.arrangement = compare;
    harness.run();
    assert_eq!(
        press(&mut harness, "Show 4 on the left"),
        [Event::Arrange(Arrangement::Compare { left: 3, right: 2 })]
    );
    assert_eq!(
        press(&mut harness, "Show 1 on the right"),
        [Event::Arrange(Arrangement::Compare { left: 1, right: 0 })]
    );
    assert_eq!(press(&mut harness, "All four"), [Event::Arrange(Arrangement::Grid)]);
}

#[test]
fn variety_is_asked_for_when_the_slider_is_let_go() {
    let mut harness = bench(model(), WINDOW, 1.0);
    let rect = harness.get_by_label("Variety").rect();
    harness.drag_at(rect.center());
    harness.run();
    harness.hover_at(rect.left_center() - vec2(30.0, 0.0));
    harness.run();
    assert!(taken(&mut harness).is_empty(), "it is still being dragged");
    harness.drop_at(rect.left_center() - vec2(30.0, 0.0));
    harness.run();
    assert_eq!(taken(&mut harness), [Event::Variety(Variety::MIN)]);
}

fn with_family() -> Model {
    let mut model = model();
    model.panels.family = true;
    model
}

#[test]
fn the_family_tree_leads_to_a_generation_and_finds_names() {
    let mut model = with_family();
    let mut family = model.family.to_vec();
    family[0].names[2] = "The Old Oak".to_owned();
    model.family = Arc::new(family);
    let mut harness = bench(model, [1280.0, 900.0], 1.0);
    let name =
        |generation: u32, landscape: u32| format!("Landscape {generation}.{landscape}: Random 7.{landscape}");
    assert_eq!(press(&mut harness, &name(1, 2)), [Event::Choose(1), Event::GoToGeneration(1)]);
    assert_eq!(press(&mut harness, &name(3, 4)), [Event::Choose(3)], "it is shown already");
    harness.get_by_label("Search names").focus();
    harness.run();
    harness.get_by_label("Search names").type_text("oak old");
    harness.run();
    assert!(harness.query_by_label(&name(1, 2)).is_none(), "no name of generation 1 matches");
    let events = press(&mut harness, "Landscape 0.3: The Old Oak");
    assert_eq!(events, [Event::Choose(2), Event::GoToGeneration(0)]);
    let closed = Event::Panel { panel: Panel::Family, open: false };
    assert_eq!(press(&mut harness, "Close the family tree"), [closed]);
}

#[test]
fn a_favourite_is_gone_to_unmarked_and_bred_with() {
    let mut harness = bench(with_family(), WINDOW, 1.0);
    let (generation, landscape) = (1, 2);
    assert_eq!(press(&mut harness, "1.3  Random 7.3"), [Event::GoToGeneration(1)]);
    let star = Event::Star { generation, landscape, starred: false };
    assert_eq!(press(&mut harness, "Take the star from 1.3"), [star]);
    for category in Category::ALL {
        let label = format!("Breed with the {} of 1.3", title(category).to_lowercase());
        assert_eq!(press(&mut harness, &label), [Event::BreedFrom { generation, landscape, category }]);
    }
    harness.state_mut().model.baking = baking();
    harness.run();
    assert!(press(&mut harness, "Breed with the sky of 1.3").is_empty(), "something is on its way");
}

#[test]
fn no_control_keeps_the_keyboard_when_a_text_field_is_left() {
    for key in [Key::Tab, Key::Enter, Key::Escape] {
        let mut harness = bench(with_genome(|_| {}), [1280.0, 1600.0], 1.0);
        let focused = |harness: &Harness<'static, Bench>| harness.ctx.memory(|memory| memory.focused());
        harness.get_by_label("Search genes").focus();
        harness.run();
        assert!(harness.state().output.typing);
        harness.key_press(key);
        harness.run();
        assert!(!harness.state().output.typing && focused(&harness).is_none(), "{key:?}");
        for key in [Key::Tab, Key::Space, Key::ArrowDown, Key::Space] {
            harness.key_press(key);
            harness.run();
        }
        assert!(focused(&harness).is_none() && taken(&mut harness).is_empty(), "{key:?}");
    }
}

#[test]
fn a_value_that_was_typed_is_taken_when_tab_leaves_its_field() {
    let mut harness = bench(with_genome(|_| {}), [1280.0, 1600.0], 1.0);
    harness.get_by_label("Value of height_m").focus();
    harness.run();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, Key::A);
    harness.run();
    harness.get_by_label("Value of height_m").type_text("7.4");
    harness.run();
    harness.key_press(Key::Tab);
    harness.run();
    assert!(matches!(&taken(&mut harness)[..], [Event::Genes { individual: 0, .. }]));
}

#[test]
fn the_splitter_follows_the_pointer_and_stays_inside() {
    let mut model = model();
    model.arrangement = Arrangement::Compare { left: 0, right: 2 };
    let mut harness = bench(model, WINDOW, 1.0);
    let mut drag = |to: f32| {
        let from = harness.get_by_label("Splitter").rect().center();
        harness.drag_at(from);
        harness.run();
        harness.hover_at(pos2(to, from.y));
        harness.run();
        harness.drop_at(pos2(to, from.y));
        harness.run();
        (harness.state().state.split, harness.get_by_label("Splitter").rect().center().x)
    };
    let (split, x) = drag(320.0);
    assert!((x - 320.0).abs() < 1.0 && (split - 0.2475).abs() < 0.01, "{x} {split}");
    let (split, x) = drag(-500.0);
    assert!(split > 0.0 && x > 4.0);
    assert!(drag(5000.0).0 < 1.0);
    let slots = &harness.state().output.views.slots;
    assert_eq!(slots.iter().map(|slot| slot.view).collect::<Vec<_>>(), [0, 2]);
    assert_eq!(slots[0].rect, slots[1].rect, "both pictures cover the whole area");
    assert!(taken(&mut harness).is_empty());
}

#[test]
fn a_drag_on_a_picture_turns_the_camera_and_chooses_nothing() {
    let mut harness = bench(model(), WINDOW, 1.0);
    harness.drag_at(pos2(300.0, 200.0));
    harness.run();
    harness.hover_at(pos2(340.0, 220.0));
    harness.step();
    assert_eq!(harness.state().output.views.dragged, vec2(40.0, 20.0));
    harness.drop_at(pos2(340.0, 220.0));
    harness.run();
    assert!(taken(&mut harness).is_empty());
}

fn slider<'h>(harness: &'h Harness<'static, Bench>, name: &'h str) -> egui_kittest::Node<'h> {
    harness.get_by_role_and_label(Role::Slider, name)
}

#[test]
fn a_dragged_gene_is_shown_while_it_moves_and_written_when_it_is_let_go() {
    for name in ["height_m", "radius_ratio", "primary_branches"] {
        let mut harness = bench(with_genome(|_| {}), [1280.0, 1600.0], 1.0);
        let rect = slider(&harness, name).rect();
        let field = format!("Value of {name}");
        let before = harness.get_by_label(&field).value();
        harness.drag_at(rect.left_center() + vec2(20.0, 0.0));
        harness.run();
        harness.hover_at(rect.left_center() + vec2(150.0, 0.0));
        harness.run();
        assert!(taken(&mut harness).is_empty(), "nothing is written while it moves");
        assert_ne!(harness.get_by_label(&field).value(), before, "but it is shown");
        harness.drop_at(rect.left_center() + vec2(150.0, 0.0));
        harness.run();
        let events = taken(&mut harness);
        let [Event::Genes { individual: 0, values }] = &events[..] else { panic!("one event: {events:?}") };
        let [(written, value)] = &values[..] else { panic!("one final value: {values:?}") };
        assert_eq!(written, name);
        let space = Space::builtin();
        let parameter = space.find(name).expect("the space has the gene");
        assert_eq!(*value, parameter.value(parameter.snap(*value)), "the value is snapped");
        let part = f64::from(parameter.snap(*value)) / f64::from(parameter.last_code());
        let at = f64::from((150.0 - rect.height() / 2.5) / (rect.width() - 2.0 * rect.height() / 2.5));
        assert!((part - at).abs() <= 0.6 / f64::from(parameter.last_code()), "{part} at {at}");
    }
}

#[test]
fn a_press_that_moves_no_slider_asks_for_nothing() {
    let mut harness = bench(with_genome(|_| {}), [1280.0, 1600.0], 1.0);
    let genes = harness.state().model.genes.clone().expect("the model has genes");
    let parameter = genes.space.find("crown_shape").expect("the space has the gene");
    let rect = slider(&harness, "crown_shape").rect();
    let radius = rect.height() / 2.5;
    let part = genes.now[0].code(parameter) as f32 / parameter.last_code() as f32;
    let handle = pos2(egui::lerp(rect.x_range().shrink(radius), part), rect.center().y);
    harness.drag_at(handle);
    harness.run();
    harness.drop_at(handle);
    harness.run();
    assert!(taken(&mut harness).is_empty());
}

#[test]
fn an_arrow_key_changes_a_gene_by_one_code_for_good() {
    let mut harness = bench(with_genome(|_| {}), [1280.0, 1600.0], 1.0);
    let genes = harness.state().model.genes.clone().expect("the model has genes");
    let parameter = genes.space.find("crown_shape").expect("the space has the gene");
    slider(&harness, "crown_shape").focus();
    harness.run();
    harness.key_press(Key::ArrowRight);
    harness.run();
    let value = parameter.value(genes.now[0].code(parameter) + 1);
    let name = parameter.name.clone();
    assert_eq!(taken(&mut harness), [Event::Genes { individual: 0, values: vec![(name, value)] }]);
}

#[test]
fn a_typed_value_is_snapped_and_nonsense_changes_nothing() {
    let typed = |text: &str| {
        let mut harness = bench(with_genome(|_| {}), [1280.0, 1600.0], 1.0);
        harness.get_by_label("Value of height_m").focus();
        harness.run();
        harness.key_press_modifiers(egui::Modifiers::COMMAND, Key::A);
        harness.run();
        harness.get_by_label("Value of height_m").type_text(text);
        harness.run();
        harness.key_press(Key::Enter);
        harness.run();
        taken(&mut harness)
    };
    let space = Space::builtin();
    let parameter = space.find("height_m").expect("the space has the gene");
    let value = parameter.value(parameter.snap(7.4));
    for text in ["7.4", " 7,4 m"] {
        let name = "height_m".to_owned();
        assert_eq!(typed(text), [Event::Genes { individual: 0, values: vec![(name, value)] }]);
    }
    for text in ["tall", "-3", "1e9", ""] {
        assert!(typed(text).is_empty(), "{text:?}");
    }
}

#[test]
fn the_help_of_a_gene_says_what_votes_have_taught() {
    let mut harness = bench(with_genome(|_| {}), [1280.0, 1600.0], 1.0);
    assert!(harness.query_by_label_contains("Votes want").is_none());
    let name = harness.get_by_label("Height").rect().center();
    harness.hover_at(name);
    harness.run_steps(60);
    assert!(harness.query_by_label("Votes want 12 … 14 m: quite sure").is_some());
}

#[test]
fn what_is_locked_does_not_move() {
    let by_itself = with_genome(|genes| {
        genes.locked.insert("height_m".to_owned());
    });
    let with_its_category = with_genome(|genes| genes.locked_categories[Category::Tree as usize] = true);
    for model in [by_itself, with_its_category] {
        let mut harness = bench(model, [1280.0, 1600.0], 1.0);
        let rect = slider(&harness, "height_m").rect();
        assert!(slider(&harness, "height_m").accesskit_node().is_disabled());
        harness.drag_at(rect.left_center() + vec2(20.0, 0.0));
        harness.run();
        harness.hover_at(rect.left_center() + vec2(90.0, 0.0));
        harness.run();
        harness.drop_at(rect.left_center() + vec2(90.0, 0.0));
        harness.run();
        assert!(taken(&mut harness).is_empty());
    }
}

#[test]
fn locks_resets_and_search_work_on_genes() {
    let mut harness = bench(
        with_genome(|genes| {
            let space = genes.space.clone();
            let parameter = space.find("height_m").expect("the space has the gene");
            let code = genes.now[0].code(parameter);
            genes.now[0].set_code(parameter, code ^ 1);
            genes.locked.insert("levels".to_owned());
        }),
        [1280.0, 1600.0],
        1.0,
    );
    let lock = |name: &str, locked| vec![Event::LockGene { name: name.to_owned(), locked }];
    assert_eq!(press(&mut harness, "Lock height_m"), lock("height_m", true));
    assert_eq!(press(&mut harness, "Unlock levels"), lock("levels", false));
    let category = Category::Tree;
    assert_eq!(press(&mut harness, "Lock all: trees"), [Event::LockCategory { category, locked: true }]);
    let genes = harness.state().model.genes.clone().expect("the model has genes");
    let parameter = genes.space.find("height_m").expect("the space has the gene");
    let bred = parameter.value(genes.bred[0].code(parameter));
    let values = vec![("height_m".to_owned(), bred)];
    assert_eq!(
        press(&mut harness, "Reset trees to how it was bred"),
        [Event::Genes { individual: 0, values }]
    );
    harness.state_mut().state.genome.search = "birch".to_owned();
    harness.run();
    assert!(harness.query_by_label("Value of bark_tone").is_some(), "its help tells of birches");
    assert!(harness.query_by_label("Value of height_m").is_none());
    assert_eq!(press(&mut harness, "Genes of: 3"), [Event::Choose(2)]);
}

#[test]
fn settings_give_the_whole_new_value() {
    let mut model = model();
    model.panels.settings = true;
    let mut harness = bench(model, [1280.0, 1400.0], 1.0);
    let options = Options { wireframe: true, ..Options::default() };
    assert_eq!(press(&mut harness, "Wireframe"), [Event::Options(options)]);
    let options = Options { tree_lod: crate::lod_mode::TreeLodMode::Simple, ..Options::default() };
    assert_eq!(press(&mut harness, "Tree detail: Simple"), [Event::Options(options)]);
    let comfort = Comfort { theme: Theme::Dark, ..Comfort::default() };
    assert_eq!(press(&mut harness, "Theme: Dark"), [Event::Comfort(comfort)]);
    assert_eq!(press(&mut harness, "Reset all settings"), [Event::ResetSettings]);
    let closed = Event::Panel { panel: Panel::Settings, open: false };
    assert_eq!(press(&mut harness, "Close the settings"), [closed]);
}

#[test]
fn help_lists_every_binding_that_it_is_given() {
    let mut model = model();
    model.panels.help = true;
    let keys = model.bindings.help();
    let mut harness = bench(model, [1280.0, 1200.0], 1.0);
    for group in &keys {
        assert!(harness.query_all_by_label(&group.title).next().is_some(), "{}", group.title);
        for (keys, meaning) in &group.keys {
            assert!(harness.query_all_by_label(meaning).next().is_some(), "{meaning}");
            for key in keys.split_whitespace() {
                assert!(harness.query_all_by_label(key).next().is_some(), "{key}");
            }
        }
    }
    harness.key_press(Key::Escape);
    harness.run();
    assert_eq!(taken(&mut harness), [Event::Panel { panel: Panel::Help, open: false }]);
}

#[test]
fn an_error_is_told_in_full_and_can_be_dismissed() {
    let mut model = model();
    let error = file_error();
    assert!(error.report.lines().count() > 10);
    model.errors = vec![error.clone()];
    let mut harness = bench(model, [800.0, 600.0], 1.0);
    assert_eq!(press(&mut harness, "Show"), [Event::Panel { panel: Panel::Genome, open: true }]);
    harness.state_mut().model.panels.genome = true;
    harness.run();
    let sentences = error.report.lines().filter(|line| line.contains("g0003.ron:"));
    for sentence in sentences.map(|line| line.trim_start_matches("population/")) {
        let rect = harness.get_by_label(sentence).rect();
        assert!(rect.left() >= 400.0 && rect.right() <= 800.0, "{sentence} at {rect}");
        let rows = (rect.height() / 17.0).round();
        assert!(rows * rect.width() > 6.0 * sentence.len() as f32, "{sentence} is cut: {rect}");
    }
    assert_eq!(press(&mut harness, &format!("Dismiss: {}", error.title)), [Event::DismissError(0)]);
}

#[test]
fn a_view_that_failed_says_what_to_do_and_can_be_tried_again() {
    let mut model = model();
    let (what, remedy) = ("The blob ab12 is missing.".to_owned(), "Bake again.".to_owned());
    model.views[2].state = ViewState::Failed { what, remedy };
    let mut harness = bench(model, WINDOW, 1.0);
    assert!(harness.query_by_label("The blob ab12 is missing.\nBake again.").is_some());
    assert!(harness.query_by_label("Trees: best in 3").is_none(), "what is not shown is not voted for");
    assert_eq!(press(&mut harness, "Try again: 3"), [Event::Retry]);
    harness.state_mut().model.situation = Situation::Stuck {
        title: "No graphics adapter".to_owned(),
        what: "wgpu found none.".to_owned(),
        remedy: "Install mesa-vulkan-drivers.".to_owned(),
    };
    harness.run();
    assert!(harness.query_by_label("Install mesa-vulkan-drivers.").is_some());
    assert!(harness.state().output.views.slots.is_empty());
    assert_eq!(press(&mut harness, "Try again"), [Event::Retry]);
}
