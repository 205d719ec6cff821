//! Land, trees, light → where a landscape is first looked at from: how good a picture each of a fixed list of lookouts
//! would show, found by rays over heightfield, water and crowns, and the best of them.
//!
//! 1. `panorama` looks around from each place: what is seen in which direction, how far away.
//! 2. `light` says how the sun stands to a look, `sunlight` how much of what is seen it reaches.
//! 3. `appraise` turns the `picture` that a look shows, and its light, into terms from 0 to 1; their product is the score.
//! 4. `meter` says how the best ones are to be exposed.
//!
//! Placement keeps trunks away from all of them ([`Lookout`]), before it is known which it will be.

mod appraise;
mod light;
mod meter;
mod panorama;
mod picture;
mod stage;
mod sunlight;
#[cfg(test)]
mod tests;

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use crate::math::ramp;
use crate::model::{Instance, Landform, Lookout, SkyLight, StartView, TreeFootprint};
use appraise::appraise;
pub use appraise::{Appraisal, Want};
use light::{SHADES_M, Sun};
use panorama::{Panorama, Surroundings};
use picture::Picture;
pub use stage::{StartFiles, StartStage};

/// Places that [`any_good_look`] tries at once.
const FEW: usize = 8;
/// A prime, so that places tried after each other lie far from each other.
const SCATTER: usize = 101;
/// Looks, each from another place, that a landscape's exposure is metered for.
const METERED: usize = 8;
/// Metres that one may want to step aside at once.
const STEPS_M: f32 = 5.0;

/// The first look at a landscape.
pub struct FirstLook {
    pub view: StartView,
    /// How good that view is.
    pub appraisal: Appraisal,
    /// Factor by which its picture is to be made brighter.
    pub exposure: f32,
}

/// Looks at a landscape from all lookouts; `footprints` are those of the trees' templates.
pub fn first_look(
    land: &Landform,
    trees: &[Instance],
    footprints: &[TreeFootprint],
    light: &SkyLight,
) -> FirstLook {
    let (scene, sun) = (Surroundings::new(land, trees, footprints, light), Sun::of(light));
    let all: Vec<Lookout> = Lookout::all().collect();
    let at_place = |lookouts: &[Lookout]| at_place(&scene, &sun, lookouts);
    let appraisals: Vec<Appraisal> = all.par_chunks(Lookout::HEADINGS).flat_map_iter(at_place).collect();
    let better =
        |best: usize, k: usize| if appraisals[k].score() > appraisals[best].score() { k } else { best };
    let best = (0..all.len()).fold(0, better);
    let view = view(land, all[best], &appraisals[best]);
    let exposure = metered(&scene, &sun, light, &good_looks(&all, &appraisals));
    FirstLook { view, appraisal: appraisals[best], exposure }
}

/// The eye stands on the ground there, or on the water.
fn view(land: &Landform, lookout: Lookout, appraisal: &Appraisal) -> StartView {
    let place = lookout.place_m(land.field.extent_m());
    let surface_m = land.field.height_m(place.x, place.y).max(land.water_level_m.unwrap_or(f32::MIN));
    let ahead = lookout.ahead();
    StartView {
        position_m: Vec3::new(place.x, surface_m + StartView::EYE_HEIGHT_M, place.y),
        direction: Vec3::new(ahead.x, appraisal.pitch, ahead.y).normalize(),
    }
}

/// How good the looks are from all lookouts, in their order, at one in so many of the places.
#[cfg(test)]
pub fn looks(
    land: &Landform,
    trees: &[Instance],
    footprints: &[TreeFootprint],
    light: &SkyLight,
    one_in: usize,
) -> Vec<Appraisal> {
    let (scene, sun) = (Surroundings::new(land, trees, footprints, light), Sun::of(light));
    let all: Vec<Lookout> = Lookout::all().collect();
    let places = all.par_chunks(Lookout::HEADINGS).step_by(one_in.max(1));
    places.flat_map_iter(|lookouts| at_place(&scene, &sun, lookouts)).collect()
}

