//! Primitives → triangles, whatever their mode, and parts that share vertices.

use std::collections::HashMap;

use gltf::json::Mesh;
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;

use super::file::AssetFile;
use super::notes::Notes;
use super::vertices::{self, Treatment};
use super::{TOO_LARGE, required};
use crate::load::Result;
use crate::scene::{Asset, AssetVertex, Part, Range};

/// Of all meshes together: beyond this no device would draw them.
const MAX_VERTICES: usize = 1 << 24;
const MAX_INDICES: usize = 1 << 27;
/// Each is a draw.
const MAX_PARTS: usize = 1 << 18;
/// What lies farther out is no place.
const MAX_PLACE_M: f32 = 1e15;

/// What was read so far, of all meshes of a file.
#[derive(Default)]
pub(super) struct Known {
    /// Vertices by their accessors and by where they were put: many parts may share them.
    vertices: HashMap<Origin, Vertices>,
    parts: usize,
}

/// Accessors by what they are for, and the bits of a place.
type Origin = (Vec<(Semantic, usize)>, [u32; 12]);

/// A run of vertices, in [`Asset::vertices`].
type Vertices = std::ops::Range<usize>;

/// Adds a mesh's triangles to the asset; what cannot be drawn is left out with a note.
pub(super) fn append(
    file: &AssetFile,
    mesh: &Mesh,
    treatment: &Treatment<'_>,
    into: &mut Asset,
    known: &mut Known,
    notes: &mut Notes,
) -> Result<Vec<Part>> {
    let mut parts = Vec::new();
    for (number, primitive) in mesh.primitives.iter().enumerate() {
        let Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) =
            primitive.mode
        else {
            notes.add("Points and lines are not drawn");
            continue;
        };
        let weights = mesh.weights.as_deref().unwrap_or_default();
        let deltas = treatment.morph.map(|deltas| deltas.get(number).copied());
        let read = || vertices::read(file, primitive, weights, deltas, treatment, notes);
        let Some(run) = known.run(primitive, treatment, &mut into.vertices, read) else {
            notes.add(match compression(primitive) {
                Some((name, advice)) => format!("A part is compressed ({name}), and is not drawn: {advice}"),
                None => "A part has no places that can be read, and is not drawn".to_owned(),
            });
            continue;
        };
        let list = triangles(file, primitive, mode, &into.vertices[run.clone()], notes).unwrap_or_default();
        known.parts += 1;
        if into.vertices.len() > MAX_VERTICES
            || into.indices.len() + 3 * list.len() > MAX_INDICES
            || known.parts > MAX_PARTS
        {
            return Err(file.wrong(format!(
                "it has more than {MAX_VERTICES} vertices, {} triangles or {MAX_PARTS} parts{TOO_LARGE}",
                MAX_INDICES / 3
            )));
        }
        if list.is_empty() {
            continue;
        }
        let (base, first) = (run.start as u32, into.indices.len() as u32);
        for [a, b, c] in list {
            let [b, c] = if treatment.mirrored { [c, b] } else { [b, c] };
            into.indices.extend([a, b, c].map(|index| index + base));
        }
        let surface = primitive.material.map_or(usize::MAX, |material| material.value());
        // Those without a material have the last, which is the default.
        let surface = surface.min(into.surfaces.len() - 1);
        parts.push(Part { surface, range: Range { first, count: into.indices.len() as u32 - first } });
    }
    Ok(parts)
}

/// What a part is compressed by, if by anything, and what helps.
fn compression(primitive: &Primitive) -> Option<(&str, &'static str)> {
    let others = &primitive.extensions.as_ref()?.others;
    others.keys().find_map(|name| Some((name.as_str(), required::advice(name)?)))
}

impl Known {
    /// The vertices of a primitive in `all`, to which `read` gives them if they are not there.
    fn run(
        &mut self,
        primitive: &Primitive,
        treatment: &Treatment<'_>,
        all: &mut Vec<AssetVertex>,
        read: impl FnOnce() -> Option<Vec<AssetVertex>>,
    ) -> Option<Vertices> {
        let accessors =
            vertices::attributes(primitive).into_iter().map(|(key, index)| (key.clone(), index.value()));
        let place = treatment.shape_from_mesh.to_cols_array().map(f32::to_bits);
        let key = (accessors.collect(), place);
        // What moves has more to tell it by.
        let moves = treatment.morph.is_some() || treatment.pose.is_some() || primitive.targets.is_some();
        if let Some(run) = self.vertices.get(&key).filter(|_| !moves) {
            return Some(run.clone());
        }
        let first = all.len();
        all.extend(read()?);
        let run = first..all.len();
        if !moves {
            self.vertices.insert(key, run.clone());
        }
        Some(run)
    }
}

/// The triangles of a list, strip or fan whose corners are all there.
fn triangles(
    file: &AssetFile,
    primitive: &Primitive,
    mode: Mode,
    vertices: &[AssetVertex],
    notes: &mut Notes,
) -> Option<Vec<[u32; 3]>> {
    let corners: Vec<u32> = match primitive.indices {
        Some(index) => {
            let indices = file.indices(index);
            if indices.is_none() {
                notes.add("A part's triangles cannot be read, and are not drawn");
            }
            indices?
        }
        None => (0..vertices.len() as u32).collect(),
    };
    let turned = |n: usize, [a, b, c]: [u32; 3]| if n.is_multiple_of(2) { [a, b, c] } else { [b, a, c] };
    let all: Vec<[u32; 3]> = match mode {
        Mode::TriangleStrip => {
            corners.windows(3).enumerate().map(|(n, t)| turned(n, [t[0], t[1], t[2]])).collect()
        }
        Mode::TriangleFan => corners.windows(2).skip(1).map(|t| [corners[0], t[0], t[1]]).collect(),
        _ => corners.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
    };
    let is_place = |index: &u32| {
        vertices.get(*index as usize).is_some_and(|v| v.position_m.iter().all(|x| x.abs() <= MAX_PLACE_M))
    };
    let sound: Vec<[u32; 3]> = all.iter().copied().filter(|corners| corners.iter().all(is_place)).collect();
    if sound.len() < all.len() {
        notes.add("Triangles whose corners are not there are left out");
    }
    (!sound.is_empty()).then_some(sound)
}
