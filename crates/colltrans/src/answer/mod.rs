//! What a query answers, and how anyone checks it.

mod certificate;
mod outcome;
mod range;
mod steps;

pub(crate) use certificate::gap_tolerance;
pub use certificate::{Certificate, CertificateError, Separation};
pub use outcome::{Contact, Grazing, Outcome, Separated};
pub use range::{Clearance, ContactRange};
pub use steps::{Solver, StartedFrom, Steps};
