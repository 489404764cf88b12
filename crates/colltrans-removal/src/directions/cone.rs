//! The cone of directions along which one facet runs into another one.
//!
//! For facets `f` of the moving and `g` of the fixed body, the directions form an open convex cone: `n_f.d >
//! 0`, `n_g.d < 0`, and `d` is inside the cone over the differences `g - f`. Each side of that cone is
//! spanned by a vertex of one facet and an edge of the other. Fifteen exact orientation signs, each of four
//! of the six vertices, select the sides among 18 candidates.
//!
//! - Coplanar facets with opposite normals whose interiors overlap block the half-space `n_f.d > 0`.
//! - Facets that cross have no such sides, and their cone is empty: the bodies overlap at the start.
//!
//! Derivation: `docs/theory/free-directions.md`.

use std::cmp::Ordering;
use std::cmp::Ordering::{Equal, Greater, Less};

use glam::DVec3;

use super::bodies::Bodies;
use super::line::{Line, PlaneVertex};
use colltrans_solid::solve::scene::PlacedVertex;

/// Open cone that a pair of facets blocks: the directions on the positive side of all lines. Without lines it
/// is empty.
#[derive(Debug, Clone)]
pub(super) struct Cone {
    pub(super) pair: [u32; 2],
    pub(super) lines: Vec<Line>,
}

impl Cone {
    /// Computes the cone of a triangle of the moving body and one of the fixed body.
    pub(super) fn new(bodies: &Bodies, pair: [u32; 2]) -> Self {
        let (f, g) =
            (bodies.triangle_vertices(true, pair[0]), bodies.triangle_vertices(false, pair[1]));
        let signs = OrientationSigns::new(bodies, &f, &g);
        let facet_lines = [Line::through(bodies, f), Line::through(bodies, [g[0], g[2], g[1]])];
        if signs.are_coplanar() {
            let blocks = coplanar_facets_block(bodies, f, g);
            return Self { pair, lines: if blocks { vec![facet_lines[0]] } else { Vec::new() } };
        }
        let mut lines = facet_lines.to_vec();
        for k in 0..3 {
            for from in 0..3 {
                let to = (from + 1) % 3;
                if let Some(reversed) = signs.side_at_moving_vertex(k, from) {
                    lines.push(edge_line(bodies, f[k], [g[from], g[to]], reversed));
                }
                if let Some(reversed) = signs.side_at_fixed_vertex(k, from) {
                    lines.push(edge_line(bodies, g[k], [f[from], f[to]], reversed));
                }
            }
        }
        let crosses = lines.len() == 2;
        Self { pair, lines: if crosses { Vec::new() } else { lines } }
    }

    /// Checks whether a direction is inside the cone.
    pub(super) fn contains_direction(&self, bodies: &Bodies, d: DVec3) -> bool {
        !self.lines.is_empty()
            && self.lines.iter().all(|line| line.side_of_direction(bodies, d) == Greater)
    }

    /// Checks whether the convex cone of four directions is inside the cone.
    pub(super) fn contains_all(&self, bodies: &Bodies, corners: &[DVec3; 4]) -> bool {
        corners.iter().all(|&d| self.contains_direction(bodies, d))
    }

    /// Checks whether the cone is empty, or all four directions lie on or outside one of its sides.
    pub(super) fn misses_all(&self, bodies: &Bodies, corners: &[DVec3; 4]) -> bool {
        let behind =
            |line: &Line| corners.iter().all(|&d| line.side_of_direction(bodies, d) != Greater);
        self.lines.is_empty() || self.lines.iter().any(behind)
    }
}

/// Builds the line through a vertex of one body and an edge of the other.
fn edge_line(
    bodies: &Bodies,
    corner: PlaneVertex,
    [a, b]: [PlaneVertex; 2],
    reversed: bool,
) -> Line {
    Line::through(bodies, if reversed { [corner, b, a] } else { [corner, a, b] })
}

