//! Casts with a minimum gap: finds the first position on a line at which a convex set is as near as the gap.
//!
//! - `M = {q - p}`: a convex set in the setting frame. `d`: the direction with length 1. `g > 0`: the gap.
//! - `f(s)`: the distance of `s d` from `M`, a convex function. The *crossing* is the first `s` with
//!   `f(s) = g`.
//! - Lower bound: a plane with the unit normal `n`, `n.d > 0`, and all of `M` above the height `h` proves
//!   `s >= (h - g) / n.d`.
//! - Upper bound: a point `c` of `M` with `|c - s d| <= g` proves that the crossing is at most `s`.
//! - No crossing: a plane with `n.d = 0` and `h > g`.
//!
//! [`bound_crossing`] is Newton's method for `f(s) = g` from below. Each sample at `s` finds the point of `M` nearest
//! to `s d` and a plane between them. [`distance_to_line`] computes the distance of the whole line from `M`. Rounding
//! errors are analysed in `docs/theory/minimum-gap.md`.

pub(crate) mod convex;

use glam::{DVec2, DVec3};

use colltrans_kernel::noise::{Noise, UNIT_VECTOR};

/// Maximum number of samples; more than were ever observed.
const MAX_SAMPLES: usize = 96;

/// Difference of the bounds, in noises over `n.d`, at which the search ends.
const SUFFICIENT_WIDTH: f64 = 5.0;

/// Minimum step of the lower bound, in noises over `n.d`, that counts as progress.
const MIN_BOUND_STEP: f64 = 0.125;

/// Initial distance ahead of the lower bound, in noises over `n.d`, of the samples that search for a point proven to be
/// within the gap. The distance doubles with each such sample.
const FIRST_STEP_AHEAD: f64 = 5.5;
/// Maximum distance ahead of the lower bound, in noises over `n.d`, of the samples of [`FIRST_STEP_AHEAD`].
const MAX_STEP_AHEAD: f64 = 11.0;

/// Reduction of the gap, in noises, with which an upper bound is computed. It exceeds the margin with which the upper
/// bound is checked ([`GapLine::is_within_gap`]).
const GAP_MARGIN: f64 = 2.0;

/// Maximum number of rounds of the descent in the shadow.
const MAX_ROUNDS: usize = 64;

/// A convex set whose distance from the points of a line is sampled.
pub trait SampledSet {
    /// Identification of a plane's support.
    type PlaneId: Copy;
    /// Identification of a point.
    type PointId: Copy;

    /// Returns the supporting plane with the unit normal `normal` below the set, and a point of the set on it.
    fn supporting_plane(&mut self, normal: DVec3) -> (SetPlane<Self::PlaneId>, DVec3);

    /// Finds the point of the set nearest to `from`, and a plane between them.
    fn sample(&mut self, from: DVec3) -> DistanceSample<Self::PlaneId, Self::PointId>;
}

/// A plane below a convex set.
#[derive(Debug, Clone, Copy)]
pub struct SetPlane<S> {
    /// Unit normal, up to rounding.
    pub normal: DVec3,
    /// Lower bound of `normal . m` for all points `m` of the set; errors are subtracted.
    pub height: f64,
    /// Part of the subtracted errors that is not rounding: a bound on how far the set extends beyond the
    /// support.
    pub excess: f64,
    /// Support of the plane.
    pub support: S,
}

/// Sample of the distance of a set from a point.
pub struct DistanceSample<S, P> {
    /// Plane between the point and the set. `None` if rounding hides it.
    pub plane: Option<SetPlane<S>>,
    /// Nearest point of the set, rounded.
    pub point: DVec3,
    /// Identification of the nearest point.
    pub spot: P,
    /// Corners of the feature that has the nearest point in its interior, at most three of them.
    pub corners: [DVec3; 3],
    /// Number of corners of the feature.
    pub count: usize,
}

/// A line through the origin and the minimum gap.
#[derive(Debug, Clone, Copy)]
pub struct GapLine {
    /// Direction, with length 1.
    pub unit: DVec3,
    /// Minimum gap.
    pub min_gap: f64,
    /// Noise of the configuration's size plus the gap.
    pub noise: Noise,
    /// Maximum `|s|` of a crossing. Points of the line farther from the origin are farther from the set than the gap.
    pub(crate) max_distance: f64,
}

/// Bounds of a crossing.
pub struct CrossingBounds<T: SampledSet> {
    /// Plane that proves the lower bound.
    pub(crate) plane: SetPlane<T::PlaneId>,
    /// Lower bound, a length.
    pub lower: f64,
    /// Point that proves the upper bound. `None` if no point is near enough.
    pub near_point: Option<NearPoint<T::PointId>>,
    /// Number of samples.
    pub(crate) samples: u32,
    /// Whether a plane has shown that the line does not cross the gap, up to rounding.
    pub(crate) is_passing: bool,
}

