//! A template → its levels of detail, as its file has them: with clusters, errors of pictures, and what casts its shadow.

use genescape_schema::scene::error_weight;
use glam::Vec2;

use super::ALPHA_CUTOFF;
use super::clusters;
use super::impostor::impostor_error_m;
use super::seen::{Compared, compare};
use super::surfaces::Surfaces;
use crate::model::{
    AlphaMask, Caster, Clusters, Image8, Level, LevelledMesh, Material, Mesh, Part, TreeTextures,
};
use crate::stages::lod::{self, Between, LodOptions, Step};

/// Triangles that are enough to cast a shadow onto a texel of a metre.
const CASTER_TRIANGLES: usize = 2_000;

/// No level follows one that has so many times the error of the tree's pictures: they show some of the tree by then, and all
/// of it from twice their error on.
const PAST_PICTURES: f32 = 1.2;

/// Twigs of dead trees are all that is seen of a crown, and stay longer than those among leaves: about here FLIP of the outline
/// is least.
const BARE_PIECE_WEIGHT: f32 = 2.0;

/// Where leaves stay single to the end, as fronds do, a stem keeps its width for longer: else it would be a thorn when half of the
/// fronds' bends still stand. With 2, FLIP of the outlines of sixteen palms, tree ferns and screw pines is higher by 4 % at D_1 and at
/// D_2, and the same at D_3; with 1, that of date palms is higher by a tenth at D_3.
const FROND_SURFACE_WEIGHT: f32 = 1.4;

/// Cards of twigs are all that is seen of a crown in winter, and stay longer than leaves: FLIP of the outlines of two bare oaks is
/// .028 and .033 at D_1 by it, and .039 and .036 by the weight of leaves.
const TWIG_WEIGHT: f32 = 0.33;

/// A template with its levels.
#[derive(Clone, Debug)]
pub struct Levelled {
    pub mesh: LevelledMesh,
    /// Pictures of the clusters that stand for leaves in coarse levels, if any do.
    pub clusters: Option<Clusters>,
    pub caster: Caster,
}

/// Makes the levels of a template; tells when each part of the work has ended.
pub fn levelled<P>(mesh: &Mesh, textures: &TreeTextures<P>, ended: &mut dyn FnMut(Step)) -> Levelled {
    let (mut caster, mut pictures, mut coverage) = (Caster::default(), None, None);
    let options = options(mesh, textures);
    let full = lod::fitted(mesh, &options.masks);
    let mut finish = |levels: &mut Vec<Level>, between: &Between<'_>| {
        // What a shadow is cast by lets light through between its leaves, which a map of such coarse texels does not draw.
        caster = caster_of(smallest_enough(levels), textures);
        let (surfaces, found) = match textures.is_thin {
            // A picture of sixteen pixels has room for leaves, not for twigs.
            true => (Surfaces::of(textures), None),
            false => clusters::substitute(&full, levels, between, Surfaces::of(textures)),
        };
        pictures = found;
        let coarser = levels.iter().skip(1).map(|level| &level.mesh);
        let meshes: Vec<&Mesh> = std::iter::once(mesh).chain(coarser).collect();
        let Compared { mut errors_m, coverage: covered } = compare(&meshes, &full, &surfaces);
        coverage = covered;
        let past_m = PAST_PICTURES * impostor_error_m(mesh, textures) / error_weight(coverage);
        let last = errors_m.iter().position(|&error_m| error_m >= past_m);
        errors_m.truncate(last.map_or(errors_m.len(), |last| last + 1));
        levels.truncate(errors_m.len() + 1);
        errors_m
    };
    let mesh = lod::levels_finished(mesh, &options, &mut finish, ended);
    let mesh = LevelledMesh { coverage, ..mesh };
    Levelled { mesh, clusters: pictures, caster }
}

