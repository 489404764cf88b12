//! Bodies with circular edges, approximated by hulls of ellipses, and the face of `M` that these hulls predict.
//!
//! - *Rim*: an ellipse near many vertices of a body, or a single vertex.
//! - *Outline*: the rims of a body. The lowest of them approximates the lowest point of the body.
//! - *Cap*: a face of a body that a rim bounds.
//!
//! If the line passes through a cap at the lowest point of the other body along its axis, three vertices of the rim
//! around the line make the portal. Otherwise [`mod@super::outline_maximum`] finds the slope at which both outlines
//! together are highest, and a face walk starts at the support point there. Rims are evaluated by the formula of the
//! ellipse; vertices are searched only for the portal and for the support point. The result is a guess, which later
//! stages verify. Formulas: `docs/theory/normal-guesses.md`.

use glam::{DMat2, DVec2, DVec3};

use super::face_walk::{OUTLINE_LIMITS, WalkResult, walk_from_guess};
use super::outline_maximum::{Maximum, maximise};
use super::{Context, NormalGuess, Portal, PortalStatus, normal_of};
use crate::body::{ConvexPolyhedron, MAX_RIMS, Rim};
use crate::setting::VertexPair;
use crate::setting::minkowski::{MinkowskiDifference, ShadowPoint};
use crate::solve::observe::Observer;

/// Minimum cosine of the angle between the axis of a rim and the direction for which the cap of the rim is tried.
/// Below that, the cap is nearly parallel to the direction, and the maximisation decides.
const MIN_AXIS_COSINE: f64 = 1e-3;

/// Walks to a face near the line by means of the outlines, from the guess `start`.
///
/// `None` if a body has no outline, or the maximisation leaves the range of numbers.
#[inline(never)]
pub(crate) fn walk_from_outlines<O: Observer>(
    context: &mut Context<O>,
    start: &NormalGuess,
) -> Option<(WalkResult, NormalGuess)> {
    let difference = &context.difference;
    let outlines = outlines_of(difference)?;
    if let Some(portal) = portal_in_cap(difference, &outlines) {
        return Some((WalkResult::Portal(portal, PortalStatus::ReachedByWalk), *start));
    }
    let near = |rims: [usize; 2]| {
        let [moving, fixed] = [0, 1].map(|body| outlines[body].rims[rims[body]].vertex);
        VertexPair::from_indices(moving, fixed)
    };
    Some(match maximise(&outlines, start.normal.truncate())? {
        Maximum::At(slope, active) => {
            let rims = active.map(|body| body.first_rim());
            let guess = NormalGuess { normal: normal_of(slope), near: Some(near(rims)) };
            walk_from_guess(context, &guess, &OUTLINE_LIMITS)
        }
        Maximum::Separated(ahead, rims) => {
            (WalkResult::Silhouette { outward: -ahead, edge: [near(rims); 2] }, *start)
        }
    })
}

/// Contact that outlines predict.
pub(crate) struct OutlineContact {
    /// Contact normal `(a, 1)` in the shadow frame.
    pub(crate) normal: DVec3,
    /// Points of contact in the frames of P and of Q.
    pub(crate) touching: [DVec3; 2],
    /// Vertices near the points of contact. `None` for a contact inside a cap.
    pub(crate) pair: Option<VertexPair>,
}

