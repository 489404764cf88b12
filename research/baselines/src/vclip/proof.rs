//! The nearest points of two features, and how near the bodies can be at most.
//!
//! Notation. `p`, `q` points of the moving and the fixed body in the fixed body's frame; `n` a unit
//! vector. For every `n` the slab between the supporting planes,
//! `w(n) = min_Q n . q - max_P n . p`, is a lower bound of the distance; for the nearest points and
//! `n` along `q - p` it is the distance. The difference is the *gap*: what the answer can be wrong
//! by, whatever walk led to it.
//!
//! Close to contact `q - p` is known to a few units in the last place of the *size* and its
//! direction to as little as that allows; the features give better ones: the face's normal, what is
//! orthogonal to the edges.

use glam::DVec3;

use super::segment::{at, foot, nearest_of_segments};
use super::walk::{Pair, Scene};
use crate::features::{Feature, HalfEdge, Shell};

/// Rounding of a coordinate of a difference of two points, in units of `2^-53` times the size: as
/// derived at the head of `colltrans`' `minkowski`.
const NOISE: f64 = 32.0;

/// Edges of a vertex that are looked at when an answer is not proven at once: pairs of them are.
const MAX_FAN: usize = 32;

/// Nearest points of a pair of features, in the fixed body's frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Nearest {
    pub(crate) on_moving: DVec3,
    pub(crate) on_fixed: DVec3,
    pub(crate) distance: f64,
    /// Unit vector from the moving to the fixed point.
    normal: DVec3,
}

/// The slab between two parallel supporting planes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Slab {
    /// By how much the slab is narrower than the distance found.
    pub(crate) gap: f64,
    /// Vertices on the planes: if the gap is real, a nearer pair is around here.
    pub(crate) supports: Pair,
}

