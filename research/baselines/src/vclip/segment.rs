//! Nearest points of two segments.

use glam::DVec3;

/// Nearest points of two segments, and the parameter on the first one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SegmentPair {
    pub(crate) first: DVec3,
    pub(crate) second: DVec3,
    /// Parameter on the first segment: 0 at its start, 1 at its end.
    pub(crate) share: f64,
}

/// Returns the nearest points: interior points at which the lines are nearest, or an end of one segment and a
/// point of the other. The best of five candidates needs no decision about parallel segments.
pub(crate) fn nearest_of_segments(ab: [DVec3; 2], cd: [DVec3; 2]) -> SegmentPair {
    let from_first = |share: f64| {
        let first = ab[0].lerp(ab[1], share);
        SegmentPair { first, second: at(cd, foot(first, cd)), share }
    };
    let from_second = |second: DVec3| {
        let share = foot(second, ab);
        SegmentPair { first: at(ab, share), second, share }
    };
    let ends = [from_first(0.0), from_first(1.0), from_second(cd[0]), from_second(cd[1])];
    let square = |pair: &SegmentPair| pair.first.distance_squared(pair.second);
    ends.into_iter()
        // The second foot corrects the crossing, which is inaccurate along both lines if they are nearly
        // parallel.
        .chain(crossing_parameter(ab, cd).map(|share| from_second(from_first(share).second)))
        .min_by(|p, q| square(p).total_cmp(&square(q)))
        .expect("four ends")
}

/// Returns the parameter on the first segment at which it is nearest to the second segment's line; `None`
/// unless it is interior.
fn crossing_parameter([a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> Option<f64> {
    let (along, other) = (b - a, d - c);
    let normal = along.cross(other);
    let share = (c - a).cross(other).dot(normal) / normal.length_squared();
    (share > 0.0 && share < 1.0).then_some(share)
}

/// Returns the parameter of a segment at its nearest point to `x`.
pub(crate) fn foot(x: DVec3, [a, b]: [DVec3; 2]) -> f64 {
    let along = b - a;
    ((x - a).dot(along) / along.length_squared()).clamp(0.0, 1.0)
}

/// Returns the point at a parameter of a segment; exact at both ends.
pub(crate) fn at([a, b]: [DVec3; 2], share: f64) -> DVec3 {
    a.lerp(b, share)
}
