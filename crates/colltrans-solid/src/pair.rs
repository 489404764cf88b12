//! How far two solids are apart, and the proof of it.
//!
//! *Surfaces.* The search goes through pairs of facets; its cover is the proof that none is nearer. *Bodies.* They
//! meet if facets have a point in common or a shell lies inside, which is decided exactly; the first is asked only
//! where surfaces may be 0 apart, the second only where they are not. The tolerance of a cast plays no part: bodies
//! are as they are.

use std::collections::HashMap;

use glam::DVec3;

use crate::body::{AsSolid, Solid};
use crate::cast::tolerance::least_tolerance_from;
use crate::cast::{Claim, Cover};
#[cfg(feature = "serde")]
use crate::solve::nearest::points_of;
use crate::solve::nearest::search::{Search, Until, proven};
use crate::solve::nearest::{
    Apart, Axes, SolidGap, SolidNear, Spot, distance_of, meeting, shared_points, triangle,
};
use crate::solve::overlap::{is_touch, nested};
use crate::solve::scene::Scene;
use crate::solve::steps::SolidSteps;
use colltrans_convex::answer::{CertificateError, Distance, Within, are_weights, checked_as};
use colltrans_convex::body::{Features, Placed};
use colltrans_convex::cast::Cast;
use colltrans_convex::pair::{Pair, PairBody};
use colltrans_convex::setting::error::QueryError;
use colltrans_convex::setting::{Setting, check_length};

/// A proof of the distance of two solids, checked by [`Pair::verify`] without a search: every pair of facets lies
/// under one entry of a cover, and every entry is looked at by itself.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct DistanceCertificate {
    /// No two points of the bodies are nearer, in world units: the least that an entry of the cover proves. 0 where
    /// nothing is proven.
    pub lower: f64,
    /// Why they are not farther apart.
    pub near: SolidNear,
    /// Why they are not nearer. That no shell is inside the other body is checked anew.
    pub cover: Cover<Apart>,
}

impl DistanceCertificate {
    /// That the bodies are not farther apart than some points; that they are not nearer is not said.
    pub fn of_near(near: SolidNear) -> Self {
        Self { lower: 0.0, near, cover: Cover::default() }
    }
}

/// A proof to check about two solids where they are.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum SolidPairProof<'a> {
    /// Of both bounds.
    Distance(&'a DistanceCertificate),
    /// That they are not farther from each other than a number.
    Near(&'a SolidNear),
}

checked_as!(SolidPairProof { Distance(DistanceCertificate), Near(SolidNear) });

/// The answer of [`SolidPair::overlap_depth`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct OverlapDepth {
    /// Whether the bodies have a point in common, as they are and exactly.
    pub meets: bool,
    /// As [`SolidCast::least_tolerance`](crate::SolidCast::least_tolerance) says: 0 if the bodies do not overlap, `None` if
    /// there is none.
    pub least_tolerance: Option<f64>,
    /// How much work it was.
    #[cfg_attr(feature = "serde", serde(default))]
    pub steps: SolidSteps,
}

impl Cover<Apart> {
    /// What the cover says of which facets; `None` if it does not fit the bodies.
    pub fn claims(&self, pair: &Pair<'_, Solid>) -> Option<Vec<Claim<Apart>>> {
        self.claims_of([pair.moving(), pair.fixed()])
    }
}

/// What a search says.
struct Said {
    spot: Option<Spot>,
    /// No two facets are nearer.
    lower: f64,
    /// If it was asked for.
    cover: Option<Cover<Apart>>,
    steps: SolidSteps,
}

/// What a search leaves of which a proof is made: points of the bodies, and what covers all pairs of facets, where
/// they are apart.
pub struct Unproven {
    near: SolidNear,
    cover: Option<Cover<Apart>>,
}

/// What a [`Pair`] of two [`Solid`]s answers besides what every pair does.
pub trait SolidPair<'a>: Sized {
    /// Of bodies of either kind, as solids: a solid and a convex polyhedron, say.
    ///
    /// # Errors
    /// A convex body whose facets [`Solid::from_mesh`] refuses.
    fn between<A: AsSolid, B: AsSolid>(
        moving: Placed<'a, A>,
        fixed: Placed<'a, B>,
    ) -> Result<Self, QueryError>;

    /// Computes [`Pair::distance`] and the proof of it. The proof takes a pass over all that the search left out, and a byte for each pair
    /// of nodes.
    ///
    /// # Errors
    /// As [`Pair::distance`].
    fn certified_distance(&self) -> Result<(Distance<Solid>, DistanceCertificate), QueryError>;

    /// Computes [`Pair::within`], and the proof of it if they are not closer, or hardly so: of how far apart they are at
    /// least. That
    /// they are closer is proven by what the answer holds.
    ///
    /// # Errors
    /// As [`Pair::within`].
    fn certified_within(
        &self,
        length: f64,
    ) -> Result<(Within<Solid>, Option<DistanceCertificate>), QueryError>;

    /// Do the bodies overlap, and how deep, by the measure that solids have: the least tolerance with which they
    /// would not. That is no translation; convex bodies have one, [`Pair::depth`].
    ///
    /// # Errors
    /// None at present.
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

