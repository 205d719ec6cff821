//! The simplification sequence → distinguished meshes and the geomorphs between them.
//!
//! D_{i+1} has half the vertices of D_i (thesis 4.3.1). A vertex of D_i that D_{i+1} lacks morphs to the vertex that it
//! merged into, or to where its piece shrank to. Errors are the greatest cost so far (thesis 4.3.3), or what is found as
//! levels are finished. For D_0, which is the original, log q is continued in a straight line: from the cost at √½ of the vertices (λ = ½)
//! and that of D_1, q₀ = q(½)² / q(1); or from what is found of D_1 and D_2, q₀ = q(1)² / q(2).

use glam::Vec3;

use crate::model::{Level, LevelledMesh, Mesh, Morph};

use super::progressive::{self, Mark};
use super::sequence::Sequence;
use super::state::{NONE, State};
use super::{Finish, LodOptions, Step, strip};

/// A level may miss its number of vertices by one in this many; otherwise there is no such level.
const TOLERANCE: usize = 50;
/// An error may not be less than this part of the mesh's diagonal.
const MIN_ERROR: f32 = 1e-7;
/// D_0's error is less than D_1's by this at least, and each that comes from collapses than the next.
const MIN_GROWTH: f32 = 1.05;

/// How far an element that goes grows in length as it loses its width: with that, a half-way crown covers as much.
const STRETCH: f32 = 1.2;

/// One level before it gets its morph.
struct Snapshot {
    mesh: Mesh,
    /// Vertex of this mesh for each original one.
    now: Vec<u32>,
}

/// Makes all levels of a sound mesh, with the errors that are found as they are finished or else with those of the collapses.
pub fn build(
    mesh: Mesh,
    options: &LodOptions,
    finish: Option<&mut Finish<'_>>,
    ended: &mut dyn FnMut(Step),
) -> LevelledMesh {
    let bounds = mesh.bounds();
    let mut sequence = Sequence::new(State::new(&mesh), options);
    ended(Step::DataStructures);
    let mut marks = vec![Mark::of(&sequence)];
    let full = mesh.positions.len();
    let half_way = (full as f64 / 2.0_f64.sqrt()) as usize;
    let mut snapshots = vec![Snapshot { mesh, now: (0..full as u32).collect() }];
    let mut error_half_way_m = 0.0;
    for _ in 0..options.max_levels {
        let before = sequence.state.vertex_count;
        let target = before / 2;
        if target < options.min_vertices as usize {
            break;
        }
        sequence.reduce_to(target, |vertices, error_m| {
            if vertices >= half_way {
                error_half_way_m = error_m;
            }
        });
        if sequence.state.vertex_count > target + target / TOLERANCE {
            break;
        }
        let mark = Mark::calibrated(&mut sequence);
        let (mesh, now) = sequence.state.to_mesh(&mark.sizes());
        snapshots.push(Snapshot { mesh, now });
        marks.push(mark);
    }
    ended(Step::ProgressiveMesh);
    let mut levels = with_morphs(&snapshots, &sequence.state, ended);
    let between = |from: usize, to: usize| morph(&snapshots[from], &snapshots[to], &sequence.state);
    let found = finish.map(|finish| finish(&mut levels, &between));
    marks.truncate(levels.len());
    levels.iter_mut().skip(marks.len() - 1).for_each(|last| last.morph = None);
    set_errors(&mut marks, found, error_half_way_m as f32, (bounds.max - bounds.min).length());
    levels.iter_mut().zip(&marks).for_each(|(level, mark)| level.error_m = mark.error_m);
    ended(Step::Finish);
    let progressive = progressive::encode(&sequence.state, &marks);
    ended(Step::Records);
    LevelledMesh { levels, progressive, coverage: None }
}

/// Of a mesh of that diagonal; `found` for all levels but the first.
fn set_errors(marks: &mut [Mark], found: Option<Vec<f32>>, half_way_m: f32, diagonal_m: f32) {
    let is_found = found.is_some();
    let coarser = marks.iter_mut().skip(1);
    coarser.zip(found.into_iter().flatten()).for_each(|(mark, error_m)| mark.error_m = error_m);
    let errors_m: Vec<f32> = marks.iter().skip(1).map(|mark| mark.error_m).collect();
    let first = match (is_found, errors_m.as_slice()) {
        (true, &[one, two, ..]) if two > 0.0 => one * (one / two),
        (false, &[one, ..]) if one > 0.0 => half_way_m * (half_way_m / one),
        _ => 0.0,
    };
    marks[0].error_m = first.min(errors_m.first().map_or(0.0, |next| next / MIN_GROWTH));
    let least = (diagonal_m * MIN_ERROR).clamp(f32::MIN_POSITIVE, f32::MAX);
    let mut floor = least;
    for mark in marks {
        mark.error_m = mark.error_m.max(floor);
        // A coarser level may look more like the original, as clusters often do than the leaves before them.
        floor = if is_found { least } else { mark.error_m * MIN_GROWTH };
    }
}

