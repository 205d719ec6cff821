//! Small plants and stones: where they stand, and what they are made of.

use glam::Vec3;

use super::*;

/// The density in bytes of a kind of plants at each pixel of its map, with the height of the land above the lake.
fn stands(plants: &GroundPlants<Image8>, name: &str) -> Vec<(u8, f32)> {
    let Some(kind) = plants.kinds.iter().find(|kind| kind.name == name) else { return Vec::new() };
    let map = &plants.maps[kind.channel as usize / 4];
    let water_m = LAND.water_level_m.expect("a lake");
    let place = |k: u32| ((k as f32 + 0.5) / map.width as f32 - 0.5) * 1024.0;
    let above_m = |i: u32, j: u32| LAND.field.height_m(place(i), place(j)) - water_m;
    let pixels = (0..map.height).flat_map(|j| (0..map.width).map(move |i| (i, j)));
    pixels.map(|(i, j)| (map.pixel(i, j)[kind.channel as usize % 4], above_m(i, j))).collect()
}

#[test]
fn reeds_stand_at_the_shore_and_flowers_where_it_is_dry() {
    let grow = |name: &str| {
        let there: Vec<f32> = stands(&FINE.plants, name)
            .into_iter()
            .filter(|&(part, _)| part > 8)
            .map(|(_, above_m)| above_m)
            .collect();
        assert!(!there.is_empty(), "no {name} grows");
        there
    };
    assert!(grow("reed").iter().all(|above_m| (-0.6..0.6).contains(above_m)));
    for name in ["flower", "tussock", "shrub", "spire", "umbel", "hay", "herb"] {
        assert!(grow(name).iter().all(|&above_m| above_m > -0.05), "{name}");
    }
    assert!(grow("boulder").iter().all(|&above_m| above_m > -0.6));
    let drained = Landform { water_level_m: None, ..LAND.clone() };
    let dry = maps(&PARAMS, &Woods::none(Season::default()), &drained, 128).plants;
    assert!(dry.maps[0].data.iter().skip(3).step_by(4).all(|&part| part == 0), "reeds without a lake");
}

/// All of them, with the parts of rock, scree, snow and earth within two metres.
fn standing(maps: &GroundMaps<Image8>) -> Vec<(&PlantKind, crate::model::Plant, [f32; 4])> {
    let half_m = 0.5 * LAND.field.extent_m();
    let part = |m: f32| 0.5 + 0.5 * m / half_m;
    let last = maps.weights.width - 1;
    let pixel = |m: f32| ((part(m) * (last + 1) as f32) as u32).min(last);
    let mut all = Vec::new();
    for kind in &maps.plants.kinds {
        let map = &maps.plants.maps[kind.channel as usize / 4];
        let map = DensityMap { width_px: map.width, height_px: map.height, rgba: &map.data };
        let lines = (half_m / kind.cell_m()) as i32;
        for (j, i) in (-lines..lines).flat_map(|j| (-lines..lines).map(move |i| (j, i))) {
            let density = |x: f32, z: f32| map.at(kind.channel, part(x), part(z));
            let Some(plant) = kind.in_cell([i, j], density) else { continue };
            let mut weights = [0.0; 4];
            for (x, z) in (-2..=2).flat_map(|x| (-2..=2).map(move |z| (x as f32, z as f32))) {
                let texel = maps.weights.pixel(pixel(plant.x_m + x), pixel(plant.z_m + z));
                (0..4).for_each(|k| weights[k] += f32::from(texel[k]) / (25.0 * 255.0));
            }
            all.push((kind, plant, weights));
        }
    }
    all
}

