//! From what a solver found to the answer: bounds, witness points and contact features, in the
//! world.

use glam::{DVec2, DVec3};

use crate::certificate::{Certificate, Separation, distance_along, gap_tolerance};
use crate::error::QueryError;
use crate::minkowski::Difference;
use crate::outcome::{Contact, Feature, Grazing, Separated, Solver, Steps};
use crate::polyhedron::ConvexPolyhedron;
use crate::portal::{OneSide, Optimum};
use crate::pose::Pose;
use crate::setting::VertexPair;

pub(crate) fn contact(
    difference: &Difference,
    moving_pose: &Pose,
    optimum: &Optimum,
    solver: Solver,
    steps: Steps,
) -> Result<Contact, QueryError> {
    let setting = difference.setting;
    let certificate = certificate(difference, optimum);
    if certificate.gap().is_nan() || certificate.gap() > certificate.tolerance {
        let Certificate { lower, upper, tolerance, .. } = certificate;
        return Err(QueryError::NotConverged { lower, upper, tolerance });
    }
    let normal = certificate.normal;
    let (mut point_on_moving, mut point_on_fixed) = (DVec3::ZERO, setting.offset);
    for (pair, weight) in certificate.pairs.iter().zip(certificate.weights) {
        point_on_moving +=
            setting.moving_matrix * setting.moving.vertices()[pair.moving as usize] * weight;
        point_on_fixed +=
            setting.fixed_matrix * setting.fixed.vertices()[pair.fixed as usize] * weight;
    }
    let VertexPair { moving, fixed } = optimum.lowest;
    let noise = difference.noise;
    Ok(Contact {
        translation: certificate.upper,
        normal,
        point_on_moving: point_on_moving + moving_pose.translation(),
        point_on_fixed: point_on_fixed + moving_pose.translation(),
        moving_feature: feature(setting.moving, setting.moving_normal(normal), moving, noise),
        fixed_feature: feature(setting.fixed, -setting.fixed_normal(normal), fixed, noise),
        certificate,
        solver,
        steps,
    })
}

fn certificate(difference: &Difference, optimum: &Optimum) -> Certificate {
    let setting = difference.setting;
    let normal = (difference.axes * optimum.normal).normalize();
    let along = normal.dot(setting.direction);
    let lower = distance_along(setting, normal, optimum.lowest) / along;
    let heights = optimum.portal.map(|point| point.height());
    let height: f64 = heights.iter().zip(optimum.weights).map(|(h, w)| h * w).sum();
    Certificate {
        normal,
        lower,
        pairs: optimum.portal.map(|point| point.pair),
        weights: optimum.weights,
        upper: height / setting.direction.length(),
        tolerance: gap_tolerance(setting, normal, difference.widening),
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
fn feature(body: &ConvexPolyhedron, outward: DVec3, vertex: u32, noise: f64) -> Feature {
    let at = body.vertices()[vertex as usize];
    let in_plane =
        |w: u32| outward.dot(at - body.vertices()[w as usize]) <= noise + body.hull_error();
    let topology = body.topology();
    let neighbours = topology.neighbours(vertex);
    let outgoing = topology.outgoing(vertex);
    let (first, count) = body.plane_candidates(vertex, outward);
    let mut edge = None;
    for i in (first..first + count).map(|i| i % neighbours.len()) {
        if !in_plane(neighbours[i]) {
            continue;
        }
        edge = edge.or(Some(neighbours[i]));
        // The face between neighbour `i` and the next one is on the left of the half-edge to the
        // next one.
        let next = (i + 1) % neighbours.len();
        if !outgoing.is_empty() && next != i && in_plane(neighbours[next]) {
            let face = topology.half_edge(outgoing[next]).face;
            // Of the two faces of a flat polygon, the one that looks there.
            let looks = body.dimension() == 3 || body.face_normal(face).dot(outward) >= 0.0;
            if looks && spread(topology.face_vertices(face)).all(in_plane) {
                return Feature::Face(face);
            }
        }
    }
    edge.map_or(Feature::Vertex(vertex), |w| Feature::Edge([vertex, w]))
}

/// Up to [`SAMPLES`] vertices, spread over a face: those near a vertex may lie in a plane that the
/// others do not.
fn spread(vertices: impl ExactSizeIterator<Item = u32>) -> impl Iterator<Item = u32> {
    let stride = vertices.len().div_ceil(SAMPLES);
    vertices.step_by(stride)
}

/// How many vertices of a face must lie in the contact plane for the face to do.
const SAMPLES: usize = 16;
