//! Bodies and settings for benchmarks, and the one other library that is measured beside
//! `colltrans`.
//!
//! The data's way: [`shapes`] -> [`settings`], alone or in sequences ([`motion`]) -> the solvers,
//! and [`parry`] on the same settings -> [`report`]. [`arguments`] is
//! the command line of both programs.

pub mod arguments;
pub mod motion;
pub mod parry;
pub mod report;
pub mod settings;
pub mod shapes;
