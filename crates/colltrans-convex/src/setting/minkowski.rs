//! The Minkowski difference `M = {q - p : p in P, q in Q}` in the shadow frame of a cast. `M` is never built.
//!
//! Notation:
//! - *Shadow frame*: two lateral axes `e1`, `e2` and the unit vector along `d`. A point of `M` has
//!   coordinates `(s1, s2, h)`: its shadow `s` and its height `h`.
//! - *The line* `t d` is the axis `s = 0`. The collision translation is the lowest height at which it
//!   intersects `M`.
//! - [`Noise`](colltrans_kernel::noise::Noise) bounds the rounding error of a coordinate.
//!
//! The shortcuts by balls inside the bodies are derived in `docs/theory/inner-balls.md`.

use std::cell::Cell;
use std::cmp::Ordering;

use glam::{DMat3, DVec2, DVec3};

use crate::setting::{Setting, VertexPair};
use colltrans_kernel::noise::{self, Noise};
use colltrans_kernel::orientation::{self, PointTerms, Shadow};
use colltrans_kernel::predicates::orient2d;
use colltrans_kernel::symmetric::Symmetric;

/// A point of `M` in the shadow frame, and the pair of vertices that defines it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ShadowPoint {
    /// Coordinates in the shadow frame, displaced to a corner of the widening rectangle if `M` is widened.
    pub(crate) coordinates: DVec3,
    /// The pair of vertices whose difference is the point.
    pub(crate) pair: VertexPair,
}

impl ShadowPoint {
    /// Returns the lateral coordinates.
    pub(crate) fn shadow(&self) -> DVec2 {
        self.coordinates.truncate()
    }

    /// Returns the coordinate along `d`, in world units.
    pub(crate) fn height(&self) -> f64 {
        self.coordinates.z
    }
}

/// A normal of an earlier query is stored in the frames of both bodies. This is the minimum cosine of the angle
/// between both copies, in the current poses, at which the earlier query is still used (measured).
const MIN_COSINE_BETWEEN_QUERIES: f64 = 0.94;

/// Maximum height of the line's entry into `M` above a nearby point that is taken as the upper bound, in
/// noises along a normal.
///
/// The point's own height and the division by the normal's component along `d` add further noises. The sum is
/// less than the amount by which an upper bound is raised.
const MAX_RISE: f64 = 3.25;

/// Maximum lateral displacement since an earlier query that is still used, as a share of the sum of both
/// bodies' radii (measured).
const MAX_DISPLACEMENT: f64 = 0.1;

/// `M` in the shadow frame: support points and orientations.
#[derive(Debug, Clone)]
pub(crate) struct MinkowskiDifference<'a> {
    /// The placed bodies and the direction.
    pub(crate) setting: &'a Setting<'a>,
    /// Columns `e1`, `e2` and the unit direction in the setting frame.
    pub(crate) setting_from_shadow: DMat3,
    /// The columns of `setting_from_shadow` in the moving body's frame.
    moving_from_shadow: DMat3,
    /// The columns of `setting_from_shadow` in the fixed body's frame.
    fixed_from_shadow: DMat3,
    /// Offset `t_Q - t_P` in the shadow frame.
    offset: DVec3,
    /// Bounds on rounding errors for the size of the configuration.
    pub(crate) noise: Noise,
    /// Half of the longer side of the rectangle by which `M` is widened laterally; 0 if `M` is not widened.
    ///
    /// Bodies whose shadows only touch are widened by slightly more than the rounding error, so that the line
    /// passes through the widened `M`.
    pub(crate) widening: f64,
    /// The shadow that was last computed in twice the working precision, with its pair.
    shadow_cache: Cell<Option<(VertexPair, Shadow)>>,
}

impl<'a> MinkowskiDifference<'a> {
    /// Builds `M` with lateral axes rotated about `d` by an angle. `turn` holds its cosine and sine.
    #[cold]
    pub(crate) fn with_rotated_axes(setting: &'a Setting<'a>, turn: DVec2) -> Self {
        let e1 = setting.unit.any_orthonormal_vector();
        Self::with_lateral_axis(
            setting,
            (e1 * turn.x + setting.unit.cross(e1) * turn.y).normalize(),
        )
    }

