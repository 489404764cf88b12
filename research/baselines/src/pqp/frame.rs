//! Axes for fitting bounding volumes.
//!
//! The axes are the columns of a rotation, in decreasing order of extent. For many triangles they are the
//! eigenvectors of the covariance of the corners (Larsen et al. 1999). For one triangle they are its longest
//! edge, its height and its normal.

use glam::{DMat3, DVec3};

use super::triangle::Triangle;

/// Maximum number of sweeps of Jacobi rotations. Convergence is quadratic, and six sweeps are usual. Any axes
/// are correct; good ones fit more tightly.
const MAX_SWEEPS: usize = 12;

/// Returns axes for one triangle.
pub(crate) fn of_triangle(t: &Triangle) -> DMat3 {
    let edges = [t[1] - t[0], t[2] - t[1], t[0] - t[2]];
    let longest = |a: DVec3, b: DVec3| if b.length_squared() > a.length_squared() { b } else { a };
    let along = longest(longest(edges[0], edges[1]), edges[2]);
    let [a, b] = if along == edges[0] { [edges[1], edges[2]] } else { [edges[0], along] };
    orthonormal(along, a.cross(b).cross(along))
}

/// Returns the principal axes of at least one point.
pub(crate) fn of_points(points: &[DVec3]) -> DMat3 {
    let mean = points.iter().sum::<DVec3>() / points.len() as f64;
    let mut covariance = [[0.0; 3]; 3];
    for p in points {
        let d = (*p - mean).to_array();
        for (i, row) in covariance.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate().skip(i) {
                *entry += d[i] * d[j];
            }
        }
    }
    let (values, vectors) = eigen_decomposition(covariance);
    let mut order = [0, 1, 2];
    order.sort_by(|&i: &usize, &j: &usize| values[j].total_cmp(&values[i]));
    orthonormal(vectors[order[0]], vectors[order[1]])
}

/// Returns eigenvalues and eigenvectors of a symmetric matrix, given by its upper triangle, by cyclic Jacobi
/// rotations.
fn eigen_decomposition(mut m: [[f64; 3]; 3]) -> ([f64; 3], [DVec3; 3]) {
    let mut vectors = DVec3::AXES;
    for _ in 0..MAX_SWEEPS {
        let off = m[0][1].abs() + m[0][2].abs() + m[1][2].abs();
        if off <= f64::EPSILON * (m[0][0] + m[1][1] + m[2][2]) {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            apply_jacobi_rotation(&mut m, &mut vectors, p, q);
        }
    }
    ([m[0][0], m[1][1], m[2][2]], vectors)
}

/// Rotates in the plane of axes `p < q` such that their entry becomes 0.
fn apply_jacobi_rotation(m: &mut [[f64; 3]; 3], vectors: &mut [DVec3; 3], p: usize, q: usize) {
    if m[p][q] == 0.0 {
        return;
    }
    let half_cot = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
    let tan = half_cot.signum() / (half_cot.abs() + (half_cot * half_cot + 1.0).sqrt());
    let cos = 1.0 / (tan * tan + 1.0).sqrt();
    let sin = tan * cos;
    m[p][p] -= tan * m[p][q];
    m[q][q] += tan * m[p][q];
    m[p][q] = 0.0;
    let r = 3 - p - q;
    let (rp, rq) = ((r.min(p), r.max(p)), (r.min(q), r.max(q)));
    let (at_p, at_q) = (m[rp.0][rp.1], m[rq.0][rq.1]);
    m[rp.0][rp.1] = cos * at_p - sin * at_q;
    m[rq.0][rq.1] = sin * at_p + cos * at_q;
    let (vp, vq) = (vectors[p], vectors[q]);
    vectors[p] = vp * cos - vq * sin;
    vectors[q] = vp * sin + vq * cos;
}

/// Returns a rotation whose first axis is along `x` and whose second axis is near `y`; arbitrary axes if
/// these vanish or are parallel.
fn orthonormal(x: DVec3, y: DVec3) -> DMat3 {
    let x = x.try_normalize().unwrap_or(DVec3::X);
    // Projecting twice makes the result orthogonal to the last digit, even if the first difference is small.
    let away = |y: DVec3| (y - x * x.dot(y)).try_normalize();
    let y = y.try_normalize().and_then(away).and_then(away);
    let y = y.unwrap_or_else(|| x.any_orthonormal_vector());
    DMat3::from_cols(x, y, x.cross(y))
}
