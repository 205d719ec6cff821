//! No tree floats, drowns, clings to a cliff or stands in another; and the same genes give the same forest.

use glam::{Mat3, Vec2, Vec3};
use proptest::prelude::*;

use crate::model::{Heightfield, Instance, Landform, Lookout, SnowMap};
use crate::noise::fbm2;
use crate::stages::ground::{self, GroundParams};

use super::site::{MAX_FLOW, Site, WATER_MARGIN_M};
use super::{EDGE_MARGIN_M, MAX_TREES, PlacementParams, TreeFootprint, clear_around, place};

fn planted(
    params: &PlacementParams,
    land: &Landform,
    snow: Option<&SnowMap>,
    trees: &[TreeFootprint],
) -> Vec<Instance> {
    place(params, land, snow, trees).instances
}

/// Rolling land 1024 m wide with one river from north to south, and a lake if `water` is above 0.
fn land(seed: u32, relief_m: f32, water: f32, side: u32) -> Landform {
    let spacing_m = 1024.0 / (side - 1) as f32;
    let middle = (side - 1) as f32 / 2.0;
    let (mut heights_m, mut flow) = (Vec::new(), Vec::new());
    for j in 0..side {
        for i in 0..side {
            let (x, z) = ((i as f32 - middle) * spacing_m, (j as f32 - middle) * spacing_m);
            let bed = (x - 200.0 - 60.0 * fbm2(seed + 9, 0.5, z / 200.0, 2, 0.5, 0)).abs();
            heights_m.push(relief_m * (0.5 + 0.5 * fbm2(seed, x / 400.0, z / 400.0, 5, 0.5, 0)));
            flow.push((1.0 - bed / 60.0).clamp(0.0, 1.0));
        }
    }
    let field = Heightfield { side, spacing_m, heights_m };
    let [low, high] = field.range_m();
    let water_level_m = (water > 0.0).then_some(low + water * (high - low));
    Landform { flow, water_level_m, snow_line_m: high + 1.0, ..Landform::bare(field.clone(), field) }
}

fn params() -> impl Strategy<Value = PlacementParams> {
    (0_u32..256, 0.0_f32..=0.5, 1.6_f32..=6.4, 0.0_f32..=1.0, 10.0_f32..=50.0, 0.15_f32..=1.0).prop_map(
        |(tree_seed, height_variation, ln_density, clustering, steepest_slope_deg, altitude_limit)| {
            let density_per_ha = libm::expf(ln_density).clamp(5.0, 600.0);
            PlacementParams {
                tree_seed,
                height_variation,
                density_per_ha,
                clustering,
                steepest_slope_deg,
                altitude_limit,
                ..usual()
            }
        },
    )
}

fn trees() -> impl Strategy<Value = Vec<TreeFootprint>> {
    let tree = (3.0_f32..30.0, 0.008_f32..0.05, 0.05_f32..0.5, 0.0_f32..0.5).prop_map(|(h, r, c, d)| {
        TreeFootprint {
            height_m: h,
            trunk_radius_m: h * r,
            crown_radius_m: h * c,
            root_depth_m: d,
            clear_trunk: 0.2,
        }
    });
    prop::collection::vec(tree, 1..6)
}

fn lands() -> impl Strategy<Value = Landform> {
    (
        0_u32..1000,
        15.0_f32..420.0,
        prop_oneof![Just(0.0_f32), 0.05_f32..0.6],
        prop_oneof![Just(129_u32), Just(257)],
    )
        .prop_map(|(seed, relief_m, water, side)| land(seed, relief_m, water, side))
}

fn linear(instance: &Instance) -> Mat3 {
    let row = |k: usize| {
        let r = instance.world_from_tree[k];
        Vec3::new(r[0], r[1], r[2])
    };
    Mat3::from_cols(row(0), row(1), row(2)).transpose()
}

fn origin(instance: &Instance) -> Vec3 {
    Vec3::new(instance.world_from_tree[0][3], instance.world_from_tree[1][3], instance.world_from_tree[2][3])
}

