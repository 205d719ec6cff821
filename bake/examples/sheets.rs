//! Contact sheets of what the stages make, for a developer's eye, as PNG files:
//! `cargo run --release -p genescape-bake --example sheets -- trees skies --seed 3`.
//!
//! Genomes are those of the starter landscapes, of the tree presets, and random ones by `--seed`.

use std::path::{Path, PathBuf};

use clap::{Parser, ValueEnum};
use genescape_bake::gltf::png;
use genescape_bake::model::{Image8, ImageF16, Instance, Landform, Material, Mesh, TreeTextures};
use genescape_bake::stages::{ground, land, light, lod, placement, sky, tree};
use genescape_schema::{Category, Genome, Population, Space, TreePreset};
use glam::{Vec2, Vec3};
use half::f16;
use rayon::prelude::*;
use serde::de::DeserializeOwned;

/// Draws contact sheets of what the stages make.
#[derive(Parser)]
struct Options {
    /// The sheets to draw; all by default.
    sheets: Vec<Sheet>,
    /// Seed of the random genomes.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder for the PNG files.
    #[arg(long, default_value = "target/sheets")]
    out: PathBuf,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Sheet {
    /// A tree of each preset and of random genomes.
    Trees,
    /// Six levels of detail of a tree: near, as far away as they are shown, and on the way to the next.
    Levels,
    /// Bark, its normals, leaf and blossom cards of each tree.
    Cards,
    /// The tiling textures of the ground.
    Ground,
    /// Lands from above with their trees, and over the land from the south.
    Lands,
    /// Light maps of the same lands, whole and near.
    Light,
    /// Sixteen skies towards the sun and aside: by the sun's elevation and by cloud cover.
    Skies,
}

type Rgb = [u8; 3];

fn main() -> std::io::Result<()> {
    let options = Options::parse();
    std::fs::create_dir_all(&options.out)?;
    let space = Space::builtin();
    let genomes = Genomes { space: &space, seed: options.seed };
    let all = if options.sheets.is_empty() { Sheet::value_variants() } else { &options.sheets };
    for &sheet in all {
        for (name, image) in match sheet {
            Sheet::Trees => vec![("trees", trees(&genomes))],
            Sheet::Levels => vec![("levels", levels(&genomes))],
            Sheet::Cards => vec![("cards", cards(&genomes))],
            Sheet::Ground => vec![("ground", ground_textures())],
            Sheet::Lands => vec![("lands", lands(&genomes))],
            Sheet::Light => vec![("light", light_maps(&genomes))],
            Sheet::Skies => vec![("skies-towards-sun", skies(50.0)), ("skies-aside", skies(160.0))],
        } {
            let path = options.out.join(name).with_extension("png");
            std::fs::write(&path, png::encode(&image))?;
            eprintln!("wrote {}", path.display());
        }
    }
    Ok(())
}

// ---- genomes ----

struct Genomes<'a> {
    space: &'a Space,
    seed: u64,
}

impl Genomes<'_> {
    fn read<T: DeserializeOwned>(&self, genome: &Genome) -> T {
        genome.read(self.space).expect("the space declares every gene")
    }

    fn random(&self) -> Vec<Genome> {
        let population = Population::random(self.space, self.seed, 0);
        population.individuals.into_iter().map(|individual| individual.genome).collect()
    }

    /// Those of the starter landscapes, then random ones.
    fn landscapes(&self) -> Vec<Genome> {
        let text = include_str!("../../configs/starter.ron");
        let starter = Population::load(self.space, "configs/starter.ron", text).expect("tested").population;
        starter.individuals.into_iter().map(|individual| individual.genome).chain(self.random()).collect()
    }

    /// Those of the tree presets, then random ones.
    fn trees(&self) -> Vec<Genome> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/presets");
        let files = std::fs::read_dir(folder).expect("the presets").flatten();
        let mut files: Vec<PathBuf> = files.map(|entry| entry.path()).collect();
        files.sort();
        let preset = |file: PathBuf| {
            let text = std::fs::read_to_string(&file).expect("a preset");
            let loaded = TreePreset::load(self.space, &file.to_string_lossy(), &text).expect("tested");
            let mut genome = self.random().remove(0);
            *genome.chromosome_mut(Category::Tree) = loaded.preset.tree;
            genome
        };
        files.into_iter().map(preset).chain(self.random()).collect()
    }
}

