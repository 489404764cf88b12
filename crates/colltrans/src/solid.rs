//! Items for solids only: the answers, proofs and options of a [`Cast`](crate::Cast) of `Solid`s, and reports
//! on their surfaces.

#[cfg(feature = "json")]
#[doc(inline)]
pub use colltrans_proof::SolidStatement;
#[doc(inline)]
pub use colltrans_solid::proof::{
    Apart, Claim, CommonNode, CommonPartCertificate, CommonPartError, Cover, DepthCertificate,
    DistanceCertificate, InnerCore, NodeFault, ProvenRelation, Reason, SolidCertificate,
    SolidPairProof, SolidProof, StartProof, StopProof,
};
#[doc(inline)]
pub use colltrans_solid::{
    AsSolid, CommonPart, InnerPair, NoGrazing, Overlap, OverlapDepth, PreparedPair, Relation,
    Shell, ShellKind, ShrinkReport, SignedDistance, SignedDistanceError, SolidCast, SolidContact,
    SolidDepth, SolidError, SolidFree, SolidGap, SolidIntersection, SolidNear, SolidOptions,
    SolidOverlap, SolidPair, SolidPenetration, SolidReport, SolidSteps, StartOverlap,
    SurfaceDistance, VolumeOptions, Workspace,
};
#[doc(hidden)]
pub use colltrans_solid::{SolidPairSearch, SolidScene};
