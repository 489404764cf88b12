//! Shared code of tests, campaigns, benchmarks and the laboratory.
//!
//! - [`oracle`] computes correct answers in exact rational arithmetic, and has settings that are deliberately
//!   difficult.
//! - [`random`] has random numbers in independent streams, [`shapes`] and [`solids`] have meshes, [`machines`]
//!   has assemblies. These do not use the library.
//! - [`timing`] measures single calls and computes statistics, [`tally`] has the counts of campaigns,
//!   [`provenance`] describes the origin of numbers, and [`golden`] hashes answers.
//! - [`TemporaryFolder`] has the files of a test, [`cases`](fn@cases) is the number of random cases, and [`bodies`]
//!   builds the bodies of tests.

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
