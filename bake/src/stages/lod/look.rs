//! Pictures of levels to judge by eye: `cargo test -p genescape-bake look -- --ignored`, into `GENESCAPE_LOOK`.

use glam::{Vec2, Vec3};

use super::shapes::{torus, tree};
use super::{LodOptions, levels};
use crate::model::{Level, Material, Mesh};

const WIDTH: usize = 260;
const HEIGHT: usize = 320;

struct Picture {
    columns: usize,
    rgb: Vec<u8>,
    depth: Vec<f32>,
}

impl Picture {
    fn new(columns: usize) -> Self {
        let pixels = columns * WIDTH * HEIGHT;
        Self { columns, rgb: [205, 220, 240].repeat(pixels), depth: vec![f32::MIN; pixels] }
    }

    /// Draws a mesh into a column; `low` and `size_m` frame it, `shrink` makes it look far away.
    fn draw(&mut self, column: usize, mesh: &Mesh, low: Vec3, size_m: f32, shrink: f32) {
        let scale = shrink * HEIGHT as f32 / size_m;
        let across = Vec3::new(0.866, 0.0, 0.5);
        for part in &mesh.parts {
            let base = match part.material {
                Material::Bark => Vec3::new(120.0, 90.0, 65.0),
                Material::Leaf => Vec3::new(80.0, 140.0, 50.0),
                _ => Vec3::new(180.0, 170.0, 160.0),
            };
            for triangle in &part.triangles {
                let p = triangle.map(|v| Vec3::from_array(mesh.positions[v as usize]));
                let uv =
                    triangle.map(|v| mesh.uvs.get(v as usize).map_or(Vec2::ZERO, |uv| Vec2::from_array(*uv)));
                let flat = p.map(|p| {
                    Vec2::new(
                        WIDTH as f32 * 0.5 + p.dot(across) * scale,
                        HEIGHT as f32 - (p.y - low.y) * scale,
                    )
                });
                let normal = (p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero();
                let light = 0.35 + 0.65 * normal.dot(Vec3::new(0.5, 0.7, 0.5)).abs().min(1.0);
                let cut = part.material == Material::Leaf;
                self.fill(column, flat, p.map(|p| p.dot(Vec3::new(-0.5, 0.0, 0.866))), uv, cut, base * light);
            }
        }
    }

    fn fill(
        &mut self,
        column: usize,
        [a, b, c]: [Vec2; 3],
        z: [f32; 3],
        uv: [Vec2; 3],
        cut: bool,
        color: Vec3,
    ) {
        let area = (b - a).perp_dot(c - a);
        let (low, high) = (a.min(b).min(c).max(Vec2::ZERO), a.max(b).max(c));
        for y in low.y as usize..(high.y.max(-1.0) + 1.0).min(HEIGHT as f32) as usize {
            for x in low.x as usize..(high.x.max(-1.0) + 1.0).min(WIDTH as f32) as usize {
                let p = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                let weights = [(b - p).perp_dot(c - p) / area, (c - p).perp_dot(a - p) / area];
                let w = [weights[0], weights[1], 1.0 - weights[0] - weights[1]];
                if area == 0.0 || w.iter().any(|&w| w < 0.0) {
                    continue;
                }
                // A leaf's outline: an ellipse of about 0.7 of the card.
                let at = uv[0] * w[0] + uv[1] * w[1] + uv[2] * w[2] - 0.5;
                let pixel = y * WIDTH * self.columns + column * WIDTH + x;
                let depth = z[0] * w[0] + z[1] * w[1] + z[2] * w[2];
                if (cut && at.length() > 0.48) || depth <= self.depth[pixel] {
                    continue;
                }
                self.depth[pixel] = depth;
                self.rgb[3 * pixel..3 * pixel + 3].copy_from_slice(&color.to_array().map(|v| v as u8));
            }
        }
    }

    fn save(&self, name: &str) {
        let Ok(folder) = std::env::var("GENESCAPE_LOOK") else { return };
        let file = std::fs::File::create(format!("{folder}/{name}.png")).unwrap();
        let mut encoder = png::Encoder::new(file, (self.columns * WIDTH) as u32, HEIGHT as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.write_header().unwrap().write_image_data(&self.rgb).unwrap();
    }
}

fn morphed(level: &Level, weight: f32) -> Mesh {
    let mut mesh = level.mesh.clone();
    for (p, d) in mesh.positions.iter_mut().zip(level.morph.iter().flat_map(|morph| &morph.positions)) {
        (0..3).for_each(|k| p[k] += weight * d[k]);
    }
    mesh
}

fn show(name: &str, mesh: &Mesh) {
    let made = levels(mesh, &LodOptions::default());
    let bounds = mesh.bounds();
    let size = (bounds.max - bounds.min).max_element() * 1.02;
    let mut near = Picture::new(6);
    made.levels.iter().take(6).enumerate().for_each(|(k, l)| near.draw(k, &l.mesh, bounds.min, size, 1.0));
    near.save(name);
    let mut far = Picture::new(6);
    let shrink = |k: usize| 0.7 / (1.0 + k as f32);
    made.levels
        .iter()
        .take(6)
        .enumerate()
        .for_each(|(k, l)| far.draw(k, &l.mesh, bounds.min, size, shrink(k)));
    far.save(&format!("{name}-far"));
    let mut morph = Picture::new(6);
    for k in 0..6 {
        morph.draw(k, &morphed(&made.levels[1], k as f32 / 5.0), bounds.min, size, 1.0);
    }
    morph.save(&format!("{name}-morph"));
}

#[test]
#[ignore = "writes pictures"]
fn look_at_levels() {
    show("tree", &tree(44, 4, 4500));
    show("bare", &tree(60, 12, 30));
    show("torus", &torus(64, 32));
}
