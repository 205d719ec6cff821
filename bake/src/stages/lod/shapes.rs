//! Meshes to test with: sheets, spheres, tori, and a tree of tubes and cards.

use glam::{Vec2, Vec3};

use crate::model::{Material, Mesh, Part, PartKind};

/// A mesh of one surface part from a grid of `u` × `v` cells with positions, normals and texture seams as given.
fn grid(u: u32, v: u32, at: impl Fn(f32, f32) -> (Vec3, Vec3)) -> Mesh {
    let mut mesh = Mesh::default();
    add_grid(&mut mesh, u, v, at);
    let triangles = grid_triangles(0, u, v);
    mesh.parts.push(Part { material: Material::Foreign(0), kind: PartKind::Surface, triangles });
    mesh
}

fn add_grid(mesh: &mut Mesh, u: u32, v: u32, at: impl Fn(f32, f32) -> (Vec3, Vec3)) {
    for j in 0..=v {
        for i in 0..=u {
            let (s, t) = (i as f32 / u as f32, j as f32 / v as f32);
            let (position, normal) = at(s, t);
            mesh.positions.push(position.to_array());
            mesh.normals.push(normal.to_array());
            mesh.uvs.push([s, t]);
        }
    }
}

fn grid_triangles(first: u32, u: u32, v: u32) -> Vec<[u32; 3]> {
    let cell = |(i, j): (u32, u32)| {
        let a = first + j * (u + 1) + i;
        let [b, c, d] = [a + 1, a + u + 2, a + u + 1];
        [[a, b, c], [a, c, d]]
    };
    (0..v).flat_map(|j| (0..u).map(move |i| (i, j))).flat_map(cell).collect()
}

/// A flat square of 1 m with `n`² cells, facing up.
pub fn plane(n: u32) -> Mesh {
    grid(n, n, |s, t| (Vec3::new(s, 0.0, 1.0 - t), Vec3::Y))
}

/// A torus of radii 1 m and 0.4 m with seams both ways.
pub fn torus(u: u32, v: u32) -> Mesh {
    grid(u, v, |s, t| {
        let (around, about) = (turn(s), turn(t));
        let out = Vec3::new(around.x, 0.0, -around.y);
        let normal = out * about.x + Vec3::Y * about.y;
        (out + normal * 0.4, normal)
    })
}

/// The point on the unit circle after a part of a turn; bit-identical after a whole one.
fn turn(part: f32) -> Vec2 {
    let angle = (part % 1.0) * std::f32::consts::TAU;
    Vec2::new(libm::cosf(angle), libm::sinf(angle))
}

/// A closed tube: `sides` around with a texture seam, `rings` along, a point at each end.
pub fn add_tube(mesh: &mut Mesh, path: &[Vec3], radius: impl Fn(f32) -> f32, sides: u32) -> Vec<[u32; 3]> {
    let first = mesh.positions.len() as u32;
    let rings = path.len() as u32 - 1;
    let axis = (path[rings as usize] - path[0]).normalize();
    let side = axis.any_orthonormal_vector();
    let up = side.cross(axis);
    add_grid(mesh, sides, rings, |s, t| {
        let ring = (t * rings as f32).round() as usize;
        let around = turn(s);
        let normal = side * around.x + up * around.y;
        (path[ring] + normal * radius(t), normal)
    });
    let mut triangles = grid_triangles(first, sides, rings);
    for (end, ring, normal) in [(path[0], 0, -axis), (path[rings as usize], rings, axis)] {
        let tip = mesh.positions.len() as u32;
        mesh.positions.push((end + normal * radius(if ring == 0 { 0.0 } else { 1.0 })).to_array());
        mesh.normals.push(normal.to_array());
        mesh.uvs.push([0.5, if ring == 0 { -0.1 } else { 1.1 }]);
        for i in 0..sides {
            let a = first + ring * (sides + 1) + i;
            triangles.push(if ring == 0 { [tip, a + 1, a] } else { [tip, a, a + 1] });
        }
    }
    triangles
}

