//! Ways out in several moves, as front ends write them.

use serde::Serialize;

use super::record;
use colltrans_removal::ways::{Searched, WaysOut};

record! {
    /// A way out in several moves, that there is none, or what was searched. Fields that do not apply are left out.
    #[non_exhaustive]
    pub struct WaysRecord {
        /// `found`; `none`: there is none by translations, which is proven; `not_found`, which proves nothing.
        pub outcome: &'static str,
        /// What to do, in order.
        pub legs: Vec<LegRecord>,
        /// The tolerance that was used, a length.
        pub tolerance: Option<f64>,
        /// Cells of displacements that prove that there is none.
        pub cells: Option<usize>,
        /// What was searched.
        pub searched: Option<Searched>,
    }
}

/// A straight move.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LegRecord {
    /// Of length 1.
    pub direction: [f64; 3],
    /// How far; nothing stops the last one.
    #[serde(serialize_with = "colltrans_kernel::written::or_infinite::serialize")]
    pub travel: f64,
}

impl WaysRecord {
    /// Of two bodies.
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
