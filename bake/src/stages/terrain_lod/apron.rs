//! Landform → the ring of coarse land around the field, joined to it without a crack, and the water, in metres.

use glam::Vec3;

use genescape_schema::scene::bintree::Sample;

use super::curved::{Curved, Fine, PARTS};
use crate::math::{cell, lerp_array, triangles_between};
use crate::model::{FarGround, Heightfield, Landform, Material, Mesh, Part, PartKind};

/// Metres of water that one unit of its texture coordinates covers.
const WATER_TILE_M: f32 = 16.0;

/// The samples on the field's border that coincide with the apron's: vertices there let the apron's colour and
/// shape continue at its own resolution.
pub(super) fn border_samples(land: &Landform) -> Vec<Sample> {
    let field = &land.field;
    let last = field.side - 1;
    let Some(hole) = Hole::of(land) else { return Vec::new() };
    let mut samples = Vec::new();
    for column in hole.first + 1..hole.last {
        let along = (land.apron.place_m(column) / field.spacing_m + 0.5 * last as f32 + 0.5).floor();
        if along > 0.0 && along < last as f32 {
            let along = along as u32;
            samples.extend([[along, 0], [along, last], [0, along], [last, along]]);
        }
    }
    samples
}

/// The apron outside the field. Between the field's border and the apron's first line of samples outside it lies
/// a strip whose inner vertices are just those of the near mesh. With each vertex's weights of the kinds of ground. Empty if the
/// apron is no wider than the field.
pub(super) fn ring(
    land: &Landform,
    used: impl Fn(Sample) -> bool,
    ground: &[FarGround],
) -> (Mesh, Vec<[u8; 4]>) {
    let Some(hole) = Hole::of(land) else { return Default::default() };
    let fine_side = (land.apron.side - 1) * PARTS + 1;
    let numbers = vec![u32::MAX; land.field.heights_m.len() + (fine_side * fine_side) as usize];
    let (mesh, weights, triangles) = Default::default();
    let curved = Curved::of(land);
    let mut ring = Ring { land, curved, ground, fine_side, mesh, weights, numbers, triangles };
    let mut inner = [const { Vec::new() }; 4];
    let last = land.field.side - 1;
    for along in 0..=last {
        // Sides in the order north, east, south, west; each from its lower to its higher coordinate.
        for (side, sample) in [[along, 0], [last, along], [along, last], [0, along]].into_iter().enumerate() {
            if used(sample) {
                inner[side].push(ring.vertex(Place::Inner(sample)));
            }
        }
    }
    for (side, inner) in inner.iter().enumerate() {
        let axis = side % 2;
        let (first, last) = (hole.first, hole.last);
        let from = [[first, first], [last, first], [first, last], [first, first]][side];
        let outer = ring.line(from, axis, hole.last - hole.first);
        ring.zip(inner, &outer, 2 * axis);
    }
    ring.cells(&hole);
    let parts = vec![Part { material: Material::Ground, kind: PartKind::Surface, triangles: ring.triangles }];
    (Mesh { parts, ..ring.mesh }, ring.weights)
}

/// Two triangles as wide as the apron at the water's level; empty if the land is dry.
pub(super) fn water(land: &Landform) -> Mesh {
    let Some(level) = land.water_level_m else { return Mesh::default() };
    let half = 0.5 * land.apron.extent_m().max(land.field.extent_m());
    let corners = [[-half, -half], [-half, half], [half, half], [half, -half]];
    let triangles = vec![[0, 1, 2], [0, 2, 3]];
    Mesh {
        positions: corners.map(|[x, z]| [x, level, z]).to_vec(),
        normals: vec![[0.0, 1.0, 0.0]; 4],
        uvs: corners.map(|[x, z]| [x / WATER_TILE_M, z / WATER_TILE_M]).to_vec(),
        parts: vec![Part { material: Material::Water, kind: PartKind::Surface, triangles }],
        ..Mesh::default()
    }
}

