//! What the parts of a tree look like: bark of one colour, and cards that are cut out.

use std::sync::LazyLock;

use glam::{Vec3, Vec4};

use super::ALPHA_CUTOFF;
use crate::math::linear_from_srgb;
use crate::model::{AlphaMask, Image8, Material, TreeTextures};

/// Linear light of each byte of sRGB.
static LINEAR: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|byte| linear_from_srgb(byte as f32 / 255.0)));

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
        Self { sunlit, texels: Texels::of(image) }
    }

    pub fn is_opaque(&self, u: f32, v: f32) -> bool {
        let [.., alpha] = self.texels.pixels[self.texels.index(u, v)];
        f32::from(alpha) >= 255.0 * ALPHA_CUTOFF
    }

    /// The same at four places: a bit for each.
    pub fn opaque(&self, [u, v]: [Vec4; 2]) -> u64 {
        (0..4).map(|k| u64::from(self.is_opaque(u[k], v[k])) << k).sum()
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
