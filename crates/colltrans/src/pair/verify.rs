//! Checks of proofs about two placed bodies, from their vertices alone.

use crate::answer::{CertificateError, NearPoints, PlaneGap};
use crate::number::{extent, noise, volume};
use crate::setting::{TwoBodies, VertexPair};
use glam::DVec3;

/// The gap that a plane proves.
pub(super) fn gap(bodies: &TwoBodies, plane: &PlaneGap) -> Result<f64, CertificateError> {
    let &PlaneGap { normal, gap } = plane;
    let unit = (normal.length() - 1.0).abs() <= noise::UNIT_VECTOR;
    if !unit {
        return Err(CertificateError::Normal { normal });
    }
    let [_, square] = extent::dot(normal, normal);
    let proven = (bodies.distance_along(normal) / square.sqrt().next_up()).next_down();
    if gap >= 0.0 && gap <= proven {
        Ok(proven)
    } else {
        Err(CertificateError::Bound { proven, claimed: gap })
    }
}

/// The distance that two points prove.
pub(super) fn near(bodies: &TwoBodies, points: &NearPoints) -> Result<f64, CertificateError> {
    let NearPoints { pairs, weights, distance } = points;
    known(bodies, pairs)?;
    let terms = pairs.map(|pair| bodies.terms(pair));
    if *distance == 0.0 {
        let met = volume::encloses(&terms, bodies.scale());
        return if met { Ok(0.0) } else { Err(CertificateError::Start) };
    }
    let sum: f64 = weights.iter().sum();
    let whole = (sum - 1.0).abs() <= noise::UNIT_VECTOR;
    if !whole || weights.iter().any(|w| w.is_nan() || *w < 0.0) {
        let [a, b, c, d] = *weights;
        return Err(CertificateError::PointWeights { weights: [a, b, c, d] });
    }
    let mean: DVec3 = terms.iter().zip(weights).map(|(m, w)| m.point() * (w / sum)).sum();
    let proven = (mean.length() + bodies.noise().mean_checked()).next_up();
    if *distance >= proven {
        Ok(proven)
    } else {
        Err(CertificateError::Bound { proven, claimed: *distance })
    }
}

/// Whether pairs name vertices that there are.
pub(super) fn known(bodies: &TwoBodies, pairs: &[VertexPair]) -> Result<(), CertificateError> {
    let [p, q] = [bodies.moving, bodies.fixed].map(|body| body.vertices().len());
    let unknown = |pair: &VertexPair| pair.moving.index() >= p || pair.fixed.index() >= q;
    match pairs.iter().position(unknown) {
        Some(pair) => Err(CertificateError::UnknownVertex { pair }),
        None => Ok(()),
    }
}
