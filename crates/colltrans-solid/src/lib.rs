//! What is of solids alone: the answers, proofs and choices of a [`Cast`](crate::Cast) of
//! [`Solid`](crate::Solid)s, and what is said of their surfaces.

pub use crate::body::solid::{AsSolid, Shell, ShellKind, ShrinkReport, SolidError, SolidReport};
pub use crate::cast::solid::{
    Claim, Cover, NoGrazing, SolidCast, SolidCertificate, SolidFree, SolidMeeting, SolidOptions,
    SolidOverlap, SolidProof, SolidScene, StartOverlap, StartProof, StopProof,
};
pub use crate::pair::solid::{
    DistanceCertificate, OverlapDepth, SolidPair, SolidPairProof, SolidPairSearch,
};
pub use crate::solve::solid::{
    Apart, Overlap, Reason, SolidContact, SolidGap, SolidNear, SolidSteps, Workspace,
};
