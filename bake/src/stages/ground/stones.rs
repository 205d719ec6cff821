//! Nothing → the shapes of stones and boulders. Metres.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

use super::shapes::{Drawing, across, corners, halves, heading};
use crate::model::PlantShape;

/// A stone of about a metre, a fifth of it in the ground: a sphere of few rings that was knocked about.
pub(super) fn stone() -> PlantShape {
    let mut d = Drawing::new(70);
    let (rings, around) = (3, 6);
    let point = |d: &mut Drawing, ring: u32, k: u32| {
        let polar = ring as f32 / rings as f32 * 0.5 * TAU;
        let turn = (k as f32 + 0.5 * ring as f32) / around as f32 * TAU;
        let bulge = 0.9 + 0.2 * d.unit();
        let round = heading(turn) * libm::sinf(polar) + Vec3::Y * libm::cosf(polar);
        // Squared off a little: stones break along planes.
        let corner = round.abs().max_element().max(0.62);
        round * (0.5 * bulge / corner) * Vec3::new(1.0, 0.62, 0.84) + Vec3::Y * 0.16
    };
    let top = point(&mut d, 0, 0);
    let bottom = point(&mut d, rings, 0);
    let grid: Vec<Vec<Vec3>> =
        (1..rings).map(|ring| (0..around).map(|k| point(&mut d, ring, k)).collect()).collect();
    let mut facet = |corners: [Vec3; 3]| {
        let (normal, from_middle) = (across(corners), corners.iter().sum::<Vec3>() - Vec3::Y * 0.48);
        let outward = if normal.dot(from_middle) < 0.0 { -normal } else { normal };
        let tint = d.unit();
        // Smoothed a little towards a sphere's.
        let triangle = corners.map(|p| {
            let round = (p - Vec3::Y * 0.16).normalize_or(Vec3::Y);
            d.vertex(p, outward + 1.1 * round, tint)
        });
        d.triangle(triangle, corners, outward);
    };
    let n = around as usize;
    for k in 0..n {
        facet([top, grid[0][(k + 1) % n], grid[0][k]]);
        facet([bottom, grid[grid.len() - 1][k], grid[grid.len() - 1][(k + 1) % n]]);
        for pair in grid.windows(2) {
            halves(corners(pair, k)).into_iter().for_each(&mut facet);
        }
    }
    d.done()
}

/// The middle of a boulder, which stands in the ground.
const MIDDLE: Vec3 = Vec3::new(0.0, 0.12, 0.0);

/// A boulder, broken along a few planes and worn since: dark where it stands in the ground, pale on top.
pub(super) fn boulder() -> PlantShape {
    let mut d = Drawing::new(76);
    // Spread evenly over all directions (Fibonacci's lattice), and moved a little.
    let planes: Vec<(Vec3, f32)> = (0..11)
        .map(|k| {
            let up = 1.0 - 2.0 * (k as f32 + 0.5) / 11.0;
            let level = heading(2.4 * k as f32 + 0.9 * d.unit()) * (1.0 - up * up).sqrt();
            ((level + Vec3::Y * (up + 0.4 * d.unit() - 0.2)).normalize(), 0.30 + 0.16 * d.unit())
        })
        .collect();
    let surface = |way: Vec3| {
        let away = planes.iter().map(|(normal, away)| away / way.dot(*normal).max(0.05));
        way * away.fold(0.54, f32::min) * Vec3::new(1.0, 0.64, 0.86)
    };
    // From afar a coarse one is enough, which the fine one hides.
    worn(&mut d, 5, 8, |way| 0.88 * surface(way));
    d.coarse();
    worn(&mut d, 9, 13, surface);
    d.done()
}

