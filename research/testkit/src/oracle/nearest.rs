//! Judges distances and depths in exact arithmetic.
//!
//! Notation as in [`mod@distance`]. Every number of an answer or proof is taken as exact.
//!
//! - *Bounds.* `lower^2 <= |v|^2 <= upper^2`, with `v` from [`distance()`].
//! - *Plane.* `min_Q n.q - max_P n.p >= gap |n|`, compared as squares.
//! - *Points.* The weighted means of the pairs are at most the stated distance apart. For a distance of 0 the
//!   pairs enclose the origin.
//! - *Depth.* The normal of a face of `M` is the cross product of two differences of vertices, of `P`, of `Q`
//!   or one of each. Therefore the minimum of `max_M n.m / |n|` over all such products, with both signs, is the
//!   depth.

use colltrans::{Depth, Distance, NearPoints, Pair, PlaneGap, VertexPair, Within};

use glam::DVec3;

use crate::oracle::check::{Objection, require};
use crate::oracle::distance::{self, distance, gap_along};
use crate::oracle::exact::{Dyadic, Ratio, Vector, place};
use crate::oracle::scene::size;

/// The exact distance of two placed bodies, with which answers are compared.
#[derive(Debug)]
pub struct DistanceJudge<'a> {
    pair: Pair<'a>,
    moving: Vec<Vector>,
    fixed: Vec<Vector>,
    /// The exact distance.
    pub truth: distance::Distance,
    /// The noise of the library, `32 u S`.
    pub noise: f64,
}

impl<'a> DistanceJudge<'a> {
    /// Computes the exact distance of a pair.
    pub fn new(pair: Pair<'a>) -> Self {
        let [p, q] = [pair.moving_pose(), pair.fixed_pose()];
        let moving = place(p.matrix(), p.translation(), pair.moving().vertices());
        let fixed = place(q.matrix(), q.translation(), pair.fixed().vertices());
        let size = size([pair.moving().vertices(), pair.fixed().vertices()], [&p, &q]);
        let truth = distance(&moving, &fixed);
        let noise = 16.0 * f64::EPSILON * size.max(colltrans::MIN_MAGNITUDE);
        Self { pair, moving, fixed, truth, noise }
    }

    /// Checks a distance with its proof. Returns the difference of its bounds in noises.
    ///
    /// # Errors
    /// [`Objection`] with the first statement that is false.
    pub fn check(&self, answer: &Distance) -> Result<f64, Objection> {
        let [lower, upper] = answer.bounds();
        require!(0.0 <= lower && lower <= upper, "bounds {lower:e} and {upper:e}");
        let truth = self.truth.to_f64();
        require!(exact_square(lower) <= self.truth.square, "lower bound {lower:e} of {truth:e}");
        require!(exact_square(upper) >= self.truth.square, "upper bound {upper:e} of {truth:e}");
        require!(answer.near.distance == upper, "the points are of another bound");
        self.check_points(&answer.near)?;
        if let Some(plane) = answer.gap {
            require!(plane.gap == lower && lower > 0.0, "the plane is of another bound");
            require!(answer.normal == Some(plane.normal), "two different normals");
            require!(answer.features.is_some(), "there is a plane and no feature");
            self.check_plane(&plane)?;
        } else {
            require!(lower == 0.0 && answer.normal.is_none(), "a bound without a plane");
        }
        let apart = (answer.on_fixed - answer.on_moving).length();
        let world = self.pair.moving_pose().translation().length();
        let rounding = 2.0 * self.noise + 32.0 * f64::EPSILON * world;
        require!(
            lower - rounding <= apart && apart <= upper + rounding,
            "the points are {apart:e} apart, not {truth:e}"
        );
        Ok((upper - lower) / self.noise)
    }

