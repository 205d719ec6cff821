//! .glb and .gltf → primitives of the default scene in world space, materials and images as they are.

use std::collections::BTreeSet;

use data_url::DataUrl;
use glam::{Mat3, Mat4, Vec3};
use gltf::accessor::Dimensions;
use gltf::mesh::{Mode, Semantic};
use percent_encoding::percent_decode_str;
use serde_json::{Value, json};

use super::{ImportError, Imported, ImportedImage, Primitive, Raw, Repair, Resolve, accessor, color_byte};
use crate::gltf::split_glb;
use crate::model::Mesh;

/// Extensions that may be required: they change materials, which are passed through, or how numbers are stored.
const UNDERSTOOD: [&str; 3] = ["KHR_mesh_quantization", "KHR_texture_transform", "KHR_lights_punctual"];

/// Reads either form; which one it is shows in the first bytes.
pub fn read(bytes: &[u8], resolve: &Resolve<'_>) -> Result<Raw, ImportError> {
    let glb = bytes.starts_with(b"glTF").then(|| split_glb(bytes)).transpose();
    let glb = glb.map_err(|error| malformed("GLB", error))?;
    let (text, blob) = glb.as_ref().map_or((bytes, None), |glb| (&*glb.json, glb.bin.as_deref()));
    let mut root: Value = serde_json::from_slice(text).map_err(|e| malformed("glTF", e))?;
    check_required(&mut root)?;
    let skipped = drop_without_positions(&mut root)?;
    complete_images(&mut root);
    let plain = serde_json::to_vec(&root).map_err(|e| malformed("glTF", e))?;
    let document = gltf::Gltf::from_slice(&plain).map_err(|e| malformed("glTF", e))?;
    let buffers = read_buffers(&document, blob, resolve)?;
    let mut raw = Raw::default();
    raw.rest.note(Repair::SkippedPrimitives, skipped);
    pass_through(&root, &document, &buffers, resolve, &mut raw.rest);
    read_scene(&document, &buffers, &mut raw)?;
    Ok(raw)
}

fn malformed(format: &'static str, reason: impl ToString) -> ImportError {
    ImportError::Malformed { format, reason: reason.to_string() }
}

/// Refuses extensions that change geometry in ways unknown; takes the list out of the way of the gltf crate, which
/// would refuse the others too.
fn check_required(root: &mut Value) -> Result<(), ImportError> {
    let Some(object) = root.as_object_mut() else { return Err(malformed("glTF", "it isn't a JSON object")) };
    let Some(required) = object.remove("extensionsRequired") else { return Ok(()) };
    let names = required.as_array().into_iter().flatten().filter_map(Value::as_str);
    let unknown = |name: &&str| !UNDERSTOOD.contains(name) && !name.starts_with("KHR_materials_");
    match names.into_iter().find(unknown) {
        Some(name) => Err(ImportError::RequiredExtension(name.to_owned())),
        None => Ok(()),
    }
}

/// Takes out primitives without positions, and checks those positions' accessors: the gltf crate would refuse the
/// whole file for the first, and panics over an accessor that isn't there. Says how many went.
fn drop_without_positions(root: &mut Value) -> Result<usize, ImportError> {
    let mut positions = BTreeSet::new();
    let mut skipped = 0;
    for mesh in root.get_mut("meshes").and_then(Value::as_array_mut).into_iter().flatten() {
        let Some(primitives) = mesh.get_mut("primitives").and_then(Value::as_array_mut) else { continue };
        let before = primitives.len();
        primitives.retain(|primitive| primitive.pointer("/attributes/POSITION").is_some());
        skipped += before - primitives.len();
        let named = primitives.iter().filter_map(|p| p.pointer("/attributes/POSITION")?.as_u64());
        positions.extend(named);
    }
    for place in positions {
        let accessor = root.get_mut("accessors").and_then(|accessors| accessors.get_mut(place as usize));
        let accessor = accessor.and_then(Value::as_object_mut);
        let accessor = accessor.ok_or_else(|| malformed("glTF", format!("there is no accessor {place}")))?;
        // Bounds are required by the standard, often missing, and of no use here.
        for bound in ["min", "max"] {
            accessor.entry(bound).or_insert_with(|| json!([0.0, 0.0, 0.0]));
        }
    }
    Ok(skipped)
}

/// Gives images what the gltf crate takes for granted, and panics without: a place to come from, and a type if that
/// is part of a buffer. An empty image is left out later; an empty type is replaced by what the image begins as.
fn complete_images(root: &mut Value) {
    let images = root.get_mut("images").and_then(Value::as_array_mut).into_iter().flatten();
    for image in images.filter_map(Value::as_object_mut) {
        let is_given = |key: &str| image.get(key).is_some_and(|value| !value.is_null());
        let (in_buffer, has_file, has_type) = (is_given("bufferView"), is_given("uri"), is_given("mimeType"));
        if in_buffer && !has_type {
            image.insert("mimeType".into(), json!(""));
        } else if !in_buffer && !has_file {
            image.insert("uri".into(), json!("data:,"));
        }
    }
}

