//! Bounding volumes of triangles: a rectangle swept sphere and an oriented box with the same axes.
//!
//! Notation. The axes are those of the covariance of the corners, longest first. The *rectangle
//! swept sphere* is all that is no farther than `radius` from a rectangle in the plane of the first
//! two axes; the *box* has the same centre (Larsen et al. 1999, section 4; Gottschalk, Lin and
//! Manocha, "`OBBTree`", SIGGRAPH 1996).

use glam::{DMat3, DVec3};

use crate::placed::Relative;

/// Both volumes of some triangles.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Volume {
    /// The axes as columns.
    pub(crate) axes: DMat3,
    pub(crate) center: DVec3,
    /// Half extents of the box.
    pub(crate) half: DVec3,
    /// Half extents of the rectangle along the first two axes, about the same centre.
    pub(crate) rectangle: [f64; 2],
    pub(crate) radius: f64,
}

impl Volume {
    /// Around points.
    pub(crate) fn new(points: &(impl Iterator<Item = DVec3> + Clone)) -> Self {
        let axes = principal_axes(points);
        let to_axes = axes.transpose();
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for x in points.clone().map(|x| to_axes * x) {
            (low, high) = (low.min(x), high.max(x));
        }
        let (middle, half) = ((low + high) * 0.5, (high - low) * 0.5);
        let radius = half.z;
        let mut rectangle = [half.x, half.y];
        // The sphere reaches over the rectangle's sides: these come in as far as all points allow,
        // one after the other.
        for side in 0..2 {
            let inner = points.clone().map(|x| {
                let x = (to_axes * x - middle).abs();
                let across = [x.x, x.y];
                let over = (across[1 - side] - rectangle[1 - side]).max(0.0);
                across[side] - (radius * radius - x.z * x.z - over * over).max(0.0).sqrt()
            });
            rectangle[side] = inner.fold(0.0, f64::max);
        }
        Self { axes, center: axes * middle, half, rectangle, radius }
    }

    /// As seen from another frame.
    pub(crate) fn seen(&self, relative: &Relative) -> Self {
        Self { axes: relative.rotation * self.axes, center: relative.point(self.center), ..*self }
    }

    /// How long it is.
    pub(crate) fn size(&self) -> f64 {
        self.half.x
    }
}

/// Rounds of projections before a bound is good enough.
const ROUNDS: usize = 6;

/// A bound this near to the distance, as a share of it, is good enough.
const CLOSE: f64 = 0.02;

/// A lower bound of the distance of two rectangle swept spheres, as good as needed to tell whether
/// it is above `limit`.
///
/// Points of both rectangles are projected on the other one in turn; they give an upper bound, and
/// the slab across them a lower one. (The published test looks at the Voronoi regions of all pairs
/// of sides instead and ends with the same distance.)
pub(crate) fn distance_of_swept(a: &Volume, b: &Volume, limit: f64) -> f64 {
    let radii = a.radius + b.radius;
    let between = b.center - a.center;
    let mut on_a = DVec3::ZERO;
    let mut bound = f64::NEG_INFINITY;
    for _ in 0..ROUNDS {
        let on_b = between + within(b, on_a - between);
        on_a = within(a, on_b);
        let apart = on_b - on_a;
        let distance = apart.length();
        if distance <= radii {
            return bound.max(0.0);
        }
        let slab = (apart.dot(between) - reach(a, apart) - reach(b, apart)) / distance;
        bound = bound.max(slab - radii);
        let upper = distance - radii;
        if bound > limit || upper <= limit || upper - bound <= CLOSE * upper {
            break;
        }
    }
    bound.max(0.0)
}

/// The point of a rectangle nearest to `x`, both relative to its centre.
fn within(v: &Volume, x: DVec3) -> DVec3 {
    let [p, q] = v.rectangle;
    let (e1, e2) = (v.axes.x_axis, v.axes.y_axis);
    e1 * e1.dot(x).clamp(-p, p) + e2 * e2.dot(x).clamp(-q, q)
}

/// How far a rectangle reaches along a vector from its centre, times the vector's length.
fn reach(v: &Volume, along: DVec3) -> f64 {
    let [p, q] = v.rectangle;
    v.axes.x_axis.dot(along).abs() * p + v.axes.y_axis.dot(along).abs() * q
}

