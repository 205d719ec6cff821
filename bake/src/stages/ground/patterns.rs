//! Nothing → the tiling patterns of ground: a height of about 0 to 1 and a tone for each texel.
//!
//! Grass, scree and earth are laid blade by blade and stone by stone, the higher over the lower; rock is broken
//! into blocks; snow is drifts and grain, sand is ripples.

use std::ops::Range;

use bytemuck::Zeroable;

use crate::math::{hermite, split};
use crate::noise::{fbm2_row, gradient2, hash01};
use crate::raster::raster;

/// Texels a side.
pub(super) const SIDE: usize = 512;

/// `SIDE`² texels, row by row.
pub(super) type Pattern = Vec<Texel>;

#[derive(Clone, Copy, Zeroable)]
pub(super) struct Texel {
    pub height: f32,
    /// RGB, of any scale.
    pub tone: [f32; 3],
}

/// Blades of grass that lean in tufts over moss.
pub(super) fn grass() -> Pattern {
    let mut pattern = paint([Waves(11, 24, 3, 0.6)], |_, _, [moss]| {
        let moss = 0.5 + 0.5 * moss;
        let tone = 30.0 + 34.0 * moss;
        Texel { height: 0.16 * moss, tone: [tone * 1.05, tone, tone * 0.9] }
    });
    for k in 0..7500 {
        let dice = |salt: i32| hash01(12, k, salt, 0);
        let (u, v) = (dice(0), dice(1));
        // Tufts: more blades, leaning apart from their middle; no feature large enough to show that the tile repeats.
        let lean = gradient2(13, u * 9.0, v * 9.0, 9) * 4.0 + dice(2) * 3.2;
        let lush = 0.5 + 0.5 * gradient2(14, u * 7.0, v * 7.0, 7);
        let shade = 62.0 + 95.0 * dice(3) + 40.0 * lush;
        let dry = if dice(4) < 0.16 { 0.34 } else { 0.10 * dice(5) };
        let blade = Blade {
            x: u * SIDE as f32,
            y: v * SIDE as f32,
            angle: lean,
            bend: (dice(6) - 0.5) * 1.6,
            length: 16.0 + 34.0 * dice(7) * (0.5 + lush),
            width: 1.1 + 1.3 * dice(8),
            rise: 0.35 + 0.65 * dice(9),
            tone: [shade * (1.0 + dry), shade * (1.0 + 0.35 * dry), shade * (1.0 - 0.5 * dry)],
        };
        blade.lay(&mut pattern);
    }
    pattern
}

/// One blade, in texels.
struct Blade {
    x: f32,
    y: f32,
    angle: f32,
    bend: f32,
    length: f32,
    width: f32,
    rise: f32,
    tone: [f32; 3],
}

impl Blade {
    /// Lays it over lower texels.
    fn lay(&self, pattern: &mut Pattern) {
        let steps = (self.length / 1.2) as i32;
        let (mut x, mut y) = (self.x, self.y);
        for s in 0..steps {
            let t = s as f32 / steps as f32;
            let angle = self.angle + self.bend * t;
            let (sin, cos) = (libm::sinf(angle), libm::cosf(angle));
            x += 1.2 * cos;
            y += 1.2 * sin;
            let half = self.width * (1.0 - t * t);
            let rise = self.rise * (0.25 + 1.5 * t * (1.0 - 0.5 * t)).min(1.0);
            // Darker at the root, where others shade it.
            let light = 0.45 + 0.55 * (t * 2.0).min(1.0);
            let reach = half as i32 + 1;
            for across in -reach..=reach {
                let off = across as f32;
                if off.abs() > half + 0.3 {
                    continue;
                }
                let at = texel((x - sin * off) as i32, (y + cos * off) as i32);
                let fold = 1.0 - 0.35 * (off / (half + 0.3)).abs();
                if rise * fold > pattern[at].height {
                    let tone = self.tone.map(|c| c * light * (0.8 + 0.2 * fold));
                    pattern[at] = Texel { height: rise * fold, tone };
                }
            }
        }
    }
}