/// A point of the set that is as near as the gap.
#[derive(Debug, Clone, Copy)]
pub struct NearPoint<P> {
    /// Upper bound of the crossing that the point proves, a length.
    pub(crate) upper: f64,
    /// Position of the point.
    pub point: DVec3,
    /// Identification of the point.
    pub(crate) spot: P,
}

impl GapLine {
    /// Creates the line for a configuration of the size `size`.
    #[inline]
    pub fn new(unit: DVec3, min_gap: f64, size: f64) -> Self {
        let noise = Noise::for_size(size + min_gap);
        Self { unit, min_gap, noise, max_distance: size + min_gap + noise.point_error() }
    }

    /// Returns `n.d` for a unit normal: the divisor of lower bounds.
    #[inline]
    pub fn direction_cosine(&self, normal: DVec3) -> f64 {
        normal.dot(self.unit)
    }

    /// Returns the lower bound of the crossing that a plane proves. `None` if `n.d` is not positive by more
    /// than rounding.
    pub(crate) fn lower_bound<S>(&self, plane: &SetPlane<S>) -> Option<f64> {
        let slope = self.direction_cosine(plane.normal);
        (slope > UNIT_VECTOR).then(|| (plane.height - self.min_gap) / slope)
    }

    /// Returns the first `s` at which a point is as near as `gap` to `s d`. `None` if there is no such `s`.
    fn gap_crossing(&self, point: DVec3, gap: f64) -> Option<f64> {
        let along = point.dot(self.unit);
        let lateral_distance = (point - self.unit * along).length();
        let square = (gap - lateral_distance) * (gap + lateral_distance);
        (gap >= 0.0 && square >= 0.0).then(|| along - square.sqrt())
    }

    /// Estimates the crossing of a point without a margin for rounding. `None` if the point is never as near as
    /// the gap.
    #[inline]
    pub fn estimate_crossing(&self, point: DVec3) -> Option<f64> {
        self.gap_crossing(point, self.min_gap)
    }

    /// Returns an upper bound of the crossing that a point proves. `None` if the point is not as near as the
    /// gap for certain.
    #[inline]
    pub fn crossing_upper_bound(&self, point: DVec3) -> Option<f64> {
        let s = self.gap_crossing(point, self.min_gap - GAP_MARGIN * self.noise.point_error())?;
        self.is_within_gap(point - self.unit * s).then_some(s)
    }

    /// Checks whether a vector, as computed, is for certain not longer than the gap.
    pub(crate) fn is_within_gap(&self, way: DVec3) -> bool {
        way.length() + self.noise.mean_length_margin() <= self.min_gap
    }

    /// Returns the difference of the bounds that is due to an error of `noises` noises and to the excess of the set
    /// beyond the support of the plane.
    pub(crate) fn bound_width<S>(&self, plane: &SetPlane<S>, noises: f64) -> f64 {
        (noises * self.noise.point_error() + 2.0 * plane.excess)
            / self.direction_cosine(plane.normal)
    }

    /// Returns the displacement along the line from `s` to the crossing of the nearest feature, if the set consisted of
    /// this vertex or edge alone. `None` for a face, or if the feature has no crossing.
    fn distance_to_feature<S, P>(&self, look: &DistanceSample<S, P>, s: f64) -> Option<f64> {
        let from_sample = |k: usize| look.corners[k] - self.unit * s;
        match look.count {
            1 => self.gap_crossing(from_sample(0), self.min_gap),
            2 => self.edge_crossing([from_sample(0), from_sample(1)]),
            _ => None,
        }
    }

    /// Returns the first `s` at which the infinite line through two points is as near as the gap to `s d`. `None` if
    /// there is no such `s`, or if the points coincide.
    fn edge_crossing(&self, [from, to]: [DVec3; 2]) -> Option<f64> {
        let edge = (to - from).try_normalize()?;
        let across = |v: DVec3| v - edge * v.dot(edge);
        let (d, a) = (across(self.unit), across(from));
        let [dd, da, aa] = [d.dot(d), d.dot(a), a.dot(a) - self.min_gap * self.min_gap];
        let square = da * da - dd * aa;
        (square >= 0.0 && dd > 0.0).then(|| (da - square.sqrt()) / dd)
    }
}

