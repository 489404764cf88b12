//! Proofs of the first contact of pairs of bodies along motions.

use std::borrow::Cow;
use std::collections::HashMap;

use serde::{Deserialize, Serialize};

use super::body::StoredBody;
use super::error::{ProofError, ProofFileError};
use super::file::{Mover, PairOptions, Placement, Query};
use super::proven::{Proven, Verify};
use super::{ProofFile, Statement};
use colltrans_convex::body::Body;
use colltrans_convex::setting::error::QueryError;
use colltrans_motion::{
    MotionCast, MotionOutcome, MotionProof, MotionProofError, Moving, ProofFacets, SolidMotionProof,
};
use colltrans_solid::body::Solid;
use colltrans_solid::cast::StartProof;
use colltrans_solid::kinds::ByKind;

/// Statement about two bodies along motions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MotionStatement {
    /// Statement about convex bodies.
    Convex(MotionProof),
    /// Statement about solids.
    Solids(SolidMotionStatement),
}

/// Statement about two solids along motions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SolidMotionStatement {
    /// Trees of both solids, for checkers that do not build trees. A check compares them with the trees of
    /// the bodies.
    parts: [ProofFacets; 2],
    /// The proof.
    pub proof: SolidMotionProof,
}

/// Query about two bodies of either kind.
#[derive(Debug)]
pub(super) enum PairCast<'a> {
    Convex(MotionCast<'a>),
    Solids(MotionCast<'a, Solid>, [usize; 2]),
}

/// Returns the minimum gap minus the tolerated depth.
pub(super) fn signed_min_gap(cast: &MotionCast<'_>) -> f64 {
    cast.min_gap() - cast.tolerance()
}

/// Builds the query about convex bodies with a minimum gap, or with a tolerated depth if `min_gap` is negative.
pub(super) fn convex_cast(
    [moving, fixed]: [Moving<'_>; 2],
    min_gap: f64,
) -> Result<MotionCast<'_>, QueryError> {
    let cast = MotionCast::new(moving, fixed)?;
    if min_gap < 0.0 { cast.with_tolerance(-min_gap) } else { cast.with_min_gap(min_gap) }
}

/// Proofs of queries about motions.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::motion::{Motion, MotionCast};
/// use colltrans::{ConvexPolyhedron, Pose, ProofFile};
///
/// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
/// let motion = Motion::translation(Pose::IDENTITY, DVec3::X * 4.0)?;
/// let mut proofs = Vec::new();
/// for x in [3.0, 2.0, 6.0] {
///     let cast = MotionCast::new(cube.with_motion(&motion), cube.at(Pose::from_translation(DVec3::X * x)?))?;
///     proofs.push(ProofFile::of_motion(&cast, &cast.first_contact()?));
/// }
/// let saved = ProofFile::of_motions(proofs)?.to_json();
/// let [lower, upper] = ProofFile::from_json(&saved)?.check()?.time_bounds().expect("bounds");
/// assert!(lower <= 0.25 && 0.25 <= upper && upper - lower < 1e-12);
///
/// let there = Motion::at_rest(Pose::from_translation(DVec3::new(3.0, 0.25, 0.375))?);
/// let cast = MotionCast::between_any(cube.with_motion(&motion), cube.with_motion(&there))?;
/// let (_, saved) = ProofFile::with_solid_motion(&cast)?;
/// let [lower, upper] = ProofFile::from_json(&saved.to_json())?.check()?.time_bounds().expect("bounds");
/// assert!((lower - 0.5).abs() < 1e-11 && upper - lower < 1e-11);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
impl ProofFile {
    /// Builds the proof of an answer of [`MotionCast::first_contact`] for convex bodies. `cast` must be the
    /// cast of the query. If the proof treats the bodies [as solids](MotionProof::solids), builds that of
    /// [`Self::with_solid_motion`].
    pub fn of_motion(cast: &MotionCast<'_>, outcome: &MotionOutcome) -> Self {
        let proof = outcome.proof();
        let solids = || Some(Self::with_solid_motion(&cast.as_solid_cast().ok()?).ok()?.1);
        if let Some(file) = proof.solids.as_ref().and_then(|_| solids()) {
            return file;
        }
        let bodies = cast.bodies().map(StoredBody::from_convex).into();
        let pair_options = PairOptions { min_gap: signed_min_gap(cast), tolerance: None };
        Self::of_pair_of_motions(bodies, cast, pair_options, MotionStatement::Convex(proof.clone()))
    }

    /// Computes the first contact of solids, for the bodies that are rebuilt from the file, and its
    /// proof.
    ///
    /// # Errors
    /// Returns the errors of [`MotionCast::certified_first_contact`], and an error for a solid that cannot be
    /// rebuilt from its own facets.
    pub fn with_solid_motion(
        cast: &MotionCast<'_, Solid>,
    ) -> Result<(MotionOutcome<SolidMotionProof>, Self), ProofFileError> {
        let placed = |k: usize| cast.bodies()[k].at(cast.motions()[k].pieces()[0].start_pose);
        let stored = |k: usize| StoredBody::rebuild(ByKind::Solid(placed(k)), k);
        let bodies = [stored(0)?, stored(1)?];
        let pair_options =
            PairOptions { min_gap: cast.min_gap(), tolerance: cast.given_tolerance() };
        let side = |k: usize| -> Result<Moving<'_, Solid>, ProofFileError> {
            let body = bodies[k].as_solid().ok_or(ProofFileError::Changed { body: k })?;
            Ok(Moving { body, motion: Cow::Borrowed(cast.motions()[k]) })
        };
        let again = solid_cast([side(0)?, side(1)?], pair_options)?;
        let outcome = again.certified_first_contact()?;
        let (parts, proof) = (again.proof_facets(), outcome.proof().clone());
        let statement = MotionStatement::Solids(SolidMotionStatement { parts, proof });
        let file = Self::of_pair_of_motions(bodies.clone().into(), cast, pair_options, statement);
        Ok((outcome, file))
    }

    fn of_pair_of_motions<B: Body>(
        bodies: Vec<StoredBody>,
        cast: &MotionCast<'_, B>,
        pair_options: PairOptions,
        statement: MotionStatement,
    ) -> Self {
        let [moving, fixed] = cast.motions().map(Clone::clone);
        let movers = [Mover { body: 0, motion: moving }, Mover { body: 1, motion: fixed }];
        let (placement, query) =
            (Placement::Motions(vec![movers]), Query::Motions(vec![pair_options]));
        Self::new(bodies, placement, query, Statement::Motions(vec![statement]))
    }

    /// Joins several proofs about motions to one proof of the first contact of all pairs.
    ///
    /// # Errors
    /// Returns an error if there is no proof, or if one is not about motions. Returns an error if a pair of convex
    /// bodies has a minimum gap above the smallest one, or if one of several pairs is a pair of solids with a
    /// tolerance.
    ///
    /// # Panics
    /// Never panics, because all numbers can be written.
    pub fn of_motions(proofs: Vec<Self>) -> Result<Self, ProofFileError> {
        let (mut bodies, mut known) = (Vec::new(), HashMap::new());
        let (mut movers, mut pair_options, mut statements) = (Vec::new(), Vec::new(), Vec::new());
        for proof in proofs {
            let (Placement::Motions(pairs), Query::Motions(query), Statement::Motions(of)) =
                (proof.placement, proof.query, proof.statement)
            else {
                return Err(ProofFileError::Statement);
            };
            let numbers: Vec<usize> = proof
                .bodies
                .into_iter()
                .map(|body| {
                    // Bodies with the same text are the same body.
                    let text = serde_json::to_string(&body.to_file())
                        .expect("numbers and names can be written");
                    *known.entry(text).or_insert_with(|| {
                        bodies.push(body);
                        bodies.len() - 1
                    })
                })
                .collect();
            let renumbered = |of: Mover| Mover { body: numbers[of.body], ..of };
            movers.extend(pairs.into_iter().map(|pair| pair.map(renumbered)));
            pair_options.extend(query);
            statements.extend(of);
        }
        let (placement, query) = (Placement::Motions(movers), Query::Motions(pair_options));
        let file = Self::new(bodies, placement, query, Statement::Motions(statements));
        drop(file.join_claim()?);
        Ok(file)
    }

    /// Returns the query of each pair. Returns an error if they do not form one query.
    pub(super) fn motion_query<'a>(
        &'a self,
        pair_options: &'a [PairOptions],
        movers: &'a [[Mover; 2]],
        statements: &[MotionStatement],
    ) -> Result<MotionQuery<'a>, ProofFileError> {
        if pair_options.is_empty() {
            return Err(ProofFileError::NoPairs);
        }
        if pair_options.len() != movers.len() || pair_options.len() != statements.len() {
            return Err(ProofFileError::Statement);
        }
        let (least, is_alone) = (least_gap(pair_options), pair_options.len() == 1);
        let mut casts = Vec::with_capacity(pair_options.len());
        for (pair, (statement, pair_options)) in statements.iter().zip(pair_options).enumerate() {
            // All convex pairs need the same minimum gap. Solids may have a larger one, because bodies that
            // keep a larger gap also keep this one.
            let is_of_question = match statement {
                MotionStatement::Convex(_) => pair_options.min_gap == least,
                MotionStatement::Solids(of) => is_alone || of.proof.tolerance == 0.0,
            };
            if !is_of_question {
                return Err(ProofFileError::Pairs { pair });
            }
            casts.push(self.pair_cast(*pair_options, &movers[pair], statement)?);
        }
        Ok(MotionQuery { pair_options, casts })
    }

    fn pair_cast<'a>(
        &'a self,
        pair_options: PairOptions,
        movers: &'a [Mover; 2],
        statement: &MotionStatement,
    ) -> Result<PairCast<'a>, ProofFileError> {
        let numbers = movers.each_ref().map(|of| of.body);
        let motions = movers.each_ref().map(|of| Cow::Borrowed(&of.motion));
        let [moving, fixed] = numbers.map(|k| StoredBody::at_index(&self.bodies, k));
        Ok(match (statement, &moving?.body, &fixed?.body) {
            (MotionStatement::Convex(_), ByKind::Convex(p), ByKind::Convex(q))
                if pair_options.tolerance.is_none() =>
            {
                let [moving, fixed] = motions;
                let sides =
                    [Moving { body: &**p, motion: moving }, Moving { body: &**q, motion: fixed }];
                PairCast::Convex(convex_cast(sides, pair_options.min_gap)?)
            }
            (MotionStatement::Solids(_), ByKind::Solid(p), ByKind::Solid(q)) => {
                let [moving, fixed] = motions;
                let sides =
                    [Moving { body: &**p, motion: moving }, Moving { body: &**q, motion: fixed }];
                PairCast::Solids(solid_cast(sides, pair_options)?, numbers)
            }
            _ => return Err(ProofFileError::Statement),
        })
    }
}

