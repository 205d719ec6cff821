//! The elements of an aggregate → how their inner vertices go, for all elements alike: a bent card becomes a flat one,
//! whose picture hardly differs, and that a triangle, before whole cards go.
//!
//! Half-edge collapses that leave the element's outline in texture space as it is but for corners where the picture shows hardly
//! anything, as beside the tip and the stalk of a leaf. Their error is how far what the picture shows moves, in metres, on average
//! over the elements.

use glam::Vec2;

use super::element::{Merge, Pattern, by_error};
use super::fitting;
use super::log::Vertex;
use super::repair::repaired;
use super::state::{PartSpan, State};
use crate::model::{AlphaMask, Mesh};

/// Elements that errors are averaged over.
const SAMPLES: usize = 64;
/// Cards whose vertices lie this far out of a plane on average, in metres, are flat.
const FLAT_M: f64 = 1e-3;

/// What is done to all elements, to each when it is its turn ([`errors_m`]).
#[derive(Clone, Debug)]
pub struct Step {
    /// How far elements are from what they were once this and all steps before are done, in metres, on average.
    error_m: f64,
    pub change: Change,
}

#[derive(Clone, Debug)]
pub enum Change {
    Merge(Merge),
    /// A flat card becomes a triangle with these texture coordinates.
    Fit([Vec2; 3]),
}

/// The steps that flatten a part's elements, whose texture leaves so much of them opaque, in order.
pub fn plan(state: &State, span: &PartSpan, mask: &AlphaMask) -> Vec<Step> {
    let Some((count, per_element, _)) = span.elements().filter(|&(count, ..)| count > 0) else {
        return Vec::new();
    };
    let pattern = Pattern::new(state, span, one_in(count), mask);
    let mut element = pattern.whole();
    let mut steps: Vec<Step> = Vec::new();
    loop {
        // The first vertex stays: that it lives says that the element does.
        let merge = (1..per_element).filter_map(|v| element.best(v)).min_by(by_error);
        let fit = element.is_card().then(|| fitted_card(state, span, mask)).flatten();
        match (merge, fit) {
            (merge, Some((error_m, triangle))) if merge.as_ref().is_none_or(|(m, _)| error_m <= *m) => {
                steps.push(Step { error_m, change: Change::Fit(triangle) });
                return steps;
            }
            (Some((error_m, merge)), _) => {
                element.take(&merge);
                steps.push(Step { error_m, change: Change::Merge(merge) });
            }
            (None, _) => return steps,
        }
    }
}

/// Of how many elements, of that many, one is looked at.
fn one_in(count: u32) -> usize {
    (count as usize / SAMPLES).max(1)
}

/// The triangle for elements, and how far their vertices lie from it on average, in metres.
fn fitted_card(state: &State, span: &PartSpan, mask: &AlphaMask) -> Option<(f64, [Vec2; 3])> {
    let triangle = fitting::triangle(mask)?;
    let (count, ..) = span.elements()?;
    let errors_m = (0..count)
        .step_by(one_in(count))
        .map(|element| fitting::error_m(vertices(state, span, element)).map(f64::from));
    let errors_m = errors_m.collect::<Option<Vec<f64>>>()?;
    Some((errors_m.iter().sum::<f64>() / errors_m.len() as f64, triangle))
}

/// For each element of a part how far its own texels have moved, in metres, once it has taken each of the steps: rows by steps,
/// none less than the one before.
pub fn errors_m(state: &State, span: &PartSpan, steps: &[Step], mask: &AlphaMask) -> Vec<Vec<f64>> {
    let Some((count, ..)) = span.elements().filter(|&(count, ..)| count > 0) else {
        return Vec::new();
    };
    let pattern = Pattern::new(state, span, 1, mask);
    let mut element = pattern.whole();
    let mut worst_m = vec![0.0_f64; count as usize];
    let after = |step: &Step| {
        match &step.change {
            Change::Merge(merge) => {
                element.take(merge);
                for moved in element.moved_m() {
                    worst_m.iter_mut().zip(moved).for_each(|(worst, m)| *worst = worst.max(m));
                }
            }
            Change::Fit(_) => {
                for (worst, e) in worst_m.iter_mut().zip(0..) {
                    let error_m = fitting::error_m(vertices(state, span, e));
                    *worst = worst.max(error_m.map_or(f64::MAX, f64::from));
                }
            }
        }
        worst_m.clone()
    };
    steps.iter().map(after).collect()
}

/// All vertices that an element has at first.
fn vertices<'a>(state: &'a State, span: &PartSpan, element: u32) -> &'a [Vertex] {
    &state.vertices[span.element(element)[0].clone()]
}

/// The same mesh with triangles in the place of flat cards: it shows nearly the same, and is drawn in less time.
pub fn fitted(mesh: &Mesh, masks: &[AlphaMask]) -> Mesh {
    let mut state = State::new(&repaired(mesh.clone()));
    for (part, mask) in masks.iter().enumerate().take(state.parts.len()) {
        let span = state.parts[part].clone();
        let are_cards = matches!(span.elements(), Some((_, 4, 2)));
        if !are_cards {
            continue;
        }
        let [Step { error_m, change: Change::Fit(triangle) }] = plan(&state, &span, mask)[..] else {
            continue;
        };
        if error_m <= FLAT_M {
            let elements = span.elements().map_or(0, |(elements, ..)| elements);
            (0..elements).for_each(|element| fitting::fit(&mut state, &span, element, triangle));
        }
    }
    let unchanged: Vec<f32> =
        state.parts.iter().map(|span| f32::from(u8::from(span.elements().is_some()))).collect();
    state.to_mesh(&unchanged).0
}
