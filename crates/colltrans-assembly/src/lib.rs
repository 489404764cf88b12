//! Disassembly planning: which parts of an assembly come out, along which directions, in which order, and
//! which parts block the others.
//!
//! The stages of a run, in order. One [`Question`] runs them all.
//! - [`Assembly`]: parts in one world frame and one unit, read from files by `colltrans-assembly-io`.
//! - [`Bodies`] with a [`Fit`] (a tolerance, or a minimum gap). `bodies` holds nearly all queries of pairs to
//!   `colltrans`; [`roles`] and [`threads`] describe what a pair tolerates.
//! - [`start`] (overlaps), [`suggest`] (causes of overlaps), [`hints`] (oddities of the parts), [`liaisons`]
//!   (contacts).
//! - [`candidates`] (directions, also of [`cylinders`] and [`inertia`]), [`matrix`] and [`rooms`] (who stops
//!   whom, how far).
//! - [`blocking`] (graph; arcs of [`constraints`]), [`likes`] (parts of equal shape), [`plan`] (steps,
//!   interlocked groups), [`map`] (all directions of a part).
//! - [`record`] (JSON), and [`report`] (pictures, an HTML file, an animation) with the feature `report`.
//!
//! Lengths are in the unit of the files. Directions have length 1. Results do not depend on the number of
//! threads. One matrix serves all states of a plan, because parts do not move until they leave. Memory,
//! besides the parts: 100 bytes for each pair and direction with a contact, and on each thread up to 50 kB
//! for each pair of parts whose facets are cached.

mod bodies;
mod boxes;
mod csv;
mod digits;
mod error;
mod findings;
mod part;
mod watch;
mod witness;
#[cfg(test)]
mod work;

pub mod blocking;
pub mod candidates;
pub mod colour;
pub mod constraints;
pub mod cylinders;
pub mod free;
pub mod hints;
pub mod inertia;
pub mod liaisons;
pub mod likes;
pub mod map;
pub mod matrix;
pub mod plan;
pub mod record;
#[cfg(feature = "report")]
pub mod report;
pub mod roles;
pub mod rooms;
mod slabs;
pub mod sphere;
pub mod start;
pub mod suggest;
pub mod threads;
pub mod units;

pub use bodies::{Bodies, Fit, Room, Stop};
pub use error::AssemblyError;
pub use findings::{Findings, Question};
pub use part::{Assembly, Ignored, Part, Piece};
pub use watch::{Stage, Watch};