/// Lines of the apron's samples (the same for rows and columns) next to the field on its outside.
struct Hole {
    first: u32,
    last: u32,
}

impl Hole {
    fn of(land: &Landform) -> Option<Self> {
        let half = 0.5 * land.field.extent_m();
        let side = land.apron.side;
        // A line that differs from the border only by rounding counts as on it.
        let outside = half + 1.0e-3 * land.apron.spacing_m;
        let first = (0..side).rev().find(|&line| land.apron.place_m(line) < -outside)?;
        let last = (0..side).find(|&line| land.apron.place_m(line) > outside)?;
        Some(Self { first, last })
    }
}

/// What a vertex of the ring lies on.
#[derive(Clone, Copy)]
enum Place {
    /// A sample of the field, on its border, where the near mesh has a vertex.
    Inner(Sample),
    /// A sample of the apron, or between its samples.
    Outer(Fine),
}

/// The ring while it grows.
struct Ring<'a> {
    land: &'a Landform,
    curved: Curved<'a>,
    ground: &'a [FarGround],
    /// Places a side of the apron.
    fine_side: u32,
    mesh: Mesh,
    weights: Vec<[u8; 4]>,
    /// Of the vertices that are made, by the samples of the field and then the places of the apron.
    numbers: Vec<u32>,
    triangles: Vec<[u32; 3]>,
}