/// Samples the distance along the line until the bounds are as near to each other as rounding lets them, or
/// until the lower bound reaches `limit`. Starts at the lower bound of the plane `start`, which must not be
/// along the direction.
pub fn bound_crossing<T: SampledSet>(
    target: &mut T,
    line: &GapLine,
    start: SetPlane<T::PlaneId>,
    limit: f64,
) -> CrossingBounds<T> {
    let lower = line.lower_bound(&start).unwrap_or(f64::NEG_INFINITY);
    let mut best =
        CrossingBounds { plane: start, lower, near_point: None, samples: 0, is_passing: false };
    let mut plan = SamplePlan::from_bound(lower);
    for _ in 0..MAX_SAMPLES {
        if best.lower >= limit {
            break;
        }
        plan.s = plan.s.clamp(-line.max_distance, line.max_distance);
        let look = target.sample(line.unit * plan.s);
        best.samples += 1;
        best.record_point(line, &look);
        best.record_plane(line, &look, &mut plan);
        if best.is_passing || best.is_converged(line) || !plan.plan_next(line, &best, &look) {
            break;
        }
    }
    best
}

/// Position of the next sample, and the state that determines it.
struct SamplePlan {
    /// Position of the next sample.
    s: f64,
    /// Last lower bound at which a sample was taken.
    sampled_bound: f64,
    /// Whether the sample is at a lower bound.
    is_at_bound: bool,
    /// Distance of the next sample ahead of the lower bound, in noises over `n.d`.
    step_ahead: f64,
    /// Position from which on all of the set is farther away than the gap. Infinite if unknown.
    end: f64,
}

impl SamplePlan {
    /// Creates the plan whose first sample is at a lower bound.
    fn from_bound(lower: f64) -> Self {
        Self {
            s: lower,
            sampled_bound: lower,
            is_at_bound: true,
            step_ahead: FIRST_STEP_AHEAD,
            end: f64::INFINITY,
        }
    }

    /// Chooses the position of the next sample: at the crossing of the nearest feature after a sample at a
    /// lower bound, else at the lower bound if it has risen, else slightly ahead of it. Returns `false` if the
    /// search is over.
    fn plan_next<T: SampledSet>(
        &mut self,
        line: &GapLine,
        best: &CrossingBounds<T>,
        look: &DistanceSample<T::PlaneId, T::PointId>,
    ) -> bool {
        let upper = best.near_point.map_or(self.end.min(line.max_distance), |near| near.upper);
        let feature = line.distance_to_feature(look, self.s).map(|by| self.s + by);
        let is_new = |next: &f64| *next > best.lower && *next <= upper && *next != self.s;
        if let (true, Some(next)) = (self.is_at_bound, feature.filter(is_new)) {
            (self.s, self.is_at_bound) = (next, false);
            return true;
        }
        if best.lower - self.sampled_bound > line.bound_width(&best.plane, MIN_BOUND_STEP) {
            (self.s, self.sampled_bound, self.is_at_bound) = (best.lower, best.lower, true);
            return true;
        }
        // The nearest point is accurate to a noise. Slightly ahead of the bound it is near enough.
        self.s = best.lower + line.bound_width(&best.plane, self.step_ahead);
        self.is_at_bound = false;
        self.step_ahead *= 2.0;
        self.step_ahead <= 2.0 * MAX_STEP_AHEAD
    }
}

impl<T: SampledSet> CrossingBounds<T> {
    /// Stores the point of a sample if it proves a smaller upper bound.
    pub(crate) fn record_point(
        &mut self,
        line: &GapLine,
        look: &DistanceSample<T::PlaneId, T::PointId>,
    ) {
        let Some(upper) = line.crossing_upper_bound(look.point) else { return };
        if self.near_point.is_none_or(|near| upper < near.upper) {
            self.near_point = Some(NearPoint { upper, point: look.point, spot: look.spot });
        }
    }

    /// Stores the plane of a sample if it proves a greater lower bound. If the plane proves no lower bound, but shows
    /// that all positions ahead are farther away than the gap, records this in `plan` and in `is_passing`.
    fn record_plane(
        &mut self,
        line: &GapLine,
        look: &DistanceSample<T::PlaneId, T::PointId>,
        plan: &mut SamplePlan,
    ) {
        let Some(plane) = look.plane else { return };
        if let Some(lower) = line.lower_bound(&plane) {
            if lower > self.lower {
                (self.plane, self.lower) = (plane, lower);
                self.is_passing |= lower > line.max_distance;
            }
        } else {
            // All points ahead are farther away than the gap.
            let gap = plane.height - plan.s * line.direction_cosine(plane.normal);
            if self.near_point.is_none() && gap > line.min_gap {
                // If the sample is at a lower bound, all points before it are farther away too: there is no
                // crossing. Otherwise there may be one before it.
                self.is_passing |= plan.is_at_bound;
                plan.end = plan.s;
            }
        }
    }

