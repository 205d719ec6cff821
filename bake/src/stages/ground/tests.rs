//! Properties of the ground.

mod drifts;
mod growth;
mod rice;

use std::sync::LazyLock;

use super::*;
use crate::math::srgb_from_linear;
use crate::model::{DensityMap, GroundPlants, Material, PlantKind};
use crate::stages::land::{LandParams, landform};

/// An alpine land with snow, scree and a lake: everything that can cover the ground.
static LAND: LazyLock<Landform> = LazyLock::new(|| landform(&LAND_PARAMS, 257));

const LAND_PARAMS: LandParams = LandParams {
    terrain_seed: 5,
    relief_m: 220.0,
    wavelength_m: 700.0,
    hurst: 0.9,
    lacunarity: 2.0,
    ridged: 0.6,
    domain_warp: 0.3,
    offset: 0.4,
    terraces: 0.0,
    stream_power_steps: 6,
    droplets: 15000.0,
    talus_angle_deg: 33.0,
    water_level: 0.15,
    snow_line: 0.6,
    cliff_m: 0.0,
    paddies: 0.0,
};

const PARAMS: GroundParams = GroundParams {
    terrain_seed: 5,
    talus_angle_deg: 33.0,
    snow_line: 0.6,
    temperature_c: 9.0,
    rain_mm: 800.0,
};

static TEXTURES: LazyLock<Vec<crate::model::GroundDetail<Image8>>> = LazyLock::new(|| {
    let last = [Loose::Earth, Loose::Sand].map(|loose| texture(4, loose));
    (0..4).map(|kind| texture(kind, Loose::Sand)).chain(last).collect()
});

/// As finely as landscapes are painted.
static FINE: LazyLock<GroundMaps<Image8>> =
    LazyLock::new(|| maps(&PARAMS, &Woods::none(Season::default()), &LAND, 1024));

static MAPS: LazyLock<GroundMaps<Image8>> =
    LazyLock::new(|| maps(&PARAMS, &Woods::none(Season::default()), &LAND, 256));

fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("thread pool").install(work)
}

#[test]
fn same_bytes_on_any_number_of_threads() {
    let both = |threads| {
        with_threads(threads, || {
            (
                maps(&PARAMS, &Woods::none(Season::default()), &LAND, 256),
                far_ground(&PARAMS, Season::default(), &LAND),
            )
        })
    };
    assert!(both(1) == both(5));
}

#[test]
fn weights_share_what_there_is_and_all_covers_occur() {
    let made = &*MAPS;
    let mut most = [0; 4];
    for w in made.weights.data.chunks_exact(4) {
        assert!(w.iter().map(|&w| u32::from(w)).sum::<u32>() <= 255);
        for k in 0..4 {
            most[k] = most[k].max(w[k]);
        }
    }
    assert!(most.iter().all(|&w| w > 200), "strongest cover of rock, scree, snow, earth: {most:?}");
}

#[test]
fn snow_lies_high_and_rock_is_steep() {
    let made = &*MAPS;
    let mean = |channel: usize, of: &dyn Fn(u32, u32) -> f32| {
        let (mut sum, mut total) = (0.0, 0.0);
        for j in 0..256 {
            for i in 0..256 {
                let w = f32::from(made.weights.pixel(i, j)[channel]);
                sum += w * of(i, j);
                total += w;
            }
        }
        sum / total
    };
    let height = |i, j| LAND.field.at(i, j);
    let flat = |i, j| LAND.field.normal_at(i, j).y;
    let everywhere = (0..256 * 256).map(|k| flat(k % 256, k / 256)).sum::<f32>() / 65536.0;
    assert!(mean(2, &height) > LAND.snow_line_m);
    assert!(mean(0, &flat) < everywhere - 0.05);
    assert!(mean(3, &height) < LAND.water_level_m.expect("a lake") + 10.0);
}

#[test]
fn the_drier_the_land_the_paler_its_grass() {
    let green = |rain_mm: f32| {
        let made = maps(&GroundParams { rain_mm, ..PARAMS }, &Woods::none(Season::default()), &LAND, 128);
        let is_grass = |w: &[u8]| w.iter().all(|&w| w < 20);
        let pixels = made.color.data.chunks_exact(3).zip(made.weights.data.chunks_exact(4));
        let grass: Vec<u32> =
            pixels.filter(|(_, weights)| is_grass(weights)).map(|(rgb, _)| rgb[1].into()).collect();
        grass.iter().sum::<u32>() as f32 / grass.len() as f32
    };
    let [steppe, meadow, forest] = [200.0, 800.0, 2500.0].map(green);
    assert!(steppe > meadow + 15.0 && meadow > forest + 5.0, "{steppe} {meadow} {forest}");
}

