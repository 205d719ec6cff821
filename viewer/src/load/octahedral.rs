//! Unit vectors in two numbers of 16 bits (Meyer et al. 2010).

use glam::Vec3;

/// A direction in two signed numbers; straight up if it has no length.
pub(super) fn octahedral(direction: Vec3) -> [i16; 2] {
    let sum = direction.abs().element_sum();
    let n = if sum > 1e-12 { direction / sum } else { Vec3::Y };
    let fold = |a: f32, b: f32| (1.0 - b.abs()) * if a >= 0.0 { 1.0 } else { -1.0 };
    let (x, y) = if n.z >= 0.0 { (n.x, n.y) } else { (fold(n.x, n.y), fold(n.y, n.x)) };
    [x, y].map(|value| (value.clamp(-1.0, 1.0) * 32767.0).round() as i16)
}

/// The direction, of unit length, as the shaders decode it.
pub(super) fn direction([x, y]: [i16; 2]) -> Vec3 {
    let (x, y) = (f32::from(x) / 32767.0, f32::from(y) / 32767.0);
    let z = 1.0 - x.abs() - y.abs();
    let t = (-z).max(0.0);
    Vec3::new(x - t.copysign(x), y - t.copysign(y), z).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn octahedral_directions_come_back(x in -1f32..1., y in -1f32..1., z in -1f32..1.) {
            let sent = Vec3::new(x, y, z);
            prop_assume!(sent.length() > 1e-2);
            let back = direction(octahedral(sent));
            prop_assert!(back.dot(sent.normalize()) > 0.999_999);
        }
    }
}
