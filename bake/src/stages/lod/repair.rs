//! Any mesh → a sound one, as the rest of this folder expects it.

use crate::model::{Mesh, Part, PartKind};

/// The mesh without violations of the rules of [`Mesh`]: attribute lists of the wrong length, triangles that name a
/// vertex that does not exist, and aggregates that are not laid out as they say.
pub fn repaired(mut mesh: Mesh) -> Mesh {
    fn clear_unless_complete<T>(list: &mut Vec<T>, count: usize) {
        if list.len() != count {
            list.clear();
        }
    }
    let count = mesh.positions.len();
    clear_unless_complete(&mut mesh.normals, count);
    clear_unless_complete(&mut mesh.uvs, count);
    clear_unless_complete(&mut mesh.colors, count);
    for part in &mut mesh.parts {
        part.triangles.retain(|t| t.iter().all(|&v| (v as usize) < count));
    }
    if !kinds_hold(&mesh) {
        mesh.parts.iter_mut().for_each(|part| part.kind = PartKind::Surface);
    }
    mesh
}

/// Whether aggregates are laid out as they say and share their vertices with no other part.
fn kinds_hold(mesh: &Mesh) -> bool {
    let mut taken = vec![false; mesh.positions.len()];
    for part in &mesh.parts {
        let PartKind::Aggregate { vertices, triangles } = part.kind else { continue };
        let (vertices, triangles) = (vertices as usize, triangles as usize);
        let first = part.triangles.iter().flatten().copied().min().unwrap_or(0) as usize;
        if vertices == 0 || triangles == 0 || !elements_hold(part, first, vertices, triangles) {
            return false;
        }
        let own = first..first + part.triangles.len() / triangles * vertices;
        let Some(own) = taken.get_mut(own).filter(|own| !own.contains(&true)) else { return false };
        own.fill(true);
    }
    let surfaces = mesh.parts.iter().filter(|part| part.kind == PartKind::Surface);
    surfaces.flat_map(|part| part.triangles.iter().flatten()).all(|&v| !taken[v as usize])
}

/// Whether the nth element has the nth run of vertices and of triangles.
fn elements_hold(part: &Part, first: usize, vertices: usize, triangles: usize) -> bool {
    part.triangles.len().is_multiple_of(triangles)
        && part.triangles.chunks_exact(triangles).enumerate().all(|(element, chunk)| {
            let start = first + element * vertices;
            chunk.iter().flatten().all(|&v| (start..start + vertices).contains(&(v as usize)))
        })
}
