//! Steps around a section, face by face.
//!
//! A convex face is cut by a level in one segment: along its boundary the vertices that are above
//! form one run, those below the other. From the half-edge at one change of runs, the other change
//! is found by galloping and bisection, so a face with `k` vertices costs `O(log k)`.

use colltrans_kernel::topology::Topology;

/// Vertices of a face tried one by one before galloping: most faces are triangles or
/// quadrilaterals.
const MAX_LINEAR_STEPS: u32 = 4;

/// The crossing edge that follows `up` counter-clockwise.
#[inline]
pub(crate) fn next_counter_clockwise(
    topology: &Topology,
    up: u32,
    above: impl Fn(u32) -> bool,
) -> u32 {
    // The face on the right of `up` is the one of its twin, which runs downwards.
    run_end(topology, topology.half_edge(up).twin, above)
}

/// The crossing edge that follows `up` clockwise.
#[inline]
pub(crate) fn next_clockwise(topology: &Topology, up: u32, above: impl Fn(u32) -> bool) -> u32 {
    let down = run_end(topology, up, |vertex| !above(vertex));
    topology.half_edge(down).twin
}

/// The half-edge of the same face that leads back to the run of vertices that `from` leaves:
/// `inside` holds for the origin of `from`, not for its target.
#[inline]
fn run_end(topology: &Topology, from: u32, inside: impl Fn(u32) -> bool) -> u32 {
    let face = topology.face(topology.half_edge(from).face);
    let count = face.end - face.start;
    let wrap = |offset: u32| {
        let h = from + offset;
        if h >= face.end { h - count } else { h }
    };
    let is_inside = |offset: u32| inside(topology.origin(wrap(offset)));
    if count <= 4 {
        // Without branches, which would be unpredictable. The fourth corner of three is the first,
        // which is inside.
        let outside = !is_inside(2);
        return wrap(1 + u32::from(outside) + u32::from(outside & !is_inside(3)));
    }
    // Invariant: the origin at `outside` is not inside, the one at `returned` is.
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
