//! Anyone's .glb or .gltf → [`Asset`]: a file of which nothing is known, and nothing is believed.

mod file;
mod levels;
mod materials;
mod mesh;
mod nodes;
mod notes;
mod numbers;
mod pictures;
mod places;
mod required;
mod vertices;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use genescape_schema::scene::{GSC_HEIGHTFIELD, GSC_SKY};
use glam::{Affine3A, DAffine3, Vec3};

use super::Result;
use crate::lod::tree::{COVERED_PX, rising};
use crate::options::MESH_ERROR_PX;
use crate::scene::{Asset, Facts, Shape, ShapeLevel};
use file::{AssetFile, MAX_ROWS};
use levels::{Change, LevelPlan};
use mesh::Known;
use nodes::ShapePlan;
use notes::Notes;
use pictures::Pictures;
use vertices::Treatment;

/// Of all copies together: to draw more takes any device seconds.
const MAX_TRIANGLES: u64 = 1 << 29;
/// What to do about a file that has too much of something.
pub(super) const TOO_LARGE: &str = "; leave some out, or `gltf-transform simplify IN.glb OUT.glb`";

/// Reads a file, whose bytes these are. Also which other files it is made of.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<(Asset, Vec<PathBuf>)> {
    let file = AssetFile::open(path, bytes)?;
    let mut notes = Notes::default();
    let mut pictures = Pictures::of(&file);
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut asset = Asset { name, ..Asset::default() };
    asset.surfaces = materials::read(&file, &mut pictures, &mut notes);
    let mut arrangement = nodes::arrange(&file, &mut notes)?;
    (asset.lights, asset.camera) = (std::mem::take(&mut arrangement.lights), arrangement.camera);
    let shapes = std::mem::take(&mut arrangement.shapes);
    let source = shapes.iter().find_map(|shape| shape.source);
    let (mut known, mut poses) = (Known::default(), BTreeMap::new());
    for plan in shapes {
        let pose = plan.skin.map(|skin| poses.entry(skin).or_insert_with(|| arrangement.pose(&file, skin)));
        let shape = build(&file, plan, pose.map(|pose| &pose[..]), &mut asset, &mut known, &mut notes)?;
        asset.shapes.extend(shape);
    }
    if file.rows_left.get() == 0 {
        return Err(
            file.wrong(format!("its meshes name more than {MAX_ROWS} vertices and indices{TOO_LARGE}"))
        );
    }
    asset.bounds_m = bounds(&asset).ok_or_else(|| {
        let left_out = std::mem::take(&mut notes).into_sentences();
        file.wrong(match &left_out[..] {
            [] => "nothing in it can be drawn: no node of its scene has a mesh that is there".to_owned(),
            left_out => format!("nothing in it can be drawn. {}", left_out.join(". ")),
        })
    })?;
    note_what_rests(&file, &mut notes);
    asset.facts = facts(&file, &asset, source, notes);
    if asset.facts.triangles > MAX_TRIANGLES {
        let count = asset.facts.triangles;
        return Err(
            file.wrong(format!("{count} triangles stand in its scene, {MAX_TRIANGLES} may{TOO_LARGE}"))
        );
    }
    Ok((asset, file.named_files()))
}

/// Whether a file says that it is a landscape of ours. Also false for what is no glTF.
pub(super) fn is_landscape(bytes: &[u8]) -> bool {
    file::used(bytes).is_some_and(|names| {
        [GSC_HEIGHTFIELD, GSC_SKY].iter().all(|name| names.contains(&(*name).to_owned()))
    })
}

