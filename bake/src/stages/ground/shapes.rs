//! Nothing → the shapes of herbs and dwarf shrubs, and what all shapes are drawn with: a few triangles each,
//! coarse ones first. Metres.

use glam::Vec3;

use crate::math::lerp;
use crate::model::PlantShape;
use crate::noise::hash01;

use std::f32::consts::TAU;

/// A shape in the making.
#[derive(Default)]
pub(super) struct Drawing {
    shape: PlantShape,
    seed: u32,
    dice: i32,
}

impl Drawing {
    pub(super) fn new(seed: u32) -> Self {
        Self { seed, ..Self::default() }
    }

    /// In [0, 1).
    pub(super) fn unit(&mut self) -> f32 {
        self.dice += 1;
        hash01(self.seed, self.dice, 7, 1)
    }

    pub(super) fn vertex(&mut self, position: Vec3, normal: Vec3, tint: f32) -> u32 {
        // Scenes hold these numbers as text: millimetres will do.
        let round = |x: f32| (1000.0 * x).round() / 1000.0;
        self.shape.positions_m.push(position.to_array().map(round));
        self.shape.normals.push(normal.normalize_or(Vec3::Y).to_array().map(round));
        self.shape.tints.push(round(tint));
        self.shape.positions_m.len() as u32 - 1
    }

    /// A triangle that is lit as if it faced half upwards, as leaves among others are.
    fn leaf(&mut self, corners: [Vec3; 3], tints: [f32; 3]) {
        let across = across(corners);
        self.lit(corners, Vec3::Y + 0.6 * if across.y < 0.0 { -across } else { across }, tints);
    }

    /// A triangle that is lit as if it faced along `normal`, of any length. Its front is on that side: renderers turn the normal of
    /// what is seen from behind, and leaves of which one sees the front would be dark.
    pub(super) fn lit(&mut self, corners: [Vec3; 3], normal: Vec3, tints: [f32; 3]) {
        let triangle = [0, 1, 2].map(|k| self.vertex(corners[k], normal, tints[k]));
        self.triangle(triangle, corners, normal);
    }

    /// A triangle of vertices that lie there, with its front on the side of `normal`.
    pub(super) fn triangle(&mut self, [a, b, c]: [u32; 3], [at_a, at_b, at_c]: [Vec3; 3], normal: Vec3) {
        let front = (at_b - at_a).cross(at_c - at_a);
        self.shape.triangles.push(if front.dot(normal) < 0.0 { [a, c, b] } else { [a, b, c] });
    }

    /// A stem or a twig of tint 0: two crossed slivers that end in a point, lit from the side.
    pub(super) fn stalk(&mut self, root: Vec3, tip: Vec3, radius: f32) {
        let side = (tip - root).cross(Vec3::new(0.31, 0.17, 0.94)).normalize_or(Vec3::X);
        for across in [side, (tip - root).cross(side).normalize_or(Vec3::Z)] {
            self.lit([root - radius * across, root + radius * across, tip], across + 0.6 * Vec3::Y, [0.0; 3]);
        }
    }

    /// A thin rod: two crossed bands, each with a radius and a tint at either end, lit from the side.
    fn rod(&mut self, [low, high]: [Vec3; 2], radii: [f32; 2], [at_low, at_high]: [f32; 2]) {
        for across in [Vec3::X, Vec3::Z] {
            let [wide, thin] = radii.map(|radius| radius * across);
            let normal = aside(across) + 0.6 * Vec3::Y;
            self.lit([low - wide, low + wide, high - thin], normal, [at_low, at_low, at_high]);
            self.lit([low + wide, high + thin, high - thin], normal, [at_low, at_high, at_high]);
        }
    }

    /// A thin stem of tint 0: two crossed slivers, lit from the side, which end in a point where grass hides them. What it carries
    /// would hang in the air if they were pointed there.
    fn stem(&mut self, root: Vec3, tip: Vec3, radius: f32) {
        for across in [Vec3::X, Vec3::Z] {
            let wide = radius * across;
            self.lit([root, tip - wide, tip + wide], aside(across) + 0.6 * Vec3::Y, [0.0; 3]);
        }
    }

