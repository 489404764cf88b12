//! The distance of two solids, and its proof.
//!
//! - Surfaces: the hulls of convex bodies give the nearest facets and a separating plane. Otherwise a best-first search
//!   compares pairs of facets. The plane, or the cover of the search, proves that no pair of facets is nearer.
//! - Bodies: they meet if facets have a common point or if a shell lies inside the other body. Both are decided
//!   exactly. Common points are searched only if the distance of the surfaces may be 0, enclosed shells only if the
//!   surfaces are apart.
//! - A tolerance of a cast has no effect. Distances are those of the nominal bodies.
//! - The search and the cover are about the cores of rounded bodies. Bounds and proofs are about the bodies: they are
//!   those of the cores less both radii.

use std::collections::HashMap;

use glam::DVec3;

use crate::body::{AsSolid, Solid};
use crate::cast::tolerance::least_tolerance_from;
use crate::cast::{Claim, Cover};
use crate::solve::hulls::nearest_facets;
use crate::solve::nearest::search::{DistanceSearch, SearchEnd, proven_bound};
#[cfg(feature = "serde")]
use crate::solve::nearest::weighted_points;
use crate::solve::nearest::{
    Apart, Axes, NearestPoints, SolidGap, SolidNear, distance_of, find_common_point, shared_points,
    triangle,
};
use crate::solve::overlap::{is_touch, nested_shell};
use crate::solve::scene::PairFrame;
use crate::solve::steps::SolidSteps;
use colltrans_convex::answer::{CertificateError, Distance, Within, are_weights, impl_from_proofs};
use colltrans_convex::body::{Features, Placed};
use colltrans_convex::cast::Cast;
use colltrans_convex::pair::{Pair, PairBody, surface_points};
use colltrans_convex::setting::error::QueryError;
use colltrans_convex::setting::{Setting, TwoBodies, check_length};

/// A proof of the distance of two solids, verified by [`Pair::verify`] without a search.
///
/// Each pair of facets is covered by one entry of the cover, and each entry is verified by itself.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct DistanceCertificate {
    /// Proven lower bound on the distance, in world units: the least that an entry of the cover proves. It is 0 if
    /// nothing is proven.
    pub lower: f64,
    /// Proof of the upper bound.
    pub near: SolidNear,
    /// Proof of the lower bound. Verification checks separately that no shell lies inside the other body.
    pub cover: Cover<Apart>,
}

impl DistanceCertificate {
    /// Returns a proof of the upper bound only; the lower bound is 0.
    pub fn from_near(near: SolidNear) -> Self {
        Self { lower: 0.0, near, cover: Cover::default() }
    }
}

/// A proof to verify about two solids in their poses.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum SolidPairProof<'a> {
    /// Proof of both bounds of the distance.
    Distance(&'a DistanceCertificate),
    /// Proof of an upper bound on the distance.
    Near(&'a SolidNear),
}

impl_from_proofs!(SolidPairProof { Distance(DistanceCertificate), Near(SolidNear) });

/// The answer of [`SolidPair::overlap_depth`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct OverlapDepth {
    /// Whether the nominal bodies have a common point, decided exactly. For rounded bodies, whether the distance of
    /// the cores is certainly at most the sum of the radii.
    pub meets: bool,
    /// Least tolerance at which the bodies do not overlap, as in
    /// [`SolidCast::least_tolerance`](crate::SolidCast::least_tolerance). It is 0 if the bodies do not overlap, and
    /// `None` if no tolerance ends the overlap.
    pub least_tolerance: Option<f64>,
    /// Number of steps of the search.
    #[cfg_attr(feature = "serde", serde(default))]
    pub steps: SolidSteps,
}

impl Cover<Apart> {
    /// Returns the claim of each entry with its facets, or `None` if the cover does not fit the bodies.
    pub fn claims(&self, pair: &Pair<'_, Solid>) -> Option<Vec<Claim<Apart>>> {
        self.claims_between([pair.moving(), pair.fixed()])
    }
}