#[test]
fn nothing_stands_in_water_in_snow_or_on_cliffs() {
    let water_m = LAND.water_level_m.expect("a lake");
    let (mut counts, mut on_rock, mut hidden) = (std::collections::BTreeMap::new(), 0, 0);
    for (kind, plant, [rock, _, snow, _]) in standing(&FINE) {
        let name = kind.name.as_str();
        *counts.entry(name).or_insert(0) += 1;
        let above_m = LAND.field.height_m(plant.x_m, plant.z_m) - water_m;
        let is_stone = ["stone", "boulder"].contains(&name);
        // Stones may lie on the bed of a lake.
        let lowest_m = if is_stone {
            f32::NEG_INFINITY
        } else if name == "reed" {
            -0.8
        } else {
            -0.1
        };
        assert!(above_m > lowest_m, "a {name} at {above_m} m");
        assert!(name != "reed" || above_m < 0.8, "a reed {above_m} m above the lake");
        let steep = [[2.0, 0.0], [0.0, 2.0]].map(|[x, z]| {
            let height_m = |way: f32| LAND.field.height_m(plant.x_m + way * x, plant.z_m + way * z);
            (height_m(1.0) - height_m(-1.0)) / 4.0
        });
        let slope = (steep[0] * steep[0] + steep[1] * steep[1]).sqrt();
        assert!(name != "boulder" || slope < 1.5, "a boulder on a slope of {slope}");
        assert!(is_stone || snow < 0.5, "a {name} in the snow, which is {snow} of the ground around");
        hidden += usize::from(name != "boulder" && snow > 0.8);
        on_rock += usize::from(!is_stone && rock > 0.8);
    }
    // A few stand in clefts, where patches of snow and rock are smaller than pixels of the maps.
    let few = counts.values().sum::<usize>() / 1000;
    assert!(on_rock < few && hidden < few, "{on_rock} on rock, {hidden} in snow");
    let common = ["flower", "tussock", "stone", "boulder"];
    assert!(common.iter().all(|name| counts.get(name) > Some(&10)), "{counts:?}");
}

#[test]
fn the_foreground_has_no_more_plants_than_a_file_can_bear() {
    let mut crowded = maps(&PARAMS, &Woods::none(Season::default()), &LAND, 256);
    crowded.plants.maps.iter_mut().for_each(|map| map.data.fill(255));
    let (_, made) = cut_with(&crowded.plants, 10.0, -35.0);
    let count = made.grass.parts[1].triangles.len() + made.stones.mesh.triangle_count();
    assert!((standing::MAX_TRIANGLES * 9 / 10..=standing::MAX_TRIANGLES).contains(&count), "{count}");
    let used: std::collections::BTreeSet<u32> =
        made.grass.parts.iter().flat_map(|part| part.triangles.as_flattened()).copied().collect();
    assert_eq!(used.len(), made.grass.positions.len(), "vertices that no triangle has");
}

#[test]
fn stones_of_the_foreground_have_the_texture_of_rock_nowhere_stretched() {
    let mut rough = MAPS.plants.clone();
    rough.maps.iter_mut().for_each(|map| map.data.fill(255));
    rough.kinds.retain(|kind| kind.texture.is_some());
    let (_, made) = cut_with(&rough, 10.0, -35.0);
    assert!(made.grass.parts[1].triangles.is_empty(), "a stone among the leaves");
    let mesh = &made.stones.mesh;
    assert!(mesh.triangle_count() > 1000, "{}", mesh.triangle_count());
    for triangle in mesh.parts.iter().flat_map(|part| &part.triangles) {
        let [a, b, c] = triangle.map(|v| glam::Vec3::from_array(mesh.positions[v as usize]));
        let [p, q, r] = triangle.map(|v| glam::Vec2::from_array(mesh.uvs[v as usize]));
        let area = (b - a).cross(c - a).length();
        let tiles = (q - p).perp_dot(r - p).abs() * standing::STONE_TILE_M * standing::STONE_TILE_M;
        // A face is seen at 55° at most; feet follow the ground, so that what stands on a slope is sheared.
        assert!(area < 1e-4 || (0.25..3.0).contains(&(tiles / area)), "{tiles} m² of tiles on {area} m²");
    }
}

