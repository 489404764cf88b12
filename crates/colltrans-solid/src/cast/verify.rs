//! Verification of certificates between solids, without a search: each entry is verified separately.

use super::proof::{Cover, SolidCertificate, StartProof, StopProof, entry_holds, leaf_gap_bound};
use super::{SolidCast, SolidScene};
use crate::body::Solid;
use crate::solve::bound::{Reason, are_separated};
use crate::solve::leaf;
use crate::solve::overlap::{is_overlap, leaves_apart, nested_shell, never_overlap};
use crate::solve::projected::Projected;
use crate::solve::scene::PairFrame;
use crate::solve::search::{Aim, SLACK, exact_gap, node_rounding};
use crate::solve::separating_axes::SeparatingAxes;
use colltrans_convex::answer::{CertificateError, Separation, impl_from_proofs};
use colltrans_convex::cast::Cast;

/// Certificate between solids, of a clearance or of a plane between the bodies.
#[derive(Debug, Clone, Copy)]
pub enum SolidProof<'a> {
    /// Certificate of a clearance.
    Clearance(&'a SolidCertificate),
    /// Plane which proves that the bodies never meet.
    Separation(&'a Separation),
}

impl_from_proofs!(SolidProof { Clearance(SolidCertificate), Separation(Separation) });

/// Minimum positive length of a proven bound. It is far below the rounding errors of the coordinates of any body.
const MIN_LENGTH: f64 = f64::MIN_POSITIVE / f64::EPSILON;

/// Verifies the certificate of a clearance. Returns the difference of the distance and its proven lower bound, in
/// multiples of the direction. Returns 0 if nothing blocks or the answer is an overlap.
///
/// # Errors
/// Returns the first part that is not proven, or a tolerance that differs from that of the cast.
pub(super) fn verify_clearance(
    cast: &Cast<'_, Solid>,
    certificate: &SolidCertificate,
) -> Result<f64, CertificateError> {
    let SolidCertificate { tolerance, start, lower, stop, cover } = certificate;
    let (claimed, asked) = (*tolerance, cast.tolerance());
    if claimed != asked {
        return Err(CertificateError::OtherTolerance { claimed, expected: asked });
    }
    let scene = cast.query_scene();
    let options = cast.options();
    cast.verify_start(&scene, start)?;
    let Some(aim) = certificate.search_aim(options) else {
        let is_empty = *lower == 0.0 && stop.is_none() && cover.is_empty();
        return if is_empty { Ok(0.0) } else { Err(CertificateError::Cover { entry: 0 }) };
    };
    verify_cover(&scene, aim, cover, *lower)?;
    let end = options.before.unwrap_or(f64::INFINITY);
    let Some(stop) = stop else {
        // The bound reaches the end, to within rounding.
        let tolerance = node_rounding(&scene) / scene.setting.length + 4.0 * f64::EPSILON * end;
        let reached = *lower >= end || *lower >= end - 2.0 * tolerance;
        let (proven, claimed) = (*lower, end);
        let unproven = CertificateError::Bound { proven, claimed };
        return if reached { Ok(0.0) } else { Err(unproven) };
    };
    let error = verify_stop(&scene, aim, stop)?;
    let gap = stop.offset_distance - *lower;
    let tolerance = (2.0 * leaf::SHARP + 2.0 * SLACK) * scene.noise + 2.0 * error;
    let tolerance = tolerance / scene.setting.length;
    if (-tolerance..=tolerance).contains(&gap) && *lower >= 0.0 {
        Ok(gap.max(0.0))
    } else {
        Err(CertificateError::Bound { proven: *lower, claimed: stop.offset_distance })
    }
}

/// Verifies the proof that the offset bodies overlap at the start, or that they do not.
///
/// # Errors
/// Returns an error if the bodies do not overlap at the stated place, the proof disagrees with the options, an entry of
/// the cover does not hold, or a shell of one body is inside the other.
pub(super) fn verify_start(
    cast: &Cast<'_, Solid>,
    scene: &PairFrame,
    start: &StartProof,
) -> Result<(), CertificateError> {
    let assumed = cast.options().overlapping;
    let holds = match start {
        StartProof::Assumed => assumed.is_some(),
        StartProof::Overlapping(overlap) => assumed != Some(false) && is_overlap(scene, *overlap),
        StartProof::Apart(cover) => return verify_apart(scene, cover),
    };
    if holds { Ok(()) } else { Err(CertificateError::StartClaim) }
}

/// Verifies that the interiors are disjoint at the start.
fn verify_apart(scene: &PairFrame, cover: &Cover) -> Result<(), CertificateError> {
    let bodies = [scene.moving.solid, scene.fixed.solid];
    let projected = |moving: bool, at: u32| Projected::new(scene, scene.side(moving), at as usize);
    let boxes_disjoint = never_overlap(scene, &projected(true, 0), &projected(false, 0));
    let walked = cover.visit_entries(bodies, |_, nodes, reason| match reason {
        Reason::Disjoint if nodes == [0, 0] && boxes_disjoint => true,
        Reason::Disjoint => {
            are_separated(scene, &projected(true, nodes[0]), &projected(false, nodes[1]))
        }
        Reason::FaceToFace => {
            !scene.has_min_gap()
                && projected(true, nodes[0]).is_face_to_face(&projected(false, nodes[1]))
        }
        Reason::Examined => {
            let [a, b] = [0, 1].map(|k| &bodies[k].nodes()[nodes[k] as usize]);
            a.is_leaf() && b.is_leaf() && leaves_apart(scene, a, b)
        }
        _ => false,
    });
    walked.map_err(|entry| CertificateError::Cover { entry })?;
    if !boxes_disjoint && nested_shell(scene).is_some() {
        return Err(CertificateError::StartClaim);
    }
    Ok(())
}

/// Verifies that no pair of facets contributes less than `lower`, in multiples of the direction.
fn verify_cover(
    scene: &PairFrame,
    aim: Aim,
    cover: &Cover,
    lower: f64,
) -> Result<(), CertificateError> {
    // A length for which this product underflows proves nothing.
    let underflows = lower > 0.0 && lower * scene.setting.length < MIN_LENGTH;
    if lower.is_nan() || lower < 0.0 || underflows {
        return Err(CertificateError::Cover { entry: 0 });
    }
    let bodies = [scene.moving.solid, scene.fixed.solid];
    // The factor covers one rounding of the division and one of this product.
    let least = (lower * scene.setting.length) * (1.0 - 2.0 * f64::EPSILON);
    let axes = SeparatingAxes::new(scene);
    let walked = cover.visit_entries(bodies, |_, nodes, reason| {
        if reason != Reason::Examined {
            return entry_holds((scene, &axes), aim, nodes, reason, least);
        }
        let leaf = |k: usize| bodies[k].nodes()[nodes[k] as usize].is_leaf();
        leaf(0) && leaf(1) && (least <= 0.0 || leaf_gap_bound(scene, aim, nodes, least) >= least)
    });
    walked.map_err(|entry| CertificateError::Cover { entry })
}

/// Verifies that two facets block the moving body at the claimed distance. Returns the error of their gap, a
/// length, if a minimum gap is set, and 0 otherwise.
fn verify_stop(scene: &PairFrame, aim: Aim, stop: &StopProof) -> Result<f64, CertificateError> {
    let [s, t] = stop.triangles;
    let refused = CertificateError::blocking_triangles(stop.triangles);
    let within = |side: bool, k: u32| (k as usize) < scene.side(side).solid.triangles().len();
    if !within(true, s) || !within(false, t) {
        return Err(refused);
    }
    let (least, error) = exact_gap(scene, aim, stop.triangles).ok_or(refused)?;
    let proven = aim.clamp_gap(least) / scene.setting.length;
    let tolerance = (error + leaf::FINE * scene.noise) / scene.setting.length;
    if (stop.offset_distance - proven).abs() <= tolerance {
        Ok(if scene.has_min_gap() { error } else { 0.0 })
    } else {
        Err(CertificateError::Bound { proven, claimed: stop.offset_distance })
    }
}
