//! The point of a simplex nearest to the origin, by the regions in which the origin may lie.
//!
//! Corners with a positive weight span the face that the nearest point is an inner point of; the others are
//! dropped. The way from the origin across that face, its *normal*, is not the nearest point itself: of a
//! near one rounding turns the direction, of edges and triangles it does not.

use glam::DVec3;

use crate::setting::VertexPair;
use colltrans_kernel::real::{Real, Vector};

/// A point of `M` and the pair of vertices it comes from.
#[derive(Debug, Clone, Copy)]
pub struct Corner<T> {
    pub at: Vector<T>,
    pub pair: VertexPair,
}

/// Up to four points of `M`, each with a weight.
#[derive(Debug, Clone, Copy)]
pub struct Simplex<T> {
    at: [Vector<T>; 4],
    pairs: [VertexPair; 4],
    /// Zero beyond the corners that are there.
    weights: [T; 4],
    count: usize,
}

impl<T: Real> Simplex<T> {
    #[inline]
    pub fn new(corner: Corner<T>) -> Self {
        let mut weights = [T::ZERO; 4];
        weights[0] = T::of(1.0);
        Self { at: [corner.at; 4], pairs: [corner.pair; 4], weights, count: 1 }
    }

    /// Of up to three corners; `None` of none.
    pub(super) fn of(mut corners: impl Iterator<Item = Corner<T>>) -> Option<Self> {
        let mut simplex = Self::new(corners.next()?);
        corners.for_each(|corner| simplex.push(corner));
        Some(simplex)
    }

    /// Adds a corner, to a simplex of fewer than four.
    #[inline]
    pub fn push(&mut self, corner: Corner<T>) {
        self.at[self.count] = corner.at;
        self.pairs[self.count] = corner.pair;
        self.count += 1;
    }

    /// Whether it is a tetrahedron, which contains the origin once [`Self::reduce`] has left it so.
    #[inline]
    pub fn is_full(&self) -> bool {
        self.count == 4
    }

    #[inline]
    pub(super) fn contains(&self, pair: VertexPair) -> bool {
        self.pairs[..self.count].contains(&pair)
    }

    /// Four pairs and their weights; those without a weight mean nothing.
    #[inline]
    pub(super) fn weighted(&self) -> ([VertexPair; 4], [f64; 4]) {
        (self.pairs, self.weights.map(T::value))
    }

    /// Drops what the nearest point does without, and returns that point.
    #[inline]
    pub fn reduce(&mut self) -> Vector<T> {
        let [a, b, c, d] = &self.at;
        self.weights = match self.count {
            1 => [T::of(1.0), T::ZERO, T::ZERO, T::ZERO],
            2 => segment(a, b),
            3 => triangle(a, b, c),
            _ => tetrahedron([a, b, c, d]),
        };
        self.keep_weighted()
    }

    /// The same of a tetrahedron too flat for its volume to tell.
    #[cold]
    pub(super) fn reduce_to_face(&mut self) -> Vector<T> {
        self.weights = nearest_face(self.at.each_ref());
        self.keep_weighted()
    }

    /// Drops corners without a weight, and returns the point that the weights give.
    #[inline]
    fn keep_weighted(&mut self) -> Vector<T> {
        let mut nearest = Vector::ZERO;
        let mut kept = 0;
        for k in 0..self.count {
            let weight = self.weights[k];
            if weight > T::ZERO {
                nearest = nearest.plus(&self.at[k].times(weight));
                self.at[kept] = self.at[k];
                self.pairs[kept] = self.pairs[k];
                self.weights[kept] = weight;
                kept += 1;
            }
        }
        self.weights[kept..].fill(T::ZERO);
        self.count = kept.max(1);
        nearest
    }

    /// The direction across the simplex from the origin's side, of any length, for its nearest point.
    #[inline]
    pub fn normal(&self, nearest: &Vector<T>) -> DVec3 {
        let [a, b, c, _] = &self.at;
        match self.count {
            2 => {
                let edge = b.minus(a);
                let along = nearest.dot(&edge) / edge.dot(&edge);
                nearest.minus(&edge.times(along)).value()
            }
            3 => {
                let normal = b.minus(a).cross(&c.minus(a)).value();
                if normal.dot(nearest.value()) < 0.0 { -normal } else { normal }
            }
            _ => nearest.value(),
        }
    }
}

