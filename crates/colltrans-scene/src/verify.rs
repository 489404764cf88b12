//! Checks of proofs about one body among many.
//!
//! A check takes all obstacles one by one: each is beyond what is claimed by its box alone, made anew from
//! its vertices, or by a proof that names it. The tree plays no part, and nothing is searched.

use std::collections::HashMap;

use glam::DVec3;

use super::boxes::{self, Sweep};
use super::obstacles::Obstacle;
use super::proof::{
    AmongProof, ApartProof, ClearanceProof, NearbyProof, NearestProof, PassedProof, gap_of,
};
use super::{Among, ByKind};
use colltrans_convex::answer::{CertificateError, Clearance, WhyFree};
use colltrans_convex::body::ObstacleId;
use colltrans_convex::cast::{Cast, verified_overlap};
use colltrans_convex::setting::{check_direction, check_length};
use colltrans_kernel::noise::Noise;
use colltrans_solid::cast::StartProof;
use colltrans_solid::kinds::AnyNear;

impl Among<'_> {
    /// Checks a proof against all obstacles, and returns how far the bounds are apart that it proves: of the
    /// least distance, or of the translation at which the moving body is stopped; 0 where there is one bound.
    ///
    /// All obstacles are looked at that are not ignored, each by its box, made anew, or by its own proof, as
    /// [`Pair::verify`](colltrans_convex::Pair::verify) and [`Cast::verify`] check it. Choices have to be those of the
    /// answer. Obstacles that are slid along, or moved away from, are so to within the graze tolerance and
    /// rounding, as [`Cast::clearance`] takes them.
    ///
    /// # Errors
    /// What is not proven, and of which obstacle.
    pub fn verify<'p>(&self, proof: impl Into<AmongProof<'p>>) -> Result<f64, CertificateError> {
        match proof.into() {
            AmongProof::Nearest(proof) => self.verify_nearest(proof),
            AmongProof::Nearby(proof) => self.verify_nearby(proof),
            AmongProof::Clearance(proof) => self.verify_clearance(proof),
        }
    }

    fn verify_nearest(&self, proof: &NearestProof) -> Result<f64, CertificateError> {
        let NearestProof { lower, obstacle, near, apart } = proof;
        let upper = self.verify_near(*obstacle, near)?;
        let claims = self.named(apart)?;
        if lower.is_nan() || *lower < 0.0 || *lower > upper {
            return Err(CertificateError::Order { lower: *lower, upper });
        }
        for one in self.asked().filter(|one| *lower > 0.0 || claims.contains_key(&one.id)) {
            let proven = self.verify_apart(one, claims.get(&one.id).copied())?;
            require(proven >= *lower, one.id)?;
        }
        Ok(upper - lower)
    }

    fn verify_nearby(&self, proof: &NearbyProof) -> Result<f64, CertificateError> {
        let NearbyProof { length, closer, undecided, apart } = proof;
        check_length(*length)?;
        let claims = self.named(apart)?;
        let open: Vec<(ObstacleId, ())> = undecided.iter().map(|id| (*id, ())).collect();
        let (open, close) = (self.named(&open)?, self.named(closer)?);
        // Of each obstacle one thing is claimed.
        let twice = |id: &&ObstacleId| {
            usize::from(open.contains_key(*id)) + usize::from(claims.contains_key(*id)) > 1
                || close.contains_key(*id) && (open.contains_key(*id) || claims.contains_key(*id))
        };
        if let Some(id) = open.keys().chain(claims.keys()).find(twice) {
            return Err(CertificateError::UnknownObstacle { obstacle: *id });
        }
        for (id, near) in closer {
            let proven = self.verify_near(*id, near)?;
            require(proven <= *length, *id)?;
        }
        for one in
            self.asked().filter(|one| !open.contains_key(&one.id) && !close.contains_key(&one.id))
        {
            let proven = self.verify_apart(one, claims.get(&one.id).copied())?;
            require(proven > *length, one.id)?;
        }
        Ok(0.0)
    }

    fn verify_clearance(&self, proof: &ClearanceProof) -> Result<f64, CertificateError> {
        let ClearanceProof { direction, lower, stop, passed } = proof;
        check_direction(*direction)?;
        let mut bounds = HashMap::with_capacity(passed.len());
        for (id, claim) in self.named(passed)? {
            let proven = self.verify_passed(self.known(id)?, claim, *direction);
            bounds.insert(id, proven.map_err(|e| e.of_obstacle(id))?);
        }
        let mut upper = f64::INFINITY;
        if let Some(id) = *stop {
            self.known(id)?;
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
        let sweep = Sweep::new(self.swept(), *direction);
        for one in self.asked() {
            let named = bounds.get(&one.id).map(|[lower, _]| *lower);
            let proven = named.unwrap_or_else(|| sweep.entry(&boxes::of_placed(&one.placed())));
            // Who is met at 0 has to be named: what a box says there is nothing.
            require(proven >= *lower && (proven > 0.0 || named.is_some()), one.id)?;
        }
        Ok(if is_stopped { (upper - lower).max(0.0) } else { 0.0 })
    }

    /// An obstacle that is asked about.
    fn known(&self, id: ObstacleId) -> Result<&Obstacle, CertificateError> {
        let unknown = CertificateError::UnknownObstacle { obstacle: id };
        let item = self.obstacles.item(id).ok().filter(|_| !self.is_ignored(id));
        item.map(|item| self.obstacle(item)).ok_or(unknown)
    }

    /// Claims by obstacle: each of one that is asked about, in order, none twice.
    fn named<'p, T>(
        &self,
        claims: &'p [(ObstacleId, T)],
    ) -> Result<HashMap<ObstacleId, &'p T>, CertificateError> {
        let mut named = HashMap::with_capacity(claims.len());
        let mut last = None;
        for (id, claim) in claims {
            self.known(*id)?;
            if last.is_some_and(|last| last >= *id) {
                return Err(CertificateError::UnknownObstacle { obstacle: *id });
            }
            last = Some(*id);
            named.insert(*id, claim);
        }
        Ok(named)
    }

    /// The distance that an obstacle is proven not to exceed.
    fn verify_near(&self, id: ObstacleId, near: &AnyNear) -> Result<f64, CertificateError> {
        let one = self.known(id)?;
        let proven = match (self.pair(one)?, near) {
            (ByKind::Convex(pair), ByKind::Convex(near)) => pair.verify(near),
            (ByKind::Solid(pair), ByKind::Solid(near)) => pair.verify(near),
            _ => Err(CertificateError::Start),
        };
        proven.map_err(|e| e.of_obstacle(id))?;
        Ok(near.distance())
    }

    /// The distance below which an obstacle is proven not to be, by what is claimed or by its box.
    fn verify_apart(
        &self,
        one: &Obstacle,
        claim: Option<&ApartProof>,
    ) -> Result<f64, CertificateError> {
        let Some(claim) = claim else {
            return Ok(boxes::distance(&self.bounds, &boxes::of_placed(&one.placed())));
        };
        let proven = match (self.pair(one)?, claim) {
            (ByKind::Convex(pair), ByKind::Convex(plane)) => pair.verify(plane),
            (ByKind::Solid(pair), ByKind::Solid(certificate)) => pair.verify(certificate),
            _ => Err(CertificateError::Start),
        };
        proven.map_err(|e| e.of_obstacle(one.id))?;
        Ok(gap_of(claim))
    }

    /// The bounds of where an obstacle is proven to stop the moving body: infinite if it does not, minus
    /// infinite if they overlap.
    fn verify_passed(
        &self,
        one: &Obstacle,
        claim: &PassedProof,
        direction: DVec3,
    ) -> Result<[f64; 2], CertificateError> {
        match (self.cast(one, direction)?, claim) {
            (ByKind::Convex(cast), ByKind::Convex(clearance)) => convex_bounds(&cast, clearance),
            (ByKind::Solid(cast), ByKind::Solid(certificate)) => {
                cast.verify(certificate)?;
                let overlaps = matches!(certificate.start, StartProof::Overlapping(_));
                if overlaps && certificate.aim(cast.options()).is_none() {
                    return Ok([f64::NEG_INFINITY; 2]);
                }
                let upper = certificate.stop.map_or(f64::INFINITY, |stop| stop.shrunk_distance);
                Ok([certificate.lower, upper])
            }
            _ => Err(CertificateError::Start),
        }
    }
}