#[test]
fn leaves_of_the_foreground_are_lit_on_the_side_that_is_seen_first() {
    let mut leafy = MAPS.plants.clone();
    leafy.maps.iter_mut().for_each(|map| map.data.fill(255));
    leafy.kinds.retain(|kind| kind.sway > 0.0);
    let (east_m, south_m) = (10.0, -35.0);
    let (_, made) = cut_with(&leafy, east_m, south_m);
    let eye = glam::Vec3::new(east_m, LAND.field.height_m(east_m, south_m) + 1.6, south_m);
    let leaves = &made.grass.parts[1].triangles;
    assert!(leaves.len() > 1000, "{}", leaves.len());
    for leaf in leaves {
        let of = |values: &[[f32; 3]]| leaf.map(|v| glam::Vec3::from_array(values[v as usize]));
        let ([a, b, c], normals) = (of(&made.grass.positions), of(&made.grass.normals));
        let front = (b - a).cross(c - a).normalize_or_zero();
        assert!(front.dot(eye - a) > -1e-3, "one sees the back of {a} {b} {c}");
        assert!(normals.iter().all(|normal| normal.dot(front) > -0.05), "{a} {b} {c} is lit from behind");
    }
}

#[test]
fn few_enough_stand_within_reach_to_draw_them_each_frame() {
    let mut farmed = LAND.clone();
    farmed.paddies = Some(vec![1.0; LAND.flow.len()]);
    for kinds in [&LAND, &farmed].map(|land| plants::all_kinds(&PARAMS, land)) {
        let most = |kind: &PlantKind| kind.per_m2 * std::f32::consts::PI * kind.reach_m * kind.reach_m;
        assert!(kinds.len() == 16 && kinds.iter().all(|kind| most(kind) < 20_000.0));
        assert!(kinds.iter().all(|kind| kind.shape.triangles.len() <= 300 && kind.shape.coarse <= 100));
    }
}

#[test]
fn flowers_do_not_hang_in_the_air() {
    let kinds = plants::all_kinds(&PARAMS, &LAND);
    for kind in kinds.iter().filter(|kind| ["flower", "umbel"].contains(&kind.name.as_str())) {
        let shape = &kind.shape;
        let at = |v: u32| Vec3::from_array(shape.positions_m[v as usize]);
        let tint = |v: u32| shape.tints[v as usize];
        // A stem or a ray, where it is as wide as one sees it.
        let width = |t: &[u32; 3]| {
            let ends = [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]
                .map(|[a, b]| (at(a).distance(at(b)), at(a).midpoint(at(b))));
            ends.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(wide_m, _)| *wide_m > 0.002)
        };
        let of_stems = shape.triangles.iter().filter(|t| t.iter().all(|&v| tint(v) <= 0.2));
        let carried: Vec<Vec3> = of_stems.filter_map(width).map(|(_, at)| at).collect();
        let mut petals = (0..shape.tints.len() as u32).filter(|&v| tint(v) >= 0.7).peekable();
        assert!(petals.peek().is_some());
        for petal in petals.map(at) {
            let away_m = carried.iter().map(|stem| stem.distance(petal)).fold(f32::MAX, f32::min);
            assert!(away_m < 0.13, "a petal {away_m} m from any stem");
        }
    }
}

#[test]
fn no_plant_grows_on_rock_or_snow() {
    let (weights, side) = (&MAPS.weights, MAPS.plants.maps[0].width);
    for (k, growth) in MAPS.plants.maps[0].data.chunks_exact(4).enumerate() {
        let (i, j) = (2 * (k as u32 % side), 2 * (k as u32 / side));
        let around = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, y)| weights.pixel(i + x, j + y));
        let bare = around.iter().all(|w| u32::from(w[0]) + u32::from(w[2]) > 250);
        assert!(!bare || growth[..3].iter().all(|&part| part < 100), "{growth:?} at {i}, {j}");
    }
}