/// A look that scores at least `enough`, of the first few places all over the land that have one; if none has, the best of
/// all. Far quicker than [`first_look`] where landscapes are good.
pub fn any_good_look(
    land: &Landform,
    trees: &[Instance],
    footprints: &[TreeFootprint],
    light: &SkyLight,
    enough: f32,
) -> Appraisal {
    let (scene, sun) = (Surroundings::new(land, trees, footprints, light), Sun::of(light));
    let all: Vec<Lookout> = Lookout::all().collect();
    let places: Vec<&[Lookout]> = all.chunks(Lookout::HEADINGS).collect();
    let scattered: Vec<usize> = (0..places.len()).map(|k| k * SCATTER % places.len()).collect();
    let mut best = Appraisal::default();
    for few in scattered.chunks(FEW) {
        let looks: Vec<Appraisal> =
            few.par_iter().flat_map_iter(|&k| at_place(&scene, &sun, places[k])).collect();
        best = looks.into_iter().fold(best, |a, b| if b.score() > a.score() { b } else { a });
        if best.score() >= enough {
            break;
        }
    }
    best
}

/// The best look from each of the best places, the best first.
fn good_looks(all: &[Lookout], appraisals: &[Appraisal]) -> Vec<Lookout> {
    let places = all.chunks(Lookout::HEADINGS).zip(appraisals.chunks(Lookout::HEADINGS));
    let mut looks: Vec<(f32, Lookout)> = places
        .filter_map(|(looks, appraisals)| {
            let scored = looks.iter().zip(appraisals).map(|(&look, appraisal)| (appraisal.score(), look));
            scored.reduce(|a, b| if b.0 > a.0 { b } else { a })
        })
        .collect();
    looks.sort_by(|a, b| b.0.total_cmp(&a.0));
    looks.truncate(METERED);
    looks.into_iter().map(|(_, look)| look).collect()
}

/// The exposure that suits the pictures from some lookouts: the mean of each one's, in stops.
fn metered(scene: &Surroundings<'_>, sun: &Sun, light: &SkyLight, lookouts: &[Lookout]) -> f32 {
    let stops = |&lookout: &Lookout| {
        let place = lookout.place_m(scene.land.field.extent_m());
        let panorama = Panorama::new(scene, place);
        let trees = scene.trees_around(place, SHADES_M);
        let lit = sun.lit(scene, &trees, place, lookout.ahead());
        libm::log2f(meter::exposure(&Picture::new(&panorama, lookout), light, lit))
    };
    let stops: Vec<f32> = lookouts.par_iter().map(stops).collect();
    libm::exp2f(stops.iter().sum::<f32>() / stops.len().max(1) as f32)
}

/// All headings at one place.
fn at_place(scene: &Surroundings<'_>, sun: &Sun, lookouts: &[Lookout]) -> Vec<Appraisal> {
    let place = lookouts[0].place_m(scene.land.field.extent_m());
    let footing = footing(scene, place);
    if footing <= 0.0 {
        // Nobody can stand there: what might be seen is not worth the time.
        return vec![Appraisal::default(); lookouts.len()];
    }
    let panorama = Panorama::new(scene, place);
    let trees = scene.trees_around(place, SHADES_M);
    let look = |&lookout: &Lookout| {
        let picture = Picture::new(&panorama, lookout);
        let light = sun.suits(scene, &trees, place, lookout.ahead()) * scene.sunlight.suits(picture.sun);
        appraise(&picture, scene, footing, light)
    };
    lookouts.iter().map(look).collect()
}

/// How well one stands there, 0 … 1: dry, level, with room for a few steps.
fn footing(scene: &Surroundings<'_>, place: Vec2) -> f32 {
    let (ground_m, water_m) = (scene.ground_m(place), scene.water_m());
    let rise =
        |step: Vec2| (scene.ground_m(place + step) - scene.ground_m(place - step)) / (2.0 * step.length());
    let slope = Vec2::new(rise(2.0 * Vec2::X), rise(2.0 * Vec2::Y)).length();
    let around = Lookout::all().step_by(3).take(8).map(Lookout::ahead);
    let walkable = |step: Vec2| {
        let there_m = scene.ground_m(place + STEPS_M * step);
        there_m > water_m && (there_m - ground_m).abs() < 0.6 * STEPS_M
    };
    let room = around.filter(|&step| walkable(step)).count() as f32 / 8.0;
    // One can stand on a steep slope, if there is nothing else; not in a lake.
    let level = 0.02 + 0.1 * ramp(1.4, 0.6, slope) + 0.88 * ramp(0.6, 0.25, slope) * ramp(0.3, 0.9, room);
    ramp(0.2, 0.7, ground_m - water_m) * level
}