    /// A blade that bends from `root` outwards in the direction of a turn and ends in a point. Where it stands its front is the outer
    /// side: of a tuft one sees that of the nearest blades, and within it is dark.
    pub(super) fn blade(&mut self, root: Vec3, turn: f32, [height, lean, width]: [f32; 3], tints: [f32; 2]) {
        let out = heading(turn);
        let side = aside(out) * (0.5 * width);
        let middle = root + out * (0.3 * lean) + Vec3::Y * (0.62 * height);
        let tip = root + out * lean + Vec3::Y * height;
        let half = lerp(tints[0], tints[1], 0.6);
        let (left, right) = (middle - 0.8 * side, middle + 0.8 * side);
        let mut part = |corners: [Vec3; 3], tints: [f32; 3]| {
            let across = across(corners);
            let outer = if across.dot(out) < 0.0 { -across } else { across };
            self.lit(corners, Vec3::Y + 0.6 * if outer.y < -0.5 { -outer } else { outer }, tints);
        };
        part([root - side, root + side, right], [tints[0], tints[0], half]);
        part([root - side, right, left], [tints[0], half, half]);
        part([left, right, tip], [half, half, tints[1]]);
    }

    /// Two halves of a leaf or of a spray of leaves: from root to tip, widest at `middle` ± `side`, each with its tint.
    pub(super) fn diamond(
        &mut self,
        [root, middle, tip]: [Vec3; 3],
        side: Vec3,
        normal: Vec3,
        [at_root, at_side, at_tip]: [f32; 3],
    ) {
        self.lit([root, middle + side, tip], normal, [at_root, at_side, at_tip]);
        self.lit([root, tip, middle - side], normal, [at_root, at_tip, at_side]);
    }

    /// The band between two rings; `look` says of each four corners, see [`corners`], the normal and the tints.
    pub(super) fn band(&mut self, pair: &[Vec<Vec3>], mut look: impl FnMut([Vec3; 4]) -> (Vec3, [f32; 4])) {
        for k in 0..pair[0].len() {
            let quad = corners(pair, k);
            let (normal, tints) = look(quad);
            for (triangle, tints) in halves(quad).into_iter().zip(halves(tints)) {
                self.lit(triangle, normal, tints);
            }
        }
    }

    /// The triangles until here are enough from afar.
    pub(super) fn coarse(&mut self) {
        self.shape.coarse = self.shape.triangles.len() as u32;
    }

    pub(super) fn done(mut self) -> PlantShape {
        if self.shape.coarse == 0 {
            self.coarse();
        }
        self.shape
    }
}

/// Level, from +x towards +z.
pub(super) fn heading(turn: f32) -> Vec3 {
    Vec3::new(libm::cosf(turn), 0.0, libm::sinf(turn))
}

/// Level, across a level direction; as long as it.
pub(super) fn aside(out: Vec3) -> Vec3 {
    Vec3::new(-out.z, 0.0, out.x)
}

