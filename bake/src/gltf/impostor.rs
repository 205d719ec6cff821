//! Pictures of a tree → a mesh of four cards, its material, and `GSC_impostor` on the mesh that they stand for.

use genescape_schema::scene::{GSC_IMPOSTOR, ImpostorExtension, Resource};
use glam::Vec3;
use serde_json::json;

use super::ExportError;
use super::document::{Document, push};
use super::materials::{MaterialSet, Picture};
use super::vertices::{Surface, add_vertices};
use crate::model::{Impostor, Material, Mesh, Part, PartKind};

/// Name of the cards' material, and of their image.
pub const IMPOSTOR: &str = "impostor";

/// What stands for a mesh from far away.
pub struct Cards<'a> {
    pub impostor: &'a Impostor,
    /// Its relief as a PNG file.
    pub relief: &'a [u8],
    /// The number of their material.
    pub material: usize,
}

impl Cards<'_> {
    /// Adds their mesh; gives its number.
    pub fn add_mesh(&self, document: &mut Document, name: &str) -> Result<usize, ExportError> {
        let name = format!("{name} impostor");
        let surface_of = |_| Surface { material: Some(self.material), normal_map: false };
        let primitives = add_vertices(document, &name, &cards(self.impostor), &surface_of)?;
        let primitives: Vec<_> = primitives.into_iter().map(|primitive| primitive.json).collect();
        Ok(push(&mut document.meshes, json!({ "name": name, "primitives": primitives })))
    }

    /// Adds the relief, and the extension to mesh 0, which the cards of mesh `cards` stand for.
    pub fn add_extension(&self, document: &mut Document, cards: usize) {
        let &Impostor { axis_m, low_m, size_m, error_m, .. } = self.impostor;
        let relief = Resource::view(document.view(self.relief, None, None), "image/png");
        let extension = ImpostorExtension { mesh: cards, relief, error_m, axis_m, low_m, size_m };
        document.meshes[0]["extensions"][GSC_IMPOSTOR] = json!(extension);
        document.extensions_used.insert(GSC_IMPOSTOR.into());
    }
}

/// Adds the material of cards whose pictures are an image; gives its number.
pub fn add_material<'a>(set: &mut MaterialSet<'a>, picture: Picture<'a>) -> usize {
    set.add_cards(IMPOSTOR, picture, Impostor::ALPHA_CUTOFF, 0.9)
}

/// A vertical rectangle for each picture; all cross in the axis.
fn cards(impostor: &Impostor) -> Mesh {
    let pictures = Impostor::AZIMUTHS.len();
    let [width_m, height_m] = impostor.size_m;
    let foot = Vec3::new(impostor.axis_m[0], impostor.low_m, impostor.axis_m[1]);
    let mut mesh = Mesh::default();
    let mut triangles = Vec::new();
    for k in 0..pictures {
        let [eye, right] = Impostor::eye_and_right(k);
        let first = mesh.positions.len() as u32;
        for [across, up] in [[0.0f32, 0.0f32], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
            let position = foot + right * ((across - 0.5) * width_m) + Vec3::Y * (up * height_m);
            // Round like a crown, for programs that shade the cards by their normals: they bend with the place on the card,
            // and more upwards than down, since the light comes from above.
            let normal = eye + right * (2.0 * across - 1.0) + Vec3::Y * (0.2 + up);
            mesh.positions.push(position.to_array());
            mesh.normals.push(normal.normalize().to_array());
            mesh.uvs.push([(k as f32 + across) / pictures as f32, 1.0 - up]);
        }
        triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    let kind = PartKind::Aggregate { vertices: 4, triangles: 2 };
    // Any material will do: each template's cards have their own.
    mesh.parts.push(Part { material: Material::Leaf, kind, triangles });
    mesh
}
