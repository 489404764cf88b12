//! Assemblies: which parts come out, along which directions, in which order, and what holds the rest.
//!
//! Data flow: files, which `colltrans-assembly-io` reads -> [`Assembly`], parts in one world and one unit -> [`Fit`] (how
//! tight: shrunk by a tolerance, or to be kept a length apart) -> `bodies` (two parts and a direction: the
//! only module that asks `colltrans`; with [`roles`] and [`threads`] what a pair tolerates) -> [`start`] (overlaps now; [`suggest`] what they may be, [`hints`] what is odd about parts), [`liaisons`] (who touches whom) ->
//! [`candidates`] (directions worth asking, axes of [`cylinders`] and of [`inertia`] among them) -> [`matrix`] and [`rooms`] (who is stopped by whom) ->
//! [`blocking`] (the graph; with [`constraints`] its arcs), [`likes`] (parts of one shape) -> [`plan`] (steps, and what is stuck) ; [`map`] (one part, all
//! directions); all of that by one [`Question`] -> [`record`] (JSON) -> [`report`] (pictures, one HTML file, an animation).
//!
//! Lengths are in the unit of the files. Directions have length 1, so distances are lengths.
//! Everything is the same on any number of threads. The memory of a run is that of the parts, 100
//! bytes for each pair of parts that meets along a direction asked, and on each thread up to 50 kB for
//! each pair of parts whose facets are kept to be asked again.
//!
//! Without the feature `report` nothing is drawn: for a page.
//!
//! What a part meets does not depend on what has
//! gone, as all stand where they were: one matrix serves all states of a plan. Everything parallel is gathered in order, so
//! results are the same on any number of threads.

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
