//! The land as plain values: its heights, what its levels of detail need, and what covers it.

use std::sync::Arc;

use genescape_schema::scene::{DensityMap, GroundSurface, Heightfield, PlantKind, TerrainLod};

use super::Image;

/// All of the land.
#[derive(Clone, Debug)]
pub struct Ground {
    /// Blob that the heights came from: equal names are equal heights.
    pub name: String,
    pub field: Arc<Heightfield>,
    /// What the levels of detail of `field` need.
    pub lod: Arc<TerrainLod>,
    /// Surface of the lake in metres; `None` when the land is dry.
    pub water_level_m: Option<f32>,
    /// What covers it.
    pub surface: GroundSurface<Image>,
    /// The coarse land around the field, to the horizon.
    pub apron: Arc<Apron>,
}

impl Ground {
    /// The map that says how densely a kind of plant stands.
    pub fn plant_map(&self, kind: &PlantKind) -> Option<DensityMap<'_>> {
        let image = self.surface.plants.maps.get(kind.channel as usize / 4)?;
        let rgba = image.levels.first()?;
        Some(DensityMap { width_px: image.width_px, height_px: image.height_px, rgba })
    }
}

/// The ring of coarse land around the field as triangles; its inner edge joins the field's border as the near mesh
/// of the file has it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Apron {
    /// Metres.
    pub positions_m: Vec<[f32; 3]>,
    /// Unit length.
    pub normals: Vec<[f32; 3]>,
    /// Linear albedo in 8 bits a channel, alpha unused.
    pub colors: Vec<[u8; 4]>,
    /// Parts of the surface's details 1 to 4, in 8 bits each; the rest is detail 0.
    pub weights: Vec<[u8; 4]>,
    /// Triangles, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
}

impl Apron {
    /// Share of the horizon where no land rises above a level: 0 where a lake has a shore all around, 1 around an island.
    pub fn open_share(&self, level_m: f32) -> f32 {
        let away_m = |[x, _, z]: &[f32; 3]| x.abs().max(z.abs());
        let farthest_m = self.positions_m.iter().map(away_m).fold(0.0, f32::max);
        let outer = || self.positions_m.iter().filter(|place_m| away_m(place_m) > 0.97 * farthest_m);
        let open = outer().filter(|[_, y, _]| *y < level_m).count();
        open as f32 / outer().count().max(1) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_horizon_is_open_where_the_outermost_land_is_under_water() {
        let place = |x: f32, y: f32, z: f32| [x, y, z];
        // A shore at 100 m; at 1000 m there is land in the east alone.
        let shore = [place(100.0, 5.0, 0.0), place(-100.0, 5.0, 0.0)];
        let outer = [
            place(1000.0, 9.0, 20.0),
            place(-1000.0, -3.0, 0.0),
            place(50.0, -3.0, 990.0),
            place(0.0, -3.0, -1000.0),
        ];
        let apron = Apron { positions_m: [&shore[..], &outer].concat(), ..Default::default() };
        assert_eq!(apron.open_share(0.0), 0.75);
        assert_eq!([apron.open_share(-4.0), apron.open_share(10.0)], [0.0, 1.0]);
        assert_eq!(Apron::default().open_share(0.0), 0.0);
    }
}