// ---- sheets ----

/// Images of one size, row by row, each from a colour for every pixel.
fn contact_sheet(
    columns: u32,
    [width, height]: [u32; 2],
    images: &[&(dyn Fn(u32, u32) -> Rgb + Sync)],
) -> Image8 {
    let rows = (images.len() as u32).div_ceil(columns);
    let mut sheet = Image8::new(columns * width, rows * height, 3);
    let line = (columns * width * 3) as usize;
    sheet.data.par_chunks_exact_mut(line).enumerate().for_each(|(y, line)| {
        for (x, pixel) in line.chunks_exact_mut(3).enumerate() {
            let (x, y) = (x as u32, y as u32);
            let image = (y / height * columns + x / width) as usize;
            pixel.copy_from_slice(&images.get(image).map_or([255; 3], |image| image(x % width, y % height)));
        }
    });
    sheet
}

fn images_in_rows(columns: u32, images: &[Image8]) -> Image8 {
    let (width, height) = (images[0].width, images[0].height);
    let pixels: Vec<_> = images.iter().map(|image| move |x, y| over_grey(texel(image, x, y))).collect();
    let pixels: Vec<&(dyn Fn(u32, u32) -> Rgb + Sync)> = pixels.iter().map(|pixel| pixel as _).collect();
    contact_sheet(columns, [width, height], &pixels)
}

fn texel(image: &Image8, x: u32, y: u32) -> [u8; 4] {
    let pixel = image.pixel(x, y);
    [pixel[0], pixel[1], pixel[2], pixel.get(3).copied().unwrap_or(255)]
}

fn over_grey([r, g, b, a]: [u8; 4]) -> Rgb {
    [r, g, b].map(|c| ((u32::from(c) * u32::from(a) + 110 * (255 - u32::from(a))) / 255) as u8)
}

fn trees(genomes: &Genomes) -> Image8 {
    let drawn = |genome: &Genome| {
        let template = tree::template(&genomes.read(genome), 0);
        let textures = tree::textures(&genomes.read(genome));
        let mut drawing = Drawing::new(&textures, [400, 480], &template.mesh);
        drawing.draw(&template.mesh, 1.0);
        drawing.image
    };
    let drawn: Vec<Image8> = genomes.trees().par_iter().map(drawn).collect();
    images_in_rows(5, &drawn)
}

fn levels(genomes: &Genomes) -> Image8 {
    let genome = genomes.trees().swap_remove((genomes.seed % 9) as usize);
    let textures = tree::textures(&genomes.read(&genome));
    let mesh = tree::template(&genomes.read(&genome), 0).mesh;
    let levels = lod::levels(&mesh, &lod::LodOptions::default()).levels;
    let draw = |mesh: &Mesh, scale: f32| {
        let mut drawing = Drawing::new(&textures, [300, 380], &levels[0].mesh);
        drawing.draw(mesh, scale);
        drawing.image
    };
    let shown = levels.iter().take(6).enumerate();
    let near = shown.clone().map(|(_, level)| draw(&level.mesh, 1.0));
    let far = shown.map(|(k, level)| draw(&level.mesh, 0.7 / (1 << k) as f32));
    let morphs = (0..6).map(|k| {
        let mut mesh = levels[1].mesh.clone();
        let moves = levels[1].morph.iter().flat_map(|morph| &morph.positions);
        for (position, by) in mesh.positions.iter_mut().zip(moves) {
            *position = (Vec3::from(*position) + Vec3::from(*by) * (k as f32 / 5.0)).to_array();
        }
        draw(&mesh, 1.0)
    });
    let missing = levels.len().min(6);
    let blank = || (missing..6).map(|_| Image8::new(300, 380, 3));
    images_in_rows(6, &near.chain(blank()).chain(far).chain(blank()).chain(morphs).collect::<Vec<_>>())
}

