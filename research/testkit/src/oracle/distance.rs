//! Computes the exact distance of two convex bodies, with its proof.
//!
//! Notation. `P` is the moving body, `Q` the fixed one, both the convex hulls of their vertices. `M = {q - p}`,
//! and `v` is the point of `M` nearest to the origin. The distance is `|v|`. A point `v` is the nearest one if
//! and only if
//!
//! - `v = sum w_i m_i` with `w_i >= 0`, `sum w_i = 1` and differences of vertices `m_i` (`v` is in `M`),
//! - `v . m >= v . v` for all differences of vertices `m` (no point is nearer).
//!
//! [`distance`] uses the algorithm of Wolfe ("Finding the nearest point in a polytope", Mathematical
//! Programming 11, 1976). While some `m` violates the second condition, the lowest such `m` is added to the
//! simplex, whose nearest point is found by trying all its faces. `|v|` decreases strictly, so the algorithm
//! terminates. The same search in `f64` guesses the first simplex; the result does not depend on it, because both
//! conditions are checked exactly. All numbers are exact, so the result satisfies both conditions exactly. Only
//! vertices are used, no faces or edges. Divisions are avoided by `v = V / D` with `D > 0`, both dyadic.
//!
//! [`brute_force`] is independent: it compares all pairs of vertices and triangles, and of edges, in `f64`.

use std::mem;

use colltrans::{ConvexPolyhedron, Pose};
use glam::DVec3;

use crate::oracle::exact::{Dyadic, Ratio, Vector, place};

/// The distance of two bodies and the shortest vector between them.
#[derive(Debug, Clone)]
pub struct Distance {
    /// The squared distance, in squared world units; 0 if and only if the bodies meet.
    pub square: Ratio,
    /// The shortest vector from the moving body to the fixed one, which is unique, rounded.
    pub shortest: DVec3,
}

impl Distance {
    /// Checks whether the bodies have a common point, exactly.
    pub fn intersects(&self) -> bool {
        self.square.is_zero()
    }

    /// Returns the nearest `f64`, up to a few rounding errors. It is 0 only if the bodies meet or the distance
    /// is below the range of `f64`.
    pub fn to_f64(&self) -> f64 {
        self.square.sqrt_to_f64()
    }
}

/// Returns the exact distance of two placed bodies of any dimension.
///
/// The position of a body is defined by the nine entries of its rotation matrix and by its translation, as
/// exact numbers. A step takes `O(n)` long products, which is feasible for thousands of vertices.
pub fn distance_of_bodies(
    (moving, moving_pose): (&ConvexPolyhedron, &Pose),
    (fixed, fixed_pose): (&ConvexPolyhedron, &Pose),
) -> Distance {
    let put = |body: &ConvexPolyhedron, pose: &Pose| {
        place(pose.matrix(), pose.translation(), body.vertices())
    };
    distance(&put(moving, moving_pose), &put(fixed, fixed_pose))
}

/// Returns the exact distance of a point in the world from a placed body.
pub fn distance_of_point(point: DVec3, (body, pose): (&ConvexPolyhedron, &Pose)) -> Distance {
    distance(&[Vector::new(point)], &place(pose.matrix(), pose.translation(), body.vertices()))
}

/// Returns the exact distance of the convex hulls of two sets of points.
///
/// # Panics
/// If a set is empty.
pub fn distance(moving: &[Vector], fixed: &[Vector]) -> Distance {
    let rounded = Rounded::new([moving, fixed]);
    let mut simplex = rounded.guess_simplex([moving, fixed]);
    // The nearest point of the guessed simplex is in its interior, unless the guess is wrong.
    let mut nearest = nearest_inside(&simplex);
    loop {
        let (point, face) = match nearest.take() {
            Some(point) => (point, mem::take(&mut simplex)),
            None => nearest_of_simplex(&simplex),
        };
        let square = point.square_of_numerator();
        if square.is_zero() {
            return point.into_distance();
        }
        let [farthest, lowest] = rounded.extremes([moving, fixed], &point.numerator);
        let lowest = lowest.minus(farthest);
        if &point.numerator.dot(&lowest) * &point.denominator >= square {
            return point.into_distance();
        }
        simplex = face;
        simplex.push(lowest);
    }
}

