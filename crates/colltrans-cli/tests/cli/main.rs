//! Runs the program as a user does.

mod assembly;
mod audit;
mod batch;
mod cast;
mod clearance;
mod directions;
mod distance;
mod example_parts;
mod help;
mod min_gap;
mod motion;
mod newcomers;
mod path;
mod picture;
mod proof;
mod readme;
mod replay;
mod rounded;
mod scene;
mod setup;
mod step;
mod support;
