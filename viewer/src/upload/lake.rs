//! Where a landscape's lake lies, and which part of a picture shows it.

use std::collections::BTreeSet;

use glam::{Mat4, Vec2, Vec3, Vec4};

use crate::scene::{Apron, Ground};

/// Metres a side of a tile.
const TILE_M: f32 = 64.0;
/// What is nearer along the line of sight is not looked at: it would fill the picture.
const NEAR_M: f32 = 0.1;

/// The lake's surface as tiles of a grid: all that hold any of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Lake {
    /// Height of the surface in metres.
    pub level_m: f32,
    /// Tile (i, k) is [`TILE_M`] wide from (i, k) · [`TILE_M`].
    tiles: BTreeSet<[i32; 2]>,
}

/// A rectangle of a picture, as clip space divided by w has it: from −1 at the left and bottom to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    pub low: Vec2,
    pub high: Vec2,
}

impl Lake {
    /// `None` where the land is dry.
    pub fn of(ground: &Ground) -> Option<Self> {
        let level_m = ground.water_level_m?;
        let (field, mut tiles) = (&ground.field, BTreeSet::new());
        let side = field.side as usize;
        for (n, _) in field.heights_m.iter().enumerate().filter(|(_, height_m)| **height_m < level_m) {
            let middle_m = Vec2::new(field.place_m((n % side) as u32), field.place_m((n / side) as u32));
            insert(&mut tiles, middle_m - field.spacing_m, middle_m + field.spacing_m);
        }
        for [low_m, high_m] in wet_triangles(&ground.apron, level_m) {
            insert(&mut tiles, low_m, high_m);
        }
        Some(Self { level_m, tiles })
    }

    /// The part of a picture that may show the lake, as if no land hid it. `None` if there is none.
    pub fn seen(&self, clip_from_world: &Mat4) -> Option<Window> {
        self.tiles.iter().filter_map(|tile| self.window(*tile, clip_from_world)).reduce(Window::union)
    }

    fn window(&self, [i, k]: [i32; 2], clip_from_world: &Mat4) -> Option<Window> {
        let corner = |[x, z]: [i32; 2]| {
            let place_m = Vec3::new((i + x) as f32 * TILE_M, self.level_m, (k + z) as f32 * TILE_M);
            *clip_from_world * place_m.extend(1.0)
        };
        let corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(corner);
        let ends = (0..4).map(|n| [corners[n], corners[(n + 1) % 4]]);
        ends.filter_map(edge).reduce(Window::union)?.within_picture()
    }
}

impl Window {
    fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// With a margin to all sides, as far as the picture reaches; `None` if that is nowhere.
    pub fn grown(self, by: f32) -> Option<Self> {
        Self { low: self.low - by, high: self.high + by }.within_picture()
    }

    fn within_picture(self) -> Option<Self> {
        let clipped = Self { low: self.low.max(Vec2::NEG_ONE), high: self.high.min(Vec2::ONE) };
        clipped.low.cmplt(clipped.high).all().then_some(clipped)
    }

    /// What makes the window the whole picture.
    pub fn crop(&self) -> Mat4 {
        let scale = 2.0 / (self.high - self.low);
        let offset = -0.5 * scale * (self.high + self.low);
        Mat4::from_translation(offset.extend(0.0)) * Mat4::from_scale(scale.extend(1.0))
    }

    /// Left, top, width, height in a picture of that size: all pixels that it touches.
    pub fn pixels(&self, size_px: [u32; 2]) -> [u32; 4] {
        let size = Vec2::from(size_px.map(|side| side as f32));
        let low = (0.5 + 0.5 * Vec2::new(self.low.x, -self.high.y)) * size;
        let high = (0.5 + 0.5 * Vec2::new(self.high.x, -self.low.y)) * size;
        let (low, high) = (low.floor().max(Vec2::ZERO), high.ceil().min(size));
        [low.x, low.y, high.x - low.x, high.y - low.y].map(|px| px as u32)
    }
}

/// Adds the tiles that a rectangle touches.
fn insert(tiles: &mut BTreeSet<[i32; 2]>, low_m: Vec2, high_m: Vec2) {
    let tile = |place_m: Vec2| (place_m / TILE_M).floor().to_array().map(|number| number as i32);
    let ([west, north], [east, south]) = (tile(low_m), tile(high_m));
    tiles.extend((west..=east).flat_map(|i| (north..=south).map(move |k| [i, k])));
}

