//! Levels of a tree → the same with clusters in the place of leaves where single leaves no longer pay.
//!
//! Of a tree with an eighth of its vertices or fewer, the leaves that stay would have to be so large that they show as what
//! they are. So all leaves of the full tree are grouped instead, and each group is shown by two crossed cards with pictures of
//! it: a billboard cloud (Décoret, Durand, Sillion, Dorsey, "Billboard clouds for extreme model simplification", 2003) of small
//! crossed pairs. Each level has as many vertices as it had with leaves. Cards grow or shrink until the level covers as
//! much as the full tree.

mod atlas;
mod card;
mod groups;

use std::ops::Range;

use glam::Vec3;

use super::outline::cover;
use super::raster::Look;
use super::seen::frame;
use super::surfaces::Surfaces;
use crate::math::matching;
use crate::model::{Clusters, Level, Material, Mesh, Morph, Part, PartKind};
use crate::silhouette::Silhouette;
use atlas::Subject;
use card::Card;
use groups::Place;

/// The first level that may have clusters.
const FIRST: usize = 3;
/// Leaves are shown one by one where a cluster would have fewer of them on average.
const MIN_LEAVES: usize = 4;
/// Vertices of a card, and of a cluster.
const CARD: usize = 4;
const CLUSTER: usize = 2 * CARD;

/// So many leaves at least are drawn of a cluster that has more: every nth, as much larger as makes up for the others.
const DRAWN_LEAVES: usize = 64;

/// Views in which it is counted how much a level covers, and samples a side: sides of the impostor, and how far each looks from
/// below or above, as the tangent of its elevation. Four from one height would not do: how much few crossed cards cover depends
/// on how they are turned to the eye.
const VIEWS: [(usize, f32); 8] =
    [(0, -0.2), (1, 0.2), (2, 0.2), (3, -0.2), (0, 0.2), (1, -0.2), (2, -0.2), (3, 0.2)];
const COVERAGE_PX: usize = 128;
/// How much smaller or larger cards may become.
const SCALES: Range<f32> = 0.7..1.5;

/// The first level of a full tree that will have clusters, as far as can be told before it is simplified.
pub fn first_level(full: &Mesh) -> Option<usize> {
    let element = |part: &Part| match part.kind {
        PartKind::Aggregate { vertices, .. } => Some(vertices as usize),
        PartKind::Surface => None,
    };
    let mut elements =
        full.parts.iter().filter(|part| !part.triangles.is_empty()).filter_map(element).peekable();
    // A quarter of the leaves' vertices at most is left where the tree has an eighth of its own.
    let pays = |vertices: usize| vertices * MIN_LEAVES <= 4 * CLUSTER;
    (elements.peek().is_some() && elements.all(pays)).then_some(FIRST)
}