fn cards(genomes: &Genomes) -> Image8 {
    let images = genomes.trees().into_iter().flat_map(|genome| {
        let TreeTextures { bark_color, bark_normal, leaf, blossom, .. } =
            tree::textures(&genomes.read(&genome));
        [bark_color, bark_normal, leaf[0].clone(), blossom[0].clone()].map(|image| resized(&image, 256))
    });
    images_in_rows(8, &images.collect::<Vec<_>>())
}

fn ground_textures() -> Image8 {
    let textures = ground::textures();
    let details = textures.iter().map(|texture| texture.detail.clone());
    let normals = textures.iter().map(|texture| texture.normal.clone());
    images_in_rows(textures.len() as u32, &details.chain(normals).collect::<Vec<_>>())
}

fn resized(image: &Image8, side: u32) -> Image8 {
    let mut out = Image8::new(side, side, 4);
    for (k, pixel) in out.data.chunks_exact_mut(4).enumerate() {
        let (x, y) = (k as u32 % side, k as u32 / side);
        pixel.copy_from_slice(&texel(image, x * image.width / side, y * image.height / side));
    }
    out
}

// ---- trees ----

/// A tree drawn by parallel light and projection, with its textures.
struct Drawing<'a> {
    textures: &'a TreeTextures<Image8>,
    image: Image8,
    depth: Vec<f32>,
    foot: Vec3,
    pixels_per_m: f32,
}

const ACROSS: Vec3 = Vec3::new(0.866, 0.0, 0.5);
const TOWARDS_EYE: Vec3 = Vec3::new(-0.5, 0.0, 0.866);
const LIGHT: Vec3 = Vec3::new(-0.25, 0.66, 0.71);

impl<'a> Drawing<'a> {
    /// An empty one, into which `frame` fits.
    fn new(textures: &'a TreeTextures<Image8>, [width, height]: [u32; 2], frame: &Mesh) -> Self {
        let mut image = Image8::new(width, height, 3);
        image.data.chunks_exact_mut(3).for_each(|pixel| pixel.copy_from_slice(&[205, 220, 240]));
        let bounds = frame.bounds();
        let size = bounds.max - bounds.min;
        let pixels_per_m = 0.97 * (height as f32 / size.y).min(width as f32 / size.x.max(size.z));
        let depth = vec![f32::MIN; (width * height) as usize];
        Self { textures, image, depth, foot: Vec3::Y * bounds.min.y, pixels_per_m }
    }

    fn draw(&mut self, mesh: &Mesh, scale: f32) {
        let textures = self.textures;
        let scale = scale * self.pixels_per_m;
        let (middle, bottom) = (0.5 * self.image.width as f32, self.image.height as f32);
        for part in &mesh.parts {
            let texture = match part.material {
                Material::Leaf => &textures.leaf[0],
                Material::Blossom => &textures.blossom[0],
                _ => &textures.bark_color,
            };
            for triangle in &part.triangles {
                let corner = |v: u32| {
                    let p = Vec3::from(mesh.positions[v as usize]) - self.foot;
                    (Vec2::new(middle + p.dot(ACROSS) * scale, bottom - p.y * scale), p.dot(TOWARDS_EYE))
                };
                let normal = Vec3::from(mesh.normals[triangle[0] as usize]);
                let light =
                    if part.material == Material::Bark { normal.dot(LIGHT) } else { normal.dot(LIGHT).abs() };
                let tint = mesh.colors.get(triangle[0] as usize).copied().unwrap_or([255; 4]);
                let tint = [0, 1, 2].map(|c| f32::from(tint[c]) / 255.0 * (0.45 + 0.75 * light.max(0.0)));
                let uvs = triangle.map(|v| Vec2::from(mesh.uvs[v as usize]));
                self.fill(triangle.map(corner), uvs, texture, tint);
            }
        }
    }

