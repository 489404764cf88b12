//! Distance of two triangles: a point of each, and a separating plane.
//!
//! - Upper bound: the distance of points `p` of `f` and `q` of `g`, given by weights of corners. Lower bound: along any
//!   unit vector `n`, the *gap*, the least `n.q` of `g`'s corners minus the largest `n.p` of `f`'s.
//! - The nearest points are a corner and a point within the other triangle, or points of two edges (then the gap is
//!   `n.(q - p)`), or the triangles cross.
//! - [`nearest_below`] tries the edges first (Larsen, Gottschalk, Lin and Manocha, "Fast distance queries with
//!   rectangular swept sphere volumes", ICRA 2000). It ends when a plane proves that no points are nearer than those
//!   found.
//! - The result does not depend on that path. If the gap is not within [`TIGHT`] noises of the length,
//!   [`compare_all_features`] takes the best of *all* pairs of features and of all planes that the features span.
//!   Choice of normals, and rounding: `docs/theory/solid-distance.md`.

use glam::DVec3;

/// Difference, in noises, of a length and the gap of its plane above which all features are tried.
const TIGHT: f64 = 0.5;

/// Noises by which a computed gap is lowered.
pub const GAP_NOISES: f64 = 0.5;

/// Noises by which a computed length is raised.
pub const LENGTH_NOISES: f64 = 1.0;

/// The corners of a triangle in the setting frame.
pub type Corners = [DVec3; 3];

/// A point of each of two triangles, and a plane between them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Weights of the corners of each triangle.
    pub weights: [DVec3; 2],
    /// Computed distance of the points.
    pub(crate) length: f64,
    /// Unit vector from `f` to `g`.
    pub normal: DVec3,
    /// Computed gap along `normal`; negative if the triangles cross.
    pub gap: f64,
}

impl Nearest {
    fn candidate_from_weights(f: &Corners, g: &Corners, weights: [DVec3; 2]) -> Candidate {
        let displacement = weighted_point(g, weights[1]) - weighted_point(f, weights[0]);
        Candidate { weights, displacement, square: displacement.length_squared() }
    }

    /// Returns this result with the better of two planes: its own, and the one with the normal `along`.
    fn with_plane(self, f: &Corners, g: &Corners, along: DVec3) -> Self {
        let Some(normal) = unit_vector(along) else { return self };
        let gap = gap_along(f, g, normal);
        if gap > self.gap { Self { normal, gap, ..self } } else { self }
    }
}

/// Two points that may be the nearest ones.
#[derive(Clone, Copy)]
struct Candidate {
    weights: [DVec3; 2],
    displacement: DVec3,
    square: f64,
}

/// Returns the point of a triangle with the given weights.
#[inline]
pub fn weighted_point([a, b, c]: &Corners, weights: DVec3) -> DVec3 {
    *a * weights.x + *b * weights.y + *c * weights.z
}

/// Returns the computed distance of the points with the given weights.
#[inline]
pub fn weighted_distance(f: &Corners, g: &Corners, weights: [DVec3; 2]) -> f64 {
    (weighted_point(g, weights[1]) - weighted_point(f, weights[0])).length()
}

/// Returns the gap from `f` to `g` along a vector, in multiples of its length; negative if they overlap along it.
#[inline]
pub(crate) fn gap_along(f: &Corners, g: &Corners, n: DVec3) -> f64 {
    least_coordinate(g, n) - largest_coordinate(f, n)
}

#[inline]
pub(crate) fn largest_coordinate([a, b, c]: &Corners, n: DVec3) -> f64 {
    n.dot(*a).max(n.dot(*b)).max(n.dot(*c))
}

#[inline]
pub(crate) fn least_coordinate([a, b, c]: &Corners, n: DVec3) -> f64 {
    n.dot(*a).min(n.dot(*b)).min(n.dot(*c))
}

/// Normalises a vector, within `4 u`. `None` if its squared length is outside the range from `1e-280` to `1e280`.
pub(crate) fn unit_vector(v: DVec3) -> Option<DVec3> {
    let square = v.length_squared();
    (square > 1e-280 && square < 1e280).then(|| v / square.sqrt())
}

