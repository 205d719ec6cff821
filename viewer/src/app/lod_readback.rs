//! How many trees the device drew at which level: fetched in the background, so that no frame waits for it.

use std::sync::mpsc::{Receiver, Sender, channel};

use genescape_schema::INDIVIDUALS;
use wgpu::util::DownloadBuffer;

use crate::gpu::Gpu;
use crate::ui::model::Stats;
use crate::upload::TreeSet;

/// What comes back: which view, and its counters unless the device was lost.
type Reply = (usize, Option<Vec<u32>>);

/// Counters on their way back, for each view.
pub struct LodReadback {
    views: [Counters; INDIVIDUALS],
    answer: Sender<Reply>,
    replies: Receiver<Reply>,
}

#[derive(Default)]
struct Counters {
    /// Asked for and not yet there.
    pending: bool,
    templates: usize,
    /// Triangles of one tree, by counter: level by level, in each template by template.
    triangles: Vec<u32>,
    /// Trees, as they came back last.
    trees: Vec<u32>,
}

impl LodReadback {
    pub fn new() -> Self {
        let (answer, replies) = channel();
        Self { views: Default::default(), answer, replies }
    }

    /// Asks for a view's counters as the last submitted frame left them, unless others are still on their way.
    pub fn request(&mut self, gpu: &Gpu, view: usize, set: &TreeSet, counts: &wgpu::Buffer) {
        let counters = &mut self.views[view];
        if std::mem::replace(&mut counters.pending, true) {
            return;
        }
        counters.templates = set.template_count as usize;
        counters.triangles.clone_from(&set.triangles);
        let answer = self.answer.clone();
        DownloadBuffer::read_buffer(&gpu.device, &gpu.queue, &counts.slice(..), move |bytes| {
            let trees = bytes.ok().map(|bytes| bytemuck::pod_collect_to_vec(&bytes));
            // The receiver is gone only when the window is.
            let _ = answer.send((view, trees));
        });
    }

    /// Whether some counters are still on their way.
    pub fn is_pending(&self) -> bool {
        self.views.iter().any(|view| view.pending)
    }

    /// Takes what has come back into the statistics.
    pub fn read(&mut self, stats: &mut Stats) {
        for (view, trees) in self.replies.try_iter() {
            self.views[view].pending = false;
            self.views[view].trees = trees.unwrap_or_default();
        }
        stats.trees_per_level.clear();
        for (view, counters) in self.views.iter().enumerate() {
            if stats.draws[view] > 0 {
                counters.add_to(stats, view);
            }
        }
    }
}

impl Counters {
    fn add_to(&self, stats: &mut Stats, view: usize) {
        let levels = &mut stats.trees_per_level;
        for (counter, (&trees, &triangles)) in self.trees.iter().zip(&self.triangles).enumerate() {
            let level = counter / self.templates;
            levels.resize(levels.len().max(level + 1), 0);
            levels[level] += trees;
            stats.triangles[view] += u64::from(trees) * u64::from(triangles);
        }
    }
}
