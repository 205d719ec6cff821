//! Pictures of the whole interface, painted by the same renderer as in the window: some are compared with what they were;
//! for people to look at all of them, set `GENESCAPE_UI_PICTURES` to a folder and run
//! `cargo test -p genescape-viewer --lib ui::testing::pictures`.

use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;

use egui::TexturesDelta;
use egui_kittest::{Harness, TestRenderer};
use egui_wgpu::{RendererOptions, ScreenDescriptor};

use super::*;
use crate::ballots::Ballot;
use crate::gpu::Gpu;
use crate::image_file;
use genescape_schema::Category;
use image::RgbaImage;

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Keeps the textures that the interface made until they are painted.
#[derive(Clone, Default)]
struct Deltas(Rc<RefCell<Vec<TexturesDelta>>>);

impl TestRenderer for Deltas {
    fn handle_delta(&mut self, delta: &mut TexturesDelta) {
        self.0.borrow_mut().push(std::mem::take(delta));
    }
}

/// The harness's last frame.
fn paint(gpu: &Gpu, harness: &Harness<'_, Bench>, deltas: &Deltas) -> RgbaImage {
    let scale = harness.ctx.pixels_per_point();
    let size = harness.ctx.content_rect().size() * scale;
    let screen = ScreenDescriptor {
        pixels_per_point: scale,
        size_in_pixels: [size.x.round() as u32, size.y.round() as u32],
    };
    let mut renderer = egui_wgpu::Renderer::new(&gpu.device, FORMAT, RendererOptions::PREDICTABLE);
    for delta in deltas.0.borrow_mut().iter_mut() {
        for (id, images) in delta.set.drain() {
            for image in images {
                renderer.update_texture(&gpu.device, &gpu.queue, id, &image);
            }
        }
    }
    let jobs = harness.ctx.tessellate(harness.output().shapes.clone(), scale);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    renderer.update_buffers(&gpu.device, &gpu.queue, &mut encoder, &jobs, &screen);
    let [width, height] = screen.size_in_pixels;
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: FORMAT,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let view = texture.create_view(&Default::default());
    let [r, g, b, _] = theme::ground(&harness.ctx).to_normalized_gamma_f32().map(f64::from);
    {
        let mut pass = encoder
            .begin_render_pass(&wgpu::RenderPassDescriptor {
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a: 1.0 }),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..Default::default()
            })
            .forget_lifetime();
        renderer.render(&mut pass, &jobs, &screen);
    }
    gpu.queue.submit([encoder.finish()]);
    image_file::read(gpu, &texture).expect("the device answers")
}