/// Returns `min_Q n.q - max_P n.p`, exactly.
///
/// # Panics
/// If a set is empty.
pub fn gap_along([moving, fixed]: [&[Vector]; 2], n: &Vector) -> Dyadic {
    let [farthest, lowest] = Rounded::new([moving, fixed]).extremes([moving, fixed], n);
    n.dot(&lowest.minus(farthest))
}

/// The points of two bodies as `f64`, in units of a power of two in which the largest coordinate is between 1/2 and
/// 1. Each coordinate has an error below `2^-50`.
struct Rounded {
    moving: Vec<DVec3>,
    fixed: Vec<DVec3>,
}

impl Rounded {
    /// Upper bound on the error of a scalar product of a rounded point and a rounded direction, whose coordinates
    /// are at most 1: three products of factors with errors of `2^-50`, and five roundings of sums of at most 3.
    const ERROR: f64 = 1.0 / (1_u64 << 46) as f64;

    /// Rounds the points of two bodies.
    fn new([moving, fixed]: [&[Vector]; 2]) -> Self {
        let exponent = largest_exponent(moving.iter().chain(fixed));
        let round = |points: &[Vector]| points.iter().map(|p| round(p, exponent)).collect();
        Self { moving: round(moving), fixed: round(fixed) }
    }

    /// Returns the point of the moving body with the greatest exact scalar product with `direction`, and that of the
    /// fixed body with the least one. Only points whose rounded products may be the extreme ones are compared exactly.
    fn extremes<'a>(
        &self,
        [moving, fixed]: [&'a [Vector]; 2],
        direction: &Vector,
    ) -> [&'a Vector; 2] {
        let along = round(direction, largest_exponent([direction]));
        [(&self.moving, moving, 1.0), (&self.fixed, fixed, -1.0)].map(|(rounded, exact, sign)| {
            let along = along * sign;
            let most = rounded.iter().map(|p| along.dot(*p)).fold(f64::NEG_INFINITY, f64::max);
            let candidates: Vec<&Vector> = rounded
                .iter()
                .zip(exact)
                .filter(|(p, _)| along.dot(**p) >= most - 2.0 * Self::ERROR)
                .map(|(_, p)| p)
                .collect();
            match candidates[..] {
                [] => panic!("a body has a point"),
                [only] => only,
                _ => {
                    let signed = direction.times(&Dyadic::new(sign));
                    candidates.into_iter().max_by_key(|p| signed.dot(p)).expect("not empty")
                }
            }
        })
    }

    /// Returns the simplex with which the search in `f64` ends, or another one if rounding misleads that search.
    fn guess_simplex(&self, [moving, fixed]: [&[Vector]; 2]) -> Vec<Vector> {
        let difference = |pair: &[usize; 2]| self.fixed[pair[1]] - self.moving[pair[0]];
        let mut simplex = vec![[0, 0]];
        let mut least = f64::INFINITY;
        for _ in 0..MAX_GUESSES {
            let corners: Vec<DVec3> = simplex.iter().map(difference).collect();
            let (nearest, face) = guess_nearest(&corners);
            simplex =
                (0..simplex.len()).filter(|i| face >> i & 1 == 1).map(|i| simplex[i]).collect();
            let square = nearest.length_squared();
            if simplex.len() == 4 || square >= least {
                break;
            }
            least = square;
            let index = |points: &[DVec3], along: DVec3| {
                let value = |i: &usize| along.dot(points[*i]);
                (0..points.len()).max_by(|i, j| value(i).total_cmp(&value(j))).unwrap_or(0)
            };
            let lowest = [index(&self.moving, nearest), index(&self.fixed, -nearest)];
            if simplex.contains(&lowest) || nearest.dot(difference(&lowest)) >= square {
                break;
            }
            simplex.push(lowest);
        }
        simplex.iter().map(|[i, j]| fixed[*j].minus(&moving[*i])).collect()
    }
}

/// Maximum number of steps of the search in `f64`.
const MAX_GUESSES: usize = 64;

