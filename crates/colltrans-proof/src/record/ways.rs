//! Records of removal paths.

use serde::Serialize;

use super::record;
use colltrans_removal::path::{RemovalSearch, SearchWork};

record! {
    /// Removal path in several moves, a proof that none exists, or the work of a search without a result.
    /// Fields that do not apply are omitted.
    #[non_exhaustive]
    pub struct WaysRecord {
        /// - `found`: the record has a path.
        /// - `none`: it is proven that no sequence of translations separates the bodies.
        /// - `not_found`: the search found no path, which proves nothing.
        pub outcome: &'static str,
        /// Moves in order.
        pub legs: Vec<LegRecord>,
        /// Tolerance in use, a length.
        pub tolerance: Option<f64>,
        /// Number of displacement cells of the proof that no path exists.
        pub cells: Option<usize>,
        /// Amounts of work of the search.
        pub searched: Option<SearchWork>,
    }
}

/// Straight move.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LegRecord {
    /// Direction of length 1.
    pub direction: [f64; 3],
    /// Length of the move; infinite for the last one, which nothing blocks.
    #[serde(serialize_with = "colltrans_kernel::serialization::null_as_infinity::serialize")]
    pub travel: f64,
}

impl WaysRecord {
    /// Converts an answer about two bodies.
    pub fn from_search(ways: &RemovalSearch) -> Self {
        match ways {
            RemovalSearch::Found(way) => {
                let leg = |leg: &colltrans_removal::path::Leg| LegRecord {
                    direction: leg.direction.to_array(),
                    travel: leg.travel,
                };
                let legs = way.legs.iter().map(leg).collect();
                let (tolerance, searched) = (Some(way.tolerance), Some(way.searched));
                Self { outcome: "found", legs, tolerance, searched, ..Self::default() }
            }
            RemovalSearch::Proven(proof) => {
                let (tolerance, cells) = (Some(proof.tolerance), Some(proof.cell_count()));
                Self { outcome: "none", tolerance, cells, ..Self::default() }
            }
            RemovalSearch::NotFound { searched } => {
                let (outcome, searched) = ("not_found", Some(*searched));
                Self { outcome, searched, ..Self::default() }
            }
        }
    }
}
