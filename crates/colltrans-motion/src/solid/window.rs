//! Two parts of solids in a time interval, and the planes that separate them throughout.
//!
//! - One normal `n` holds for the whole interval: `dn = 0`, `W = alpha^2 n_across` for the moving body and `-W` for the
//!   fixed one. Notation: [`curvature`](super::super::curvature).
//! - A part is a box or a facet. The bound needs the support of both parts in two directions.
//! - A plane is identified by a name, not by numbers. A proof has one letter for it, and a check tests this plane only.
//! - Normals have any length. Gaps and curvature bounds grow with it, and the error margins with the sum of its
//!   absolute components.
//!
//! Derivation: `docs/theory/motion-bounds.md`.

use glam::{DMat3, DVec3};

use super::super::arc;
use super::super::curvature::{ROOT_MARGIN, max_provable_curvature, perpendicular_part};
use super::super::proof::PlaneName;
use super::super::span::Span;
use super::tree::{BoxNode, Facet, NodeContent, SolidTree};
use colltrans_convex::body::VertexHull;
use colltrans_kernel::motion::{Piece, PiecePlacement};
use colltrans_kernel::noise::Noise;

/// Angle of rotation in radians above which the curvature bound is infinite.
const MAX_ANGLE: f64 = 2.0;

/// Maximum distance of two axes, relative to the size of the bodies, that count as one axis.
const MAX_AXIS_DISTANCE: f64 = 1e-6;

/// Error bound of a coordinate along a unit normal, in noises.
const COORDINATE_NOISES: f64 = 2.0;

/// Both bodies at one time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Snapshot {
    pub(super) time: f64,
    places: [BodyPlacement; 2],
    /// Vector from the origin of the moving body to that of the fixed one.
    offset: DVec3,
}

/// A body at one time.
#[derive(Debug, Clone, Copy)]
struct BodyPlacement {
    rotation: DMat3,
    /// Vector from a point of the axis to the origin of the body, and its component along the axis.
    arm: DVec3,
    along: f64,
}

/// Data that all parts and intervals of a span share.
#[derive(Debug, Clone)]
pub(super) struct SpanFrame<'s, 'a> {
    pub(super) span: &'s Span<'a, SolidTree<'a>>,
    /// Error bound of coordinates along a unit normal, in world units.
    coordinate_error: f64,
    /// Minimum gap of the cores, rounded up: that of the solids plus their radii.
    pub(super) core_gap: f64,
    /// Whether both bodies have the same angular velocity and axis, up to rounding. In the frame that rotates with
    /// them, one then only translates relative to the other.
    has_common_rotation: bool,
}

/// A part of a body, in the frame of the body.
#[derive(Debug, Clone, Copy)]
pub(super) enum TreePart {
    Box(BoxNode),
    Facet(Facet),
}

impl TreePart {
    /// Returns the part at a node of a tree.
    pub(super) fn at_node(tree: &SolidTree, at: u32) -> Self {
        let node = tree.node(at);
        match node.content {
            NodeContent::Facet(triangle) => Self::Facet(tree.facet(triangle)),
            NodeContent::Children(_) => Self::Box(node),
        }
    }

    /// Returns the facet, or `None` for a box.
    pub(super) fn facet(&self) -> Option<&Facet> {
        match self {
            Self::Box(_) => None,
            Self::Facet(facet) => Some(facet),
        }
    }
}

/// A part at one time: vectors with the axes of the world, from the origin of the body. For a facet they are the
/// corners, for a box its middle and the halves of its edges.
#[derive(Debug, Clone, Copy)]
struct PlacedPart {
    vectors: [DVec3; 4],
    /// Component of each vector along the axis of the body.
    along: [f64; 4],
    is_facet: bool,
}

