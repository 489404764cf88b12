//! Every bound on a rounding error, in one place.
//!
//! Notation. `u = 2^-53`. `S` is the size of a configuration: the reach of `P` (largest distance of
//! a vertex from its frame's origin) plus that of `Q` plus the distance of the frames, so that no
//! two points of the bodies are farther apart. `M = {q - p}`; `d` is the direction, `n` a unit normal.
//!
//! - *Point.* A coordinate of a point of `M` in the shadow frame is a sum of three dot products.
//!   Rotating a lateral axis into a body costs a relative error of at most `3 u` in each component,
//!   the dot product `3 u`, adding the three parts `2 u`, the axis itself `2 u`: together less than
//!   `10 u S sqrt(3) < 18 u S`. The *noise* is `32 u S`, which also covers comparing two such
//!   coordinates along a unit normal of the frame. A pose's nine entries may be off a rotation by
//!   `1e-6`; they define where the body is, so this is no error, but it stretches lengths by up to
//!   that share: the margin between 18 and 32 covers it.
//! - *Touching.* Sideways distances below eight noises are not told apart: shadows that overlap by
//!   less only touch, and triangles of shadows that are narrower have no plane. So directions
//!   across such a distance are still known to better than 1/8.
//! - *Widening.* When shadows only touch, `M` is widened sideways by a rectangle whose half-sides
//!   are [`WIDENING`] times four touching distances and, if the line misses `M`, the margin (at most
//!   one noise) more: the line then passes clearly inside. Its corners are at most
//!   `|WIDENING| < 1.3` longer half-sides off.
//! - *Plane.* A plane supports `M` when no support point is deeper below it than one noise; after
//!   many exchanges ties follow each other, and what counts as touching is taken to lie on it.
//! - *Gap.* The estimates of the lower and the upper bound each add at most one noise to what the
//!   plane was accepted with, over `n . d` if counted in multiples of `d`; widening by `w` adds what
//!   the rectangle's corners make of it on both sides, `2 |WIDENING| w` times the part of `n` across
//!   `d`.
//! - *Outwards.* The lower bound's products and sums are off by less than `18 u S`, and dividing by a
//!   rounded `n . d` by `3 u S` more, as `|t d| <= S`: one noise, and what the body reaches beyond
//!   the support points. The upper bound's weights are of a triangle more than eight noises high, so
//!   its plane is tilted by rounding by less than an eighth; the weighted mean of its corners is off
//!   the line by at most two noises sideways, as its weights are off by a noise over that height, and
//!   off in height by one: together less than four noises along `n`. Whoever computes the height of
//!   the mean without rounding misses that one, and has to find the bound three noises above it. Of
//!   a narrower triangle the plane is that of its rounded corners: the exact ones, which enclose the
//!   line, are within one noise of it, and the mean, on it, is less than one off the line sideways.
//! - *Polygon.* A point of `M` as the rounded difference of rotated vertices (`3 u sqrt(3)` each, `u` for the
//!   difference), seen along an axis (`3 u`, the axis `2 u`) and moved by the offset along it (`5 u`, `u` for the sum)
//!   is off by less than `18 u S` as well. If the line is seen to pass inside all sides of a face, the face's
//!   corners span a point on it; along the face's normal that is at most as much above the mean of three of them as all
//!   corners are above the plane (half a noise is admitted, and their rounding less than another half), and the mean
//!   is off the line by a noise sideways, in height by one: together less than the four noises of any upper bound. So
//!   the triangle need not be the one that the line pierces in exact numbers.
//! - *Rim.* `n.m >= a` and `k.m >= b` for two unit normals prove `(s n + t k).m >= s a + t b` for `s, t >= 0`, say
//!   of sum 1. Of length `|s n + t k| >= 1/2` the computed unit normal is off that by `8 u`, `8 u S` along it; the quotient of
//!   the bounds by `8 u S`, the offset along the normal by `4 u S`, the sum by `2 u S`: less than one noise. With
//!   shares that make it orthogonal to `d`, which are off by `4 u`, it is so to `23 u`, less than a unit vector may be off.
//! - *Residual.* The witness points of a certificate are the same weighted mean, so they miss each
//!   other by at most two noises sideways, and one that the weights' sum may be off; of bodies that
//!   were widened by the corner of the widest rectangle, and by one noise for each body.
//! - *Mean.* A point of `M` in the setting frame is off by less than `9 u S` (three products in each
//!   coordinate of either body, `3 u sqrt(3)`, the sums `3 u`), the weighted mean of four by `4 u S` more, as
//!   their sum of weights by `3 u`, its length by `2 u`: together less than `18 u S`. Whoever computes the
//!   points nearly without rounding is off by `12 u S` in all. So a distance of two points is raised by one
//!   noise and a half, of which a check demands a fourth of that.
//! - *Height.* A point of `M` in the setting frame along a unit normal is off by `9 u S + 3 u S` as
//!   computed, and by `4 u S` for the normal's length: less than three quarters of a noise. With points that
//!   are computed nearly without rounding a fourth is enough.
//! - *Unit vector.* Normalising leaves `4 u`, rotating into the world `3 u sqrt(3)`, normalising
//!   again `4 u`; an orthogonal one inherits the same from its axes. Tolerated is twice their sum.
//! - *Gain.* A dot product of a direction with an edge vector, itself rounded, has an error of `4 u`
//!   of its terms' magnitudes; a gain below twice that may not be real.
//! - *Coplanar.* A point of a designed plane that was rotated and translated in double precision has
//!   been rounded about eight times at the magnitude `r` of its coordinates, so it is off its plane
//!   by up to `8 u r sqrt(3)`; a plane through three such points is off by as much again, more
//!   beyond their triangle. Points within `64 u r` of a face are taken to lie on it.
//! - *Witness.* A point `a + s (b - a) + t (c - a)` of a triangle, `s, t >= 0`, is compared with a
//!   point `p` in the order `(p - a) - s (b - a) - t (c - a)`. With coordinates up to `r`, each of
//!   the result's is off by `4 u r` for the differences, `2 u r` for the products, `2 u r` for the
//!   first sum, `2 u r` for the last one and `2 u r` because the rounded `s + t` is at most 1; its
//!   length by `10 u r` more: together less than `(12 sqrt(3) + 10) u r < 32 u r`.
//! - *Pose.* Of a motion a sine and `1 - cos` are off by `2 u`, an axis by `4 u` from length 1, a cross
//!   product by `3 u` of its factors: `z + sin (k x z) + (1 - cos) k x (k x z)` is off by `10 u |z|` for the
//!   second term, `28 u |z|` for the third one and `8 u |z|` for the sums, less than `48 u |z|`; three
//!   columns of a rotation together move a point by `48 sqrt(3) u` of its distance from the frame's origin,
//!   less than [`POSE`]. Sine and `1 - cos` are at most the angle, and so is what they make of an arm. A way,
//!   a sum with it and one with another body's are off by less than [`WAY`].
//! - *Section.* A sum of a few products in section coordinates, with a margin for the errors of
//!   their factors. Only guesses hang on it.

