//! Hue of a leaf → its colour, for trees and for the young ones under them.

use glam::Vec3;

/// Albedo of a leaf by hue: green is dark, yellow is bright, orange and red between. Linear RGB.
pub fn leaf_color(hue_deg: f32) -> Vec3 {
    // Hue; albedo as in spectra of green, senescent and red leaves.
    const STOPS: [(f32, Vec3); 7] = [
        (15.0, Vec3::new(0.36, 0.045, 0.016)),
        (30.0, Vec3::new(0.46, 0.125, 0.018)),
        (48.0, Vec3::new(0.52, 0.32, 0.030)),
        (66.0, Vec3::new(0.30, 0.31, 0.042)),
        (90.0, Vec3::new(0.150, 0.245, 0.050)),
        (115.0, Vec3::new(0.090, 0.158, 0.063)),
        (150.0, Vec3::new(0.070, 0.118, 0.084)),
    ];
    let hue = hue_deg.clamp(15.0, 150.0);
    let above = STOPS.iter().position(|stop| stop.0 >= hue).unwrap_or(6).max(1);
    let (a, b) = (STOPS[above - 1], STOPS[above]);
    a.1.lerp(b.1, (hue - a.0) / (b.0 - a.0))
}