/// The levels, without errors yet.
fn with_morphs(snapshots: &[Snapshot], state: &State, ended: &mut dyn FnMut(Step)) -> Vec<Level> {
    let morph_to_next = |index: usize| Some(morph(&snapshots[index], snapshots.get(index + 1)?, state));
    let morphs: Vec<_> = (0..snapshots.len()).map(morph_to_next).collect();
    ended(Step::Morphs);
    let level = |(snapshot, morph): (&Snapshot, Option<Morph>)| {
        let vertices = snapshot.mesh.positions.len();
        let strips = snapshot.mesh.parts.iter().map(|part| strip::strip(&part.triangles, vertices)).collect();
        Level { mesh: snapshot.mesh.clone(), morph, error_m: 0.0, strips }
    };
    let levels = snapshots.iter().zip(morphs).map(level).collect();
    ended(Step::Strips);
    levels
}

/// The offsets of one level's vertices to their places in the next.
fn morph(level: &Snapshot, next: &Snapshot, state: &State) -> Morph {
    let mut morph = Morph::default();
    for (id, &here) in level.now.iter().enumerate().filter(|(_, here)| **here != NONE) {
        let here = here as usize;
        let mut last = id;
        while next.now[last] == NONE && state.merged_into[last] != NONE {
            last = state.merged_into[last] as usize;
        }
        let there = (next.now[last] != NONE).then_some(next.now[last] as usize);
        let place = there.map_or(state.collapsed_to[last], |there| next.mesh.positions[there]);
        morph.positions.push(difference(place, level.mesh.positions[here]));
        if !level.mesh.normals.is_empty() {
            let delta = |there: usize| difference(next.mesh.normals[there], level.mesh.normals[here]);
            morph.normals.push(there.map_or([0.0; 3], delta));
        }
        if !level.mesh.uvs.is_empty() {
            let delta = |there: usize| difference(next.mesh.uvs[there], level.mesh.uvs[here]);
            morph.uvs.push(there.map_or([0.0; 2], delta));
        }
    }
    for span in &state.parts {
        let elements =
            (0..span.elements().map_or(0, |(elements, ..)| elements)).map(|e| span.element(e)[0].clone());
        for ids in elements.filter(|ids| level.now[ids.start] != NONE && next.now[ids.start] == NONE) {
            let here: Vec<_> =
                ids.filter(|&id| level.now[id] != NONE).map(|id| level.now[id] as usize).collect();
            shrink(&level.mesh, &here, &mut morph);
        }
    }
    morph
}

/// Moves the vertices of an element that goes onto the line from its root to its tip, and a little along it. So its
/// area falls linearly as it shrinks, as fast as that of those grows that stay: a crown does not thin out in mid-morph.
fn shrink(mesh: &Mesh, vertices: &[usize], morph: &mut Morph) {
    let at = |v: &usize| Vec3::from_array(mesh.positions[*v]);
    let centre = vertices.iter().map(at).sum::<Vec3>() / vertices.len().max(1) as f32;
    // A row of a card has two or three vertices.
    let row = (vertices.len() / 6).max(2).min(vertices.len());
    let [root, tip] = [&vertices[..row], &vertices[vertices.len() - row..]];
    let along = (tip.iter().map(at).sum::<Vec3>() - root.iter().map(at).sum::<Vec3>()).normalize_or(Vec3::Y);
    for v in vertices {
        let place = centre + along * ((at(v) - centre).dot(along) * STRETCH);
        morph.positions[*v] = (place - at(v)).to_array();
    }
}

fn difference<const N: usize>(to: [f32; N], from: [f32; N]) -> [f32; N] {
    std::array::from_fn(|k| to[k] - from[k])
}

#[cfg(test)]
mod tests {
    use super::progressive::reader;
    use crate::model::Level;
    use crate::stages::lod::shapes::sphere;
    use crate::stages::lod::{Between, LodOptions, levels_finished};

    #[test]
    fn what_finishes_levels_says_how_far_they_are_even_if_a_coarser_one_is_nearer() {
        let mesh = sphere(32, 30);
        let mut finish = |levels: &mut Vec<Level>, _: &Between<'_>| {
            (1..levels.len()).map(|i| [0.5, 1.0, 0.2][i.min(3) - 1]).collect()
        };
        let made = levels_finished(&mesh, &LodOptions::default(), &mut finish, &mut |_| ());
        let errors: Vec<f32> = made.levels.iter().map(|level| level.error_m).collect();
        assert_eq!(errors[..4], [0.25, 0.5, 1.0, 0.2], "D_0 goes on in a straight line");
        let payload = reader::decode(&made.progressive).unwrap();
        assert!(payload.marks().iter().zip(errors).all(|(mark, error_m)| mark.error_m == error_m));
    }
}
