//! What a person wants of a first look holds on made-up lands, told by marching over the heights once more, and on random
//! ones.

use std::f32::consts::TAU;

use genescape_schema::scene::{START_ASPECT, START_FOV_Y_DEG};
use genescape_schema::{Genome, Kinds, Space};
use glam::{Vec2, Vec3, Vec3Swizzles};

use super::appraise::Appraisal;
use super::panorama::COLUMNS;
use super::picture::{HALF_COLUMNS, HALF_HEIGHT};
use super::{FirstLook, Want, first_look, looks};
use crate::export::film;
use crate::model::TreeFootprint;
use crate::model::{Heightfield, Instance, Landform, Lookout, SkyLight, StartView};
use crate::random;
use crate::stages::ground::snow_map;
use crate::stages::land::landform;
use crate::stages::placement::{PlacementParams, clear_around, place};
use crate::stages::sky::{self, SkyParams};

const TREE: TreeFootprint = TreeFootprint {
    height_m: 12.0,
    trunk_radius_m: 0.25,
    crown_radius_m: 3.0,
    root_depth_m: 0.3,
    clear_trunk: 0.12,
};

/// 1024 m of land of those heights, level beyond, with no snow.
fn land(height_m: impl Fn(f32, f32) -> f32, water_level_m: Option<f32>) -> Landform {
    let field = |side: u32, spacing_m: f32| {
        let place = |line: u32| (line as f32 - 0.5 * (side - 1) as f32) * spacing_m;
        let heights_m = (0..side * side).map(|k| height_m(place(k % side), place(k / side))).collect();
        Heightfield { side, spacing_m, heights_m }
    };
    let (field, apron) = (field(129, 8.0), field(65, 64.0));
    Landform { water_level_m, ..Landform::bare(field, apron) }
}

/// Trees of 12 m, upright.
fn trees(places: impl IntoIterator<Item = Vec2>) -> Vec<Instance> {
    let tree = |p: Vec2| Instance {
        world_from_tree: [[1.0, 0.0, 0.0, p.x], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, p.y]],
        template: 0,
        trunk_cylinder_m: [p.x, p.y, 0.3],
    };
    places.into_iter().map(tree).collect()
}

/// Under a clear sky with the sun there.
fn light(elevation_deg: f32, azimuth_deg: f32) -> SkyLight {
    let (elevation, azimuth) = (elevation_deg.to_radians(), azimuth_deg.to_radians());
    let flat = libm::cosf(elevation);
    SkyLight {
        sun_direction: Vec3::new(
            flat * libm::sinf(azimuth),
            libm::sinf(elevation),
            -flat * libm::cosf(azimuth),
        ),
        sun_angular_radius_rad: 0.0047,
        sun_irradiance_linear: [3.2, 2.9, 2.4],
        sky_irradiance_linear: [0.5, 0.7, 1.0],
        zonal_radiance_linear: vec![[0.5, 0.6, 0.7], [0.2, 0.3, 0.5]],
        haze_linear: [0.5, 0.6, 0.7],
        haze_extinction_per_m: 0.0002,
        exposure: 1.0,
    }
}

fn look(land: &Landform, trees: &[Instance], light: &SkyLight) -> FirstLook {
    first_look(land, trees, &[TREE], light)
}

fn foot(view: &StartView) -> Vec2 {
    Vec2::new(view.position_m.x, view.position_m.z)
}

/// Metres to the ground along a ray of that turn and slope from the look's azimuth; 500 at most.
fn reach_m(land: &Landform, view: &StartView, turn: f32, slope: f32) -> f32 {
    let along = Vec2::from_angle(turn).rotate(Vec2::new(view.direction.x, view.direction.z).normalize());
    let steps = (1..1000).map(|step| 0.5 * step as f32);
    let hits = |distance_m: &f32| {
        let p = foot(view) + along * *distance_m;
        land.field.height_m(p.x, p.y).max(land.water_level_m.unwrap_or(f32::MIN))
            > view.position_m.y + slope * distance_m
    };
    steps.clone().find(hits).unwrap_or(500.0)
}

