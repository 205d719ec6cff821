//! A person's work on a world in a temporary folder: what is told, written and taken back.

use super::*;
use crate::ballots::Ballot;
use crate::input::Command;
use crate::ui::model::ViewState;
use genescape_schema::{Category, Genome, Parent, Variety, Votes};
use genescape_world::atomic_write;

/// A world with the starter landscapes in `root`, an editor of it, and its population file.
fn starter(root: &Path) -> (Editor, PathBuf) {
    let world = World::open_or_create(root).expect("a world");
    world.begin().expect("its first generation");
    let editor = Editor::open(Source::World(root.to_owned()), &WorldSettings::default());
    (editor, world.population_path(0))
}

#[test]
fn a_mistake_in_the_first_file_is_told_until_it_is_mended() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (_, path) = starter(folder.path());
    let good = std::fs::read_to_string(&path).expect("there");
    std::fs::write(&path, "Population(").expect("written");
    let (mut editor, _) = starter(folder.path());
    assert!(editor.is_hindered() && editor.errors()[0].report.contains("g0000.ron:1:"));
    std::fs::write(&path, good).expect("written");
    editor.changed(Change::Population(0));
    assert!(!editor.is_hindered() && editor.errors().is_empty());
}

#[test]
fn a_mistake_is_told_once_whether_bake_or_editor_finds_it_first() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for bake_first in [true, false] {
        let (mut editor, path) = starter(folder.path());
        let good = std::fs::read_to_string(&path).expect("there");
        std::fs::write(&path, "Population(").expect("written");
        let failed = baker::Event::Failed { message: "g0000.ron:1: wrong".into() };
        if bake_first {
            editor.baked(failed.clone());
        }
        editor.changed(Change::Population(0));
        if !bake_first {
            editor.baked(failed);
        }
        assert_eq!(editor.errors().len(), 1, "{bake_first}");
        std::fs::write(&path, good).expect("written");
    }
}

#[test]
fn a_new_generation_comes_on_show_whichever_change_is_told_first() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (place, told) in [[0, 1], [1, 0]].into_iter().enumerate() {
        let (mut editor, path) = starter(&folder.path().join(place.to_string()));
        assert_eq!(editor.generations(), (0, [0].as_slice()));
        let first = std::fs::read_to_string(path).expect("there");
        let second = first.replacen("generation: 0", "generation: 1", 1);
        std::fs::write(editor.world.population_path(1), second).expect("written");
        told.into_iter().for_each(|generation| editor.changed(Change::Population(generation)));
        assert_eq!(editor.generations(), (1, [0, 1].as_slice()), "{told:?}");
    }
}

#[test]
fn genes_of_an_older_world_are_filled_in_told_once_and_can_be_edited() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (_, path) = starter(folder.path());
    for (file, sign) in [(folder.path().join(names::SPACE), "\"snow_line\""), (path, " snow_line: ")] {
        let text = std::fs::read_to_string(&file).expect("there");
        let older: Vec<&str> = text.lines().filter(|line| !line.contains(sign)).collect();
        std::fs::write(&file, older.join("\n")).expect("written");
    }
    let (mut editor, path) = starter(folder.path());
    let told = |editor: &mut Editor| {
        editor
            .take_tasks()
            .iter()
            .filter(|task| matches!(task, Task::Tell(_, text) if text.contains("snow_line")))
            .count()
    };
    assert_eq!(told(&mut editor), 1 + INDIVIDUALS);
    let bake = World::read_population(&editor.space, &path).expect("valid").notices;
    bake.into_iter().for_each(|message| editor.baked(baker::Event::Notice { message }));
    editor.changed(Change::Space);
    assert_eq!(told(&mut editor), 0);
    editor.set_genes(1, vec![("snow_line".into(), 0.2)]);
    assert!(std::fs::read_to_string(&path).expect("there").contains("snow_line: 0.2,"));
    let value = |editor: &Editor| {
        editor.population.as_ref().and_then(|all| all.individuals[1].genome.value(&editor.space, "snow_line"))
    };
    assert_eq!(value(&editor), Some(0.2));
    editor.undo();
    assert_eq!(value(&editor), Some(1.0));
}

