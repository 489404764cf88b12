//! A body with its pose, and the traits that connect bodies with queries.

use derive_where::derive_where;
use std::fmt::Debug;

use super::{ConvexPolyhedron, Feature, InputVertex, Pose, VertexId};
use crate::answer::RangeEnd;

/// A kind of body that queries accept, with the types of their options and answers: a [`ConvexPolyhedron`] or a
/// `Solid`.
pub trait Body: InputNumbered + Clone + Debug {
    /// Options of a query about two such bodies.
    type Options: Copy + Default + Debug;
    /// Answer for bodies that come into contact.
    type Contact: AnswerPart + RangeEnd;
    /// Answer for bodies that slide along each other, where a query distinguishes this case.
    type Grazing: AnswerPart + RangeEnd;
    /// Answer for bodies that never come into contact.
    type Separated: AnswerPart;
    /// Answer for a motion that nothing stops.
    type Free: AnswerPart;
    /// Answer for bodies that overlap.
    type Overlap: AnswerPart;
    /// Evidence for or against an intersection of the bodies in their poses.
    type Evidence: AnswerPart;
    /// Proof of an upper bound of the distance of two bodies.
    type Near: AnswerPart;
    /// Proof of a lower bound of the distance of two bodies.
    type Gap: AnswerPart;
    /// Amount of work that an answer took.
    type Steps: AnswerPart + Default;
}

impl Feature {
    /// Returns the vertices of the feature by their input numbers. Those of a face are its corners, one loop after
    /// the other, the outer loop first.
    ///
    /// # Panics
    /// If the feature is a face that `body` does not have.
    pub fn vertices<B: Body>(self, body: &B) -> Vec<InputVertex> {
        match self {
            Self::Vertex(v) => vec![v],
            Self::Edge(ends) => ends.to_vec(),
            Self::Face(_) => {
                let own = self.vertex_positions(body);
                own.into_iter().map(|v| body.vertex_inputs()[v.index()]).collect()
            }
        }
    }

    /// Returns the vertices of the feature as positions in [`ConvexPolyhedron::vertices`] or `Solid::vertices`.
    /// Their order is that of [`Self::vertices`].
    ///
    /// # Panics
    /// If `body` does not have the feature.
    pub fn vertex_positions<B: Body>(self, body: &B) -> Vec<VertexId> {
        feature_vertices(body, self)
    }
}

/// Type of a part of an answer.
#[cfg(not(feature = "serde"))]
#[doc(hidden)]
pub trait AnswerPart: Copy + Debug + PartialEq {}

#[cfg(not(feature = "serde"))]
impl<T: Copy + Debug + PartialEq> AnswerPart for T {}

/// Type of a part of an answer, which can be serialised.
#[cfg(feature = "serde")]
#[doc(hidden)]
pub trait AnswerPart:
    Copy + Debug + PartialEq + serde::Serialize + serde::de::DeserializeOwned
{
}

#[cfg(feature = "serde")]
impl<T> AnswerPart for T where
    T: Copy + Debug + PartialEq + serde::Serialize + serde::de::DeserializeOwned
{
}

/// A body that maps its vertices and faces to input numbers.
#[doc(hidden)]
pub trait InputNumbered {
    /// Returns the input number of each vertex of the body.
    fn vertex_inputs(&self) -> &[InputVertex];
    /// Returns the corners of a face as positions among the body's vertices.
    fn face_corner_positions(&self, face: u32) -> Vec<u32>;
}

/// Returns the vertices of a feature as positions among the body's vertices.
fn feature_vertices<B: InputNumbered>(body: &B, feature: Feature) -> Vec<VertexId> {
    let position = |v: InputVertex| {
        let found = body.vertex_inputs().iter().position(|input| *input == v);
        VertexId(found.expect("the feature belongs to this body") as u32)
    };
    match feature {
        Feature::Vertex(v) => vec![position(v)],
        Feature::Edge(ends) => ends.map(position).to_vec(),
        Feature::Face(face) => {
            body.face_corner_positions(face.0).into_iter().map(VertexId).collect()
        }
    }
}

impl InputNumbered for ConvexPolyhedron {
    fn vertex_inputs(&self) -> &[InputVertex] {
        self.input_indices()
    }

    fn face_corner_positions(&self, face: u32) -> Vec<u32> {
        self.face_vertices(face).collect()
    }
}

/// A body placed in the world, from [`ConvexPolyhedron::at`].
#[derive(Debug)]
#[derive_where(Clone, Copy)]
pub struct Placed<'a, B = ConvexPolyhedron> {
    /// The body.
    pub body: &'a B,
    /// Pose of the body frame in the world.
    pub pose: Pose,
}

impl ConvexPolyhedron {
    /// Pairs this body with a pose, for a [`Cast`](crate::Cast).
    #[inline]
    pub fn at(&self, pose: Pose) -> Placed<'_> {
        Placed { body: self, pose }
    }
}
