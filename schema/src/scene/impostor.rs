//! `GSC_impostor`, on the glTF mesh that is D_0 of a tree: pictures of it from four sides, for where it is far away.

use serde::{Deserialize, Serialize};

use super::Resource;

/// The extension's name.
pub const GSC_IMPOSTOR: &str = "GSC_impostor";
/// Pictures side by side, an eighth of a turn apart; seen from behind each is its own mirror image.
pub const IMPOSTOR_PICTURES: u32 = 4;

/// The extension's object on a mesh. Lengths in metres of the mesh's space.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct ImpostorExtension {
    /// Index in `meshes` of the cards: a vertical one for each picture, crossing in the axis. Its only material's base
    /// colour holds the pictures from left to right, number k as seen orthographically from the azimuth k·45°, which is
    /// the direction (sin, 0, cos); each is as wide and high as `size_m`.
    pub mesh: usize,
    /// A PNG file of as many pixels: red is how far what a pixel shows lies before the axis, 0.5 for none and 1 for half
    /// of the width; green 1 for leaves and blossom, 0 for wood; blue the share of the pixel that the tree covers.
    pub relief: Resource,
    /// From this error in metres on the pictures serve as well as any mesh; `error` in JSON.
    #[serde(rename = "error")]
    pub error_m: f32,
    /// x and z of the vertical axis; `axis` in JSON.
    #[serde(rename = "axis")]
    pub axis_m: [f32; 2],
    /// y of the pictures' lower edge; `low` in JSON.
    #[serde(rename = "low")]
    pub low_m: f32,
    /// Width and height of a picture; `size` in JSON.
    #[serde(rename = "size")]
    pub size_m: [f32; 2],
}
