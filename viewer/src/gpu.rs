//! The device that draws, and what it can do.

use std::sync::{Arc, PoisonError, RwLock};

use bytemuck::NoUninit;
use thiserror::Error;
use wgpu::{Adapter, Buffer, BufferUsages, Instance, Surface, TextureView};

/// The device with its queue; cheap to clone.
#[derive(Clone, Debug)]
pub struct Gpu {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    /// "llvmpipe (LLVM 15.0.6, 256 bits)".
    pub name: String,
    /// "llvmpipe Mesa 22.3.6", as the driver calls itself.
    pub driver: String,
    /// True if there is no graphics card and the processor draws.
    pub software: bool,
    /// Optional features that this device has.
    pub features: wgpu::Features,
    /// Held to read by threads in the background while the device works for them.
    busy: Arc<RwLock<()>>,
}

/// What to do where no device is found.
const ADVICE: &str = "Genescape draws with Vulkan, Metal or Direct3D 12. On Linux install your card's Vulkan driver, or, \
    to draw without a card, the package mesa-vulkan-drivers (Debian, Ubuntu, Fedora) or vulkan-swrast (Arch).";

/// Why nothing can be drawn. Reasons are in the text, and so no sources, as in [`LoadError`](crate::load::LoadError).
#[derive(Debug, Error)]
pub enum GpuError {
    #[error("no graphics device was found: {0}\n{ADVICE}")]
    NoAdapter(wgpu::RequestAdapterError),
    #[error("no graphics device can draw to the window: {0}\n{ADVICE}")]
    NoSurface(wgpu::CreateSurfaceError),
    #[error("{name} lacks {missing}, which is needed to draw; try a newer driver")]
    Lacking { name: String, missing: String },
    #[error("{name} could not be opened: {reason}")]
    NoDevice { name: String, reason: wgpu::RequestDeviceError },
}

/// What drawing cannot do without: trees are drawn by commands that a compute pass writes, each starting at an
/// instance of its own.
const REQUIRED: wgpu::Features = wgpu::Features::INDIRECT_FIRST_INSTANCE;

/// What is used where the adapter has it.
const OPTIONAL: wgpu::Features = wgpu::Features::POLYGON_MODE_LINE
    .union(wgpu::Features::PIPELINE_STATISTICS_QUERY)
    .union(wgpu::Features::TIMESTAMP_QUERY)
    .union(wgpu::Features::TIMESTAMP_QUERY_INSIDE_ENCODERS)
    .union(wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES);

