//! Properties of the sky: energy, continuity, orientation, determinism.

use glam::Vec3A;
use half::f16;

use super::clear::ClearSky;
use super::math::dot;
use super::paint::{equirect_direction, face_direction};
use super::{SkyParams, images, light};
use crate::model::{ImageF16, SkyImages};

fn noon() -> SkyParams {
    SkyParams {
        sky_seed: 5,
        sun_elevation_deg: 35.0,
        sun_azimuth_deg: 130.0,
        turbidity: 3.0,
        sun_size_deg: 0.53,
        exposure_ev: 0.0,
        cloud_cover: 0.0,
        cloud_base_m: 1400.0,
        cloud_thickness_m: 900.0,
        cloud_scale_m: 1500.0,
        cirrus: 0.0,
        haze_m: 30_000.0,
    }
}

/// Genes spread over their ranges by a low-discrepancy sequence, the ends included.
fn any(i: u32) -> SkyParams {
    let unit = |k: f64| {
        let t = (f64::from(i) * k + 0.5).fract() as f32;
        ((t - 0.5) * 1.3 + 0.5).clamp(0.0, 1.0)
    };
    let log = |low: f32, high: f32, t: f32| low * libm::powf(high / low, t);
    SkyParams {
        sky_seed: i,
        sun_elevation_deg: 2.0 + 68.0 * unit(0.754_877_7),
        sun_azimuth_deg: 354.375 * unit(0.569_840_3),
        turbidity: 1.7 + 8.3 * unit(0.819_172_5),
        sun_size_deg: log(0.25, 5.0, unit(0.671_043_6)),
        exposure_ev: 3.0 * unit(0.549_700_4) - 1.5,
        cloud_cover: unit(0.450_304_1),
        cloud_base_m: log(500.0, 4000.0, unit(0.856_674_9)),
        cloud_thickness_m: log(100.0, 3000.0, unit(0.733_891_7)),
        cloud_scale_m: log(300.0, 5000.0, unit(0.628_714_5)),
        cirrus: unit(0.538_612_7),
        haze_m: log(1000.0, 50_000.0, unit(0.461_402_1)),
    }
}

fn at(image: &ImageF16, x: usize, y: usize) -> Vec3A {
    let start = (y * image.width as usize + x) * 3;
    let value = |channel: usize| f16::from_bits(image.data[start + channel]).to_f32();
    Vec3A::new(value(0), value(1), value(2))
}

fn sum(color: Vec3A) -> f32 {
    color.x + color.y + color.z
}

/// Irradiance on level ground from the upper half of the cube.
fn irradiance_of(faces: &[ImageF16]) -> Vec3A {
    let mut total = Vec3A::ZERO;
    for (face, image) in faces.iter().enumerate() {
        let side = image.width as usize;
        let place = |i: usize| (2 * i + 1) as f32 / side as f32 - 1.0;
        for y in 0..side {
            for x in 0..side {
                let (s, t) = (place(x), place(y));
                let direction = face_direction(face, s, t);
                let solid_angle = 4.0 / (side * side) as f32 / libm::powf(1.0 + s * s + t * t, 1.5);
                total += at(image, x, y) * (direction.y.max(0.0) * solid_angle);
            }
        }
    }
    total
}

