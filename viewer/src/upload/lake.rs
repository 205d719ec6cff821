//! Where a landscape's lake lies, and which part of a picture shows it.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::{Mat4, Vec2, Vec3, Vec4};

use super::horizon::Horizon;
use crate::lod::nested::Sight;
use crate::scene::{Apron, Ground, Heightfield};

/// Metres a side of a tile.
const TILE_M: f32 = 64.0;
/// What is nearer along the line of sight is not looked at: it would fill the picture.
const NEAR_M: f32 = 0.1;

/// The lake's surface as tiles of a grid: all that hold any of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Lake {
    /// Height of the surface in metres.
    pub level_m: f32,
    /// How much of a sea it is: 0 with a shore all around, 1 where a third of the horizon or more is open.
    pub sea: f32,
    /// Tile (i, k) is [`TILE_M`] wide from (i, k) · [`TILE_M`].
    tiles: BTreeSet<[i32; 2]>,
    /// The land around it, which may hide it.
    field: Arc<Heightfield>,
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
        Some(Self::between(&ground.field, &ground.apron, ground.water_level_m?))
    }

    /// Where that land and the ring around it are below a level.
    fn between(field: &Arc<Heightfield>, apron: &Apron, level_m: f32) -> Self {
        let mut tiles = BTreeSet::new();
        let side = field.side as usize;
        for (n, _) in field.heights_m.iter().enumerate().filter(|(_, height_m)| **height_m < level_m) {
            let middle_m = Vec2::new(field.place_m((n % side) as u32), field.place_m((n / side) as u32));
            insert(&mut tiles, middle_m - field.spacing_m, middle_m + field.spacing_m);
        }
        for [low_m, high_m] in wet_triangles(apron, level_m) {
            insert(&mut tiles, low_m, high_m);
        }
        let sea = (3.0 * apron.open_share(level_m)).min(1.0);
        Self { level_m, sea, tiles, field: field.clone() }
    }

    /// The part of a picture that may show the lake to an eye, where the land is drawn for that sight. `None` if there is none.
    pub fn seen(&self, clip_from_world: &Mat4, eye_m: Vec3, drawn: Sight) -> Option<Window> {
        let mut horizon = Horizon::new(&self.field, eye_m, drawn);
        let mut is_hidden = |tile: [i32; 2]| {
            let corner_m = |aside: i32| Vec2::from(tile.map(|number| (number + aside) as f32 * TILE_M));
            horizon.hides(corner_m(0), corner_m(1), self.level_m)
        };
        let windows =
            self.tiles.iter().filter_map(|tile| Some((*tile, self.window(*tile, clip_from_world)?)));
        windows.fold(None, |seen: Option<Window>, (tile, window)| match seen {
            Some(seen) if seen.contains(&window) => Some(seen),
            _ if is_hidden(tile) => seen,
            _ => Some(seen.map_or(window, |seen| seen.union(window))),
        })
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

    fn contains(&self, other: &Self) -> bool {
        self.low.cmple(other.low).all() && self.high.cmpge(other.high).all()
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
    use std::sync::LazyLock;

    /// 1024 m × 1024 m, by the height at each x and z.
    fn land(height_m: impl Fn(f32, f32) -> f32) -> Arc<Heightfield> {
        let mut field = Heightfield { side: 257, spacing_m: 4.0, heights_m: Vec::new() };
        let places: Vec<f32> = (0..field.side).map(|line| field.place_m(line)).collect();
        field.heights_m = places.iter().flat_map(|z| places.iter().map(|x| height_m(*x, *z))).collect();
        Arc::new(field)
    }

    /// Land that may be two pixels off in a picture where a radian has 500.
    fn usual(eye_m: Vec3) -> Sight {
        Sight { eye_m, pixels: 250.0 }
    }

    /// Hills between lakes at height 0.
    fn hills(x: f32, z: f32) -> f32 {
        16.0 * libm::sinf(x / 37.0 + 0.3) * libm::cosf(z / 29.0)
            + 9.0 * libm::sinf((x - 2.0 * z) / 61.0)
            + 4.0
    }

    proptest! {
        // Of random places few are under water, and of those land hides many.
        #![proptest_config(ProptestConfig { cases: 500, max_global_rejects: 100_000, ..Default::default() })]
        #[test]
        fn water_that_no_land_hides_is_seen(
            from in prop::array::uniform2(-480f32..480.), above in 1.6f32..12., way in prop::array::uniform2(-300f32..300.),
        ) {
            static HILLS: LazyLock<Arc<Heightfield>> = LazyLock::new(|| land(hills));
            let field = &*HILLS;
            let eye = Vec3::new(from[0], field.height_m(from[0], from[1]).max(0.0) + above, from[1]);
            let place = Vec3::new(from[0] + way[0], 0.0, from[1] + way[1]);
            prop_assume!(place.abs().max_element() < 500.0 && field.height_m(place.x, place.z) < -0.5);
            let is_free = |n: u16| {
                let at = place.lerp(eye, f32::from(n) / 1000.0);
                field.height_m(at.x, at.z) < at.y
            };
            prop_assume!((1..1000).all(is_free));
            let lake = Lake::between(field, &Apron::default(), 0.0);
            let look = place - eye;
            let camera = Camera {
                position_m: eye,
                yaw_rad: libm::atan2f(-look.x, -look.z),
                pitch_rad: libm::atan2f(look.y, Vec2::new(look.x, look.z).length()),
                fov_y_rad: 0.05,
            };
            prop_assert!(lake.seen(&camera.clip_from_world(1.5), eye, usual(eye)).is_some());
        }
    }

    #[test]
    fn a_lake_behind_a_ridge_is_seen_from_its_top_alone() {
        let ridge = |_: f32, z: f32| if (-40.0..40.0).contains(&z) { 30.0 } else { z.signum() * 2.0 };
        let lake =
            Lake { level_m: 0.0, sea: 0.0, tiles: [[-1, -3], [0, -3], [0, -4]].into(), field: land(ridge) };
        let look = |y: f32, z: f32| {
            let position_m = Vec3::new(0.0, y, z);
            let camera = Camera { position_m, yaw_rad: 0.0, pitch_rad: -0.1, fov_y_rad: 1.2 };
            let seen = |pixels| {
                lake.seen(&camera.clip_from_world(1.5), position_m, Sight { eye_m: position_m, pixels })
            };
            // Land that may be drawn anyhow hides nothing.
            assert!(seen(0.0).is_some());
            seen(usual(position_m).pixels)
        };
        assert_eq!(look(4.0, 200.0), None);
        assert_eq!(look(31.0, 36.0), None, "the ridge's far edge");
        assert!(look(32.0, -39.0).is_some());
        assert!(look(120.0, 200.0).is_some());
        assert!(look(1.7, -100.0).is_some());
    }

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
            let lake = Lake { level_m: 0.0, sea: 0.0, tiles: [[0, -1], [0, 0], [1, -1], [1, 0]].into(), field: land(|_, _| -1.0) };
            let camera = Camera { position_m: Vec3::new(x, y, z), yaw_rad: yaw, pitch_rad: pitch, fov_y_rad: 1.0 };
            let clip_from_world = camera.clip_from_world(1.5);
            let clip = clip_from_world * Vec4::new(place_x, 0.0, place_z, 1.0);
            prop_assume!(clip.w > 2.0 * NEAR_M && clip.x.abs() < clip.w && clip.y.abs() < clip.w);
            let window = lake.seen(&clip_from_world, camera.position_m, usual(camera.position_m)).expect("some of it is seen");
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
        let lake = Lake { level_m: 0.0, sea: 0.0, tiles: [[0, 0]].into(), field: land(|_, _| -1.0) };
        let look = |yaw_rad, pitch_rad| {
            let camera =
                Camera { position_m: Vec3::new(32.0, 20.0, 200.0), yaw_rad, pitch_rad, fov_y_rad: 1.0 };
            lake.seen(&camera.clip_from_world(1.5), camera.position_m, usual(camera.position_m))
        };
        assert!(look(0.0, 0.0).is_some());
        assert_eq!(look(std::f32::consts::PI, 0.0), None);
        assert_eq!(look(0.0, 0.9), None);
    }
}