/// Mean cover of rock, scree, snow and earth, and mean colour, of the land in a climate.
fn of_climate(temperature_c: f32, rain_mm: f32) -> ([f32; 4], [f32; 3]) {
    let made =
        maps(&GroundParams { temperature_c, rain_mm, ..PARAMS }, &Woods::none(Season::default()), &LAND, 128);
    let mean = |bytes: &[u8], channels: usize, k: usize| {
        let all = bytes.iter().skip(k).step_by(channels);
        all.map(|&byte| f32::from(byte)).sum::<f32>() / (bytes.len() / channels) as f32
    };
    let (weights, color) = (&made.weights.data, &made.color.data);
    ([0, 1, 2, 3].map(|k| mean(weights, 4, k)), [0, 1, 2].map(|k| mean(color, 3, k)))
}

#[test]
fn neighbouring_climates_look_alike_and_distant_ones_do_not() {
    let temperature_c = |k: usize| -9.0 + 1.2 * k as f32;
    let rain_mm = |k: usize| 100.0 * libm::exp2f(k as f32 / 3.0);
    let apart = |a: &([f32; 4], [f32; 3]), b: &([f32; 4], [f32; 3])| {
        let parts = (0..4).map(|k| (a.0[k] - b.0[k]).abs());
        parts.chain((0..3).map(|k| (a.1[k] - b.1[k]).abs())).fold(0.0, f32::max)
    };
    let along: Vec<_> = (0..32).map(|k| of_climate(temperature_c(k), 400.0)).collect();
    let down: Vec<_> = (0..16).map(|k| of_climate(20.0, rain_mm(k))).collect();
    for line in [along, down] {
        for pair in line.windows(2) {
            assert!(apart(&pair[0], &pair[1]) < 24.0, "{pair:?}");
        }
        assert!(apart(&line[0], &line[line.len() - 1]) > 40.0);
    }
}

#[test]
fn deserts_are_bare_and_rainforests_are_not() {
    let earth_and_scree = |(cover, _): ([f32; 4], [f32; 3])| cover[1] + cover[3];
    let [desert, polar, meadow, jungle] = [(26.0, 100.0), (-9.0, 100.0), (9.0, 800.0), (26.0, 3000.0)]
        .map(|(temperature_c, rain_mm)| earth_and_scree(of_climate(temperature_c, rain_mm)));
    assert!(desert > meadow + 60.0 && polar > meadow + 30.0, "{desert} {polar} {meadow}");
    assert!((jungle - meadow).abs() < 1.0, "{jungle} {meadow}");
    let [r, g, b] = of_climate(26.0, 3000.0).1;
    assert!(g > r && r > b, "{r} {g} {b}");
    let [r, g, b] = of_climate(26.0, 100.0).1;
    assert!(r > g + 15.0 && g > b + 15.0, "{r} {g} {b}");
}

#[test]
fn albedo_is_that_of_real_ground() {
    let made = &*MAPS;
    for (color, weights) in made.color.data.chunks_exact(3).zip(made.weights.data.chunks_exact(4)) {
        // Linear 0.02 to 0.9 in green.
        assert!((25..=245).contains(&color[1]), "{color:?}");
        if weights[2] > 250 {
            assert!(color[1] > 215, "snow of {color:?}");
        }
    }
}

const WINTER: Season = Season { winter: 1.0, autumn: 0.0, spring: 0.0 };

#[test]
fn apron_continues_the_map() {
    for season in [Season::default(), WINTER] {
        check_apron(season);
    }
}

