//! The distance of two triangles and their nearest points.
//!
//! The nearest points are an inner point of one triangle and a corner of the other, or points of
//! two edges, or the triangles meet. All nine pairs of edges and six of corner and triangle are
//! looked at, unless the slab between the planes across an edge pair's nearest points already
//! proves them (as Larsen et al. do). Triangles that meet without an edge near another have an edge
//! that pierces the other triangle. Degenerate triangles are segments and points: their edges are
//! all there is to look at.

use glam::DVec3;

use crate::segment::{foot, nearest_of_segments};

/// Corners in order.
pub(crate) type Triangle = [DVec3; 3];

/// A point of either triangle and the square of their distance.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Nearest {
    pub(crate) first: DVec3,
    pub(crate) second: DVec3,
    pub(crate) square: f64,
}

impl Nearest {
    fn new(first: DVec3, second: DVec3) -> Self {
        Self { first, second, square: first.distance_squared(second) }
    }

    fn swapped(self) -> Self {
        Self { first: self.second, second: self.first, ..self }
    }
}

/// Sines below this make the closed formula for two lines lose more than a third of its digits.
const NEARLY_PARALLEL: f64 = 1e-5;

/// The nearest points of two triangles.
pub(crate) fn nearest_of_triangles(s: &Triangle, t: &Triangle) -> Nearest {
    let mut best = Nearest::new(s[0], t[0]);
    for i in 0..3 {
        for j in 0..3 {
            let (ab, cd) = ([s[i], s[(i + 1) % 3]], [t[j], t[(j + 1) % 3]]);
            let near = nearest_of_edges(ab, cd);
            if near.square <= best.square {
                best = near;
                if best.square == 0.0 || is_proven(&best, s, t) {
                    return best;
                }
            }
        }
    }
    let faces = [from_corners(s, t, best.square), from_corners(t, s, best.square)];
    if let Some(near) = faces[0].map(Nearest::swapped) {
        best = near;
    }
    if let Some(near) = faces[1].filter(|near| near.square < best.square) {
        best = near;
    }
    pierced(s, t).or_else(|| pierced(t, s)).map_or(best, |x| Nearest::new(x, x))
}

/// Nearest points of two edges: the closed formula where it is accurate.
fn nearest_of_edges([a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> Nearest {
    let (u, v, w) = (b - a, d - c, a - c);
    let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
    let det = uu * vv - uv * uv;
    if det <= NEARLY_PARALLEL * NEARLY_PARALLEL * uu * vv {
        let near = nearest_of_segments([a, b], [c, d]);
        return if near.first.is_finite() && near.second.is_finite() {
            Nearest::new(near.first, near.second)
        } else {
            nearest_of_points([a, b], [c, d])
        };
    }
    let (uw, vw) = (u.dot(w), v.dot(w));
    let share = ((uv * vw - vv * uw) / det).clamp(0.0, 1.0);
    let other = ((uv * share + vw) / vv).clamp(0.0, 1.0);
    let first = a + u * ((uv * other - uw) / uu).clamp(0.0, 1.0);
    // The foot of the foot: its error is of second order in that of the share.
    let second = c + v * ((first - c).dot(v) / vv).clamp(0.0, 1.0);
    Nearest::new(first, second)
}

/// For edges of length zero.
fn nearest_of_points([a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> Nearest {
    let on = |x: DVec3, ends: [DVec3; 2]| {
        if ends[0] == ends[1] { ends[0] } else { ends[0].lerp(ends[1], foot(x, ends)) }
    };
    let second = on(a, [c, d]);
    let candidates = [Nearest::new(on(second, [a, b]), second), Nearest::new(b, on(b, [c, d]))];
    if candidates[0].square <= candidates[1].square { candidates[0] } else { candidates[1] }
}

/// Whether all corners lie beyond the planes across two nearest points.
fn is_proven(near: &Nearest, s: &Triangle, t: &Triangle) -> bool {
    let across = near.second - near.first;
    s.iter().all(|x| across.dot(*x - near.first) <= 0.0)
        && t.iter().all(|x| across.dot(*x - near.second) >= 0.0)
}

/// The corner of `t` that is nearest to an inner point of `s`, if nearer than `square`: the point
/// of `t` first.
fn from_corners(s: &Triangle, t: &Triangle, square: f64) -> Option<Nearest> {
    let normal = (s[1] - s[0]).cross(s[2] - s[0]);
    let length = normal.length_squared();
    let mut best = None;
    let mut least = square;
    for &x in t {
        let height = normal.dot(x - s[0]);
        if length > 0.0 && height * height < least * length && is_above(s, normal, x) {
            let near = Nearest::new(x, x - normal * (height / length));
            if near.square < least {
                (best, least) = (Some(near), near.square);
            }
        }
    }
    best
}

/// Whether the foot of `x` on the triangle's plane is inside.
fn is_above(s: &Triangle, normal: DVec3, x: DVec3) -> bool {
    (0..3).all(|i| normal.cross(s[(i + 1) % 3] - s[i]).dot(x - s[i]) >= 0.0)
}

/// A point where an edge of `t` goes through `s`.
fn pierced(s: &Triangle, t: &Triangle) -> Option<DVec3> {
    let normal = (s[1] - s[0]).cross(s[2] - s[0]);
    let heights = t.map(|x| normal.dot(x - s[0]));
    (0..3).find_map(|j| {
        let (low, high) = (heights[j], heights[(j + 1) % 3]);
        if !(low < 0.0 && high > 0.0 || low > 0.0 && high < 0.0) {
            return None;
        }
        let x = t[j].lerp(t[(j + 1) % 3], low / (low - high));
        is_above(s, normal, x).then_some(x)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use colltrans::{ConvexPolyhedron, Pose};
    use colltrans_oracle::distance::distance_of_bodies;
    use colltrans_oracle::settings::Rng;

    /// Triangles of all kinds, small whole coordinates among them so that ties are frequent.
    fn triangle(rng: &mut Rng) -> Triangle {
        let kind = rng.int(0, 3);
        let mut corner = || if kind == 0 { rng.vector() } else { rng.grid(-2, 2) };
        let (a, b, c) = (corner(), corner(), corner());
        match kind {
            2 => [a, b, a.lerp(b, 1e-3) + c * 1e-9],
            3 => [a, b, b],
            _ => [a, b, c],
        }
    }

    #[test]
    fn the_distance_is_the_exact_one() {
        let mut rng = Rng::new(4);
        let mut worst = 0.0_f64;
        for _ in 0..20_000 {
            let (s, t) = (triangle(&mut rng), triangle(&mut rng));
            let [p, q] = [s, t].map(|t| ConvexPolyhedron::from_points(&t).unwrap());
            let exact = distance_of_bodies((&p, &Pose::IDENTITY), (&q, &Pose::IDENTITY)).to_f64();
            let near = nearest_of_triangles(&s, &t);
            let error = (near.square.sqrt() - exact).abs();
            assert!(error < 1e-12, "{s:?} {t:?}: {error:e} {exact}");
            worst = worst.max(error);
        }
        println!("worst error {worst:e}");
    }
}
