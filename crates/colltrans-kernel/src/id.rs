//! Typed numbers of vertices, faces and obstacles.
//!
//! A body renumbers its vertices and faces, so that the numbers may differ from those of the input. Answers, and
//! mappings between the two numberings, use these types. Plain `u32` are used in these places:
//!
//! - Constructors of bodies: a corner of a face is an index into the vertices passed to the same constructor.
//! - `Solid::triangles`, `ConvexPolyhedron::face_vertices` and `HalfEdge`: vertices, faces and half-edges have
//!   the numbers of the body.
//! - Methods of `ConvexPolyhedron` with a parameter `face` or `vertex`: it is the number in the body.
//! - `Solid::face_numbers`: the values are those of `FaceId`.

use std::fmt;

macro_rules! typed_numbers {
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
            /// Returns the number as an index into a slice.
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

typed_numbers! {
    /// A vertex of a body after construction: its index in `ConvexPolyhedron::vertices` or `Solid::vertices`.
    VertexId;
    /// A face as named by a `Feature`: the number of a face of a convex polyhedron, or the smallest number of
    /// the input facets that form a face of a solid.
    FaceId;
    /// A point or mesh vertex of the input, by its index there.
    InputVertex;
    /// A facet of the input mesh of a `Solid`, by its index there. Each triangle of the body
    /// (`Solid::triangles`) is a part of one facet.
    InputFacet;
}

/// A body of `Obstacles`: the number of its insertion, counted from 0. It stays valid after any other
/// insertion, move or removal, and is never reused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(transparent))]
pub struct ObstacleId(pub u64);

impl fmt::Display for ObstacleId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}
