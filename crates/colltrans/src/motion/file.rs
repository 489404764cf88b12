//! A proof about a motion with all that it is about, as one file.

use std::borrow::Cow;
use std::fmt;

use serde::{Deserialize, Serialize};

use super::{Motion, MotionCast, MotionOutcome, MotionProof, MotionProofError, Moving};
use crate::body::ConvexPolyhedron;
use crate::cast::CaseError;
use crate::cast::replay::BodyRecord;
use crate::proof_file::{convex_body, said};
use crate::setting::error::QueryError;

/// What a file of this version calls itself.
const FORMAT: &str = "colltrans motion proof 1";

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
    bodies: Box<[ConvexPolyhedron; 2]>,
    motions: [Motion; 2],
    keep: f64,
    proof: MotionProof,
}

impl MotionProofFile {
    /// Of an answer; `cast` is the one that was asked.
    pub fn of(cast: &MotionCast, outcome: &MotionOutcome) -> Self {
        Self {
            bodies: Box::new([cast.moving.body.clone(), cast.fixed.body.clone()]),
            motions: [&cast.moving, &cast.fixed].map(|side| side.motion.clone().into_owned()),
            keep: cast.keep,
            proof: outcome.proof().clone(),
        }
    }

    /// Checks it, as [`MotionCast::verify`] does.
    ///
    /// # Errors
    /// What is not proven.
    pub fn check(&self) -> Result<[f64; 2], MotionProofError> {
        self.cast().verify(&self.proof)
    }

    fn cast(&self) -> MotionCast<'_> {
        let side =
            |k: usize| Moving { body: &self.bodies[k], motion: Cow::Borrowed(&self.motions[k]) };
        MotionCast { moving: side(0), fixed: side(1), keep: self.keep, tolerance: None }
    }

    /// As a file: numbers that read back as the same bits.
    ///
    /// # Panics
    /// Never: all numbers can be written.
    pub fn to_json(&self) -> String {
        let [moving, fixed] = self.bodies.each_ref().map(BodyRecord::of);
        let [moving_motion, fixed_motion] = self.motions.clone();
        let (format, keep, proof) = (FORMAT.into(), self.keep, self.proof.clone());
        let file = File { format, moving, moving_motion, fixed, fixed_motion, keep, proof };
        serde_json::to_string(&file).expect("numbers and names")
    }

    /// From what [`Self::to_json`] has written. It is read, not believed: see [`Self::check`].
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn from_json(text: &str) -> Result<Self, CaseError> {
        let text = said(text, FORMAT)?;
        let file: File = serde_json::from_str(text).map_err(CaseError::Proof)?;
        if !file.keep.is_finite() {
            return Err(QueryError::Keep { gap: file.keep }.into());
        }
        let bodies = [convex_body(&file.moving, "moving")?, convex_body(&file.fixed, "fixed")?];
        let motions = [file.moving_motion, file.fixed_motion];
        Ok(Self { bodies: Box::new(bodies), motions, keep: file.keep, proof: file.proof })
    }
}

impl fmt::Display for MotionProofFile {
    /// What is said, in words.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let meeting = self.proof.meeting.as_ref().map(|meeting| meeting.time);
        let reached = self.proof.spans.iter().flatten().last().map(|plane| plane.time);
        let meet = match self.keep {
            keep if keep > 0.0 => format!("come as near as {keep}"),
            keep if keep < 0.0 => format!("overlap by more than {}", -keep),
            _ => "meet".into(),
        };
        match (reached, meeting) {
            (None, Some(_)) => write!(f, "the bodies {meet} when the motion begins"),
            (Some(lower), Some(upper)) => {
                write!(f, "the bodies first {meet} at a time between {lower} and {upper}")
            }
            (Some(1.0), None) => write!(f, "the bodies never {meet} throughout the motion"),
            (Some(lower), None) => write!(f, "the bodies do not {meet} up to the time {lower}"),
            (None, None) => write!(f, "nothing is said"),
        }
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    format: String,
    moving: BodyRecord,
    moving_motion: Motion,
    fixed: BodyRecord,
    fixed_motion: Motion,
    #[serde(default, skip_serializing_if = "crate::written::is_zero")]
    keep: f64,
    proof: MotionProof,
}
