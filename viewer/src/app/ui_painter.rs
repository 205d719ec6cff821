//! The user interface's triangles → draws with a shader of our own: texts, surfaces, and the landscapes' pictures
//! among them.
//!
//! egui's own shader asks for each pixel how to filter and whether to dither. Where the processor draws, both answers of
//! each question are computed, and painting a window took longer than walking through its four landscapes.

use std::collections::BTreeMap;
use std::ops::Range;

use egui::epaint::{ClippedPrimitive, Mesh, Primitive, Vertex};
use egui::{PaintCallbackInfo, Rect, TextureId, TextureOptions};
use egui_wgpu::{Callback, CallbackResources, CallbackTrait};
use wgpu::{BlendComponent, BlendFactor, BufferUsages};

use crate::gpu::Gpu;

/// Knows the pictures by the numbers that the user interface has for them, [`TextureId::User`]; its own textures are egui's.
pub struct UiPainter {
    gpu: Gpu,
    pipelines: Pipelines,
    /// Pictures of less than full resolution are stretched.
    linear: wgpu::Sampler,
    pictures: BTreeMap<u64, wgpu::BindGroup>,
}

impl UiPainter {
    /// For targets of that format, whose values are encoded for the screen.
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        let filter = wgpu::FilterMode::Linear;
        let linear = wgpu::SamplerDescriptor { mag_filter: filter, min_filter: filter, ..Default::default() };
        Self {
            gpu: gpu.clone(),
            pipelines: Pipelines::new(&gpu.device, format),
            linear: gpu.device.create_sampler(&linear),
            pictures: BTreeMap::new(),
        }
    }

    /// Says what the picture of that number is from now on.
    pub fn set(&mut self, number: u64, texture: &wgpu::TextureView) -> TextureId {
        let group = self.group(texture);
        self.pictures.insert(number, group);
        TextureId::User(number)
    }

    fn group(&self, texture: &wgpu::TextureView) -> wgpu::BindGroup {
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        self.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("picture"),
            layout: &self.pipelines.group,
            entries: &[
                entry(0, wgpu::BindingResource::TextureView(texture)),
                entry(1, wgpu::BindingResource::Sampler(&self.linear)),
            ],
        })
    }

    /// Replaces all that egui would paint, unless it is to be filtered otherwise. `screen`: the whole window, in points;
    /// `egui` knows the textures of this frame.
    pub fn take_over(&self, shapes: &mut [ClippedPrimitive], screen: Rect, egui: &egui_wgpu::Renderer) {
        let mut own: BTreeMap<u64, Option<wgpu::BindGroup>> = BTreeMap::new();
        for shape in shapes {
            let Primitive::Mesh(mesh) = &shape.primitive else { continue };
            let group = match mesh.texture_id {
                TextureId::User(number) => self.pictures.get(&number),
                TextureId::Managed(number) => own
                    .entry(number)
                    .or_insert_with(|| self.group_of(egui.texture(&mesh.texture_id)?))
                    .as_ref(),
            };
            if let Some(group) = group {
                let painted = self.painted(mesh, group, screen);
                shape.primitive = Primitive::Callback(Callback::new_paint_callback(screen, painted));
            }
        }
    }

    /// Of one of egui's textures.
    fn group_of(&self, texture: &egui_wgpu::Texture) -> Option<wgpu::BindGroup> {
        texture.options.filter(|options| *options == TextureOptions::LINEAR)?;
        Some(self.group(&texture.texture.as_ref()?.create_view(&Default::default())))
    }

    fn painted(&self, mesh: &Mesh, group: &wgpu::BindGroup, screen: Rect) -> Painted {
        let place = |vertex: &Vertex| {
            let at = (vertex.pos - screen.min) / screen.size() * 2.0;
            Vertex { pos: egui::pos2(at.x - 1.0, 1.0 - at.y), ..*vertex }
        };
        let vertices: Vec<Vertex> = mesh.vertices.iter().map(place).collect();
        // A picture has no transparent pixels, and its triangles lie beside each other.
        let is_picture = matches!(mesh.texture_id, TextureId::User(_));
        let is_opaque = |triangle: &&[u32]| {
            is_picture && triangle.iter().all(|vertex| mesh.vertices[*vertex as usize].color.is_opaque())
        };
        let triangles = mesh.indices.chunks_exact(3);
        let (opaque, soft): (Vec<&[u32]>, Vec<&[u32]>) = triangles.partition(is_opaque);
        let (first_soft, indices) = (3 * opaque.len() as u32, [opaque, soft].concat().concat());
        Painted {
            pipelines: self.pipelines.clone(),
            group: group.clone(),
            vertices: self.gpu.buffer("picture", &vertices, BufferUsages::VERTEX),
            indices: self.gpu.buffer("picture triangles", &indices, BufferUsages::INDEX),
            opaque: 0..first_soft,
            soft: first_soft..indices.len() as u32,
        }
    }
}

