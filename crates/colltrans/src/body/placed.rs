//! A body and where it stands.

use std::fmt::Debug;

use super::{ConvexPolyhedron, Pose};

/// What queries can be asked about: a [`ConvexPolyhedron`] or a
/// [`Solid`](crate::Solid). Sealed.
pub trait Body: sealed::Sealed {
    /// The choices of a query about two such bodies.
    type Options: Copy + Default + Debug;
    /// What is said of the contact that stops it.
    type Contact: Copy + Debug + PartialEq;
    /// What is said where nothing stops it.
    type Free: Copy + Debug + PartialEq;
    /// What is said of an overlap.
    type Overlap: Copy + Debug + PartialEq;
}

pub(crate) mod sealed {
    /// Bodies are those of this crate.
    pub trait Sealed {}
}

impl sealed::Sealed for ConvexPolyhedron {}

/// A body placed in the world, from [`ConvexPolyhedron::at`].
#[derive(Debug)]
pub struct Placed<'a, B = ConvexPolyhedron> {
    /// The body.
    pub body: &'a B,
    /// Where it is.
    pub pose: Pose,
}

// Derived ones would ask the same of the body.
impl<B> Clone for Placed<'_, B> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<B> Copy for Placed<'_, B> {}

impl ConvexPolyhedron {
    /// This body in a pose, for a [`Cast`](crate::Cast).
    #[inline]
    pub fn at(&self, pose: Pose) -> Placed<'_> {
        Placed { body: self, pose }
    }
}
