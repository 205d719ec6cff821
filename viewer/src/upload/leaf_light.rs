//! How the leaves of a template are lit where a picture stands for them: a table for each template, by the height of the eye and its
//! direction from the sun's.
//!
//! Trees are turned by chance, and leaves hardly prefer a side. So an entry is the mean over a tree that is turned once around,
//! and of eye and sun only their heights count and the angle between them as seen from above. The sun's height is the landscape's.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::Uploader;
use crate::gpu::flat;
use crate::scene::LeafSide;

/// Entries by the cosine of the angle between eye and sun as seen from above, and by the sine of the eye's height, each from -1 to 1.
const SIZE: [usize; 2] = [16, 8];

/// Directions in which the turned tree is looked at.
const TURNS: usize = 16;

impl Uploader {
    /// A layer for each template, by its leaves: see [`entry`].
    pub(super) fn leaf_lights(&self, leaves: &[&[LeafSide]], sun: Vec3) -> Arc<wgpu::Texture> {
        let size_px = SIZE.map(|side| side as u32);
        let usage = wgpu::TextureUsages::TEXTURE_BINDING;
        let mut texture = flat("light of leaves", size_px, wgpu::TextureFormat::Rgba8Unorm, usage);
        texture.size.depth_or_array_layers = leaves.len() as u32;
        let layers: Vec<Vec<[u8; 4]>> = leaves.par_iter().map(|leaves| table(leaves, sun)).collect();
        Arc::new(self.gpu.texture(&texture, bytemuck::cast_slice(&layers.concat())))
    }
}

fn table(leaves: &[LeafSide], sun: Vec3) -> Vec<[u8; 4]> {
    let [columns, rows] = SIZE;
    let middle = |number: usize, of: usize| 2.0 * (number as f32 + 0.5) / of as f32 - 1.0;
    let entries = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    entries
        .map(|(column, row)| {
            entry(leaves, sun, middle(column, columns), middle(row, rows))
                .map(|part| (255.0 * part).round() as u8)
        })
        .collect()
}

/// Of the leaves' area that the eye sees: the share of which it sees the lit side; how much sun, on average, falls on leaves that it
/// sees from there, and on those that it sees from behind; and how far they face upwards. As `leaf_light` of `trees.wgsl` has it.
fn entry(leaves: &[LeafSide], sun: Vec3, cosine: f32, eye_y: f32) -> [f32; 4] {
    let direction = |azimuth: f32, y: f32| {
        let level = Vec2::from_angle(azimuth) * (1.0 - y * y).max(0.0).sqrt();
        Vec3::new(level.x, y, level.y)
    };
    let aside = libm::acosf(cosine);
    let (mut seen, mut front, mut front_sun, mut back_sun, mut up) = (1e-6, 0.0, 0.0, 0.0, 0.0);
    for (turn, side) in (0..TURNS).flat_map(|turn| [(turn, aside), (turn, -aside)]) {
        let turned = turn as f32 * TAU / TURNS as f32;
        let to_eye = direction(turned, eye_y);
        let to_sun = direction(turned + side, sun.y);
        for leaf in leaves {
            let share = leaf.face.dot(to_eye).abs();
            let toward_sun = leaf.normal.dot(to_sun);
            let sun = share * (0.75 * toward_sun.abs() + 0.25);
            let is_front = toward_sun * leaf.normal.dot(to_eye) > 0.0;
            seen += share;
            front += if is_front { share } else { 0.0 };
            *(if is_front { &mut front_sun } else { &mut back_sun }) += sun;
            up += share * (0.5 + 0.5 * leaf.normal.y.abs());
        }
    }
    [front / seen, front_sun / front.max(1e-6), back_sun / (seen - front).max(1e-6), up / seen]
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEVEL: LeafSide = LeafSide { normal: Vec3::Y, face: Vec3::Y };

    fn near(entry: [f32; 4], expected: [f32; 4]) -> bool {
        entry.iter().zip(expected).all(|(one, other)| (one - other).abs() < 1e-3)
    }

    #[test]
    fn leaves_that_lie_level_are_lit_from_above_and_glow_below() {
        let sun = Vec3::new(0.8, 0.6, 0.0);
        let lit = 0.75 * 0.6 + 0.25;
        for cosine in [-1.0, 0.3, 1.0] {
            let (above, below) = (entry(&[LEVEL], sun, cosine, 0.5), entry(&[LEVEL], sun, cosine, -0.5));
            assert!(near(above, [1.0, lit, 0.0, 1.0]), "{above:?}");
            assert!(near(below, [0.0, 0.0, lit, 1.0]), "{below:?}");
        }
    }

    #[test]
    fn of_upright_leaves_the_lit_side_is_seen_with_the_sun_behind() {
        let leaves: [LeafSide; 8] = std::array::from_fn(|number| {
            let way = Vec2::from_angle(number as f32 * TAU / 8.0);
            LeafSide { normal: Vec3::new(way.x, 0.0, way.y), face: Vec3::new(way.x, 0.0, way.y) }
        });
        let share = |cosine: f32| entry(&leaves, Vec3::new(1.0, 0.1, 0.0), cosine, 0.0)[0];
        assert!(share(0.99) > 0.95 && share(-0.99) < 0.05, "{} {}", share(0.99), share(-0.99));
        assert!((share(0.0) - 0.5).abs() < 0.05, "{}", share(0.0));
    }
}
