//! How far two triangles are apart: two points of them, and a plane between.
//!
//! Above: two points of the triangles, `p` of `f` and `q` of `g`, by weights of corners. Below: along any
//! unit vector `n`, no two points are nearer than the *gap*, the least `n.q` of `g`'s corners less the
//! largest `n.p` of `f`'s. The nearest points are a corner and a point within the other triangle, or points of
//! two edges (then `q - p` along `n` is the gap), or the triangles cross. [`examine`] tries the edges first, as
//! Larsen, Gottschalk, Lin and Manocha do ("Fast distance queries with rectangular swept sphere volumes",
//! ICRA 2000), and ends at the first pair of points between which a plane shows that nothing is nearer. No
//! answer hangs on the way there: where the plane's gap is not within [`TIGHT`] noises of the length, as for
//! slivers, parallel edges and triangles that all but touch, [`carefully`] takes the best of *all* pairs of
//! features and the best of all planes that the features span.
//!
//! The normal of a short `v = q - p` is not `v / |v|`, which rounding turns by `u S / |v|`: that tilts the
//! plane by as much times the triangles' length. Planes are those of the features: across two edges, of a face,
//! or `v` made orthogonal to an edge. A product of two edges that are nearly parallel, or of those of a sliver,
//! is turned by `u / s` (`s` the sine of their angle), but made orthogonal to the longer edge it is off that one
//! by `u` alone, and what is left of the turn acts on no more than `s` times the other's length. If the best
//! normal lies within the range of those that have the same two corners in front, `v / |v|` is as good as it
//! but for `(u S)^2 / |v|`; if it is nearer than `u S / |v|` to the end of that range, so is one of the others.
//!
//! Rounding. Corners in the setting frame are off by `5.2 u |v|` for the matrix (`3 u` for each product of a
//! row, the rows together `sqrt 3`), those of the fixed body by `u |q|` for adding the offset and `u` of it
//! for its own rounding more: those of the two bodies together by less than `6.5 u S`.
//!
//! - *Length.* A mean of corners is off by `3 u` of their size, and by `2 u` as the weights' sum is 1 but for that:
//!   `5 u S` for both; the difference by `u S`; the length by `4 u S`. Together less than `17 u S`: one noise
//!   (`32 u S`) above the computed length is a distance of points that belong to the bodies.
//! - *Gap.* The products with `n` are off by `3 u S`, their difference by `u S`, and by `4 u S` as the length of `n`
//!   is 1 but for `4 u`. Together less than `15 u S`: half a noise below the computed gap is a lower bound.

use glam::DVec3;

/// How many noises a length may be above the gap of its plane before everything is tried.
const TIGHT: f64 = 0.5;

/// What a computed gap is lowered by, in noises.
pub const GAP: f64 = 0.5;

/// What a computed length is raised by, in noises.
pub const LENGTH: f64 = 1.0;

/// The corners of a triangle in the setting frame.
pub type Corners = [DVec3; 3];

/// Two points of two triangles, and a plane between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Of the corners of each.
    pub weights: [DVec3; 2],
    /// How far the points are apart, as computed.
    pub(crate) length: f64,
    /// A unit vector from `f` to `g`, and the gap along it, as computed; below 0 where the triangles cross.
    pub normal: DVec3,
    pub gap: f64,
}

impl Nearest {
    fn between(f: &Corners, g: &Corners, weights: [DVec3; 2]) -> Candidate {
        let way = mean(g, weights[1]) - mean(f, weights[0]);
        Candidate { weights, way, square: way.length_squared() }
    }

    /// The same with the best of two planes.
    fn with_plane(self, f: &Corners, g: &Corners, along: DVec3) -> Self {
        let Some(normal) = unit(along) else { return self };
        let gap = gap(f, g, normal);
        if gap > self.gap { Self { normal, gap, ..self } } else { self }
    }
}

/// Two points, on their way to be the nearest.
#[derive(Clone, Copy)]
struct Candidate {
    weights: [DVec3; 2],
    way: DVec3,
    square: f64,
}

