//! How many trees the device drew at which level: copied back some frames later, so that no frame waits for it.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use genescape_schema::INDIVIDUALS;

use crate::gpu::Gpu;
use crate::ui::model::Stats;
use crate::upload::{MAX_LEVELS, TreeSet};

/// Counters of a view: levels times templates.
const MAX_COUNTERS: usize = MAX_LEVELS * 16;

/// What becomes of a slot's buffer, in this order and around again.
const IDLE: u8 = 0;
const COPIED: u8 = 1;
const MAPPING: u8 = 2;
const MAPPED: u8 = 3;

/// Counters on their way back, for each view.
pub struct LodReadback {
    slots: [Slot; INDIVIDUALS],
}

struct Slot {
    buffer: wgpu::Buffer,
    state: Arc<AtomicU8>,
    templates: usize,
    /// Of one tree, by counter.
    triangles: Vec<u32>,
    /// What came back last.
    counts: Vec<u32>,
}

impl LodReadback {
    pub fn new(gpu: &Gpu) -> Self {
        let slot = |_| Slot {
            buffer: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("LOD readback"),
                size: 4 * MAX_COUNTERS as u64,
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                mapped_at_creation: false,
            }),
            state: Arc::new(AtomicU8::new(IDLE)),
            templates: 1,
            triangles: Vec::new(),
            counts: Vec::new(),
        };
        Self { slots: std::array::from_fn(slot) }
    }

    /// Records the copy of a view's counters, unless an earlier one is still on its way.
    pub fn copy(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        view: usize,
        set: &TreeSet,
        counts: &wgpu::Buffer,
    ) {
        let slot = &mut self.slots[view];
        if slot.state.load(Ordering::Acquire) != IDLE || counts.size() > slot.buffer.size() {
            return;
        }
        slot.templates = set.template_count as usize;
        slot.triangles.clone_from(&set.triangles);
        encoder.copy_buffer_to_buffer(counts, 0, &slot.buffer, 0, counts.size());
        slot.state.store(COPIED, Ordering::Release);
    }

    /// After the frame was submitted: asks for what was copied.
    pub fn map(&mut self) {
        let copied = |slot: &&Slot| slot.state.load(Ordering::Acquire) == COPIED;
        for slot in self.slots.iter().filter(copied) {
            slot.state.store(MAPPING, Ordering::Release);
            let state = slot.state.clone();
            slot.buffer.slice(..).map_async(wgpu::MapMode::Read, move |result| {
                state.store(if result.is_ok() { MAPPED } else { IDLE }, Ordering::Release);
            });
        }
    }

    /// Takes what has come back into the statistics.
    pub fn read(&mut self, stats: &mut Stats) {
        stats.trees_per_level.clear();
        for (view, slot) in self.slots.iter_mut().enumerate() {
            slot.read();
            if stats.draws[view] > 0 {
                slot.add_to(stats, view);
            }
        }
    }
}

impl Slot {
    fn read(&mut self) {
        if self.state.load(Ordering::Acquire) != MAPPED {
            return;
        }
        if let Ok(bytes) = self.buffer.slice(..).get_mapped_range() {
            self.counts = bytemuck::pod_collect_to_vec(&bytes);
            self.counts.truncate(self.triangles.len());
        }
        self.buffer.unmap();
        self.state.store(IDLE, Ordering::Release);
    }

    fn add_to(&self, stats: &mut Stats, view: usize) {
        let levels = &mut stats.trees_per_level;
        for (counter, (&trees, &triangles)) in self.counts.iter().zip(&self.triangles).enumerate() {
            let level = counter / self.templates;
            levels.resize(levels.len().max(level + 1), 0);
            levels[level] += trees;
            stats.triangles[view] += u64::from(trees) * u64::from(triangles);
        }
    }
}
