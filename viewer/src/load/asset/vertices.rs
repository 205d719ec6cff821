//! Attributes of a primitive → vertices, with what they lack made up, where the file's pose and levels put them.

use std::collections::BTreeMap;

use glam::{Affine3A, Mat3A, Vec3};
use gltf::Semantic;
use gltf::json::Index;
use gltf::json::accessor::Accessor;
use gltf::json::mesh::{MorphTarget, Primitive};
use gltf::json::validation::Checked;

use super::file::AssetFile;
use super::notes::Notes;
use crate::load::octahedral::{direction, octahedral};
use crate::scene::AssetVertex;

/// What is done to a mesh's vertices when it is read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Treatment<'a> {
    /// Into the space of the shape.
    pub shape_from_mesh: Affine3A,
    /// Triangles turn their other side out: the shape is mirrored where it stands.
    pub mirrored: bool,
    /// The first morph target leads to the next level; for each primitive an accessor says how texture coordinates move.
    pub morph: Option<&'a [usize]>,
    /// What each joint of its skeleton does to it.
    pub pose: Option<&'a [Affine3A]>,
}

type Found<T> = Option<Vec<T>>;
type Attributes<'a> = BTreeMap<&'a Semantic, Index<Accessor>>;

/// The vertices of a primitive where the treatment puts them.
pub(super) fn read(
    file: &AssetFile,
    primitive: &Primitive,
    weights: &[f32],
    deltas: Option<Option<usize>>,
    treatment: &Treatment<'_>,
    notes: &mut Notes,
) -> Found<AssetVertex> {
    let mut vertices = unplaced(file, primitive, weights, deltas, notes)?;
    if let Some(pose) = treatment.pose {
        take_pose(file, primitive, pose, &mut vertices);
    }
    vertices.iter_mut().for_each(|vertex| *vertex = transformed(*vertex, &treatment.shape_from_mesh));
    Some(vertices)
}

/// Accessors by what they are for, in a fixed order.
pub(super) fn attributes(primitive: &Primitive) -> Attributes<'_> {
    primitive.attributes.iter().filter_map(|(key, index)| Some((valid(key)?, *index))).collect()
}

fn unplaced(
    file: &AssetFile,
    primitive: &Primitive,
    weights: &[f32],
    deltas: Option<Option<usize>>,
    notes: &mut Notes,
) -> Found<AssetVertex> {
    let attributes = attributes(primitive);
    let get = |semantic: Semantic| attributes.get(&semantic).copied();
    let places = get(Semantic::Positions)?;
    let accessor = file.root.accessors.get(places.value())?;
    if accessor.buffer_view.is_none() && accessor.sparse.is_none() {
        // All zeros, says the standard: what only a decompressor would fill.
        return None;
    }
    let mut positions: Vec<Vec3> = vectors(file.rows::<3>(places)?);
    let count = positions.len();
    let mut fits = |what: &str, length: usize| {
        let is_right = length == count;
        if !is_right {
            notes.add(format!("{what} do not match their vertices, and are left out"));
        }
        is_right
    };
    let mut normals: Found<Vec3> = get(Semantic::Normals).and_then(|index| file.rows(index)).map(vectors);
    let tangents: Found<[f32; 4]> = get(Semantic::Tangents).and_then(|index| file.rows(index));
    let colors = get(Semantic::Colors(0)).and_then(|index| file.colors(index));
    let uvs = [0, 1].map(|set| get(Semantic::TexCoords(set)).and_then(|index| file.rows::<2>(index)));
    normals = normals.filter(|all| fits("Normals", all.len()));
    let tangents = tangents.filter(|all| fits("Tangents", all.len()));
    let colors = colors.filter(|all| fits("Colours", all.len()));
    let uvs = uvs.map(|all| all.filter(|all| fits("Texture coordinates", all.len())));
    let targets = primitive.targets.as_deref().unwrap_or_default();
    for (target, weight) in targets.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
        add_weighted(file, target, *weight, &mut positions, normals.as_mut());
    }
    let target = targets.first().filter(|_| deltas.is_some());
    let way = |index: Option<Index<Accessor>>| -> Found<Vec3> {
        index.and_then(|index| file.rows(index)).map(vectors).filter(|all| all.len() == count)
    };
    let (moves, turns) = target.map_or((None, None), |target| (way(target.positions), way(target.normals)));
    let slides: Found<[f32; 2]> = deltas.flatten().and_then(|index| file.rows(Index::new(index as u32)));
    let slides = slides.filter(|all| all.len() == count);
    let at = |all: &Found<Vec3>, v: usize| all.as_ref().map_or(Vec3::ZERO, |all| all[v]);
    let vertex = |v: usize| {
        let normal = at(&normals, v);
        let [x, y, z, sign] = tangents.as_ref().map_or([1.0, 0.0, 0.0, 0.0], |all| all[v]);
        let [along_x, along_y] = octahedral(Vec3::new(x, y, z));
        let full = |value: f32| (value.signum() * 32767.0) as i16;
        AssetVertex {
            position_m: positions[v].to_array(),
            color: colors.as_ref().map_or([255; 4], |all| all[v].map(byte)),
            position_delta_m: at(&moves, v).to_array(),
            normal_oct: octahedral(normal),
            uvs: [0, 1].map(|set: usize| uvs[set].as_ref().map_or([0.0; 2], |all| all[v].map(finite))),
            uv_delta: slides.as_ref().map_or([0.0; 2], |all| all[v].map(finite)),
            normal_end_oct: octahedral(normal + at(&turns, v)),
            tangent: [
                along_x,
                along_y,
                if tangents.is_some() { full(sign) } else { 0 },
                if normal != Vec3::ZERO { i16::MAX } else { 0 },
            ],
        }
    };
    Some((0..count).map(vertex).collect())
}

