//! A finished mesh and its heightfield → how far apart they are, in metres. Independent of how the mesh was made.

use crate::model::{Heightfield, Mesh};

/// The greatest vertical distance in metres between the mesh and any sample of the field, measured by drawing each
/// triangle over the grid. Infinite if some sample is not covered, a vertex is not a sample, or a triangle does
/// not face up.
pub fn max_error_m(field: &Heightfield, mesh: &Mesh) -> f32 {
    let side = field.side as i64;
    let mut covered = vec![false; field.heights_m.len()];
    let mut worst = 0.0_f64;
    for triangle in mesh.parts.iter().flat_map(|part| &part.triangles) {
        let corners = triangle.map(|vertex| grid_corner(field, mesh.positions[vertex as usize]));
        let [Some(a), Some(b), Some(c)] = corners else { return f32::INFINITY };
        // Doubled areas in plan: of the triangle, and of the parts opposite b and c for each sample.
        let area = (b.z - a.z) * (c.x - a.x) - (b.x - a.x) * (c.z - a.z);
        if area <= 0 {
            return f32::INFINITY;
        }
        let per_area = 1.0 / area as f64;
        for z in a.z.min(b.z).min(c.z)..=a.z.max(b.z).max(c.z) {
            for x in a.x.min(b.x).min(c.x)..=a.x.max(b.x).max(c.x) {
                let at_b = (z - a.z) * (c.x - a.x) - (x - a.x) * (c.z - a.z);
                let at_c = (b.z - a.z) * (x - a.x) - (b.x - a.x) * (z - a.z);
                if at_b < 0 || at_c < 0 || at_b + at_c > area {
                    continue;
                }
                let rise = at_b as f64 * (b.y - a.y) + at_c as f64 * (c.y - a.y);
                let index = (z * side + x) as usize;
                let error = (a.y + rise * per_area - f64::from(field.heights_m[index])).abs();
                covered[index] = true;
                worst = if error <= worst { worst } else { error };
            }
        }
    }
    if covered.iter().all(|&covered| covered) { worst as f32 } else { f32::INFINITY }
}

/// A vertex in grid coordinates with its height in metres.
struct Corner {
    x: i64,
    z: i64,
    y: f64,
}

/// `None` if it does not lie on a sample in plan.
fn grid_corner(field: &Heightfield, [x, y, z]: [f32; 3]) -> Option<Corner> {
    let last = i64::from(field.side - 1);
    let along = |metres: f32| {
        let exact = f64::from(metres) / f64::from(field.spacing_m) + 0.5 * last as f64;
        let whole = (exact + 0.5).floor();
        let sample = whole as i64;
        ((exact - whole).abs() < 1.0e-3 && (0..=last).contains(&sample)).then_some(sample)
    };
    Some(Corner { x: along(x)?, z: along(z)?, y: f64::from(y) })
}