/// Queries about all pairs.
#[derive(Debug)]
pub(super) struct MotionQuery<'a> {
    pair_options: &'a [PairOptions],
    casts: Vec<PairCast<'a>>,
}

impl Verify<'_, MotionQuery<'_>> for Vec<MotionStatement> {
    fn verify(&self, about: &MotionQuery<'_>) -> Result<Proven<'static>, ProofError> {
        let checked = self.iter().zip(&about.casts).map(|(of, cast)| cast.verify(of));
        let times = checked.collect::<Result<Vec<_>, _>>()?;
        Ok(Proven::Time(first_times(about.pair_options, &times)))
    }
}

impl PairCast<'_> {
    fn verify(&self, statement: &MotionStatement) -> Result<[f64; 2], ProofError> {
        match (self, statement) {
            (Self::Convex(cast), MotionStatement::Convex(proof)) => Ok(cast.verify(proof)?),
            (Self::Solids(cast, bodies), MotionStatement::Solids(of)) => {
                let parts = cast.proof_facets();
                if let Some(k) = (0..2).find(|k| parts[*k] != of.parts[*k]) {
                    return Err(ProofError::Parts { body: bodies[k] });
                }
                Ok(cast.verify(&of.proof)?)
            }
            _ => Err(MotionProofError::Start.into()),
        }
    }
}

