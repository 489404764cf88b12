//! Bodies and poses of the tests.

pub(crate) use colltrans_testkit::bodies::{at, body, faces};