/// Result of a search for the nearest facets.
pub(crate) struct NearestFacets {
    pub(crate) spot: Option<NearestPoints>,
    /// Lower bound on the distance of all facets.
    pub(crate) lower: f64,
    /// Whether a plane separates the bodies, so that neither is inside the other.
    pub(crate) are_separated: bool,
    /// Cover of all pairs of nodes, if a proof was requested and the lower bound is positive.
    pub(crate) cover: Option<Cover<Apart>>,
    /// Lower bound of the distance of the cores that the cover proves, if it is known.
    proven: Option<f64>,
    pub(crate) steps: SolidSteps,
}

/// Data for a proof: points of the bodies, and a cover of all pairs of facets if the bodies are apart.
pub struct ProofInput {
    near: SolidNear,
    cover: Option<Cover<Apart>>,
    /// Lower bound of the distance of the cores that the cover proves, if it is known.
    proven: Option<f64>,
}

/// Queries of a [`Pair`] of two [`Solid`]s that pairs of other bodies do not have.
pub trait SolidPair<'a>: Sized {
    /// Returns the pair of two bodies as solids, for example of a solid and a convex polyhedron.
    ///
    /// # Errors
    /// Returns an error for a convex body whose facets [`Solid::from_mesh`] rejects.
    fn between<A: AsSolid, B: AsSolid>(
        moving: Placed<'a, A>,
        fixed: Placed<'a, B>,
    ) -> Result<Self, QueryError>;

    /// Computes [`Pair::distance`] and its proof. The proof takes an additional pass over the cover, and one byte per
    /// pair of nodes.
    ///
    /// # Errors
    /// Returns an error in the same cases as [`Pair::distance`].
    fn certified_distance(&self) -> Result<(Distance<Solid>, DistanceCertificate), QueryError>;

    /// Computes [`Pair::within`] and a proof of a lower bound on the distance. The proof is `None` if the answer is
    /// `Closer`, which contains its own proof, or if the search finds no positive lower bound.
    ///
    /// # Errors
    /// Returns an error in the same cases as [`Pair::within`].
    fn certified_within(
        &self,
        length: f64,
    ) -> Result<(Within<Solid>, Option<DistanceCertificate>), QueryError>;

    /// Checks whether the bodies have a common point, and computes the depth of their overlap as the least tolerance at
    /// which they do not overlap. This depth is not a translation. For convex bodies [`Pair::depth`] returns one.
    ///
    /// # Errors
    /// Returns no error at present.
    ///
    /// ```
    /// # use colltrans::glam::DVec3;
    /// # use colltrans::solid::SolidPair;
    /// # use colltrans::{Pair, Pose, ConvexPolyhedron};
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// let there = Pose::from_translation(DVec3::new(0.75, 0.5, 0.5))?;
    /// let found = Pair::between(cube.at(Pose::IDENTITY), cube.at(there))?.overlap_depth()?;
    /// assert!(found.meets && (found.least_tolerance.unwrap() - 0.25).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    fn overlap_depth(&self) -> Result<OverlapDepth, QueryError>;
}

/// Search and proof in separate steps, for the crates that write files.
#[doc(hidden)]
pub trait SolidPairSearch {
    /// Computes the distance, with the data for a proof if `prove` is set.
    fn distance_with_proof_input(
        &self,
        prove: bool,
    ) -> Result<(Distance<Solid>, ProofInput), QueryError>;

    /// Builds the proof from the data of a search. Its lower bound is the one that the cover proves, or 0 if there is
    /// no cover or it proves nothing.
    fn prove_lower_bound(&self, found: ProofInput) -> Result<DistanceCertificate, QueryError>;

    /// Computes [`Pair::within_counted`], with the data for a proof if `prove` is set.
    fn within_with_proof_input(
        &self,
        length: f64,
        prove: bool,
    ) -> Result<((Within<Solid>, SolidSteps), ProofInput), QueryError>;

    /// Returns points of the moving and of the fixed body, rounded, in world coordinates, whose distance `near`
    /// claims.
    #[cfg(feature = "serde")]
    fn witness_points(&self, near: &SolidNear) -> Result<[DVec3; 2], QueryError>;

