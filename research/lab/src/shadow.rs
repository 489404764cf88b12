//! Shadows: projections of bodies along a direction, and their distance in the plane.
//!
//! - The plane perpendicular to the direction has coordinates along two unit vectors.
//! - `C = {b - a}` is the Minkowski difference of the shadows of the fixed and the moving body: a convex
//!   polygon.
//! - If the fixed body is displaced by `s u`, the distance of the shadows is that of the point `-s u` from
//!   `C`. It is the least distance of the bodies during the whole motion.
//!
//! Invariant: polygons are counter-clockwise, without repeated corners. The points at a distance `gap > 0`
//! from `C` form edges of `C` displaced outwards and arcs about its corners. A ray from inside `C` crosses
//! exactly one of them.

use colltrans::ConvexPolyhedron;
use glam::{DQuat, DVec2, DVec3};

/// A convex polygon, counter-clockwise.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Shadow(Vec<DVec2>);

impl Shadow {
    /// Computes the shadow of a body rotated about the origin, in the plane of two orthogonal unit vectors.
    pub(crate) fn of(body: &ConvexPolyhedron, turn: DQuat, plane: [DVec3; 2]) -> Self {
        let [e, f] = plane.map(|axis| turn.inverse() * axis);
        let at = |vertex: u32| {
            let v = body.vertices()[vertex as usize];
            DVec2::new(e.dot(v), f.dot(v))
        };
        let heights = body.vertices().iter().map(|v| f.dot(*v));
        let lowest = (0..).zip(heights).min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(v, _)| v);
        let mut rim = Vec::new();
        let mut vertex = lowest;
        for _ in body.vertices() {
            let here = at(vertex);
            rim.push(here);
            // Edges of the silhouette are edges of the body. The next one has all neighbours on its left.
            let mut next = (vertex, DVec2::ZERO);
            for &neighbour in body.neighbours(vertex) {
                let way = at(neighbour) - here;
                let turn = way.perp_dot(next.1);
                if turn > 0.0 || turn == 0.0 && way.length_squared() > next.1.length_squared() {
                    next = (neighbour, way);
                }
            }
            vertex = next.0;
            if vertex == lowest {
                break;
            }
        }
        Self::hull(rim)
    }

    /// Returns the shadow displaced by a vector.
    pub(crate) fn displaced(mut self, by: DVec2) -> Self {
        for corner in &mut self.0 {
            *corner += by;
        }
        self
    }

    /// Computes the hull of points (Andrew's monotone chain).
    fn hull(mut points: Vec<DVec2>) -> Self {
        points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
        points.dedup();
        let mut corners = half_hull(points.iter());
        corners.pop();
        corners.extend(half_hull(points.iter().rev()));
        corners.pop();
        Self(corners)
    }

    /// Returns `{b - a}` for points `a` of this polygon and `b` of the other, by merging the edges of both in
    /// the order of their directions.
    pub(crate) fn differences(&self, other: &Self) -> Self {
        let negated: Vec<DVec2> = self.0.iter().map(|corner| -*corner).collect();
        let [a, b] = [lowest_first(&negated), lowest_first(&other.0)];
        let (mut i, mut j) = (0, 0);
        let mut corners = Vec::with_capacity(a.len() + b.len());
        while i < a.len() || j < b.len() {
            corners.push(a[i % a.len()] + b[j % b.len()]);
            let [p, q] = [(&a, i), (&b, j)]
                .map(|(polygon, k)| polygon[(k + 1) % polygon.len()] - polygon[k % polygon.len()]);
            let turn = p.perp_dot(q);
            let (first, second) = (j >= b.len() || turn >= 0.0, i >= a.len() || turn <= 0.0);
            i += usize::from(first && i < a.len());
            j += usize::from(second && j < b.len());
        }
        Self(corners)
    }

    /// Returns the distance from the origin, which is inside this polygon, at which a ray along the unit
    /// vector `way` is at distance `gap` from the polygon.
    pub(crate) fn ray_to_distance(&self, way: DVec2, gap: f64) -> f64 {
        let next = self.0.iter().cycle().skip(1);
        let mut farthest: f64 = 0.0;
        for (&from, &to) in self.0.iter().zip(next) {
            // On the arc about the corner, `|s way - from| = gap`.
            let along = way.dot(from);
            let root = along * along - from.length_squared() + gap * gap;
            if root >= 0.0 {
                farthest = farthest.max(along + root.sqrt());
            }
            let edge = to - from;
            let outwards = DVec2::new(edge.y, -edge.x).normalize_or_zero();
            let rate = outwards.dot(way);
            let s = (outwards.dot(from) + gap) / rate;
            let place = edge.dot(way * s - from);
            if rate > 0.0 && (0.0..=edge.length_squared()).contains(&place) {
                farthest = farthest.max(s);
            }
        }
        farthest
    }
}

