//! The simplex of GJK and its point nearest to a given one, by signed volumes (Montanari,
//! Petrinic, Barbieri, "Improving the GJK algorithm for faster and more reliable distance queries
//! between convex objects", ACM Transactions on Graphics 36(3), 2017).
//!
//! Notation. `a, b, c, d` are corners, relative to the given point, which is thus the origin; its
//! *foot* is its projection onto the plane or the line of some of them. The weights of the foot are
//! quotients of signed volumes, areas or lengths: of the simplex with one corner exchanged for the
//! foot, over the whole. Areas and lengths are measured in the coordinate plane or axis in which
//! the whole is largest.
//!
//! - All weights positive: the foot is the nearest point.
//! - A weight of the wrong sign: the origin lies beyond the face without that corner. The nearest
//!   point is the nearest of those faces' nearest points, each found in the same way.
//!
//! Three things are added, for accuracy:
//!
//! - Where rounding leaves the sign of a weight open, the face is looked at; where it leaves that
//!   of the whole open, all faces are: a simplex that is flat up to rounding is covered by them.
//! - In thin simplices the weights are corrected by Newton's method.
//! - Directions matter more than lengths: a nearest point of length `|v|`, off by `u S`, has a
//!   direction off by `u S / |v|`, and so would be the bound of GJK that rests on it. The foot on a
//!   plane is therefore a multiple of the normal, and that on a line is made orthogonal to it
//!   twice.

use colltrans::VertexPair;
use glam::DVec3;

/// A point `q - p` of the Minkowski difference, for one vertex of each body.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Corner {
    pub(crate) pair: VertexPair,
    pub(crate) point: DVec3,
}

/// Up to four corners, and weights whose sum is 1.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Simplex {
    corners: [Corner; 4],
    weights: [f64; 4],
    len: usize,
}

impl Simplex {
    /// One corner.
    pub(crate) fn new(corner: Corner) -> Self {
        Self { corners: [corner; 4], weights: [1.0, 0.0, 0.0, 0.0], len: 1 }
    }

    pub(crate) fn corners(&self) -> &[Corner] {
        &self.corners[..self.len]
    }

    pub(crate) fn corners_mut(&mut self) -> &mut [Corner] {
        &mut self.corners[..self.len]
    }

    /// The vertex pairs of the corners with their weights.
    pub(crate) fn weighted_pairs(&self) -> impl Iterator<Item = (VertexPair, f64)> + '_ {
        self.corners().iter().map(|c| c.pair).zip(self.weights)
    }

    pub(crate) fn contains(&self, pair: VertexPair) -> bool {
        self.corners().iter().any(|c| c.pair == pair)
    }

    /// Adds a corner of weight 0. A full simplex contains its nearest point and needs no more.
    pub(crate) fn push(&mut self, corner: Corner) {
        debug_assert!(self.len < 4, "reduced before");
        self.corners[self.len] = corner;
        self.weights[self.len] = 0.0;
        self.len += 1;
    }

    /// The shortest vector from `origin` to the simplex. Keeps the corners that it needs, and their
    /// weights.
    pub(crate) fn reduce(&mut self, origin: DVec3) -> DVec3 {
        let points = self.corners.map(|c| c.point - origin);
        let nearest = match self.len {
            1 => Nearest::vertex(&points, 0),
            2 => segment(&points, [0, 1]),
            3 => triangle(&points, [0, 1, 2]),
            _ => tetrahedron(&points),
        };
        let mut kept = 0;
        for i in 0..self.len {
            if nearest.weights[i] > 0.0 {
                self.corners[kept] = self.corners[i];
                self.weights[kept] = nearest.weights[i];
                kept += 1;
            }
        }
        self.len = kept;
        nearest.point
    }
}

/// The point of a face of the simplex nearest to the origin.
#[derive(Debug, Clone, Copy)]
struct Nearest {
    point: DVec3,
    /// Positive for the corners it needs, 0 for the others.
    weights: [f64; 4],
}

impl Nearest {
    fn vertex(points: &[DVec3; 4], i: usize) -> Self {
        let mut weights = [0.0; 4];
        weights[i] = 1.0;
        Self { point: points[i], weights }
    }

    fn at<const N: usize>(point: DVec3, corners: [usize; N], of_corners: [f64; N]) -> Self {
        let mut weights = [0.0; 4];
        for (corner, weight) in corners.into_iter().zip(of_corners) {
            weights[corner] = weight;
        }
        Self { point, weights }
    }

