//! The trees of a scene file: templates with all their levels of detail, and instances.

use std::sync::Arc;

use genescape_schema::scene::{
    FAR_TREES_NODE, GSC_IMPOSTOR, GSC_INSTANCES, IMPOSTOR_PICTURES, ImpostorExtension, Instance,
    InstancesExtension, ProgressiveMeshExtension, Resource, error_weight, read_instances,
};
use glam::Vec3;
use gltf::Semantic;
use rayon::prelude::*;
use serde_json::Value;

use super::bounds::{is_placed, is_tree_sized};
use super::document::Document;
use super::octahedral::{direction, octahedral};
use super::{Result, images};
use crate::lod::tree::rising;
use crate::scene::{
    Crown, Image, Impostor, LEAVES, LeafSide, Level, Material, Range, Template, TreeVertex, Trees, middles_m,
    sort_by_place,
};

/// Numbers of templates have 16 bits on the device.
const MAX_TEMPLATES: usize = 1 << 16;

/// The trees; none if the scene has none.
pub(super) fn read(document: &Document) -> Result<Trees> {
    let is_far = |node: &gltf::Node<'_>| node.name() == Some(FAR_TREES_NODE);
    let of_node = |far: bool| {
        let mut nodes = document.gltf.nodes().filter(move |node| is_far(node) == far);
        nodes.find_map(|node| Some(node.extension_value(GSC_INSTANCES)?.clone()))
    };
    let records = |value: &Value| -> Result<(InstancesExtension, Vec<Instance>)> {
        let extension: InstancesExtension = document.extension(Some(value), GSC_INSTANCES)?;
        let instances = read_instances(&document.view(extension.buffer_view)?)
            .map_err(|error| document.wrong(format!("its {GSC_INSTANCES} is wrong: {error}")))?;
        Ok((extension, instances))
    };
    let Some(value) = of_node(false) else { return Ok(Trees::default()) };
    let (extension, instances) = records(&value)?;
    if extension.templates.len() > MAX_TEMPLATES {
        let count = extension.templates.len();
        return Err(
            document.wrong(format!("it has {count} templates of trees; at most {MAX_TEMPLATES} are drawn"))
        );
    }
    let mut far = of_node(true).map_or(Ok(Vec::new()), |value| Ok(records(&value)?.1))?;
    sort_by_place(&mut far);
    let templates = extension
        .templates
        .par_iter()
        .map(|entry| template(document, &entry.name, entry.mesh))
        .collect::<Result<Vec<_>>>()?;
    let trees = Trees { templates, instances: instances.into(), far: far.into() };
    if let Some(tree) = trees.all().find(|tree| tree.template as usize >= trees.templates.len()) {
        return Err(document.wrong(format!("a tree is of unknown template {}", tree.template)));
    }
    if !trees.all().all(is_placed) {
        return Err(document.wrong("a tree stands or reaches beyond all bounds"));
    }
    Ok(trees)
}

fn template(document: &Document, name: &str, finest: usize) -> Result<Arc<Template>> {
    let mesh = mesh(document, finest)?;
    let blob = blob_name(document, &mesh);
    document.store.get(&format!("{blob} {finest}"), || {
        let value = mesh.extension_value("GSC_progressive_mesh");
        let extension: ProgressiveMeshExtension = document.extension(value, "GSC_progressive_mesh")?;
        let template = build(document, name, &blob, &extension)?;
        let impostor = mesh.extension_value(GSC_IMPOSTOR).map(|value| impostor(document, value, &template));
        Ok(Template { impostor: impostor.transpose()?, ..template })
    })
}

fn mesh<'a>(document: &'a Document, index: usize) -> Result<gltf::Mesh<'a>> {
    document.gltf.meshes().nth(index).ok_or_else(|| document.wrong(format!("it has no mesh {index}")))
}

/// Name of the file that a mesh's positions are in.
fn blob_name(document: &Document, mesh: &gltf::Mesh<'_>) -> String {
    let positions = mesh.primitives().next().and_then(|primitive| primitive.get(&Semantic::Positions));
    let buffer = positions.and_then(|accessor| accessor.view()).map(|view| view.buffer());
    match buffer.map(|buffer| buffer.source()) {
        Some(gltf::buffer::Source::Uri(uri)) => document.name_of(&Resource::file(uri, "")),
        _ => format!("{} mesh {}", document.name_of(&Resource::view(0, "")), mesh.index()),
    }
}