/// Whether land within 25 m fills more than a third of the middle of the picture above the eye.
fn faces_a_wall(land: &Landform, view: &StartView) -> bool {
    let rays =
        (-4..=4).flat_map(|turn| (0..6).map(move |row| (turn as f32 * 0.08, 0.02 + 0.06 * row as f32)));
    let (mut all, mut near) = (0, 0);
    for (turn, slope) in rays {
        (all, near) = (all + 1, near + i32::from(reach_m(land, view, turn, slope) < 25.0));
    }
    3 * near > all
}

/// Trees between two distances in the middle half of the picture.
fn trees_ahead(view: &StartView, trees: &[Instance], [from_m, to_m]: [f32; 2]) -> usize {
    let ahead = Vec2::new(view.direction.x, view.direction.z).normalize();
    let is_ahead = |tree: &&Instance| {
        let way = Vec2::new(tree.trunk_cylinder_m[0], tree.trunk_cylinder_m[1]) - foot(view);
        (from_m..to_m).contains(&way.length()) && way.normalize().dot(ahead) > 0.8
    };
    trees.iter().filter(is_ahead).count()
}

#[test]
fn nobody_starts_before_a_wall() {
    // A plain between cliffs, and a cone in its middle.
    let height_m = |x: f32, z: f32| {
        let cone = 120.0 - libm::hypotf(x, z);
        cone.max(3.0 * (x.abs() - 330.0)).max(0.0)
    };
    let land = land(height_m, None);
    let look = look(&land, &[], &light(40.0, 130.0));
    assert!(!faces_a_wall(&land, &look.view), "{:?}", look.view);
    assert!(reach_m(&land, &look.view, 0.0, 0.0) > 150.0);
    assert!(look.appraisal.term(Want::Open) > 0.9);
    // The test can tell: into the cone, and into the cliff.
    let wall = |x: f32, z: f32, ahead: Vec3| {
        let position_m = Vec3::new(x, land.field.height_m(x, z) + 1.6, z);
        faces_a_wall(&land, &StartView { position_m, direction: ahead })
    };
    assert!(wall(128.0, 0.0, Vec3::NEG_X) && wall(328.0, 300.0, Vec3::X) && !wall(200.0, 300.0, Vec3::NEG_Z));
}

#[test]
fn who_comes_to_mountains_sees_them_unless_there_is_fog() {
    // Level but for a range in the north.
    let range = land(|_, z| (0.5 * (-300.0 - z)).clamp(0.0, 160.0), None);
    let seen = |land: &Landform, light: &SkyLight| looks(land, &[], &[TREE], light, 1);
    let least = |looks: &[Appraisal]| {
        let terms = looks.iter().filter(|look| look.term(Want::Footing) > 0.0);
        terms.map(|look| look.term(Want::Relief)).fold(1.0, f32::min)
    };
    let (clear, fog) = (light(40.0, 130.0), SkyLight { haze_extinction_per_m: 0.03, ..light(40.0, 130.0) });
    assert!(look(&range, &[], &clear).appraisal.term(Want::Relief) > 0.9);
    assert!(least(&seen(&range, &clear)) < 0.4, "who looks the other way misses it");
    assert!(least(&seen(&range, &fog)) > 0.99);
    assert!(least(&seen(&land(|_, _| 0.0, None), &clear)) > 0.99, "level land has nothing to miss");
}

#[test]
fn one_stands_dry_by_the_lake_and_sees_it() {
    let land = land(|x, z| 0.05 * (libm::hypotf(x, z) - 180.0), Some(0.0));
    let look = look(&land, &[], &light(40.0, 130.0));
    let place = foot(&look.view);
    assert!(land.field.height_m(place.x, place.y) > 0.3, "dry");
    let ahead = Vec2::new(look.view.direction.x, look.view.direction.z).normalize();
    let wet = |distance_m: f32| {
        let p = place + ahead * distance_m;
        land.field.height_m(p.x, p.y) < 0.0
    };
    assert!(!wet(5.0) && (8..300).any(|distance_m| wet(distance_m as f32)), "{:?}", look.view);
}

