//! A levelled mesh → one self-contained .glb: scene 0 is D_0, with the others as its MSFT_lod, scene 1 every
//! distinguished mesh side by side, each D_i with a core morph target that is its geomorph to D_{i+1}, and everything in `GSC_progressive_mesh` besides.

use genescape_schema::scene::{GSC_PROGRESSIVE_MESH, ProgressiveLevel, ProgressiveMeshExtension};
use serde_json::{Value, json};

use super::document::{ARRAY_BUFFER, Document, ELEMENT_ARRAY_BUFFER, FLOAT, Node, UNSIGNED_BYTE};
use super::glb::write_glb;
use super::tangents::tangents;
use super::{ExportError, MaterialSet};
use crate::model::{Bounds, Level, LevelledMesh, Material, Mesh};

/// Levels of detail that Babylon.js reads.
const MSFT_LOD: &str = "MSFT_lod";

/// One .glb with all levels of `mesh`, named after `name`.
///
/// Primitives are the parts that have triangles, in their order. Where the parts' vertices are disjoint runs of the
/// vertex lists, as they are in everything that the bake makes, each primitive has accessors of its own run.
///
/// # Errors
/// When D_0 has no triangles, or any list is inconsistent or not finite.
pub fn levelled_glb(
    name: &str,
    mesh: &LevelledMesh,
    materials: &MaterialSet<'_>,
) -> Result<Vec<u8>, ExportError> {
    let mut document = Document::default();
    let levels: Vec<_> = mesh.levels.iter().take_while(|level| level.mesh.triangle_count() > 0).collect();
    if levels.is_empty() {
        return Err(ExportError::Empty(name.into()));
    }
    materials.add_to(&mut document);
    let surface_of = |material| materials.surface_of(material);

    let mut records = Vec::new();
    for (i, level) in levels.iter().enumerate() {
        let what = format!("{name}.D{i}");
        let primitives = add_vertices(&mut document, &what, &level.mesh, &surface_of)?;
        let next = (i + 1 < levels.len()).then_some(level.morph.as_ref()).flatten();
        let mut json = json!({ "name": what, "primitives": [],
            "extras": { "level": i, "error_m": level.error_m } });
        let mut record = ProgressiveLevel {
            mesh: i,
            error_m: level.error_m,
            vertices: primitives.iter().map(|p| p.count).sum(),
            triangles: level.mesh.triangle_count(),
            texcoord_deltas: Vec::new(),
            strips: Vec::new(),
        };
        for primitive in primitives {
            let Primitive { part, first, count, json: mut object } = primitive;
            if let Some(morph) = next {
                if morph.positions.len() != level.mesh.positions.len() {
                    return Err(ExportError::Inconsistent(what, "its morph is not as long as its vertices"));
                }
                let run = first..first + count;
                let mut target = json!({});
                let positions = &morph.positions[run.clone()];
                target["POSITION"] = add_deltas(&mut document, positions, true).into();
                let normals = morph.normals.get(run.clone()).unwrap_or_default();
                if normals.iter().any(|n| *n != [0.0; 3]) {
                    target["NORMAL"] = add_deltas(&mut document, normals, false).into();
                }
                object["targets"] = json!([target]);
                record.texcoord_deltas.push(add_uv_deltas(&mut document, morph.uvs.get(run), count));
            }
            if let Some(strip) = level.strips.get(part) {
                record.strips.push(add_strip(&mut document, &what, strip, first, count)?);
            }
            json["primitives"].as_array_mut().expect("made above").push(object);
        }
        if next.is_some() {
            json["weights"] = json!([0]);
            json["extras"]["targetNames"] = json!([format!("geomorph to D{}", i + 1)]);
        }
        records.push(record);
        document.meshes.push(json);
    }
    if !mesh.progressive.is_empty() {
        let buffer_view = document.view(&mesh.progressive, None, None);
        let extension = ProgressiveMeshExtension { buffer_view, levels: records };
        document.meshes[0]["extensions"] = json!({ GSC_PROGRESSIVE_MESH: extension });
        document.extensions_used.insert(GSC_PROGRESSIVE_MESH.into());
    }
    add_scenes(&mut document, name, &levels);
    materials.add_images_to(&mut document);
    let json = document.json();
    Ok(write_glb(json, document.bin))
}

/// Pixels by which a level may be off, and the rows of the picture that these are pixels of, where programs choose levels
/// by `MSFT_screencoverage`.
const ERROR_PX: f32 = 1.5;
const SCREEN_PX: f32 = 1080.0;