    fn fill(&mut self, corners: [(Vec2, f32); 3], uvs: [Vec2; 3], texture: &Image8, tint: [f32; 3]) {
        let [a, b, c] = corners.map(|corner| corner.0);
        let area = (b - a).perp_dot(c - a);
        let limit = |v: f32, max: u32| v.clamp(0.0, max as f32) as u32;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c) + 1.0);
        for y in limit(low.y, self.image.height)..limit(high.y, self.image.height) {
            for x in limit(low.x, self.image.width)..limit(high.x, self.image.width) {
                let p = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                let [u, v] = [(b - p).perp_dot(c - p) / area, (c - p).perp_dot(a - p) / area];
                let weights = [u, v, 1.0 - u - v];
                let mixed = |values: [f32; 3]| (0..3).map(|k| values[k] * weights[k]).sum::<f32>();
                let at = (y * self.image.width + x) as usize;
                let depth = mixed(corners.map(|corner| corner.1));
                if weights.iter().any(|&w| w.is_nan() || w < 0.0) || depth <= self.depth[at] {
                    continue;
                }
                let place = |uv: f32, side: u32| ((uv.rem_euclid(1.0) * side as f32) as u32).min(side - 1);
                let (s, t) = (mixed(uvs.map(|uv| uv.x)), mixed(uvs.map(|uv| uv.y)));
                let [red, green, blue, alpha] =
                    texel(texture, place(s, texture.width), place(t, texture.height));
                if f32::from(alpha) >= 255.0 * self.textures.alpha_cutoff {
                    self.depth[at] = depth;
                    let color = [red, green, blue].map(f32::from);
                    let color: Rgb = std::array::from_fn(|k| (color[k] * tint[k]).min(255.0) as u8);
                    self.image.data[3 * at..3 * at + 3].copy_from_slice(&color);
                }
            }
        }
    }
}

// ---- lands ----

/// A land with its trees and colours.
struct Land {
    form: Landform,
    field: Image8,
    apron: Vec<[u8; 4]>,
    trees: Vec<Instance>,
    footprints: Vec<placement::TreeFootprint>,
    casters: Vec<Mesh>,
}

impl Land {
    fn new(genomes: &Genomes, genome: &Genome) -> Self {
        let form = land::landform(&genomes.read(genome), 513);
        let colors = genomes.read(genome);
        let mut made = Self {
            field: ground::maps(&colors, &form, 1024).color,
            apron: ground::apron_colors(&colors, &form),
            trees: Vec::new(),
            footprints: Vec::new(),
            casters: Vec::new(),
            form,
        };
        for index in 0..5 {
            let template = tree::template(&genomes.read(genome), index);
            made.footprints.push(placement::TreeFootprint {
                height_m: template.bounds.max.y,
                trunk_radius_m: template.trunk_radius_m,
                crown_radius_m: template.crown_radius_m,
                root_depth_m: -template.bounds.min.y,
            });
            let mut levels = lod::levels(&template.mesh, &lod::LodOptions::default()).levels;
            made.casters.extend(levels.pop().map(|level| level.mesh));
        }
        let snow = ground::snow_map(colors.terrain_seed, &made.form);
        made.trees = placement::place(&genomes.read(genome), &made.form, snow.as_ref(), &made.footprints);
        made
    }

    fn is_inside(x: f32, z: f32) -> bool {
        x.abs() < 512.0 && z.abs() < 512.0
    }

    fn height_m(&self, x: f32, z: f32) -> f32 {
        if Self::is_inside(x, z) { self.form.field.height_m(x, z) } else { self.form.apron.height_m(x, z) }
    }

    fn water_m(&self) -> f32 {
        self.form.water_level_m.unwrap_or(f32::MIN)
    }

