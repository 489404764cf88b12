//! The file format of proofs: its structure, writing and reading.

use glam::DVec3;
use serde::de::{DeserializeOwned, Error as _};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::body::{BodyFile, StoredBody};
use super::error::{FORMAT, ProofFileError, VERSION};
use super::{ProofFile, Statement};
use colltrans_convex::body::Pose;
use colltrans_kernel::noise;
use colltrans_motion::Motion;
use colltrans_motion::path::{Frame, JointPath, Mechanism};
use colltrans_solid::cast::StartOverlap;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    format: String,
    version: u64,
    bodies: Vec<BodyFile>,
    placement: Placement,
    query: Query,
    statement: Statement,
}

/// Placement of the bodies.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Placement {
    /// Poses of the moving body and then of the fixed one, or of the obstacles in the order of their indices.
    Poses(Vec<Place>),
    /// Motions of the moving and of the fixed body of each pair.
    Motions(Vec<[Mover; 2]>),
    /// Bodies that are attached to frames of a mechanism.
    Robot(Robot),
}

impl Placement {
    /// Places two bodies, of which the first one in the file is the moving one.
    pub(super) fn of_two([moving, fixed]: [Pose; 2]) -> Self {
        Self::Poses(vec![Place { body: 0, pose: moving }, Place { body: 1, pose: fixed }])
    }
}

#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Place {
    pub(super) body: usize,
    pub(super) pose: Pose,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Mover {
    pub(super) body: usize,
    pub(super) motion: Motion,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Robot {
    #[serde(serialize_with = "write_frames", deserialize_with = "read_frames")]
    pub(super) frames: Mechanism,
    pub(super) bodies: Vec<Link>,
}

/// Body of a mechanism, and the frame that carries it.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Link {
    pub(super) body: usize,
    pub(super) name: String,
    #[serde(deserialize_with = "colltrans_kernel::serialization::required_option")]
    pub(super) frame: Option<usize>,
    pub(super) pose: Pose,
}

/// Query of a file.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Query {
    /// Contacts or clearance along a direction.
    Cast(Along),
    /// Distance, depth or free directions of two bodies in their given poses.
    Pair,
    /// Query about one body in a scene.
    Scene(Choices),
    /// First contact of each pair of moving bodies.
    Motions(Vec<PairOptions>),
    /// First contact of bodies of a mechanism.
    Path(Joints),
}

/// Direction, and minimum gap.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Along {
    pub(super) direction: DVec3,
    #[serde(default, skip_serializing_if = "colltrans_kernel::serialization::is_zero")]
    pub(super) min_gap: f64,
}

/// Options of a scene query on which its proof depends.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Choices {
    #[serde(default, skip_serializing_if = "colltrans_kernel::serialization::is_zero")]
    pub(super) min_gap: f64,
    #[serde(default, skip_serializing_if = "colltrans_kernel::serialization::is_zero")]
    pub(super) graze_tolerance: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) tolerance: Option<f64>,
    pub(super) start_overlap: StartOverlap,
}

/// Minimum gap of two bodies, minus the tolerated depth of convex ones; tolerance of solids.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PairOptions {
    pub(super) min_gap: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) tolerance: Option<f64>,
}

/// Path of joints, and minimum gap.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Joints {
    pub(super) path: JointPath,
    #[serde(default, skip_serializing_if = "colltrans_kernel::serialization::is_zero")]
    pub(super) min_gap: f64,
}

impl ProofFile {
    /// Writes the proof as JSON. Numbers are read back with the same bits.
    ///
    /// # Panics
    /// Never panics, because all numbers can be written.
    pub fn to_json(&self) -> String {
        let file = File {
            format: FORMAT.into(),
            version: VERSION,
            bodies: self.bodies.iter().map(StoredBody::to_file).collect(),
            placement: self.placement.clone(),
            query: self.query.clone(),
            statement: self.statement.clone(),
        };
        serde_json::to_string(&file).expect("numbers and names can be written")
    }

    /// Reads the text that [`Self::to_json`] writes. The claims are not verified; see [`Self::check`].
    ///
    /// # Errors
    /// Returns the first problem of the text.
    pub fn from_json(text: &str) -> Result<Self, ProofFileError> {
        // Some editors write a byte-order mark at the start of a file.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let Head { format, version } = read_nested(text).map_err(ProofFileError::Syntax)?;
        if format != FORMAT {
            return Err(ProofFileError::Format { found: format });
        }
        if version != Some(VERSION) {
            return Err(ProofFileError::Version { found: version });
        }
        let file: File = read_nested(text).map_err(|error| {
            // The text is JSON at least up to the end of its header.
            let is_choice = error.is_syntax() && error.to_string().starts_with("expected value");
            if is_choice { ProofFileError::Choice(error) } else { ProofFileError::Syntax(error) }
        })?;
        let File { bodies, placement, query, statement, .. } = file;
        let bodies = bodies.into_iter().enumerate().map(|(k, body)| StoredBody::from_file(body, k));
        let bodies = bodies.collect::<Result<_, _>>()?;
        let proof = Self::new(bodies, placement, query, statement);
        drop(proof.join_claim()?);
        Ok(proof)
    }
}

/// Header that identifies the format.
#[derive(Deserialize)]
struct Head {
    format: String,
    #[serde(default)]
    version: Option<u64>,
}

/// Maximum nesting depth of lists and objects in a file. The cover of two bodies with a million facets needs
/// 250.
const MAX_NESTING: usize = 400;

/// Reads a file whose covers are nested like trees, which exceeds the default limit of `serde_json`.
fn read_nested<T: DeserializeOwned>(text: &str) -> Result<T, serde_json::Error> {
    if nesting_depth(text) > MAX_NESTING {
        let reason = format!("lists and objects are nested more than {MAX_NESTING} deep");
        return Err(serde_json::Error::custom(reason));
    }
    let mut reader = serde_json::Deserializer::from_str(text);
    reader.disable_recursion_limit();
    let read = T::deserialize(&mut reader)?;
    reader.end()?;
    Ok(read)
}

/// Returns a lower bound of the nesting depth of lists and objects in a JSON text.
fn nesting_depth(text: &str) -> usize {
    let (mut depth, mut deepest) = (0_usize, 0);
    let (mut in_text, mut escaped) = (false, false);
    for byte in text.bytes() {
        match byte {
            _ if escaped => escaped = false,
            b'\\' if in_text => escaped = true,
            b'"' => in_text = !in_text,
            b'[' | b'{' if !in_text => {
                depth += 1;
                deepest = deepest.max(depth);
            }
            b']' | b'}' if !in_text => depth = depth.saturating_sub(1),
            _ => {}
        }
    }
    deepest
}

fn write_frames<S: Serializer>(of: &Mechanism, to: S) -> Result<S::Ok, S::Error> {
    of.frames().serialize(to)
}

/// Reads frames. Returns an error for an axis that is not a unit vector, because normalising it would change
/// the frames by rounding.
fn read_frames<'de, D: Deserializer<'de>>(from: D) -> Result<Mechanism, D::Error> {
    let frames = Vec::<Frame>::deserialize(from)?;
    for (frame, of) in frames.iter().enumerate() {
        let is_unit = |axis: &DVec3| (axis.length() - 1.0).abs() <= noise::UNIT_VECTOR;
        if let Some(axis) = of.joint.axis().filter(|axis| !is_unit(axis)) {
            let axis = axis.to_array();
            let reason = format!("the axis {axis:?} of frame {frame} is not a unit vector");
            return Err(D::Error::custom(reason));
        }
    }
    Mechanism::new(frames).map_err(D::Error::custom)
}