    fn nearer(self, other: Self) -> Self {
        if other.point.length_squared() < self.point.length_squared() { other } else { self }
    }
}

fn segment(points: &[DVec3; 4], [a, b]: [usize; 2]) -> Nearest {
    let edge = points[b] - points[a];
    let square = edge.length_squared();
    if square > 0.0 {
        let foot = points[a] - edge * (points[a].dot(edge) / square);
        let foot = foot - edge * (foot.dot(edge) / square);
        let axis = edge.abs().max_position();
        let to = [points[a] - foot, points[b] - foot];
        let slope = edge / square;
        if let Some(weights) = inside(to, [to[1][axis], -to[0][axis]], [-slope, slope]) {
            return Nearest::at(foot, [a, b], weights);
        }
    }
    Nearest::vertex(points, a).nearer(Nearest::vertex(points, b))
}

fn triangle(points: &[DVec3; 4], [a, b, c]: [usize; 3]) -> Nearest {
    let sides = [[b, c], [c, a], [a, b]];
    let normal = (points[b] - points[a]).cross(points[c] - points[a]);
    let square = normal.length_squared();
    let mut beyond = [true; 3];
    if square > 0.0 {
        let foot = normal * (points[a].dot(normal) / square);
        let axis = normal.abs().max_position();
        let to = [a, b, c].map(|i| points[i] - foot);
        let parts = [to[1].cross(to[2])[axis], to[2].cross(to[0])[axis], to[0].cross(to[1])[axis]];
        let slopes = sides.map(|[i, j]| normal.cross(points[j] - points[i]) / square);
        if let Some(weights) = inside(to, parts, slopes) {
            return Nearest::at(foot, [a, b, c], weights);
        }
        beyond = may_be_beyond(parts, normal[axis], VOLUME_ERROR * longest_square(&to));
    }
    nearest_of_faces(sides, beyond, |side| segment(points, side))
}

fn tetrahedron(points: &[DVec3; 4]) -> Nearest {
    let [a, b, c, d] = *points;
    // The volume over a face is taken from a corner of it, not from the origin: far away, that
    // would cost digits.
    let normal = |p: DVec3, q: DVec3, r: DVec3| (q - p).cross(r - p);
    let normals = [normal(b, c, d), normal(a, d, c), normal(a, b, d), normal(a, c, b)];
    let parts = [b.dot(normals[0]), a.dot(normals[1]), a.dot(normals[2]), a.dot(normals[3])];
    let whole = (a - b).dot(normals[1]);
    let longest = longest_square(points).sqrt();
    if let Some(weights) = inside(*points, parts, normals.map(|n| -n / whole))
        // Else so flat that the weights are made of rounding errors.
        && combination(points, weights).length() <= RESIDUAL * longest
    {
        return Nearest { point: DVec3::ZERO, weights };
    }
    let edges = longest_square(&[b - a, c - a, d - a]);
    let beyond = may_be_beyond(parts, whole, VOLUME_ERROR * longest * edges);
    let faces = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];
    nearest_of_faces(faces, beyond, |face| triangle(points, face))
}

/// Bounds the rounding error of a signed area or volume: in units of the square of the longest
/// vector, or of that of the longest edge from one corner times the longest corner. (Two edges from
/// another corner are up to twice as long each.)
const VOLUME_ERROR: f64 = 16.0 * f64::EPSILON;

/// What a sum of four products may miss by rounding, in units of the longest vector.
const RESIDUAL: f64 = 4.0 * f64::EPSILON;

fn longest_square(vectors: &[DVec3]) -> f64 {
    vectors.iter().map(|v| v.length_squared()).fold(0.0, f64::max)
}

fn combination(points: &[DVec3], weights: impl IntoIterator<Item = f64>) -> DVec3 {
    points.iter().zip(weights).map(|(p, weight)| *p * weight).sum()
}

/// Beyond which faces, opposite to the corners, the origin may lie, signs being wrong up to
/// `error`. One face more costs time only.
fn may_be_beyond<const N: usize>(parts: [f64; N], whole: f64, error: f64) -> [bool; N] {
    parts.map(|part| whole.abs() <= error || part * whole.signum() <= error)
}

