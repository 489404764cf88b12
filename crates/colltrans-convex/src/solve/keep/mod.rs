//! How far a body goes until it is as near to another as a gap that is to be kept.
//!
//! Notation. `M = {q - p}`, a convex set in the setting frame; `d` the direction as a unit vector, `g > 0` the
//! gap, `f(s)` the distance of `s d` from `M`, a convex function. The bodies are nearer than `g` where `f < g`:
//! between two numbers, of which the first is asked. `m` is the least `f`, the distance of the whole line from `M`:
//! that of their shadows along `d`. `S` is the size of the configuration, `u = 2^-53`.
//!
//! - *From below.* A plane with the unit normal `n`, `n.d > 0`, and all of `M` above the height `h`: where the bodies
//!   are nearer than `g`, `s >= (h - g) / n.d`.
//! - *From above.* A point `c` of `M`: where `|c - s d| <= g` they are.
//! - *Never.* A plane with `n.d = 0` and `h > g`.
//!
//! [`travel`] is Newton's method for `f(s) = g`, which comes from below: a *look* at `s` finds the point of `M` nearest
//! to `s d` and the plane across the way there, and the plane says where to look next. As `f` is convex, no such plane
//! leads too far, and each bound is one whatever led there: planes and points are only proposed by looks. In
//! between it looks where the edge or the corner that is nearest would be reached if it were all of `M`: if the
//! nearest feature is no other one there, that look is the last.
//!
//! A line that passes `M` by more than the gap has no such number; one that all but does has one that rounding
//! moves far along. [`shadow`] tells: it descends to the point of the shadow of `M` nearest to the line, over
//! simplices, in the plane.
//!
//! Rounding. All is measured in noises of the size `S + g` (`32 u (S + g)`), as `|s| <= S + g` where bodies are that near.
//!
//! - *Planes.* Heights come with their errors taken off. The product `|n| g` is off by `5 u g` for the length of
//!   `n`, its sum with the height by `u (S + g)`, and dividing by a rounded `n.d` costs `3 u (S + g)` more, as `n.d` is off by
//!   `2 u`. A height along a rounded unit normal is off by `18 u S` at most: together less than the one noise that
//!   is taken off.
//! - *Points.* A mean of points of `M` as computed is off by `16 u S` ([`Noise::mean_raised`]), `s d` by `2 u |s|`, the length of
//!   their difference by `2 u` of it: less than one noise and a half, which is kept from the gap. Who checks demands
//!   half a noise.
//! - Where a bound is not computed from these lines to the last digit (features, shadows), it only proposes.

pub(crate) mod convex;

use glam::{DVec2, DVec3};

use colltrans_kernel::noise::{Noise, UNIT_VECTOR};

/// Looks after which nothing more is expected; more than were ever seen.
const MOST_LOOKS: usize = 96;

/// How far apart, in noises over `n.d`, bounds may be to be left at that.
const ENOUGH: f64 = 5.0;

/// A step of the lower bound, in noises over `n.d`, that is none.
const LEAST_STEP: f64 = 0.125;

/// How far ahead of the lower bound, in noises over `n.d`, a point is looked for where none was near enough, at first
/// and at last.
const AHEAD: f64 = 5.5;
const MOST_AHEAD: f64 = 11.0;

/// What is taken from the gap, in noises, where a point is solved for; a little more than is checked.
const SOLVED: f64 = 2.0;

/// Rounds of the descent in the shadow.
const MOST_ROUNDS: usize = 64;

/// A convex set, seen from a line.
pub trait Target {
    /// What says of a plane where it is.
    type Support: Copy;
    /// What says of a point which it is.
    type Spot: Copy;

    /// The plane with a unit normal below all of it, and a point there.
    fn lowest(&mut self, normal: DVec3) -> (Plane<Self::Support>, DVec3);

    /// The point nearest to a place, and a plane between.
    fn look(&mut self, from: DVec3) -> Look<Self::Support, Self::Spot>;
}

