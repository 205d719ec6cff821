//! What the parts of a tree look like: bark of one colour, and cards that are cut out.

use glam::Vec3;

use super::ALPHA_CUTOFF;
use crate::math::linear_from_srgb;
use crate::model::{AlphaMask, Image8, Material, TreeTextures};

/// A card's colours, and where it is cut away.
pub(super) struct Card {
    pub mask: AlphaMask,
    width: usize,
    height: usize,
    /// Rows from the top; linear.
    texels: Vec<Vec3>,
}

impl Card {
    /// A card's small picture, ready to be drawn; white and opaque where there is none.
    fn of(image: &Image8) -> Self {
        let mask = AlphaMask::of(image, ALPHA_CUTOFF);
        if image.channels != 4 || image.data.is_empty() {
            return Self { mask, width: 1, height: 1, texels: vec![Vec3::ONE] };
        }
        let linear: Vec<f32> = (0..256).map(|byte| linear_from_srgb(byte as f32 / 255.0)).collect();
        let texel = |pixel: &[u8]| Vec3::from_array([0, 1, 2].map(|c| linear[usize::from(pixel[c])]));
        Self {
            mask,
            width: image.width as usize,
            height: image.height as usize,
            texels: image.data.chunks_exact(4).map(texel).collect(),
        }
    }

    pub fn at(&self, u: f32, v: f32) -> Vec3 {
        let index = |t: f32, count: usize| ((t * count as f32).max(0.0) as usize).min(count - 1);
        self.texels[index(v, self.height) * self.width + index(u, self.width)]
    }
}

/// What triangles are made of.
#[derive(Clone, Copy)]
pub(super) enum Surface<'a> {
    /// A colour, linear.
    Wood(Vec3),
    Card(&'a Card),
}

/// What all parts of a tree are made of.
pub(super) struct Surfaces {
    bark: Vec3,
    leaf: Card,
    blossom: Card,
}

impl Surfaces {
    pub fn of<P>(textures: &TreeTextures<P>) -> Self {
        Self {
            bark: Vec3::from_array(textures.bark_linear),
            leaf: Card::of(&textures.leaf_small),
            blossom: Card::of(&textures.blossom_small),
        }
    }

    pub fn of_part(&self, material: Material) -> Surface<'_> {
        match material {
            Material::Leaf => Surface::Card(&self.leaf),
            Material::Blossom => Surface::Card(&self.blossom),
            _ => Surface::Wood(self.bark),
        }
    }
}