const MAPLE: LitterParams = LitterParams {
    height_m: 14.0,
    leaves_per_stem: 20,
    secondary_branches: 20,
    leaf_shape: 4,
    leaf_size_m: 0.1,
    leaf_hue_deg: 30.0,
    blossom: 0.0,
};

/// A tree at a place, upright.
fn tree(x: f32, z: f32) -> crate::model::Instance {
    let y = LAND.field.height_m(x, z);
    crate::model::Instance {
        template: 0,
        world_from_tree: [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]],
        trunk_cylinder_m: [x, z, 0.3],
    }
}

#[test]
fn leaves_lie_under_their_tree_and_in_its_colour() {
    // The greenest place, so that nothing else lies there.
    let green = |k: u32| MAPS.weights.pixel(k % 256, k / 256).iter().map(|&w| u32::from(w)).sum::<u32>();
    let inside = |k: &u32| (20..236).contains(&(k % 256)) && (20..236).contains(&(k / 256));
    let around = |k: u32| [0, 1, 2, 256, 512, 514].map(|d| green(k + d)).iter().sum::<u32>();
    let k = (0..65536).filter(inside).min_by_key(|&k| around(k)).expect("a place");
    let [x, z] = [k % 256 + 1, k / 256 + 1].map(|k| (k as f32 + 0.5) * 4.0 - 512.0);
    let woods = Woods::new(&MAPLE, &LAND, &[tree(x, z)], &[9.0]);
    let made = maps(&PARAMS, &woods, &LAND, 256);
    let without = maps(&PARAMS, &Woods::new(&MAPLE, &LAND, &[], &[9.0]), &LAND, 256);
    let (mut reddest, mut changed) = (0.0f32, 0);
    for (k, (new, old)) in made.color.data.chunks_exact(3).zip(without.color.data.chunks_exact(3)).enumerate()
    {
        if new == old {
            continue;
        }
        let [dx, dz] = [(k % 256, x), (k / 256, z)].map(|(k, m)| (k as f32 + 0.5) * 4.0 - 512.0 - m);
        assert!((dx * dx + dz * dz).sqrt() < 16.0, "{dx} {dz}");
        reddest = reddest.max(f32::from(new[0]) / f32::from(new[1]));
        changed += 1;
    }
    assert!(changed > 4 && reddest > 1.15, "{changed} {reddest}");
    let of = |plants: &GroundPlants<Image8>| {
        stands(plants, "litter").iter().filter(|(part, _)| *part > 60).count()
    };
    assert!(of(&made.plants) > 1 && of(&MAPS.plants) == 0);
    let bare = Woods::new(&LitterParams { leaves_per_stem: 0, ..MAPLE }, &LAND, &[tree(x, z)], &[9.0]);
    assert!(of(&maps(&PARAMS, &bare, &LAND, 256).plants) > 1, "last autumn's leaves lie under bare trees");
}

