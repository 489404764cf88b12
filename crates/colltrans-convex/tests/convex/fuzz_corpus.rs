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
fn solids_corpus() {
    fuzz::corpus("solids", 12).for_each(|bytes| fuzz::solids(&bytes));
}

#[test]
fn track_corpus() {
    fuzz::corpus("track", 24).for_each(|bytes| fuzz::track(&bytes));
}

#[test]
fn bulk_corpus() {
    fuzz::corpus("bulk", 24).for_each(|bytes| fuzz::bulk(&bytes));
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
fn keep_corpus() {
    fuzz::corpus("keep", 24).for_each(|bytes| fuzz::keep(&bytes));
}

#[test]
fn motion_corpus() {
    fuzz::corpus("motion", 12).for_each(|bytes| fuzz::motion(&bytes));
}

#[test]
fn among_corpus() {
    fuzz::corpus("among", 6).for_each(|bytes| fuzz::among(&bytes));
}
