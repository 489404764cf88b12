//! Bodies of the tests.

pub(crate) use colltrans_testkit::bodies::solid;