    /// Checks whether the bounds differ by no more than [`SUFFICIENT_WIDTH`].
    fn is_converged(&self, line: &GapLine) -> bool {
        let gap = self.near_point.map(|near| near.upper - self.lower);
        gap.is_some_and(|gap| gap <= line.bound_width(&self.plane, SUFFICIENT_WIDTH))
    }
}

/// Distance of a line from a set.
pub struct LineDistance<S> {
    /// Plane along the line with the greatest height found.
    pub plane: SetPlane<S>,
    /// Upper bound of the distance, up to rounding; 0 if the line intersects the set.
    pub(crate) distance: f64,
}

/// Finds the point of the set's shadow nearest to the line, by descent over simplices from the direction
/// `toward`. Evaluates at least one plane, therefore the result is never `None`.
pub fn distance_to_line<T: SampledSet>(
    target: &mut T,
    line: &GapLine,
    toward: DVec3,
) -> Option<LineDistance<T::PlaneId>> {
    let x = line.unit.any_orthonormal_vector();
    let y = line.unit.cross(x);
    let to_plane = |v: DVec3| DVec2::new(v.dot(x), v.dot(y));
    let mut simplex = ShadowSimplex::default();
    let mut axis = to_plane(toward).try_normalize().unwrap_or(DVec2::X);
    let mut best: Option<LineDistance<T::PlaneId>> = None;
    for _ in 0..MAX_ROUNDS {
        let normal = (x * axis.x + y * axis.y).normalize_or(x);
        let (plane, lowest) = target.supporting_plane(normal);
        let distance = best.as_ref().map_or(f64::INFINITY, |best| best.distance);
        if best.as_ref().is_none_or(|best| plane.height > best.plane.height) {
            best = Some(LineDistance { plane, distance });
        }
        let best = best.as_mut()?;
        let lowest = to_plane(lowest);
        // No point is nearer than those of the simplex.
        if simplex.count > 0 && axis.dot(lowest) >= distance - line.noise.point_error() {
            break;
        }
        match simplex.add_point(lowest) {
            Some((next, distance)) if distance < best.distance => {
                best.distance = distance;
                axis = next;
            }
            Some(_) => break,
            None => {
                best.distance = 0.0;
                break;
            }
        }
    }
    best
}

/// Up to three points of a shadow.
#[derive(Default)]
struct ShadowSimplex {
    points: [DVec2; 3],
    count: usize,
}

impl ShadowSimplex {
    /// Adds a point, and drops points that the nearest feature does not need. Returns the direction to the
    /// point nearest to the origin, perpendicular to an edge that contains it, and its distance. `None` if the
    /// simplex contains the origin.
    fn add_point(&mut self, point: DVec2) -> Option<(DVec2, f64)> {
        self.points[self.count] = point;
        self.count += 1;
        let [a, b, c] = self.points;
        match self.count {
            1 => self.reduce_to(Self::nearest_on_edge(a, a)),
            2 => self.reduce_to(Self::nearest_on_edge(a, b)),
            _ => {
                let area = (b - a).perp_dot(c - a);
                let inside = |p: DVec2, q: DVec2| p.perp_dot(q) * area >= 0.0;
                if area != 0.0 && inside(a, b) && inside(b, c) && inside(c, a) {
                    return None;
                }
                // The nearest edge contains the last point.
                let [one, other] = [Self::nearest_on_edge(a, c), Self::nearest_on_edge(b, c)];
                let nearer =
                    if one.2.length_squared() <= other.2.length_squared() { one } else { other };
                self.reduce_to(nearer)
            }
        }
    }

    /// Keeps the ends of the nearest feature. Returns the direction to its nearest point and the distance.
    /// `None` if this point is the origin.
    fn reduce_to(
        &mut self,
        (points, count, at): ([DVec2; 2], usize, DVec2),
    ) -> Option<(DVec2, f64)> {
        let [a, b] = points;
        (self.points, self.count) = ([a, b, DVec2::ZERO], count);
        let across = if count == 2 { (b - a).perp() } else { at };
        let axis = across.try_normalize()?;
        let axis = if axis.dot(a) < 0.0 { -axis } else { axis };
        let distance = if count == 2 { axis.dot(a) } else { at.length() };
        Some((axis, distance))
    }

    /// Finds the point of a segment nearest to the origin. Returns the ends of the feature that contains it,
    /// their number, and the point.
    fn nearest_on_edge(a: DVec2, b: DVec2) -> ([DVec2; 2], usize, DVec2) {
        let along = b - a;
        let share = -a.dot(along) / along.length_squared();
        if share > 0.0 && share < 1.0 {
            ([a, b], 2, a + along * share)
        } else if share >= 1.0 {
            ([b, b], 1, b)
        } else {
            ([a, a], 1, a)
        }
    }
}