    /// Checks the answer whether the bodies are closer than a length.
    ///
    /// # Errors
    /// [`Objection`] with the first statement that is false.
    pub fn check_within(&self, length: f64, answer: &Within) -> Result<(), Objection> {
        let truth = self.truth.to_f64();
        match answer {
            Within::Closer(near) => {
                require!(near.distance <= length, "points {:e} apart", near.distance);
                require!(
                    exact_square(length) >= self.truth.square,
                    "{truth:e} is not within {length:e}"
                );
                self.check_points(near)
            }
            Within::Farther(plane) => {
                require!(plane.gap > length, "a gap of {:e}", plane.gap);
                require!(
                    exact_square(length) < self.truth.square,
                    "{truth:e} is within {length:e}"
                );
                self.check_plane(plane)
            }
            Within::Undecided(distance) => {
                let [lower, upper] = distance.bounds();
                require!(lower <= length && length < upper, "the bounds decide");
                self.check(distance).map(|_| ())
            }
        }
    }

    /// Checks the bounds of a depth and their proof. Returns the difference of the bounds in noises.
    ///
    /// # Errors
    /// [`Objection`] with the first statement that is false.
    pub fn check_depth(&self, answer: &Depth) -> Result<f64, Objection> {
        let [lower, upper] = answer.bounds();
        require!(0.0 <= lower && lower <= upper, "bounds {lower:e} and {upper:e} of a depth");
        let verified = self.pair.verify(answer).map_err(|e| Objection(format!("depth: {e}")))?;
        require!(verified >= lower, "verified a depth of {verified:e} of {lower:e}");
        let n = Vector::new(answer.direction);
        let reach = -self.gap_along(&Vector::new(-answer.direction));
        let (claimed, square) = (Dyadic::new(upper), n.dot(&n));
        require!(
            !reach.is_positive() || &reach * &reach <= &(&claimed * &claimed) * &square,
            "a depth of {upper:e} does not part them"
        );
        require!(lower == 0.0 || self.truth.intersects(), "they are apart");
        Ok((upper - lower) / self.noise)
    }

    /// Compares the bounds of a depth with the exact depth, for small bodies.
    ///
    /// # Errors
    /// [`Objection`] with the bound that is false.
    pub fn compare_depth(&self, answer: &Depth) -> Result<(), Objection> {
        let truth = if self.truth.intersects() {
            depth(&self.moving, &self.fixed, self.noise)
        } else {
            Ratio::from_f64(0.0)
        };
        let [lower, upper] = answer.bounds();
        let rounded = truth.sqrt_to_f64();
        require!(exact_square(lower) <= truth, "lower bound {lower:e} of a depth of {rounded:e}");
        require!(exact_square(upper) >= truth, "upper bound {upper:e} of a depth of {rounded:e}");
        Ok(())
    }

    /// Checks the plane of a lower bound.
    fn check_plane(&self, plane: &PlaneGap) -> Result<(), Objection> {
        let PlaneGap { normal, gap } = *plane;
        require!((normal.length() - 1.0).abs() < 1e-14, "the normal {normal} is not a unit vector");
        let n = Vector::new(normal);
        let along = self.gap_along(&n);
        let claimed = &Dyadic::new(gap) * &Dyadic::new(gap);
        require!(
            !along.is_negative() && &along * &along >= &claimed * &n.dot(&n),
            "a gap of {gap:e}, and the plane proves {:e}",
            along.to_f64()
        );
        let verified = self.pair.verify(plane).map_err(|e| Objection(format!("gap: {e}")))?;
        require!(verified >= gap, "verified {verified:e} of {gap:e}");
        Ok(())
    }

    /// Returns `min_Q n.q - max_P n.p`.
    fn gap_along(&self, n: &Vector) -> Dyadic {
        gap_along([&self.moving, &self.fixed], n)
    }

    /// Checks the points of an upper bound.
    fn check_points(&self, near: &NearPoints) -> Result<(), Objection> {
        let NearPoints { pairs, weights, distance } = near;
        let differences = pairs.map(|pair| self.difference(pair));
        if *distance == 0.0 {
            require!(encloses_origin(&differences), "four points that do not enclose the origin");
        } else {
            require!(weights.iter().all(|w| *w >= 0.0), "negative weights");
            let sum = weights.iter().fold(Dyadic::ZERO, |sum, w| &sum + &Dyadic::new(*w));
            require!(sum.is_positive(), "no weights");
            let zero = Vector([Dyadic::ZERO, Dyadic::ZERO, Dyadic::ZERO]);
            let mean = differences
                .iter()
                .zip(weights)
                .fold(zero, |mean, (m, w)| mean.plus(&m.times(&Dyadic::new(*w))));
            let claimed = &Dyadic::new(*distance) * &sum;
            require!(
                mean.dot(&mean) <= &claimed * &claimed,
                "the points are more than {distance:e} apart"
            );
        }
        let verified = self.pair.verify(near).map_err(|e| Objection(format!("points: {e}")))?;
        require!(verified <= *distance, "verified {verified:e} of {distance:e}");
        Ok(())
    }

