//! Pictures of lands for the eye: `cargo test --release land::pictures -- --ignored` writes PNG files into the
//! folder `genescape-land` of the system's temporary folder.

use std::path::PathBuf;

use super::tests::random_params;
use super::*;
use crate::model::Landform;
use crate::stages::ground::{self, GroundParams};

/// The four lands that a new world might start with.
fn starters() -> [(&'static str, LandParams); 4] {
    let base = random_params(0);
    [
        (
            "soft-hills-lake",
            LandParams {
                terrain_seed: 12,
                relief_m: 70.0,
                wavelength_m: 650.0,
                hurst: 1.1,
                lacunarity: 2.0,
                ridged: 0.1,
                domain_warp: 0.4,
                offset: 0.4,
                terraces: 0.0,
                stream_power_steps: 5,
                droplets: 20000.0,
                talus_angle_deg: 32.0,
                water_level: 0.2,
                snow_line: 1.0,
            },
        ),
        (
            "alpine-snow",
            LandParams {
                terrain_seed: 77,
                relief_m: 380.0,
                wavelength_m: 1100.0,
                hurst: 0.9,
                lacunarity: 2.1,
                ridged: 0.9,
                domain_warp: 0.35,
                offset: 0.5,
                terraces: 0.0,
                stream_power_steps: 10,
                droplets: 45000.0,
                talus_angle_deg: 38.0,
                water_level: 0.0,
                snow_line: 0.55,
            },
        ),
        (
            "dunes-coast",
            LandParams {
                terrain_seed: 221,
                relief_m: 28.0,
                wavelength_m: 320.0,
                hurst: 1.3,
                lacunarity: 2.0,
                ridged: 0.5,
                domain_warp: 0.6,
                offset: 0.2,
                terraces: 0.0,
                stream_power_steps: 0,
                droplets: 4000.0,
                talus_angle_deg: 33.0,
                water_level: 0.36,
                snow_line: 1.0,
            },
        ),
        (
            "misty-plain",
            LandParams {
                relief_m: 20.0,
                wavelength_m: 1200.0,
                hurst: 0.9,
                ridged: 0.0,
                offset: 0.7,
                terraces: 0.0,
                stream_power_steps: 3,
                droplets: 12000.0,
                water_level: 0.12,
                snow_line: 1.0,
                ..base
            },
        ),
    ]
}

#[test]
#[ignore = "writes pictures"]
fn pictures() {
    let lands = (1..=12).map(|k| (format!("random-{k:02}"), random_params(k)));
    let lands = starters().into_iter().map(|(n, p)| (n.to_string(), p)).chain(lands);
    for (name, params) in lands {
        let land = landform(&params, 513);
        let colors = paint(&params, &land);
        let (plan, view) = (plan(&land, &colors), view(&land, &colors));
        let both: Vec<u8> = (0..400)
            .flat_map(|j| [&plan[j * 400 * 3..][..400 * 3], &view[j * 720 * 3..][..720 * 3]].concat())
            .collect();
        write(&name, 1120, 400, &both);
        write(&format!("{name}.txt"), 0, 0, format!("{params:#?} {:?}", land.water_level_m).as_bytes());
    }
}

#[test]
#[ignore = "measures"]
fn speed() {
    for k in 0..6 {
        let params = match k {
            0 => LandParams {
                stream_power_steps: 15,
                droplets: 60000.0,
                hurst: 0.5,
                lacunarity: 1.8,
                wavelength_m: 2000.0,
                ..random_params(3)
            },
            k => random_params(k),
        };
        let begin = cpu_s();
        let land = landform(&params, 513);
        let end = cpu_s();
        let ground = GroundParams {
            terrain_seed: params.terrain_seed,
            talus_angle_deg: params.talus_angle_deg,
            snow_line: params.snow_line,
        };
        let maps = ground::maps(&ground, &land, 1024);
        let painted = cpu_s();
        let apron = ground::apron_colors(&ground, &land);
        eprintln!(
            "ground {:.0} apron {:.0} ms {}",
            (painted - end) * 1e3,
            (cpu_s() - painted) * 1e3,
            maps.weights.data.len() + apron.len()
        );
        eprintln!(
            "{k}: {:.0} ms, {:?}, droplets {} steps {}",
            (end - begin) * 1e3,
            land.field.range_m(),
            params.droplets,
            params.stream_power_steps
        );
    }
}

/// CPU seconds that this process has used.
pub(crate) fn cpu_s() -> f64 {
    let mut total = 0.0;
    for task in std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten() {
        let text = std::fs::read_to_string(task.path().join("schedstat")).unwrap_or_default();
        total += text.split(' ').next().and_then(|t| t.parse::<f64>().ok()).unwrap_or(0.0) * 1e-9;
    }
    total
}

/// Linear colours of the field (1024²) and of the apron.
struct Paint {
    field: Vec<[f32; 3]>,
    apron: Vec<[u8; 4]>,
}

fn paint(params: &LandParams, land: &Landform) -> Paint {
    let ground = GroundParams {
        terrain_seed: params.terrain_seed,
        talus_angle_deg: params.talus_angle_deg,
        snow_line: params.snow_line,
    };
    let maps = ground::maps(&ground, land, 1024);
    let linear = |c: u8| libm::powf(f32::from(c) / 255.0, 2.2);
    let field = maps.color.data.chunks_exact(3).map(|c| [linear(c[0]), linear(c[1]), linear(c[2])]).collect();
    Paint { field, apron: ground::apron_colors(&ground, land) }
}

/// North at the top, hillshaded from the north-west, 400×400.
fn plan(land: &Landform, colors: &Paint) -> Vec<u8> {
    let mut out = Vec::new();
    for j in 0..400 {
        for i in 0..400 {
            let (x, z) = ((i as f32 + 0.5) * 2.56 - 512.0, (j as f32 + 0.5) * 2.56 - 512.0);
            out.extend(shade(land, colors, x, z));
        }
    }
    out
}

/// From the south, 160 m above the highest land, or standing in the middle, 720×400.
fn view(land: &Landform, colors: &Paint) -> Vec<u8> {
    let [_, hi] = land.field.range_m();
    let eye = [0.0, hi * 0.8 + 120.0, 820.0];
    let mut out = Vec::new();
    for j in 0..400 {
        for i in 0..720 {
            let (right, down) = ((i as f32 - 360.0) / 560.0, (j as f32 - 110.0) / 560.0);
            out.extend(cast(land, colors, eye, [right, -down, -1.0]));
        }
    }
    out
}

fn cast(land: &Landform, colors: &Paint, eye: [f32; 3], way: [f32; 3]) -> [u8; 3] {
    let mut t = 30.0;
    while t < 5000.0 {
        let p = [eye[0] + way[0] * t, eye[1] + way[1] * t, eye[2] + way[2] * t];
        let ground = height(land, p[0], p[2]).max(land.water_level_m.unwrap_or(-1e9));
        let clear = p[1] - ground;
        if clear < 0.05 * t * 0.01 {
            let fog = (t / 5000.0).min(1.0);
            let c = shade(land, colors, p[0], p[2]);
            return [0, 1, 2].map(|k| (c[k] as f32 * (1.0 - fog) + [170.0, 190.0, 215.0][k] * fog) as u8);
        }
        t += (clear * 0.4).clamp(0.5 + t * 0.001, 40.0);
    }
    [170, 190, 215]
}

fn height(land: &Landform, x: f32, z: f32) -> f32 {
    if x.abs() < 512.0 && z.abs() < 512.0 { land.field.height_m(x, z) } else { land.apron.height_m(x, z) }
}

fn shade(land: &Landform, colors: &Paint, x: f32, z: f32) -> [u8; 3] {
    let inside = x.abs() < 512.0 && z.abs() < 512.0;
    let e = if inside { 2.0 } else { 40.0 };
    let (dx, dz) =
        (height(land, x + e, z) - height(land, x - e, z), height(land, x, z + e) - height(land, x, z - e));
    let normal = glam::Vec3::new(-dx, 2.0 * e, -dz).normalize();
    let light = normal.dot(glam::Vec3::new(-0.6, 0.6, -0.45).normalize()).max(0.0) * 2.6 + 0.55 * normal.y;
    let at = |v: f32| ((v + 512.0) as usize).min(1023);
    let far = |v: f32| ((v / 64.0 + 64.5) as usize).min(128);
    let mut c = if inside {
        colors.field[at(z) * 1024 + at(x)]
    } else {
        let [r, g, b, _] = colors.apron[far(z) * 129 + far(x)];
        [r, g, b].map(|c| f32::from(c) / 255.0)
    };
    let depth = land.water_level_m.unwrap_or(-1e9) - height(land, x, z);
    if depth > 0.0 {
        c = [0.04, 0.09, 0.12].map(|v| v + 0.1 / (1.0 + depth));
        return c.map(|v| (255.0 * libm::powf(v.min(1.0), 0.4545)) as u8);
    }
    c.map(|v| (255.0 * libm::powf((v * light).min(1.0), 0.4545)) as u8)
}

/// Writes a picture (or, without a width, text) into the folder.
pub(crate) fn write(name: &str, width: u32, height: u32, data: &[u8]) {
    let folder: PathBuf = std::env::temp_dir().join("genescape-land");
    std::fs::create_dir_all(&folder).expect("folder for pictures");
    if width == 0 {
        std::fs::write(folder.join(name), data).expect("text");
        return;
    }
    let file = std::fs::File::create(folder.join(format!("{name}.png"))).expect("picture");
    let mut encoder = png::Encoder::new(file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().and_then(|mut w| w.write_image_data(data)).expect("picture");
}
