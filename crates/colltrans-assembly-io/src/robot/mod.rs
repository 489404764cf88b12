//! A robot: links with bodies, joints with names, and the pairs of links to check.
//!
//! A path has one value for each independent joint, in radians or metres. A joint is independent if it moves
//! and mimics no other joint. Pairs of links between which no joint moves are never checked. Pairs with exactly
//! one moving joint between them are checked only if an SRDF file lists the pairs to skip, because neighbours
//! touch by design.

mod cell;
mod path;
mod table;

use std::path::PathBuf;

use colltrans::AnyBody;
use colltrans::motion::path::Mechanism;
use colltrans_mesh::Mesh;
use colltrans_mesh::body::{self, BodyError, BodyOptions, Loaded};
use thiserror::Error;

pub use cell::Cell;
pub use table::{Table, TableError};

/// A robot with its links, joints and kinematic tree.
#[derive(Debug, Clone)]
pub struct Robot {
    pub(crate) name: String,
    pub(crate) links: Vec<Link>,
    pub(crate) joints: Vec<RobotJoint>,
    pub(crate) mechanism: Mechanism,
    pub(crate) notes: Vec<String>,
    pub(crate) files: Vec<PathBuf>,
}

/// A link of a robot.
#[derive(Debug, Clone)]
pub struct Link {
    /// The name of the link.
    pub name: String,
    /// The frame of the mechanism that carries the link; `None` is the world.
    pub frame: Option<usize>,
    /// The collision bodies, in that frame.
    pub bodies: Vec<AnyBody>,
    /// Whether the meshes of the link are replaced by their convex hulls.
    pub is_hull: bool,
    /// The largest depth of the surface of a mesh below its hull, a length, over the meshes that are convex only to
    /// within the tolerance ([`Loaded::dent`]).
    pub dent: Option<f64>,
}

/// A joint that moves.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotJoint {
    /// The name of the joint.
    pub name: String,
    /// The frame of the mechanism that the joint moves.
    pub frame: usize,
    /// The kind of motion.
    pub kind: JointKind,
    /// The lower and the upper limit, in radians or metres.
    pub limits: Option<[f64; 2]>,
    /// The joint that this one mimics, if it is not independent.
    pub mimic: Option<Mimic>,
}

/// The kind of motion of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    /// Rotates within limits.
    Revolute,
    /// Rotates without limits.
    Continuous,
    /// Translates along its axis.
    Prismatic,
}

/// The dependence of a joint on another one: its value is `multiplier` times the other value plus `offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mimic {
    /// The index of the other joint in [`Robot::joints`].
    pub joint: usize,
    /// The factor of the other joint's value.
    pub multiplier: f64,
    /// The constant part, in radians or metres.
    pub offset: f64,
}

/// An error in a query about a robot.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RobotError {
    /// An independent joint has no values.
    #[error(
        "missing values for joint {joint}: add a column of that name, or fix the joint with \
         --joint {joint}=VALUE"
    )]
    NoValues {
        /// The name of the joint.
        joint: String,
    },
    /// A column does not name an independent joint.
    #[error("column {column} does not name an independent joint; independent joints: {joints}")]
    Column {
        /// The name of the column.
        column: String,
        /// The names of the joints for which columns are accepted.
        joints: String,
    },
    /// The number of values in a row differs from the number of joints.
    #[error(
        "rows have {values} values, expected {count}, one for each joint: {joints}; to select joints, \
         add a header line with their names"
    )]
    Values {
        /// The number of values in the first row.
        values: usize,
        /// The number of joints.
        count: usize,
        /// The names of the joints.
        joints: String,
    },
    /// A joint to fix does not exist or is not independent.
    #[error("joint {joint} is not an independent joint; independent joints: {joints}")]
    Joint {
        /// The name of the joint.
        joint: String,
        /// The names of the independent joints.
        joints: String,
    },
    /// The cell has no pair of bodies to check.
    #[error(
        "there is no pair of bodies to check: give the links collision geometry, give an SRDF file that does not \
         list the neighbours to be checked, or give meshes of the scene and joints that move the links against \
         them"
    )]
    NoPair,
    /// Two links or scene bodies have the same name.
    #[error("duplicate name {name} of a link or scene body; rename one of them")]
    DuplicateName {
        /// The name.
        name: String,
    },
    /// No link or scene body has this name.
    #[error("unknown name {name}; known names: {known}")]
    Unknown {
        /// The name that was given.
        name: String,
        /// The names that exist.
        known: String,
    },
    /// The values do not form a path.
    #[error(transparent)]
    Path(#[from] colltrans::motion::path::PathError),
}