fn build(
    document: &Document,
    name: &str,
    blob: &str,
    extension: &ProgressiveMeshExtension,
) -> Result<Template> {
    let clusters = extension.clusters.map(|level| level as u32);
    let error_weight = error_weight(extension.coverage);
    let mut template = Template {
        name: name.to_owned(),
        blob: blob.to_owned(),
        clusters,
        error_weight,
        ..Default::default()
    };
    // Numbers of the materials in the file, in the order of the finest level.
    let mut materials: Vec<usize> = Vec::new();
    for (number, level) in extension.levels.iter().enumerate() {
        let last = number + 1 == extension.levels.len();
        let base_vertex = template.vertices.len() as u32;
        // Of each material; several parts may be of one.
        let mut lists = vec![Vec::new(); materials.len()];
        let mut strips = vec![Range::default(); materials.len()];
        for (number_of_part, primitive) in mesh(document, level.mesh)?.primitives().enumerate() {
            let material = primitive.material();
            let index =
                material.index().ok_or_else(|| document.wrong("a tree has a part without material"))?;
            let slot = materials.iter().position(|&known| known == index).unwrap_or_else(|| {
                materials.push(index);
                lists.push(Vec::new());
                strips.push(Range::default());
                materials.len() - 1
            });
            if template.materials.len() < materials.len() {
                let material = read_material(document, &material)?;
                let clusters = material.alpha_cutoff.is_some() && Some(number as u32) == template.clusters;
                template.materials.push(Material { clusters, thin: material.thin && !clusters, ..material });
            }
            let first_vertex = template.vertices.len() as u32 - base_vertex;
            let delta = if last { None } else { level.texcoord_deltas.get(number_of_part).copied() };
            let mut part = vertices(document, &primitive, delta)?;
            let is_masked = template.materials[slot].alpha_cutoff.is_some();
            let strip = level.strips.get(number_of_part).filter(|_| !is_masked);
            // What is thin gives no shade.
            if is_masked && !template.materials[slot].thin {
                shade_crown(&mut part);
            }
            let count = part.len();
            template.vertices.extend(part);
            let moved = |indices: Vec<u32>| indices.into_iter().map(move |index| index + first_vertex);
            let indices: &mut Vec<u32> = &mut lists[slot];
            indices.extend(moved(document.indices(&primitive, count)?));
            if let Some(&strip) = strip {
                strips[slot] =
                    add(&mut template.indices, moved(document.index_list(document.accessor(strip)?, count)?));
            }
        }
        let ranges = lists.into_iter().map(|list| add(&mut template.indices, list.into_iter())).collect();
        let error_m = error_weight * level.error_m;
        template.levels.push(Level { error_m, base_vertex, ranges, strips });
    }
    check_levels(document, &template)?;
    let errors_m: Vec<f32> = rising(template.levels.iter().map(|level| level.error_m)).collect();
    template.levels.iter_mut().zip(errors_m).for_each(|(level, error_m)| level.error_m = error_m);
    let parts = materials.len();
    for level in &mut template.levels {
        level.ranges.resize(parts, Range::default());
        level.strips.resize(parts, Range::default());
    }
    (template.center_m, template.radius_m) = sphere(&template.vertices);
    Ok(template)
}

/// Adds indices to a list of them.
fn add(list: &mut Vec<u32>, indices: impl Iterator<Item = u32>) -> Range {
    let first = list.len() as u32;
    list.extend(indices);
    Range { first, count: list.len() as u32 - first }
}

/// The pictures of a tree whose meshes are read.
fn impostor(document: &Document, value: &serde_json::Value, template: &Template) -> Result<Impostor> {
    let ImpostorExtension { mesh: cards, relief, error_m, axis_m, low_m, size_m } =
        document.extension(Some(value), GSC_IMPOSTOR)?;
    let wrong = |what: &str| document.wrong(format!("{} has pictures {what}", template.name));
    let primitive = mesh(document, cards)?.primitives().next();
    let material = primitive.ok_or_else(|| wrong("without cards"))?.material();
    let Material { color, .. } = read_material(document, &material)?;
    let color = color.ok_or_else(|| wrong("without colour"))?;
    let relief = images::png(document, &relief)?;
    let is_size = |m: f32| m.is_finite() && m > 0.0;
    if !size_m.into_iter().chain([error_m]).all(is_size) {
        return Err(wrong("of no size, or without error"));
    }
    let [x, z] = axis_m;
    if !is_tree_sized(&[[x, low_m, z], [size_m[0], low_m + size_m[1], 0.0]]) {
        return Err(wrong("larger than any tree"));
    }
    let is_strip = color.width_px == IMPOSTOR_PICTURES * color.height_px;
    if !is_strip || (relief.width_px, relief.height_px) != (color.width_px, color.height_px) {
        return Err(wrong("that are not four squares side by side, of one size with their relief"));
    }
    let places = leaf_vertices(template).map(|vertex| Vec3::from(vertex.position_m));
    let crown = Crown::around(places);
    let (leaves, leaf_m) = some_leaves(template);
    let middles_m = middles_m(&relief, size_m[0]);
    Ok(Impostor { color, relief, axis_m, low_m, size_m, error_m, crown, leaves, leaf_m, middles_m })
}