/// Computes the contact of the outlines of both bodies, starting at the slope `near`: in a cap, or where `f` is
/// greatest.
///
/// `None` if a body has no outline, or the line misses the outlines.
#[inline(never)]
pub(crate) fn outline_contact(
    difference: &MinkowskiDifference,
    near: DVec2,
) -> Option<OutlineContact> {
    let outlines = outlines_of(difference)?;
    let in_cap = caps_of(&outlines).find_map(|Cap { body, rim, normal, opposite }| {
        rim.enclosing_normals(-opposite.expansion_at(normal).gradient)?;
        let vertices = if body == 0 { [rim, opposite] } else { [opposite, rim] }.map(|r| r.vertex);
        let lowest = lowest_point_on_rims(difference, vertices, [normal; 2]);
        let height = normal.dot(lowest.coordinates);
        let touching = difference.points_on_line(lowest.pair, body, height);
        Some(OutlineContact { normal, touching, pair: None })
    });
    if in_cap.is_some() {
        return in_cap;
    }
    let Maximum::At(slope, active) = maximise(&outlines, near)? else { return None };
    let normal = normal_of(slope);
    let [p, q] = [0, 1].map(|body: usize| {
        let rims = &outlines[body].rims;
        let points = active[body].weighted_rims();
        points.map(|(rim, weight)| rims[rim].lowest_point(normal) * weight).sum::<DVec3>()
    });
    let offset = difference.difference(DVec3::ZERO, DVec3::ZERO);
    let touching = [
        inside_rims(difference.setting.moving, difference.to_moving_frame(-p)),
        inside_rims(difference.setting.fixed, difference.to_fixed_frame(q - offset)),
    ];
    let vertices = [0, 1].map(|body: usize| {
        let heavier = |a: (usize, f64), b: (usize, f64)| if b.1 > a.1 { b } else { a };
        let rim = active[body].weighted_rims().reduce(heavier).map_or(0, |(rim, _)| rim);
        outlines[body].rims[rim].vertex
    });
    let pair = lowest_point_on_rims(difference, vertices, [normal; 2]).pair;
    Some(OutlineContact { normal, touching, pair: Some(pair) })
}

/// Moves a point of a rim towards the centre of the body, by the sagitta of a side of a polygon with `n / 2` corners.
fn inside_rims(body: &ConvexPolyhedron, point: DVec3) -> DVec3 {
    let corners = 0.5 * body.vertices().len() as f64;
    let sagitta = 0.5 * (std::f64::consts::PI / corners).powi(2);
    point.lerp(body.inertia().center, sagitta)
}

/// Returns the outlines of both bodies as parts of `M`. `None` if a body has no outline.
fn outlines_of(difference: &MinkowskiDifference) -> Option<[Outline; 2]> {
    let setting = difference.setting;
    if setting.moving.rim_outline().len() == 0 || setting.fixed.rim_outline().len() == 0 {
        return None;
    }
    let mut outlines = [Outline::NONE; 2];
    outlines[0].set_moving(difference);
    outlines[1].set_fixed(difference);
    Some(outlines)
}

/// Rim of one body as a part of `M`, in the shadow frame.
///
/// Rims of `P` are negated. Those of `Q` are displaced by the offset between the frames of the bodies.
#[derive(Clone, Copy)]
pub(super) struct RimInDifference {
    center: DVec3,
    semi_axes: [DVec3; 2],
    vertex: u32,
    is_point: bool,
    /// Whether the body ends at the plane of the rim: on the side of [`Self::axis`], and on the other.
    ends: [bool; 2],
}

/// Outline of one body as a part of `M`.
pub(super) struct Outline {
    pub(super) rims: [RimInDifference; MAX_RIMS],
    count: usize,
}

/// Value, gradient and negative Hessian of the height of a rim at a slope.
#[derive(Clone, Copy, Default)]
pub(super) struct HeightExpansion {
    pub(super) value: f64,
    pub(super) gradient: DVec2,
    pub(super) curvature: DMat2,
}

impl Outline {
    const NONE: Self = Self { rims: [RimInDifference::POINT; MAX_RIMS], count: 0 };

    /// Stores the outline of the moving body, negated.
    fn set_moving(&mut self, difference: &MinkowskiDifference) {
        self.set_rims(difference.setting.moving.rim_outline(), |rim| {
            let [to, away] = rim.ends;
            RimInDifference {
                center: -difference.moving_normal_to_shadow(rim.center),
                ends: [away, to],
                ..RimInDifference::without_center(rim, |axis| {
                    difference.moving_normal_to_shadow(axis)
                })
            }
        });
    }