/// Orientation signs of four vertices of two facets.
struct OrientationSigns {
    /// `outside(f_i; g)`.
    moving: [Ordering; 3],
    /// `outside(g_i; f)`.
    fixed: [Ordering; 3],
    /// `outside(f_a, g_b, g_(b+1), f_(a+1))`.
    edges: [[Ordering; 3]; 3],
}

impl OrientationSigns {
    fn new(bodies: &Bodies, f: &[PlaneVertex; 3], g: &[PlaneVertex; 3]) -> Self {
        let (p, q) = (f.map(|s| bodies.placed_vertex(s)), g.map(|s| bodies.placed_vertex(s)));
        let outside = |a: &PlacedVertex, b: &PlacedVertex, c: &PlacedVertex, e: &PlacedVertex| {
            bodies.scene.side_of_plane(a, b, c, e)
        };
        Self {
            moving: p.map(|a| outside(a, q[0], q[1], q[2])),
            fixed: q.map(|a| outside(a, p[0], p[1], p[2])),
            edges: [0, 1, 2]
                .map(|a| [0, 1, 2].map(|b| outside(p[a], q[b], q[(b + 1) % 3], p[(a + 1) % 3]))),
        }
    }

    /// Checks whether all vertices are coplanar.
    fn are_coplanar(&self) -> bool {
        self.moving.iter().chain(&self.fixed).all(|sign| *sign == Equal)
    }

    /// Checks whether the plane through `f_k` and the edge of `g` from `b` has all differences on one side.
    /// Returns `Some(true)` if this is the negative side of `det[g_b - f_k, g_(b+1) - f_k, d]`, and `None` if
    /// there are differences on both sides or all are in the plane.
    fn side_at_moving_vertex(&self, k: usize, b: usize) -> Option<bool> {
        let others = [self.edges[k][b], self.edges[(k + 2) % 3][b].reverse()];
        common_side(self.moving[k], others.map(Ordering::reverse))
    }

    /// Checks whether the plane through `g_k` and the edge of `f` from `a` has all differences on one side.
    /// Returns `Some(true)` if this is the negative side of `det[f_a - g_k, f_(a+1) - g_k, d]`, and `None` if
    /// there are differences on both sides or all are in the plane.
    fn side_at_fixed_vertex(&self, k: usize, a: usize) -> Option<bool> {
        // outside(g_k, f_a, f_(a+1), g_l), an even permutation of outside(f_a, g_k, g_l, f_(a+1)).
        let others = [self.edges[a][k], self.edges[a][(k + 2) % 3].reverse()];
        common_side(self.fixed[k].reverse(), others)
    }
}

/// Returns the common side of three signs, `Some(true)` for the negative one. Returns `None` for signs on
/// both sides or for three zeros.
fn common_side(one: Ordering, others: [Ordering; 2]) -> Option<bool> {
    let all = [one, others[0], others[1]];
    match (all.contains(&Greater), all.contains(&Less)) {
        (true, false) => Some(false),
        (false, true) => Some(true),
        _ => None,
    }
}

/// Checks whether two coplanar triangles have opposite normals and overlapping interiors.
fn coplanar_facets_block(bodies: &Bodies, f: [PlaneVertex; 3], g: [PlaneVertex; 3]) -> bool {
    let scene = &bodies.scene;
    let (p, q) = (f.map(|s| bodies.placed_vertex(s)), g.map(|s| bodies.placed_vertex(s)));
    let facing = |axis: usize| scene.projected_orientation(axis, p[0], p[1], p[2]);
    let Some(axis) = (0..3).find(|&axis| facing(axis) != Equal) else { return false };
    let turn = facing(axis);
    if scene.projected_orientation(axis, q[0], q[1], q[2]) != turn.reverse() {
        return false;
    }
    let separates = |[a, b]: [&PlacedVertex; 2], others: [&PlacedVertex; 3], inner: Ordering| {
        others.iter().all(|c| scene.projected_orientation(axis, a, b, *c) != inner)
    };
    !(0..3).any(|k| {
        separates([p[k], p[(k + 1) % 3]], q, turn)
            || separates([q[k], q[(k + 1) % 3]], p, turn.reverse())
    })
}
