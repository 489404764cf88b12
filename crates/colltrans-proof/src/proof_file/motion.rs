//! A question about a motion, and a proof with all that it is about, as files.

use std::borrow::Cow;
use std::fmt;

use serde::de::Error as _;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::file::{convex_body, said};
use super::solid_motion::{FORMAT as SOLIDS_PROOF, SolidMotionProofFile};
use colltrans_convex::body::ConvexPolyhedron;
use colltrans_convex::cast::CaseError;
use colltrans_convex::cast::replay::BodyRecord;
use colltrans_convex::setting::error::QueryError;
use colltrans_motion::{Motion, MotionCast, MotionOutcome, MotionProof, MotionProofError, Moving};

/// What files of this version call themselves.
const PROOF: &str = "colltrans motion proof 1";
const CASE: &str = "colltrans motion case 1";
const PROOFS: &str = "colltrans motions proof 1";

/// Returns the gap that is to be kept, or less a depth that is tolerated.
fn kept(cast: &MotionCast<'_>) -> f64 {
    cast.keep() - cast.tolerance()
}

/// A question about a motion that owns its bodies, read from a file.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::motion::{Motion, MotionCase, MotionCast};
/// use colltrans::{ConvexPolyhedron, Pose};
///
/// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
/// let turn = Motion::turn(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, 2.0)?;
/// let cast = MotionCast::new(cube.along(&turn), cube.at(Pose::from_translation(DVec3::X * 1.2)?))?;
///
/// let saved: String = MotionCase::of(&cast).to_json();
/// let case = MotionCase::from_json(&saved)?;
/// assert_eq!(case.cast().first_contact()?, cast.first_contact()?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct MotionCase {
    bodies: Box<[ConvexPolyhedron; 2]>,
    motions: [Motion; 2],
    keep: f64,
}

impl MotionCase {
    /// Of a question.
    pub fn of(cast: &MotionCast) -> Self {
        Self {
            bodies: Box::new(cast.bodies().map(ConvexPolyhedron::clone)),
            motions: cast.motions().map(Motion::clone),
            keep: kept(cast),
        }
    }

    /// The question.
    ///
    /// # Panics
    /// Never: the gap was checked when the question was made or read.
    pub fn cast(&self) -> MotionCast<'_> {
        self.asked().expect("a gap that was checked")
    }

    fn asked(&self) -> Result<MotionCast<'_>, QueryError> {
        let side =
            |k: usize| Moving { body: &self.bodies[k], motion: Cow::Borrowed(&self.motions[k]) };
        let cast = MotionCast::new(side(0), side(1))?;
        if self.keep < 0.0 { cast.tolerating(-self.keep) } else { cast.keeping(self.keep) }
    }

    /// As a file: bodies, their motions and what is to be kept, exact in bits. [`Self::from_json`] reads it.
    ///
    /// # Panics
    /// Never: all numbers can be written.
    pub fn to_json(&self) -> String {
        serde_json::to_string(&Asked::of(&self.cast(), CASE)).expect("numbers and names")
    }

    /// From what [`Self::to_json`] has written.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn from_json(text: &str) -> Result<Self, CaseError> {
        let text = said(text, CASE).map_err(|error| match error {
            CaseError::Proof(error) => CaseError::Syntax(error),
            error => error,
        })?;
        let asked: Asked = serde_json::from_str(text)?;
        match asked.proof {
            None => Self::read(asked),
            Some(_) => Err(serde_json::Error::unknown_field("proof", &[]).into()),
        }
    }

    fn read(asked: Asked) -> Result<Self, CaseError> {
        let Asked { moving, moving_motion, fixed, fixed_motion, keep, .. } = asked;
        let bodies = [convex_body(&moving, "moving")?, convex_body(&fixed, "fixed")?];
        let case = Self { bodies: Box::new(bodies), motions: [moving_motion, fixed_motion], keep };
        case.asked()?;
        Ok(case)
    }
}

