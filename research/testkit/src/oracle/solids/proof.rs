//! Judges proofs of solids in rational arithmetic, without trees, boxes or rounded numbers.
//!
//! Each entry of a cover names its facets. Each pair of facets must be covered exactly once, and the reason of
//! a pair must hold for its triangles.

use std::cmp::Ordering;

use colltrans::solid::{Claim, Reason, SolidCertificate, StartProof};
use colltrans::{Cast, Solid};

use super::facets::{FacetJudge, Gaps, Triangle, triangles};
use crate::oracle::exact::Ratio;

/// Maximum number of pairs of facets that are judged.
pub const MOST_PAIRS: usize = 2_500;

/// Judges the proof of a clearance between bodies that are not shrunk. An overlap at the start is judged
/// elsewhere. `slack`, in multiples of the direction, is the tolerance for sums of rounded numbers.
///
/// # Errors
/// A description of the first statement that is false.
pub fn approve(
    cast: &Cast<'_, Solid>,
    certificate: &SolidCertificate,
    slack: f64,
) -> Result<(), String> {
    let counts = [cast.moving().triangles().len(), cast.fixed().triangles().len()];
    if let StartProof::Apart(cover) = &certificate.start {
        let claims = cover.claims(cast).ok_or("the cover of the start does not fit")?;
        once(counts, &claims)?;
    }
    if matches!(certificate.start, StartProof::Overlapping(_)) {
        return Ok(());
    }
    let claims = certificate.cover.claims(cast).ok_or("the cover does not fit")?;
    once(counts, &claims)?;
    let placed = |solid: &Solid, pose: colltrans::Pose| {
        triangles(solid.vertices(), solid.triangles(), (pose.matrix(), pose.translation()))
    };
    let moving = placed(cast.moving(), cast.moving_pose());
    let fixed = placed(cast.fixed(), cast.fixed_pose());
    let judge = FacetJudge::new(cast.direction());
    for claim in &claims {
        for s in claim.moving.clone() {
            for t in claim.fixed.clone() {
                let gaps = judge.gaps(&moving[s], &fixed[t]);
                if !holds(&judge, claim.reason, certificate.lower, &gaps, [&moving[s], &fixed[t]]) {
                    let reason = claim.reason;
                    return Err(format!("{reason:?} of facets {s} and {t}: {gaps:?}"));
                }
            }
        }
    }
    let Some(stop) = &certificate.stop else { return Ok(()) };
    let [s, t] = stop.triangles.map(|k| k as usize);
    let value = judge.gaps(&moving[s], &fixed[t]).contribution();
    let near = |v: &Ratio| v.minus(&Ratio::from_f64(stop.offset_distance)).is_within(slack);
    match value {
        Some(value) if near(&value) => Ok(()),
        other => {
            Err(format!("facets {s} and {t} stop it at {other:?}, not {}", stop.offset_distance))
        }
    }
}

/// Checks whether each pair of facets is covered exactly once.
pub(super) fn once<R>([m, n]: [usize; 2], claims: &[Claim<R>]) -> Result<(), String> {
    let mut spoken = vec![0_u8; m * n];
    for claim in claims {
        for s in claim.moving.clone() {
            for t in claim.fixed.clone() {
                spoken[s * n + t] += 1;
            }
        }
    }
    match spoken.iter().position(|&count| count != 1) {
        None => Ok(()),
        Some(k) => Err(format!("facets {} and {}: {} times", k / n, k % n, spoken[k])),
    }
}

fn holds(
    judge: &FacetJudge,
    reason: Reason,
    lower: f64,
    gaps: &Gaps,
    [f, g]: [&Triangle; 2],
) -> bool {
    let parts = |gaps: &Gaps| {
        let zero = Ratio::from_f64(0.0);
        gaps.range
            .as_ref()
            .is_none_or(|[least, largest]| *largest < zero || *largest == zero && *least < zero)
    };
    match reason {
        Reason::MovingFacesAway => judge.facing(f) != Ordering::Greater,
        Reason::FixedFacesAway => judge.facing(g) != Ordering::Less,
        Reason::ShadowsApart => gaps.range.is_none(),
        Reason::Parting => !gaps.front || parts(gaps),
        Reason::NotBefore | Reason::Examined => gaps
            .contribution()
            .is_none_or(|value| lower.is_finite() && value >= Ratio::from_f64(lower)),
        Reason::Disjoint | Reason::FaceToFace => false,
    }
}