    /// Checks whether a shell of one body lies inside the other one. The surfaces of the bodies must not cross.
    fn is_nested(&self) -> Result<bool, QueryError>;
}

impl<'a> SolidPair<'a> for Pair<'a, Solid> {
    fn between<A: AsSolid, B: AsSolid>(
        moving: Placed<'a, A>,
        fixed: Placed<'a, B>,
    ) -> Result<Self, QueryError> {
        let (a, b) = (moving.body.as_surface()?, fixed.body.as_surface()?);
        Self::new(a.at(moving.pose), b.at(fixed.pose))
    }

    fn certified_distance(&self) -> Result<(Distance<Solid>, DistanceCertificate), QueryError> {
        let (mut distance, found) = self.distance_with_proof_input(true)?;
        let proof = self.prove_lower_bound(found)?;
        distance.lower = proof.lower;
        distance.gap = (proof.lower > 0.0).then_some(SolidGap { gap: proof.lower });
        Ok((distance, proof))
    }

    fn certified_within(
        &self,
        length: f64,
    ) -> Result<(Within<Solid>, Option<DistanceCertificate>), QueryError> {
        let ((answer, _), found) = self.within_with_proof_input(length, true)?;
        prove_within(self, length, answer, found)
    }

    fn overlap_depth(&self) -> Result<OverlapDepth, QueryError> {
        let bodies = [self.bodies.moving_placed(), self.bodies.fixed_placed()];
        // Neither query depends on the direction.
        let cast = Cast::new(bodies[0], bodies[1], DVec3::Z)?;
        let found = cast.intersects()?;
        let (meets, mut steps) = (found.meets, found.evidence.steps);
        let least_tolerance =
            if meets { least_tolerance_from(&cast, None, &mut steps) } else { Some(0.0) };
        Ok(OverlapDepth { meets, least_tolerance, steps })
    }
}

impl SolidPairSearch for Pair<'_, Solid> {
    #[inline]
    fn distance_with_proof_input(
        &self,
        prove: bool,
    ) -> Result<(Distance<Solid>, ProofInput), QueryError> {
        let scene = pair_scene(self)?;
        let nearest = search_nearest(self, &scene, SearchEnd::LEAST, prove);
        let distance = distance_answer(self, &scene, &nearest);
        let cover = nearest.cover.filter(|_| distance.lower > 0.0);
        Ok((distance, ProofInput { near: distance.near, cover, proven: nearest.proven }))
    }

    #[inline]
    fn prove_lower_bound(&self, found: ProofInput) -> Result<DistanceCertificate, QueryError> {
        let ProofInput { near, cover, proven } = found;
        let Some(cover) = cover else { return Ok(DistanceCertificate::from_near(near)) };
        let proven = match proven {
            Some(proven) => Ok(proven),
            None => least_proven_distance(&pair_scene(self)?, &near, &cover),
        };
        Ok(match proven.map(|cores| self.bodies.less_radii(cores)) {
            Ok(lower) if lower > 0.0 => DistanceCertificate { lower, near, cover },
            _ => DistanceCertificate::from_near(near),
        })
    }

    fn within_with_proof_input(
        &self,
        length: f64,
        prove: bool,
    ) -> Result<((Within<Solid>, SolidSteps), ProofInput), QueryError> {
        check_length(length)?;
        let scene = pair_scene(self)?;
        let [low, high] = self.bodies.core_gap_bounds(length);
        let until = SearchEnd {
            // Pairs beyond this distance count as farther. The margin exceeds the amount by which a bound may be
            // lowered.
            beyond: high + 0.125 * scene.noise,
            enough: low - triangle::LENGTH_NOISES * scene.noise,
        };
        let NearestFacets { spot, lower, cover, proven, mut steps, .. } =
            search_nearest(self, &scene, until, prove && until.beyond.is_finite());
        let near_of = |spot: NearestPoints| near_less_radii(&self.bodies, spot.solid_near(&scene));
        let near = spot.map(near_of);
        let lower = self.bodies.less_radii(lower);
        let meeting = || nested_shell(&scene).map(SolidNear::Meeting);
        let closer = near.map_or_else(meeting, |near| (near.distance() <= length).then_some(near));
        if let Some(near) = closer {
            let found = ProofInput { near, cover: None, proven: None };
            return Ok(((Within::Closer(near), steps), found));
        }
        if lower > length {
            let near =
                near.unwrap_or_else(|| near_of(NearestPoints::from_triangles(&scene, [0, 0])));
            let answer = Within::Farther(SolidGap { gap: lower });
            return Ok(((answer, steps), ProofInput { near, cover, proven }));
        }
        let (distance, found) = self.distance_with_proof_input(prove)?;
        steps += distance.steps;
        let answer = if distance.upper <= length {
            let near = distance.near;
            let found = ProofInput { near, cover: None, proven: None };
            return Ok(((Within::Closer(near), steps), found));
        } else if distance.lower > length {
            Within::Farther(SolidGap { gap: distance.lower })
        } else {
            Within::Undecided(distance)
        };
        Ok(((answer, steps), found))
    }

    #[cfg(feature = "serde")]
    #[inline]
    fn witness_points(&self, near: &SolidNear) -> Result<[DVec3; 2], QueryError> {
        let scene = pair_scene(self)?;
        let origin = self.bodies.translations[0];
        let points = match *near {
            SolidNear::Meeting(place) => shared_points(&scene, place),
            SolidNear::Points { triangles, weights, distance } => {
                let cores = weighted_points(&scene, triangles, weights.map(DVec3::from_array));
                surface_points(&self.bodies, cores, distance, DVec3::ZERO)
            }
        };
        Ok(points.map(|point| point + origin))
    }

    #[inline]
    fn is_nested(&self) -> Result<bool, QueryError> {
        Ok(nested_shell(&pair_scene(self)?).is_some())
    }
}

