//! How many trees the device drew at which level: copied back some frames later, so that nobody waits for it.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use genescape_schema::INDIVIDUALS;

use crate::gpu::Gpu;
use crate::ui::model::Stats;
use crate::upload::{MAX_LEVELS, TreeSet};

/// The most counters of a view: levels times kinds.
const MOST: usize = MAX_LEVELS * 16;

const IDLE: u8 = 0;
const COPIED: u8 = 1;
const ASKED: u8 = 2;
const THERE: u8 = 3;
const FAILED: u8 = 4;

/// Counters on their way back.
pub struct Tally {
    slots: [Slot; INDIVIDUALS],
}

struct Slot {
    buffer: wgpu::Buffer,
    state: Arc<AtomicU8>,
    kinds: usize,
    triangles: Vec<u32>,
    /// What came back last.
    counts: Vec<u32>,
}

impl Tally {
    /// With room for four views.
    pub fn new(gpu: &Gpu) -> Self {
        let slot = |_| Slot {
            buffer: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("tally"),
                size: 4 * MOST as u64,
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                mapped_at_creation: false,
            }),
            state: Arc::new(AtomicU8::new(IDLE)),
            kinds: 1,
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
        slot.kinds = set.template_count as usize;
        slot.triangles.clone_from(&set.triangles);
        encoder.copy_buffer_to_buffer(counts, 0, &slot.buffer, 0, counts.size());
        slot.state.store(COPIED, Ordering::Release);
    }

    /// After the frame was submitted: asks for what was copied.
    pub fn ask(&mut self) {
        for slot in &self.slots {
            if slot.state.load(Ordering::Acquire) != COPIED {
                continue;
            }
            slot.state.store(ASKED, Ordering::Release);
            let state = slot.state.clone();
            slot.buffer.slice(..).map_async(wgpu::MapMode::Read, move |result| {
                state.store(if result.is_ok() { THERE } else { FAILED }, Ordering::Release);
            });
        }
    }

    /// Takes what has come back into the statistics.
    pub fn read(&mut self, stats: &mut Stats) {
        for slot in &mut self.slots {
            match slot.state.load(Ordering::Acquire) {
                THERE => {
                    if let Ok(bytes) = slot.buffer.slice(..).get_mapped_range() {
                        let count = slot.triangles.len();
                        slot.counts = bytes
                            .chunks_exact(4)
                            .take(count)
                            .map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]))
                            .collect();
                    }
                    slot.buffer.unmap();
                    slot.state.store(IDLE, Ordering::Release);
                }
                FAILED => slot.state.store(IDLE, Ordering::Release),
                _ => {}
            }
        }
        stats.trees_per_level.clear();
        for (view, slot) in self.slots.iter().enumerate().filter(|(view, _)| stats.draws[*view] > 0) {
            for (bucket, (&trees, &triangles)) in slot.counts.iter().zip(&slot.triangles).enumerate() {
                let level = bucket / slot.kinds;
                if stats.trees_per_level.len() <= level {
                    stats.trees_per_level.resize(level + 1, 0);
                }
                stats.trees_per_level[level] += trees;
                stats.triangles[view] += u64::from(trees) * u64::from(triangles);
            }
        }
    }
}
