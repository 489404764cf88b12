//! Proofs about one body among many.

use std::convert::Infallible;

use glam::DVec3;

use super::boxes;
use super::obstacles::Obstacle;
use super::search::Closeness;
use super::{ByKind, Nearby, Nearest, SceneClearance, SceneQuery};
use colltrans_convex::answer::{Clearance, PlaneGap, Within, impl_from_proofs};
use colltrans_convex::body::{Aabb, ObstacleId};
use colltrans_convex::setting::check_length;
use colltrans_convex::setting::error::QueryError;
use colltrans_solid::cast::SolidCertificate;
use colltrans_solid::kinds::AnyNear;
use colltrans_solid::pair::DistanceCertificate;
use colltrans_solid::{SolidCast, SolidPair};

/// Proof that an obstacle is not nearer than a distance.
pub type ApartProof = ByKind<PlaneGap, DistanceCertificate>;

/// Proof that an obstacle stops the moving body within the claimed bounds, or does not stop it. For convex bodies it is
/// the answer itself, which contains its certificates.
pub type ObstacleClearanceProof = ByKind<Clearance, SolidCertificate>;

/// The proof of [`SceneQuery::nearest`].
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct NearestProof {
    /// Lower bound of the distances of all obstacles, in world units.
    pub lower: f64,
    /// The obstacle that proves the upper bound.
    pub obstacle: ObstacleId,
    /// Two near points of this obstacle and the moving body.
    pub near: AnyNear,
    /// Proofs for the obstacles that their boxes do not exclude, in the order of insertion.
    pub apart: Vec<(ObstacleId, ApartProof)>,
}

/// The proof of [`SceneQuery::within`].
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct NearbyProof {
    /// Length of the query, in world units.
    #[cfg_attr(
        feature = "serde",
        serde(with = "colltrans_kernel::serialization::null_as_infinity")
    )]
    pub length: f64,
    /// The obstacles that are closer. All lists are in the order of insertion.
    pub closer: Vec<(ObstacleId, AnyNear)>,
    /// The obstacles about which nothing is claimed.
    pub undecided: Vec<ObstacleId>,
    /// Proofs that obstacles are not closer, if their boxes do not exclude them.
    pub apart: Vec<(ObstacleId, ApartProof)>,
}

/// The proof of [`SceneQuery::clearance`].
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct ClearanceProof {
    /// Direction of the query.
    pub direction: DVec3,
    /// Translation before which no obstacle stops the moving body, in multiples of the direction; 0 if it overlaps one.
    #[cfg_attr(
        feature = "serde",
        serde(with = "colltrans_kernel::serialization::null_as_infinity")
    )]
    pub lower: f64,
    /// The obstacle that stops or overlaps the moving body.
    #[cfg_attr(
        feature = "serde",
        serde(deserialize_with = "colltrans_kernel::serialization::required_option")
    )]
    pub stop: Option<ObstacleId>,
    /// Proofs for the obstacles that their boxes do not exclude, including the one that stops the body, in the order of
    /// insertion. If an obstacle overlaps the body, only the proof of this obstacle.
    pub passed: Vec<(ObstacleId, ObstacleClearanceProof)>,
}

#[cfg(feature = "json")]
impl ClearanceProof {
    /// Returns the claimed upper bound of the translation at which an obstacle stops the moving body: 0 if they
    /// overlap, infinity if none does.
    #[doc(hidden)]
    pub fn upper(&self) -> f64 {
        let claim = self.stop.and_then(|stop| self.passed.iter().find(|(id, _)| *id == stop));
        match claim.map(|(_, claim)| claim) {
            None | Some(ByKind::Convex(Clearance::Free(_))) => f64::INFINITY,
            Some(ByKind::Convex(Clearance::Blocked { contact, .. })) => contact.certificate.upper,
            Some(ByKind::Convex(Clearance::Overlapping(_))) => 0.0,
            Some(ByKind::Solid(proof)) => proof.stop.map_or(0.0, |stop| stop.offset_distance),
        }
    }
}