#[test]
fn young_trees_and_dead_ones_stand_by_trees_alone() {
    let half_m = 0.5 * LAND.field.extent_m();
    let part = |m: f32| ((0.5 + 0.5 * m / half_m) * 128.0) as u32;
    let is_green = |[x, z]: [f32; 2]| MAPS.weights.pixel(2 * part(x), 2 * part(z)).iter().all(|&w| w < 40);
    let lines = || (-22..22).map(|k| 20.0 * k as f32);
    let places: Vec<[f32; 2]> =
        lines().flat_map(|x| lines().map(move |z| [x, z])).filter(|&at| is_green(at)).collect();
    let trees: Vec<_> = places.iter().step_by(2).map(|&[x, z]| tree(x, z)).collect();
    let made = maps(&PARAMS, &Woods::new(&MAPLE, &LAND, &trees, &[6.0]), &LAND, 256);
    let near = |k: usize| {
        let [x, z] = [k as u32 % 128, k as u32 / 128].map(|k| ((k as f32 + 0.5) / 64.0 - 1.0) * half_m);
        trees
            .iter()
            .any(|tree| libm::hypotf(tree.trunk_cylinder_m[0] - x, tree.trunk_cylinder_m[1] - z) < 20.0)
    };
    for name in ["sapling", "log", "stump"] {
        let parts = stands(&made.plants, name);
        assert!(parts.iter().filter(|(part, _)| *part > 60).count() > 5, "hardly any {name}");
        assert!(
            parts.iter().enumerate().all(|(k, (part, _))| *part == 0 || near(k)),
            "a {name} far from trees"
        );
        assert!(stands(&MAPS.plants, name).is_empty(), "a {name} without a tree");
    }
    let bushes =
        |plants: &GroundPlants<Image8>| stands(plants, "bush").iter().filter(|(part, _)| *part > 60).count();
    assert!(bushes(&made.plants) > bushes(&MAPS.plants) + 20, "no bushes at the edge of the woods");
}

#[test]
fn nothing_solid_lies_in_a_tree_or_in_another() {
    let lines = || (-60..60).map(|k| 8.0 * k as f32);
    let trees: Vec<_> = lines().flat_map(|x| lines().map(move |z| tree(x, z))).collect();
    let made = maps(&PARAMS, &Woods::new(&MAPLE, &LAND, &trees, &[6.0]), &LAND, 1024);
    // Along a fallen trunk, and the middle of what is round.
    let points = |kind: &PlantKind, plant: &crate::model::Plant| -> Vec<glam::Vec2> {
        let half_m = if kind.name == "log" { 2.2 * plant.scale } else { 0.0 };
        let axis = glam::Vec2::from_angle(plant.turn_rad);
        let middle = glam::Vec2::new(plant.x_m, plant.z_m);
        (-8..=8).map(|k| middle + k as f32 / 8.0 * half_m * axis).collect()
    };
    let solid: Vec<_> = standing(&made)
        .into_iter()
        .filter(|(kind, ..)| ["boulder", "stump", "log"].contains(&kind.name.as_str()))
        .map(|(kind, plant, _)| (kind.name.as_str(), points(kind, &plant)))
        .collect();
    let logs = solid.iter().filter(|(name, _)| *name == "log").count();
    assert!(logs > 100, "{logs} fallen trunks");
    for (n, (name, points)) in solid.iter().enumerate() {
        for point in points {
            let from_stem = trees.iter().map(|tree| {
                let [x, z, radius_m] = tree.trunk_cylinder_m;
                point.distance(glam::Vec2::new(x, z)) - radius_m
            });
            let nearest_m = from_stem.fold(f32::MAX, f32::min);
            assert!(nearest_m > 0.0, "a {name} at {point}, {nearest_m} m from a trunk");
        }
        for (other, theirs) in solid[..n].iter().filter(|(_, theirs)| theirs[8].distance(points[8]) < 9.0) {
            let apart_m =
                points.iter().flat_map(|p| theirs.iter().map(|q| p.distance(*q))).fold(f32::MAX, f32::min);
            assert!(apart_m > 0.2, "a {name} and a {other} at {}, {apart_m} m apart", points[8]);
        }
    }
}

#[test]
fn nothing_high_stands_before_a_lookout() {
    let half_m = 0.5 * LAND.field.extent_m();
    for kind in FINE.plants.kinds.iter().filter(|kind| ["boulder", "bush"].contains(&kind.name.as_str())) {
        let map = &FINE.plants.maps[kind.channel as usize / 4];
        let map = DensityMap { width_px: map.width, height_px: map.height, rgba: &map.data };
        let around =
            |place: glam::Vec2| (0..8).map(move |k| place + 5.0 * glam::Vec2::from_angle(k as f32 * 0.785));
        for at in crate::model::Lookout::places_m(2.0 * half_m).flat_map(around) {
            let [u, v] = [at.x, at.y].map(|m| 0.5 + 0.5 * m / half_m);
            assert_eq!(map.at(kind.channel, u, v), 0.0, "a {} at {at}", kind.name);
        }
    }
}

