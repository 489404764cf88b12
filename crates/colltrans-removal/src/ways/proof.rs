//! Proofs of legs: a cast of each body that moves against each that stays.

use glam::DVec3;

use super::answer::{Leg, MOST_BODIES};
use super::pairs::displaced;
use super::search::{Group, Move, border};
use crate::free::FreeError;
use colltrans_convex::body::Placed;
use colltrans_convex::cast::Cast;
use colltrans_convex::setting::error::QueryError;
use colltrans_solid::SolidCast;
use colltrans_solid::body::Solid;
use colltrans_solid::cast::{SolidCertificate, SolidOptions, StartProof};

/// Where casts of legs that end do, in multiples of their motion: beyond 1, so that rounding leaves it proven to 1.
const END: f64 = 1.0 + 1.0 / (1 << 30) as f64;

/// Why a body does not hit another on a leg.
#[derive(Debug, Clone, PartialEq)]
pub struct LegProof {
    /// The one that moves, and the other.
    pub bodies: [usize; 2],
    /// Of the cast along the motion, before a little more than 1, or without an end.
    pub certificate: SolidCertificate,
}

/// The bodies of a group.
pub(super) fn members(group: Group) -> Vec<usize> {
    (0..MOST_BODIES).filter(|k| group >> k & 1 == 1).collect()
}

/// The cast of a leg.
pub(super) fn of_leg(
    pair: [Placed<'_, Solid>; 2],
    by: DVec3,
    motion: DVec3,
    last: bool,
    tolerance: f64,
) -> Result<Cast<'_, Solid>, QueryError> {
    let end = (!last).then_some(END);
    let options = SolidOptions::default().with_tolerance(tolerance).with_before(end);
    displaced(pair, by, motion)?.with_options(options)
}

/// Whether nothing is overlapped at the start, and nothing hit on the way.
pub(super) fn passes(certificate: &SolidCertificate, last: bool) -> bool {
    let end = if last { f64::INFINITY } else { 1.0 };
    matches!(certificate.start, StartProof::Apart(_))
        && certificate.stop.is_none()
        && certificate.lower >= end
}

/// The legs of a plan, if all of them can be proven.
pub(super) fn certified(
    bodies: &[Placed<'_, Solid>],
    moves: &[Move],
    tolerance: f64,
) -> Result<Option<Vec<Leg>>, FreeError> {
    let mut at = vec![DVec3::ZERO; bodies.len()];
    let mut legs = Vec::new();
    for (k, &Move { group, motion }) in moves.iter().enumerate() {
        let last = k + 1 == moves.len();
        let mut proofs = Vec::new();
        for [i, j] in border(group, bodies.len()) {
            let cast = of_leg([bodies[i], bodies[j]], at[i] - at[j], motion, last, tolerance)?;
            let certificate = cast.certified_clearance()?.1;
            if !passes(&certificate, last) {
                return Ok(None);
            }
            proofs.push(LegProof { bodies: [i, j], certificate });
        }
        let own = members(group);
        for &b in &own {
            at[b] += motion;
        }
        let travel = if last { f64::INFINITY } else { motion.length() };
        legs.push(Leg { bodies: own, direction: motion.normalize(), travel, motion, proofs });
    }
    Ok(Some(legs))
}