impl Scene<'_> {
    /// The nearest points of two features that a walk ended with.
    pub(crate) fn nearest(&self, pair: Pair) -> Nearest {
        use Feature::{Edge, Face, Vertex};
        let [from_moving, from_fixed] = &self.views;
        let (moving, fixed) = (from_moving.own, from_fixed.own);
        let seen = |h: u32| {
            let HalfEdge { origin, target, .. } = moving.half_edge(h);
            [from_fixed.seen(origin), from_fixed.seen(target)]
        };
        match pair {
            [Vertex(v), Vertex(w)] => {
                let (p, q) = (from_fixed.seen(v), fixed.vertex(w));
                Nearest::new(p, q, q - p)
            }
            [Vertex(v), Edge(h)] => {
                let (p, edge) = (from_fixed.seen(v), fixed.ends(h));
                let share = foot(p, edge);
                let q = at(edge, share);
                Nearest::new(p, q, across(q - p, edge, share))
            }
            [Edge(h), Vertex(w)] => {
                let (edge, q) = (seen(h), fixed.vertex(w));
                let share = foot(q, edge);
                let p = at(edge, share);
                Nearest::new(p, q, across(q - p, edge, share))
            }
            [Edge(g), Edge(h)] => {
                let (first, second) = (seen(g), fixed.ends(h));
                let near = nearest_of_segments(first, second);
                let apart = near.second - near.first;
                let crossing = near.share > 0.0 && near.share < 1.0;
                let normal = if crossing { across_both(apart, first, second) } else { apart };
                Nearest::new(near.first, near.second, normal)
            }
            [Vertex(v), Face(f)] => {
                let (p, normal) = (from_fixed.seen(v), fixed.normal(f));
                Nearest::new(p, p - normal * fixed.height(f, p), -normal)
            }
            [Face(f), Vertex(w)] => {
                let normal = from_fixed.rotation * moving.normal(f);
                let (q, height) = (fixed.vertex(w), moving.height(f, from_moving.seen(w)));
                Nearest::new(q - normal * height, q, normal)
            }
            // No walk ends here.
            [a, b] => {
                let vertices = [moving.some_vertex(a), fixed.some_vertex(b)].map(Vertex);
                self.nearest(vertices)
            }
        }
    }

    /// Of each feature the vertex that is nearest to its nearest point.
    pub(crate) fn nearest_vertices(&self, pair: Pair) -> [u32; 2] {
        let [from_moving, from_fixed] = &self.views;
        let Nearest { on_moving, on_fixed, .. } = self.nearest(pair);
        let in_moving = from_moving.rotation * on_moving + from_moving.translation;
        [
            nearest_corner(from_moving.own, pair[0], in_moving),
            nearest_corner(from_fixed.own, pair[1], on_fixed),
        ]
    }

    /// How far below the distance of these points that of the bodies can be. `pair` is where to
    /// look for supporting planes first.
    pub(crate) fn slab(&self, near: &Nearest, pair: Pair) -> Slab {
        let straight = self.slab_along(near, near.normal, pair);
        if straight.gap <= self.rounding() {
            return straight;
        }
        // A tie: the normal is at the border of what the features allow, and rounded beyond it.
        self.normals_around(near.normal, pair)
            .into_iter()
            .map(|normal| self.slab_along(near, normal, pair))
            .fold(straight, |best, slab| if slab.gap < best.gap { slab } else { best })
    }

    /// A gap that rounding explains: a few noises of the coordinates.
    pub(crate) fn rounding(&self) -> f64 {
        let size = self.views.iter().map(|view| view.own.reach()).sum::<f64>()
            + self.views[1].translation.length();
        4.0 * NOISE * (f64::EPSILON / 2.0) * size
    }

    fn slab_along(&self, near: &Nearest, normal: DVec3, pair: Pair) -> Slab {
        let [from_moving, from_fixed] = &self.views;
        let (moving, fixed) = (from_moving.own, from_fixed.own);
        let p = moving.support(from_moving.rotation * normal, moving.some_vertex(pair[0]));
        let q = fixed.support(-normal, fixed.some_vertex(pair[1]));
        let width = normal.dot(fixed.vertex(q) - from_fixed.seen(p));
        let gap = (near.distance - width.max(0.0)).max(0.0);
        Slab { gap, supports: [p, q].map(Feature::Vertex) }
    }

    /// Goes on to nearer features around as long as there are any, by distances alone: where a body
    /// comes close at a small angle, rounding hides on which side of a Voronoi plane a point is
    /// long before it hides a distance. Says whether it went anywhere.
    pub(crate) fn polish(&self, pair: &mut Pair) -> bool {
        let (start, mut best) = (*pair, self.nearest(*pair).distance);
        for _ in 0..self.patience() {
            let distances = self.pairs_around(*pair).into_iter();
            let distances = distances.map(|pair| (self.nearest(pair).distance, pair));
            match distances.min_by(|a, b| a.0.total_cmp(&b.0)) {
                Some((distance, nearer)) if distance < best => (best, *pair) = (distance, nearer),
                _ => break,
            }
        }
        *pair != start
    }

    /// Edges with edges, which includes their ends, and vertices above faces.
    fn pairs_around(&self, pair: Pair) -> Vec<Pair> {
        let around = self.around(pair);
        let shells = self.views.map(|view| view.own);
        let mut pairs = Vec::new();
        for &g in &around[0] {
            for &h in &around[1] {
                pairs.push([shells[0].edge(g), shells[1].edge(h)]);
                for (body, vertex_edge, face_edge) in [(1, g, h), (0, h, g)] {
                    let vertex = shells[1 - body].half_edge(vertex_edge).target;
                    let face = shells[body].half_edge(face_edge).face;
                    if self.views[body].is_above(face, vertex) {
                        let mut pair = [Feature::Vertex(vertex); 2];
                        pair[body] = Feature::Face(face);
                        pairs.push(pair);
                    }
                }
            }
        }
        pairs
    }

    /// The half-edges that leave two features where they are nearest: all of them, unless a vertex
    /// has very many.
    fn around(&self, pair: Pair) -> [Vec<u32>; 2] {
        let near = self.nearest_vertices(pair);
        let leaving = |body: usize| {
            let shell = self.views[body].own;
            let vertices = match pair[body] {
                Feature::Edge(h) => shell.half_edge(h).both_ends().to_vec(),
                _ => vec![near[body]],
            };
            let fans = vertices.into_iter().flat_map(|v| shell.outgoing(v).iter().take(MAX_FAN));
            fans.copied().collect()
        };
        [leaving(0), leaving(1)]
    }

    /// Unit vectors that two features may have meant by `normal`: across one edge around them, or
    /// across one of each body, or along a face's normal; with both signs where the edges do not
    /// say which.
    fn normals_around(&self, normal: DVec3, pair: Pair) -> Vec<DVec3> {
        let [from_moving, from_fixed] = &self.views;
        let to_fixed = |n: DVec3| from_fixed.rotation * n;
        let [moving, fixed] = self.around(pair);
        let moving = described(from_moving.own, &moving);
        let fixed = described(from_fixed.own, &fixed);
        let moving = moving.into_iter().map(|(along, n)| (to_fixed(along), to_fixed(n)));
        let moving: Vec<(DVec3, DVec3)> = moving.collect();
        let mut normals: Vec<DVec3> = moving.iter().map(|(_, n)| *n).collect();
        normals.extend(fixed.iter().map(|(_, n)| -*n));
        for (along, _) in moving.iter().chain(&fixed) {
            normals.push((normal - along * normal.dot(*along)).normalize_or_zero());
        }
        for (first, _) in &moving {
            for (second, _) in &fixed {
                let across = first.cross(*second).normalize_or_zero();
                normals.extend([across, -across]);
            }
        }
        normals
    }
}