/// Puts clusters of the full tree's leaves in the place of leaves and gives their pictures; `None` where all levels stay as
/// they are. Of the full tree it is drawn what shows the same, with as many leaves in as many parts. `between` says where the
/// vertices of one level go until it is another, by their numbers.
pub fn substitute(
    full: &Mesh,
    levels: &mut [Level],
    between: impl Fn(usize, usize) -> Morph,
    surfaces: Surfaces,
) -> (Surfaces, Option<Clusters>) {
    let foliage: Vec<Foliage<'_>> =
        (0..full.parts.len()).filter_map(|part| Foliage::of(full, part)).collect();
    if foliage.is_empty() {
        return (surfaces, None);
    }
    let is_wood = |part: usize| foliage.iter().all(|leaves| leaves.part != part);
    let (canvas, mut covered) = (Canvas::new(full), Canvas::empty());
    canvas.draw(full, &surfaces, is_wood, &mut covered);
    let of_wood = count(&covered);
    canvas.draw(full, &surfaces, |part| !is_wood(part), &mut covered);
    let target = count(&covered);
    let woods = woods(levels, is_wood, of_wood as f32 / target.max(1) as f32);
    let shares = shares(&canvas, full, &surfaces, &foliage);
    let cards_of = |level: usize| {
        let vertices = levels[level].mesh.positions.len();
        shared_out(vertices.saturating_sub(vertices_of(&levels[woods[level]], is_wood)), &shares)
    };
    let pays =
        |level: &usize| foliage.iter().zip(cards_of(*level)).all(|(leaves, cards)| leaves.pay_on(cards));
    let Some(first) = (FIRST..levels.len()).find(pays) else { return (surfaces, None) };

    let mut subjects = Vec::new();
    // Of each level its parts, and which of the subjects are theirs.
    let mut owned = vec![Vec::new(); levels.len() - first];
    for (n, leaves) in foliage.iter().enumerate() {
        let cards: Vec<usize> = (first..levels.len()).map(|level| cards_of(level)[n]).collect();
        for (owned, of_level) in owned.iter_mut().zip(leaves.subjects(&cards)) {
            let before = subjects.len();
            subjects.extend(of_level);
            owned.push((leaves.part, before..subjects.len()));
        }
    }
    let (pictures, atlas) = atlas::draw(&subjects, &surfaces);
    let surfaces = surfaces.with_clusters(atlas);
    let wardrobe = Wardrobe::new(&subjects);
    let mut scale = 1.0;
    let dress = |(level, owned): (usize, &Vec<Owned>)| {
        let wood = &levels[woods[level]];
        let mut rest = Canvas::empty();
        canvas.draw(&wood.mesh, &surfaces, is_wood, &mut rest);
        let covered = |scale: f32| {
            let mut covered = rest.clone();
            canvas.draw(&wardrobe.cards_of(owned, scale), &surfaces, |_| true, &mut covered);
            count(&covered)
        };
        scale = matching(target, SCALES, scale, covered);
        let morph = woods.get(level + 1).map(|&next| between(woods[level], next));
        wardrobe.dressed(wood, morph, owned, scale)
    };
    let dressed: Vec<Level> = (first..levels.len()).zip(&owned).map(dress).collect();
    let last_leaves = &mut levels[first - 1];
    last_leaves.morph = Some(between(first - 1, woods[first]));
    foliage.iter().for_each(|leaves| hold_still(last_leaves, leaves.part));
    levels[first..].iter_mut().zip(dressed).for_each(|(level, dressed)| *level = dressed);
    (surfaces, Some(pictures))
}

/// For each level that whose wood it has: its own, or of a coarser one where its own takes a larger share of the vertices than
/// of what the tree covers. As the simplifier weighs bends of boughs against leaves, those go last, and a few clusters would
/// stand for a whole crown.
fn woods(levels: &[Level], is_wood: impl Fn(usize) -> bool, share: f32) -> Vec<usize> {
    let sizes: Vec<usize> = levels.iter().map(|level| vertices_of(level, &is_wood)).collect();
    let wood_of = |level: usize| {
        let most = share * levels[level].mesh.positions.len() as f32;
        (level..levels.len()).find(|&coarser| sizes[coarser] as f32 <= most).unwrap_or(levels.len() - 1)
    };
    (0..levels.len()).map(wood_of).collect()
}

/// Vertices of those of a level's parts whose index is asked for.
fn vertices_of(level: &Level, is_counted: impl Fn(usize) -> bool) -> usize {
    let counted = level.mesh.parts.iter().enumerate().filter(|(index, _)| is_counted(*index));
    counted.map(|(_, part)| run(part).len()).sum()
}

/// The share of the cards that each part of the foliage has, by how much it would cover alone. The simplifier keeps few large
/// leaves rather than many small ones, so that of trees in blossom it leaves little but flowers.
fn shares(canvas: &Canvas, full: &Mesh, surfaces: &Surfaces, foliage: &[Foliage<'_>]) -> Vec<f32> {
    if foliage.len() < 2 {
        return vec![1.0; foliage.len()];
    }
    let alone =
        |leaves: &Foliage<'_>| canvas.covered(full, surfaces, |part| part == leaves.part).max(1) as f32;
    let covered: Vec<f32> = foliage.iter().map(alone).collect();
    let sum: f32 = covered.iter().sum();
    covered.into_iter().map(|covered| covered / sum).collect()
}

/// How many cards each part of the foliage has: all for which there are vertices, and one at least.
fn shared_out(vertices: usize, shares: &[f32]) -> Vec<usize> {
    shares.iter().map(|share| ((vertices / CARD) as f32 * share).round().max(1.0) as usize).collect()
}

/// A part of a level, and the run of subjects that it shows.
type Owned = (usize, Range<usize>);

/// All leaves of a part of the full tree.
struct Foliage<'a> {
    mesh: &'a Mesh,
    part: usize,
    /// Vertices and triangles of a leaf.
    per: [usize; 2],
    first_vertex: usize,
    /// One for each leaf.
    places: Vec<Place>,
}

