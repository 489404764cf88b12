//! The answer of a cast as the page reads it: the record of the library, and data for the page alone.

use colltrans::record::ClearanceRecord;
#[cfg(feature = "min-gap")]
use colltrans::solid::SolidCertificate;
use colltrans::{Certificate, Separation};
use serde::{Deserialize, Serialize};

use crate::highlight::ContactHighlight;

/// An answer to `cast`. Fields that do not apply are omitted.
#[derive(Serialize)]
pub(crate) struct CastAnswer<R> {
    /// The kind of the bodies: `convex` or `solid`.
    pub(crate) kind: &'static str,
    /// The contacts of convex bodies, or the clearance of solids.
    pub(crate) record: R,
    /// The clearance of convex bodies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) clearance: Option<ClearanceRecord>,
    /// The features in contact.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) lit: Option<ContactHighlight>,
    /// The proof of the answer; for solids only a short one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) proof: Option<Proof>,
    /// The precision of the files of solids, a length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) precision: Option<f64>,
}

/// A proof that the page can hand back for a check.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Proof {
    Contact(Certificate),
    Separation(Separation),
    /// A proof between solids.
    #[cfg(feature = "min-gap")]
    Clearance(SolidCertificate),
}