/// A proof that owns its bodies and their motions: whoever has the file can check what it says, without a search.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::motion::{Motion, MotionCast, MotionProofFile};
/// use colltrans::{ConvexPolyhedron, Pose};
///
/// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
/// let motion = Motion::slide(Pose::IDENTITY, DVec3::X * 4.0)?;
/// let cast = MotionCast::new(cube.along(&motion), cube.at(Pose::from_translation(DVec3::X * 3.0)?))?;
/// let saved = MotionProofFile::of(&cast, &cast.first_contact()?).to_json();
/// let [lower, upper] = MotionProofFile::from_json(&saved)?.check()?;
/// assert!(lower <= 0.5 && 0.5 <= upper && upper - lower < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct MotionProofFile {
    case: MotionCase,
    proof: MotionProof,
}

impl MotionProofFile {
    /// Of an answer; `cast` is the one that was asked.
    pub fn of(cast: &MotionCast, outcome: &MotionOutcome) -> Self {
        Self { case: MotionCase::of(cast), proof: outcome.proof().clone() }
    }

    /// Checks it, as [`MotionCast::verify`] does.
    ///
    /// # Errors
    /// What is not proven.
    pub fn check(&self) -> Result<[f64; 2], MotionProofError> {
        self.case.cast().verify(&self.proof)
    }

    /// As a file: numbers that read back as the same bits. A proof about the same bodies [as
    /// solids](MotionProof::solids) is written as a [`SolidMotionProofFile`].
    ///
    /// # Panics
    /// Never: all numbers can be written.
    pub fn to_json(&self) -> String {
        self.as_solids().map_or_else(|| self.written(), |file| file.to_json())
    }

    /// Returns the proof about the same bodies [as solids](MotionProof::solids), if this is one.
    fn as_solids(&self) -> Option<SolidMotionProofFile> {
        self.proof.solids.as_ref()?;
        let cast = self.case.cast();
        SolidMotionProofFile::answer(&cast.between_solids().ok()?).ok().map(|(_, file)| file)
    }

    fn written(&self) -> String {
        let asked = Asked::of(&self.case.cast(), PROOF);
        let file = Asked { proof: Some(self.proof.clone()), ..asked };
        serde_json::to_string(&file).expect("numbers and names")
    }

    /// From what [`Self::to_json`] has written. It is read, not believed: see [`Self::check`].
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn from_json(text: &str) -> Result<Self, CaseError> {
        let text = said(text, PROOF)?;
        let mut file: Asked = serde_json::from_str(text).map_err(CaseError::Proof)?;
        let missing = || CaseError::Proof(serde_json::Error::missing_field("proof"));
        let proof = file.proof.take().ok_or_else(missing)?;
        Ok(Self { case: MotionCase::read(file)?, proof })
    }
}

impl fmt::Display for MotionProofFile {
    /// What is said, in words.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let meeting = self.proof.meeting.as_ref().map(|meeting| meeting.time);
        let reached = self.proof.spans.iter().flatten().last().map(|plane| plane.time);
        let meet = meet(self.case.keep);
        match (reached, meeting) {
            (None, Some(0.0)) => write!(f, "the bodies {meet} when the motion begins"),
            (None, Some(upper)) => write!(f, "the bodies {meet} by the time {upper}"),
            (Some(lower), Some(upper)) => {
                write!(f, "the bodies first {meet} at a time between {lower} and {upper}")
            }
            (Some(1.0), None) => write!(f, "the bodies never {meet} throughout the motion"),
            (Some(lower), None) => write!(f, "the bodies do not {meet} up to the time {lower}"),
            (None, None) => write!(f, "nothing is said"),
        }
    }
}

