//! The extension module of the Python package `colltrans`: thin conversions, nothing is computed here.
//!
//! The way: `arrays` (numbers in and out) and `errors` (the library's errors as exceptions) ->
//! `body` (with `offset`), `pose` -> `query` (two placed bodies and a direction), `questions` (the functions of the
//! package) -> `answer`, `clearance`, `features`, `certificate` (what comes back) -> `solid`, `solid_cast`, `solid_answer` (the same for parts
//! that are not convex), `saved` (answers as bytes), `show` (as pictures), `tracker` and `many` (queries in sequence and in bulk), `assembly` (many parts). The package itself
//! is in `python/`; its stub `_colltrans.pyi` has the types.

mod answer;
mod arrays;
mod assembly;
mod body;
mod certificate;
mod clearance;
mod errors;
mod features;
mod many;
mod offset;
mod pose;
mod query;
mod questions;
mod saved;
mod show;
mod solid;
mod solid_answer;
mod solid_cast;
mod tracker;

/// The module.
#[pyo3::pymodule(gil_used = false)]
mod _colltrans {
    #[pymodule_export]
    use crate::answer::{Contact, ContactRange, Grazing, Separated};
    #[pymodule_export]
    use crate::assembly::Assembly;
    #[pymodule_export]
    use crate::body::{ConvexPolyhedron, read};
    #[pymodule_export]
    use crate::certificate::{Certificate, Separation};
    #[pymodule_export]
    use crate::clearance::{Behind, Blocked, DirectionalDepth, Intersection, Overlapping, Slides};
    #[pymodule_export]
    use crate::features::{Feature, Features, Steps};
    #[pymodule_export]
    use crate::many::ask_many;
    #[pymodule_export]
    use crate::offset::{OffsetReport, ShrinkReport};
    #[pymodule_export]
    use crate::pose::Pose;
    #[pymodule_export]
    use crate::query::Cast;
    #[pymodule_export]
    use crate::questions::{cast, clearance, contact_range, directional_depth, intersects};
    #[pymodule_export]
    use crate::saved::restore;
    #[pymodule_export]
    use crate::solid::Solid;
    #[pymodule_export]
    use crate::solid_answer::{
        SolidBlocked, SolidCertificate, SolidContact, SolidFree, SolidOverlapping,
    };
    #[pymodule_export]
    use crate::solid_cast::SolidCast;
    #[pymodule_export]
    use crate::tracker::Tracker;
}