/// The point of a triangle with these weights.
#[inline]
pub fn mean([a, b, c]: &Corners, weights: DVec3) -> DVec3 {
    *a * weights.x + *b * weights.y + *c * weights.z
}

/// How far apart points with these weights are, as computed.
#[inline]
pub fn length(f: &Corners, g: &Corners, weights: [DVec3; 2]) -> f64 {
    (mean(g, weights[1]) - mean(f, weights[0])).length()
}

/// How far `g` is before `f` along a vector.
#[inline]
pub(crate) fn gap(f: &Corners, g: &Corners, n: DVec3) -> f64 {
    least(g, n) - largest(f, n)
}

#[inline]
pub(crate) fn largest([a, b, c]: &Corners, n: DVec3) -> f64 {
    n.dot(*a).max(n.dot(*b)).max(n.dot(*c))
}

#[inline]
pub(crate) fn least([a, b, c]: &Corners, n: DVec3) -> f64 {
    n.dot(*a).min(n.dot(*b)).min(n.dot(*c))
}

/// A vector at length 1, to within `4 u`; lengths whose squares would leave the range are none.
pub(crate) fn unit(v: DVec3) -> Option<DVec3> {
    let square = v.length_squared();
    (square > 1e-280 && square < 1e280).then(|| v / square.sqrt())
}

/// Two points of the triangles that are nearest, and a plane between; `None` if a plane shows that they
/// are at least `limit` apart.
pub(crate) fn examine(f: &Corners, g: &Corners, limit: f64, noise: f64) -> Option<Nearest> {
    let end = limit + GAP * noise;
    match by_features(f, g, end) {
        Quick::Beyond => None,
        Quick::Found(found, along) => {
            let length = found.square.sqrt();
            let Candidate { weights, way, .. } = found;
            let none = Nearest { weights, length, normal: DVec3::X, gap: f64::NEG_INFINITY };
            let mut nearest = none.with_plane(f, g, along);
            if nearest.gap < length - TIGHT * noise {
                nearest = nearest.with_plane(f, g, way);
            }
            let tight = nearest.gap >= length - TIGHT * noise;
            let nearest = if tight { nearest } else { carefully(f, g, nearest) };
            (nearest.gap < end).then_some(nearest)
        }
        Quick::Crossing(found) => {
            let Candidate { weights, square, .. } = found;
            let (normal, gap) = (DVec3::X, f64::NEG_INFINITY);
            let found = Nearest { weights, length: square.sqrt(), normal, gap };
            let nearest = carefully(f, g, found);
            (nearest.gap < end).then_some(nearest)
        }
    }
}

/// Two points of the triangles that are nearest, and a plane between.
#[inline]
pub fn nearest(f: &Corners, g: &Corners, noise: f64) -> Nearest {
    examine(f, g, f64::INFINITY, noise).unwrap_or_else(|| {
        // No plane is infinitely far from another; any points will do.
        let weights = [DVec3::X; 2];
        let length = length(f, g, weights);
        Nearest { weights, length, normal: DVec3::X, gap: f64::NEG_INFINITY }
    })
}

/// What [`by_features`] comes to.
enum Quick {
    /// No two points are as near as asked.
    Beyond,
    /// The nearest, and what a plane between might be across.
    Found(Candidate, DVec3),
    /// Nothing showed that they do not cross.
    Crossing(Candidate),
}

