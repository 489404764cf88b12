//! Positions along a first move at which a second move is possible.
//!
//! `A` is displaced by `s` and moves along `d` by the length `t`, then along `e` by the length `far`. Facets `f`
//! of `A` and `g` of `B` with `n_f.e > 0 > n_g.e` block the second move if `t d + tau e` is inside the convex set
//! `g - f - s` for a `tau` between 0 and `far`. The plane of `d` and `e` cuts this set in a polygon with
//! coordinates `(t, tau)`. The projection of its part between `tau = 0` and `tau = far` is an **open interval of
//! `t`**. The complement of all intervals is closed. It consists of the openings, which may be single values.
//!
//! - The interval of two facets is not clipped to the range of `t`, because its clipped end would be an opening.
//! - The box of differences of two nodes is sliced in the same way. A pair of nodes is dismissed if one blocked
//!   interval covers its interval.
//! - Of the pairs of children of a pair of nodes, the one with the widest interval is visited first.

use glam::DVec3;

use crate::directions::{Bodies, NodeBounds};
use colltrans_convex::body::Aabb;

/// Open interval.
type Interval = [f64; 2];

/// Query about two bodies.
pub(super) struct OpeningQuery {
    /// Displacement of the moving body against the other one.
    pub(super) from: DVec3,
    /// First and second direction, of length 1 and not parallel.
    pub(super) along: [DVec3; 2],
    /// Length of the first move.
    pub(super) end: f64,
    /// Length of the second move.
    pub(super) far: f64,
    /// Whether each body has open shells, whose facets block from both sides.
    pub(super) two_sided: [bool; 2],
}

impl OpeningQuery {
    /// Returns the values of `t` at which the second move is blocked, as sorted disjoint open intervals. Adds
    /// the number of node visits to `visits`.
    pub(super) fn blocked_intervals(&self, bodies: &Bodies, visits: &mut u64) -> Vec<Interval> {
        let mut blocked = Vec::new();
        let mut stack = vec![([0_u32, 0], [0.0, self.end])];
        while let Some((pair, span)) = stack.pop() {
            if is_covered(&blocked, span) {
                continue;
            }
            let [a, b] = [0, 1].map(|k| &bodies.nodes[k][pair[k] as usize]);
            if a.is_facet() && b.is_facet() {
                if let Some(span) = self.facet_interval(bodies, pair) {
                    insert_interval(&mut blocked, span);
                }
                continue;
            }
            let first =
                b.is_facet() || (!a.is_facet() && a.squared_diagonal() >= b.squared_diagonal());
            let parts = if first { a.children() } else { b.children() };
            let pairs = parts.map(|k| if first { [k, pair[1]] } else { [pair[0], k] });
            let mut found: Vec<([u32; 2], Interval)> = Vec::new();
            for pair in pairs {
                *visits += 1;
                let nodes = [0, 1].map(|k| &bodies.nodes[k][pair[k] as usize]);
                found.extend(self.node_interval(nodes).map(|span| (pair, span)));
            }
            found.sort_by(|x, y| (x.1[1] - x.1[0]).total_cmp(&(y.1[1] - y.1[0])));
            stack.append(&mut found);
        }
        blocked
    }

    /// Returns an interval that contains those of all facets of two nodes, clipped to the range.
    fn node_interval(&self, [a, b]: [&NodeBounds; 2]) -> Option<Interval> {
        let [_, e] = self.along;
        let looks_away = |axis: DVec3, spread: f64| spread < 1.0 && axis.dot(e) <= -spread;
        let [own, other] = self.two_sided;
        if !own && looks_away(a.axis, a.spread) || !other && looks_away(-b.axis, b.spread) {
            return None;
        }
        self.difference_interval(b.low - a.high - self.from, b.high - a.low - self.from)
    }

    /// Returns an interval that contains those of all facets in two boxes, clipped to the range.
    pub(super) fn box_interval(&self, [a, b]: [&Aabb; 2]) -> Option<Interval> {
        self.difference_interval(b.low - a.high - self.from, b.high - a.low - self.from)
    }

