//! A proof about a path with all that it is about, as one file.

use std::collections::HashMap;
use std::fmt;

use glam::DVec3;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::file::{BodyFile, nested, said};
use super::scene::{Written, kept};
use colltrans_convex::body::{InputFacet, Pose};
use colltrans_convex::cast::CaseError;
use colltrans_kernel::noise;
use colltrans_motion::path::{
    Frame, JointPath, Mechanism, PathBody, PathCast, PathError, PathOutcome, PathProof,
    PathProofError,
};
use colltrans_solid::kinds::{AnyBody, ByKind};

/// What a file of this version calls itself.
const FORMAT: &str = "colltrans path proof 2";

/// So many pairs are named in words.
const NAMED: usize = 12;

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
    /// Of the statement, by the numbers of the bodies.
    pairs: Vec<[usize; 2]>,
    keep: f64,
    proof: PathProof,
    statement: PathStatement,
}

/// What a [`PathProofFile`] claims: of these pairs of bodies none meet before a time, and when some do.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct PathStatement {
    /// The names of both bodies of each pair.
    pub pairs: Vec<[String; 2]>,
    /// No two bodies of a pair meet before this time; also not at it, if it is the end of the path and no contact is claimed.
    pub lower: f64,
    /// The pair of [`PathProof::meeting`] meets at this time or before; infinite where that is not claimed.
    #[serde(with = "colltrans_kernel::written::or_infinite")]
    pub upper: f64,
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
    /// A name that none of the bodies has, or several.
    #[error(
        "{name:?} is not the name of one of the bodies, or of several; each has one of its own"
    )]
    Name {
        /// That name.
        name: String,
    },
    /// There is no pair of bodies, so that nothing is said.
    #[error("there is no pair of bodies")]
    NoPairs,
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
    /// Asks, of the bodies as they are read back from the file, and keeps the proof. The statement names bodies: those that
    /// have no name of their own get one by their number.
    ///
    /// # Errors
    /// As [`PathCast::first_contact`], a solid that its own facets do not make once more, and no pair at all.
    pub fn answer(cast: &PathCast, names: &[String]) -> Result<(PathOutcome, Self), PathFileError> {
        if cast.pairs().is_empty() {
            return Err(PathFileError::NoPairs);
        }
        let names = names_of(cast.bodies().count(), names);
        let carried =
            cast.carried_bodies().zip(&names).map(|(PathBody { frame, placed }, name)| {
                let written = Written::again(&kept(placed), "one")?;
                Ok(Carried { name: name.clone(), frame, pose: placed.pose(), written })
            });
        let mut file = Self {
            mechanism: cast.mechanism().clone(),
            path: cast.path().clone(),
            bodies: carried.collect::<Result<_, CaseError>>()?,
            pairs: cast.pairs().to_vec(),
            keep: cast.keep(),
            proof: PathProof::default(),
            statement: PathStatement::default(),
        };
        let outcome = file.cast()?.first_contact()?;
        if !outcome.proof().solids.is_empty() {
            // The file has those bodies as the solids that the proof takes them as.
            return Self::answer(&cast.with_solids(&outcome.proof().solids), &names);
        }
        let [from, to] = file.path.ends();
        let [lower, upper] = match &outcome {
            PathOutcome::Contact(of) | PathOutcome::Grazing(of) | PathOutcome::Undecided(of) => {
                [of.lower, of.upper]
            }
            PathOutcome::Overlapping(_) => [from; 2],
            PathOutcome::Free(_) => [to, f64::INFINITY],
            _ => [from, f64::INFINITY],
        };
        let pairs = cast.pairs().iter().map(|pair| pair.map(|k| names[k].clone())).collect();
        file.statement = PathStatement { pairs, lower, upper };
        file.proof = outcome.proof().clone();
        Ok((outcome, file))
    }

    /// Checks it, as [`PathCast::verify`] does.
    ///
    /// # Errors
    /// What is not proven.
    pub fn check(&self) -> Result<[f64; 2], PathCheckError> {
        let proven = self.cast()?.verify(&self.proof)?;
        let PathStatement { lower, upper, .. } = self.statement;
        if lower <= proven[0] && proven[1] <= upper {
            return Ok(proven);
        }
        Err(PathCheckError::Said { said: [lower, upper], proven })
    }

    /// The names of its bodies.
    pub fn names(&self) -> Vec<String> {
        self.bodies.iter().map(|of| of.name.clone()).collect()
    }

    /// What it claims; true if [`Self::check`] does not object.
    pub const fn statement(&self) -> &PathStatement {
        &self.statement
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
            keep: self.keep,
            proof: self.proof.clone(),
            statement: self.statement.clone(),
        };
        serde_json::to_string(&file).expect("numbers and names")
    }

    /// From what [`Self::to_json`] has written. It is read, not believed: see [`Self::check`].
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn from_json(text: &str) -> Result<Self, PathFileError> {
        let text = said(text, FORMAT)?;
        let file: File = nested(text)?;
        let body = |of: BodyRecord| {
            let written = Written::of(of.body)?;
            // They are there for whoever has no such trees; they have to be those of these bodies.
            if of.parts != Parts::of(&written.body) {
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
        let bodies: Vec<Carried> =
            file.bodies.into_iter().map(body).collect::<Result<_, CaseError>>()?;
        let pairs = numbers_of(&file.statement.pairs, &bodies)?;
        if pairs.is_empty() {
            return Err(PathFileError::NoPairs);
        }
        let file = Self {
            mechanism: Mechanism::new(file.frames)?,
            path: file.path,
            bodies,
            pairs,
            keep: file.keep,
            proof: file.proof,
            statement: file.statement,
        };
        file.cast()?;
        Ok(file)
    }
}

/// A name for each body, no two of them the same: its own one, or else its number.
fn names_of(count: usize, own: &[String]) -> Vec<String> {
    let mut names: Vec<String> = Vec::with_capacity(count);
    for k in 0..count {
        let mut name = own.get(k).cloned().unwrap_or_default();
        if name.is_empty() {
            name = format!("body {k}");
        }
        while names.contains(&name) {
            name = format!("{name} ({k})");
        }
        names.push(name);
    }
    names
}

/// The pairs of a statement by the numbers of their bodies, each of which has a name of its own.
fn numbers_of(pairs: &[[String; 2]], bodies: &[Carried]) -> Result<Vec<[usize; 2]>, PathFileError> {
    let mut numbers = HashMap::new();
    for (k, Carried { name, .. }) in bodies.iter().enumerate() {
        if name.is_empty() || numbers.insert(name.as_str(), k).is_some() {
            return Err(PathFileError::Name { name: name.clone() });
        }
    }
    let number = |name: &String| {
        numbers
            .get(name.as_str())
            .copied()
            .ok_or_else(|| PathFileError::Name { name: name.clone() })
    };
    pairs.iter().map(|[a, b]| Ok([number(a)?, number(b)?])).collect()
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
        let PathStatement { pairs, lower, upper } = &self.statement;
        let named = |[a, b]: &[String; 2]| format!("{a} and {b}");
        let first: Vec<String> = pairs.iter().take(NAMED).map(named).collect();
        let more = if pairs.len() > NAMED { ", ..." } else { "" };
        write!(f, "of {} pairs ({}{more}) ", pairs.len(), first.join(", "))?;
        let [from, to] = self.path.ends();
        let meeting = self.proof.meeting.as_ref().and_then(|meeting| pairs.get(meeting.pair));
        let is_whole = *lower == to && self.proof.is_of_the_beginning();
        match meeting {
            None if is_whole => write!(f, "none {meet} on the whole path, up to the time {lower}"),
            None if from == to => f.write_str("nothing is said"),
            None => write!(f, "none {meet} before the time {lower}"),
            Some(pair) => {
                write!(f, "none {meet} before the time {lower}, and {} {meet} ", named(pair))?;
                if upper.is_finite() {
                    write!(f, "by the time {upper}")
                } else {
                    f.write_str("on the path")
                }
            }
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
    #[serde(default, skip_serializing_if = "colltrans_kernel::written::is_zero")]
    keep: f64,
    proof: PathProof,
    statement: PathStatement,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct BodyRecord {
    name: String,
    #[serde(deserialize_with = "colltrans_kernel::written::given")]
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