/// Proofs of one question about several pairs of bodies: which two first meet.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::motion::{Motion, MotionCast, MotionProofFile, MotionProofFiles};
/// use colltrans::{ConvexPolyhedron, Pose};
///
/// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
/// let motion = Motion::slide(Pose::IDENTITY, DVec3::X * 4.0)?;
/// let mut proofs = Vec::new();
/// for x in [3.0, 2.0, 6.0] {
///     let cast = MotionCast::new(cube.along(&motion), cube.at(Pose::from_translation(DVec3::X * x)?))?;
///     proofs.push(MotionProofFile::of(&cast, &cast.first_contact()?));
/// }
/// let saved = MotionProofFiles::of(proofs).to_json();
/// let [lower, upper] = MotionProofFiles::from_json(&saved)?.check()?;
/// assert!(lower <= 0.25 && 0.25 <= upper && upper - lower < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct MotionProofFiles(Vec<PairFile>);

/// The proof of one pair, about convex bodies or about the same bodies as solids.
#[derive(Debug, Clone)]
enum PairFile {
    Convex(MotionProofFile),
    Solids(SolidMotionProofFile),
}

impl PairFile {
    fn of(proof: MotionProofFile) -> Self {
        proof.as_solids().map_or(Self::Convex(proof), Self::Solids)
    }

    fn check(&self) -> Result<[f64; 2], MotionProofError> {
        match self {
            Self::Convex(file) => file.check(),
            Self::Solids(file) => file.check(),
        }
    }

    /// Returns the time up to which the bodies do not meet, and the one at which they do, infinity if that is not
    /// claimed.
    fn claims(&self) -> [f64; 2] {
        let (reached, meeting) = match self {
            Self::Convex(file) => {
                let MotionProof { spans, meeting, .. } = &file.proof;
                let last = spans.iter().flatten().last().map(|plane| plane.time);
                (last, meeting.as_ref().map(|meeting| meeting.time))
            }
            Self::Solids(file) => file.claims(),
        };
        [reached.unwrap_or(0.0), meeting.unwrap_or(f64::INFINITY)]
    }

    fn keep(&self) -> f64 {
        match self {
            Self::Convex(file) => file.case.keep,
            Self::Solids(file) => file.keep(),
        }
    }

    fn to_json(&self) -> String {
        match self {
            Self::Convex(file) => file.written(),
            Self::Solids(file) => file.to_json(),
        }
    }

    fn from_json(text: &str) -> Result<Self, CaseError> {
        let Format { format } = serde_json::from_str(text).map_err(CaseError::Proof)?;
        match &*format {
            PROOF => MotionProofFile::from_json(text).map(Self::Convex),
            SOLIDS_PROOF => SolidMotionProofFile::from_json(text).map(Self::Solids),
            other => {
                let what = format!("proofs of motions, not {other:?}");
                Err(CaseError::Proof(serde_json::Error::custom(what)))
            }
        }
    }
}

impl MotionProofFiles {
    /// Of the proofs of all pairs. Proofs about the same bodies [as solids](MotionProof::solids) are those of a
    /// [`SolidMotionProofFile`].
    pub fn of(proofs: Vec<MotionProofFile>) -> Self {
        Self(proofs.into_iter().map(PairFile::of).collect())
    }

    /// How many pairs there are.
    pub fn pairs(&self) -> usize {
        self.0.len()
    }

    /// Checks all of them. Returns up to which time no two bodies meet, and when some are proven to, infinity if that is
    /// not claimed.
    ///
    /// # Errors
    /// What is not proven of one of them.
    pub fn check(&self) -> Result<[f64; 2], MotionProofError> {
        let checked = self.0.iter().map(PairFile::check);
        Ok(self.first_of(&checked.collect::<Result<Vec<_>, _>>()?))
    }

    /// The gap that is kept: the smallest one, because what is proven apart by a larger one is apart by that, too.
    fn keep(&self) -> f64 {
        self.0.iter().map(PairFile::keep).fold(f64::INFINITY, f64::min)
    }

    /// Returns the smallest times of all pairs. A pair that comes as near as a larger gap does not come as near as this one.
    fn first_of(&self, times: &[[f64; 2]]) -> [f64; 2] {
        let keep = self.keep();
        let pairs = self.0.iter().zip(times);
        pairs.fold([1.0, f64::INFINITY], |[lower, upper], (proof, [l, u])| {
            let u = if proof.keep() == keep { *u } else { f64::INFINITY };
            [f64::min(lower, *l), f64::min(upper, u)]
        })
    }

