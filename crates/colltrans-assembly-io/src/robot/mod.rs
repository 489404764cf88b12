//! A robot that moves: links with bodies, joints with names, and which links are held against what.
//!
//! A path has one value for each joint that moves and follows no other one, in radians or metres. Links between which
//! no joint moves are never asked about; nor are those with one joint between them, unless somebody says which pairs
//! are not (an SRDF file): neighbours touch, and are made to.

mod cell;
mod path;
mod table;

use std::path::PathBuf;

use colltrans::AnyBody;
use colltrans::motion::path::Mechanism;
use colltrans_mesh::Mesh;
use colltrans_mesh::body::{self, BodyOptions, Loaded, Refused};
use thiserror::Error;

pub use cell::Cell;
pub use table::{Table, TableError};

/// A robot.
#[derive(Debug, Clone)]
pub struct Robot {
    pub(crate) name: String,
    pub(crate) links: Vec<Link>,
    pub(crate) joints: Vec<RobotJoint>,
    pub(crate) mechanism: Mechanism,
    pub(crate) notes: Vec<String>,
    pub(crate) files: Vec<PathBuf>,
}

/// A link.
#[derive(Debug, Clone)]
pub struct Link {
    /// Its name.
    pub name: String,
    /// The frame of the mechanism that carries it; none is the world.
    pub frame: Option<usize>,
    /// What it collides with, in that frame.
    pub bodies: Vec<AnyBody>,
    /// Whether convex hulls stand for its meshes.
    pub is_hull: bool,
    /// The largest dent of its meshes that are convex only to within the tolerance, a length
    /// ([`Loaded::dent`]).
    pub dent: Option<f64>,
}

/// A joint that moves.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotJoint {
    /// Its name.
    pub name: String,
    /// The frame that it moves.
    pub frame: usize,
    /// How.
    pub kind: Kind,
    /// Its limits, in radians or metres.
    pub limits: Option<[f64; 2]>,
    /// The joint it follows.
    pub mimic: Option<Mimic>,
}

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// It turns, within limits.
    Revolute,
    /// It turns as far as one likes.
    Continuous,
    /// It slides.
    Prismatic,
}

/// The value of a joint that follows another one: `multiplier` times its value, and `offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mimic {
    /// The number of the other joint.
    pub joint: usize,
    /// As it is.
    pub multiplier: f64,
    /// As it is.
    pub offset: f64,
}

/// Why a robot cannot be asked about.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RobotError {
    /// A joint has no value.
    #[error(
        "there are no values for joint {joint}: give a column of that name, or let it rest with \
         --joint {joint}=VALUE"
    )]
    NoValues {
        /// Its name.
        joint: String,
    },
    /// A column is of no joint.
    #[error("column {column} is of no joint that moves by itself; those are {joints}")]
    Column {
        /// Its name.
        column: String,
        /// All that there are.
        joints: String,
    },
    /// Rows have not one value for each joint.
    #[error(
        "rows have {values} values, and {count} joints have one each: {joints}; a first line of names \
         says which are given"
    )]
    Values {
        /// How many there are in a row.
        values: usize,
        /// How many there should be.
        count: usize,
        /// The joints.
        joints: String,
    },
    /// A joint that is named does not move, or follows another one.
    #[error("joint {joint} is none that moves by itself; those are {joints}")]
    Joint {
        /// Its name.
        joint: String,
        /// All that there are.
        joints: String,
    },
    /// No pair of bodies is held against each other.
    #[error(
        "no pair of bodies is held against each other, so nothing can be checked: links need geometry to collide \
         with, neighbours are held against each other by an SRDF file that does not list them, and meshes of the \
         scene are held against links that move"
    )]
    NoPair,
    /// Two things have one name.
    #[error("two links or bodies around are called {name}")]
    Twice {
        /// Which.
        name: String,
    },
    /// Nothing has a name.
    #[error("there is no {name} among {known}")]
    Unknown {
        /// What was named.
        name: String,
        /// What there is.
        known: String,
    },
    /// The values are no path.
    #[error(transparent)]
    Path(#[from] colltrans::motion::path::PathError),
}

/// Makes a body of a mesh: convex if the mesh is, otherwise a solid, which may be open.
///
/// # Errors
/// What is wrong with its surface.
pub fn body_of(mesh: &Mesh, options: &BodyOptions) -> Result<Loaded<AnyBody>, Refused> {
    if let Ok(Loaded { body, precision, notes }) = body::convex(mesh, options) {
        return Ok(Loaded { body: body.into(), precision, notes });
    }
    let Loaded { body, precision, notes } = body::solid(mesh, &options.with_open(true))?;
    Ok(Loaded { body: body.into(), precision, notes })
}

impl Robot {
    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its links, in the order of the file.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// The joints that move, in the order of the mechanism's values.
    pub fn joints(&self) -> &[RobotJoint] {
        &self.joints
    }

    /// Frames and joints.
    pub const fn mechanism(&self) -> &Mechanism {
        &self.mechanism
    }

    /// What was noted when it was read.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The files that it was read from.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// How many joints move between two links; of none, between a link and the world.
    pub fn moving_between(&self, link: usize, other: Option<usize>) -> usize {
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

    /// The pairs of links that are held against each other: all that have bodies and move against each other, but
    /// neighbours, or but those that are listed.
    ///
    /// # Errors
    /// A listed name that no link has.
    pub fn pairs(&self, listed: Option<&[[String; 2]]>) -> Result<Vec<[usize; 2]>, RobotError> {
        let mut ignored = Vec::new();
        for names in listed.unwrap_or_default() {
            let [a, b] = [self.link(&names[0])?, self.link(&names[1])?];
            ignored.push([a.min(b), a.max(b)]);
        }
        let has = |k: &usize| !self.links[*k].bodies.is_empty();
        let least = if listed.is_some() { 1 } else { 2 };
        let count = self.links.len();
        let all =
            (0..count).filter(has).flat_map(|a| (a + 1..count).filter(has).map(move |b| [a, b]));
        Ok(all
            .filter(|pair| !ignored.contains(pair))
            .filter(|[a, b]| self.moving_between(*a, Some(*b)) >= least)
            .collect())
    }

    /// The number of the link of a name.
    ///
    /// # Errors
    /// There is none.
    pub fn link(&self, name: &str) -> Result<usize, RobotError> {
        let found = self.links.iter().position(|link| link.name == name);
        found.ok_or_else(|| {
            let names: Vec<&str> = self.links.iter().map(|link| link.name.as_str()).collect();
            RobotError::Unknown {
                name: name.into(),
                known: format!("the links {}", names.join(", ")),
            }
        })
    }
}
