//! Writes tone-mapped panoramas and views of a sheet of skies as PNG files into a folder: to look at them.
//! `cargo run --release -p genescape-bake --example sky_sheet -- /tmp/sky`

use genescape_bake::model::{Image8, ImageF16, SkyLight};
use genescape_bake::stages::export::{exr, png};
use genescape_bake::stages::sky::{SkyParams, images, light};

fn aces(x: f32) -> f32 {
    let x = x * 0.6;
    ((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14)).clamp(0.0, 1.0)
}

fn byte(x: f32) -> u8 {
    let y = aces(x);
    let s = if y <= 0.0031308 { 12.92 * y } else { 1.055 * libm::powf(y, 1.0 / 2.4) - 0.055 };
    (s * 255.0 + 0.5) as u8
}

fn texel(image: &ImageF16, x: i64, y: i64, c: usize) -> f32 {
    let (w, h) = (i64::from(image.width), i64::from(image.height));
    let (x, y) = (x.rem_euclid(w), y.clamp(0, h - 1));
    half::f16::from_bits(image.data[((y * w + x) * 3) as usize + c]).to_f32()
}

fn bilinear(image: &ImageF16, u: f32, v: f32, c: usize) -> f32 {
    let (x, y) = (u * image.width as f32 - 0.5, v * image.height as f32 - 0.5);
    let (fx, fy) = (x - x.floor(), y - y.floor());
    let (x, y) = (x.floor() as i64, y.floor() as i64);
    let a = texel(image, x, y, c) * (1.0 - fx) + texel(image, x + 1, y, c) * fx;
    let b = texel(image, x, y + 1, c) * (1.0 - fx) + texel(image, x + 1, y + 1, c) * fx;
    a * (1.0 - fy) + b * fy
}

fn view(
    image: &ImageF16,
    azimuth_deg: f32,
    pitch_deg: f32,
    fov_deg: f32,
    w: u32,
    h: u32,
    exposure: f32,
) -> Image8 {
    let mut out = Image8::new(w, h, 3);
    let (az, pitch) = (azimuth_deg.to_radians(), pitch_deg.to_radians());
    let k = libm::tanf(fov_deg.to_radians() * 0.5);
    for j in 0..h {
        for i in 0..w {
            let x = ((i as f32 + 0.5) / w as f32 * 2.0 - 1.0) * k;
            let y = -((j as f32 + 0.5) / h as f32 * 2.0 - 1.0) * k * h as f32 / w as f32;
            let (s, c) = (libm::sinf(pitch), libm::cosf(pitch));
            let (y2, z2) = (y * c + s, c - y * s);
            let len = (x * x + y2 * y2 + z2 * z2).sqrt();
            let a = libm::atan2f(x, z2) + az;
            let u = a / std::f32::consts::TAU + 0.5;
            let v = libm::acosf(y2 / len) / std::f32::consts::PI;
            for ch in 0..3 {
                out.data[((j * w + i) * 3) as usize + ch] =
                    byte(bilinear(image, u - u.floor(), v, ch) * exposure);
            }
        }
    }
    out
}

fn paste(sheet: &mut Image8, image: &Image8, x: u32, y: u32) {
    for row in 0..image.height {
        let at = (((y + row) * sheet.width + x) * 3) as usize;
        let n = (image.width * 3) as usize;
        sheet.data[at..at + n].copy_from_slice(&image.data[row as usize * n..(row as usize + 1) * n]);
    }
}

fn cpu_ms() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    text.split(' ').next().unwrap().parse::<f64>().unwrap() / 1e6
}

fn main() {
    rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(run);
}

fn bench() {
    for (cover, cirrus) in [(0.0, 0.0), (0.0, 0.5), (0.4, 0.0), (0.4, 0.5), (1.0, 0.5)] {
        let p = SkyParams {
            sky_seed: 3,
            sun_elevation_deg: 25.0,
            sun_azimuth_deg: 40.0,
            turbidity: 3.0,
            sun_size_deg: 0.6,
            exposure_ev: 0.0,
            cloud_cover: cover,
            cloud_base_m: 1200.0,
            cloud_thickness_m: 900.0,
            cloud_scale_m: 1300.0,
            cirrus,
            haze_m: 30000.0,
        };
        let mut best = [f64::MAX; 4];
        for _ in 0..4 {
            let t = cpu_ms();
            let l = light(&p);
            best[0] = best[0].min(cpu_ms() - t);
            let t = cpu_ms();
            std::hint::black_box(images(&p, &l, 8, 16));
            best[1] = best[1].min(cpu_ms() - t);
            let t = cpu_ms();
            let s = images(&p, &l, 512, 2048);
            best[2] = best[2].min(cpu_ms() - t);
            let t = cpu_ms();
            std::hint::black_box(exr::encode(&s.equirect));
            for layer in &s.layers {
                std::hint::black_box(png::encode(&layer.image_srgb));
            }
            best[3] = best[3].min(cpu_ms() - t);
        }
        eprintln!(
            "cover {cover} cirrus {cirrus}: light {:.0}, dome and sheets {:.0}, images {:.0}, encode {:.0}",
            best[0], best[1], best[2], best[3]
        );
    }
}