/// Rock that is broken into blocks, each into smaller ones, with joints that have opened between some, and lichen.
pub(super) fn rock() -> Pattern {
    let broken =
        [Blocks::new(21, [5, 6], 0.08), Blocks::new(22, [11, 17], 0.10), Blocks::new(23, [29, 43], 0.20)];
    let noise = [
        Waves(24, 5, 3, 0.5),
        Waves(25, 6, 3, 0.5),
        Waves(26, 40, 2, 0.6),
        Waves(27, 90, 2, 0.7),
        Waves(28, 7, 4, 0.6),
    ];
    paint(noise, |u, v, [bend, sag, ragged, rough, lichen]| {
        let mut at = [u + 0.035 * bend + 0.004 * ragged, v + 0.03 * sag - 0.003 * ragged];
        let spots = broken.each_ref().map(|blocks| {
            let spot = blocks.at(at);
            // Smaller blocks end at larger ones.
            at = [at[0] + 0.37 * spot.dice[0], at[1] + 0.61 * spot.dice[1]];
            spot
        });
        let [large, middle, small] = &spots;
        // How deep the joints are: most are closed.
        let wide = 0.7 * large.joint(0.45, 0.03..0.12);
        let narrow = 0.8 * middle.joint(0.6, 0.06..0.14);
        let fine = 1.0 - hermite((small.edge / 0.22).min(1.0));
        let planes = 0.34 * large.height + 0.20 * middle.height + 0.055 * small.height;
        let height = 0.5 + planes + 0.03 * bend + 0.02 * rough - 0.10 * wide - 0.07 * narrow - 0.006 * fine;
        let own = 0.30 * large.shade + 0.34 * middle.shade + 0.30 * small.shade - 0.47;
        let shade = (1.0 - 0.75 * wide) * (1.0 - 0.75 * narrow) * (1.0 - 0.22 * fine);
        let open = large.open_sky(0.35, 0.9) + middle.open_sky(0.25, 0.7) + small.open_sky(0.0, 0.35);
        let tone = 100.0 * (1.0 + own + 0.5 * rough + 0.55 * lichen).max(0.1) * shade * (1.0 + open).max(0.2);
        let rust = 0.08 * (bend + large.dice[1] - 0.5);
        Texel { height, tone: [tone * (1.0 + rust), tone, tone * (1.0 - rust)] }
    })
}

/// A surface broken into blocks along the borders of a jittered grid's Voronoi cells, each of which is raised and tilted
/// by chance. It tiles.
struct Blocks {
    cells: [i32; 2],
    /// Width of a block's slanted border, in cells.
    bevel: f32,
    blocks: Vec<Block>,
}

#[derive(Clone, Copy)]
struct Block {
    /// In its cell, 0 to 1.
    middle: [f32; 2],
    level: f32,
    tilt: [f32; 2],
    dice: [f32; 2],
}

/// A place on broken rock.
struct Spot {
    height: f32,
    /// Distance to the border, in cells.
    edge: f32,
    /// How much higher the block beyond the border stands: 0 away from it.
    under: f32,
    /// How light the block is, 0 to 1, but for what its border has of the other's.
    shade: f32,
    /// 0 to 1, the same on both sides of a border.
    opened: f32,
    /// Those of the block, 0 to 1.
    dice: [f32; 2],
}

impl Blocks {
    fn new(seed: u32, cells: [i32; 2], bevel: f32) -> Self {
        let block = |place: i32| {
            let dice = |salt: i32| hash01(seed, place % cells[0], place / cells[0], salt);
            // Never so near to a cell's side that the two nearest blocks are not among the nine around.
            let middle = [0, 1].map(|axis| 0.5 + 0.75 * (dice(axis) - 0.5));
            let tilt = [2, 3].map(|axis| 2.0 * (dice(axis) - 0.5));
            Block { middle, level: dice(4) - 0.5, tilt, dice: [dice(5), dice(6)] }
        };
        Self { cells, bevel, blocks: (0..cells[0] * cells[1]).map(block).collect() }
    }