/// How a template with these textures is simplified.
fn options<P>(mesh: &Mesh, textures: &TreeTextures<P>) -> LodOptions {
    let mask = |part: &Part| match part.material {
        Material::Leaf if textures.is_thin => AlphaMask::of_lines(&textures.leaf_small, ALPHA_CUTOFF),
        Material::Leaf => AlphaMask::of(&textures.leaf_small, ALPHA_CUTOFF),
        Material::Blossom => AlphaMask::of(&textures.blossom_small, ALPHA_CUTOFF),
        _ => AlphaMask::default(),
    };
    let masks = mesh.parts.iter().map(mask).collect();
    // Where leaves stay to the end, they are counted to the end.
    let clusters_from = clusters::first_level(mesh).filter(|_| !textures.is_thin);
    let counted_levels = clusters_from.map_or(u32::MAX, |first| first as u32 - 1);
    let mut options = LodOptions { masks, counted_levels, thickens: true, ..LodOptions::default() };
    match (mesh.has_cards(), clusters_from) {
        (false, _) => options.piece_weight = BARE_PIECE_WEIGHT,
        (true, _) if textures.is_thin => options.aggregate_weight = TWIG_WEIGHT,
        (true, None) => options.surface_weight = FROND_SURFACE_WEIGHT,
        (true, Some(_)) => {}
    }
    options
}

/// What casts the shadow of a template, with cards that hold back as much as their pictures do on average.
fn caster_of<P>(mesh: &Mesh, textures: &TreeTextures<P>) -> Caster {
    let opacity = |part: &Part| match part.material {
        Material::Leaf => card_opacity(mesh, part, &textures.leaf_small, textures.is_thin),
        Material::Blossom => card_opacity(mesh, part, &textures.blossom_small, false),
        _ => 1.0,
    };
    Caster { opacities: mesh.parts.iter().map(opacity).collect(), mesh: mesh.clone() }
}

/// The share of a part's triangles that a picture covers, at places that are spread evenly over some of them: a triangle may
/// reach beyond the picture, or leave out where it is empty, and one card differ from the next. Alpha is the share of each texel
/// that is covered where the picture holds thin lines.
fn card_opacity(mesh: &Mesh, part: &Part, picture: &Image8, is_thin: bool) -> f32 {
    const TRIANGLES: usize = 16;
    const PLACES: usize = 32;
    let side = [picture.width, picture.height].map(|side| side as f32);
    let covered = |uv: Vec2| {
        if uv.min_element() < 0.0 || uv.max_element() >= 1.0 || picture.channels != 4 {
            return f32::from(u8::from(picture.channels != 4));
        }
        let alpha = picture.pixel((uv.x * side[0]) as u32, (uv.y * side[1]) as u32)[3];
        let alpha = f32::from(alpha) / 255.0;
        if is_thin { alpha } else { f32::from(u8::from(alpha >= ALPHA_CUTOFF)) }
    };
    let (mut sum, mut all) = (0.0, 0.0);
    // Odd, or all of them might be the same half of a card.
    let step = (part.triangles.len() / TRIANGLES) | 1;
    for triangle in part.triangles.iter().step_by(step) {
        let uv = |v: u32| mesh.uvs.get(v as usize).copied().map_or(Vec2::ZERO, Vec2::from_array);
        let [a, b, c] = triangle.map(uv);
        let (ab, ac) = (b - a, c - a);
        let area = ab.perp_dot(ac).abs();
        for k in 0..PLACES * PLACES {
            let place = [k % PLACES, k / PLACES].map(|at| (at as f32 + 0.5) / PLACES as f32);
            // The other half of the parallelogram is the same triangle once more.
            let [s, t] = if place[0] + place[1] > 1.0 { place.map(|at| 1.0 - at) } else { place };
            sum += area * covered(a + s * ab + t * ac);
            all += area;
        }
    }
    if all > 0.0 { sum / all } else { 1.0 }
}

