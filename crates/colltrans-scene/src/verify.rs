//! Checks proofs about one body among many.
//!
//! A check considers all obstacles one by one. Each satisfies the claim by its box, which is computed again from the
//! placed body, or by a proof that names it. The check uses neither the tree of the obstacles nor a search.

use std::collections::HashMap;

use glam::DVec3;

use super::boxes;
use super::obstacles::Obstacle;
use super::proof::{
    ApartProof, ClearanceProof, NearbyProof, NearestProof, ObstacleClearanceProof, SceneProof,
    claimed_distance,
};
use super::{ByKind, SceneQuery};
use colltrans_convex::answer::{CertificateError, Clearance, FreeReason};
use colltrans_convex::body::ObstacleId;
use colltrans_convex::cast::{Cast, verified_overlap};
use colltrans_convex::setting::{check_direction, check_length};
use colltrans_kernel::noise::Noise;
use colltrans_solid::cast::StartProof;
use colltrans_solid::kinds::AnyNear;

impl SceneQuery<'_> {
    /// Checks a proof against all obstacles. Returns the proven upper bound minus the lower bound, of the least
    /// distance or of the translation at which the body is stopped. Returns 0 for a proof of [`SceneQuery::within`], if
    /// nothing stops the body, or if it overlaps an obstacle.
    ///
    /// Each obstacle that is not ignored is checked by its box, which is computed again, or by its own proof, as
    /// [`Pair::verify`](colltrans_convex::Pair::verify) and [`Cast::verify`] do. The options must be those of the
    /// answer. Obstacles along which the body slides, or from which it moves away, are checked within the graze
    /// tolerance and rounding errors, as in [`Cast::clearance`].
    ///
    /// # Errors
    /// Returns the first claim that is not proven, with its obstacle.
    pub fn verify<'p>(&self, proof: impl Into<SceneProof<'p>>) -> Result<f64, CertificateError> {
        match proof.into() {
            SceneProof::Nearest(proof) => self.verify_nearest(proof),
            SceneProof::Nearby(proof) => self.verify_nearby(proof),
            SceneProof::Clearance(proof) => self.verify_clearance(proof),
        }
    }

    /// Checks a proof of the nearest obstacle.
    fn verify_nearest(&self, proof: &NearestProof) -> Result<f64, CertificateError> {
        let NearestProof { lower, obstacle, near, apart } = proof;
        let upper = self.verify_near(*obstacle, near)?;
        let claims = self.claims_by_obstacle(apart)?;
        if lower.is_nan() || *lower < 0.0 || *lower > upper {
            return Err(CertificateError::Order { lower: *lower, upper });
        }
        for one in
            self.queried_obstacles().filter(|one| *lower > 0.0 || claims.contains_key(&one.id))
        {
            let proven = self.verify_apart(one, claims.get(&one.id).copied())?;
            require_proof(proven >= *lower, one.id)?;
        }
        Ok(upper - lower)
    }

    /// Checks a proof of the obstacles within a distance.
    fn verify_nearby(&self, proof: &NearbyProof) -> Result<f64, CertificateError> {
        let NearbyProof { length, closer, undecided, apart } = proof;
        check_length(*length)?;
        let claims = self.claims_by_obstacle(apart)?;
        let open: Vec<(ObstacleId, ())> = undecided.iter().map(|id| (*id, ())).collect();
        let (open, close) = (self.claims_by_obstacle(&open)?, self.claims_by_obstacle(closer)?);
        // Each obstacle may have one claim only.
        let twice = |id: &&ObstacleId| {
            usize::from(open.contains_key(*id)) + usize::from(claims.contains_key(*id)) > 1
                || close.contains_key(*id) && (open.contains_key(*id) || claims.contains_key(*id))
        };
        if let Some(id) = open.keys().chain(claims.keys()).find(twice) {
            return Err(CertificateError::UnknownObstacle { obstacle: *id });
        }
        for (id, near) in closer {
            let proven = self.verify_near(*id, near)?;
            require_proof(proven <= *length, *id)?;
        }
        for one in self
            .queried_obstacles()
            .filter(|one| !open.contains_key(&one.id) && !close.contains_key(&one.id))
        {
            let proven = self.verify_apart(one, claims.get(&one.id).copied())?;
            require_proof(proven > *length, one.id)?;
        }
        Ok(0.0)
    }

    /// Checks a proof of a clearance.
    fn verify_clearance(&self, proof: &ClearanceProof) -> Result<f64, CertificateError> {
        let ClearanceProof { direction, lower, stop, passed } = proof;
        check_direction(*direction)?;
        let mut bounds = HashMap::with_capacity(passed.len());
        for (id, claim) in self.claims_by_obstacle(passed)? {
            let proven = self.verify_passed(self.queried_obstacle(id)?, claim, *direction);
            bounds.insert(id, proven.map_err(|e| e.of_obstacle(id))?);
        }
        let mut upper = f64::INFINITY;
        if let Some(id) = *stop {
            self.queried_obstacle(id)?;
            upper = bounds.get(&id).ok_or(CertificateError::Unproven { obstacle: id })?[1];
        }
        if upper == f64::NEG_INFINITY && *lower == 0.0 {
            return Ok(0.0);
        }
        let is_stopped = upper < f64::INFINITY;
        if lower.is_nan() || *lower < 0.0 || *lower > upper.max(0.0) || stop.is_some() != is_stopped
        {
            return Err(CertificateError::Order { lower: *lower, upper });
        }
        let sweep = self.sweep(*direction);
        for one in self.queried_obstacles() {
            let named = bounds.get(&one.id).map(|[lower, _]| *lower);
            let proven = named.unwrap_or_else(|| {
                sweep.entry_of_outer_box(&boxes::bounds_of_placed(&one.placed()))
            });
            // An obstacle with a contact at 0 needs a proof, because its box excludes nothing there.
            require_proof(proven >= *lower && (proven > 0.0 || named.is_some()), one.id)?;
        }
        Ok(if is_stopped { (upper - lower).max(0.0) } else { 0.0 })
    }

    /// Returns an obstacle by its id. Returns an error if it does not exist or is ignored.
    fn queried_obstacle(&self, id: ObstacleId) -> Result<&Obstacle, CertificateError> {
        let unknown = CertificateError::UnknownObstacle { obstacle: id };
        let item = self.obstacles.item_of(id).ok().filter(|_| !self.is_ignored(id));
        item.map(|item| self.obstacle_of_item(item)).ok_or(unknown)
    }

    /// Returns the claims by obstacle. Returns an error unless each obstacle is part of the query, in the order of
    /// insertion, and has one claim.
    fn claims_by_obstacle<'p, T>(
        &self,
        claims: &'p [(ObstacleId, T)],
    ) -> Result<HashMap<ObstacleId, &'p T>, CertificateError> {
        let mut named = HashMap::with_capacity(claims.len());
        let mut last = None;
        for (id, claim) in claims {
            self.queried_obstacle(*id)?;
            if last.is_some_and(|last| last >= *id) {
                return Err(CertificateError::UnknownObstacle { obstacle: *id });
            }
            last = Some(*id);
            named.insert(*id, claim);
        }
        Ok(named)
    }

    /// Checks a proof of closeness, and returns the proven upper bound of the distance of an obstacle.
    fn verify_near(&self, id: ObstacleId, near: &AnyNear) -> Result<f64, CertificateError> {
        let one = self.queried_obstacle(id)?;
        let proven = match (self.pair_with_obstacle(one)?, near) {
            (ByKind::Convex(pair), ByKind::Convex(near)) => pair.verify(near),
            (ByKind::Solid(pair), ByKind::Solid(near)) => pair.verify(near),
            _ => Err(CertificateError::StartClaim),
        };
        proven.map_err(|e| e.of_obstacle(id))?;
        Ok(near.distance())
    }

    /// Returns the proven lower bound of the distance of an obstacle, by a claim or by its box.
    fn verify_apart(
        &self,
        one: &Obstacle,
        claim: Option<&ApartProof>,
    ) -> Result<f64, CertificateError> {
        let Some(claim) = claim else {
            return Ok(boxes::box_distance(&self.bounds, &boxes::bounds_of_placed(&one.placed())));
        };
        let proven = match (self.pair_with_obstacle(one)?, claim) {
            (ByKind::Convex(pair), ByKind::Convex(plane)) => pair.verify(plane),
            (ByKind::Solid(pair), ByKind::Solid(certificate)) => pair.verify(certificate),
            _ => Err(CertificateError::StartClaim),
        };
        proven.map_err(|e| e.of_obstacle(one.id))?;
        Ok(claimed_distance(claim))
    }

    /// Returns the proven bounds of the translation at which an obstacle stops the moving body. They are infinity if it
    /// does not, and negative infinity if the bodies overlap.
    fn verify_passed(
        &self,
        one: &Obstacle,
        claim: &ObstacleClearanceProof,
        direction: DVec3,
    ) -> Result<[f64; 2], CertificateError> {
        match (self.cast_with_obstacle(one, direction)?, claim) {
            (ByKind::Convex(cast), ByKind::Convex(clearance)) => {
                verify_convex_clearance(&cast, clearance)
            }
            (ByKind::Solid(cast), ByKind::Solid(certificate)) => {
                cast.verify(certificate)?;
                let overlaps = matches!(certificate.start, StartProof::Overlapping(_));
                if overlaps && certificate.search_aim(cast.options()).is_none() {
                    return Ok([f64::NEG_INFINITY; 2]);
                }
                let upper = certificate.stop.map_or(f64::INFINITY, |stop| stop.offset_distance);
                Ok([certificate.lower, upper])
            }
            _ => Err(CertificateError::StartClaim),
        }
    }
}

