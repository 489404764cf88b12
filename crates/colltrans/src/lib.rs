//! Collision translations of convex polyhedra: how far can one body move before it touches another.

mod answer;
mod certificate;
mod cta;
mod error;
mod exact;
mod minkowski;
mod outcome;
mod plane;
mod polyhedron;
mod portal;
mod pose;
mod query;
mod section;
mod setting;
mod topology;

pub use certificate::{Certificate, CertificateError, Separation};
pub use error::{BuildError, MAX_MAGNITUDE, MIN_MAGNITUDE, PoseError, QueryError, TopologyError};
pub use glam;
pub use outcome::{
    Clearance, Contact, ContactRange, Feature, Grazing, Outcome, Separated, Solver, Steps,
};
pub use polyhedron::{ConvexPolyhedron, ConvexityDefect, convexity_defect};
pub use pose::Pose;
pub use query::{
    Options, cast, cast_with, clearance, contact_range, directional_depth, intersects,
};
pub use setting::VertexPair;
