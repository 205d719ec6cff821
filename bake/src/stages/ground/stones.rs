//! Nothing → the shapes of stones and boulders. Metres.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

use super::shapes::{Drawing, heading};
use crate::math::lerp;
use crate::model::PlantShape;

/// Breaks a ball along some planes, and gives how far its surface is towards a direction, a unit vector.
fn broken(
    d: &mut Drawing,
    planes: usize,
    [least, most]: [f32; 2],
    ball: f32,
) -> impl Fn(Vec3) -> Vec3 + use<> {
    // Spread evenly over all directions (Fibonacci's lattice), and moved a little.
    let planes: Vec<(Vec3, f32)> = (0..planes)
        .map(|k| {
            let up = 1.0 - 2.0 * (k as f32 + 0.5) / planes as f32;
            let level = heading(2.4 * k as f32 + 0.9 * d.unit()) * (1.0 - up * up).sqrt();
            let normal = (level + Vec3::Y * (up + 0.4 * d.unit() - 0.2)).normalize();
            (normal, lerp(least, most, d.unit()))
        })
        .collect();
    move |way: Vec3| {
        let away = planes.iter().map(|(normal, away)| away / way.dot(*normal).max(0.05));
        way * away.fold(ball, f32::min) * Vec3::new(1.0, 0.64, 0.86)
    }
}

/// A stone of about a metre, a fifth of it in the ground.
pub(super) fn stone() -> PlantShape {
    let mut d = Drawing::new(70);
    let surface = broken(&mut d, 8, [0.40, 0.56], 0.58);
    let look = Look { middle: 0.16 * Vec3::Y, rough: 0.05, dark_below: 0.0 };
    worn(&mut d, [3, 6], &look, |way| 0.9 * surface(way));
    d.coarse();
    worn(&mut d, [7, 11], &look, surface);
    d.done()
}

/// The middle of a boulder, which stands in the ground.
const BOULDER_MIDDLE: Vec3 = Vec3::new(0.0, 0.12, 0.0);

/// A boulder, broken along a few planes and worn since: dark where it stands in the ground, pale on top.
pub(super) fn boulder() -> PlantShape {
    let mut d = Drawing::new(76);
    let surface = broken(&mut d, 11, [0.30, 0.46], 0.54);
    let look = Look { middle: BOULDER_MIDDLE, rough: 0.08, dark_below: 0.3 };
    // From afar a coarse one is enough, which the fine one hides.
    worn(&mut d, [5, 8], &look, |way| 0.91 * surface(way));
    d.coarse();
    worn(&mut d, [9, 14], &look, surface);
    d.done()
}

/// How a stone is worn.
struct Look {
    middle: Vec3,
    /// By how much its surface is rough, as a part of its size.
    rough: f32,
    /// Metres above the ground below which it is dark.
    dark_below: f32,
}

/// Draws a closed surface around the middle, known by the direction from there, rough and mottled; from pole to pole in so many
/// rings of so many corners.
fn worn(d: &mut Drawing, [rings, around]: [usize; 2], look: &Look, surface: impl Fn(Vec3) -> Vec3) {
    let mut point = |ring: usize, k: usize| {
        let polar = ring as f32 / rings as f32 * PI;
        let turn = (k as f32 + 0.5 * ring as f32) / around as f32 * TAU;
        let way = heading(turn) * libm::sinf(polar) + Vec3::Y * libm::cosf(polar);
        surface(way) * (1.0 + look.rough * (d.unit() - 0.5))
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
    for pole in [0, rings] {
        smooth[pole] = vec![smooth[pole].iter().sum(); around];
    }
    // Lichen and stains lie here and there; edges are worn, so that corners are shared.
    let vertices: Vec<Vec<u32>> = (0..=rings)
        .map(|ring| {
            let corner = |k: usize| {
                let (at, normal) = (look.middle + grid[ring][k], smooth[ring][k].normalize_or(Vec3::Y));
                let tint =
                    0.3 + 0.4 * normal.y - (look.dark_below - 2.0 * at.y).max(0.0) + 0.4 * (d.unit() - 0.3);
                d.vertex(at, normal, tint.clamp(0.0, 1.0))
            };
            (0..around).map(corner).collect()
        })
        .collect();
    for corners in &triangles {
        let vertices = corners.map(|(ring, k)| vertices[ring][k]);
        d.triangle(vertices, corners.map(place), outward(corners));
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
        let at = |v: u32| Vec3::from_array(shape.positions_m[v as usize]) - BOULDER_MIDDLE;
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
