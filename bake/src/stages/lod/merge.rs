//! One edge collapse, decided → the mesh after it, with every change in the log.
//!
//! Both sides of a texture seam or crease merge in one collapse, each with its own attributes interpolated along the
//! edge. A wedge that the edge does not touch keeps its attributes.

use glam::DVec3;

use super::edge::Edge;
use super::log::Vertex;
use super::state::{NONE, State};
use super::topology::Topology;

/// Collapses `edge` into its first point. The new vertex lies at `at`, and has the attributes found `along` the edge
/// (0 at its first point, 1 at its second).
pub fn merge(topology: &mut Topology, state: &mut State, edge: &Edge, along: f32, at: DVec3) {
    let vertices_before = state.vertex_count;
    let [a, b] = edge.points;
    let merged_into = merged_wedges(edge);
    let mut wedges: Vec<u32> = Vec::with_capacity(8);
    topology.seen.clear();
    for &corner in edge.stars.iter().flatten() {
        let vertex = state.vertex_at(corner);
        if topology.seen.insert(vertex) {
            wedges.push(vertex);
        }
    }
    let opposite = &edge.triangles.opposite[..edge.triangles.count];
    for t in opposite.iter().map(|corner| corner / 3) {
        state.remove_triangle(t);
        for vertex in state.triangles[t as usize] {
            topology.uses[vertex as usize] -= 1;
        }
    }
    for &corner in &edge.stars[1] {
        let vertex = state.vertex_at(corner);
        if state.triangle_lives[corner as usize / 3]
            && let Some(kept) = merged_into(vertex)
        {
            state.change_corner(corner, kept);
            topology.uses[vertex as usize] -= 1;
            topology.uses[kept as usize] += 1;
        }
    }
    settle_wedges(topology, state, edge, along, at, &wedges);
    for &corner in opposite {
        let apex = state.vertex_at(corner);
        if topology.uses[apex as usize] == 0 && state.vertex_lives[apex as usize] {
            topology.wedges[topology.point_of[apex as usize] as usize] -= 1;
            state.remove_vertex(apex, NONE);
        }
    }
    topology.join(a, b);
    topology.flags[a as usize] |= topology.flags[b as usize];
    let piece = topology.piece_of[a as usize] as usize;
    topology.pieces[piece].living_vertices -= vertices_before - state.vertex_count;
    state.log.finish_record();
}

/// For a wedge at the edge's second point, the one at its first point that it merges into.
fn merged_wedges(edge: &Edge) -> impl Fn(u32) -> Option<u32> + use<> {
    let [first, second] = edge.triangles.vertices;
    let two = edge.triangles.count == 2 && second.1 != first.1 && second.0 != first.0;
    let merges = [first, if two { second } else { (NONE, NONE) }];
    move |wedge| merges.iter().find(|pair| pair.1 == wedge).map(|pair| pair.0)
}

/// Removes the wedges that merged or are no longer used, and gives the others their new place and attributes.
fn settle_wedges(
    topology: &mut Topology,
    state: &mut State,
    edge: &Edge,
    along: f32,
    at: DVec3,
    wedges: &[u32],
) {
    let a = edge.points[0];
    let merged_into = merged_wedges(edge);
    let keeps_place = at == edge.ends[0];
    let keeper = wedges.iter().copied().find(|&w| topology.uses[w as usize] > 0).unwrap_or(NONE);
    let position = if keeps_place {
        state.vertices[edge.triangles.vertices[0].0 as usize].position
    } else {
        (at + topology.origin).as_vec3().to_array()
    };
    let originals = [0, 1].map(|k| {
        let (wa, wb) = edge.triangles.vertices[k.min(edge.triangles.count - 1)];
        [wa, wb].map(|w| (w, state.vertices[w as usize]))
    });
    let mut living = 0;
    for &wedge in wedges {
        let kept = merged_into(wedge);
        if kept.is_some() || topology.uses[wedge as usize] == 0 {
            let kept = kept.filter(|&kept| topology.uses[kept as usize] > 0);
            state.remove_vertex(wedge, kept.unwrap_or(keeper));
            continue;
        }
        living += 1;
        topology.point_of[wedge as usize] = a;
        let touched = originals.iter().find(|ends| ends[0].0 == wedge || ends[1].0 == wedge);
        let vertex = match touched {
            Some([(_, va), (_, vb)]) => between(va, vb, along),
            None => state.vertices[wedge as usize],
        };
        state.change_vertex(wedge, Vertex { position, ..vertex });
    }
    topology.wedges[a as usize] = living;
    if !keeps_place {
        let rounded = DVec3::from_array(position.map(f64::from));
        topology.positions[a as usize] = rounded - topology.origin;
    }
}

/// Attributes part of the way along an edge; normals of unit length.
fn between(a: &Vertex, b: &Vertex, along: f32) -> Vertex {
    if along == 0.0 {
        return *a;
    }
    if along == 1.0 {
        return *b;
    }
    let mix = |a: f32, b: f32| a + (b - a) * along;
    let normal: [f32; 3] = std::array::from_fn(|k| mix(a.normal[k], b.normal[k]));
    let length = (normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]).sqrt();
    Vertex {
        position: a.position,
        normal: if length > 1e-6 { normal.map(|n| n / length) } else { a.normal },
        uv: std::array::from_fn(|k| mix(a.uv[k], b.uv[k])),
        color: std::array::from_fn(|k| (mix(a.color[k].into(), b.color[k].into()) + 0.5) as u8),
    }
}
