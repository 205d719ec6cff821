//! Primitives as read → one sound mesh: everything that would harm a stage is taken out and counted.

use std::collections::BTreeMap;

use glam::Vec3;

use super::{ImportError, Imported, Primitive, Raw, Repair};
use crate::model::{Material, Mesh, Part, PartKind};

/// A part of at least this many like pieces is an aggregate.
const MIN_ELEMENTS: usize = 65;
/// Vertices of one piece.
const MAX_ELEMENT_VERTICES: usize = 32;

/// What was taken out.
#[derive(Default)]
struct Counts {
    vertices: usize,
    attributes: usize,
    out_of_range: usize,
    degenerate: usize,
    unused: usize,
}

/// Joins primitives by material, checks every number, finds aggregates.
pub fn finish(raw: Raw) -> Result<Imported, ImportError> {
    let Raw { mut primitives, rest: mut imported } = raw;
    let mut counts = Counts::default();
    primitives.iter_mut().for_each(|primitive| check(primitive, &mut counts));
    primitives.retain(|primitive| !primitive.triangles.is_empty());
    imported.note(Repair::NonFiniteVertices, counts.vertices);
    imported.note(Repair::NonFiniteAttributes, counts.attributes);
    imported.note(Repair::IndexOutOfRange, counts.out_of_range);
    imported.note(Repair::DegenerateTriangles, counts.degenerate);
    imported.note(Repair::UnusedVertices, counts.unused);
    if primitives.is_empty() {
        return Err(ImportError::Empty(imported.repairs));
    }
    let bare = primitives.iter().filter(|primitive| primitive.mesh.normals.is_empty()).count();
    imported.note(Repair::MissingNormals, bare);
    if bare > 0 {
        primitives.iter_mut().for_each(|primitive| primitive.mesh.normals.clear());
    }
    let with_uvs = primitives.iter().any(|primitive| !primitive.mesh.uvs.is_empty());
    let with_colors = primitives.iter().any(|primitive| !primitive.mesh.colors.is_empty());
    for Mesh { positions, uvs, colors, .. } in primitives.iter_mut().map(|primitive| &mut primitive.mesh) {
        uvs.resize(if with_uvs { positions.len() } else { 0 }, [0.0; 2]);
        colors.resize(if with_colors { positions.len() } else { 0 }, [255; 4]);
    }
    primitives.sort_by_key(|primitive| primitive.material);
    for group in primitives.chunk_by(|p, q| p.material == q.material) {
        add_part(&mut imported, group);
    }
    let crowded = crowded_edges(&imported.mesh);
    imported.note(Repair::NonManifoldEdges, crowded);
    Ok(imported)
}

/// Takes what can't be used out of one primitive.
fn check(primitive: &mut Primitive, counts: &mut Counts) {
    let Primitive { mesh, triangles, .. } = primitive;
    let positions = &mesh.positions;
    let bound = 1e18;
    let sound: Vec<bool> =
        positions.iter().map(|p| p.iter().all(|x| x.is_finite() && x.abs() < bound)).collect();
    triangles.retain(|triangle| {
        if triangle.iter().any(|&v| v as usize >= sound.len()) {
            counts.out_of_range += 1;
            return false;
        }
        if triangle.iter().any(|&v| !sound[v as usize]) {
            return false;
        }
        let [p, q, r] = triangle.map(|v| Vec3::from_array(positions[v as usize]).as_dvec3());
        let flat = (q - p).cross(r - p).length_squared() == 0.0;
        counts.degenerate += usize::from(flat);
        !flat
    });
    let mut used = vec![false; sound.len()];
    triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
    let unsound = sound.iter().filter(|&&sound| !sound).count();
    let kept: Vec<u32> = (0..used.len() as u32).filter(|&v| used[v as usize]).collect();
    counts.vertices += unsound;
    counts.unused += sound.len() - unsound - kept.len();
    select(mesh, triangles, &kept);
    let mut zero = |values: &mut [f32]| {
        for value in values.iter_mut().filter(|value| !value.is_finite()) {
            *value = 0.0;
            counts.attributes += 1;
        }
    };
    mesh.normals.iter_mut().for_each(|normal| zero(normal));
    mesh.uvs.iter_mut().for_each(|uv| zero(uv));
}

/// Keeps the vertices of `order`, in that order, and renumbers the corners of triangles, which use no others.
fn select(mesh: &mut Mesh, triangles: &mut [[u32; 3]], order: &[u32]) {
    fn pick<T: Copy>(list: &mut Vec<T>, order: &[u32]) {
        if !list.is_empty() {
            *list = order.iter().map(|&v| list[v as usize]).collect();
        }
    }
    let mut new_index = vec![0; mesh.positions.len()];
    order.iter().zip(0..).for_each(|(&old, new)| new_index[old as usize] = new);
    triangles.iter_mut().flatten().for_each(|v| *v = new_index[*v as usize]);
    pick(&mut mesh.positions, order);
    pick(&mut mesh.normals, order);
    pick(&mut mesh.uvs, order);
    pick(&mut mesh.colors, order);
}

