//! A 3×3 linear map → rotation, scale, rotation: singular value decomposition by one-sided Jacobi rotations
//! (Hestenes 1958; Demmel & Veselić 1992 on its accuracy). glTF nodes may not shear; two nested ones may.

/// Columns of a 3×3 matrix.
pub type Columns = [[f64; 3]; 3];

/// `A = R(left) · diag(scale) · R(right)` with two proper rotations, as quaternions (x, y, z, w), and three scales
/// above 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decomposition {
    /// U.
    pub left: [f64; 4],
    /// Σ.
    pub scale: [f64; 3],
    /// Vᵀ.
    pub right: [f64; 4],
}

/// Splits a linear map. `None` if its determinant is not above 0, or so close to it that no inverse exists.
pub fn decompose(a: Columns) -> Option<Decomposition> {
    let size = a.iter().map(|column| length(*column)).fold(0.0, f64::max);
    let det = determinant(a);
    if !det.is_finite() || det <= 1e-12 * size * size * size {
        return None;
    }
    // Columns of `u` become orthogonal while u · vᵀ stays a.
    let mut u = a;
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _sweep in 0..30 {
        let cosines = [(0, 1), (0, 2), (1, 2)].map(|(p, q)| orthogonalise(&mut u, &mut v, p, q));
        if cosines.iter().all(|&cosine| cosine < 1e-15) {
            break;
        }
    }
    let scale = u.map(length);
    for (column, size) in u.iter_mut().zip(scale) {
        *column = column.map(|x| x / size);
    }
    // v is a product of rotations and det a > 0, so both factors are proper rotations.
    Some(Decomposition { left: quaternion(u), scale, right: quaternion(transpose(v)) })
}

/// a · (b × c).
pub fn determinant([a, b, c]: Columns) -> f64 {
    a[0] * (b[1] * c[2] - b[2] * c[1])
        + a[1] * (b[2] * c[0] - b[0] * c[2])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

fn transpose(m: Columns) -> Columns {
    [0, 1, 2].map(|row| [m[0][row], m[1][row], m[2][row]])
}

/// Rotates columns p and q of both matrices so that those of `u` become orthogonal; returns the cosine they had.
fn orthogonalise(u: &mut Columns, v: &mut Columns, p: usize, q: usize) -> f64 {
    let (alpha, beta, gamma) = (dot(u[p], u[p]), dot(u[q], u[q]), dot(u[p], u[q]));
    let cosine = gamma.abs() / (alpha * beta).sqrt();
    if gamma == 0.0 || cosine < 1e-16 {
        return 0.0;
    }
    // The smaller angle that makes the product 0 (Golub & Van Loan, Matrix Computations, 8.5.2).
    let zeta = (beta - alpha) / (2.0 * gamma);
    let tangent = 1.0f64.copysign(zeta) / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
    let cos = 1.0 / (1.0 + tangent * tangent).sqrt();
    let sin = cos * tangent;
    for matrix in [u, v] {
        let (a, b) = (matrix[p], matrix[q]);
        matrix[p] = [0, 1, 2].map(|row| a[row] * cos - b[row] * sin);
        matrix[q] = [0, 1, 2].map(|row| a[row] * sin + b[row] * cos);
    }
    cosine
}

/// The unit quaternion of a rotation, from its greatest component (Shepperd 1978).
fn quaternion(m: Columns) -> [f64; 4] {
    let [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] = m;
    let squares = [1.0 + xx - yy - zz, 1.0 - xx + yy - zz, 1.0 - xx - yy + zz, 1.0 + xx + yy + zz];
    let greatest = (0..4).fold(3, |best, i| if squares[i] > squares[best] { i } else { best });
    let four_q = match greatest {
        0 => [squares[0], xy + yx, xz + zx, yz - zy],
        1 => [xy + yx, squares[1], yz + zy, zx - xz],
        2 => [xz + zx, yz + zy, squares[2], xy - yx],
        _ => [yz - zy, zx - xz, xy - yx, squares[3]],
    };
    let norm = four_q.iter().map(|x| x * x).sum::<f64>().sqrt();
    four_q.map(|x| x / norm)
}

#[cfg(test)]
pub mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Columns of a quaternion's rotation (Shoemake 1985).
    pub fn rotation([x, y, z, w]: [f64; 4]) -> Columns {
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)],
            [2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)],
            [2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)],
        ]
    }

    /// a · b.
    pub fn multiply(a: Columns, b: Columns) -> Columns {
        b.map(|column| [0, 1, 2].map(|row| (0..3).map(|k| a[k][row] * column[k]).sum()))
    }

    /// R(left) · diag(scale) · R(right).
    pub fn product(left: [f64; 4], scale: [f64; 3], right: [f64; 4]) -> Columns {
        let mut scaled = rotation(left);
        for (column, factor) in scaled.iter_mut().zip(scale) {
            *column = column.map(|x| x * factor);
        }
        multiply(scaled, rotation(right))
    }

    /// The greatest difference between entries.
    pub fn difference(a: Columns, b: Columns) -> f64 {
        let pairs = a.as_flattened().iter().zip(b.as_flattened());
        pairs.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
    }

    fn error(a: Columns) -> f64 {
        let d = decompose(a).expect("a proper map");
        assert!(d.scale.iter().all(|&s| s > 0.0));
        difference(product(d.left, d.scale, d.right), a)
    }

    proptest! {
        #[test]
        fn the_product_is_the_map(
            entries in prop::array::uniform3(prop::array::uniform3(-3.0f64..3.0)),
            size in 0.001f64..1000.0,
        ) {
            let a = entries.map(|column| column.map(|x| x * size));
            prop_assume!(determinant(entries) > 1e-4);
            prop_assert!(error(a) < 1e-11 * size);
        }
    }

    #[test]
    fn simple_maps_are_split_too() {
        let turn = rotation([0.5, -0.5, 0.1, 0.7]);
        let stretch = [[2.5, 0.0, 0.0], [0.0, 0.3, 0.0], [0.0, 0.0, 2.5]];
        assert_eq!(error([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), 0.0);
        assert!(error(turn) < 1e-14);
        assert!(error(multiply(stretch, turn)) < 1e-14);
        assert!(error(multiply(turn, stretch)) < 1e-14);
    }

    #[test]
    fn mirrors_and_flat_maps_are_refused() {
        for middle in [-1.0, 0.0, f64::NAN, f64::INFINITY] {
            assert_eq!(decompose([[1.0, 0.0, 0.0], [0.0, middle, 0.0], [0.0, 0.0, 1.0]]), None);
        }
    }
}
