//! Solids that need not be convex: bodies, casts, distances and proofs.
//!
//! `colltrans_convex::Cast` and `Pair` accept a [`Solid`] as they accept a convex polyhedron. Queries that only
//! solids answer are methods of [`SolidCast`] and [`SolidPair`]. [`AnyBody`] is a body of either kind. The modules,
//! in the order of dependence:
//! - [`body`]: surfaces (`validate`, `shells`), trees of boxes (`tree`), offsets (`shrink`) and thin walls
//!   (`self_intersection`)
//! - [`solve`]: the search between two placed solids, separating planes (`separate`, `parted`) and distances
//!   (`nearest`)
//! - [`cast`]: clearance by boxes and convex hulls, least tolerances, proofs and their verification
//! - [`pair`]: distances and their proofs
//! - [`penetration`]: distances of nested surfaces, signed distances of points, common parts, depths
//! - [`kinds`]: bodies and answers of either kind

#![allow(
    rustdoc::private_intra_doc_links,
    reason = "the docs of hidden modules link to private items"
)]

#[doc(hidden)]
pub mod body;
#[doc(hidden)]
pub mod cast;
#[doc(hidden)]
pub mod kinds;
#[doc(hidden)]
pub mod pair;
#[doc(hidden)]
pub mod penetration;
#[doc(hidden)]
pub mod solve;

/// Proofs of answers for solids: their entries, and the reasons why a pair of nodes is dismissed.
pub mod proof {
    pub use crate::cast::{Claim, Cover, SolidCertificate, SolidProof, StartProof, StopProof};
    pub use crate::pair::{DistanceCertificate, SolidPairProof};
    pub use crate::penetration::{
        CommonNode, CommonPartCertificate, CommonPartError, DepthCertificate, InnerCore, NodeFault,
        ProvenRelation,
    };
    pub use crate::solve::{Apart, Reason};
}

pub use body::{AsSolid, Shell, ShellKind, ShrinkReport, Solid, SolidError, SolidReport};
#[doc(hidden)]
pub use cast::SolidScene;
pub use cast::{
    NoGrazing, SolidCast, SolidFree, SolidIntersection, SolidOptions, SolidOverlap, StartOverlap,
};
pub use kinds::{AnyBody, AnyClearance, AnyDistance, AnyNear, AnyPlaced, ByKind};
#[doc(hidden)]
pub use pair::SolidPairSearch;
pub use pair::{OverlapDepth, SolidPair};
pub use penetration::{
    CommonPart, InnerPair, PreparedPair, Relation, SignedDistance, SignedDistanceError, SolidDepth,
    SolidPenetration, SurfaceDistance, VolumeOptions,
};
pub use solve::{Overlap, SolidContact, SolidGap, SolidNear, SolidSteps, Workspace};