    /// Stores the outline of the fixed body, displaced by the offset between the frames.
    fn set_fixed(&mut self, difference: &MinkowskiDifference) {
        self.set_rims(difference.setting.fixed.rim_outline(), |rim| RimInDifference {
            center: difference.difference(DVec3::ZERO, rim.center),
            ..RimInDifference::without_center(rim, |axis| difference.fixed_normal_to_shadow(axis))
        });
    }

    /// Stores `rims`, each converted by `transform`.
    fn set_rims(
        &mut self,
        rims: impl ExactSizeIterator<Item = Rim>,
        transform: impl Fn(&Rim) -> RimInDifference,
    ) {
        self.count = rims.len();
        for (place, rim) in self.rims.iter_mut().zip(rims) {
            *place = transform(&rim);
        }
    }

    /// Returns the index and the height of the rim that is lowest along `normal`.
    pub(super) fn lowest(&self, normal: DVec3) -> (usize, f64) {
        let (mut lowest, mut least) = (0, f64::INFINITY);
        for (k, rim) in self.rims[..self.count].iter().enumerate() {
            let height = rim.lowest_height(normal);
            if height < least {
                (lowest, least) = (k, height);
            }
        }
        (lowest, least)
    }
}

impl RimInDifference {
    const POINT: Self = Self {
        center: DVec3::ZERO,
        semi_axes: [DVec3::ZERO; 2],
        vertex: 0,
        is_point: true,
        ends: [false; 2],
    };

    /// Transforms a rim with `transform`, without its centre.
    fn without_center(rim: &Rim, transform: impl Fn(DVec3) -> DVec3) -> Self {
        let point = Self { vertex: rim.vertex, ..Self::POINT };
        if rim.is_point() {
            return point;
        }
        let semi_axes = rim.semi_axes.map(transform);
        Self { semi_axes, is_point: false, ends: rim.ends, ..point }
    }

    /// Returns the axis, perpendicular to the rim, of any length.
    fn axis(&self) -> DVec3 {
        self.semi_axes[0].cross(self.semi_axes[1])
    }

    /// Returns normals along which three points of the rim are extreme, such that these enclose the
    /// point `line` of the shadow plane, counter-clockwise about the axis.
    ///
    /// `None` if `line` is outside the rim.
    fn enclosing_normals(&self, line: DVec2) -> Option<[DVec3; 3]> {
        let ([u, v], axis) = (self.semi_axes, self.axis());
        // Affine coordinates in which the rim is the unit circle.
        let off = line - self.center.truncate();
        let [x, y] = [off.perp_dot(v.truncate()), u.truncate().perp_dot(off)];
        let place = DVec2::new(x, y) / axis.z;
        let distance = place.length();
        if distance >= 1.0 {
            return None;
        }
        // One point opposite the line, and two whose chord is halfway between the line and the rim.
        let ahead = if distance > 0.0 { place / distance } else { DVec2::X };
        let along = 0.5 * (1.0 + distance);
        let aside = ahead.perp() * (1.0 - along * along).sqrt();
        let corners = [ahead * along - aside, ahead * along + aside, -ahead];
        let [of_x, of_y] = [axis.cross(v), u.cross(axis)];
        Some(corners.map(|corner| of_x * corner.x + of_y * corner.y))
    }

    /// Returns the height of the lowest point along `normal`.
    fn lowest_height(&self, normal: DVec3) -> f64 {
        let height = self.center.dot(normal);
        if self.is_point {
            return height;
        }
        let [u, v] = self.semi_axes.map(|axis| axis.dot(normal));
        height - (u * u + v * v).sqrt()
    }

    /// Returns the lowest point along `normal`, or the centre if all points are equally low.
    fn lowest_point(&self, normal: DVec3) -> DVec3 {
        if self.is_point {
            return self.center;
        }
        let [u, v] = self.semi_axes;
        let (along_u, along_v) = (u.dot(normal), v.dot(normal));
        let reach = (along_u * along_u + along_v * along_v).sqrt();
        if reach > 0.0 { self.center - (u * along_u + v * along_v) / reach } else { self.center }
    }