/// All of the set is above it.
#[derive(Debug, Clone, Copy)]
pub struct Plane<S> {
    /// Of length 1, but for rounding.
    pub normal: DVec3,
    /// At most `normal . m` for all `m`, its error taken off.
    pub height: f64,
    /// What was taken off besides rounding.
    pub beyond: f64,
    pub support: S,
}

/// What is seen from a place.
pub struct Look<S, P> {
    /// Between the place and the set; `None` if there is none that rounding can tell.
    pub plane: Option<Plane<S>>,
    /// The nearest point, rounded.
    pub point: DVec3,
    pub spot: P,
    /// The corners of the feature that it is an inner point of, and how many.
    pub corners: [DVec3; 3],
    pub count: usize,
}

/// A line and the gap that is kept from it.
#[derive(Debug, Clone, Copy)]
pub struct Line {
    /// The direction, at length 1.
    pub unit: DVec3,
    pub keep: f64,
    /// Of the size with the gap.
    pub noise: Noise,
    /// Nothing is as near as the gap beyond this.
    pub(crate) reach: f64,
}

/// How near to each other bounds have come.
pub struct Travel<T: Target> {
    /// The plane that the lower bound is of, and the bound as a length.
    pub(crate) plane: Plane<T::Support>,
    pub lower: f64,
    /// The upper bound, the point that it is of, and which.
    pub near: Option<Near<T::Spot>>,
    pub(crate) looks: u32,
    /// Whether a plane showed that the line passes, or all but passes.
    pub(crate) passes: bool,
}

/// A point of the set that is as near as the gap.
#[derive(Debug, Clone, Copy)]
pub struct Near<P> {
    pub(crate) upper: f64,
    pub point: DVec3,
    pub(crate) spot: P,
}

impl Line {
    #[inline]
    pub fn new(unit: DVec3, keep: f64, size: f64) -> Self {
        let noise = Noise::of(size + keep);
        Self { unit, keep, noise, reach: size + keep + noise.point() }
    }

    /// How far a plane is off the direction: what bounds from below are divided by.
    #[inline]
    pub fn slope(&self, normal: DVec3) -> f64 {
        normal.dot(self.unit)
    }

    /// No point above a plane is as near as the gap before; `None` if it lies along the direction.
    pub(crate) fn lower<S>(&self, plane: &Plane<S>) -> Option<f64> {
        let slope = self.slope(plane.normal);
        (slope > UNIT_VECTOR).then(|| (plane.height - self.keep) / slope)
    }

    /// Where a point is as near as a gap.
    fn root(&self, point: DVec3, gap: f64) -> Option<f64> {
        let along = point.dot(self.unit);
        let aside = (point - self.unit * along).length();
        let square = (gap - aside) * (gap + aside);
        (gap >= 0.0 && square >= 0.0).then(|| along - square.sqrt())
    }

    /// The same with the gap as it is: an estimate.
    #[inline]
    pub fn estimate(&self, point: DVec3) -> Option<f64> {
        self.root(point, self.keep)
    }

    /// Where a point is so near for certain.
    #[inline]
    pub fn upper(&self, point: DVec3) -> Option<f64> {
        let s = self.root(point, self.keep - SOLVED * self.noise.point())?;
        self.is_near(point - self.unit * s).then_some(s)
    }

    /// Whether what is so far away, as computed, is as near as the gap.
    pub(crate) fn is_near(&self, way: DVec3) -> bool {
        way.length() + self.noise.mean_raised() <= self.keep
    }

    /// How far apart bounds may be, for a plane: so many noises, and what the set may reach beyond.
    pub(crate) fn rounding<S>(&self, plane: &Plane<S>, noises: f64) -> f64 {
        (noises * self.noise.point() + 2.0 * plane.beyond) / self.slope(plane.normal)
    }

