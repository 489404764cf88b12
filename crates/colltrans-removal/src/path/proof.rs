//! Proofs of legs: one cast for each pair of a moving body and a body at rest.

use glam::DVec3;

use super::answer::{Leg, MAX_BODIES};
use super::pairs::displaced_cast;
use super::scene::RemovalScene;
use super::search::{Group, Move, moving_pairs};
use crate::directions::FreeError;
use colltrans_convex::body::Placed;
use colltrans_convex::cast::Cast;
use colltrans_convex::setting::error::QueryError;
use colltrans_solid::SolidCast;
use colltrans_solid::body::Solid;
use colltrans_solid::cast::{SolidCertificate, SolidOptions, StartProof};

/// End of the cast of a leg that is not the last one, in multiples of its motion. It is larger than 1, so
/// that the proven bound is at least 1 in spite of rounding.
const CAST_END: f64 = 1.0 + 1.0 / (1 << 30) as f64;

/// Proof that a body does not hit another one on a leg.
#[derive(Debug, Clone, PartialEq)]
pub struct LegProof {
    /// Index of the moving body, and of the one at rest.
    pub bodies: [usize; 2],
    /// Certificate of the cast along the motion. The cast ends slightly beyond the end of the motion. For the
    /// last leg it has no end.
    pub certificate: SolidCertificate,
}

/// Returns the bodies of a group.
pub(super) fn group_members(group: Group) -> Vec<usize> {
    (0..MAX_BODIES).filter(|k| group >> k & 1 == 1).collect()
}

/// Builds the cast of one pair on a leg.
pub(super) fn leg_cast(
    pair: [Placed<'_, Solid>; 2],
    by: DVec3,
    motion: DVec3,
    last: bool,
    tolerance: f64,
) -> Result<Cast<'_, Solid>, QueryError> {
    let end = (!last).then_some(CAST_END);
    let options = SolidOptions::default().with_tolerance(tolerance).with_before(end);
    displaced_cast(pair, by, motion)?.with_options(options)
}

/// Checks whether a certificate proves that the bodies are apart at the start and do not collide on the leg. A contact
/// beyond the end of the leg, before that of the cast, does not matter: a leg may end just before a wall.
pub(super) fn proves_leg(certificate: &SolidCertificate, last: bool) -> bool {
    let end = if last { f64::INFINITY } else { 1.0 };
    matches!(certificate.start, StartProof::Apart(_)) && certificate.lower >= end
}

/// Certifies the legs of a plan. Returns `None` if a leg cannot be proven.
pub(super) fn certified_legs(
    scene: &RemovalScene<'_>,
    moves: &[Move],
) -> Result<Option<Vec<Leg>>, FreeError> {
    let mut at = vec![DVec3::ZERO; scene.count()];
    let mut legs = Vec::new();
    for (k, &Move { group, motion }) in moves.iter().enumerate() {
        let last = k + 1 == moves.len();
        let mut proofs = Vec::new();
        let Some(pairs) = scene.pairs_to_prove(moving_pairs(group, scene.count())) else {
            return Ok(None);
        };
        for [i, j] in pairs {
            let Some((bodies, tolerance)) = scene.proven_pair([i, j]) else { continue };
            let cast = leg_cast(bodies, at[i] - at[j], motion, last, tolerance)?;
            let certificate = cast.certified_clearance()?.1;
            if !proves_leg(&certificate, last) {
                return Ok(None);
            }
            proofs.push(LegProof { bodies: [i, j], certificate });
        }
        let own = group_members(group);
        for &b in &own {
            at[b] += motion;
        }
        let travel = if last { f64::INFINITY } else { motion.length() };
        legs.push(Leg { bodies: own, direction: motion.normalize(), travel, motion, proofs });
    }
    Ok(Some(legs))
}
