//! A heightfield → where its land is rough, and from that how near each level of detail may come to the eye. Metres.
//!
//! The uniform triangulation of level l strays from the land by e_l at most, differently from place to place. Where it
//! strays by little it may be drawn nearer: from the distance d_l(x, z) on. [`super::morph`] says how λ follows from these
//! and what they must fulfil, so that no crack opens and no triangle folds: each d_l changes by at most σ metres a metre,
//! and d_{l+1} − d_l is at least the way on which one level becomes the next, (1 + σ) · 8√2 · 2^l cells. So both distance and
//! roughness enter as smooth fields (the thesis, 9, asks for morphing that adapts to the land and leaves open how).

use std::f32::consts::FRAC_1_SQRT_2;

use genescape_schema::scene::bintree::parents;

use super::block::{Block, block_cells, block_number, top_level};
use crate::scene::Heightfield;

/// log₂ of the cells between the places for which reaches are kept.
const TILE_BITS: u32 = 4;
/// How many metres a reach may change by for each metre along the land (σ): the less, the wider rough places are
/// surrounded by fine triangles, the more, the more of them smooth land needs. At 0 the land's roughest place speaks for
/// all of it. Which of these costs least depends on the land, and is found out. More would save triangles where the worst
/// place is what counts, but the whole picture would be farther from the land than with as many triangles by distance alone.
const STEEPNESSES: [f32; 2] = [0.0, 0.25];
/// How far one goes at least, if σ is 0, while level 0 becomes level 1: 8√2 cells, and a little more for rounding.
const MIN_MORPH_CELLS: f32 = 1.03 * 8.0 * std::f32::consts::SQRT_2;
/// A level is used from a little farther on than its error alone would ask, because it is there before λ has reached it:
/// by this part of the way on which it comes …
const EARLY: f32 = 0.6;
/// … or by distance alone, where that way is half of the reach, from that many times as far on.
const EARLY_BY_DISTANCE: f32 = 1.45;
/// Levels beyond a block's own that its vertices may ask for.
const LEVELS_ABOVE: usize = 3;

/// How far the uniform triangulations of a field are from it, and where. To be computed once a field.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Roughness {
    grid: Grid,
    /// For each level from 1 on, a number a node: the greatest vertical distance in metres within the tiles around it.
    levels_m: Vec<Vec<f32>>,
    /// Blocks of each level from 0 on, along a side.
    across: Vec<u32>,
}

/// Nodes at the corners of square tiles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Grid {
    /// Along a side.
    nodes: u32,
    tile_m: f32,
    cell_m: f32,
    /// Cells of a tile, along a side.
    tile_cells: u32,
    /// Cells of a block, along a side.
    block_cells: u32,
}

/// From which distance on each level may be drawn, place by place.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reach {
    grid: Grid,
    /// d_l in metres, of a node each, for each level from 0 to three beyond the coarsest.
    levels_m: Vec<Vec<f32>>,
    /// Of each block, as [`block_number`] counts, its own level's greatest d.
    blocks_m: Vec<f32>,
    /// How far one goes while level 0 becomes level 1; while l becomes l + 1, 2^l times as far.
    pub morph_m: f32,
}

impl Roughness {
    /// Measures a field at each level up to [`top_level`].
    pub fn of(field: &Heightfield) -> Self {
        let bits = TILE_BITS.min(field.depth());
        let tile_cells = 1 << bits;
        let nodes = ((field.side - 1) >> bits) + 1;
        let grid = Grid {
            nodes,
            tile_m: tile_cells as f32 * field.spacing_m,
            cell_m: field.spacing_m,
            tile_cells,
            block_cells: block_cells(field),
        };
        let mut drawn_m = Vec::new();
        let levels = 1..=top_level(field);
        let levels_m = levels.map(|level| grid.errors_m(field, level, &mut drawn_m)).collect();
        let across =
            (0..=top_level(field)).map(|level| (field.side - 1) / (grid.block_cells << level)).collect();
        Self { grid, levels_m, across }
    }

    /// Reaches by which no level looks farther from the land than one pixel, where `pixels` is how many a radian covers:
    /// ½·height/tan(½·fov), over the pixels of error that are allowed. Positive and finite.
    pub fn reach(&self, pixels: f32) -> Reach {
        let all = STEEPNESSES.map(|steepness| self.reach_of_steepness(pixels, steepness));
        let least = all.into_iter().min_by(|a, b| a.cost().total_cmp(&b.cost()));
        least.unwrap_or_default()
    }