/// Returns the smallest minimum gap.
fn least_gap(pair_options: &[PairOptions]) -> f64 {
    pair_options.iter().map(|of| of.min_gap).fold(f64::INFINITY, f64::min)
}

/// Returns the smallest times of all pairs. A contact at a larger gap than the smallest one does not count as
/// an upper bound.
fn first_times(pair_options: &[PairOptions], times: &[[f64; 2]]) -> [f64; 2] {
    let least = least_gap(pair_options);
    pair_options.iter().zip(times).fold([1.0, f64::INFINITY], |[lower, upper], (of, [l, u])| {
        let u = if of.min_gap == least { *u } else { f64::INFINITY };
        [f64::min(lower, *l), f64::min(upper, u)]
    })
}

impl MotionStatement {
    /// Returns the tolerance of solids, and 0 for convex bodies.
    pub(super) fn tolerance(&self) -> f64 {
        match self {
            Self::Convex(_) => 0.0,
            Self::Solids(of) => of.proof.tolerance,
        }
    }

    /// Returns the claimed time up to which the bodies do not meet, and the claimed time of a contact, each
    /// if there is one.
    fn claimed_times(&self) -> (Option<f64>, Option<f64>) {
        match self {
            Self::Convex(MotionProof { spans, meeting, .. }) => {
                let last = spans.iter().flatten().last().map(|plane| plane.time);
                (last, meeting.as_ref().map(|meeting| meeting.time))
            }
            Self::Solids(SolidMotionStatement { proof, .. }) => {
                let SolidMotionProof { start, spans, meeting, .. } = proof;
                if let StartProof::Overlapping(_) = start {
                    return (None, Some(0.0));
                }
                (spans.last().map(|span| span.until), meeting.as_ref().map(|of| of.time))
            }
        }
    }

