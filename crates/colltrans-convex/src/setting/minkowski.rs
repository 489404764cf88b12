//! The Minkowski difference `M = {q - p : p in P, q in Q}`, seen along the direction.
//!
//! Notation. The *shadow frame* has two lateral axes `e1, e2` and `d` at length 1; a point of `M`
//! has the coordinates `(s1, s2, h)`: its shadow `s` and its height `h`. The line `t d` is the axis
//! `s = 0`; the collision translation is the lowest height at which it meets `M`.
//!
//! Rounding. [`Noise`](colltrans_kernel::noise::Noise) bounds the error of a coordinate.

use std::cell::Cell;
use std::cmp::Ordering;

use glam::{DMat3, DVec2, DVec3};

use crate::setting::{Setting, VertexPair};
use colltrans_kernel::noise::{self, Noise};
use colltrans_kernel::orientation::{self, Shadow, Terms};
use colltrans_kernel::predicates::orient2d;
use colltrans_kernel::symmetric::Symmetric;

/// A vertex of `M`, in the shadow frame, and the pair of vertices it comes from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Point {
    pub(crate) at: DVec3,
    pub(crate) pair: VertexPair,
}

impl Point {
    pub(crate) fn shadow(&self) -> DVec2 {
        self.at.truncate()
    }

    pub(crate) fn height(&self) -> f64 {
        self.at.z
    }
}

/// Cosine of the largest angle by which bodies turn against each other between queries that have
/// something in common (measured).
const MIN_COSINE_BETWEEN_QUERIES: f64 = 0.94;

/// How many noises along a normal a point that the line nearly passes may be too low: with those for
/// its own height, and for dividing by the normal's share, less than an upper bound is raised by.
const MAX_RISE: f64 = 3.25;

/// Largest displacement between such queries, as a share of both bodies' radii (measured).
const MAX_DISPLACEMENT: f64 = 0.1;

/// `M` in the shadow frame: support points and orientations.
#[derive(Debug, Clone)]
pub(crate) struct MinkowskiDifference<'a> {
    pub(crate) setting: &'a Setting<'a>,
    /// Columns `e1, e2, d` in the setting frame.
    pub(crate) setting_from_shadow: DMat3,
    /// The same columns in the moving body's frame.
    moving_from_shadow: DMat3,
    /// The same columns in the fixed body's frame.
    fixed_from_shadow: DMat3,
    /// `offset` in the shadow frame.
    offset: DVec3,
    /// Bounds on rounding errors.
    pub(crate) noise: Noise,
    /// Half the longer side of a rectangle by which `M` is widened sideways: 0, or a little more
    /// than the rounding error when shadows only touch, so that the line passes through the widened
    /// body.
    pub(crate) widening: f64,
    /// The exact shadow that was needed last.
    exact_shadow_cache: Cell<Option<(VertexPair, Shadow)>>,
}

impl<'a> MinkowskiDifference<'a> {
    /// With the lateral axes turned by an angle, given by its cosine and sine.
    #[cold]
    pub(crate) fn with_rotated_axes(setting: &'a Setting<'a>, turn: DVec2) -> Self {
        let e1 = setting.unit.any_orthonormal_vector();
        Self::with_lateral_axis(
            setting,
            (e1 * turn.x + setting.unit.cross(e1) * turn.y).normalize(),
        )
    }

