//! The simplex of GJK and its point nearest to the origin, by signed volumes (Montanari, Petrinic, Barbieri,
//! "Improving the GJK algorithm for faster and more reliable distance queries between convex objects", ACM
//! Transactions on Graphics 36(3), 2017).
//!
//! `a, b, c, d` are corners relative to the given point, which becomes the origin. Its *foot* is the projection onto
//! the plane or line of some corners. The weights of the foot are quotients of signed volumes, areas or lengths: the
//! simplex with a corner replaced by the foot, over the whole simplex, measured in the coordinate plane or axis in
//! which the whole is largest. If all weights are positive, the foot is the nearest point. If a weight has the wrong
//! sign, the origin is beyond the face without its corner; the nearest point is then that of the nearest such face.
//! [`Simplex::reduce`] lists additions for accuracy.

use colltrans::VertexPair;
use glam::DVec3;

/// A point `q - p` of the Minkowski difference with its vertices.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Corner {
    pub(crate) pair: VertexPair,
    pub(crate) point: DVec3,
}

/// Up to four corners, and their weights with sum 1.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Simplex {
    corners: [Corner; 4],
    weights: [f64; 4],
    len: usize,
}

impl Simplex {
    /// Creates a simplex of one corner.
    pub(crate) fn new(corner: Corner) -> Self {
        Self { corners: [corner; 4], weights: [1.0, 0.0, 0.0, 0.0], len: 1 }
    }

    /// Returns the corners.
    pub(crate) fn corners(&self) -> &[Corner] {
        &self.corners[..self.len]
    }

    /// Returns the corners for modification.
    pub(crate) fn corners_mut(&mut self) -> &mut [Corner] {
        &mut self.corners[..self.len]
    }

    /// Iterates over the vertex pairs of the corners with their weights.
    pub(crate) fn weighted_pairs(&self) -> impl Iterator<Item = (VertexPair, f64)> + '_ {
        self.corners().iter().map(|c| c.pair).zip(self.weights)
    }

    /// Checks whether a vertex pair is a corner.
    pub(crate) fn contains(&self, pair: VertexPair) -> bool {
        self.corners().iter().any(|c| c.pair == pair)
    }

    /// Adds a corner of weight 0. The simplex must not be full; a full simplex contains its nearest point.
    pub(crate) fn push(&mut self, corner: Corner) {
        debug_assert!(self.len < 4, "a full simplex cannot grow");
        self.corners[self.len] = corner;
        self.weights[self.len] = 0.0;
        self.len += 1;
    }

    /// Returns the shortest vector from `origin` to the simplex. Keeps only the corners with positive weights.
    ///
    /// Additions for accuracy:
    /// - If rounding leaves the sign of a weight open, its face is examined too; if it leaves that of the whole open,
    ///   all faces are. They cover a flat simplex.
    /// - Newton steps correct the weights of thin simplices.
    /// - A nearest point of length `|v|` with error `u S` has a direction with error `u S / |v|`, which enters the
    ///   bound of GJK. Therefore the foot on a plane is a multiple of the normal, and the foot on a line is made
    ///   orthogonal to it twice.
    pub(crate) fn reduce(&mut self, origin: DVec3) -> DVec3 {
        let points = self.corners.map(|c| c.point - origin);
        let nearest = match self.len {
            1 => Nearest::at_vertex(&points, 0),
            2 => nearest_on_segment(&points, [0, 1]),
            3 => nearest_on_triangle(&points, [0, 1, 2]),
            _ => nearest_in_tetrahedron(&points),
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
    /// Returns a corner as the nearest point.
    fn at_vertex(points: &[DVec3; 4], i: usize) -> Self {
        let mut weights = [0.0; 4];
        weights[i] = 1.0;
        Self { point: points[i], weights }
    }

    /// Returns a point with the weights of some corners.
    fn with_weights<const N: usize>(
        point: DVec3,
        corners: [usize; N],
        of_corners: [f64; N],
    ) -> Self {
        let mut weights = [0.0; 4];
        for (corner, weight) in corners.into_iter().zip(of_corners) {
            weights[corner] = weight;
        }
        Self { point, weights }
    }

    /// Returns the nearer one of two points.
    fn nearer(self, other: Self) -> Self {
        if other.point.length_squared() < self.point.length_squared() { other } else { self }
    }
}

/// Returns the nearest point of an edge.
fn nearest_on_segment(points: &[DVec3; 4], [a, b]: [usize; 2]) -> Nearest {
    let edge = points[b] - points[a];
    let square = edge.length_squared();
    if square > 0.0 {
        let foot = points[a] - edge * (points[a].dot(edge) / square);
        let foot = foot - edge * (foot.dot(edge) / square);
        let axis = edge.abs().max_position();
        let to = [points[a] - foot, points[b] - foot];
        let slope = edge / square;
        if let Some(weights) = positive_weights(to, [to[1][axis], -to[0][axis]], [-slope, slope]) {
            return Nearest::with_weights(foot, [a, b], weights);
        }
    }
    Nearest::at_vertex(points, a).nearer(Nearest::at_vertex(points, b))
}

/// Returns the nearest point of a face.
fn nearest_on_triangle(points: &[DVec3; 4], [a, b, c]: [usize; 3]) -> Nearest {
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
        if let Some(weights) = positive_weights(to, parts, slopes) {
            return Nearest::with_weights(foot, [a, b, c], weights);
        }
        beyond = may_be_beyond(parts, normal[axis], VOLUME_ERROR * longest_square(&to));
    }
    nearest_of_faces(sides, beyond, |side| nearest_on_segment(points, side))
}