impl PairBody for Solid {
    type PairProof<'p> = SolidPairProof<'p>;

    fn distance(pair: &Pair<'_, Self>) -> Result<Distance<Self>, QueryError> {
        Ok(pair.distance_with_proof_input(false)?.0)
    }

    fn within(
        pair: &Pair<'_, Self>,
        length: f64,
    ) -> Result<(Within<Self>, SolidSteps), QueryError> {
        Ok(pair.within_with_proof_input(length, false)?.0)
    }

    fn verify_pair(
        pair: &Pair<'_, Self>,
        proof: SolidPairProof<'_>,
    ) -> Result<f64, CertificateError> {
        // The scene has a direction, which the proof does not use.
        let scene = pair_scene(pair).map_err(|_| CertificateError::StartClaim)?;
        match proof {
            SolidPairProof::Near(near) => verify_near(&scene, near),
            SolidPairProof::Distance(certificate) => {
                let upper = verify_near(&scene, &certificate.near)?;
                let lower = verify_cover(&scene, certificate)?;
                Ok(upper - lower)
            }
        }
    }
}

/// Proves the answer of a search, and restricts it to what the proof shows. The cover may prove less than the search.
fn prove_within(
    pair: &Pair<'_, Solid>,
    length: f64,
    answer: Within<Solid>,
    found: ProofInput,
) -> Result<(Within<Solid>, Option<DistanceCertificate>), QueryError> {
    if found.cover.is_none() {
        return Ok((answer, None));
    }
    let mut proof = pair.prove_lower_bound(found)?;
    let distance = match answer {
        Within::Closer(_) => return Ok((answer, Some(proof))),
        Within::Undecided(distance) => distance,
        Within::Farther(_) if proof.lower > length => {
            return Ok((Within::Farther(SolidGap { gap: proof.lower }), Some(proof)));
        }
        Within::Farther(_) => {
            // The search for the distance has a cover of its own.
            let (distance, found) = pair.distance_with_proof_input(true)?;
            proof = pair.prove_lower_bound(found)?;
            distance
        }
    };
    let lower = proof.lower;
    let answer = if lower > length {
        Within::Farther(SolidGap { gap: lower })
    } else {
        let gap = (lower > 0.0).then_some(SolidGap { gap: lower });
        Within::Undecided(Distance { lower, gap, ..distance })
    };
    Ok((answer, Some(proof)))
}