/// A search and its proof, apart: for the crates that write files.
#[doc(hidden)]
pub trait SolidPairSearch {
    /// The distance, and what a proof is made of, where that is wanted.
    fn ask(&self, prove: bool) -> Result<(Distance<Solid>, Unproven), QueryError>;

    /// The proof by what was found: its lower bound is what the cover proves, at least that of the search.
    fn prove(&self, found: Unproven) -> Result<DistanceCertificate, QueryError>;

    /// [`Pair::within_counted`], and what a proof is made of, where that is wanted.
    fn decide(
        &self,
        length: f64,
        prove: bool,
    ) -> Result<((Within<Solid>, SolidSteps), Unproven), QueryError>;

    /// Points of the moving and of the fixed body, in the world, rounded, that are as near to each other as is
    /// said.
    #[cfg(feature = "serde")]
    fn points(&self, near: &SolidNear) -> Result<[DVec3; 2], QueryError>;

    /// Whether a shell of one body lies inside the other one, of bodies whose surfaces do not cross.
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
        let (mut distance, found) = self.ask(true)?;
        let proof = self.prove(found)?;
        distance.lower = proof.lower;
        distance.gap = (proof.lower > 0.0).then_some(SolidGap { gap: proof.lower });
        Ok((distance, proof))
    }

    fn certified_within(
        &self,
        length: f64,
    ) -> Result<(Within<Solid>, Option<DistanceCertificate>), QueryError> {
        let ((answer, _), found) = self.decide(length, true)?;
        if found.cover.is_none() {
            return Ok((answer, None));
        }
        let proof = self.prove(found)?;
        let gap = proof.lower;
        let answer = match answer {
            Within::Closer(near) => Within::Closer(near),
            Within::Undecided(distance) if gap <= length => {
                let (lower, gap) = (gap, distance.gap.map(|_| SolidGap { gap }));
                Within::Undecided(Distance { lower, gap, ..distance })
            }
            Within::Farther(_) | Within::Undecided(_) => Within::Farther(SolidGap { gap }),
        };
        Ok((answer, Some(proof)))
    }

    fn overlap_depth(&self) -> Result<OverlapDepth, QueryError> {
        let bodies = [self.bodies.moving_placed(), self.bodies.fixed_placed()];
        // Neither question knows of a direction.
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
    fn ask(&self, prove: bool) -> Result<(Distance<Solid>, Unproven), QueryError> {
        let scene = scene(self)?;
        let said = search(self, &scene, Until::LEAST, prove);
        let distance = answer(self, &scene, &said);
        let cover = said.cover.filter(|_| distance.lower > 0.0);
        Ok((distance, Unproven { near: distance.near, cover }))
    }

    #[inline]
    fn prove(&self, found: Unproven) -> Result<DistanceCertificate, QueryError> {
        let Unproven { near, cover } = found;
        let Some(cover) = cover else { return Ok(DistanceCertificate::of_near(near)) };
        Ok(match least_proven(&scene(self)?, &cover) {
            Ok(lower) if lower > 0.0 => DistanceCertificate { lower, near, cover },
            _ => DistanceCertificate::of_near(near),
        })
    }

    fn decide(
        &self,
        length: f64,
        prove: bool,
    ) -> Result<((Within<Solid>, SolidSteps), Unproven), QueryError> {
        check_length(length)?;
        let scene = scene(self)?;
        let until = Until {
            // What is a little farther is far enough, by more than a bound may be lowered.
            beyond: length + 0.125 * scene.noise,
            enough: length - triangle::LENGTH * scene.noise,
        };
        let Said { spot, lower, cover, mut steps } =
            search(self, &scene, until, prove && until.beyond.is_finite());
        let near = spot.map(|spot| spot.near(&scene));
        let meeting = || nested(&scene).map(SolidNear::Meeting);
        let closer = near.map_or_else(meeting, |near| (near.distance() <= length).then_some(near));
        if let Some(near) = closer {
            return Ok(((Within::Closer(near), steps), Unproven { near, cover: None }));
        }
        if lower > length {
            let near = near.unwrap_or_else(|| Spot::of(&scene, [0, 0]).near(&scene));
            let answer = Within::Farther(SolidGap { gap: lower });
            return Ok(((answer, steps), Unproven { near, cover }));
        }
        let (distance, found) = self.ask(prove)?;
        steps += distance.steps;
        let answer = if distance.upper <= length {
            let near = distance.near;
            return Ok(((Within::Closer(near), steps), Unproven { near, cover: None }));
        } else if distance.lower > length {
            Within::Farther(SolidGap { gap: distance.lower })
        } else {
            Within::Undecided(distance)
        };
        Ok(((answer, steps), found))
    }

    #[cfg(feature = "serde")]
    #[inline]
    fn points(&self, near: &SolidNear) -> Result<[DVec3; 2], QueryError> {
        let scene = scene(self)?;
        let origin = self.bodies.translations[0];
        let points = match *near {
            SolidNear::Meeting(place) => shared_points(&scene, place),
            SolidNear::Points { triangles, weights, .. } => {
                points_of(&scene, triangles, weights.map(DVec3::from_array))
            }
        };
        Ok(points.map(|point| point + origin))
    }

    #[inline]
    fn is_nested(&self) -> Result<bool, QueryError> {
        Ok(nested(&scene(self)?).is_some())
    }
}