fn check_apron(season: Season) {
    let made = maps(&PARAMS, &Woods::none(season), &LAND, 512);
    let far = far_ground(&PARAMS, season, &LAND);
    let linear = |c: u8| libm::powf((f32::from(c) / 255.0 + 0.055) / 1.055, 2.4);
    let (mut apart, mut apart_of_kinds) = (0.0f32, [0.0f32; 4]);
    for k in 0..=12 {
        // The northern border, 32 texels around, against the apron's samples there, smoothed alike.
        let mean = |texels: std::ops::Range<u32>| {
            let sum: f32 = texels
                .clone()
                .flat_map(|i| (0..12).map(move |j| (i, j)))
                .map(|(i, j)| linear(made.color.pixel(i, j)[1]))
                .sum();
            sum / (texels.len() * 12) as f32
        };
        let map = mean(k * 32..(k + 4) * 32);
        let samples = || far[(56 * 129 + 56 + k) as usize..][..5].iter();
        let apron = samples().map(|s| f32::from(s.color[1]) / 255.0).sum::<f32>() / 5.0;
        apart += (map - apron).abs() / 13.0;
        for (kind, apart) in apart_of_kinds.iter_mut().enumerate() {
            let texels = (k * 32..(k + 4) * 32).flat_map(|i| (0..12).map(move |j| (i, j)));
            let map: f32 = texels.map(|(i, j)| f32::from(made.weights.pixel(i, j)[kind])).sum();
            let apron = samples().map(|s| f32::from(s.weights[kind])).sum::<f32>() / 5.0;
            *apart += (map / (128.0 * 12.0) - apron).abs() / (255.0 * 13.0);
        }
    }
    assert!(apart < 0.05, "{apart} apart");
    assert!(apart_of_kinds.iter().all(|&apart| apart < 0.15), "{apart_of_kinds:?} apart");
    assert!(far.len() == 129 * 129 && far.iter().all(|s| s.color[3] == 255));
    assert!(far.iter().all(|s| s.weights.map(u32::from).iter().sum::<u32>() <= 255));
}

#[test]
fn textures_tile() {
    for t in TEXTURES.iter() {
        for image in [&t.detail, &t.normal] {
            let across =
                |a: u32, b: u32| (0..512).map(|j| apart(image.pixel(a, j), image.pixel(b, j))).sum::<u32>();
            let down =
                |a: u32, b: u32| (0..512).map(|i| apart(image.pixel(i, a), image.pixel(i, b))).sum::<u32>();
            let inside_across = (0..511).map(|i| across(i, i + 1)).max().unwrap_or(0);
            let inside_down = (0..511).map(|j| down(j, j + 1)).max().unwrap_or(0);
            assert!(
                across(511, 0) * 10 <= inside_across * 11,
                "{}: a seam from top to bottom, {} against {inside_across}",
                t.name,
                across(511, 0)
            );
            assert!(
                down(511, 0) * 10 <= inside_down * 11,
                "{}: a seam from side to side, {} against {inside_down}",
                t.name,
                down(511, 0)
            );
        }
    }
}

fn apart(a: &[u8], b: &[u8]) -> u32 {
    a.iter().zip(b).map(|(a, b)| u32::from(a.abs_diff(*b))).sum()
}

#[test]
fn textures_have_their_mean_and_point_outwards() {
    let names: Vec<&str> = TEXTURES.iter().map(|t| t.name.as_str()).collect();
    assert_eq!(names, ["grass", "rock", "scree", "snow", "earth", "sand"]);
    for t in TEXTURES.iter() {
        assert!((3.0..=6.0).contains(&t.tile_m));
        for channel in 0..3 {
            let sum: u64 = t.detail.data.iter().skip(channel).step_by(3).map(|&b| u64::from(b)).sum();
            let mean = sum as f64 / (512.0 * 512.0);
            assert!((mean - 128.0).abs() < 1.0, "{} has mean {mean}", t.name);
        }
        for n in t.normal.data.chunks_exact(3) {
            let n = [0, 1, 2].map(|k| f32::from(n[k]) / 127.5 - 1.0);
            let length = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
            assert!((length - 1.0).abs() < 0.03 && n[2] > 0.0, "{} has the normal {n:?}", t.name);
        }
    }
}

#[test]
fn green_of_tones_follows_from_red_and_blue() {
    for t in TEXTURES.iter() {
        let squares = t.detail.data.chunks_exact(3).map(|tone| {
            let [red, green, blue] = [0, 1, 2].map(|channel| f64::from(tone[channel]));
            let off = 0.6 * red + 0.4 * blue - green;
            off * off
        });
        let rms = (squares.sum::<f64>() / (512.0 * 512.0)).sqrt();
        assert!(rms < 1.0, "the viewer, which never reads it, is off by {rms} on {}", t.name);
    }
}

/// A near mesh of the land, and the piece cut out of it around a place.
fn cut(east_m: f32, south_m: f32) -> (crate::model::Mesh, crate::model::Foreground) {
    cut_with(&MAPS.plants, east_m, south_m)
}

fn cut_with(
    plants: &GroundPlants<Image8>,
    east_m: f32,
    south_m: f32,
) -> (crate::model::Mesh, crate::model::Foreground) {
    let near = crate::stages::terrain_lod::mesh(&LAND, 1.0, BLOCK_M, &[]).near;
    let eye = glam::Vec3::new(east_m, LAND.field.height_m(east_m, south_m) + 1.6, south_m);
    let view = crate::model::StartView { position_m: eye, direction: glam::Vec3::new(0.6, 0.0, -0.8) };
    let ground = Ground { params: &PARAMS, woods: &Woods::none(Season::default()), land: &LAND, plants };
    let made = foreground(&ground, &view, &near.positions, &near.parts[0].triangles);
    (near, made)
}

