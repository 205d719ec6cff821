//! What is left of a mesh → how much larger its elements and how much thicker its twigs must be to cover as many pixels
//! as the whole mesh does (Cook et al. 2007, "contrast and area are preserved").

use glam::Vec3;

use super::LodOptions;
use super::aggregate::Aggregate;
use super::coverage::{Camera, Canvas, Detail, Elements, Surfaces};
use super::state::State;
use crate::math::{is_close, matching, matching_with};
use crate::model::AlphaMask;

/// So many leaves are many; a palm has fewer.
const MANY: usize = 1000;
/// Twigs may grow by this part of the mesh's diagonal.
const MAX_OFFSET: f32 = 0.0025;
/// Elements may shrink to this part of their scale: flat ones cover more than bent ones.
const MIN_SHRUNK: f32 = 0.7;

/// Sizes at which the mesh covers as much as it did.
#[derive(Clone, Debug)]
pub struct Sizes {
    /// For each aggregate, the scale of its elements.
    pub scales: Vec<f32>,
    /// How far surfaces grow along their normals, in metres.
    pub offset_m: f32,
}

/// Keeps coverage from level to level.
pub struct Calibration {
    camera: Camera,
    masks: Vec<AlphaMask>,
    /// Pixels that each aggregate covers when whole, and all parts together.
    full_elements: Vec<u32>,
    full: u32,
    max_offset_m: f32,
    /// At how many more levels elements are counted.
    counted: u32,
    last: Sizes,
    /// For each aggregate what was found at the last two levels, the latest first.
    found: Vec<[Found; 2]>,
}

/// A scale at which elements cover what they did, beside one that gives them their whole area.
#[derive(Clone, Copy, Debug)]
struct Found {
    living: f32,
    /// The one over the other.
    ratio: f32,
}

impl Found {
    /// The ratio for fewer elements: a power of their number, for they come to hide each other less.
    fn next(&[last, before]: &[Self; 2], living: f32) -> f32 {
        let power = libm::logf(last.ratio / before.ratio) / libm::logf(last.living / before.living);
        let power = if power.is_finite() { power.clamp(-1.0, 1.0) } else { 0.0 };
        last.ratio * libm::powf(living / last.living, power)
    }
}

impl Calibration {
    /// Measures the whole mesh, which lies in a box.
    pub fn new(
        state: &State,
        aggregates: &[Aggregate],
        [low, high]: [Vec3; 2],
        options: &LodOptions,
    ) -> Self {
        let thickens = options.thickens;
        let elements: usize = aggregates.iter().map(Aggregate::living).sum();
        let are_thin = options.masks.iter().any(AlphaMask::is_of_lines);
        let of_leaves = if elements >= MANY { Detail::Many } else { Detail::Few };
        let detail = if are_thin { Detail::Thin } else { of_leaves };
        let diagonal_m = (high - low).max(Vec3::ZERO).length();
        let mut calibration = Self {
            camera: Camera::of([low, high], detail),
            masks: options.masks.clone(),
            full_elements: Vec::new(),
            full: 0,
            max_offset_m: if thickens { MAX_OFFSET * diagonal_m } else { 0.0 },
            counted: options.counted_levels,
            last: Sizes { scales: vec![1.0; aggregates.len()], offset_m: 0.0 },
            found: aggregates
                .iter()
                .map(|all| [Found { living: all.living() as f32, ratio: 1.0 }; 2])
                .collect(),
        };
        let mut all = Canvas::empty(&calibration.camera);
        for elements in calibration.elements(state, aggregates) {
            let canvas = elements.canvas(&calibration.camera, 1.0);
            calibration.full_elements.push(canvas.covered());
            all.add(&canvas);
        }
        if thickens {
            Surfaces::new(state, &calibration.camera).draw(0.0, &mut all);
            calibration.full = all.covered();
        }
        calibration
    }

    /// First each aggregate covers what it did; then the surfaces make up for the rest as far as they may, then all
    /// elements.
    pub fn sizes(&mut self, state: &State, aggregates: &[Aggregate]) -> Sizes {
        let mut sizes = self.last.clone();
        let counts = self.counted > 0;
        self.counted = self.counted.saturating_sub(1);
        let elements = self.elements(state, aggregates);
        let mut all = Canvas::empty(&self.camera);
        for (index, (elements, aggregate)) in elements.iter().zip(aggregates).enumerate() {
            let scale = sizes.scales[index];
            let range = MIN_SHRUNK * scale..aggregate.max_scale(scale);
            let living = aggregate.living() as f32;
            let guess = aggregate.same_area_scale() * Found::next(&self.found[index], living);
            let count = |scale: f32| {
                let canvas = elements.canvas(&self.camera, scale);
                (canvas.covered(), canvas)
            };
            let (scale, canvas) = if counts {
                matching_with(self.full_elements[index], range, guess, count)
            } else {
                let scale = guess.clamp(range.start, range.end);
                (scale, elements.canvas(&self.camera, scale))
            };
            all.add(&canvas);
            sizes.scales[index] = scale;
            let found = Found { living, ratio: scale / aggregate.same_area_scale() };
            self.found[index] = [found, self.found[index][0]];
        }
        if self.max_offset_m > 0.0 {
            let range = 0.0..self.max_offset_m;
            let guess = sizes.offset_m + 0.1 * self.max_offset_m;
            let surfaces = Surfaces::new(state, &self.camera);
            let count = |offset_m: f32| {
                let mut canvas = all.clone();
                surfaces.draw(offset_m, &mut canvas);
                let covered = canvas.covered();
                (covered, covered)
            };
            let covered;
            (sizes.offset_m, covered) = matching_with(self.full, range, guess, count);
            if counts && covered < self.full && !is_close(covered, self.full) {
                self.make_up_with_elements(aggregates, &elements, &surfaces, covered, &mut sizes);
            }
        }
        self.last = sizes.clone();
        sizes
    }

    /// Where branches that went were seen between the leaves and those that stay may not grow by enough, so that only so much
    /// is covered, all elements grow until the whole covers what it did.
    fn make_up_with_elements(
        &self,
        aggregates: &[Aggregate],
        elements: &[Elements],
        surfaces: &Surfaces,
        covered: u32,
        sizes: &mut Sizes,
    ) {
        let mut bark = Canvas::empty(&self.camera);
        surfaces.draw(sizes.offset_m, &mut bark);
        let count = |growth: f32| {
            let mut canvas = bark.clone();
            let parts = elements.iter().zip(&sizes.scales);
            parts.for_each(|(part, scale)| part.draw(growth * scale, &mut canvas));
            canvas.covered()
        };
        let room = |(aggregate, &scale): (&Aggregate, &f32)| aggregate.max_scale(scale) / scale;
        let most = aggregates.iter().zip(&sizes.scales).map(room).fold(1.0, f32::max);
        // About a third of what elements grow by is not hidden by others.
        let guess = 1.0 + 3.0 * (self.full - covered) as f32 / self.full as f32;
        let growth = matching(self.full, 1.0..most, guess, count);
        for (aggregate, scale) in aggregates.iter().zip(&mut sizes.scales) {
            *scale = (growth * *scale).min(aggregate.max_scale(*scale));
        }
    }

    fn elements(&self, state: &State, aggregates: &[Aggregate]) -> Vec<Elements> {
        let project = |aggregate: &Aggregate| {
            let mask = self.masks.get(aggregate.part).copied().unwrap_or_default();
            Elements::new(state, &state.parts[aggregate.part], &self.camera, mask)
        };
        aggregates.iter().map(project).collect()
    }
}