use crate::range::MIN_MAGNITUDE;

/// `u`.
const ROUNDING: f64 = 0.5 * f64::EPSILON;

/// The noise of a point, in `u S`.
const POINT: f64 = 32.0;

/// The length of two coordinates' errors, `18 u S` each, in noises.
const LATERAL: f64 = 0.8;

/// What counts as touching, in noises.
const TOUCHING: f64 = 8.0;

/// By how many touching distances bodies that touch are widened.
const WIDER: f64 = 4.0;

/// The sides of the widening rectangle: not equal, because a diagonal of a square would often be
/// parallel to an edge.
pub const WIDENING: [f64; 2] = [1.0, 0.8];

/// At least the length of [`WIDENING`].
const WIDENING_CORNER: f64 = 1.3;

/// The noises that the two bounds of an optimum cost.
const BOUNDS: f64 = 2.0;

/// How many noises bodies reach beyond support points at most.
const BEYOND: f64 = 8.0 * COPLANAR / (POINT * ROUNDING);

/// By how many noises an upper bound is raised.
const RAISED: f64 = 4.0;

/// By how many noises witness points may miss each other.
const RESIDUAL: f64 = 3.0;

/// By how many noises the length of a weighted mean of points of `M` is raised to be an upper bound, and what
/// of that is demanded if the points are computed nearly without rounding.
const MEAN: [f64; 2] = [1.5, 0.375];

/// What of a gap to be kept is not claimed where points are computed nearly without rounding, in noises.
const KEPT: f64 = 0.5;

/// A gap to be kept of no more noises leaves rounding no room.
const SLIGHT: f64 = 8.0;

/// By how many noises a height in the setting frame is lowered to be a lower bound, and what of that is
/// demanded if the points are computed nearly without rounding.
const HEIGHT: [f64; 2] = [0.75, 0.25];

/// Relative error of a unit vector's length and of its product with one it should be orthogonal to.
pub const UNIT_VECTOR: f64 = 32.0 * ROUNDING;

/// Relative error of a gain along an edge, in which more is demanded of a climb.
pub const GAIN: f64 = 8.0 * ROUNDING;

/// Distance from a face, in multiples of the largest coordinate, within which points lie on it.
pub const COPLANAR: f64 = 64.0 * ROUNDING;

/// Bound on the error of a point's distance from a triangle's, in multiples of the largest coordinate.
pub const WITNESS: f64 = 32.0 * ROUNDING;