/// The weights of the foot, from which the corners are seen at `corners`, if all are positive.
///
/// First they are what `parts` has of their sum. In a thin simplex that misses the foot by more
/// than a rounding error, or misses that it is outside, so steps of Newton follow: a weight is a
/// linear function, with the gradient `slopes`.
fn inside<const N: usize>(
    corners: [DVec3; N],
    parts: [f64; N],
    slopes: [DVec3; N],
) -> Option<[f64; N]> {
    let whole: f64 = parts.iter().sum();
    let mut weights = parts.map(|part| part / whole);
    let positive = |weights: &[f64; N]| weights.iter().all(|weight| *weight > 0.0);
    for _ in 0..NEWTON_STEPS {
        if !positive(&weights) {
            return None;
        }
        let missed = combination(&corners, weights);
        for (weight, slope) in weights.iter_mut().zip(&slopes) {
            *weight -= missed.dot(*slope);
        }
    }
    let sum: f64 = weights.iter().sum();
    positive(&weights).then(|| weights.map(|weight| weight / sum))
}

/// The slopes of a simplex that is flat up to rounding are wrong in their first digit: the second
/// step takes what the first one left.
const NEWTON_STEPS: u32 = 2;

/// The nearest over the faces that are wanted, or over all if none is.
fn nearest_of_faces<F: Copy, const N: usize>(
    faces: [F; N],
    wanted: [bool; N],
    nearest_of: impl Fn(F) -> Nearest,
) -> Nearest {
    let none = wanted == [false; N];
    let chosen = faces.into_iter().zip(wanted).filter(|(_, wanted)| none || *wanted);
    let nearest = chosen.map(|(face, _)| nearest_of(face)).reduce(Nearest::nearer);
    nearest.expect("a simplex has faces")
}

#[cfg(test)]
mod tests {
    use super::*;
    use colltrans_testkit::oracle::distance::distance;
    use colltrans_testkit::oracle::exact::Vector;
    use colltrans_testkit::random::Random;

    /// Up to four points: in general position, on a grid (so often in a plane, on a line or equal),
    /// nearly in a plane, or far away and close to each other.
    fn corners(rng: &mut Random) -> Vec<DVec3> {
        let n = rng.int(1, 4);
        let thin = rng.pick(&[1e-3, 1e-9, 1e-15, 1e-18]);
        let (shift, turn) = (rng.vector(), rng.rotation());
        let kind = rng.int(0, 3);
        (0..n)
            .map(|_| match kind {
                0 => rng.vector(),
                1 => rng.grid(-1, 1),
                2 => turn * (rng.vector() * DVec3::new(1.0, 1.0, thin)) + shift * thin,
                _ => shift * 1e3 + rng.vector(),
            })
            .collect()
    }

    #[test]
    fn nearest_points_of_simplices_in_every_position() {
        let mut rng = Random::new(1);
        let mut inside = 0;
        for case in 0..20_000 {
            let points = corners(&mut rng);
            let corner = |&point: &DVec3| Corner { point, ..Corner::default() };
            let mut simplex = Simplex::new(corner(&points[0]));
            points[1..].iter().for_each(|point| simplex.push(corner(point)));
            let found = simplex.reduce(DVec3::ZERO);

            let exact: Vec<Vector> = points.iter().map(|p| Vector::new(*p)).collect();
            let truth = distance(&[Vector::new(DVec3::ZERO)], &exact).to_f64();
            let size = points.iter().map(|p| p.length()).fold(0.0, f64::max);
            let error = (found.length() - truth).abs() / size.max(f64::MIN_POSITIVE);
            assert!(error <= 16.0 * f64::EPSILON, "case {case}: {points:?} {error:e}");
            let weights = &simplex.weights[..simplex.len];
            let sum: f64 = weights.iter().sum();
            assert!((sum - 1.0).abs() <= 4.0 * f64::EPSILON && weights.iter().all(|w| *w > 0.0));
            let combined: DVec3 =
                simplex.corners().iter().zip(weights).map(|(c, w)| c.point * *w).sum();
            let off = combined.distance(found) / size.max(f64::MIN_POSITIVE);
            assert!(off <= 16.0 * f64::EPSILON, "case {case}: {points:?} {off:e}");
            inside += u32::from(simplex.len == 4);
        }
        assert!(inside > 20, "{inside}");
    }
}
