//! What must hold of light on the ground: analytic values on plain shapes, shadows where geometry puts them, the
//! same bytes on any number of threads.

use glam::Vec3;

use super::*;
use crate::model::{Heightfield, Instance, Material, Mesh, Part, PartKind};
use crate::noise::fbm2;

/// A sky without clouds whose sun stands at an elevation and azimuth (clockwise from north), in degrees.
fn light(elevation_deg: f32, azimuth_deg: f32, sun_size_deg: f32) -> SkyLight {
    let (sin, cos) = libm::sincosf(elevation_deg.to_radians());
    let (east, north) = libm::sincosf(azimuth_deg.to_radians());
    SkyLight {
        sun_direction: Vec3::new(cos * east, sin, -cos * north),
        sun_angular_radius_rad: 0.5 * sun_size_deg.to_radians(),
        sun_irradiance_linear: [1.0; 3],
        sky_irradiance_linear: [0.2; 3],
        zonal_radiance_linear: (0..16).map(|k| [0.5, 0.5, 0.6 - 0.02 * k as f32]).collect(),
        haze_linear: [0.5; 3],
        haze_extinction_per_m: 1e-4,
        exposure: 1.0,
    }
}

/// Land of 1024 m with heights by a function of (x, z), its apron likewise.
fn land(side: u32, height_m: impl Fn(f32, f32) -> f32) -> Landform {
    let field = |side: u32, spacing_m: f32| {
        let place = |k: u32| (k as f32 - 0.5 * (side - 1) as f32) * spacing_m;
        let heights_m = (0..side * side).map(|k| height_m(place(k % side), place(k / side))).collect();
        Heightfield { side, spacing_m, heights_m }
    };
    let (field, apron) = (field(side, 1024.0 / (side - 1) as f32), field(65, 64.0));
    Landform::bare(field, apron)
}

/// A box of bark from the ground up.
fn trunk(radius_m: f32, height_m: f32) -> Mesh {
    let ring = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let mut mesh = Mesh::default();
    for y in [0.0, height_m] {
        mesh.positions.extend(ring.map(|[x, z]| [x * radius_m, y, z * radius_m]));
    }
    let mut triangles = vec![[4, 6, 5], [4, 7, 6]];
    for k in 0..4 {
        let next = (k + 1) % 4;
        triangles.extend([[k, k + 4, next], [next, k + 4, next + 4]]);
    }
    mesh.parts = vec![Part { material: Material::Bark, kind: PartKind::Surface, triangles }];
    mesh
}

/// Cards are half empty.
fn caster(mesh: Mesh) -> Caster {
    let opacity = |part: &Part| if part.material.is_card() { 0.55 } else { 1.0 };
    Caster { opacities: mesh.parts.iter().map(opacity).collect(), mesh }
}

fn at(template: u32, x: f32, y: f32, z: f32, turn_rad: f32, scale: f32) -> Instance {
    let (sin, cos) = libm::sincosf(turn_rad);
    let world_from_tree =
        [[cos * scale, 0.0, sin * scale, x], [0.0, scale, 0.0, y], [-sin * scale, 0.0, cos * scale, z]];
    Instance { template, world_from_tree, trunk_cylinder_m: [x, z, 0.3] }
}

fn bare(light: &SkyLight, land: &Landform, side_px: u32) -> LightMap {
    light_map(light, land, &[], &[] as &[Caster], side_px)
}

/// R, G, B, A at world (x, z).
fn texel(map: &LightMap, x_m: f32, z_m: f32) -> [u8; 4] {
    let side = map.image.width as f32;
    let place = |at: f32| ((at / 1024.0 + 0.5) * side) as u32;
    let p = map.image.pixel(place(x_m), place(z_m));
    [p[0], p[1], p[2], p[3]]
}

#[test]
fn an_open_plain_has_the_analytic_light() {
    let plain = land(65, |_, _| 37.3);
    for (elevation, azimuth, size) in [
        (2.0, 10.0, 5.0),
        (5.0, 77.0, 0.53),
        (12.5, 200.0, 1.0),
        (30.0, 333.0, 0.25),
        (70.0, 125.0, 5.0),
        (90.0, 0.0, 0.5),
    ] {
        let map = bare(&light(elevation, azimuth, size), &plain, 96);
        let expected = 255.0 * libm::sinf(f32::to_radians(elevation));
        for rgba in map.image.data.chunks_exact(4) {
            assert!(rgba[0] == 255 && rgba[2] == 255 && rgba[3] == 255, "{elevation}: {rgba:?}");
            assert!((f32::from(rgba[1]) - expected).abs() < 1.01, "{elevation}: {rgba:?}, {expected}");
        }
        let mean = map.image.data.chunks_exact(4).map(|p| f32::from(p[1])).sum::<f32>() / (96.0 * 96.0);
        assert!((mean - expected).abs() < 0.05, "{elevation}: {mean}, {expected}");
    }
}

