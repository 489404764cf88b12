//! Reads assemblies and robots from the files that people have.
//!
//! Data flow: a folder of meshes, a manifest, URDF, glTF or 3MF -> [`read()`] -> an [`Assembly`](colltrans_assembly::Assembly):
//! parts in one world and one unit, with what the file says about them. Or: URDF -> [`read::robot`] -> a [`Robot`]: links,
//! joints, and paths of it that are asked ([`robot`]).
//!
//! [`robot`] takes convex bodies around round shapes, assemblies take them inside, so that parts which fit do not overlap.
//!
//! Without the feature `files` GLB alone is read, from memory: for a page.

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