impl Ring<'_> {
    /// The number of a vertex, which is made when it is first needed.
    fn vertex(&mut self, place: Place) -> u32 {
        let (number, extent_m) = (self.mesh.positions.len() as u32, self.land.field.extent_m());
        let field = &self.land.field;
        let slot = match place {
            Place::Inner([i, j]) => (j * field.side + i) as usize,
            Place::Outer([i, j]) => field.heights_m.len() + (j * self.fine_side + i) as usize,
        };
        if self.numbers[slot] != u32::MAX {
            return self.numbers[slot];
        }
        self.numbers[slot] = number;
        let (position, normal) = match place {
            Place::Inner(sample) => vertex(field, sample),
            Place::Outer(fine) => self.curved.vertex(fine),
        };
        let FarGround { color, weights } = self.ground_between(position[0], position[2]);
        self.mesh.positions.push(position);
        self.mesh.normals.push(normal);
        self.mesh.uvs.push([position[0] / extent_m + 0.5, position[2] / extent_m + 0.5]);
        self.mesh.colors.push(color);
        self.weights.push(weights);
        number
    }

    /// The ground at the apron's four samples around a point, blended.
    fn ground_between(&self, x_m: f32, z_m: f32) -> FarGround {
        let apron = &self.land.apron;
        let last = (apron.side - 1) as f32;
        let grid = |along: f32| (along / apron.spacing_m + 0.5 * last).clamp(0.0, last);
        let side = apron.side as usize;
        let ((i, u), (j, v)) = (cell(grid(x_m), side), cell(grid(z_m), side));
        let values = |at: usize| bytemuck::cast::<_, [u8; 8]>(self.ground(at)).map(f32::from);
        let along = |j: usize| lerp_array(values(j * side + i), values(j * side + i + 1), u);
        let [color, weights] = bytemuck::cast::<_, [[f32; 4]; 2]>(lerp_array(along(j), along(j + 1), v));
        // Weights are rounded down, so that four of them cannot pass 255.
        FarGround { color: color.map(|c| (c + 0.5) as u8), weights: weights.map(|part| part as u8) }
    }

    /// At a sample of the apron; white where nothing is known.
    fn ground(&self, index: usize) -> FarGround {
        const UNKNOWN: FarGround = FarGround { color: [255; 4], weights: [0; 4] };
        self.ground.get(index).copied().unwrap_or(UNKNOWN)
    }

    /// Fills the strip between two rows of vertices that both ascend along `axis` (0 = x, 2 = z).
    fn zip(&mut self, inner: &[u32], outer: &[u32], axis: usize) {
        let along = |vertex: u32| self.mesh.positions[vertex as usize][axis];
        for [outer, inner, third] in triangles_between(outer, inner, along) {
            self.face_up([inner, outer, third]);
        }
    }

    /// The vertices along some of the apron's edges, from a sample on along x (0) or z (1).
    fn line(&mut self, from: Sample, axis: usize, edges: u32) -> Vec<u32> {
        let mut line = vec![self.vertex(Place::Outer(from.map(|along| along * PARTS)))];
        for edge in 0..edges {
            let mut sample = from;
            sample[axis] += edge;
            let step = PARTS / self.curved.parts(sample, axis);
            for part in (step..=PARTS).step_by(step as usize) {
                let mut fine = sample.map(|along| along * PARTS);
                fine[axis] += part;
                line.push(self.vertex(Place::Outer(fine)));
            }
        }
        line
    }

    /// All whole cells outside the hole.
    fn cells(&mut self, hole: &Hole) {
        let within = hole.first..hole.last;
        for j in 0..self.land.apron.side - 1 {
            for i in 0..self.land.apron.side - 1 {
                if !(within.contains(&i) && within.contains(&j)) {
                    self.cell([i, j]);
                }
            }
        }
    }

    /// A cell: two triangles, cut along the diagonal that bends less, or as many as its most finely cut edge asks for.
    fn cell(&mut self, [i, j]: Sample) {
        let sides = [([i, j], 0), ([i + 1, j], 1), ([i, j + 1], 0), ([i, j], 1)];
        let parts = sides.iter().map(|&(from, axis)| self.curved.parts(from, axis)).max().unwrap_or(1);
        if parts == 1 {
            let [nw, ne, se, sw] = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]]
                .map(|sample| self.vertex(Place::Outer(sample.map(|along| along * PARTS))));
            let apron = &self.land.apron;
            let falls = (apron.at(i, j) - apron.at(i + 1, j + 1)).abs();
            let rises = (apron.at(i + 1, j) - apron.at(i, j + 1)).abs();
            self.triangles.extend(match falls <= rises {
                true => [[nw, sw, se], [nw, se, ne]],
                false => [[nw, sw, ne], [ne, sw, se]],
            });
            return;
        }
        let sides = sides.map(|(from, axis)| self.line(from, axis, 1));
        // A grid within, and strips between it and the edges, of which each may be cut otherwise.
        let step = PARTS / parts;
        let mut within =
            |u: u32, v: u32| self.vertex(Place::Outer([i * PARTS + u * step, j * PARTS + v * step]));
        let rows: Vec<Vec<u32>> = (1..parts).map(|v| (1..parts).map(|u| within(u, v)).collect()).collect();
        for (upper, lower) in rows.iter().zip(&rows[1..]) {
            self.zip(upper, lower, 0);
        }
        let column = |u: usize| rows.iter().map(|row| row[u]).collect::<Vec<u32>>();
        let last = rows.len() - 1;
        let inner = [rows[0].clone(), column(last), rows[last].clone(), column(0)];
        for (side, (outer, inner)) in sides.iter().zip(&inner).enumerate() {
            self.zip(inner, outer, 2 * (side % 2));
        }
    }

    fn face_up(&mut self, [a, b, c]: [u32; 3]) {
        let [pa, pb, pc] = [a, b, c].map(|vertex| Vec3::from_array(self.mesh.positions[vertex as usize]));
        let up = (pb - pa).cross(pc - pa).y > 0.0;
        self.triangles.push(if up { [a, b, c] } else { [a, c, b] });
    }
}

/// Position and normal of a sample; shared with the near mesh so that both agree to the bit.
pub(super) fn vertex(field: &Heightfield, [i, j]: Sample) -> ([f32; 3], [f32; 3]) {
    ([field.place_m(i), field.at(i, j), field.place_m(j)], field.normal_at(i, j).to_array())
}
