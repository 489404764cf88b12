//! Nearest points of two features, and a lower bound of the distance of the bodies.
//!
//! `p`, `q` are points of the moving and the fixed body in the fixed body's frame, `n` is a unit vector. For
//! every `n` the width of the slab between the supporting planes, `w(n) = min_Q n . q - max_P n . p`, is a
//! lower bound of the distance. For the nearest points and `n` along `q - p` it equals the distance. The
//! difference is the *gap*, a bound on the error of the answer, whatever the walk did.
//!
//! Near contact, `q - p` has an error of a few units in the last place of the *size*, which limits the
//! accuracy of its direction. The features yield better directions: the normal of a face, or a vector
//! orthogonal to the edges.

use glam::DVec3;

use super::segment::{at, foot, nearest_of_segments};
use super::walk::{Pair, Scene};
use crate::features::{Feature, HalfEdge, Shell};

/// Rounding error of a coordinate of a difference of two points, in units of `2^-53` times the size, as
/// derived in `colltrans-kernel` (`noise`).
const NOISE: f64 = 32.0;

/// Maximum number of edges of a vertex that are examined, in pairs, if a result is not proven at once.
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
    /// Difference of the distance found and the width of the slab.
    pub(crate) gap: f64,
    /// Vertices on the planes. If the gap is real, a nearer pair is near them.
    pub(crate) supports: Pair,
}

