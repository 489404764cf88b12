//! Judges solids.
//!
//! - Bodies of cubes, whose exact answers follow without facets ([`cells`]), and the same for open surfaces of
//!   squares ([`squares`], [`sheets`]).
//! - The rule over all pairs of facets in exact arithmetic ([`facets`]), and proofs in rational arithmetic
//!   ([`proof`]).
//! - Common parts and depths ([`depth`]), also of unions of pieces that overlap ([`unions`]), by cubes.
//! - Distances over all pairs of facets ([`nearest`]), casts with a minimum gap ([`min_gap`]), free directions
//!   ([`free`]), first contacts of rotating solids ([`turning`]), and settings with many ties ([`settings`]).

pub mod cells;
mod convex;
pub mod depth;
pub mod facets;
pub mod free;
pub mod min_gap;
pub mod nearest;
pub mod proof;
pub mod settings;
pub mod sheets;
pub mod squares;
pub mod turning;
pub mod unions;

use colltrans::solid::SolidCast;
use colltrans::{Bounded, Cast, Pose, Solid};
use glam::DVec3;

use crate::oracle::exact::Ratio;
pub use convex::as_solids;
pub use settings::MotionOutcome;

/// Builds the cast of two solids without a tolerance.
pub(crate) fn exactly(
    [a, b]: [&Solid; 2],
    poses: [Pose; 2],
    direction: DVec3,
) -> Result<Cast<'_, Solid>, String> {
    Cast::new(a.at(poses[0]), b.at(poses[1]), direction)
        .and_then(|cast| cast.with_tolerance(0.0))
        .map_err(|e| e.to_string())
}

/// Checks whether an exact number and the estimate are between the bounds.
pub(crate) fn encloses(found: &Bounded, right: &Ratio) -> bool {
    let Bounded { value, lower, upper } = *found;
    lower <= value
        && value <= upper
        && Ratio::from_f64(lower) <= *right
        && (upper == f64::INFINITY || *right <= Ratio::from_f64(upper))
}