#[test]
fn shapes_stand_on_the_ground_and_are_made_of_proper_triangles() {
    for PlantKind { name, shape, scale, per_m2, .. } in &MAPS.plants.kinds {
        let count = shape.positions_m.len();
        assert!(count == shape.normals.len() && count == shape.tints.len(), "{name}");
        assert!(shape.coarse > 0 && shape.coarse as usize <= shape.triangles.len(), "{name}");
        let low = shape.positions_m.iter().map(|p| p[1]).fold(f32::MAX, f32::min);
        assert!((-0.25..=0.03).contains(&low), "{name} begins at {low} m");
        for corners in &shape.triangles {
            let [a, b, c] = corners.map(|v| glam::Vec3::from_array(shape.positions_m[v as usize]));
            let front = (b - a).cross(c - a);
            assert!(front.length() > 1e-6, "{name}: {a} {b} {c}");
            let lit: glam::Vec3 =
                corners.map(|v| glam::Vec3::from_array(shape.normals[v as usize])).iter().sum();
            // Normals are rounded.
            assert!(front.normalize().dot(lit) > -0.01, "{name} is lit from behind: {a} {b} {c}");
        }
        assert!(scale[0] > 0.0 && scale[0] <= scale[1] && *per_m2 > 0.0, "{name}");
        assert!(shape.tints.iter().all(|tint| (0.0..=1.0).contains(tint)), "{name}");
    }
}

#[test]
fn small_plants_of_the_foreground_stand_where_the_maps_have_them() {
    let (_, made) = cut(10.0, -35.0);
    let [_, leafy] = &made.grass.parts[..] else { panic!("grass and plants") };
    let stones = made.stones.mesh.parts.iter().map(|part| (&made.stones.mesh, part));
    let all = || stones.clone().chain([(&made.grass, leafy)]);
    let count: usize = all().map(|(_, part)| part.triangles.len()).sum();
    assert!(count > 200, "{count} triangles");
    for (mesh, corner) in
        all().flat_map(|(mesh, part)| part.triangles.as_flattened().iter().map(move |corner| (mesh, corner)))
    {
        let [x, y, z] = mesh.positions[*corner as usize];
        let above = y - LAND.field.height_m(x, z);
        assert!((-1.0..3.0).contains(&above), "{above} m above the ground");
    }
}

#[test]
fn the_ground_has_the_season_of_its_trees() {
    let seen = |trees: LitterParams| {
        let made = maps(&PARAMS, &Woods::new(&trees, &LAND, &[], &[]), &LAND, 256);
        let flowers: u32 = stands(&made.plants, "flower").iter().map(|(part, _)| u32::from(*part)).sum();
        let [mut red, mut green] = [0u64; 2];
        for (color, weights) in made.color.data.chunks_exact(3).zip(made.weights.data.chunks_exact(4)) {
            if weights.iter().all(|&part| part == 0) {
                red += u64::from(color[0]);
                green += u64::from(color[1]);
            }
        }
        (flowers, green as f64 / red as f64)
    };
    let leafy = LitterParams { leaf_hue_deg: 100.0, ..MAPLE };
    let [summer, autumn] = [leafy.clone(), MAPLE].map(seen);
    let winter = seen(LitterParams { leaves_per_stem: 0, ..leafy.clone() });
    let spring = seen(LitterParams { blossom: 0.3, ..leafy.clone() });
    assert!(summer.0 > 2 * autumn.0 && autumn.0 > 0 && winter.0 == 0, "{summer:?} {autumn:?} {winter:?}");
    assert!(summer.1 > autumn.1 + 0.02 && autumn.1 > winter.1 + 0.02, "{summer:?} {autumn:?} {winter:?}");
    assert!(spring.0 == summer.0 && spring.1 > summer.1 + 0.02, "{spring:?} {summer:?}");
    // Dead trees, which have no twigs either, stand in any season.
    let dead = LitterParams { leaves_per_stem: 0, secondary_branches: 0, ..leafy.clone() };
    assert_eq!(seen(dead), summer);
    // Another green is the same summer: what is kept of the ground stays.
    assert_eq!(
        Season::of(&leafy),
        Season::of(&LitterParams { leaf_hue_deg: 85.0, leaves_per_stem: 9, ..leafy })
    );
}

