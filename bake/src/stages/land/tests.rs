//! Properties of the land.

use super::*;

/// Genes anywhere in their ranges, from a number.
pub(crate) fn random_params(k: u32) -> LandParams {
    let gene = |i: i32, lo: f32, hi: f32| lo + (hi - lo) * crate::noise::hash01(k, i, 1, 2);
    let log = |i: i32, lo: f32, hi: f32| lo * libm::powf(hi / lo, gene(i, 0.0, 1.0));
    LandParams {
        terrain_seed: k * 37 % 256,
        relief_m: log(1, 15.0, 420.0),
        wavelength_m: log(2, 200.0, 2000.0),
        hurst: gene(3, 0.5, 1.3),
        lacunarity: gene(4, 1.8, 2.4),
        ridged: gene(5, 0.0, 1.0),
        domain_warp: gene(6, 0.0, 1.0),
        offset: gene(7, 0.0, 1.0),
        terraces: gene(8, 0.0, 1.0),
        stream_power_steps: gene(9, 0.0, 15.99) as u32,
        droplets: gene(10, 0.0, 60000.0),
        talus_angle_deg: gene(11, 20.0, 45.0),
        water_level: gene(12, 0.0, 0.6),
        snow_line: gene(13, 0.2, 1.0),
        cliff_m: gene(14, 0.0, 45.0),
        paddies: gene(15, 0.0, 1.0),
    }
}

/// The least and the greatest value of every gene.
fn corners() -> [LandParams; 2] {
    let corner =
        |seed, relief_m, wavelength_m, hurst, lacunarity, part: f32, steps, droplets, talus, water, snow| {
            LandParams {
                terrain_seed: seed,
                relief_m,
                wavelength_m,
                hurst,
                lacunarity,
                ridged: part,
                domain_warp: part,
                offset: part,
                terraces: part,
                stream_power_steps: steps,
                droplets,
                talus_angle_deg: talus,
                water_level: water,
                snow_line: snow,
                cliff_m: 45.0 * part,
                paddies: part,
            }
        };
    [
        corner(0, 15.0, 200.0, 0.5, 1.8, 0.0, 0, 0.0, 20.0, 0.0, 0.2),
        corner(255, 420.0, 2000.0, 1.3, 2.4, 1.0, 15, 60000.0, 45.0, 0.6, 1.0),
    ]
}

fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("thread pool").install(work)
}

#[test]
fn same_bytes_on_any_number_of_threads() {
    let params = random_params(2);
    let one = with_threads(1, || landform(&params, 129));
    let many = with_threads(5, || landform(&params, 129));
    assert_eq!(one, many);
}

#[test]
fn any_genes_give_finite_land_of_the_relief_asked_for() {
    for params in (20..23).map(random_params).chain(corners()) {
        let land = landform(&params, 513);
        let all = [&land.field.heights_m, &land.apron.heights_m, &land.flow, &land.deposit];
        assert!(all.iter().all(|v| v.iter().all(|h| h.is_finite())), "{params:?}");
        assert_eq!(
            (land.field.heights_m.len(), land.flow.len(), land.deposit.len()),
            (513 * 513, 513 * 513, 513 * 513)
        );
        let [lo, hi] = land.field.range_m();
        assert!((hi - lo - params.relief_m).abs() < 0.04 * params.relief_m, "{} for {params:?}", hi - lo);
        assert!(land.flow.iter().chain(&land.deposit).all(|v| (0.0..=1.0).contains(v)), "{params:?}");
        let [_, far] = land.apron.range_m();
        assert!(far < hi + 1.6 * params.relief_m + 60.0, "the horizon towers over {params:?}");
        assert_eq!(params.snow_line > 0.999, land.snow_line_m > far.max(hi));
    }
}

#[test]
fn apron_equals_the_field_where_they_share_samples() {
    let land = landform(&random_params(4), 257);
    assert_eq!((land.apron.side, land.apron.spacing_m), (129, 64.0));
    for j in 0..=16 {
        for i in 0..=16 {
            assert_eq!(land.apron.at(56 + i, 56 + j), land.field.at(i * 16, j * 16), "apron sample {i}, {j}");
        }
    }
}

#[test]
fn apron_goes_on_where_the_field_ends() {
    for params in (30..33).map(random_params) {
        let land = landform(&params, 257);
        let ring =
            |i: u32, j: u32, out: u32, side: u32| (land.apron.at(i, j) - land.apron.at(out, side)).abs();
        let steps: f32 =
            (0..=16).map(|k| ring(56 + k, 56, 56 + k, 55) + ring(72, 56 + k, 73, 56 + k)).sum::<f32>() / 34.0;
        let inside: f32 =
            (0..=16).map(|k| ring(56 + k, 57, 56 + k, 58) + ring(70, 56 + k, 71, 56 + k)).sum::<f32>() / 34.0;
        assert!(
            steps < 1.8 * inside + 0.06 * params.relief_m,
            "a step of {steps} m (inside {inside} m) in {params:?}"
        );
    }
}

