//! Runs the corpus of the fuzz target as an ordinary test. Each finding is added as a file.

use colltrans_testkit::oracle::fuzz;

#[test]
fn motion_corpus() {
    fuzz::corpus("motion", 12).for_each(|bytes| fuzz::motion(&bytes));
}
