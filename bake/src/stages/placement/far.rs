//! Landform, its ring of coarse land and the density of the field's forest → the trees that go on beyond the field, in
//! metres.
//!
//! They grow where `site` says and are as dense as in the field; but each cell of a lattice has at most one, somewhere within
//! it: nobody walks there, so crowns may mingle. With distance they thin out, and end where there are [`MAX_FAR_TREES`] of them
//! or they are too small to count.
//!
//! They stand on the ring's triangles, from which the land between its samples differs by metres.

use glam::Vec3;

use crate::model::{Heightfield, Instance, Landform, Mesh, TreeFootprint};
use crate::noise::hash01;
use crate::raster::square;
use crate::seed::{Dice, noise_seed};

use super::site::{Site, Spot};
use super::stand::{self, Foot};
use super::{EDGE_MARGIN_M, PlacementParams};

/// The most trees beyond the field.
pub const MAX_FAR_TREES: usize = 12_000;
/// Metres from the field within which all of them stand.
const REACH_M: f32 = 1200.0;
/// From this part of their reach on they get fewer.
const THINNING: f32 = 0.25;
/// The ring is flatter than land of finer samples: its slope counts as so many times as much, and as so much more.
const STEEPER: f32 = 1.25;
const ROUGHNESS: f32 = 0.05;

/// Plants the land beyond the field with `trees`, `per_m2` of them where they grow best, in a fixed order. `ring` is that land
/// as triangles.
pub fn place_far(
    params: &PlacementParams,
    land: &Landform,
    ring: &Mesh,
    trees: &[TreeFootprint],
    per_m2: f32,
) -> Vec<Instance> {
    let half_m = 0.5 * land.field.extent_m();
    let reach_m = REACH_M.min(0.5 * land.apron.extent_m() - half_m);
    if trees.is_empty() || per_m2 <= 0.0 || reach_m <= 0.0 {
        return Vec::new();
    }
    let forest = Forest {
        site: Site::new(params, land, None),
        facets: Facets::new(ring, &land.apron, half_m + reach_m),
        seed: noise_seed(params.tree_seed.into(), "placement/far", 0),
        half_m,
        reach_m,
        cell_m: per_m2.sqrt().recip(),
    };
    let across = (2.0 * (half_m + reach_m) / forest.cell_m) as usize;
    let reaches_m = square(across, |i, j| forest.reach_m([i, j]).unwrap_or(f32::MAX));
    let mut cells: Vec<usize> = (0..reaches_m.len()).filter(|&cell| reaches_m[cell] < f32::MAX).collect();
    cells.sort_by(|&a, &b| reaches_m[a].total_cmp(&reaches_m[b]));
    cells.truncate(MAX_FAR_TREES);
    let stand = |&cell: &usize| {
        let mut dice = Dice::new(params.tree_seed, "placement/far", cell as u64);
        let (place_m, facet, spot) = forest.spot([cell % across, cell / across])?;
        let template = ((dice.unit() * trees.len() as f32) as usize).min(trees.len() - 1);
        let scale = stand::scale(params.height_variation, spot.vigour, &mut dice);
        let shore_m = forest.site.shore_m;
        let foot = |radius_m: f32| Foot {
            centre_m: facet.height_m,
            lowest_m: facet.height_m - radius_m * facet.slope,
            shore_m,
        };
        stand::stand(&trees[template], template as u32, place_m, scale, &mut dice, foot)
    };
    cells.iter().filter_map(stand).collect()
}

/// Where trees may stand: a lattice over the land, around and below the field too.
struct Forest<'a> {
    site: Site<'a>,
    facets: Facets,
    seed: u32,
    /// Half the field's side.
    half_m: f32,
    reach_m: f32,
    cell_m: f32,
}

