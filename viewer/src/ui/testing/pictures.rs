//! Pictures of the whole interface, painted by the same renderer as in the window, for people to look at: set
//! `GENESCAPE_UI_PICTURES` to a folder and run `cargo test -p genescape-viewer --lib ui::testing::pictures`.

use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;

use egui::TexturesDelta;
use egui_kittest::{Harness, TestRenderer};
use egui_wgpu::{RendererOptions, ScreenDescriptor};

use super::*;
use crate::event::Ballot;
use genescape_schema::Category;

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Keeps the textures that the interface made until they are painted.
#[derive(Clone, Default)]
struct Deltas(Rc<RefCell<Vec<TexturesDelta>>>);

impl TestRenderer for Deltas {
    fn handle_delta(&mut self, delta: &mut TexturesDelta) {
        self.0.borrow_mut().push(std::mem::take(delta));
    }
}

struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
}

fn gpu() -> Option<Gpu> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&Default::default())).ok()?;
    let (device, queue) = pollster::block_on(adapter.request_device(&Default::default())).ok()?;
    Some(Gpu { device, queue })
}

/// The harness's last frame as RGBA, with its size.
fn paint(gpu: &Gpu, harness: &Harness<'_, Bench>, deltas: &Deltas) -> (Vec<u8>, [u32; 2]) {
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
    {
        let mut pass = encoder
            .begin_render_pass(&wgpu::RenderPassDescriptor {
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..Default::default()
            })
            .forget_lifetime();
        renderer.render(&mut pass, &jobs, &screen);
    }
    gpu.queue.submit([encoder.finish()]);
    (read_back(gpu, &texture), screen.size_in_pixels)
}

fn read_back(gpu: &Gpu, texture: &wgpu::Texture) -> Vec<u8> {
    let row = (texture.width() * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(row) * u64::from(texture.height()),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
    let target = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), target, texture.size());
    gpu.queue.submit([encoder.finish()]);
    buffer.slice(..).map_async(wgpu::MapMode::Read, |_| {});
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device answers");
    let bytes = buffer.slice(..).get_mapped_range().expect("the buffer is mapped");
    bytes.chunks(row as usize).flat_map(|line| &line[..texture.width() as usize * 4]).copied().collect()
}

fn save(path: &Path, pixels: &[u8], [width, height]: [u32; 2]) {
    image::save_buffer(path, pixels, width, height, image::ExtendedColorType::Rgba8)
        .expect("the file can be written");
}

type Prepare = fn(&mut Model);
type Act = fn(&mut Harness<'static, Bench>);

fn nothing(_: &mut Harness<'static, Bench>) {}

fn voted(model: &mut Model) {
    model.ballots.set(Category::Tree, Ballot::For(0));
    model.ballots.set(Category::Terrain, Ballot::For(3));
    model.ballots.set(Category::Sky, Ballot::Nobody);
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
const SCENES: [Scene; 14] = [
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
    (
        "error",
        [1280.0, 800.0],
        1.0,
        egui::Theme::Dark,
        |model| {
            model.panels.genome = true;
            model.errors = vec![file_error()];
        },
        nothing,
    ),
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
            model.views[2].state = ViewState::Baking { done: 0, total: 0, stage: String::new() };
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
            harness
                .state_mut()
                .state
                .notify(super::super::Tone::Success, "Screenshot saved: world/screenshots/g0003.png");
            harness.state_mut().state.notify(super::super::Tone::Error, "space.ron: 2 errors");
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

#[test]
fn pictures_for_people() {
    let Some(folder) = std::env::var_os("GENESCAPE_UI_PICTURES") else { return };
    let gpu = gpu().expect("an adapter; on Debian, mesa-vulkan-drivers has one in software");
    for (name, size, scale, theme, prepare, act) in SCENES {
        let mut model = model();
        prepare(&mut model);
        let deltas = Deltas::default();
        let builder = Harness::builder().renderer(deltas.clone());
        let mut harness = build(model, size, scale, theme, [960, 600], builder);
        act(&mut harness);
        harness.run_steps(40);
        let (pixels, size_px) = paint(&gpu, &harness, &deltas);
        save(&Path::new(&folder).join(format!("{name}.png")), &pixels, size_px);
    }
}
