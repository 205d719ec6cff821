//! A mesh and a side → which samples of the picture it covers, cut out by the alpha of its cards.

use glam::Vec2;

use super::raster::Look;
use super::surfaces::{Surface, Surfaces};
use crate::model::Mesh;
use crate::silhouette::Silhouette;

/// Covers what is seen of those of a mesh's parts whose index is asked for.
pub(super) fn cover(
    mesh: &Mesh,
    is_drawn: impl Fn(usize) -> bool,
    surfaces: &Surfaces,
    look: &Look,
    silhouette: &mut Silhouette,
) {
    let places: Vec<Vec2> = mesh.positions.iter().map(|&p| look.project(p).truncate()).collect();
    for (_, part) in mesh.parts.iter().enumerate().filter(|(index, _)| is_drawn(*index)) {
        let surface = surfaces.of_part(part.material);
        for triangle in &part.triangles {
            let corners = triangle.map(|v| places[v as usize]);
            let uv = |v: u32| mesh.uvs.get(v as usize).copied().unwrap_or_default();
            let uvs = || triangle.map(|v| Vec2::from_array(uv(v)));
            match surface {
                Surface::Wood(_) => silhouette.fill(corners),
                Surface::Card(card) => {
                    silhouette.fill_cut_out(corners, uvs(), |uv| card.mask.opaque(uv));
                }
                Surface::Atlas(atlas) => {
                    silhouette.fill_cut_out(corners, uvs(), |uv| atlas.opaque(uv));
                }
            }
        }
    }
}
