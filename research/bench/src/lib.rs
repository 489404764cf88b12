//! Measurements of `colltrans` beside `parry3d-f64`.
//!
//! A program is one file in `bin`: it declares the columns of its table, draws cases, and has [`times`] let contestants
//! answer them in turns; [`harness`] reads arguments, prints rows and writes them. Cases are bodies ([`shapes`], [`meshes`],
//! [`ties`]) in settings (`colltrans_lab::settings`), the same in the other library by [`parry`].

pub mod harness;
pub mod meshes;
pub mod parry;
pub mod shapes;
pub mod ties;
pub mod times;
