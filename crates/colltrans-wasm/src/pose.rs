//! Poses as seven numbers, `x,y,z,qx,qy,qz,qw`, as on the command line.

use colltrans::Pose;
use glam::{DQuat, DVec3};

/// Builds a pose. Returns an error if the numbers do not describe one.
pub(crate) fn pose([x, y, z, qx, qy, qz, qw]: [f64; 7], whose: &str) -> Result<Pose, String> {
    let (at, turn) = (DVec3::new(x, y, z), DQuat::from_xyzw(qx, qy, qz, qw));
    Pose::new(turn, at).map_err(|error| format!("pose of the {whose} body: {error}"))
}
