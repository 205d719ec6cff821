//! What a profiler has measured → the time of each pass.

use wgpu_profiler::GpuTimerQueryResult;

/// Names and milliseconds on the device; of a pass that is timed in parts, those of its parts.
pub fn timed(queries: &[GpuTimerQueryResult]) -> Vec<(String, f32)> {
    let of = |query: &GpuTimerQueryResult| {
        if query.nested_queries.iter().any(|part| part.time.is_some()) {
            return timed(&query.nested_queries);
        }
        let ms = query.time.as_ref().map(|time| ((time.end - time.start) * 1e3) as f32);
        ms.map(|ms| (query.label.clone(), ms)).into_iter().collect()
    };
    queries.iter().flat_map(of).collect()
}