/// Scene 0: the finished mesh. Scene 1: all levels in a row along x. Each stands on a node of its own there, so that the
/// nodes of its meshes, which stand in no one's way, serve scene 0 as levels: Blender shows nodes that are in no scene.
fn add_scenes(document: &mut Document, name: &str, levels: &[&Level]) {
    let finished = document.node(Node { name: name.into(), mesh: Some(0), ..Node::default() });
    let (mut places, mut meshes) = (Vec::new(), Vec::new());
    let widths_m = levels.iter().map(|level| level.mesh.bounds()).map(|bounds| bounds.max.x - bounds.min.x);
    let (mut at_m, mut before_m) = (0.0, None);
    for (i, width_m) in widths_m.enumerate() {
        at_m += before_m.replace(width_m).map_or(0.0, |before_m| 0.55 * (before_m + width_m));
        let mesh = document.node(Node { name: format!("{name} D{i}"), mesh: Some(i), ..Node::default() });
        meshes.push(mesh);
        places.push(document.node(Node {
            name: format!("{name} D{i} place"),
            translation: Some([at_m, 0.0, 0.0]),
            children: vec![mesh],
            ..Node::default()
        }));
    }
    let row = document.node(Node { name: format!("{name} levels"), children: places, ..Node::default() });
    document.scenes.push(json!({ "name": name, "nodes": [finished] }));
    document.scenes.push(json!({ "name": format!("{name} levels"), "nodes": [row] }));
    if levels.len() > 1 {
        let node = &mut document.nodes[finished];
        node.extensions = Some(json!({ MSFT_LOD: { "ids": meshes[1..] } }));
        node.extras = Some(json!({ "MSFT_screencoverage": screen_coverage(levels) }));
        document.extensions_used.insert(MSFT_LOD.into());
    }
}

/// For each level the part of the picture's height that the mesh must fill for it to be needed: less, and the next one's
/// error is too small to see. The last is never let go.
fn screen_coverage(levels: &[&Level]) -> Vec<f32> {
    let bounds = levels[0].mesh.bounds();
    let size_m = bounds.max.distance(bounds.min);
    let mut coverage = Vec::with_capacity(levels.len());
    let mut above = 1.0f32;
    for level in &levels[1..] {
        above = above.min(ERROR_PX / SCREEN_PX * size_m / level.error_m.max(f32::MIN_POSITIVE));
        coverage.push(above);
    }
    coverage.push(0.0);
    coverage
}

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

fn set_bounds(accessor: &mut Value, values: &[[f32; 3]]) {
    let bounds = Bounds::of(values);
    accessor["min"] = json!(bounds.min.to_array());
    accessor["max"] = json!(bounds.max.to_array());
}

/// Morph deltas, sparse where that is smaller.
fn add_deltas(document: &mut Document, deltas: &[[f32; 3]], bounds: bool) -> usize {
    let mut moved: Vec<u32> = (0..deltas.len() as u32).filter(|&i| deltas[i as usize] != [0.0; 3]).collect();
    if moved.is_empty() {
        moved.push(0); // a sparse accessor has at least one entry
    }
    let sparse_bytes = moved.len() * if deltas.len() <= 65536 { 14 } else { 16 };
    let accessor = if sparse_bytes < deltas.len() * 12 {
        let values: Vec<[f32; 3]> = moved.iter().map(|&i| deltas[i as usize]).collect();
        document.sparse_accessor(deltas.len(), "VEC3", &moved, bytemuck::cast_slice(&values))
    } else {
        let view = document.view(bytemuck::cast_slice(deltas), Some(ARRAY_BUFFER), None);
        document.accessor(view, 0, FLOAT, deltas.len(), "VEC3")
    };
    if bounds {
        set_bounds(&mut document.accessors[accessor], deltas);
    }
    accessor
}

/// Deltas of texture coordinates; where all are 0, a sparse accessor with one entry, since the gltf crate refuses
/// those without any bytes.
fn add_uv_deltas(document: &mut Document, deltas: Option<&[[f32; 2]]>, count: usize) -> usize {
    if let Some(deltas) = deltas.filter(|deltas| deltas.iter().any(|d| *d != [0.0; 2])) {
        let view = document.view(bytemuck::cast_slice(deltas), None, None);
        return document.accessor(view, 0, FLOAT, deltas.len(), "VEC2");
    }
    document.sparse_accessor(count, "VEC2", &[0], &[0; 8])
}

fn add_strip(
    document: &mut Document,
    what: &str,
    strip: &[u32],
    first: usize,
    count: usize,
) -> Result<usize, ExportError> {
    let run = first as u32..(first + count) as u32;
    if strip.iter().any(|i| !run.contains(i)) {
        return Err(ExportError::Inconsistent(what.into(), "a strip uses another part's vertices"));
    }
    let own: Vec<u32> = strip.iter().map(|&i| i - first as u32).collect();
    Ok(document.indices(&own, count, None))
}
