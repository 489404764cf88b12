//! Stability of parts under gravity, by support polygons.
//!
//! - A part *rests on* the parts that block it at once along `-up`.
//! - Its *support* is the convex hull, projected along `up`, of the areas in which its downward facets touch these
//!   parts.
//! - A part is *off balance* if its centre of mass projects outside of the support by more than the error of the
//!   centre plus the contact reach. Otherwise it counts as *standing*.
//! - A part also counts as standing if some part below touches none of its downward facets (a slant or an edge), or
//!   if it is a surface.
//!
//! Friction and lateral support are ignored. Therefore a part that is off balance need not fall.

use glam::{DVec2, DVec3};

use crate::bodies::Bodies;
use crate::inertia;
use crate::liaisons::{contact_reach, footprint_corners};

/// Stability of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stability {
    /// Its centre of mass is above the support, or no instability is established.
    Stands,
    /// Its centre of mass is outside of the support.
    OffBalance,
    /// It rests on no part.
    Falls,
}

/// The support of a part, projected along `up`.
pub(super) struct Support {
    /// Centre of mass and its error plus the contact reach; `None` for surfaces.
    center: Option<(DVec2, f64)>,
    /// The parts that it rests on, each with the corners of the contact; no corners if no downward facet touches.
    contacts: Vec<(usize, Vec<DVec2>)>,
}

impl Support {
    /// Computes the support of a part that rests on others.
    pub(super) fn new(bodies: &Bodies, part: usize, on: &[usize], up: DVec3) -> Self {
        let parts = bodies.assembly().parts();
        let (u, v) = up.any_orthonormal_pair();
        let seen = |p: DVec3| DVec2::new(p.dot(u), p.dot(v));
        let (solid, reach) = (parts[part].solid(), contact_reach(bodies));
        let center = (!parts[part].is_surface()).then(|| inertia::volume_center(solid)).flatten();
        let corners = |&below: &usize| {
            let all = footprint_corners(solid, parts[below].solid(), reach, -up);
            (below, convex_hull(all.into_iter().map(seen).collect()))
        };
        let center = center.map(|(center, error)| (seen(center), error + reach));
        Self { center, contacts: on.iter().map(corners).collect() }
    }

    /// Returns the parts that it rests on.
    pub(super) fn parts_below(&self) -> impl Iterator<Item = usize> {
        self.contacts.iter().map(|(part, _)| *part)
    }

    /// Returns the stability of the part if only the parts for which `carry` holds support it.
    pub(super) fn stability(&self, carry: impl Fn(usize) -> bool) -> Stability {
        let mut under = self.contacts.iter().filter(|(part, _)| carry(*part)).peekable();
        if under.peek().is_none() {
            return Stability::Falls;
        }
        let Some((center, slack)) = self.center else { return Stability::Stands };
        let mut corners = Vec::new();
        for (_, own) in under {
            if own.is_empty() {
                return Stability::Stands;
            }
            corners.extend_from_slice(own);
        }
        if signed_depth(&convex_hull(corners), center) < -slack {
            Stability::OffBalance
        } else {
            Stability::Stands
        }
    }
}

/// Returns the corners of the convex hull, counter-clockwise (Andrew's monotone chain).
fn convex_hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
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

/// Returns the distance of a point to the boundary of a convex polygon, positive inside. Outside, the value is
/// negative and its absolute value is a lower bound of the distance.
fn signed_depth(polygon: &[DVec2], point: DVec2) -> f64 {
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
