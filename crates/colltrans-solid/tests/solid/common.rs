//! Bodies and poses of the tests, from the test kit's meshes.

pub(crate) use colltrans_testkit::bodies::{at, cuboid, solid};
