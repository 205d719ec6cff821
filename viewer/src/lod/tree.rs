//! A tree's distance → its LOD number λ in [0, k] (thesis 4.3.2 and 4.3.3). Metres, pixels. Written so that the culling
//! shader says the same line by line.
//!
//! The error allowed at distance d is αd, α = error_px / pixels a radian. An instance scaled by `scale` shows q·scale,
//! so λ is where q(λ) = αd/scale. By quality: log q is linear between the levels' errors. Simple: q(λ) = q̂·2^(λ/2),
//! hence λ = 2·log₂ d + β with β = 2·log₂(α/(scale·q̂)).

use crate::lod_mode::TreeLodMode;

/// The most levels that a template may have.
pub const MAX_LEVELS: usize = 12;

/// The least distance in metres that counts: what is nearer, or around the eye, is drawn from here.
pub const MIN_DISTANCE_M: f32 = 0.01;

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
#[inline]
pub fn distance_m(center_distance_m: f32, radius_m: f32) -> f32 {
    (center_distance_m - radius_m).max(MIN_DISTANCE_M)
}

/// λ of an instance at [`distance_m`]. `errors_m`: of D_0 … D_k, positive and increasing; `simple_error_m`: of
/// [`simple_error_m`]; `scale`: the largest singular value of the instance's linear part. 0 for what makes no sense.
#[inline]
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

/// λ → the number i of the mesh to draw and the weight α of D_{i+1} in it; α is 0 for the last level, k.
#[inline]
pub fn lod_split(lambda: f32, k: u32) -> (u32, f32) {
    let level = (lambda as u32).min(k);
    let alpha = if level == k { 0.0 } else { (lambda - level as f32).clamp(0.0, 1.0) };
    (level, alpha)
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

/// r⁻¹(log `allowed_m`), r(λ) = log q(λ).
#[inline]
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
#[inline]
fn by_count(levels: usize, simple_error_m: f32, allowed_m: f32) -> f32 {
    let k = levels.max(1) as f32 - 1.0;
    // Also false for what is not a number.
    if allowed_m > simple_error_m { (2.0 * libm::log2f(allowed_m / simple_error_m)).min(k) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    prop_compose! {
        fn errors()(first in 1e-4f32..0.1, ratios in prop::collection::vec(1.05f32..8.0, 0..MAX_LEVELS)) -> Vec<f32> {
            let mut errors = vec![first];
            for ratio in ratios {
                errors.push(errors[errors.len() - 1] * ratio);
            }
            errors
        }
    }

    fn control(mode: TreeLodMode, error_px: f32) -> Control {
        Control { mode, focal_px: 800.0, error_px }
    }

    fn mode() -> impl Strategy<Value = TreeLodMode> {
        prop::sample::select(vec![
            TreeLodMode::Quality,
            TreeLodMode::Simple,
            TreeLodMode::Discrete,
            TreeLodMode::Off,
        ])
    }

    proptest! {
        #[test]
        fn number_is_bounded_and_grows_with_distance(
            errors in errors(), mode in mode(), near in 0.0f32..2000., more in 0.0f32..500., scale in 0.2f32..4.
        ) {
            let control = control(mode, 1.0);
            let q = simple_error_m(&errors);
            let at = |distance| lod_number(&control, &errors, q, distance, scale);
            let k = errors.len() as f32 - 1.0;
            prop_assert!((0.0..=k).contains(&at(near)));
            prop_assert!(at(near + more) >= at(near) - 1e-4);
        }

        #[test]
        fn number_is_continuous_unless_discrete(
            errors in errors(), simple in any::<bool>(), distance in 0.1f32..2000., scale in 0.2f32..4.
        ) {
            let mode = if simple { TreeLodMode::Simple } else { TreeLodMode::Quality };
            let control = control(mode, 1.0);
            let q = simple_error_m(&errors);
            let at = |distance| lod_number(&control, &errors, q, distance, scale);
            // Steepest where neighbours differ least: log₂(1.0001) / log₂ 1.05.
            prop_assert!((at(distance * 1.0001) - at(distance)).abs() < 3e-3);
        }

        #[test]
        fn error_on_the_screen_is_kept_wherever_detail_is_left_out(
            errors in errors(), discrete in any::<bool>(), distance in 0.1f32..2000., scale in 0.2f32..4.,
            error_px in 0.1f32..8.
        ) {
            let mode = if discrete { TreeLodMode::Discrete } else { TreeLodMode::Quality };
            let control = control(mode, error_px);
            let lambda = lod_number(&control, &errors, 0.1, distance, scale);
            let (i, alpha) = lod_split(lambda, errors.len() as u32 - 1);
            let next = errors.get(i as usize + 1).copied().unwrap_or(1.0);
            let fine = errors[i as usize];
            let shown = fine * libm::powf(next / fine, alpha) * scale * control.focal_px / distance;
            prop_assert!(lambda == 0.0 || shown <= error_px * 1.001, "{lambda}: {shown} px");
        }

        #[test]
        fn split_adds_up(lambda in -1.0f32..14., k in 0u32..12) {
            let (i, alpha) = lod_split(lambda, k);
            prop_assert!(i <= k && (0.0..1.0).contains(&alpha));
            prop_assert!((i as f32 + alpha - lambda.clamp(0.0, k as f32)).abs() < 1e-6);
        }

        #[test]
        fn no_number_is_poison(
            errors in errors(), mode in mode(), pick in 0usize..6, other in 0usize..6, third in 0usize..6
        ) {
            let odd = [f32::NAN, f32::INFINITY, 0.0, -1.0, f32::NEG_INFINITY, 1.0];
            let control = Control { mode, focal_px: odd[third], error_px: 1.0 };
            let lambda = lod_number(&control, &errors, simple_error_m(&errors), odd[pick], odd[other]);
            prop_assert!(lambda >= 0.0 && lambda <= errors.len() as f32 - 1.0, "{lambda}");
        }
    }

    #[test]
    fn inside_the_crown_every_leaf_is_drawn() {
        for mode in [TreeLodMode::Quality, TreeLodMode::Simple, TreeLodMode::Discrete] {
            let distance = distance_m(3.0, 5.0);
            assert_eq!(lod_number(&control(mode, 1.0), &[0.001, 0.01, 0.1], 0.005, distance, 1.0), 0.0);
        }
    }

    #[test]
    fn simple_mode_asks_as_much_as_quality_if_errors_follow_counts() {
        let errors: Vec<f32> = (0..8).map(|i| 0.01 * libm::exp2f(0.5 * i as f32)).collect();
        let q = simple_error_m(&errors);
        for distance in [5.0, 20.0, 37.0, 60.0, 300.0] {
            let [a, b] = [TreeLodMode::Simple, TreeLodMode::Quality]
                .map(|mode| lod_number(&control(mode, 1.0), &errors, q, distance, 1.3));
            assert!((a - b).abs() < 1e-3, "{a} {b}");
        }
    }

    #[test]
    fn a_tree_without_levels_is_drawn_as_it_is() {
        assert_eq!(lod_number(&control(TreeLodMode::Simple, 1.0), &[], simple_error_m(&[]), 1e9, 1.0), 0.0);
        assert_eq!(lod_number(&control(TreeLodMode::Quality, 1.0), &[0.1], 0.1, 1e9, 1.0), 0.0);
    }
}