#[test]
fn tall_flowers_stand_in_drifts_and_hay_stands_through_the_winter() {
    let summer = LitterParams { leaf_hue_deg: 100.0, ..MAPLE };
    let winter = LitterParams { leaves_per_stem: 0, ..summer.clone() };
    let grown = |trees: &LitterParams, terrain_seed: u32| {
        let params = GroundParams { terrain_seed, ..PARAMS };
        maps(&params, &Woods::new(trees, &LAND, &[], &[]), &LAND, 256).plants
    };
    let amount = |plants: &GroundPlants<Image8>, name: &str| {
        stands(plants, name).iter().map(|(part, _)| u64::from(*part)).sum::<u64>()
    };
    let (green, asleep) = (grown(&summer, PARAMS.terrain_seed), grown(&winter, PARAMS.terrain_seed));
    for name in ["spire", "umbel", "herb"] {
        assert!(amount(&green, name) > 0 && amount(&asleep, name) == 0, "{name} in winter");
    }
    assert!(amount(&asleep, "hay") == amount(&green, "hay"));
    // Where one kind is thick the other is not.
    let densest = |plants: &GroundPlants<Image8>, name: &str| {
        stands(plants, name).iter().map(|(part, _)| *part).max().unwrap_or(0)
    };
    let has_both =
        |plants: &GroundPlants<Image8>| ["spire", "umbel"].iter().all(|name| densest(plants, name) > 200);
    let rich = (0..40).map(|seed| grown(&summer, seed)).find(has_both).expect("a land with many of both");
    let [mut spires, mut mixed] = [0; 2];
    for ((spire, _), (umbel, _)) in stands(&rich, "spire").into_iter().zip(stands(&rich, "umbel")) {
        spires += usize::from(spire > 90);
        mixed += usize::from(spire > 90 && umbel > 90);
    }
    assert!(spires > 50 && mixed * 20 < spires, "{mixed} of {spires}");
    // Some lands have many, some have none.
    let many: Vec<u64> = (0..8).map(|seed| amount(&grown(&summer, seed), "spire")).collect();
    assert!(many.contains(&0) && many.iter().any(|&sum| sum > 50_000), "{many:?}");
}

