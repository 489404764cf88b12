//! Proofs about pairs of bodies that turn: when two of them first meet.

use std::borrow::Cow;
use std::collections::HashMap;

use serde::{Deserialize, Serialize};

use super::body::StoredBody;
use super::error::{ProofError, ProofFileError};
use super::file::{Mover, Placement, Query, Timed};
use super::proven::{Proven, Verify};
use super::{ProofFile, Statement};
use colltrans_convex::body::Body;
use colltrans_convex::setting::error::QueryError;
use colltrans_motion::{
    MotionCast, MotionOutcome, MotionProof, MotionProofError, Moving, Parts, SolidMotionProof,
};
use colltrans_solid::body::Solid;
use colltrans_solid::cast::StartProof;
use colltrans_solid::kinds::ByKind;

/// What is said of two bodies that turn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MotionStatement {
    /// Of convex bodies.
    Convex(MotionProof),
    /// Of solids.
    Solids(SolidMotionStatement),
}

/// What is said of two solids that turn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SolidMotionStatement {
    /// They are there for whoever has no such trees; they have to be those of these bodies.
    parts: [Parts; 2],
    /// The proof.
    pub proof: SolidMotionProof,
}

/// What was asked of two bodies of either kind.
#[derive(Debug)]
pub(super) enum PairCast<'a> {
    Convex(MotionCast<'a>),
    Solids(MotionCast<'a, Solid>, [usize; 2]),
}

/// Returns the gap that is to be kept, or less a depth that is tolerated.
pub(super) fn kept(cast: &MotionCast<'_>) -> f64 {
    cast.keep() - cast.tolerance()
}

/// Returns what is asked of convex bodies, with the gap that is to be kept, or less a depth that is tolerated.
pub(super) fn convex_cast(
    [moving, fixed]: [Moving<'_>; 2],
    keep: f64,
) -> Result<MotionCast<'_>, QueryError> {
    let cast = MotionCast::new(moving, fixed)?;
    if keep < 0.0 { cast.tolerating(-keep) } else { cast.keeping(keep) }
}

/// Of questions about bodies that turn.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::motion::{Motion, MotionCast};
/// use colltrans::{ConvexPolyhedron, Pose, ProofFile};
///
/// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
/// let motion = Motion::slide(Pose::IDENTITY, DVec3::X * 4.0)?;
/// let mut proofs = Vec::new();
/// for x in [3.0, 2.0, 6.0] {
///     let cast = MotionCast::new(cube.along(&motion), cube.at(Pose::from_translation(DVec3::X * x)?))?;
///     proofs.push(ProofFile::of_motion(&cast, &cast.first_contact()?));
/// }
/// let saved = ProofFile::of_motions(proofs)?.to_json();
/// let [lower, upper] = ProofFile::from_json(&saved)?.check()?.time().expect("bounds");
/// assert!(lower <= 0.25 && 0.25 <= upper && upper - lower < 1e-12);
///
/// let there = Motion::still(Pose::from_translation(DVec3::new(3.0, 0.25, 0.375))?);
/// let cast = MotionCast::between(cube.along(&motion), cube.along(&there))?;
/// let (_, saved) = ProofFile::with_solid_motion(&cast)?;
/// let [lower, upper] = ProofFile::from_json(&saved.to_json())?.check()?.time().expect("bounds");
/// assert!((lower - 0.5).abs() < 1e-11 && upper - lower < 1e-11);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
impl ProofFile {
    /// Of an answer of [`MotionCast::first_contact`] about convex bodies; `cast` is the one that was asked. A proof about
    /// the same bodies [as solids](MotionProof::solids) is the one of [`Self::with_solid_motion`].
    pub fn of_motion(cast: &MotionCast<'_>, outcome: &MotionOutcome) -> Self {
        let proof = outcome.proof();
        let solids = || Some(Self::with_solid_motion(&cast.between_solids().ok()?).ok()?.1);
        if let Some(file) = proof.solids.as_ref().and_then(|_| solids()) {
            return file;
        }
        let bodies = cast.bodies().map(StoredBody::convex).into();
        let asked = Timed { keep: kept(cast), tolerance: None };
        Self::of_pair_of_motions(bodies, cast, asked, MotionStatement::Convex(proof.clone()))
    }

    /// The first contact of solids, asked of the bodies as they are read back from the file, and its proof.
    ///
    /// # Errors
    /// As [`MotionCast::certified_first_contact`], and a solid that its own facets do not make once more.
    pub fn with_solid_motion(
        cast: &MotionCast<'_, Solid>,
    ) -> Result<(MotionOutcome<SolidMotionProof>, Self), ProofFileError> {
        let placed = |k: usize| cast.bodies()[k].at(cast.motions()[k].pieces()[0].start);
        let stored = |k: usize| StoredBody::again(ByKind::Solid(placed(k)), k);
        let bodies = [stored(0)?, stored(1)?];
        let asked = Timed { keep: cast.keep(), tolerance: cast.given_tolerance() };
        let side = |k: usize| -> Result<Moving<'_, Solid>, ProofFileError> {
            let body = bodies[k].as_solid().ok_or(ProofFileError::Changed { body: k })?;
            Ok(Moving { body, motion: Cow::Borrowed(cast.motions()[k]) })
        };
        let again = solid_cast([side(0)?, side(1)?], asked)?;
        let outcome = again.certified_first_contact()?;
        let (parts, proof) = (again.parts(), outcome.proof().clone());
        let statement = MotionStatement::Solids(SolidMotionStatement { parts, proof });
        let file = Self::of_pair_of_motions(bodies.clone().into(), cast, asked, statement);
        Ok((outcome, file))
    }

    fn of_pair_of_motions<B: Body>(
        bodies: Vec<StoredBody>,
        cast: &MotionCast<'_, B>,
        asked: Timed,
        statement: MotionStatement,
    ) -> Self {
        let [moving, fixed] = cast.motions().map(Clone::clone);
        let movers = [Mover { body: 0, motion: moving }, Mover { body: 1, motion: fixed }];
        Self {
            bodies,
            placement: Placement::Motions(vec![movers]),
            query: Query::Motions(vec![asked]),
            statement: Statement::Motions(vec![statement]),
        }
    }

    /// One proof about all pairs of several proofs about motions: which two first meet.
    ///
    /// # Errors
    /// No proofs, one that is not about motions, and pairs that keep several gaps or are shrunk.
    ///
    /// # Panics
    /// Never: all numbers can be written.
    pub fn of_motions(proofs: Vec<Self>) -> Result<Self, ProofFileError> {
        let (mut bodies, mut known) = (Vec::new(), HashMap::new());
        let (mut movers, mut asked, mut statements) = (Vec::new(), Vec::new(), Vec::new());
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
                    // Bodies that are written as the same are the same.
                    let text = serde_json::to_string(&body.file()).expect("numbers and names");
                    *known.entry(text).or_insert_with(|| {
                        bodies.push(body);
                        bodies.len() - 1
                    })
                })
                .collect();
            let renumbered = |of: Mover| Mover { body: numbers[of.body], ..of };
            movers.extend(pairs.into_iter().map(|pair| pair.map(renumbered)));
            asked.extend(query);
            statements.extend(of);
        }
        let (placement, query) = (Placement::Motions(movers), Query::Motions(asked));
        let file = Self { bodies, placement, query, statement: Statement::Motions(statements) };
        drop(file.claim()?);
        Ok(file)
    }

    /// Returns what is asked of each pair, if all of it is one question.
    pub(super) fn motions<'a>(
        &'a self,
        asked: &'a [Timed],
        movers: &'a [[Mover; 2]],
        statements: &[MotionStatement],
    ) -> Result<Motions<'a>, ProofFileError> {
        if asked.is_empty() {
            return Err(ProofFileError::NoPairs);
        }
        if asked.len() != movers.len() || asked.len() != statements.len() {
            return Err(ProofFileError::Statement);
        }
        let (least, is_alone) = (least_gap(asked), asked.len() == 1);
        let mut casts = Vec::with_capacity(asked.len());
        for (pair, (statement, asked)) in statements.iter().zip(asked).enumerate() {
            // What is proven apart by a larger gap is apart by this one, too, as solids are that stand for convex bodies.
            let is_of_question = match statement {
                MotionStatement::Convex(_) => asked.keep == least,
                MotionStatement::Solids(of) => is_alone || of.proof.tolerance == 0.0,
            };
            if !is_of_question {
                return Err(ProofFileError::Pairs { pair });
            }
            casts.push(self.pair_cast(*asked, &movers[pair], statement)?);
        }
        Ok(Motions { asked, casts })
    }

    fn pair_cast<'a>(
        &'a self,
        asked: Timed,
        movers: &'a [Mover; 2],
        statement: &MotionStatement,
    ) -> Result<PairCast<'a>, ProofFileError> {
        let numbers = movers.each_ref().map(|of| of.body);
        let motions = movers.each_ref().map(|of| Cow::Borrowed(&of.motion));
        let [moving, fixed] = numbers.map(|k| StoredBody::of(&self.bodies, k));
        Ok(match (statement, &moving?.body, &fixed?.body) {
            (MotionStatement::Convex(_), ByKind::Convex(p), ByKind::Convex(q))
                if asked.tolerance.is_none() =>
            {
                let [moving, fixed] = motions;
                let sides =
                    [Moving { body: &**p, motion: moving }, Moving { body: &**q, motion: fixed }];
                PairCast::Convex(convex_cast(sides, asked.keep)?)
            }
            (MotionStatement::Solids(_), ByKind::Solid(p), ByKind::Solid(q)) => {
                let [moving, fixed] = motions;
                let sides =
                    [Moving { body: &**p, motion: moving }, Moving { body: &**q, motion: fixed }];
                PairCast::Solids(solid_cast(sides, asked)?, numbers)
            }
            _ => return Err(ProofFileError::Statement),
        })
    }
}