/// Reads the meshes of a shape; none if nothing of it can be drawn.
fn build(
    file: &AssetFile,
    plan: ShapePlan,
    pose: Option<&[Affine3A]>,
    asset: &mut Asset,
    known: &mut Known,
    notes: &mut Notes,
) -> Result<Option<Shape>> {
    let mut levels: Vec<(ShapeLevel, Change)> = Vec::new();
    for LevelPlan { meshes, change, morph } in &plan.levels {
        let mut level = ShapeLevel::default();
        for (mesh, place) in meshes {
            let treatment = Treatment {
                shape_from_mesh: place.as_affine3a(),
                mirrored: plan.mirrored != (place.matrix3.determinant() < 0.0),
                morph: morph.as_deref(),
                pose,
            };
            level.parts.extend(mesh::append(
                file,
                &file.root.meshes[*mesh],
                &treatment,
                asset,
                known,
                notes,
            )?);
        }
        if !level.parts.is_empty() {
            levels.push((level, *change));
        }
    }
    if levels.is_empty() {
        return Ok(None);
    }
    let corners = || levels.iter().flat_map(|(level, _)| asset.corners(level));
    let (low, high) = (corners().fold(Vec3::MAX, Vec3::min), corners().fold(Vec3::MIN, Vec3::max));
    let center_m = 0.5 * (low + high);
    let radius_m = corners().map(|corner| corner.distance(center_m)).fold(0.0, f32::max);
    Ok(Some(Shape {
        name: plan.name,
        levels: with_errors(levels, radius_m),
        center_m,
        radius_m,
        morphs: plan.levels.iter().any(|level| level.morph.is_some()),
        copies: plan.copies,
    }))
}

/// Levels with their errors in metres, which rise.
fn with_errors(levels: Vec<(ShapeLevel, Change)>, radius_m: f32) -> Vec<ShapeLevel> {
    let error_m = |(_, change): &(ShapeLevel, Change)| match change {
        Change::Error(error_m) => *error_m,
        // That which the usual error allows where the shape covers that much of the picture: so all levels obey the
        // same controls.
        Change::Coverage(share) => MESH_ERROR_PX * 2.0 * radius_m / (share * COVERED_PX),
    };
    let errors_m: Vec<f32> =
        rising(levels.iter().map(|level| error_m(level).max(f32::MIN_POSITIVE))).collect();
    levels.into_iter().zip(errors_m).map(|((level, _), error_m)| ShapeLevel { error_m, ..level }).collect()
}

/// A box around all copies.
fn bounds(asset: &Asset) -> Option<[Vec3; 2]> {
    let reach = |direction: Vec3| asset.reach_m(direction, &DAffine3::IDENTITY) as f32;
    let high = Vec3::AXES.map(reach);
    let low = Vec3::AXES.map(|axis| -reach(-axis));
    let bounds = [low, high].map(Vec3::from_array);
    bounds.iter().all(|corner| corner.is_finite()).then_some(bounds)
}

fn note_what_rests(file: &AssetFile, notes: &mut Notes) {
    match file.root.animations.len() {
        0 => {}
        1 => notes.add("Its animation is not played"),
        count => notes.add(format!("Its {count} animations are not played")),
    }
    if file.root.nodes.iter().any(|node| node.skin.is_some() && node.mesh.is_some()) {
        notes.add("Meshes with a skeleton keep the pose that the file gives them");
    }
}

fn facts(file: &AssetFile, asset: &Asset, level_source: Option<&'static str>, notes: Notes) -> Facts {
    let triangles = |shape: &Shape| {
        let indices: u64 = shape.levels[0].parts.iter().map(|part| u64::from(part.range.count)).sum();
        indices / 3 * shape.copies.len() as u64
    };
    Facts {
        triangles: asset.shapes.iter().map(triangles).sum(),
        vertices: asset.vertices.len(),
        meshes: file.root.meshes.len(),
        copies: asset.shapes.iter().map(|shape| shape.copies.len()).sum(),
        materials: file.root.materials.len(),
        pictures: file.root.images.len(),
        levels: asset.shapes.iter().map(|shape| shape.levels.len()).max().unwrap_or(1),
        level_source,
        notes: notes.into_sentences(),
    }
}
