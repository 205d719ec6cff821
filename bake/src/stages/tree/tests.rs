//! Properties of every tree, whatever its genes.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use glam::{Vec2, Vec3};

use genescape_schema::scene::Alpha;
use genescape_schema::{Category, Genome, Population, Space, TreePreset};

use super::budget::Budget;
use super::{ALPHA_CUTOFF, TreeParams, TreeTextureParams, cards, skeleton, template, textures};
use crate::model::{Image8, Material, Mesh, Part, PartKind, TreeTemplate, TreeTextures};
use crate::seed::Dice;

const GENOMES: u32 = 50;

static SPACE: LazyLock<Space> = LazyLock::new(Space::builtin);

/// A genome with every gene anywhere in its range.
fn random(seed: u32) -> Genome {
    Population::random(&SPACE, seed.into(), 0).individuals[0].genome.clone()
}

/// The genes that a stage reads from a genome.
pub(super) fn read<T: serde::de::DeserializeOwned>(genome: &Genome) -> T {
    genome.read(&SPACE).expect("the space declares every gene")
}

/// Genomes with the trees of `configs/presets`, by the names of their files.
pub(super) fn presets() -> Vec<(String, Genome)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/presets");
    let mut files: Vec<PathBuf> = folder.read_dir().unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let genome = |file: PathBuf| {
        let text = std::fs::read_to_string(&file).unwrap();
        let mut genome = random(0);
        let loaded = TreePreset::load(&SPACE, &file.to_string_lossy(), &text).unwrap();
        *genome.chromosome_mut(Category::Tree) = loaded.preset.tree;
        (file.file_stem().unwrap().to_string_lossy().into_owned(), genome)
    };
    let presets: Vec<_> = files.into_iter().map(genome).collect();
    assert!(presets.len() >= 9);
    presets
}

/// Bark of one colour, linear; leaves are white and opaque.
pub(super) fn plain(bark_linear: [f32; 3]) -> TreeTextures<()> {
    TreeTextures {
        bark_color: (),
        bark_normal: (),
        leaf: Vec::new(),
        blossom: Vec::new(),
        bark_linear,
        is_thin: false,
        leaf_small: Image8::default(),
        blossom_small: Image8::default(),
        alpha_cutoff: ALPHA_CUTOFF,
    }
}

fn oak() -> Genome {
    presets().into_iter().find(|(name, _)| name == "broadleaf").expect("the oak").1
}

fn trees() -> impl Iterator<Item = (TreeParams, TreeTemplate)> {
    let presets = presets().into_iter().map(|(_, genome)| genome);
    (0..GENOMES).map(random).chain(presets).map(|genome| {
        let params: TreeParams = read(&genome);
        let tree = template(&params, 1);
        (params, tree)
    })
}

fn at(mesh: &Mesh, vertex: u32) -> Vec3 {
    Vec3::from_array(mesh.positions[vertex as usize])
}

fn bark(mesh: &Mesh) -> &Part {
    &mesh.parts[0]
}

#[test]
fn bark_is_closed_and_faces_outwards() {
    for (params, tree) in trees() {
        let mesh = &tree.mesh;
        let place = |v: u32| mesh.positions[v as usize].map(f32::to_bits);
        let mut edges: BTreeMap<_, i32> = BTreeMap::new();
        for triangle in &bark(mesh).triangles {
            let p = triangle.map(place);
            for k in 0..3 {
                let (a, b) = (p[k], p[(k + 1) % 3]);
                assert_ne!(a, b, "an edge without length: {params:?}");
                *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
            }
        }
        let open = edges.values().filter(|&&sum| sum != 0).count();
        assert_eq!(open, 0, "{open} open edges: {params:?}");
        let volume: f32 = bark(mesh)
            .triangles
            .iter()
            .map(|t| at(mesh, t[0]).dot(at(mesh, t[1]).cross(at(mesh, t[2]))))
            .sum();
        assert!(volume > 0.0, "{params:?}");
    }
}

#[test]
fn triangles_stay_within_budget() {
    for (params, tree) in trees() {
        let count = tree.mesh.triangle_count();
        assert!(count <= 26_000, "{count}: {params:?}");
        assert!(count >= if params.levels == 1 { 600 } else { 1_200 }, "{count}: {params:?}");
    }
    let count = template(&read(&oak()), 0).mesh.triangle_count();
    assert!((15_000..=22_000).contains(&count), "{count}");
}

