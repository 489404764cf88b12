//! Proofs about bodies that joints carry along a path: which two of them first meet.

use std::collections::HashMap;
use std::fmt;

use serde::{Deserialize, Serialize};

use super::body::StoredBody;
use super::error::{ProofError, ProofFileError};
use super::file::{Joints, Link, Placement, Query, Robot};
use super::proven::{Proven, Verify};
use super::words::shown;
use super::{ProofFile, Statement};
use colltrans_convex::body::InputFacet;
use colltrans_motion::path::{PathBody, PathCast, PathOutcome, PathProof};
use colltrans_solid::kinds::{AnyBody, ByKind};

/// So many pairs are named in words.
const NAMED: usize = 12;

/// What is said of a path: of these pairs of bodies none meet before a time, and when some do.
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
    /// Of each body of the file that is a solid, for whoever has no such trees; they have to be those of these bodies.
    parts: Vec<Option<Parts>>,
    /// The proof.
    pub proof: PathProof,
}

/// What is asked of bodies of a mechanism.
#[derive(Debug)]
pub(super) struct PathSetting<'a> {
    bodies: &'a [StoredBody],
    cast: PathCast<'a>,
}

impl<'a> PathSetting<'a> {
    pub(super) fn new(
        bodies: &'a [StoredBody],
        robot: &'a Robot,
        joints: &'a Joints,
        pairs: &[[String; 2]],
    ) -> Result<Self, ProofFileError> {
        if pairs.is_empty() {
            return Err(ProofFileError::NoPairs);
        }
        let carried = |link: &Link| {
            let placed = StoredBody::of(bodies, link.body)?.body.at(link.pose);
            Ok(PathBody { frame: link.frame, placed })
        };
        let carried = robot.bodies.iter().map(carried).collect::<Result<_, ProofFileError>>()?;
        let pairs = numbers_of(pairs, &robot.bodies)?;
        let cast = PathCast::new(&robot.frames, &joints.path, carried, pairs)?;
        Ok(Self { bodies, cast: cast.keeping(joints.keep)? })
    }
}

impl Verify<'_, PathSetting<'_>> for PathStatement {
    fn verify(&self, about: &PathSetting<'_>) -> Result<Proven<'static>, ProofError> {
        let parts: Vec<_> = about.bodies.iter().map(|of| Parts::of(&of.body)).collect();
        if parts != self.parts {
            let body = parts.iter().zip(&self.parts).take_while(|(own, said)| own == said).count();
            return Err(ProofError::Parts { body });
        }
        let proven = about.cast.verify(&self.proof)?;
        let said = [self.lower, self.upper];
        if said[0] <= proven[0] && proven[1] <= said[1] {
            return Ok(Proven::Time(proven));
        }
        Err(ProofError::Said { said, proven })
    }
}

/// Of questions about bodies of a mechanism.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::motion::path::{Frame, Joint, JointPath, Mechanism, PathBody, PathCast};
/// use colltrans::{ConvexPolyhedron, Pose, ProofFile};
///
/// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
/// let frame = Frame { parent: None, origin: Pose::IDENTITY, joint: Joint::Sliding(DVec3::X) };
/// let slide = Mechanism::new(vec![frame])?;
/// let path = JointPath::evenly(vec![vec![0.0], vec![4.0]])?;
/// let there = Pose::from_translation(DVec3::X * 3.0)?;
/// let bodies = vec![PathBody::carried(0, cube.at(Pose::IDENTITY)), PathBody::standing(cube.at(there))];
/// let cast = PathCast::new(&slide, &path, bodies, vec![[0, 1]])?;
/// let names = ["cart".into(), "stop".into()];
/// let (_, saved) = ProofFile::with_path(&cast, &names)?;
/// let [lower, upper] = ProofFile::from_json(&saved.to_json())?.check()?.time().expect("bounds");
/// assert!(lower <= 0.5 && 0.5 <= upper && upper - lower < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
impl ProofFile {
    /// The first contact on a path, asked of the bodies as they are read back from the file, and its proof. The statement
    /// names bodies: those that have no name of their own get one by their number.
    ///
    /// # Errors
    /// As [`PathCast::first_contact`], a solid that its own facets do not make once more, and no pair at all.
    pub fn with_path(
        cast: &PathCast<'_>,
        names: &[String],
    ) -> Result<(PathOutcome, Self), ProofFileError> {
        let names = names_of(cast.bodies().count(), names);
        let (mut bodies, mut links) = (Vec::new(), Vec::new());
        for (body, (of, name)) in cast.carried_bodies().zip(&names).enumerate() {
            let (name, frame, pose) = (name.clone(), of.frame, of.placed.pose());
            bodies.push(StoredBody::again(of.placed, body)?);
            links.push(Link { body, name, frame, pose });
        }
        let robot = Robot { frames: cast.mechanism().clone(), bodies: links };
        let joints = Joints { path: cast.path().clone(), keep: cast.keep() };
        let pairs: Vec<_> =
            cast.pairs().iter().map(|pair| pair.map(|k| names[k].clone())).collect();
        let outcome = PathSetting::new(&bodies, &robot, &joints, &pairs)?.cast.first_contact()?;
        let proof = outcome.proof().clone();
        if !proof.solids.is_empty() {
            // The file has those bodies as the solids that the proof takes them as.
            return Self::with_path(&cast.with_solids(&proof.solids), &names);
        }
        let [from, to] = joints.path.ends();
        let [lower, upper] = match &outcome {
            PathOutcome::Contact(of) | PathOutcome::Grazing(of) | PathOutcome::Undecided(of) => {
                [of.lower, of.upper]
            }
            PathOutcome::Overlapping(_) => [from; 2],
            PathOutcome::Free(_) => [to, f64::INFINITY],
            _ => [from, f64::INFINITY],
        };
        let parts = bodies.iter().map(|of| Parts::of(&of.body)).collect();
        let statement = Statement::Path(PathStatement { pairs, lower, upper, parts, proof });
        let (placement, query) = (Placement::Robot(robot), Query::Path(joints));
        Ok((outcome, Self { bodies, placement, query, statement }))
    }