    /// Builds `M` with default lateral axes.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a copy through memory stalls its reader")]
    pub(crate) fn new(setting: &'a Setting<'a>) -> Self {
        Self::with_lateral_axis(setting, setting.unit.any_orthonormal_vector())
    }

    /// Builds `M` with the first lateral axis `e1`, a unit vector orthogonal to the direction.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a copy through memory stalls its reader")]
    fn with_lateral_axis(setting: &'a Setting<'a>, e1: DVec3) -> Self {
        let e2 = setting.unit.cross(e1);
        let axes = DMat3::from_cols(e1, e2, setting.unit);
        Self {
            setting,
            setting_from_shadow: axes,
            moving_from_shadow: setting.moving_matrix.transpose() * axes,
            fixed_from_shadow: setting.fixed_matrix.transpose() * axes,
            offset: axes.transpose() * setting.offset,
            noise: setting.noise(),
            widening: 0.0,
            shadow_cache: Cell::new(None),
        }
    }

    /// Returns `M` widened laterally, so that the line passes clearly inside.
    ///
    /// `margin` is the distance by which the line misses `M`. It is added to the widening if it is positive.
    pub(crate) fn widened_by(&self, margin: f64) -> Self {
        Self { widening: self.noise.widening_half_side(margin), ..self.clone() }
    }

    /// Returns the lateral distance below which points are not distinguished.
    #[inline]
    pub(crate) fn touching_distance(&self) -> f64 {
        self.noise.touching_distance()
    }

    /// Returns the point of `M` that is lowest along `normal` (shadow frame, any length).
    #[inline]
    pub(crate) fn support_point(&self, normal: DVec3) -> ShadowPoint {
        let (p, q) = (self.setting.moving, self.setting.fixed);
        let (in_moving, in_fixed) = (self.to_moving_frame(normal), -self.to_fixed_frame(normal));
        // Both table entries are loaded before either climb, so that their memory accesses overlap.
        let (near_p, near_q) = (p.support_guess(in_moving), q.support_guess(in_fixed));
        let moving = p.support_from_guess(in_moving, near_p);
        let fixed = q.support_from_guess(in_fixed, near_q);
        self.widened_point(VertexPair::from_indices(moving, fixed), normal)
    }

    /// Returns the point of `M` that is lowest along `normal` (shadow frame, any length), by hill climbing
    /// from the pair `near`.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a direction passed through memory stalls the scan")]
    pub(crate) fn support_point_from(&self, normal: DVec3, near: VertexPair) -> ShadowPoint {
        let moving =
            self.setting.moving.support_point_from(self.to_moving_frame(normal), near.moving.0);
        let fixed =
            self.setting.fixed.support_point_from(-self.to_fixed_frame(normal), near.fixed.0);
        self.widened_point(VertexPair::from_indices(moving, fixed), normal)
    }

    /// Transforms a normal from the shadow frame to the moving body's frame.
    #[inline]
    pub(crate) fn to_moving_frame(&self, normal: DVec3) -> DVec3 {
        self.moving_from_shadow * normal
    }

    /// Transforms a normal from the moving body's frame to the shadow frame.
    #[inline]
    pub(crate) fn moving_normal_to_shadow(&self, normal: DVec3) -> DVec3 {
        transpose_mul(&self.moving_from_shadow, normal)
    }

    /// Transforms a normal from the fixed body's frame to the shadow frame.
    #[inline]
    pub(crate) fn fixed_normal_to_shadow(&self, normal: DVec3) -> DVec3 {
        transpose_mul(&self.fixed_from_shadow, normal)
    }

    /// Transforms a normal of an earlier query, stored in the frames of both bodies, to the shadow frame.
    /// Returns one vector for each body.
    ///
    /// Returns `None` if the bodies have rotated relative to each other by more than the limit
    /// `MIN_COSINE_BETWEEN_QUERIES`.
    pub(crate) fn body_normals_to_shadow(
        &self,
        [in_moving, in_fixed]: [DVec3; 2],
    ) -> Option<[DVec3; 2]> {
        let p = transpose_mul(&self.moving_from_shadow, in_moving);
        let q = transpose_mul(&self.fixed_from_shadow, in_fixed);
        (p.dot(q) > MIN_COSINE_BETWEEN_QUERIES).then_some([p, q])
    }