    /// How far beyond `s` a feature would be reached.
    fn ahead_to_feature<S, P>(&self, look: &Look<S, P>, s: f64) -> Option<f64> {
        let seen = |k: usize| look.corners[k] - self.unit * s;
        match look.count {
            1 => self.root(seen(0), self.keep),
            2 => {
                let edge = (seen(1) - seen(0)).try_normalize()?;
                let across = |v: DVec3| v - edge * v.dot(edge);
                let (d, a) = (across(self.unit), across(seen(0)));
                let [dd, da, aa] = [d.dot(d), d.dot(a), a.dot(a) - self.keep * self.keep];
                let square = da * da - dd * aa;
                (square >= 0.0 && dd > 0.0).then(|| (da - square.sqrt()) / dd)
            }
            _ => None,
        }
    }
}

/// Looks along the line until the bounds are as near to each other as rounding lets them, beginning with a plane
/// that is not along it; no farther than to a limit.
pub fn travel<T: Target>(
    target: &mut T,
    line: &Line,
    start: Plane<T::Support>,
    limit: f64,
) -> Travel<T> {
    let lower = line.lower(&start).unwrap_or(f64::NEG_INFINITY);
    let mut best = Travel { plane: start, lower, near: None, looks: 0, passes: false };
    let mut course = Course::from(lower);
    for _ in 0..MOST_LOOKS {
        if best.lower >= limit {
            break;
        }
        course.s = course.s.clamp(-line.reach, line.reach);
        let look = target.look(line.unit * course.s);
        best.looks += 1;
        best.note_point(line, &look);
        best.note_plane(line, &look, &mut course);
        if best.passes || best.is_enough(line) || !course.goes_on(line, &best, &look) {
            break;
        }
    }
    best
}

/// Where to look next.
struct Course {
    s: f64,
    /// The last lower bound that was looked at, and whether that was the last look.
    looked: f64,
    of_bound: bool,
    /// How far ahead of it, in noises over `n.d`, the next look may be.
    ahead: f64,
    /// Beyond this all is farther away than the gap, or nothing was looked at.
    end: f64,
}

impl Course {
    fn from(lower: f64) -> Self {
        Self { s: lower, looked: lower, of_bound: true, ahead: AHEAD, end: f64::INFINITY }
    }

    /// Goes on, if there is somewhere to look: every other look is Newton's own.
    fn goes_on<T: Target>(
        &mut self,
        line: &Line,
        best: &Travel<T>,
        look: &Look<T::Support, T::Spot>,
    ) -> bool {
        let upper = best.near.map_or(self.end.min(line.reach), |near| near.upper);
        let feature = line.ahead_to_feature(look, self.s).map(|by| self.s + by);
        let is_new = |next: &f64| *next > best.lower && *next <= upper && *next != self.s;
        if let (true, Some(next)) = (self.of_bound, feature.filter(is_new)) {
            (self.s, self.of_bound) = (next, false);
            return true;
        }
        if best.lower - self.looked > line.rounding(&best.plane, LEAST_STEP) {
            (self.s, self.looked, self.of_bound) = (best.lower, best.lower, true);
            return true;
        }
        // The nearest point is known to a noise: a little ahead it is near enough.
        self.s = best.lower + line.rounding(&best.plane, self.ahead);
        self.of_bound = false;
        self.ahead *= 2.0;
        self.ahead <= 2.0 * MOST_AHEAD
    }
}

impl<T: Target> Travel<T> {
    pub(crate) fn note_point(&mut self, line: &Line, look: &Look<T::Support, T::Spot>) {
        let Some(upper) = line.upper(look.point) else { return };
        if self.near.is_none_or(|near| upper < near.upper) {
            self.near = Some(Near { upper, point: look.point, spot: look.spot });
        }
    }