    /// At (u, v) of the tile.
    fn at(&self, place: [f32; 2]) -> Spot {
        let [x, y] = [0, 1].map(|axis| place[axis] * self.cells[axis] as f32);
        let ((column, x), (row, y)) = (split(x), split(y));
        // Squared distance, place from the middle, and index: of the nearest and of the second.
        let mut nearest = [(f32::MAX, [0.0; 2], 0); 2];
        for near in 0..9 {
            let (i, j) = (near % 3 - 1, near / 3 - 1);
            let [i_of, j_of] =
                [(column + i, 0), (row + j, 1)].map(|(n, axis)| n.rem_euclid(self.cells[axis]));
            let index = j_of * self.cells[0] + i_of;
            let middle = self.blocks[index as usize].middle;
            let from = [x - i as f32 - middle[0], y - j as f32 - middle[1]];
            let one = (from[0] * from[0] + from[1] * from[1], from, index);
            if one.0 < nearest[0].0 {
                nearest = [one, nearest[0]];
            } else if one.0 < nearest[1].0 {
                nearest[1] = one;
            }
        }
        let [(first, from, own), (second, beside, other)] = nearest;
        let across = [from[0] - beside[0], from[1] - beside[1]];
        let gap = (across[0] * across[0] + across[1] * across[1]).sqrt();
        let edge = (second - first) / (2.0 * gap).max(1e-6);
        let block = self.blocks[own as usize];
        let plane =
            |block: Block, from: [f32; 2]| block.level + block.tilt[0] * from[0] + block.tilt[1] * from[1];
        let next = self.blocks[other as usize];
        let (here, there) = (plane(block, from), plane(next, beside));
        let inner = 0.5 + 0.5 * hermite((edge / self.bevel).min(1.0));
        let near = (1.0 - edge / 0.35).max(0.0);
        // Not a step from texel to texel, at which one would see them.
        let off = hermite((edge / (0.3 * self.bevel)).min(1.0));
        let under = (there - here).clamp(-1.0, 1.0) * near * near * off;
        let opened = hash01(29, own.min(other), own.max(other), self.cells[0]);
        let height = there + (here - there) * inner;
        let shade = next.dice[0] + (block.dice[0] - next.dice[0]) * (0.5 + 0.5 * off);
        Spot { height, edge, under, shade, opened, dice: block.dice }
    }
}

impl Spot {
    /// What more (`crest`, on an edge that stands out) or less (`foot`, below a higher block) of the sky shines there.
    fn open_sky(&self, crest: f32, foot: f32) -> f32 {
        if self.under < 0.0 { -crest * self.under } else { -foot * self.under }
    }

    /// 1 in the middle of an open joint, 0 beside it. Joints from `closed` up open, and the more the wider.
    fn joint(&self, closed: f32, widths: Range<f32>) -> f32 {
        let open = hermite(((self.opened - closed) / 0.35).clamp(0.0, 1.0));
        let width = widths.start + (widths.end - widths.start) * self.dice[0];
        open * (1.0 - hermite((self.edge / width).min(1.0)))
    }
}

/// Stones of all sizes, the larger on top.
pub(super) fn scree() -> Pattern {
    let mut pattern = paint([Waves(31, 64, 2, 0.7)], |_, _, [grit]| {
        let grit = 0.5 + 0.5 * grit;
        let tone = 34.0 + 40.0 * grit;
        Texel { height: 0.10 * grit, tone: [tone * 1.04, tone, tone * 0.95] }
    });
    let count = 2300;
    for k in 0..count {
        let dice = |salt: i32| hash01(32, k, salt, 0);
        // From small to large; few are large.
        let size = k as f32 / count as f32;
        let radius = 4.5 + 6.0 * size + 15.0 * size * size * size * size * (0.4 + 0.6 * dice(3));
        let base = 0.15 + 0.4 * size + 0.2 * dice(2);
        Stone::new(dice(0) * SIDE as f32, dice(1) * SIDE as f32, radius, base, k).lay(&mut pattern);
    }
    pattern
}

/// One stone, in texels: a polygon of seven sides with bevelled edges and a tilted top.
struct Stone {
    x: f32,
    y: f32,
    radius: f32,
    base: f32,
    sides: [[f32; 3]; 7],
    tilt: [f32; 2],
    tone: [f32; 3],
}

