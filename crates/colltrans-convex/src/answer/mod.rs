//! Answers of queries, and the checks of their proofs.

mod certificate;
mod clearance;
mod distance;
mod outcome;
mod range;
mod steps;

#[doc(hidden)]
pub use certificate::impl_from_proofs;
pub use certificate::{Certificate, CertificateError, Proof, Separation};
pub use certificate::{NormalBound, are_weights, check_lateral_normal, gap_rounding, shadow_gap};
pub use clearance::{Clearance, FreeReason, OverlapAhead};
pub use colltrans_kernel::bounded::{Bounded, RangeEnd};
pub use distance::{Depth, Distance, Enclosure, NearPoints, PlaneGap, Within};
pub use outcome::{Contact, Grazing, Outcome, Separated};
pub use range::{CentralCast, ContactRange, DirectionalDepth, Intersection};
pub use steps::{Solver, StartedFrom, Steps};
