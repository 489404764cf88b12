//! Judges distances and depths of rounded bodies in exact arithmetic. [`super::min_gap`] judges their casts.
//!
//! Notation. `d` is the exact distance of the cores, `R` the exact sum of the radii, `m` the exact depth of the cores.
//! All numbers of an answer are taken as exact.
//!
//! - *Distance.* `lower + R <= d` unless `lower` is 0, and `d <= upper + R`, compared as squares.
//! - *Depth.* `R - d` if `d > 0`, `R + m` if the cores meet.
//! - *Points.* Each is at its body's radius from the core, up to rounding.

use colltrans::{ConvexPolyhedron, Depth, Distance, Pair, Pose, Within};
use glam::DVec3;

use crate::oracle::check::Objection;
use crate::oracle::distance::{self, distance, distance_of_point};
use crate::oracle::exact::{Dyadic, Ratio, Vector, place};
use crate::oracle::nearest;

macro_rules! require {
    ($condition:expr, $($text:tt)+) => {
        let holds: bool = $condition;
        if !holds {
            return Err(Objection(format!($($text)+)));
        }
    };
}

/// The exact data of a pair of rounded bodies, with which answers are compared.
#[derive(Debug)]
pub struct RoundedJudge<'a> {
    pair: Pair<'a>,
    moving: Vec<Vector>,
    fixed: Vec<Vector>,
    /// The exact distance of the cores.
    pub cores: distance::Distance,
    /// The exact sum of the radii.
    radii: Dyadic,
    /// The noise `32 u S` of the size of the configuration, with the radii.
    pub noise: f64,
}

impl<'a> RoundedJudge<'a> {
    /// Computes the exact data of a pair.
    pub fn new(pair: Pair<'a>) -> Self {
        let put = |body: &ConvexPolyhedron, pose: Pose| {
            place(pose.matrix(), pose.translation(), body.vertices())
        };
        let moving = put(pair.moving(), pair.moving_pose());
        let fixed = put(pair.fixed(), pair.fixed_pose());
        let cores = distance(&moving, &fixed);
        let [r, s] = [pair.moving().radius(), pair.fixed().radius()];
        let reach = |body: &ConvexPolyhedron, pose: Pose| {
            body.vertices().iter().map(|v| v.length()).fold(0.0, f64::max)
                + pose.translation().length()
        };
        let size =
            reach(pair.moving(), pair.moving_pose()) + reach(pair.fixed(), pair.fixed_pose());
        let size = (size + r + s).max(colltrans::MIN_MAGNITUDE);
        let radii = &Dyadic::new(r) + &Dyadic::new(s);
        Self { pair, moving, fixed, cores, radii, noise: 16.0 * f64::EPSILON * size }
    }

    /// Returns the square of `length + R`.
    fn square_between_cores(&self, length: f64) -> Ratio {
        let sum = &Dyadic::new(length) + &self.radii;
        Ratio::new(&sum * &sum, Dyadic::new(1.0))
    }

    /// Checks a distance with its proof. Returns the difference of its bounds in noises.
    ///
    /// # Errors
    /// [`Objection`] with the first statement that is false.
    pub fn check(&self, answer: &Distance) -> Result<f64, Objection> {
        let [lower, upper] = answer.bounds();
        let truth = self.cores.to_f64() - self.radii.to_f64();
        require!(0.0 <= lower && lower <= upper, "bounds {lower:e} and {upper:e}");
        let square = &self.cores.square;
        require!(
            lower == 0.0 || self.square_between_cores(lower) <= *square,
            "lower bound {lower:e} of {truth:e}"
        );
        require!(self.square_between_cores(upper) >= *square, "upper bound {upper:e} of {truth:e}");
        let verified = |checked: Result<f64, colltrans::CertificateError>| {
            checked.map_err(|error| Objection(error.to_string()))
        };
        require!(verified(self.pair.verify(&answer.near))? <= upper, "the points prove less");
        if let Some(plane) = answer.gap {
            require!(plane.gap == lower && lower > 0.0, "the plane is of another bound");
            require!(verified(self.pair.verify(&plane))? >= lower, "the plane proves less");
        } else {
            require!(lower == 0.0, "a bound without a plane");
        }
        self.check_surface_points([answer.on_moving, answer.on_fixed], upper)?;
        Ok((upper - lower) / self.noise)
    }