impl Stone {
    fn new(x: f32, y: f32, radius: f32, base: f32, k: i32) -> Self {
        let dice = |salt: i32| hash01(33, k, salt, 0);
        let turn = dice(0) * std::f32::consts::TAU;
        let stretch = 0.62 + 0.38 * dice(1);
        let sides = [0, 1, 2, 3, 4, 5, 6].map(|s| {
            let angle = turn + (s as f32 + 0.7 * (dice(10 + s) - 0.5)) * 0.8976;
            let long = libm::cosf(angle - turn * 1.7).abs();
            let reach = radius * (0.8 + 0.2 * dice(20 + s)) * (stretch + (1.0 - stretch) * long);
            [libm::cosf(angle), libm::sinf(angle), reach]
        });
        let shade = 105.0 + 80.0 * dice(2);
        let warm = 0.10 * (dice(3) - 0.5);
        let tone = [shade * (1.0 + warm), shade, shade * (1.0 - warm)];
        let tilt = [(dice(4) - 0.5) * 0.5, (dice(5) - 0.5) * 0.5];
        Self { x, y, radius, base, sides, tilt, tone }
    }

    /// Lays it over lower texels; those just outside its edge are in its shade.
    fn lay(&self, pattern: &mut Pattern) {
        let reach = self.radius as i32 + 2;
        for dy in -reach..=reach {
            for dx in -reach..=reach {
                let (fx, fy) = (dx as f32, dy as f32);
                let inside =
                    self.sides.iter().fold(f32::MAX, |least, [c, s, r]| least.min(r - fx * c - fy * s));
                if inside < -1.5 {
                    continue;
                }
                let at = texel(self.x as i32 + dx, self.y as i32 + dy);
                if inside < 0.0 {
                    pattern[at].tone = pattern[at].tone.map(|c| c * 0.72);
                    continue;
                }
                let bevel = (inside / (0.35 * self.radius)).min(1.0);
                let round = bevel * (2.0 - bevel);
                let top = 1.0 + (fx * self.tilt[0] + fy * self.tilt[1]) / self.radius;
                let height = self.base + 0.025 * self.radius * round * top;
                if height > pattern[at].height {
                    let grit = 0.88 + 0.24 * hash01(34, self.x as i32 + dx, self.y as i32 + dy, 0);
                    let tone = self.tone.map(|c| c * (0.68 + 0.32 * round) * grit);
                    pattern[at] = Texel { height, tone };
                }
            }
        }
    }
}

/// Soft drifts, ripples that the wind left, and grain.
pub(super) fn snow() -> Pattern {
    let noise = [Waves(41, 6, 2, 0.5), Waves(42, 8, 3, 0.5), Waves(44, 5, 1, 0.5), Waves(45, 128, 2, 0.8)];
    paint(noise, |u, v, [bend, drift, still, grain]| {
        // Sastrugi: sharp ridges along the wind, which blows along u, with still places between them.
        let ridge = gradient2(43, u * 12.0 + 0.6 * bend, v * 36.0 + 3.0 * bend, 12);
        let ridge = (0.4 - 1.6 * ridge.abs()) * (0.55 + 0.9 * still).clamp(0.1, 1.0);
        let height = 0.5 + 0.55 * drift + 0.26 * ridge + 0.06 * grain;
        let tone = 128.0 * (1.0 + 0.08 * drift + 0.10 * ridge + 0.08 * grain);
        Texel { height, tone: [tone * (1.0 - 0.02 * drift), tone, tone * (1.0 + 0.03 * drift)] }
    })
}

