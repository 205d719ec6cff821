//! Genes → tiling bark: 512² texels of colour in sRGB and 256² of tangent-space normals a repeat.
//!
//! Three barks blend by `bark_tone`: dark with deep furrows (oak), brown plates (pine), pale and smooth with dark
//! lenticels (birch). What is too slender for bark is a cane: green, smooth, with nodes. u runs around the stem, v
//! along it; noise wraps at the edges.

use bytemuck::Zeroable;
use glam::Vec3;

use super::mips::Encoder;
use super::params::TreeTextureParams;
use crate::math::{hermite as smooth, lerp, linear_from_srgb, smoothstep, split};
use crate::model::Image8;
use crate::noise::{cellular2, gradient2, hash};
use crate::raster::{square, square_image};
use crate::seed;

/// Texels a side.
const SIZE: usize = 512;
/// Radius over length up to which a stem is a cane, and from which it has bark.
const CANE: [f32; 2] = [0.009, 0.0105];
/// Nodes of a cane in one repeat.
const NODES: f32 = 3.0;
/// Texels a side of the height that colours and normals are made from.
const COARSE: usize = 256;

/// Colour and normals.
pub(super) fn paint(params: &TreeTextureParams) -> (Image8, Image8) {
    let seed = seed::noise_seed(u64::from(params.tree_seed), "bark", 0);
    let cane = 1.0 - smoothstep(CANE[0], CANE[1], params.radius_ratio);
    let bark = Bark { seed, tone: params.bark_tone.clamp(0.0, 1.0), cane };
    let place = |i: usize| i as f32 / COARSE as f32;
    let coarse = square(COARSE, |x, y| bark.texel(place(x), place(y)));
    (colors(&coarse, seed.wrapping_add(40)), normals(&coarse))
}

/// Mean of a picture in sRGB, in linear light.
pub(super) fn mean_linear(image: &Image8) -> [f32; 3] {
    let mut counts = [[0u32; 256]; 3];
    for pixel in image.data.chunks_exact(3) {
        (0..3).for_each(|c| counts[c][usize::from(pixel[c])] += 1);
    }
    let pixels = (image.data.len() / 3).max(1) as f32;
    let light =
        |(byte, &count): (usize, &u32)| linear_from_srgb(byte as f32 / 255.0) * (count as f32 / pixels);
    counts.map(|counts| counts.iter().enumerate().map(light).sum())
}

/// Height in texels of `COARSE` and linear colour.
#[derive(Clone, Copy, Zeroable)]
struct Texel {
    height: f32,
    color: Vec3,
}

struct Bark {
    seed: u32,
    tone: f32,
    /// 1 for a cane, 0 for a trunk.
    cane: f32,
}

impl Bark {
    /// What a place of the bark is like; (u, v) in 0..1.
    fn texel(&self, u: f32, v: f32) -> Texel {
        match self.cane {
            ..=0.0 => self.bark(u, v),
            1.0.. => self.culm(u, v),
            part => mix(self.bark(u, v), self.culm(u, v), part),
        }
    }

    /// A green skin with rings where leaves sat, pale with wax below each.
    fn culm(&self, u: f32, v: f32) -> Texel {
        let along = v * NODES;
        let below = along - along.floor();
        let ring = smooth((1.0 - 14.0 * below.min(1.0 - below)).max(0.0));
        let wax = smooth((1.0 - 5.0 * below).max(0.0)) * (1.0 - ring);
        let wear = 0.5 + 0.5 * self.tiled(12, u, v, 7, 2);
        let green = Vec3::new(0.075, 0.130, 0.030).lerp(Vec3::new(0.150, 0.165, 0.050), wear);
        let color = green.lerp(Vec3::new(0.240, 0.270, 0.180), 0.6 * wax);
        Texel { height: 1.0 + 2.0 * ring, color: color.lerp(Vec3::new(0.080, 0.075, 0.040), 0.7 * ring) }
    }

    fn bark(&self, u: f32, v: f32) -> Texel {
        let wear = gradient2(self.seed.wrapping_add(90), u * 4.0, v * 4.0, 4);
        let barks = [Self::furrows as fn(&Self, f32, f32, f32) -> Texel, Self::plates, Self::birch];
        let darker = usize::from(self.tone > 0.5);
        let part = smooth(self.tone * 2.0 - darker as f32);
        let bark = |k: usize| barks[k](self, u, v, wear);
        match part {
            0.98.. => bark(darker + 1),
            ..=0.02 => bark(darker),
            _ => mix(bark(darker), bark(darker + 1), part),
        }
    }

    /// Long ridges that join and part, with dark furrows between.
    fn furrows(&self, u: f32, v: f32, wear: f32) -> Texel {
        let sway = gradient2(self.seed.wrapping_add(1), u * 4.0, v * 4.0, 4) * 0.07;
        let crest = (self.tiled(3, u + sway, v, 10, 3).abs() * 2.3).min(1.0);
        let small = (self.tiled(4, u + sway, v, 22, 8).abs() * 1.8).min(1.0);
        let height = smooth(crest) * 0.78 + small * 0.22;
        let dark = Vec3::new(0.032, 0.025, 0.019);
        let light = Vec3::new(0.150, 0.122, 0.096);
        let color = dark.lerp(light, height) * (1.0 + 0.35 * wear);
        Texel { height: height * 6.0, color }
    }

