//! A body with its motion.

use std::borrow::Cow;

use derive_where::derive_where;

use crate::body::{ConvexPolyhedron, Placed};
use colltrans_kernel::motion::Motion;

/// A body and its motion, from [`ConvexPolyhedron::with_motion`](crate::ConvexPolyhedron::with_motion).
#[derive(Debug)]
#[derive_where(Clone)]
pub struct Moving<'a, B = crate::ConvexPolyhedron> {
    /// The body.
    pub body: &'a B,
    /// The motion of the body frame.
    pub motion: Cow<'a, Motion>,
}

impl ConvexPolyhedron {
    /// Pairs this body with a motion, for a cast of bodies that turn.
    pub fn with_motion<'a>(&'a self, motion: &'a Motion) -> Moving<'a> {
        Moving { body: self, motion: Cow::Borrowed(motion) }
    }
}

impl<'a, B> From<Placed<'a, B>> for Moving<'a, B> {
    fn from(placed: Placed<'a, B>) -> Self {
        Self { body: placed.body, motion: Cow::Owned(Motion::at_rest(placed.pose)) }
    }
}