/// The nearest points but for what rounding does.
fn by_features(f: &Corners, g: &Corners, end: f64) -> Quick {
    let (e, h) = (edges(f), edges(g));
    let mut best = (f64::INFINITY, [0, 0], [0.0; 2]);
    let mut apart = false;
    for i in 0..3 {
        for j in 0..3 {
            let [s, t] = on_edges((f[i], e[i]), (g[j], h[j]));
            let (p, q) = (f[i] + e[i] * s, g[j] + h[j] * t);
            let way = q - p;
            let square = way.length_squared();
            // Nothing is nearer than what is not a number: an edge without a length.
            if square.is_nan() || square >= best.0 {
                continue;
            }
            best = (square, [i, j], [s, t]);
            // How far the third corners reach into the gap between the edges.
            let into = (f[(i + 2) % 3] - p).dot(way).max(0.0);
            let back = (g[(j + 2) % 3] - q).dot(way).min(0.0);
            if into == 0.0 && back == 0.0 {
                return edge_pair(f, g, best);
            }
            let rest = square - into + back;
            apart |= rest > 0.0;
            if rest > 0.0 && rest * rest >= end * end * square && is_beyond(f, g, way, end) {
                return Quick::Beyond;
            }
        }
    }
    for turned in [false, true] {
        let (face, other) = if turned { (g, f) } else { (f, g) };
        match on_face(face, other) {
            Side::Through => {}
            Side::Off(normal) => {
                apart = true;
                if is_beyond(f, g, if turned { -normal } else { normal }, end) {
                    return Quick::Beyond;
                }
            }
            Side::Foot(weights, corner, normal) => {
                let corner = DVec3::AXES[corner];
                let weights = if turned { [corner, weights] } else { [weights, corner] };
                let along = if turned { -normal } else { normal };
                return Quick::Found(Nearest::between(f, g, weights), along);
            }
        }
    }
    if apart { edge_pair(f, g, best) } else { Quick::Crossing(edge_points(f, g, best)) }
}

/// Whether a plane shows that they are farther apart.
fn is_beyond(f: &Corners, g: &Corners, along: DVec3, end: f64) -> bool {
    unit(along).is_some_and(|n| gap(f, g, n) >= end)
}

/// The points on two edges.
fn edge_points(
    f: &Corners,
    g: &Corners,
    (_, [i, j], [s, t]): (f64, [usize; 2], [f64; 2]),
) -> Candidate {
    Nearest::between(f, g, [along_edge(i, s), along_edge(j, t)])
}

fn edge_pair(f: &Corners, g: &Corners, best: (f64, [usize; 2], [f64; 2])) -> Quick {
    let found = edge_points(f, g, best);
    let (_, [i, j], [s, t]) = best;
    let (e, h) = (f[(i + 1) % 3] - f[i], g[(j + 1) % 3] - g[j]);
    let inner = |x: f64| x > 0.0 && x < 1.0;
    let along = match (inner(s), inner(t)) {
        (true, true) => across(e, h),
        (true, false) => without(found.way, e),
        (false, true) => without(found.way, h),
        (false, false) => found.way,
    };
    Quick::Found(found, if along.dot(found.way) < 0.0 { -along } else { along })
}

fn edges([a, b, c]: &Corners) -> [DVec3; 3] {
    [*b - *a, *c - *b, *a - *c]
}

fn along_edge(k: usize, s: f64) -> DVec3 {
    let mut weights = [0.0; 3];
    (weights[k], weights[(k + 1) % 3]) = (1.0 - s, s);
    DVec3::from_array(weights)
}

/// The shares at which two segments, each from a point by a vector, are nearest, to within rounding.
fn on_edges((a, e): (DVec3, DVec3), (b, h): (DVec3, DVec3)) -> [f64; 2] {
    let way = b - a;
    let (ee, hh, eh) = (e.length_squared(), h.length_squared(), e.dot(h));
    let (we, wh) = (way.dot(e), way.dot(h));
    let s = share(we * hh - wh * eh, ee * hh - eh * eh);
    let t = (s * eh - wh) / hh;
    // An edge without a length is its first end.
    if t <= 0.0 || hh == 0.0 {
        [share(we, ee), 0.0]
    } else if t >= 1.0 {
        [share(we + eh, ee), 1.0]
    } else {
        [s, t]
    }
}

/// A quotient between 0 and 1; 0 if it is none.
fn share(a: f64, b: f64) -> f64 {
    let x = a / b;
    if x > 0.0 { x.min(1.0) } else { 0.0 }
}