impl PairBody for Solid {
    type PairProof<'p> = SolidPairProof<'p>;

    fn distance(pair: &Pair<'_, Self>) -> Result<Distance<Self>, QueryError> {
        Ok(pair.ask(false)?.0)
    }

    fn within(
        pair: &Pair<'_, Self>,
        length: f64,
    ) -> Result<(Within<Self>, SolidSteps), QueryError> {
        Ok(pair.decide(length, false)?.0)
    }

    fn verify_pair(
        pair: &Pair<'_, Self>,
        proof: SolidPairProof<'_>,
    ) -> Result<f64, CertificateError> {
        // A direction that is no part of the proof.
        let scene = scene(pair).map_err(|_| CertificateError::Start)?;
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

fn scene<'a>(pair: &Pair<'a, Solid>) -> Result<Scene<'a>, QueryError> {
    let setting = Setting::of(pair.bodies, DVec3::Z)?;
    Ok(Scene::new(&setting, [0.0; 2], 0.0))
}

fn search(pair: &Pair<'_, Solid>, scene: &Scene, until: Until, prove: bool) -> Said {
    let mut cuts = HashMap::new();
    let mut search = Search::new(scene, until, |nodes, reason| {
        if prove {
            cuts.insert(nodes, reason);
        }
    });
    let ((found, lower), steps) = (search.run(), search.steps);
    // An early end leaves pairs that nothing was said of, and no bound.
    let cover = (prove && lower > 0.0).then(|| Cover::new([pair.moving(), pair.fixed()], &cuts));
    Said { spot: found.map(Spot::from), lower, cover, steps }
}

fn answer(pair: &Pair<'_, Solid>, scene: &Scene, said: &Said) -> Distance<Solid> {
    let origin = pair.bodies.translations[0];
    let mut steps = said.steps;
    let place = meeting(scene, said.lower, &mut steps);
    let spot = said.spot.unwrap_or_else(|| Spot::of(scene, [0, 0]));
    let (near, points) = match place {
        Some(place) => (SolidNear::Meeting(place), shared_points(scene, place)),
        None => (spot.near(scene), spot.points(scene)),
    };
    let lower = if place.is_some() { 0.0 } else { said.lower };
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

/// The least that the entries of a cover prove.
fn least_proven(scene: &Scene, cover: &Cover<Apart>) -> Result<f64, CertificateError> {
    let bodies = [scene.moving.solid, scene.fixed.solid];
    let axes = Axes::new(scene);
    let mut least = f64::INFINITY;
    let walked = cover.walk(bodies, |_, nodes, reason| {
        let leaf = |k: usize| bodies[k].nodes()[nodes[k] as usize].is_leaf();
        if reason == Apart::Examined && !(leaf(0) && leaf(1)) {
            return false;
        }
        least = least.min(proven(scene, &axes, nodes, reason));
        least > 0.0
    });
    walked.map_err(|entry| CertificateError::Cover { entry })?;
    Ok(least)
}

/// The distance that is proven not to be exceeded.
fn verify_near(scene: &Scene, near: &SolidNear) -> Result<f64, CertificateError> {
    match *near {
        SolidNear::Meeting(place) if is_touch(scene, place) => Ok(0.0),
        SolidNear::Meeting(_) => Err(CertificateError::Start),
        SolidNear::Points { triangles, weights, distance: claimed } => {
            if let Some(&weights) = weights.iter().find(|weights| !are_weights(&weights[..])) {
                return Err(CertificateError::Weights { weights });
            }
            let [moving, fixed] = triangles;
            let proven = distance_of(scene, triangles, weights)
                .ok_or(CertificateError::Facets { moving, fixed })?;
            if claimed >= proven {
                Ok(proven)
            } else {
                Err(CertificateError::Bound { proven, claimed })
            }
        }
    }
}

/// The distance that no two points are below.
fn verify_cover(scene: &Scene, certificate: &DistanceCertificate) -> Result<f64, CertificateError> {
    let DistanceCertificate { lower: claimed, near, cover } = certificate;
    if *claimed == 0.0 && cover.is_empty() {
        return Ok(0.0);
    }
    let proven = least_proven(scene, cover)?;
    let met = matches!(near, SolidNear::Meeting(_));
    if !(0.0..=proven).contains(claimed) || met {
        return Err(CertificateError::Bound { proven, claimed: *claimed });
    }
    if nested(scene).is_some() {
        return Err(CertificateError::Start);
    }
    Ok(proven)
}