#[test]
fn a_grove_is_seen_from_outside_at_a_good_distance() {
    let grid = (0..12).flat_map(|i| (0..12).map(move |j| Vec2::new(i as f32, j as f32)));
    let land = land(|_, _| 0.0, None);
    let mut trees = trees(grid.map(|cell| Vec2::new(120.0, -60.0) + 9.0 * cell));
    clear_around(&land, &mut trees);
    let look = look(&land, &trees, &light(40.0, 130.0));
    assert!(trees_ahead(&look.view, &trees, [10.0, 60.0]) >= 3, "{:?}", look.view);
    assert_eq!(trees_ahead(&look.view, &trees, [0.0, Lookout::CLEARING_M]), 0);
    assert!(look.appraisal.score() > 0.3);
}

#[test]
fn the_skyline_lies_in_the_upper_half_of_the_picture() {
    for hills_m in [0.0, 15.0, 40.0] {
        let height_m = |x: f32, z: f32| hills_m * (libm::cosf(x / 90.0) + libm::cosf(z / 110.0));
        let land = land(height_m, None);
        let view = look(&land, &[], &light(40.0, 130.0)).view;
        let pitch = view.direction.y / Vec2::new(view.direction.x, view.direction.z).length();
        // For each column the lowest slope that passes over all land; in the middle of the field, land is all around.
        let skyline = |turn: i32| {
            let slopes = (-60..60).map(|k| 0.01 * k as f32);
            slopes
                .into_iter()
                .find(|&slope| reach_m(&land, &view, 0.1 * turn as f32, slope) >= 500.0)
                .expect("sky")
        };
        let mean = (-7..=7).map(skyline).sum::<f32>() / 15.0;
        let from_top = 0.5 - (mean - pitch) / (2.0 * 0.577);
        assert!((0.3..0.55).contains(&from_top), "{hills_m} m: {from_top}");
    }
}

#[test]
fn the_sun_is_not_in_the_eyes_and_lights_the_ground() {
    let ridge = land(|x, z| if z > 300.0 { 0.0 } else { (80.0 - (x + 100.0).abs()).max(0.0) }, None);
    for azimuth_deg in [0.0, 90.0, 200.0] {
        let light = light(15.0, azimuth_deg);
        let look = look(&ridge, &[], &light);
        let sun = Vec2::new(light.sun_direction.x, light.sun_direction.z).normalize();
        let ahead = Vec2::new(look.view.direction.x, look.view.direction.z).normalize();
        assert!(ahead.dot(sun) < 0.9, "{azimuth_deg}°: {ahead}");
        let place = foot(&look.view) + ahead * 15.0;
        let shaded = (1..300).any(|step| {
            let p = place + sun * (2.0 * step as f32);
            ridge.field.height_m(p.x, p.y)
                > ridge.field.height_m(place.x, place.y) + 0.5 + 0.268 * 2.0 * step as f32
        });
        assert!(!shaded, "{azimuth_deg}°");
    }
}

/// How good the trees are that one sees who looks north on level land, at `(heading, metres)` from there; a heading is a 24th of a
/// turn.
fn trees_north(footprint: TreeFootprint, around: impl IntoIterator<Item = (f32, f32)>) -> f32 {
    trees_before(0.0, footprint, around)
}

