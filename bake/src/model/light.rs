//! Light on the ground.

use serde::{Deserialize, Serialize};

use super::Image8;

/// Light on the ground; covers the field as `GroundMaps` do. RGBA:
/// R = part of the sky's irradiance that arrives, relative to open level ground (glTF reads occlusion from R);
/// G = the sun's irradiance relative to a surface that faces it if there were no trees: max(0, n·l) × visibility;
/// B = the part of the sun's disc that the land leaves visible;
/// A = the part of its light that trees let through.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LightMap {
    /// RGBA, linear, 8 bits.
    pub image: Image8,
}
