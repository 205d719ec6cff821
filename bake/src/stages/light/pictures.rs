//! Pictures and times to judge by, made on request: `cargo test --release -- --ignored light::pictures` writes into
//! the folder `genescape-light` of the system's temporary folder.

use super::tests::{at, land, light};
use super::*;
use crate::model::{Material, Part, PartKind};
use crate::noise::{fbm2, hash01};

/// A crown of `cards` leaf quads (within a cone or an ellipsoid) over a six-sided trunk.
fn tree(seed: u32, height_m: f32, radius_m: f32, cards: u32, conical: bool) -> Mesh {
    let mut mesh = Mesh::default();
    let mut bark = Vec::new();
    for k in 0..6_u32 {
        let (sin, cos) = libm::sincosf(k as f32 * std::f32::consts::TAU / 6.0);
        mesh.positions.extend([[0.25 * cos, -0.3, 0.25 * sin], [0.08 * cos, height_m * 0.9, 0.08 * sin]]);
        let (a, b) = (2 * k, 2 * ((k + 1) % 6));
        bark.extend([[a, a + 1, b], [b, a + 1, b + 1]]);
    }
    let mut leaf = Vec::new();
    for k in 0..cards {
        let random = |n: i32| hash01(seed, k as i32, n, 7);
        let up = random(0);
        let (sin, cos) = libm::sincosf(random(1) * std::f32::consts::TAU);
        let width = if conical { 1.0 - up } else { 2.0 * (up * (1.0 - up)).sqrt() };
        let r = radius_m * width * random(2).sqrt();
        let middle = [r * cos, height_m * (0.25 + 0.75 * up), r * sin];
        let (sin, cos) = libm::sincosf(random(3) * std::f32::consts::TAU);
        let tilt = random(4) - 0.5;
        let (e, f) = ([cos * 0.6, tilt * 0.4, sin * 0.6], [-sin * 0.4, 0.45, cos * 0.4]);
        let first = mesh.positions.len() as u32;
        for (s, t) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            mesh.positions.push(std::array::from_fn(|n| middle[n] + s * e[n] + t * f[n]));
        }
        leaf.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    let kind = PartKind::Aggregate { vertices: 4, triangles: 2 };
    mesh.parts = vec![
        Part { material: Material::Bark, kind: PartKind::Surface, triangles: bark },
        Part { material: Material::Leaf, kind, triangles: leaf },
    ];
    mesh
}

fn scene(count: u32, cards: u32) -> (Landform, Vec<Instance>, Vec<Mesh>) {
    let height = |x: f32, z: f32| {
        let broad = fbm2(3, x / 500.0, z / 500.0, 7, 0.45, 0);
        120.0 * (1.0 - broad.abs() * 1.6) + 15.0 * broad
    };
    let land = land(513, height);
    let casters =
        (0..5).map(|k| tree(k, 9.0 + 2.0 * k as f32, 3.0 + 0.4 * k as f32, cards, k % 2 == 0)).collect();
    let instances = (0..count).map(|k| {
        let random = |n: i32| hash01(9, k as i32, n, 3);
        let (x, z) = (random(0) * 1000.0 - 500.0, random(1) * 1000.0 - 500.0);
        at(
            k % 5,
            x,
            land.field.height_m(x, z) - 0.1,
            z,
            random(2) * std::f32::consts::TAU,
            0.8 + 0.4 * random(3),
        )
    });
    let placement = instances.collect::<Vec<_>>();
    (land, placement, casters)
}

/// What this thread has used of a processor (Linux only).
fn cpu_ms() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    text.split(' ').next().unwrap().parse::<f64>().unwrap() * 1e-6
}

