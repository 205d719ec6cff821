//! Land, trees, light → where a landscape is first looked at from: how good a picture each of a fixed list of lookouts
//! would show, found by rays over heightfield, water and crowns, and the best of them.
//!
//! 1. `panorama` looks around from each place: what is seen in which direction, how far away.
//! 2. `light` says how the sun stands to a look.
//! 3. `appraise` turns the `picture` that a look shows, and its light, into terms from 0 to 1; their product is the score.
//! 4. `meter` says how the best ones are to be exposed.
//!
//! All landscapes are asked about the same lookouts ([`Lookout`]), so that one for several can be chosen from their
//! scores alone; placement keeps trunks away from all of them.

mod appraise;
mod light;
mod meter;
mod panorama;
mod picture;
mod stage;
#[cfg(test)]
mod tests;

use glam::Vec2;
use rayon::prelude::*;

use crate::math::ramp;
use crate::model::{Instance, Landform, SkyLight, StartView, TreeFootprint};
use appraise::appraise;
pub use appraise::{Appraisal, Want};
use genescape_schema::scene::{Lookout, Lookouts, Prospect};
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
    /// How good all others are.
    pub lookouts: Lookouts,
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
    let at_place = |lookouts: &[Lookout]| at_place(&scene, &sun, lookouts, 0.0);
    let appraisals: Vec<Appraisal> = all.par_chunks(Lookout::HEADINGS).flat_map_iter(at_place).collect();
    let lookouts = Lookouts::new(appraisals.iter().map(prospect).collect()).expect("one for each");
    let best = Lookouts::shared(&[&lookouts]).expect("one landscape");
    let appraisal = appraisals[all.partition_point(|lookout| *lookout < best.lookout)];
    let exposure = metered(&scene, &sun, light, &good_looks(&all, &appraisals));
    FirstLook { view: best.on(&land.field, land.water_level_m), appraisal, exposure, lookouts }
}

/// How good the looks are from all lookouts, in their order, at one in so many of the places; those that cannot score `least`
/// because one stands badly there may count as nothing.
pub fn looks(
    land: &Landform,
    trees: &[Instance],
    footprints: &[TreeFootprint],
    light: &SkyLight,
    one_in: usize,
    least: f32,
) -> Vec<Appraisal> {
    let (scene, sun) = (Surroundings::new(land, trees, footprints, light), Sun::of(light));
    let all: Vec<Lookout> = Lookout::all().collect();
    let places = all.par_chunks(Lookout::HEADINGS).step_by(one_in.max(1));
    places.flat_map_iter(|lookouts| at_place(&scene, &sun, lookouts, least)).collect()
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
            few.par_iter().flat_map_iter(|&k| at_place(&scene, &sun, places[k], 0.0)).collect();
        best = looks.into_iter().fold(best, |a, b| if b.score() > a.score() { b } else { a });
        if best.score() >= enough {
            break;
        }
    }
    best
}

/// The best look from each of the best places, the best first: those that one may well begin with, when a view is shared with
/// other landscapes.
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

/// All headings at one place, unless its footing alone keeps them below `least`.
fn at_place(scene: &Surroundings<'_>, sun: &Sun, lookouts: &[Lookout], least: f32) -> Vec<Appraisal> {
    let place = lookouts[0].place_m(scene.land.field.extent_m());
    let footing = footing(scene, place);
    if footing <= 0.0 || footing < least * least {
        // Nobody can stand there, or would: what might be seen is not worth the time.
        return vec![Appraisal::default(); lookouts.len()];
    }
    let panorama = Panorama::new(scene, place);
    let trees = scene.trees_around(place, SHADES_M);
    let look = |&lookout: &Lookout| {
        let light = sun.suits(scene, &trees, place, lookout.ahead());
        appraise(&Picture::new(&panorama, lookout), scene, footing, light)
    };
    lookouts.iter().map(look).collect()
}

fn prospect(appraisal: &Appraisal) -> Prospect {
    let pitch_deg = libm::roundf(libm::atanf(appraisal.pitch).to_degrees()) as i8;
    Prospect { score: crate::math::unit_to_byte(appraisal.score()), pitch_deg }
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
