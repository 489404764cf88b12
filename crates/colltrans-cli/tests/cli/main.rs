//! The real binary, run as a user runs it.

mod assembly;
mod batch;
mod cast;
mod clear;
mod door;
mod example_parts;
mod picture;
mod readme;
mod replay;
mod support;
