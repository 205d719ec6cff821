//! What the LOD number λ in [0, k] of a tree, or of a shape of anyone's file, is chosen by (thesis 4.3.2 and 4.3.3). The
//! culling shader chooses it for trees, and a test compares the two.
//!
//! The error allowed at distance d is αd, α = error_px / pixels a radian. An instance scaled by `scale` shows q·scale,
//! so λ is where q(λ) = αd/scale. By quality: log q is linear between the levels' errors. Simple: q(λ) = q̂·2^(λ/2),
//! hence λ = 2·log₂ d + β with β = 2·log₂(α/(scale·q̂)).
//! Of trees, error_px is what is usual times their [`allowance`].

use crate::lod_mode::TreeLodMode;

/// Rows of the picture for which levels are chosen that change where they cover a part of it, whatever its size.
pub const COVERED_PX: f32 = 1080.0;

/// The most levels that a template may have.
pub const MAX_LEVELS: usize = 12;

/// In metres: what is nearer than this, or around the eye, is drawn as from here.
pub const MIN_DISTANCE_M: f32 = 0.01;

/// The least factor from the error of a level to that of the next.
const MIN_GROWTH: f32 = 1.05;

/// Errors of levels → those by which they are chosen, for levels are passed in their order: each is more than the one before.
/// In a file, clusters may have less than the leaves before them. Shown from there on, a field of oaks took as long to draw,
/// and FLIP from full trees was .0147 instead of .0135.
pub fn rising(errors_m: impl IntoIterator<Item = f32>) -> impl Iterator<Item = f32> {
    errors_m.into_iter().scan(0.0, |least_m, error_m| {
        let error_m = error_m.max(*least_m);
        *least_m = (MIN_GROWTH * error_m).min(f32::MAX);
        Some(error_m)
    })
}

/// q̂ in metres of the simple mode: such that q̂·2^(i/2) is, on geometric average over the levels, their error. Then
/// one `error_px` asks as much of both modes. The error of D_0, which is extrapolated, counts only if it is alone.
pub fn simple_error_m(errors_m: &[f32]) -> f32 {
    let first = usize::from(errors_m.len() > 1);
    let count = errors_m.len().saturating_sub(first);
    if count == 0 {
        return 1.0;
    }
    let logs = errors_m.iter().enumerate().skip(first).map(|(i, &q)| libm::log2f(q) - 0.5 * i as f32);
    libm::exp2f(logs.sum::<f32>() / count as f32)
}

/// Sines of the angles above or below from which on pictures are too steep to be of use, and are not used.
pub const STEEP: [f32; 2] = [0.6, 0.75];

/// The share of a tree that its picture shows, the rest being its mesh: none up to `error_m` of the picture, all from twice
/// that on; none from steeply above or below. `steepness`: sine of the angle between the way to the eye and the level.
pub fn pictured(control: &Control, error_m: f32, distance_m: f32, scale: f32, steepness: f32) -> f32 {
    let times = control.error_px / control.focal_px * distance_m / (scale * error_m);
    let steep = ((steepness - STEEP[0]) / (STEEP[1] - STEEP[0])).clamp(0.0, 1.0);
    let share = libm::log2f(times.max(1.0)).clamp(0.0, 1.0) * (1.0 - steep * steep * (3.0 - 2.0 * steep));
    match control.mode {
        TreeLodMode::Off => 0.0,
        TreeLodMode::Discrete => f32::from(u8::from(share >= 0.5)),
        _ => share,
    }
}

/// Pixels of the picture that a tree may fill before less than the usual error is allowed of it, and those from which on it is
/// least.
pub const SEEN_PX: [f32; 2] = [65.0, 150.0];

/// Metres that a tree is taken to be large at least, for the leaves of shrubs are as large as those of trees.
pub const SMALL_TREE_M: f32 = 15.0;

/// The part of the usual error that is allowed of a tree whose sphere has its middle `center_distance_m` away, (0, 1]: less, the
/// larger it is in the picture. A person looks closely at the few large trees, and hardly at any one of the many small ones.
pub fn allowance(focal_px: f32, center_distance_m: f32, radius_m: f32) -> f32 {
    let size_m = (2.0 * radius_m).max(SMALL_TREE_M);
    let size_px = focal_px * size_m / center_distance_m.max(MIN_DISTANCE_M);
    SEEN_PX[0] / size_px.clamp(SEEN_PX[0], SEEN_PX[1])
}

/// What one frame asks of all trees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control {
    /// How levels are chosen.
    pub mode: TreeLodMode,
    /// Pixels a radian in the middle of the picture, ½·height/tan(½·fov).
    pub focal_px: f32,
    /// Error allowed on the screen.
    pub error_px: f32,
}

/// Distance in metres from the eye to the sphere around a tree; [`MIN_DISTANCE_M`] inside it. `center_distance_m`:
/// to the sphere's centre.
pub fn distance_m(center_distance_m: f32, radius_m: f32) -> f32 {
    (center_distance_m - radius_m).max(MIN_DISTANCE_M)
}

/// λ of an instance at [`distance_m`]. `errors_m`: of D_0 … D_k, positive and increasing; `simple_error_m`: of
/// [`simple_error_m`]; `scale`: the largest singular value of the instance's linear part. 0 for what makes no sense.
pub fn lod_number(
    control: &Control,
    errors_m: &[f32],
    simple_error_m: f32,
    distance_m: f32,
    scale: f32,
) -> f32 {
    let allowed_m = control.error_px / control.focal_px * distance_m / scale;
    match control.mode {
        TreeLodMode::Quality => by_quality(errors_m, allowed_m),
        TreeLodMode::Simple => by_count(errors_m.len(), simple_error_m, allowed_m),
        TreeLodMode::Discrete => by_quality(errors_m, allowed_m).floor(),
        TreeLodMode::Off => 0.0,
    }
}

/// r⁻¹(log `allowed_m`), r(λ) = log q(λ).
fn by_quality(errors_m: &[f32], allowed_m: f32) -> f32 {
    let mut lambda = 0.0;
    for i in 1..errors_m.len() {
        let (fine_m, coarse_m) = (errors_m[i - 1], errors_m[i]);
        if allowed_m >= coarse_m {
            lambda = i as f32;
        } else {
            if allowed_m > fine_m {
                let part = libm::log2f(allowed_m / fine_m) / libm::log2f(coarse_m / fine_m);
                lambda += part.clamp(0.0, 1.0);
            }
            break;
        }
    }
    lambda
}

/// 2·log₂ d + β.
fn by_count(levels: usize, simple_error_m: f32, allowed_m: f32) -> f32 {
    let k = levels.max(1) as f32 - 1.0;
    // Also false for what is not a number.
    if allowed_m > simple_error_m { (2.0 * libm::log2f(allowed_m / simple_error_m)).min(k) } else { 0.0 }
}
