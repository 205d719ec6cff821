//! The sun's direction and size → how much of its disc the land leaves visible (0–1) and how it strikes the ground.

use glam::Vec3;
use rayon::prelude::*;

use super::horizon::{Beyond, slopes};
use crate::math::interpolate;
use crate::model::{Landform, SkyLight};
use crate::raster::square;

/// The smallest sine of the sun's angular radius, so that a point-like sun still has a defined edge (0.05°).
const MIN_RADIUS: f32 = 0.000_87;
/// Entries of the table of the disc's visible part.
const DISC_STEPS: usize = 512;

/// The sun as the stage uses it.
pub(super) struct Sun {
    /// Unit vector towards it.
    pub direction: Vec3,
    /// Unit vector towards it in plan (x, z).
    pub towards: [f32; 2],
    /// Sine and cosine of its elevation.
    pub sin_elevation: f32,
    pub cos_elevation: f32,
    /// Sine of half its angular diameter.
    pub sin_radius: f32,
    /// The part of its disc above a flat horizon.
    open: f32,
    disc: Disc,
}

impl Sun {
    pub fn of(light: &SkyLight) -> Self {
        let direction = light.sun_direction.normalize_or(Vec3::Y);
        let level = (direction.x * direction.x + direction.z * direction.z).sqrt();
        let towards = if level > 1.0e-6 { [direction.x / level, direction.z / level] } else { [1.0, 0.0] };
        let sin_radius = libm::sinf(light.sun_angular_radius_rad.clamp(0.0, 0.5)).max(MIN_RADIUS);
        let disc = Disc::new();
        let open = disc.above(direction.y / sin_radius);
        Self { direction, towards, sin_elevation: direction.y, cos_elevation: level, sin_radius, open, disc }
    }

    /// Whether its middle is above a level horizon.
    pub fn is_up(&self) -> bool {
        self.sin_elevation > 0.0
    }

    /// Visible part of the disc, relative to open level ground. `margin`: how far the disc's middle stands above
    /// the horizon, in radii; `edge`: how much that changes over a texel, so that no edge is sharper than one.
    #[inline]
    pub fn visibility(&self, margin: f32, edge: f32) -> f32 {
        let edge = edge.max(1.0);
        if margin <= -edge || !self.is_up() {
            0.0
        } else if margin >= edge {
            1.0
        } else {
            (self.disc.above(margin / edge) / self.open).min(1.0)
        }
    }
}

/// The part of a disc above a straight line: the analytic segment, as a table with linear interpolation (off by
/// less than 1/4000).
pub(super) struct Disc(Vec<f32>);

impl Disc {
    pub fn new() -> Self {
        let entry = |step: usize| {
            let d = 2.0 * step as f32 / DISC_STEPS as f32 - 1.0;
            0.5 + (libm::asinf(d) + d * (1.0 - d * d).sqrt()) / std::f32::consts::PI
        };
        Self((0..=DISC_STEPS).map(entry).collect())
    }

    /// The part above a line that passes `distance` radii below the middle: ½ + (asin d + d·√(1−d²))/π.
    #[inline]
    pub fn above(&self, distance: f32) -> f32 {
        interpolate(&self.0, (distance.clamp(-1.0, 1.0) + 1.0) * (0.5 * DISC_STEPS as f32))
    }
}

/// The sun at every sample of the field: how far the disc's middle stands above the land, in radii; a third of how
/// much that changes across the sample's neighbours; n·l, negative where the ground is turned away; and 0.
pub(super) fn on_land(sun: &Sun, land: &Landform) -> Vec<[f32; 4]> {
    let field = &land.field;
    let side = field.side as usize;
    let [lowest, _] = field.range_m();
    let [_, highest] = land.apron.range_m();
    // Beyond this, even the highest hill stands below the sun's lower limb seen from the lowest place.
    let tan_limb = (sun.sin_elevation - sun.sin_radius).max(0.02) / sun.cos_elevation.max(1.0e-3);
    let beyond = Beyond { apron: &land.apron, reach_m: ((highest - lowest) / tan_limb).min(8000.0) };
    let mut margin = slopes(field, &beyond, sun.towards);
    margin.par_iter_mut().for_each(|slope| {
        // The sine of the angle between disc and horizon; as good as the angle itself where the disc is cut.
        let above = (sun.sin_elevation - sun.cos_elevation * *slope) / (1.0 + *slope * *slope).sqrt();
        *slope = above / sun.sin_radius;
    });
    square(side, |i, j| {
        let (north, south) = (j.saturating_sub(1) * side, (j + 1).min(side - 1) * side);
        let (west, east) = (i.saturating_sub(1), (i + 1).min(side - 1));
        let dx = margin[j * side + east] - margin[j * side + west];
        let dz = margin[south + i] - margin[north + i];
        let edge = 0.35 * (dx * dx + dz * dz).sqrt();
        let cosine = field.normal_at(i as u32, j as u32).dot(sun.direction);
        [margin[j * side + i], edge, cosine, 0.0]
    })
}
