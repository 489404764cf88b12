//! Checks of proofs about two placed convex bodies. They use only the vertices.

use glam::DVec3;

use crate::answer::{CertificateError, Depth, Enclosure, NearPoints, PlaneGap, are_weights};
use crate::setting::{TwoBodies, VertexPair};
use crate::solve::nearest::surrounds_origin;
use colltrans_kernel::{height_bounds, noise, volume};

/// Returns the gap that a plane proves. Returns an error if the claimed gap is negative or larger.
pub(super) fn verify_plane(bodies: &TwoBodies, plane: &PlaneGap) -> Result<f64, CertificateError> {
    let &PlaneGap { normal, gap } = plane;
    check_unit_normal(normal)?;
    let proven = bodies.proven_gap(normal);
    if gap >= 0.0 && gap <= proven {
        Ok(proven)
    } else {
        Err(CertificateError::Bound { proven, claimed: gap })
    }
}

/// Returns the distance that two points prove. If the claimed distance is 0, checks that the pairs enclose
/// the origin. Returns an error if the claim is not proven.
pub(super) fn verify_points(
    bodies: &TwoBodies,
    points: &NearPoints,
) -> Result<f64, CertificateError> {
    let claimed = points.distance;
    if claimed == 0.0 && !bodies.is_rounded() {
        check_vertices_exist(bodies, &points.pairs)?;
        let met = do_pairs_surround_origin(bodies, points);
        return if met { Ok(0.0) } else { Err(CertificateError::StartClaim) };
    }
    let proven = bodies.distance_less_radii(core_distance(bodies, points)?);
    if claimed >= proven {
        Ok(proven)
    } else if claimed == 0.0 {
        Err(CertificateError::StartClaim)
    } else {
        Err(CertificateError::Bound { proven, claimed })
    }
}

/// Returns an upper bound of the distance of the cores that two points prove, 0 if the pairs enclose the origin.
/// Only the distance of rounded bodies may be claimed to be 0 by points that are apart.
fn core_distance(bodies: &TwoBodies, points: &NearPoints) -> Result<f64, CertificateError> {
    let NearPoints { pairs, weights, .. } = points;
    check_vertices_exist(bodies, pairs)?;
    if bodies.is_rounded() && points.distance == 0.0 && do_pairs_surround_origin(bodies, points) {
        return Ok(0.0);
    }
    if !are_weights(weights) {
        return Err(CertificateError::PointWeights { weights: *weights });
    }
    let terms = pairs.map(|pair| bodies.terms(pair));
    let sum: f64 = weights.iter().sum();
    let mean: DVec3 = terms.iter().zip(weights).map(|(m, w)| m.rounded_point() * (w / sum)).sum();
    Ok((mean.length() + bodies.noise().checked_mean_length_margin()).next_up())
}

/// Returns a lower bound of the depth of rounded bodies that two points of their cores prove: the sum of the radii less
/// the distance of the points; 0 if that is negative.
pub(super) fn depth_by_points(
    bodies: &TwoBodies,
    points: &NearPoints,
) -> Result<f64, CertificateError> {
    let [radii, _] = bodies.core_gap_bounds(0.0);
    Ok((radii - core_distance(bodies, points)?).next_down().max(0.0))
}

/// Checks whether the differences of four pairs of existing vertices enclose the origin.
fn do_pairs_surround_origin(bodies: &TwoBodies, points: &NearPoints) -> bool {
    volume::contains_origin(&points.pairs.map(|pair| bodies.terms(pair)), bodies.size())
}

/// Returns the depth that the enclosure proves, 0 if it is empty.
///
/// Returns an error if more is claimed, or if the direction does not prove the upper bound.
pub(super) fn verify_depth(bodies: &TwoBodies, depth: &Depth) -> Result<f64, CertificateError> {
    check_unit_normal(depth.direction)?;
    let [least_square, most_square] = height_bounds::dot_bounds(depth.direction, depth.direction);
    let reach = -bodies.distance_along(-depth.direction);
    // The cores of rounded bodies may be apart: then the larger length gives the larger quotient.
    let length =
        if reach < 0.0 { most_square.sqrt().next_up() } else { least_square.sqrt().next_down() };
    let upper = (reach / length).next_up();
    let (is_rounded, [least, most]) = (bodies.is_rounded(), bodies.core_gap_bounds(0.0));
    let upper = if is_rounded { (upper + most).next_up() } else { upper }.max(0.0);
    if depth.upper.is_nan() || depth.upper < upper {
        return Err(CertificateError::Bound { proven: upper, claimed: depth.upper });
    }
    let proven = if depth.enclosure != Enclosure::default() {
        let radius = enclosed_radius(bodies, &depth.enclosure)?;
        if is_rounded { (radius + least).next_down() } else { radius }
    } else if let Some(near) = &depth.near {
        depth_by_points(bodies, near)?
    } else {
        0.0
    };
    if depth.lower >= 0.0 && depth.lower <= proven {
        Ok(proven)
    } else {
        Err(CertificateError::Bound { proven, claimed: depth.lower })
    }
}

/// Returns a lower bound of the distance of the origin from a surface around it.
///
/// Returns an error if the surface is malformed or does not enclose the origin.
pub(super) fn enclosed_radius(
    bodies: &TwoBodies,
    surface: &Enclosure,
) -> Result<f64, CertificateError> {
    let Enclosure { pairs, triangles, normals } = surface;
    check_vertices_exist(bodies, pairs)?;
    let fits = |corners: &[u32; 3]| corners.iter().all(|k| (*k as usize) < pairs.len());
    if normals.len() != triangles.len() || !triangles.iter().all(fits) {
        return Err(CertificateError::StartClaim);
    }
    let points: Vec<DVec3> = pairs.iter().map(|pair| bodies.terms(*pair).rounded_point()).collect();
    let mut least = f64::INFINITY;
    for (corners, normal) in triangles.iter().zip(normals) {
        check_unit_normal(*normal)?;
        // The length of the normal may exceed 1 by rounding.
        let [_, square] = height_bounds::dot_bounds(*normal, *normal);
        let length = square.sqrt().next_up();
        for corner in corners {
            let height =
                normal.dot(points[*corner as usize]) - bodies.noise().checked_height_margin();
            least = least.min((height / length).next_down());
        }
    }
    let proven = least.next_down();
    if proven > 0.0 && surrounds_origin(bodies, surface) {
        Ok(proven)
    } else {
        Err(CertificateError::StartClaim)
    }
}

/// Checks that a normal is a unit vector to within rounding.
fn check_unit_normal(normal: DVec3) -> Result<(), CertificateError> {
    let is_unit = (normal.length() - 1.0).abs() <= noise::UNIT_VECTOR;
    if is_unit { Ok(()) } else { Err(CertificateError::Normal { normal }) }
}

/// Checks that all pairs name existing vertices.
pub(super) fn check_vertices_exist(
    bodies: &TwoBodies,
    pairs: &[VertexPair],
) -> Result<(), CertificateError> {
    let [p, q] = [bodies.moving, bodies.fixed].map(|body| body.vertices().len());
    let unknown = |pair: &VertexPair| pair.moving.index() >= p || pair.fixed.index() >= q;
    match pairs.iter().position(unknown) {
        Some(pair) => Err(CertificateError::UnknownVertex { pair }),
        None => Ok(()),
    }
}
