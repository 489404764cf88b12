//! The extension module of the Python package `colltrans`. It only converts between Python and the library.
//!
//! Each group of files uses only the groups before it:
//!
//! 1. `errors` (errors of the library as exceptions), `arguments` (messages for confused arguments), `arrays`
//!    (conversion of numbers), `pose`, `frozen` (shared parts of frozen classes), `pool` (threads);
//! 2. bodies: `offset` (reports), `body`, `solid`;
//! 3. queries as values: `solver` (options), `query` (convex bodies), `solid_cast` (solids), `pair` (without a
//!    direction);
//! 4. answers: `certificate`, `features`, `answer` (shared parts), `outcome`, `clearance`, `solid_answer`,
//!    `distance`, `directions`, `ways`, `motion` (queries and answers for bodies that turn);
//! 5. entry points: `questions` (functions and methods of queries), `tracker` (sequences), `rows`, `repeats`,
//!    `columns`, `bulk` and `many` (bulk queries), `obstacles` with `scene` and `scene_answers` (one body
//!    among many), `assembly` (many parts), `robot` (links on joint paths).
//!
//! The package itself is in `python/`. Its stub `_colltrans.pyi` has the types.

mod answer;
mod arguments;
mod arrays;
mod assembly;
mod body;
mod bulk;
mod certificate;
mod clearance;
mod columns;
mod common_part;
mod directions;
mod distance;
mod errors;
mod features;
mod frozen;
mod many;
mod motion;
mod number;
mod obstacles;
mod offset;
mod outcome;
mod pair;
mod placed;
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

/// The extension module.
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
    use crate::common_part::CommonPart;
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
    use crate::placed::Placed;
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
