//! Queries about motions as files.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use super::motion::{convex_cast, signed_min_gap};
use colltrans_convex::body::ConvexPolyhedron;
use colltrans_convex::cast::CaseError;
use colltrans_convex::cast::case_file::BodyRecord;
use colltrans_convex::setting::error::QueryError;
use colltrans_motion::{Motion, MotionCast, Moving};

/// Name of the format in this version.
const FORMAT: &str = "colltrans motion case 1";

/// Query about a motion that owns its bodies. It can be written to a file and read from it.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::motion::{Motion, MotionCase, MotionCast};
/// use colltrans::{ConvexPolyhedron, Pose};
///
/// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
/// let turn = Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, 2.0)?;
/// let cast = MotionCast::new(cube.with_motion(&turn), cube.at(Pose::from_translation(DVec3::X * 1.2)?))?;
///
/// let saved: String = MotionCase::from_cast(&cast).to_json();
/// let case = MotionCase::from_json(&saved)?;
/// assert_eq!(case.cast().first_contact()?, cast.first_contact()?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct MotionCase {
    bodies: Box<[ConvexPolyhedron; 2]>,
    motions: [Motion; 2],
    min_gap: f64,
}

impl MotionCase {
    /// Copies the query of a cast.
    pub fn from_cast(cast: &MotionCast) -> Self {
        Self {
            bodies: Box::new(cast.bodies().map(ConvexPolyhedron::clone)),
            motions: cast.motions().map(Motion::clone),
            min_gap: signed_min_gap(cast),
        }
    }

    /// Returns the cast of the query.
    ///
    /// # Panics
    /// Never panics, because the minimum gap was checked when the query was built or read.
    pub fn cast(&self) -> MotionCast<'_> {
        self.checked_cast().expect("the gap was checked before")
    }

    fn checked_cast(&self) -> Result<MotionCast<'_>, QueryError> {
        let side =
            |k: usize| Moving { body: &self.bodies[k], motion: Cow::Borrowed(&self.motions[k]) };
        convex_cast([side(0), side(1)], self.min_gap)
    }

    /// Writes the bodies, their motions and the minimum gap as JSON, exact in bits. [`Self::from_json`] reads
    /// the text.
    ///
    /// # Panics
    /// Never panics, because all numbers can be written.
    pub fn to_json(&self) -> String {
        let [moving, fixed] = self.bodies.each_ref().map(BodyRecord::from_body);
        let [moving_motion, fixed_motion] = self.motions.clone();
        let (format, min_gap) = (FORMAT.into(), self.min_gap);
        let file = File { format, moving, moving_motion, fixed, fixed_motion, min_gap };
        serde_json::to_string(&file).expect("numbers and names can be written")
    }

    /// Reads the text that [`Self::to_json`] writes.
    ///
    /// # Errors
    /// Returns the first problem of the text.
    pub fn from_json(text: &str) -> Result<Self, CaseError> {
        // Some editors write a byte-order mark at the start of a file.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let Named { format } = serde_json::from_str(text)?;
        if format != FORMAT {
            return Err(CaseError::Format { found: format, known: FORMAT });
        }
        let File { moving, moving_motion, fixed, fixed_motion, min_gap, .. } =
            serde_json::from_str(text)?;
        let body = |of: BodyRecord, which| {
            of.to_body().map_err(|error| CaseError::Body { which, error: error.into() })
        };
        let bodies = Box::new([body(moving, "moving")?, body(fixed, "fixed")?]);
        let case = Self { bodies, motions: [moving_motion, fixed_motion], min_gap };
        case.checked_cast()?;
        Ok(case)
    }
}

/// Header of a file.
#[derive(Deserialize)]
struct Named {
    format: String,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    format: String,
    moving: BodyRecord,
    moving_motion: Motion,
    fixed: BodyRecord,
    fixed_motion: Motion,
    #[serde(default, skip_serializing_if = "colltrans_kernel::serialization::is_zero")]
    min_gap: f64,
}