impl Scene<'_> {
    /// Computes the nearest points of two features at the end of a walk.
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
                Nearest::new(p, q, without_component_along(q - p, edge, share))
            }
            [Edge(h), Vertex(w)] => {
                let (edge, q) = (seen(h), fixed.vertex(w));
                let share = foot(q, edge);
                let p = at(edge, share);
                Nearest::new(p, q, without_component_along(q - p, edge, share))
            }
            [Edge(g), Edge(h)] => {
                let (first, second) = (seen(g), fixed.ends(h));
                let near = nearest_of_segments(first, second);
                let apart = near.second - near.first;
                let crossing = near.share > 0.0 && near.share < 1.0;
                let normal = if crossing { common_normal(apart, first, second) } else { apart };
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
            // No walk ends at such a pair.
            [a, b] => {
                let vertices = [moving.some_vertex(a), fixed.some_vertex(b)].map(Vertex);
                self.nearest(vertices)
            }
        }
    }

    /// Returns for each feature its vertex nearest to its nearest point.
    pub(crate) fn nearest_vertices(&self, pair: Pair) -> [u32; 2] {
        let [from_moving, from_fixed] = &self.views;
        let Nearest { on_moving, on_fixed, .. } = self.nearest(pair);
        let in_moving = from_moving.rotation * on_moving + from_moving.translation;
        [
            nearest_corner(from_moving.own, pair[0], in_moving),
            nearest_corner(from_fixed.own, pair[1], on_fixed),
        ]
    }

    /// Returns the slab with the smallest gap found. `pair` is the start of the search for supporting planes.
    pub(crate) fn narrowest_gap_slab(&self, near: &Nearest, pair: Pair) -> Slab {
        let straight = self.slab_along(near, near.normal, pair);
        if straight.gap <= self.rounding() {
            return straight;
        }
        // For ties, the normal is at the boundary of the directions that the features permit, and rounding
        // moved it outside.
        self.normals_around(near.normal, pair)
            .into_iter()
            .map(|normal| self.slab_along(near, normal, pair))
            .fold(straight, |best, slab| if slab.gap < best.gap { slab } else { best })
    }

    /// Returns the largest gap that rounding explains: four noises of the coordinates.
    pub(crate) fn rounding(&self) -> f64 {
        let size = self.views.iter().map(|view| view.own.reach()).sum::<f64>()
            + self.views[1].translation.length();
        4.0 * NOISE * (f64::EPSILON / 2.0) * size
    }

    /// Returns the slab along a normal.
    fn slab_along(&self, near: &Nearest, normal: DVec3, pair: Pair) -> Slab {
        let [from_moving, from_fixed] = &self.views;
        let (moving, fixed) = (from_moving.own, from_fixed.own);
        let p = moving.support(from_moving.rotation * normal, moving.some_vertex(pair[0]));
        let q = fixed.support(-normal, fixed.some_vertex(pair[1]));
        let width = normal.dot(fixed.vertex(q) - from_fixed.seen(p));
        let gap = (near.distance - width.max(0.0)).max(0.0);
        Slab { gap, supports: [p, q].map(Feature::Vertex) }
    }

    /// Moves to nearer features in the surroundings, by distances alone, while there are any. If a body
    /// approaches at a small angle, rounding hides the side of a Voronoi plane earlier than a distance.
    /// Returns whether the pair changed.
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

    /// Returns the surrounding pairs: all pairs of edges (which include their ends), and vertices above
    /// faces.
    fn pairs_around(&self, pair: Pair) -> Vec<Pair> {
        let around = self.surrounding_half_edges(pair);
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

    /// Returns for each feature the half-edges that leave it where the features are nearest, at most
    /// [`MAX_FAN`] for each vertex.
    fn surrounding_half_edges(&self, pair: Pair) -> [Vec<u32>; 2] {
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

    /// Returns candidates for the exact normal: perpendicular to one surrounding edge, perpendicular to one
    /// edge of each body, or the normal of a face. Both signs are included where the edges do not determine
    /// the sign.
    fn normals_around(&self, normal: DVec3, pair: Pair) -> Vec<DVec3> {
        let [from_moving, from_fixed] = &self.views;
        let to_fixed = |n: DVec3| from_fixed.rotation * n;
        let [moving, fixed] = self.surrounding_half_edges(pair);
        let moving = directions_and_normals(from_moving.own, &moving);
        let fixed = directions_and_normals(from_fixed.own, &fixed);
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
    /// Creates the nearest points with a normal of any length.
    fn new(p: DVec3, q: DVec3, normal: DVec3) -> Self {
        Self {
            on_moving: p,
            on_fixed: q,
            distance: p.distance(q),
            normal: normal.normalize_or_zero(),
        }
    }
}

/// Returns `apart` without its rounding error along an edge, if it ends at an interior point of the edge.
fn without_component_along(apart: DVec3, [a, b]: [DVec3; 2], share: f64) -> DVec3 {
    if share <= 0.0 || share >= 1.0 {
        return apart;
    }
    let along = (b - a).normalize_or_zero();
    apart - along * apart.dot(along)
}

/// Returns the common normal of two edges, or `apart` without its component along the first edge if the edges are
/// nearly parallel and this vector is more accurate.
fn common_normal(apart: DVec3, [a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> DVec3 {
    let normal = (b - a).normalize_or_zero().cross((d - c).normalize_or_zero());
    let length = apart.length();
    if normal.length() * length < f64::EPSILON.sqrt() * a.distance(b).max(c.distance(d)).max(length)
    {
        return without_component_along(apart, [a, b], 0.5);
    }
    normal * normal.dot(apart).signum()
}

/// Returns for each half-edge its unit direction and the normal of the face on its left.
fn directions_and_normals(shell: &Shell, half_edges: &[u32]) -> Vec<(DVec3, DVec3)> {
    let described = half_edges.iter().map(|&h| {
        let [a, b] = shell.ends(h);
        ((b - a).normalize_or_zero(), shell.normal(shell.half_edge(h).face))
    });
    described.collect()
}

/// Returns the vertices of a feature.
fn corners(shell: &Shell, feature: Feature) -> Vec<u32> {
    match feature {
        Feature::Vertex(v) => vec![v],
        Feature::Edge(h) => shell.half_edge(h).both_ends().to_vec(),
        Feature::Face(f) => shell.boundary(f).map(|h| shell.half_edge(h).origin).collect(),
    }
}

/// Returns the vertex of a feature nearest to `x`.
fn nearest_corner(shell: &Shell, feature: Feature, x: DVec3) -> u32 {
    let square = |v: &u32| shell.vertex(*v).distance_squared(x);
    let corners = corners(shell, feature).into_iter();
    corners
        .min_by(|v, w| square(v).total_cmp(&square(w)))
        .unwrap_or_else(|| shell.some_vertex(feature))
}