    /// Checks that two points are on the surfaces of the bodies, or for a distance of 0 in them.
    fn check_surface_points(&self, points: [DVec3; 2], apart: f64) -> Result<(), Objection> {
        let bodies = [
            (self.pair.moving(), self.pair.moving_pose()),
            (self.pair.fixed(), self.pair.fixed_pose()),
        ];
        for (point, (body, pose)) in points.into_iter().zip(bodies) {
            let off = distance_of_point(point, (body, &pose)).to_f64() - body.radius();
            let is_there =
                if apart == 0.0 { off <= 4.0 * self.noise } else { off.abs() <= 4.0 * self.noise };
            require!(is_there, "a point is {off:e} off the surface");
        }
        Ok(())
    }

    /// Checks the answer whether the bodies are closer than a length.
    ///
    /// # Errors
    /// [`Objection`] with the first statement that is false.
    pub fn check_within(&self, length: f64, answer: &Within) -> Result<(), Objection> {
        let between = self.square_between_cores(length);
        match answer {
            Within::Closer(_) => {
                require!(between >= self.cores.square, "not within {length:e}");
            }
            Within::Farther(_) => {
                require!(between < self.cores.square, "within {length:e}");
            }
            Within::Undecided(distance) => {
                let [lower, upper] = distance.bounds();
                require!(lower <= length && length < upper, "the bounds decide");
                self.check(distance)?;
            }
        }
        Ok(())
    }

    /// Checks the bounds of a depth and their proof. Compares them with the exact depth if the cores are apart, or
    /// if `compares` (for small bodies). Returns the difference of the bounds in noises.
    ///
    /// # Errors
    /// [`Objection`] with the first statement that is false.
    pub fn check_depth(&self, answer: &Depth, compares: bool) -> Result<f64, Objection> {
        let [lower, upper] = answer.bounds();
        require!(0.0 <= lower && lower <= upper, "bounds {lower:e} and {upper:e} of a depth");
        let verified = self.pair.verify(answer).map_err(|e| Objection(format!("depth: {e}")))?;
        require!(verified >= lower, "verified a depth of {verified:e} of {lower:e}");
        let one = || Dyadic::new(1.0);
        // Compares `value` with `R + sign * sqrt(square)`.
        let rest = |value: f64| &Dyadic::new(value) - &self.radii;
        let squared = |x: &Dyadic| Ratio::new(x * x, one());
        if !self.cores.intersects() {
            let square = &self.cores.square;
            let [low, high] = [rest(lower), rest(upper)];
            // lower <= R - d: d <= R - lower.
            let is_below = !low.is_positive() && squared(&low) >= *square;
            require!(lower == 0.0 || is_below, "lower bound {lower:e} of a depth");
            // upper >= R - d: R - upper <= d.
            let is_above = !high.is_negative() || squared(&high) <= *square;
            require!(is_above, "upper bound {upper:e} of a depth");
        } else if compares {
            let square = nearest::depth(&self.moving, &self.fixed, self.noise);
            let [low, high] = [rest(lower), rest(upper)];
            let is_below = !low.is_positive() || squared(&low) <= square;
            require!(is_below, "lower bound {lower:e} of a depth of overlapping cores");
            let is_above = !high.is_negative() && squared(&high) >= square;
            require!(is_above, "upper bound {upper:e} of a depth of overlapping cores");
        }
        Ok((upper - lower) / self.noise)
    }
}