/// A proof about one body among many.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum SceneProof<'a> {
    /// Proof of the nearest obstacle.
    Nearest(&'a NearestProof),
    /// Proof of the obstacles within a distance.
    Nearby(&'a NearbyProof),
    /// Proof of the clearance.
    Clearance(&'a ClearanceProof),
}

impl_from_proofs!(SceneProof { Nearest(NearestProof), Nearby(NearbyProof), Clearance(ClearanceProof) });

/// Queries with proofs.
impl<'a> SceneQuery<'a> {
    /// Finds the nearest obstacle as [`Self::nearest`] does, with a proof. The proof covers all obstacles whose boxes
    /// are nearer than the lower bound. Its own lower bound may be smaller than that of the answer. It is 0 if no
    /// positive distance is proven for one of these obstacles.
    ///
    /// # Errors
    /// Returns the errors of [`Self::nearest`].
    pub fn certified_nearest(&self) -> Result<Option<(Nearest, NearestProof)>, QueryError> {
        let Some(nearest) = self.nearest()? else { return Ok(None) };
        let Nearest { obstacle, mut lower, distance, .. } = nearest;
        let mut apart = Vec::new();
        for one in self.obstacles_below(lower, |other| boxes::box_distance(&self.bounds, other)) {
            let apart_from = self.prove_apart(one, lower).map_err(|e| e.of_obstacle(one.id))?;
            let Some(proof) = apart_from else {
                lower = 0.0;
                break;
            };
            lower = lower.min(claimed_distance(&proof));
            apart.push((one.id, proof));
        }
        if lower == 0.0 {
            apart.clear();
        }
        Ok(Some((nearest, NearestProof { lower, obstacle, near: distance.near(), apart })))
    }

    /// Finds the obstacles within a distance as [`Self::within`] does, with a proof.
    ///
    /// # Errors
    /// Returns the errors of [`Self::within`].
    pub fn certified_within(&self, length: f64) -> Result<(Nearby, NearbyProof), QueryError> {
        check_length(length)?;
        let nearby = self.within(length)?;
        let undecided = nearby.undecided.iter().map(|(id, _)| *id).collect();
        let closer = nearby.closer.clone();
        let mut proof = NearbyProof { length, closer, undecided, apart: Vec::new() };
        for one in
            self.obstacles_below(length.next_up(), |other| boxes::box_distance(&self.bounds, other))
        {
            let of_one = |e: QueryError| e.of_obstacle(one.id);
            match self.closeness_of(one, length).map_err(of_one)? {
                Closeness::Closer(_) => {}
                // The rounded box of the moving body may have decided in the search.
                Closeness::Undecided(_) => proof.undecided.push(one.id),
                Closeness::Farther => match self.prove_apart(one, length).map_err(of_one)? {
                    Some(apart) if claimed_distance(&apart) > length => {
                        proof.apart.push((one.id, apart));
                    }
                    _ => proof.undecided.push(one.id),
                },
            }
        }
        proof.undecided.sort_unstable();
        proof.undecided.dedup();
        Ok((nearby, proof))
    }

    /// Computes the clearance as [`Self::clearance`] does, with a proof. The proof covers all obstacles whose boxes do
    /// not exclude a contact before the lower bound, and the one that stops the body. If an obstacle overlaps the body,
    /// it covers only this obstacle. The lower bound of the proof may be smaller than that of the answer.
    ///
    /// # Errors
    /// Returns the errors of [`Self::clearance`].
    pub fn certified_clearance(
        &self,
        direction: DVec3,
    ) -> Result<(SceneClearance, ClearanceProof), QueryError> {
        let clearance = self.clearance(direction)?;
        let stop = clearance.stop.map(|(id, _)| id);
        let mut proof =
            ClearanceProof { direction, lower: clearance.lower, stop, passed: Vec::new() };
        for one in self.obstacles_to_prove(&clearance, direction) {
            let passed = self.prove_clearance(one, direction).map_err(|e| e.of_obstacle(one.id))?;
            proof.lower = proof.lower.min(claimed_translation(&passed));
            proof.passed.push((one.id, passed));
        }
        Ok((clearance, proof))
    }

    /// Proves bounds of the translation at which an obstacle stops the moving body, or that it does not stop it.
    fn prove_clearance(
        &self,
        one: &'a Obstacle,
        direction: DVec3,
    ) -> Result<ObstacleClearanceProof, QueryError> {
        Ok(match self.cast_with_obstacle(one, direction)? {
            ByKind::Convex(cast) => ByKind::Convex(cast.clearance()?),
            ByKind::Solid(cast) => ByKind::Solid(cast.certified_clearance()?.1),
        })
    }

    /// Returns the obstacles that need a proof: those whose boxes do not exclude a contact before the lower bound, and
    /// the one that stops the body. If the bodies overlap, only the latter is returned.
    fn obstacles_to_prove(
        &self,
        clearance: &SceneClearance,
        direction: DVec3,
    ) -> Vec<&'a Obstacle> {
        let stop = clearance.stop.and_then(|(id, _)| self.obstacles.item_of(id).ok());
        let stop = stop.map(|item| self.obstacle_of_item(item));
        if clearance.safe_translation().is_none() {
            return stop.into_iter().collect();
        }
        let sweep = self.sweep(direction);
        let below = clearance.lower.max(f64::MIN_POSITIVE);
        let mut found = self.obstacles_below(below, |other| sweep.entry_of_outer_box(other));
        if let Some(stop) = stop
            && let Err(place) = found.binary_search_by_key(&stop.id, |one| one.id)
        {
            found.insert(place, stop);
        }
        found
    }

    /// Returns the obstacles whose boxes have a bound below the given one, in the order of insertion.
    fn obstacles_below(&self, below: f64, bound: impl Fn(&Aabb) -> f64) -> Vec<&'a Obstacle> {
        let mut found = Vec::new();
        let visit = |item, bound| {
            let one = self.obstacle_of_item(item);
            if bound < below && !self.is_ignored(one.id) {
                found.push(one);
            }
            Ok::<_, Infallible>(below)
        };
        let Ok(_) = self.obstacles.tree().visit_by_bound(below, bound, visit);
        found.sort_unstable_by_key(|one| one.id);
        found
    }

    /// Proves that an obstacle is not nearer than a length. If it is nearer, proves a smaller lower bound. Returns
    /// `None` if no positive lower bound is proven.
    fn prove_apart(
        &self,
        one: &'a Obstacle,
        length: f64,
    ) -> Result<Option<ApartProof>, QueryError> {
        Ok(match self.pair_with_obstacle(one)? {
            ByKind::Convex(pair) => pair.distance()?.gap.map(ByKind::Convex),
            ByKind::Solid(pair) => {
                let proof = match pair.certified_within(length)? {
                    // A closer body still has a positive lower bound.
                    (Within::Closer(_), _) => Some(pair.certified_distance()?.1),
                    (Within::Farther(_) | Within::Undecided(_), proof) => proof,
                };
                proof.filter(|proof| proof.lower > 0.0).map(ByKind::Solid)
            }
        })
    }
}

/// Returns the distance that a proof claims as a lower bound.
pub(super) fn claimed_distance(proof: &ApartProof) -> f64 {
    match proof {
        ByKind::Convex(plane) => plane.gap,
        ByKind::Solid(certificate) => certificate.lower,
    }
}

/// Returns the translation before which the proof claims no contact; 0 if the bodies overlap.
fn claimed_translation(proof: &ObstacleClearanceProof) -> f64 {
    match proof {
        ByKind::Convex(clearance) => clearance.distance().unwrap_or(0.0),
        ByKind::Solid(certificate) => certificate.lower,
    }
}
