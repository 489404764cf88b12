//! The one file format of proofs: what it holds, written and read.

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

/// Where bodies are.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Placement {
    /// Of the moving body, then of the fixed one, or of the obstacles in the order of their numbers.
    Poses(Vec<Place>),
    /// Of the moving and of the fixed body of each pair.
    Motions(Vec<[Mover; 2]>),
    /// Of bodies that the frames of a mechanism carry.
    Robot(Robot),
}

impl Placement {
    /// Places two bodies: the first of the file is the moving one.
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

/// A body, and which frame carries it.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Link {
    pub(super) body: usize,
    pub(super) name: String,
    #[serde(deserialize_with = "colltrans_kernel::written::given")]
    pub(super) frame: Option<usize>,
    pub(super) pose: Pose,
}

/// What is asked of bodies.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Query {
    /// How far the moving body gets along a direction.
    Cast(Along),
    /// How two bodies are to each other where they are.
    Pair,
    /// How one body is to many obstacles.
    Scene(Choices),
    /// When the bodies of each pair first meet.
    Motions(Vec<Timed>),
    /// When bodies of a mechanism first meet.
    Path(Joints),
}

/// The direction, and the gap that is kept.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Along {
    pub(super) direction: DVec3,
    #[serde(default, skip_serializing_if = "colltrans_kernel::written::is_zero")]
    pub(super) keep: f64,
}

/// The choices that count in a proof about a scene.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Choices {
    #[serde(default, skip_serializing_if = "colltrans_kernel::written::is_zero")]
    pub(super) keep: f64,
    #[serde(default, skip_serializing_if = "colltrans_kernel::written::is_zero")]
    pub(super) graze_tolerance: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) tolerance: Option<f64>,
    pub(super) start_overlap: StartOverlap,
}

/// The gap that two bodies keep, less the depth that is tolerated of convex ones; the tolerance of solids.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Timed {
    pub(super) keep: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) tolerance: Option<f64>,
}

/// A path of joints, and the gap that is kept on it.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Joints {
    pub(super) path: JointPath,
    #[serde(default, skip_serializing_if = "colltrans_kernel::written::is_zero")]
    pub(super) keep: f64,
}

impl ProofFile {
    /// As a file: numbers that read back as the same bits.
    ///
    /// # Panics
    /// Never: all numbers can be written.
    pub fn to_json(&self) -> String {
        let file = File {
            format: FORMAT.into(),
            version: VERSION,
            bodies: self.bodies.iter().map(StoredBody::file).collect(),
            placement: self.placement.clone(),
            query: self.query.clone(),
            statement: self.statement.clone(),
        };
        serde_json::to_string(&file).expect("numbers and names")
    }

    /// From what [`Self::to_json`] has written. It is read, not believed: see [`Self::check`].
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn from_json(text: &str) -> Result<Self, ProofFileError> {
        // Some editors begin a file with a byte-order mark.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let Head { format, version } = nested(text).map_err(ProofFileError::Syntax)?;
        if format != FORMAT {
            return Err(ProofFileError::Format { found: format });
        }
        if version != Some(VERSION) {
            return Err(ProofFileError::Version { found: version });
        }
        let file: File = nested(text).map_err(|error| {
            // It is JSON, as far as its head was read.
            let is_choice = error.is_syntax() && error.to_string().starts_with("expected value");
            if is_choice { ProofFileError::Choice(error) } else { ProofFileError::Syntax(error) }
        })?;
        let File { bodies, placement, query, statement, .. } = file;
        let bodies = bodies.into_iter().enumerate().map(|(k, body)| StoredBody::read(body, k));
        let bodies = bodies.collect::<Result<_, _>>()?;
        let proof = Self { bodies, placement, query, statement };
        drop(proof.claim()?);
        Ok(proof)
    }
}

/// What tells files apart.
#[derive(Deserialize)]
struct Head {
    format: String,
    #[serde(default)]
    version: Option<u64>,
}

/// Lists and objects within each other in a file of proof, at most: the cover of two bodies of a million facets takes
/// 250 of them.
const MOST_NESTED: usize = 400;

/// Reads a file whose covers are nested as trees of parts are: deeper than `serde_json` reads by itself.
fn nested<T: DeserializeOwned>(text: &str) -> Result<T, serde_json::Error> {
    if depth_of(text) > MOST_NESTED {
        let reason = format!("lists and objects are nested more than {MOST_NESTED} deep");
        return Err(serde_json::Error::custom(reason));
    }
    let mut reader = serde_json::Deserializer::from_str(text);
    reader.disable_recursion_limit();
    let read = T::deserialize(&mut reader)?;
    reader.end()?;
    Ok(read)
}

/// Returns how deep lists and objects of JSON are nested, at least.
fn depth_of(text: &str) -> usize {
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

/// Reads frames whose axes are unit vectors: frames would be elsewhere by what rounding makes of others.
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