    /// Returns what a proof about a path is about, and the names of the bodies. `None` if it is not about a path.
    pub fn path(&self) -> Option<(PathCast<'_>, Vec<String>)> {
        let (Placement::Robot(robot), Query::Path(joints), Statement::Path(of)) =
            (&self.placement, &self.query, &self.statement)
        else {
            return None;
        };
        let setting = PathSetting::new(&self.bodies, robot, joints, &of.pairs).ok()?;
        Some((setting.cast, robot.bodies.iter().map(|of| of.name.clone()).collect()))
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
fn numbers_of(pairs: &[[String; 2]], links: &[Link]) -> Result<Vec<[usize; 2]>, ProofFileError> {
    let mut numbers = HashMap::new();
    for (k, Link { name, .. }) in links.iter().enumerate() {
        if name.is_empty() || numbers.insert(name.as_str(), k).is_some() {
            return Err(ProofFileError::Name { name: name.clone() });
        }
    }
    let number = |name: &String| {
        numbers
            .get(name.as_str())
            .copied()
            .ok_or_else(|| ProofFileError::Name { name: name.clone() })
    };
    pairs.iter().map(|[a, b]| Ok([number(a)?, number(b)?])).collect()
}

impl PathStatement {
    /// Tells it in words.
    pub(super) fn tell(&self, f: &mut fmt::Formatter<'_>, joints: &Joints) -> fmt::Result {
        let meet = match joints.keep {
            keep if keep > 0.0 => format!("come as near as {keep:?}"),
            _ => "meet".into(),
        };
        let Self { pairs, lower, upper, proof, .. } = self;
        let named = |[a, b]: &[String; 2]| format!("{} and {}", shown(a), shown(b));
        let first: Vec<String> = pairs.iter().take(NAMED).map(named).collect();
        let more = if pairs.len() > NAMED { ", ..." } else { "" };
        write!(f, "of {} pairs ({}{more}) ", pairs.len(), first.join(", "))?;
        let [from, to] = joints.path.ends();
        let meeting = proof.meeting.as_ref().and_then(|meeting| pairs.get(meeting.pair));
        let is_whole = *lower == to && proof.is_of_the_beginning();
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

/// How a solid is taken apart: its facets by their numbers in the file, in the order in which a proof counts them, and the
/// nodes of its tree in preorder, -1 for one that has two parts, else how many of the next facets it holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
