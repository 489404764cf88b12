//! What is of solids alone: the answers, proofs and choices of a [`Cast`](crate::Cast) of
//! `Solid`s, and what is said of their surfaces.

#[cfg(feature = "json")]
#[doc(inline)]
pub use colltrans_proof::SolidStatement;
#[doc(inline)]
pub use colltrans_solid::{
    Apart, AsSolid, Claim, Cover, DistanceCertificate, NoGrazing, Overlap, OverlapDepth, Reason,
    Shell, ShellKind, ShrinkReport, SolidCast, SolidCertificate, SolidContact, SolidError,
    SolidFree, SolidGap, SolidMeeting, SolidNear, SolidOptions, SolidOverlap, SolidPair,
    SolidPairProof, SolidProof, SolidReport, SolidSteps, StartOverlap, StartProof, StopProof,
    Workspace,
};
#[doc(hidden)]
pub use colltrans_solid::{SolidPairSearch, SolidScene};
