//! Guesses the solution `p` of a cast and the half-side `delta` of its neighbourhood `N(p)`: the input of line 2 of the
//! paper's algorithm, in a query without an earlier solution.
//!
//! `p` is a pair of points, one of each body, that probably touch; only their section levels matter. Sources:
//! 1. A face of two bodies *like boxes*: with few vertices, and large faces alone.
//! 2. [`outline_contact`], if both bodies have outlines.
//! 3. A large face of one body and the vertex of the other one opposite it, if their plane proves a higher lower bound
//!    than the first normal.
//! 4. Support points of `M`, each along a slope that should move its shadow to the line (a quasi-Newton method on the
//!    concave `f` of [`portal`](super::portal), whose gradient is the shadow).
//!
//! If the line misses the face of a body like a box, both points move towards the face. On bodies like boxes a point then
//! moves towards the centre. `delta` is the lateral distance that is left, or an edge of the bodies if this is longer.

use glam::{DMat2, DVec2, DVec3};

use super::cta::LastSolution;
use super::observe::{Observer, Support};
use super::portal::{Context, NormalGuess, outline_contact};
use crate::body::{ConvexPolyhedron, LargeFace};
use crate::setting::minkowski::{MinkowskiDifference, ShadowPoint};
use crate::setting::{TwoBodies, VertexPair};

/// Maximum number of support points of one guess (measured).
const MAX_SUPPORTS: usize = 8;

/// Distance from the line at which a support point is near enough, in mean edges (measured).
const NEAR_EDGES: f64 = 2.0;

/// Maximum change of the slope in one step, relative to the length of the normal.
const MAX_STEP: f64 = 0.5;

/// Minimum cosine between a step and its remainder at which the symmetric rank-one update is made.
const MIN_UPDATE_COSINE: f64 = 1e-3;

/// Share of the distance of the last support point from the line below which a point between support points replaces
/// it (measured).
const MAX_BETWEEN: f64 = 0.9;

/// `delta` of a point between support points, as a share of their distance from each other (measured).
const BETWEEN_SHARE: f64 = 0.05;

/// Minimum cosine between the normal of a large face and the direction at which the face is tried.
const MIN_FACE_COSINE: f64 = 0.05;

/// Minimum cosine between the normal of another face of a body like a box and the direction at which this face is tried
/// (measured).
const MIN_OTHER_COSINE: f64 = 0.4;

/// Maximum number of vertices of a body like a box.
const MAX_BOX_VERTICES: usize = 32;

/// Distance of the line from a face, as a share of the length of a side, up to which it meets the face. Rounding of
/// flush faces stays far below.
const NEAR_FACE: f64 = 1e-9;

/// Share of the way to the centre of a body like a box by which a point of contact is moved. Sections through its
/// boundary may miss those of the other body.
const INSIDE_SHARE: f64 = 0.02;

/// As [`INSIDE_SHARE`], if an edge probably touches instead of the face. Cells are large, so that a shift returns to the
/// contact (measured).
const MISSED_SHARE: f64 = 0.3;

/// Least `delta` on bodies with rims, as a multiple of the radius over the number of vertices: about a side of a rim.
const RIM_EDGES: f64 = 8.0;

/// Guesses the solution. `None` if the bodies seem to miss each other, unless both are like boxes.
pub(super) fn guessed_solution<O: Observer>(context: &mut Context<O>) -> Option<LastSolution> {
    solution_near(context, NormalGuess::with_curvatures)
}

/// Guesses the solution from the normal of the contact against the direction (frame of the moving body). Two bodies like
/// boxes do not need the normal. `None` if the bodies seem to miss each other, unless both are like boxes.
pub(super) fn opposite_solution<O: Observer>(
    context: &mut Context<O>,
    normal: DVec3,
) -> Option<LastSolution> {
    let other = context.difference.moving_normal_to_shadow(normal);
    solution_near(context, |difference| NormalGuess::opposite_with_curvatures(difference, other))
}

/// Guesses the solution from a face of two bodies like boxes, or from a guess of its normal.
fn solution_near<O: Observer>(
    context: &mut Context<O>,
    guess: impl FnOnce(&MinkowskiDifference) -> (NormalGuess, [DMat2; 2]),
) -> Option<LastSolution> {
    let setting = context.difference.setting;
    if is_like_box(setting.moving) && is_like_box(setting.fixed) {
        let found = solution_on_large_face(context, f64::NEG_INFINITY);
        if found.is_some() {
            return found;
        }
    }
    let (NormalGuess { normal: first, .. }, curvatures) = guess(&context.difference);
    if first.z <= 0.0 {
        return None;
    }
    if setting.moving.may_have_rims() || setting.fixed.may_have_rims() {
        let found = solution_on_outlines(&context.difference, first.truncate());
        if found.is_some() {
            return found;
        }
    }
    let point = context.support(first, None);
    if setting.moving.has_large_faces() || setting.fixed.has_large_faces() {
        let found = solution_on_large_face(context, first.dot(point.coordinates));
        if found.is_some() {
            return found;
        }
    }
    Some(SupportSearch::new(point, first.truncate()).run(context, curvatures))
}

