//! Rings: cyclic vertex lists that are searched by angle. They are the corners of a face with many corners, the
//! corners adjacent to such a face, or the neighbours of a vertex with many neighbours.
//!
//! - *axis*: the normal of the face, or of a plane that cuts all edges of the vertex. Projected along it, a ring is
//!   a convex polygon.
//! - *cells*: as many equal parts of the full turn as there are corners. Each stores the range of corners that may
//!   be farthest along a direction in it.
//! - *rim*: the ellipse that approximates the corners, a smooth body for guesses.
//!
//! The farthest corner is the one between whose edge normals the direction lies. It is found by bisection within a
//! cell; on the rim of a cylinder this takes one or two tests for any number of corners. The result only continues
//! a climb: on a ring that is not exactly flat it need not be the farthest corner.

use glam::{DVec2, DVec3};

use colltrans_kernel::plane::polygon_normal;
use colltrans_kernel::topology::Topology;
use colltrans_kernel::visit_counter;

/// Maximum deviation of a corner from an ellipse, relative to its size, up to which the ring counts as round.
const MAX_RIM_DEVIATION: f64 = 0.02;

/// Definition of the corners of a ring.
#[derive(Debug, Clone, Copy)]
pub(super) enum Cycle {
    /// The corners of a face, starting with the origin of this half-edge.
    Face(u32),
    /// The vertices next to the corners of a face, starting with the corner of this half-edge. Each is the end of
    /// the edge that leaves its corner and follows the half-edge's twin.
    AdjacentToFace(u32),
    /// The neighbours of this vertex.
    Fan(u32),
}

/// An ellipse that approximates corners of a body, or a point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rim {
    pub(crate) center: DVec3,
    /// Conjugate semi-diameters; zero for a point.
    pub(crate) semi_axes: [DVec3; 2],
    /// One of the corners.
    pub(crate) vertex: u32,
    /// Whether the outline of the body ends at the rim's plane, along the cross product of the semi-diameters and
    /// along its opposite.
    pub(crate) ends: [bool; 2],
}

/// A cyclic list of vertices, indexed by angle.
#[derive(Debug, Clone)]
pub(super) struct Ring {
    cycle: Cycle,
    rim: Rim,
    /// Whether all corners are near the rim.
    is_round: bool,
    /// Two orthogonal unit vectors across the axis, about which the corners are counter-clockwise.
    axes: [DVec3; 2],
    /// The corner at which numbering starts. The normal of the edge that starts there has the smallest angle.
    first: u32,
    /// For each cell the number of corners before its first candidate, followed by the number of corners.
    cells: Vec<u32>,
}

impl Cycle {
    #[inline]
    fn vertex_at(self, topology: &Topology, k: u32) -> u32 {
        match self {
            Self::Face(start) => topology.origin(start + k),
            Self::AdjacentToFace(start) => {
                let twin = topology.half_edge(start + k).twin;
                topology.target(topology.next(twin))
            }
            Self::Fan(vertex) => topology.neighbours(vertex)[k as usize],
        }
    }
}

impl Rim {
    /// Returns the rim that consists of one point.
    pub(super) fn from_vertex(vertex: u32, center: DVec3) -> Self {
        Self { center, semi_axes: [DVec3::ZERO; 2], vertex, ends: [false; 2] }
    }

    pub(crate) fn is_point(&self) -> bool {
        self.semi_axes == [DVec3::ZERO; 2]
    }

    /// Returns the largest product of a point of the rim with `direction`.
    fn support_value(&self, direction: DVec3) -> f64 {
        let [u, v] = self.semi_axes.map(|axis| axis.dot(direction));
        self.center.dot(direction) + (u * u + v * v).sqrt()
    }

    /// Returns this rim with `ends` computed for a body whose outline is given.
    pub(super) fn with_ends_among(self, outline: &[Self]) -> Self {
        let [u, v] = self.semi_axes;
        let ends = |out: DVec3| {
            outline.iter().all(|rim| rim.support_value(out) <= self.support_value(out))
        };
        let axis = u.cross(v);
        Self { ends: [axis, -axis].map(|out| !self.is_point() && ends(out)), ..self }
    }