    /// Reaches that are smooth, and each level's greater than the one's before.
    fn reach_of_steepness(&self, pixels: f32, steepness: f32) -> Reach {
        let morph_m = MIN_MORPH_CELLS * (1.0 + steepness) * self.grid.cell_m;
        let scaled = |(finer, errors_m): (usize, &Vec<f32>)| {
            let early_m = EARLY * morph_m * (1u32 << finer) as f32;
            errors_m.iter().map(|e| pixels * e + early_m).collect()
        };
        let mut levels_m = vec![vec![0.0; self.grid.node_count()]];
        levels_m.extend(self.levels_m.iter().enumerate().map(scaled));
        levels_m.iter_mut().for_each(|reach_m| self.grid.spread(reach_m, steepness));
        levels_m.extend((0..LEVELS_ABOVE).map(|_| vec![0.0; self.grid.node_count()]));
        for level in 1..levels_m.len() {
            let band_m = morph_m * (1u32 << (level - 1)) as f32;
            let [finer, coarser] = &mut levels_m[level - 1..=level] else { continue };
            coarser.iter_mut().zip(finer).for_each(|(d, below)| *d = d.max(*below + band_m));
        }
        self.with_blocks(levels_m, morph_m)
    }

    /// The same by distance alone, as in the thesis: λ = log₂(D/d₀), wherever the land is rough.
    pub fn reach_by_distance(&self, pixels: f32) -> Reach {
        let greatest = |errors_m: &Vec<f32>| errors_m.iter().copied().fold(0.0, f32::max);
        let at_unit_m = |(level, errors_m)| greatest(errors_m) / (2u32 << level) as f32;
        let worst_m = self.levels_m.iter().enumerate().map(at_unit_m).fold(0.0, f32::max);
        let least_m = 8.0 * std::f32::consts::SQRT_2 * self.grid.cell_m;
        let unit_m = (EARLY_BY_DISTANCE * pixels * worst_m).max(least_m);
        let levels = 0..=self.levels_m.len() + LEVELS_ABOVE;
        let level = |level| vec![unit_m * (1u32 << level) as f32; self.grid.node_count()];
        self.with_blocks(levels.map(level).collect(), unit_m)
    }

    fn with_blocks(&self, levels_m: Vec<Vec<f32>>, morph_m: f32) -> Reach {
        let mut blocks_m = Vec::new();
        for (level, &across) in self.across.iter().enumerate().rev() {
            for row in 0..across {
                let blocks = (0..across).map(|column| [column, row]);
                blocks_m.extend(blocks.map(|at| self.grid.greatest(&levels_m[level], level as u32, at)));
            }
        }
        Reach { grid: self.grid, levels_m, blocks_m, morph_m }
    }
}

impl Reach {
    /// What this comes to in triangles, but for a factor: of all nodes seen from eyes all around, up to half of the land's
    /// width away, the land between d_l and d_{l+1} in squares of 2^l cells.
    fn cost(&self) -> f32 {
        let far_m = 0.5 * (self.grid.nodes - 1) as f32 * self.grid.tile_m;
        let last = self.levels_m.len() - LEVELS_ABOVE - 1;
        let node_cost = |node: usize| {
            let from_m = |level: usize| {
                let reach_m = self.levels_m[level][node];
                if level > last { far_m } else { reach_m.min(far_m) }
            };
            let ring = |level: usize| {
                let [inner_m, outer_m] = [from_m(level), from_m(level + 1)];
                (outer_m * outer_m - inner_m * inner_m) / (1u64 << (2 * level)) as f32
            };
            (0..=last).map(ring).sum::<f32>()
        };
        (0..self.grid.node_count()).map(node_cost).sum()
    }

    /// d in metres of three levels and the next, from `level` on, at (x, z): between the nodes in straight lines.
    pub fn at(&self, level: u32, [x, z]: [f32; 2]) -> [f32; 4] {
        let half_m = 0.5 * (self.grid.nodes - 1) as f32 * self.grid.tile_m;
        let place = |at_m: f32| {
            let at = ((at_m + half_m) / self.grid.tile_m).clamp(0.0, (self.grid.nodes - 1) as f32);
            let node = (at as usize).min(self.grid.nodes as usize - 2);
            (node, at - node as f32)
        };
        let ((i, across), (j, down)) = (place(x), place(z));
        let mix = |a: f32, b: f32, part: f32| a + (b - a) * part;
        std::array::from_fn(|above| {
            let nodes = &self.levels_m[level as usize + above];
            let row = |j: usize| {
                let first = j * self.grid.nodes as usize + i;
                mix(nodes[first], nodes[first + 1], across)
            };
            mix(row(j), row(j + 1), down)
        })
    }