/// Returns the point of a simplex of up to four corners nearest to the origin, and the face that has it as a set of
/// bits, up to rounding.
fn guess_nearest(corners: &[DVec3]) -> (DVec3, usize) {
    let mut best = (corners[0], 1);
    for face in 1..1_usize << corners.len() {
        let chosen = (0..corners.len()).filter(|i| face >> i & 1 == 1).map(|i| corners[i]);
        let inside = guess_inside(&chosen.collect::<Vec<_>>());
        if let Some(point) = inside.filter(|p| p.length_squared() < best.0.length_squared()) {
            best = (point, face);
        }
    }
    best
}

/// Returns the point nearest to the origin on what the corners span, if it is in the interior of their hull, up to
/// rounding.
fn guess_inside(corners: &[DVec3]) -> Option<DVec3> {
    match *corners {
        [a] => Some(a),
        [a, b] => {
            let edge = b - a;
            let share = -a.dot(edge) / edge.length_squared();
            (share > 0.0 && share < 1.0).then(|| a + edge * share)
        }
        [a, b, c] => {
            let normal = (b - a).cross(c - a);
            let inside =
                [(a, b), (b, c), (c, a)].iter().all(|(p, q)| p.cross(*q).dot(normal) > 0.0);
            inside.then(|| normal * (normal.dot(a) / normal.length_squared()))
        }
        [a, b, c, d] => {
            let whole = (b - a).cross(c - a).dot(d - a);
            let parts =
                [(b, d, c), (a, c, d), (a, d, b), (a, b, c)].map(|(p, q, r)| p.cross(q).dot(r));
            parts.iter().all(|part| part * whole > 0.0).then_some(DVec3::ZERO)
        }
        _ => None,
    }
}

/// Returns the least `e` for which all coordinates are below `2^e`.
fn largest_exponent<'a>(points: impl IntoIterator<Item = &'a Vector>) -> i32 {
    let coordinates = points.into_iter().flat_map(|p| &p.0);
    coordinates.filter_map(Dyadic::log2).max().unwrap_or(0)
}

/// Rounds a vector whose coordinates are below `2^exponent`, in units of `2^exponent`.
fn round(v: &Vector, exponent: i32) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|i| v.0[i].to_f64_in_units_of(exponent)))
}

/// A point `numerator / denominator` with a positive denominator.
#[derive(Debug, Clone)]
struct Fraction {
    numerator: Vector,
    denominator: Dyadic,
}

impl Fraction {
    /// Returns the squared length of the numerator.
    fn square_of_numerator(&self) -> Dyadic {
        self.numerator.dot(&self.numerator)
    }

    /// Returns the squared length.
    fn square(&self) -> Ratio {
        Ratio::new(self.square_of_numerator(), &self.denominator * &self.denominator)
    }

    /// Converts to a distance.
    fn into_distance(self) -> Distance {
        let coordinate = |x: Dyadic| Ratio::new(x, self.denominator.clone()).to_f64();
        Distance {
            square: self.square(),
            shortest: DVec3::from_array(self.numerator.0.clone().map(coordinate)),
        }
    }
}

/// Returns the point of a simplex of up to four corners nearest to the origin, and the corners of the face that
/// has it in its interior.
fn nearest_of_simplex(corners: &[Vector]) -> (Fraction, Vec<Vector>) {
    let faces = (1..1_usize << corners.len()).map(|face| {
        let chosen = corners.iter().enumerate().filter(move |(i, _)| face >> i & 1 == 1);
        chosen.map(|(_, corner)| corner.clone()).collect::<Vec<_>>()
    });
    let (_, nearest, face) = faces
        .filter_map(|face| Some((nearest_inside(&face)?, face)))
        .map(|(point, face)| (point.square(), point, face))
        .min_by(|a, b| a.0.cmp(&b.0))
        .expect("every corner is a face");
    (nearest, face)
}