impl<'a> Foliage<'a> {
    /// `None` of what is no aggregate, or an empty one.
    fn of(mesh: &'a Mesh, part: usize) -> Option<Self> {
        let PartKind::Aggregate { vertices, triangles } = mesh.parts[part].kind else { return None };
        let per = [vertices, triangles].map(|count| (count as usize).max(1));
        let run = run(&mesh.parts[part]);
        let center = |leaf: &[[f32; 3]]| {
            let at_m = leaf.iter().map(|&p| Vec3::from_array(p)).sum::<Vec3>() / leaf.len() as f32;
            Place { at_m, weight: 1.0 }
        };
        let places: Vec<Place> = mesh.positions[run.clone()].chunks_exact(per[0]).map(center).collect();
        (!places.is_empty()).then_some(Self { mesh, part, per, first_vertex: run.start, places })
    }

    /// Whether each cluster would have enough leaves.
    fn pay_on(&self, cards: usize) -> bool {
        cards >= 2 && cards / 2 * MIN_LEAVES <= self.places.len()
    }

    /// What each of some levels shows, one coarser than the other, each on so many cards.
    fn subjects(&self, cards: &[usize]) -> Vec<Vec<Subject>> {
        let mut places = self.places.clone();
        let mut place_of: Vec<u32> = (0..places.len() as u32).collect();
        let of_level = |&cards: &usize| {
            let count = cards.div_ceil(2);
            let group = groups::groups(&places, count);
            place_of.iter_mut().for_each(|place| *place = group[*place as usize]);
            places = groups::gathered(&places, &group, count);
            let mut leaves = vec![Vec::new(); count];
            place_of.iter().enumerate().for_each(|(leaf, &group)| leaves[group as usize].push(leaf));
            let subject = |(n, leaves): (usize, Vec<usize>)| self.subject(&leaves, (cards - 2 * n).min(2));
            leaves.into_iter().enumerate().filter(|(_, leaves)| !leaves.is_empty()).map(subject).collect()
        };
        cards.iter().map(of_level).collect()
    }

    /// Some leaves, on one card or two.
    fn subject(&self, leaves: &[usize], cards: usize) -> Subject {
        let [vertices, triangles] = self.per;
        let part = &self.mesh.parts[self.part];
        let mut shown = Mesh::default();
        let mut faces = Vec::with_capacity(triangles * leaves.len());
        let one_in = (leaves.len() / DRAWN_LEAVES).max(1);
        let scale = (one_in as f32).sqrt();
        for leaf in leaves.iter().step_by(one_in) {
            let first = self.first_vertex + leaf * vertices;
            let moved = shown.positions.len() as u32;
            let middle_m = self.places[*leaf].at_m;
            let grown = |&p: &[f32; 3]| (middle_m + scale * (Vec3::from_array(p) - middle_m)).to_array();
            shown.positions.extend(self.mesh.positions[first..][..vertices].iter().map(grown));
            let run = first..first + vertices;
            shown.normals.extend_from_slice(self.mesh.normals.get(run.clone()).unwrap_or_default());
            shown.uvs.extend_from_slice(self.mesh.uvs.get(run.clone()).unwrap_or_default());
            shown.colors.extend_from_slice(self.mesh.colors.get(run).unwrap_or_default());
            let of_leaf = &part.triangles[leaf * triangles..][..triangles];
            faces.extend(of_leaf.iter().map(|t| t.map(|v| v - first as u32 + moved)));
        }
        let points: Vec<Vec3> = shown.positions.iter().map(|&p| Vec3::from_array(p)).collect();
        shown.parts.push(Part { material: part.material, kind: part.kind, triangles: faces });
        let cards = Card::crossed(&points).into_iter().take(cards);
        Subject { leaves: shown, cards: cards.map(|card| card.grown(atlas::MARGIN)).collect() }
    }
}