/// Returns the mean edge of the body with the longer edges.
fn mean_edge(difference: &MinkowskiDifference) -> f64 {
    let of =
        |body: &ConvexPolyhedron| body.inertia().radius / (body.vertices().len() as f64).sqrt();
    of(difference.setting.moving).max(of(difference.setting.fixed))
}

/// Returns the contact that the outlines predict. `None` if there is none.
fn solution_on_outlines(difference: &MinkowskiDifference, near: DVec2) -> Option<LastSolution> {
    let found = outline_contact(difference, near)?;
    let setting = difference.setting;
    let edge =
        |body: &ConvexPolyhedron| RIM_EDGES * body.inertia().radius / body.vertices().len() as f64;
    let least = edge(setting.moving).max(edge(setting.fixed));
    Some(LastSolution {
        touching: found.touching,
        half_side: setting.lateral_displacement(found.touching).max(least),
        normal: difference.to_moving_frame(found.normal),
        pair: found.pair,
    })
}

/// Contact of a large face with the vertex of the other body that is nearest to its plane.
struct FaceContact<'a> {
    /// Body of the face.
    body: usize,
    face: &'a LargeFace,
    /// Normal `(a, 1)` in the shadow frame.
    normal: DVec3,
    /// A vertex of the face, and the vertex of the other body.
    pair: VertexPair,
    /// Height at which the vertex reaches the plane: a lower bound.
    height: f64,
}

impl<'a> FaceContact<'a> {
    /// Finds the vertex for a face of a body. `None` if the face does not face the other body.
    fn new<O: Observer>(
        context: &mut Context<O>,
        body: usize,
        face: &'a LargeFace,
    ) -> Option<Self> {
        let difference = &context.difference;
        let TwoBodies { moving, fixed, .. } = difference.setting.bodies;
        let normal = if body == 0 {
            difference.moving_normal_to_shadow(face.normal)
        } else {
            -difference.fixed_normal_to_shadow(face.normal)
        };
        if normal.z <= MIN_FACE_COSINE {
            return None;
        }
        let normal = normal / normal.z;
        let own = face.corners[0];
        let farthest = |other: &ConvexPolyhedron, direction: DVec3| {
            other.support_from_guess(direction, other.support_guess(direction))
        };
        let pair = if body == 0 {
            VertexPair::from_indices(own, farthest(fixed, -difference.to_fixed_frame(normal)))
        } else {
            VertexPair::from_indices(farthest(moving, difference.to_moving_frame(normal)), own)
        };
        let point = difference.vertex_point(pair);
        context.watch.support(|| Support::from_point(normal, &point));
        let height = normal.dot(point.coordinates);
        Some(Self { body, face, normal, pair, height })
    }

    /// Replaces `highest` by this contact if this one is higher.
    fn keep_highest(self, highest: &mut Option<Self>) {
        if highest.as_ref().is_none_or(|other| self.height > other.height) {
            *highest = Some(self);
        }
    }
}

/// Returns the contact of a large face with the vertex of the other body that is nearest to its plane. `None` if
/// neither body has a face whose plane is a higher lower bound than `least`.
///
/// Tries the face of each body that is most perpendicular to the line. If the line misses the higher one, and its body is
/// like a box, tries the other faces of such bodies.
fn solution_on_large_face<O: Observer>(
    context: &mut Context<O>,
    least: f64,
) -> Option<LastSolution> {
    let TwoBodies { moving, fixed, .. } = context.difference.setting.bodies;
    let down = [
        context.difference.to_moving_frame(DVec3::Z),
        -context.difference.to_fixed_frame(DVec3::Z),
    ];
    let nearest = [moving.large_face_toward(down[0]), fixed.large_face_toward(down[1])];
    let mut highest = None;
    for (body, face) in nearest.into_iter().enumerate() {
        if let Some(contact) = face.and_then(|face| FaceContact::new(context, body, face)) {
            contact.keep_highest(&mut highest);
        }
    }
    let first_height = highest.as_ref()?.height;
    let mut points = highest.as_ref()?.points_of_contact(&context.difference);
    if points.misses_face {
        for (body, of_body) in [moving, fixed].into_iter().enumerate() {
            let faces = if is_like_box(of_body) { of_body.large_faces() } else { &[] };
            for face in faces {
                if face.normal.dot(down[body]) > MIN_OTHER_COSINE
                    && nearest[body].is_none_or(|nearest| nearest.face != face.face)
                    && let Some(contact) = FaceContact::new(context, body, face)
                {
                    contact.keep_highest(&mut highest);
                }
            }
        }
        let highest = highest.as_ref()?;
        if highest.height > first_height {
            points = highest.points_of_contact(&context.difference);
        }
    }
    let FaceContact { normal, pair, height, .. } = highest?;
    let share = if points.misses_face { MISSED_SHARE } else { INSIDE_SHARE };
    let inside = |body: &ConvexPolyhedron, point: DVec3| {
        if is_like_box(body) { point.lerp(body.inertia().center, share) } else { point }
    };
    let [p, q] = points.touching;
    (height > least).then(|| LastSolution {
        touching: [inside(moving, p), inside(fixed, q)],
        half_side: mean_edge(&context.difference),
        normal: context.difference.to_moving_frame(normal),
        pair: Some(pair),
    })
}

