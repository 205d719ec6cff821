//! A mesh's vertices and triangles → glTF primitives, a part each.

use serde_json::{Value, json};

use super::ExportError;
use super::document::{ARRAY_BUFFER, Document, ELEMENT_ARRAY_BUFFER, FLOAT, UNSIGNED_BYTE};
use super::tangents::tangents;
use crate::model::{Bounds, Material, Mesh};

/// A primitive without morph targets: what part of the mesh it is, and its JSON so far.
pub struct Primitive {
    /// Index into `Mesh::parts`.
    pub part: usize,
    /// Its run of the mesh's vertices.
    pub first: usize,
    pub count: usize,
    pub json: Value,
}

/// What a part's material asks of its vertices.
#[derive(Clone, Copy, Debug, Default)]
pub struct Surface {
    /// The material's index.
    pub material: Option<usize>,
    /// Whether it has a normal map, for which vertices need tangents.
    pub normal_map: bool,
}

/// Writes a mesh's vertices, interleaved, and its indices; gives its primitives.
pub fn add_vertices(
    document: &mut Document,
    what: &str,
    mesh: &Mesh,
    surface_of: &dyn Fn(Material) -> Surface,
) -> Result<Vec<Primitive>, ExportError> {
    let total = mesh.positions.len();
    let fits = |len: usize| len == 0 || len == total;
    if !fits(mesh.normals.len()) || !fits(mesh.uvs.len()) || !fits(mesh.colors.len()) {
        return Err(ExportError::Inconsistent(what.into(), "its attribute lists differ in length"));
    }
    if mesh.parts.iter().any(|p| p.triangles.as_flattened().iter().any(|&i| i as usize >= total)) {
        return Err(ExportError::Inconsistent(what.into(), "an index is beyond its vertices"));
    }
    let finite = mesh.positions.as_flattened().iter().chain(mesh.normals.as_flattened());
    if !finite.chain(mesh.uvs.as_flattened()).all(|x| x.is_finite()) {
        return Err(ExportError::NotFinite(what.into()));
    }
    let layout = Layout::of(mesh);
    let view = document.view(&layout.interleave(mesh), Some(ARRAY_BUFFER), Some(layout.stride));
    let runs = runs(mesh);
    let mut primitives = Vec::new();
    for (part, &(first, count)) in runs.iter().enumerate().filter(|(_, run)| run.1 > 0) {
        let start = first * layout.stride;
        let positions = document.accessor(view, start, FLOAT, count, "VEC3");
        set_bounds(&mut document.accessors[positions], &mesh.positions[first..first + count]);
        let mut attributes = json!({ "POSITION": positions });
        if let Some(at) = layout.normal {
            attributes["NORMAL"] = document.accessor(view, start + at, FLOAT, count, "VEC3").into();
        }
        if let Some(at) = layout.uv {
            attributes["TEXCOORD_0"] = document.accessor(view, start + at, FLOAT, count, "VEC2").into();
        }
        if let Some(at) = layout.color {
            let colors = document.accessor(view, start + at, UNSIGNED_BYTE, count, "VEC4");
            document.accessors[colors]["normalized"] = true.into();
            attributes["COLOR_0"] = colors.into();
        }
        let triangles = &mesh.parts[part].triangles;
        let indices: Vec<u32> = triangles.as_flattened().iter().map(|&i| i - first as u32).collect();
        let indices = document.indices(&indices, count, Some(ELEMENT_ARRAY_BUFFER));
        let mut json = json!({ "attributes": attributes, "indices": indices });
        let surface = surface_of(mesh.parts[part].material);
        if let Some(material) = surface.material {
            json["material"] = material.into();
        }
        if surface.normal_map && layout.normal.is_some() && layout.uv.is_some() {
            let all = tangents(&mesh.positions, &mesh.normals, &mesh.uvs, triangles, (first, count));
            let view = document.view(bytemuck::cast_slice(&all), Some(ARRAY_BUFFER), None);
            json["attributes"]["TANGENT"] = document.accessor(view, 0, FLOAT, count, "VEC4").into();
        }
        primitives.push(Primitive { part, first, count, json });
    }
    Ok(primitives)
}

/// For each part its run of vertices (first, count): its own where runs are disjoint, else all for everyone. Parts
/// without triangles have no vertices.
fn runs(mesh: &Mesh) -> Vec<(usize, usize)> {
    let mut own = Vec::with_capacity(mesh.parts.len());
    for part in &mesh.parts {
        let used = part.triangles.as_flattened();
        match (used.iter().min(), used.iter().max()) {
            (Some(&lo), Some(&hi)) => own.push((lo as usize, (hi - lo + 1) as usize)),
            _ => own.push((0, 0)),
        }
    }
    let mut sorted: Vec<_> = own.iter().filter(|run| run.1 > 0).collect();
    sorted.sort_unstable();
    if sorted.windows(2).all(|pair| pair[0].0 + pair[0].1 <= pair[1].0) {
        return own;
    }
    own.iter().map(|run| if run.1 > 0 { (0, mesh.positions.len()) } else { (0, 0) }).collect()
}

/// Where each attribute of a vertex lies among its bytes.
struct Layout {
    stride: usize,
    normal: Option<usize>,
    uv: Option<usize>,
    color: Option<usize>,
}

impl Layout {
    fn of(mesh: &Mesh) -> Self {
        let mut stride = 12;
        let mut take = |present: bool, bytes: usize| {
            present.then(|| {
                stride += bytes;
                stride - bytes
            })
        };
        let normal = take(!mesh.normals.is_empty(), 12);
        let uv = take(!mesh.uvs.is_empty(), 8);
        let color = take(!mesh.colors.is_empty(), 4);
        Self { stride, normal, uv, color }
    }

    fn interleave(&self, mesh: &Mesh) -> Vec<u8> {
        let mut out = Vec::with_capacity(self.stride * mesh.positions.len());
        for i in 0..mesh.positions.len() {
            out.extend_from_slice(bytemuck::bytes_of(&mesh.positions[i]));
            if self.normal.is_some() {
                out.extend_from_slice(bytemuck::bytes_of(&unit(mesh.normals[i])));
            }
            if self.uv.is_some() {
                out.extend_from_slice(bytemuck::bytes_of(&mesh.uvs[i]));
            }
            if self.color.is_some() {
                out.extend_from_slice(&mesh.colors[i]);
            }
        }
        out
    }
}

/// A normal as it is if it has unit length, else made so; glTF allows no other.
fn unit(n: [f32; 3]) -> [f32; 3] {
    let square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    if (square - 1.0).abs() < 1e-4 {
        return n;
    }
    if square < 1e-12 {
        return [0.0, 1.0, 0.0];
    }
    let length = square.sqrt();
    n.map(|x| x / length)
}

pub fn set_bounds(accessor: &mut Value, values: &[[f32; 3]]) {
    let bounds = Bounds::of(values);
    accessor["min"] = json!(bounds.min.to_array());
    accessor["max"] = json!(bounds.max.to_array());
}
