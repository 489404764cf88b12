//! Proofs of the first contact of bodies that joints carry along a path.

use std::collections::HashMap;
use std::fmt;

use serde::{Deserialize, Serialize};

use super::body::StoredBody;
use super::error::{ProofError, ProofFileError};
use super::file::{Joints, Link, Placement, Query, Robot};
use super::proven::{Proven, Verify};
use super::text::quoted_name;
use super::{ProofFile, Statement};
use colltrans_convex::body::InputFacet;
use colltrans_motion::path::{PathBody, PathCast, PathOutcome, PathProof};
use colltrans_solid::kinds::{AnyBody, ByKind};

/// Maximum number of pairs that a text names.
const MAX_NAMED: usize = 12;

/// Statement about a path: none of these pairs of bodies meets before a time. If a contact is claimed, one of
/// them meets by another time.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct PathStatement {
    /// Names of both bodies of each pair.
    pub pairs: Vec<[String; 2]>,
    /// Time before which no pair meets. If it is the end of the path and no contact is claimed, no pair meets
    /// at this time either.
    pub lower: f64,
    /// Time by which the pair of [`PathProof::meeting`] meets; infinite if no contact is claimed.
    #[serde(with = "colltrans_kernel::serialization::null_as_infinity")]
    pub upper: f64,
    /// Tree of each solid of the file, for checkers that do not build trees. A check compares it with the
    /// tree of the body.
    parts: Vec<Option<StoredTree>>,
    /// The proof.
    pub proof: PathProof,
}

/// Bodies of a mechanism, and the query about them.
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
            let placed = StoredBody::at_index(bodies, link.body)?.body.at(link.pose);
            Ok(PathBody { frame: link.frame, placed })
        };
        let carried = robot.bodies.iter().map(carried).collect::<Result<_, ProofFileError>>()?;
        let pairs = pair_indices(pairs, &robot.bodies)?;
        let cast = PathCast::new(&robot.frames, &joints.path, carried, pairs)?;
        Ok(Self { bodies, cast: cast.with_min_gap(joints.min_gap)? })
    }
}

impl Verify<'_, PathSetting<'_>> for PathStatement {
    fn verify(&self, about: &PathSetting<'_>) -> Result<Proven<'static>, ProofError> {
        let parts: Vec<_> = about.bodies.iter().map(|of| StoredTree::of_body(&of.body)).collect();
        if parts != self.parts {
            let body =
                parts.iter().zip(&self.parts).take_while(|(own, claimed)| own == claimed).count();
            return Err(ProofError::Parts { body });
        }
        let proven = about.cast.verify(&self.proof)?;
        let claimed = [self.lower, self.upper];
        if claimed[0] <= proven[0] && proven[1] <= claimed[1] {
            return Ok(Proven::Time(proven));
        }
        Err(ProofError::ClaimTooStrong { claimed, proven })
    }
}

/// Proofs of queries about bodies of a mechanism.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::motion::path::{Frame, Joint, JointPath, Mechanism, PathBody, PathCast};
/// use colltrans::{ConvexPolyhedron, Pose, ProofFile};
///
/// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
/// let frame = Frame { parent: None, origin: Pose::IDENTITY, joint: Joint::Sliding(DVec3::X) };
/// let slide = Mechanism::new(vec![frame])?;
/// let path = JointPath::at_unit_times(vec![vec![0.0], vec![4.0]])?;
/// let there = Pose::from_translation(DVec3::X * 3.0)?;
/// let bodies = vec![PathBody::carried_by(0, cube.at(Pose::IDENTITY)), PathBody::at_rest(cube.at(there))];
/// let cast = PathCast::new(&slide, &path, bodies, vec![[0, 1]])?;
/// let names = ["cart".into(), "stop".into()];
/// let (_, saved) = ProofFile::with_path(&cast, &names)?;
/// let [lower, upper] = ProofFile::from_json(&saved.to_json())?.check()?.time_bounds().expect("bounds");
/// assert!(lower <= 0.5 && 0.5 <= upper && upper - lower < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
impl ProofFile {
    /// Computes the first contact on a path, for the bodies that are rebuilt from the file, and its
    /// proof. The statement refers to bodies by name. Bodies without a name of their own get one that
    /// contains their index.
    ///
    /// # Errors
    /// Returns the errors of [`PathCast::first_contact`], and errors for a solid that cannot be rebuilt from
    /// its own facets and for a query without pairs.
    pub fn with_path(
        cast: &PathCast<'_>,
        names: &[String],
    ) -> Result<(PathOutcome, Self), ProofFileError> {
        let names = distinct_names(cast.bodies().count(), names);
        let (mut bodies, mut links) = (Vec::new(), Vec::new());
        for (body, (of, name)) in cast.bodies_with_frames().zip(&names).enumerate() {
            let (name, frame, pose) = (name.clone(), of.frame, of.placed.pose());
            bodies.push(StoredBody::rebuild(of.placed, body)?);
            links.push(Link { body, name, frame, pose });
        }
        let robot = Robot { frames: cast.mechanism().clone(), bodies: links };
        let joints = Joints { path: cast.path().clone(), min_gap: cast.min_gap() };
        let pairs: Vec<_> =
            cast.pairs().iter().map(|pair| pair.map(|k| names[k].clone())).collect();
        let outcome = PathSetting::new(&bodies, &robot, &joints, &pairs)?.cast.first_contact()?;
        let proof = outcome.proof().clone();
        if !proof.solids.is_empty() {
            // The file contains these bodies as solids, like the proof.
            return Self::with_path(&cast.with_solids(&proof.solids), &names);
        }
        let [from, to] = joints.path.time_range();
        let [lower, upper] = match &outcome {
            PathOutcome::Contact(of) | PathOutcome::Grazing(of) | PathOutcome::Undecided(of) => {
                [of.lower, of.upper]
            }
            PathOutcome::Overlapping(_) => [from; 2],
            PathOutcome::Free(_) => [to, f64::INFINITY],
            _ => [from, f64::INFINITY],
        };
        let parts = bodies.iter().map(|of| StoredTree::of_body(&of.body)).collect();
        let statement = Statement::Path(PathStatement { pairs, lower, upper, parts, proof });
        let (placement, query) = (Placement::Robot(robot), Query::Path(joints));
        Ok((outcome, Self::new(bodies, placement, query, statement)))
    }

