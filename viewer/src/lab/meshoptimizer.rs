//! The same tree simplified by meshoptimizer, where the viewer was built with it.

use crate::scene::Template;

/// A template with as many levels, each with as many triangles of each material, made by meshoptimizer of the full tree;
/// `None` in viewers that were built without it.
#[cfg(feature = "meshopt")]
pub fn alike(template: &Template) -> Option<Template> {
    use crate::scene::{Level, Range, TreeVertex};
    use meshopt::{SimplifyOptions, VertexDataAdapter};

    let full = template.levels.first()?;
    let end = template.levels.get(1).map_or(template.vertices.len(), |next| next.base_vertex as usize);
    let vertices = template.vertices.get(full.base_vertex as usize..end)?;
    let adapter = VertexDataAdapter::new(bytemuck::cast_slice(vertices), size_of::<TreeVertex>(), 0).ok()?;
    let part = |range: &Range| {
        let first = range.first as usize;
        template.indices.get(first..first + range.count as usize).unwrap_or_default()
    };
    let are_leaves = |at: &usize| *at > 0 && !template.materials[*at].clusters;
    let leaves = || (0..full.ranges.len()).filter(are_leaves);
    let all_leaves: u32 = leaves().map(|at| full.ranges[at].count / 3).sum();
    // Triangles of clusters stand for leaves, so leaves get them.
    let wanted = |level: &Level, at: usize| {
        let of_clusters = (0..level.ranges.len()).filter(|&at| template.materials[at].clusters);
        let shared: u32 = of_clusters.map(|at| level.ranges[at].count / 3).sum();
        let share =
            if are_leaves(&at) { shared * (full.ranges[at].count / 3) / all_leaves.max(1) } else { 0 };
        level.ranges[at].count as usize + 3 * share as usize
    };
    let mut indices = Vec::new();
    let mut levels = Vec::new();
    for level in &template.levels {
        let mut ranges = Vec::new();
        for (at, range) in full.ranges.iter().enumerate() {
            let (count, first) = (wanted(level, at), indices.len() as u32);
            // Leaves are pieces of their own: without pruning none would ever go.
            let options = SimplifyOptions::Prune | SimplifyOptions::Permissive;
            let simple = match part(range) {
                whole if whole.len() <= count => whole.to_vec(),
                whole => meshopt::simplify(whole, &adapter, count, f32::MAX, options, None),
            };
            ranges.push(Range { first, count: simple.len() as u32 });
            indices.extend(simple);
        }
        // All of them are made of the full tree's vertices.
        let strips = Vec::new();
        levels.push(Level { error_m: level.error_m, base_vertex: full.base_vertex, ranges, strips });
    }
    let blob = format!("{} by meshoptimizer", template.blob);
    Some(Template { blob, indices, levels, clusters: None, ..template.clone() })
}

/// `None`: this viewer was built without it.
#[cfg(not(feature = "meshopt"))]
pub fn alike(_: &Template) -> Option<Template> {
    None
}
