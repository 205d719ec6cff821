//! A made-up world for the interface's tests, and a bench that shows it without a window.

mod behaviour;
mod export;
mod layout;
mod pictures;
mod questions;
mod shown;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use egui::{Color32, ColorImage, TextureHandle, TextureOptions, Vec2};
use egui_kittest::{Harness, HarnessBuilder};
use genescape_schema::{Parent, Population, Space, Variety, Votes};

use super::model::{
    Baking, ExportModel, FileError, Genes, Kin, Model, Panels, PassTime, Situation, StageEntry, Stats,
};
use super::model::{ViewModel, ViewState};
use super::{Output, State, theme};
use crate::ballots::Ballots;
use crate::event::{Arrangement, Event};
use crate::options::Options;
use crate::questionnaire::Answers;
use crate::settings::Comfort;

/// A window's content without a window.
pub struct Bench {
    pub model: Model,
    pub state: State,
    /// Everything that was asked so far.
    pub events: Vec<Event>,
    /// Of the last frame.
    pub output: Output,
    textures: Vec<TextureHandle>,
    /// Of the pictures, in pixels.
    picture_size: [usize; 2],
}

impl Bench {
    fn frame(&mut self, ui: &mut egui::Ui) {
        if self.textures.is_empty() {
            self.textures = (0..4).map(|view| landscape(ui.ctx(), view, self.picture_size)).collect();
        }
        for (view, texture) in self.model.views.iter_mut().zip(&self.textures) {
            view.picture = view.picture.map(|_| texture.id());
        }
        // The harness puts a margin around; the window has none.
        let window = ui.ctx().content_rect();
        let mut root = ui.new_child(egui::UiBuilder::new().max_rect(window));
        root.set_clip_rect(window);
        self.output = super::show(&mut root, &self.model, &mut self.state);
        self.events.append(&mut self.output.events);
    }
}

/// A window of `size` points.
pub fn bench(model: Model, size: [f32; 2], pixels_per_point: f32) -> Harness<'static, Bench> {
    build(model, size, pixels_per_point, egui::Theme::Dark, [8, 5], Harness::builder())
}

fn build(
    model: Model,
    size: [f32; 2],
    pixels_per_point: f32,
    theme: egui::Theme,
    picture_size: [usize; 2],
    builder: HarnessBuilder<Bench>,
) -> Harness<'static, Bench> {
    let (state, output) = (State::default(), Output::default());
    let bench = Bench { model, state, events: Vec::new(), output, textures: Vec::new(), picture_size };
    builder
        .with_size(Vec2::from(size))
        .with_pixels_per_point(pixels_per_point)
        .with_theme(theme)
        .with_context_setup(theme::install)
        .build_ui_state(|ui, bench: &mut Bench| bench.frame(ui), bench)
}

/// Four ready landscapes of generation 3, no vote, no panel.
pub fn model() -> Model {
    let space = Arc::new(Space::builtin());
    let population = Population::random(&space, 7, 3);
    let now = population.individuals.map(|individual| individual.genome);
    let names = ["Oak valley in June", "Birches by the lake", "Dry ridge at dusk", "Pines under cirrus"];
    Model {
        situation: Situation::Ready,
        generation: 3,
        generations: (0..=3).collect(),
        baking: None,
        undo: Some("vote on trees".to_owned()),
        redo: None,
        views: names.map(|name| ViewModel {
            descent: String::new(),
            name: name.to_owned(),
            picture: Some(egui::TextureId::default()),
            state: ViewState::Ready,
        }),
        ballots: Ballots::default(),
        arrangement: Arrangement::Grid,
        chosen: 0,
        genes: Some(Genes {
            space,
            bred: now.clone(),
            now,
            taught: Arc::new([("height_m".to_owned(), "Votes want 12 … 14 m: quite sure".to_owned())].into()),
            locked: BTreeSet::new(),
            locked_categories: [false; 3],
        }),
        bake_log: bake_log(),
        errors: Vec::new(),
        stats: stats(),
        bindings: Arc::default(),
        count: 4,
        votable: true,
        studied: false,
        file: None,
        parents: (1..=3).map(|generation| (generation, parent(generation - 1))).collect(),
        ancestors: Some(["Old oaks", "Wet birches", "A ridge", "Pines"].map(str::to_owned)),
        variety: Variety::USUAL,
        answers: Answers::default(),
        family: Arc::new((0..=3).map(kin).collect()),
        favourites: [(1, 2)].into(),
        thumbnails: BTreeMap::new(),
        greets: false,
        options: Options::default(),
        comfort: Comfort::default(),
        export: ExportModel { default_folder: "exports".to_owned(), ..ExportModel::default() },
        panels: Panels::default(),
        captured: false,
    }
}

