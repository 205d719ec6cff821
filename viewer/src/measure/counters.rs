//! What the device itself counts of one picture, where it can: its time, vertices, triangles, pixels.

use anyhow::Result;
use wgpu::{Features, PipelineStatisticsTypes as Statistics, QueryType};

use crate::gpu::Gpu;
use crate::image_file::read_buffer;
use crate::view::View;

/// In the order in which devices write them.
const STATISTICS: Statistics = Statistics::VERTEX_SHADER_INVOCATIONS
    .union(Statistics::CLIPPER_INVOCATIONS)
    .union(Statistics::FRAGMENT_SHADER_INVOCATIONS);
/// Where the statistics begin in the buffer: two timestamps before them, and wgpu's alignment.
const STATISTICS_AT: u64 = wgpu::QUERY_RESOLVE_BUFFER_ALIGNMENT;
const BYTES: u64 = STATISTICS_AT + 3 * size_of::<u64>() as u64;

/// Queries of one picture.
#[derive(Debug)]
pub struct Counters {
    timestamps: Option<wgpu::QuerySet>,
    statistics: Option<wgpu::QuerySet>,
    resolved: wgpu::Buffer,
    ms_per_tick: f64,
}

/// What was counted; `None` where the device cannot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counted {
    /// Milliseconds from the picture's first command to its last.
    pub gpu_ms: Option<f64>,
    /// Vertices that a vertex shader worked on in the pass that draws the landscape.
    pub vertices: Option<u64>,
    /// Triangles that came out of these.
    pub triangles: Option<u64>,
    /// Pixels (samples of edges once) that a fragment shader worked on.
    pub fragments: Option<u64>,
}

impl Counters {
    pub fn new(gpu: &Gpu) -> Self {
        let set = |needed: Features, ty: QueryType, count: u32| {
            let descriptor = wgpu::QuerySetDescriptor { label: Some("counters"), ty, count };
            gpu.features.contains(needed).then(|| gpu.device.create_query_set(&descriptor))
        };
        let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        Self {
            timestamps: set(
                Features::TIMESTAMP_QUERY | Features::TIMESTAMP_QUERY_INSIDE_ENCODERS,
                QueryType::Timestamp,
                2,
            ),
            statistics: set(
                Features::PIPELINE_STATISTICS_QUERY,
                QueryType::PipelineStatistics(STATISTICS),
                1,
            ),
            resolved: gpu.empty_buffer("counters", BYTES, usage),
            ms_per_tick: f64::from(gpu.queue.get_timestamp_period()) * 1e-6,
        }
    }

    /// Has a view's pictures counted from now on.
    pub fn watch(&self, view: &mut View) {
        view.count(self.statistics.clone());
    }

    /// Before what draws one picture of a watched view is recorded.
    pub fn begin(&self, encoder: &mut wgpu::CommandEncoder) {
        self.timestamps.iter().for_each(|set| encoder.write_timestamp(set, 0));
    }

    /// After it.
    pub fn end(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some(set) = &self.timestamps {
            encoder.write_timestamp(set, 1);
            encoder.resolve_query_set(set, 0..2, &self.resolved, 0);
        }
        if let Some(set) = &self.statistics {
            encoder.resolve_query_set(set, 0..1, &self.resolved, STATISTICS_AT);
        }
    }

    /// What was counted of the last picture that was handed over.
    ///
    /// # Errors
    /// A device that was lost.
    pub fn read(&self, gpu: &Gpu) -> Result<Counted> {
        let bytes = read_buffer(gpu, &self.resolved)?;
        let numbers: Vec<u64> = bytemuck::pod_collect_to_vec(&bytes);
        let counted = |at: u64| {
            let number = numbers.get((STATISTICS_AT / 8 + at) as usize).copied();
            number.filter(|_| self.statistics.is_some())
        };
        let ticks = numbers[1].saturating_sub(numbers[0]);
        Ok(Counted {
            gpu_ms: self.timestamps.as_ref().map(|_| ticks as f64 * self.ms_per_tick),
            vertices: counted(0),
            triangles: counted(1),
            fragments: counted(2),
        })
    }
}
