//! What solids are judged by: bodies of cubes, whose motions are known without facets ([`cells`]), the
//! rule over all pairs of facets in exact arithmetic ([`facets`]), proofs judged in fractions
//! ([`proof`]), and settings full of ties ([`settings`]).

pub mod cells;
mod convex;
pub mod facets;
pub mod proof;
pub mod settings;

pub use convex::as_solids;
pub use settings::Seen;
