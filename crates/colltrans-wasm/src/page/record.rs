//! The record of a cast as the page takes it: that of the library, and what only a page needs.

use colltrans::record::{ClearanceRecord, Record};
use colltrans::solid::SolidCertificate;
use colltrans::{Certificate, Separation};
use serde::{Deserialize, Serialize};

use crate::lit::Touching;

/// An answer to `cast`; fields that do not apply are left out.
#[derive(Serialize)]
pub(crate) struct CastAnswer {
    /// How the bodies were taken: `convex` or `solid`.
    pub(crate) kind: &'static str,
    /// Between convex bodies of when they meet, between solids of how far the moving one can go.
    pub(crate) record: Record,
    /// Between convex bodies: how far the moving one can go.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) clearance: Option<ClearanceRecord>,
    /// What touches.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) lit: Option<Touching>,
    /// Of the answer; between solids only where it is short.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) proof: Option<Proof>,
    /// Of the files of solids: a length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) precision: Option<f64>,
}

/// What anyone can check.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Proof {
    Contact(Certificate),
    Separation(Separation),
    /// Between solids.
    Clearance(SolidCertificate),
}
