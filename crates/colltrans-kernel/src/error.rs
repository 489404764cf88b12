//! Errors of poses, motions and surfaces.

use glam::DVec3;
use thiserror::Error;

/// The reason why a [`Pose`](crate::Pose) was rejected.
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
        /// Length of the quaternion.
        length: f64,
    },
    /// The matrix is not finite or not a rotation.
    #[error(
        "the matrix with the columns {columns:?} is not a rotation: its defect is {defect:e} \
         (accepted: up to {tolerance:e})"
    )]
    NotARotationMatrix {
        /// Columns as given.
        columns: [[f64; 3]; 3],
        /// Largest entry of `R^T R - I` by magnitude; at least 2 for a reflection, infinite if an entry is
        /// not finite.
        defect: f64,
        /// Largest defect that is accepted.
        tolerance: f64,
    },
    /// The translation is not finite, or outside the range in which the predicates are exact.
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

/// The reason why a motion was rejected.
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
        /// Name of the vector.
        what: &'static str,
        /// The vector as given or derived.
        vector: DVec3,
    },
    /// The angle is not a number, or its magnitude exceeds 1e5 in a unit of time.
    #[error("the angle {angle} is not a number from -1e5 to 1e5 (radians)")]
    Angle {
        /// The angle in a unit of time, in radians.
        angle: f64,
    },
    /// There are no poses.
    #[error("a motion needs at least one pose")]
    NoPoses,
    /// A time is not from 0 to 1, or the times do not increase.
    #[error("the time {time} is not accepted; times must be from 0 to 1 and increase")]
    Time {
        /// The time as given.
        time: f64,
    },
    /// A piece of the motion does not start where the previous one ends.
    #[error(
        "the motion jumps at the time {time}; each piece must start at the pose at which the previous one ends"
    )]
    Jump {
        /// Start time of the later piece.
        time: f64,
    },
    /// A pose of the motion was rejected.
    #[error("invalid pose of the motion: {0}")]
    Pose(#[from] PoseError),
}

/// The reason why faces do not form the boundary of one body.
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
    /// A face contains an index of a vertex that does not exist.
    #[error("face {face} names vertex {vertex}, but the number of vertices is {vertices}")]
    UnknownVertex {
        /// Index of the face.
        face: usize,
        /// The index that does not exist.
        vertex: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// A face contains the same vertex twice.
    #[error("face {face} contains vertex {vertex} twice; the vertices of a face must be distinct")]
    RepeatedVertex {
        /// Index of the face.
        face: usize,
        /// The repeated vertex.
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
        /// The face that contains the edge.
        face: usize,
    },
    /// More than two faces share an edge, or two faces contain it in the same direction.
    #[error(
        "the edge between vertices {from} and {to} is used {count} times, not once in each direction"
    )]
    NonManifoldEdge {
        /// One end of the edge.
        from: usize,
        /// Its other end.
        to: usize,
        /// Number of faces that contain the edge.
        count: usize,
    },
    /// The faces around a vertex form more than one fan.
    #[error(
        "the faces around vertex {vertex} form more than one fan; the surface must be manifold"
    )]
    NonManifoldVertex {
        /// The vertex.
        vertex: usize,
    },
    /// The faces form several surfaces, or a surface with handles.
    #[error(
        "the surface is {}, not one sphere ({vertices} vertices - {edges} edges + {faces} faces = \
         {euler}, not 2)",
        describe_surface(*euler, *shells)
    )]
    NotASphere {
        /// Number of vertices that faces contain.
        vertices: usize,
        /// Number of edges.
        edges: usize,
        /// Number of faces.
        faces: usize,
        /// Euler characteristic: vertices minus edges plus faces.
        euler: i64,
        /// Number of surfaces that share no vertex.
        shells: usize,
    },
    /// There are no faces.
    #[error("the mesh has no faces")]
    NoFaces,
}

/// Describes closed surfaces with an Euler characteristic: each shell adds 2, and each hole through a shell
/// subtracts 2.
fn describe_surface(euler: i64, shells: usize) -> String {
    match (shells, shells as i64 - euler / 2) {
        (1, 1) => "one body with a hole through it".into(),
        (1, holes) => format!("one body with {holes} holes through it"),
        (_, 0) => format!("{shells} separate shells"),
        (_, 1) => format!("{shells} separate shells with a hole through one of them"),
        (_, holes) => format!("{shells} separate shells with {holes} holes in all"),
    }
}