impl Forest<'_> {
    /// The place in a cell where one tree may stand.
    fn place_m(&self, cell: [usize; 2]) -> [f32; 2] {
        let [i, j] = cell.map(|along| along as i32);
        let along = |cell: i32, axis: i32| {
            (cell as f32 + hash01(self.seed, i, j, axis)) * self.cell_m - self.half_m - self.reach_m
        };
        [along(i, 0), along(j, 1)]
    }

    /// Metres from the field to where trees have to end at the earliest for one to stand in a cell, if any grows there.
    fn reach_m(&self, cell: [usize; 2]) -> Option<f32> {
        let away_m = self.place_m(cell).map(|along_m| (along_m.abs() - self.half_m).max(0.0));
        let away_m = libm::hypotf(away_m[0], away_m[1]);
        if away_m < EDGE_MARGIN_M {
            return None;
        }
        let chance = |number: i32| hash01(self.seed, cell[0] as i32, cell[1] as i32, number);
        let reach_m = away_m / (1.0 - (1.0 - THINNING) * chance(2));
        if reach_m > self.reach_m {
            return None;
        }
        let (_, _, spot) = self.spot(cell)?;
        (chance(3) < spot.weight).then_some(reach_m)
    }

    fn spot(&self, cell: [usize; 2]) -> Option<([f32; 2], Facet, Spot)> {
        let [x_m, z_m] = self.place_m(cell);
        let facet = self.facets.at(x_m, z_m)?;
        let spot = self.site.beyond([x_m, facet.height_m, z_m], STEEPER * facet.slope + ROUGHNESS)?;
        Some(([x_m, z_m], facet, spot))
    }
}

/// The ring's triangles, by cells.
struct Facets {
    half_m: f32,
    cell_m: f32,
    across: usize,
    cells: Vec<Vec<[Vec3; 3]>>,
}

/// A point on one.
struct Facet {
    height_m: f32,
    /// Tangent.
    slope: f32,
}

impl Facets {
    /// Those of them that are within `half_m` from the middle, along x and z, in cells of half the size of `apron`'s.
    fn new(ring: &Mesh, apron: &Heightfield, half_m: f32) -> Self {
        let cell_m = 0.5 * apron.spacing_m;
        let across = (2.0 * half_m / cell_m).ceil() as usize;
        let mut facets = Self { half_m, cell_m, across, cells: vec![Vec::new(); across * across] };
        for triangle in ring.parts.iter().flat_map(|part| &part.triangles) {
            let corners = triangle.map(|vertex| Vec3::from_array(ring.positions[vertex as usize]));
            let (low, high) = (
                corners.iter().fold(Vec3::MAX, |low, &c| low.min(c)),
                corners.iter().fold(Vec3::MIN, |high, &c| high.max(c)),
            );
            let (columns, rows) =
                (facets.line(low.x)..=facets.line(high.x), facets.line(low.z)..=facets.line(high.z));
            let inside = high.x > -half_m && low.x < half_m && high.z > -half_m && low.z < half_m;
            for row in rows.filter(|_| inside) {
                columns.clone().for_each(|column| facets.cells[row * across + column].push(corners));
            }
        }
        facets
    }

    fn line(&self, along_m: f32) -> usize {
        (((along_m + self.half_m) / self.cell_m).max(0.0) as usize).min(self.across - 1)
    }

