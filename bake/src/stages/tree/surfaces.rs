//! What the parts of a tree look like: bark of one colour, and cards that are cut out.

use std::sync::LazyLock;

use glam::{Vec3, Vec4};

use super::ALPHA_CUTOFF;
use crate::math::linear_from_srgb;
use crate::model::{AlphaMask, Image8, Material, TreeTextures};

/// Linear light of each byte of sRGB.
static LINEAR: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|byte| linear_from_srgb(byte as f32 / 255.0)));

/// Bits in a word.
const WORD: usize = u64::BITS as usize;

/// A card's colours, and where it is cut away.
pub(super) struct Card {
    pub mask: AlphaMask,
    /// Whether it is of wood.
    pub is_wood: bool,
    texels: Texels,
}

/// The pictures of all clusters of leaves.
pub(super) struct Atlas {
    sunlit: Vec<f32>,
    texels: Texels,
    /// Whether each texel is opaque, in bits of its row's words.
    opaque: Vec<u64>,
    /// Words in a row.
    words: usize,
    /// Texels across and down, and the last of each.
    size: [Vec4; 2],
    last: [Vec4; 2],
}

/// A picture: rows from the top.
struct Texels {
    width: usize,
    height: usize,
    /// sRGB with alpha.
    pixels: Vec<[u8; 4]>,
}

impl Texels {
    /// Of an RGBA picture; white where there is none.
    fn of(image: &Image8) -> Self {
        if image.channels != 4 || image.data.is_empty() {
            return Self { width: 1, height: 1, pixels: vec![[u8::MAX; 4]] };
        }
        let (width, height) = (image.width as usize, image.height as usize);
        Self { width, height, pixels: image.data.as_chunks().0.to_vec() }
    }

    /// Linear.
    fn color(&self, index: usize) -> Vec3 {
        let [r, g, b, _] = self.pixels[index];
        Vec3::from_array([r, g, b].map(|byte| LINEAR[usize::from(byte)]))
    }

    /// Which texel is at texture coordinates, which are clamped to [0, 1].
    fn index(&self, u: f32, v: f32) -> usize {
        let index = |t: f32, count: usize| ((t * count as f32).max(0.0) as i32 as usize).min(count - 1);
        index(v, self.height) * self.width + index(u, self.width)
    }
}

impl Card {
    /// A card's small picture, ready to be drawn; white and opaque where there is none.
    fn of(image: &Image8, is_wood: bool) -> Self {
        Self { mask: AlphaMask::of(image, ALPHA_CUTOFF), is_wood, texels: Texels::of(image) }
    }

    pub fn at(&self, u: f32, v: f32) -> Vec3 {
        self.texels.color(self.texels.index(u, v))
    }
}

impl Atlas {
    /// Of an RGBA picture; with how far what each texel shows is turned to the sun.
    pub fn new(image: &Image8, sunlit: Vec<f32>) -> Self {
        let texels = Texels::of(image);
        let is_opaque = |[.., alpha]: [u8; 4]| f32::from(alpha) >= 255.0 * ALPHA_CUTOFF;
        let word = |pixels: &[[u8; 4]]| {
            pixels.iter().enumerate().map(|(bit, &pixel)| u64::from(is_opaque(pixel)) << bit).sum::<u64>()
        };
        let rows = texels.pixels.chunks(texels.width);
        let opaque = rows.flat_map(|row| row.chunks(WORD).map(word)).collect();
        let size = [texels.width, texels.height].map(|count| Vec4::splat(count as f32));
        let last = size.map(|count| count - 1.0);
        Self { sunlit, opaque, words: texels.width.div_ceil(WORD), size, last, texels }
    }

    /// Whether it is opaque at four places: a bit for each. Texture coordinates are clamped to [0, 1].
    #[inline]
    pub fn opaque(&self, uv: [Vec4; 2]) -> u64 {
        let texels = |axis: usize| {
            let places = (uv[axis] * self.size[axis]).clamp(Vec4::ZERO, self.last[axis]);
            places.to_array().map(|place| place as i32 as usize)
        };
        let [x, y] = [0, 1].map(texels);
        let bit = |k: usize| (self.opaque[y[k] * self.words + x[k] / WORD] >> (x[k] % WORD) & 1) << k;
        bit(0) | bit(1) | bit(2) | bit(3)
    }

    /// Colour, and how far it is turned to the sun.
    pub fn at(&self, u: f32, v: f32) -> (Vec3, f32) {
        let index = self.texels.index(u, v);
        (self.texels.color(index), self.sunlit[index])
    }
}

/// What triangles are made of.
#[derive(Clone, Copy)]
pub(super) enum Surface<'a> {
    /// A colour, linear.
    Wood(Vec3),
    Card(&'a Card),
    Atlas(&'a Atlas),
}

/// What all parts of a tree are made of.
pub(super) struct Surfaces {
    bark: Vec3,
    leaf: Card,
    blossom: Card,
    clusters: Option<Atlas>,
}

impl Surfaces {
    pub fn of<P>(textures: &TreeTextures<P>) -> Self {
        Self {
            bark: Vec3::from_array(textures.bark_linear),
            leaf: Card::of(&textures.leaf_small, textures.is_thin),
            blossom: Card::of(&textures.blossom_small, false),
            clusters: None,
        }
    }

    /// The same with pictures of clusters.
    pub fn with_clusters(self, atlas: Atlas) -> Self {
        Self { clusters: Some(atlas), ..self }
    }

    pub fn of_part(&self, material: Material) -> Surface<'_> {
        match material {
            Material::Leaf => Surface::Card(&self.leaf),
            Material::Blossom => Surface::Card(&self.blossom),
            Material::Cluster => self.clusters.as_ref().map_or(Surface::Wood(self.bark), Surface::Atlas),
            _ => Surface::Wood(self.bark),
        }
    }
}
