//! A proof about solids that turn with all that it is about, as one file.

use std::borrow::Cow;
use std::fmt;

use serde::de::Error as _;
use serde::{Deserialize, Serialize};

use super::file::{BodyFile, said};
use super::scene::{Written, kept};
use colltrans_convex::cast::CaseError;
use colltrans_motion::{
    FacetsMeeting, Motion, MotionCast, MotionOutcome, MotionProofError, Moving, Parts,
    SolidMotionProof,
};
use colltrans_solid::body::Solid;
use colltrans_solid::cast::StartProof;
use colltrans_solid::kinds::ByKind;

/// What a file of this version calls itself.
pub(super) const FORMAT: &str = "colltrans motion of solids proof 1";

/// A proof that owns its solids and their motions: whoever has the file can check what it says, without a search.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::motion::{Motion, MotionCast, SolidMotionProofFile};
/// use colltrans::{ConvexPolyhedron, Pose};
///
/// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
/// let motion = Motion::slide(Pose::IDENTITY, DVec3::X * 4.0)?;
/// let there = Motion::still(Pose::from_translation(DVec3::new(3.0, 0.25, 0.375))?);
/// let cast = MotionCast::between(cube.along(&motion), cube.along(&there))?;
/// let (_, saved) = SolidMotionProofFile::answer(&cast)?;
/// let [lower, upper] = SolidMotionProofFile::from_json(&saved.to_json())?.check()?;
/// assert!((lower - 0.5).abs() < 1e-11 && upper - lower < 1e-11);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct SolidMotionProofFile {
    bodies: Box<[Written; 2]>,
    motions: [Motion; 2],
    keep: f64,
    tolerance: Option<f64>,
    proof: SolidMotionProof,
}

impl SolidMotionProofFile {
    /// Asks, of the bodies as they are read back from the file, and keeps the proof.
    ///
    /// # Errors
    /// As [`MotionCast::certified_first_contact`], and a solid that its own facets do not make once more.
    pub fn answer(
        cast: &MotionCast<'_, Solid>,
    ) -> Result<(MotionOutcome<SolidMotionProof>, Self), CaseError> {
        let motions = cast.motions().map(Clone::clone);
        let written = |k: usize, which| {
            let placed = cast.bodies()[k].at(motions[k].pieces()[0].start);
            Written::again(&kept(placed.into()), which)
        };
        let bodies = Box::new([written(0, "moving")?, written(1, "fixed")?]);
        let (keep, tolerance) = (cast.keep(), cast.given_tolerance());
        let again = asked(&bodies, &motions, keep, tolerance)?;
        let outcome = again.certified_first_contact()?;
        let proof = outcome.proof().clone();
        Ok((outcome, Self { bodies, motions, keep, tolerance, proof }))
    }

    /// Checks it, as [`MotionCast::verify`] does.
    ///
    /// # Errors
    /// What is not proven.
    pub fn check(&self) -> Result<[f64; 2], MotionProofError> {
        let Self { bodies, motions, keep, tolerance, proof } = self;
        let cast =
            asked(bodies, motions, *keep, *tolerance).map_err(|_| MotionProofError::Start)?;
        cast.verify(proof)
    }

    /// Returns the gap that is kept.
    pub(super) fn keep(&self) -> f64 {
        self.keep
    }

    /// Returns whether it is about solids that a tolerance has shrunk.
    pub(super) fn is_shrunk(&self) -> bool {
        self.proof.tolerance != 0.0
    }

    /// Returns the time up to which the solids do not meet, and the one at which they do, if these are claimed.
    pub(super) fn claims(&self) -> (Option<f64>, Option<f64>) {
        let SolidMotionProof { spans, meeting, .. } = &self.proof;
        (spans.last().map(|span| span.until), meeting.as_ref().map(|meeting| meeting.time))
    }

    /// As a file: numbers that read back as the same bits.
    ///
    /// # Panics
    /// Never: all numbers can be written.
    pub fn to_json(&self) -> String {
        let [moving, fixed] = self.bodies.each_ref().map(Written::file);
        let [moving_motion, fixed_motion] = self.motions.clone();
        let (format, keep, tolerance) = (FORMAT.into(), self.keep, self.tolerance);
        let proof = self.proof.clone();
        let cast = asked(&self.bodies, &self.motions, keep, tolerance);
        let parts = cast.ok().map(|cast| cast.parts());
        let file = File {
            format,
            moving,
            moving_motion,
            fixed,
            fixed_motion,
            keep,
            tolerance,
            parts,
            proof,
        };
        serde_json::to_string(&file).expect("numbers and names")
    }

    /// From what [`Self::to_json`] has written. It is read, not believed: see [`Self::check`].
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn from_json(text: &str) -> Result<Self, CaseError> {
        let text = said(text, FORMAT)?;
        let file: File = serde_json::from_str(text).map_err(CaseError::Proof)?;
        let File {
            moving, moving_motion, fixed, fixed_motion, keep, tolerance, parts, proof, ..
        } = file;
        let bodies = Box::new([Written::of(moving)?, Written::of(fixed)?]);
        let motions = [moving_motion, fixed_motion];
        let cast = asked(&bodies, &motions, keep, tolerance)?;
        // They are there for whoever has no such trees; they have to be those of these bodies.
        let missing = || CaseError::Proof(serde_json::Error::missing_field("parts"));
        let told = cast.parts().into_iter().zip(parts.ok_or_else(missing)?);
        for (which, (parts, told)) in ["moving", "fixed"].into_iter().zip(told) {
            if parts != told {
                return Err(CaseError::Changed { which });
            }
        }
        Ok(Self { bodies, motions, keep, tolerance, proof })
    }
}

/// What was asked.
fn asked<'a>(
    bodies: &'a [Written; 2],
    motions: &'a [Motion; 2],
    keep: f64,
    tolerance: Option<f64>,
) -> Result<MotionCast<'a, Solid>, CaseError> {
    let side = |k: usize, which| match &bodies[k].body {
        ByKind::Solid(solid) => Ok(Moving { body: &**solid, motion: Cow::Borrowed(&motions[k]) }),
        ByKind::Convex(_) => Err(CaseError::Changed { which }),
    };
    let cast = MotionCast::<Solid>::new(side(0, "moving")?, side(1, "fixed")?)?.keeping(keep)?;
    Ok(match tolerance {
        Some(tolerance) => cast.tolerating(tolerance)?,
        None => cast,
    })
}

impl fmt::Display for SolidMotionProofFile {
    /// What is said, in words.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let SolidMotionProof { tolerance, start, spans, meeting } = &self.proof;
        let meet = match self.keep {
            keep if keep > 0.0 => format!("come as near as {keep}"),
            _ => "meet".into(),
        };
        let reached = spans.last().map_or(0.0, |span| span.until);
        write!(f, "the solids, shrunk by {} each, ", 0.5 * tolerance)?;
        match (start, meeting) {
            (StartProof::Overlapping(_), _) => write!(f, "overlap when the motion begins"),
            (_, Some(FacetsMeeting { time, .. })) => {
                write!(f, "first {meet} at a time between {reached} and {time}")
            }
            _ if reached == 1.0 => write!(f, "never {meet} throughout the motion"),
            _ => write!(f, "do not {meet} up to the time {reached}"),
        }
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    format: String,
    moving: BodyFile,
    moving_motion: Motion,
    fixed: BodyFile,
    fixed_motion: Motion,
    #[serde(default, skip_serializing_if = "colltrans_kernel::written::is_zero")]
    keep: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    tolerance: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    parts: Option<[Parts; 2]>,
    proof: SolidMotionProof,
}