    /// Fits an ellipse to the mean and the second moments of the corners, projected along the axis. Returns the
    /// ellipse, and whether all corners are near it.
    fn fit_ellipse(
        vertex: u32,
        axes: [DVec3; 2],
        corners: impl Iterator<Item = DVec3> + Clone,
    ) -> (Self, bool) {
        let count = corners.clone().count() as f64;
        let center = corners.clone().sum::<DVec3>() / count;
        let [mut xx, mut xy, mut yy] = [0.0; 3];
        for corner in corners.clone() {
            let [x, y] = axes.map(|axis| axis.dot(corner - center));
            (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
        }
        // For corners spread evenly over an ellipse, the moments are half of its squared semi-axes.
        let [xx, xy, yy] = [xx, xy, yy].map(|moment| 2.0 * moment / count);
        let first = xx.sqrt();
        let shear = if first > 0.0 { xy / first } else { 0.0 };
        let second = (yy - shear * shear).max(0.0).sqrt();
        let axis = axes[0].cross(axes[1]);
        let is_near = |corner: DVec3| {
            let off = corner - center;
            let [x, y] = axes.map(|axis| axis.dot(off));
            let along = x / first;
            let across = (y - along * shear) / second;
            let square = along * along + across * across;
            (square - 1.0).abs() < MAX_RIM_DEVIATION
                && axis.dot(off).abs() < MAX_RIM_DEVIATION * second
        };
        let semi_axes = [axes[0] * first + axes[1] * shear, axes[1] * second];
        (
            Self { center, semi_axes, vertex, ends: [false; 2] },
            corners.map(is_near).fold(true, |all, near| all & near),
        )
    }
}

impl Ring {
    /// Builds the ring of a face's corners.
    pub(super) fn from_face(vertices: &[DVec3], topology: &Topology, face: u32) -> Self {
        let range = topology.face_half_edges(face);
        Self::from_cycle(vertices, topology, Cycle::Face(range.start), range.len() as u32)
    }

    /// Builds the ring adjacent to a face. Returns `None` if two consecutive corners are the same vertex.
    pub(super) fn from_adjacent_corners(
        vertices: &[DVec3],
        topology: &Topology,
        face: u32,
    ) -> Option<Self> {
        let range = topology.face_half_edges(face);
        let (cycle, count) = (Cycle::AdjacentToFace(range.start), range.len() as u32);
        let repeats =
            |k| cycle.vertex_at(topology, k) == cycle.vertex_at(topology, (k + 1) % count);
        (!(0..count).any(repeats)).then(|| Self::from_cycle(vertices, topology, cycle, count))
    }

    /// Builds a ring whose axis is the normal of its own polygon.
    fn from_cycle(vertices: &[DVec3], topology: &Topology, cycle: Cycle, count: u32) -> Self {
        let corners = (0..count).map(|k| vertices[cycle.vertex_at(topology, k) as usize]);
        let axis = polygon_normal(corners.clone());
        Self::new((cycle, cycle.vertex_at(topology, 0)), axis, corners.clone(), corners).0
    }

    /// Builds a ring and computes its [dent](polygon_dent).
    ///
    /// - `vertex`: the first corner.
    /// - `axis`: any length; the corners are counter-clockwise about it.
    /// - `corners`: the positions for the rim.
    /// - `projected_from`: the positions whose projection along the axis is the polygon.
    pub(super) fn new(
        (cycle, vertex): (Cycle, u32),
        axis: DVec3,
        corners: impl Iterator<Item = DVec3> + Clone,
        projected_from: impl Iterator<Item = DVec3>,
    ) -> (Self, f64) {
        let axis = axis.try_normalize().unwrap_or(DVec3::Z);
        let x = axis.any_orthonormal_vector();
        let axes = [x, axis.cross(x)];
        let (rim, is_round) = Rim::fit_ellipse(vertex, axes, corners);
        let polygon: Vec<DVec2> =
            projected_from.map(|p| DVec2::from(axes.map(|a| a.dot(p)))).collect();
        let next = polygon.iter().cycle().skip(1);
        let angles: Vec<f64> =
            polygon.iter().zip(next).map(|(p, q)| pseudo_angle(-(q - p).perp())).collect();
        let count = angles.len();
        let least = |best: usize, k: usize| if angles[k] < angles[best] { k } else { best };
        let first = (0..count).fold(0, least);
        let mut before = 0;
        let mut cells: Vec<u32> = (0..count)
            .map(|cell| {
                let start = cell as f64 * (4.0 / count as f64);
                while before < count && angles[(first + before) % count] < start {
                    before += 1;
                }
                before as u32
            })
            .collect();
        cells.push(count as u32);
        let dent = polygon_dent(&polygon, &angles);
        (Self { cycle, rim, is_round, axes, first: first as u32, cells }, dent)
    }

    /// Returns the ellipse that approximates the corners.
    pub(super) fn rim(&self) -> &Rim {
        &self.rim
    }