/// Finds nearest points of two triangles, and a plane between; `None` if a plane shows that their distance is at least
/// `limit`.
pub(crate) fn nearest_below(f: &Corners, g: &Corners, limit: f64, noise: f64) -> Option<Nearest> {
    let end = limit + GAP_NOISES * noise;
    match by_features(f, g, end) {
        FeatureResult::Beyond => None,
        FeatureResult::Found(found, along) => {
            let length = found.square.sqrt();
            let Candidate { weights, displacement, .. } = found;
            let none = Nearest { weights, length, normal: DVec3::X, gap: f64::NEG_INFINITY };
            let mut nearest = none.with_plane(f, g, along);
            if nearest.gap < length - TIGHT * noise {
                nearest = nearest.with_plane(f, g, displacement);
            }
            let tight = nearest.gap >= length - TIGHT * noise;
            let nearest = if tight { nearest } else { compare_all_features(f, g, nearest) };
            (nearest.gap < end).then_some(nearest)
        }
        FeatureResult::Crossing(found) => {
            let Candidate { weights, square, .. } = found;
            let (normal, gap) = (DVec3::X, f64::NEG_INFINITY);
            let found = Nearest { weights, length: square.sqrt(), normal, gap };
            let nearest = compare_all_features(f, g, found);
            (nearest.gap < end).then_some(nearest)
        }
    }
}

/// Finds nearest points of two triangles, and a plane between.
#[inline]
pub fn nearest_points(f: &Corners, g: &Corners, noise: f64) -> Nearest {
    nearest_below(f, g, f64::INFINITY, noise).unwrap_or_else(|| {
        // No plane proves an infinite distance, so any points are valid here.
        let weights = [DVec3::X; 2];
        let length = weighted_distance(f, g, weights);
        Nearest { weights, length, normal: DVec3::X, gap: f64::NEG_INFINITY }
    })
}

/// The result of [`by_features`].
enum FeatureResult {
    /// A plane shows that no two points are nearer than the limit.
    Beyond,
    /// The nearest points, and a candidate for the normal of a plane between.
    Found(Candidate, DVec3),
    /// Nothing showed that the triangles do not cross.
    Crossing(Candidate),
}

/// Finds the nearest points, up to rounding errors.
fn by_features(f: &Corners, g: &Corners, end: f64) -> FeatureResult {
    let (e, h) = (edge_vectors(f), edge_vectors(g));
    let mut best = (f64::INFINITY, [0, 0], [0.0; 2]);
    let mut apart = false;
    for i in 0..3 {
        for j in 0..3 {
            let [s, t] = on_edges((f[i], e[i]), (g[j], h[j]));
            let (p, q) = (f[i] + e[i] * s, g[j] + h[j] * t);
            let displacement = q - p;
            let square = displacement.length_squared();
            // The distance of an edge without length is NaN. It is never the nearest.
            if square.is_nan() || square >= best.0 {
                continue;
            }
            best = (square, [i, j], [s, t]);
            // Distances by which the third corners extend into the gap between the edges.
            let into = (f[(i + 2) % 3] - p).dot(displacement).max(0.0);
            let back = (g[(j + 2) % 3] - q).dot(displacement).min(0.0);
            if into == 0.0 && back == 0.0 {
                return edge_pair(f, g, best);
            }
            let rest = square - into + back;
            apart |= rest > 0.0;
            if rest > 0.0 && rest * rest >= end * end * square && is_beyond(f, g, displacement, end)
            {
                return FeatureResult::Beyond;
            }
        }
    }
    for turned in [false, true] {
        let (face, other) = if turned { (g, f) } else { (f, g) };
        match on_face(face, other) {
            PlaneSide::Through => {}
            PlaneSide::Off(normal) => {
                apart = true;
                if is_beyond(f, g, if turned { -normal } else { normal }, end) {
                    return FeatureResult::Beyond;
                }
            }
            PlaneSide::Foot(weights, corner, normal) => {
                let corner = DVec3::AXES[corner];
                let weights = if turned { [corner, weights] } else { [weights, corner] };
                let along = if turned { -normal } else { normal };
                return FeatureResult::Found(Nearest::candidate_from_weights(f, g, weights), along);
            }
        }
    }
    if apart { edge_pair(f, g, best) } else { FeatureResult::Crossing(edge_points(f, g, best)) }
}

/// Checks whether a plane with this normal shows a distance of at least `end`.
fn is_beyond(f: &Corners, g: &Corners, along: DVec3, end: f64) -> bool {
    unit_vector(along).is_some_and(|n| gap_along(f, g, n) >= end)
}

/// Returns the points on two edges.
fn edge_points(
    f: &Corners,
    g: &Corners,
    (_, [i, j], [s, t]): (f64, [usize; 2], [f64; 2]),
) -> Candidate {
    Nearest::candidate_from_weights(f, g, [along_edge(i, s), along_edge(j, t)])
}

