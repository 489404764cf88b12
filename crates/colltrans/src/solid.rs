//! What is of solids alone: the answers, proofs and choices of a [`Cast`](crate::Cast) of
//! `Solid`s, and what is said of their surfaces.

#[cfg(feature = "json")]
#[doc(inline)]
pub use colltrans_proof::SolidStatement;
#[doc(inline)]
pub use colltrans_solid::*;
