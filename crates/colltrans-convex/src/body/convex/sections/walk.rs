//! Steps around a section, face by face.
//!
//! A level cuts a convex face in one segment. Therefore the vertices of the face above the level form one run of
//! its boundary, those below the other. A half-edge leads from one run to the other; galloping and bisection find
//! the half-edge back. A face with `k` vertices takes `O(log k)` time.
//!
//! Vertices are read from the half-edges, which are in memory next to each other, and not from a second array.

use colltrans_kernel::topology::Topology;

/// Number of vertices of a face that are tested one by one before galloping. Most faces are triangles or
/// quadrilaterals.
const MAX_LINEAR_STEPS: u32 = 4;

/// Returns the crossing edge that follows `up` counter-clockwise. `above` reports whether a vertex is above the
/// level.
#[inline]
pub(crate) fn next_counter_clockwise(
    topology: &Topology,
    up: u32,
    above: impl Fn(u32) -> bool,
) -> u32 {
    // The face to the right of `up` is that of its twin, which runs downwards.
    run_end(topology, topology.half_edge(up).twin, above)
}

/// Returns the crossing edge that follows `up` clockwise. `above` reports whether a vertex is above the level.
#[inline]
pub(crate) fn next_clockwise(topology: &Topology, up: u32, above: impl Fn(u32) -> bool) -> u32 {
    let down = run_end(topology, up, |vertex| !above(vertex));
    topology.half_edge(down).twin
}

/// Returns the half-edge of the same face that leads back to the run of vertices that `from` leaves. `inside` must
/// be true for the origin of `from`, and false for its target.
#[inline]
fn run_end(topology: &Topology, from: u32, inside: impl Fn(u32) -> bool) -> u32 {
    let half_edges = topology.half_edges();
    let face = topology.face_half_edges(half_edges[from as usize].face);
    let count = face.end - face.start;
    let wrap = |offset: u32| {
        let h = from + offset;
        if h >= face.end { h - count } else { h }
    };
    let is_inside = |offset: u32| inside(half_edges[wrap(offset) as usize].origin);
    if count <= 4 {
        // Without branches, which would be unpredictable. For a triangle, the fourth corner is the first one, which
        // is inside.
        let outside = !is_inside(2);
        return wrap(1 + u32::from(outside) + u32::from(outside & !is_inside(3)));
    }
    // Invariant: the origin at `outside` is not inside, the origin at `returned` is.
    let mut outside = 1;
    let mut returned = 2;
    while returned < count && !is_inside(returned) {
        outside = returned;
        returned =
            if returned <= MAX_LINEAR_STEPS { returned + 1 } else { (2 * returned).min(count) };
    }
    while returned - outside > 1 {
        let middle = u32::midpoint(outside, returned);
        if is_inside(middle) {
            returned = middle;
        } else {
            outside = middle;
        }
    }
    wrap(outside)
}