    /// Returns the query of a proof about a path, and the names of the bodies. Returns `None` for other
    /// proofs.
    pub fn path_query(&self) -> Option<(PathCast<'_>, Vec<String>)> {
        let (Placement::Robot(robot), Query::Path(joints), Statement::Path(of)) =
            (&self.placement, &self.query, &self.statement)
        else {
            return None;
        };
        let setting = PathSetting::new(&self.bodies, robot, joints, &of.pairs).ok()?;
        Some((setting.cast, robot.bodies.iter().map(|of| of.name.clone()).collect()))
    }
}

/// Returns a distinct name for each body: its own one, or one with its index.
fn distinct_names(count: usize, own: &[String]) -> Vec<String> {
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

/// Converts the pairs of a statement from names to indices. Returns an error unless every name belongs to
/// exactly one body.
fn pair_indices(pairs: &[[String; 2]], links: &[Link]) -> Result<Vec<[usize; 2]>, ProofFileError> {
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
    /// Writes the statement as text.
    pub(super) fn write_text(&self, f: &mut fmt::Formatter<'_>, joints: &Joints) -> fmt::Result {
        let meet = match joints.min_gap {
            min_gap if min_gap > 0.0 => format!("come as near as {min_gap:?}"),
            _ => "meet".into(),
        };
        let Self { pairs, lower, upper, proof, .. } = self;
        let named = |[a, b]: &[String; 2]| format!("{} and {}", quoted_name(a), quoted_name(b));
        let first: Vec<String> = pairs.iter().take(MAX_NAMED).map(named).collect();
        let more = if pairs.len() > MAX_NAMED { ", ..." } else { "" };
        write!(f, "of {} pairs ({}{more}) ", pairs.len(), first.join(", "))?;
        let [from, to] = joints.path.time_range();
        let meeting = proof.meeting.as_ref().and_then(|meeting| pairs.get(meeting.pair));
        let is_whole = *lower == to && proof.proves_start();
        match meeting {
            None if is_whole => write!(f, "none {meet} on the whole path, up to the time {lower}"),
            None if from == to => f.write_str("no claim is made"),
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

/// Decomposition of a solid: the indices of its facets in the file, in the order of the proof, and the nodes
/// of its tree in preorder. A node with two children is -1, a leaf is the number of facets that it contains.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredTree {
    numbers: Vec<InputFacet>,
    tree: Vec<i64>,
}

impl StoredTree {
    fn of_body(body: &AnyBody) -> Option<Self> {
        let ByKind::Solid(solid) = body else { return None };
        let nodes = solid.nodes();
        let (mut tree, mut open) = (Vec::with_capacity(nodes.len()), vec![0]);
        while let Some(at) = open.pop() {
            if nodes[at].is_leaf() {
                tree.push(nodes[at].facets().len() as i64);
            } else {
                let first = at + nodes[at].child_offset as usize;
                tree.push(-1);
                open.extend([first + 1, first]);
            }
        }
        Some(Self { numbers: solid.facet_indices().to_vec(), tree })
    }
}