/// Points of a circle around the trunk's axis, in the world.
fn ring(instance: &Instance, radius_m: f32, height_m: f32) -> Vec<Vec3> {
    let point = |k: u32| {
        let (sin, cos) = libm::sincosf(k as f32 / 32.0 * std::f32::consts::TAU);
        linear(instance) * Vec3::new(radius_m * cos, height_m, radius_m * sin) + origin(instance)
    };
    (0..32).map(point).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..Default::default() })]

    #[test]
    fn nobody_floats_drowns_or_is_buried(params in params(), land in lands(), trees in trees()) {
        for instance in planted(&params, &land, None, &trees) {
            let tree = trees[instance.template as usize];
            let (foot, size) = (origin(&instance), linear(&instance).y_axis.y);
            for p in ring(&instance, tree.trunk_radius_m, 0.0) {
                let ground = land.field.height_m(p.x, p.z);
                prop_assert!(p.y <= ground, "floats {} m", p.y - ground);
                prop_assert!(land.water_level_m.is_none_or(|level| ground >= level + WATER_MARGIN_M));
            }
            let sunk = land.field.height_m(foot.x, foot.z) - foot.y;
            prop_assert!(sunk <= 0.1 + size * (0.07 * tree.height_m + tree.root_depth_m), "{sunk} m deep");
        }
    }

    #[test]
    fn limits_hold(params in params(), land in lands(), trees in trees()) {
        let site = Site::new(&params, &land, None);
        let [low, high] = land.field.range_m();
        let base = land.water_level_m.map_or(low, |level| level + WATER_MARGIN_M).min(high);
        let half = 0.5 * land.field.extent_m() - EDGE_MARGIN_M;
        let mut instances = planted(&params, &land, None, &trees);
        prop_assert!(instances.len() < MAX_TREES as usize);
        for instance in &instances {
            let p = origin(instance);
            let slope = libm::atanf(site.slope(p.x, p.z)).to_degrees();
            prop_assert!(slope <= params.steepest_slope_deg + 0.01, "{slope}°");
            let altitude = (land.field.height_m(p.x, p.z) - base) / (high - base);
            prop_assert!(altitude <= params.altitude_limit + 1e-4, "at {altitude} of the relief");
            prop_assert!(site.flow(p.x, p.z) < MAX_FLOW);
            prop_assert!(p.x.abs().max(p.z.abs()) <= half);
        }
        clear_around(&land, &mut instances);
        for instance in &instances {
            let [x, z, radius] = instance.trunk_cylinder_m;
            let to = |place: Vec2| place.distance(Vec2::new(x, z)) - radius;
            let free = Lookout::places_m(land.field.extent_m()).map(to).fold(f32::MAX, f32::min);
            prop_assert!(free >= Lookout::CLEARING_M, "{free} m from a lookout");
        }
    }

    #[test]
    fn trunks_never_meet_and_cylinders_hold_them(params in params(), land in lands(), trees in trees()) {
        let mut instances = planted(&params, &land, None, &trees);
        for instance in &instances {
            let [x, z, radius] = instance.trunk_cylinder_m;
            let foot = origin(instance);
            let top = land.field.height_m(foot.x, foot.z) + 2.0 - foot.y;
            let up = linear(instance).y_axis.y;
            for height in [0.0, 0.5 * top / up, top / up] {
                for p in ring(instance, trees[instance.template as usize].trunk_radius_m, height) {
                    prop_assert!(Vec2::new(p.x - x, p.z - z).length() <= radius + 1e-4);
                }
            }
        }
        instances.sort_by(|a, b| a.trunk_cylinder_m[0].total_cmp(&b.trunk_cylinder_m[0]));
        for (k, a) in instances.iter().enumerate() {
            let [ax, az, ar] = a.trunk_cylinder_m;
            for b in instances[k + 1..].iter().take_while(|b| b.trunk_cylinder_m[0] - ax < 12.0) {
                let [bx, bz, br] = b.trunk_cylinder_m;
                let gap = Vec2::new(ax - bx, az - bz).length() - ar - br;
                prop_assert!(gap > 0.25, "trunks {gap} m apart");
            }
        }
    }

    #[test]
    fn transforms_are_affine_in_earnest_and_well_conditioned(params in params(), trees in trees()) {
        let land = land(3, 60.0, 0.0, 129);
        let mut skewed = 0;
        let instances = planted(&params, &land, None, &trees);
        for instance in &instances {
            let m = linear(instance);
            prop_assert!(m.is_finite() && m.determinant() > 0.0);
            let size = libm::cbrtf(m.determinant());
            prop_assert!((0.15..=1.7).contains(&size), "size {size}");
            // Frobenius norms bound the condition number from above.
            let norm = |m: Mat3| (m.x_axis.length_squared() + m.y_axis.length_squared() + m.z_axis.length_squared()).sqrt();
            prop_assert!(norm(m) * norm(m.inverse()) < 3.3, "3 is a rotation");
            skewed += usize::from(m.x_axis.normalize().dot(m.y_axis.normalize()).abs() > 1e-4);
        }
        prop_assert!(skewed * 10 >= instances.len() * 9, "{skewed} of {}", instances.len());
    }

    #[test]
    fn same_genes_same_forest_another_seed_another(params in params(), land in lands(), trees in trees()) {
        let first = planted(&params, &land, None, &trees);
        prop_assert_eq!(&first, &planted(&params, &land, None, &trees));
        let other = PlacementParams { tree_seed: params.tree_seed ^ 1, ..params };
        prop_assert!(first.is_empty() || first != planted(&other, &land, None, &trees));
    }
}

