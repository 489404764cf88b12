//! What benchmarks, laboratory and tests share: nothing here knows the library.
//!
//! [`random`] numbers on streams that do not disturb each other, [`shapes`] as vertices and faces,
//! [`timing`] of single calls with the statistics of many, and [`provenance`]: where numbers come
//! from.

pub mod provenance;
pub mod random;
pub mod shapes;
pub mod solids;
pub mod timing;