/// The direction of the brightest pixel.
fn brightest(image: &ImageF16, direction: impl Fn(f32, f32) -> Vec3A) -> (f32, Vec3A) {
    let (width, height) = (image.width as usize, image.height as usize);
    let mut best = (-1.0, Vec3A::ZERO);
    for y in 0..height {
        for x in 0..width {
            let value = sum(at(image, x, y));
            if value > best.0 {
                let (u, v) = ((x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32);
                best = (value, direction(u, v));
            }
        }
    }
    best
}

#[test]
fn the_cube_holds_as_much_light_as_the_model_says() {
    for (elevation, turbidity) in [(4.0, 2.0), (35.0, 3.0), (65.0, 8.0)] {
        let params = SkyParams { sun_elevation_deg: elevation, turbidity, ..noon() };
        let light = light(&params);
        let pictures = images(&params, &light, 96, 64);
        let model = Vec3A::from_array(light.sky_irradiance_linear);
        let painted = irradiance_of(&pictures.faces);
        let error = (painted - model).abs() / model;
        assert!(error.max_element() < 0.02, "sun at {elevation}°: {painted} painted, {model} meant");
        // The zones tell the same.
        let zones: Vec<Vec3A> =
            light.zonal_radiance_linear.iter().map(|&zone| Vec3A::from_array(zone)).collect();
        let error = (super::zonal_irradiance(&zones) - model).abs() / model;
        assert!(error.max_element() < 0.02, "zones at {elevation}°");
    }
}

#[test]
fn clouds_change_the_light_as_they_change_the_picture() {
    for cover in [0.4, 1.0] {
        let params = SkyParams { cloud_cover: cover, cirrus: 0.4, ..noon() };
        let light = light(&params);
        let model = Vec3A::from_array(light.sky_irradiance_linear);
        let painted = irradiance_of(&images(&params, &light, 64, 64).faces);
        let error = (painted - model).abs() / model;
        assert!(error.max_element() < 0.12, "cover {cover}: {painted} painted, {model} meant");
    }
}

#[test]
fn the_sun_reddens_towards_the_horizon_and_fades_behind_clouds() {
    let sun = |elevation: f32, cover: f32| {
        let params = SkyParams { sun_elevation_deg: elevation, cloud_cover: cover, ..noon() };
        light(&params).sun_irradiance_linear
    };
    let (low, high) = (sun(3.0, 0.0), sun(60.0, 0.0));
    assert!(low[0] / low[2] > 5.0 * high[0] / high[2]);
    let (clear, fair, overcast) = (sun(40.0, 0.0)[1], sun(40.0, 0.4)[1], sun(40.0, 1.0)[1]);
    assert!(fair < 0.95 * clear && fair > 0.3 * clear, "{fair} of {clear}");
    assert!(overcast < 0.06 * clear, "{overcast} of {clear}");
}

#[test]
fn shade_is_not_brown_under_clouds_that_a_low_sun_lights() {
    // Altocumulus at sunset: the clouds give more light than the sky between them.
    let sunset = SkyParams {
        sun_elevation_deg: 3.6,
        cloud_cover: 0.44,
        cloud_base_m: 3400.0,
        cloud_thickness_m: 190.0,
        cloud_scale_m: 580.0,
        cirrus: 0.4,
        ..noon()
    };
    let light = light(&sunset);
    let warmth = |[red, _, blue]: [f32; 3]| red / blue;
    let (sun, shade) = (warmth(light.sun_irradiance_linear), warmth(light.sky_irradiance_linear));
    assert!(shade < 1.6 && sun > 6.0, "sun {sun}, shade {shade}");
}

#[test]
fn the_sky_is_blue_above_and_paler_below() {
    let params = noon();
    let sky = ClearSky::new(&params, 1.0);
    let zenith = sky.radiance(Vec3A::Y);
    let away = sky.radiance(Vec3A::new(-sky.sun.x, 0.03, -sky.sun.z).normalize());
    assert!(zenith.z > 1.8 * zenith.x);
    assert!(away.z / away.x < zenith.z / zenith.x);
    assert!(sum(away) > sum(zenith));
}

#[test]
fn the_sun_stands_where_its_direction_says() {
    for (azimuth, elevation) in [(0.0, 20.0), (90.0, 5.0), (225.0, 50.0), (310.0, 69.0)] {
        let params = SkyParams { sun_azimuth_deg: azimuth, sun_elevation_deg: elevation, ..noon() };
        let light = light(&params);
        let (a, e) = (azimuth.to_radians(), elevation.to_radians());
        let meant = Vec3A::new(libm::sinf(a) * libm::cosf(e), libm::sinf(e), -libm::cosf(a) * libm::cosf(e));
        assert!(dot(meant, Vec3A::from(light.sun_direction)) > 0.99999);
        let pictures = images(&params, &light, 128, 256);
        let (_, seen) = brightest(&pictures.equirect, equirect_direction);
        assert!(dot(seen, meant) > 0.9995, "equirect: {seen} for {meant}");
        let faces = pictures.faces.iter().enumerate();
        let (_, seen) = faces
            .map(|(face, image)| brightest(image, |u, v| face_direction(face, 2.0 * u - 1.0, 2.0 * v - 1.0)))
            .fold((-1.0, Vec3A::ZERO), |best, next| if next.0 > best.0 { next } else { best });
        assert!(dot(seen, meant) > 0.9995, "cube: {seen} for {meant}");
    }
}

fn all_pictures(pictures: &SkyImages) -> impl Iterator<Item = &ImageF16> {
    pictures.faces.iter().chain(&pictures.clear_faces).chain([&pictures.equirect])
}

#[test]
fn any_genes_give_finite_light() {
    for i in 0..12 {
        let params = any(i);
        let light = light(&params);
        let numbers = light.zonal_radiance_linear.iter().flatten().chain(&light.sky_irradiance_linear);
        let numbers = numbers.chain(&light.sun_irradiance_linear).chain(&light.haze_linear);
        assert!(numbers.copied().all(|x| x.is_finite() && x >= 0.0), "{params:?}");
        assert!(sum(Vec3A::from_array(light.sky_irradiance_linear)) > 0.1, "black: {params:?}");
        let pictures = images(&params, &light, 16, 32);
        for image in all_pictures(&pictures) {
            assert!(image.data.iter().all(|&bits| bits < 0x7C00), "not finite or negative: {params:?}");
        }
        assert!(pictures.layers.windows(2).all(|pair| pair[0].altitude_m < pair[1].altitude_m));
    }
}

#[test]
fn faces_meet_and_the_panorama_closes() {
    let params = SkyParams { cloud_cover: 0.45, cirrus: 0.5, sun_elevation_deg: 50.0, ..noon() };
    let pictures = images(&params, &light(&params), 256, 512);
    let last = 255;
    // Around the horizon. Cube maps are seen from outside: to the right of +X comes −Z.
    for (left, right) in [(0, 5), (5, 1), (1, 4), (4, 0)] {
        let (mut seam, mut inside) = (0.0, 0.0);
        for y in 0..256 {
            seam += sum((at(&pictures.faces[left], last, y) - at(&pictures.faces[right], 0, y)).abs());
            inside +=
                sum((at(&pictures.faces[left], last, y) - at(&pictures.faces[left], last - 1, y)).abs());
        }
        assert!(seam < 2.0 * inside + 0.5, "faces {left} and {right}: {seam} across, {inside} within");
    }
    // The top of −Z is the top row of +Y.
    let (mut seam, mut inside) = (0.0, 0.0);
    for x in 0..256 {
        seam += sum((at(&pictures.faces[5], last - x, 0) - at(&pictures.faces[2], x, 0)).abs());
        inside += sum((at(&pictures.faces[2], x, 1) - at(&pictures.faces[2], x, 0)).abs());
    }
    assert!(seam < 2.0 * inside + 0.5, "top: {seam} across, {inside} within");
    let (mut seam, mut inside) = (0.0, 0.0);
    for y in 0..256 {
        seam += sum((at(&pictures.equirect, 511, y) - at(&pictures.equirect, 0, y)).abs());
        inside += sum((at(&pictures.equirect, 1, y) - at(&pictures.equirect, 0, y)).abs());
    }
    assert!(seam < 2.0 * inside + 0.5, "panorama: {seam} across, {inside} within");
}

#[test]
fn threads_do_not_matter() {
    let params = SkyParams { cloud_cover: 0.6, cirrus: 0.6, ..noon() };
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let light = light(&params);
            let pictures = images(&params, &light, 32, 64);
            (light, pictures)
        })
    };
    assert!(on(1) == on(3));
}

