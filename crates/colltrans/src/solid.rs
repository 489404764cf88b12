//! What is of solids alone: the answers, proofs and choices of a [`Cast`](crate::Cast) of
//! [`Solid`](crate::Solid)s, and what is said of their surfaces.

#[doc(inline)]
pub use colltrans_convex::solid::*;
#[cfg(feature = "json")]
#[doc(inline)]
pub use colltrans_proof::SolidStatement;