/// The corners of the triangles of all leaves of D_0.
fn leaf_vertices(template: &Template) -> impl Iterator<Item = &TreeVertex> + Clone {
    let finest = template.levels.first();
    let parts = finest.into_iter().flat_map(|level| level.ranges.iter().zip(&template.materials));
    let masked = parts.filter(|(_, material)| material.alpha_cutoff.is_some());
    let base = finest.map_or(0, |level| level.base_vertex as usize);
    masked
        .flat_map(|(range, _)| &template.indices[range.first as usize..][..range.count as usize])
        .map(move |&vertex| &template.vertices[base + vertex as usize])
}

/// Leaves of D_0 that are evenly spread over all their area, and how wide what shows of one is: a leaf takes about half of its card, as
/// much as one of its two triangles, and others hide half of its width.
fn some_leaves(template: &Template) -> ([LeafSide; LEAVES], f32) {
    let corners: Vec<&TreeVertex> = leaf_vertices(template).collect();
    let (triangles, _) = corners.as_chunks::<3>();
    let twice_area_m2 = |corners: &[&TreeVertex; 3]| {
        let [a, b, c] = corners.map(|corner| Vec3::from(corner.position_m));
        (b - a).cross(c - a)
    };
    let sums_m2: Vec<f32> = triangles
        .iter()
        .scan(0.0, |sum_m2, corners| {
            *sum_m2 += twice_area_m2(corners).length();
            Some(*sum_m2)
        })
        .collect();
    let Some(&all_m2) = sums_m2.last() else { return ([LeafSide::default(); LEAVES], MIN_LEAF_M) };
    let leaf_m = (0.125 * all_m2 / triangles.len() as f32).sqrt().max(MIN_LEAF_M);
    let leaves = std::array::from_fn(|leaf| {
        let at_m2 = (leaf as f32 + 0.5) / LEAVES as f32 * all_m2;
        let triangle = &triangles[sums_m2.partition_point(|&sum_m2| sum_m2 < at_m2).min(triangles.len() - 1)];
        // Nearer now to the one corner, now to another.
        let near = triangle.iter().cycle().skip(leaf % 3).zip([0.6, 0.2, 0.2]);
        let normal: Vec3 = near.map(|(corner, part)| part * direction(corner.normal_oct)).sum();
        LeafSide { normal: normal.normalize_or_zero(), face: twice_area_m2(triangle).normalize_or_zero() }
    });
    (leaves, leaf_m)
}

/// Smaller leaves are not told apart.
const MIN_LEAF_M: f32 = 0.02;

fn check_levels(document: &Document, template: &Template) -> Result<()> {
    let is_sound = |level: &Level| level.error_m.is_finite() && level.error_m > 0.0;
    if template.levels.is_empty() || !template.levels.iter().all(is_sound) {
        return Err(
            document.wrong(format!("{} has no levels of detail, or levels without error", template.name))
        );
    }
    Ok(())
}

/// One primitive's vertices with where they go at the end of the morph.
fn vertices(
    document: &Document,
    primitive: &gltf::Primitive<'_>,
    texcoord_deltas: Option<usize>,
) -> Result<Vec<TreeVertex>> {
    let positions = primitive.get(&Semantic::Positions);
    let positions: Vec<[f32; 3]> =
        document.values(positions.ok_or_else(|| document.wrong("a tree has no positions"))?)?;
    let count = positions.len();
    let get = |semantic: Semantic| primitive.get(&semantic);
    let normals = values_or(document, get(Semantic::Normals), [0.0, 1.0, 0.0], count, "normals")?;
    let uvs = values_or(document, get(Semantic::TexCoords(0)), [0.0; 2], count, "texture coordinates")?;
    let colors = values_or(document, get(Semantic::Colors(0)), [255; 4], count, "colours")?;
    let tangents = values_or(document, get(Semantic::Tangents), [1.0, 0.0, 0.0, 1.0], count, "tangents")?;
    let target = primitive.morph_targets().next();
    let (moves, turns) = target.map_or((None, None), |target| (target.positions(), target.normals()));
    let moves = values_or(document, moves, [0.0; 3], count, "geomorphs")?;
    let turns = values_or(document, turns, [0.0; 3], count, "geomorphs of normals")?;
    if !is_tree_sized(&positions) || !is_tree_sized(&moves) {
        return Err(document.wrong("a tree is larger than any tree"));
    }
    let slides = texcoord_deltas.map(|index| document.accessor(index)).transpose()?;
    let slides = values_or(document, slides, [0.0; 2], count, "geomorphs of texture coordinates")?;
    let vertex = |v: usize| {
        let normal = Vec3::from(normals[v]);
        let [x, y, z, sign] = tangents[v];
        let [r, g, b, _] = colors[v];
        TreeVertex {
            position_m: positions[v],
            color: [r, g, b, if sign < 0.0 { 0 } else { 255 }],
            position_delta_m: moves[v],
            normal_oct: octahedral(normal),
            uv: uvs[v],
            uv_delta: slides[v],
            normal_end_oct: octahedral(normal + Vec3::from(turns[v])),
            tangent_oct: octahedral(Vec3::new(x, y, z)),
        }
    };
    Ok((0..count).map(vertex).collect())
}