/// Weights of the point of a segment nearest to the origin.
#[inline]
fn segment<T: Real>(a: &Vector<T>, b: &Vector<T>) -> [T; 4] {
    let one = T::of(1.0);
    let edge = b.minus(a);
    let (along, square) = (-a.dot(&edge), edge.dot(&edge));
    if along >= square {
        // Of two points in one place, too.
        [T::ZERO, one, T::ZERO, T::ZERO]
    } else if along > T::ZERO {
        let t = along / square;
        [one - t, t, T::ZERO, T::ZERO]
    } else {
        [one, T::ZERO, T::ZERO, T::ZERO]
    }
}

/// The same of a triangle (the regions of Ericson, "Real-Time Collision Detection", 5.1.5).
#[inline]
fn triangle<T: Real>(a: &Vector<T>, b: &Vector<T>, c: &Vector<T>) -> [T; 4] {
    let (zero, one) = (T::ZERO, T::of(1.0));
    let (ab, ac) = (b.minus(a), c.minus(a));
    let (ab_a, ac_a) = (-ab.dot(a), -ac.dot(a));
    if ab_a <= zero && ac_a <= zero {
        return [one, zero, zero, zero];
    }
    let (ab_b, ac_b) = (-ab.dot(b), -ac.dot(b));
    if ab_b >= zero && ac_b <= ab_b {
        return [zero, one, zero, zero];
    }
    let (ab_c, ac_c) = (-ab.dot(c), -ac.dot(c));
    if ac_c >= zero && ab_c <= ac_c {
        return [zero, zero, one, zero];
    }
    // Areas along the normal, not products of the sums above: of slivers these would lose twice as much.
    let normal = ab.cross(&ac);
    let at_c = normal.dot(&a.cross(b));
    if at_c <= zero && ab_a >= zero && ab_b <= zero {
        let t = ab_a / (ab_a - ab_b);
        return [one - t, t, zero, zero];
    }
    let at_b = normal.dot(&c.cross(a));
    if at_b <= zero && ac_a >= zero && ac_c <= zero {
        let t = ac_a / (ac_a - ac_c);
        return [one - t, zero, t, zero];
    }
    let at_a = normal.dot(&b.cross(c));
    let (from_b, from_c) = (ac_b - ab_b, ab_c - ac_c);
    if at_a <= zero && from_b >= zero && from_c >= zero {
        let t = from_b / (from_b + from_c);
        return [zero, one - t, t, zero];
    }
    let sum = at_a + at_b + at_c;
    [at_a / sum, at_b / sum, at_c / sum, zero]
}

/// The same of a tetrahedron: itself, if the origin is on the inner side of all planes.
#[inline]
fn tetrahedron<T: Real>(corners: [&Vector<T>; 4]) -> [T; 4] {
    let [a, b, c, d] = corners;
    let volume = |x: &Vector<T>, y: &Vector<T>, z: &Vector<T>| x.dot(&y.cross(z));
    let parts = [volume(b, c, d), -volume(a, c, d), volume(a, b, d), -volume(a, b, c)];
    let inside = parts.iter().all(|x| *x > T::ZERO) || parts.iter().all(|x| *x < T::ZERO);
    if inside {
        let sum = parts[0] + parts[1] + parts[2] + parts[3];
        return parts.map(|x| x / sum);
    }
    nearest_face(corners)
}

/// The weights over the face of a tetrahedron that is nearest to the origin.
fn nearest_face<T: Real>(corners: [&Vector<T>; 4]) -> [T; 4] {
    let mut best = ([T::ZERO; 4], None);
    for left_out in 0..4 {
        let [i, j, k] = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]][left_out];
        let [u, v, w, _] = triangle(corners[i], corners[j], corners[k]);
        let [x, y, z] = [corners[i].times(u), corners[j].times(v), corners[k].times(w)];
        let point = x.plus(&y).plus(&z);
        let square = point.dot(&point);
        if best.1.is_none_or(|least| square < least) {
            let mut weights = [T::ZERO; 4];
            (weights[i], weights[j], weights[k]) = (u, v, w);
            best = (weights, Some(square));
        }
    }
    best.0
}
