//! The corpora of the fuzz targets as ordinary tests. A finding becomes one more file.

use colltrans_testkit::oracle::fuzz;

#[test]
fn solids_corpus() {
    fuzz::corpus("solids", 12).for_each(|bytes| fuzz::solids(&bytes));
}
