//! .glb and .gltf → primitives of the default scene in world space, materials and images as they are.

use std::collections::BTreeSet;

use glam::{Mat3, Mat4, Vec3};
use gltf::mesh::{Mode, Semantic};
use serde_json::{Value, json};

use super::{
    ImportError, Imported, ImportedImage, ImportedMaterial, Primitive, Raw, Repair, Resolve, accessor,
};

/// Extensions that may be required: they change materials, which are passed through, or how numbers are stored.
const UNDERSTOOD: [&str; 3] = ["KHR_mesh_quantization", "KHR_texture_transform", "KHR_lights_punctual"];

/// Reads either form; which one it is shows in the first bytes.
pub fn read(bytes: &[u8], resolve: &Resolve<'_>) -> Result<Raw, ImportError> {
    let (text, blob) = match bytes.starts_with(b"glTF") {
        true => chunks(bytes)?,
        false => (bytes, None),
    };
    let mut root: Value = serde_json::from_slice(text).map_err(|e| malformed("glTF", e))?;
    check_required(&mut root)?;
    let skipped = drop_without_positions(&mut root)?;
    let plain = serde_json::to_vec(&root).map_err(|e| malformed("glTF", e))?;
    let document = gltf::Gltf::from_slice(&plain).map_err(|e| malformed("glTF", e))?;
    let buffers = read_buffers(&document, blob, resolve)?;
    let mut raw = Raw::default();
    raw.rest.repairs.extend((skipped > 0).then_some(Repair::SkippedPrimitives(skipped)));
    pass_through(&root, &document, &buffers, resolve, &mut raw.rest);
    read_scene(&document, &buffers, &mut raw)?;
    Ok(raw)
}

fn malformed(format: &'static str, reason: impl ToString) -> ImportError {
    ImportError::Malformed { format, reason: reason.to_string() }
}

/// The JSON and the binary chunk of a .glb file.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), ImportError> {
    let word = |at: usize| {
        let chunk = bytes.get(at..).and_then(|rest| rest.first_chunk::<4>());
        chunk.map(|word| u32::from_le_bytes(*word)).ok_or_else(|| malformed("GLB", "it ends too early"))
    };
    if word(4)? != 2 {
        return Err(malformed("GLB", format!("it is of version {}, not 2", word(4)?)));
    }
    let body = |at: usize| {
        let end = (word(at)? as usize).checked_add(at + 8);
        let bytes = end.and_then(|end| bytes.get(at + 8..end));
        bytes.ok_or_else(|| malformed("GLB", "it ends too early"))
    };
    if word(16)? != u32::from_le_bytes(*b"JSON") {
        return Err(malformed("GLB", "it doesn't start with JSON"));
    }
    let text = body(12)?;
    let next = 20 + text.len();
    if next + 8 > bytes.len() {
        return Ok((text, None));
    }
    let is_binary = word(next + 4)? == u32::from_le_bytes(*b"BIN\0");
    Ok((text, if is_binary { Some(body(next)?) } else { None }))
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
    let mut none = Vec::new();
    let accessors = root.get_mut("accessors").and_then(Value::as_array_mut).unwrap_or(&mut none);
    for place in positions {
        let accessor = accessors.get_mut(place as usize).and_then(Value::as_object_mut);
        let accessor = accessor.ok_or_else(|| malformed("glTF", format!("there is no accessor {place}")))?;
        // Bounds are required by the standard, often missing, and of no use here.
        for bound in ["min", "max"] {
            accessor.entry(bound).or_insert_with(|| json!([0.0, 0.0, 0.0]));
        }
    }
    Ok(skipped)
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