/// Points of contact of a face, in the frames of P and of Q.
struct FaceContactPoints {
    touching: [DVec3; 2],
    /// Whether the body of the face is like a box, and the line misses the face. Then the points are moved towards it.
    misses_face: bool,
}

impl FaceContact<'_> {
    /// Returns the points of contact on the line, moved towards the face if its body is like a box.
    fn points_of_contact(&self, difference: &MinkowskiDifference) -> FaceContactPoints {
        let TwoBodies { moving, fixed, .. } = difference.setting.bodies;
        let mut touching = difference.points_on_line(self.pair, self.body, self.height);
        let of_face = if self.body == 0 { moving } else { fixed };
        if !is_like_box(of_face) {
            return FaceContactPoints { touching, misses_face: false };
        }
        let way = way_onto_face(of_face, self.face, touching[self.body]);
        let misses_face = way != DVec3::ZERO;
        if misses_face {
            touching[self.body] += way;
            touching[1 - self.body] += if self.body == 0 {
                difference.to_fixed_frame(difference.moving_normal_to_shadow(way))
            } else {
                difference.to_moving_frame(difference.fixed_normal_to_shadow(way))
            };
        }
        FaceContactPoints { touching, misses_face }
    }
}

/// Checks whether a body has few vertices and large faces alone.
fn is_like_box(body: &ConvexPolyhedron) -> bool {
    body.vertices().len() <= MAX_BOX_VERTICES
        && body.has_large_faces()
        && body.large_faces().len() == body.face_count()
}

/// Returns the way from a point in the plane of a face towards the face: across each side beyond which the point lies,
/// one after the other. It may end outside of the face near an acute corner.
fn way_onto_face(body: &ConvexPolyhedron, face: &LargeFace, point: DVec3) -> DVec3 {
    let mut corners = body.face_vertices(face.face).map(|v| body.vertices()[v as usize]);
    let Some(first) = corners.next() else { return DVec3::ZERO };
    let (mut from, mut moved) = (first, point);
    for to in corners.chain(std::iter::once(first)) {
        let outward = (to - from).cross(face.normal);
        let excess = outward.dot(moved - from);
        if excess > NEAR_FACE * outward.length_squared() {
            moved -= outward * (excess / outward.length_squared());
        }
        from = to;
    }
    moved - point
}

/// Search for support points of `M` near the line.
struct SupportSearch {
    points: [ShadowPoint; MAX_SUPPORTS],
    count: usize,
    /// Support point nearest to the line, and its slope.
    nearest: ShadowPoint,
    slope: DVec2,
}

impl SupportSearch {
    fn new(point: ShadowPoint, slope: DVec2) -> Self {
        Self { points: [point; MAX_SUPPORTS], count: 1, nearest: point, slope }
    }

    /// Searches until a support point is near the line, or no step brings another one. `curvatures` are the Hessians of
    /// the ellipsoids' support functions.
    fn run<O: Observer>(
        mut self,
        context: &mut Context<O>,
        curvatures: [DMat2; 2],
    ) -> LastSolution {
        let least = mean_edge(&context.difference);
        let of_ellipsoids = (curvatures[0] + curvatures[1]).inverse();
        // Estimates the inverse of the negative Hessian of `f`.
        let mut inverse = of_ellipsoids;
        let is_far = |point: &ShadowPoint| point.shadow().length() > NEAR_EDGES * least;
        while self.count < MAX_SUPPORTS && is_far(&self.nearest) {
            let shadow = self.nearest.shadow();
            let step = limited_step(inverse * shadow, self.slope);
            if !step.is_finite() {
                break;
            }
            let next = context.support((self.slope + step).extend(1.0), Some(self.nearest.pair));
            if next.pair == self.nearest.pair {
                break;
            }
            self.points[self.count] = next;
            self.count += 1;
            let updated = rank_one_update(inverse, step, shadow - next.shadow());
            inverse = updated.unwrap_or(of_ellipsoids * 0.5);
            if next.shadow().length_squared() < shadow.length_squared() {
                (self.nearest, self.slope) = (next, self.slope + step);
            }
        }
        self.solution(&context.difference, curvatures, least)
    }