    /// Checks whether points that touched in an earlier query are still close to each other, compared with
    /// the radii of the bodies. `apart` is their lateral distance now.
    pub(crate) fn is_near(&self, apart: f64) -> bool {
        let size = self.setting.moving.inertia().radius + self.setting.fixed.inertia().radius;
        apart < MAX_DISPLACEMENT * size
    }

    /// Transforms a normal from the shadow frame to the fixed body's frame.
    #[inline]
    pub(crate) fn to_fixed_frame(&self, normal: DVec3) -> DVec3 {
        self.fixed_from_shadow * normal
    }

    /// Returns the point of `M` for a pair of vertices, without widening.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a copy through memory stalls its reader")]
    pub(crate) fn vertex_point(&self, pair: VertexPair) -> ShadowPoint {
        let p = self.setting.moving.vertices()[pair.moving.index()];
        let q = self.setting.fixed.vertices()[pair.fixed.index()];
        ShadowPoint { coordinates: self.difference(p, q), pair }
    }

    /// Computes `q - p` in the shadow frame. Each point is in its body's frame.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a copy through memory stalls its reader")]
    pub(crate) fn difference(&self, moving: DVec3, fixed: DVec3) -> DVec3 {
        (transpose_mul(&self.fixed_from_shadow, fixed)
            - transpose_mul(&self.moving_from_shadow, moving))
            + self.offset
    }

    /// Returns the points of contact after the translation `height`, in the frames of P and of Q: the vertex of `pair`
    /// that does not belong to `body`, and the point of `body` (0 for P, 1 for Q) that it meets.
    pub(crate) fn points_on_line(&self, pair: VertexPair, body: usize, height: f64) -> [DVec3; 2] {
        let [p, q] = self.setting.vertices(pair);
        let up = DVec3::Z * height;
        if body == 0 {
            [self.to_moving_frame(self.difference(DVec3::ZERO, q) - up), q]
        } else {
            [p, self.to_fixed_frame(up - self.difference(p, DVec3::ZERO))]
        }
    }

    /// Returns the point of the widened `M` for a pair of vertices: the corner of the widening rectangle
    /// around it that is lowest along `normal`.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a direction passed through memory stalls the scan")]
    pub(crate) fn widened_point(&self, pair: VertexPair, normal: DVec3) -> ShadowPoint {
        let mut point = self.vertex_point(pair);
        if self.widening != 0.0 {
            let [along_x, along_y] = noise::WIDENING.map(|side| side * self.widening);
            point.coordinates.x -= along_x.copysign(normal.x);
            point.coordinates.y -= along_y.copysign(normal.y);
        }
        point
    }

    /// Returns the difference of the bodies' centres, and the matrices of their inertia ellipsoids, in the
    /// shadow frame.
    #[inline]
    pub(crate) fn inertia_ellipsoids(&self) -> (DVec3, [Symmetric; 2]) {
        let (moving, fixed) = (self.setting.moving.inertia(), self.setting.fixed.inertia());
        let a = Symmetric::gram_matrix(&moving.transposed_factor_product(&self.moving_from_shadow));
        let b = Symmetric::gram_matrix(&fixed.transposed_factor_product(&self.fixed_from_shadow));
        (self.center_difference(), [a, b])
    }

    /// Returns the difference of the bodies' centres, in the shadow frame.
    #[inline]
    pub(crate) fn center_difference(&self) -> DVec3 {
        let (moving, fixed) = (self.setting.moving.inertia(), self.setting.fixed.inertia());
        self.difference(moving.center, fixed.center)
    }

    /// Checks whether balls inside the bodies prove that the shadow of `M` contains all points within
    /// `margin` of the line.
    #[inline]
    pub(crate) fn shadow_contains_disc(&self, margin: f64) -> bool {
        let radius_left = self.inner_radius() - (margin + self.noise.point_error());
        radius_left > 0.0
            && self.center_difference().truncate().length_squared() < radius_left * radius_left
    }