/// The same before a hill of that height, 150 m away.
fn trees_before(hill_m: f32, footprint: TreeFootprint, around: impl IntoIterator<Item = (f32, f32)>) -> f32 {
    let first = Lookout::HEADINGS * 136;
    let lookout = Lookout::all().nth(first).expect("a lookout");
    let place = lookout.place_m(1024.0);
    let (land, light) =
        (land(|_, z| if z < place.y - 150.0 { hill_m } else { 0.0 }, None), light(40.0, 130.0));
    let towards = |heading: f32| {
        let (sin, cos) = libm::sincosf(heading * TAU / Lookout::HEADINGS as f32);
        Vec2::new(sin, -cos)
    };
    let trees = trees(around.into_iter().map(|(heading, away_m)| place + away_m * towards(heading)));
    looks(&land, &trees, &[footprint], &light, 1)[first].term(Want::Trees)
}

#[test]
fn crowns_that_fill_the_picture_spoil_it_and_the_same_farther_away_do_not() {
    let huge = TreeFootprint { height_m: 28.0, crown_radius_m: 8.0, clear_trunk: 0.0, ..TREE };
    // Before the eyes, and 30 degrees to both sides.
    let score = |away_m: f32| trees_north(huge, [-2.0, 0.0, 2.0].map(|heading| (heading, away_m)));
    assert!(score(11.0) < 0.6 * score(36.0), "{} {}", score(11.0), score(36.0));
}

#[test]
fn trees_before_the_sky_are_worth_more_than_the_same_before_a_hill() {
    let row = [-2.0, 0.0, 2.0].map(|heading| (heading, 30.0));
    let (sky, hill) = (trees_before(0.0, TREE, row), trees_before(90.0, TREE, row));
    assert!(hill < 0.8 * sky, "{hill} {sky}");
}

#[test]
fn one_tree_alone_is_worth_less_than_several_that_take_as_much_of_the_picture() {
    let round = |crown_radius_m: f32| TreeFootprint { crown_radius_m, ..TREE };
    let (alone, several) = (
        trees_north(round(6.0), [(0.0, 25.0)]),
        trees_north(round(2.0), [-2.0, -1.0, 0.0, 1.0, 2.0].map(|heading| (heading, 25.0))),
    );
    assert!(alone < 0.9 * several, "{alone} {several}");
}

#[test]
fn trees_are_worth_more_whole_than_with_their_tops_cut_off() {
    // Crowns that begin as high above the ground, and as wide.
    let row = |height_m: f32, clear_trunk: f32| {
        let footprint = TreeFootprint { height_m, clear_trunk, crown_radius_m: 1.5, ..TREE };
        trees_north(footprint, [-2.0, 0.0, 2.0].map(|heading| (heading, 20.0)))
    };
    let (whole, cut) = (row(10.0, 0.12), row(24.0, 0.05));
    assert!(cut < 0.9 * whole, "{cut} {whole}");
}

#[test]
fn tall_columns_are_looked_at_from_where_their_tops_are_in_the_picture() {
    let poplar = TreeFootprint { height_m: 28.0, crown_radius_m: 1.8, clear_trunk: 0.05, ..TREE };
    let row = |away_m: f32| trees_north(poplar, [-2.0, -1.0, 0.0, 1.0, 2.0].map(|heading| (heading, away_m)));
    let (whole, cut) = (row(62.0), row(25.0));
    assert!(cut < 0.8 * whole, "{cut} {whole}");
    assert!(whole > 0.6, "{whole}");
}

#[test]
fn a_slender_tree_before_others_is_worth_more_whole_wherever_it_stands() {
    let poplars = |near_m: f32, heading: f32| {
        let poplar = TreeFootprint { height_m: 20.0, crown_radius_m: 0.9, clear_trunk: 0.05, ..TREE };
        let far = [-2.5, -1.5, 1.5, 2.5].map(|heading| (heading, 55.0));
        trees_north(poplar, far.into_iter().chain([(heading, near_m)]))
    };
    // A panorama has four columns a heading.
    for heading in [0.0, 0.0625, 0.125, 0.1875] {
        let (whole, cut) = (poplars(40.0, heading), poplars(24.0, heading));
        assert!(cut < 0.85 * whole, "{cut} of {whole} at {heading}");
    }
}