    /// The ground, lit from the north-west.
    fn color(&self, x: f32, z: f32) -> Rgb {
        let depth = self.water_m() - self.height_m(x, z);
        if depth > 0.0 {
            return [0.04, 0.09, 0.12].map(|c| (255.0 * libm::powf(c + 0.1 / (1.0 + depth), 0.4545)) as u8);
        }
        let e = if Self::is_inside(x, z) { 2.0 } else { 40.0 };
        let (dx, dz) = (
            self.height_m(x + e, z) - self.height_m(x - e, z),
            self.height_m(x, z + e) - self.height_m(x, z - e),
        );
        let normal = Vec3::new(-dx, 2.0 * e, -dz).normalize();
        let light = normal.dot(Vec3::new(-0.62, 0.62, -0.47)).max(0.0) * 2.6 + 0.55 * normal.y;
        let linear = if Self::is_inside(x, z) {
            let at = |v: f32| ((v + 512.0) as u32).min(1023);
            let [r, g, b, _] = texel(&self.field, at(x), at(z));
            [r, g, b].map(|c| libm::powf(f32::from(c) / 255.0, 2.2))
        } else {
            let at = |v: f32| ((v / 64.0 + 64.5) as usize).min(128);
            let [r, g, b, _] = self.apron[at(z) * 129 + at(x)];
            [r, g, b].map(|c| f32::from(c) / 255.0)
        };
        linear.map(|c| (255.0 * libm::powf((c * light).min(1.0), 0.4545)) as u8)
    }

    /// From above, north at the top, with the trees' crowns.
    fn plan(&self, side: u32) -> Image8 {
        let scale = 1024.0 / side as f32;
        let color = |x, y| self.color((x as f32 + 0.5) * scale - 512.0, (y as f32 + 0.5) * scale - 512.0);
        let mut image = contact_sheet(1, [side, side], &[&color]);
        for tree in &self.trees {
            let [x, z, _] = tree.trunk_cylinder_m.map(|m| (m + 512.0) / scale);
            let radius =
                self.footprints[tree.template as usize].crown_radius_m * tree.world_from_tree[1][1] / scale;
            let pixels = |m: f32| (m - radius).max(0.0) as u32..=((m + radius) as u32).min(side - 1);
            for (i, j) in pixels(z).flat_map(|j| pixels(x).map(move |i| (i, j))) {
                if Vec2::new(i as f32 + 0.5 - x, j as f32 + 0.5 - z).length() <= radius.max(0.6) {
                    let green = [30, 60 + 25 * (tree.template % 5) as u8, 35];
                    image.data[3 * (j * side + i) as usize..][..3].copy_from_slice(&green);
                }
            }
        }
        image
    }

    /// Over the land from the south, without trees.
    fn view(&self, [x, y]: [f32; 2]) -> Rgb {
        let eye = Vec3::new(0.0, self.form.field.range_m()[1] * 0.8 + 120.0, 820.0);
        let way = Vec3::new(x, y, -1.0);
        let mut t = 30.0;
        while t < 5000.0 {
            let p = eye + way * t;
            let clear = p.y - self.height_m(p.x, p.z).max(self.water_m());
            if clear < 0.0005 * t {
                let color = self.color(p.x, p.z);
                let haze = t / 5000.0;
                return [0, 1, 2].map(|k| (f32::from(color[k]) * (1.0 - haze) + HAZE[k] * haze) as u8);
            }
            t += (clear * 0.4).clamp(0.5 + t * 0.001, 40.0);
        }
        HAZE.map(|c| c as u8)
    }
}

const HAZE: [f32; 3] = [170.0, 190.0, 215.0];

fn lands(genomes: &Genomes) -> Image8 {
    let draw = |genome: &Genome| {
        let land = Land::new(genomes, genome);
        let plan = land.plan(400);
        let pixel = |x: u32, y: u32| match x {
            0..400 => over_grey(texel(&plan, x, y)),
            _ => land.view([(x as f32 - 760.0) / 560.0, (110.0 - y as f32) / 560.0]),
        };
        contact_sheet(1, [1120, 400], &[&pixel])
    };
    images_in_rows(2, &genomes.landscapes().iter().map(draw).collect::<Vec<_>>())
}