impl Nearest {
    fn new(p: DVec3, q: DVec3, normal: DVec3) -> Self {
        Self {
            on_moving: p,
            on_fixed: q,
            distance: p.distance(q),
            normal: normal.normalize_or_zero(),
        }
    }
}

/// `apart` without what rounding left of it along an edge, if it ends at an inner point of it.
fn across(apart: DVec3, [a, b]: [DVec3; 2], share: f64) -> DVec3 {
    if share <= 0.0 || share >= 1.0 {
        return apart;
    }
    let along = (b - a).normalize_or_zero();
    apart - along * apart.dot(along)
}

/// The common normal of two edges, unless they are so nearly parallel that `apart` says it better.
fn across_both(apart: DVec3, [a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> DVec3 {
    let normal = (b - a).normalize_or_zero().cross((d - c).normalize_or_zero());
    let length = apart.length();
    if normal.length() * length < f64::EPSILON.sqrt() * a.distance(b).max(c.distance(d)).max(length)
    {
        return across(apart, [a, b], 0.5);
    }
    normal * normal.dot(apart).signum()
}

/// Unit vector along each half-edge, and the normal of the face on its left.
fn described(shell: &Shell, half_edges: &[u32]) -> Vec<(DVec3, DVec3)> {
    let described = half_edges.iter().map(|&h| {
        let [a, b] = shell.ends(h);
        ((b - a).normalize_or_zero(), shell.normal(shell.half_edge(h).face))
    });
    described.collect()
}

fn corners(shell: &Shell, feature: Feature) -> Vec<u32> {
    match feature {
        Feature::Vertex(v) => vec![v],
        Feature::Edge(h) => shell.half_edge(h).both_ends().to_vec(),
        Feature::Face(f) => shell.boundary(f).map(|h| shell.half_edge(h).origin).collect(),
    }
}

fn nearest_corner(shell: &Shell, feature: Feature, x: DVec3) -> u32 {
    let square = |v: &u32| shell.vertex(*v).distance_squared(x);
    let corners = corners(shell, feature).into_iter();
    corners
        .min_by(|v, w| square(v).total_cmp(&square(w)))
        .unwrap_or_else(|| shell.some_vertex(feature))
}