fn edge_pair(f: &Corners, g: &Corners, best: (f64, [usize; 2], [f64; 2])) -> FeatureResult {
    let found = edge_points(f, g, best);
    let (_, [i, j], [s, t]) = best;
    let (e, h) = (f[(i + 1) % 3] - f[i], g[(j + 1) % 3] - g[j]);
    let inner = |x: f64| x > 0.0 && x < 1.0;
    let along = match (inner(s), inner(t)) {
        (true, true) => edge_normal(e, h),
        (true, false) => without_component(found.displacement, e),
        (false, true) => without_component(found.displacement, h),
        (false, false) => found.displacement,
    };
    FeatureResult::Found(found, if along.dot(found.displacement) < 0.0 { -along } else { along })
}

fn edge_vectors([a, b, c]: &Corners) -> [DVec3; 3] {
    [*b - *a, *c - *b, *a - *c]
}

fn along_edge(k: usize, s: f64) -> DVec3 {
    let mut weights = [0.0; 3];
    (weights[k], weights[(k + 1) % 3]) = (1.0 - s, s);
    DVec3::from_array(weights)
}

/// Returns the positions, from 0 to 1, at which two segments are nearest, up to rounding. Each segment is given by a
/// point and a vector.
fn on_edges((a, e): (DVec3, DVec3), (b, h): (DVec3, DVec3)) -> [f64; 2] {
    let displacement = b - a;
    let (ee, hh, eh) = (e.length_squared(), h.length_squared(), e.dot(h));
    let (we, wh) = (displacement.dot(e), displacement.dot(h));
    let s = clamped_ratio(we * hh - wh * eh, ee * hh - eh * eh);
    let t = (s * eh - wh) / hh;
    // An edge without length is represented by its first end.
    if t <= 0.0 || hh == 0.0 {
        [clamped_ratio(we, ee), 0.0]
    } else if t >= 1.0 {
        [clamped_ratio(we + eh, ee), 1.0]
    } else {
        [s, t]
    }
}

/// Returns a quotient clamped to the range from 0 to 1; 0 if it is NaN.
fn clamped_ratio(a: f64, b: f64) -> f64 {
    let x = a / b;
    if x > 0.0 { x.min(1.0) } else { 0.0 }
}

/// The position of a triangle's corners relative to the plane of another one.
enum PlaneSide {
    /// The corners are on both sides, or on the plane.
    Through,
    /// All corners are on the side to which the normal points. The nearest one is not over the face.
    Off(DVec3),
    /// The nearest corner is over the face: weights of the point below it, its number, and the normal.
    Foot(DVec3, usize, DVec3),
}

fn on_face(face: &Corners, other: &Corners) -> PlaneSide {
    let normal = face_normal(face);
    let heights = other.map(|c| normal.dot(c - face[0]));
    let up = heights[0] > 0.0;
    if heights.iter().any(|h| (*h > 0.0) != up || *h == 0.0) {
        return PlaneSide::Through;
    }
    let towards = if up { normal } else { -normal };
    let nearest = (0..3).fold(0, |k, i| if heights[i].abs() < heights[k].abs() { i } else { k });
    match foot_weights(face, normal, other[nearest]) {
        Some(weights) => PlaneSide::Foot(weights, nearest, towards),
        None => PlaneSide::Off(towards),
    }
}

/// Returns a normal of a triangle, orthogonal to its longest edge. Its length is twice the area of the triangle, up to
/// rounding.
fn face_normal(corners: &Corners) -> DVec3 {
    let [e, h, k] = edge_vectors(corners);
    let (x, y, z) = (e.length_squared(), h.length_squared(), k.length_squared());
    let (n, longest) = if x >= y && x >= z {
        (e.cross(h), e)
    } else if y >= z {
        (h.cross(k), h)
    } else {
        (k.cross(e), k)
    };
    without_component(n, longest)
}

/// Returns the weights of the point of a triangle below or above another point; `None` if that point is outside the
/// triangle.
fn foot_weights([a, b, c]: &Corners, normal: DVec3, point: DVec3) -> Option<DVec3> {
    let (u, v, square) = (*b - *a, *c - *a, normal.length_squared());
    let solve = |x: DVec3| [x.cross(v).dot(normal) / square, u.cross(x).dot(normal) / square];
    let x = point - *a;
    let [s, t] = solve(x);
    // A second step for the remainder: the first solution of a sliver is inaccurate by its length over its height.
    let [ds, dt] = solve(x - u * s - v * t);
    let (s, t) = (s + ds, t + dt);
    (s >= 0.0 && t >= 0.0 && s + t <= 1.0).then(|| DVec3::new(1.0 - (s + t), s, t))
}