/// Builds a body from a mesh: a convex polyhedron if the mesh is convex or [`BodyOptions::hull`] is set, otherwise
/// a solid, which may be open.
///
/// # Errors
/// [`BodyError`] if neither can be built, with the defects of the surface.
pub fn body_from_mesh(mesh: &Mesh, options: &BodyOptions) -> Result<Loaded<AnyBody>, BodyError> {
    if let Ok(Loaded { body, precision, notes }) = body::convex(mesh, options) {
        return Ok(Loaded { body: body.into(), precision, notes });
    }
    let Loaded { body, precision, notes } = body::solid(mesh, &options.with_open(true))?;
    Ok(Loaded { body: body.into(), precision, notes })
}

impl Robot {
    /// Returns the name of the robot.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the links, in the order of the file.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// Returns the joints that move, in the order of the mechanism's values.
    pub fn joints(&self) -> &[RobotJoint] {
        &self.joints
    }

    /// Returns the kinematic tree: frames and joints.
    pub const fn mechanism(&self) -> &Mechanism {
        &self.mechanism
    }

    /// Returns the notes made while the robot was read.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Returns the files from which the robot was read.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Returns the number of moving joints between two links, or between a link and the world if `other` is
    /// `None`.
    pub fn joints_between(&self, link: usize, other: Option<usize>) -> usize {
        let above = |frame: Option<usize>| {
            let parent = |k: &usize| self.mechanism.frames()[*k].parent;
            std::iter::successors(frame, parent).collect::<Vec<usize>>()
        };
        let (a, b) =
            (above(self.links[link].frame), above(other.and_then(|other| self.links[other].frame)));
        let moves = |frame: &&usize| self.joints.iter().any(|joint| joint.frame == **frame);
        let only = |own: &[usize], others: &[usize]| {
            own.iter().filter(|frame| !others.contains(frame)).filter(moves).count()
        };
        only(&a, &b) + only(&b, &a)
    }

    /// Returns the pairs of links to check. Both links have bodies, and at least one joint moves between them.
    /// With `listed` the listed pairs are left out; without it the pairs with a single joint between them are
    /// left out.
    ///
    /// # Errors
    /// [`RobotError::Unknown`] if no link has a listed name.
    pub fn checked_pairs(
        &self,
        listed: Option<&[[String; 2]]>,
    ) -> Result<Vec<[usize; 2]>, RobotError> {
        let mut ignored = Vec::new();
        for names in listed.unwrap_or_default() {
            let [a, b] = [self.link_index(&names[0])?, self.link_index(&names[1])?];
            ignored.push([a.min(b), a.max(b)]);
        }
        let has = |k: &usize| !self.links[*k].bodies.is_empty();
        let least = if listed.is_some() { 1 } else { 2 };
        let count = self.links.len();
        let all =
            (0..count).filter(has).flat_map(|a| (a + 1..count).filter(has).map(move |b| [a, b]));
        Ok(all
            .filter(|pair| !ignored.contains(pair))
            .filter(|[a, b]| self.joints_between(*a, Some(*b)) >= least)
            .collect())
    }

    /// Returns the index of a link, found by name.
    ///
    /// # Errors
    /// [`RobotError::Unknown`] if no link has this name.
    pub fn link_index(&self, name: &str) -> Result<usize, RobotError> {
        let found = self.links.iter().position(|link| link.name == name);
        found.ok_or_else(|| {
            let names: Vec<&str> = self.links.iter().map(|link| link.name.as_str()).collect();
            RobotError::Unknown { name: name.into(), known: names.join(", ").clone() }
        })
    }
}