fn vote(editor: &mut Editor, category: Category, ballot: Ballot) {
    editor.vote(category, ballot);
    assert_eq!(editor.ballots.get(category), ballot);
}

/// The window is closed and opened again.
fn restarted(editor: &Editor) -> Editor {
    let mut kept = WorldSettings::default();
    editor.keep(&mut kept);
    let text = ron::to_string(&kept).expect("RON");
    Editor::open(editor.source.clone(), &ron::from_str(&text).expect("the same"))
}

/// What the bake does with votes.
fn bear(editor: &mut Editor, root: &Path) {
    let population = World::new(root).population(&Space::builtin(), 0).expect("valid").population;
    let parent = population.votes.map(|votes| Parent { generation: 0, votes, variety: None });
    let child = Population { generation: 1, parent, votes: None, ..population };
    editor.world.create_population(&Space::builtin(), &child).expect("saved");
    editor.changed(Change::Population(1));
}

#[test]
fn more_like_this_votes_for_all_of_one_and_asks_for_close_variations() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (mut editor, path) = starter(folder.path());
    let good = std::fs::read_to_string(&path).expect("there");
    editor.breed_more_like(2);
    let population = World::read_population(&editor.space, &path).expect("valid").population;
    assert_eq!(population.votes, Some(Votes { tree: Some(2), terrain: Some(2), sky: Some(2) }));
    assert_eq!((population.variety, editor.variety()), (Some(Variety::CLOSE), Variety::CLOSE));
    // Votes that were answered with another variety are not answered.
    let parent = Parent { generation: 0, votes: population.votes.expect("votes"), variety: None };
    let other = Population { generation: 1, parent: Some(parent), votes: None, ..population };
    editor.world.create_population(&Space::builtin(), &other).expect("saved");
    editor.breed();
    assert_eq!(editor.generations().0, 0, "no generation is bred of them yet");
    for _ in 0..8 {
        editor.undo();
    }
    let undone = std::fs::read_to_string(&path).expect("there");
    assert_eq!(undone, good);
}

#[test]
fn stars_are_kept_and_the_family_is_what_the_files_say() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (mut editor, _) = starter(folder.path());
    editor.star(0, 3, true);
    assert_eq!(restarted(&editor).favourites(), &[(0, 3)].into());
    editor.star(0, 3, false);
    assert!(restarted(&editor).favourites().is_empty());
    let sky = Ballot::For(1);
    vote(&mut editor, Category::Sky, sky);
    bear(&mut editor, folder.path());
    let family = editor.family();
    assert_eq!(family.iter().map(|kin| kin.generation).collect::<Vec<_>>(), [0, 1]);
    let path = editor.world.population_path(1);
    let text = std::fs::read_to_string(&path).expect("there");
    let name = &family[1].names[0];
    std::fs::write(&path, text.replacen(name.as_str(), "Grandmother's valley", 1)).expect("written");
    editor.changed(Change::Population(1));
    assert_eq!(editor.family()[1].names[0], "Grandmother's valley");
}

#[test]
fn a_part_of_any_landscape_is_bred_with() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (mut editor, _) = starter(folder.path());
    editor.breed_with(0, 3, Category::Tree);
    editor.changed(Change::Population(1));
    let population =
        |generation| editor.world.population(&Space::builtin(), generation).expect("valid").population;
    let of = |generation, landscape: usize| population(generation).individuals[landscape].genome.clone();
    let tree = |genome: &Genome| genome.chromosome(Category::Tree).clone();
    assert_eq!(tree(&of(1, 0)), tree(&of(0, 3)));
    assert_eq!(of(1, 0).chromosome(Category::Sky), of(0, 0).chromosome(Category::Sky));
    assert_eq!(editor.generations().0, 1, "it comes on show");
}

