//! The extension module of the Python package `colltrans`: thin conversions, nothing is computed here.
//!
//! Each file uses only those before it:
//!
//! 1. `errors` (the library's errors as exceptions), `arrays` (numbers in and out), `pose`, `frozen` (what
//!    frozen classes have in common);
//! 2. bodies: `offset` (reports), `body`, `solid`;
//! 3. queries as values: `query` between convex bodies, `solid_cast` between solids, `pair` without a
//!    direction;
//! 4. answers: `certificate`, `features`, `answer` (what all have in common), `outcome`, `clearance`,
//!    `solid_answer`, `distance`, `directions`, `ways`, `motion` (queries and answers about bodies that turn);
//! 5. those who ask: `questions` (functions, and methods of queries), `tracker` (in sequence), `rows`, `repeats`,
//!    `columns`, `bulk` and `many` (in bulk), `obstacles` (one body among many) with its `scene` and `scene_answers`,
//!    `assembly` (many parts), `robot` (links on paths of joints).
//!
//! The package itself is in `python/`; its stub `_colltrans.pyi` has the types.

mod answer;
mod arguments;
mod arrays;
mod assembly;
mod body;
mod bulk;
mod certificate;
mod clearance;
mod columns;
mod directions;
mod distance;
mod errors;
mod features;
mod frozen;
mod many;
mod motion;
mod obstacles;
mod offset;
mod outcome;
mod pair;
mod pool;
mod pose;
mod query;
mod questions;
mod repeats;
mod robot;
mod rows;
mod scene;
mod scene_answers;
mod solid;
mod solid_answer;
mod solid_cast;
mod solver;
mod tracker;
mod ways;

/// The module.
#[pyo3::pymodule(gil_used = false)]
mod _colltrans {
    #[pymodule_export]
    use crate::assembly::{Assembly, Planned};
    #[pymodule_export]
    use crate::body::{ConvexPolyhedron, read};
    #[pymodule_export]
    use crate::certificate::{Certificate, Separation, SolidCertificate};
    #[pymodule_export]
    use crate::clearance::{Behind, Blocked, DirectionalDepth, Intersection, Overlapping, Slides};
    #[pymodule_export]
    use crate::directions::{FreeDirections, free_directions};
    #[pymodule_export]
    use crate::distance::{Depth, Distance, OverlapDepth, Within};
    #[pymodule_export]
    use crate::features::{Feature, Features, Steps};
    #[pymodule_export]
    use crate::many::ask_many;
    #[pymodule_export]
    use crate::motion::{
        FirstContact, Motion, MotionCast, MotionClearance, first_contact, motion_clearance,
    };
    #[pymodule_export]
    use crate::obstacles::Obstacles;
    #[pymodule_export]
    use crate::offset::{OffsetReport, ShrinkReport};
    #[pymodule_export]
    use crate::outcome::{Contact, ContactRange, Grazing, LastContact, Separated};
    #[pymodule_export]
    use crate::pair::Pair;
    #[pymodule_export]
    use crate::pose::Pose;
    #[pymodule_export]
    use crate::query::Cast;
    #[pymodule_export]
    use crate::questions::{
        cast, clearance, contact_range, depth, directional_depth, distance, intersects, within,
    };
    #[pymodule_export]
    use crate::robot::{PathAnswer, Robot, ask_paths};
    #[pymodule_export]
    use crate::scene_answers::{NearbyObstacles, NearestObstacle, ObstacleClearance};
    #[pymodule_export]
    use crate::solid::Solid;
    #[pymodule_export]
    use crate::solid_answer::{SolidBlocked, SolidContact, SolidFree, SolidOverlapping};
    #[pymodule_export]
    use crate::solid_cast::SolidCast;
    #[pymodule_export]
    use crate::solver::Cta;
    #[pymodule_export]
    use crate::tracker::Tracker;
    #[pymodule_export]
    use crate::ways::{WaysOut, ways_out};
}
