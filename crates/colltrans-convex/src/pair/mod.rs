//! Two placed bodies and no direction: how far apart they are, how deep they overlap.

mod convex;
pub mod solid;
mod verify;

use crate::answer::{Depth, NearPoints, PlaneGap, checked_as};
use crate::body::{Body, ConvexPolyhedron, Placed, Pose};
use crate::setting::TwoBodies;
use crate::setting::error::QueryError;
pub use convex::distance_from;
pub use convex::points;
use derive_where::derive_where;

/// A moving body and a fixed one, where they are: what is asked of both and no direction. Nothing moves;
/// the names tell them apart, as in a [`Cast`](crate::Cast).
///
/// Made once, asked as often as one likes: nothing is searched before a question is asked.
#[derive(Debug)]
#[derive_where(Clone, Copy)]
pub struct Pair<'a, B: Body = ConvexPolyhedron> {
    #[doc(hidden)]
    pub bodies: TwoBodies<'a, B>,
}

/// A proof to check about two convex bodies where they are.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum PairProof<'a> {
    /// That they are not nearer to each other than a number.
    Gap(&'a PlaneGap),
    /// That they are not farther from each other than a number.
    Near(&'a NearPoints),
    /// Both bounds of a depth.
    Depth(&'a Depth),
}

checked_as!(PairProof { Gap(PlaneGap), Near(NearPoints), Depth(Depth) });

impl<'a, B: Body> Pair<'a, B> {
    /// Of two placed bodies.
    ///
    /// # Errors
    /// None today: what a body and a pose admit, a pair does.
    #[inline]
    pub fn new(moving: Placed<'a, B>, fixed: Placed<'a, B>) -> Result<Self, QueryError> {
        Ok(Self { bodies: TwoBodies::new(moving, fixed) })
    }

    /// The moving body.
    pub fn moving(&self) -> &'a B {
        self.bodies.moving
    }

    /// The fixed body.
    pub fn fixed(&self) -> &'a B {
        self.bodies.fixed
    }

    /// Where the moving body is.
    pub fn moving_pose(&self) -> Pose {
        self.bodies.moving_placed().pose
    }

    /// Where the fixed body is.
    pub fn fixed_pose(&self) -> Pose {
        self.bodies.fixed_placed().pose
    }
}