/// Sand in ripples across the wind, which fork and end, and grains.
pub(super) fn sand() -> Pattern {
    let noise = [Waves(61, 4, 2, 0.5), Waves(62, 7, 3, 0.55), Waves(63, 170, 1, 0.5), Waves(64, 5, 2, 0.5)];
    paint(noise, |_, v, [bend, fork, grain, still]| {
        let phase = v * 27.0 + 1.7 * bend + 0.55 * fork;
        let along = phase - phase.floor();
        // Steep to the lee, gentle to the wind.
        let ripple = if along < 0.68 { hermite(along / 0.68) } else { hermite((1.0 - along) / 0.32) };
        let strong = (0.75 + 0.9 * still).clamp(0.15, 1.0);
        let height = 0.3 + 0.5 * ripple * strong + 0.05 * grain + 0.12 * fork;
        let tone = 118.0 * (1.0 + 0.10 * strong * (ripple - 0.5) + 0.11 * grain + 0.03 * fork);
        Texel { height, tone: [tone * (1.0 + 0.015 * grain), tone, tone * (1.0 - 0.025 * grain)] }
    })
}

/// Crumbly soil with pebbles, twigs and bits of leaves in it.
pub(super) fn earth() -> Pattern {
    let noise = [Waves(71, 19, 3, 0.62), Waves(72, 110, 2, 0.75), Waves(73, 7, 2, 0.5)];
    let mut pattern = paint(noise, |_, _, [lumps, crumbs, damp]| {
        let height = 0.22 + 0.16 * lumps + 0.10 * crumbs;
        let tone = 104.0 * (1.0 + 0.24 * lumps + 0.22 * crumbs + 0.12 * damp);
        let warm = 0.05 * damp;
        Texel { height, tone: [tone * (1.0 + warm), tone, tone * (1.0 - warm)] }
    });
    for k in 0..170 {
        let dice = |salt: i32| hash01(74, k, salt, 0);
        // Many small ones, few large.
        let radius = 1.6 + 2.0 * dice(2) + 5.0 * dice(3) * dice(3) * dice(3) * dice(3);
        let base = 0.26 + 0.12 * dice(4);
        Stone::new(dice(0) * SIDE as f32, dice(1) * SIDE as f32, radius, base, k + 5000).lay(&mut pattern);
    }
    for k in 0..1900 {
        let dice = |salt: i32| hash01(75, k, salt, 0);
        let shade = 58.0 + 105.0 * dice(5);
        // Twigs are long and dark, bits of leaves short and wide.
        let is_twig = dice(6) < 0.2;
        Blade {
            x: dice(0) * SIDE as f32,
            y: dice(1) * SIDE as f32,
            angle: dice(2) * std::f32::consts::TAU,
            bend: (dice(3) - 0.5) * 0.9,
            length: if is_twig { 9.0 + 17.0 * dice(4) } else { 4.5 + 6.0 * dice(4) },
            width: if is_twig { 0.7 + 0.5 * dice(7) } else { 2.0 + 2.2 * dice(7) },
            rise: 0.4 + 0.3 * dice(8),
            tone: if is_twig {
                [0.8 * shade, 0.72 * shade, 0.64 * shade]
            } else {
                [1.2 * shade, shade, 0.72 * shade]
            },
        }
        .lay(&mut pattern);
    }
    pattern
}

/// Fractal noise that tiles the pattern: seed, cells a side, octaves and gain.
struct Waves(u32, i32, u32, f32);

/// A pattern from each texel's (u, v) in 0..1 and the noise there.
fn paint<const N: usize>(noise: [Waves; N], texel: impl Fn(f32, f32, [f32; N]) -> Texel + Sync) -> Pattern {
    let part = |i: usize| i as f32 / SIDE as f32;
    let xs: Vec<Vec<f32>> =
        noise.iter().map(|waves| (0..SIDE).map(|i| part(i) * waves.1 as f32).collect()).collect();
    raster(SIDE, SIDE, |j| {
        let (texel, v) = (&texel, part(j));
        let mut values = [[0.0; SIDE]; N];
        for ((&Waves(seed, cells, octaves, gain), xs), values) in noise.iter().zip(&xs).zip(&mut values) {
            fbm2_row(seed, xs, v * cells as f32, octaves, gain, cells, values);
        }
        move |i| texel(part(i), v, std::array::from_fn(|k| values[k][i]))
    })
}

/// The index of a texel, wrapped around.
#[inline]
fn texel(x: i32, y: i32) -> usize {
    let side = SIDE as i32;
    (y.rem_euclid(side) * side + x.rem_euclid(side)) as usize
}
