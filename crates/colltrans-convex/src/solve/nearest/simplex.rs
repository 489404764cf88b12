//! Point of a simplex nearest to the origin, by a case distinction over the regions that may contain the origin.
//!
//! Corners with a positive weight span the face whose interior contains the nearest point. The others are removed. The
//! *normal* is the direction from the origin perpendicular to that face. It is not computed from the nearest point,
//! because rounding changes the direction of a short vector, but not that of edges and triangles.

use glam::DVec3;

use crate::setting::VertexPair;
use colltrans_kernel::real::{Real, RealVector};

/// Point of `M` with its vertex pair.
#[derive(Debug, Clone, Copy)]
pub struct Corner<T> {
    /// Coordinates of the point.
    pub at: RealVector<T>,
    /// Vertices of the moving and of the fixed body.
    pub pair: VertexPair,
}

/// Simplex of up to four points of `M`, each with a weight.
#[derive(Debug, Clone, Copy)]
pub struct Simplex<T> {
    at: [RealVector<T>; 4],
    pairs: [VertexPair; 4],
    /// Weights of the nearest point; 0 beyond `count`.
    weights: [T; 4],
    count: usize,
}

impl<T: Real> Simplex<T> {
    /// Builds the simplex of one corner, with weight 1.
    #[inline]
    pub fn new(corner: Corner<T>) -> Self {
        let mut weights = [T::ZERO; 4];
        weights[0] = T::from_f64(1.0);
        Self { at: [corner.at; 4], pairs: [corner.pair; 4], weights, count: 1 }
    }

    /// Builds the simplex of up to three corners. `None` if there are none.
    pub(super) fn from_corners(mut corners: impl Iterator<Item = Corner<T>>) -> Option<Self> {
        let mut simplex = Self::new(corners.next()?);
        corners.for_each(|corner| simplex.push(corner));
        Some(simplex)
    }

    /// Adds a corner.
    ///
    /// # Panics
    /// If the simplex already has four corners.
    #[inline]
    pub fn push(&mut self, corner: Corner<T>) {
        self.at[self.count] = corner.at;
        self.pairs[self.count] = corner.pair;
        self.count += 1;
    }

    /// Checks whether the simplex is a tetrahedron. After [`Self::reduce`] such a simplex contains the origin.
    #[inline]
    pub fn is_full(&self) -> bool {
        self.count == 4
    }

    /// Checks whether a corner has this vertex pair.
    #[inline]
    pub(super) fn contains(&self, pair: VertexPair) -> bool {
        self.pairs[..self.count].contains(&pair)
    }

    /// Returns four pairs and their weights. Pairs with weight 0 are not used.
    #[inline]
    pub(super) fn pairs_and_weights(&self) -> ([VertexPair; 4], [f64; 4]) {
        (self.pairs, self.weights.map(T::to_f64))
    }

    /// Computes the nearest point, and removes the corners that it does not need.
    #[inline]
    pub fn reduce(&mut self) -> RealVector<T> {
        let [a, b, c, d] = &self.at;
        self.weights = match self.count {
            1 => [T::from_f64(1.0), T::ZERO, T::ZERO, T::ZERO],
            2 => segment_weights(a, b),
            3 => triangle_weights(a, b, c),
            _ => tetrahedron_weights([a, b, c, d]),
        };
        self.drop_unweighted()
    }

    /// Computes the nearest point of the faces of a tetrahedron, and removes the other corners. Used for a tetrahedron
    /// so flat that rounded volumes do not locate the origin.
    #[cold]
    pub(super) fn reduce_to_face(&mut self) -> RealVector<T> {
        self.weights = nearest_face_weights(self.at.each_ref());
        self.drop_unweighted()
    }

    /// Removes corners with weight 0, and returns the weighted mean of the others.
    #[inline]
    fn drop_unweighted(&mut self) -> RealVector<T> {
        let mut nearest = RealVector::ZERO;
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
        if kept == 0 {
            // Corners that coincide up to rounding have weights that are not numbers.
            self.weights[0] = T::from_f64(1.0);
            nearest = self.at[0];
        }
        self.count = kept.max(1);
        nearest
    }

    /// Returns the direction from the origin perpendicular to the simplex (any length), given its nearest point.
    #[inline]
    pub fn normal(&self, nearest: &RealVector<T>) -> DVec3 {
        let [a, b, c, _] = &self.at;
        match self.count {
            2 => {
                let edge = b.minus(a);
                let along = nearest.dot(&edge) / edge.dot(&edge);
                nearest.minus(&edge.times(along)).to_dvec3()
            }
            3 => {
                let normal = b.minus(a).cross(&c.minus(a)).to_dvec3();
                if normal.dot(nearest.to_dvec3()) < 0.0 { -normal } else { normal }
            }
            _ => nearest.to_dvec3(),
        }
    }
}

/// Returns the weights of the point of a segment nearest to the origin.
#[inline]
fn segment_weights<T: Real>(a: &RealVector<T>, b: &RealVector<T>) -> [T; 4] {
    let one = T::from_f64(1.0);
    let edge = b.minus(a);
    let (along, square) = (-a.dot(&edge), edge.dot(&edge));
    if along >= square {
        // This includes coincident points.
        [T::ZERO, one, T::ZERO, T::ZERO]
    } else if along > T::ZERO {
        let t = along / square;
        [one - t, t, T::ZERO, T::ZERO]
    } else {
        [one, T::ZERO, T::ZERO, T::ZERO]
    }
}

/// Returns the weights of the point of a triangle nearest to the origin (Ericson, "Real-Time Collision Detection",
/// section 5.1.5).
#[inline]
fn triangle_weights<T: Real>(a: &RealVector<T>, b: &RealVector<T>, c: &RealVector<T>) -> [T; 4] {
    let (zero, one) = (T::ZERO, T::from_f64(1.0));
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
    // Areas along the normal. Products of the sums above would lose twice as many digits for thin triangles.
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

/// Returns the weights of the point of a tetrahedron nearest to the origin. This is the origin itself if it is on the
/// inner side of all faces.
#[inline]
fn tetrahedron_weights<T: Real>(corners: [&RealVector<T>; 4]) -> [T; 4] {
    let [a, b, c, d] = corners;
    let volume = |x: &RealVector<T>, y: &RealVector<T>, z: &RealVector<T>| x.dot(&y.cross(z));
    let volumes = [volume(b, c, d), -volume(a, c, d), volume(a, b, d), -volume(a, b, c)];
    let inside = volumes.iter().all(|x| *x > T::ZERO) || volumes.iter().all(|x| *x < T::ZERO);
    if inside {
        let sum = volumes[0] + volumes[1] + volumes[2] + volumes[3];
        return volumes.map(|x| x / sum);
    }
    nearest_face_weights(corners)
}

/// Returns the weights of the point of the faces of a tetrahedron nearest to the origin.
fn nearest_face_weights<T: Real>(corners: [&RealVector<T>; 4]) -> [T; 4] {
    let mut best = ([T::ZERO; 4], None);
    for left_out in 0..4 {
        let [i, j, k] = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]][left_out];
        let [u, v, w, _] = triangle_weights(corners[i], corners[j], corners[k]);
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
