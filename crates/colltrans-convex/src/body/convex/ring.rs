//! Rings: the corners around a face with many, those beside them, and the neighbours of a vertex with many, by
//! their angle.
//!
//! Notation. Seen along its *axis*, the normal of the face or that of a plane which cuts all edges of the
//! vertex, a ring is a convex polygon. Its corner farthest along a direction is the one between whose edges'
//! outward normals the direction lies: so the turn is divided into as many *cells* as there are corners, each
//! with the first corner that a direction in it may ask for, and among those of one cell the edges that rise
//! are counted by bisection. Along the rim of a cylinder that is one look or two, however many corners it has.
//!
//! What is found is where a climb goes on: of a ring that is not quite flat it need not be the farthest.
//!
//! The *rim* of a ring is the ellipse that its corners lie on, nearly: a smooth body to guess with.

use glam::{DVec2, DVec3};

use colltrans_kernel::plane::polygon_normal;
use colltrans_kernel::topology::Topology;
use colltrans_kernel::work;

/// Corners this near an ellipse, as a share of its size, are taken to lie on it.
const MAX_RIM_DEVIATION: f64 = 0.02;

/// Whose corners a ring has.
#[derive(Debug, Clone, Copy)]
pub(super) enum Cycle {
    /// Those of a face, from this half-edge on.
    Face(u32),
    /// Those that the edges which leave a face from its corners lead to, from this half-edge on.
    AdjacentToFace(u32),
    /// A vertex's neighbours.
    Fan(u32),
}

/// An ellipse, or a point, in the place of corners of a body.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rim {
    pub(crate) center: DVec3,
    /// Conjugate semi-diameters; zero of a point.
    pub(crate) semi_axes: [DVec3; 2],
    /// One of the corners.
    pub(crate) vertex: u32,
    /// Whether the body ends at its plane, towards the product of the semi-diameters and away from it.
    pub(crate) ends: [bool; 2],
}

#[derive(Debug, Clone)]
pub(super) struct Ring {
    cycle: Cycle,
    rim: Rim,
    /// Whether all corners are near the rim.
    is_round: bool,
    /// Two vectors across the axis, so that the corners run counter-clockwise.
    axes: [DVec3; 2],
    /// The corner from which corners are counted: its edge's normal has the least angle.
    first: u32,
    /// For each cell the number of corners before those that it may ask for, and the number of all.
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
    pub(super) fn from_vertex(vertex: u32, center: DVec3) -> Self {
        Self { center, semi_axes: [DVec3::ZERO; 2], vertex, ends: [false; 2] }
    }

    pub(crate) fn is_point(&self) -> bool {
        self.semi_axes == [DVec3::ZERO; 2]
    }

    /// How far it reaches along a direction, times the direction's length.
    fn support_value(&self, direction: DVec3) -> f64 {
        let [u, v] = self.semi_axes.map(|axis| axis.dot(direction));
        self.center.dot(direction) + (u * u + v * v).sqrt()
    }

    /// The same rim, knowing where the hull of it and others ends.
    pub(super) fn with_ends_among(self, outline: &[Self]) -> Self {
        let [u, v] = self.semi_axes;
        let ends = |out: DVec3| {
            outline.iter().all(|rim| rim.support_value(out) <= self.support_value(out))
        };
        let axis = u.cross(v);
        Self { ends: [axis, -axis].map(|out| !self.is_point() && ends(out)), ..self }
    }

    /// The ellipse with the mean and the moments of corners, across an axis; and whether it is near all of them.
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
        // Of corners spread evenly over an ellipse the moments are half of its squared semi-axes.
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
    /// The ring of a face.
    pub(super) fn from_face(vertices: &[DVec3], topology: &Topology, face: u32) -> Self {
        let range = topology.face(face);
        Self::from_cycle(vertices, topology, Cycle::Face(range.start), range.len() as u32)
    }

    /// That beside a face, if it is not one vertex over and over.
    pub(super) fn from_adjacent_corners(
        vertices: &[DVec3],
        topology: &Topology,
        face: u32,
    ) -> Option<Self> {
        let range = topology.face(face);
        let (cycle, count) = (Cycle::AdjacentToFace(range.start), range.len() as u32);
        let repeats =
            |k| cycle.vertex_at(topology, k) == cycle.vertex_at(topology, (k + 1) % count);
        (!(0..count).any(repeats)).then(|| Self::from_cycle(vertices, topology, cycle, count))
    }

