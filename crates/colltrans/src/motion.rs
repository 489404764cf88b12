//! Bodies that turn: when do two of them first touch?
//!
//! A [`Motion`] says where a body is at every time from 0 to 1: it slides, turns, unscrews, is thrown, or
//! goes through poses. A [`MotionCast`] answers when two such bodies first meet, with bounds on that time
//! that are bounds, or proves that they never do. `colltrans_motion` says how.
//!
//! ```
//! use colltrans::glam::DVec3;
//! use colltrans::motion::{Motion, MotionCast, MotionOutcome};
//! use colltrans::{ConvexPolyhedron, Pose};
//!
//! // A plank, 2 long, turns by half a turn about its middle; a post stands 0.8 to the side of it.
//! let plank = ConvexPolyhedron::cuboid(DVec3::new(-1.0, -0.1, 0.0), DVec3::new(1.0, 0.1, 0.1))?;
//! let post = ConvexPolyhedron::cuboid(DVec3::new(-0.1, 0.8, -1.0), DVec3::new(0.1, 1.0, 1.0))?;
//! let turn = Motion::turn(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, std::f64::consts::PI)?;
//!
//! let cast = MotionCast::new(plank.along(&turn), post.at(Pose::IDENTITY))?;
//! let MotionOutcome::Contact(contact) = cast.first_contact()? else { panic!("no contact") };
//! assert!(0.3 < contact.lower && contact.lower <= contact.upper && contact.upper < 0.5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#[doc(inline)]
pub use colltrans_motion::*;
#[cfg(feature = "json")]
#[doc(inline)]
pub use colltrans_proof::{MotionCase, MotionStatement, SolidMotionStatement};

/// Paths of joints: when do bodies of a mechanism first meet?
pub mod path {
    #[doc(inline)]
    pub use colltrans_motion::path::*;
    #[cfg(feature = "json")]
    #[doc(inline)]
    pub use colltrans_proof::PathStatement;
}
