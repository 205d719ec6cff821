//! What the ground looks like: images that cover the field once, and tiling textures for what is near.

use serde::{Deserialize, Serialize};

use super::GroundPlants;

/// Images over the whole field: row 0 is its north edge (−z), column 0 its west edge (−x).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct GroundSurface<P> {
    /// Albedo, sRGB. A, if there is any: how much of the ground is not under the water of flooded fields.
    pub color: P,
    /// How much of `details` 1 to 4 (rock, scree, snow, earth) there is, in RGBA; the rest up to 255 is `details` 0, grass.
    pub weights: P,
    /// R: part of the sky's irradiance that arrives, relative to open level ground (glTF reads occlusion from R);
    /// G: the sun's irradiance relative to a surface that faces it if there were no trees, max(0, n·l) × visibility;
    /// B: the part of the sun's disc that the land leaves visible; A: the part of its light that trees let through. Linear.
    pub light: P,
    /// Grass, rock, scree, snow and earth.
    pub details: Vec<GroundDetail<P>>,
    /// What stands and lies on it; nothing in scenes of Genescape 0.1.
    #[serde(default = "GroundPlants::default")]
    pub plants: GroundPlants<P>,
}

/// A tiling texture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct GroundDetail<P> {
    /// "grass", "rock", "scree", "snow", "earth" or "sand".
    pub name: String,
    /// Factor on the ground's colour, linear RGB: 128, its mean, stands for 1. The viewer makes green of red and blue, as
    /// 0.6 R + 0.4 B, which it is within a byte.
    pub detail: P,
    /// Tangent-space normals, RGB, of the same size.
    pub normal: P,
    /// Metres that one tile covers.
    pub tile_m: f32,
}

impl<P> GroundSurface<P> {
    /// The same with `f` of each image.
    ///
    /// # Errors
    /// The first that `f` gives.
    pub fn try_map<Q, E>(&self, mut f: impl FnMut(&P) -> Result<Q, E>) -> Result<GroundSurface<Q>, E> {
        Ok(GroundSurface {
            color: f(&self.color)?,
            weights: f(&self.weights)?,
            light: f(&self.light)?,
            details: self.details.iter().map(|detail| detail.try_map(&mut f)).collect::<Result<_, _>>()?,
            plants: self.plants.try_map(&mut f)?,
        })
    }
}

impl<P> GroundDetail<P> {
    /// The same with `f` of each image.
    ///
    /// # Errors
    /// The first that `f` gives.
    pub fn try_map<Q, E>(&self, mut f: impl FnMut(&P) -> Result<Q, E>) -> Result<GroundDetail<Q>, E> {
        let Self { name, detail, normal, tile_m } = self;
        Ok(GroundDetail { name: name.clone(), detail: f(detail)?, normal: f(normal)?, tile_m: *tile_m })
    }
}