/// Returns the cores of the nominal bodies in a common frame; its direction `z` has no meaning.
pub(crate) fn pair_scene<'a>(pair: &Pair<'a, Solid>) -> Result<PairFrame<'a>, QueryError> {
    let setting = Setting::from_bodies(pair.bodies, DVec3::Z)?;
    Ok(PairFrame::of_cores(&setting))
}

/// Lowers the upper bound of a distance of cores by both radii. Changes nothing if no body is rounded.
fn near_less_radii(bodies: &TwoBodies<'_, Solid>, near: SolidNear) -> SolidNear {
    match near {
        SolidNear::Meeting(_) => near,
        SolidNear::Points { triangles, weights, distance } => {
            let distance = bodies.distance_less_radii(distance);
            SolidNear::Points { triangles, weights, distance }
        }
    }
}

/// Finds the nearest facets: those of convex bodies from the distance of their hulls, others by a search. If `prove` is
/// set, the result has a cover: the plane between the facets of convex bodies, or the pairs of nodes of the search.
pub(crate) fn search_nearest(
    pair: &Pair<'_, Solid>,
    scene: &PairFrame,
    until: SearchEnd,
    prove: bool,
) -> NearestFacets {
    if let Some(found) = nearest_facets(scene, prove) {
        let steps = SolidSteps { leaves: found.leaves, ..SolidSteps::default() };
        let (spot, lower, proven) = (Some(found.spot), found.lower, found.proven);
        let cover = prove.then(|| Cover(vec![Some(Apart::NearestPlane)]));
        return NearestFacets { spot, lower, are_separated: true, cover, proven, steps };
    }
    let mut cuts = HashMap::new();
    let mut search = DistanceSearch::new(scene, until, |nodes, reason| {
        if prove {
            cuts.insert(nodes, reason);
        }
    });
    let ((found, lower), steps) = (search.find_nearest(), search.steps);
    // If the search ended early, some pairs have no reason, and the bound is 0.
    let cover = (prove && lower > 0.0).then(|| Cover::new([pair.moving(), pair.fixed()], &cuts));
    let spot = found.map(NearestPoints::from);
    NearestFacets { spot, lower, are_separated: false, cover, proven: None, steps }
}

/// Returns the distance of the bodies from the result for their surfaces.
fn distance_answer(
    pair: &Pair<'_, Solid>,
    scene: &PairFrame,
    nearest: &NearestFacets,
) -> Distance<Solid> {
    let origin = pair.bodies.translations[0];
    let mut steps = nearest.steps;
    let place = if nearest.are_separated {
        None
    } else {
        find_common_point(scene, nearest.lower, &mut steps)
    };
    let spot = nearest.spot.unwrap_or_else(|| NearestPoints::from_triangles(scene, [0, 0]));
    let (near, points) = if let Some(place) = place {
        (SolidNear::Meeting(place), shared_points(scene, place))
    } else {
        let near = near_less_radii(&pair.bodies, spot.solid_near(scene));
        let normal = if nearest.lower > 0.0 { spot.nearest.normal } else { DVec3::ZERO };
        let cores = spot.witness_points(scene);
        (near, surface_points(&pair.bodies, cores, near.distance(), normal))
    };
    let lower = if place.is_some() { 0.0 } else { pair.bodies.less_radii(nearest.lower).max(0.0) };
    let spot = (lower > 0.0).then_some(spot);
    let features = spot.map(|spot| spot.features(scene));
    Distance {
        lower,
        upper: near.distance(),
        on_moving: points[0] + origin,
        on_fixed: points[1] + origin,
        normal: spot.map(|spot| spot.nearest.normal),
        features: features.map(|[moving, fixed]| Features { moving, fixed }),
        near,
        gap: (lower > 0.0).then_some(SolidGap { gap: lower }),
        steps,
    }
}

