//! A proof about a path with all that it is about, as one file.

use std::fmt;

use glam::DVec3;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::{
    Frame, JointPath, Mechanism, PathBody, PathCast, PathError, PathOutcome, PathProof,
    PathProofError,
};
use crate::among::{AnyBody, ByKind};
use crate::body::{InputFacet, Pose};
use crate::cast::CaseError;
use crate::number::noise;
use crate::proof_file::{BodyFile, Written, kept, said};

/// What a file of this version calls itself.
const FORMAT: &str = "colltrans path proof 1";

/// A proof that owns its mechanism, bodies and path: whoever has the file can check what it says, without a search.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::motion::path::{Frame, Joint, JointPath, Mechanism, PathBody, PathCast, PathProofFile};
/// use colltrans::{ConvexPolyhedron, Pose};
///
/// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
/// let frame = Frame { parent: None, origin: Pose::IDENTITY, joint: Joint::Sliding(DVec3::X) };
/// let slide = Mechanism::new(vec![frame])?;
/// let path = JointPath::evenly(vec![vec![0.0], vec![4.0]])?;
/// let there = Pose::from_translation(DVec3::X * 3.0)?;
/// let bodies = vec![PathBody::carried(0, cube.at(Pose::IDENTITY)), PathBody::standing(cube.at(there))];
/// let cast = PathCast::new(&slide, &path, bodies, vec![[0, 1]])?;
/// let names = ["cart".into(), "stop".into()];
/// let (_, saved) = PathProofFile::answer(&cast, &names)?;
/// let [lower, upper] = PathProofFile::from_json(&saved.to_json())?.check()?;
/// assert!(lower <= 0.5 && 0.5 <= upper && upper - lower < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct PathProofFile {
    mechanism: Mechanism,
    path: JointPath,
    bodies: Vec<Carried>,
    pairs: Vec<[usize; 2]>,
    keep: f64,
    proof: PathProof,
    said: Said,
}

/// Up to which time no two bodies meet, and when two do.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Said {
    lower: f64,
    #[serde(with = "crate::written::or_infinite")]
    upper: f64,
}

/// A body and who carries it.
#[derive(Debug, Clone)]
struct Carried {
    name: String,
    frame: Option<usize>,
    pose: Pose,
    written: Written,
}

/// Why a file has no proof.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PathFileError {
    /// It is no such file, or a body in it is none.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// What is asked has no answer.
    #[error(transparent)]
    Path(#[from] PathError),
    /// An axis has another length than 1: frames would be elsewhere by what rounding makes of it.
    #[error("the axis {:?} of frame {frame} is not a unit vector", .axis.to_array())]
    Axis {
        /// Which frame.
        frame: usize,
        /// Its axis.
        axis: DVec3,
    },
}

impl PathProofFile {
    /// Asks, of the bodies as they are read back from the file, and keeps the proof. Names are those of the bodies, for
    /// people; those that there is none for have none.
    ///
    /// # Errors
    /// As [`PathCast::first_contact`], and a solid that its own facets do not make once more.
    pub fn answer(cast: &PathCast, names: &[String]) -> Result<(PathOutcome, Self), PathFileError> {
        let carried =
            cast.shapes.iter().zip(&cast.frames).enumerate().map(|(k, (shape, frame))| {
                let written = Written::again(&kept(shape.placed), "one")?;
                let name = names.get(k).cloned().unwrap_or_default();
                Ok(Carried { name, frame: *frame, pose: shape.pose(), written })
            });
        let mut file = Self {
            mechanism: cast.mechanism.clone(),
            path: cast.path.clone(),
            bodies: carried.collect::<Result<_, CaseError>>()?,
            pairs: cast.pairs.clone(),
            keep: cast.keep,
            proof: PathProof::default(),
            said: Said::default(),
        };
        let outcome = file.cast()?.first_contact()?;
        let [from, to] = file.path.ends();
        let [lower, upper] = match &outcome {
            PathOutcome::Contact(of) | PathOutcome::Grazing(of) => [of.lower, of.upper],
            PathOutcome::Overlapping(_) => [from; 2],
            PathOutcome::Free(_) => [to, f64::INFINITY],
        };
        file.said = Said { lower, upper };
        file.proof = outcome.proof().clone();
        Ok((outcome, file))
    }

    /// Checks it, as [`PathCast::verify`] does.
    ///
    /// # Errors
    /// What is not proven.
    pub fn check(&self) -> Result<[f64; 2], PathCheckError> {
        let proven = self.cast()?.verify(&self.proof)?;
        let Said { lower, upper } = self.said;
        if lower <= proven[0] && proven[1] <= upper {
            return Ok(proven);
        }
        Err(PathCheckError::Said { said: [lower, upper], proven })
    }

    /// The names of its bodies.
    pub fn names(&self) -> Vec<String> {
        self.bodies.iter().map(|of| of.name.clone()).collect()
    }

    /// Its proof, checked or not.
    pub const fn proof(&self) -> &PathProof {
        &self.proof
    }

