//! Compares the speed of `colltrans` with that of `parry3d-f64`.
//!
//! Each file in `bin` is a program. It declares the columns of its table and draws cases; [`times`] measures
//! the contestants on these cases in turns. [`harness`] reads arguments, prints rows and writes them. A case
//! consists of bodies ([`shapes`], [`meshes`], [`ties`]) and a setting (`colltrans_lab::settings`). [`parry`]
//! converts cases for the other library.

pub mod harness;
pub mod meshes;
pub mod parry;
pub mod shapes;
pub mod ties;
pub mod times;
