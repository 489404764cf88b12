//! A body and where it stands.

use derive_where::derive_where;
use std::fmt::Debug;

use super::{ConvexPolyhedron, Feature, InputVertex, Pose, VertexId};
use crate::answer::RangeEnd;

/// A kind of body that queries can be asked about, and what their answers consist of: a [`ConvexPolyhedron`] or a
/// `Solid`.
pub trait Body: Numbered + Clone + Debug {
    /// The choices of a query about two such bodies.
    type Options: Copy + Default + Debug;
    /// What is said of a contact.
    type Contact: Told + RangeEnd;
    /// What is said of bodies that slide along each other, where a query tells.
    type Grazing: Told + RangeEnd;
    /// What is said of bodies that never meet.
    type Separated: Told;
    /// What is said where nothing stops it.
    type Free: Told;
    /// What is said of an overlap.
    type Overlap: Told;
    /// What shows whether the bodies meet where they are.
    type Evidence: Told;
    /// What proves that two bodies are not farther from each other than a number.
    type Near: Told;
    /// What proves that they are not nearer to each other.
    type Gap: Told;
    /// How much work an answer was.
    type Steps: Told + Default;
}

impl Feature {
    /// The vertices of the feature, by their numbers in the input; those of a face are its corners, one
    /// loop after the other, the outer one first.
    ///
    /// # Panics
    /// If the feature is not one of `body`.
    pub fn vertices<B: Body>(self, body: &B) -> Vec<InputVertex> {
        match self {
            Self::Vertex(v) => vec![v],
            Self::Edge(ends) => ends.to_vec(),
            Self::Face(_) => {
                let own = self.own_vertices(body);
                own.into_iter().map(|v| body.inputs()[v.index()]).collect()
            }
        }
    }

    /// The same vertices, as positions among the vertices that the body has kept:
    /// [`ConvexPolyhedron::vertices`] or `Solid::vertices`.
    ///
    /// # Panics
    /// If the feature is not one of `body`.
    pub fn own_vertices<B: Body>(self, body: &B) -> Vec<VertexId> {
        feature_vertices(body, self)
    }
}

/// A part of an answer.
#[cfg(not(feature = "serde"))]
#[doc(hidden)]
pub trait Told: Copy + Debug + PartialEq {}

#[cfg(not(feature = "serde"))]
impl<T: Copy + Debug + PartialEq> Told for T {}

/// A part of an answer.
#[cfg(feature = "serde")]
#[doc(hidden)]
pub trait Told: Copy + Debug + PartialEq + serde::Serialize + serde::de::DeserializeOwned {}

#[cfg(feature = "serde")]
impl<T> Told for T where T: Copy + Debug + PartialEq + serde::Serialize + serde::de::DeserializeOwned
{}

/// Names the vertices of a body's features as the input does.
#[doc(hidden)]
pub trait Numbered {
    /// For each vertex of the body its number in the input.
    fn inputs(&self) -> &[InputVertex];
    /// The corners of a face, as positions among the body's vertices.
    fn corners_of_face(&self, face: u32) -> Vec<u32>;
}

/// The vertices of a feature, as positions among the body's vertices.
fn feature_vertices<B: Numbered>(body: &B, feature: Feature) -> Vec<VertexId> {
    let position = |v: InputVertex| {
        let found = body.inputs().iter().position(|input| *input == v);
        VertexId(found.expect("a feature of this body") as u32)
    };
    match feature {
        Feature::Vertex(v) => vec![position(v)],
        Feature::Edge(ends) => ends.map(position).to_vec(),
        Feature::Face(face) => body.corners_of_face(face.0).into_iter().map(VertexId).collect(),
    }
}

impl Numbered for ConvexPolyhedron {
    fn inputs(&self) -> &[InputVertex] {
        self.input_indices()
    }

    fn corners_of_face(&self, face: u32) -> Vec<u32> {
        self.face_vertices(face).collect()
    }
}

/// A body placed in the world, from [`ConvexPolyhedron::at`].
#[derive(Debug)]
#[derive_where(Clone, Copy)]
pub struct Placed<'a, B = ConvexPolyhedron> {
    /// The body.
    pub body: &'a B,
    /// Where it is.
    pub pose: Pose,
}

impl ConvexPolyhedron {
    /// This body in a pose, for a [`Cast`](crate::Cast).
    #[inline]
    pub fn at(&self, pose: Pose) -> Placed<'_> {
        Placed { body: self, pose }
    }
}