/// The finest level that is small enough to be rasterised for every instance, else the coarsest.
fn smallest_enough(levels: &[Level]) -> &Mesh {
    let small = |level: &&Level| level.mesh.triangle_count() <= CASTER_TRIANGLES;
    &levels.iter().find(small).unwrap_or(&levels[levels.len() - 1]).mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::PartKind;
    use crate::stages::tree::tests::{presets, read};
    use crate::stages::tree::{template, textures};

    #[test]
    fn cards_that_are_drawn_as_triangles_show_nearly_the_same() {
        let mut fitted = 0;
        for (name, genome) in presets() {
            let (tree, textures) = (template(&read(&genome), 0), textures(&read(&genome)));
            let full = lod::fitted(&tree.mesh, &options(&tree.mesh, &textures).masks);
            fitted += usize::from(full.triangle_count() < tree.mesh.triangle_count());
            let levels = levelled(&tree.mesh, &textures, &mut |_| ()).mesh.levels;
            let found =
                compare(&[&tree.mesh, &full, &levels[1].mesh], &tree.mesh, &Surfaces::of(&textures)).errors_m;
            assert!(found[0] < 0.25 * found[1], "{name}: {} m off, D_1 is {} m", found[0], found[1]);
        }
        assert!(fitted > 2, "hardly any tree has flat cards");
    }

    #[test]
    fn a_card_holds_back_as_much_light_as_the_triangle_that_becomes_of_it() {
        let mut fitted = 0;
        for (name, genome) in presets() {
            let (tree, textures) = (template(&read(&genome), 0), textures(&read(&genome)));
            let full = lod::fitted(&tree.mesh, &options(&tree.mesh, &textures).masks);
            if full.triangle_count() == tree.mesh.triangle_count() {
                continue;
            }
            let held_back = |mesh: &Mesh| {
                let leaves = mesh.parts.iter().find(|part| part.material == Material::Leaf).expect("leaves");
                let PartKind::Aggregate { triangles, .. } = leaves.kind else { panic!("{name}: mixed") };
                let area = |t: &[u32; 3]| {
                    let [a, b, c] = t.map(|v| Vec2::from_array(mesh.uvs[v as usize]));
                    0.5 * (b - a).perp_dot(c - a).abs()
                };
                let element: f32 = leaves.triangles[..triangles as usize].iter().map(area).sum();
                element * card_opacity(mesh, leaves, &textures.leaf_small, textures.is_thin)
            };
            let (card, triangle) = (held_back(&tree.mesh), held_back(&full));
            assert!(
                (triangle / card - 1.0).abs() < 0.1,
                "{name}: {card} of a card, {triangle} of a triangle"
            );
            fitted += 1;
        }
        assert!(fitted > 2, "hardly any tree has flat cards");
    }

    #[test]
    fn no_twig_is_cut_off_by_the_triangle_that_becomes_of_its_card() {
        let (_, winter) = presets().into_iter().find(|(name, _)| name == "winter").expect("a preset");
        let (tree, textures) = (template(&read(&winter), 0), textures(&read(&winter)));
        let full = lod::fitted(&tree.mesh, &options(&tree.mesh, &textures).masks);
        let leaves = full.parts.iter().find(|part| part.material == Material::Leaf).expect("twigs");
        assert!(full.triangle_count() < tree.mesh.triangle_count(), "its cards are triangles");
        let [a, b, c] = leaves.triangles[0].map(|v| Vec2::from_array(full.uvs[v as usize]));
        let is_inside = |p: Vec2| {
            let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| (to - from).perp_dot(p - from) > 0.0);
            sides[0] == sides[1] && sides[1] == sides[2]
        };
        let twigs = &textures.leaf[0];
        for (i, pixel) in twigs.data.chunks_exact(4).enumerate() {
            let [x, y] = [i as u32 % twigs.width, i as u32 / twigs.width].map(|t| t as f32 + 0.5);
            let is_shown = f32::from(pixel[3]) >= 255.0 * ALPHA_CUTOFF;
            assert!(!is_shown || is_inside(Vec2::new(x, y) / twigs.width as f32), "{x}, {y}");
        }
    }
}
