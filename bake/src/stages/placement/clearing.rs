//! Room around the lookouts that a landscape may first be seen from.

use glam::Vec2;

use crate::model::{Instance, Landform, Lookout};

/// Removes the trees whose trunks reach into the clearing around a lookout.
pub fn clear_around(land: &Landform, trees: &mut Vec<Instance>) {
    let places: Vec<Vec2> = Lookout::places_m(land.field.extent_m()).collect();
    trees.retain(|tree| {
        let [x, z, radius] = tree.trunk_cylinder_m;
        places.iter().all(|place| place.distance(Vec2::new(x, z)) - radius >= Lookout::CLEARING_M)
    });
}
