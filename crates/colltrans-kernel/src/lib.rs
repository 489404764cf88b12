//! Arithmetic, geometry and data structures that all bodies and all searches use.
//!
//! - Exact arithmetic: [`range`] (accepted numbers), [`error_free`], [`double`], [`real`], [`integer`],
//!   [`big`], [`extended`].
//! - Signs: [`predicates`], [`orientation`], [`volume`].
//! - Bounds on rounding errors: [`noise`], [`height_bounds`], [`bounded`].
//! - Placement: [`angle`], [`pose`], [`motion`].
//! - Linear algebra: [`determinant`], [`plane`], [`symmetric`].
//! - Boxes and trees: [`aabb`], [`split`], [`dynamic_tree`], [`descent`], [`plane_tree`].
//! - Bodies: [`topology`] (half-edges), [`derived`] (cached derived data), [`id`] (typed numbers).
//! - Text and tests: [`error`], [`serialization`], [`visit_counter`].

#![allow(rustdoc::private_intra_doc_links, reason = "hidden modules document their private items")]

pub mod aabb;
#[doc(hidden)]
pub mod angle;
#[doc(hidden)]
pub mod big;
pub mod bounded;
#[doc(hidden)]
pub mod derived;
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
pub mod extended;
#[doc(hidden)]
pub mod height_bounds;
pub mod id;
#[doc(hidden)]
pub mod integer;
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
pub mod serialization;
#[doc(hidden)]
pub mod split;
#[doc(hidden)]
pub mod symmetric;
#[doc(hidden)]
pub mod topology;
#[doc(hidden)]
pub mod visit_counter;
#[doc(hidden)]
pub mod volume;

pub use aabb::Aabb;
pub use error::{MotionError, PoseError};
pub use id::{FaceId, InputFacet, InputVertex, ObstacleId, VertexId};
pub use pose::Pose;

#[cfg(test)]
mod tests {
    //! Random numbers for the tests of this crate.

    use dashu_ratio::RBig;
    use glam::DVec3;
    use proptest::prelude::*;

    pub(crate) fn rational(x: f64) -> RBig {
        RBig::try_from(x).unwrap()
    }

    /// Numbers of very different magnitudes, with zeros and ties.
    pub(crate) fn any_number() -> impl Strategy<Value = f64> {
        prop_oneof![
            Just(0.0),
            (-4_i32..=4).prop_map(f64::from),
            -1.0..1.0_f64,
            (-1.0..1.0_f64, -180_i32..180).prop_map(|(x, e)| x * 2.0_f64.powi(e)),
        ]
    }

    pub(crate) fn any_vector() -> impl Strategy<Value = DVec3> {
        [any_number(), any_number(), any_number()].prop_map(DVec3::from_array)
    }
}
