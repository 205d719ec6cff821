//! Leaves → rectangles through them, in which pictures of them lie.

use genescape_schema::scene::svd;
use glam::{DQuat, DVec3, Vec2, Vec3};

/// No side of a card is shorter than this, in metres, not even around nothing.
const MIN_SIDE_M: f32 = 1e-3;

/// A rectangle in space.
#[derive(Clone, Copy, Debug)]
pub struct Card {
    pub middle_m: Vec3,
    /// Unit vectors to its right and upper sides.
    pub axes: [Vec3; 2],
    /// Half of its width and height.
    pub half_m: Vec2,
}

impl Card {
    /// Two that cross in the direction in which the points extend most: one shows as much of them as any, the other stands
    /// upright on it. So something is seen from each side.
    pub fn crossed(points: &[Vec3]) -> [Self; 2] {
        let [first, second, third] = axes(points);
        [[first, second], [first, third]].map(|axes| Self::around(points, axes))
    }

    fn around(points: &[Vec3], axes: [Vec3; 2]) -> Self {
        let [right, up] = axes;
        let all = [right, up, right.cross(up)];
        let along = |p: &Vec3| Vec3::from_array(all.map(|axis| p.dot(axis)));
        let (low, high) =
            points.iter().map(along).fold((Vec3::MAX, Vec3::MIN), |(low, high), p| (low.min(p), high.max(p)));
        let middle = 0.5 * (low + high);
        let middle_m = all.iter().zip(middle.to_array()).map(|(axis, t)| *axis * t).sum();
        Self { middle_m, axes, half_m: (0.5 * (high - low)).truncate().max(Vec2::splat(0.5 * MIN_SIDE_M)) }
    }

    /// The same, larger.
    pub fn grown(self, factor: f32) -> Self {
        Self { half_m: self.half_m * factor, ..self }
    }

    /// The unit vector towards those who see it the right way round.
    pub fn front(&self) -> Vec3 {
        self.axes[0].cross(self.axes[1])
    }

    /// A normal on either side, turned to those who see the card the right way round: to its right, up, and towards them.
    pub fn toward_eye(&self, normal: Vec3) -> Vec3 {
        let [right, up] = self.axes;
        let turned = normal * 1.0_f32.copysign(normal.dot(self.front()));
        Vec3::new(turned.dot(right), turned.dot(up), turned.dot(self.front()))
    }

    /// Its corners, counter-clockwise from the lower left one.
    pub fn corners(&self) -> [Vec3; 4] {
        let [right, up] = self.axes;
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
            .map(|[x, y]| self.middle_m + right * (x * self.half_m.x) + up * (y * self.half_m.y))
    }
}

/// The principal axes of points, unit vectors: those along which they extend most first.
fn axes(points: &[Vec3]) -> [Vec3; 3] {
    let mean = points.iter().map(|p| p.as_dvec3()).sum::<DVec3>() / points.len().max(1) as f64;
    let mut columns = [[0.0; 3]; 3];
    for from_mean in points.iter().map(|p| p.as_dvec3() - mean) {
        for (column, axis) in columns.iter_mut().zip(from_mean.to_array()) {
            (0..3).for_each(|row| column[row] += axis * from_mean[row]);
        }
    }
    // Points in a plane have no extent across it, and no such matrix can be taken apart.
    let spread = 1e-6 * (columns[0][0] + columns[1][1] + columns[2][2]).max(1e-12);
    (0..3).for_each(|k| columns[k][k] += spread);
    let Some(split) = svd::decompose(columns) else { return [Vec3::X, Vec3::Y, Vec3::Z] };
    let turned = DQuat::from_array(split.left);
    let mut axes = [0, 1, 2].map(|k| (split.scale[k], (turned * DVec3::AXES[k]).as_vec3().normalize()));
    axes.sort_by(|a, b| b.0.total_cmp(&a.0));
    axes.map(|(_, axis)| axis)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cards_cross_along_the_longest_side_and_hold_all_points() {
        let turned = glam::Quat::from_euler(glam::EulerRot::YXZ, 0.4, 0.9, -0.3);
        let points: Vec<Vec3> = (0..60u32)
            .map(|i| {
                let [x, y, z] = [i % 5, i / 5 % 4, i / 20].map(|k| k as f32);
                Vec3::new(2.0, 1.0, 5.0) + turned * Vec3::new(3.0 * x, y, 0.4 * z)
            })
            .collect();
        for card in Card::crossed(&points) {
            let [right, up] = card.axes;
            assert!(right.dot(up).abs() < 1e-5);
            assert!(right.dot(turned * Vec3::X).abs() > 0.999, "along the longest side");
            assert!((card.half_m.x - 6.0).abs() < 1e-3, "{:?}", card.half_m);
            for point in &points {
                let from = *point - card.middle_m;
                assert!(from.dot(right).abs() <= card.half_m.x + 1e-4);
                assert!(from.dot(up).abs() <= card.half_m.y + 1e-4);
            }
        }
        let [flat, upright] = Card::crossed(&points);
        assert!(flat.half_m.y > upright.half_m.y && flat.axes[1].dot(upright.axes[1]).abs() < 1e-4);
    }

    #[test]
    fn one_point_or_none_has_cards() {
        for points in [&[][..], &[Vec3::ONE], &[Vec3::ONE; 3]] {
            for card in Card::crossed(points) {
                assert!(card.half_m.min_element() > 0.0 && card.half_m.is_finite());
            }
        }
    }
}