/// What is asked of each pair.
#[derive(Debug)]
pub(super) struct Motions<'a> {
    asked: &'a [Timed],
    casts: Vec<PairCast<'a>>,
}

impl Verify<'_, Motions<'_>> for Vec<MotionStatement> {
    fn verify(&self, about: &Motions<'_>) -> Result<Proven<'static>, ProofError> {
        let checked = self.iter().zip(&about.casts).map(|(of, cast)| cast.verify(of));
        let times = checked.collect::<Result<Vec<_>, _>>()?;
        Ok(Proven::Time(first_of(about.asked, &times)))
    }
}

impl PairCast<'_> {
    fn verify(&self, statement: &MotionStatement) -> Result<[f64; 2], ProofError> {
        match (self, statement) {
            (Self::Convex(cast), MotionStatement::Convex(proof)) => Ok(cast.verify(proof)?),
            (Self::Solids(cast, bodies), MotionStatement::Solids(of)) => {
                let parts = cast.parts();
                if let Some(k) = (0..2).find(|k| parts[*k] != of.parts[*k]) {
                    return Err(ProofError::Parts { body: bodies[k] });
                }
                Ok(cast.verify(&of.proof)?)
            }
            _ => Err(MotionProofError::Start.into()),
        }
    }
}

/// Returns the smallest gap that is kept.
fn least_gap(asked: &[Timed]) -> f64 {
    asked.iter().map(|of| of.keep).fold(f64::INFINITY, f64::min)
}

