//! A landscape as plain values, as read from its files and before any of it is on the GPU. Knows neither disk nor
//! device. Coordinates as in glTF: right-handed, y up, metres.

mod ground;
mod picture;
mod sky;
mod trees;

pub use ground::{Apron, Detail, Ground, Heightfield, Surface};
pub use picture::{HdrPicture, Picture};
pub use sky::{CloudLayer, Sky};
pub use trees::{Instance, Level, Material, Range, Template, TreeVertex, Trees};

/// One landscape.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The individual's name: "Oak valley in June".
    pub name: String,
    /// The genome's values by gene, in their units, as the scene's file tells them.
    pub genome: Vec<(String, f64)>,
    /// The land.
    pub ground: Ground,
    /// The trees.
    pub trees: Trees,
    /// Sky, sun and air.
    pub sky: Sky,
}
