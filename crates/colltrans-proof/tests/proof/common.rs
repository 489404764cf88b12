//! Bodies of the tests, from the test kit's meshes.

pub(crate) use colltrans_testkit::bodies::solid;
