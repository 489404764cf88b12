//! Bodies and settings for benchmarks, and the one other library that is measured beside
//! `colltrans`.
//!
//! The data's way: [`shapes`] -> [`settings`] -> the solvers, and [`parry`] on the same settings.

pub mod parry;
pub mod settings;
pub mod shapes;