#[test]
fn attributes_are_complete_finite_and_normals_unit() {
    for (params, tree) in trees() {
        let mesh = &tree.mesh;
        let count = mesh.positions.len();
        assert_eq!([mesh.normals.len(), mesh.uvs.len(), mesh.colors.len()], [count; 3]);
        assert!(
            mesh.positions.iter().flatten().chain(mesh.uvs.iter().flatten()).all(|v| v.is_finite()),
            "{params:?}"
        );
        for &normal in &mesh.normals {
            let length = Vec3::from_array(normal).length();
            assert!((length - 1.0).abs() < 1e-3, "{length}: {params:?}");
        }
        assert!(tree.trunk_radius_m > 0.0 && tree.crown_radius_m > 0.0);
        assert!(tree.bounds.min.y <= -0.29, "roots reach into the ground: {params:?}");
        assert!(tree.bounds.max.y < 80.0, "{params:?}");
    }
}

#[test]
fn elements_are_consecutive() {
    for (_, tree) in trees() {
        assert_eq!(tree.mesh.parts[0].kind, PartKind::Surface);
        for part in &tree.mesh.parts[1..] {
            let PartKind::Aggregate { vertices, triangles } = part.kind else {
                panic!("leaves are an aggregate")
            };
            let first = part.triangles.as_flattened().iter().copied().min().unwrap_or(0);
            for (element, chunk) in part.triangles.chunks(triangles as usize).enumerate() {
                assert_eq!(chunk.len(), triangles as usize);
                let from = first + element as u32 * vertices;
                assert!(chunk.iter().flatten().all(|v| (from..from + vertices).contains(v)));
            }
        }
    }
}

#[test]
fn the_same_genes_give_the_same_tree_and_another_index_another() {
    let params = read(&random(3));
    assert_eq!(template(&params, 2), template(&params, 2));
    assert_ne!(template(&params, 2).mesh, template(&params, 3).mesh);
}

/// How much longer the texture is in one direction than in the other on a triangle, and its area.
fn stretch(mesh: &Mesh, triangle: [u32; 3]) -> Option<(f32, f32)> {
    let [a, b, c] = triangle.map(|v| at(mesh, v));
    let [s, t, u] = triangle.map(|v| Vec2::from_array(mesh.uvs[v as usize]));
    let (e, f, g, h) = (b - a, c - a, t - s, u - s);
    let determinant = g.x * h.y - g.y * h.x;
    let area = 0.5 * e.cross(f).length();
    if determinant.abs() < 1e-9 || area < 1e-9 {
        return None;
    }
    let along_u = (e * h.y - f * g.y) / determinant;
    let along_v = (f * g.x - e * h.x) / determinant;
    // Singular values of the map from texture to space.
    let (p, q, r) = (along_u.length_squared(), along_v.length_squared(), along_u.dot(along_v));
    let root = ((p - q) * (p - q) + 4.0 * r * r).sqrt();
    let (most, least) = (p + q + root, (p + q - root).max(1e-12));
    Some(((most / least).sqrt(), area))
}

#[test]
fn bark_is_not_stretched() {
    for (params, tree) in trees().filter(|(params, _)| params.root_flare < 1.2) {
        let mesh = &tree.mesh;
        let all: Vec<_> = bark(mesh).triangles.iter().filter_map(|&t| stretch(mesh, t)).collect();
        let whole: f32 = all.iter().map(|s| s.1).sum();
        let bad: f32 = all.iter().filter(|s| s.0 > 2.0).map(|s| s.1).sum();
        assert!(bad < 0.12 * whole, "{} of the bark is stretched: {params:?}", bad / whole);
    }
}

