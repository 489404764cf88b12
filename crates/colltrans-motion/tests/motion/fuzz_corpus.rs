//! The corpora of the fuzz targets as ordinary tests. A finding becomes one more file.

use colltrans_testkit::oracle::fuzz;

#[test]
fn motion_corpus() {
    fuzz::corpus("motion", 12).for_each(|bytes| fuzz::motion(&bytes));
}
