//! Primitives as read → one sound mesh: everything that would harm a stage is taken out and counted.

use std::collections::BTreeMap;

use glam::Vec3;

use super::{ImportError, Imported, Primitive, Raw, Repair};
use crate::model::{Material, Mesh, Part, PartKind};

/// A part of more like pieces than this is an aggregate.
const FEWEST_ELEMENTS: usize = 64;
/// An element has at most so many vertices.
const LARGEST_ELEMENT: usize = 32;

const NONE: u32 = u32::MAX;

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
    imported.repairs.extend(
        [
            (counts.vertices, Repair::NonFiniteVertices(counts.vertices)),
            (counts.attributes, Repair::NonFiniteAttributes(counts.attributes)),
            (counts.out_of_range, Repair::IndexOutOfRange(counts.out_of_range)),
            (counts.degenerate, Repair::DegenerateTriangles(counts.degenerate)),
            (counts.unused, Repair::UnusedVertices(counts.unused)),
        ]
        .into_iter()
        .filter(|&(count, _)| count > 0)
        .map(|(_, repair)| repair),
    );
    if primitives.is_empty() {
        return Err(ImportError::Empty(imported.repairs));
    }
    let bare = primitives.iter().filter(|primitive| primitive.normals.is_none()).count();
    imported.repairs.extend((bare > 0).then_some(Repair::MissingNormals(bare)));
    primitives.sort_by_key(|primitive| primitive.material);
    for group in primitives.chunk_by(|p, q| p.material == q.material) {
        add_part(&mut imported, group, &primitives);
    }
    let shared = crowded_edges(&imported.mesh);
    imported.repairs.extend((shared > 0).then_some(Repair::NonManifoldEdges(shared)));
    Ok(imported)
}

/// Takes what can't be used out of one primitive.
fn check(primitive: &mut Primitive, counts: &mut Counts) {
    let count = primitive.positions.len();
    let bound = 1e18;
    let sound: Vec<bool> =
        primitive.positions.iter().map(|p| p.iter().all(|x| x.is_finite() && x.abs() < bound)).collect();
    counts.vertices += sound.iter().filter(|&&sound| !sound).count();
    let positions = &primitive.positions;
    primitive.triangles.retain(|triangle| {
        if triangle.iter().any(|&v| v as usize >= count) {
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
    keep_used(primitive, &sound, counts);
    let mut zero = |values: &mut [f32]| {
        for value in values.iter_mut().filter(|value| !value.is_finite()) {
            *value = 0.0;
            counts.attributes += 1;
        }
    };
    primitive.normals.iter_mut().flatten().for_each(|normal| zero(normal));
    primitive.uvs.iter_mut().flatten().for_each(|uv| zero(uv));
}

fn keep_used(primitive: &mut Primitive, sound: &[bool], counts: &mut Counts) {
    let mut used = vec![false; primitive.positions.len()];
    primitive.triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
    let unused = used.iter().zip(sound).filter(|&(&used, &sound)| sound && !used).count();
    counts.unused += unused;
    if used.iter().all(|&used| used) {
        return;
    }
    let mut next = 0;
    let now: Vec<u32> = used
        .iter()
        .map(|&used| {
            next += u32::from(used);
            if used { next - 1 } else { NONE }
        })
        .collect();
    primitive.triangles.iter_mut().flatten().for_each(|v| *v = now[*v as usize]);
    keep(&mut primitive.positions, &used);
    primitive.normals.iter_mut().for_each(|list| keep(list, &used));
    primitive.uvs.iter_mut().for_each(|list| keep(list, &used));
    primitive.colors.iter_mut().for_each(|list| keep(list, &used));
}

fn keep<T>(list: &mut Vec<T>, used: &[bool]) {
    let mut used = used.iter();
    list.retain(|_| used.next().copied().unwrap_or(false));
}

/// Adds all primitives of one material as one part.
fn add_part(imported: &mut Imported, group: &[Primitive], all: &[Primitive]) {
    let with_normals = all.iter().all(|primitive| primitive.normals.is_some());
    let with_uvs = all.iter().any(|primitive| primitive.uvs.is_some());
    let with_colors = all.iter().any(|primitive| primitive.colors.is_some());
    let mut triangles = Vec::new();
    let mut part = Mesh::default();
    for primitive in group {
        let (first, count) = (part.positions.len() as u32, primitive.positions.len());
        part.positions.extend_from_slice(&primitive.positions);
        if let (true, Some(normals)) = (with_normals, &primitive.normals) {
            part.normals.extend_from_slice(normals);
        }
        if with_uvs {
            part.uvs.extend(primitive.uvs.clone().unwrap_or_else(|| vec![[0.0; 2]; count]));
        }
        if with_colors {
            part.colors.extend(primitive.colors.clone().unwrap_or_else(|| vec![[255; 4]; count]));
        }
        triangles.extend(primitive.triangles.iter().map(|triangle| triangle.map(|v| v + first)));
    }
    let material = Material::Foreign(group[0].material as u32);
    let kind = match aggregate(&part, &triangles) {
        Some((kind, elements, order, sorted)) => {
            imported.repairs.push(Repair::FoundAggregate(elements));
            part = reordered(&part, &order);
            triangles = sorted;
            kind
        }
        None => PartKind::Surface,
    };
    let mesh = &mut imported.mesh;
    let first = mesh.positions.len() as u32;
    mesh.positions.append(&mut part.positions);
    mesh.normals.append(&mut part.normals);
    mesh.uvs.append(&mut part.uvs);
    mesh.colors.append(&mut part.colors);
    let triangles = triangles.into_iter().map(|triangle| triangle.map(|v| v + first)).collect();
    mesh.parts.push(Part { material, kind, triangles });
}

fn reordered(mesh: &Mesh, order: &[u32]) -> Mesh {
    fn pick<T: Copy>(list: &[T], order: &[u32]) -> Vec<T> {
        if list.is_empty() { Vec::new() } else { order.iter().map(|&v| list[v as usize]).collect() }
    }
    Mesh {
        positions: pick(&mesh.positions, order),
        normals: pick(&mesh.normals, order),
        uvs: pick(&mesh.uvs, order),
        colors: pick(&mesh.colors, order),
        parts: Vec::new(),
    }
}

type Aggregate = (PartKind, usize, Vec<u32>, Vec<[u32; 3]>);

/// Many small pieces of equal size: the layout as elements, or `None`. Gives the kind, the number of elements, the
/// vertices in their new order, and the triangles with new indices.
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
        let least = a.min(b).min(c);
        for v in [a, b, c] {
            union[v as usize] = least;
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
    if pieces.len() <= FEWEST_ELEMENTS || vertices > LARGEST_ELEMENT || !alike || joined(mesh, &pieces) {
        return None;
    }
    let order: Vec<u32> = pieces.values().flat_map(|piece| piece.0.iter().copied()).collect();
    let mut now = vec![0; order.len()];
    order.iter().enumerate().for_each(|(new, &old)| now[old as usize] = new as u32);
    let renamed = |triangle: &[u32; 3]| triangle.map(|v| now[v as usize]);
    let sorted = pieces.values().flat_map(|piece| piece.1.iter().map(renamed)).collect();
    let kind = PartKind::Aggregate { vertices: vertices as u32, triangles: faces as u32 };
    Some((kind, pieces.len(), order, sorted))
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
