//! Disassembly planning: which parts of an assembly come out, along which directions, in which order, and what blocks
//! the others.
//!
//! Stages of a run, performed by one [`AnalysisRequest`]:
//! - [`Assembly`] and [`Fit`] -> [`Bodies`] (queries; [`roles`], [`threads`]) -> [`start`], [`suggest`] (overlaps)
//! - [`fasteners`]: screws, nuts and other standard parts, which a plan treats as a mechanic does
//! - [`hints`], [`liaisons`] (contacts), [`candidates`] (directions, also of [`cylinders`] and [`inertia`])
//! - [`matrix`], [`travel`] (blockers and free travel) -> [`blocking`] (graph, [`constraints`]) -> [`plan`] ([`identical`]),
//!   [`map`]
//! - [`attempts`]: options to try if parts stay together
//! - [`audit`]: pairs that interfere or are too near, without a plan
//! - [`record`] (JSON) and [`report`] (pictures, HTML, animation; feature `report`)
//!
//! Lengths are in the unit of the files. Results do not depend on the number of threads. One matrix serves all states
//! of a plan, because parts do not move until they leave. Memory: 130 bytes for each ordered pair and direction with a
//! contact, and on each thread up to 50 kB for each pair with cached facets.

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

pub mod attempts;
pub mod audit;
pub mod blocking;
pub mod candidates;
pub mod colour;
pub mod constraints;
pub mod cylinders;
pub mod fasteners;
pub mod free;
pub mod hints;
pub mod identical;
pub mod inertia;
pub mod liaisons;
pub mod map;
pub mod matrix;
pub mod plan;
pub mod record;
#[cfg(feature = "report")]
pub mod report;
pub mod roles;
mod slabs;
pub mod sphere;
pub mod start;
pub mod suggest;
pub mod threads;
pub mod tools;
pub mod travel;
pub mod units;

pub use bodies::{Bodies, Fit, FreeTravel, Stop};
pub use error::AssemblyError;
pub use findings::{Analysis, AnalysisRequest};
pub use part::{Assembly, Ignored, Part, Piece};
pub use watch::{Stage, Watch};

/// Compiles and runs the example of the README as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
