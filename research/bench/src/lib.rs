//! Measurements of `colltrans` beside `parry3d-f64`.
//!
//! Data flow: [`shapes`], [`meshes`] and [`ties`] (on what) -> `colltrans_lab::settings` (where it is) ->
//! [`parry`] (the same in the other library) -> [`report`]. The programs `table`, `coherence` and
//! `solids` go that way.

pub mod arguments;
pub mod meshes;
pub mod parry;
pub mod report;
pub mod shapes;
pub mod ties;