/// A sphere of 1 m: a tube without length would be open, so a bulging one.
pub fn sphere(sides: u32, rings: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let height = |k: u32| -libm::cosf(std::f32::consts::PI * (k + 1) as f32 / (rings + 2) as f32);
    let path: Vec<_> = (0..=rings).map(|k| Vec3::Y * height(k)).collect();
    let radius = |t: f32| {
        let y = height((t * rings as f32).round() as u32);
        (1.0 - y * y).max(0.0).sqrt()
    };
    let triangles = add_tube(&mut mesh, &path, radius, sides);
    for (position, normal) in mesh.positions.iter_mut().zip(&mut mesh.normals) {
        let on_sphere = Vec3::from_array(*position).normalize().to_array();
        (*position, *normal) = (on_sphere, on_sphere);
    }
    mesh.parts.push(Part { material: Material::Foreign(0), kind: PartKind::Surface, triangles });
    mesh
}

/// Numbers in [0, 1) for a counter.
pub fn dice(counter: &mut u32) -> f32 {
    *counter = counter.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((*counter >> ((*counter >> 28) + 4)) ^ *counter).wrapping_mul(277_803_737);
    ((word >> 22) ^ word) as f32 / 4_294_967_296.0
}

/// A tree: a trunk, branches and twigs as closed tubes, and so many leaf cards at the twigs.
pub fn tree(branches: u32, twigs: u32, cards: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let mut seed = 7;
    let trunk: Vec<_> = (0..=12).map(|k| Vec3::Y * (k as f32 * 0.6)).collect();
    let mut bark = add_tube(&mut mesh, &trunk, |t| 0.3 * (1.0 - 0.9 * t), 12);
    let mut tips = Vec::new();
    for b in 0..branches {
        let t = 0.3 + 0.7 * b as f32 / branches as f32;
        let start = Vec3::Y * (7.2 * t);
        let around = turn((b as f32 * 0.382) % 1.0);
        let out = Vec3::new(around.x, 0.4, around.y).normalize() * (3.5 * (1.15 - t));
        let bend = |k: u32, n: u32| {
            let s = k as f32 / n as f32;
            start + out * s + Vec3::Y * (0.3 * s * s)
        };
        let path: Vec<_> = (0..=8).map(|k| bend(k, 8)).collect();
        bark.extend(add_tube(&mut mesh, &path, |s| 0.09 * (1.0 - 0.85 * s), 6));
        for w in 0..twigs {
            let base = path[2 + (w as usize * 6) / twigs.max(1) as usize];
            let any = Vec3::new(dice(&mut seed), dice(&mut seed), dice(&mut seed)) - 0.5;
            let twig = (any.normalize_or(Vec3::Y) + out.normalize()) * 0.5;
            let path: Vec<_> = (0..=3).map(|k| base + twig * (k as f32 / 3.0)).collect();
            bark.extend(add_tube(&mut mesh, &path, |s| 0.014 * (1.0 - 0.7 * s), 4));
            tips.push((base, twig));
        }
    }
    mesh.parts.push(Part { material: Material::Bark, kind: PartKind::Surface, triangles: bark });
    let first = mesh.positions.len() as u32;
    for _ in 0..cards {
        let (base, twig) = tips[(dice(&mut seed) * tips.len() as f32) as usize];
        let root = base + twig * dice(&mut seed);
        let any = Vec3::new(dice(&mut seed), dice(&mut seed), dice(&mut seed)) - 0.5;
        let along = any.normalize_or(Vec3::Y) * 0.22;
        let across = along.any_orthonormal_vector() * 0.07;
        for (corner, uv) in [
            (-across, [0.0, 1.0]),
            (across, [1.0, 1.0]),
            (across + along, [1.0, 0.0]),
            (along - across, [0.0, 0.0]),
        ] {
            mesh.positions.push((root + corner).to_array());
            mesh.normals.push((root - Vec3::Y * 4.0).normalize_or(Vec3::Y).to_array());
            mesh.uvs.push(uv);
        }
    }
    let card = |k: u32| {
        let v = first + 4 * k;
        [[v, v + 1, v + 2], [v, v + 2, v + 3]]
    };
    let kind = PartKind::Aggregate { vertices: 4, triangles: 2 };
    mesh.parts.push(Part { material: Material::Leaf, kind, triangles: (0..cards).flat_map(card).collect() });
    mesh
}