    /// Returns the interval of a box of differences, clipped to the range.
    fn difference_interval(&self, low: DVec3, high: DVec3) -> Option<Interval> {
        let [d, e] = self.along;
        let mut range = Range { low: 0.0, high: self.end };
        // Lower and upper bounds of `tau`, each as its value at 0 and its slope.
        let (mut floors, mut roofs) = ([[0.0; 2]; 4], [[0.0; 2]; 4]);
        roofs[0] = [self.far, 0.0];
        let mut count = 1;
        for k in 0..3 {
            if e[k] == 0.0 {
                range.restrict_to([high[k], -d[k]]);
                range.restrict_to([-low[k], d[k]]);
                continue;
            }
            let (share, slope) = (e[k].recip(), -d[k] / e[k]);
            let (x, y) = (low[k] * share, high[k] * share);
            floors[count] = [x.min(y), slope];
            roofs[count] = [x.max(y), slope];
            count += 1;
        }
        for (i, floor) in floors[..count].iter().enumerate() {
            for (j, roof) in roofs[..count].iter().enumerate() {
                if i != j {
                    range.restrict_to([roof[0] - floor[0], roof[1] - floor[1]]);
                }
            }
        }
        (range.low <= range.high).then_some([range.low, range.high])
    }

    /// Returns the interval of two facets. Returns `None` if it does not meet the range.
    fn facet_interval(&self, bodies: &Bodies, pair: [u32; 2]) -> Option<Interval> {
        let [d, e] = self.along;
        let normal = |k: usize| bodies.nodes[k][pair[k] as usize].axis;
        let facing = [normal(0).dot(e), -normal(1).dot(e)];
        let blocks = |k: usize| {
            let sine = if self.two_sided[k] { facing[k].abs() } else { facing[k] };
            sine > MIN_FACING
        };
        if !(blocks(0) && blocks(1)) {
            return None;
        }
        let corners = [true, false].map(|moving| {
            let triangle = bodies.leaf_triangle(moving, pair[usize::from(!moving)]);
            bodies.triangle_vertices(moving, triangle).map(|vertex| bodies.placed_vertex(vertex).at)
        });
        let across = d.cross(e);
        let scale = across.length_squared().recip();
        // Differences: their height above the plane of both directions, and their coordinates in it.
        let mut differences = [(0.0, [0.0; 2]); 9];
        for (k, difference) in differences.iter_mut().enumerate() {
            let v = corners[1][k % 3] - corners[0][k / 3] - self.from;
            let place = [v.cross(e).dot(across) * scale, d.cross(v).dot(across) * scale];
            *difference = (across.dot(v), place);
        }
        let span = projected_range(&slice_points(&differences), self.far)?;
        (span[1] > 0.0 && span[0] < self.end).then_some(span)
    }
}

/// Sine of the angle between a direction and a facet below which the facet does not block.
const MIN_FACING: f64 = 1e-12;

/// Returns points whose hull is the slice at height 0. The result is empty if all differences are on one
/// side.
fn slice_points(differences: &[(f64, [f64; 2]); 9]) -> Vec<[f64; 2]> {
    let mut points = Vec::with_capacity(20);
    if !differences.iter().any(|x| x.0 > 0.0) {
        return points;
    }
    for (h, p) in differences.iter().filter(|x| x.0 < 0.0) {
        for (i, q) in differences.iter().filter(|x| x.0 >= 0.0) {
            let share = h / (h - i);
            points.push([0, 1].map(|k| p[k] + share * (q[k] - p[k])));
        }
    }
    points
}

/// Returns the range of the first coordinate over the part of a hull whose second coordinate is between 0 and
/// `far`.
fn projected_range(points: &[[f64; 2]], far: f64) -> Option<Interval> {
    let mut span = [f64::INFINITY, f64::NEG_INFINITY];
    let mut put = |t: f64| span = [span[0].min(t), span[1].max(t)];
    for p in points {
        if p[1] > 0.0 && p[1] < far {
            put(p[0]);
        }
        for q in points {
            for limit in [0.0, far] {
                if p[1] < limit && q[1] > limit {
                    put(p[0] + (limit - p[1]) / (q[1] - p[1]) * (q[0] - p[0]));
                }
            }
        }
    }
    (span[0] < span[1]).then_some(span)
}

/// Range of `t`. It is empty if the lower end is above the upper one.
struct Range {
    low: f64,
    high: f64,
}

impl Range {
    /// Restricts the range to where a linear function, given by its value at 0 and its slope, is not
    /// negative.
    fn restrict_to(&mut self, [value, slope]: [f64; 2]) {
        let (at_low, at_high) = (value + slope * self.low, value + slope * self.high);
        match (at_low >= 0.0, at_high >= 0.0) {
            (true, true) => (),
            (true, false) => self.high = self.high.min(self.low.max(value / -slope)),
            (false, true) => self.low = self.low.max(self.high.min(value / -slope)),
            (false, false) => self.high = f64::NEG_INFINITY,
        }
    }
}