fn run() {
    if std::env::args().nth(1).as_deref() == Some("bench") {
        return bench();
    }
    let args: Vec<String> = std::env::args().collect();
    let dir = args.get(1).cloned().unwrap_or("/tmp/sky".into());
    let (vw, vh) = (480u32, 270u32);
    let elevations = [2.0f32, 8.0, 25.0, 60.0];
    let kinds = [
        // cover, base, thickness, scale, cirrus, turbidity, haze
        (0.0f32, 1200.0f32, 600.0f32, 1200.0f32, 0.0f32, 2.0f32, 50000.0f32),
        (0.35, 1200.0, 900.0, 1300.0, 0.3, 2.5, 40000.0),
        (0.6, 1500.0, 1200.0, 2200.0, 0.7, 4.0, 25000.0),
        (1.0, 1000.0, 700.0, 2500.0, 0.5, 6.0, 12000.0),
    ];
    let mut front = Image8::new(vw * 4, vh * 4, 3);
    let mut side = Image8::new(vw * 4, vh * 4, 3);
    let mut pano = Image8::new(vw * 4, 240 * 4, 3);
    for (j, &elevation) in elevations.iter().enumerate() {
        for (i, &k) in kinds.iter().enumerate() {
            let p = SkyParams {
                sky_seed: (j * 4 + i) as u32 + args.get(2).and_then(|s| s.parse().ok()).unwrap_or(0),
                sun_elevation_deg: elevation,
                sun_azimuth_deg: 40.0,
                turbidity: k.5,
                sun_size_deg: 0.6,
                exposure_ev: 0.0,
                cloud_cover: k.0,
                cloud_base_m: k.1,
                cloud_thickness_m: k.2,
                cloud_scale_m: k.3,
                cirrus: k.4,
                haze_m: k.6,
            };
            let t0 = cpu_ms();
            let l: SkyLight = light(&p);
            let t1 = cpu_ms();
            let s = images(&p, &l, 512, 2048);
            let t2 = cpu_ms();
            let bytes = exr::encode(&s.equirect);
            let t3 = cpu_ms();
            let n: usize = s.layers.iter().map(|l| png::encode(&l.image_srgb).len()).sum();
            let t4 = cpu_ms();
            eprintln!(
                "el {elevation} kind {i}: light {:.0} images {:.0} exr {:.0} ({} MB) layers png {:.0} ({} kB)  sun {:.2?} sky {:.2?} haze {:.2?}",
                t1 - t0,
                t2 - t1,
                t3 - t2,
                bytes.len() / 1_000_000,
                t4 - t3,
                n / 1000,
                l.sun_irradiance_linear,
                l.sky_irradiance_linear,
                l.haze_linear
            );
            paste(
                &mut front,
                &view(&s.equirect, 50.0, 11.0, 60.0, vw, vh, 1.0),
                i as u32 * vw,
                j as u32 * vh,
            );
            paste(
                &mut side,
                &view(&s.equirect, 160.0, 11.0, 60.0, vw, vh, 1.0),
                i as u32 * vw,
                j as u32 * vh,
            );
            let mut small = Image8::new(vw, 240, 3);
            for y in 0..240u32 {
                for x in 0..vw {
                    for c in 0..3 {
                        let (u, v) = ((x as f32 + 0.5) / vw as f32, (y as f32 + 0.5) / 240.0);
                        small.data[((y * vw + x) * 3) as usize + c] = byte(bilinear(&s.equirect, u, v, c));
                    }
                }
            }
            paste(&mut pano, &small, i as u32 * vw, j as u32 * 240);
            if args.len() > 3 {
                let big = view(&s.equirect, 60.0, 12.0, 60.0, 1280, 720, 1.0);
                std::fs::write(format!("{dir}/big_{j}_{i}.png"), png::encode(&big)).unwrap();
                for layer in &s.layers {
                    std::fs::write(
                        format!("{dir}/layer_{j}_{i}_{}.png", layer.name),
                        png::encode(&layer.image_srgb),
                    )
                    .unwrap();
                }
                std::fs::write(format!("{dir}/sky_{j}_{i}.exr"), &bytes).unwrap();
            }
        }
    }
    for (name, image) in [("front", &front), ("side", &side), ("pano", &pano)] {
        std::fs::write(format!("{dir}/{name}.png"), png::encode(image)).unwrap();
    }
}