/// Whether a plane across one of fifteen axes parts two boxes, by more than `slack`.
pub(crate) fn boxes_are_apart(a: &Volume, b: &Volume, slack: f64) -> bool {
    let between = b.center - a.center;
    let apart = |axis: DVec3| {
        let extent = |v: &Volume| {
            v.axes.x_axis.dot(axis).abs() * v.half.x
                + v.axes.y_axis.dot(axis).abs() * v.half.y
                + v.axes.z_axis.dot(axis).abs() * v.half.z
        };
        axis.dot(between).abs() > extent(a) + extent(b) + slack * axis.length()
    };
    let (of_a, of_b) = (columns(&a.axes), columns(&b.axes));
    of_a.into_iter().chain(of_b).any(apart)
        || of_a.into_iter().any(|x| of_b.into_iter().any(|y| apart(x.cross(y))))
}

fn columns(m: &DMat3) -> [DVec3; 3] {
    [m.x_axis, m.y_axis, m.z_axis]
}

/// Unit eigenvectors of the points' covariance, the largest eigenvalue first.
fn principal_axes(points: &(impl Iterator<Item = DVec3> + Clone)) -> DMat3 {
    let count = points.clone().count().max(1) as f64;
    let mean = points.clone().sum::<DVec3>() / count;
    let mut m = DMat3::ZERO;
    for x in points.clone().map(|x| x - mean) {
        m += DMat3::from_cols(x * x.x, x * x.y, x * x.z);
    }
    let (values, vectors) = eigen(m);
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| values[j].total_cmp(&values[i]));
    let [x, y, _] = order.map(|i| vectors.col(i));
    let y = (y - x * x.dot(y)).normalize();
    DMat3::from_cols(x, y, x.cross(y))
}

/// Eigenvalues and orthonormal eigenvectors of a symmetric matrix: Jacobi's rotations.
fn eigen(mut m: DMat3) -> ([f64; 3], DMat3) {
    const SWEEPS: usize = 12;
    let mut vectors = DMat3::IDENTITY;
    for _ in 0..SWEEPS {
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let (ii, jj, ij) = (m.col(i)[i], m.col(j)[j], m.col(j)[i]);
            if ij.abs() <= f64::EPSILON * f64::EPSILON * (ii.abs() + jj.abs()) {
                continue;
            }
            let angle = 0.5 * (2.0 * ij).atan2(ii - jj);
            let (sin, cos) = angle.sin_cos();
            let mut turn = DMat3::IDENTITY;
            turn.col_mut(i)[i] = cos;
            turn.col_mut(j)[j] = cos;
            turn.col_mut(i)[j] = sin;
            turn.col_mut(j)[i] = -sin;
            m = turn.transpose() * m * turn;
            vectors *= turn;
        }
    }
    ([m.col(0).x, m.col(1).y, m.col(2).z], vectors)
}

#[cfg(test)]
mod tests {
    use super::*;
    use colltrans_oracle::settings::Rng;

    fn cloud(rng: &mut Rng) -> Vec<DVec3> {
        let shape = DVec3::new(1.0, rng.range(0.0, 1.0), rng.range(0.0, 0.3));
        let (turn, at) = (rng.rotation(), rng.vector() * 3.0);
        (0..rng.int(3, 12)).map(|_| turn * (rng.vector() * shape) + at).collect()
    }

    fn distance_to(v: &Volume, x: DVec3) -> f64 {
        let x = x - v.center;
        (x - within(v, x)).length()
    }

    #[test]
    fn volumes_contain_their_points_and_bounds_are_bounds() {
        let mut rng = Rng::new(8);
        for _ in 0..3_000 {
            let (p, q) = (cloud(&mut rng), cloud(&mut rng));
            let (a, b) = (Volume::new(&p.iter().copied()), Volume::new(&q.iter().copied()));
            for (v, points) in [(&a, &p), (&b, &q)] {
                let identity = v.axes.transpose() * v.axes - DMat3::IDENTITY;
                assert!(columns(&identity).iter().all(|c| c.length() < 1e-13));
                for x in points {
                    assert!(distance_to(v, *x) <= v.radius + 1e-13, "{v:?} {x}");
                    let inside = (v.axes.transpose() * (*x - v.center)).abs() - v.half;
                    assert!(inside.max_element() < 1e-13);
                }
            }
            let near = p.iter().flat_map(|x| q.iter().map(|y| x.distance(*y)));
            let least = near.fold(f64::INFINITY, f64::min);
            for limit in [0.0, 0.5 * least, least, f64::INFINITY] {
                assert!(distance_of_swept(&a, &b, limit) <= least + 1e-13);
            }
            if boxes_are_apart(&a, &b, 0.0) {
                assert!(least > 0.0);
            }
        }
    }
}