    /// As a file: numbers that read back as the same bits.
    ///
    /// # Panics
    /// Never: all numbers can be written.
    pub fn to_json(&self) -> String {
        let raw = |proof: &PairFile| RawValue::from_string(proof.to_json()).expect("JSON");
        let file = Several { format: PROOFS.into(), proofs: self.0.iter().map(raw).collect() };
        serde_json::to_string(&file).expect("numbers and names")
    }

    /// From what [`Self::to_json`] has written. It is read, not believed: see [`Self::check`].
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn from_json(text: &str) -> Result<Self, CaseError> {
        let text = said(text, PROOFS)?;
        let file: Several = serde_json::from_str(text).map_err(CaseError::Proof)?;
        let wrong = |what: String| Err(CaseError::Proof(serde_json::Error::custom(what)));
        let read = file.proofs.iter().map(|proof| PairFile::from_json(proof.get()));
        let proofs: Vec<PairFile> = read.collect::<Result<_, _>>()?;
        if proofs.is_empty() {
            return wrong("there are no proofs; there has to be one of each pair of bodies".into());
        }
        let all = Self(proofs);
        let is_shrunk = |proof: &PairFile| match proof {
            PairFile::Convex(_) => false,
            PairFile::Solids(file) => file.is_shrunk(),
        };
        if all.0.iter().any(is_shrunk) {
            return wrong("a pair as solids is one of solids as they are, of tolerance 0".into());
        }
        let keep = all.keep();
        let is_other =
            |proof: &&PairFile| matches!(proof, PairFile::Convex(_)) && proof.keep() != keep;
        if let Some(other) = all.0.iter().find(is_other) {
            let keeps = [keep, other.keep()];
            return wrong(format!("proofs of one question keep one gap, not {keeps:?}"));
        }
        Ok(all)
    }
}

impl fmt::Display for MotionProofFiles {
    /// What is said, in words.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = self.pairs();
        let claims: Vec<[f64; 2]> = self.0.iter().map(PairFile::claims).collect();
        let [lower, upper] = self.first_of(&claims);
        let meet = meet(self.keep());
        if upper.is_finite() {
            write!(
                f,
                "of {count} pairs of bodies the first {meet} at a time between {lower} and {upper}"
            )
        } else if lower == 1.0 {
            write!(f, "of {count} pairs of bodies none {meet} throughout the motion")
        } else {
            write!(f, "of {count} pairs of bodies none {meet} up to the time {lower}")
        }
    }
}

/// Returns what bodies do that meet, in words, with the gap that is kept.
fn meet(keep: f64) -> String {
    match keep {
        keep if keep > 0.0 => format!("come as near as {keep}"),
        keep if keep < 0.0 => format!("overlap by more than {}", -keep),
        _ => "meet".into(),
    }
}

/// What a file of several proofs holds.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Several {
    format: String,
    proofs: Vec<Box<RawValue>>,
}

/// The format of a file.
#[derive(Deserialize)]
struct Format {
    format: String,
}

/// What is asked, and of a proof what is claimed.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Asked {
    format: String,
    moving: BodyRecord,
    moving_motion: Motion,
    fixed: BodyRecord,
    fixed_motion: Motion,
    #[serde(default, skip_serializing_if = "colltrans_kernel::written::is_zero")]
    keep: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    proof: Option<MotionProof>,
}

impl Asked {
    fn of(cast: &MotionCast, format: &str) -> Self {
        let [moving, fixed] = cast.bodies().map(BodyRecord::of);
        let [moving_motion, fixed_motion] = cast.motions().map(Motion::clone);
        let (format, keep) = (format.into(), kept(cast));
        Self { format, moving, moving_motion, fixed, fixed_motion, keep, proof: None }
    }
}
