//! What stands, and on what: support polygons under gravity.
//!
//! Notation: seen from above is seen along `up`. What a part *rests on* is what it meets at once along `-up`; its *support*
//! are the corners of where it touches these with facets that look down. It *stands* if its centre of mass, seen from above,
//! lies in the convex hull of its support, by more than the centre may be off and contacts reach; it is *off balance* if it
//! lies outside by more than that; *between* nothing is said, nor of a part that rests on something without such facets, on
//! a slant or an edge, nor of surfaces. Friction, what leans on it, and what holds it at its sides do not count: whether what
//! is off balance falls is not said.

use glam::{DVec2, DVec3};

use crate::bodies::Bodies;
use crate::inertia;
use crate::liaisons::{footprint, reach};

/// How a part stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Standing {
    /// Its centre of mass lies over what carries it, or nothing else is known.
    Stands,
    /// Its centre of mass lies beyond that.
    OffBalance,
    /// It rests on nothing.
    Falls,
}

/// A part, as seen from above.
pub(super) struct Base {
    /// Where its centre of mass is, and how far beside that it may be; `None` of surfaces.
    center: Option<(DVec2, f64)>,
    /// On what it rests, and where; nowhere, if not with facets that look down.
    on: Vec<(usize, Vec<DVec2>)>,
}

impl Base {
    /// Of a part that rests on others.
    pub(super) fn new(bodies: &Bodies, part: usize, on: &[usize], up: DVec3) -> Self {
        let parts = bodies.assembly().parts();
        let (u, v) = up.any_orthonormal_pair();
        let seen = |p: DVec3| DVec2::new(p.dot(u), p.dot(v));
        let (solid, reach) = (parts[part].solid(), reach(bodies));
        let center = (!parts[part].is_surface()).then(|| inertia::center(solid)).flatten();
        let corners = |&below: &usize| {
            let all = footprint(solid, parts[below].solid(), reach, -up);
            (below, hull(all.into_iter().map(seen).collect()))
        };
        let center = center.map(|(center, error)| (seen(center), error + reach));
        Self { center, on: on.iter().map(corners).collect() }
    }

    /// Returns the parts that it rests on.
    pub(super) fn below(&self) -> impl Iterator<Item = usize> {
        self.on.iter().map(|(part, _)| *part)
    }

    /// How it stands on those that `carry`.
    pub(super) fn standing(&self, carry: impl Fn(usize) -> bool) -> Standing {
        let mut under = self.on.iter().filter(|(part, _)| carry(*part)).peekable();
        if under.peek().is_none() {
            return Standing::Falls;
        }
        let Some((center, slack)) = self.center else { return Standing::Stands };
        let mut corners = Vec::new();
        for (_, own) in under {
            if own.is_empty() {
                return Standing::Stands;
            }
            corners.extend_from_slice(own);
        }
        if inside(&hull(corners), center) < -slack {
            Standing::OffBalance
        } else {
            Standing::Stands
        }
    }
}

/// The corners of the convex hull, counter-clockwise.
fn hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let mut all = Vec::with_capacity(points.len());
    let half = |points: &mut dyn Iterator<Item = DVec2>, all: &mut Vec<DVec2>| {
        let from = all.len();
        for p in points {
            while all.len() >= from + 2 {
                let [a, b] = [all[all.len() - 2], all[all.len() - 1]];
                if (b - a).perp_dot(p - b) > 0.0 {
                    break;
                }
                all.pop();
            }
            all.push(p);
        }
        all.pop();
    };
    half(&mut points.iter().copied(), &mut all);
    half(&mut points.iter().rev().copied(), &mut all);
    all
}

/// How far a point lies inside of a convex polygon; negative, if it lies outside by so much at least.
fn inside(polygon: &[DVec2], point: DVec2) -> f64 {
    let to_segment = |a: DVec2, b: DVec2| {
        let along = (point - a).dot(b - a) / (b - a).length_squared().max(f64::MIN_POSITIVE);
        (a + (b - a) * along.clamp(0.0, 1.0)).distance(point)
    };
    match *polygon {
        [] => f64::NEG_INFINITY,
        [a] => -a.distance(point),
        [a, b] => -to_segment(a, b),
        _ => {
            let sides = (0..polygon.len()).map(|k| {
                let (a, b) = (polygon[k], polygon[(k + 1) % polygon.len()]);
                (b - a).perp_dot(point - a) / (b - a).length()
            });
            sides.fold(f64::INFINITY, f64::min)
        }
    }
}
