//! Leaf cards and other aggregates → the order in which elements are flattened and removed, and its cost in metres.
//!
//! Cook, Halstead, Planck, Ryu, "Stochastic simplification of aggregate detail" (2007). The order is stratified:
//! elements are paired with their neighbours in a k-d tree, one of each pair is removed, pairs taken in a sequence that
//! is spread over the whole; then the survivors pair up again. So no hole opens. Which of a pair is removed is left to
//! chance, lest the crown become a shell; but where elements are few, the outer one stays, which carries the silhouette.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::Vec3;

use super::flattening::{self, Change, Step};
use super::state::{PartSpan, State};
use crate::model::AlphaMask;

/// No part keeps fewer elements than this.
const MIN_ELEMENTS: usize = 6;
/// An element may grow to this part of the extent of all.
const MAX_GROWN: f32 = 0.3;
/// Flattening that moves texels by at most this part of an element's radius comes before any element goes.
const SLIGHT: f64 = 0.25;
/// Aggregates of fewer elements keep the outer ones.
const MIN_RANDOM: usize = 200;

/// One aggregate part.
pub struct Aggregate {
    /// Index of the part in the mesh.
    pub part: usize,
    /// How elements are flattened: all by the same steps, each when it is its turn.
    steps: Vec<Step>,
    /// The next step of each element that is not gone, the least error first.
    turns: BinaryHeap<Reverse<Turn>>,
    /// By steps and elements, in metres.
    step_errors_m: Vec<Vec<f64>>,
    /// Elements in the order in which they are removed, then those that always stay.
    order: Vec<u32>,
    removable: usize,
    removed: usize,
    /// Error in metres of removing all of them.
    weight_m: f64,
    /// Mean radius of an element.
    radius_m: f64,
    max_scale: f32,
}

/// An element's next step: its error in metres, as bits, which are ordered as the numbers are; where the element comes in the order
/// of removal; the step.
type Turn = (u64, u32, u32);

/// What an aggregate loses next.
pub enum Loss {
    /// A vertex of an element.
    Vertex { element: u32, change: Change },
    /// An element.
    Element(u32),
}

impl Aggregate {
    /// Plans how a part's elements lose vertices and go; `None` for surfaces and for empty parts.
    pub fn new(state: &State, part: usize, weight: f32, mask: &AlphaMask) -> Option<Self> {
        let span = &state.parts[part];
        let places = places(state, span)?;
        let count = places.len();
        let radius_m = places.iter().map(|place| f64::from(place.radius)).sum::<f64>() / count as f64;
        let (low, high) = places.iter().fold((Vec3::MAX, Vec3::MIN), |(low, high), place| {
            (low.min(place.centre - place.radius), high.max(place.centre + place.radius))
        });
        let extent = (high - low).max_element();
        let (order, removable) = removal_order(&places, (low + high) * 0.5);
        let steps = if state.attributes.uvs { flattening::plan(state, span, mask) } else { Vec::new() };
        let mut aggregate = Self {
            part,
            step_errors_m: flattening::errors_m(state, span, &steps, mask),
            steps,
            turns: BinaryHeap::with_capacity(count),
            order,
            removable,
            removed: 0,
            weight_m: f64::from(weight) * radius_m,
            radius_m,
            max_scale: (MAX_GROWN * extent / radius_m as f32).max(1.0),
        };
        (0..count as u32).for_each(|rank| aggregate.queue(rank, 0));
        Some(aggregate)
    }

    /// Queues a step of the element that comes there in the order of removal, if there is such a step.
    fn queue(&mut self, rank: u32, step: u32) {
        if let Some(errors_m) = self.step_errors_m.get(step as usize) {
            let error_m = errors_m[self.order[rank as usize] as usize];
            self.turns.push(Reverse((error_m.to_bits(), rank, step)));
        }
    }

    pub fn living(&self) -> usize {
        self.order.len() - self.removed
    }

    /// The error in metres of the next loss.
    pub fn next_cost_m(&self) -> Option<f64> {
        self.next().map(|(_, cost_m)| cost_m)
    }

