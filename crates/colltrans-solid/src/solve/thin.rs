//! Points and segments: facets without area, each an open shell of its own.
//!
//! A segment overlaps a closed shell if a part of it is inside, and an open shell if it passes from one side to the
//! other. A point overlaps the closed shells that contain it. Unless an end of the segment is inside, it shares a point
//! with the surface:
//!
//! 1. It meets a facet of a closed shell, and one of its ends lies on the inner side of the facet's plane. It runs
//!    inside if it [enters](super::line::enters_body) the body there.
//! 2. It passes through the interior of an open facet.
//! 3. It passes an edge of an open shell whose facets lie on both sides of the segment.
//! 4. It passes a vertex of an open shell, according to the [`fan`](super::fan) around the vertex.

use std::cmp::Ordering;
use std::cmp::Ordering::{Equal, Greater, Less};

use super::fan::Fan;
use super::line::{self, Line, LineDirection};
use super::overlap::{EdgeAxis, EdgeNeighbourhood};
use super::scene::{PairFrame, PlacedVertex};
use super::triangle::Triangle;
use crate::body::wedge::Ray;

/// Returns the ends of a facet without area, equal for a point; `None` for any other facet.
pub(super) fn segment_ends(triangle: &Triangle) -> Option<[PlacedVertex; 2]> {
    let thin = triangle.side.solid.is_without_area(triangle.index);
    thin.then_some([triangle.corners[0], triangle.corners[1]])
}

/// Checks whether two facets show an overlap; `None` if both have an area.
pub(super) fn show_overlap(scene: &PairFrame, f: &Triangle, g: &Triangle) -> Option<bool> {
    match (segment_ends(f), segment_ends(g)) {
        (None, None) => None,
        (Some(segment), None) => Some(runs_into(scene, segment, g)),
        (None, Some(segment)) => Some(runs_into(scene, segment, f)),
        (Some(_), Some(_)) => Some(false),
    }
}

fn runs_into(scene: &PairFrame, segment: [PlacedVertex; 2], facet: &Triangle) -> bool {
    if segment[0].local == segment[1].local {
        return false;
    }
    if !facet.is_open() {
        return runs_inside(scene, &segment, facet);
    }
    passes_facet(scene, &segment, facet)
        || (0..3).any(|k| passes_edge(scene, &segment, facet, k))
        || (0..3).any(|k| passes_vertex(scene, &segment, facet, k))
}

/// Checks case 1.
fn runs_inside(scene: &PairFrame, [p, q]: &[PlacedVertex; 2], facet: &Triangle) -> bool {
    let [a, b, c] = &facet.corners;
    let (from, to, outer) = match [p, q].map(|end| scene.side_of_plane(a, b, c, end)) {
        [Less, Less] => return false,
        [outer, Less] => (p, q, outer),
        [Less, outer] => (q, p, outer),
        _ => return false,
    };
    let around = [[a, b], [b, c], [c, a]].map(|[u, v]| scene.side_of_plane(p, q, u, v));
    let is_met = !(around.contains(&Greater) && around.contains(&Less));
    let line = Line { from, way: LineDirection::To(to) };
    is_met && line::enters_body(scene, &line, facet.side, facet.index as u32, outer == Greater)
}

/// Checks case 2.
fn passes_facet(scene: &PairFrame, [p, q]: &[PlacedVertex; 2], facet: &Triangle) -> bool {
    let [a, b, c] = &facet.corners;
    let [x, y] = [p, q].map(|end| scene.side_of_plane(a, b, c, end));
    x != Equal && x == y.reverse() && {
        let around = [[a, b], [b, c], [c, a]].map(|[u, v]| scene.side_of_plane(p, q, u, v));
        around[0] != Equal && around[1] == around[0] && around[2] == around[0]
    }
}

/// Checks case 3 for edge `k` of a facet.
fn passes_edge(scene: &PairFrame, [p, q]: &[PlacedVertex; 2], facet: &Triangle, k: usize) -> bool {
    let (a, b) = (&facet.corners[k], &facet.corners[(k + 1) % 3]);
    let Some(across) = facet.corner_across_edge(k) else { return false };
    if scene.side_of_plane(a, b, p, q) != Equal {
        return false;
    }
    // An axis of the world along which the ends of the edge project strictly to opposite sides of the segment's line.
    let strictly = |axis: &usize| {
        let [x, y] = [a, b].map(|end| scene.projected_orientation(*axis, p, q, end));
        x != Equal && x == y.reverse()
    };
    let Some(axis) = (0..3).find(strictly) else { return false };
    let [x, y] = [p, q].map(|end| scene.projected_orientation(axis, a, b, end));
    if x == Equal || x != y.reverse() {
        return false;
    }
    let own = EdgeNeighbourhood::Bend([Ray::towards(0), Ray::towards(1)]);
    let points = [&across, &facet.corners[(k + 2) % 3], p, q];
    own.overlaps_around(
        &EdgeNeighbourhood::Bend([Ray::towards(2), Ray::towards(3)]),
        &EdgeAxis { scene, p: a, q: b, points },
    )
}

/// Checks case 4 for corner `k` of a facet.
fn passes_vertex(
    scene: &PairFrame,
    [p, q]: &[PlacedVertex; 2],
    facet: &Triangle,
    k: usize,
) -> bool {
    let v = &facet.corners[k];
    let is_end = |end: &PlacedVertex| (0..3).all(|axis| scene.axis_order(axis, v, end) == Equal);
    if !is_on(scene, v, [p, q]) || is_end(p) || is_end(q) {
        return false;
    }
    let fan = Fan::new(scene, facet.side, facet.index as u32, v);
    fan.is_some_and(|fan| fan.is_passed(&Line { from: p, way: LineDirection::To(q) }))
}

/// Checks whether a point lies on a segment, ends included.
fn is_on(scene: &PairFrame, point: &PlacedVertex, [p, q]: [&PlacedVertex; 2]) -> bool {
    (0..3).all(|axis| {
        scene.projected_orientation(axis, p, q, point) == Equal
            && !are_strictly_one(scene.axis_order(axis, p, point), scene.axis_order(axis, q, point))
    })
}

fn are_strictly_one(x: Ordering, y: Ordering) -> bool {
    x != Equal && x == y
}

/// Checks whether two segments or points have a common point.
pub(super) fn share_a_point(
    scene: &PairFrame,
    [p, q]: [PlacedVertex; 2],
    [r, s]: [PlacedVertex; 2],
) -> bool {
    let boxed = (0..3).all(|axis| {
        let orders =
            [(&p, &r), (&p, &s), (&q, &r), (&q, &s)].map(|(a, b)| scene.axis_order(axis, a, b));
        !orders.iter().all(|&o| o == Less) && !orders.iter().all(|&o| o == Greater)
    });
    let straddle = |a: &PlacedVertex, b: &PlacedVertex, c: &PlacedVertex, e: &PlacedVertex| {
        (0..3).all(|axis| {
            let turn = |x: &PlacedVertex| scene.projected_orientation(axis, a, b, x);
            !are_strictly_one(turn(c), turn(e))
        })
    };
    boxed
        && scene.side_of_plane(&p, &q, &r, &s) == Equal
        && straddle(&p, &q, &r, &s)
        && straddle(&r, &s, &p, &q)
}