#[test]
fn rice_grows_in_fields_and_nothing_else_does() {
    let mut land = LAND.clone();
    land.paddies = Some(vec![1.0; land.flow.len()]);
    let made = maps(&PARAMS, &Woods::none(Season::default()), &land, 256);
    let names: Vec<&str> = made.plants.kinds.iter().map(|kind| kind.name.as_str()).collect();
    assert!(!names.is_empty() && names.iter().all(|name| name.ends_with("rice")), "weeds grow: {names:?}");
    let corners = [(0, 0), (1, 0), (0, 1), (1, 1)];
    let is_level = |i: u32, j: u32| LAND.field.normal_at(i, j).y > 0.995;
    let level = |k: u32| corners.iter().all(|&(di, dj)| is_level(k % 256 + di, k / 256 + dj));
    let dry: Vec<u8> = made.color.data.chunks_exact(4).map(|rgba| rgba[3]).collect();
    let pixels = || made.weights.data.chunks_exact(4).zip(&dry).zip(0..);
    let is_bare =
        |weights: &[u8], dry: u8| weights[..3].iter().any(|&w| w > 0) || (dry == 255) == (weights[3] > 0);
    let bare = pixels().filter(|&((weights, &dry), k)| level(k) && is_bare(weights, dry)).count();
    assert_eq!(bare, 0, "rock, scree, snow, earth without water, or water without earth on level fields");
    // Fields of young rice are flooded, and no bank is.
    let steep =
        |k: u32| corners.iter().all(|&(di, dj)| LAND.field.normal_at(k % 256 + di, k / 256 + dj).y < 0.94);
    assert!(pixels().all(|((_, &dry), k)| !steep(k) || dry == 255), "water on a slope");
    // Water stands on what is level, as all of these fields are.
    land.field.heights_m.fill(land.water_level_m.expect("a lake") + 20.0);
    let flooded = |seed| {
        let params = GroundParams { terrain_seed: seed, ..PARAMS };
        let color = maps(&params, &Woods::none(Season::default()), &land, 64).color;
        color.data.chunks_exact(4).filter(|rgba| rgba[3] == 0).count()
    };
    let counts: Vec<usize> = (0..12).map(flooded).collect();
    assert!(counts.contains(&0) && counts.iter().any(|&count| count > 200), "{counts:?} of 4096 under water");
}

#[test]
fn water_stands_in_fields_alone() {
    let made = maps(&PARAMS, &Woods::none(Season::default()), &LAND, 64);
    assert_eq!(made.color.channels, 3);
    let mut land = LAND.clone();
    let farmed = |k: usize| if k % LAND.field.side as usize > 128 { 1.0 } else { 0.0 };
    land.paddies = Some((0..land.flow.len()).map(farmed).collect());
    for seed in 0..12 {
        let params = GroundParams { terrain_seed: seed, ..PARAMS };
        let GroundMaps { color, plants, .. } = maps(&params, &Woods::none(Season::default()), &land, 256);
        let is_dry = |k: u32| color.pixel(k % 256, k / 256)[3] == 255;
        assert!(
            (0..256 * 256).filter(|k| k % 256 < 126).all(is_dry),
            "seed {seed}: water where nothing is farmed"
        );
        for rice in ["rice", "ripe rice"] {
            let stands = stands(&plants, rice);
            let wild =
                (0..128 * 128).filter(|k| k % 128 < 63 && stands.get(*k).is_some_and(|(part, _)| *part > 0));
            assert_eq!(wild.count(), 0, "seed {seed}: {rice} where nothing is farmed");
        }
    }
}

#[test]
fn tussocks_stand_where_little_else_grows_and_boulders_in_some_lands_alone() {
    let grown = |terrain_seed: u32, temperature_c: f32, rain_mm: f32| {
        let params = GroundParams { terrain_seed, temperature_c, rain_mm, ..PARAMS };
        maps(&params, &Woods::none(Season::default()), &LAND, 128).plants
    };
    let amount = |plants: &GroundPlants<Image8>, name: &str| {
        stands(plants, name).iter().map(|(part, _)| u64::from(*part)).sum::<u64>()
    };
    let of = |temperature_c: f32, rain_mm: f32| -> u64 {
        (0..6).map(|seed| amount(&grown(seed, temperature_c, rain_mm), "tussock")).sum()
    };
    let (meadow, steppe, forest) = (of(10.0, 900.0), of(9.0, 380.0), of(26.0, 3000.0));
    assert!(steppe > meadow + meadow / 2 && 2 * meadow > 3 * forest, "{steppe} {meadow} {forest}");
    let boulders: Vec<u64> = (0..10).map(|seed| amount(&grown(seed, 4.0, 700.0), "boulder")).collect();
    // Below cliffs they lie in all of them.
    let least = *boulders.iter().min().expect("ten");
    let beside = |part: u64| boulders.iter().filter(|&&sum| sum > least + least / part).count();
    assert!(least > 0 && (3..8).contains(&beside(10)) && beside(25) < 8, "{boulders:?}");
}