/// Where the corners of a triangle are beside the plane of another.
enum Side {
    /// On both sides, or on it.
    Through,
    /// On one side, to which this points, but the nearest of them not over the face.
    Off(DVec3),
    /// The nearest corner over the face: the weights of the point below, which corner, and the normal.
    Foot(DVec3, usize, DVec3),
}

fn on_face(face: &Corners, other: &Corners) -> Side {
    let normal = plane(face);
    let heights = other.map(|c| normal.dot(c - face[0]));
    let up = heights[0] > 0.0;
    if heights.iter().any(|h| (*h > 0.0) != up || *h == 0.0) {
        return Side::Through;
    }
    let towards = if up { normal } else { -normal };
    let nearest = (0..3).fold(0, |k, i| if heights[i].abs() < heights[k].abs() { i } else { k });
    match foot(face, normal, other[nearest]) {
        Some(weights) => Side::Foot(weights, nearest, towards),
        None => Side::Off(towards),
    }
}

/// A normal of a triangle, of its edges' size squared; see the module's head.
fn plane(corners: &Corners) -> DVec3 {
    let [e, h, k] = edges(corners);
    let (x, y, z) = (e.length_squared(), h.length_squared(), k.length_squared());
    let (n, longest) = if x >= y && x >= z {
        (e.cross(h), e)
    } else if y >= z {
        (h.cross(k), h)
    } else {
        (k.cross(e), k)
    };
    without(n, longest)
}

/// The weights of the point of a triangle below or above another point, if there is one.
fn foot([a, b, c]: &Corners, normal: DVec3, point: DVec3) -> Option<DVec3> {
    let (u, v, square) = (*b - *a, *c - *a, normal.length_squared());
    let solve = |x: DVec3| [x.cross(v).dot(normal) / square, u.cross(x).dot(normal) / square];
    let x = point - *a;
    let [s, t] = solve(x);
    // Once more for what is left: a sliver's first answer is off by its length over its height.
    let [ds, dt] = solve(x - u * s - v * t);
    let (s, t) = (s + ds, t + dt);
    (s >= 0.0 && t >= 0.0 && s + t <= 1.0).then(|| DVec3::new(1.0 - (s + t), s, t))
}

/// A vector less its part along another one.
fn without(v: DVec3, edge: DVec3) -> DVec3 {
    let square = edge.length_squared();
    if square > 0.0 { v - edge * (v.dot(edge) / square) } else { v }
}

/// A vector orthogonal to two, the longer one exactly but for `u`.
fn across(e: DVec3, h: DVec3) -> DVec3 {
    let longer = if e.length_squared() >= h.length_squared() { e } else { h };
    without(e.cross(h), longer)
}

