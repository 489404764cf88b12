//! The working size of a picture, to which its scale and its tolerances are relative.

/// Returns the working size: the radius of the larger body, but at most three times that of the smaller one. Points and
/// short segments count as larger, so that the size is positive even for two points.
pub(super) fn working_size(moving: f64, fixed: f64, way: f64) -> f64 {
    let (small, large) = (moving.min(fixed), moving.max(fixed));
    // A point or a short segment has no size of its own.
    let small = if small > 1e-3 * large { small } else { large.min(way.max(0.25 * large)) };
    let size = large.min(3.0 * small);
    if size > 0.0 {
        size
    } else if way > 0.0 {
        way
    } else {
        1.0
    }
}