    /// What it is about.
    ///
    /// # Errors
    /// Bodies that are none of a path.
    pub fn cast(&self) -> Result<PathCast<'_>, PathError> {
        let body = |of| {
            let Carried { frame, pose, written, .. }: &Carried = of;
            PathBody { frame: *frame, placed: written.body.at(*pose) }
        };
        let bodies = self.bodies.iter().map(body).collect();
        PathCast::new(&self.mechanism, &self.path, bodies, self.pairs.clone())?.keeping(self.keep)
    }

    /// As a file: numbers that read back as the same bits.
    ///
    /// # Panics
    /// Never: all numbers can be written.
    pub fn to_json(&self) -> String {
        let body = |of: &Carried| BodyRecord {
            name: of.name.clone(),
            frame: of.frame,
            pose: of.pose,
            parts: Parts::of(&of.written.body),
            body: of.written.file(),
        };
        let file = File {
            format: FORMAT.into(),
            frames: self.mechanism.frames().to_vec(),
            path: self.path.clone(),
            bodies: self.bodies.iter().map(body).collect(),
            pairs: self.pairs.clone(),
            keep: self.keep,
            proof: self.proof.clone(),
            said: self.said,
        };
        serde_json::to_string(&file).expect("numbers and names")
    }

    /// From what [`Self::to_json`] has written. It is read, not believed: see [`Self::check`].
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn from_json(text: &str) -> Result<Self, PathFileError> {
        let text = said(text, FORMAT)?;
        let file: File = serde_json::from_str(text).map_err(CaseError::Proof)?;
        let body = |of: BodyRecord| {
            let written = Written::of(of.body)?;
            // They are there for whoever has no such trees; they have to be those of these bodies.
            if of.parts.is_some() && of.parts != Parts::of(&written.body) {
                return Err(CaseError::Changed { which: "one" });
            }
            Ok(Carried { name: of.name, frame: of.frame, pose: of.pose, written })
        };
        for (frame, of) in file.frames.iter().enumerate() {
            let is_unit = |axis: &DVec3| (axis.length() - 1.0).abs() <= noise::UNIT_VECTOR;
            if let Some(axis) = of.joint.axis().filter(|axis| !is_unit(axis)) {
                return Err(PathFileError::Axis { frame, axis });
            }
        }
        Ok(Self {
            mechanism: Mechanism::new(file.frames)?,
            path: file.path,
            bodies: file.bodies.into_iter().map(body).collect::<Result<_, CaseError>>()?,
            pairs: file.pairs,
            keep: file.keep,
            proof: file.proof,
            said: file.said,
        })
    }

    fn name(&self, body: usize) -> String {
        match self.bodies.get(body).map(|of| of.name.as_str()) {
            Some("") | None => format!("body {body}"),
            Some(name) => name.into(),
        }
    }
}

/// Why a file does not prove what it says.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum PathCheckError {
    /// Its bodies are none of a path.
    #[error(transparent)]
    Path(#[from] PathError),
    /// Its proof is none.
    #[error(transparent)]
    Proof(#[from] PathProofError),
    /// It says more than is proven.
    #[error("it says that the first contact is between {} and {}, and proves {} and {}", .said[0], .said[1], .proven[0], .proven[1])]
    Said {
        /// What it says.
        said: [f64; 2],
        /// What it proves.
        proven: [f64; 2],
    },
}

impl fmt::Display for PathProofFile {
    /// What is said, in words.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let meet = match self.keep {
            keep if keep > 0.0 => format!("come as near as {keep}"),
            _ => "meet".into(),
        };
        let (pairs, Said { lower, upper }) = (self.pairs.len(), self.said);
        let pair = self.proof.meeting.as_ref().and_then(|meeting| self.pairs.get(meeting.pair));
        match pair {
            Some([a, b]) => {
                let (a, b) = (self.name(*a), self.name(*b));
                write!(
                    f,
                    "of {pairs} pairs, {a} and {b} are the first to {meet}, at a time between {lower} \
                     and {upper}"
                )
            }
            None if lower == self.path.ends()[1] => {
                write!(f, "of {pairs} pairs, none {meet} on the whole path, up to the time {lower}")
            }
            None => write!(f, "of {pairs} pairs, none {meet} up to the time {lower}"),
        }
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    format: String,
    frames: Vec<Frame>,
    path: JointPath,
    bodies: Vec<BodyRecord>,
    pairs: Vec<[usize; 2]>,
    #[serde(default, skip_serializing_if = "crate::written::is_zero")]
    keep: f64,
    proof: PathProof,
    said: Said,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct BodyRecord {
    name: String,
    frame: Option<usize>,
    pose: Pose,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    parts: Option<Parts>,
    body: BodyFile,
}

/// How a solid is taken apart: its facets by their numbers in the file, in the order in which a proof counts them, and the
/// nodes of its tree in preorder, -1 for one that has two parts, else how many of the next facets it holds.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Parts {
    numbers: Vec<InputFacet>,
    tree: Vec<i64>,
}

impl Parts {
    fn of(body: &AnyBody) -> Option<Self> {
        let ByKind::Solid(solid) = body else { return None };
        let nodes = solid.nodes();
        let (mut tree, mut open) = (Vec::with_capacity(nodes.len()), vec![0]);
        while let Some(at) = open.pop() {
            if nodes[at].is_leaf() {
                tree.push(nodes[at].facets().len() as i64);
            } else {
                let first = at + nodes[at].skip as usize;
                tree.push(-1);
                open.extend([first + 1, first]);
            }
        }
        Some(Self { numbers: solid.facet_indices().to_vec(), tree })
    }
}