fn valid<T>(checked: &Checked<T>) -> Option<&T> {
    if let Checked::Valid(value) = checked { Some(value) } else { None }
}

/// The pose that the file gives a mesh that could change its shape.
fn add_weighted(
    file: &AssetFile,
    target: &MorphTarget,
    weight: f32,
    positions: &mut [Vec3],
    normals: Option<&mut Vec<Vec3>>,
) {
    let add = |index: Option<Index<Accessor>>, to: &mut [Vec3]| {
        for (value, change) in
            to.iter_mut().zip(index.and_then(|index| file.rows::<3>(index)).unwrap_or_default())
        {
            *value += weight * Vec3::from(change);
        }
    };
    add(target.positions, positions);
    if let Some(normals) = normals {
        add(target.normals, normals);
    }
}

fn vectors(rows: Vec<[f32; 3]>) -> Vec<Vec3> {
    rows.into_iter().map(Vec3::from).collect()
}

fn finite(value: f32) -> f32 {
    if value.is_finite() { value } else { 0.0 }
}

fn byte(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// Puts vertices where the joints hold them that they hang on.
fn take_pose(file: &AssetFile, primitive: &Primitive, pose: &[Affine3A], vertices: &mut [AssetVertex]) {
    let rows = |semantic: Semantic| {
        let index = primitive.attributes.get(&Checked::Valid(semantic))?;
        file.rows::<4>(*index)
    };
    let (Some(joints), Some(weights)) = (rows(Semantic::Joints(0)), rows(Semantic::Weights(0))) else {
        return;
    };
    for ((vertex, joints), weights) in vertices.iter_mut().zip(joints).zip(weights) {
        let sum: f32 = weights.iter().sum();
        let held = joints
            .iter()
            .zip(weights)
            .filter_map(|(joint, weight)| Some((pose.get(*joint as usize)?, weight)));
        let mut mean = [0.0; 12];
        for (by, weight) in held {
            mean.iter_mut().zip(by.to_cols_array()).for_each(|(sum, part)| *sum += part * weight);
        }
        if sum > 1e-6 {
            *vertex = transformed(*vertex, &Affine3A::from_cols_array(&mean.map(|part| part / sum)));
        }
    }
}

fn transformed(vertex: AssetVertex, by: &Affine3A) -> AssetVertex {
    if *by == Affine3A::IDENTITY {
        return vertex;
    }
    let turn = |oct: [i16; 2], by: Mat3A| octahedral(by.mul_vec3(direction(oct)).normalize_or_zero());
    let cofactors = Mat3A::from_cols(
        by.matrix3.y_axis.cross(by.matrix3.z_axis),
        by.matrix3.z_axis.cross(by.matrix3.x_axis),
        by.matrix3.x_axis.cross(by.matrix3.y_axis),
    );
    let [x, y, sign, normal] = vertex.tangent;
    let [along_x, along_y] = turn([x, y], by.matrix3);
    AssetVertex {
        position_m: by.transform_point3(vertex.position_m.into()).to_array(),
        position_delta_m: by.transform_vector3(vertex.position_delta_m.into()).to_array(),
        normal_oct: turn(vertex.normal_oct, cofactors),
        normal_end_oct: turn(vertex.normal_end_oct, cofactors),
        tangent: [along_x, along_y, sign, normal],
        ..vertex
    }
}
