//! Gift wrapping: which neighbour a plane meets first that turns about a vertex or an edge of `M`.
//!
//! Seen along the axis of the turn, the edges that leave a vertex are rays on one side of the plane, and
//! the plane meets them in the order of their angles. In cyclic order of the edges the angle has one
//! maximum and one minimum, because what the body's cone is seen as is a wedge; so around a vertex with
//! many neighbours the first is found in `O(log n)`, mostly at once: near the one that rises least, as most planes that
//! turn support the body.

use std::hint::select_unpredictable;

use glam::{DVec2, DVec3};

use crate::body::{ConvexPolyhedron, FAN, greatest_near};
use crate::setting::VertexPair;
use crate::setting::minkowski::{MinkowskiDifference, Point};

/// A plane that turns downwards on one side.
pub(super) struct Tilt {
    /// Its normal (shadow frame, any length).
    pub(super) normal: DVec3,
    /// Away from the axis of the turn, in the shadow plane, any length.
    pub(super) outward: DVec2,
}

/// Of the neighbours of a vertex of `M` on the axis of the turn, the one with the least rise over
/// its run.
#[inline]
pub(super) fn first_met(
    difference: &MinkowskiDifference,
    vertex: &Point,
    tilt: &Tilt,
) -> Option<Point> {
    let [moving, fixed] = vertex.pair.numbers();
    let setting = difference.setting;
    let (normal, outward) = (tilt.normal, tilt.outward.extend(0.0));
    // A neighbour closer to the axis than this is not beyond it.
    let least = difference.touching() * tilt.outward.length();
    let turn =
        Turn { up: -difference.in_moving(normal), out: -difference.in_moving(outward), least };
    let p = turn.first(setting.moving, moving);
    let turn = Turn { up: difference.in_fixed(normal), out: difference.in_fixed(outward), least };
    let q = turn.first(setting.fixed, fixed);
    let of_fixed = q.rise * p.run < p.rise * q.run;
    let found = if of_fixed { q.vertex } else { p.vertex };
    if found == NOBODY {
        return None;
    }
    let moving = select_unpredictable(of_fixed, moving, found);
    let fixed = select_unpredictable(of_fixed, found, fixed);
    Some(difference.vertex(VertexPair::of(moving, fixed)))
}

/// A turn seen from one body's frame: `up` and `out` measure rise and run.
struct Turn {
    up: DVec3,
    out: DVec3,
    /// Least run.
    least: f64,
}

/// The neighbour that a turn meets first.
struct First {
    vertex: u32,
    rise: f64,
    run: f64,
}

/// No neighbour lies beyond the axis.
const NOBODY: u32 = u32::MAX;

impl Turn {
    /// The first among the neighbours of one body's vertex.
    #[inline]
    #[expect(clippy::needless_bitwise_bool, reason = "a branch here is not predictable")]
    fn first(&self, body: &ConvexPolyhedron, vertex: u32) -> First {
        let here = body.vertices()[vertex as usize];
        let neighbours = body.neighbours(vertex);
        if neighbours.len() > FAN {
            return self.first_of_many(body, vertex, neighbours);
        }
        let mut first = First { vertex: NOBODY, rise: f64::INFINITY, run: 1.0 };
        for &w in neighbours {
            let edge = body.vertices()[w as usize] - here;
            let (rise, run) = (self.up.dot(edge), self.out.dot(edge));
            let sooner = (run > self.least) & (rise * first.run < first.rise * run);
            first.vertex = select_unpredictable(sooner, w, first.vertex);
            first.rise = select_unpredictable(sooner, rise, first.rise);
            first.run = select_unpredictable(sooner, run, first.run);
        }
        first
    }

    /// The same, by a search.
    #[cold]
    #[inline(never)]
    fn first_of_many(&self, body: &ConvexPolyhedron, vertex: u32, neighbours: &[u32]) -> First {
        let here = body.vertices()[vertex as usize];
        let ahead = |i: usize| {
            let edge = body.vertices()[neighbours[i] as usize] - here;
            (self.up.dot(edge), self.out.dot(edge))
        };
        // Falls as the angle grows; on the axis there is none.
        let soon = |i: usize| {
            let (rise, run) = ahead(i);
            let size = run.abs() + rise.abs();
            if run > self.least { -rise / size } else { (rise.abs() / size - 2.0).max(-2.0) }
        };
        let near = body.steepest_edge(vertex, -self.up);
        let i = greatest_near(neighbours.len(), near, soon);
        let (rise, run) = ahead(i);
        if run > self.least {
            First { vertex: neighbours[i], rise, run }
        } else {
            First { vertex: NOBODY, rise: f64::INFINITY, run: 1.0 }
        }
    }
}
