//! The size that a picture is made for, which of two bodies may be of very different ones.

/// The size that the picture is made for: that of the smaller body, or of the larger one while
/// both can be seen well. Positive also for two points.
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