#[test]
fn land_that_is_a_little_different_has_nearly_the_same_trees() {
    let feet = |land: &Landform| {
        let made = planted(&PlacementParams { clustering: 0.3, ..usual() }, land, None, &[OAK]);
        made.iter().map(|tree| origin(tree).with_y(0.0)).collect::<Vec<Vec3>>()
    };
    let (coarse, fine) = (feet(&land(3, 60.0, 0.1, 129)), feet(&land(3, 60.0, 0.1, 513)));
    let is_there = |foot: &&Vec3| fine.iter().any(|other| other.distance(**foot) < 0.1);
    let shared = coarse.iter().filter(is_there).count();
    assert!(shared * 10 > coarse.len() * 7, "{shared} of {} and {}", coarse.len(), fine.len());
}

pub(super) const OAK: TreeFootprint = TreeFootprint {
    height_m: 12.0,
    trunk_radius_m: 0.3,
    crown_radius_m: 4.0,
    root_depth_m: 0.2,
    clear_trunk: 0.2,
};

pub(super) fn usual() -> PlacementParams {
    PlacementParams {
        tree_seed: 7,
        height_variation: 0.2,
        density_per_ha: 40.0,
        clustering: 0.5,
        steepest_slope_deg: 35.0,
        altitude_limit: 0.8,
        hardiness_c: -10.0,
        terrain_seed: 0,
        temperature_c: 9.0,
        rain_mm: 800.0,
    }
}

#[test]
fn hundreds_to_thousands_and_more_where_more_are_asked_for() {
    let land = land(3, 60.0, 0.1, 257);
    let count =
        |density_per_ha| planted(&PlacementParams { density_per_ha, ..usual() }, &land, None, &[OAK]).len();
    // However few are asked for, some are in sight from anywhere.
    let mut before = count(5.0);
    assert!((500..700).contains(&before), "{before}");
    for density_per_ha in [20.0, 60.0, 200.0, 600.0] {
        let count = count(density_per_ha);
        assert!(count > before && count < MAX_TREES as usize, "{density_per_ha}/ha: {count}");
        before = count;
    }
    assert!(before > 2000, "{before}");
}

