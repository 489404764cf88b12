//! A query as a file, exact in bits.

use thiserror::Error;

/// Why a file is no query.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum CaseError {}
