//! A question about a motion, and a proof with all that it is about, as files.

use std::borrow::Cow;
use std::fmt;

use serde::de::Error as _;
use serde::{Deserialize, Serialize};

use super::{
    Motion, MotionCast, MotionOutcome, MotionProof, MotionProofError, Moving, SolidMotionProofFile,
    check_tolerated,
};
use crate::body::ConvexPolyhedron;
use crate::cast::CaseError;
use crate::cast::replay::BodyRecord;
use crate::proof_file::{convex_body, said};
use crate::setting::check_keep;
use crate::solid::StartOverlap;

/// What files of this version call themselves.
const PROOF: &str = "colltrans motion proof 1";
const CASE: &str = "colltrans motion case 1";
const PROOFS: &str = "colltrans motions proof 1";

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
/// let saved: String = cast.to_json();
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
    fn of(cast: &MotionCast) -> Self {
        Self {
            bodies: Box::new(cast.bodies().map(ConvexPolyhedron::clone)),
            motions: cast.motions().map(Motion::clone),
            keep: cast.keep,
        }
    }

    /// The question.
    pub fn cast(&self) -> MotionCast<'_> {
        let side =
            |k: usize| Moving { body: &self.bodies[k], motion: Cow::Borrowed(&self.motions[k]) };
        let start_overlap = StartOverlap::Refuse;
        MotionCast {
            moving: side(0),
            fixed: side(1),
            keep: self.keep,
            tolerance: None,
            start_overlap,
        }
    }

    /// From what [`MotionCast::to_json`] has written.
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

    /// What the bodies do, in words.
    fn meet(&self) -> String {
        match self.keep {
            keep if keep > 0.0 => format!("come as near as {keep}"),
            keep if keep < 0.0 => format!("overlap by more than {}", -keep),
            _ => "meet".into(),
        }
    }

    fn read(asked: Asked) -> Result<Self, CaseError> {
        let Asked { moving, moving_motion, fixed, fixed_motion, keep, .. } = asked;
        if keep < 0.0 {
            check_tolerated(-keep)?;
        } else {
            check_keep(keep)?;
        }
        let bodies = [convex_body(&moving, "moving")?, convex_body(&fixed, "fixed")?];
        Ok(Self { bodies: Box::new(bodies), motions: [moving_motion, fixed_motion], keep })
    }
}

impl MotionCast<'_> {
    /// The question as a file: bodies, their motions and what is to be kept, exact in bits.
    /// [`MotionCase::from_json`] reads it.
    ///
    /// # Panics
    /// Never: all numbers can be written.
    pub fn to_json(&self) -> String {
        serde_json::to_string(&Asked::of(self, CASE)).expect("numbers and names")
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
        let cast = self.case.cast();
        let solids = self.proof.solids.as_ref().and_then(|_| cast.between_solids().ok());
        if let Some((_, file)) = solids.and_then(|cast| SolidMotionProofFile::answer(&cast).ok()) {
            return file.to_json();
        }
        serde_json::to_string(&self.written()).expect("numbers and names")
    }

    fn written(&self) -> Asked {
        Asked { proof: Some(self.proof.clone()), ..Asked::of(&self.case.cast(), PROOF) }
    }

    /// From what [`Self::to_json`] has written. It is read, not believed: see [`Self::check`].
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn from_json(text: &str) -> Result<Self, CaseError> {
        let text = said(text, PROOF)?;
        Self::read(serde_json::from_str(text).map_err(CaseError::Proof)?)
    }

    fn read(mut file: Asked) -> Result<Self, CaseError> {
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
        let meet = self.case.meet();
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
pub struct MotionProofFiles(Vec<MotionProofFile>);

impl MotionProofFiles {
    /// Of the proofs of all pairs.
    pub fn of(proofs: Vec<MotionProofFile>) -> Self {
        Self(proofs)
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
        self.0.iter().try_fold([1.0, f64::INFINITY], |[lower, upper], proof| {
            let [l, u] = proof.check()?;
            Ok([f64::min(lower, l), f64::min(upper, u)])
        })
    }

    /// As a file: numbers that read back as the same bits.
    ///
    /// # Panics
    /// Never: all numbers can be written.
    pub fn to_json(&self) -> String {
        let proofs = self.0.iter().map(MotionProofFile::written).collect();
        let file = Several { format: PROOFS.into(), proofs };
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
        let [first, ..] = &file.proofs[..] else {
            return wrong("there are no proofs; there has to be one of each pair of bodies".into());
        };
        if let Some(other) = file.proofs.iter().find(|proof| proof.format != PROOF) {
            return wrong(format!("proofs of motions, not {:?}", other.format));
        }
        if let Some(other) = file.proofs.iter().find(|proof| proof.keep != first.keep) {
            let keeps = [first.keep, other.keep];
            return wrong(format!("proofs of one question keep one gap, not {keeps:?}"));
        }
        file.proofs.into_iter().map(MotionProofFile::read).collect::<Result<_, _>>().map(Self)
    }
}

impl fmt::Display for MotionProofFiles {
    /// What is said, in words.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = self.pairs();
        let proofs = || self.0.iter().map(|proof| &proof.proof);
        let meeting = proofs().filter_map(|proof| Some(proof.meeting.as_ref()?.time));
        let upper = meeting.fold(f64::INFINITY, f64::min);
        let reached =
            |proof: &MotionProof| proof.spans.iter().flatten().last().map_or(0.0, |p| p.time);
        let lower = proofs().map(reached).fold(1.0, f64::min);
        let meet = self.0.first().map_or_else(|| "meet".into(), |proof| proof.case.meet());
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

/// What a file of several proofs holds.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Several {
    format: String,
    proofs: Vec<Asked>,
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
    #[serde(default, skip_serializing_if = "crate::written::is_zero")]
    keep: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    proof: Option<MotionProof>,
}

impl Asked {
    fn of(cast: &MotionCast, format: &str) -> Self {
        let [moving, fixed] = cast.bodies().map(BodyRecord::of);
        let [moving_motion, fixed_motion] = cast.motions().map(Motion::clone);
        let (format, keep) = (format.into(), cast.keep);
        Self { format, moving, moving_motion, fixed, fixed_motion, keep, proof: None }
    }
}