#[test]
fn a_stem_whose_crown_is_cut_off_does_not_stand_across_the_picture() {
    let term = |trunk_radius_m: f32, heading: f32| {
        let pine = TreeFootprint { height_m: 20.0, clear_trunk: 0.6, trunk_radius_m, ..TREE };
        let wood = (0..Lookout::HEADINGS).map(|heading| (heading as f32, 40.0));
        trees_north(pine, wood.chain([(heading, 5.0)]))
    };
    // Before the eyes; behind the back; one that hides nothing.
    let (before, behind, thin) = (term(0.3, 0.0), term(0.3, 12.0), term(0.03, 0.0));
    assert!(before < 0.6 * behind, "{before} {behind}");
    assert!(thin > 0.95 * behind, "{thin} {behind}");
}

#[test]
fn a_look_into_shade_is_worth_little_where_the_sun_shines() {
    let light = light(15.0, 90.0);
    let term = |wall_m: f32| {
        // A wall east of the middle, along which one looks north.
        let land = land(|x, _| if (60.0..200.0).contains(&x) { wall_m } else { 0.0 }, None);
        light_of_look(&land, &light, Vec2::new(20.0, 0.0), 0)
    };
    assert!(term(0.0) > 0.95 && term(60.0) < 0.5, "{} {}", term(0.0), term(60.0));
}

#[test]
fn a_hill_is_worth_more_from_where_a_low_sun_lights_it() {
    // The sun is in the north. One looks east at a hill that falls off northwards, or southwards.
    let light = light(4.0, 0.0);
    let term = |to_north: f32| {
        let hill =
            |x: f32, z: f32| 0.35 * (x - 120.0).max(0.0) * (1.0 + to_north * (z / 150.0).clamp(-1.0, 1.0));
        light_of_look(&land(hill, None), &light, Vec2::ZERO, Lookout::HEADINGS / 4)
    };
    let (lit, dark) = (term(1.0), term(-1.0));
    assert!(lit > 1.15 * dark, "{lit} {dark}");
}

/// How good the light is of the look in a direction from the lookout that is nearest to a place.
fn light_of_look(land: &Landform, light: &SkyLight, place: Vec2, heading: usize) -> f32 {
    let away_m = |one: &Lookout| one.place_m(land.field.extent_m()).distance(place);
    let there = Lookout::all().enumerate().filter(|(_, one)| one.heading() == heading);
    let nearest = there.min_by(|(_, a), (_, b)| away_m(a).total_cmp(&away_m(b)));
    let (number, _) = nearest.expect("one of all");
    looks(land, &[], &[TREE], light, 1)[number].term(Want::Light)
}

#[test]
fn where_nobody_can_stand_there_is_still_a_view_and_it_is_worth_nothing() {
    let look = look(&land(|_, _| -5.0, Some(1000.0)), &[], &light(40.0, 130.0));
    assert!(look.view.position_m.is_finite() && look.view.position_m.y > 1000.0);
    assert_eq!((look.appraisal.score(), look.appraisal.weakest()), (0.0, Want::Footing));
}

#[test]
fn no_look_is_better_than_the_first() {
    let land = land(|x, z| 10.0 * (libm::cosf(x / 90.0) + libm::cosf(z / 110.0)), None);
    let light = light(30.0, 60.0);
    let (look, all) = (look(&land, &[], &light), looks(&land, &[], &[TREE], &light, 1));
    let best = all.iter().max_by(|a, b| a.score().total_cmp(&b.score())).expect("some");
    assert_eq!(*best, look.appraisal);
    assert!((look.view.direction.y / look.view.direction.xz().length() - look.appraisal.pitch).abs() < 1e-3);
}

/// A landscape of some kind, drawn as `bake random` draws it.
struct Drawn {
    land: Landform,
    trees: Vec<Instance>,
    look: FirstLook,
}

