//! First contact of two bodies that rotate.
//!
//! A [`Motion`] is the pose of a body at every time from 0 to 1: a translation, a rotation, a screw, a throw,
//! or an interpolation of poses. A [`MotionCast`] computes when two such bodies first meet, with proven
//! bounds of that time, or proves that they never do. `colltrans_motion` explains the algorithm.
//!
//! ```
//! use colltrans::glam::DVec3;
//! use colltrans::motion::{Motion, MotionCast, MotionOutcome};
//! use colltrans::{ConvexPolyhedron, Pose};
//!
//! // A plank of length 2 makes half a turn about its center. A post is 0.8 to the side.
//! let plank = ConvexPolyhedron::cuboid(DVec3::new(-1.0, -0.1, 0.0), DVec3::new(1.0, 0.1, 0.1))?;
//! let post = ConvexPolyhedron::cuboid(DVec3::new(-0.1, 0.8, -1.0), DVec3::new(0.1, 1.0, 1.0))?;
//! let turn = Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, std::f64::consts::PI)?;
//!
//! let cast = MotionCast::new(plank.with_motion(&turn), post.at(Pose::IDENTITY))?;
//! let MotionOutcome::Contact(contact) = cast.first_contact()? else { panic!("no contact") };
//! assert!(0.3 < contact.lower && contact.lower <= contact.upper && contact.upper < 0.5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#[doc(inline)]
pub use colltrans_motion::*;
#[cfg(feature = "json")]
#[doc(inline)]
pub use colltrans_proof::{MotionCase, MotionStatement, SolidMotionStatement};

/// Paths of joints, and the first contact of bodies of a mechanism.
pub mod path {
    #[doc(inline)]
    pub use colltrans_motion::path::*;
    #[cfg(feature = "json")]
    #[doc(inline)]
    pub use colltrans_proof::PathStatement;
}
