//! A query as a JSON file that preserves every bit.
//!
//! - Numbers are decimals that parse to the same bits.
//! - A body is stored with its own faces, not as the input it was built from. Its vertices and half-edges are
//!   restored in the same order, so a restored query takes the same steps to the same bits.
//! - Input is checked like a mesh.

use glam::DVec3;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::Cast;
use crate::body::error::BuildError;
use crate::body::{ConvexPolyhedron, InputVertex, Pose};
use crate::setting::error::QueryError;
use crate::solve::options::{Options, OptionsRecord};
use colltrans_kernel::error::PoseError;
use colltrans_kernel::pose::PoseRecord;

/// Reason why a file is not a valid query.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CaseError {
    /// The file is not JSON, or lacks a field.
    #[error("not a saved query: {}", json_error_message(.0))]
    Syntax(#[from] serde_json::Error),
    /// The file was written by another version.
    #[error("the format is {found:?}, not {known:?}")]
    Format {
        /// The format that the file names.
        found: String,
        /// The format of this version.
        known: &'static str,
    },
    /// A body is invalid.
    #[error("{which} body: {error}")]
    Body {
        /// `"moving"` or `"fixed"`; `"the"` for a body on its own.
        which: &'static str,
        /// The cause: a [`BuildError`] of a convex body, a `SolidError` of a solid.
        error: Box<dyn std::error::Error + Send + Sync>,
    },
    /// A pose is invalid.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// The direction or an option is invalid.
    #[error(transparent)]
    Query(#[from] QueryError),
}

/// Returns the message of a parser error in terms of the file, with line and column. An input error keeps the
/// parser's message.
pub fn json_error_message(error: &serde_json::Error) -> String {
    use serde_json::error::Category;
    let what = match error.classify() {
        Category::Io => return error.to_string(),
        // The parser has no category for this error, only a message.
        Category::Syntax if error.to_string().starts_with("number out of range") => {
            "a number is larger than any double".into()
        }
        Category::Syntax => "it is not JSON".into(),
        Category::Eof => "it ends too early".into(),
        Category::Data => {
            let what = error.to_string();
            let place = format!(" at line {} column {}", error.line(), error.column());
            what.strip_suffix(&place).unwrap_or(&what).to_owned()
        }
    };
    format!("line {}, column {}: {what}", error.line(), error.column())
}

/// Name of the format of this version.
const FORMAT: &str = "colltrans case 1";

/// A query that owns its bodies, read from a file.
///
/// ```
/// use colltrans::glam::{DQuat, DVec3};
/// use colltrans::{Case, Cast, ConvexPolyhedron, Pose};
///
/// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
/// let start = Pose::new(DQuat::from_rotation_x(0.3), DVec3::new(-3.1, 0.3, 0.1))?;
/// let cast = Cast::new(cube.at(start), cube.at(Pose::IDENTITY), DVec3::X)?;
///
/// let saved: String = cast.to_json();
/// let case = Case::from_json(&saved)?;
/// assert_eq!(case.cast()?.first_contact()?, cast.first_contact()?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Case {
    bodies: [ConvexPolyhedron; 2],
    poses: [Pose; 2],
    direction: DVec3,
    options: Options,
}

impl Case {
    /// Reads a query that [`Cast::to_json`] has written.
    ///
    /// # Errors
    /// Returns an error if the text is not JSON, has another format or an unknown field, or if a body, a
    /// pose, the direction or an option is invalid.
    pub fn from_json(text: &str) -> Result<Self, CaseError> {
        // Some editors begin a file with a byte-order mark.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let file: CaseFile = serde_json::from_str(text)?;
        if file.format != FORMAT {
            return Err(CaseError::Format { found: file.format, known: FORMAT });
        }
        let body = |record: &BodyRecord, which| {
            record.to_body().map_err(|error| CaseError::Body { which, error: error.into() })
        };
        let case = Self {
            bodies: [body(&file.moving, "moving")?, body(&file.fixed, "fixed")?],
            poses: [file.moving_pose.try_into()?, file.fixed_pose.try_into()?],
            direction: DVec3::from_array(file.direction),
            options: file.options.try_into()?,
        };
        case.cast()?;
        Ok(case)
    }