impl Drawn {
    fn new(space: &Space, genome: &Genome) -> Self {
        let land = landform(&genome.read(space).expect("genes"), 129);
        let placement: PlacementParams = genome.read(space).expect("genes");
        let snow = snow_map(placement.terrain_seed, &land);
        let mut trees = place(&placement, &land, snow.as_ref(), &[TREE]).instances;
        clear_around(&land, &mut trees);
        let look = look(&land, &trees, &sky::light(&genome.read(space).expect("genes")));
        Self { land, trees, look }
    }
}

#[test]
fn of_forty_random_landscapes_hardly_one_is_first_seen_before_a_wall_and_most_have_trees() {
    let space = Space::builtin();
    let (kinds, _) = Kinds::shipped(&space);
    let (mut walls, mut bare, mut elsewhere) = (Vec::new(), Vec::new(), 0);
    for seed in 0..10 {
        let population = random::population(&space, &kinds, &[], seed, 0).expect("kinds").population;
        for (k, one) in population.individuals.iter().enumerate() {
            let one = Drawn::new(&space, &one.genome);
            let view = &one.look.view;
            walls.extend(faces_a_wall(&one.land, view).then_some((seed, k)));
            elsewhere +=
                u32::from(faces_a_wall(&one.land, &StartView { direction: -view.direction, ..*view }));
            bare.extend((trees_ahead(view, &one.trees, [8.0, 80.0]) == 0).then_some((seed, k)));
        }
    }
    assert!(walls.is_empty(), "walls: {walls:?}");
    assert!(elsewhere > 0, "nothing to avoid");
    assert!(bare.len() <= 2, "without trees: {bare:?}");
}

/// What the viewer's film curve makes of the sky and of the ground, as colours from 0 to 1.
fn shown(sky: &SkyParams, snow: bool) -> [Vec3; 2] {
    let mut land = land(|_, _| 0.0, None);
    land.snow_line_m = if snow { -1.0 } else { 1e4 };
    let light = sky::light(sky);
    let exposure = look(&land, &[], &light).exposure;
    let albedo = if snow { Vec3::new(0.80, 0.83, 0.87) } else { Vec3::new(0.09, 0.10, 0.04) };
    let [sun, around] = [light.sun_irradiance_linear, light.sky_irradiance_linear].map(Vec3::from);
    let ground = albedo * (sun * light.sun_direction.y + around) / core::f32::consts::PI;
    let above = Vec3::from(light.zonal_radiance_linear[3]);
    [above, ground].map(|radiance| Vec3::from(film((exposure * radiance).to_array())))
}

