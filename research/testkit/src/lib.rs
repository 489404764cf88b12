//! What tests, campaigns, benchmarks and the laboratory share.
//!
//! [`oracle`]: the judge, in exact rational arithmetic, with the settings that are hard on purpose.
//! Beside it what knows nothing of the library: [`random`] numbers on streams that do not disturb each
//! other, [`shapes`] and [`solids`] as vertices and faces, [`machines`] made of parts, [`timing`] of single calls with the statistics
//! of many, [`tally`] of what campaigns count, [`provenance`]: where numbers come from, and [`golden`]: hashes of answers. Files of
//! tests lie in a [`TemporaryFolder`]; [`cases`] is the number of random cases, and [`bodies`] makes those of tests.

pub mod bodies;
mod cases;
mod folder;
pub mod golden;
pub mod machines;
pub mod oracle;
pub mod provenance;
pub mod random;
pub mod shapes;
pub mod solids;
pub mod tally;
pub mod timing;

pub use cases::cases;
pub use folder::TemporaryFolder;
