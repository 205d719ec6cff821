//! Near mesh and start view → a finer mesh of the ground around the eye, whose vertices carry the colour of the map
//! and whose parts carry tiling textures: within some 50 m the ground needs centimetres, the map has metres.
//!
//! The piece is a square of the blocks that no triangle of the near mesh crosses. Its border has the vertices of the
//! near mesh, bit by bit, so there is no crack; colour, relief and grain of its own fade towards the border, so
//! there is no seam.

use bytemuck::Zeroable;
use glam::{Vec2, Vec3};

use super::GroundParams;
use super::cover::KINDS;
use super::grass::grass;
use super::patch::{Patch, SIDE_M, corner, plan};
use super::standing::stand;
use super::textures::{TILE_M, TILE_MEAN, factor_on};
use super::window::MapWindow;
use super::woods::Woods;
use crate::math::triangles_between;
use crate::model::{
    Foreground, GroundPlants, Image8, Landform, Material, Mesh, Part, PartKind, StartView, Tiled,
};
use crate::noise::{fbm2, gradient2};
use crate::raster::square;
use crate::seed::noise_seed;

/// Cells a side of the fine grid.
const CELLS: usize = 128;
const CELL_M: f32 = SIDE_M / CELLS as f32;

/// What the ground around the start is made from: the genes, and what [`super::maps`] made of them.
#[derive(Clone, Copy)]
pub struct Ground<'a> {
    pub params: &'a GroundParams,
    pub woods: &'a Woods,
    pub land: &'a Landform,
    pub plants: &'a GroundPlants<Image8>,
}

/// Cuts the foreground out of a near mesh given as positions and triangles, made with blocks of `BLOCK_M`. Colours
/// come from the painter of [`super::maps`]. Nothing is cut where the land is smaller.
pub fn foreground(
    ground: &Ground<'_>,
    view: &StartView,
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
) -> Foreground {
    let Ground { params, woods, land, plants } = *ground;
    let field = &land.field;
    let Some(corner) = corner(field, view) else {
        return Foreground { rest: triangles.to_vec(), ..Foreground::default() };
    };
    let map_px = 2 * plants.maps.first().map_or(1, |map| map.width);
    let middle = |t: &[u32; 3]| t.iter().map(|&v| plan(positions[v as usize])).sum::<Vec2>() / 3.0 - corner;
    let inside = |t: &[u32; 3]| middle(t).min_element() > 0.0 && middle(t).max_element() < SIDE_M;
    let (cut, rest): (Vec<_>, Vec<_>) = triangles.iter().copied().partition(inside);
    let patch = Patch { land, corner, seed: noise_seed(params.terrain_seed.into(), "foreground", 0) };
    let window = MapWindow::new(params, woods, land, map_px, corner);
    let mut points = patch.points(&window);
    let border = patch.border(positions, &cut, &mut points);
    let shape = patch.triangles(&points, &border);
    let ground = by_kind(&points, &shape, field.extent_m());
    let mut grass = grass(&patch, &window, view);
    let stones = stand(plants, &patch, view, &mut grass);
    Foreground { ground, stones, rest, grass }
}

/// A vertex before it has a texture.
#[derive(Clone, Copy, Zeroable)]
struct Point {
    position: [f32; 3],
    normal: [f32; 3],
    /// Albedo, linear.
    color: [f32; 3],
    parts: [f32; KINDS],
}