fn is_covered(set: &[Interval], span: Interval) -> bool {
    set.iter().any(|s| s[0] <= span[0] && span[1] <= s[1])
}

/// Inserts an open interval into a set of disjoint ones, and joins those that overlap. Intervals that only
/// touch remain separate, because the point between them is an opening.
pub(super) fn insert_interval(set: &mut Vec<Interval>, mut span: Interval) {
    set.retain(|s| {
        let apart = s[1] <= span[0] || span[1] <= s[0];
        if !apart {
            span = [span[0].min(s[0]), span[1].max(s[1])];
        }
        apart
    });
    let at = set.partition_point(|s| s[0] < span[0]);
    set.insert(at, span);
}

/// Returns the complement of blocked intervals in `[0, end]`.
pub(super) fn complement(blocked: &[Interval], end: f64) -> Vec<Interval> {
    let (mut open, mut at) = (Vec::new(), 0.0_f64);
    for &[low, high] in blocked {
        if low >= at {
            open.push([at, low.min(end)]);
        }
        at = at.max(high);
    }
    if at <= end {
        open.push([at, end]);
    }
    open
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn point_between_touching_intervals_is_open() {
        let mut set = Vec::new();
        for span in [[3.0, 5.0], [0.0, 1.0], [1.0, 2.0], [4.0, 9.0]] {
            insert_interval(&mut set, span);
        }
        assert_eq!(set, [[0.0, 1.0], [1.0, 2.0], [3.0, 9.0]]);
        assert_eq!(complement(&set, 7.0), [[0.0, 0.0], [1.0, 1.0], [2.0, 3.0]]);
    }

    #[test]
    fn difference_interval_matches_sampled_slice() {
        let query = |along: [DVec3; 2], end: f64, far: f64| OpeningQuery {
            from: DVec3::ZERO,
            along,
            end,
            far,
            two_sided: [false; 2],
        };
        let of = |query: &OpeningQuery, low: [f64; 3], high: [f64; 3]| {
            query.difference_interval(DVec3::from(low), DVec3::from(high))
        };
        let across = query([DVec3::X, DVec3::Z], 4.0, 4.0);
        assert_eq!(of(&across, [0.5, -1.0, 1.0], [2.0, 1.0, 9.0]), Some([0.5, 2.0]));
        // To the side, beyond the second move, before the first one.
        assert_eq!(of(&across, [0.5, 1.0, 1.0], [2.0, 2.0, 9.0]), None);
        assert_eq!(of(&across, [0.5, -1.0, 5.0], [2.0, 1.0, 9.0]), None);
        assert_eq!(of(&across, [-2.0, -1.0, 1.0], [-1.0, 1.0, 9.0]), None);
        // A sample of the slice confirms that the range is neither wider nor narrower.
        let mut random = colltrans_testkit::random::Random::new(3);
        let (mut met, mut missed) = (0, 0);
        for _ in 0..300 {
            let [a, b] = [random.direction(), random.direction()];
            let query = query([a, b], 2.0, 1.5);
            let (middle, half) = (1.5 * random.direction(), 0.6 * random.direction().abs());
            let (low, high) = (middle - half, middle + half);
            let places = (0..=400).flat_map(|i| (0..=300).map(move |j| (i, j)));
            let mut seen = [f64::INFINITY, f64::NEG_INFINITY];
            for (i, j) in places {
                let (t, tau) = (f64::from(i) / 200.0, f64::from(j) / 200.0);
                let at = a * t + b * tau;
                if at.cmpge(low).all() && at.cmple(high).all() {
                    seen = [seen[0].min(t), seen[1].max(t)];
                }
            }
            match query.difference_interval(low, high) {
                Some([from, to]) if seen[0] <= seen[1] => {
                    met += 1;
                    assert!(from <= seen[0] + 1e-12 && to >= seen[1] - 1e-12);
                    assert!(from >= seen[0] - 0.2 && to <= seen[1] + 0.2, "{from} {to} {seen:?}");
                }
                found => {
                    missed += 1;
                    assert!(seen[0] > seen[1], "{found:?} {seen:?}");
                }
            }
        }
        assert!(met > 20 && missed > 50, "{met} {missed}");
    }
}
