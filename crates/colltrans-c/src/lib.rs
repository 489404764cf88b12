//! C interface of `colltrans`. It converts between C and the library, and computes no geometry.
//!
//! `include/colltrans.h` is generated from the public items of this crate; `tests/c_interface/header.rs` has the
//! generator. `Body` is `colltrans_body` in C, `Outcome::Contact` is `COLLTRANS_CONTACT`.
//!
//! - Every entry point runs in `error::guard`: errors become a status and a text, and no panic crosses the boundary.
//! - `error` reads pointers. Null and misaligned ones are errors that name the argument.
//! - `body` has bodies and poses, `answer` the plain structs of answers.
//! - Queries: `cast`, `pair`, `tracker`, `motion`, `scene`, `many` (tables of poses), `proof`.
//!
//! Invariants that the caller keeps: a pointer that is not null points to an initialised object of its type, or to as
//! many as the count states; a handle is freed once and not used afterwards; a handle that a call changes (its pointer
//! is not const) is used by no other thread during the call.

mod answer;
mod body;
mod cast;
mod error;
mod many;
mod motion;
mod pair;
mod proof;
mod scene;
mod tracker;

use std::ffi::c_char;

pub use answer::{
    CastAnswer, CastColumns, DepthAnswer, DistanceAnswer, DistanceColumns, Feature, FeatureKind,
    MotionAnswer, Outcome,
};
pub use body::{
    Body, BodyProperties, Pose, colltrans_body_clone, colltrans_body_free, colltrans_body_info,
    colltrans_body_rounded, colltrans_convex_cuboid, colltrans_convex_from_mesh,
    colltrans_convex_from_points, colltrans_pose_from_matrix, colltrans_pose_from_quaternion,
    colltrans_solid_from_mesh, colltrans_solid_from_pieces,
};
pub use cast::{
    CastOptions, colltrans_clearance, colltrans_contact_range, colltrans_first_contact,
    colltrans_intersects,
};
pub use error::{Status, colltrans_error_message};
pub use many::{
    Rows, colltrans_clearance_many, colltrans_contact_range_many, colltrans_distance_many,
    colltrans_first_contact_many,
};
pub use motion::{
    Motion, colltrans_motion_clearance, colltrans_motion_first_contact, colltrans_motion_free,
    colltrans_motion_free_flight, colltrans_motion_pose_at, colltrans_motion_rest,
    colltrans_motion_screw, colltrans_motion_through_poses, colltrans_motion_translation,
};
pub use pair::{colltrans_depth, colltrans_distance, colltrans_distance_bounds, colltrans_within};
pub use proof::{
    colltrans_check_proof, colltrans_clearance_proof, colltrans_common_part_proof,
    colltrans_depth_proof, colltrans_distance_proof, colltrans_first_contact_proof,
    colltrans_motion_proof, colltrans_scene_clearance_proof, colltrans_scene_nearest_proof,
    colltrans_text_free, colltrans_within_proof,
};
pub use scene::{
    Scene, colltrans_scene_clearance, colltrans_scene_free, colltrans_scene_insert,
    colltrans_scene_nearest, colltrans_scene_new, colltrans_scene_remove, colltrans_scene_set_pose,
    colltrans_scene_size, colltrans_scene_within,
};
pub use tracker::{
    Tracker, colltrans_tracker_clearance, colltrans_tracker_contact_range,
    colltrans_tracker_distance, colltrans_tracker_first_contact, colltrans_tracker_free,
    colltrans_tracker_new, colltrans_tracker_reset,
};

/// Number of the binary interface. It grows with every change of a struct, a number or a function.
pub const COLLTRANS_ABI: u32 = 1;

/// The library chooses the solver of convex bodies.
pub const COLLTRANS_SOLVER_AUTO: u32 = 0;

/// The algorithm of the paper (`cta`).
pub const COLLTRANS_SOLVER_CTA: u32 = 1;

/// Portal refinement.
pub const COLLTRANS_SOLVER_PORTAL: u32 = 2;

/// Obstacle of an answer that has none.
pub const COLLTRANS_NO_OBSTACLE: u64 = u64::MAX;

/// Vertex of a feature that has fewer vertices.
pub const COLLTRANS_NO_VERTEX: u32 = u32::MAX;

// The header promises that any number of threads may use these handles, and that a tracker may move between threads.
const _: () = {
    const fn is_shared<T: Send + Sync>() {}
    const fn is_sent<T: Send>() {}
    is_shared::<Body>();
    is_shared::<Motion>();
    is_shared::<Scene>();
    is_sent::<Tracker>();
};

/// Returns the number of the binary interface. Programs compare it with `COLLTRANS_ABI` of their header.
#[unsafe(no_mangle)]
pub extern "C" fn colltrans_abi() -> u32 {
    COLLTRANS_ABI
}

/// Returns the version of the library, for example `0.2.0`. The text is static.
#[unsafe(no_mangle)]
pub extern "C" fn colltrans_version() -> *const c_char {
    const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");
    VERSION.as_ptr().cast()
}
