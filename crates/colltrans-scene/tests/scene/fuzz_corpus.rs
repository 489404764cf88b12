//! Runs the corpora of the fuzz targets as ordinary tests. Each finding is added as a file.

use colltrans_testkit::oracle::fuzz;

#[test]
fn bulk_corpus() {
    fuzz::corpus("bulk", 24).for_each(|bytes| fuzz::bulk(&bytes));
}

#[test]
fn among_corpus() {
    fuzz::corpus("among", 6).for_each(|bytes| fuzz::among(&bytes));
}