/// Returns the point nearest to the origin on the plane, line or point that the corners span, if it is in the
/// interior of their hull. Solves `G w = b` by Cramer's rule with `G_ij = e_i . e_j`, `b_i = -e_i . a_0`, `e_i
/// = a_i - a_0`. `None` also if the corners are dependent, because then a face has the same nearest point.
fn nearest_inside(corners: &[Vector]) -> Option<Fraction> {
    let (first, rest) = corners.split_first().expect("no empty face");
    let edges: Vec<Vector> = rest.iter().map(|a| a.minus(first)).collect();
    let gram: Vec<Vec<Dyadic>> =
        edges.iter().map(|e| edges.iter().map(|f| e.dot(f)).collect()).collect();
    let right_side: Vec<Dyadic> = edges.iter().map(|e| -e.dot(first)).collect();
    let whole = determinant(&gram);
    if whole.is_zero() {
        return None;
    }
    let weights: Vec<Dyadic> = (0..edges.len())
        .map(|i| {
            // G is symmetric, so rows may replace columns.
            let mut replaced = gram.clone();
            replaced[i].clone_from(&right_side);
            determinant(&replaced)
        })
        .collect();
    let first_weight = weights.iter().fold(whole.clone(), |rest, w| &rest - w);
    if !(first_weight.is_positive() && weights.iter().all(Dyadic::is_positive)) {
        return None;
    }
    let numerator = edges
        .iter()
        .zip(&weights)
        .fold(first.times(&whole), |sum, (edge, weight)| sum.plus(&edge.times(weight)));
    Some(Fraction { numerator, denominator: whole })
}

/// Returns the determinant of a matrix of up to three rows, expanded along the first row.
fn determinant(rows: &[Vec<Dyadic>]) -> Dyadic {
    let Some((first, others)) = rows.split_first() else { return Dyadic::new(1.0) };
    let mut sum = Dyadic::ZERO;
    for (i, entry) in first.iter().enumerate() {
        let without = |row: &Vec<Dyadic>| {
            let kept = row.iter().enumerate().filter(|(j, _)| *j != i);
            kept.map(|(_, x)| x.clone()).collect()
        };
        let minor: Vec<Vec<Dyadic>> = others.iter().map(without).collect();
        let term = entry * &determinant(&minor);
        sum = if i % 2 == 0 { &sum + &term } else { &sum - &term };
    }
    sum
}

/// Returns the distance of the *surfaces* of two placed bodies, up to rounding errors of some `1e-15` of the
/// size. Compares all vertices with all triangles, and all edges with all edges.
///
/// For disjoint bodies it is their distance. For overlapping bodies it is meaningless.
pub fn brute_force(
    (moving, moving_pose): (&ConvexPolyhedron, &Pose),
    (fixed, fixed_pose): (&ConvexPolyhedron, &Pose),
) -> f64 {
    // Coordinates are relative to the origin of the fixed body, so that a common displacement does not reduce
    // accuracy.
    let offset = moving_pose.translation() - fixed_pose.translation();
    let moving = Soup::new(moving, |v| moving_pose.transform_vector(v) + offset);
    let fixed = Soup::new(fixed, |v| fixed_pose.transform_vector(v));
    let one_way = |points: &[DVec3], triangles: &[[DVec3; 3]]| {
        points
            .iter()
            .flat_map(|&p| triangles.iter().map(move |t| point_to_triangle(p, *t)))
            .fold(f64::INFINITY, f64::min)
    };
    let edges = moving
        .edges
        .iter()
        .flat_map(|&e| fixed.edges.iter().map(move |&f| segment_to_segment(e, f)))
        .fold(f64::INFINITY, f64::min);
    edges
        .min(one_way(&moving.points, &fixed.triangles))
        .min(one_way(&fixed.points, &moving.triangles))
}

/// A body as vertices, edges and triangles. A point also counts as an edge of length 0.
struct Soup {
    points: Vec<DVec3>,
    edges: Vec<[DVec3; 2]>,
    triangles: Vec<[DVec3; 3]>,
}

impl Soup {
    /// Builds the lists of a body after a transformation.
    fn new(body: &ConvexPolyhedron, put: impl Fn(DVec3) -> DVec3) -> Self {
        let points: Vec<DVec3> = body.vertices().iter().map(|v| put(*v)).collect();
        let mut edges: Vec<[DVec3; 2]> = Vec::new();
        for v in 0..points.len() as u32 {
            let above = body.neighbours(v).iter().filter(|w| **w > v);
            edges.extend(above.map(|w| [points[v as usize], points[*w as usize]]));
        }
        if let [only] = points[..] {
            edges.push([only, only]);
        }
        let mut triangles = Vec::new();
        for face in 0..body.face_count() as u32 {
            let corners: Vec<DVec3> =
                body.face_vertices(face).map(|v| points[v as usize]).collect();
            let fan = corners[1..].windows(2);
            triangles.extend(fan.map(|pair| [corners[0], pair[0], pair[1]]));
        }
        Self { points, edges, triangles }
    }
}

