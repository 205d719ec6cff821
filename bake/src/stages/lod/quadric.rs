//! Area-weighted quadrics → what a collapse costs and where its vertex goes.
//!
//! Garland and Heckbert, "Surface simplification using quadric error metrics" (1997); the new vertex is kept on the
//! collapsed edge as in Merry's thesis, appendix A. Costs are metres: the square root of the quadric over the area
//! it stands for, that is the root mean square distance to the planes of the original triangles.

use glam::DVec3;

/// Where along an edge the new vertex may lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Freedom {
    /// Anywhere on it.
    Edge,
    /// At its start only.
    Start,
    /// At its end only.
    End,
}

/// A place for the new vertex of a collapse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// 0 at the edge's start, 1 at its end.
    pub along: f64,
    /// How far the surface moves, in metres.
    pub error_m: f64,
}

/// xᵀQx + 2bᵀx + c over an area.
#[derive(Clone, Copy, Debug, Default)]
struct Quadric {
    /// xx, xy, xz, yy, yz, zz.
    q: [f64; 6],
    b: DVec3,
    c: f64,
    area: f64,
}

impl Quadric {
    fn plane(normal: DVec3, through: DVec3, weight: f64, area: f64) -> Self {
        let (n, d) = (normal, -normal.dot(through));
        let q = [n.x * n.x, n.x * n.y, n.x * n.z, n.y * n.y, n.y * n.z, n.z * n.z].map(|v| v * weight);
        Self { q, b: n * (d * weight), c: d * d * weight, area }
    }

    fn plus(&self, other: &Self) -> Self {
        let q = std::array::from_fn(|k| self.q[k] + other.q[k]);
        Self { q, b: self.b + other.b, c: self.c + other.c, area: self.area + other.area }
    }

    fn times(&self, v: DVec3) -> DVec3 {
        let q = &self.q;
        DVec3::new(
            q[0] * v.x + q[1] * v.y + q[2] * v.z,
            q[1] * v.x + q[3] * v.y + q[4] * v.z,
            q[2] * v.x + q[4] * v.y + q[5] * v.z,
        )
    }

    fn at(&self, x: DVec3) -> f64 {
        x.dot(self.times(x)) + 2.0 * self.b.dot(x) + self.c
    }

    fn error_m(&self, x: DVec3) -> f64 {
        (self.at(x).max(0.0) / self.area.max(f64::MIN_POSITIVE)).sqrt()
    }
}

/// A quadric for each point, weighted by area, in double precision, relative to an origin near the mesh.
#[derive(Clone, Debug)]
pub struct Quadrics(Vec<Quadric>);

impl Quadrics {
    /// Points without any cost.
    pub fn new(points: usize) -> Self {
        Self(vec![Quadric::default(); points])
    }

    fn add(&mut self, points: &[usize], quadric: &Quadric) {
        for &point in points {
            self.0[point] = self.0[point].plus(quadric);
        }
    }

    /// Adds a triangle of the original surface.
    pub fn add_triangle(&mut self, points: [usize; 3], [p, q, r]: [DVec3; 3]) {
        let cross = (q - p).cross(r - p);
        let double_area = cross.length();
        if double_area > 0.0 {
            let area = 0.5 * double_area;
            let plane = Quadric::plane(cross / double_area, p, area, area);
            self.add(&points, &plane);
        }
    }

    /// Adds an edge of the original where the surface or its texture ends: points are kept on its line. The plane
    /// through the edge with unit normal `across` is perpendicular to the surface.
    pub fn add_crease(&mut self, points: [usize; 2], [p, q]: [DVec3; 2], across: DVec3, weight: f64) {
        let plane = Quadric::plane(across, p, weight * (q - p).length_squared(), 0.0);
        self.add(&points, &plane);
    }

    /// The best allowed place on the edge from `start` to `end`, which lie at `ends`.
    pub fn place(&self, start: usize, end: usize, [p, q]: [DVec3; 2], freedom: Freedom) -> Placed {
        let sum = self.0[start].plus(&self.0[end]);
        let edge = q - p;
        let along = match freedom {
            Freedom::Start => 0.0,
            Freedom::End => 1.0,
            Freedom::Edge => {
                let image = sum.times(edge);
                let (a, half_b) = (edge.dot(image), image.dot(p) + sum.b.dot(edge));
                // On a plane every place is as good as another: the middle keeps triangles in shape.
                let flat = a <= 1e-9 * sum.area * edge.length_squared();
                if flat { 0.5 } else { (-half_b / a).clamp(0.0, 1.0) }
            }
        };
        Placed { along, error_m: sum.error_m(p + edge * along) }
    }

    /// The error in metres with the new vertex anywhere.
    pub fn error_m(&self, start: usize, end: usize, at: DVec3) -> f64 {
        self.0[start].plus(&self.0[end]).error_m(at)
    }

    /// After the collapse of an edge, `kept` stands for both ends.
    pub fn merge(&mut self, kept: usize, removed: usize) {
        self.0[kept] = self.0[kept].plus(&self.0[removed]);
    }
}