#[test]
fn the_disc_is_cut_as_geometry_says() {
    let disc = sun::Disc::new();
    for (distance, part) in
        [(-1.0, 0.0), (0.0, 0.5), (1.0, 1.0), (-3.0, 0.0), (0.5, 0.804_5), (-0.5, 0.195_5)]
    {
        assert!((disc.above(distance) - part).abs() < 5e-4, "{distance}");
    }
}

#[test]
fn a_wall_throws_a_shadow_as_long_as_its_height_over_the_tangent() {
    for elevation in [8.0_f32, 20.0, 45.0] {
        // The sun in the west; a ridge along z, 40 m high, a single slope wide.
        let ridge = land(513, |x, _| (40.0 - 20.0 * (x + 300.0).abs()).max(0.0));
        let map = bare(&light(elevation, 270.0, 0.53), &ridge, 1024);
        let length = 40.0 / libm::tanf(elevation.to_radians());
        let end = -300.0 + length;
        // Half the width of the penumbra, and a sample's blur.
        let soft =
            0.004_63 * 40.0 / libm::sinf(elevation.to_radians()) / libm::sinf(elevation.to_radians()) + 3.0;
        assert_eq!(texel(&map, end - soft, 7.0)[2], 0, "{elevation}");
        assert_eq!(texel(&map, end + soft, 7.0)[2], 255, "{elevation}");
        assert_eq!(texel(&map, -310.0, 7.0)[2], 255, "{elevation}");
        let lit: f32 = (0..40).map(|k| f32::from(texel(&map, end - 19.5 + k as f32, 7.0)[2]) / 255.0).sum();
        assert!((lit - 20.0).abs() < 1.5, "{elevation}: {lit}");
    }
}

#[test]
fn hills_beyond_the_field_throw_shadows_into_it() {
    let hills = land(129, |x, _| if x < -560.0 { 100.0 } else { 0.0 });
    let map = bare(&light(20.0, 270.0, 0.53), &hills, 128);
    assert_eq!(texel(&map, -420.0, 0.0)[2], 0);
    assert_eq!(texel(&map, -200.0, 0.0)[2], 255);
}

#[test]
fn a_larger_sun_has_softer_shadows() {
    let ridge = land(513, |x, _| (60.0 - 30.0 * (x + 300.0).abs()).max(0.0));
    let grey = |size: f32| {
        let map = bare(&light(15.0, 270.0, size), &ridge, 1024);
        map.image.data.chunks_exact(4).take(1024).filter(|p| p[2] > 10 && p[2] < 245).count()
    };
    let (small, large) = (grey(0.5), grey(5.0));
    // 224 m of shadow, a disc of 5°: width = 2·tan 2.5°·(ray of 232 m) / sin 15°.
    assert!(small < 16 && (55..=90).contains(&large), "{small} {large}");
}

#[test]
fn a_canyon_sees_less_of_the_sky() {
    let canyon = land(257, |x, _| if x.abs() < 30.0 { 0.0 } else { 60.0 });
    let map = bare(&light(60.0, 0.0, 0.53), &canyon, 256);
    let (floor, plateau) = (texel(&map, 0.0, 0.0)[0], texel(&map, 300.0, 0.0)[0]);
    // An endless canyon 60 m wide and deep: the sine of the angle from its middle to its edge, about 0.45.
    assert!(plateau == 255 && (95..=140).contains(&floor), "{floor} {plateau}");
}