    /// Returns the query.
    ///
    /// # Errors
    /// Never fails in practice, because the query was checked when it was read.
    pub fn cast(&self) -> Result<Cast<'_>, QueryError> {
        let [moving, fixed] = &self.bodies;
        Cast::new(moving.at(self.poses[0]), fixed.at(self.poses[1]), self.direction)?
            .with_options(self.options)
    }
}

impl Cast<'_> {
    /// Returns the query as a file: bodies, poses, direction and options, with all bits. [`Case::from_json`]
    /// reads it. The state of a tracker is not included.
    ///
    /// # Panics
    /// Never, because all numbers can be written.
    pub fn to_json(&self) -> String {
        let file = CaseFile {
            format: FORMAT.into(),
            moving: BodyRecord::from_body(self.moving()),
            moving_pose: self.moving_pose().into(),
            fixed: BodyRecord::from_body(self.fixed()),
            fixed_pose: self.fixed_pose().into(),
            direction: self.direction().to_array(),
            options: self.options().into(),
        };
        serde_json::to_string(&file).expect("numbers and names are valid JSON")
    }
}

impl ConvexPolyhedron {
    /// Returns the body as a file: its vertices and faces in their order, with all bits.
    ///
    /// ```
    /// use colltrans::ConvexPolyhedron;
    /// use colltrans::glam::DVec3;
    ///
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// let again = ConvexPolyhedron::from_json(&cube.to_json())?;
    /// assert_eq!(again.vertices(), cube.vertices());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Panics
    /// Never, because all numbers can be written.
    pub fn to_json(&self) -> String {
        serde_json::to_string(&BodyRecord::from_body(self)).expect("numbers are valid JSON")
    }

    /// Reads a body that [`Self::to_json`] has written. Queries about it give the same bits as those about
    /// the original.
    ///
    /// # Errors
    /// Returns an error if the text is not JSON or has an unknown field, or if the body is invalid.
    pub fn from_json(text: &str) -> Result<Self, CaseError> {
        let record: BodyRecord = serde_json::from_str(text)?;
        record.to_body().map_err(|error| CaseError::Body { which: "the", error: error.into() })
    }
}

/// Layout of a file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CaseFile {
    format: String,
    moving: BodyRecord,
    moving_pose: PoseRecord,
    fixed: BodyRecord,
    fixed_pose: PoseRecord,
    direction: [f64; 3],
    options: OptionsRecord,
}

/// A body in a file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyRecord {
    vertices: Vec<[f64; 3]>,
    /// Empty for a segment or a point; front and back for a flat polygon.
    faces: Vec<Vec<u32>>,
    input_indices: Vec<InputVertex>,
    hull_error: f64,
    /// Omitted if it is 0, and in files of versions whose bounds did not include it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    input_excess: Option<f64>,
    /// Radius of a rounded body; omitted if it is 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    radius: Option<f64>,
}

impl BodyRecord {
    /// Converts a body to its record.
    #[inline]
    pub fn from_body(body: &ConvexPolyhedron) -> Self {
        Self {
            vertices: body.vertices().iter().map(DVec3::to_array).collect(),
            faces: (0..body.face_count() as u32).map(|f| body.face_vertices(f).collect()).collect(),
            input_indices: body.input_indices().to_vec(),
            hull_error: body.hull_error(),
            input_excess: Some(body.input_excess()).filter(|excess| *excess > 0.0),
            radius: Some(body.radius()).filter(|radius| *radius != 0.0),
        }
    }

    /// Builds the body, with the checks of a mesh.
    ///
    /// # Errors
    /// Returns an error if the faces do not describe a valid body.
    #[inline]
    pub fn to_body(&self) -> Result<ConvexPolyhedron, BuildError> {
        let vertices: Vec<DVec3> = self.vertices.iter().copied().map(DVec3::from_array).collect();
        let core = ConvexPolyhedron::from_own_faces(
            &vertices,
            &self.faces,
            &self.input_indices,
            [self.hull_error, self.input_excess.unwrap_or(0.0)],
        )?;
        core.rounded(self.radius.unwrap_or(0.0))
    }
}
