//! Light on the ground.

use serde::{Deserialize, Serialize};

use super::Image8;

/// Light on the ground; covers the field as `GroundMaps` do. RGB:
/// R = part of the sky's irradiance that arrives, relative to open level ground (glTF reads occlusion from R);
/// G = the sun's irradiance relative to a surface that faces it: max(0, n·l) × visibility;
/// B = visibility of the sun's disc alone, trees and land included.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LightMap {
    /// RGB, linear, 8 bits.
    pub image: Image8,
}