    /// With lateral axes along the world's where the direction is.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory it stalls its reader")]
    pub(crate) fn new(setting: &'a Setting<'a>) -> Self {
        Self::with_lateral_axis(setting, setting.unit.any_orthonormal_vector())
    }

    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory it stalls its reader")]
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
            exact_shadow_cache: Cell::new(None),
        }
    }

    /// The same body, widened sideways, if the line misses it, by `margin` more: then the line
    /// passes clearly inside.
    pub(crate) fn widened(&self, margin: f64) -> Self {
        Self { widening: self.noise.widening(margin), ..self.clone() }
    }

    /// Sideways distance below which points are not told apart.
    #[inline]
    pub(crate) fn touching(&self) -> f64 {
        self.noise.touching()
    }

    /// The point of `M` that is lowest along `normal` (shadow frame, any length).
    #[inline]
    pub(crate) fn support(&self, normal: DVec3) -> Point {
        let (p, q) = (self.setting.moving, self.setting.fixed);
        let (in_moving, in_fixed) = (self.in_moving(normal), -self.in_fixed(normal));
        // Both tables are asked before either climb, so that neither waits for the other's memory.
        let (near_p, near_q) = (p.support_guess(in_moving), q.support_guess(in_fixed));
        let moving = p.support_from_guess(in_moving, near_p);
        let fixed = q.support_from_guess(in_fixed, near_q);
        self.point(VertexPair::of(moving, fixed), normal)
    }

    /// The same, climbing from a pair believed to be near.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a direction passed through memory stalls the scan")]
    pub(crate) fn support_from(&self, normal: DVec3, near: VertexPair) -> Point {
        let moving = self.setting.moving.support_from(self.in_moving(normal), near.moving.0);
        let fixed = self.setting.fixed.support_from(-self.in_fixed(normal), near.fixed.0);
        self.point(VertexPair::of(moving, fixed), normal)
    }

    /// A normal of the shadow frame in the moving body's frame.
    #[inline]
    pub(crate) fn in_moving(&self, normal: DVec3) -> DVec3 {
        self.moving_from_shadow * normal
    }

    /// A normal of the moving body's frame in the shadow frame.
    #[inline]
    pub(crate) fn shadow_of_moving(&self, normal: DVec3) -> DVec3 {
        transpose_mul(&self.moving_from_shadow, normal)
    }

    /// A normal of the fixed body's frame in the shadow frame.
    #[inline]
    pub(crate) fn shadow_of_fixed(&self, normal: DVec3) -> DVec3 {
        transpose_mul(&self.fixed_from_shadow, normal)
    }

    /// One normal of an earlier query, kept in the frames of the moving and of the fixed body, in
    /// the shadow frame: what each body has made of it since. `None` if the bodies have turned so
    /// far against each other that nothing follows from it.
    pub(crate) fn shadow_from_bodies(
        &self,
        [in_moving, in_fixed]: [DVec3; 2],
    ) -> Option<[DVec3; 2]> {
        let p = transpose_mul(&self.moving_from_shadow, in_moving);
        let q = transpose_mul(&self.fixed_from_shadow, in_fixed);
        (p.dot(q) > MIN_COSINE_BETWEEN_QUERIES).then_some([p, q])
    }

    /// Whether points that met in an earlier query, and are a lateral distance apart now, are still
    /// near each other as bodies of this size go.
    pub(crate) fn is_near(&self, apart: f64) -> bool {
        let size = self.setting.moving.inertia().radius + self.setting.fixed.inertia().radius;
        apart < MAX_DISPLACEMENT * size
    }

    /// A normal of the shadow frame in the fixed body's frame.
    #[inline]
    pub(crate) fn in_fixed(&self, normal: DVec3) -> DVec3 {
        self.fixed_from_shadow * normal
    }

    /// The point of `M`, not widened, that a pair of vertices gives.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory it stalls its reader")]
    pub(crate) fn vertex(&self, pair: VertexPair) -> Point {
        let p = self.setting.moving.vertices()[pair.moving.index()];
        let q = self.setting.fixed.vertices()[pair.fixed.index()];
        Point { at: self.difference(p, q), pair }
    }

    /// The difference of a place in the fixed body and one in the moving body, each in its body's frame.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory it stalls its reader")]
    pub(crate) fn difference(&self, moving: DVec3, fixed: DVec3) -> DVec3 {
        (transpose_mul(&self.fixed_from_shadow, fixed)
            - transpose_mul(&self.moving_from_shadow, moving))
            + self.offset
    }

    /// The same of `M` as it is widened: the corner that is lowest along a normal.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a direction passed through memory stalls the scan")]
    pub(crate) fn point(&self, pair: VertexPair, normal: DVec3) -> Point {
        let mut point = self.vertex(pair);
        if self.widening != 0.0 {
            let [along_x, along_y] = noise::WIDENING.map(|side| side * self.widening);
            point.at.x -= along_x.copysign(normal.x);
            point.at.y -= along_y.copysign(normal.y);
        }
        point
    }

    /// The bodies' inertia ellipsoids in the shadow frame: the difference of their centres, and
    /// their matrices.
    #[inline]
    pub(crate) fn ellipsoids(&self) -> (DVec3, [Symmetric; 2]) {
        let (moving, fixed) = (self.setting.moving.inertia(), self.setting.fixed.inertia());
        let a = Symmetric::gram(&moving.axes_by_factor(&self.moving_from_shadow));
        let b = Symmetric::gram(&fixed.axes_by_factor(&self.fixed_from_shadow));
        (self.center(), [a, b])
    }

    /// The difference of the bodies' centres in the shadow frame.
    #[inline]
    pub(crate) fn center(&self) -> DVec3 {
        let (moving, fixed) = (self.setting.moving.inertia(), self.setting.fixed.inertia());
        self.difference(moving.center, fixed.center)
    }

    /// Whether balls inside the bodies prove that the shadow of `M` contains all that is nearer to
    /// the line than `margin`.
    #[inline]
    pub(crate) fn shadow_contains_disc(&self, margin: f64) -> bool {
        let radius_left = self.inner_radius() - (margin + self.noise.point());
        radius_left > 0.0 && self.center().truncate().length_squared() < radius_left * radius_left
    }

    /// The same by an edge of `M` as well, which the line passes nearby.
    ///
    /// The shadow contains the edge and the points of the disc farthest across it on either side. If these
    /// are at least `R` beyond the edge, the triangles between them and the edge contain all that is
    /// nearer to a place on it than `R e / s`, for either end at `e` from the place and `s`, at most,
    /// from these points.
    #[inline]
    pub(crate) fn shadow_contains_disc_near_edge(&self, edge: [&Point; 2], margin: f64) -> bool {
        let [from, to] = edge.map(Point::shadow);
        let center = self.center().truncate();
        let length = (to - from).length();
        let radius = self.inner_radius();
        let disc_reach = self.disc_reach_beyond_edge([from, to], length, center);
        let along = -from.dot(to - from) / length;
        let apart = from.perp_dot(to).abs() / length;
        let least = margin + apart + self.noise.point();
        let reaches = |end: DVec2, inside: f64| {
            inside * disc_reach > least * ((end - center).length() + radius)
        };
        disc_reach > 0.0 && reaches(from, along) && reaches(to, length - along)
    }

    /// How far beyond an edge of this length a disc around the centre, inside the shadow, reaches on
    /// either side.
    #[inline]
    fn disc_reach_beyond_edge(&self, [from, to]: [DVec2; 2], length: f64, center: DVec2) -> f64 {
        let away = (to - from).perp_dot(center - from).abs() / length;
        self.inner_radius() - (away + self.noise.point())
    }

    /// Radius of a ball around the centre of `M` that it contains.
    #[inline]
    fn inner_radius(&self) -> f64 {
        self.setting.moving.inertia().inner + self.setting.fixed.inertia().inner
    }

    /// Whether the line meets `M` not noticeably higher than a point of `M` which it passes within
    /// `residual`, as measured along `normal`: so the point is an upper bound, up to rounding.
    ///
    /// `M` contains the point, and a level disc around its centre; hence the cone between them. If
    /// the disc covers the line and `R` around it, the line is in the cone at `residual / R` of the
    /// way from the point to the disc_reach.
    pub(crate) fn is_upper_bound(&self, point: DVec3, residual: f64, normal: DVec3) -> bool {
        let noise = self.noise.point();
        let center = self.center();
        let disc_reach = self.inner_radius() - (center.truncate().length() + noise);
        let rise = (center.z - point.z + noise) * (normal.z / normal.length());
        disc_reach > 0.0
            && (residual + self.noise.lateral()) * rise <= MAX_RISE * noise * disc_reach
    }

    /// The same for a point on an edge in a plane across `normal`.
    ///
    /// `M` contains the edge and the disc, hence the two triangles between the edge and the points of
    /// the disc farthest across it. If these are at least `R` beyond the edge, the line is in one of
    /// the triangles at `residual / R` of the way from the edge to its third corner, and at most that
    /// share of the corner's height above the plane; the plane itself rises by the residual at most.
    pub(crate) fn is_upper_bound_on_edge(
        &self,
        edge: [&Point; 2],
        point: DVec3,
        residual: f64,
        normal: DVec3,
    ) -> bool {
        let noise = self.noise.point();
        let away = residual + self.noise.lateral();
        let [from, to] = edge.map(Point::shadow);
        let length = (to - from).length();
        let center = self.center();
        let radius = self.inner_radius();
        let disc_reach = self.disc_reach_beyond_edge([from, to], length, center.truncate());
        let rise = (normal.dot(center - point) + radius * normal.truncate().length())
            / normal.length()
            + noise;
        // The triangle's way across the edge leads along it, too.
        let along = away * (center.truncate() - point.truncate()).length();
        let inside = (point.truncate() - from).length().min((point.truncate() - to).length());
        let level = disc_reach > 0.0
            && along <= 0.5 * inside * disc_reach
            && away * (disc_reach + rise) <= MAX_RISE * noise * disc_reach;
        level || self.is_upper_bound(point, residual, normal)
    }

    /// A pair's exact shadow, computed once if it is asked for several times.
    fn cached_exact_shadow(&self, pair: VertexPair, terms: &Terms) -> Shadow {
        match self.exact_shadow_cache.get() {
            Some((cached, shadow)) if cached == pair => shadow,
            _ => {
                let new = orientation::shadow(terms, self.setting.direction);
                self.exact_shadow_cache.set(Some((pair, new)));
                new
            }
        }
    }

    /// The shadow of a pair's point of `M`, not widened, with a small error relative to its length;
    /// zero only if the line passes through the point. `None` if that is not known.
    pub(crate) fn exact_shadow(&self, pair: VertexPair) -> Option<DVec2> {
        if self.widening != 0.0 {
            return None;
        }
        let exact = self.cached_exact_shadow(pair, &self.setting.terms(pair));
        orientation::rounded(&exact, &self.setting_from_shadow, self.setting.direction)
    }

    /// Whether the line passes to the left (`true`) or to the right of the directed segment between
    /// two shadows.
    ///
    /// Exact: a rounded determinant decides where its error allows, whole numbers otherwise. Where
    /// the line meets the segment's carrier it is moved, in thought, by `(eps, eps^2)`: so it is
    /// never *on* a segment, and three consistent answers always mean a triangle that contains it.
    #[inline]
    pub(crate) fn is_left(&self, from: &Point, to: &Point) -> bool {
        match self.is_left_rounded(from, to) {
            Some(left) => left,
            None => self.is_left_exactly(from, to),
        }
    }

    /// The same, if a rounded determinant decides.
    #[inline]
    pub(crate) fn is_left_rounded(&self, from: &Point, to: &Point) -> Option<bool> {
        let (a, b) = (from.shadow(), to.shadow());
        let det = a.perp_dot(b);
        let size = a.x.abs() + a.y.abs() + b.x.abs() + b.y.abs();
        (det.abs() > 2.0 * self.noise.point() * (size + self.noise.point())).then_some(det > 0.0)
    }

    #[cold]
    #[inline(never)]
    fn is_left_exactly(&self, from: &Point, to: &Point) -> bool {
        if self.widening == 0.0 {
            let setting = self.setting;
            let (a, b) = (setting.terms(from.pair), setting.terms(to.pair));
            // The line passes near one of the two again and again.
            let from_is_near = from.shadow().length_squared() < to.shadow().length_squared();
            let (near, terms) = if from_is_near { (from.pair, &a) } else { (to.pair, &b) };
            let base = || self.cached_exact_shadow(near, terms);
            let segment = to.shadow() - from.shadow();
            if segment.length_squared() > self.touching() * self.touching() {
                let side = orientation::side(
                    &base(),
                    segment,
                    &self.setting_from_shadow,
                    setting.direction,
                    self.noise.point(),
                );
                if let Some(left) = side {
                    return left;
                }
            }
            return orientation::orientation(&a, &b, setting.direction, base) == Ordering::Greater;
        }
        // Widened bodies exist only in rounded coordinates; their determinant is exact for those.
        let (a, b) = (from.shadow(), to.shadow());
        let det = orient2d(a, b, DVec2::ZERO);
        if det != 0.0 {
            return det > 0.0;
        }
        if a.y == b.y { b.x > a.x } else { a.y > b.y }
    }
}

/// `m^T v`.
#[inline]
fn transpose_mul(m: &DMat3, v: DVec3) -> DVec3 {
    DVec3::new(m.x_axis.dot(v), m.y_axis.dot(v), m.z_axis.dot(v))
}