/// The vertices of a part.
fn run(part: &Part) -> Range<usize> {
    let used = part.triangles.as_flattened();
    match (used.iter().min(), used.iter().max()) {
        (Some(&low), Some(&high)) => low as usize..high as usize + 1,
        _ => 0..0,
    }
}

/// All cards with their numbers in the image.
struct Wardrobe {
    cards: Vec<Card>,
    /// Of each subject, and one past the last.
    first_card: Vec<usize>,
}

impl Wardrobe {
    fn new(subjects: &[Subject]) -> Self {
        let mut first_card = vec![0];
        first_card.extend(subjects.iter().scan(0, |sum, subject| {
            *sum += subject.cards.len();
            Some(*sum)
        }));
        let cards = subjects.iter().flat_map(|subject| subject.cards.iter().copied()).collect();
        Self { cards, first_card }
    }

    /// The cards of some parts, larger by `scale`.
    fn cards_of(&self, owned: &[Owned], scale: f32) -> Mesh {
        let mut mesh = Mesh::default();
        for (_, subjects) in owned {
            let triangles = self.add_cards(&mut mesh, self.run(subjects), scale);
            mesh.parts.push(Part { material: Material::Cluster, kind: PartKind::Surface, triangles });
        }
        mesh
    }

    fn run(&self, subjects: &Range<usize>) -> Range<usize> {
        self.first_card[subjects.start]..self.first_card[subjects.end]
    }

    /// A level with subjects in the place of some of its parts, on cards larger by `scale`, and with that morph of the others.
    fn dressed(&self, level: &Level, old_morph: Option<Morph>, owned: &[Owned], scale: f32) -> Level {
        let old = &level.mesh;
        let mut mesh = Mesh::default();
        let mut morph = old_morph.as_ref().map(|_| Morph::default());
        let mut strips = Vec::new();
        for (index, part) in old.parts.iter().enumerate() {
            let first = mesh.positions.len();
            if let Some((_, subjects)) = owned.iter().find(|(part, _)| *part == index) {
                let triangles = self.add_cards(&mut mesh, self.run(subjects), scale);
                strips.push(strip_of_cards(&triangles));
                let kind = PartKind::Aggregate { vertices: CARD as u32, triangles: 2 };
                mesh.parts.push(Part { material: Material::Cluster, kind, triangles });
            } else {
                let run = run(part);
                let moved = |v: &u32| v - run.start as u32 + first as u32;
                mesh.positions.extend_from_slice(&old.positions[run.clone()]);
                mesh.normals.extend_from_slice(old.normals.get(run.clone()).unwrap_or_default());
                mesh.uvs.extend_from_slice(old.uvs.get(run.clone()).unwrap_or_default());
                mesh.colors.extend_from_slice(old.colors.get(run.clone()).unwrap_or_default());
                strips.push(level.strips.get(index).into_iter().flatten().map(moved).collect());
                let triangles = part.triangles.iter().map(|t| t.each_ref().map(moved)).collect();
                mesh.parts.push(Part { material: part.material, kind: part.kind, triangles });
                if let Some((morph, old)) = morph.as_mut().zip(old_morph.as_ref()) {
                    morph.positions.extend_from_slice(&old.positions[run.clone()]);
                    morph.normals.extend_from_slice(old.normals.get(run.clone()).unwrap_or_default());
                    morph.uvs.extend_from_slice(old.uvs.get(run).unwrap_or_default());
                }
            }
            if let Some(morph) = &mut morph {
                morph.positions.resize(mesh.positions.len(), [0.0; 3]);
                morph.normals.resize(mesh.normals.len(), [0.0; 3]);
                morph.uvs.resize(mesh.uvs.len(), [0.0; 2]);
            }
        }
        Level { mesh, morph, error_m: level.error_m, strips }
    }

