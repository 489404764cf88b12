//! Proofs about one body among many.

use std::convert::Infallible;

use glam::DVec3;

use super::boxes::{self, Sweep};
use super::obstacles::Obstacle;
use super::search::Closeness;
use super::{Among, ByKind, ClearanceAmong, Nearby, Nearest};
use colltrans_convex::answer::{Clearance, PlaneGap, Within, checked_as};
use colltrans_convex::body::{Aabb, ObstacleId};
use colltrans_convex::setting::check_length;
use colltrans_convex::setting::error::QueryError;
use colltrans_solid::cast::SolidCertificate;
use colltrans_solid::kinds::AnyNear;
use colltrans_solid::pair::DistanceCertificate;
use colltrans_solid::{SolidCast, SolidPair};

/// What proves that an obstacle is not nearer than a number.
pub type ApartProof = ByKind<PlaneGap, DistanceCertificate>;

/// What proves where an obstacle stops the moving body, or that it does not: of convex bodies the answer,
/// which carries its proof.
pub type PassedProof = ByKind<Clearance, SolidCertificate>;

/// The proof of [`Among::nearest`].
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct NearestProof {
    /// No obstacle is nearer, in world units.
    pub lower: f64,
    /// The one that is not farther than the upper bound.
    pub obstacle: ObstacleId,
    /// Why not: two points.
    pub near: AnyNear,
    /// Why obstacles are not nearer whose boxes do not tell, in the order in which they came.
    pub apart: Vec<(ObstacleId, ApartProof)>,
}

/// The proof of [`Among::within`].
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct NearbyProof {
    /// The length.
    #[cfg_attr(feature = "serde", serde(with = "colltrans_kernel::written::or_infinite"))]
    pub length: f64,
    /// Those that are closer, in the order in which they came, as all of these.
    pub closer: Vec<(ObstacleId, AnyNear)>,
    /// Those of which nothing is claimed.
    pub undecided: Vec<ObstacleId>,
    /// Why obstacles are not closer whose boxes do not tell.
    pub apart: Vec<(ObstacleId, ApartProof)>,
}

/// The proof of [`Among::clearance`].
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct ClearanceProof {
    /// The direction.
    pub direction: DVec3,
    /// No obstacle stops the moving body before, in multiples of the direction; 0 if it overlaps one.
    #[cfg_attr(feature = "serde", serde(with = "colltrans_kernel::written::or_infinite"))]
    pub lower: f64,
    /// The one that stops it, or overlaps it.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "colltrans_kernel::written::given"))]
    pub stop: Option<ObstacleId>,
    /// What obstacles do whose boxes do not tell, the one that stops it among them, in the order in which
    /// they came.
    pub passed: Vec<(ObstacleId, PassedProof)>,
}

#[cfg(feature = "json")]
impl ClearanceProof {
    /// The translation by which an obstacle is claimed to stop the moving body, at most: 0 if they overlap, infinite if
    /// none is.
    #[doc(hidden)]
    pub fn upper(&self) -> f64 {
        let claim = self.stop.and_then(|stop| self.passed.iter().find(|(id, _)| *id == stop));
        match claim.map(|(_, claim)| claim) {
            None | Some(ByKind::Convex(Clearance::Free(_))) => f64::INFINITY,
            Some(ByKind::Convex(Clearance::Blocked { contact, .. })) => contact.certificate.upper,
            Some(ByKind::Convex(Clearance::Overlapping(_))) => 0.0,
            Some(ByKind::Solid(proof)) => proof.stop.map_or(0.0, |stop| stop.shrunk_distance),
        }
    }
}

