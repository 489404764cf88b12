//! From what a solver found to the answer: bounds, witness points and contact features, in the
//! world.

use glam::{DVec2, DVec3};

use crate::certificate::{Certificate, Separation, gap_tolerance};
use crate::error::QueryError;
use crate::minkowski::{Difference, Point};
use crate::outcome::{Contact, Feature, Grazing, Separated, Solver, Steps};
use crate::polyhedron::ConvexPolyhedron;
use crate::portal::{Met, OneSide, Optimum, Portal};
use crate::pose::Pose;
use crate::setting::VertexPair;

/// An optimum and what it proves, in the world. Small and passed by reference: moving an outcome
/// about costs a tenth of a coherent query.
pub(crate) struct Proven<'a> {
    difference: &'a Difference<'a>,
    portal: &'a Portal,
    optimum: &'a Optimum,
    /// The unit contact normal, in the world.
    normal: DVec3,
    /// The same in the frames of the moving and of the fixed body.
    normals: [DVec3; 2],
    lower: f64,
    upper: f64,
    tolerance: f64,
}

impl<'a> Proven<'a> {
    /// # Errors
    /// Bounds that rounding alone does not explain.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory it stalls its reader: 5 %")]
    pub(crate) fn new(
        difference: &'a Difference,
        portal: &'a Portal,
        optimum: &'a Optimum,
    ) -> Result<Self, QueryError> {
        let setting = difference.setting;
        let normal = (difference.axes * optimum.normal).normalize();
        let normals = [setting.moving_normal(normal), setting.fixed_normal(normal)];
        let [p, q] = setting.vertices(optimum.lowest);
        let distance = (normals[1].dot(q) - normals[0].dot(p)) + normal.dot(setting.offset);
        let lower = distance / normal.dot(setting.direction);
        let [u, v, w] = optimum.weights;
        let [a, b, c] = portal.each_ref().map(Point::height);
        let upper = (a * u + b * v + c * w) / setting.length;
        let tolerance = gap_tolerance(setting, normal, difference.noise, difference.widening);
        let gap = upper - lower;
        if gap.is_nan() || gap > tolerance {
            return Err(QueryError::NotConverged { lower, upper, tolerance });
        }
        Ok(Self { difference, portal, optimum, normal, normals, lower, upper, tolerance })
    }

    /// What a later query may start from.
    #[inline]
    pub(crate) fn met(&self) -> Met {
        let weights = self.optimum.weights;
        Met { pairs: self.portal.each_ref().map(|p| p.pair), weights, normals: self.normals }
    }

    #[inline(always)]
    #[expect(clippy::inline_always, reason = "built where it is to stay: 5 %")]
    pub(crate) fn contact(&self, moving_pose: &Pose, solver: Solver, steps: Steps) -> Contact {
        let setting = self.difference.setting;
        let pairs = self.portal.each_ref().map(|p| p.pair);
        let [on_moving, on_fixed] = setting.weighted(&pairs, &self.optimum.weights);
        let origin = moving_pose.translation();
        let VertexPair { moving, fixed } = self.optimum.lowest;
        let noise = self.difference.noise;
        Contact {
            translation: self.upper,
            normal: self.normal,
            point_on_moving: setting.moving_matrix * on_moving + origin,
            point_on_fixed: setting.fixed_matrix * on_fixed + setting.offset + origin,
            moving_feature: feature(setting.moving, self.normals[0], moving, noise),
            fixed_feature: feature(setting.fixed, -self.normals[1], fixed, noise),
            certificate: Certificate {
                normal: self.normal,
                lower: self.lower,
                pairs,
                weights: self.optimum.weights,
                upper: self.upper,
                tolerance: self.tolerance,
            },
            solver,
            steps,
        }
    }
}

pub(crate) fn grazing(
    difference: &Difference,
    inward: DVec2,
    overlap: f64,
    contact: Contact,
) -> Grazing {
    let separating_direction = (difference.axes * inward.extend(0.0)).normalize();
    Grazing { separating_direction, overlap, contact }
}

pub(crate) fn separated(
    difference: &Difference,
    found: &OneSide,
    solver: Solver,
    steps: Steps,
) -> Separated {
    let normal = (difference.axes * found.normal.extend(0.0)).normalize();
    let certificate = Separation { normal, margin: found.margin };
    Separated { certificate, solver, steps }
}

/// The vertex, edge or face of a body in its supporting plane along the unit vector `outward` (body
/// frame).
#[inline]
fn feature(body: &ConvexPolyhedron, outward: DVec3, vertex: u32, noise: f64) -> Feature {
    let vertices = body.vertices();
    let least = outward.dot(vertices[vertex as usize]) - (noise + body.hull_error());
    let in_plane = |w: u32| outward.dot(vertices[w as usize]) >= least;
    let topology = body.topology();
    let neighbours = topology.neighbours(vertex);
    let (first, count) = body.plane_candidates(vertex, outward);
    let wrapped = |i: usize| if i >= neighbours.len() { i - neighbours.len() } else { i };
    // Bit `k`: whether the candidate `k` is in the plane. Without branches: none is predictable.
    let mut hits = 0_u32;
    for k in 0..count {
        hits |= u32::from(in_plane(neighbours[wrapped(first + k)])) << k;
    }
    if hits == 0 {
        return Feature::Vertex(vertex);
    }
    let outgoing = topology.outgoing(vertex);
    let all_round = count == neighbours.len() && count > 1;
    let followed = hits & ((hits >> 1) | ((u32::from(all_round) * (hits & 1)) << (count - 1)));
    let mut corners = if outgoing.is_empty() { 0 } else { followed };
    while corners != 0 {
        // The face between a neighbour and the next one is on the left of the half-edge to the next.
        let next = wrapped(wrapped(first + corners.trailing_zeros() as usize) + 1);
        let face = topology.half_edge(outgoing[next]).face;
        // Of the two faces of a flat polygon, the one that looks there.
        let looks = body.dimension() == 3 || body.face_normal(face).dot(outward) >= 0.0;
        if looks && spread(topology.face_vertices(face), in_plane) {
            return Feature::Face(face);
        }
        corners &= corners - 1;
    }
    Feature::Edge([vertex, neighbours[wrapped(first + hits.trailing_zeros() as usize)]])
}

/// Whether something holds for up to [`SAMPLES`] vertices, spread over a face: those near a vertex
/// may lie in a plane that the others do not.
fn spread(
    mut vertices: impl ExactSizeIterator<Item = u32>,
    holds: impl FnMut(u32) -> bool,
) -> bool {
    if vertices.len() <= SAMPLES {
        return vertices.all(holds);
    }
    let stride = vertices.len().div_ceil(SAMPLES);
    vertices.step_by(stride).all(holds)
}

/// How many vertices of a face must lie in the contact plane for the face to do.
const SAMPLES: usize = 16;