    /// Checks whether an edge of `M` near the line and balls inside the bodies prove that the shadow of `M`
    /// contains all points within `margin` of the line.
    ///
    /// See `docs/theory/inner-balls.md`, section "Shadow around an edge".
    #[inline]
    pub(crate) fn shadow_contains_disc_near_edge(
        &self,
        edge: [&ShadowPoint; 2],
        margin: f64,
    ) -> bool {
        let [from, to] = edge.map(ShadowPoint::shadow);
        let center = self.center_difference().truncate();
        let length = (to - from).length();
        let radius = self.inner_radius();
        let disc_reach = self.disc_reach_beyond_edge([from, to], length, center);
        let along = -from.dot(to - from) / length;
        let apart = from.perp_dot(to).abs() / length;
        let least = margin + apart + self.noise.point_error();
        let reaches = |end: DVec2, inside: f64| {
            inside * disc_reach > least * ((end - center).length() + radius)
        };
        disc_reach > 0.0 && reaches(from, along) && reaches(to, length - along)
    }

    /// Returns a lower bound of the distance by which the disc inside the shadow, around `center`, reaches
    /// beyond an edge of this length, on both sides. Not positive if the disc may lie on one side.
    #[inline]
    fn disc_reach_beyond_edge(&self, [from, to]: [DVec2; 2], length: f64, center: DVec2) -> f64 {
        let away = (to - from).perp_dot(center - from).abs() / length;
        self.inner_radius() - (away + self.noise.point_error())
    }

    /// Returns the radius of a ball around the centre of `M` that lies inside `M`.
    #[inline]
    fn inner_radius(&self) -> f64 {
        self.setting.moving.inertia().inner_radius + self.setting.fixed.inertia().inner_radius
    }

    /// Checks whether a point of `M` near the line is an upper bound of the contact up to rounding.
    ///
    /// This holds if the line enters `M` at most `MAX_RISE` noises above the point, measured along `normal`.
    /// `residual` is the lateral distance of the point from the line. See `docs/theory/inner-balls.md`,
    /// section "Upper bound at a point".
    pub(crate) fn is_upper_bound(&self, point: DVec3, residual: f64, normal: DVec3) -> bool {
        let noise = self.noise.point_error();
        let center = self.center_difference();
        let disc_reach = self.inner_radius() - (center.truncate().length() + noise);
        let rise = (center.z - point.z + noise) * (normal.z / normal.length());
        disc_reach > 0.0
            && (residual + self.noise.lateral_error()) * rise <= MAX_RISE * noise * disc_reach
    }

    /// Checks whether a point on an edge of `M` is an upper bound of the contact up to rounding. The edge
    /// lies in a plane with this normal.
    ///
    /// If the edge does not prove it, [`Self::is_upper_bound`] decides. See `docs/theory/inner-balls.md`,
    /// section "Upper bound on an edge".
    pub(crate) fn is_upper_bound_on_edge(
        &self,
        edge: [&ShadowPoint; 2],
        point: DVec3,
        residual: f64,
        normal: DVec3,
    ) -> bool {
        let noise = self.noise.point_error();
        let away = residual + self.noise.lateral_error();
        let [from, to] = edge.map(ShadowPoint::shadow);
        let length = (to - from).length();
        let center = self.center_difference();
        let radius = self.inner_radius();
        let disc_reach = self.disc_reach_beyond_edge([from, to], length, center.truncate());
        let rise = (normal.dot(center - point) + radius * normal.truncate().length())
            / normal.length()
            + noise;
        // Moving towards the apex of the triangle also shifts the point along the edge.
        let along = away * (center.truncate() - point.truncate()).length();
        let inside = (point.truncate() - from).length().min((point.truncate() - to).length());
        let level = disc_reach > 0.0
            && along <= 0.5 * inside * disc_reach
            && away * (disc_reach + rise) <= MAX_RISE * noise * disc_reach;
        level || self.is_upper_bound(point, residual, normal)
    }

