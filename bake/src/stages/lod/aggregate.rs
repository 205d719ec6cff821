//! Leaf cards and other aggregates → the order in which elements are removed, its cost in metres, and how much the rest
//! grow.
//!
//! Cook, Halstead, Planck, Ryu, "Stochastic simplification of aggregate detail" (2007). The order is stratified:
//! elements are paired with their neighbours in a k-d tree, one of each pair is removed, pairs taken in a sequence that
//! is spread over the whole; then the survivors pair up again. So no hole opens. Of a pair the one nearer the middle of
//! the crown is removed, for the outer one carries the silhouette.

use glam::Vec3;

use super::coverage::Silhouettes;
use super::log::Vertex;
use super::state::{PartSpan, State};

/// No part keeps fewer elements than this.
const MIN_ELEMENTS: usize = 6;
/// An element may grow to this part of the extent of all.
const MAX_GROWN: f32 = 0.3;

/// One aggregate part.
pub struct Aggregate {
    /// Index of the part in the mesh.
    pub part: usize,
    /// Elements in the order in which they are removed, without those that always stay.
    order: Vec<u32>,
    removed: usize,
    /// Error in metres per unit of growth.
    weight_m: f64,
    max_scale: f32,
    silhouettes: Silhouettes,
    lives: Vec<bool>,
    /// Scale and number of elements when last calibrated.
    last: (f32, usize),
}

impl Aggregate {
    /// Plans the removal of a part's elements; `None` for surfaces and for empty parts.
    pub fn new(state: &State, part: usize, weight: f32, fill: f32) -> Option<Self> {
        let span = &state.parts[part];
        let places = places(state, span)?;
        let count = places.len();
        let radius = places.iter().map(|place| f64::from(place.radius)).sum::<f64>() / count as f64;
        let (low, high) = places.iter().fold((Vec3::MAX, Vec3::MIN), |(low, high), place| {
            (low.min(place.centre - place.radius), high.max(place.centre + place.radius))
        });
        let extent = (high - low).max_element();
        let centres: Vec<Vec3> = places.iter().map(|place| place.centre).collect();
        Some(Self {
            part,
            order: removal_order(&places, (low + high) * 0.5),
            removed: 0,
            weight_m: f64::from(weight) * radius,
            max_scale: (MAX_GROWN * extent / radius as f32).max(1.0),
            silhouettes: Silhouettes::new(state, span, &centres, [low, high], fill),
            lives: vec![true; count],
            last: (1.0, count),
        })
    }

    pub fn living(&self) -> usize {
        self.lives.len() - self.removed
    }

    /// The error in metres once the next element is removed: by how much elements will have grown to keep the area.
    pub fn next_cost_m(&self) -> Option<f64> {
        (self.removed < self.order.len()).then(|| {
            let ratio = self.lives.len() as f64 / (self.living() - 1) as f64;
            self.weight_m * (ratio.sqrt() - 1.0)
        })
    }

    /// Removes the next element.
    pub fn take_next(&mut self) -> Option<u32> {
        let element = *self.order.get(self.removed)?;
        self.removed += 1;
        self.lives[element as usize] = false;
        Some(element)
    }

    /// How much larger the living elements must be so that they cover as much as all did, seen from the sides.
    pub fn calibrated_scale(&mut self) -> f32 {
        let (last, before) = self.last;
        let now = self.living();
        if now == before {
            return last;
        }
        let target = self.silhouettes.full as f32;
        let same_area = last * (before as f32 / now as f32).sqrt();
        let max = (1.25 * same_area).min(self.max_scale).max(last);
        let cover = |scale: f32| self.silhouettes.covered(&self.lives, scale) as f32;
        let mut near = (same_area.min(max), 0.0);
        near.1 = cover(near.0);
        let mut best = near;
        for step in 0..3 {
            let slope = if step == 0 { 1.3 * near.1 / near.0 } else { (best.1 - near.1) / (best.0 - near.0) };
            let slope = if slope.is_finite() && slope > 0.0 { slope } else { near.1 / near.0 };
            let wanted = (best.0 + (target - best.1) / slope.max(1e-3)).clamp(last, max);
            if (best.1 - target).abs() <= 0.004 * target || wanted == best.0 {
                break;
            }
            (near, best) = (best, (wanted, cover(wanted)));
        }
        self.last = (best.0, now);
        best.0
    }
}

struct Place {
    centre: Vec3,
    /// Root mean square distance of its vertices from the centre, in metres.
    radius: f32,
}

fn places(state: &State, span: &PartSpan) -> Option<Vec<Place>> {
    let (count, per, _) = span.elements()?;
    let place = |element: u32| {
        let [ids, _] = span.element(element);
        let centre = state.centre(ids.clone());
        let square = |v: &Vertex| Vec3::from_array(v.position).distance_squared(centre);
        let sum: f32 = state.vertices[ids].iter().map(square).sum();
        Place { centre, radius: (sum / per as f32).sqrt() }
    };
    let places: Vec<_> = (0..count).map(place).collect();
    let sound = places.iter().all(|p| p.centre.is_finite() && p.radius.is_finite());
    (sound && places.iter().any(|p| p.radius > 0.0)).then_some(places)
}

/// Elements in the order in which they are removed; the last few never are.
fn removal_order(places: &[Place], middle: Vec3) -> Vec<u32> {
    let mut living: Vec<u32> = (0..places.len() as u32).collect();
    neighbours_together(&mut living, places);
    let mut order = Vec::with_capacity(places.len());
    let worth = |e: u32| {
        let place = &places[e as usize];
        place.centre.distance(middle) + place.radius
    };
    while living.len() >= 2 * MIN_ELEMENTS {
        let mut leaving: Vec<(u32, u32)> = Vec::with_capacity(living.len() / 2);
        let (pairs, odd) = living.as_chunks::<2>();
        let mut staying = Vec::with_capacity(living.len().div_ceil(2));
        for (index, &[p, q]) in pairs.iter().enumerate() {
            let (goes, stays) = if worth(p) <= worth(q) { (p, q) } else { (q, p) };
            staying.push(stays);
            // Multiples of the golden ratio spread the pairs evenly at every length of the sequence.
            leaving.push(((index as u32).wrapping_mul(0x9E37_79B9), goes));
        }
        staying.extend_from_slice(odd);
        leaving.sort_unstable();
        order.extend(leaving.into_iter().map(|(_, element)| element));
        living = staying;
    }
    order
}

/// Sorts so that consecutive pairs, fours, eights … lie close together: halves along the longest side, again and
/// again, at powers of two.
fn neighbours_together(elements: &mut [u32], places: &[Place]) {
    if elements.len() <= 2 {
        return;
    }
    let at = |e: u32| places[e as usize].centre;
    let (low, high) =
        elements.iter().fold((Vec3::MAX, Vec3::MIN), |(low, high), &e| (low.min(at(e)), high.max(at(e))));
    let axis = (high - low).max_position();
    let half = elements.len().next_power_of_two() / 2;
    elements.select_nth_unstable_by(half, |&p, &q| at(p)[axis].total_cmp(&at(q)[axis]).then(p.cmp(&q)));
    let (lower, upper) = elements.split_at_mut(half);
    neighbours_together(lower, places);
    neighbours_together(upper, places);
}
