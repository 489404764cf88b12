//! Why a pose, a motion or a surface was refused.

use glam::DVec3;
use thiserror::Error;

/// Why a [`Pose`](crate::Pose) was refused.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum PoseError {
    /// The quaternion is not finite or its length is not 1.
    #[error("the rotation (x {x}, y {y}, z {z}, w {w}) has length {length}, not 1")]
    NotARotation {
        /// Component x as given.
        x: f64,
        /// Component y as given.
        y: f64,
        /// Component z as given.
        z: f64,
        /// Component w as given.
        w: f64,
        /// Its length.
        length: f64,
    },
    /// The matrix is not finite or not a rotation.
    #[error(
        "the matrix with the columns {columns:?} is not a rotation: it is off one by {defect:e} \
         (tolerated: {tolerance:e})"
    )]
    NotARotationMatrix {
        /// The columns as given.
        columns: [[f64; 3]; 3],
        /// The largest entry of `R^T R - I` by magnitude; at least 2 for a reflection, infinite if an
        /// entry is not finite.
        defect: f64,
        /// The defect that would have been accepted.
        tolerance: f64,
    },
    /// The translation is not finite, or beyond the range in which the predicates are exact.
    #[error(
        "the translation {:?} is not finite or has a component outside the exact range \
         (0, or a magnitude from 2^-200 to 2^200)",
        .translation.to_array()
    )]
    Translation {
        /// The translation as given.
        translation: DVec3,
    },
}

/// Why a motion is none.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum MotionError {
    /// A vector is not finite or out of range, or an axis is zero.
    #[error(
        "the {what} {:?} is zero, not finite or has a component outside the exact range \
         (0, or a magnitude from 2^-200 to 2^200)",
        .vector.to_array()
    )]
    Number {
        /// Which one.
        what: &'static str,
        /// As given, or as it follows.
        vector: DVec3,
    },
    /// The angle is not finite, or larger than 1e5 in a piece or for a whole unit of time.
    #[error("the angle {angle} is not a number from -1e5 to 1e5 (radians)")]
    Angle {
        /// The angle as given, in a unit of time.
        angle: f64,
    },
    /// No poses to go through.
    #[error("a motion needs at least one pose")]
    NoPoses,
    /// A time that is not from 0 to 1, or not in order.
    #[error("the time {time} is not from 0 to 1, or not after the one before it")]
    Time {
        /// The time as given.
        time: f64,
    },
    /// A pose on the way is none.
    #[error("a pose on the way is none: {0}")]
    Pose(#[from] PoseError),
}

/// Why faces do not form the boundary of one body.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum TopologyError {
    /// A face has fewer than three vertices.
    #[error("face {face} has {count} vertices; a face needs at least 3")]
    DegenerateFace {
        /// Index of the face.
        face: usize,
        /// Number of its vertices.
        count: usize,
    },
    /// A face names a vertex that does not exist.
    #[error("face {face} names vertex {vertex}, but there are only {vertices} vertices")]
    UnknownVertex {
        /// Index of the face.
        face: usize,
        /// The index that does not exist.
        vertex: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// A face names the same vertex twice.
    #[error("face {face} passes twice through vertex {vertex}")]
    RepeatedVertex {
        /// Index of the face.
        face: usize,
        /// The vertex it repeats.
        vertex: usize,
    },
    /// An edge has a face on one side only.
    #[error(
        "the surface is open: the edge from vertex {from} to vertex {to} of face {face} has no face \
         on its other side"
    )]
    OpenEdge {
        /// Start of the edge, along its face.
        from: usize,
        /// End of the edge.
        to: usize,
        /// The face on the side that has one.
        face: usize,
    },
    /// More than two faces meet at an edge, or two run along it in the same direction.
    #[error(
        "the edge between vertices {from} and {to} is used {count} times, not once in each direction"
    )]
    NonManifoldEdge {
        /// One end of the edge.
        from: usize,
        /// Its other end.
        to: usize,
        /// How often faces run along it.
        count: usize,
    },
    /// The faces around a vertex form more than one fan.
    #[error("the faces around vertex {vertex} form more than one fan")]
    NonManifoldVertex {
        /// The vertex.
        vertex: usize,
    },
    /// The faces form several surfaces, or one with holes through it (handles).
    #[error(
        "the surface is {}, not one sphere ({vertices} vertices - {edges} edges + {faces} faces = \
         {euler}, not 2)",
        surface_in_words(*euler, *shells)
    )]
    NotASphere {
        /// Number of vertices in use.
        vertices: usize,
        /// Number of edges.
        edges: usize,
        /// Number of faces.
        faces: usize,
        /// Their alternating sum.
        euler: i64,
        /// Number of surfaces that share no vertex.
        shells: usize,
    },
    /// There are no faces.
    #[error("the mesh has no faces")]
    NoFaces,
}

/// What closed surfaces with this Euler characteristic are: every shell adds 2, every hole through
/// one takes 2 away.
fn surface_in_words(euler: i64, shells: usize) -> String {
    match (shells, shells as i64 - euler / 2) {
        (1, 1) => "one body with a hole through it".into(),
        (1, holes) => format!("one body with {holes} holes through it"),
        (_, 0) => format!("{shells} separate shells"),
        (_, 1) => format!("{shells} separate shells with a hole through one of them"),
        (_, holes) => format!("{shells} separate shells with {holes} holes in all"),
    }
}