#[test]
fn loose_stone_holds_its_talus_angle() {
    for params in (10..13).map(random_params) {
        let land = landform(&LandParams { water_level: 0.0, ..params.clone() }, 513);
        let steepest = libm::tanf((params.talus_angle_deg + 8.0).to_radians());
        let (mut loose, mut steep) = (0, 0);
        for j in 1..512 {
            for i in 1..512 {
                if land.deposit[(j * 513 + i) as usize] > 0.6 {
                    let n = land.field.normal_at(i, j);
                    loose += 1;
                    steep += usize::from((1.0 - n.y * n.y).sqrt() / n.y > steepest);
                }
            }
        }
        assert!(steep * 25 <= loose, "{steep} of {loose} loose samples are too steep in {params:?}");
    }
}

#[test]
fn enough_land_stays_dry_and_one_starts_on_it() {
    for k in 40..44 {
        let params = LandParams { water_level: 0.6, ..random_params(k) };
        let land = landform(&params, 257);
        let water_m = land.water_level_m.expect("a lake");
        let dry = land.field.heights_m.iter().filter(|&&h| h > water_m).count();
        assert!(dry * 5 >= 257 * 257 * 2, "{dry} dry samples in {params:?}");
        let middle = (-20..=20).flat_map(|j| (-20..=20).map(move |i| (i, j)));
        let wet =
            middle.filter(|&(i, j)| land.field.at((128 + i) as u32, (128 + j) as u32) <= water_m).count();
        assert!(wet * 2 < 41 * 41, "{wet} wet samples in the middle of {params:?}");
    }
    assert_eq!(landform(&LandParams { water_level: 0.0, ..random_params(40) }, 65).water_level_m, None);
}

#[test]
fn features_keep_their_place_at_any_size() {
    let params = random_params(6);
    let lands = [129, 513, 1025].map(|size| landform(&params, size));
    let mut worst = 0.0f32;
    for j in 0..129 {
        for i in 0..129 {
            let h = lands[1].field.at(i * 4, j * 4);
            assert_eq!(lands[0].field.at(i, j), h);
            worst = worst.max((lands[2].field.at(i * 8, j * 8) - h).abs());
        }
    }
    assert!(worst < 0.02 * params.relief_m, "{worst} m apart");
}

#[test]
fn no_sample_stands_alone() {
    for params in (50..53).map(random_params) {
        let land = landform(&params, 513);
        for j in 1..512u32 {
            for i in 1..512u32 {
                let around = [(0, 0), (1, 0), (2, 0), (0, 1), (2, 1), (0, 2), (1, 2), (2, 2)];
                let near = around.map(|(di, dj)| land.field.at(i + di - 1, j + dj - 1));
                let (lo, hi) = near.iter().fold((f32::MAX, f32::MIN), |(lo, hi), &h| (lo.min(h), hi.max(h)));
                let h = land.field.at(i, j);
                assert!(
                    h < hi + 1.6 && h > lo - 1.6,
                    "a spike of {} m at {i}, {j} in {params:?}",
                    (h - hi).max(lo - h)
                );
            }
        }
    }
}

#[test]
fn a_sketch_is_the_same_land_seen_coarsely() {
    for seed in [3, 4, 40] {
        let params = random_params(seed);
        let (land, sketch) = (landform(&params, 513), sketch(&params));
        let extent = sketch.field.extent_m();
        assert_eq!(extent, land.field.extent_m());
        let at = |k: u32| (k as f32 / 40.0 - 0.5) * 0.95 * extent;
        let places = (0..=40).flat_map(|z| (0..=40).map(move |x| (at(x), at(z))));
        let off = |(x, z): (f32, f32)| (land.field.height_m(x, z) - sketch.field.height_m(x, z)).abs();
        let mean = places.map(off).sum::<f32>() / (41.0 * 41.0);
        assert!(mean < 0.06 * params.relief_m, "{seed}: {mean} m of {}", params.relief_m);
    }
}

/// Rolling land by a lake.
fn downs() -> LandParams {
    LandParams {
        terrain_seed: 5,
        relief_m: 90.0,
        wavelength_m: 900.0,
        hurst: 1.25,
        lacunarity: 2.06,
        ridged: 0.0,
        domain_warp: 0.5,
        offset: 0.1,
        terraces: 0.0,
        stream_power_steps: 2,
        droplets: 4000.0,
        talus_angle_deg: 40.0,
        water_level: 0.3,
        snow_line: 1.0,
        cliff_m: 0.0,
        paddies: 0.0,
    }
}