/// Bytes and, for data URIs, the MIME type.
fn fetch(uri: &str, resolve: &Resolve<'_>) -> Result<(Vec<u8>, String), ImportError> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (head, body) = data.split_once(',').ok_or_else(|| malformed("glTF", "a data URI is cut off"))?;
        let mime_type = head.split(';').next().unwrap_or_default().to_owned();
        let bytes = match head.ends_with(";base64") {
            true => base64(body).ok_or_else(|| malformed("glTF", "a data URI isn't base64"))?,
            false => percent_decoded(body),
        };
        return Ok((bytes, mime_type));
    }
    let name = String::from_utf8_lossy(&percent_decoded(uri)).into_owned();
    match resolve(&name) {
        Ok(bytes) => Ok((bytes, String::new())),
        Err(source) => Err(ImportError::Missing { name, source }),
    }
}

fn percent_decoded(text: &str) -> Vec<u8> {
    let bytes = text.as_bytes();
    let (mut out, mut at) = (Vec::with_capacity(bytes.len()), 0);
    while at < bytes.len() {
        let code = (bytes[at] == b'%').then(|| text.get(at + 1..at + 3)).flatten();
        match code.and_then(|hex| u8::from_str_radix(hex, 16).ok()) {
            Some(byte) => {
                out.push(byte);
                at += 3;
            }
            None => {
                out.push(bytes[at]);
                at += 1;
            }
        }
    }
    out
}