    /// Scales of bark with cracks between.
    fn plates(&self, u: f32, v: f32, wear: f32) -> Texel {
        let sway = gradient2(self.seed.wrapping_add(5), u * 5.0, v * 5.0, 5) * 0.45;
        let (first, second, id) = cellular2(self.seed.wrapping_add(6), u * 10.0 + sway, v * 5.0 + sway, 5);
        let crack = smooth(((second - first) * 3.2).min(1.0));
        let own = (id & 0xFF) as f32 / 255.0;
        let layer = self.tiled(7, u + 0.02 * sway, v, 6, 22).abs();
        let height = crack * (0.72 + 0.28 * own) - 0.22 * layer * crack;
        let dark = Vec3::new(0.040, 0.028, 0.020);
        let light = Vec3::new(0.205, 0.135, 0.088).lerp(Vec3::new(0.235, 0.180, 0.135), own);
        let color = dark.lerp(light, crack * (1.0 - 0.4 * layer)) * (1.0 + 0.25 * wear);
        Texel { height: height * 5.5, color }
    }

    /// Pale bark with dark dashes around the stem.
    fn birch(&self, u: f32, v: f32, wear: f32) -> Texel {
        let dashes = self.tiled(8, u, v, 6, 44);
        let patches = self.tiled(9, u, v, 4, 5);
        let lenticel = smooth(((dashes - 0.36 + 0.3 * patches.min(0.3)) * 5.0).clamp(0.0, 1.0));
        let peel = self.tiled(10, u, v, 3, 16);
        let scar = smooth(((self.tiled(11, u, v, 9, 15) - 0.62) * 5.0).clamp(0.0, 1.0));
        let dark = (lenticel * 0.85).max(scar * 0.9);
        let pale = Vec3::new(0.52, 0.49, 0.44) * (1.0 + 0.12 * wear + 0.1 * peel);
        let color = pale.lerp(Vec3::new(0.060, 0.050, 0.044), dark);
        Texel { height: 1.2 + 0.8 * peel - 2.2 * dark, color }
    }

    /// Gradient noise of `across` by `along` cells a tile, in about [-1, 1].
    fn tiled(&self, layer: u32, u: f32, v: f32, across: i32, along: i32) -> f32 {
        let seed = self.seed.wrapping_add(layer);
        let (x, y) = (u * across as f32, v * along as f32);
        let ((ix, dx), (iy, dy)) = (split(x), split(y));
        let (x0, y0) = (ix.rem_euclid(across), iy.rem_euclid(along));
        let (x1, y1) = ((x0 + 1) % across, (y0 + 1) % along);
        let corner = |ix: i32, iy: i32, dx: f32, dy: f32| {
            let h = hash(seed, ix, iy, 0);
            let long = if h & 1 == 0 { dx } else { -dx };
            let short = if h & 2 == 0 { dy } else { -dy };
            if h & 4 == 0 { long + 0.5 * short } else { 0.5 * long + short }
        };
        let (s, t) = (smooth(dx), smooth(dy));
        let upper = corner(x0, y0, dx, dy) * (1.0 - s) + corner(x1, y0, dx - 1.0, dy) * s;
        let lower = corner(x0, y1, dx, dy - 1.0) * (1.0 - s) + corner(x1, y1, dx - 1.0, dy - 1.0) * s;
        (upper * (1.0 - t) + lower * t) * 1.3
    }
}

fn mix(a: Texel, b: Texel, part: f32) -> Texel {
    Texel { height: lerp(a.height, b.height, part), color: a.color.lerp(b.color, part) }
}

/// Colours at twice the size by wrapped bilinear interpolation, with fine grain added.
fn colors(coarse: &[Texel], seed: u32) -> Image8 {
    let encode = Encoder::new();
    square_image(SIZE, |y| {
        let (y0, y1, fy) = halfway(y);
        let (upper, lower) = (&coarse[y0 * COARSE..][..COARSE], &coarse[y1 * COARSE..][..COARSE]);
        let column: Vec<Vec3> =
            upper.iter().zip(lower).map(|(a, b)| a.color + (b.color - a.color) * fy).collect();
        let encode = &encode;
        move |x| {
            let (x0, x1, fx) = halfway(x);
            // Fibres run along the stem: grain varies faster around it.
            let bits = hash(seed, x as i32, (y / 3) as i32, 7);
            let grain = (bits & 0xFF) as f32 * (1.0 / 255.0) - 0.5;
            let color = (column[x0] + (column[x1] - column[x0]) * fx) * (1.0 + 0.2 * grain);
            color.to_array().map(|linear| encode.byte(linear))
        }
    })
}

/// The two coarse texels that a fine one lies between, and the fraction.
fn halfway(i: usize) -> (usize, usize, f32) {
    let last = COARSE - 1;
    if i.is_multiple_of(2) { ((i / 2 + last) & last, i / 2, 0.75) } else { (i / 2, (i / 2 + 1) & last, 0.25) }
}

/// Normals by central differences; red towards +u, green towards −v (up in the image), as glTF has it.
fn normals(texels: &[Texel]) -> Image8 {
    let height = |x: usize, y: usize| texels[(y % COARSE) * COARSE + x % COARSE].height;
    square_image(COARSE, |y| {
        move |x| {
            let east = height(x + 1, y) - height(x + COARSE - 1, y);
            let south = height(x, y + 1) - height(x, y + COARSE - 1);
            let normal = Vec3::new(-0.5 * east, 0.5 * south, 1.0);
            let normal = normal / normal.length_squared().sqrt();
            normal.to_array().map(|part| (127.5 * (part + 1.0) + 0.5) as u8)
        }
    })
}
