//! Ways out in several moves, as front ends write them.

use serde::Serialize;

use colltrans_removal::ways::{Searched, WaysOut};

/// A way out in several moves, that there is none, or what was searched. Fields that do not apply are left out.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct WaysRecord {
    /// `found`; `none`: there is none by translations, which is proven; `not_found`, which proves nothing.
    pub outcome: &'static str,
    /// What to do, in order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub legs: Vec<LegRecord>,
    /// The tolerance that was used, a length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// Cells of displacements that prove that there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cells: Option<usize>,
    /// What was searched.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub searched: Option<Searched>,
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
        let none = Self {
            outcome: "not_found",
            legs: Vec::new(),
            tolerance: None,
            cells: None,
            searched: None,
        };
        match ways {
            WaysOut::Found(way) => {
                let leg = |leg: &colltrans_removal::ways::Leg| LegRecord {
                    direction: leg.direction.to_array(),
                    travel: leg.travel,
                };
                let legs = way.legs.iter().map(leg).collect();
                let (tolerance, searched) = (Some(way.tolerance), Some(way.searched));
                Self { outcome: "found", legs, tolerance, searched, ..none }
            }
            WaysOut::Proven(proof) => {
                let (tolerance, cells) = (Some(proof.tolerance), Some(proof.cells()));
                Self { outcome: "none", tolerance, cells, ..none }
            }
            WaysOut::NotFound { searched } => Self { searched: Some(*searched), ..none },
        }
    }
}