/// Clark and Evans, 1954: mean distance to the nearest neighbour over that of points thrown at random. Above 1 is
/// even, below 1 clustered.
fn clark_evans(instances: &[Instance]) -> f32 {
    let nearest = |a: &Instance| {
        let others = instances.iter().filter(|b| *b != a);
        others.map(|b| (origin(a) - origin(b)).with_y(0.0).length()).fold(f32::MAX, f32::min)
    };
    let mean = instances.iter().map(nearest).sum::<f32>() / instances.len() as f32;
    mean / (0.5 * (1024.0 * 1024.0 / instances.len() as f32).sqrt())
}

#[test]
fn clustering_goes_from_even_to_groves() {
    let mut land = land(3, 10.0, 0.0, 129);
    land.flow.fill(0.0);
    let index = |clustering| {
        let params = PlacementParams { clustering, density_per_ha: 8.0, altitude_limit: 1.0, ..usual() };
        clark_evans(&planted(&params, &land, None, &[OAK]))
    };
    let (even, half, groves) = (index(0.0), index(0.5), index(1.0));
    // Even groves stay above 1 themselves: the index is of both. What counts is how far it falls.
    assert!(even > 1.25 && even > half && half > groves && groves < 0.8 * even, "{even} {half} {groves}");
}

#[test]
fn trees_are_smaller_at_the_tree_line() {
    let land = land(5, 200.0, 0.0, 257);
    let params = PlacementParams { clustering: 0.0, altitude_limit: 0.6, ..usual() };
    let [low, high] = land.field.range_m();
    let (mut near, mut below) = (Vec::new(), Vec::new());
    for instance in planted(&params, &land, None, &[OAK]) {
        let altitude = (origin(&instance).y - low) / (high - low);
        let size = libm::cbrtf(linear(&instance).determinant());
        if altitude > 0.56 {
            near.push(size)
        } else if altitude < 0.5 {
            below.push(size)
        }
    }
    let mean = |sizes: &[f32]| sizes.iter().sum::<f32>() / sizes.len() as f32;
    assert!(near.len() > 5 && mean(&near) < 0.85 * mean(&below), "{} {}", mean(&near), mean(&below));
}

#[test]
fn hopeless_land_and_no_templates_give_no_trees() {
    let mut drowned = land(1, 50.0, 0.0, 129);
    assert!(planted(&usual(), &drowned, None, &[]).is_empty());
    drowned.water_level_m = Some(1000.0);
    assert!(planted(&usual(), &drowned, None, &[OAK]).is_empty());
}

#[test]
fn only_hardy_trees_stand_on_snow() {
    let land = land(3, 200.0, 0.1, 257);
    // Snow in the northern half.
    let parts = (0..129 * 129).map(|k| if k < 64 * 129 { 1.0 } else { 0.0 }).collect();
    let snow = SnowMap { side: 129, extent_m: 1024.0, parts };
    let on_snow = |hardiness_c: f32, temperature_c: f32| {
        let params = PlacementParams { hardiness_c, temperature_c, ..usual() };
        let instances = planted(&params, &land, Some(&snow), &[OAK]);
        let on_snow = instances.iter().filter(|tree| snow.at(origin(tree).x, origin(tree).z) > 0.3).count();
        (on_snow, instances.len())
    };
    for (hardiness_c, temperature_c) in [(4.0, 9.0), (-1.0, 25.0), (-4.0, -5.0), (20.0, -9.0)] {
        let (on_snow, all) = on_snow(hardiness_c, temperature_c);
        assert!(on_snow == 0 && all > 40, "{hardiness_c} at {temperature_c}: {on_snow} of {all}");
    }
    for (hardiness_c, temperature_c) in [(-10.0, 9.0), (-6.0, 3.0), (-10.0, -5.0)] {
        let (on_snow, all) = on_snow(hardiness_c, temperature_c);
        assert!(on_snow > all / 4, "{hardiness_c} at {temperature_c}: {on_snow} of {all}");
    }
}