/// Bounds from above of the ring's triangles that reach below the surface.
fn wet_triangles(apron: &Apron, level_m: f32) -> impl Iterator<Item = [Vec2; 2]> {
    apron.triangles.iter().filter_map(move |triangle| {
        let places = triangle.map(|vertex| Vec3::from(apron.positions_m[vertex as usize]));
        let flat = places.map(|place_m| Vec2::new(place_m.x, place_m.z));
        let [a, b, c] = flat;
        places.iter().any(|place_m| place_m.y < level_m).then(|| [a.min(b).min(c), a.max(b).max(c)])
    })
}

/// The window around the part of an edge that lies before the eye.
fn edge([a, b]: [Vec4; 2]) -> Option<Window> {
    let before = |from: Vec4, to: Vec4| match from.w < NEAR_M {
        true => from + (to - from) * ((NEAR_M - from.w) / (to.w - from.w)),
        false => from,
    };
    if a.w.max(b.w) <= NEAR_M {
        return None;
    }
    let [a, b] = [before(a, b), before(b, a)].map(|clip| clip.truncate().truncate() / clip.w);
    Some(Window { low: a.min(b), high: a.max(b) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_place_of_the_lake_that_is_seen_lies_within_the_window(
            x in -300f32..300., y in 0.5f32..60., z in -300f32..300., aside in -0.6f32..0.6, up in -0.4f32..0.4,
            place_x in 0f32..128., place_z in -64f32..64.
        ) {
            // Past the place, but so that it is in the picture most times.
            let way = Vec3::new(place_x - x, -y, place_z - z);
            let yaw = Vec2::new(-way.z, -way.x).to_angle() + aside;
            let level_m = Vec2::new(way.x, way.z).length();
            let pitch = (Vec2::new(level_m, way.y).to_angle() + up).clamp(-1.5, 1.0);
            let lake = Lake { level_m: 0.0, tiles: [[0, -1], [0, 0], [1, -1], [1, 0]].into() };
            let camera = Camera { position_m: Vec3::new(x, y, z), yaw_rad: yaw, pitch_rad: pitch, fov_y_rad: 1.0 };
            let clip_from_world = camera.clip_from_world(1.5);
            let clip = clip_from_world * Vec4::new(place_x, 0.0, place_z, 1.0);
            prop_assume!(clip.w > 2.0 * NEAR_M && clip.x.abs() < clip.w && clip.y.abs() < clip.w);
            let window = lake.seen(&clip_from_world).expect("some of it is seen");
            let ndc = clip.truncate().truncate() / clip.w;
            prop_assert!((ndc - window.low).min_element() > -1e-3 && (window.high - ndc).min_element() > -1e-3);
            // The window as a picture of its own shows the same.
            let cropped = window.crop() * clip;
            prop_assert!(cropped.x.abs() <= 1.01 * cropped.w && cropped.y.abs() <= 1.01 * cropped.w);
            let [left, top, width, height] = window.pixels([300, 200]).map(|px| px as f32);
            let px = (0.5 + 0.5 * Vec2::new(ndc.x, -ndc.y)) * Vec2::new(300.0, 200.0);
            prop_assert!(px.x > left - 1.0 && px.x < left + width + 1.0);
            prop_assert!(px.y > top - 1.0 && px.y < top + height + 1.0);
        }
    }

    #[test]
    fn a_lake_behind_the_eye_or_below_the_picture_is_not_seen() {
        let lake = Lake { level_m: 0.0, tiles: [[0, 0]].into() };
        let look = |yaw_rad, pitch_rad| {
            let camera =
                Camera { position_m: Vec3::new(32.0, 20.0, 200.0), yaw_rad, pitch_rad, fov_y_rad: 1.0 };
            lake.seen(&camera.clip_from_world(1.5))
        };
        assert!(look(0.0, 0.0).is_some());
        assert_eq!(look(std::f32::consts::PI, 0.0), None);
        assert_eq!(look(0.0, 0.9), None);
    }
}