/// What was one mesh.
struct Painted {
    pipelines: Pipelines,
    group: wgpu::BindGroup,
    /// [`Vertex`] with places in clip space.
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    /// Nearly all of a picture. To blend it would take as long as to look it up.
    opaque: Range<u32>,
    /// The rest, in its order.
    soft: Range<u32>,
}

impl CallbackTrait for Painted {
    fn paint(&self, _: PaintCallbackInfo, pass: &mut wgpu::RenderPass<'static>, _: &CallbackResources) {
        pass.set_bind_group(0, &self.group, &[]);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        if !self.opaque.is_empty() {
            pass.set_pipeline(&self.pipelines.opaque);
            pass.draw_indexed(self.opaque.clone(), 0, 0..1);
        }
        pass.set_pipeline(&self.pipelines.soft);
        pass.draw_indexed(self.soft.clone(), 0, 0..1);
    }
}

#[derive(Clone)]
struct Pipelines {
    group: wgpu::BindGroupLayout,
    opaque: wgpu::RenderPipeline,
    soft: wgpu::RenderPipeline,
}

impl Pipelines {
    fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        use wgpu::{BindingType, SamplerBindingType, TextureSampleType, TextureViewDimension};
        let picture = BindingType::Texture {
            sample_type: TextureSampleType::Float { filterable: true },
            view_dimension: TextureViewDimension::D2,
            multisampled: false,
        };
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty,
            count: None,
        };
        let group = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("picture"),
            entries: &[entry(0, picture), entry(1, BindingType::Sampler(SamplerBindingType::Filtering))],
        });
        // As egui: colours are multiplied by their alpha already.
        let part =
            |src_factor, dst_factor| BlendComponent { src_factor, dst_factor, ..BlendComponent::REPLACE };
        let blend = wgpu::BlendState {
            color: part(BlendFactor::One, BlendFactor::OneMinusSrcAlpha),
            alpha: part(BlendFactor::OneMinusDstAlpha, BlendFactor::One),
        };
        Self {
            opaque: pipeline(device, &group, format, None),
            soft: pipeline(device, &group, format, Some(blend)),
            group,
        }
    }
}

fn pipeline(
    device: &wgpu::Device,
    group: &wgpu::BindGroupLayout,
    format: wgpu::TextureFormat,
    blend: Option<wgpu::BlendState>,
) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::include_wgsl!("ui_painter.wgsl"));
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("pictures"),
        bind_group_layouts: &[Some(group)],
        immediate_size: 0,
    });
    let attributes = wgpu::vertex_attr_array![0 => Float32x2, 1 => Float32x2, 2 => Unorm8x4];
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("pictures"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: Default::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<Vertex>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &attributes,
            })],
        },
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: Default::default(),
            targets: &[Some(wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL })],
        }),
        multiview_mask: None,
        cache: None,
    })
}