#[test]
fn trees_in_the_cold_are_few_and_small() {
    let land = land(3, 60.0, 0.0, 257);
    let forest = |temperature_c: f32| {
        let params = PlacementParams { hardiness_c: 10.0, temperature_c, density_per_ha: 150.0, ..usual() };
        let made = planted(&params, &land, None, &[OAK]);
        let size = made.iter().map(|tree| libm::cbrtf(linear(tree).determinant())).sum::<f32>();
        (made.len() as f32, size / made.len() as f32)
    };
    let [warm, cool, cold] = [12.0, 7.0, -9.0].map(forest);
    assert_eq!(warm, forest(13.2), "warm enough is warm enough");
    assert!(cool.0 < warm.0 && cold.0 < 0.5 * warm.0, "{warm:?} {cool:?} {cold:?}");
    assert!(cool.1 < 0.95 * warm.1 && cold.1 < 0.6 * warm.1, "{warm:?} {cool:?} {cold:?}");
}

#[test]
fn trees_of_a_desert_stand_by_water() {
    let land = land(4, 60.0, 0.2, 257);
    let mean_flow = |rain_mm: f32| {
        let params = PlacementParams { rain_mm, temperature_c: 25.0, clustering: 0.0, ..usual() };
        let made = planted(&params, &land, None, &[OAK]);
        let shore = land.water_level_m.expect("a lake") + 6.0;
        let site = Site::new(&params, &land, None);
        let near =
            |tree: &&Instance| site.flow(origin(tree).x, origin(tree).z) > 0.3 || origin(tree).y < shore;
        made.iter().filter(near).count() as f32 / made.len() as f32
    };
    let (forest, desert) = (mean_flow(2500.0), mean_flow(100.0));
    assert!(desert > 0.7 && forest < 0.6, "{desert} by water, {forest} where it rains");
}

#[test]
fn no_tree_that_needs_warmth_stands_where_the_ground_is_white() {
    let land = Landform { snow_line_m: 90.0, ..land(6, 200.0, 0.1, 257) };
    let genes = GroundParams {
        terrain_seed: 5,
        talus_angle_deg: 33.0,
        snow_line: 0.45,
        temperature_c: 6.0,
        rain_mm: 1000.0,
    };
    let white = ground::maps(&genes, &ground::Woods::none(ground::Season::default()), &land, 1024).weights;
    let snow = ground::snow_map(genes.terrain_seed, &land);
    let params = PlacementParams { terrain_seed: 5, hardiness_c: 2.0, altitude_limit: 1.0, ..usual() };
    let made = planted(&params, &land, snow.as_ref(), &[OAK]);
    assert!(made.len() > 100, "{}", made.len());
    for tree in &made {
        let [x, z] = [origin(tree).x, origin(tree).z].map(|m| (m + 512.0) as u32);
        let part = white.pixel(x, z)[2];
        assert!(part < 150, "{part}/255 of snow at {x}, {z}");
    }
    let hardy = planted(&PlacementParams { hardiness_c: -10.0, ..params }, &land, snow.as_ref(), &[OAK]);
    let in_white = hardy.iter().filter(|tree| origin(tree).y > 110.0).count();
    assert!(in_white > 20, "{in_white}");
}

#[test]
fn hardly_a_tree_stands_on_farmed_land() {
    let wild = land(3, 40.0, 0.0, 257);
    let farmed = |k: usize| if k % 257 < 128 { 1.0 } else { 0.0 };
    let half = Landform { paddies: Some((0..257 * 257).map(farmed).collect()), ..wild.clone() };
    let west = |land: &Landform| {
        let trees = planted(&PlacementParams { density_per_ha: 60.0, ..usual() }, land, None, &[OAK]);
        let [west, east] = [true, false]
            .map(|is_west| trees.iter().filter(|tree| (tree.world_from_tree[0][3] < 0.0) == is_west).count());
        west as f32 / east as f32
    };
    assert!(west(&wild) > 0.5 && west(&half) < 0.1, "{} and {}", west(&wild), west(&half));
}