impl PlacedPart {
    /// Places a part with a rotation.
    #[inline]
    fn new(part: &TreePart, rotation: &DMat3, axis: DVec3) -> Self {
        let vectors = match part {
            TreePart::Box(node) => {
                let half = node.half;
                let [x, y, z] = [rotation.x_axis, rotation.y_axis, rotation.z_axis];
                [*rotation * node.middle, x * half.x, y * half.y, z * half.z]
            }
            TreePart::Facet(facet) => {
                let [a, b, c] = facet.corners.map(|v| *rotation * v);
                [a, b, c, DVec3::ZERO]
            }
        };
        let along = vectors.map(|v| v.dot(axis));
        Self { vectors, along, is_facet: part.facet().is_some() }
    }

    /// Returns the middle of the part.
    #[inline]
    fn middle(&self) -> DVec3 {
        let [a, b, c, _] = self.vectors;
        if self.is_facet { (a + b + c) / 3.0 } else { a }
    }

    /// Returns the largest coordinate along a normal, and along its part perpendicular to the axis. `share` is the
    /// component of the normal along the axis.
    #[inline]
    fn max_coordinates(&self, normal: DVec3, share: f64) -> [f64; 2] {
        let [a, b, c, d] = self.vectors.map(|v| normal.dot(v));
        let [k, l, m, n] = self.along.map(|along| share * along);
        if self.is_facet {
            [a.max(b).max(c), (a - k).max(b - l).max(c - m)]
        } else {
            let side = (a - k) + ((b - l).abs() + (c - m).abs() + (d - n).abs());
            [a + (b.abs() + c.abs() + d.abs()), side]
        }
    }
}

/// Two parts in a time interval.
#[derive(Debug, Clone)]
pub(super) struct Window<'w, 's, 'a> {
    frame: &'w SpanFrame<'s, 'a>,
    ends: [&'w Snapshot; 2],
    /// The moving and the fixed part, at both ends.
    placed: [[PlacedPart; 2]; 2],
    /// Sum of the vectors between the middles at both ends.
    middle_offset: DVec3,
}

impl Snapshot {
    /// Estimates the gap of two boxes along the line through their middles. It is negative if they overlap there.
    pub(super) fn box_gap(&self, moving: &BoxNode, fixed: &BoxNode) -> f64 {
        let [p, q] = self.places.each_ref().map(|place| &place.rotation);
        let between = self.offset + (*q * fixed.middle - *p * moving.middle);
        let half = |rotation: &DMat3, half: DVec3| (rotation.transpose() * between).abs().dot(half);
        let length = between.length();
        length - (half(p, moving.half) + half(q, fixed.half)) / length.max(f64::MIN_POSITIVE)
    }
}

impl<'s, 'a> SpanFrame<'s, 'a> {
    /// Computes the error bounds and the rotation data of a span.
    pub(super) fn new(span: &'s Span<'a, SolidTree<'a>>) -> Self {
        let start = span.instant_at(span.from).bodies;
        // Bound of the distance of points of a body from its start origin within the span.
        let far = |which: usize| {
            let (piece, h) = (span.piece(which), span.to - span.from);
            let swung = 2.0 * piece.arm.length() * (piece.rate.abs() * h).min(1.0);
            span.body(which).reach() + swung + piece.velocity.length() * h
        };
        let noise = Noise::for_size(start.offset.length() + far(0) + far(1));
        let coordinate_error = COORDINATE_NOISES * noise.point_error() + span.error;
        let arms = [0, 1].map(|which| span.piece(which).arm);
        let axis_distance =
            perpendicular_part(start.offset - (arms[1] - arms[0]), span.piece(0).axis).length();
        let size = span.body(0).reach() + span.body(1).reach();
        let has_common_rotation =
            arc::has_same_spin(span) && axis_distance <= MAX_AXIS_DISTANCE * size;
        let [_, core_gap] = start.core_gap_bounds(span.min_gap);
        Self { span, coordinate_error, core_gap, has_common_rotation }
    }

    /// Computes the poses of both bodies at a time.
    pub(super) fn snapshot_at(&self, time: f64) -> Snapshot {
        let at = self.span.instant_at(time);
        let rotations = [at.bodies.moving_matrix, at.bodies.fixed_matrix];
        let place = |k: usize| {
            let (rotation, PiecePlacement { arm, .. }) = (rotations[k], at.moved[k]);
            BodyPlacement { rotation, arm, along: arm.dot(self.piece(k).axis) }
        };
        Snapshot { time, places: [place(0), place(1)], offset: at.bodies.offset }
    }