fn save(name: &str, image: &Image8) {
    let folder = std::env::temp_dir().join("genescape-light");
    std::fs::create_dir_all(&folder).unwrap();
    let file = std::fs::File::create(folder.join(name)).unwrap();
    let mut encoder = png::Encoder::new(file, image.width, image.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().unwrap().write_image_data(&image.data).unwrap();
}

/// What a white ground would look like: warm sun, blue sky, display curve.
fn shaded(map: &LightMap) -> Image8 {
    let mut image = map.image.clone();
    for texel in image.data.chunks_exact_mut(3) {
        let (sky, sun) = (f32::from(texel[0]) / 255.0, f32::from(texel[1]) / 255.0);
        let light = [0.9 * sun + 0.10 * sky, 0.82 * sun + 0.14 * sky, 0.65 * sun + 0.22 * sky];
        for (byte, light) in texel.iter_mut().zip(light) {
            *byte = (255.0 * libm::powf((0.8 * light).min(1.0), 1.0 / 2.2)) as u8;
        }
    }
    image
}

fn crop(image: &Image8, x: u32, y: u32, size: u32, zoom: u32) -> Image8 {
    let mut out = Image8::new(size * zoom, size * zoom, 3);
    for j in 0..size * zoom {
        for i in 0..size * zoom {
            let at = ((j * size * zoom + i) * 3) as usize;
            out.data[at..at + 3].copy_from_slice(image.pixel(x + i / zoom, y + j / zoom));
        }
    }
    out
}

#[test]
#[ignore = "writes pictures"]
fn pictures() {
    let (land, placement, casters) = scene(400, 120);
    for (elevation, azimuth, size) in
        [(35.0, 300.0, 0.53), (12.0, 250.0, 0.53), (4.0, 130.0, 5.0), (65.0, 45.0, 2.0)]
    {
        let map = light_map(&light(elevation, azimuth, size), &land, &placement, &casters, 1024);
        let shaded = shaded(&map);
        save(&format!("el{elevation}.png"), &shaded);
        save(&format!("el{elevation}-near.png"), &crop(&shaded, 400, 400, 200, 4));
        let mut red = map.image.clone();
        red.data.chunks_exact_mut(3).for_each(|p| p.fill(p[0]));
        save("sky.png", &red);
    }
}

#[test]
#[ignore = "prints times"]
fn measure() {
    use std::io::Write;
    for (count, cards, elevation) in [
        (0, 10, 30.0),
        (1500, 200, 30.0),
        (1500, 900, 30.0),
        (4000, 400, 30.0),
        (1500, 400, 5.0),
        (1500, 400, 2.0),
    ] {
        let (land, placement, casters) = scene(count, cards);
        let light = light(elevation, 300.0, 0.53);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let start = pool.install(cpu_ms);
        (0..4).for_each(|_| drop(pool.install(|| light_map(&light, &land, &placement, &casters, 1024))));
        let mean = (pool.install(cpu_ms) - start) / 4.0;
        let triangles = casters[0].triangle_count();
        writeln!(
            std::io::stderr(),
            "{count} trees of {triangles} triangles, {elevation}°: {mean:.1} ms on one thread"
        )
        .unwrap();
    }
}

#[test]
#[ignore = "prints times"]
fn measure_parts() {
    use std::io::Write;
    let (land, placement, casters) = scene(1500, 400);
    let light = light(30.0, 300.0, 0.53);
    let sun = Sun::of(&light);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| {
        let time = |name: &str, work: &dyn Fn()| {
            let start = cpu_ms();
            (0..20).for_each(|_| work());
            writeln!(std::io::stderr(), "{name}: {:.1} ms", (cpu_ms() - start) / 20.0).unwrap();
        };
        let to_samples = Resampling::from_samples(1024, 513);
        let ground = to_samples.whole(1024, &land.field.heights_m);
        let side = sky::side(&land);
        time("ground", &|| drop(to_samples.whole(1024, &land.field.heights_m)));
        time("sun", &|| drop(sun::on_land(&sun, &land)));
        time("sky", &|| drop(sky::on_land(&light, &land, side)));
        time("trees", &|| {
            drop(trees::shade(&sun, &land, &placement, &casters.iter().collect::<Vec<_>>(), &ground, 1024))
        });
        time("no trees", &|| {
            drop(trees::shade(&sun, &land, &[], &casters.iter().collect::<Vec<_>>(), &ground, 1024))
        });
        time("all", &|| drop(light_map(&light, &land, &placement, &casters, 1024)));
    });
}