    /// Returns the statement about one pair as text.
    fn text(&self, min_gap: f64) -> String {
        let (reached, meeting) = self.claimed_times();
        let meet = contact_verb(min_gap);
        let bodies = match self {
            Self::Convex(_) => "the bodies ".into(),
            Self::Solids(of) => {
                format!("the solids, shrunk by {:?} each, ", 0.5 * of.proof.tolerance)
            }
        };
        let claim = match (self, reached, meeting) {
            (Self::Solids(_), None, Some(0.0)) => "overlap when the motion begins".into(),
            (Self::Convex(_), None, None) => return "no claim is made".into(),
            (Self::Convex(_), None, Some(0.0)) => format!("{meet} when the motion begins"),
            (Self::Convex(_), None, Some(upper)) => format!("{meet} by the time {upper}"),
            (_, lower, Some(upper)) => {
                let lower = lower.unwrap_or(0.0);
                format!("first {meet} at a time between {lower} and {upper}")
            }
            (_, Some(1.0), None) => format!("never {meet} throughout the motion"),
            (_, lower, None) => format!("do not {meet} up to the time {}", lower.unwrap_or(0.0)),
        };
        format!("{bodies}{claim}")
    }
}

/// Returns the statement about all pairs as text.
pub(super) fn text(pair_options: &[PairOptions], statements: &[MotionStatement]) -> String {
    if let ([pair_options], [statement]) = (pair_options, statements) {
        return statement.text(pair_options.min_gap);
    }
    let claimed = statements.iter().map(|of| {
        let (reached, meeting) = of.claimed_times();
        [reached.unwrap_or(0.0), meeting.unwrap_or(f64::INFINITY)]
    });
    let [lower, upper] = first_times(pair_options, &claimed.collect::<Vec<_>>());
    let (count, meet) = (statements.len(), contact_verb(least_gap(pair_options)));
    let claim = if upper == 0.0 {
        format!("those of one {meet} when the motion begins")
    } else if upper.is_finite() {
        format!("the first {meet} at a time between {lower} and {upper}")
    } else if lower == 1.0 {
        format!("none {meet} throughout the motion")
    } else {
        format!("none {meet} up to the time {lower}")
    };
    format!("of {count} pairs of bodies {claim}")
}

/// Returns the verb of a contact as text, with the minimum gap or the tolerated depth.
fn contact_verb(min_gap: f64) -> String {
    match min_gap {
        min_gap if min_gap > 0.0 => format!("come as near as {min_gap:?}"),
        min_gap if min_gap < 0.0 => format!("overlap by more than {:?}", -min_gap),
        _ => "meet".into(),
    }
}

/// Builds the query about solids.
fn solid_cast(
    [moving, fixed]: [Moving<'_, Solid>; 2],
    PairOptions { min_gap, tolerance }: PairOptions,
) -> Result<MotionCast<'_, Solid>, QueryError> {
    let cast = MotionCast::<Solid>::new(moving, fixed)?.with_min_gap(min_gap)?;
    match tolerance {
        Some(tolerance) => cast.with_tolerance(tolerance),
        None => Ok(cast),
    }
}
