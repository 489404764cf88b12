//! Records of removal paths.

use serde::Serialize;

use super::record;
use colltrans_removal::ways::{Searched, WaysOut};

record! {
    /// Removal path in several moves, a proof that none exists, or the work of a search without a result.
    /// Fields that do not apply are omitted.
    #[non_exhaustive]
    pub struct WaysRecord {
        /// - `found`: the record has a path.
        /// - `none`: it is proven that no sequence of translations exists.
        /// - `not_found`: the search found no path, which proves nothing.
        pub outcome: &'static str,
        /// Moves in order.
        pub legs: Vec<LegRecord>,
        /// Tolerance in use, a length.
        pub tolerance: Option<f64>,
        /// Number of displacement cells of the proof that no path exists.
        pub cells: Option<usize>,
        /// Amounts of work of the search.
        pub searched: Option<Searched>,
    }
}

/// Straight move.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LegRecord {
    /// Direction of length 1.
    pub direction: [f64; 3],
    /// Length of the move; infinite for the last one, which nothing blocks.
    #[serde(serialize_with = "colltrans_kernel::written::or_infinite::serialize")]
    pub travel: f64,
}

impl WaysRecord {
    /// Converts an answer about two bodies.
    pub fn of(ways: &WaysOut) -> Self {
        match ways {
            WaysOut::Found(way) => {
                let leg = |leg: &colltrans_removal::ways::Leg| LegRecord {
                    direction: leg.direction.to_array(),
                    travel: leg.travel,
                };
                let legs = way.legs.iter().map(leg).collect();
                let (tolerance, searched) = (Some(way.tolerance), Some(way.searched));
                Self { outcome: "found", legs, tolerance, searched, ..Self::default() }
            }
            WaysOut::Proven(proof) => {
                let (tolerance, cells) = (Some(proof.tolerance), Some(proof.cells()));
                Self { outcome: "none", tolerance, cells, ..Self::default() }
            }
            WaysOut::NotFound { searched } => {
                let (outcome, searched) = ("not_found", Some(*searched));
                Self { outcome, searched, ..Self::default() }
            }
        }
    }
}