    /// Checks whether all corners are near the rim.
    pub(super) fn is_round(&self) -> bool {
        self.is_round
    }

    /// Returns the number of corners.
    pub(super) fn corner_count(&self) -> u32 {
        self.cells.len() as u32 - 1
    }

    pub(super) fn corner_vertex(&self, topology: &Topology, k: u32) -> u32 {
        self.cycle.vertex_at(topology, k)
    }

    /// Finds the corner farthest along `direction` (any length). `rises(from, to)` reports whether the edge between
    /// two consecutive corners rises along it.
    #[inline]
    fn farthest_corner(&self, direction: DVec3, rises: impl Fn(u32, u32) -> bool) -> u32 {
        let (mut low, mut high) = self.candidate_range(direction);
        while low < high {
            visit_counter::count_visits(1);
            let middle = u32::midpoint(low, high);
            if rises(self.corner_number(middle), self.corner_number(middle + 1)) {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        self.corner_number(low)
    }

    /// Returns the first candidate for the corner farthest along `direction`.
    #[inline]
    pub(super) fn first_candidate(&self, direction: DVec3) -> u32 {
        self.corner_number(self.candidate_range(direction).0)
    }

    /// Returns the numbers of the first and the last candidate for the corner farthest along `direction` (any
    /// length), counted from `first`.
    #[inline]
    fn candidate_range(&self, direction: DVec3) -> (u32, u32) {
        let count = self.corner_count();
        let along = DVec2::from(self.axes.map(|axis| axis.dot(direction)));
        // Casts saturate: a NaN from a direction along the axis selects cell 0.
        let cell = (pseudo_angle(along) * (0.25 * f64::from(count))) as usize;
        let cell = cell.min(count as usize - 1);
        (self.cells[cell], self.cells[cell + 1])
    }

    /// Returns the corner with number `k`, counted from `first`, at most once beyond the end.
    #[inline]
    fn corner_number(&self, k: u32) -> u32 {
        let (k, count) = (self.first + k, self.corner_count());
        if k >= count { k - count } else { k }
    }

    /// Finds the vertex farthest along `direction` (any length).
    #[inline]
    pub(super) fn farthest_vertex(
        &self,
        vertices: &[DVec3],
        topology: &Topology,
        direction: DVec3,
    ) -> u32 {
        let corner = |k: u32| self.cycle.vertex_at(topology, k);
        let rises = |from: u32, to: u32| {
            let edge = vertices[corner(to) as usize] - vertices[corner(from) as usize];
            direction.dot(edge) > 0.0
        };
        corner(self.farthest_corner(direction, rises))
    }

    /// Returns the number of bytes on the heap.
    pub(super) fn heap_bytes(&self) -> usize {
        self.cells.capacity() * size_of::<u32>()
    }
}

/// Bounds the deviation of a polygon from convexity. The bound applies to linear functions with a gradient of
/// length 1. It limits the increase of such a function along the polygon from its maximum to its minimum, and the
/// decrease on the way back.
///
/// `angles` are the pseudo-angles of the edges' outward normals. The result has the size of rounding errors for a
/// convex polygon. It is infinite if the polygon does not turn exactly once. Derivation: `docs/theory/supports.md`.
fn polygon_dent(polygon: &[DVec2], angles: &[f64]) -> f64 {
    let count = angles.len();
    let (mut angle, mut max_angle, mut turns, mut dent) = (0.0_f64, 0.0_f64, 0.0, 0.0);
    for k in 0..count {
        let next = (k + 1) % count;
        max_angle = max_angle.max(angle).min(4.0);
        // Twice the difference bounds it in radians, because the pseudo-angle changes by at least half of the angle.
        let off = 2.0 * (max_angle - angle).abs() + 32.0 * f64::EPSILON;
        dent += off * polygon[next].distance(polygon[k]);
        let step = angles[next] - angles[k];
        turns += f64::from(u8::from(step < -2.0)) - f64::from(u8::from(step > 2.0));
        angle = angles[next] - angles[0] + 4.0 * turns;
    }
    if turns == 1.0 { dent } else { f64::INFINITY }
}

/// Computes a pseudo-angle of a vector: from 0 along `x` to 4, increasing with the angle, and equal on all
/// platforms.
#[inline]
fn pseudo_angle(v: DVec2) -> f64 {
    let along = v.y / (v.x.abs() + v.y.abs());
    if v.x < 0.0 {
        2.0 - along
    } else if v.y < 0.0 {
        4.0 + along
    } else {
        along
    }
}