#[test]
fn a_coast_breaks_off_at_a_sea_that_is_open_to_the_horizon() {
    for terrain_seed in [5, 6, 7] {
        let coast = |cliff_m: f32| {
            let land = landform(&LandParams { terrain_seed, cliff_m, ..downs() }, 257);
            let water_m = land.water_level_m.expect("a sea");
            let is_wet = |field: &Heightfield, i: u32, j: u32| field.at(i, j) < water_m;
            // Land from 12 m to 24 m behind the shoreline.
            let mut behind: Vec<f32> = (6..251)
                .flat_map(|j| (6..251).map(move |i| (i, j)))
                .filter(|&(i, j)| {
                    let near = |reach: u32| {
                        let ways = [(reach, 0), (0, reach), (2 * reach, reach), (reach, 2 * reach)];
                        ways.iter().any(|&(x, y)| is_wet(&land.field, i + x - reach, j + y - reach))
                    };
                    !is_wet(&land.field, i, j) && near(6) && !near(3)
                })
                .map(|(i, j)| land.field.at(i, j) - water_m)
                .collect();
            behind.sort_by(f32::total_cmp);
            let far = (0..land.apron.side).flat_map(|j| [(0, j), (128, j), (j, 0), (j, 128)]);
            let sea = far.filter(|&(i, j)| is_wet(&land.apron, i, j)).count() as f32 / 516.0;
            (behind[behind.len() * 2 / 3], sea)
        };
        let ((lake_m, lake), (cliff_m, sea)) = (coast(0.0), coast(30.0));
        assert!(lake_m < 9.0 && cliff_m > 17.0, "{lake_m} m by a lake, {cliff_m} m by the sea");
        assert!(lake < 0.15 && sea > 0.3, "{lake} and {sea} of the horizon are water");
    }
}

#[test]
fn a_dry_land_has_no_sea_to_sink_into() {
    let land = |cliff_m: f32| landform(&LandParams { cliff_m, water_level: 0.0, ..downs() }, 129);
    assert_eq!(land(30.0), land(0.0));
}

#[test]
fn paddies_are_level_and_follow_the_slope() {
    let [wild, farmed] = [0.0, 0.8].map(|paddies| landform(&LandParams { paddies, ..downs() }, 513));
    let paddies = farmed.paddies.as_ref().expect("fields");
    assert!(wild.paddies.is_none());
    let cut: Vec<u32> = (0..513 * 513).filter(|&k| paddies[k as usize] > 0.99).collect();
    assert!(cut.len() > 513 * 513 / 4, "{} samples are farmed", cut.len());
    let level = |land: &Landform| {
        let is_level = |k: &&u32| land.field.normal_at(*k % 513, *k / 513).y > 0.9995;
        cut.iter().filter(is_level).count() as f32 / cut.len() as f32
    };
    assert!(
        level(&farmed) > 0.35 && level(&wild) < 0.1,
        "{} of fields and {} before",
        level(&farmed),
        level(&wild)
    );
    let moved = |&k: &u32| (farmed.field.heights_m[k as usize] - wild.field.heights_m[k as usize]).abs();
    let most = cut.iter().map(moved).fold(0.0, f32::max);
    assert!(most < 6.0, "a field lies {most} m from the slope that it is cut into");
}

#[test]
fn no_island_beyond_the_field_is_a_pyramid() {
    let mut small = 0;
    for terrain_seed in 0..12 {
        let land = landform(&LandParams { terrain_seed, cliff_m: 20.0, ..downs() }, 129);
        let water_m = land.water_level_m.expect("a sea");
        let dry_around = |x: u32, z: u32| {
            let around = (z - 1..z + 2).flat_map(|j| (x - 1..x + 2).map(move |i| (i, j)));
            around.filter(|&(i, j)| land.apron.at(i, j) > water_m).count()
        };
        // Whose neighbours are beyond the field, too.
        let outer = (1..128).flat_map(|z| (1..128).map(move |x| (x, z)));
        for (x, z) in outer.filter(|&(x, z)| [x, z].iter().any(|at| !(55..=73).contains(at))) {
            let dry = dry_around(x, z);
            assert!(land.apron.at(x, z) <= water_m || dry > 1, "seed {terrain_seed}, sample {x}, {z}");
            small += usize::from(dry == 4);
        }
    }
    assert!(small > 0, "no land tried it");
}