/// Returns the chain from the first to the last of sorted points that only turns left.
fn half_hull<'p>(points: impl Iterator<Item = &'p DVec2>) -> Vec<DVec2> {
    let mut corners: Vec<DVec2> = Vec::new();
    for &point in points {
        while let [.., a, b] = corners[..]
            && (b - a).perp_dot(point - b) <= 0.0
        {
            corners.pop();
        }
        corners.push(point);
    }
    corners
}

/// Returns the polygon rotated to start at its lowest corner, the leftmost one of several.
fn lowest_first(polygon: &[DVec2]) -> Vec<DVec2> {
    let lowest = (0..polygon.len()).min_by(|&i, &j| {
        let (a, b) = (polygon[i], polygon[j]);
        a.y.total_cmp(&b.y).then(a.x.total_cmp(&b.x))
    });
    let mut polygon = polygon.to_vec();
    polygon.rotate_left(lowest.unwrap_or(0));
    polygon
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{Kind, bodies};
    use colltrans_testkit::random::Random;

    fn to_segment(point: DVec2, from: DVec2, to: DVec2) -> f64 {
        let edge = to - from;
        let share = ((point - from).dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
        point.distance(from + edge * share)
    }

    /// Computes the distance of disjoint polygons from all pairs of corners and edges.
    fn distance(a: &[DVec2], b: &[DVec2]) -> f64 {
        let one_way = |points: &[DVec2], edges: &[DVec2]| {
            let mut least = f64::INFINITY;
            for point in points {
                for k in 0..edges.len() {
                    let to = edges[(k + 1) % edges.len()];
                    least = least.min(to_segment(*point, edges[k], to));
                }
            }
            least
        };
        one_way(a, b).min(one_way(b, a))
    }

    /// The silhouette is the hull of all projected vertices: it is convex and contains them.
    #[test]
    fn shadow_is_hull_of_projected_vertices() {
        let mut random = Random::new(3);
        for kind in [Kind::Balanced, Kind::Thin, Kind::Prism, Kind::HalfEllipsoid, Kind::RandomHull]
        {
            let bodies = bodies(3, kind, 200, 0);
            for _ in 0..20 {
                let (turn, along) = (random.rotation(), random.direction());
                let e = along.any_orthonormal_vector();
                let plane = [e, along.cross(e)];
                let Shadow(corners) = Shadow::of(&bodies.pair[0], turn, plane);
                for k in 0..corners.len() {
                    let (from, to) = (corners[k], corners[(k + 1) % corners.len()]);
                    for v in bodies.pair[0].vertices() {
                        let point = DVec2::from_array(plane.map(|axis| axis.dot(turn * *v)));
                        let off = (to - from).perp_dot(point - from) / (to - from).length();
                        assert!(off > -1e-12, "{kind:?}: {off:e}");
                    }
                }
            }
        }
    }

    /// The distance of the displaced shadows is the requested one, by brute force.
    #[test]
    fn displaced_shadows_have_requested_distance() {
        let mut random = Random::new(4);
        for kind in [Kind::Balanced, Kind::Thin, Kind::Prism, Kind::RandomHull] {
            let bodies = bodies(4, kind, 200, 0);
            for case in 0..40 {
                let along = random.direction();
                let e = along.any_orthonormal_vector();
                let plane = [e, along.cross(e)];
                let [p, q] = [0, 1].map(|k| Shadow::of(&bodies.pair[k], random.rotation(), plane));
                let gap = [1e-6, 0.01, 0.1, 3.0][case % 4];
                let way = DVec2::from_angle(random.range(0.0, 6.0));
                let s = p.differences(&q).ray_to_distance(-way, gap);
                let moved: Vec<_> = q.0.iter().map(|corner| *corner + way * s).collect();
                let found = distance(&p.0, &moved);
                assert!((found - gap).abs() < 1e-11, "{kind:?}: {found:e} for {gap:e}");
            }
        }
    }

    /// Parallel edges, as of boxes.
    #[test]
    fn difference_of_squares_merges_parallel_edges() {
        let square = |side: f64| {
            let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.0]];
            Shadow::hull(corners.map(|c| (DVec2::from(c) - 0.5) * side).to_vec())
        };
        let difference = square(2.0).differences(&square(4.0));
        assert_eq!(difference, Shadow(difference.0.clone()));
        assert_eq!(difference.0.len(), 4);
        assert_eq!(difference.ray_to_distance(DVec2::X, 0.5), 3.5);
        let diagonal = difference.ray_to_distance(DVec2::ONE.normalize(), 1.0);
        assert!((diagonal - (3.0 * 2.0_f64.sqrt() + 1.0)).abs() < 1e-12);
    }
}