    /// Returns the height of the lowest point along `normal`, with its derivatives.
    pub(super) fn expansion_at(&self, normal: DVec3) -> HeightExpansion {
        let mut local = HeightExpansion {
            value: self.center.dot(normal),
            gradient: self.center.truncate(),
            curvature: DMat2::ZERO,
        };
        if self.is_point {
            return local;
        }
        let [u, v] = self.semi_axes;
        let (along_u, along_v) = (u.dot(normal), v.dot(normal));
        let reach = (along_u * along_u + along_v * along_v).sqrt();
        if reach > 0.0 {
            let inverse = 1.0 / reach;
            local.value -= reach;
            local.gradient -= (u * along_u + v * along_v).truncate() * inverse;
            // The curvature of an ellipse has rank 1.
            let across = (u * along_v - v * along_u).truncate();
            let bending = across * (inverse * inverse * inverse);
            local.curvature = DMat2::from_cols(across * bending.x, across * bending.y);
        }
        local
    }
}

/// Cap of the rim `rim` of `body` that may be the lowest face of `M`.
struct Cap<'o> {
    body: usize,
    rim: &'o RimInDifference,
    /// Normal `(a, 1)` of the cap.
    normal: DVec3,
    /// Rim of the other body that is lowest along the normal.
    opposite: &'o RimInDifference,
}

/// Returns the caps at which `M` may end below, those of P first.
fn caps_of(outlines: &[Outline; 2]) -> impl Iterator<Item = Cap<'_>> {
    let numbers = |of: usize| (0..outlines[of].count).map(move |k| (of, k));
    numbers(0).chain(numbers(1)).filter_map(|(body, k)| {
        let rim = &outlines[body].rims[k];
        if rim.ends == [false; 2] {
            return None;
        }
        let axis = rim.axis();
        let is_lowest = rim.ends[usize::from(axis.z > 0.0)];
        if !is_lowest || axis.z.abs() <= MIN_AXIS_COSINE * axis.length() {
            return None;
        }
        let normal = normal_of(axis.truncate() / axis.z);
        let other = &outlines[1 - body];
        let opposite = &other.rims[other.lowest(normal).0];
        Some(Cap { body, rim, normal, opposite })
    })
}

/// Returns a portal in a cap, if the line passes through the cap at the lowest point of the other outline.
/// `None` if it passes through no cap, or rounded coordinates do not prove that the portal contains it.
fn portal_in_cap(difference: &MinkowskiDifference, outlines: &[Outline; 2]) -> Option<Portal> {
    caps_of(outlines).find_map(|Cap { body, rim, normal, opposite }| {
        let places = rim.enclosing_normals(-opposite.expansion_at(normal).gradient)?;
        let vertices = [rim.vertex, opposite.vertex];
        let mut portal = if body == 0 {
            places.map(|place| lowest_point_on_rims(difference, vertices, [place, normal]))
        } else {
            let [own, opposite] = vertices;
            places.map(|place| lowest_point_on_rims(difference, [opposite, own], [normal, place]))
        };
        if rim.axis().z < 0.0 {
            portal.swap(0, 1);
        }
        let [a, b, c] = &portal;
        let is_left = |from, to| difference.is_left_rounded(from, to) == Some(true);
        (is_left(a, b) && is_left(b, c) && is_left(c, a)).then_some(portal)
    })
}

/// Returns the point of `M` that combines the vertices of two rims, each the lowest of its rim in `M`
/// along its own normal. A rim is given by one of its vertices.
fn lowest_point_on_rims(
    difference: &MinkowskiDifference,
    [moving, fixed]: [u32; 2],
    [of_moving, of_fixed]: [DVec3; 2],
) -> ShadowPoint {
    let setting = difference.setting;
    let moving = setting.moving.farthest_rim_vertex(difference.to_moving_frame(of_moving), moving);
    let fixed = setting.fixed.farthest_rim_vertex(-difference.to_fixed_frame(of_fixed), fixed);
    difference.vertex_point(VertexPair::from_indices(moving, fixed))
}