fn luma(color: Vec3) -> f32 {
    color.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

const NOON: SkyParams = SkyParams {
    sky_seed: 5,
    sun_elevation_deg: 50.0,
    sun_azimuth_deg: 130.0,
    turbidity: 3.0,
    sun_size_deg: 0.53,
    exposure_ev: 0.0,
    cloud_cover: 0.2,
    cloud_base_m: 1400.0,
    cloud_thickness_m: 900.0,
    cloud_scale_m: 1500.0,
    cirrus: 0.0,
    haze_m: 30_000.0,
};

#[test]
fn grass_in_shade_is_seen_at_any_hour() {
    let land = land(|_, _| 0.0, None);
    for (elevation_deg, cover) in [2.0, 4.0, 8.0, 13.0, 30.0, 65.0].into_iter().zip([0.1, 0.5, 0.9].repeat(2))
    {
        let sky = SkyParams { sun_elevation_deg: elevation_deg, cloud_cover: cover, ..NOON };
        let light = sky::light(&sky);
        let shade = Vec3::from(light.sky_irradiance_linear) * 0.75 / core::f32::consts::PI;
        let grass = Vec3::new(0.09, 0.10, 0.04) * shade * look(&land, &[], &light).exposure;
        let shown = luma(Vec3::from(film(grass.to_array())));
        assert!(shown > 0.19, "{elevation_deg}°, {cover}: {shown}");
    }
}

#[test]
fn metered_pictures_are_neither_dark_nor_burnt_and_dusk_has_colour() {
    let (noon, overcast) = (NOON, SkyParams { cloud_cover: 1.0, ..NOON });
    let dusk = SkyParams { sun_elevation_deg: 3.0, ..noon };
    let dull_dusk = SkyParams { cloud_cover: 1.0, ..dusk };
    let means = [&noon, &overcast, &dusk, &dull_dusk].map(|sky| {
        let [above, ground] = shown(sky, false);
        let mean = 0.5 * (luma(above) + luma(ground));
        assert!((0.3..0.68).contains(&mean) && luma(above) < 0.93, "{sky:?}: {above}, {ground}");
        mean
    });
    assert!(means[2] < means[0] && means[1] > 0.38, "{means:?}");
    for sky in [&noon, &overcast] {
        let ([_, snow], [_, grass]) = (shown(sky, true), shown(sky, false));
        assert!((0.6..0.93).contains(&luma(snow)), "{sky:?}: {snow}");
        assert!((0.2..0.6).contains(&luma(grass)), "{sky:?}: {grass}");
    }
    let chroma = |color: Vec3| color.max_element() - color.min_element();
    assert!(chroma(shown(&dusk, false)[0]) > 0.08, "{:?}", shown(&dusk, false));
    // Under a deck there is little colour, and no brown.
    let [above, _] = shown(&dull_dusk, false);
    assert!(above.x - above.z < 0.1, "{above}");
    // Grass at sunset is gold, not brown.
    let sunset = SkyParams { sun_elevation_deg: 7.0, ..noon };
    let [_, grass] = shown(&sunset, false);
    assert!(grass.y > 0.92 * grass.x && grass.x > 1.3 * grass.z, "{grass}");
}

#[test]
fn fog_is_bright() {
    let light = sky::light(&SkyParams { sun_elevation_deg: 10.0, haze_m: 1300.0, ..NOON });
    let exposure = look(&land(|_, _| 0.0, None), &[], &light).exposure;
    let fog = luma(Vec3::from(film((exposure * Vec3::from(light.haze_linear)).to_array())));
    assert!((0.86..0.94).contains(&fog), "{fog}");
}

#[test]
fn who_comes_to_the_sea_sees_it() {
    let sea = land(|x, _| (60.0 - 0.3 * x).clamp(-20.0, 4.0), Some(0.0));
    let trees =
        trees((0..60).map(|k| Vec2::new((k % 10) as f32 * 90.0 - 450.0, (k / 10) as f32 * 150.0 - 400.0)));
    let seen = |land: &Landform| looks(land, &trees, &[TREE], &light(40.0, 130.0), 1);
    let (by_sea, inland) = (seen(&sea), seen(&land(|_, _| 4.0, None)));
    let best = by_sea.iter().max_by(|a, b| a.score().total_cmp(&b.score())).expect("a look");
    assert!(best.term(Want::Water) > 0.9, "{best:?}");
    // Who looks the other way misses much, and where there is no sea nothing.
    let least = |looks: &[Appraisal]| {
        looks.iter().map(|look| look.term(Want::Water)).filter(|&t| t > 0.0).fold(1.0, f32::min)
    };
    assert!(least(&by_sea) < 0.5 && least(&inland) > 0.8, "{} {}", least(&by_sea), least(&inland));
}

/// What a picture is judged by is what the file's camera and the viewer show.
#[test]
fn pictures_are_as_wide_and_high_as_the_camera_shows() {
    let half_height = libm::tanf(0.5 * START_FOV_Y_DEG.to_radians());
    assert!((HALF_HEIGHT / half_height - 1.0).abs() < 0.01, "{HALF_HEIGHT} for {half_height}");
    let half_width_rad = (HALF_COLUMNS as f32 + 0.5) * TAU / COLUMNS as f32;
    let shown_rad = libm::atanf(START_ASPECT * half_height);
    assert!((half_width_rad / shown_rad - 1.0).abs() < 0.03, "{half_width_rad} for {shown_rad}");
}
