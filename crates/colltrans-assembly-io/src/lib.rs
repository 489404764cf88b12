//! Reads assemblies and robots from files.
//!
//! - [`read()`] reads a folder of meshes, a single mesh, a manifest, URDF, glTF or 3MF. It returns an
//!   [`Assembly`](colltrans_assembly::Assembly), which has parts in one world frame and one unit.
//! - [`read::read_robot`] reads URDF. It returns a [`Robot`], which has links, joints, and queries about paths
//!   ([`robot`]).
//!
//! Round shapes are replaced by polyhedra. For a [`Robot`] they are circumscribed, so that a path that is
//! proven free is free for the true shapes. For an assembly they are inscribed, so that parts which fit do not
//! overlap.
//!
//! Without the feature `files` the crate reads only GLB from memory, as the web page does.

mod error;
mod plain;
pub mod read;
#[cfg(feature = "files")]
pub mod robot;

pub use error::ReadError;
pub use read::ReadOptions;
#[cfg(feature = "files")]
pub use read::read;
#[cfg(feature = "files")]
pub use robot::Robot;

/// Compiles and runs the example of the README as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