    fn from_cycle(vertices: &[DVec3], topology: &Topology, cycle: Cycle, count: u32) -> Self {
        let corners = (0..count).map(|k| vertices[cycle.vertex_at(topology, k) as usize]);
        let axis = polygon_normal(corners.clone());
        Self::new((cycle, cycle.vertex_at(topology, 0)), axis, corners.clone(), corners).0
    }

    /// A ring, counter-clockwise about an axis, any length, with the polygon that it is seen as; and the [`dent`] of this.
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

    /// The ellipse that the corners lie on, nearly.
    pub(super) fn rim(&self) -> &Rim {
        &self.rim
    }

    /// Whether they do, all of them.
    pub(super) fn is_round(&self) -> bool {
        self.is_round
    }

    /// The number of corners.
    pub(super) fn corner_count(&self) -> u32 {
        self.cells.len() as u32 - 1
    }

    /// The vertex of a corner.
    pub(super) fn corner_vertex(&self, topology: &Topology, k: u32) -> u32 {
        self.cycle.vertex_at(topology, k)
    }

    /// The corner farthest along a direction, any length, if the edge from one corner to the next is told to rise
    /// along it or not.
    #[inline]
    fn farthest_corner(&self, direction: DVec3, rises: impl Fn(u32, u32) -> bool) -> u32 {
        let (mut low, mut high) = self.candidate_range(direction);
        while low < high {
            work::count(1);
            let middle = u32::midpoint(low, high);
            if rises(self.corner_number(middle), self.corner_number(middle + 1)) {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        self.corner_number(low)
    }

    /// A corner near that one: none before it in its cell.
    #[inline]
    pub(super) fn first_candidate(&self, direction: DVec3) -> u32 {
        self.corner_number(self.candidate_range(direction).0)
    }

    /// The first and the last corner that a direction, any length, may ask for.
    #[inline]
    fn candidate_range(&self, direction: DVec3) -> (u32, u32) {
        let count = self.corner_count();
        let along = DVec2::from(self.axes.map(|axis| axis.dot(direction)));
        // Casts saturate, so that along the axis, where it is not a number, it is cell 0.
        let cell = (pseudo_angle(along) * (0.25 * f64::from(count))) as usize;
        let cell = cell.min(count as usize - 1);
        (self.cells[cell], self.cells[cell + 1])
    }

    /// The corner that is counted so, from the first one on and once over the end at most.
    #[inline]
    fn corner_number(&self, k: u32) -> u32 {
        let (k, count) = (self.first + k, self.corner_count());
        if k >= count { k - count } else { k }
    }

    /// The vertex farthest along a direction, any length.
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

    /// Bytes on the heap.
    pub(super) fn heap_bytes(&self) -> usize {
        self.cells.capacity() * size_of::<u32>()
    }
}

/// By how much a linear function of slope 1 may rise along a polygon on its way down from the greatest value to the least,
/// or fall on the way up: nothing, up to rounding, if the polygon is convex. `angles` are those of its edges.
///
/// If edges pointed no less far round than those before them, it would not. By as much as one does, times its length, it
/// may.
fn polygon_dent(polygon: &[DVec2], angles: &[f64]) -> f64 {
    let count = angles.len();
    let (mut angle, mut max_angle, mut turns, mut dent) = (0.0_f64, 0.0_f64, 0.0, 0.0);
    for k in 0..count {
        let next = (k + 1) % count;
        max_angle = max_angle.max(angle).min(4.0);
        // Twice, as a radian is at least half of what `turn` counts.
        let off = 2.0 * (max_angle - angle).abs() + 32.0 * f64::EPSILON;
        dent += off * polygon[next].distance(polygon[k]);
        let step = angles[next] - angles[k];
        turns += f64::from(u8::from(step < -2.0)) - f64::from(u8::from(step > 2.0));
        angle = angles[next] - angles[0] + 4.0 * turns;
    }
    if turns == 1.0 { dent } else { f64::INFINITY }
}

/// How far round a vector points, from 0 along `x` to 4: alike on every machine, and rising with the angle.
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