/// Returns a vector minus its component along another one.
fn without_component(v: DVec3, edge: DVec3) -> DVec3 {
    let square = edge.length_squared();
    if square > 0.0 { v - edge * (v.dot(edge) / square) } else { v }
}

/// Returns a vector orthogonal to two others, within `u` for the longer one.
fn edge_normal(e: DVec3, h: DVec3) -> DVec3 {
    let longer = if e.length_squared() >= h.length_squared() { e } else { h };
    without_component(e.cross(h), longer)
}

/// Returns the best of all pairs of features and of all planes.
#[cold]
fn compare_all_features(f: &Corners, g: &Corners, known: Nearest) -> Nearest {
    let mut best = known;
    let mut take = |weights: [DVec3; 2]| {
        let length = weighted_distance(f, g, weights);
        if length < best.length {
            best = Nearest { weights, length, ..best };
        }
    };
    for i in 0..3 {
        for j in 0..3 {
            let [s, t] =
                on_edges_carefully((f[i], f[(i + 1) % 3] - f[i]), (g[j], g[(j + 1) % 3] - g[j]));
            take([along_edge(i, s), along_edge(j, t)]);
        }
        let on_g = [f[i], f[(i + 1) % 3]];
        points_over(g, on_g, |on, s| take([along_edge(i, s), on]));
        let on_f = [g[i], g[(i + 1) % 3]];
        points_over(f, on_f, |on, s| take([on, along_edge(i, s)]));
    }
    for n in candidate_normals(f, g, best) {
        best = best.with_plane(f, g, n).with_plane(f, g, -n);
    }
    best
}

/// Calls `tell` with points of a face and positions along an edge that may be nearest: below its first end, and where
/// the edge passes through the face.
fn points_over(face: &Corners, [a, b]: [DVec3; 2], mut tell: impl FnMut(DVec3, f64)) {
    let normal = face_normal(face);
    if let Some(on) = foot_weights(face, normal, a) {
        tell(on, 0.0);
    }
    let (x, y) = (normal.dot(a - face[0]), normal.dot(b - face[0]));
    if x * y < 0.0 {
        let s = clamped_ratio(x, x - y);
        if let Some(on) = foot_weights(face, normal, a + (b - a) * s) {
            tell(on, s);
        }
    }
}

/// Returns the positions of [`on_edges`] for edges that may be nearly parallel. The cross product of the edges depends
/// on the angle itself and not on its square. Then each position is computed again from the other.
fn on_edges_carefully((a, e): (DVec3, DVec3), (b, h): (DVec3, DVec3)) -> [f64; 2] {
    let (displacement, normal) = (b - a, e.cross(h));
    let mut s = clamped_ratio(displacement.cross(h).dot(normal), normal.length_squared());
    let mut t = 0.0;
    for _ in 0..2 {
        t = clamped_ratio((e * s - displacement).dot(h), h.length_squared());
        s = clamped_ratio((displacement + h * t).dot(e), e.length_squared());
    }
    [s, t]
}

/// Returns a normal of each plane that the features span. Its sign is arbitrary.
fn candidate_normals(f: &Corners, g: &Corners, best: Nearest) -> impl Iterator<Item = DVec3> {
    let (e, h) = (edge_vectors(f), edge_vectors(g));
    let displacement = weighted_point(g, best.weights[1]) - weighted_point(f, best.weights[0]);
    let faces = [face_normal(f), face_normal(g), displacement];
    let products = e.into_iter().flat_map(move |a| h.map(|b| edge_normal(a, b)));
    let beside = e.into_iter().chain(h).map(move |a| without_component(displacement, a));
    faces.into_iter().chain(products).chain(beside)
}

#[cfg(test)]
mod tests {
    use std::cmp::Ordering::Equal;

    use colltrans_testkit::oracle::distance::distance;
    use colltrans_testkit::oracle::exact::Vector;
    use colltrans_testkit::random::Random;

    use super::*;
    use crate::body::exact::sign_along_axis;
    use colltrans_kernel::noise::Noise;