    /// Returns the point between support points that is nearest to the line, if it is much nearer than the nearest
    /// support point, or else this support point, moved to the line.
    fn solution(
        &self,
        difference: &MinkowskiDifference,
        curvatures: [DMat2; 2],
        least: f64,
    ) -> LastSolution {
        let setting = difference.setting;
        let normal = difference.to_moving_frame(self.slope.extend(1.0));
        let distance = self.nearest.shadow().length();
        let between = (distance > NEAR_EDGES * least)
            .then(|| nearest_between(&self.points[..self.count]))
            .flatten()
            .filter(|between| between.distance < MAX_BETWEEN * distance);
        if let Some(Between { points, weights, distance, size }) = between {
            let pairs = points.map(|k| self.points[k].pair);
            let heaviest = (1..3).fold(0, |a, b| if weights[b] > weights[a] { b } else { a });
            return LastSolution {
                touching: setting.weighted_points(&pairs, &weights),
                half_side: distance.max(BETWEEN_SHARE * size).max(least),
                normal,
                pair: Some(pairs[heaviest]),
            };
        }
        let change = (curvatures[0] + curvatures[1]).inverse() * self.nearest.shadow();
        // The supporting plane contains the way to the line, to first order.
        let in_plane = |lateral: DVec2| lateral.extend(-self.slope.dot(lateral));
        let [p, q] = setting.vertices(self.nearest.pair);
        let moved = [
            p + difference.to_moving_frame(in_plane(curvatures[0] * change)),
            q - difference.to_fixed_frame(in_plane(curvatures[1] * change)),
        ];
        let is_finite = moved.iter().all(|point| point.is_finite());
        let touching = if is_finite { moved } else { [p, q] };
        LastSolution {
            touching,
            half_side: distance.max(least),
            normal,
            pair: Some(self.nearest.pair),
        }
    }
}

/// Returns `step`, shortened if it is longer than [`MAX_STEP`] times the normal of `slope`.
fn limited_step(step: DVec2, slope: DVec2) -> DVec2 {
    let most = MAX_STEP * MAX_STEP * (1.0 + slope.length_squared());
    let square = step.length_squared();
    if square > most { step * (most / square).sqrt() } else { step }
}

/// Returns the symmetric rank-one update of `inverse` with which it maps `moved` to `step`. `None` if the update is not
/// defined or not positive definite.
fn rank_one_update(inverse: DMat2, step: DVec2, moved: DVec2) -> Option<DMat2> {
    let rest = step - inverse * moved;
    let along = rest.dot(moved);
    let least = MIN_UPDATE_COSINE * MIN_UPDATE_COSINE;
    if along * along <= least * rest.length_squared() * moved.length_squared() {
        return Some(inverse);
    }
    let share = rest / along;
    let updated = inverse + DMat2::from_cols(rest * share.x, rest * share.y);
    (updated.x_axis.x > 0.0 && updated.determinant() > 0.0).then_some(updated)
}

/// Point between three points of `M`, two of which may be equal.
struct Between {
    points: [usize; 3],
    weights: [f64; 3],
    /// Distance of the point from the line.
    distance: f64,
    /// Distance of the first two points from each other.
    size: f64,
}

/// Finds the point between two or three support points that is nearest to the line. Among triangles that contain the
/// line, selects the one with the shortest sides. `None` for a single point.
fn nearest_between(points: &[ShadowPoint]) -> Option<Between> {
    let shadow = |k: usize| points[k].shadow();
    let mut best: Option<Between> = None;
    let is_better = |best: &Option<Between>, distance: f64, size: f64| {
        best.as_ref()
            .is_none_or(|b| distance < b.distance || (distance == b.distance && size < b.size))
    };
    for i in 0..points.len() {
        for j in 0..i {
            let (a, b) = (shadow(i), shadow(j));
            let way = b - a;
            let size = way.length();
            let share = (-a.dot(way) / (size * size)).clamp(0.0, 1.0);
            let distance = (a + way * share).length();
            if is_better(&best, distance, size) {
                let weights = [1.0 - share, share, 0.0];
                best = Some(Between { points: [i, j, j], weights, distance, size });
            }
            for k in 0..j {
                let c = shadow(k);
                let parts = [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)];
                let sum: f64 = parts.iter().sum();
                let size = size.max((c - a).length());
                let contains = sum != 0.0 && parts.iter().all(|part| part * sum >= 0.0);
                if contains && is_better(&best, 0.0, size) {
                    let weights = parts.map(|part| part / sum);
                    best = Some(Between { points: [i, j, k], weights, distance: 0.0, size });
                }
            }
        }
    }
    best
}