fn read_buffers(
    document: &gltf::Document,
    blob: Option<&[u8]>,
    resolve: &Resolve<'_>,
) -> Result<Vec<Vec<u8>>, ImportError> {
    let read = |buffer: gltf::Buffer<'_>| {
        let bytes = match buffer.source() {
            gltf::buffer::Source::Bin => {
                blob.ok_or_else(|| malformed("GLB", "it has no binary chunk"))?.to_vec()
            }
            gltf::buffer::Source::Uri(uri) => fetch(uri, resolve)?.0,
        };
        match bytes.len() >= buffer.length() {
            true => Ok(bytes),
            false => Err(malformed("glTF", format!("buffer {} ends too early", buffer.index()))),
        }
    };
    document.buffers().map(read).collect()
}

/// Bytes and, for the data URI of an image, its MIME type.
fn fetch(uri: &str, resolve: &Resolve<'_>) -> Result<(Vec<u8>, String), ImportError> {
    if uri.starts_with("data:") {
        let data = DataUrl::process(uri).map_err(|_| malformed("glTF", "a data URI is cut off"))?;
        let (bytes, _) = data.decode_to_vec().map_err(|_| malformed("glTF", "a data URI isn't base64"))?;
        let mime_type = data.mime_type();
        let is_image = mime_type.type_ == "image";
        return Ok((bytes, if is_image { mime_type.to_string() } else { String::new() }));
    }
    let name = percent_decode_str(uri).decode_utf8_lossy().into_owned();
    match resolve(&name) {
        Ok(bytes) => Ok((bytes, String::new())),
        Err(source) => Err(ImportError::Missing { name, source }),
    }
}

/// Materials, textures, samplers and images.
fn pass_through(
    root: &Value,
    document: &gltf::Document,
    buffers: &[Vec<u8>],
    resolve: &Resolve<'_>,
    into: &mut Imported,
) {
    let list = |key: &str| root.get(key).and_then(Value::as_array).cloned().unwrap_or_default();
    into.materials = list("materials");
    into.textures = list("textures");
    into.samplers = list("samplers");
    for image in document.images() {
        let (bytes, mime_type) = match image.source() {
            gltf::image::Source::View { view, mime_type } => {
                let range = view.offset()..view.offset().saturating_add(view.length());
                let bytes = buffers.get(view.buffer().index()).and_then(|buffer| buffer.get(range));
                (bytes.unwrap_or_default().to_vec(), mime_type.to_owned())
            }
            gltf::image::Source::Uri { uri, mime_type } => {
                let (bytes, of_data_uri) = fetch(uri, resolve).unwrap_or_default();
                let stated = mime_type.map_or(of_data_uri, str::to_owned);
                (bytes, if stated.is_empty() { mime_of(uri).to_owned() } else { stated })
            }
        };
        let name = image.name().unwrap_or_default().to_owned();
        if bytes.is_empty() {
            let name = if name.is_empty() { format!("image {}", image.index()) } else { name.clone() };
            into.repairs.push(Repair::MissingFile(name));
        }
        into.images.push(ImportedImage { name, mime_type, bytes });
    }
}

/// The MIME type that a file name's ending stands for.
pub fn mime_of(name: &str) -> &'static str {
    let ending = name.rsplit('.').next().unwrap_or_default().to_ascii_lowercase();
    match ending.as_str() {
        "png" => "image/png",
        "jpg" | "jpeg" => "image/jpeg",
        "webp" => "image/webp",
        _ => "",
    }
}

fn read_scene(document: &gltf::Document, buffers: &[Vec<u8>], raw: &mut Raw) -> Result<(), ImportError> {
    let scene = document.default_scene().or_else(|| document.scenes().next());
    // A file without scenes is a library: everything in it counts.
    let nodes: Vec<_> = scene.map_or_else(|| roots(document), |scene| scene.nodes().collect());
    let mut open: Vec<_> = nodes.into_iter().rev().map(|node| (node, Mat4::IDENTITY)).collect();
    let (mut seen, mut cyclic, mut skipped, mut converted) = (BTreeSet::new(), 0, 0, 0);
    while let Some((node, world_from_parent)) = open.pop() {
        if !seen.insert(node.index()) {
            cyclic += 1;
            continue;
        }
        let world_from_node = world_from_parent * Mat4::from_cols_array_2d(&node.transform().matrix());
        for primitive in node.mesh().into_iter().flat_map(|mesh| mesh.primitives()) {
            match read_primitive(&primitive, buffers, &mut raw.rest)? {
                Some(mut found) => {
                    transform(&mut found, world_from_node);
                    converted += usize::from(primitive.mode() != Mode::Triangles);
                    raw.primitives.push(found);
                }
                None => skipped += 1,
            }
        }
        let first_child = open.len();
        open.extend(node.children().map(|child| (child, world_from_node)));
        open[first_child..].reverse();
    }
    raw.rest.note(Repair::CyclicNodes, cyclic);
    raw.rest.note(Repair::SkippedPrimitives, skipped);
    raw.rest.note(Repair::ConvertedPrimitives, converted);
    Ok(())
}