/// Returns the nearest point of the whole simplex.
fn nearest_in_tetrahedron(points: &[DVec3; 4]) -> Nearest {
    let [a, b, c, d] = *points;
    // The volume over a face is measured from a corner of the face. Measuring from a distant origin would
    // lose digits.
    let normal = |p: DVec3, q: DVec3, r: DVec3| (q - p).cross(r - p);
    let normals = [normal(b, c, d), normal(a, d, c), normal(a, b, d), normal(a, c, b)];
    let parts = [b.dot(normals[0]), a.dot(normals[1]), a.dot(normals[2]), a.dot(normals[3])];
    let whole = (a - b).dot(normals[1]);
    let longest = longest_square(points).sqrt();
    if let Some(weights) = positive_weights(*points, parts, normals.map(|n| -n / whole))
        // Otherwise the simplex is so flat that the weights are rounding errors.
        && combination(points, weights).length() <= RESIDUAL * longest
    {
        return Nearest { point: DVec3::ZERO, weights };
    }
    let edges = longest_square(&[b - a, c - a, d - a]);
    let beyond = may_be_beyond(parts, whole, VOLUME_ERROR * longest * edges);
    let faces = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];
    nearest_of_faces(faces, beyond, |face| nearest_on_triangle(points, face))
}

/// Bound on the rounding error of a signed area or volume. The unit of areas is the square of the longest
/// vector. That of volumes is the square of the longest edge from one corner, times the longest corner
/// vector. Two edges from another corner are at most twice as long each.
const VOLUME_ERROR: f64 = 16.0 * f64::EPSILON;

/// Rounding error of a sum of four products, in units of the longest vector.
const RESIDUAL: f64 = 4.0 * f64::EPSILON;

/// Returns the largest squared length.
fn longest_square(vectors: &[DVec3]) -> f64 {
    vectors.iter().map(|v| v.length_squared()).fold(0.0, f64::max)
}

/// Returns the weighted sum of points.
fn combination(points: &[DVec3], weights: impl IntoIterator<Item = f64>) -> DVec3 {
    points.iter().zip(weights).map(|(p, weight)| *p * weight).sum()
}

/// Checks for each corner whether the origin may lie beyond the opposite face, if signs have errors up to
/// `error`. An additional face only costs time.
fn may_be_beyond<const N: usize>(parts: [f64; N], whole: f64, error: f64) -> [bool; N] {
    parts.map(|part| whole.abs() <= error || part * whole.signum() <= error)
}

/// Returns the weights of the foot if all are positive; `corners` are the corners relative to the foot.
///
/// The first weights are the quotients of `parts` and their sum. In a thin simplex their errors exceed
/// rounding errors or hide that the foot is outside. Therefore Newton steps follow: each weight is a linear
/// function with the gradient `slopes`.
fn positive_weights<const N: usize>(
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

/// Number of Newton steps. In a simplex that is flat up to rounding the slopes have errors in the first
/// digit, so the second step corrects the remainder of the first.
const NEWTON_STEPS: u32 = 2;

/// Returns the nearest point over the wanted faces, or over all faces if none is wanted.
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

    /// Returns up to four points: in general position, on a grid (often coplanar, collinear or equal), nearly
    /// coplanar, or distant and close to each other.
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
    fn nearest_point_of_simplex_matches_exact_distance() {
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