/// An attribute's `count` values, or as often `default` if the file has none.
fn values_or<T: gltf::accessor::Item + Copy>(
    document: &Document,
    accessor: Option<gltf::Accessor<'_>>,
    default: T,
    count: usize,
    what: &str,
) -> Result<Vec<T>> {
    let Some(accessor) = accessor else { return Ok(vec![default; count]) };
    let values = document.values(accessor)?;
    if values.len() == count {
        Ok(values)
    } else {
        Err(document.wrong(format!("a tree's {what} do not match")))
    }
}

/// Writes into each leaf's alpha how open its surroundings are: little in the middle of the crown, much at its surface
/// and top. Light that crosses a crown falls off with the foliage on its way, of which the place within the ellipsoid
/// around the crown is the measure here.
fn shade_crown(leaves: &mut [TreeVertex]) {
    let crown = Crown::around(leaves.iter().map(|leaf| Vec3::from(leaf.position_m)));
    let (middle, half) = (Vec3::from(crown.middle_m), Vec3::from(crown.half_m));
    for leaf in leaves {
        let place = (Vec3::from(leaf.position_m) - middle) / half;
        let outside = ((place.length() - 0.15) / 0.85).clamp(0.0, 1.0);
        let open = 0.12 + 0.7 * outside + 0.18 * (0.5 + 0.5 * place.y).clamp(0.0, 1.0);
        leaf.color[3] = (open * 255.0).round() as u8;
    }
}

/// A sphere around all vertices, at the start and the end of their morphs.
fn sphere(vertices: &[TreeVertex]) -> ([f32; 3], f32) {
    let ends = |v: &TreeVertex| {
        let start = Vec3::from(v.position_m);
        [start, start + Vec3::from(v.position_delta_m)]
    };
    let points = || vertices.iter().flat_map(ends);
    let low = points().fold(Vec3::MAX, Vec3::min);
    let high = points().fold(Vec3::MIN, Vec3::max);
    let center = if vertices.is_empty() { Vec3::ZERO } else { 0.5 * (low + high) };
    let radius = points().map(|point| point.distance_squared(center)).fold(0.0, f32::max).sqrt();
    (center.into(), radius)
}

fn read_material(document: &Document, material: &gltf::Material<'_>) -> Result<Material> {
    let pbr = material.pbr_metallic_roughness();
    let read = |texture: gltf::Texture<'_>| -> Result<Image> {
        let image = texture.source();
        let (resource, mipmaps) = image_files(document, &image)?;
        images::with_mips(document, &resource, &mipmaps)
    };
    let color = pbr.base_color_texture().map(|info| read(info.texture())).transpose()?;
    let alpha_cutoff = match material.alpha_mode() {
        gltf::material::AlphaMode::Opaque => None,
        _ => Some(material.alpha_cutoff().unwrap_or(0.5)),
    };
    Ok(Material {
        name: material.name().unwrap_or("unnamed").to_owned(),
        thin: alpha_cutoff.is_some() && color.as_ref().is_some_and(|color| color.levels.len() == 1),
        color,
        color_factor: pbr.base_color_factor(),
        normal: material.normal_texture().map(|info| read(info.texture())).transpose()?,
        alpha_cutoff,
        clusters: false,
    })
}

/// An image's own file and those of its coarser versions.
fn image_files(document: &Document, image: &gltf::Image<'_>) -> Result<(Resource, Vec<Resource>)> {
    #[derive(Default, serde::Deserialize)]
    #[serde(default)]
    struct Extras {
        mipmaps: Vec<Resource>,
    }
    let resource = match image.source() {
        gltf::image::Source::Uri { uri, .. } => Resource::file(uri, "image/png"),
        gltf::image::Source::View { view, .. } => Resource::view(view.index(), "image/png"),
    };
    let extras = image.extras().as_ref().map(|raw| serde_json::from_str::<Extras>(raw.get()));
    let extras = extras.transpose().map_err(|error| document.wrong(format!("mipmaps are wrong: {error}")))?;
    Ok((resource, extras.unwrap_or_default().mipmaps))
}