fn base64(text: &str) -> Option<Vec<u8>> {
    let digit = |byte: u8| match byte {
        b'A'..=b'Z' => Some(byte - b'A'),
        b'a'..=b'z' => Some(byte - b'a' + 26),
        b'0'..=b'9' => Some(byte - b'0' + 52),
        b'+' | b'-' => Some(62),
        b'/' | b'_' => Some(63),
        _ => None,
    };
    let (mut out, mut held, mut bits) = (Vec::with_capacity(text.len() * 3 / 4), 0_u32, 0);
    for byte in text.trim_end_matches('=').bytes().filter(|byte| !byte.is_ascii_whitespace()) {
        held = held << 6 | u32::from(digit(byte)?);
        bits += 6;
        if bits >= 8 {
            bits -= 8;
            out.push((held >> bits) as u8);
        }
    }
    Some(out)
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
    into.materials = list("materials").into_iter().map(|json| ImportedMaterial { json }).collect();
    into.textures = list("textures");
    into.samplers = list("samplers");
    for image in document.images() {
        let mut found = ImportedImage {
            name: image.name().unwrap_or_default().to_owned(),
            mime_type: String::new(),
            bytes: Vec::new(),
        };
        match image.source() {
            gltf::image::Source::View { view, mime_type } => {
                let range = view.offset()..view.offset().saturating_add(view.length());
                let bytes = buffers.get(view.buffer().index()).and_then(|buffer| buffer.get(range));
                found.bytes = bytes.unwrap_or_default().to_vec();
                mime_type.clone_into(&mut found.mime_type);
            }
            gltf::image::Source::Uri { uri, mime_type } => {
                if let Ok((bytes, of_uri)) = fetch(uri, resolve) {
                    found.bytes = bytes;
                    found.mime_type = mime_type.map_or(of_uri, str::to_owned);
                }
                if found.mime_type.is_empty() {
                    found.mime_type = mime_of(uri).to_owned();
                }
            }
        }
        if found.bytes.is_empty() {
            let name =
                if found.name.is_empty() { format!("image {}", image.index()) } else { found.name.clone() };
            into.repairs.push(Repair::MissingFile(name));
        }
        into.images.push(found);
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
    let mut open: Vec<_> = match &scene {
        Some(scene) => scene.nodes().map(|node| (node, Mat4::IDENTITY)).collect(),
        None => roots(document).into_iter().map(|node| (node, Mat4::IDENTITY)).collect(),
    };
    open.reverse();
    let (mut seen, mut cyclic, mut skipped, mut converted) = (BTreeSet::new(), 0, 0, 0);
    while let Some((node, world_from_parent)) = open.pop() {
        if !seen.insert(node.index()) {
            cyclic += 1;
            continue;
        }
        let world_from_node = world_from_parent * Mat4::from_cols_array_2d(&node.transform().matrix());
        for primitive in node.mesh().into_iter().flat_map(|mesh| mesh.primitives()) {
            match read_primitive(&primitive, buffers, world_from_node, raw)? {
                Some(found) => {
                    converted += usize::from(primitive.mode() != Mode::Triangles);
                    raw.primitives.push(found);
                }
                None => skipped += 1,
            }
        }
        let children: Vec<_> = node.children().map(|child| (child, world_from_node)).collect();
        open.extend(children.into_iter().rev());
    }
    let repairs = &mut raw.rest.repairs;
    repairs.extend((cyclic > 0).then_some(Repair::CyclicNodes(cyclic)));
    repairs.extend((skipped > 0).then_some(Repair::SkippedPrimitives(skipped)));
    repairs.extend((converted > 0).then_some(Repair::ConvertedPrimitives(converted)));
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
    world_from_node: Mat4,
    raw: &mut Raw,
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
    let mut misfits = Vec::new();
    let mut optional = |semantic: Semantic, fits: bool| {
        if !fits {
            misfits.push(Repair::AttributeMismatch(semantic.to_string()));
        }
        fits
    };
    let mut read3 = |semantic: Semantic| {
        let rows = accessor::rows::<3>(&primitive.get(&semantic)?, buffers).unwrap_or_default();
        optional(semantic, rows.len() == count).then_some(rows)
    };
    let normals = read3(Semantic::Normals);
    let uvs = primitive.get(&Semantic::TexCoords(0)).and_then(|uvs| {
        let rows = accessor::rows::<2>(&uvs, buffers).unwrap_or_default();
        optional(Semantic::TexCoords(0), rows.len() == count).then_some(rows)
    });
    let colors = primitive.get(&Semantic::Colors(0)).and_then(|colors| {
        let with_alpha = accessor::rows::<4>(&colors, buffers);
        let plain = || {
            Some(accessor::rows::<3>(&colors, buffers)?.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect())
        };
        let rows: Vec<_> = with_alpha.or_else(plain).unwrap_or_default();
        let byte = |value: f32| (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
        optional(Semantic::Colors(0), rows.len() == count)
            .then(|| rows.into_iter().map(|row| row.map(byte)).collect())
    });
    raw.rest.repairs.append(&mut misfits);
    let material = primitive.material().index().unwrap_or_else(|| default_material(&mut raw.rest));
    let triangles = triangles(primitive.mode(), &indices);
    let mut found = Primitive { material, positions, normals, uvs, colors, triangles };
    transform(&mut found, world_from_node);
    Ok(Some(found))
}

/// The material of primitives that have none: glTF's default.
fn default_material(into: &mut Imported) -> usize {
    let json = json!({ "name": "default" });
    let place = into.materials.iter().position(|material| material.json == json);
    place.unwrap_or_else(|| {
        into.materials.push(ImportedMaterial { json });
        into.materials.len() - 1
    })
}

fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => {
            let orient =
                |(n, t): (usize, &[u32])| if n % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] };
            indices.windows(3).enumerate().map(orient).collect()
        }
        Mode::TriangleFan => indices
            .first()
            .map(|&hub| indices[1..].windows(2).map(|edge| [hub, edge[0], edge[1]]).collect())
            .unwrap_or_default(),
        _ => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
    }
}

fn transform(primitive: &mut Primitive, world_from_node: Mat4) {
    if world_from_node == Mat4::IDENTITY {
        return;
    }
    let linear = Mat3::from_mat4(world_from_node);
    let determinant = linear.determinant();
    for position in &mut primitive.positions {
        *position = world_from_node.transform_point3(Vec3::from_array(*position)).to_array();
    }
    // The cofactors carry normals even where the matrix has no inverse.
    let (x, y, z) = (linear.x_axis, linear.y_axis, linear.z_axis);
    let cofactors = Mat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * determinant.signum();
    for normal in primitive.normals.iter_mut().flatten() {
        *normal = (cofactors * Vec3::from_array(*normal)).normalize_or_zero().to_array();
    }
    if determinant < 0.0 {
        primitive.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
}
