//! The corpora of the fuzz targets as ordinary tests. A finding becomes one more file.

use colltrans_testkit::oracle::fuzz;

#[test]
fn hull_corpus() {
    fuzz::corpus("hull", 8).for_each(|bytes| fuzz::hull(&bytes));
}

#[test]
fn from_mesh_corpus() {
    fuzz::corpus("from_mesh", 8).for_each(|bytes| fuzz::from_mesh(&bytes));
}

#[test]
fn cast_corpus() {
    fuzz::corpus("cast", 8).for_each(|bytes| fuzz::cast(&bytes));
}

#[test]
fn track_corpus() {
    fuzz::corpus("track", 24).for_each(|bytes| fuzz::track(&bytes));
}

#[test]
fn distance_corpus() {
    fuzz::corpus("distance", 24).for_each(|bytes| fuzz::distance(&bytes));
}

#[test]
fn depth_corpus() {
    fuzz::corpus("depth", 8).for_each(|bytes| fuzz::depth(&bytes));
}

#[test]
fn within_corpus() {
    fuzz::corpus("within", 8).for_each(|bytes| fuzz::within(&bytes));
}

#[test]
fn min_gap_corpus() {
    fuzz::corpus("min_gap", 24).for_each(|bytes| fuzz::min_gap(&bytes));
}

#[test]
fn rounded_corpus() {
    fuzz::corpus("rounded", 26).for_each(|bytes| fuzz::rounded(&bytes));
}