    fn note_plane(&mut self, line: &Line, look: &Look<T::Support, T::Spot>, course: &mut Course) {
        let Some(plane) = look.plane else { return };
        if let Some(lower) = line.lower(&plane) {
            if lower > self.lower {
                (self.plane, self.lower) = (plane, lower);
                self.passes |= lower > line.reach;
            }
        } else {
            // All that is ahead is farther away than the gap.
            let gap = plane.height - course.s * line.slope(plane.normal);
            if self.near.is_none() && gap > line.keep {
                // From a bound, before which all is farther away as well, none is left; from a guess there may be.
                self.passes |= course.of_bound;
                course.end = course.s;
            }
        }
    }

    fn is_enough(&self, line: &Line) -> bool {
        let gap = self.near.map(|near| near.upper - self.lower);
        gap.is_some_and(|gap| gap <= line.rounding(&self.plane, ENOUGH))
    }
}

/// How far a line passes from a set.
pub struct Shadow<S> {
    /// The best plane along the line.
    pub plane: Plane<S>,
    /// A point of the shadow is no farther from it, but for rounding; 0 if the line passes through.
    pub(crate) distance: f64,
}

/// Descends to the point of the shadow nearest to the line, from a direction to begin with.
pub fn shadow<T: Target>(target: &mut T, line: &Line, toward: DVec3) -> Option<Shadow<T::Support>> {
    let x = line.unit.any_orthonormal_vector();
    let y = line.unit.cross(x);
    let flat = |v: DVec3| DVec2::new(v.dot(x), v.dot(y));
    let mut simplex = Flat::default();
    let mut axis = flat(toward).try_normalize().unwrap_or(DVec2::X);
    let mut best: Option<Shadow<T::Support>> = None;
    for _ in 0..MOST_ROUNDS {
        let normal = (x * axis.x + y * axis.y).normalize_or(x);
        let (plane, lowest) = target.lowest(normal);
        let distance = best.as_ref().map_or(f64::INFINITY, |best| best.distance);
        if best.as_ref().is_none_or(|best| plane.height > best.plane.height) {
            best = Some(Shadow { plane, distance });
        }
        let best = best.as_mut()?;
        let lowest = flat(lowest);
        // No point is nearer than those of the simplex.
        if simplex.count > 0 && axis.dot(lowest) >= distance - line.noise.point() {
            break;
        }
        match simplex.add(lowest) {
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
struct Flat {
    points: [DVec2; 3],
    count: usize,
}

impl Flat {
    /// Adds a point, and drops what the one nearest to the origin does without: the direction to that one, across
    /// an edge where it is on one, and how far it is; `None` if the origin is inside.
    fn add(&mut self, point: DVec2) -> Option<(DVec2, f64)> {
        self.points[self.count] = point;
        self.count += 1;
        let [a, b, c] = self.points;
        match self.count {
            1 => self.keep(Self::on_edge(a, a)),
            2 => self.keep(Self::on_edge(a, b)),
            _ => {
                let area = (b - a).perp_dot(c - a);
                let inside = |p: DVec2, q: DVec2| p.perp_dot(q) * area >= 0.0;
                if area != 0.0 && inside(a, b) && inside(b, c) && inside(c, a) {
                    return None;
                }
                // The last one is of the nearest edge.
                let [one, other] = [Self::on_edge(a, c), Self::on_edge(b, c)];
                let nearer =
                    if one.2.length_squared() <= other.2.length_squared() { one } else { other };
                self.keep(nearer)
            }
        }
    }

    fn keep(&mut self, (points, count, at): ([DVec2; 2], usize, DVec2)) -> Option<(DVec2, f64)> {
        let [a, b] = points;
        (self.points, self.count) = ([a, b, DVec2::ZERO], count);
        let across = if count == 2 { (b - a).perp() } else { at };
        let axis = across.try_normalize()?;
        let axis = if axis.dot(a) < 0.0 { -axis } else { axis };
        let distance = if count == 2 { axis.dot(a) } else { at.length() };
        Some((axis, distance))
    }

    /// The point of a segment nearest to the origin, and the ends that it needs.
    fn on_edge(a: DVec2, b: DVec2) -> ([DVec2; 2], usize, DVec2) {
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
