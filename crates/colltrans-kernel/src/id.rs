//! Numbers of vertices and faces, each kind a type: what a body has kept is numbered anew, and the
//! input has numbers of its own.
//!
//! What leads from one numbering to the other, or is told in an answer, has these types. Plain `u32` are the
//! body's own numbers where nothing else can be meant: lists of corners that bodies are built and drawn from
//! (`Solid::triangles`, `ConvexPolyhedron::face_vertices`), positions of
//! triangles in such a list, and walks over a body's edges (`HalfEdge`,
//! `ConvexPolyhedron::neighbours`): there types would be taken off again at every use.
//!

use std::fmt;

macro_rules! numbers {
    ($($(#[$doc:meta])* $name:ident;)+) => {$(
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
        #[cfg_attr(
            feature = "serde",
            derive(serde::Serialize, serde::Deserialize),
            serde(transparent)
        )]
        pub struct $name(pub u32);

        impl $name {
            /// As a position in a slice.
            #[inline]
            pub const fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.0.fmt(f)
            }
        }

        impl From<u32> for $name {
            #[inline]
            fn from(number: u32) -> Self {
                Self(number)
            }
        }

        impl From<$name> for u32 {
            #[inline]
            fn from(number: $name) -> Self {
                number.0
            }
        }
    )+};
}

numbers! {
    /// A vertex that a body has kept: its position in
    /// `ConvexPolyhedron::vertices` or
    /// `Solid::vertices`.
    VertexId;
    /// A face as a `Feature` names it: of a convex polyhedron its own, of a solid the
    /// least number of the input's facets that it is made of.
    FaceId;
    /// A point or mesh vertex of the input, by its number there.
    InputVertex;
    /// A facet of the input mesh of a `Solid`, by its number there: a part of it is a
    /// triangle of the body, which has a position in `Solid::triangles`.
    InputFacet;
}

/// A body among many (`Obstacles`): the number with which it came, from 0 on. It stays
/// valid whatever else comes, moves and goes, and is never used again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(transparent))]
pub struct ObstacleId(pub u64);

impl fmt::Display for ObstacleId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}