/// A generation, bred from the one before it.
fn kin(generation: u32) -> Kin {
    let mut population = Population::random(&Space::builtin(), 7, generation);
    population.parent = generation.checked_sub(1).map(parent);
    population.votes = parent(generation).votes.into();
    for one in population.individuals.iter_mut().filter(|_| generation > 0) {
        one.descent = "trees of 1 · land like 3 · new sky".to_owned();
    }
    Kin::of(&population)
}

/// Bred from that generation.
pub fn parent(generation: u32) -> Parent {
    Parent { generation, votes: Votes { tree: Some(0), terrain: Some(2), sky: None }, variety: None }
}

/// Two faults of a population file, as the schema reports them.
pub fn file_error() -> FileError {
    let space = Space::builtin();
    let text = "Population(\n    version: 1,\n    generation: \"three\",\n    individuals: [],\n    wotes: None,\n)\n";
    let report = Population::load(&space, "population/g0003.ron", text).expect_err("the text is faulty");
    let title = format!("population/g0003.ron: {} errors", report.diagnostics.len());
    FileError { title, report: report.to_string() }
}

/// Generation 4 on its way.
pub fn baking() -> Option<Baking> {
    Some(Baking { generation: 4, done: 31, total: 76 })
}

fn bake_log() -> Vec<StageEntry> {
    let entry = |stage: &str, scene, reused, ms, why: &str| StageEntry {
        stage: stage.to_owned(),
        scene,
        reused,
        ms,
        why: why.to_owned(),
    };
    vec![
        entry("tree skeleton", Some(0), true, 0.2, ""),
        entry("tree mesh", Some(0), true, 0.3, ""),
        entry("terrain heights", Some(0), false, 412.0, "relief_m was 120, is 180"),
        entry("light map", Some(0), false, 1830.0, "input heights changed"),
        entry("sky", None, true, 0.1, ""),
    ]
}

fn stats() -> Stats {
    let frame =
        |at: u32| 7.5 + f32::from((at * 7 % 5) as u8) * 0.4 + if at.is_multiple_of(41) { 14.0 } else { 0.0 };
    let pass =
        |name: &str, ms: f32| PassTime { name: name.to_owned(), ms: [ms, ms * 1.1, ms * 0.8, ms * 1.2] };
    Stats {
        frames_ms: (0..240).map(frame).collect(),
        gpu: vec![
            pass("cull", 0.08),
            pass("terrain", 0.55),
            pass("trees", 0.92),
            pass("sky", 0.2),
            pass("tone", 0.1),
        ],
        cpu_record_ms: 0.84,
        triangles: [312_441, 280_112, 401_223, 298_001],
        draws: [8, 8, 9, 8],
        trees_per_level: vec![12, 60, 410, 1900, 5200, 9800, 4100],
        adapter: "llvmpipe (LLVM 19.1.7, 256 bits)".to_owned(),
    }
}

/// A picture that looks enough like a landscape: sky, hills, dots for trees.
fn landscape(ctx: &egui::Context, view: usize, size: [usize; 2]) -> TextureHandle {
    let sky = [[112, 160, 216], [236, 226, 206], [214, 120, 84], [150, 178, 200]][view];
    let land = [[72, 104, 48], [96, 128, 92], [134, 96, 58], [58, 84, 66]][view];
    let mix = |color: [u8; 3], other: [u8; 3], part: f32| {
        let byte = |at: usize| (f32::from(color[at]) * (1.0 - part) + f32::from(other[at]) * part) as u8;
        Color32::from_rgb(byte(0), byte(1), byte(2))
    };
    let hill = |x: f32, layer: f32| {
        let phase = view as f32 * 1.7 + layer * 2.1;
        0.38 + 0.16 * layer
            + 0.07 * libm::sinf(x * (5.0 + layer) + phase)
            + 0.03 * libm::sinf(x * 17.0 + phase)
    };
    let pixel = |index: usize| {
        let (x, y) = ((index % size[0]) as f32 / size[0] as f32, (index / size[0]) as f32 / size[1] as f32);
        match [2.0f32, 1.0, 0.0].into_iter().find(|&layer| y > hill(x, layer)) {
            Some(layer) => {
                let speck = (index * 2_654_435_761) >> 7 & 7;
                mix(land, sky, 0.5 - 0.25 * layer + 0.02 * speck as f32)
            }
            None => mix(sky, [248, 246, 240], y * 1.6_f32.min(1.0)),
        }
    };
    let image = ColorImage::new(size, (0..size[0] * size[1]).map(pixel).collect());
    ctx.load_texture(format!("landscape {view}"), image, TextureOptions::LINEAR)
}