    /// `None` beside all of them.
    fn at(&self, x_m: f32, z_m: f32) -> Option<Facet> {
        let here = &self.cells[self.line(z_m) * self.across + self.line(x_m)];
        here.iter().find_map(|[a, b, c]| {
            let normal = (b - a).cross(c - a);
            let beside = |p: &Vec3, q: &Vec3| (q.z - p.z) * (x_m - p.x) - (q.x - p.x) * (z_m - p.z);
            // Facets face upwards: all three have the sign of the area as it is seen from above.
            let is_inside = [(a, b), (b, c), (c, a)].iter().all(|(p, q)| beside(p, q) >= 0.0);
            let rise = (normal.x * (x_m - a.x) + normal.z * (z_m - a.z)) / normal.y;
            (is_inside && normal.y > 0.0)
                .then(|| Facet { height_m: a.y - rise, slope: libm::hypotf(normal.x, normal.z) / normal.y })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::placement::place;
    use crate::stages::placement::tests::{OAK, usual};
    use crate::stages::terrain_lod::mesh;

    /// Hills around a field of 1024 m, with their ring as triangles.
    fn hills(height_m: f32, water_level_m: Option<f32>) -> (Landform, Mesh) {
        let heights = |side: u32, spacing_m: f32| {
            let along = |line: usize| (line as f32 - 0.5 * (side - 1) as f32) * spacing_m;
            let hill = |i: usize, j: usize| {
                height_m * libm::sinf(along(i) / 170.0) * libm::cosf(along(j) / 230.0 + 0.4)
            };
            Heightfield { side, spacing_m, heights_m: square(side as usize, hill) }
        };
        let land = Landform { water_level_m, ..Landform::bare(heights(129, 8.0), heights(65, 64.0)) };
        let ring = mesh(&land, 0.2, 64.0, &[]).apron;
        (land, ring)
    }

    fn far(land: &Landform, ring: &Mesh, params: &PlacementParams) -> (Vec<Instance>, Vec<Instance>) {
        let field = place(params, land, None, &[OAK]);
        (place_far(params, land, ring, &[OAK], field.per_m2), field.instances)
    }

    fn foot_m(tree: &Instance) -> [f64; 3] {
        tree.world_from_tree.map(|row| f64::from(row[3]))
    }

    /// Height of the ring above or below a place, over all its triangles.
    fn height_m(ring: &Mesh, [x, _, z]: [f64; 3]) -> Option<f64> {
        ring.parts.iter().flat_map(|part| &part.triangles).find_map(|triangle| {
            let [a, b, c] = triangle.map(|v| ring.positions[v as usize].map(f64::from));
            let cross = |p: [f64; 3], q: [f64; 3]| (q[0] - p[0]) * (z - p[2]) - (q[2] - p[2]) * (x - p[0]);
            let weights = [cross(b, c), cross(c, a), cross(a, b)];
            let sum: f64 = weights.iter().sum();
            let inside = sum != 0.0 && weights.iter().all(|weight| weight / sum >= -1e-9);
            inside.then(|| (weights[0] * a[1] + weights[1] * b[1] + weights[2] * c[1]) / sum)
        })
    }

    #[test]
    fn they_stand_on_the_rings_triangles_beyond_the_field_and_above_the_water() {
        let (land, ring) = hills(25.0, Some(-8.0));
        let (trees, _) = far(&land, &ring, &PlacementParams { density_per_ha: 15.0, ..usual() });
        assert!(trees.len() > 1000, "{} trees", trees.len());
        let mut in_strip = 0;
        for tree in &trees {
            let foot @ [x, y, z] = foot_m(tree);
            let away_m = x.abs().max(z.abs()) - 512.0;
            assert!(away_m >= f64::from(EDGE_MARGIN_M) * 0.7, "{foot:?} is on the field");
            in_strip += usize::from(away_m < 64.0);
            let above_m = y - height_m(&ring, foot).expect("on the ring");
            assert!((-1.0..0.0).contains(&above_m), "{foot:?} is {above_m} m above the ground");
            assert!(y > -8.0, "{foot:?} stands in the water");
        }
        assert!(in_strip > 50, "{in_strip} where the ring meets the field");
    }

    #[test]
    fn the_forest_goes_on_as_dense_as_before_and_thins_out() {
        let (land, ring) = hills(0.0, None);
        let params =
            PlacementParams { density_per_ha: 12.0, clustering: 0.0, altitude_limit: 1.0, ..usual() };
        let (beyond, within) = far(&land, &ring, &params);
        let density = |from_m: f64, to_m: f64| {
            let trees = within.iter().chain(&beyond).map(foot_m);
            let count = trees.filter(|[x, _, z]| (from_m..to_m).contains(&x.abs().max(z.abs()))).count();
            count as f64 / (to_m * to_m - from_m * from_m)
        };
        let (inside, outside, far) = (density(200.0, 500.0), density(520.0, 720.0), density(1300.0, 1600.0));
        assert!((outside / inside - 1.0).abs() < 0.12, "{outside} after {inside}");
        assert!(far < 0.6 * outside && far > 0.0, "{far} after {outside}");
    }

    #[test]
    fn there_are_never_more_than_so_many_and_always_the_same_ones() {
        let (land, ring) = hills(10.0, None);
        let params = PlacementParams { density_per_ha: 300.0, clustering: 0.0, ..usual() };
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| far(&land, &ring, &params).0)
        };
        let trees = on(1);
        assert!((MAX_FAR_TREES / 2..=MAX_FAR_TREES).contains(&trees.len()), "{}", trees.len());
        assert_eq!(trees, on(3));
        // Those that are left are near, all around.
        let reach_m = trees.iter().map(|tree| foot_m(tree)[0].abs()).fold(0.0, f64::max);
        assert!(reach_m < 1600.0, "{reach_m}");
    }

    #[test]
    fn without_trees_on_the_field_or_land_beyond_it_there_are_none() {
        let (land, ring) = hills(10.0, None);
        assert!(place_far(&usual(), &land, &ring, &[OAK], 0.0).is_empty());
        assert!(place_far(&usual(), &land, &ring, &[], 0.01).is_empty());
        let narrow = Landform::bare(land.field.clone(), land.field);
        assert!(place_far(&usual(), &narrow, &Mesh::default(), &[OAK], 0.01).is_empty());
    }
}