/// Draws a closed surface around the middle, known by the direction from there, rough and mottled; from pole to pole in so many
/// rings.
fn worn(d: &mut Drawing, rings: usize, around: usize, surface: impl Fn(Vec3) -> Vec3) {
    let mut point = |ring: usize, k: usize| {
        let polar = ring as f32 / rings as f32 * PI;
        let turn = (k as f32 + 0.5 * ring as f32) / around as f32 * TAU;
        let way = heading(turn) * libm::sinf(polar) + Vec3::Y * libm::cosf(polar);
        surface(way) * (0.96 + 0.08 * d.unit())
    };
    let mut grid: Vec<Vec<Vec3>> =
        (0..=rings).map(|ring| (0..around).map(|k| point(ring, k)).collect()).collect();
    // At the poles rings are points.
    [0, rings].into_iter().for_each(|pole| grid[pole] = vec![grid[pole][0]; around]);
    let quads = || (0..rings).flat_map(|ring| (0..around).map(move |k| (ring, k)));
    let triangles: Vec<[(usize, usize); 3]> = quads()
        .flat_map(|(ring, k)| {
            let next = (k + 1) % around;
            let [a, b, c, e] = [(ring, k), (ring, next), (ring + 1, k), (ring + 1, next)];
            [(ring > 0).then_some([a, b, c]), (ring + 1 < rings).then_some([b, e, c])]
        })
        .flatten()
        .collect();
    let place = |(ring, k): (usize, usize)| grid[ring][k];
    let outward = |corners: &[(usize, usize); 3]| {
        let [a, b, c] = corners.map(place);
        let front = (b - a).cross(c - a);
        if front.dot(a + b + c) < 0.0 { -front } else { front }
    };
    let mut smooth = vec![vec![Vec3::ZERO; around]; rings + 1];
    for corners in &triangles {
        corners.iter().for_each(|&(ring, k)| smooth[ring][k] += outward(corners));
    }
    for corners in &triangles {
        let face = outward(corners).normalize_or(Vec3::Y);
        // Lichen and stains are on some faces.
        let stain = 0.3 + 0.5 * (d.unit() - 0.3);
        let triangle = corners.map(|(ring, k)| {
            let (at, smooth) = (MIDDLE + grid[ring][k], smooth[ring][k].normalize_or(face));
            let tint = stain + 0.4 * smooth.y - (0.3 - 2.0 * at.y).max(0.0) + 0.2 * d.unit();
            // Edges are worn, not gone.
            d.vertex(at, face + 0.9 * smooth, tint.clamp(0.0, 1.0))
        });
        d.triangle(triangle, corners.map(place), face);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How far along a ray from the middle a triangle is hit.
    fn hit(way: Vec3, [a, b, c]: [Vec3; 3]) -> Option<f32> {
        let (ab, ac) = (b - a, c - a);
        let across = way.cross(ac);
        let size = ab.dot(across);
        let u = -a.dot(across) / size;
        let q = (-a).cross(ab);
        let v = way.dot(q) / size;
        let along = ac.dot(q) / size;
        (size.abs() > 1e-9 && u >= -1e-4 && v >= -1e-4 && u + v <= 1.0 + 1e-4 && along > 0.0).then_some(along)
    }

    #[test]
    fn a_boulder_is_closed_and_hides_its_coarse_self() {
        let shape = boulder();
        let at = |v: u32| Vec3::from_array(shape.positions_m[v as usize]) - MIDDLE;
        let (coarse, fine) = shape.triangles.split_at(shape.coarse as usize);
        assert!(coarse.len() < 80 && fine.len() > 2 * coarse.len());
        let away = |triangles: &[[u32; 3]], way: Vec3| {
            triangles.iter().filter_map(|corners| hit(way, corners.map(at))).reduce(f32::max)
        };
        for k in 0..500u16 {
            let up = 1.0 - 2.0 * (f32::from(k) + 0.5) / 500.0;
            let way = heading(2.399_963 * f32::from(k)) * (1.0 - up * up).sqrt() + Vec3::Y * up;
            let (inner, outer) = (away(coarse, way).expect("closed"), away(fine, way).expect("closed"));
            assert!(inner < outer && inner > 0.7 * outer, "{inner} in {outer} towards {way}");
        }
    }
}
