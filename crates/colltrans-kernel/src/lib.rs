//! What every body and every search needs: numbers and the bounds of their rounding errors, decisions that rounding
//! cannot make, poses and motions, boxes, and how things are numbered and named.
//!
//! In the order of use: [`range`] (the numbers that are accepted), [`error_free`], [`double`] and [`integer`] (exact
//! arithmetic), [`predicates`] and [`orientation`] (signs), [`noise`] (bounds of rounding errors), [`fine`] (numbers of
//! twice the precision with bounds), [`bounded`], [`pose`] and [`motion`], [`aabb`], [`split`], [`dynamic_tree`] and
//! [`descent`] (boxes, how trees of them are built, one that changes, and searches down two of them), [`plane_tree`],
//! [`topology`] (half-edges without coordinates), [`kept`] (what is made once with a body), [`id`], [`written`].

#![allow(
    rustdoc::private_intra_doc_links,
    reason = "hidden modules are read with their private parts"
)]

pub mod aabb;
#[doc(hidden)]
pub mod angle;
#[doc(hidden)]
pub mod bounded;
#[doc(hidden)]
pub mod descent;
#[doc(hidden)]
pub mod determinant;
mod double;
#[doc(hidden)]
pub mod dynamic_tree;
pub mod error;
#[doc(hidden)]
pub mod error_free;
#[doc(hidden)]
pub mod extent;
#[doc(hidden)]
pub mod fine;
pub mod id;
#[doc(hidden)]
pub mod integer;
#[doc(hidden)]
pub mod kept;
pub mod motion;
#[doc(hidden)]
pub mod noise;
#[doc(hidden)]
pub mod orientation;
#[doc(hidden)]
pub mod plane;
#[doc(hidden)]
pub mod plane_tree;
pub mod pose;
#[doc(hidden)]
pub mod predicates;
#[doc(hidden)]
pub mod range;
#[doc(hidden)]
pub mod real;
#[doc(hidden)]
pub mod split;
#[doc(hidden)]
pub mod symmetric;
#[doc(hidden)]
pub mod topology;
#[doc(hidden)]
pub mod volume;
#[doc(hidden)]
pub mod work;
#[doc(hidden)]
pub mod written;

pub use aabb::Aabb;
pub use error::{MotionError, PoseError};
pub use id::{FaceId, InputFacet, InputVertex, ObstacleId, VertexId};
pub use pose::Pose;

#[cfg(test)]
mod tests {
    //! Numbers for the tests of this crate.

    use dashu_ratio::RBig;
    use glam::DVec3;
    use proptest::prelude::*;

    pub(crate) fn rational(x: f64) -> RBig {
        RBig::try_from(x).unwrap()
    }

    /// Numbers of very different size, zero and ties among them.
    pub(crate) fn number() -> impl Strategy<Value = f64> {
        prop_oneof![
            Just(0.0),
            (-4_i32..=4).prop_map(f64::from),
            -1.0..1.0_f64,
            (-1.0..1.0_f64, -180_i32..180).prop_map(|(x, e)| x * 2.0_f64.powi(e)),
        ]
    }

    pub(crate) fn vector() -> impl Strategy<Value = DVec3> {
        [number(), number(), number()].prop_map(DVec3::from_array)
    }
}