/// Adds all primitives of one material as one part.
fn add_part(imported: &mut Imported, group: &[Primitive]) {
    let (mut part, mut triangles) = (Mesh::default(), Vec::new());
    for primitive in group {
        append(&mut part, &primitive.mesh, &primitive.triangles, &mut triangles);
    }
    let mut kind = PartKind::Surface;
    if let Some(found) = aggregate(&part, &triangles) {
        imported.note(Repair::FoundAggregate, found.elements);
        (kind, triangles) = (found.kind, found.triangles);
        select(&mut part, &mut triangles, &found.order);
    }
    let mut joined = Vec::new();
    append(&mut imported.mesh, &part, &triangles, &mut joined);
    let material = Material::Foreign(group[0].material as u32);
    imported.mesh.parts.push(Part { material, kind, triangles: joined });
}

/// Adds `from`'s vertices to `mesh`, and its triangles, renumbered, to `all`.
fn append(mesh: &mut Mesh, from: &Mesh, triangles: &[[u32; 3]], all: &mut Vec<[u32; 3]>) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend_from_slice(&from.positions);
    mesh.normals.extend_from_slice(&from.normals);
    mesh.uvs.extend_from_slice(&from.uvs);
    mesh.colors.extend_from_slice(&from.colors);
    all.extend(triangles.iter().map(|triangle| triangle.map(|v| v + first)));
}

/// Many small pieces of equal size, which a stage thins out as it does leaves.
struct Aggregate {
    kind: PartKind,
    elements: usize,
    /// The vertices piece by piece.
    order: Vec<u32>,
    /// The triangles piece by piece.
    triangles: Vec<[u32; 3]>,
}

/// The pieces of a mesh, if it consists of many small ones of equal size.
fn aggregate(mesh: &Mesh, triangles: &[[u32; 3]]) -> Option<Aggregate> {
    let mut union: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    fn root(union: &mut [u32], mut v: u32) -> u32 {
        while union[v as usize] != v {
            union[v as usize] = union[union[v as usize] as usize];
            v = union[v as usize];
        }
        v
    }
    for &[a, b, c] in triangles {
        let [a, b, c] = [a, b, c].map(|v| root(&mut union, v));
        let first = a.min(b).min(c);
        for v in [a, b, c] {
            union[v as usize] = first;
        }
    }
    // A piece's root is its first vertex, so pieces come in the order of their first vertices.
    let mut pieces: BTreeMap<u32, (Vec<u32>, Vec<[u32; 3]>)> = BTreeMap::new();
    for v in 0..union.len() as u32 {
        pieces.entry(root(&mut union, v)).or_default().0.push(v);
    }
    for &triangle in triangles {
        pieces.entry(root(&mut union, triangle[0])).or_default().1.push(triangle);
    }
    let (vertices, faces) = pieces.values().next().map(|piece| (piece.0.len(), piece.1.len()))?;
    let alike = pieces.values().all(|piece| piece.0.len() == vertices && piece.1.len() == faces);
    if pieces.len() < MIN_ELEMENTS || vertices > MAX_ELEMENT_VERTICES || !alike || joined(mesh, &pieces) {
        return None;
    }
    let (order, triangles): (Vec<_>, Vec<_>) = pieces.values().cloned().unzip();
    Some(Aggregate {
        kind: PartKind::Aggregate { vertices: vertices as u32, triangles: faces as u32 },
        elements: pieces.len(),
        order: order.concat(),
        triangles: triangles.concat(),
    })
}

/// Whether the pieces are really one surface whose vertices were all given apart (flat shading): most of them then
/// share positions with others.
fn joined(mesh: &Mesh, pieces: &BTreeMap<u32, (Vec<u32>, Vec<[u32; 3]>)>) -> bool {
    let mut owners: BTreeMap<[u32; 3], u32> = BTreeMap::new();
    let mut shared = 0;
    for (&piece, (vertices, _)) in pieces {
        for &v in vertices {
            let owner = *owners.entry(mesh.positions[v as usize].map(f32::to_bits)).or_insert(piece);
            shared += usize::from(owner != piece);
        }
    }
    shared * 2 > mesh.positions.len()
}

/// Edges (by position) of more than two triangles.
fn crowded_edges(mesh: &Mesh) -> usize {
    let mut edges: Vec<[[u32; 3]; 2]> = Vec::new();
    let mut crowded = 0;
    for part in &mesh.parts {
        edges.clear();
        for triangle in &part.triangles {
            let [p, q, r] = triangle.map(|v| mesh.positions[v as usize].map(f32::to_bits));
            edges.extend([[p, q], [q, r], [r, p]].map(|[p, q]| if p < q { [p, q] } else { [q, p] }));
        }
        edges.sort_unstable();
        crowded += edges.chunk_by(|e, f| e == f).filter(|same| same.len() > 2).count();
    }
    crowded
}