/// Returns an error for an obstacle unless a condition holds.
fn require_proof(holds: bool, obstacle: ObstacleId) -> Result<(), CertificateError> {
    if holds { Ok(()) } else { Err(CertificateError::Unproven { obstacle }) }
}

/// Checks a clearance of convex bodies, and returns the bounds of the translation at which the moving body is stopped.
fn verify_convex_clearance(
    cast: &Cast<'_>,
    clearance: &Clearance,
) -> Result<[f64; 2], CertificateError> {
    const NEVER: [f64; 2] = [f64::INFINITY; 2];
    match clearance {
        Clearance::Blocked { distance, contact } => {
            let certificate = &contact.certificate;
            cast.verify(certificate)?;
            let proven = certificate.lower.max(0.0);
            if *distance <= proven {
                Ok([*distance, certificate.upper])
            } else {
                Err(CertificateError::Bound { proven, claimed: *distance })
            }
        }
        Clearance::Free(FreeReason::Separated(separated)) => {
            cast.verify(&separated.certificate)?;
            Ok(NEVER)
        }
        Clearance::Free(FreeReason::Behind(last)) => {
            let certificate = &last.certificate;
            cast.reversed().verify(certificate)?;
            let is_behind = certificate.lower >= -certificate.rounding;
            if is_behind { Ok(NEVER) } else { Err(CertificateError::StartClaim) }
        }
        Clearance::Free(FreeReason::Slides(grazing)) => {
            let proven = verified_overlap(grazing.separating_direction, cast)?;
            let [_, gap] = cast.setting.core_gap_bounds(cast.options.min_gap);
            let noise = Noise::for_size(cast.setting.size() + gap);
            let most = cast.options.graze_tolerance.max(noise.touching_distance())
                + 2.0 * noise.point_error();
            if proven <= most { Ok(NEVER) } else { Err(CertificateError::StartClaim) }
        }
        Clearance::Overlapping(ends) => {
            let behind = [(cast, &ends.first), (&cast.reversed(), &ends.last)];
            for (cast, contact) in behind {
                cast.verify(&contact.certificate)?;
                if contact.certificate.upper >= 0.0 {
                    return Err(CertificateError::StartClaim);
                }
            }
            Ok([f64::NEG_INFINITY; 2])
        }
    }
}
