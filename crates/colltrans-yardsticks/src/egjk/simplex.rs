//! The simplex of GJK and its point nearest to a given one, by signed volumes (Montanari,
//! Petrinic, Barbieri, "Improving the GJK algorithm for faster and more reliable distance queries
//! between two convex objects", ACM Transactions on Graphics 36(3), 2017, sections 4 and 5).
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
//! That stays true when a simplex is flat up to rounding and the sign of the whole is a matter of
//! chance: either sign leads to one of two sets of faces that cover the same area.
//!
//! Directions matter more than lengths here: a nearest point of length `|v|`, off by `u S`, has a
//! direction off by `u S / |v|`, and so would be the bound of GJK that rests on it. The foot on a
//! plane is therefore a multiple of the normal, and that on a line is made orthogonal to it twice.

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
        if let Ok(weights) = inside(to, [to[1][axis], -to[0][axis]], [-slope, slope]) {
            return Nearest::at(foot, [a, b], weights);
        }
    }
    Nearest::vertex(points, a).nearer(Nearest::vertex(points, b))
}

fn triangle(points: &[DVec3; 4], [a, b, c]: [usize; 3]) -> Nearest {
    let sides = [[b, c], [c, a], [a, b]];
    let normal = (points[b] - points[a]).cross(points[c] - points[a]);
    let square = normal.length_squared();
    let mut signs = [0.0; 3];
    if square > 0.0 {
        let foot = normal * (points[a].dot(normal) / square);
        let axis = normal.abs().max_position();
        let to = [a, b, c].map(|i| points[i] - foot);
        let parts = [to[1].cross(to[2])[axis], to[2].cross(to[0])[axis], to[0].cross(to[1])[axis]];
        let slopes = sides.map(|[i, j]| normal.cross(points[j] - points[i]) / square);
        match inside(to, parts, slopes) {
            Ok(weights) => return Nearest::at(foot, [a, b, c], weights),
            Err(found) => signs = found,
        }
    }
    nearest_beyond(sides, signs, |side| segment(points, side))
}

fn tetrahedron(points: &[DVec3; 4]) -> Nearest {
    let [a, b, c, d] = *points;
    // The volume over a face is taken from a corner of it, not from the origin: far away, that
    // would cost digits.
    let normal = |p: DVec3, q: DVec3, r: DVec3| (q - p).cross(r - p);
    let normals = [normal(b, c, d), normal(a, d, c), normal(a, b, d), normal(a, c, b)];
    let parts = [b.dot(normals[0]), a.dot(normals[1]), a.dot(normals[2]), a.dot(normals[3])];
    let whole = (b - a).dot(normal(a, c, d));
    match inside(*points, parts, normals.map(|n| -n / whole)) {
        Ok(weights) => Nearest { point: DVec3::ZERO, weights },
        Err(signs) => {
            let faces = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];
            nearest_beyond(faces, signs, |face| triangle(points, face))
        }
    }
}

/// The weights of the foot, from which the corners are seen at `corners`, if all are positive; else
/// their signs, up to rounding.
///
/// First they are what `parts` has of their sum. In a thin simplex that misses the foot by more
/// than a rounding error, or misses that it is outside, so steps of Newton follow: a weight is a
/// linear function, with the gradient `slopes`.
fn inside<const N: usize>(
    corners: [DVec3; N],
    parts: [f64; N],
    slopes: [DVec3; N],
) -> Result<[f64; N], [f64; N]> {
    let whole: f64 = parts.iter().sum();
    let mut weights = parts.map(|part| part / whole);
    let positive = |weights: &[f64; N]| weights.iter().all(|weight| *weight > 0.0);
    for _ in 0..NEWTON_STEPS {
        if !positive(&weights) {
            return Err(weights);
        }
        let missed: DVec3 = corners.iter().zip(weights).map(|(p, weight)| *p * weight).sum();
        for (weight, slope) in weights.iter_mut().zip(&slopes) {
            *weight -= missed.dot(*slope);
        }
    }
    let sum: f64 = weights.iter().sum();
    if positive(&weights) { Ok(weights.map(|weight| weight / sum)) } else { Err(weights) }
}

/// The slopes of a simplex that is flat up to rounding are wrong in their first digit: the second
/// step takes what the first one left.
const NEWTON_STEPS: u32 = 2;

/// The nearest over all faces whose opposite corner has a weight of the wrong sign, or over all if
/// rounding leaves none.
fn nearest_beyond<F: Copy, const N: usize>(
    faces: [F; N],
    signs: [f64; N],
    nearest_of: impl Fn(F) -> Nearest,
) -> Nearest {
    let beyond = |all: bool| {
        let wanted = faces.into_iter().zip(signs).filter(move |(_, sign)| all || *sign <= 0.0);
        wanted.map(|(face, _)| nearest_of(face)).reduce(Nearest::nearer)
    };
    beyond(false).or_else(|| beyond(true)).expect("a simplex has faces")
}