type Prepare = fn(&mut Model);
type Act = fn(&mut Harness<'static, Bench>);

fn nothing(_: &mut Harness<'static, Bench>) {}

fn voted(model: &mut Model) {
    model.ballots.set(Category::Tree, Ballot::For(0));
    model.ballots.set(Category::Terrain, Ballot::For(3));
    model.ballots.set(Category::Sky, Ballot::NoFavourite);
}

fn broken(model: &mut Model) {
    model.panels.genome = true;
    model.errors = vec![file_error()];
}

fn edited(model: &mut Model) {
    model.panels.genome = true;
    if let Some(genes) = &mut model.genes {
        let space = genes.space.clone();
        for parameter in space.parameters().iter().skip(2).step_by(5) {
            let code = genes.now[0].code(parameter);
            genes.now[0].set_code(parameter, (code + 3) % parameter.last_code());
        }
        genes.locked.insert("height_variation".to_owned());
    }
}

type Scene = (&'static str, [f32; 2], f32, egui::Theme, Prepare, Act);

/// Name, window in points, scale, theme, how the world differs from the usual one, and what is done to it.
const SCENES: [Scene; 21] = [
    (
        "grid",
        [1280.0, 800.0],
        1.0,
        egui::Theme::Dark,
        |_| {},
        |harness| harness.hover_at(egui::pos2(300.0, 250.0)),
    ),
    ("grid-light", [1280.0, 800.0], 1.0, egui::Theme::Light, voted, |harness| {
        harness.hover_at(egui::pos2(400.0, 400.0))
    }),
    (
        "family",
        [1280.0, 800.0],
        1.0,
        egui::Theme::Dark,
        |model| {
            voted(model);
            model.panels.family = true;
        },
        |harness| harness.hover_at(egui::pos2(700.0, 250.0)),
    ),
    ("voted", [1920.0, 1080.0], 1.0, egui::Theme::Dark, voted, nothing),
    (
        "small",
        [800.0, 600.0],
        1.0,
        egui::Theme::Dark,
        |model| {
            voted(model);
            model.panels.genome = true;
        },
        nothing,
    ),
    ("genome", [1280.0, 800.0], 1.0, egui::Theme::Dark, edited, nothing),
    ("genome-light-2x", [900.0, 700.0], 2.0, egui::Theme::Light, edited, |harness| {
        harness.hover_at(egui::pos2(640.0, 250.0))
    }),
    ("error", [1280.0, 800.0], 1.0, egui::Theme::Dark, broken, nothing),
    (
        "banner",
        [1280.0, 800.0],
        1.0,
        egui::Theme::Dark,
        |model| {
            model.errors = vec![file_error()];
            model.baking = baking();
            model.views[1].state =
                ViewState::Baking { done: 7, total: 19, stage: "terrain: erosion".to_owned() };
            model.views[2].picture = None;
            model.views[2].state = ViewState::Waiting;
            model.views[0].state = ViewState::Loading;
            model.views[3].state = ViewState::Failed {
                what: "scene-3/scene.gltf names a blob that is missing: blobs/ab/ab12….png".to_owned(),
                remedy: "Bake this generation again; what is intact is reused.".to_owned(),
            };
        },
        nothing,
    ),
    (
        "stats",
        [1280.0, 800.0],
        1.0,
        egui::Theme::Dark,
        |model| {
            model.panels.stats = true;
            model.panels.settings = true;
        },
        nothing,
    ),
    (
        "settings-light",
        [1280.0, 900.0],
        1.0,
        egui::Theme::Light,
        |model| {
            model.panels.settings = true;
            model.panels.stats = true;
        },
        |harness| {
            harness.state_mut().state.notify(
                super::super::Tone::Success,
                "Screenshot saved: world/screenshots/g0003.png",
                None,
            );
            harness.state_mut().state.notify(super::super::Tone::Error, "space.ron: 2 errors", None);
        },
    ),
    ("help", [1280.0, 800.0], 1.0, egui::Theme::Dark, |model| model.panels.help = true, nothing),
    ("help-light", [800.0, 600.0], 1.0, egui::Theme::Light, |model| model.panels.help = true, nothing),
    (
        "compare",
        [1280.0, 800.0],
        1.0,
        egui::Theme::Dark,
        |model| {
            voted(model);
            model.arrangement = Arrangement::Compare { left: 0, right: 2 };
        },
        nothing,
    ),
    (
        "compare-left",
        [800.0, 600.0],
        1.0,
        egui::Theme::Dark,
        |model| {
            voted(model);
            model.ballots.set(Category::Sky, Ballot::For(1));
            model.arrangement = Arrangement::Compare { left: 1, right: 3 };
        },
        |harness| harness.state_mut().state.split = 0.25,
    ),
    (
        "first",
        [800.0, 600.0],
        1.0,
        egui::Theme::Light,
        |model| {
            model.greets = true;
            model.generations = (0..40).collect();
            model.parents.insert(20, parent(4));
            model.generation = 20;
            model.views[0].name = "trees of 2 · land of 3 × 1 · sky like 4".to_owned();
            model.views[1].name = "Spruces by a mountain lake · land × 1 · sky varied".to_owned();
        },
        |harness| {
            harness.state_mut().state.notify(super::super::Tone::Error, "The votes are not written", None);
            harness.hover_at(egui::pos2(60.0, 65.0));
        },
    ),
    (
        "first-small",
        [640.0, 400.0],
        1.0,
        egui::Theme::Dark,
        |model| {
            model.greets = true;
            model.views[3].name = "Spruces by a mountain lake · land × 1 · sky varied".to_owned();
        },
        nothing,
    ),
    ("error-small", [800.0, 600.0], 1.0, egui::Theme::Light, broken, nothing),
    (
        "single",
        [1280.0, 800.0],
        1.0,
        egui::Theme::Dark,
        |model| (model.count, model.votable, model.arrangement) = (1, false, Arrangement::One(0)),
        nothing,
    ),
    (
        "stuck",
        [800.0, 600.0],
        1.0,
        egui::Theme::Dark,
        |model| {
            (model.count, model.votable) = (1, false);
            model.situation = Situation::Stuck {
                title: "Nothing to show".to_owned(),
                what: "tree.glb is no landscape of Genescape: it has no terrain".to_owned(),
                remedy: "Drop a world here, a baked folder, or a scene.gltf that bake has written."
                    .to_owned(),
            };
        },
        nothing,
    ),
    (
        "growing",
        [1280.0, 800.0],
        1.0,
        egui::Theme::Light,
        |model| {
            model.situation = Situation::Growing;
            model.baking = baking();
        },
        nothing,
    ),
];

/// One of [`SCENES`], with landscapes of that size in its views.
fn draw(gpu: &Gpu, (_, size, scale, theme, prepare, act): Scene, picture_size: [usize; 2]) -> RgbaImage {
    let mut model = model();
    prepare(&mut model);
    let deltas = Deltas::default();
    let builder = Harness::builder().renderer(deltas.clone());
    let mut harness = build(model, size, scale, theme, picture_size, builder);
    act(&mut harness);
    harness.run_steps(40);
    paint(gpu, &harness, &deltas)
}

#[test]
fn pictures_for_people() {
    let Some(folder) = std::env::var_os("GENESCAPE_UI_PICTURES") else { return };
    let gpu = Gpu::headless().expect("an adapter; on Debian, mesa-vulkan-drivers has one in software");
    for scene in SCENES {
        let path = Path::new(&folder).join(scene.0).with_extension("png");
        image_file::write_png(&path, &draw(&gpu, scene, [960, 600])).expect("the folder can be written");
    }
}

/// Those of [`SCENES`] that together show every panel but the help, both themes, and views in every state.
const GOLDEN: [&str; 3] = ["small", "banner", "settings-light"];

/// Compared with pictures that a person has looked at, as `tests/golden.rs` does: `GENESCAPE_BLESS=1` writes them anew.
#[test]
fn the_interface_looks_as_it_did() {
    let Some(gpu) = Gpu::for_tests() else { return };
    for scene in SCENES.into_iter().filter(|scene| GOLDEN.contains(&scene.0)) {
        let name = format!("tests/golden/ui-{}.png", scene.0);
        let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join(&name);
        let drawn = draw(&gpu, scene, [8, 5]);
        if std::env::var_os("GENESCAPE_BLESS").is_some() {
            image_file::write_png(&golden, &drawn).expect("written");
        }
        let off = difference(
            &image::open(&golden).expect("a picture; GENESCAPE_BLESS=1 writes it").into_rgba8(),
            &drawn,
        );
        // An accent a shade redder is 0.004.
        assert!(off < 2e-4, "{name}: FLIP {off}");
    }
}

/// The mean of FLIP (Andersson et al. 2020).
fn difference(a: &RgbaImage, b: &RgbaImage) -> f32 {
    assert_eq!(a.dimensions(), b.dimensions());
    let image = |pixels: &RgbaImage| {
        let rgb: Vec<u8> = pixels.pixels().flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        nv_flip::FlipImageRgb8::with_data(pixels.width(), pixels.height(), &rgb)
    };
    let map = nv_flip::flip(image(a), image(b), nv_flip::DEFAULT_PIXELS_PER_DEGREE);
    nv_flip::FlipPool::from_image(&map).mean()
}
