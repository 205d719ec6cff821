//! Places with weights → groups of those that lie close together, of about the same weight.

use glam::Vec3;
use rayon::prelude::*;

/// Rounds in which places go to the nearest middle and middles move among their places.
const ROUNDS: usize = 3;

/// A place, and how many leaves it stands for.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    pub at_m: Vec3,
    pub weight: f32,
}

/// The group of each place: numbers below `count`, each of somebody where there are enough places. Halves of halves along
/// the longest side are the start of k-means (Lloyd, "Least squares quantization in PCM", 1982). The same for any number
/// of threads.
pub fn groups(places: &[Place], count: usize) -> Vec<u32> {
    let mut group = vec![0; places.len()];
    let mut order: Vec<u32> = (0..places.len() as u32).collect();
    split(&mut order, places, 0..count as u32, &mut group);
    for _ in 0..ROUNDS {
        let middles = Middles::of(&gathered(places, &group, count));
        group = places.par_iter().zip(&group).map(|(place, &own)| middles.nearest(place.at_m, own)).collect();
        share_out(places, &mut group, count);
    }
    group
}

/// The middles of groups, from west to east.
struct Middles {
    sorted: Vec<(Vec3, u32)>,
    /// The same by their numbers.
    numbered: Vec<Vec3>,
}

impl Middles {
    fn of(groups: &[Place]) -> Self {
        let numbered: Vec<Vec3> = groups.iter().map(|group| group.at_m).collect();
        let mut sorted: Vec<(Vec3, u32)> = numbered.iter().copied().zip(0..).collect();
        sorted.sort_unstable_by(|p, q| p.0.x.total_cmp(&q.0.x).then(p.1.cmp(&q.1)));
        Self { sorted, numbered }
    }

    /// The nearest, of equally near ones the first, found from one that is near: none can be nearer that lies farther to
    /// the west or east alone.
    fn nearest(&self, at_m: Vec3, near: u32) -> u32 {
        let mut best = (at_m.distance_squared(self.numbered[near as usize]), near);
        let aside = |middle: Vec3| (at_m.x - middle.x) * (at_m.x - middle.x);
        let first = self.sorted.partition_point(|(m, _)| m.x < at_m.x && aside(*m) > best.0);
        for &(middle, number) in &self.sorted[first..] {
            if middle.x > at_m.x && aside(middle) > best.0 {
                break;
            }
            let square = at_m.distance_squared(middle);
            if square < best.0 || square == best.0 && number < best.1 {
                best = (square, number);
            }
        }
        best.1
    }
}

/// Gives each group of nobody the place that is farthest from the middle of the largest.
fn share_out(places: &[Place], group: &mut [u32], count: usize) {
    let mut sizes = vec![0u32; count];
    group.iter().for_each(|&group| sizes[group as usize] += 1);
    let empties: Vec<usize> = (0..count).filter(|&n| sizes[n] == 0).collect();
    for empty in empties {
        let Some(largest) = (0..count).max_by_key(|&n| (sizes[n], n)).filter(|&n| sizes[n] > 1) else {
            return;
        };
        let members = || (0..places.len()).filter(|&i| group[i] as usize == largest);
        let middle = members().map(|i| places[i].at_m).sum::<Vec3>() / sizes[largest] as f32;
        let away = |i: &usize| places[*i].at_m.distance_squared(middle);
        if let Some(farthest) = members().max_by(|a, b| away(a).total_cmp(&away(b)).then(a.cmp(b))) {
            group[farthest] = empty as u32;
            sizes[largest] -= 1;
            sizes[empty] = 1;
        }
    }
}

/// The middle of each group, and what it weighs; that of nobody is far away.
pub fn gathered(places: &[Place], group: &[u32], count: usize) -> Vec<Place> {
    let mut sums = vec![(Vec3::ZERO, 0.0f32); count];
    for (place, &group) in places.iter().zip(group) {
        let (sum, weight) = &mut sums[group as usize];
        *sum += place.at_m * place.weight;
        *weight += place.weight;
    }
    let middle = |sum: Vec3, weight: f32| if weight > 0.0 { sum / weight } else { Vec3::MAX };
    sums.into_iter().map(|(sum, weight)| Place { at_m: middle(sum, weight), weight }).collect()
}

/// Gives the places these numbers, each to about as many.
fn split(order: &mut [u32], places: &[Place], numbers: std::ops::Range<u32>, group: &mut [u32]) {
    let count = numbers.len();
    if count <= 1 || order.len() <= 1 {
        order.iter().for_each(|&place| group[place as usize] = numbers.start);
        return;
    }
    let at = |place: u32| places[place as usize].at_m;
    let (low, high) =
        order.iter().fold((Vec3::MAX, Vec3::MIN), |(low, high), &p| (low.min(at(p)), high.max(at(p))));
    let axis = (high - low).max_position();
    let half = count / 2;
    let before = order.len() * half / count;
    if before > 0 {
        order.select_nth_unstable_by(before, |&p, &q| at(p)[axis].total_cmp(&at(q)[axis]).then(p.cmp(&q)));
    }
    let (lower, upper) = order.split_at_mut(before);
    let middle = numbers.start + half as u32;
    split(lower, places, numbers.start..middle, group);
    split(upper, places, middle..numbers.end, group);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heaps_that_lie_apart_are_groups() {
        let heaps = [Vec3::ZERO, Vec3::new(9.0, 0.0, 0.0), Vec3::new(0.0, 9.0, 4.0)];
        let places: Vec<Place> = (0..30u32)
            .map(|i| Place { at_m: heaps[i as usize % 3] + 0.1 * Vec3::splat((i / 3) as f32), weight: 1.0 })
            .collect();
        let group = groups(&places, 3);
        for i in 0..30 {
            assert_eq!(group[i], group[i % 3], "those of one heap are together");
        }
        assert!(group[0] != group[1] && group[1] != group[2] && group[2] != group[0]);
        let middle = gathered(&places, &group, 3)[group[1] as usize];
        assert_eq!(middle.weight, 10.0);
        assert!(middle.at_m.distance(heaps[1] + 0.45 * Vec3::ONE) < 1e-4);
    }

    #[test]
    fn the_nearest_is_found_from_any_and_of_equals_the_first() {
        // A grid of points, each there twice, so that many are equally near.
        let grid = (0..54).map(|i| Vec3::new((i % 3) as f32, (i / 3 % 3) as f32, (i / 9 % 3) as f32));
        let groups: Vec<Place> = grid.map(|at_m| Place { at_m, weight: 1.0 }).collect();
        let middles = Middles::of(&groups);
        for (at_m, near) in (0..40).map(|i| (0.1 * Vec3::new((i % 7) as f32, i as f32, 5.0), i)) {
            let square = |n: &u32| groups[*n as usize].at_m.distance_squared(at_m);
            let nearest = (0..54).min_by(|a, b| square(a).total_cmp(&square(b)).then(a.cmp(b)));
            assert_eq!(Some(middles.nearest(at_m, near)), nearest);
        }
    }

    #[test]
    fn there_may_be_more_groups_than_places_or_none_at_all() {
        let place = Place { at_m: Vec3::ONE, weight: 1.0 };
        assert_eq!(groups(&[place], 5).len(), 1);
        assert!(groups(&[place; 4], 3).iter().all(|&group| group < 3));
        assert!(groups(&[], 3).is_empty());
    }
}
