//! Heights → the slope of the horizon towards one azimuth, for every sample: Timonen & Westerholm, "Scalable height
//! field self-shadowing" (2010). Slopes are rise over run (the tangent of the elevation), heights in metres.
//!
//! Lines parallel to the azimuth cross the grid, one per sample along the side they cross. Along each, from the far
//! end to the near, the upper convex hull of the points passed is kept on a stack; the tangent from a point to that
//! hull is its horizon, and a point below the tangent can never be a horizon again. So the whole field
//! takes time in proportion to its samples, however far shadows reach.

use rayon::prelude::*;

use crate::math::{cell, lerp};
use crate::model::Heightfield;
use crate::raster::square;

/// Horizon where all land ends: level.
const OPEN: f32 = 0.0;
/// The lowest slope: looking down a cliff.
const MIN: f32 = -4.0;

/// What stands around the field and how far to look, in metres from the field's border.
pub(super) struct Beyond<'a> {
    pub apron: &'a Heightfield,
    pub reach_m: f32,
}

/// Slope of the horizon at each sample towards (x, z), a unit vector in plan.
pub(super) fn slopes(field: &Heightfield, beyond: &Beyond, towards: [f32; 2]) -> Vec<f32> {
    let lines = Lines::new(field, towards);
    let side = field.side as usize;
    let mut swept = vec![OPEN; lines.count * side];
    swept.par_chunks_mut(side).enumerate().for_each_init(Vec::new, |hull, (line, slopes)| {
        hull.clear();
        lines.sweep(beyond, lines.first + line as i32, hull, slopes);
    });
    square(side, |i, j| {
        let (along, across) = if lines.along_x { (i, j) } else { (j, i) };
        // The sample lies between two lines.
        let at = across as f32 - lines.drift * along as f32 - lines.first as f32;
        let whole = at as usize;
        let near = swept[whole * side + along];
        let next = swept[(whole + 1).min(lines.count - 1) * side + along];
        lerp(near, next, at - whole as f32)
    })
}

/// A point of the hull: metres along the line, against the azimuth, and its height.
type Point = [f32; 2];

/// The family of lines. Line k passes column (or row) `along` at `across` = k + drift·along.
struct Lines<'a> {
    field: &'a Heightfield,
    towards: [f32; 2],
    along_x: bool,
    /// Whether the azimuth points to the greater end of `along`.
    ahead: bool,
    drift: f32,
    first: i32,
    count: usize,
    step_m: f32,
}

impl<'a> Lines<'a> {
    fn new(field: &'a Heightfield, towards: [f32; 2]) -> Self {
        let along_x = towards[0].abs() >= towards[1].abs();
        let (major, minor) = if along_x { (towards[0], towards[1]) } else { (towards[1], towards[0]) };
        let drift = minor / major;
        let last = (field.side - 1) as f32;
        let first = (-drift * last).min(0.0).floor() as i32;
        let final_line = (last - (drift * last).min(0.0)).ceil() as i32;
        Self {
            field,
            towards,
            along_x,
            ahead: major > 0.0,
            drift,
            first,
            count: (final_line - first + 1) as usize,
            step_m: field.spacing_m * (1.0 + drift * drift).sqrt(),
        }
    }

    fn sweep(&self, beyond: &Beyond, line: i32, hull: &mut Vec<Point>, slopes: &mut [f32]) {
        let side = self.field.side as usize;
        let across = |along: usize| line as f32 + self.drift * along as f32;
        // A line up to one sample outside still serves for interpolation.
        let within = |along: &usize| across(*along) > -1.0 && across(*along) < side as f32;
        let Some(low) = (0..side).find(within) else { return };
        let Some(high) = (0..side).rev().find(within) else { return };
        let (start, steps) = (if self.ahead { high } else { low }, high - low);
        self.look_beyond(beyond, start, across(start), hull);
        for step in 0..=steps {
            let along = if self.ahead { start - step } else { start + step };
            let point = [step as f32 * self.step_m, self.height_m(along, across(along))];
            slopes[along] = tangent(hull, point);
            hull.push(point);
        }
    }

    /// Puts the apron onto the hull, from afar to the field's border.
    fn look_beyond(&self, beyond: &Beyond, along: usize, across: f32, hull: &mut Vec<Point>) {
        let middle = 0.5 * (self.field.side - 1) as f32;
        let place = |at: f32| (at - middle) * self.field.spacing_m;
        let (along_m, across_m) = (place(along as f32), place(across));
        let [x, z] = if self.along_x { [along_m, across_m] } else { [across_m, along_m] };
        let edge_m = 0.5 * beyond.apron.extent_m();
        let step_m = beyond.apron.spacing_m;
        for step in (1..=(beyond.reach_m / step_m) as u32 + 1).rev() {
            let away_m = step as f32 * step_m;
            let (px, pz) = (x + self.towards[0] * away_m, z + self.towards[1] * away_m);
            if px.abs() <= edge_m && pz.abs() <= edge_m {
                let point = [-away_m, beyond.apron.height_m(px, pz)];
                tangent(hull, point);
                hull.push(point);
            }
        }
    }

    /// Height on a line, between two samples of a column (or row).
    #[inline]
    fn height_m(&self, along: usize, across: f32) -> f32 {
        let side = self.field.side as usize;
        let (whole, part) = cell(across.clamp(0.0, (side - 1) as f32), side);
        let index = if self.along_x { whole * side + along } else { along * side + whole };
        let next = if self.along_x { index + side } else { index + 1 };
        lerp(self.field.heights_m[index], self.field.heights_m[next], part)
    }
}

/// The slope from a point up (or down) to the hull; removes the points of the hull that it hides.
#[inline]
fn tangent(hull: &mut Vec<Point>, [at, height]: Point) -> f32 {
    while let [.., next, top] = hull.as_slice() {
        if (next[1] - height) * (at - top[0]) < (top[1] - height) * (at - next[0]) {
            break;
        }
        hull.pop();
    }
    hull.last().map_or(OPEN, |top| ((top[1] - height) / (at - top[0])).max(MIN))
}