#[test]
fn every_kind_of_step_is_undone_and_redone_also_after_a_restart() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (mut editor, path) = starter(folder.path());
    let text = || std::fs::read_to_string(&path).expect("there");
    let good = text();
    for (category, ballot) in
        Category::ALL.into_iter().zip([Ballot::For(2), Ballot::NoFavourite, Ballot::For(0)])
    {
        vote(&mut editor, category, ballot);
    }
    let all = editor.ballots;
    editor.set_genes(1, vec![("height_m".into(), 9.0)]);
    let edited = text();
    editor.breed();
    let voted = text();
    assert!(good != edited && edited != voted);
    bear(&mut editor, folder.path());
    assert_eq!((editor.generations().0, editor.ballots), (1, Ballots::default()));

    let now = |editor: &Editor| (editor.generations().0, editor.ballots, text());
    let mut open = all;
    open.set(Category::Sky, Ballot::Open);
    let states = [(0, all, edited), (0, all, good.clone()), (0, open, good)];
    for state in &states {
        editor = restarted(&editor);
        editor.undo();
        assert_eq!(now(&editor), *state);
    }
    assert_eq!(editor.generations().1, [0, 1], "what was bred stays");
    for state in states[..2].iter().rev() {
        editor = restarted(&editor);
        editor.redo();
        assert_eq!(now(&editor), *state);
    }
    editor.redo();
    assert_eq!(now(&editor), (1, Ballots::default(), voted));
    assert_eq!((editor.next_redo(), editor.generations().1), (None, [0, 1].as_slice()));
}

#[test]
fn a_step_that_cannot_be_undone_does_not_bar_the_way_to_those_before_it() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (mut editor, path) = starter(folder.path());
    vote(&mut editor, Category::Sky, Ballot::For(1));
    editor.set_genes(1, vec![("height_m".into(), 9.0)]);
    let by_hand = format!("// mine\n{}", std::fs::read_to_string(&path).expect("there"));
    std::fs::write(&path, &by_hand).expect("written");
    editor.undo();
    let told = editor.take_tasks();
    let foreign = |task: &Task| matches!(task, Task::Tell(_, text) if text.contains("changed elsewhere"));
    assert!(told.iter().any(foreign), "{told:?}");
    assert_eq!(std::fs::read_to_string(&path).expect("there"), by_hand);
    editor.undo();
    assert_eq!(editor.ballots, Ballots::default());
}

#[test]
fn ballots_wait_for_a_person_who_looks_at_another_generation() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (mut editor, _) = starter(folder.path());
    bear(&mut editor, folder.path());
    editor.visit(0);
    vote(&mut editor, Category::Tree, Ballot::For(3));
    editor.visit(1);
    assert_eq!(editor.ballots, Ballots::default());
    editor.undo();
    assert_eq!((editor.generations().0, editor.ballots), (0, Ballots::default()));
    editor.redo();
    editor.visit(1);
    editor.visit(0);
    assert_eq!(editor.ballots.get(Category::Tree), Ballot::For(3));
}

#[test]
fn a_landscape_waits_grows_loads_and_is_ready_and_never_falls_back() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (mut editor, _) = starter(folder.path());
    let states = |editor: &Editor| [0, 1].map(|view| editor.state(view));
    assert_eq!(states(&editor), [ViewState::Waiting, ViewState::Waiting]);
    let stage =
        |stage: &str, scenes: &[usize]| baker::Event::Started { stage: stage.into(), scenes: scenes.into() };
    let finished = |scenes: &[usize]| baker::Event::Finished {
        stage: String::new(),
        scenes: scenes.into(),
        reused: false,
        ms: 1.0,
    };
    editor.baked(baker::Event::Planned { generation: 0, stages: 5, of_scenes: vec![3, 3, 1, 1] });
    editor.baked(stage("sky", &[0, 1]));
    editor.baked(finished(&[0, 1]));
    editor.baked(stage("tree", &[0]));
    let growing = |done, stage: &str| ViewState::Baking { done, total: 3, stage: stage.into() };
    assert_eq!(states(&editor), [growing(1, "tree"), growing(1, "sky")]);
    editor.baked(finished(&[0]));
    editor.baked(finished(&[0]));
    let ready = baker::Event::SceneReady { scene: 0, name: String::new(), path: String::new() };
    editor.baked(ready);
    assert_eq!(states(&editor), [ViewState::Loading, growing(1, "sky")]);
    // The file is there, the bake is done, and it takes its time to read it.
    let path = editor.world.scene_path(0, 0);
    std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
    std::fs::write(&path, "{}").expect("written");
    editor.changed(Change::Scene { generation: 0, index: 0 });
    editor.baked(baker::Event::Done { built: 5, reused: 0, ms: 1.0 });
    assert_eq!(editor.state(0), ViewState::Loading);
    assert!(editor.loaded(0, 0, Ok(())));
    assert_eq!(editor.state(0), ViewState::Ready);
    // A generation that was baked long ago, while another one grows.
    bear(&mut editor, folder.path());
    editor.baked(baker::Event::Planned { generation: 1, stages: 5, of_scenes: vec![3, 3, 1, 1] });
    editor.baked(stage("sky", &[0, 1]));
    editor.visit(0);
    assert_eq!(states(&editor), [ViewState::Loading, ViewState::Waiting]);
}