    /// Returns the piece of motion of a body.
    fn piece(&self, which: usize) -> &Piece {
        self.span.piece(which)
    }

    /// Builds the window of two parts between two times.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory it stalls its reader")]
    pub(super) fn window<'w>(
        &'w self,
        ends: [&'w Snapshot; 2],
        parts: [&TreePart; 2],
    ) -> Window<'w, 's, 'a> {
        let placed = |which: usize| {
            let (part, piece) = (parts[which], self.piece(which));
            let at =
                |end: &Snapshot| PlacedPart::new(part, &end.places[which].rotation, piece.axis);
            let first = at(ends[0]);
            [first, if piece.rate == 0.0 { first } else { at(ends[1]) }]
        };
        let placed = [placed(0), placed(1)];
        let middles = placed.each_ref().map(|[a, b]| a.middle() + b.middle());
        let middle_offset = (ends[0].offset + ends[1].offset) + (middles[1] - middles[0]);
        Window { frame: self, ends, placed, middle_offset }
    }
}

impl Window<'_, '_, '_> {
    /// Returns the angle by which a body rotates in the interval, in radians.
    #[inline]
    fn rotation_angle(&self, which: usize) -> f64 {
        (self.frame.piece(which).rate * (self.ends[1].time - self.ends[0].time)).abs()
    }

    /// Returns the larger of both angles; 0 if both bodies have the same angular velocity and axis.
    pub(super) fn max_rotation_angle(&self) -> f64 {
        if self.frame.has_common_rotation {
            return 0.0;
        }
        self.rotation_angle(0).max(self.rotation_angle(1))
    }

    /// Returns an upper bound of the distance by which the middles of both parts move relative to each other: the sum
    /// of their arcs and of the drift of the axes. If both bodies have the same angular velocity and axis, it is the
    /// drift.
    pub(super) fn travel_bound(&self) -> f64 {
        let drift =
            self.frame.span.relative_velocity().length() * (self.ends[1].time - self.ends[0].time);
        if self.frame.has_common_rotation {
            return drift;
        }
        let of = |which: usize| {
            let (piece, place) = (self.frame.piece(which), &self.ends[0].places[which]);
            let from_axis =
                perpendicular_part(place.arm + self.placed[which][0].middle(), piece.axis);
            from_axis.length() * self.rotation_angle(which)
        };
        of(0) + of(1) + drift
    }

    /// Checks whether a plane with this normal, of any length, separates both parts throughout. Returns `false` if a
    /// body rotates by more than [`MAX_ANGLE`].
    #[inline]
    fn separates_along(&self, normal: DVec3) -> bool {
        let (frame, length) = (self.frame, normal.abs().element_sum());
        let core_gap = frame.core_gap;
        let gap_margin =
            if core_gap > 0.0 { core_gap * normal.length() * (1.0 + 1e-12) } else { 0.0 };
        let coordinate_error = frame.coordinate_error * length + gap_margin;
        let shares = [0, 1].map(|k| normal.dot(self.frame.piece(k).axis));
        let mut gaps = [0.0; 2];
        // Maximum coordinates along the vectors `W`.
        let mut most = [f64::NEG_INFINITY; 2];
        for (k, end) in self.ends.into_iter().enumerate() {
            let [moving, fixed] = &end.places;
            let [high, side] = self.placed[0][k].max_coordinates(normal, shares[0]);
            let [low, back] = self.placed[1][k].max_coordinates(-normal, -shares[1]);
            gaps[k] = normal.dot(end.offset) - low - high - coordinate_error;
            if gaps[k] <= 0.0 {
                return false;
            }
            let arms = [
                normal.dot(moving.arm) - shares[0] * moving.along,
                shares[1] * fixed.along - normal.dot(fixed.arm),
            ];
            most = [most[0].max(side + arms[0]), most[1].max(back + arms[1])];
        }
        let c = self.curvature_part(0, most[0], length) + self.curvature_part(1, most[1], length);
        c <= max_provable_curvature(gaps, ROOT_MARGIN)
    }

    /// Returns the part of `C` of the moving body (0) or the fixed body (1). `most` is the larger support of the part
    /// at both ends along `W`, divided by the square of the angle. `length` is at least the length of the normal.
    #[inline]
    fn curvature_part(&self, which: usize, most: f64, length: f64) -> f64 {
        let angle = self.rotation_angle(which);
        if angle == 0.0 {
            return 0.0;
        }
        if angle > MAX_ANGLE {
            return f64::INFINITY;
        }
        // The last term bounds the rounding error.
        let size = self.frame.span.body(which).reach() + self.frame.piece(which).arm.length();
        let most = most + 1e-13 * size * length;
        // cos(x) >= 1 - x^2 / 2.
        let most = if most > 0.0 { most / (1.0 - 0.125 * angle * angle) } else { most };
        angle * angle * most
    }

    /// Returns the normal of a plane, of any length, from the moving to the fixed part. Returns `None` if the parts do
    /// not determine such a plane, or if its length is out of range.
    #[inline]
    fn plane_normal(&self, plane: PlaneName) -> Option<DVec3> {
        // A direction of a body at the middle of the interval, times two.
        let axis = |which: usize, k: usize| {
            let [a, b] = self.ends.map(|end| end.places[which].rotation.col(k));
            a + b
        };
        let edge = |which: usize, k: usize| {
            let [a, b] = &self.placed[which];
            let next = (k + 1) % 3;
            let along = (a.vectors[next] - a.vectors[k]) + (b.vectors[next] - b.vectors[k]);
            a.is_facet.then_some(along)
        };
        let along = match plane {
            PlaneName::Middles => self.middle_offset,
            PlaneName::Axis(which, k) => axis(which as usize, k as usize),
            PlaneName::FacetNormal(which) => {
                edge(which as usize, 0)?.cross(edge(which as usize, 1)?)
            }
            PlaneName::Edges(i, j) => edge(0, i as usize)?.cross(edge(1, j as usize)?),
        };
        // Products of shorter or longer vectors would leave the range.
        let is_fit = (1e-100..1e100).contains(&along.abs().max_element());
        is_fit.then_some(if along.dot(self.middle_offset) < 0.0 { -along } else { along })
    }

    /// Checks whether the plane with this name separates both parts throughout.
    #[inline]
    pub(super) fn is_separated_by(&self, plane: PlaneName) -> bool {
        self.plane_normal(plane).is_some_and(|normal| self.separates_along(normal))
            || self.is_separated_by_carried(plane)
    }

    /// Checks whether a plane separates both parts while both bodies carry it along. Returns `false` unless the bodies
    /// have the same angular velocity and axis, and the gap at the start exceeds the loss.
    fn is_separated_by_carried(&self, plane: PlaneName) -> bool {
        let SpanFrame { span, coordinate_error, core_gap, has_common_rotation } = *self.frame;
        if !has_common_rotation {
            return false;
        }
        let start = self.ends[0];
        let placed = self.placed.map(|[first, _]| [first; 2]);
        let middle_offset = (start.offset + (placed[1][0].middle() - placed[0][0].middle())) * 2.0;
        let begin = Window { frame: self.frame, ends: [start; 2], placed, middle_offset };
        let Some(normal) = begin.plane_normal(plane) else { return false };
        let [high, _] = placed[0][0].max_coordinates(normal, 0.0);
        let [low, _] = placed[1][0].max_coordinates(-normal, 0.0);
        let gap_margin = core_gap.max(0.0) * normal.length() * (1.0 + 1e-12);
        let gap = normal.dot(start.offset)
            - low
            - high
            - coordinate_error * normal.abs().element_sum()
            - gap_margin;
        let offset = start.offset - (start.places[1].arm - start.places[0].arm);
        gap > arc::carried_gap_loss(span, offset, self.ends[1].time - start.time, normal)
    }
}
