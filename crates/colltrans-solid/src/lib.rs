//! Solids that need not be convex: bodies, their casts and distances, and the proofs.
//!
//! [`Solid`] is a body that `colltrans_convex::Cast` and `Pair` accept as they accept a convex polyhedron; what only
//! solids answer are the methods of [`SolidCast`] and [`SolidPair`]. [`AnyBody`] is a body of either kind.
//!
//! The modules, each using only those before it: [`body`] (surfaces and their trees), [`solve`] (the search), [`cast`] and
//! [`pair`] (the questions), [`kinds`] (bodies and answers of either kind).
//!
//! In `body`, `validate` makes a checked surface, `shells` its parts, `tree` a tree of boxes; `shrink` (facets moved inwards)
//! and `self_intersection` (thin walls) follow when first asked for. In `solve`, `scene` is the setting of two solids,
//! `overlap` asks about the start, `thin` has points and segments, `fan` the facets around a vertex, `leaf` asks about two
//! facets, `search` goes best first through both trees, `separate` looks for a plane between the bodies along the direction,
//! `parted` for one anywhere; `nearest` is the distance. In `cast`, `boxes` tell what passes, `hulls` what is convex,
//! `tolerance` finds the least tolerance, `proof` and `verify` make and check proofs.

#![allow(
    rustdoc::private_intra_doc_links,
    reason = "hidden modules are read with their private parts"
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
pub mod solve;

/// Proofs of answers between solids: what they hold, and why a pair of nodes matters no more.
pub mod proof {
    pub use crate::cast::{Claim, Cover, SolidCertificate, SolidProof, StartProof, StopProof};
    pub use crate::pair::{DistanceCertificate, SolidPairProof};
    pub use crate::solve::{Apart, Reason};
}

pub use body::{AsSolid, Shell, ShellKind, ShrinkReport, Solid, SolidError, SolidReport};
#[doc(hidden)]
pub use cast::SolidScene;
pub use cast::{
    NoGrazing, SolidCast, SolidFree, SolidMeeting, SolidOptions, SolidOverlap, StartOverlap,
};
pub use kinds::{AnyBody, AnyClearance, AnyDistance, AnyNear, AnyPlaced, ByKind};
#[doc(hidden)]
pub use pair::SolidPairSearch;
pub use pair::{OverlapDepth, SolidPair};
pub use solve::{Overlap, SolidContact, SolidGap, SolidNear, SolidSteps, Workspace};