/// The best of all pairs of features and of all planes.
#[cold]
fn carefully(f: &Corners, g: &Corners, known: Nearest) -> Nearest {
    let mut best = known;
    let mut take = |weights: [DVec3; 2]| {
        let length = length(f, g, weights);
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
    for n in planes(f, g, best) {
        best = best.with_plane(f, g, n).with_plane(f, g, -n);
    }
    best
}

/// Tells of points of a face and shares of an edge that may be nearest: below its first end, and where it
/// goes through.
fn points_over(face: &Corners, [a, b]: [DVec3; 2], mut tell: impl FnMut(DVec3, f64)) {
    let normal = plane(face);
    if let Some(on) = foot(face, normal, a) {
        tell(on, 0.0);
    }
    let (x, y) = (normal.dot(a - face[0]), normal.dot(b - face[0]));
    if x * y < 0.0 {
        let s = share(x, x - y);
        if let Some(on) = foot(face, normal, a + (b - a) * s) {
            tell(on, s);
        }
    }
}

/// As [`on_edges`], for edges that may be all but parallel: by their product, which has the angle itself
/// and not its square, and then each share once more for the other.
fn on_edges_carefully((a, e): (DVec3, DVec3), (b, h): (DVec3, DVec3)) -> [f64; 2] {
    let (way, normal) = (b - a, e.cross(h));
    let mut s = share(way.cross(h).dot(normal), normal.length_squared());
    let mut t = 0.0;
    for _ in 0..2 {
        t = share((e * s - way).dot(h), h.length_squared());
        s = share((way + h * t).dot(e), e.length_squared());
    }
    [s, t]
}

/// The normals of all planes that features of the two span, without a sign.
fn planes(f: &Corners, g: &Corners, best: Nearest) -> impl Iterator<Item = DVec3> {
    let (e, h) = (edges(f), edges(g));
    let way = mean(g, best.weights[1]) - mean(f, best.weights[0]);
    let faces = [plane(f), plane(g), way];
    let products = e.into_iter().flat_map(move |a| h.map(|b| across(a, b)));
    let beside = e.into_iter().chain(h).map(move |a| without(way, a));
    faces.into_iter().chain(products).chain(beside)
}

#[cfg(test)]
mod tests {
    use std::cmp::Ordering::Equal;

    use colltrans_testkit::oracle::distance::distance;
    use colltrans_testkit::oracle::exact::Vector;
    use colltrans_testkit::random::Random;

    use super::*;
    use crate::body::exact::turn;
    use colltrans_kernel::noise::Noise;

    /// Corners with ties, slivers and flat places; the second triangle near the first one or not.
    fn draw(random: &mut Random) -> [Corners; 2] {
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
                // Edges that are all but parallel.
                5 => {
                    let thin = 10.0_f64.powf(r.range(-15.0, -3.0));
                    [free[0], free[0] + DVec3::X + any(r) * thin, free[2]]
                }
                // One plane.
                6 => free.map(|v| DVec3::new(v.x, v.y, 0.25)),
                _ => grid.map(|v| DVec3::new(v.x, v.y, 1.0)),
            }
        };
        let triangle = |r: &mut Random| loop {
            let corners = corners(r);
            if !(0..3).all(|k| turn(corners[0], corners[1], corners[2], k) == Equal) {
                return corners;
            }
        };
        [triangle(random), triangle(random)]
    }

    /// The second triangle moved so that the gap along its plane is about so much.
    fn put_near(f: &Corners, g: Corners, gap: f64) -> Corners {
        let Some(nearest) = examine(f, &g, f64::INFINITY, 1e-15) else { return g };
        let by = nearest.normal * (gap - nearest.gap);
        g.map(|v| v + by)
    }

    fn size(f: &Corners, g: &Corners) -> f64 {
        let reach = |t: &Corners| t.iter().map(|v| v.length()).fold(0.0, f64::max);
        reach(f) + reach(g)
    }

    #[test]
    fn lengths_and_gaps_enclose_the_distance_in_fractions() {
        let mut random = Random::new(27);
        let (mut widest, mut apart, mut met) = (0.0_f64, 0, 0);
        for _ in 0..6_000 {
            let [f, mut g] = draw(&mut random);
            if random.one_in(2) {
                let gap = [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3][random.int(0, 5) as usize];
                g = put_near(&f, g, gap);
            }
            let noise = Noise::of(size(&f, &g)).point();
            let found = examine(&f, &g, f64::INFINITY, noise).expect("no limit");
            let right = distance(&f.map(Vector::new), &g.map(Vector::new)).to_f64();
            let [lower, upper] = [found.gap - GAP * noise, found.length + LENGTH * noise];
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
    fn what_is_dismissed_is_beyond() {
        let mut random = Random::new(28);
        let mut dismissed = 0;
        for _ in 0..4_000 {
            let [f, g] = draw(&mut random);
            let noise = Noise::of(size(&f, &g)).point();
            let right = distance(&f.map(Vector::new), &g.map(Vector::new)).to_f64();
            let limit = right * random.range(0.5, 1.1);
            if examine(&f, &g, limit, noise).is_none() {
                dismissed += 1;
                assert!(right >= limit, "{right} {limit}: {f:?} {g:?}");
            } else {
                assert!(right <= limit + 4.0 * noise, "{right} {limit}: {f:?} {g:?}");
            }
        }
        assert!(dismissed > 1_000, "{dismissed}");
    }
}