    /// Computes the shadow of a pair's point in twice the working precision, with an error bound. Returns the
    /// cached value if the pair is that of the last call. `terms` are those of the pair.
    fn cached_shadow(&self, pair: VertexPair, terms: &PointTerms) -> Shadow {
        match self.shadow_cache.get() {
            Some((cached, shadow)) if cached == pair => shadow,
            _ => {
                let new = orientation::shadow_of_point(terms, self.setting.direction);
                self.shadow_cache.set(Some((pair, new)));
                new
            }
        }
    }

    /// Computes the shadow of a pair's point of `M` with a small error relative to its length. The shadow is
    /// zero only if the line passes through the point.
    ///
    /// Returns `None` if `M` is widened, or if the precision does not suffice.
    pub(crate) fn precise_shadow(&self, pair: VertexPair) -> Option<DVec2> {
        if self.widening != 0.0 {
            return None;
        }
        let exact = self.cached_shadow(pair, &self.setting.terms(pair));
        orientation::lateral_coordinates(&exact, &self.setting_from_shadow, self.setting.direction)
    }

    /// Checks whether the line passes to the left (`true`) or to the right of the directed segment between
    /// the shadows of two points.
    ///
    /// The decision is exact: a rounded determinant if its error allows, otherwise exact arithmetic. Ties are
    /// broken by simulation of simplicity (Edelsbrunner and Muecke, ACM Transactions on Graphics 9(1), 1990): the
    /// line is displaced symbolically by `(eps, eps^2)`. It is therefore never *on* a segment, and three consistent
    /// answers always mean a triangle that contains it.
    #[inline]
    pub(crate) fn is_left(&self, from: &ShadowPoint, to: &ShadowPoint) -> bool {
        match self.is_left_rounded(from, to) {
            Some(left) => left,
            None => self.is_left_exactly(from, to),
        }
    }

    /// Returns the answer of [`Self::is_left`] if a rounded determinant decides it, otherwise `None`.
    #[inline]
    pub(crate) fn is_left_rounded(&self, from: &ShadowPoint, to: &ShadowPoint) -> Option<bool> {
        let (a, b) = (from.shadow(), to.shadow());
        let det = a.perp_dot(b);
        let size = a.x.abs() + a.y.abs() + b.x.abs() + b.y.abs();
        (det.abs() > 2.0 * self.noise.point_error() * (size + self.noise.point_error()))
            .then_some(det > 0.0)
    }

    /// Decides [`Self::is_left`] exactly. Widened bodies are decided in their rounded coordinates.
    #[cold]
    #[inline(never)]
    fn is_left_exactly(&self, from: &ShadowPoint, to: &ShadowPoint) -> bool {
        if self.widening == 0.0 {
            let setting = self.setting;
            let (a, b) = (setting.terms(from.pair), setting.terms(to.pair));
            // Repeated calls share the point near the line, so its shadow is cached.
            let from_is_near = from.shadow().length_squared() < to.shadow().length_squared();
            let (near, terms) = if from_is_near { (from.pair, &a) } else { (to.pair, &b) };
            let base = || self.cached_shadow(near, terms);
            let segment = to.shadow() - from.shadow();
            if segment.length_squared() > self.touching_distance() * self.touching_distance() {
                let side = orientation::is_left_of_segment(
                    &base(),
                    segment,
                    &self.setting_from_shadow,
                    setting.direction,
                    self.noise.point_error(),
                );
                if let Some(left) = side {
                    return left;
                }
            }
            return orientation::perturbed_orientation(&a, &b, setting.direction, base)
                == Ordering::Greater;
        }
        // Widened bodies are defined by rounded coordinates, for which `orient2d` is exact.
        let (a, b) = (from.shadow(), to.shadow());
        let det = orient2d(a, b, DVec2::ZERO);
        if det != 0.0 {
            return det > 0.0;
        }
        if a.y == b.y { b.x > a.x } else { a.y > b.y }
    }
}

/// Computes `m^T v`.
#[inline]
fn transpose_mul(m: &DMat3, v: DVec3) -> DVec3 {
    DVec3::new(m.x_axis.dot(v), m.y_axis.dot(v), m.z_axis.dot(v))
}