#[test]
fn texture_seams_share_positions_and_repeat_whole_numbers() {
    for (params, tree) in trees().take(20) {
        let mesh = &tree.mesh;
        // Wherever vertices coincide on a tube's side, u differs by a whole number of repeats.
        let mut places: BTreeMap<_, Vec<[f32; 2]>> = BTreeMap::new();
        for &v in bark(mesh).triangles.iter().flatten() {
            places
                .entry(mesh.positions[v as usize].map(f32::to_bits))
                .or_default()
                .push(mesh.uvs[v as usize]);
        }
        let mut seams = 0;
        for uvs in places.values() {
            let (first, last) = uvs.iter().fold((uvs[0], uvs[0]), |(lo, hi), &uv| {
                (if uv[0] < lo[0] { uv } else { lo }, if uv[0] > hi[0] { uv } else { hi })
            });
            if first[1] == last[1] && last[0] > first[0] && first[0] == 0.0 {
                seams += 1;
                assert_eq!(last[0], last[0].round(), "{params:?}");
            }
        }
        assert!(seams > 10);
    }
}

#[test]
fn every_card_is_rooted_on_a_stem() {
    for (params, _) in trees().take(30) {
        let budget = Budget::new(&params);
        let mut dice = Dice::new(params.tree_seed, "tree", 0);
        let skeleton = skeleton::grow(&params, &budget, &mut dice);
        let cards = cards::place(&params, &budget, &skeleton, &mut dice);
        for card in cards.iter().step_by(41) {
            let near = skeleton.stems.iter().flat_map(|stem| {
                skeleton.nodes[stem.nodes.clone()].windows(2).map(|pair| {
                    let (a, b) = (pair[0].at, pair[1].at);
                    let t = ((card.root - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
                    (card.root - a.lerp(b, t)).length() - pair[0].radius_m
                })
            });
            let near = near.fold(f32::MAX, f32::min);
            assert!(near < 0.01, "{near} m from any stem: {params:?}");
        }
    }
}

#[test]
fn leaders_stand_upright_but_nod_where_all_hangs() {
    // How high a trunk is, and how steeply it ends.
    let trunk = |tropism: f32| {
        let params = TreeParams { tropism, ..read(&oak()) };
        let mut dice = Dice::new(params.tree_seed, "tree", 0);
        let skeleton = skeleton::grow(&params, &Budget::new(&params), &mut dice);
        let stem = skeleton.stems.iter().find(|stem| stem.level == 0).expect("a trunk");
        let heights = skeleton.nodes[stem.nodes.clone()].iter().map(|node| node.at.y);
        let (_, tip, _) = skeleton.along(stem, 1.0);
        (heights.fold(0.0, f32::max), tip.y)
    };
    let ((upright_m, up), (nodding_m, down)) = (trunk(-0.4), trunk(-1.0));
    assert!(up > 0.8 && down < 0.2, "{up} {down}");
    assert!(nodding_m < 0.95 * upright_m, "{nodding_m} of {upright_m} m");
}

#[test]
fn crowns_are_shaded_but_never_black() {
    let params = read(&oak());
    let ranges = [0, 1, 2, 3, 4].map(|index| {
        let mesh = template(&params, index).mesh;
        let leaves =
            mesh.parts.iter().find(|part| part.material == Material::Leaf).expect("an oak has leaves");
        let light = || leaves.triangles.iter().map(|t| mesh.colors[t[0] as usize][1]);
        (light().min(), light().max())
    });
    assert!(ranges.iter().all(|(least, _)| (Some(90)..Some(150)).contains(least)), "{ranges:?}");
    assert!(ranges.iter().any(|(_, most)| *most > Some(210)), "{ranges:?}");
}

fn coverage(image: &crate::model::Image8) -> f32 {
    let kept = image.data.chunks_exact(4).filter(|p| f32::from(p[3]) >= 255.0 * ALPHA_CUTOFF).count();
    kept as f32 / (image.width * image.height) as f32
}

fn shown(image: &crate::model::Image8) -> f32 {
    let alphas: Vec<f32> = image.data.chunks_exact(4).map(|p| f32::from(p[3]) / 255.0).collect();
    Alpha::new(&alphas, image.width as usize).share(ALPHA_CUTOFF)
}

#[test]
fn a_tree_in_winter_bears_twigs_and_dead_wood_nothing() {
    let (_, winter) = presets().into_iter().find(|(name, _)| name == "winter").expect("a preset");
    let params: TreeParams = read(&winter);
    let cards = |params: &TreeParams| {
        let mesh = template(params, 0).mesh;
        let parts = mesh.parts.iter().filter(|part| part.material.is_card());
        parts.map(|part| part.triangles.len()).sum::<usize>()
    };
    assert!(cards(&params) > 1000, "{}", cards(&params));
    assert_eq!(cards(&TreeParams { secondary_branches: 0, ..params.clone() }), 0);

    let params: TreeTextureParams = read(&winter);
    let made = textures(&params);
    assert!(made.is_thin && !textures(&TreeTextureParams { leaves_per_stem: 1, ..params }).is_thin);
    let whole = coverage(&made.leaf[0]);
    assert!((0.04..0.2).contains(&whole), "twigs leave gaps: {whole}");
    let brown = |p: &[u8]| p[3] == 0 || (p[0] > p[1] && p[1] > p[2]);
    assert!(made.leaf[0].data.chunks_exact(4).all(brown), "no leaf is left");
}

#[test]
fn slender_needles_stand_in_tufts_with_bare_wood_between_them() {
    let base: TreeTextureParams = read(&oak());
    let card = |leaf_aspect| {
        let params = TreeTextureParams { leaf_shape: 6, leaf_hue_deg: 115.0, leaf_aspect, ..base.clone() };
        textures(&params).leaf.swap_remove(0)
    };
    let bare = |image: &Image8| {
        let opaque = || image.data.chunks_exact(4).filter(|p| p[3] > 200);
        opaque().filter(|p| p[0] > p[1]).count() as f32 / opaque().count() as f32
    };
    let [tufts, sprays] = [0.25, 0.5].map(card);
    assert!(bare(&tufts) > 4.0 * bare(&sprays), "{} of tufts, {} of sprays", bare(&tufts), bare(&sprays));
    assert!((0.15..0.5).contains(&coverage(&tufts)), "{}", coverage(&tufts));
}

#[test]
fn mips_keep_their_coverage() {
    for (name, genome) in presets() {
        let made = textures(&read(&genome));
        assert!(!made.is_thin || made.leaf.len() == 1, "{name}: levels of twigs are plain averages");
        let chains = [&made.leaf, &made.blossom].into_iter().skip(made.is_thin.into());
        assert!((coverage(&made.leaf_small) - coverage(&made.leaf[0])).abs() < 0.02, "{name}");
        for chain in chains {
            let whole = shown(&chain[0]);
            assert_eq!(chain.last().map(|image| image.width), Some(1));
            for level in chain.iter().filter(|level| level.width >= 8) {
                let here = shown(level);
                assert!((here - whole).abs() < 0.01, "{name} {}: {here} instead of {whole}", level.width);
            }
        }
    }
}

#[test]
fn leaf_cards_are_well_filled_and_bleed_colour() {
    for seed in 0..6 {
        let params: TreeTextureParams = read(&random(seed));
        for leaf_shape in [0, 3, 4, 5, 6, 7].into_iter().skip(seed as usize % 2).step_by(2) {
            let params = TreeTextureParams { leaf_shape, ..params.clone() };
            let made = textures(&params);
            let whole = coverage(&made.leaf[0]);
            assert!((0.05..0.9).contains(&whole), "{whole}: {params:?}");
            let clear = made.leaf[0].data.chunks_exact(4).filter(|p| p[3] == 0);
            assert!(clear.into_iter().all(|p| p[0] > 20 || p[1] > 20), "dark under transparent texels");
        }
    }
}

#[test]
fn bark_tiles() {
    for bark_tone in [0.0, 0.27, 0.5, 0.8, 1.0] {
        let params = TreeTextureParams { bark_tone, ..read(&oak()) };
        let image = textures(&params).bark_color;
        let size = image.width;
        let step = |a: u32, b: u32, along: bool| -> u32 {
            (0..size)
                .map(|i| {
                    let (p, q) = if along {
                        (image.pixel(a, i), image.pixel(b, i))
                    } else {
                        (image.pixel(i, a), image.pixel(i, b))
                    };
                    u32::from(p[1].abs_diff(q[1]))
                })
                .sum()
        };
        for along in [true, false] {
            let inside = (8..16).map(|k| step(k * 25, k * 25 + 1, along)).max().unwrap_or(0);
            let across = step(size - 1, 0, along);
            assert!(across <= inside * 2, "{across} against {inside} at tone {bark_tone}");
        }
    }
}