    fn add_cards(&self, mesh: &mut Mesh, cards: Range<usize>, scale: f32) -> Vec<[u32; 3]> {
        let mut triangles = Vec::with_capacity(2 * cards.len());
        for number in cards {
            let first = mesh.positions.len() as u32;
            let card = self.cards[number].grown(scale);
            for corner in card.corners() {
                mesh.positions.push(corner.to_array());
                // Its picture of normals says the rest.
                mesh.normals.push(card.front().to_array());
                mesh.colors.push([255; 4]);
            }
            mesh.uvs.extend(atlas::corners(number, self.cards.len()));
            triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
        triangles
    }
}

/// Two triangles a card → one generalised strip, in which vertices that are named twice lead from card to card.
fn strip_of_cards(triangles: &[[u32; 3]]) -> Vec<u32> {
    let (cards, _) = triangles.as_chunks::<2>();
    let mut strip: Vec<u32> = Vec::with_capacity(6 * cards.len());
    for [[a, b, c], [_, _, d]] in cards {
        strip.extend(strip.last().copied().into_iter().flat_map(|last| [last, *b]));
        strip.extend([b, c, a, d]);
    }
    strip
}

/// Leaves of a level stay where they are while clusters come in their place.
fn hold_still(level: &mut Level, part: usize) {
    let run = run(&level.mesh.parts[part]);
    if let Some(morph) = &mut level.morph {
        morph.positions[run.clone()].fill([0.0; 3]);
        morph.normals.get_mut(run.clone()).unwrap_or_default().fill([0.0; 3]);
        morph.uvs.get_mut(run).unwrap_or_default().fill([0.0; 2]);
    }
}

/// Views in which it is counted how much of them meshes cover.
struct Canvas {
    looks: [Look; VIEWS.len()],
}

/// What is covered in each of the views.
type Covered = [Silhouette; VIEWS.len()];

impl Canvas {
    /// Views of what is as large as the full tree.
    fn new(full: &Mesh) -> Self {
        let (foot_m, side_m) = frame(full);
        let looks = VIEWS.map(|(k, tilt)| Look::new(k, foot_m, [side_m; 2], COVERAGE_PX).tilted(tilt));
        Self { looks }
    }

    fn empty() -> Covered {
        VIEWS.map(|_| Silhouette::empty(COVERAGE_PX))
    }

    /// How much those of a mesh's parts cover whose index is asked for.
    fn covered(&self, mesh: &Mesh, surfaces: &Surfaces, is_counted: impl Fn(usize) -> bool) -> u32 {
        let mut covered = Self::empty();
        self.draw(mesh, surfaces, is_counted, &mut covered);
        count(&covered)
    }

