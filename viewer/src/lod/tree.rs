//! What the LOD number λ in [0, k] of a tree is chosen by (thesis 4.3.2 and 4.3.3). The culling shader chooses it; its
//! reference in Rust stands in the test that compares them.
//!
//! The error allowed at distance d is αd, α = error_px / pixels a radian. An instance scaled by `scale` shows q·scale,
//! so λ is where q(λ) = αd/scale. By quality: log q is linear between the levels' errors. Simple: q(λ) = q̂·2^(λ/2),
//! hence λ = 2·log₂ d + β with β = 2·log₂(α/(scale·q̂)).

/// The most levels that a template may have.
pub const MAX_LEVELS: usize = 12;

/// In metres: what is nearer than this, or around the eye, is drawn as from here.
pub const MIN_DISTANCE_M: f32 = 0.01;

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