    /// Returns the difference `q - p` of a pair of vertices.
    fn difference(&self, pair: VertexPair) -> Vector {
        self.fixed[pair.fixed.index()].minus(&self.moving[pair.moving.index()])
    }
}

/// Returns the squared depth of intersecting bodies, from all cross products of two differences of vertices.
/// `noise` is their rounding error.
///
/// # Panics
/// If a body has no points.
pub fn depth(moving: &[Vector], fixed: &[Vector], noise: f64) -> Ratio {
    let edges = |points: &[Vector]| -> Vec<Vector> {
        let from = |i: usize| (0..i).map(move |j| points[i].minus(&points[j]));
        (0..points.len()).flat_map(from).collect()
    };
    let (p, q) = (edges(moving), edges(fixed));
    let all: Vec<&Vector> = p.iter().chain(&q).collect();
    let [near_by, far_off] = [moving, fixed]
        .map(|body| body.iter().map(|x| x.minus(&moving[0]).to_f64()).collect::<Vec<_>>());
    // Candidates that exceed the minimum by more than rounding are not evaluated exactly.
    let reach = |n: DVec3| {
        let far = far_off.iter().map(|x| n.dot(*x)).fold(f64::NEG_INFINITY, f64::max);
        let near = near_by.iter().map(|x| n.dot(*x)).fold(f64::INFINITY, f64::min);
        far - near
    };
    let mut candidates = Vec::new();
    for i in 0..all.len() {
        for j in 0..i {
            let n = all[i].cross(all[j]).to_f64();
            for sign in [1.0, -1.0] {
                candidates.push((reach(n * sign) / n.length(), i, j, sign));
            }
        }
    }
    let sound = |value: f64| if value.is_nan() { f64::INFINITY } else { value };
    let least = candidates.iter().map(|c| sound(c.0)).fold(f64::INFINITY, f64::min);
    let margin = 1e5 * noise;
    let mut depth: Option<Ratio> = None;
    for (value, i, j, sign) in candidates {
        if value <= least + margin || value.is_nan() {
            let n = all[i].cross(all[j]).times(&Dyadic::new(sign));
            depth = least_along([moving, fixed], depth, &n);
        }
    }
    depth.unwrap_or_else(|| Ratio::from_f64(0.0))
}

/// Returns the smaller of a squared depth and that along a normal.
fn least_along(bodies: [&[Vector]; 2], depth: Option<Ratio>, n: &Vector) -> Option<Ratio> {
    let square = n.dot(n);
    if square.is_zero() {
        return depth;
    }
    let reach = -gap_along(bodies, &n.times(&Dyadic::new(-1.0)));
    let here = if reach.is_positive() { &reach * &reach } else { Dyadic::ZERO };
    let here = Ratio::new(here, square);
    Some(depth.map_or(here.clone(), |depth| depth.min(here)))
}

/// Checks whether a tetrahedron with a volume contains the origin.
fn encloses_origin([a, b, c, d]: &[Vector; 4]) -> bool {
    let volumes = [[b, c, d], [a, d, c], [a, b, d], [a, c, b]].map(|[x, y, z]| x.dot(&y.cross(z)));
    let some = volumes.iter().any(|v| !v.is_zero());
    let none_less = volumes.iter().all(|v| !v.is_negative());
    some && (none_less || volumes.iter().all(|v| !v.is_positive()))
}

/// Returns the exact square.
fn exact_square(x: f64) -> Ratio {
    Ratio::from_f64(x).times(&Ratio::from_f64(x))
}
