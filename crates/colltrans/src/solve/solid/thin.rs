//! Points and segments: facets without area, each an open shell of its own.
//!
//! A segment overlaps a body where a part of it runs inside a closed shell, or where it passes from one side of an
//! open shell to the other. It does so at a point that it shares with the surface:
//!
//! 1. inside a facet: its ends lie on both sides of the facet, or one lies on the facet and the other one inside;
//! 2. on an edge: one of the two ways along the segment lies strictly in the wedge of material;
//! 3. at a vertex: one of the two ways points into the material, as the [`fan`](super::fan) around it says.
//!
//! A segment that shares no such point with the surface is inside a shell as a whole, or not at all. A point
//! is never on the inside by what it shares with a surface.

use std::cmp::Ordering;
use std::cmp::Ordering::{Equal, Greater, Less};

use super::fan::{Fan, Line};
use super::overlap::{Around, Stuff};
use super::scene::{Corner, Scene};
use super::triangle::Triangle;
use crate::body::solid::wedge::Ray;

/// Returns the ends of a facet without area, equal for a point; `None` of any other facet.
pub(super) fn ends(triangle: &Triangle) -> Option<[Corner; 2]> {
    let thin = triangle.side.solid.is_without_area(triangle.index);
    thin.then_some([triangle.corners[0], triangle.corners[1]])
}

/// Checks whether two facets show an overlap; `None` if both have an area.
pub(super) fn overlaps(scene: &Scene, f: &Triangle, g: &Triangle) -> Option<bool> {
    match (ends(f), ends(g)) {
        (None, None) => None,
        (Some(segment), None) => Some(runs_into(scene, segment, g)),
        (None, Some(segment)) => Some(runs_into(scene, segment, f)),
        (Some(_), Some(_)) => Some(false),
    }
}

fn runs_into(scene: &Scene, segment: [Corner; 2], facet: &Triangle) -> bool {
    segment[0].local != segment[1].local
        && (passes_inside(scene, &segment, facet)
            || (0..3).any(|k| passes_edge(scene, &segment, facet, k))
            || (0..3).any(|k| passes_vertex(scene, &segment, facet, k)))
}

/// Case 1.
fn passes_inside(scene: &Scene, [p, q]: &[Corner; 2], facet: &Triangle) -> bool {
    let [a, b, c] = &facet.corners;
    let passes = match [p, q].map(|end| scene.outside(a, b, c, end)) {
        [Equal, Equal] => false,
        [x, y] if x == y => false,
        [Equal, x] | [x, Equal] => x == Less && !facet.is_open(),
        _ => true,
    };
    passes && {
        let around = [[a, b], [b, c], [c, a]].map(|[u, v]| scene.outside(p, q, u, v));
        around[0] != Equal && around[1] == around[0] && around[2] == around[0]
    }
}

/// Case 2, for edge `k` of a facet.
fn passes_edge(scene: &Scene, [p, q]: &[Corner; 2], facet: &Triangle, k: usize) -> bool {
    let (a, b) = (&facet.corners[k], &facet.corners[(k + 1) % 3]);
    if scene.outside(a, b, p, q) != Equal {
        return false;
    }
    // Across an axis along which the plane of both has an area.
    let ends_beside = |axis: usize| [p, q].map(|end| scene.turn_about(axis, a, b, end));
    let edge_beside = |axis: usize| [a, b].map(|end| scene.turn_about(axis, p, q, end));
    let strictly = |axis: &usize| {
        let [x, y] = edge_beside(*axis);
        x != Equal && x == y.reverse()
    };
    let Some(axis) = (0..3).find(strictly) else { return false };
    let beside = ends_beside(axis);
    if beside[0] == beside[1] {
        return false;
    }
    let ways: Vec<usize> = (0..2).filter(|&end| beside[end] != Equal).collect();
    let rays = match ways[..] {
        [way] => Stuff::Rim(Ray::to(2 + way)),
        _ => Stuff::Bend([Ray::to(2), Ray::to(3)]),
    };
    let apex = &facet.corners[(k + 2) % 3];
    let across = facet.across(k);
    let own = Stuff::around(facet.is_open(), across.is_some(), [Ray::to(0), Ray::to(1)]);
    let points = [across.as_ref().unwrap_or(apex), apex, p, q];
    own.is_some_and(|own| own.overlaps(&rays, &Around { scene, p: a, q: b, points }))
}

/// Case 3, for corner `k` of a facet.
fn passes_vertex(scene: &Scene, [p, q]: &[Corner; 2], facet: &Triangle, k: usize) -> bool {
    let v = &facet.corners[k];
    if !is_on(scene, v, [p, q]) {
        return false;
    }
    let Some(fan) = Fan::new(scene, facet.side, facet.index as u32, v) else { return false };
    let is_before = |end: &Corner| (0..3).any(|axis| scene.order(axis, v, end) != Equal);
    let (ahead, behind) = (is_before(q), is_before(p));
    let [there, back] = [[*p, *q], [*q, *p]].map(Line::Through);
    if facet.is_open() {
        ahead && behind && fan.is_passed(&there)
    } else {
        ahead && fan.has_inside(&there) || behind && fan.has_inside(&back)
    }
}

/// Checks whether a point lies on a segment, ends included.
fn is_on(scene: &Scene, point: &Corner, [p, q]: [&Corner; 2]) -> bool {
    (0..3).all(|axis| {
        scene.turn_about(axis, p, q, point) == Equal
            && !are_strictly_one(scene.order(axis, p, point), scene.order(axis, q, point))
    })
}

fn are_strictly_one(x: Ordering, y: Ordering) -> bool {
    x != Equal && x == y
}

/// Checks whether two segments, or points, have a point in common.
pub(super) fn share_a_point(scene: &Scene, [p, q]: [Corner; 2], [r, s]: [Corner; 2]) -> bool {
    let boxed = (0..3).all(|axis| {
        let orders = [(&p, &r), (&p, &s), (&q, &r), (&q, &s)].map(|(a, b)| scene.order(axis, a, b));
        !orders.iter().all(|&o| o == Less) && !orders.iter().all(|&o| o == Greater)
    });
    let straddle = |a: &Corner, b: &Corner, c: &Corner, e: &Corner| {
        (0..3).all(|axis| {
            let turn = |x: &Corner| scene.turn_about(axis, a, b, x);
            !are_strictly_one(turn(c), turn(e))
        })
    };
    boxed
        && scene.outside(&p, &q, &r, &s) == Equal
        && straddle(&p, &q, &r, &s)
        && straddle(&r, &s, &p, &q)
}