#[test]
fn a_scene_that_came_is_read_once() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (mut editor, _) = starter(folder.path());
    let path = editor.world.scene_path(0, 0);
    std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
    let mut tasks_after = |text: &str, told: Result<(), &str>| {
        atomic_write::replace(&path, text).expect("written");
        let change = Change::Scene { generation: 0, index: 0 };
        editor.take_tasks();
        editor.changed(change);
        let tasks = editor.take_tasks();
        editor.changed(change);
        assert_eq!(editor.take_tasks(), [], "while it is read");
        editor.loaded(0, 0, told).then(|| editor.changed(change));
        assert_eq!(editor.take_tasks(), [], "when it is on show");
        tasks.len()
    };
    assert_eq!(tasks_after("{}", Ok(())), 1);
    assert_eq!(tasks_after("{ }", Err("a blob is damaged")), 1, "another was written");
    editor.changed(Change::Scene { generation: 0, index: 0 });
    assert_eq!(editor.take_tasks().len(), 1, "somebody has mended what it is made of");
}

#[test]
fn a_scene_that_cannot_be_shown_is_read_again_when_one_tries_again() {
    let path = PathBuf::from("elsewhere/scene.gltf");
    let mut editor = Editor::open(Source::Scenes(vec![path.clone()]), &WorldSettings::default());
    let load = Task::Load { view: 0, generation: 0, path };
    assert_eq!(editor.take_tasks(), std::slice::from_ref(&load));
    assert!(!editor.loaded(0, 0, Err("it is no landscape")));
    assert!(matches!(editor.state(0), ViewState::Failed { .. }) && editor.count() == 1);
    editor.retry();
    assert_eq!((editor.take_tasks(), editor.state(0)), (vec![load], ViewState::Loading));
}

#[test]
fn breeding_again_gives_other_children_of_the_same_votes() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (mut editor, _) = starter(folder.path());
    editor.breed_again();
    assert!(
        matches!(&editor.take_tasks()[..], [.., Task::Tell(_, text)] if text.starts_with("Vote and breed"))
    );
    Category::ALL.into_iter().for_each(|category| editor.vote(category, Ballot::For(1)));
    editor.breed();
    let votes = editor.world.population(&editor.space, 0).expect("valid").population.votes.expect("written");
    let parent = Parent { generation: 0, votes, variety: None };
    // As the bake does when it sees the votes.
    crate::baker::breed_another(&editor.world, &editor.space, &parent).expect("bred");
    editor.changed(Change::Population(1));
    editor.visit(0);
    Category::ALL.into_iter().for_each(|category| editor.vote(category, Ballot::For(1)));
    editor.take_tasks();
    editor.breed();
    assert_eq!(editor.generations().0, 1, "they are there already");
    let offered = editor.take_tasks();
    let again = |task: &Task| matches!(task, Task::Offer(_, event) if *event == Command::BreedAgain.into());
    assert!(offered.iter().any(again), "{offered:?}");
    editor.breed_again();
    editor.changed(Change::Population(2));
    assert_eq!(editor.generations(), (2, [0, 1, 2].as_slice()));
    let genomes = [1, 2].map(|generation| {
        assert_eq!(editor.world.parent_of(generation), Some(parent));
        let population = editor.world.population(&editor.space, generation).expect("valid").population;
        population.individuals.map(|individual| individual.genome)
    });
    assert_eq!(genomes[0][0], genomes[1][0], "the favourites are united in both");
    assert!((1..4).all(|child| genomes[0][child] != genomes[1][child]), "the others are others");
}