fn require(holds: bool, obstacle: ObstacleId) -> Result<(), CertificateError> {
    if holds { Ok(()) } else { Err(CertificateError::Unproven { obstacle }) }
}

/// What a clearance of convex bodies proves: bounds of where the moving one is stopped.
fn convex_bounds(cast: &Cast<'_>, clearance: &Clearance) -> Result<[f64; 2], CertificateError> {
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
        Clearance::Free(WhyFree::Separated(separated)) => {
            cast.verify(&separated.certificate)?;
            Ok(NEVER)
        }
        Clearance::Free(WhyFree::Behind(last)) => {
            let certificate = &last.certificate;
            cast.reversed().verify(certificate)?;
            let is_behind = certificate.lower >= -certificate.rounding;
            if is_behind { Ok(NEVER) } else { Err(CertificateError::Start) }
        }
        Clearance::Free(WhyFree::Slides(grazing)) => {
            let proven = verified_overlap(grazing.separating_direction, cast)?;
            let noise: Noise = cast.setting.noise();
            let most = cast.options.graze_tolerance.max(noise.touching()) + 2.0 * noise.point();
            if proven <= most { Ok(NEVER) } else { Err(CertificateError::Start) }
        }
        Clearance::Overlapping(ends) => {
            let behind = [(cast, &ends.first), (&cast.reversed(), &ends.last)];
            for (cast, contact) in behind {
                cast.verify(&contact.certificate)?;
                if contact.certificate.upper >= 0.0 {
                    return Err(CertificateError::Start);
                }
            }
            Ok([f64::NEG_INFINITY; 2])
        }
    }
}