#[test]
fn a_trunks_shadow_touches_its_foot_and_points_away_from_the_sun() {
    for (ground, turn) in [(0.0, 0.0), (0.2, 1.0)] {
        let slope = move |x: f32, z: f32| ground * (x + 0.5 * z);
        let land = land(257, slope);
        for azimuth in [0.0, 60.0, 135.0, 250.0] {
            for elevation in [25.0, 50.0] {
                let light = light(elevation, azimuth, 0.53);
                let (x, z) = (40.5, -20.5);
                let placement = vec![at(0, x, slope(x, z), z, turn, 1.0)];
                let map = light_map(&light, &land, &placement, &[caster(trunk(1.5, 15.0))], 1024);
                let open = bare(&light, &land, 1024);
                let s = light.sun_direction;
                let level = (s.x * s.x + s.z * s.z).sqrt();
                let (dx, dz) = (-s.x / level, -s.z / level);
                let rise = slope(dx, dz);
                let length = 15.0 / (s.y / level + rise);
                let along = |d: f32| texel(&map, x + dx * d, z + dz * d)[3];
                assert!(along(0.0) < 128, "gap at the foot: {} for {azimuth} {elevation}", along(0.0));
                let steps = (length * 0.9) as usize;
                assert!((0..steps).all(|d| along(d as f32) < 128), "{azimuth} {elevation} {ground}");
                assert_eq!(along(length + 6.0), 255);
                assert!((2..40).all(|d| along(-(d as f32) - 2.5) > 250), "{azimuth} {elevation}");
                let side = texel(&map, x + dx * 4.0 - dz * 6.0, z + dz * 4.0 + dx * 6.0)[3];
                assert_eq!(side, 255);
                let dark =
                    |map: &LightMap| map.image.data.iter().skip(3).step_by(4).filter(|&&b| b < 128).count();
                assert_eq!(dark(&open), 0);
                let count = dark(&map) as f32;
                assert!(
                    count < length * 5.0 + 20.0 && count > length * 2.0,
                    "{count} of {length} {azimuth} {elevation} {ground}"
                );
            }
        }
    }
}

#[test]
fn a_shadow_climbs_a_step_where_the_land_does() {
    // Sun in the west at 45°: a trunk of 20 m at x = 0 shades 20 m of plain, but only 8 m if a step of 12 m rises.
    let land = land(513, |x, _| if x > 4.0 { 12.0 } else { 0.0 });
    let placement = vec![at(0, 0.0, 0.0, 0.5, 0.0, 1.0)];
    let map = light_map(&light(45.0, 270.0, 0.53), &land, &placement, &[caster(trunk(1.0, 20.0))], 1024);
    assert!(texel(&map, 6.5, 0.5)[3] < 128 && texel(&map, 12.0, 0.5)[3] == 255);
}

fn forest(count: u32) -> (Landform, Vec<Instance>, Vec<Caster>) {
    let height = |x: f32, z: f32| 80.0 * fbm2(5, x / 300.0, z / 300.0, 5, 0.5, 0);
    let land = land(129, height);
    let mut leafy = trunk(0.4, 9.0);
    leafy.parts.push(Part { material: Material::Leaf, ..trunk(2.0, 9.0).parts.remove(0) });
    let instances = (0..count).map(|k| {
        let (x, z) = (crate::noise::hash01(1, k as i32, 0, 0), crate::noise::hash01(1, k as i32, 1, 0));
        let (x, z) = (x * 1000.0 - 500.0, z * 1000.0 - 500.0);
        at(k % 2, x, height(x, z), z, k as f32, 0.7 + (k % 7) as f32 * 0.1)
    });
    (land, instances.collect(), vec![caster(trunk(0.5, 12.0)), caster(leafy)])
}

#[test]
fn the_same_bytes_on_any_number_of_threads() {
    let (land, placement, casters) = forest(150);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| light_map(&light(14.0, 222.0, 2.0), &land, &placement, &casters, 256))
    };
    let one = run(1);
    assert_eq!(one, run(2));
    assert_eq!(one, run(8));
}

#[test]
fn more_trees_never_make_it_lighter() {
    let (land, placement, casters) = forest(120);
    let light = light(35.0, 100.0, 1.0);
    let mut last = bare(&light, &land, 256);
    for count in [1, 30, 120] {
        let some = placement[..count].to_vec();
        let map = light_map(&light, &land, &some, &casters, 256);
        assert!(map.image.data.iter().zip(&last.image.data).all(|(now, before)| now <= before));
        assert_ne!(map, last);
        last = map;
    }
}

#[test]
fn nothing_breaks_on_odd_input() {
    let (land, mut placement, mut casters) = forest(20);
    casters.push(Caster::default());
    placement[0].template = 2;
    placement[1].template = 99;
    placement[2].world_from_tree = [[0.0; 4]; 3];
    placement[3].world_from_tree[1][3] = f32::NAN;
    placement[4].world_from_tree[0][3] = 1e7;
    let mut odd = light(-5.0, 0.0, 0.0);
    odd.zonal_radiance_linear.clear();
    for side_px in [1, 2, 33] {
        let map = light_map(&odd, &land, &placement, &casters, side_px);
        assert!(map.image.data.chunks_exact(4).all(|p| p[1] == 0 && p[2] == 0));
        for elevation in [0.0, 2.0, 90.0] {
            light_map(&light(elevation, 0.0, 5.0), &land, &placement, &casters, side_px);
        }
    }
}