#[test]
fn the_foreground_fills_its_hole_edge_by_edge() {
    for (east_m, south_m) in [(10.0, -35.0), (-505.0, 500.0), (511.0, -511.0)] {
        let (near, made) = cut(east_m, south_m);
        let mut edges = std::collections::BTreeMap::new();
        let mut area = 0.0;
        let pieces = made.ground.mesh.parts.iter().map(|part| (&made.ground.mesh.positions, &part.triangles));
        for (positions, triangles) in pieces.chain([(&near.positions, &made.rest)]) {
            for triangle in triangles {
                let [a, b, c] = triangle.map(|v| positions[v as usize]);
                let [p, q, r] = [a, b, c].map(glam::Vec3::from_array);
                let twice = (q - p).cross(r - p).y;
                assert!(twice > 0.0, "{a:?} {b:?} {c:?} faces down");
                area += f64::from(twice) * 0.5;
                for edge in [[a, b], [b, c], [c, a]] {
                    *edges.entry(edge.map(|end| end.map(f32::to_bits))).or_insert(0) += 1;
                }
            }
        }
        assert!((area - 1024.0 * 1024.0).abs() < 2.0, "{area}");
        for (&[a, b], &count) in &edges {
            let rim = |p: [u32; 3]| [p[0], p[2]].iter().any(|&m| f32::from_bits(m).abs() == 512.0);
            assert!(
                count == 1 && (edges.contains_key(&[b, a]) || rim(a) && rim(b)),
                "a crack at {a:?} {b:?}"
            );
        }
    }
}

#[test]
fn the_foreground_looks_like_the_map_at_its_border() {
    let (_, made) = cut(10.0, -35.0);
    let map = &MAPS.color;
    let bounds = made.ground.mesh.bounds();
    let (mut differences, mut count) = (0.0, 0.0);
    for part in &made.ground.mesh.parts {
        let Material::Foreign(kind) = part.material else { panic!("a kind of ground") };
        for &v in part.triangles.as_flattened() {
            let ([x, _, z], uv) = (made.ground.mesh.positions[v as usize], made.ground.map_uvs[v as usize]);
            let inside = (x - bounds.min.x).min(bounds.max.x - x).min(z - bounds.min.z).min(bounds.max.z - z);
            if inside > 1.0 {
                continue;
            }
            let own = f32::from(made.ground.mesh.colors[v as usize][1]) / 255.0
                * textures::TILE_MEAN[kind as usize];
            let texel = map.pixel((uv[0] * 256.0) as u32, (uv[1] * 256.0) as u32)[1];
            let own = 255.0 * srgb_from_linear(own);
            (differences, count) = (differences + own - f32::from(texel), count + 1.0);
        }
    }
    assert!(count > 100.0 && (differences / count).abs() < 4.0, "{}", differences / count);
}

#[test]
fn blades_stand_on_grass_alone() {
    let mut blades = 0;
    for (east_m, south_m) in [(10.0, -35.0), (200.0, 150.0), (-300.0, 100.0), (-100.0, -300.0)] {
        let (_, made) = cut(east_m, south_m);
        let weights = &MAPS.weights;
        for triangle in &made.grass.parts[0].triangles {
            let [root, _, tip] = triangle.map(|v| made.grass.positions[v as usize]);
            assert!((root[1] - LAND.field.height_m(root[0], root[2])).abs() < 0.3 && tip[1] > root[1]);
            let texel = |m: f32| ((m / 1024.0 + 0.5) * 256.0) as u32;
            // The texels around a root.
            let other = |dx: f32, dz: f32| -> u32 {
                weights
                    .pixel(texel(root[0] + dx).min(255), texel(root[2] + dz).min(255))
                    .iter()
                    .map(|&w| u32::from(w))
                    .sum()
            };
            let least = [-2.3, 0.0, 2.3]
                .map(|dx| [-2.3, 0.0, 2.3].map(|dz| other(dx, dz)))
                .as_flattened()
                .iter()
                .copied()
                .min();
            assert!(least < Some(200), "a blade on {least:?}/255 of something else");
            blades += 1;
        }
    }
    assert!(blades > 1000, "{blades}");
}

#[test]
fn the_foreground_is_the_same_on_any_number_of_threads() {
    assert!(with_threads(1, || cut(10.0, -35.0).1) == with_threads(5, || cut(10.0, -35.0).1));
}