    /// Returns triangles with ties, slivers and coplanar places. The second triangle need not be near the first one.
    fn random_triangles(random: &mut Random) -> [Corners; 2] {
        let kind = random.int(0, 7);
        let any = |r: &mut Random| DVec3::from_array([0; 3].map(|_| r.range(-1.0, 1.0)));
        let corners = |r: &mut Random| -> Corners {
            let grid = [0; 3].map(|_| r.grid(-2, 2));
            let free = [any(r), any(r), any(r)];
            match kind {
                0 => free,
                1 | 2 => grid,
                // Needles and caps.
                3 | 4 => {
                    let thin = 10.0_f64.powf(r.range(-12.0, -3.0));
                    let share = [0.0, 0.5, 1.0, r.unit()][r.int(0, 3) as usize];
                    let [a, b, c] = free;
                    [a, b, a + (b - a) * share + c * thin]
                }
                // Nearly parallel edges.
                5 => {
                    let thin = 10.0_f64.powf(r.range(-15.0, -3.0));
                    [free[0], free[0] + DVec3::X + any(r) * thin, free[2]]
                }
                // Coplanar triangles.
                6 => free.map(|v| DVec3::new(v.x, v.y, 0.25)),
                _ => grid.map(|v| DVec3::new(v.x, v.y, 1.0)),
            }
        };
        let triangle = |r: &mut Random| loop {
            let corners = corners(r);
            if !(0..3).all(|k| sign_along_axis(corners[0], corners[1], corners[2], k) == Equal) {
                return corners;
            }
        };
        [triangle(random), triangle(random)]
    }

    /// Moves the second triangle so that the gap along its plane is about `gap`.
    fn put_near(f: &Corners, g: Corners, gap: f64) -> Corners {
        let Some(nearest) = nearest_below(f, &g, f64::INFINITY, 1e-15) else { return g };
        let by = nearest.normal * (gap - nearest.gap);
        g.map(|v| v + by)
    }

    fn configuration_size(f: &Corners, g: &Corners) -> f64 {
        let reach = |t: &Corners| t.iter().map(|v| v.length()).fold(0.0, f64::max);
        reach(f) + reach(g)
    }

    #[test]
    fn lengths_and_gaps_enclose_the_distance_in_fractions() {
        let mut random = Random::new(27);
        let (mut widest, mut apart, mut met) = (0.0_f64, 0, 0);
        for _ in 0..6_000 {
            let [f, mut g] = random_triangles(&mut random);
            if random.one_in(2) {
                let gap = [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3][random.int(0, 5) as usize];
                g = put_near(&f, g, gap);
            }
            let noise = Noise::for_size(configuration_size(&f, &g)).point_error();
            let found = nearest_below(&f, &g, f64::INFINITY, noise).expect("no limit");
            let right = distance(&f.map(Vector::new), &g.map(Vector::new)).to_f64();
            let [lower, upper] =
                [found.gap - GAP_NOISES * noise, found.length + LENGTH_NOISES * noise];
            assert!(lower <= right && right <= upper, "{lower:e} {right:e} {upper:e}: {f:?} {g:?}");
            let width = (upper - lower.max(0.0)) / noise;
            assert!(width <= 4.0, "{width} {lower:e} {right:e} {upper:e}: {f:?} {g:?}");
            widest = widest.max(width);
            *(if right == 0.0 { &mut met } else { &mut apart }) += 1;
            for weights in found.weights {
                assert!(weights.cmpge(DVec3::ZERO).all(), "{weights}");
                assert!((weights.element_sum() - 1.0).abs() <= 2.0 * f64::EPSILON, "{weights}");
            }
        }
        assert!(apart > 2_000 && met > 300, "{apart} {met}");
        eprintln!("{widest} noises, {apart} apart, {met} met");
    }

    #[test]
    fn excluded_triangles_are_at_least_the_limit_apart() {
        let mut random = Random::new(28);
        let mut dismissed = 0;
        for _ in 0..4_000 {
            let [f, g] = random_triangles(&mut random);
            let noise = Noise::for_size(configuration_size(&f, &g)).point_error();
            let right = distance(&f.map(Vector::new), &g.map(Vector::new)).to_f64();
            let limit = right * random.range(0.5, 1.1);
            if nearest_below(&f, &g, limit, noise).is_none() {
                dismissed += 1;
                assert!(right >= limit, "{right} {limit}: {f:?} {g:?}");
            } else {
                assert!(right <= limit + 4.0 * noise, "{right} {limit}: {f:?} {g:?}");
            }
        }
        assert!(dismissed > 1_000, "{dismissed}");
    }
}