/// A proof to check about one body among many.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum AmongProof<'a> {
    /// Which is nearest.
    Nearest(&'a NearestProof),
    /// Which are closer than a length.
    Nearby(&'a NearbyProof),
    /// Which stops the moving body.
    Clearance(&'a ClearanceProof),
}

checked_as!(AmongProof { Nearest(NearestProof), Nearby(NearbyProof), Clearance(ClearanceProof) });

/// Proofs are made of answers.
impl<'a> Among<'a> {
    /// The nearest obstacle, as [`Self::nearest`] says, and the proof of it: of all obstacles whose boxes are
    /// nearer than that.
    ///
    /// # Errors
    /// As [`Self::nearest`].
    pub fn certified_nearest(&self) -> Result<Option<(Nearest, NearestProof)>, QueryError> {
        let Some(nearest) = self.nearest()? else { return Ok(None) };
        let Nearest { obstacle, mut lower, distance, .. } = nearest;
        let mut apart = Vec::new();
        for one in self.sorted(lower, |other| boxes::distance(&self.bounds, other)) {
            let apart_from = self.prove_apart(one, lower).map_err(|e| e.of_obstacle(one.id))?;
            let Some(proof) = apart_from else {
                lower = 0.0;
                break;
            };
            lower = lower.min(gap_of(&proof));
            apart.push((one.id, proof));
        }
        if lower == 0.0 {
            apart.clear();
        }
        Ok(Some((nearest, NearestProof { lower, obstacle, near: distance.near(), apart })))
    }

    /// Which obstacles are closer than a length, as [`Self::within`] says, and the proof of it.
    ///
    /// # Errors
    /// As [`Self::within`].
    pub fn certified_within(&self, length: f64) -> Result<(Nearby, NearbyProof), QueryError> {
        check_length(length)?;
        let nearby = self.within(length)?;
        let undecided = nearby.undecided.iter().map(|(id, _)| *id).collect();
        let closer = nearby.closer.clone();
        let mut proof = NearbyProof { length, closer, undecided, apart: Vec::new() };
        for one in self.sorted(length.next_up(), |other| boxes::distance(&self.bounds, other)) {
            let of_one = |e: QueryError| e.of_obstacle(one.id);
            if let Closeness::Farther = self.is_within(one, length).map_err(of_one)? {
                match self.prove_apart(one, length).map_err(of_one)? {
                    Some(apart) if gap_of(&apart) > length => proof.apart.push((one.id, apart)),
                    _ => proof.undecided.push(one.id),
                }
            }
        }
        proof.undecided.sort_unstable();
        Ok((nearby, proof))
    }

    /// How far the moving body can move, as [`Self::clearance`] says, and the proof of it: of all obstacles
    /// whose boxes are met before that.
    ///
    /// # Errors
    /// As [`Self::clearance`].
    pub fn certified_clearance(
        &self,
        direction: DVec3,
    ) -> Result<(ClearanceAmong, ClearanceProof), QueryError> {
        let clearance = self.clearance(direction)?;
        let stop = clearance.stop.map(|(id, _)| id);
        let mut proof =
            ClearanceProof { direction, lower: clearance.lower, stop, passed: Vec::new() };
        for one in self.before(&clearance, direction) {
            let passed = self.prove_passed(one, direction).map_err(|e| e.of_obstacle(one.id))?;
            proof.lower = proof.lower.min(lower_of(&passed));
            proof.passed.push((one.id, passed));
        }
        Ok((clearance, proof))
    }

    fn prove_passed(&self, one: &'a Obstacle, direction: DVec3) -> Result<PassedProof, QueryError> {
        Ok(match self.cast(one, direction)? {
            ByKind::Convex(cast) => ByKind::Convex(cast.clearance()?),
            ByKind::Solid(cast) => ByKind::Solid(cast.certified_clearance()?.1),
        })
    }

    /// Obstacles whose boxes do not tell that they are met later than the moving body is stopped, and the one
    /// that stops it; that one alone if they overlap.
    fn before(&self, clearance: &ClearanceAmong, direction: DVec3) -> Vec<&'a Obstacle> {
        let stop = clearance.stop.and_then(|(id, _)| self.obstacles.item(id).ok());
        let stop = stop.map(|item| self.obstacle(item));
        if clearance.distance().is_none() {
            return stop.into_iter().collect();
        }
        let sweep = Sweep::new(self.swept(), direction);
        let below = clearance.lower.max(f64::MIN_POSITIVE);
        let mut found = self.sorted(below, |other| sweep.entry(other));
        if let Some(stop) = stop
            && let Err(place) = found.binary_search_by_key(&stop.id, |one| one.id)
        {
            found.insert(place, stop);
        }
        found
    }

    /// Obstacles whose boxes have a bound below this one, in the order in which they came.
    fn sorted(&self, below: f64, bound: impl Fn(&Aabb) -> f64) -> Vec<&'a Obstacle> {
        let mut found = Vec::new();
        let visit = |item, bound| {
            let one = self.obstacle(item);
            if bound < below && !self.is_ignored(one.id) {
                found.push(one);
            }
            Ok::<_, Infallible>(below)
        };
        let Ok(_) = self.obstacles.tree().search(below, bound, visit);
        found.sort_unstable_by_key(|one| one.id);
        found
    }

    /// That an obstacle is not nearer than a length, if it is not, or else than it is.
    fn prove_apart(
        &self,
        one: &'a Obstacle,
        length: f64,
    ) -> Result<Option<ApartProof>, QueryError> {
        Ok(match self.pair(one)? {
            ByKind::Convex(pair) => pair.distance()?.gap.map(ByKind::Convex),
            ByKind::Solid(pair) => {
                let proof = match pair.certified_within(length)? {
                    // What is closer has a lower bound of its own.
                    (Within::Closer(_), _) => Some(pair.certified_distance()?.1),
                    (Within::Farther(_) | Within::Undecided(_), proof) => proof,
                };
                proof.filter(|proof| proof.lower > 0.0).map(ByKind::Solid)
            }
        })
    }
}

/// What it claims.
pub(super) fn gap_of(proof: &ApartProof) -> f64 {
    match proof {
        ByKind::Convex(plane) => plane.gap,
        ByKind::Solid(certificate) => certificate.lower,
    }
}

/// Before which translation an obstacle is claimed not to stop the moving body: 0 if they overlap.
fn lower_of(proof: &PassedProof) -> f64 {
    match proof {
        ByKind::Convex(clearance) => clearance.distance().unwrap_or(0.0),
        ByKind::Solid(certificate) => certificate.lower,
    }
}
