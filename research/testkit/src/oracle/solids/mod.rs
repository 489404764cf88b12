//! What solids are judged by: bodies of cubes, whose motions are known without facets ([`cells`]), the
//! rule over all pairs of facets in exact arithmetic ([`facets`]), proofs judged in fractions
//! ([`proof`]), distances over all pairs of facets ([`nearest`]), casts that keep a gap ([`keep`]), free directions ([`free`]), first contacts of
//! what turns ([`turning`]), and settings full of ties ([`settings`]); the same for open surfaces, bodies of cubes
//! and of squares ([`squares`], [`sheets`]).

pub mod cells;
mod convex;
pub mod facets;
pub mod free;
pub mod keep;
pub mod nearest;
pub mod proof;
pub mod settings;
pub mod sheets;
pub mod squares;
pub mod turning;

use colltrans::solid::SolidCast;
use colltrans::{Bounded, Cast, Pose, Solid};
use glam::DVec3;

use crate::oracle::exact::Ratio;
pub use convex::as_solids;
pub use settings::Seen;

/// The query between two solids as they are, without a tolerance.
pub(crate) fn exactly(
    [a, b]: [&Solid; 2],
    poses: [Pose; 2],
    direction: DVec3,
) -> Result<Cast<'_, Solid>, String> {
    Cast::new(a.at(poses[0]), b.at(poses[1]), direction)
        .and_then(|cast| cast.with_tolerance(0.0))
        .map_err(|e| e.to_string())
}

/// Whether a number lies between bounds, exactly, and the estimate too.
pub(crate) fn encloses(found: &Bounded, right: &Ratio) -> bool {
    let Bounded { value, lower, upper } = *found;
    lower <= value
        && value <= upper
        && Ratio::from_f64(lower) <= *right
        && (upper == f64::INFINITY || *right <= Ratio::from_f64(upper))
}