/// Returns the smallest times of all pairs. A pair that comes as near as a larger gap does not come as near as the
/// smallest one.
fn first_of(asked: &[Timed], times: &[[f64; 2]]) -> [f64; 2] {
    let least = least_gap(asked);
    asked.iter().zip(times).fold([1.0, f64::INFINITY], |[lower, upper], (of, [l, u])| {
        let u = if of.keep == least { *u } else { f64::INFINITY };
        [f64::min(lower, *l), f64::min(upper, u)]
    })
}

impl MotionStatement {
    /// Returns the tolerance of solids, 0 of convex bodies.
    pub(super) fn tolerance(&self) -> f64 {
        match self {
            Self::Convex(_) => 0.0,
            Self::Solids(of) => of.proof.tolerance,
        }
    }

    /// Returns the time up to which the bodies do not meet, and the one at which they do, if these are claimed.
    fn claims(&self) -> (Option<f64>, Option<f64>) {
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

    /// Returns in words what is said of one pair.
    fn words(&self, keep: f64) -> String {
        let (reached, meeting) = self.claims();
        let meet = meet(keep);
        let bodies = match self {
            Self::Convex(_) => "the bodies ".into(),
            Self::Solids(of) => {
                format!("the solids, shrunk by {:?} each, ", 0.5 * of.proof.tolerance)
            }
        };
        let told = match (self, reached, meeting) {
            (Self::Solids(_), None, Some(0.0)) => "overlap when the motion begins".into(),
            (Self::Convex(_), None, None) => return "nothing is said".into(),
            (Self::Convex(_), None, Some(0.0)) => format!("{meet} when the motion begins"),
            (Self::Convex(_), None, Some(upper)) => format!("{meet} by the time {upper}"),
            (_, lower, Some(upper)) => {
                let lower = lower.unwrap_or(0.0);
                format!("first {meet} at a time between {lower} and {upper}")
            }
            (_, Some(1.0), None) => format!("never {meet} throughout the motion"),
            (_, lower, None) => format!("do not {meet} up to the time {}", lower.unwrap_or(0.0)),
        };
        format!("{bodies}{told}")
    }
}

/// Returns in words what is said of all pairs.
pub(super) fn words(asked: &[Timed], statements: &[MotionStatement]) -> String {
    if let ([asked], [statement]) = (asked, statements) {
        return statement.words(asked.keep);
    }
    let claimed = statements.iter().map(|of| {
        let (reached, meeting) = of.claims();
        [reached.unwrap_or(0.0), meeting.unwrap_or(f64::INFINITY)]
    });
    let [lower, upper] = first_of(asked, &claimed.collect::<Vec<_>>());
    let (count, meet) = (statements.len(), meet(least_gap(asked)));
    let told = if upper == 0.0 {
        format!("those of one {meet} when the motion begins")
    } else if upper.is_finite() {
        format!("the first {meet} at a time between {lower} and {upper}")
    } else if lower == 1.0 {
        format!("none {meet} throughout the motion")
    } else {
        format!("none {meet} up to the time {lower}")
    };
    format!("of {count} pairs of bodies {told}")
}

/// Returns what bodies do that meet, in words, with the gap that is kept.
fn meet(keep: f64) -> String {
    match keep {
        keep if keep > 0.0 => format!("come as near as {keep:?}"),
        keep if keep < 0.0 => format!("overlap by more than {:?}", -keep),
        _ => "meet".into(),
    }
}

/// Returns what is asked of solids.
fn solid_cast(
    [moving, fixed]: [Moving<'_, Solid>; 2],
    Timed { keep, tolerance }: Timed,
) -> Result<MotionCast<'_, Solid>, QueryError> {
    let cast = MotionCast::<Solid>::new(moving, fixed)?.keeping(keep)?;
    match tolerance {
        Some(tolerance) => cast.tolerating(tolerance),
        None => Ok(cast),
    }
}