    /// Draws those of a mesh's parts whose index is asked for.
    fn draw(
        &self,
        mesh: &Mesh,
        surfaces: &Surfaces,
        is_drawn: impl Fn(usize) -> bool,
        covered: &mut Covered,
    ) {
        for (look, silhouette) in self.looks.iter().zip(covered) {
            cover(mesh, &is_drawn, surfaces, look, silhouette);
        }
    }
}

fn count(covered: &Covered) -> u32 {
    covered.iter().map(Silhouette::covered).sum()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::model::{Image8, TreeTextures};
    use crate::stages::tree::tests::{presets, read};
    use crate::stages::tree::{levelled, template, textures};

    #[test]
    fn flowers_leave_cards_to_the_leaves() {
        let mut in_blossom = 0;
        for (name, genome) in presets() {
            let (tree, textures) = (template(&read(&genome), 0), textures(&read(&genome)));
            let made = levelled(&tree.mesh, &textures, &mut |_| ());
            let foliage: Vec<Foliage<'_>> =
                (0..tree.mesh.parts.len()).filter_map(|part| Foliage::of(&tree.mesh, part)).collect();
            if foliage.len() < 2 {
                continue;
            }
            in_blossom += 1;
            let canvas = Canvas::new(&tree.mesh);
            let shares = shares(&canvas, &tree.mesh, &Surfaces::of(&textures), &foliage);
            let is_cluster = |part: &&Part| part.material == Material::Cluster;
            for level in &made.mesh.levels {
                let clusters = level.mesh.parts.iter().filter(is_cluster);
                let all = clusters.map(|part| part.triangles.len()).sum::<usize>() as f32;
                for (leaves, share) in foliage.iter().zip(&shares).filter(|_| all > 0.0) {
                    let own = level.mesh.parts[leaves.part].triangles.len() as f32;
                    assert!(
                        (own / all - share).abs() <= 0.02 + 2.0 / all,
                        "{name}: {own} of {all}, not {share}"
                    );
                }
            }
        }
        assert!(in_blossom > 0, "no tree is in blossom");
    }

    /// The part of what a tree covers that its wood alone covers.
    fn wood_share(tree: &Mesh, textures: &TreeTextures<Image8>) -> f32 {
        let (canvas, surfaces) = (Canvas::new(tree), Surfaces::of(textures));
        let of_wood = canvas.covered(tree, &surfaces, |part| !tree.parts[part].material.is_card());
        of_wood as f32 / canvas.covered(tree, &surfaces, |_| true) as f32
    }

    #[test]
    fn levels_with_clusters_halve_as_before_and_are_whole() {
        let mut dressed = 0;
        for (name, genome) in presets() {
            let (tree, textures) = (template(&read(&genome), 0), textures(&read(&genome)));
            let made = levelled(&tree.mesh, &textures, &mut |_| ());
            let is_cluster = |part: &Part| part.material == Material::Cluster;
            let levels = &made.mesh.levels;
            let first = levels.iter().position(|level| level.mesh.parts.iter().any(is_cluster));
            assert_eq!(first.is_some(), made.clusters.is_some(), "{name}");
            let Some(first) = first else { continue };
            assert!(first >= FIRST, "{name}");
            dressed += 1;
            for (k, pair) in levels.windows(2).enumerate().skip(first - 1) {
                let [before, after] = [0, 1].map(|i| pair[i].mesh.positions.len() as f32);
                // A cluster may not fit in any more.
                assert!(
                    (after - before / 2.0).abs() <= 0.02 * before + 8.0,
                    "{name} D{k}: {before}, {after}"
                );
            }
            for level in &levels[first..] {
                let mesh = &level.mesh;
                assert!(mesh.uvs.iter().zip(&mesh.positions).len() == mesh.normals.len());
                let morphs = level.morph.as_ref();
                assert!(morphs.is_none_or(|morph| morph.positions.len() == mesh.positions.len()));
                for part in mesh.parts.iter().filter(|part| is_cluster(part)) {
                    assert!(run(part).all(|v| mesh.uvs[v].iter().all(|t| (0.0..=1.0).contains(t))));
                }
            }
            // Wood never takes more of the vertices than of what is covered, unless there is no coarser wood.
            let is_wood = |part: usize| !tree.mesh.parts[part].material.is_card();
            let most = wood_share(&tree.mesh, &textures) + 0.01;
            let last = vertices_of(&levels[levels.len() - 1], is_wood);
            for (k, level) in levels.iter().enumerate().skip(first) {
                let wood = vertices_of(level, is_wood);
                let share = wood as f32 / level.mesh.positions.len() as f32;
                assert!(share <= most || wood == last, "{name} D{k}: {share} is wood");
            }
            // It ends its morph where the next level has it, even if that skips some of the simplifier's.
            for pair in levels[first - 1..].windows(2) {
                let morph = pair[0].morph.as_ref().expect("a morph");
                let ends = |level: &Level, morph: Option<&Morph>| -> BTreeSet<[i32; 3]> {
                    let wood = level.mesh.parts.iter().enumerate().filter(|(part, _)| is_wood(*part));
                    let moved = |v: usize| {
                        let by_m = morph.map_or([0.0; 3], |morph| morph.positions[v]);
                        let end_m = Vec3::from_array(level.mesh.positions[v]) + Vec3::from_array(by_m);
                        (1000.0 * end_m).round().to_array().map(|mm| mm as i32)
                    };
                    wood.flat_map(|(_, part)| run(part)).map(moved).collect()
                };
                let missed = ends(&pair[1], None).difference(&ends(&pair[0], Some(morph))).count();
                let all = vertices_of(&pair[1], is_wood);
                // Where rounding is in doubt, an end is a millimetre beside.
                assert!(100 * missed <= all, "{name}: {missed} of {all} vertices come from nowhere");
            }
            let held = levels[first - 1].morph.as_ref().expect("a morph");
            let leaves = levels[first - 1].mesh.parts.iter().filter(|part| part.material.is_card());
            assert!(leaves.flat_map(run).all(|v| held.positions[v] == [0.0; 3]), "{name}: leaves move");
        }
        assert!(dressed > 2, "hardly any tree has clusters");
    }
}