/// What a white ground would look like under a warm sun and a blue sky; on the right four times as near.
fn light_maps(genomes: &Genomes) -> Image8 {
    let draw = |genome: &Genome| {
        let land = Land::new(genomes, genome);
        let light = sky::light(&genomes.read(genome));
        let map = light::light_map(&light, &land.form, &land.trees, &land.casters, 1024).image;
        let pixel = |x: u32, y: u32| {
            let (x, y) = if x < 512 { (2 * x, 2 * y) } else { (480 + (x - 512) / 4, 480 + y / 4) };
            let [sky, sun, ..] = texel(&map, x, y).map(|c| f32::from(c) / 255.0);
            let light = [0.9 * sun + 0.10 * sky, 0.82 * sun + 0.14 * sky, 0.65 * sun + 0.22 * sky];
            light.map(|c| (255.0 * libm::powf((0.8 * c).min(1.0), 1.0 / 2.2)) as u8)
        };
        contact_sheet(1, [1024, 512], &[&pixel])
    };
    images_in_rows(2, &genomes.landscapes().iter().map(draw).collect::<Vec<_>>())
}

// ---- skies ----

/// Rows: the sun's elevation. Columns: clear, scattered cumulus, towering cumulus, overcast.
fn sky_params(row: usize, column: usize) -> sky::SkyParams {
    let [cloud_cover, cloud_base_m, cloud_thickness_m, cloud_scale_m] = [
        [0.0, 1200.0, 600.0, 1200.0],
        [0.35, 1200.0, 900.0, 1300.0],
        [0.6, 1500.0, 1200.0, 2200.0],
        [1.0, 1000.0, 700.0, 2500.0],
    ][column];
    sky::SkyParams {
        sky_seed: (row * 4 + column) as u32,
        sun_elevation_deg: [2.0, 8.0, 25.0, 60.0][row],
        sun_azimuth_deg: 40.0,
        turbidity: [2.0, 2.5, 4.0, 6.0][column],
        sun_size_deg: 0.6,
        exposure_ev: 0.0,
        cloud_cover,
        cloud_base_m,
        cloud_thickness_m,
        cloud_scale_m,
        cirrus: [0.0, 0.3, 0.7, 0.5][column],
        haze_m: [50_000.0, 40_000.0, 25_000.0, 12_000.0][column],
    }
}

/// What a camera 11° above the horizon sees towards an azimuth, 60° wide.
fn skies(azimuth_deg: f32) -> Image8 {
    let panoramas: Vec<ImageF16> = (0..16)
        .map(|k| {
            let params = sky_params(k / 4, k % 4);
            sky::images(&params, &sky::light(&params), 64, 1536).equirect
        })
        .collect();
    let (width, height) = (480, 270);
    let (sin, cos) = libm::sincosf(11.0_f32.to_radians());
    let half = libm::tanf(30.0_f32.to_radians());
    let view = |panorama: &ImageF16, x: u32, y: u32| {
        let right = ((2 * x + 1) as f32 / width as f32 - 1.0) * half;
        let up = (height as f32 - (2 * y + 1) as f32) / width as f32 * half;
        let (up, ahead) = (up * cos + sin, cos - up * sin);
        let azimuth = libm::atan2f(right, ahead) + azimuth_deg.to_radians();
        let u = (azimuth / std::f32::consts::TAU + 0.5).rem_euclid(1.0);
        let v = libm::acosf(up / Vec3::new(right, up, ahead).length()) / std::f32::consts::PI;
        let at = |part: f32, side: u32| ((part * side as f32) as u32).min(side - 1);
        let pixel = (at(v, panorama.height) * panorama.width + at(u, panorama.width)) as usize;
        [0, 1, 2].map(|c| tone_mapped(f16::from_bits(panorama.data[3 * pixel + c]).to_f32()))
    };
    let views: Vec<_> = panoramas.iter().map(|panorama| move |x, y| view(panorama, x, y)).collect();
    let views: Vec<&(dyn Fn(u32, u32) -> Rgb + Sync)> = views.iter().map(|view| view as _).collect();
    contact_sheet(4, [width, height], &views)
}

/// Narkowicz's fit to the ACES curve, then a gamma of 2.2.
fn tone_mapped(linear: f32) -> u8 {
    let x = linear * 0.6;
    let y = ((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14)).clamp(0.0, 1.0);
    (255.0 * libm::powf(y, 1.0 / 2.2) + 0.5) as u8
}