#[test]
fn a_clear_sky_has_no_structure() {
    let params = noon();
    let pictures = images(&params, &light(&params), 64, 256);
    assert!(pictures.layers.is_empty());
    let sun = Vec3A::from(super::clear::sun_direction(&params));
    // Second differences along rows stay small, away from the sun.
    for y in 0..120 {
        for x in 1..255 {
            let direction = equirect_direction((x as f32 + 0.5) / 256.0, (y as f32 + 0.5) / 128.0);
            if dot(direction, sun) > 0.95 {
                continue;
            }
            let [a, b, c] = [x - 1, x, x + 1].map(|x| at(&pictures.equirect, x, y));
            let bend = (a + c - b * 2.0).abs().max_element();
            assert!(bend < 0.012 * b.max_element() + 1e-3, "at {x}, {y}: {bend} of {b}");
        }
    }
}

#[test]
fn cloud_layers_tile() {
    let params = SkyParams { cloud_cover: 0.5, cirrus: 0.7, ..noon() };
    let pictures = images(&params, &light(&params), 8, 16);
    assert_eq!(
        pictures.layers.iter().map(|layer| layer.name.as_str()).collect::<Vec<_>>(),
        ["cumulus", "cirrus"]
    );
    for layer in &pictures.layers {
        let image = &layer.image;
        let alpha = |x: u32, y: u32| i64::from(image.pixel(x, y)[3]);
        let last = image.width - 1;
        let seam: i64 = (0..=last)
            .map(|i| (alpha(last, i) - alpha(0, i)).abs() + (alpha(i, last) - alpha(i, 0)).abs())
            .sum();
        let inside: i64 = (0..=last)
            .map(|i| (alpha(200, i) - alpha(201, i)).abs() + (alpha(i, 300) - alpha(i, 301)).abs())
            .sum();
        assert!(seam < 3 * inside + 1500, "{}: {seam} across the seam, {inside} within", layer.name);
        let mean =
            (0..=last).map(|i| (0..=last).map(|j| alpha(i, j)).sum::<i64>()).sum::<i64>() / (512 * 512);
        assert!((5..250).contains(&mean), "{}: mean alpha {mean}", layer.name);
    }
}