impl Patch<'_> {
    fn normal(&self, p: Vec2) -> Vec3 {
        let (dx, dz) = (Vec2::new(CELL_M, 0.0), Vec2::new(0.0, CELL_M));
        let slope = |step: Vec2| (self.height_m(p + step) - self.height_m(p - step)) / (2.0 * CELL_M);
        Vec3::new(-slope(dx), 1.0, -slope(dz)).normalize()
    }

    /// Colour of the map, with growth that its texels are too large for.
    fn painted(&self, window: &MapWindow, p: Vec2) -> ([f32; 3], [f32; KINDS]) {
        let value = window.at(p);
        let (inward, mut parts) = (self.inward(p), value.parts);
        let tuft = fbm2(self.seed ^ 1, p.x / 1.9, p.y / 1.9, 2, 0.7, 0) * inward;
        let hue = gradient2(self.seed ^ 2, p.x / 3.7, p.y / 3.7, 0) * inward;
        // Snow is even; everything else is lush here and worn there.
        let strength = 1.0 - 0.85 * parts[3];
        let lush = [-0.16, 0.06, -0.30].map(|c| 1.0 + strength * parts[0] * c * hue * 1.6);
        let color = [0, 1, 2].map(|c| value.color[c] * (1.0 + 0.42 * strength * tuft) * lush[c]);
        // Borders between kinds wander.
        parts[0] += 0.35 * tuft;
        (color, parts)
    }

    /// The grid's points except those of its border, row by row.
    fn points(&self, window: &MapWindow) -> Vec<Point> {
        square(CELLS - 1, |i, j| {
            let p = self.corner + Vec2::new((i + 1) as f32, (j + 1) as f32) * CELL_M;
            let (color, parts) = self.painted(window, p);
            Point { position: [p.x, self.height_m(p), p.y], normal: self.normal(p).to_array(), color, parts }
        })
    }

    /// Adds the vertices of the near mesh on the border; gives their numbers by side: north, south, west, east, each
    /// towards east or south.
    fn border(&self, positions: &[[f32; 3]], cut: &[[u32; 3]], points: &mut Vec<Point>) -> [Vec<u32>; 4] {
        let mut used: Vec<u32> = cut.as_flattened().to_vec();
        used.sort_unstable();
        used.dedup();
        let far = self.corner + SIDE_M;
        let mut sides = [const { Vec::new() }; 4];
        for position in used.into_iter().map(|v| positions[v as usize]) {
            let p = plan(position);
            let on = [p.y == self.corner.y, p.y == far.y, p.x == self.corner.x, p.x == far.x];
            if on.iter().any(|&on| on) {
                let number = points.len() as u32;
                points.push(self.border_point(position, points));
                (0..4).filter(|&side| on[side]).for_each(|side| sides[side].push(number));
            }
        }
        for (side, numbers) in sides.iter_mut().enumerate() {
            let along = |n: u32| plan(points[n as usize].position)[side / 2];
            numbers.sort_by(|&a, &b| along(a).total_cmp(&along(b)));
        }
        sides
    }

    /// A vertex of the near mesh, with that mesh's normal and the colour of the nearest point of the grid, which is
    /// close to the map's there.
    fn border_point(&self, position: [f32; 3], points: &[Point]) -> Point {
        let field = &self.land.field;
        let p = plan(position);
        let sample = (p + 0.5 * field.extent_m()) / field.spacing_m;
        let near = ((p - self.corner) / CELL_M - 0.5).clamp(Vec2::ZERO, Vec2::splat((CELLS - 2) as f32));
        let near = points[near.y as usize * (CELLS - 1) + near.x as usize];
        let normal = field.normal_at((sample.x + 0.5) as u32, (sample.y + 0.5) as u32).to_array();
        Point { position, normal, ..near }
    }

    /// The grid's cells, and the strips between it and the border.
    fn triangles(&self, points: &[Point], border: &[Vec<u32>; 4]) -> Vec<[u32; 3]> {
        let n = CELLS as u32 - 1;
        let mut out = Vec::with_capacity(2 * CELLS * CELLS);
        for (j, i) in (0..n - 1).flat_map(|j| (0..n - 1).map(move |i| (j, i))) {
            let [a, b, c, d] = [j * n + i, j * n + i + 1, (j + 1) * n + i, (j + 1) * n + i + 1];
            out.extend(if (i + j) % 2 == 0 { [[a, c, d], [a, d, b]] } else { [[a, c, b], [b, c, d]] });
        }
        for (side, outer) in border.iter().enumerate() {
            let (start, step) = [(0, 1), (n * (n - 1), 1), (0, n), (n - 1, n)][side];
            let inner: Vec<u32> = (0..n).map(|k| start + k * step).collect();
            let at = |v: u32| plan(points[v as usize].position);
            for triangle in triangles_between(&inner, outer, |v| at(v)[side / 2]) {
                let ([inner, outer, third], [a, b, c]) = (triangle, triangle.map(at));
                let up = (b - a).perp_dot(c - a) < 0.0;
                out.push(if up { triangle } else { [outer, inner, third] });
            }
        }
        out
    }
}

/// Each triangle goes to the kind that covers most of it.
fn by_kind(points: &[Point], triangles: &[[u32; 3]], extent_m: f32) -> Tiled {
    let Tiled { mut mesh, mut map_uvs } = Tiled::default();
    let kinds: Vec<usize> = triangles
        .iter()
        .map(|t| {
            let part = |k: usize| t.iter().map(|&v| points[v as usize].parts[k]).sum::<f32>();
            (1..KINDS).fold(0, |best, k| if part(k) > part(best) { k } else { best })
        })
        .collect();
    for kind in 0..KINDS {
        let mut numbers = vec![u32::MAX; points.len()];
        let mut part = Vec::new();
        for (triangle, _) in triangles.iter().zip(&kinds).filter(|(_, k)| **k == kind) {
            part.push(triangle.map(|v| {
                let number = &mut numbers[v as usize];
                if *number == u32::MAX {
                    *number = mesh.positions.len() as u32;
                    push(&mut mesh, &points[v as usize], kind);
                    map_uvs.push((plan(points[v as usize].position) / extent_m + 0.5).to_array());
                }
                *number
            }));
        }
        let material = Material::Foreign(kind as u32);
        mesh.parts.push(Part { material, kind: PartKind::Surface, triangles: part });
    }
    Tiled { mesh, map_uvs }
}

fn push(mesh: &mut Mesh, point: &Point, kind: usize) {
    mesh.positions.push(point.position);
    mesh.normals.push(point.normal);
    mesh.uvs.push((plan(point.position) / TILE_M[kind]).to_array());
    mesh.colors.push(factor_on(TILE_MEAN[kind], point.color));
}