/// Returns the distance of a point from a triangle; infinite if the foot of the perpendicular is outside,
/// because then an edge is nearer.
fn point_to_triangle(point: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let inside =
        [(a, b), (b, c), (c, a)].iter().all(|(s, t)| normal.cross(t - s).dot(point - s) >= 0.0);
    if inside && normal != DVec3::ZERO {
        normal.normalize().dot(point - a).abs()
    } else {
        f64::INFINITY
    }
}

/// Returns the distance of a point from a triangle, up to rounding.
pub(crate) fn point_to_triangle_or_edges(point: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let edges = [[a, b], [b, c], [c, a]].map(|edge| point_to_segment(point, edge));
    edges.into_iter().fold(point_to_triangle(point, [a, b, c]), f64::min)
}

/// Returns the distance of two segments: the minimum of the distance of the lines, if its feet are on both
/// segments, and of the distances of each end from the other segment.
fn segment_to_segment([a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> f64 {
    let (along, other) = (b - a, d - c);
    let normal = along.cross(other);
    let square = normal.length_squared();
    let (s, t) = ((c - a).cross(other).dot(normal), (c - a).cross(along).dot(normal));
    // For edges that are parallel up to rounding the cross product is meaningless, and the ends determine the
    // distance.
    let parallel = (64.0 * f64::EPSILON).powi(2) * along.length_squared() * other.length_squared();
    let crossing =
        if square > parallel && (0.0..=square).contains(&s) && (0.0..=square).contains(&t) {
            normal.normalize().dot(c - a).abs()
        } else {
            f64::INFINITY
        };
    crossing
        .min(point_to_segment(a, [c, d]))
        .min(point_to_segment(b, [c, d]))
        .min(point_to_segment(c, [a, b]))
        .min(point_to_segment(d, [a, b]))
}

/// Returns the distance of a point from a segment.
fn point_to_segment(point: DVec3, [a, b]: [DVec3; 2]) -> f64 {
    let (edge, to_point) = (b - a, point - a);
    let square = edge.length_squared();
    let along = if square > 0.0 { (to_point.dot(edge) / square).clamp(0.0, 1.0) } else { 0.0 };
    (to_point - edge * along).length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bodies::{at_xyz as at, body};
    use crate::oracle::settings::{FAMILIES, setting};
    use crate::shapes::cuboid;
    use glam::DQuat;

    fn distance_of_cubes(pose: &Pose) -> Distance {
        let cube = body(&cuboid(DVec3::splat(0.5)).vertices);
        distance_of_bodies((&cube, &Pose::IDENTITY), (&cube, pose))
    }

    #[test]
    fn cubes_face_edge_and_corner() {
        assert_eq!(distance_of_cubes(&at(3.0, 0.25, 0.5)).to_f64(), 2.0);
        assert_eq!(distance_of_cubes(&at(3.0, 0.25, 0.5)).shortest, DVec3::X * 2.0);
        assert_eq!(distance_of_cubes(&at(4.0, 5.0, 0.25)).to_f64(), 5.0);
        assert_eq!(distance_of_cubes(&at(-2.0, 3.0, 3.0)).to_f64(), 3.0);
        assert_eq!(distance_of_cubes(&at(2.0, 2.0, -2.0)).square, Ratio::from_f64(3.0));
    }

    #[test]
    fn touching_counts_as_meeting_but_one_ulp_apart_does_not() {
        for touching in [at(1.0, 0.25, 0.0), at(1.0, 1.0, 0.5), at(1.0, -1.0, 1.0)] {
            assert!(distance_of_cubes(&touching).intersects());
            assert_eq!(distance_of_cubes(&touching).to_f64(), 0.0);
        }
        assert!(
            distance_of_cubes(&at(0.0, 0.0, 0.0)).intersects()
                && distance_of_cubes(&at(0.1, 0.2, 0.3)).intersects()
        );
        let apart = distance_of_cubes(&at(1.0_f64.next_up(), 0.25, 0.0));
        assert!(!apart.intersects());
        assert_eq!(apart.to_f64(), f64::EPSILON);
    }

    #[test]
    fn lower_dimensions() {
        let world = &Pose::IDENTITY;
        let of = |a: &[DVec3], b: &[DVec3]| {
            distance_of_bodies((&body(a), world), (&body(b), world)).to_f64()
        };
        let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
        assert_eq!(of(&[x * 3.0], &[y * 4.0]), 5.0);
        assert_eq!(of(&[x, -x], &[y + z * 2.0, -y + z * 2.0]), 2.0);
        assert_eq!(of(&[x, -x], &[y + x * 9.0, y + x * 4.0 + z]), 11.0_f64.sqrt());
        assert_eq!(of(&[x, -x], &[y, -y]), 0.0);
        assert_eq!(of(&[x, y, -x - y], &[z * 0.125, x + y + z * 8.0]), 0.125);
        assert_eq!(of(&[x, y, -x - y], &[x + z, y + z, -x - y + z]), 1.0);
        assert_eq!(of(&[x, y, z], &[DVec3::ZERO]), (1.0_f64 / 3.0).sqrt());
        assert_eq!(
            distance_of_point(z * 3.0, (&body(&[x, -x, y]), &at(0.0, 0.0, 1.0))).to_f64(),
            2.0
        );
    }

    #[test]
    fn distances_with_squares_outside_f64_are_exact() {
        let tiny = Pose::from_translation(DVec3::X * 2.0_f64.powi(-190)).unwrap();
        let point = body(&[DVec3::ZERO]);
        let is = distance_of_bodies((&point, &Pose::IDENTITY), (&point, &tiny)).to_f64();
        assert_eq!(is, 2.0_f64.powi(-190));
        let turned = Pose::new(DQuat::from_rotation_z(0.5), DVec3::X * 1e60).unwrap();
        let is = distance_of_bodies((&point, &turned), (&point, &tiny)).to_f64();
        assert!((is - 1e60).abs() <= 1e45);
    }

    /// Compares two independent algorithms in every family of settings.
    #[test]
    fn agrees_with_all_pairs_of_features() {
        let (mut apart, mut met) = (0, 0);
        for (family, _) in FAMILIES {
            for seed in 0..40 {
                let setting = setting(family, seed);
                let bodies = setting.bodies().unwrap();
                let moving = (&bodies.moving, &setting.moving_pose);
                let fixed = (&bodies.fixed, &setting.fixed_pose);
                let exact = distance_of_bodies(moving, fixed);
                let brute = brute_force(moving, fixed);
                // Points outside or inside faces, because of the hull error, also contribute.
                let size = setting.judge(&bodies).scene.size;
                let hull = bodies.moving.hull_error() + bodies.fixed.hull_error();
                let tolerance = 64.0 * f64::EPSILON * size + 2.0 * hull;
                if exact.intersects() {
                    met += 1;
                } else {
                    apart += 1;
                    let off = (brute - exact.to_f64()).abs();
                    assert!(off <= tolerance, "{setting}: {brute:e} {:e}", exact.to_f64());
                }
                let backwards = distance_of_bodies(fixed, moving);
                assert_eq!(exact.square, backwards.square, "{setting}");
            }
        }
        assert!(apart > 300 && met > 100, "{apart} {met}");
    }

    /// An overlap is proven by a point that is exactly in both bodies.
    #[test]
    fn inner_points_are_inside() {
        let cloud = body(&cuboid(DVec3::new(0.3, 1.7, 0.9)).vertices);
        let pose = Pose::new(DQuat::from_rotation_y(0.7), DVec3::new(0.1, 7.0, 2.0)).unwrap();
        for corner in cloud.vertices() {
            let inside = pose.transform_point(*corner * 0.999_999);
            let outside = pose.transform_point(*corner * 1.000_001);
            assert!(distance_of_point(inside, (&cloud, &pose)).intersects());
            let away = distance_of_point(outside, (&cloud, &pose)).to_f64();
            assert!((away - corner.length() * 1e-6).abs() < 1e-14, "{away:e}");
        }
    }
}