/// Bound on the error of a point that was turned, in multiples of its distance from the origin of its frame.
pub const POSE: f64 = 96.0 * ROUNDING;

/// How far points of two moving bodies may be off because coordinates of poses below the exact range count as 0.
pub const FLUSHED: f64 = 8.0 * MIN_MAGNITUDE;

/// The same of a displacement.
pub const WAY: f64 = 8.0 * ROUNDING;

/// Relative rounding error of sums in section coordinates.
pub const SECTION: f64 = 128.0 * ROUNDING;

/// The rounding errors of a configuration of one size.
#[derive(Debug, Clone, Copy)]
pub struct Noise(f64);

impl Noise {
    /// For the size `S`.
    #[inline]
    pub fn of(size: f64) -> Self {
        // Two points in one place have no size; the least there can be stands for it.
        Self(POINT * ROUNDING * size.max(MIN_MAGNITUDE))
    }

    /// Bound on the error of a coordinate of a point of `M`, and of comparing two along a unit
    /// normal.
    #[inline]
    pub fn point(self) -> f64 {
        self.0
    }

    /// Bound on the distance by which the shadow of a point of `M` may be off.
    #[inline]
    pub fn lateral(self) -> f64 {
        LATERAL * self.0
    }

    /// Sideways distance below which points are not told apart.
    #[inline]
    pub fn touching(self) -> f64 {
        TOUCHING * self.0
    }

    /// Bound on how far both bodies reach beyond support points: twice four tolerances of [`COPLANAR`] of their size.
    #[inline]
    pub fn beyond(self) -> f64 {
        BEYOND * self.0
    }

    /// How deep below a plane a point may be that counts as lying on it; `late` if many portals
    /// were visited.
    #[inline]
    pub fn plane(self, late: bool) -> f64 {
        if late { self.touching() } else { self.0 }
    }

    /// The longer half-side of the widening rectangle for bodies whose shadows are `margin` apart.
    #[inline]
    pub fn widening(self, margin: f64) -> f64 {
        margin.max(0.0) + WIDER * self.touching()
    }

    /// The largest of these: more than a noise apart, shadows are separated.
    #[inline]
    pub fn widest(self) -> f64 {
        self.widening(self.0)
    }

    /// What rounding can make of `upper - lower` in units of length along `n`, for a normal with
    /// this length across the direction and bodies widened by so much.
    #[inline]
    pub fn gap(self, across: f64, widening: f64) -> f64 {
        // The plane as accepted among ties.
        let bounds = self.plane(true) + BOUNDS * self.0;
        if widening == 0.0 { bounds } else { bounds + across * (2.0 * WIDENING_CORNER * widening) }
    }

    /// By how much a lower bound along `n` has to be lowered to be one.
    #[inline]
    pub fn lowered(self) -> f64 {
        self.0
    }

    /// By how much an upper bound along `n` has to be raised to be one.
    #[inline]
    pub fn raised(self) -> f64 {
        RAISED * self.0
    }

    /// By how much the length of a weighted mean of points of `M` has to be raised to be an upper bound.
    #[inline]
    pub fn mean_raised(self) -> f64 {
        MEAN[0] * self.0
    }

    /// The same for points that are computed nearly without rounding.
    #[inline]
    pub fn mean_checked(self) -> f64 {
        MEAN[1] * self.0
    }

    /// Whether a gap to be kept, that the size has been made larger by, leaves no room for points that are so
    /// near for certain.
    #[inline]
    pub fn is_slight(self, keep: f64) -> bool {
        keep <= SLIGHT * self.0
    }

    /// The same for points that are as near as a gap, after a translation.
    #[inline]
    pub fn mean_kept(self) -> f64 {
        KEPT * self.0
    }

    /// By how much the height of a point of `M` has to be lowered to be a lower bound.
    #[inline]
    pub fn height_lowered(self) -> f64 {
        HEIGHT[0] * self.0
    }

    /// The same for points that are computed nearly without rounding.
    #[inline]
    pub fn height_checked(self) -> f64 {
        HEIGHT[1] * self.0
    }

    /// By how much an upper bound along `n` has to lie above the weighted mean of the corners, if
    /// that is computed without rounding.
    #[inline]
    pub fn above_mean(self) -> f64 {
        (RAISED - 1.0) * self.0
    }

    /// By how much the witness points of a certificate may miss each other that claims an upper
    /// bound.
    #[inline]
    pub fn residual(self) -> f64 {
        RESIDUAL * self.0
    }

    /// The same for bodies that were widened sideways.
    #[inline]
    pub fn residual_widened(self) -> f64 {
        WIDENING_CORNER * self.widest() + BOUNDS * self.0
    }
}