/// Returns the smallest distance of the cores that the entries of a cover prove. `near` proves the upper bound of the
/// distance, by facets that exist.
///
/// # Errors
/// Returns [`CertificateError::Cover`] if the cover does not fit the bodies, or for an entry that proves no positive
/// distance or is marked as examined without being a pair of leaves.
pub(crate) fn least_proven_distance(
    scene: &PairFrame,
    near: &SolidNear,
    cover: &Cover<Apart>,
) -> Result<f64, CertificateError> {
    let bodies = [scene.moving.solid, scene.fixed.solid];
    let axes = Axes::new(scene);
    let mut least = f64::INFINITY;
    let walked = cover.visit_entries(bodies, |_, nodes, reason| {
        let leaf = |k: usize| bodies[k].nodes()[nodes[k] as usize].is_leaf();
        if reason == Apart::Examined && !(leaf(0) && leaf(1)) {
            return false;
        }
        least = least.min(proven_bound((scene, &axes), near, nodes, reason));
        least > 0.0
    });
    walked.map_err(|entry| CertificateError::Cover { entry })?;
    Ok(least)
}

/// Verifies the upper bound, and returns the distance of the points that prove it.
fn verify_near(scene: &PairFrame, near: &SolidNear) -> Result<f64, CertificateError> {
    match *near {
        SolidNear::Meeting(place) if is_touch(scene, place) => Ok(0.0),
        SolidNear::Meeting(_) => Err(CertificateError::StartClaim),
        SolidNear::Points { triangles, weights, distance: claimed } => {
            if let Some(&weights) = weights.iter().find(|weights| !are_weights(&weights[..])) {
                return Err(CertificateError::Weights { weights });
            }
            let [moving, fixed] = triangles;
            let proven = distance_of(scene, triangles, weights)
                .ok_or(CertificateError::Facets { moving, fixed })?;
            let proven = scene.setting.distance_less_radii(proven);
            if claimed >= proven {
                Ok(proven)
            } else {
                Err(CertificateError::Bound { proven, claimed })
            }
        }
    }
}

/// Verifies the lower bound, and returns the distance that the cover proves.
fn verify_cover(
    scene: &PairFrame,
    certificate: &DistanceCertificate,
) -> Result<f64, CertificateError> {
    let DistanceCertificate { lower: claimed, near, cover } = certificate;
    if *claimed == 0.0 && cover.is_empty() {
        return Ok(0.0);
    }
    let proven = scene.setting.less_radii(least_proven_distance(scene, near, cover)?);
    let met = matches!(near, SolidNear::Meeting(_));
    if !(0.0..=proven).contains(claimed) || met {
        return Err(CertificateError::Bound { proven, claimed: *claimed });
    }
    if nested_shell(scene).is_some() {
        return Err(CertificateError::StartClaim);
    }
    Ok(proven)
}

#[cfg(test)]
mod tests {
    use colltrans_convex::body::{ConvexPolyhedron, Pose};

    use super::*;

    /// With a cover that proves nothing, neither a search that found a larger distance nor an undecided one may be
    /// answered by more than the proof shows.
    #[test]
    fn answer_with_weak_cover_claims_only_proven_distance() {
        let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).expect("a cube");
        let cube = Solid::from_convex(&cube).expect("a solid");
        let there = Pose::from_translation(DVec3::X * 3.0).expect("a pose");
        let pair = Pair::new(cube.at(Pose::IDENTITY), cube.at(there)).expect("a pair");
        for (length, is_farther) in [(1.0, true), (2.0, false)] {
            let ((answer, _), mut found) =
                pair.within_with_proof_input(length, true).expect("an answer");
            assert_eq!(matches!(answer, Within::Farther(_)), is_farther);
            (found.cover, found.proven) = (Some(Cover::new([&cube, &cube], &HashMap::new())), None);
            let (answer, proof) = prove_within(&pair, length, answer, found).expect("an answer");
            let proof = proof.expect("a proof");
            pair.verify(&proof).expect("it holds");
            match answer {
                Within::Farther(gap) => {
                    assert!(gap.gap > length && gap.gap == proof.lower, "{gap:?}");
                }
                Within::Undecided(of) => {
                    assert!(of.lower <= length && of.lower == proof.lower, "{of:?}");
                    assert_eq!(of.gap.map(|of| of.gap), (of.lower > 0.0).then_some(of.lower));
                }
                Within::Closer(_) => panic!("{answer:?}"),
            }
        }
    }
}
