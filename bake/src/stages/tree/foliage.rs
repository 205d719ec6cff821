//! Cards → their triangles, bent and coloured.
//!
//! Normals are rounded: mostly those of the crown and of the mass of leaves that a card belongs to, so that foliage
//! shades as masses.

use glam::Vec3;

use super::cards::Card;
use super::params::Habit;
use super::shade::Shade;
use super::skeleton::perpendicular;
use crate::math::unit_to_byte;
use crate::model::{Material, Mesh, Part, PartKind};

/// Where the columns of a frond, from left to right, are in each row of vertices: the rib is first, for the first vertex of an
/// element stays as long as the element, and of a frond's corners nothing is seen.
const FROND_COLUMNS: [u32; 3] = [1, 0, 2];

/// Appends the cards of leaves or of blossom to `mesh` as a part, if there are any.
pub(super) fn build(habit: Habit, cards: &[Card], blossom: bool, shade: &Shade, mesh: &mut Mesh) {
    let (rows, columns) = habit.grid();
    let mut triangles = Vec::new();
    for card in cards.iter().filter(|card| card.blossom == blossom) {
        let start = mesh.positions.len() as u32;
        if habit == Habit::Frond {
            arch(card, rows, shade, mesh);
        } else {
            flat(card, rows, shade, mesh);
        }
        let vertex = |row: u32, column: u32| {
            let place = if habit == Habit::Frond { FROND_COLUMNS[column as usize] } else { column };
            start + row * columns + place
        };
        for row in 0..rows - 1 {
            for column in 0..columns - 1 {
                let [a, b] = [column, column + 1].map(|column| vertex(row, column));
                let [c, d] = [column, column + 1].map(|column| vertex(row + 1, column));
                triangles.push([a, b, d]);
                triangles.push([a, d, c]);
            }
        }
    }
    if !triangles.is_empty() {
        let material = if blossom { Material::Blossom } else { Material::Leaf };
        let kind = PartKind::Aggregate { vertices: rows * columns, triangles: habit.triangles() };
        mesh.parts.push(Part { material, kind, triangles });
    }
}

fn push(mesh: &mut Mesh, position: Vec3, normal: Vec3, uv: [f32; 2], color: Vec3) {
    let [r, g, b] = color.to_array().map(unit_to_byte);
    mesh.positions.push(position.to_array());
    mesh.normals.push(normal.to_array());
    mesh.uvs.push(uv);
    mesh.colors.push([r, g, b, 255]);
}

/// A card of two columns, bent downwards from row to row.
fn flat(card: &Card, rows: u32, shade: &Shade, mesh: &mut Mesh) {
    let across = card.axis.cross(card.normal).normalize_or(perpendicular(card.axis));
    let half = across * (0.5 * card.width_m);
    let step_m = card.length_m / (rows - 1) as f32;
    let (mut at, mut axis) = (card.root, card.axis);
    for row in 0..rows {
        let v = 1.0 - row as f32 / (rows - 1) as f32;
        // Twigs are lighter towards their tips, where leaves are young and stand in the light.
        let color = card.tint * (shade.at(at) * (1.04 - 0.1 * v));
        for (column, sign) in [-1.0, 1.0].into_iter().enumerate() {
            let position = at + half * sign;
            let u = if card.mirrored { 1.0 - column as f32 } else { column as f32 };
            push(mesh, position, rounded(card, position), [u, v], color);
        }
        at += axis * step_m;
        axis = (axis - Vec3::Y * (card.droop_rad / (rows - 1) as f32)).normalize_or(axis);
    }
}

/// The normal of the mass of leaves around a place, with a little of the card's own.
fn rounded(card: &Card, position: Vec3) -> Vec3 {
    let crown = (position - card.crown).normalize_or(Vec3::Y);
    let mass = (position - card.mass).normalize_or(Vec3::Y);
    let sum = crown * 0.5 + mass * 0.45 + card.normal * 0.4 + Vec3::Y * 0.15;
    let normal = sum.normalize_or(card.normal);
    // Never turned away from the card's front: two-sided shading would flip it.
    let facing = normal.dot(card.normal);
    if facing < 0.1 { (normal + card.normal * (0.1 - facing)).normalize_or(card.normal) } else { normal }
}

/// A frond: three columns, folded along its rib, arching over.
fn arch(card: &Card, rows: u32, shade: &Shade, mesh: &mut Mesh) {
    let steps = (rows - 1) as f32;
    let across = card.axis.cross(card.normal).normalize_or(perpendicular(card.axis));
    let (mut at, mut axis) = (card.root, card.axis);
    for row in 0..rows {
        let t = row as f32 / steps;
        let up = across.cross(axis).normalize_or(Vec3::Y);
        let light = shade.at(at) * (0.86 + 0.14 * t);
        for sign in [0.0, -1.0, 1.0_f32] {
            // Leaflets hang from the rib, more so towards the tip.
            let fold = up * (-(0.32 + 0.25 * t) * sign.abs());
            let position = at + (across * sign * 0.9 + fold) * (0.5 * card.width_m);
            let normal = (up + across * (0.45 * sign) + Vec3::Y * 0.25).normalize_or(up);
            let u = 0.5 + 0.5 * if card.mirrored { -sign } else { sign };
            push(mesh, position, normal, [u, 1.0 - t], card.tint * light);
        }
        at += axis * (card.length_m / steps);
        let pull = card.droop_rad / steps * (0.4 + 1.2 * t);
        axis = (axis - Vec3::Y * (pull * (1.0 - 0.5 * (-axis.y).max(0.0)))).normalize_or(axis);
    }
}