    /// The distance in metres from which on a block may be drawn.
    pub fn of_block_m(&self, block: Block) -> f32 {
        let cells = (self.grid.nodes - 1) * self.grid.tile_cells;
        let number = block_number(cells, self.grid.block_cells, block);
        self.blocks_m.get(number).copied().unwrap_or(f32::MAX)
    }

    /// Nodes a side, and layers, of the texture that [`Self::texels`] fill.
    pub fn texture_size(&self) -> [u32; 2] {
        [self.grid.nodes, (self.levels_m.len() - LEVELS_ABOVE) as u32]
    }

    /// A layer for each level of blocks: in every node d of that level and of the three after it.
    pub fn texels(&self) -> Vec<[f32; 4]> {
        let layers = self.levels_m.windows(1 + LEVELS_ABOVE);
        let layer = |levels: &[Vec<f32>]| -> Vec<[f32; 4]> {
            (0..self.grid.node_count()).map(|node| std::array::from_fn(|k| levels[k][node])).collect()
        };
        layers.flat_map(layer).collect()
    }
}

impl Grid {
    fn node_count(&self) -> usize {
        (self.nodes * self.nodes) as usize
    }

    /// The greatest vertical distances between the land and its uniform triangulation of a level, of a node each.
    /// `drawn_m`: room to work in.
    fn errors_m(&self, field: &Heightfield, level: u32, drawn_m: &mut Vec<f32>) -> Vec<f32> {
        drawn_m.clear();
        drawn_m.extend_from_slice(&field.heights_m);
        let mut nodes_m = vec![0.0f32; self.node_count()];
        for finer in (0..level).rev() {
            let step = 1u32 << finer;
            for j in (0..field.side).step_by(step as usize) {
                // Samples of this very level: all in an odd row, every other in an even one.
                let (first, by) = if j & step == 0 { (step, 2 * step) } else { (0, step) };
                for i in (first..field.side).step_by(by as usize) {
                    let entry = |[i, j]: [u32; 2]| (j * field.side + i) as usize;
                    let [a, b] = parents([i, j]);
                    let here = entry([i, j]);
                    drawn_m[here] = 0.5 * (drawn_m[entry(a)] + drawn_m[entry(b)]);
                    self.note(&mut nodes_m, [i, j], (drawn_m[here] - field.heights_m[here]).abs());
                }
            }
        }
        nodes_m
    }

    /// Raises the nodes of all tiles that a sample lies in, or on the edge of.
    fn note(&self, nodes_m: &mut [f32], sample: [u32; 2], error_m: f32) {
        let nodes = |line: u32| {
            let (first, on_node) = (line / self.tile_cells, line.is_multiple_of(self.tile_cells));
            let [before, after] = [u32::from(on_node), 1];
            first.saturating_sub(before)..=(first + after).min(self.nodes - 1)
        };
        for j in nodes(sample[1]) {
            for i in nodes(sample[0]) {
                let node = &mut nodes_m[(j * self.nodes + i) as usize];
                *node = node.max(error_m);
            }
        }
    }

    /// Raises nodes until none is more than σ allows below another: along both axes by 1/√2 of it, so that it holds in all
    /// directions.
    fn spread(&self, nodes_m: &mut [f32], steepness: f32) {
        let (side, fall_m) = (self.nodes as usize, steepness * FRAC_1_SQRT_2 * self.tile_m);
        let count = nodes_m.len();
        for node in 0..count {
            let west = if node % side == 0 { 0.0 } else { nodes_m[node - 1] };
            let north = if node < side { 0.0 } else { nodes_m[node - side] };
            nodes_m[node] = nodes_m[node].max(west.max(north) - fall_m);
        }
        for node in (0..count).rev() {
            let east = if node % side == side - 1 { 0.0 } else { nodes_m[node + 1] };
            let south = if node + side >= count { 0.0 } else { nodes_m[node + side] };
            nodes_m[node] = nodes_m[node].max(east.max(south) - fall_m);
        }
    }

    /// The greatest of the nodes around a block of a level, which is the so-manieth along both axes.
    fn greatest(&self, nodes_m: &[f32], level: u32, [column, row]: [u32; 2]) -> f32 {
        let cells = self.block_cells << level;
        let nodes = |n: u32| n * cells / self.tile_cells..=((n + 1) * cells).div_ceil(self.tile_cells);
        let all = nodes(row).flat_map(|j| nodes(column).map(move |i| (j * self.nodes + i) as usize));
        all.fold(0.0, |greatest, node| nodes_m[node].max(greatest))
    }
}
