//! Proofs about one body among many, and their checks.
//!
//! A check takes all obstacles one by one: each is beyond what is claimed by its box alone, made anew from
//! its vertices, or by a proof that names it. The tree plays no part, and nothing is searched.

use std::collections::HashMap;
use std::convert::Infallible;

use glam::DVec3;

use super::boxes::{self, Sweep};
use super::nearest::{Closeness, Nearby, Nearest};
use super::obstacles::Obstacle;
use super::{Among, ByKind, ClearanceAmong};
use colltrans_convex::answer::{
    CertificateError, Clearance, PlaneGap, WhyFree, Within, checked_as,
};
use colltrans_convex::body::{Aabb, ObstacleId};
use colltrans_convex::cast::{Cast, verified_overlap};
use colltrans_convex::setting::error::QueryError;
use colltrans_convex::setting::{check_direction, check_length};
use colltrans_kernel::noise::Noise;
use colltrans_solid::cast::{SolidCertificate, StartProof};
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
fn gap_of(proof: &ApartProof) -> f64 {
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

/// Checks.
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