fn roots(document: &gltf::Document) -> Vec<gltf::Node<'_>> {
    let children: BTreeSet<_> =
        document.nodes().flat_map(|n| n.children()).map(|child| child.index()).collect();
    document.nodes().filter(|node| !children.contains(&node.index())).collect()
}

fn read_primitive(
    primitive: &gltf::Primitive<'_>,
    buffers: &[Vec<u8>],
    rest: &mut Imported,
) -> Result<Option<Primitive>, ImportError> {
    let Some(positions) = primitive.get(&Semantic::Positions) else { return Ok(None) };
    if matches!(primitive.mode(), Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
        return Ok(None);
    }
    let beyond = |what: &str| malformed("glTF", format!("the {what} of a mesh lie beyond their buffer"));
    let positions = accessor::rows::<3>(&positions, buffers).ok_or_else(|| beyond("positions"))?;
    let indices = match primitive.indices() {
        Some(indices) => accessor::indices(&indices, buffers).ok_or_else(|| beyond("indices"))?,
        None => (0..positions.len() as u32).collect(),
    };
    let count = positions.len();
    let normals = attribute::<3>(primitive, Semantic::Normals, buffers, count, rest);
    let uvs = attribute::<2>(primitive, Semantic::TexCoords(0), buffers, count, rest);
    let with_alpha = |colors: gltf::Accessor<'_>| colors.dimensions() == Dimensions::Vec4;
    let colors = if primitive.get(&Semantic::Colors(0)).is_some_and(with_alpha) {
        attribute::<4>(primitive, Semantic::Colors(0), buffers, count, rest)
    } else {
        let plain = attribute::<3>(primitive, Semantic::Colors(0), buffers, count, rest);
        plain.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect()
    };
    let colors = colors.into_iter().map(|color| color.map(color_byte)).collect();
    let material = primitive.material().index().unwrap_or_else(|| rest.default_material());
    let triangles = triangles(primitive.mode(), &indices);
    let mesh = Mesh { positions, normals, uvs, colors, parts: Vec::new() };
    Ok(Some(Primitive { material, mesh, triangles }))
}

/// The rows of an optional attribute; none, with a note, if they don't fit the `count` vertices.
fn attribute<const N: usize>(
    primitive: &gltf::Primitive<'_>,
    semantic: Semantic,
    buffers: &[Vec<u8>],
    count: usize,
    rest: &mut Imported,
) -> Vec<[f32; N]> {
    let Some(accessor) = primitive.get(&semantic) else { return Vec::new() };
    let rows = accessor::rows::<N>(&accessor, buffers).filter(|rows| rows.len() == count);
    rows.unwrap_or_else(|| {
        rest.repairs.push(Repair::AttributeMismatch(semantic.to_string()));
        Vec::new()
    })
}

fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => {
            let orient =
                |(n, t): (usize, &[u32])| if n % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] };
            indices.windows(3).enumerate().map(orient).collect()
        }
        Mode::TriangleFan => match indices {
            [hub, rim @ ..] => rim.windows(2).map(|edge| [*hub, edge[0], edge[1]]).collect(),
            [] => Vec::new(),
        },
        _ => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
    }
}

fn transform(primitive: &mut Primitive, world_from_node: Mat4) {
    if world_from_node == Mat4::IDENTITY {
        return;
    }
    let linear = Mat3::from_mat4(world_from_node);
    let determinant = linear.determinant();
    for position in &mut primitive.mesh.positions {
        *position = world_from_node.transform_point3(Vec3::from_array(*position)).to_array();
    }
    // The cofactors carry normals even where the matrix has no inverse.
    let (x, y, z) = (linear.x_axis, linear.y_axis, linear.z_axis);
    let cofactors = Mat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * determinant.signum();
    for normal in &mut primitive.mesh.normals {
        *normal = (cofactors * Vec3::from_array(*normal)).normalize_or_zero().to_array();
    }
    if determinant < 0.0 {
        primitive.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
}