impl Gpu {
    /// Opens the best device that can also draw to `surface`, if one is given.
    pub fn open(instance: &Instance, surface: Option<&Surface<'_>>) -> Result<(Self, Adapter), GpuError> {
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            compatible_surface: surface,
            ..Default::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&options)).map_err(GpuError::NoAdapter)?;
        let (info, limits) = (adapter.get_info(), adapter.limits());
        let missing = REQUIRED - adapter.features();
        if !missing.is_empty() {
            return Err(GpuError::Lacking { name: info.name, missing: missing.to_string() });
        }
        let features = REQUIRED | (OPTIONAL & adapter.features());
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("genescape"),
            required_features: features,
            // The defaults, with room for great forests where the adapter has it.
            required_limits: wgpu::Limits {
                max_buffer_size: limits.max_buffer_size,
                max_storage_buffer_binding_size: limits.max_storage_buffer_binding_size,
                max_texture_dimension_2d: limits.max_texture_dimension_2d,
                ..Default::default()
            },
            ..Default::default()
        };
        let opened = pollster::block_on(adapter.request_device(&descriptor));
        let (device, queue) =
            opened.map_err(|reason| GpuError::NoDevice { name: info.name.clone(), reason })?;
        let software = info.device_type == wgpu::DeviceType::Cpu;
        let driver = format!("{} {}", info.driver, info.driver_info).trim().to_owned();
        let busy = Arc::default();
        Ok((Self { device, queue, name: info.name, driver, software, features, busy }, adapter))
    }

    /// Opens a device that draws to memory only.
    pub fn headless() -> Result<Self, GpuError> {
        Ok(Self::open(&instance(), None)?.0)
    }

    /// A device that draws to memory only; where there is none, tests are skipped unless they must not be.
    #[cfg(test)]
    pub fn for_tests() -> Option<Self> {
        let gpu = Self::headless();
        if let Err(error) = &gpu {
            assert!(std::env::var_os("GENESCAPE_NEEDS_GPU").is_none(), "{error}");
            crate::say!("SKIPPED, for nothing can draw here: {error}");
        }
        gpu.ok()
    }

    /// A buffer with these contents.
    pub fn buffer<T: NoUninit>(&self, label: &str, contents: &[T], usage: BufferUsages) -> Buffer {
        use wgpu::util::DeviceExt;
        let contents: &[u8] = bytemuck::cast_slice(contents);
        // Empty buffers cannot be bound.
        let contents = if contents.is_empty() { &[0; 16] } else { contents };
        let descriptor = wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage };
        self.device.create_buffer_init(&descriptor)
    }

    /// A buffer of at least that many bytes.
    pub fn empty_buffer(&self, label: &str, bytes: u64, usage: BufferUsages) -> Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            // Empty buffers cannot be bound.
            size: bytes.max(16),
            usage,
            mapped_at_creation: false,
        })
    }

    /// A texture with these texels: layer by layer, in each mip level by mip level.
    pub fn texture(&self, descriptor: &wgpu::TextureDescriptor<'_>, texels: &[u8]) -> wgpu::Texture {
        use wgpu::util::{DeviceExt, TextureDataOrder::LayerMajor};
        self.device.create_texture_with_data(&self.queue, descriptor, LayerMajor, texels)
    }

    /// Hands over work of a thread in the background and waits until it is done.
    pub fn work(&self, commands: wgpu::CommandBuffer) {
        let _busy = self.busy.read().unwrap_or_else(PoisonError::into_inner);
        let submitted = self.queue.submit([commands]);
        // An error here means a lost device, which the next call reports.
        let _ = self.device.poll(wgpu::PollType::Wait { submission_index: Some(submitted), timeout: None });
    }

    /// Gives a surface its size and format. No thread may hand over work meanwhile: wgpu would end the program.
    pub fn configure(&self, surface: &Surface<'_>, config: &wgpu::SurfaceConfiguration) {
        let _idle = self.busy.write().unwrap_or_else(PoisonError::into_inner);
        surface.configure(&self.device, config);
    }

    /// Waits until everything that was submitted is done.
    pub fn wait(&self) {
        // An error here means a lost device, which the next call reports.
        let _ = self.device.poll(wgpu::PollType::wait_indefinitely());
    }
}

/// A picture to draw into, all `color` at first.
pub fn cleared<'a>(
    view: &'a TextureView,
    resolve_target: Option<&'a TextureView>,
    color: wgpu::Color,
) -> Option<wgpu::RenderPassColorAttachment<'a>> {
    let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(color), store: wgpu::StoreOp::Store };
    Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target, ops })
}

/// A texture of one layer with one mip level and one sample a texel.
pub fn flat(
    label: &str,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::TextureDescriptor<'_> {
    wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    }
}

/// The library's entry; `WGPU_BACKEND` and its like choose among several drivers.
pub fn instance() -> wgpu::Instance {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
    // Labels are for debuggers, and Mesa 22.3's llvmpipe (Debian 12) dies of them sooner or later, where the names of
    // nested groups are kept. WGPU_DISCARD_HAL_LABELS=0 brings them back.
    descriptor.flags = (descriptor.flags | wgpu::InstanceFlags::DISCARD_HAL_LABELS).with_env();
    wgpu::Instance::new(descriptor)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc;
    use std::time::Duration;

    #[test]
    #[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
    fn nobody_hands_over_work_while_a_surface_is_configured() {
        let Some(gpu) = Gpu::for_tests() else { return };
        let (done, is_done) = mpsc::channel();
        let configuring = gpu.busy.write().expect("no panic");
        std::thread::scope(|scope| {
            scope.spawn(|| {
                gpu.work(gpu.device.create_command_encoder(&Default::default()).finish());
                done.send(()).expect("awaited");
            });
            let early = is_done.recv_timeout(Duration::from_millis(200));
            drop(configuring);
            assert_eq!(early, Err(mpsc::RecvTimeoutError::Timeout));
            assert_eq!(is_done.recv_timeout(Duration::from_secs(60)), Ok(()));
        });
    }
}