#[cfg(test)]
mod tests {
    use egui::epaint::{ClippedShape, ImageDelta, RectShape, TessellationOptions, Tessellator};
    use egui::{Color32, ColorImage, Shape, pos2, vec2};
    use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};
    use image::RgbaImage;

    use super::*;
    use crate::gpu::{cleared, flat};
    use crate::image_file;

    const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
    const SIZE_PX: [u32; 2] = [120, 90];

    /// Four by four colours.
    fn chessboard(gpu: &Gpu) -> wgpu::TextureView {
        let texels: Vec<u8> = (0..16u8).flat_map(|n| [n * 16, 255 - n * 9, (n & 1) * 200, 255]).collect();
        let usage = wgpu::TextureUsages::TEXTURE_BINDING;
        gpu.texture(&flat("chessboard", [4, 4], FORMAT, usage), &texels).create_view(&Default::default())
    }

    /// Eight by eight, as egui keeps its letters.
    fn atlas() -> ImageDelta {
        let pixel = |n: usize| Color32::from_rgba_premultiplied(n as u8, 90, 60, 90 + n as u8);
        let pixels = (0..64).map(pixel).collect();
        let image = ColorImage { size: [8, 8], source_size: vec2(8.0, 8.0), pixels };
        ImageDelta::full(image, TextureOptions::LINEAR)
    }

    /// A dimmed picture with round corners, partly cut off, and a surface that lies over a corner of it, as triangles.
    fn shapes() -> Vec<ClippedPrimitive> {
        let place = Rect::from_min_size(pos2(10.0, 7.0), vec2(70.0, 61.0));
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        let shape = RectShape::filled(place, 9, Color32::from_gray(180));
        let shape = Shape::from(shape.with_texture(TextureId::User(0), whole));
        let above = Rect::from_min_size(pos2(50.0, 40.0), vec2(60.0, 40.0));
        let surface = RectShape::filled(above, 5, Color32::from_rgb(90, 220, 160));
        let surface = Shape::from(surface.with_texture(TextureId::default(), whole));
        let mut tessellator = Tessellator::new(1.0, TessellationOptions::default(), [1, 1], Vec::new());
        let shapes = vec![
            ClippedShape::new(place.with_max_x(75.0), shape),
            ClippedShape::new(above.with_max_y(77.0), surface),
        ];
        tessellator.tessellate_shapes(shapes)
    }

    fn draw(gpu: &Gpu, renderer: &mut Renderer, shapes: &[ClippedPrimitive]) -> RgbaImage {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
        let texture = gpu.device.create_texture(&flat("screen", SIZE_PX, FORMAT, usage));
        let screen = ScreenDescriptor { size_in_pixels: SIZE_PX, pixels_per_point: 1.0 };
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        renderer.update_buffers(&gpu.device, &gpu.queue, &mut encoder, shapes, &screen);
        let view = texture.create_view(&Default::default());
        let red = wgpu::Color { r: 0.8, g: 0.1, b: 0.1, a: 1.0 };
        let descriptor = wgpu::RenderPassDescriptor {
            color_attachments: &[cleared(&view, None, red)],
            ..Default::default()
        };
        renderer.render(&mut encoder.begin_render_pass(&descriptor).forget_lifetime(), shapes, &screen);
        gpu.queue.submit([encoder.finish()]);
        image_file::read(gpu, &texture).expect("the device answers")
    }

    #[test]
    fn all_looks_as_if_egui_had_painted_it() {
        let Some(gpu) = Gpu::for_tests() else { return };
        let (picture, mut shapes) = (chessboard(&gpu), shapes());
        let mut renderer = Renderer::new(&gpu.device, FORMAT, RendererOptions::PREDICTABLE);
        let id = renderer.register_native_texture(&gpu.device, &picture, wgpu::FilterMode::Linear);
        assert_eq!(id, TextureId::User(0));
        renderer.update_texture(&gpu.device, &gpu.queue, TextureId::default(), &atlas());
        let theirs = draw(&gpu, &mut renderer, &shapes);
        let mut painter = UiPainter::new(&gpu, FORMAT);
        painter.set(0, &picture);
        let [width, height] = SIZE_PX.map(|side| side as f32);
        painter.take_over(&mut shapes, Rect::from_min_size(pos2(0.0, 0.0), vec2(width, height)), &renderer);
        assert!(shapes.iter().all(|shape| matches!(shape.primitive, Primitive::Callback(_))));
        let ours = draw(&gpu, &mut renderer, &shapes);
        let off = ours.as_raw().iter().zip(theirs.as_raw()).map(|(a, b)| a.abs_diff(*b)).max();
        // Rounding, in each of two layers.
        assert!(off <= Some(2), "{off:?}");
        let distinct: std::collections::BTreeSet<_> = ours.pixels().map(|pixel| pixel.0).collect();
        assert!(distinct.len() > 500, "{} colours", distinct.len());
    }
}