    /// Takes the next loss.
    pub fn take_next(&mut self) -> Option<Loss> {
        let (flattens, _) = self.next()?;
        if !flattens {
            let element = self.order[self.removed];
            self.removed += 1;
            self.skip_gone();
            return Some(Loss::Element(element));
        }
        let Reverse((_, rank, step)) = self.turns.pop()?;
        let element = self.order[rank as usize];
        self.queue(rank, step + 1);
        self.skip_gone();
        Some(Loss::Vertex { element, change: self.steps[step as usize].change.clone() })
    }

    /// One that is gone need not be flattened.
    fn skip_gone(&mut self) {
        while self.turns.peek().is_some_and(|&Reverse((_, rank, _))| (rank as usize) < self.removed) {
            self.turns.pop();
        }
    }

    /// Whether the next loss flattens, and its cost in metres. Elements are flattened before any goes as long as their
    /// picture hardly changes.
    fn next(&self) -> Option<(bool, f64)> {
        let moved_m = self.turns.peek().map(|&Reverse((error_m, ..))| f64::from_bits(error_m));
        let remove = (self.removed < self.removable).then(|| {
            let gone = (self.removed + 1) as f64 / self.order.len() as f64;
            (false, self.weight_m * removal_cost(gone))
        });
        let flatten = moved_m.map(|moved_m| (true, self.radius_m * flattening_cost(moved_m / self.radius_m)));
        let is_slight = moved_m.is_some_and(|moved_m| moved_m <= SLIGHT * self.radius_m);
        match (flatten, remove) {
            (Some(flatten), Some(remove)) if !is_slight && remove.1 < flatten.1 => Some(remove),
            (flatten, remove) => flatten.or(remove),
        }
    }

    /// The scale at which the living elements have the area that all had.
    pub fn same_area_scale(&self) -> f32 {
        (self.order.len() as f32 / self.living() as f32).sqrt()
    }

    /// How large the living elements may become; at least `now`.
    pub fn max_scale(&self, now: f32) -> f32 {
        (1.6 * self.same_area_scale()).min(self.max_scale).max(now)
    }
}

/// What it costs that a part of all elements has gone, when 1 is that of all: much at first, then hardly more. In fine levels it is
/// bark that is missed least, which leaves hide; in coarse ones, of leaves that are few and large already, boughs are missed
/// more. Of costs that rise in proportion, none keeps both: FLIP of the outlines of twelve trees at D_1 was .044 in the mean, and
/// is .037 by this and [`flattening_cost`], .083 and .080 at D_2, the same from D_3 on.
fn removal_cost(gone: f64) -> f64 {
    (7.2 * gone).min(0.9 + 0.1 * gone)
}

/// The same of elements whose texels have moved by a part of their radius: the first bends that go cost most beside how far they
/// move, and where all elements bend, the last cost less than a trunk does.
fn flattening_cost(moved: f64) -> f64 {
    (1.6 * moved).min(0.05).max(0.4 * moved)
}

struct Place {
    centre: Vec3,
    /// Root mean square distance of its vertices from the centre, in metres.
    radius: f32,
}

fn places(state: &State, span: &PartSpan) -> Option<Vec<Place>> {
    let (count, ..) = span.elements()?;
    let place = |element: u32| {
        let [ids, _] = span.element(element);
        Place { centre: state.centre(ids.clone()), radius: state.radius_m(ids) }
    };
    let places: Vec<_> = (0..count).map(place).collect();
    let sound = places.iter().all(|p| p.centre.is_finite() && p.radius.is_finite());
    (sound && places.iter().any(|p| p.radius > 0.0)).then_some(places)
}

/// Elements in the order in which they are removed, and how many are: the last few never.
fn removal_order(places: &[Place], middle: Vec3) -> (Vec<u32>, usize) {
    let mut living: Vec<u32> = (0..places.len() as u32).collect();
    neighbours_together(&mut living, places);
    let mut order = Vec::with_capacity(places.len());
    let random = places.len() >= MIN_RANDOM;
    let worth = |e: u32| {
        let place = &places[e as usize];
        if random { hash(e) as f32 } else { place.centre.distance(middle) + place.radius }
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
    let removable = order.len();
    order.extend(living);
    (order, removable)
}

/// The finaliser of MurmurHash3.
fn hash(mut x: u32) -> u32 {
    x = (x ^ x >> 16).wrapping_mul(0x85EB_CA6B);
    x = (x ^ x >> 13).wrapping_mul(0xC2B2_AE35);
    x ^ x >> 16
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