/// Across a triangle, to one of its sides; unit length.
pub(super) fn across([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(c - a).normalize_or(Vec3::Y)
}

/// Where two rings of as many points have their `k`-th quadrangle: two corners on the first, two on the second.
pub(super) fn corners(pair: &[Vec<Vec3>], k: usize) -> [Vec3; 4] {
    let next = (k + 1) % pair[0].len();
    [pair[0][k], pair[0][next], pair[1][k], pair[1][next]]
}

/// The triangles of a quadrangle.
pub(super) fn halves<T: Copy>([a, b, c, d]: [T; 4]) -> [[T; 3]; 2] {
    [[a, b, c], [b, d, c]]
}

/// Three stalks with a head of six petals each, and leaves; tint 1 is the petals'.
pub(super) fn flower() -> PlantShape {
    let mut d = Drawing::new(61);
    let heads = [[0.0, 0.27, 0.02], [0.07, 0.21, -0.03], [-0.05, 0.17, -0.05]].map(Vec3::from_array);
    let petal = |d: &mut Drawing, head: Vec3, k: u32| {
        let turn = k as f32 / 6.0 * TAU + head.x * 9.0;
        let out =
            |turn: f32, reach: f32| head + reach * heading(turn) + Vec3::Y * (0.3 * reach * libm::cosf(turn));
        d.leaf([head, out(turn - 0.36, 0.022), out(turn + 0.36, 0.022)], [0.75, 1.0, 1.0]);
    };
    for head in heads {
        (0..6).step_by(2).for_each(|k| petal(&mut d, head, k));
        let root = head.with_y(0.0) * 0.2;
        d.stem(root, head, 0.003);
    }
    d.coarse();
    for head in heads {
        (1..6).step_by(2).for_each(|k| petal(&mut d, head, k));
    }
    for k in 0..4 {
        d.blade(Vec3::ZERO, 1.6 * k as f32 + 0.4, [0.11, 0.07, 0.018], [0.0, 0.06]);
    }
    d.done()
}

/// A rosette of fronds that arch outwards, with leaflets on both sides.
pub(super) fn fern() -> PlantShape {
    let mut d = Drawing::new(62);
    let fronds: Vec<(f32, f32)> =
        (0..8).map(|k| (k as f32 / 8.0 * TAU + 0.5 * d.unit(), 0.75 + 0.5 * d.unit())).collect();
    // Along a frond, 0 to 1.
    let spine = |turn: f32, long: f32, t: f32| {
        heading(turn) * (0.52 * long * t) + Vec3::Y * (0.42 * long * libm::sinf(2.3 * t) + 0.02)
    };
    for &(turn, long) in &fronds {
        let side = Vec3::new(-libm::sinf(turn), 0.0, libm::cosf(turn));
        let [a, b, c] = [0.0, 0.45, 1.0].map(|t| spine(turn, long, t));
        d.leaf([a, b + 0.013 * side, b - 0.013 * side], [0.0, 0.5, 0.5]);
        d.leaf([b - 0.013 * side, b + 0.013 * side, c], [0.5, 0.5, 1.0]);
    }
    d.coarse();
    for &(turn, long) in &fronds {
        let side = Vec3::new(-libm::sinf(turn), -0.12, libm::cosf(turn));
        for k in 0..13 {
            // Longest at a third of the frond; each hangs a little more or less and has a tint of its own.
            let t = 0.12 + 0.067 * k as f32;
            let reach = 0.17 * long * (1.0 - t) * (0.45 + 1.8 * t).min(1.0) + 0.012;
            let (near, far) = (spine(turn, long, t - 0.012), spine(turn, long, t + 0.026));
            for way in [-1.0, 1.0] {
                let hang = side.y - 0.5 * d.unit();
                let side = Vec3::new(way * side.x, hang, way * side.z);
                let (at_rib, at_tip) = (0.7 * t * d.unit(), (0.2 + 0.5 * t + 0.5 * d.unit()).min(1.0));
                d.leaf([near, far, spine(turn, long, t + 0.07) + reach * side], [at_rib, at_rib, at_tip]);
            }
        }
    }
    d.done()
}

/// A low dome of sprigs from one root, with leaves on their upper halves; tint 1 is that of their outermost leaves, or of their
/// bloom.
pub(super) fn shrub() -> PlantShape {
    const SPRIGS: usize = 29;
    const LEAVES: usize = 7;
    let mut d = Drawing::new(63);
    let sprigs: Vec<[Vec3; 2]> = (0..SPRIGS)
        .map(|k| {
            // Evenly over the dome, by the golden angle.
            let part = (k as f32 + 0.5) / SPRIGS as f32;
            let (turn, up) = (2.4 * k as f32 + 0.6 * d.unit(), 1.0 - part);
            let out = heading(turn) * (1.0 - 0.8 * up * up).sqrt();
            let tip = (out * 0.36 + Vec3::Y * (0.15 + 0.26 * up)) * (0.75 + 0.4 * d.unit());
            [out * 0.05, tip]
        })
        .collect();
    // From where on its sprig a leaf stands off, across, to its end; and which way it faces.
    let leaf = |d: &mut Drawing, [root, tip]: [Vec3; 2], along: f32, long: f32| {
        let from = root.lerp(tip, along);
        let ahead = (tip - root).normalize_or(Vec3::Y);
        let aim = (0.9 * ahead + 0.9 * heading(d.unit() * TAU) + 0.3 * Vec3::Y).normalize_or(Vec3::Y);
        let side = aim.cross(ahead + 0.4 * heading(d.unit() * TAU)).normalize_or(Vec3::X);
        let face = aim.cross(side);
        let normal = if face.y < 0.0 { -face } else { face } + 0.8 * Vec3::Y + 0.4 * ahead;
        ([from, 0.24 * long * side, from + long * aim], normal)
    };
    for &sprig in &sprigs {
        let ([from, side, end], normal) = leaf(&mut d, sprig, 0.76, 0.09);
        let tint = 0.3 + 0.4 * sprig[1].y;
        d.diamond([from, from.lerp(end, 0.45), end], side, normal, [0.7 * tint, tint, tint]);
    }
    d.coarse();
    for &[root, tip] in &sprigs {
        let across = 0.0035 * (tip - root).cross(Vec3::Y).normalize_or(Vec3::X);
        d.leaf([root + across, root - across, tip], [0.0, 0.0, 0.2]);
        for k in 0..LEAVES {
            let along = 0.42 + 0.6 * (k as f32 + d.unit()) / LEAVES as f32;
            let tint = (1.5 * along - 0.62 + 0.2 * d.unit()).clamp(0.0, 1.0);
            let long = 0.038 + 0.02 * d.unit();
            let ([from, side, end], normal) = leaf(&mut d, [root, tip], along, long);
            let wide = from.lerp(end, 0.15);
            d.lit([wide + side, wide - side, end], normal, [0.8 * tint, 0.8 * tint, tint]);
        }
    }
    d.done()
}

/// Tall blades and brown ears from one root.
pub(super) fn reed() -> PlantShape {
    let mut d = Drawing::new(64);
    for k in 0..9 {
        let (turn, high) = (d.unit() * TAU, 0.9 + 0.7 * d.unit());
        let root = heading(turn) * (0.12 * d.unit());
        let lean = 0.1 + 0.22 * d.unit();
        d.blade(root, turn, [high, lean, 0.026], [0.0, 0.3]);
        if k == 4 {
            d.coarse();
        }
    }
    for _ in 0..2 {
        let root = heading(d.unit() * TAU) * 0.08;
        let neck = root + Vec3::new(0.04, 1.32 + 0.3 * d.unit(), 0.02);
        let long = 0.13 + 0.05 * d.unit();
        d.rod([root, neck], [0.006, 0.004], [0.0, 0.2]);
        cattail(&mut d, neck, long);
        // What is left of the flowers above.
        let bare = neck + long * Vec3::Y;
        let top = bare + (0.10 + 0.06 * d.unit()) * Vec3::Y;
        d.rod([bare, top], [0.004, 0.0015], [0.5, 0.6]);
    }
    d.done()
}

/// The head of a cattail, a cylinder with rounded ends.
fn cattail(d: &mut Drawing, low: Vec3, long: f32) {
    const SIDES: usize = 6;
    // Height, radius, how much it faces upwards, and tint of each ring.
    let rings = [
        (0.0, 0.003, -1.0, 0.75),
        (0.016, 0.0125, -0.35, 0.9),
        (long - 0.014, 0.0135, 0.35, 1.0),
        (long, 0.004, 1.0, 0.85),
    ];
    // Every ring is turned by half a side against the one below.
    let corner = |ring: usize, k: usize| {
        let (high, radius, up, tint) = rings[ring];
        let out = heading((k as f32 + 0.5 * ring as f32) / SIDES as f32 * TAU);
        (low + high * Vec3::Y + radius * out, out + up * Vec3::Y, tint)
    };
    for (ring, k) in (0..rings.len() - 1).flat_map(|ring| (0..SIDES).map(move |k| (ring, k))) {
        let quad = [corner(ring, k), corner(ring, k + 1), corner(ring + 1, k), corner(ring + 1, k + 1)];
        for triangle in halves(quad) {
            // Of its own: the foreground of a file turns each triangle to the eye.
            let vertices = triangle.map(|(at, normal, tint)| d.vertex(at, normal, tint));
            let out = triangle.iter().map(|(at, ..)| *at - low).sum::<Vec3>();
            d.triangle(vertices, triangle.map(|(at, ..)| at), out.with_y(0.0));
        }
    }
}

/// A tuft of long arching grass: blades within stand, those around them lean out.
pub(super) fn tussock() -> PlantShape {
    let mut d = Drawing::new(65);
    for k in 0..32 {
        // Those that are drawn from afar, too, are spread over all.
        let out = ((5 * k) % 32) as f32 / 32.0;
        let (turn, long) = (2.4 * k as f32 + 0.7 * d.unit(), 0.75 + 0.5 * d.unit());
        let width = if k < 7 { 0.028 } else { 0.013 };
        let root = heading(turn) * (0.02 + 0.11 * out);
        let lean = 0.05 + 0.46 * out;
        d.blade(root, turn, [(0.58 - 0.24 * out) * long, lean * long, width], [0.0, 1.0]);
        if k == 6 {
            d.coarse();
        }
    }
    d.done()
}

/// A hill of rice: leaves that stand and bend over at their ends, and, if it is ripe, ears that hang between them.
pub(super) fn rice(is_in_ear: bool) -> PlantShape {
    let mut d = Drawing::new(75);
    for k in 0..15 {
        // Those that are drawn from afar, too, are spread over all.
        let out = ((4 * k) % 15) as f32 / 15.0;
        let (turn, long) = (2.4 * k as f32 + 0.8 * d.unit(), 0.8 + 0.4 * d.unit());
        let width = if k < 4 { 0.026 } else { 0.014 };
        let root = heading(turn) * (0.015 + 0.03 * out);
        d.blade(root, turn, [(0.56 - 0.16 * out) * long, (0.04 + 0.24 * out) * long, width], [0.0, 0.8]);
        if k == 3 {
            d.coarse();
        }
    }
    for k in 0..if is_in_ear { 7 } else { 0 } {
        let turn = 2.4 * k as f32 + 0.6 * d.unit();
        let (out, high) = (heading(turn), 0.50 + 0.10 * d.unit());
        let from = out * 0.06 + Vec3::Y * high;
        let tip = out * (0.20 + 0.06 * d.unit()) + Vec3::Y * (high - 0.09);
        let middle = from.lerp(tip, 0.45) + 0.008 * Vec3::Y;
        d.diamond([from, middle, tip], aside(out) * 0.010, Vec3::Y + 0.6 * out, [0.7, 1.0, 1.0]);
    }
    d.done()
}

/// Three spikes of flowers over a rosette, the lowest flowers open widest; tint 1 is the petals'.
pub(super) fn spire() -> PlantShape {
    let mut d = Drawing::new(71);
    let spikes = [([0.0, 0.82, 0.03], 1.0), ([0.09, 0.61, -0.05], 0.8), ([-0.07, 0.50, -0.06], 0.7)]
        .map(|(top, wide)| (Vec3::from_array(top), wide));
    let foot = |top: Vec3| top.with_y(0.0) * 0.3;
    // All flowers of a spike that stand for those of a size, from the lowest to the topmost.
    let flowers = |d: &mut Drawing, (top, wide): (Vec3, f32), count: usize, reach_m: f32| {
        for k in 0..count {
            let part = (k as f32 + 0.2 + 0.6 * d.unit()) / count as f32;
            let from = foot(top).lerp(top, 0.38 + 0.61 * part);
            let out = heading(2.4 * k as f32 + 0.5 * d.unit());
            let reach = wide * reach_m * (1.0 - 0.8 * part) * (0.75 + 0.5 * d.unit());
            let side = aside(out) * (0.42 * reach) + Vec3::Y * (0.4 * reach * (d.unit() - 0.5));
            let tip = from + (out - Vec3::Y * (0.7 * (1.0 - part) - 0.15)) * reach;
            // Buds at the top are green, and within a flower is shade.
            let (open, tint) = ((1.25 - part).min(1.0), 0.6 + 0.4 * d.unit());
            let tints = [0.15, tint, 0.85 * tint].map(|tint| tint * open);
            // No two are lit alike.
            let normal = out + 0.6 * Vec3::Y + 1.2 * (d.unit() - 0.5) * aside(out);
            d.lit([from + 0.35 * reach * Vec3::Y, tip + side, tip - side], normal, tints);
        }
    };
    spikes.into_iter().for_each(|spike| flowers(&mut d, spike, 5, 0.078));
    d.coarse();
    for (top, wide) in spikes {
        d.stem(foot(top), foot(top).lerp(top, 0.95), 0.0025);
        flowers(&mut d, (top, wide), (42.0 * wide) as usize, 0.042);
    }
    for k in 0..7 {
        let (high, lean) = (0.12 + 0.1 * d.unit(), 0.14 + 0.08 * d.unit());
        d.blade(Vec3::ZERO, 0.9 * k as f32, [high, lean, 0.030], [0.0, 0.08]);
    }
    d.done()
}

/// Stalks that branch into rays with flat heads of tiny flowers, over feathery leaves; tint 1 is the petals'.
pub(super) fn umbel() -> PlantShape {
    let mut d = Drawing::new(72);
    let heads =
        [([0.03, 0.80, 0.0], 0.085, 13), ([-0.12, 0.64, 0.07], 0.065, 9), ([0.10, 0.57, -0.11], 0.060, 9)]
            .map(|(middle, reach, umbellets)| (Vec3::from_array(middle), reach, umbellets));
    // Where rays part, and where each ends: those in the middle of a head higher.
    let fork = |head: Vec3, reach: f32| head - 0.42 * reach * Vec3::Y;
    let umbellet = |(head, reach, umbellets): (Vec3, f32, usize), k: usize| {
        let part = (k as f32 + 0.3) / umbellets as f32;
        head + reach * part.sqrt() * heading(2.4 * k as f32) + Vec3::Y * (0.02 * (1.0 - part))
    };
    let petals = |d: &mut Drawing, middle: Vec3, size: f32, outward: Vec3| {
        let (turn, tint) = (d.unit() * TAU, 0.7 + 0.3 * d.unit());
        let out = |k: usize| middle + size * heading(turn + k as f32 / 3.0 * TAU);
        d.lit([out(0), out(1), out(2)], Vec3::Y + 0.4 * outward, [tint; 3]);
    };
    for (head, reach, umbellets) in heads {
        d.stem(head.with_y(0.0) * 0.2, fork(head, reach), 0.0028);
        // From afar four umbellets show.
        for k in (1..umbellets).step_by(umbellets / 4).take(4) {
            let middle = umbellet((head, reach, umbellets), k);
            petals(&mut d, middle, 0.34 * reach, (middle - head) / reach);
        }
    }
    d.coarse();
    for (head, reach, umbellets) in heads {
        let fork = fork(head, reach);
        for k in 0..umbellets {
            let from = umbellet((head, reach, umbellets), k);
            let wide = 0.0022 * aside((from - fork).with_y(0.0).normalize_or(Vec3::X));
            d.leaf([fork - wide, fork + wide, from], [0.0, 0.0, 0.2]);
            let small = 0.30 * reach;
            for _ in 0..3 {
                let middle = from + 0.5 * small * heading(d.unit() * TAU) + Vec3::Y * (0.006 * d.unit());
                let size = small * (0.4 + 0.2 * d.unit());
                petals(&mut d, middle, size, (middle - head) / reach);
            }
        }
    }
    for k in 0..7 {
        let (turn, lean) = (0.9 * k as f32 + 0.2, 0.16 + 0.08 * d.unit());
        let up = 0.10 + 0.16 * d.unit();
        d.blade(Vec3::Y * up, turn, [0.06, lean, 0.03], [0.0, 0.06]);
    }
    d.done()
}

/// Tall grass in seed: stalks that lean under their panicles; tint 1 is the ears'.
pub(super) fn hay() -> PlantShape {
    let mut d = Drawing::new(73);
    // From where to where, and where the panicle begins.
    let stalks: Vec<[Vec3; 3]> = (0..11)
        .map(|k| {
            let (turn, high) = (2.4 * k as f32 + d.unit(), 0.55 + 0.33 * d.unit());
            let root = heading(d.unit() * TAU) * (0.14 * d.unit());
            let tip = root + heading(turn) * (0.10 + 0.16 * d.unit()) + Vec3::Y * high;
            [root, tip, root.lerp(tip, 0.74)]
        })
        .collect();
    for (k, &[root, tip, ear]) in stalks.iter().enumerate() {
        let out = (tip - root).with_y(0.0).normalize_or(Vec3::X);
        let side = aside(out);
        let wide = if k < 5 { 0.005 } else { 0.0035 };
        d.leaf([root - wide * side, root + wide * side, tip], [0.0, 0.0, 0.5]);
        let normal = Vec3::Y + 0.6 * out;
        d.diamond([ear, ear.lerp(tip, 0.4), tip], side * wide, normal, [0.6, 1.0, 0.9]);
        if k == 4 {
            d.coarse();
        }
    }
    for [_, tip, ear] in stalks {
        let loose = 0.3 + 0.7 * d.unit();
        for k in 0..10 {
            // Shorter branches towards the tip, and what they carry hangs.
            let part = (k as f32 + 0.5) / 10.0;
            let from = ear.lerp(tip, part);
            let out = heading(2.4 * k as f32 + d.unit());
            let at = from + out * (0.036 * loose * (1.0 - 0.75 * part)) + Vec3::Y * 0.006;
            let end = at + out * 0.006 - Vec3::Y * (0.013 + 0.010 * d.unit()) * (1.2 * loose - 0.45);
            let across = aside(out) * 0.004;
            let tint = 0.65 + 0.35 * d.unit();
            d.lit([from, at + across, end - across], Vec3::Y + 0.6 * out, [0.6, tint, tint]);
        }
    }
    d.done()
}

/// A rosette of broad leaves, as dock and plantain have it: inner ones stand, outer ones lie.
pub(super) fn herb() -> PlantShape {
    let mut d = Drawing::new(74);
    for k in 0..13 {
        // Those that are drawn from afar, too, are spread over all.
        let age = ((5 * k) % 13) as f32 / 13.0;
        let (turn, long) = (2.4 * k as f32 + 0.5 * d.unit(), 0.30 + 0.16 * d.unit());
        let (out, up) = (heading(turn), 0.95 - 0.75 * age);
        let at = |along: f32, high: f32| {
            out * (long * along * (1.1 - 0.7 * up)) + Vec3::Y * (long * up * high + 0.01)
        };
        let [root, low, high, tip] =
            [at(0.1, 0.1), at(0.45, 0.62), at(0.78, 0.88), at(1.05, 0.86 - 0.3 * age)];
        let across = aside(out);
        let (pale, rib) = (0.45 + 0.55 * d.unit(), 0.35);
        for way in [-1.0, 1.0] {
            let edge = |middle: Vec3, wide: f32| middle + (way * across + 0.25 * Vec3::Y) * (wide * long);
            let (a, b) = (edge(low, 0.12), edge(high, 0.13));
            let normal = Vec3::Y - 0.45 * way * across + 0.3 * out;
            d.lit([root, a, low], normal, [0.0, 0.7 * pale, rib]);
            d.lit([low, a, b], normal, [rib, 0.7 * pale, pale]);
            d.lit([low, b, high], normal, [rib, pale, rib]);
            d.lit([high, b, tip], normal, [rib, pale, pale]);
        }
        if k == 4 {
            d.coarse();
        }
    }
    d.done()
}

/// Narrower leaves, as parts of their length, are needles or leaflets of fronds: twice as many lie there.
const NARROW: f32 = 0.2;

/// Fallen leaves flat on the ground, `wide` times as wide as they are long, folded along the middle and curled up.
pub(super) fn litter(leaf_m: f32, wide: f32) -> PlantShape {
    let mut d = Drawing::new(66);
    let count = if wide < NARROW { 12 } else { 6 };
    for _ in 0..count {
        let turn = d.unit() * TAU;
        let middle =
            heading(d.unit() * TAU) * (0.34 * d.unit().sqrt()) + Vec3::Y * (0.008 + 0.016 * d.unit());
        let (along, across) = (leaf_m * heading(turn), 0.5 * wide * leaf_m * heading(turn + 0.25 * TAU));
        let curl = Vec3::Y * (0.16 * leaf_m * d.unit());
        let (root, tip) = (middle - 0.5 * along, middle + 0.5 * along + curl);
        let tint = d.unit();
        for (way, tint) in [(-1.0, 0.8 * tint), (1.0, tint)] {
            let fold = Vec3::Y * (0.3 * wide * leaf_m * d.unit());
            let edge =
                |at: f32, part: f32| middle + at * along + part * (way * across + fold) + (at + 0.5) * curl;
            let (low, high) = (edge(-0.2, 0.9), edge(0.18, 0.85));
            d.leaf([root, low, high], [tint; 3]);
            d.leaf([root, high, tip], [tint; 3]);
        }
    }
    d.done()
}
