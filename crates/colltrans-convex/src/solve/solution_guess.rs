//! Guesses the solution `p` of a cast and the half-side `delta` of its neighbourhood `N(p)`: the input of line 2 of the
//! paper's algorithm, in a query without an earlier solution.
//!
//! `p` is a pair of points, one of each body, that probably touch; only their section levels matter. Sources:
//! 1. [`outline_contact`], if both bodies have outlines.
//! 2. A large face of one body and the vertex of the other one opposite it, if their plane proves a higher lower bound
//!    than the first normal.
//! 3. Support points of `M`, each along a slope that should move its shadow to the line (a quasi-Newton method on the
//!    concave `f` of [`portal`](super::portal), whose gradient is the shadow).
//!
//! `delta` is the lateral distance that is left, or an edge of the bodies if this is longer.

use glam::{DMat2, DVec2, DVec3};

use super::cta::LastSolution;
use super::observe::Observer;
use super::portal::{Context, NormalGuess, outline_contact};
use crate::body::ConvexPolyhedron;
use crate::setting::minkowski::{MinkowskiDifference, ShadowPoint};

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

/// Maximum number of vertices of a body that [`inside_box`] treats.
const MAX_BOX_VERTICES: usize = 32;

/// Share of the way to the centre by which [`inside_box`] moves a point.
const INSIDE_SHARE: f64 = 0.15;

/// Least `delta` on bodies with rims, as a multiple of the radius over the number of vertices: about a side of a rim.
const RIM_EDGES: f64 = 8.0;

/// Guesses the solution. `None` if the bodies seem to miss each other.
pub(super) fn guessed_solution<O: Observer>(context: &mut Context<O>) -> Option<LastSolution> {
    let guess = NormalGuess::with_curvatures(&context.difference);
    solution_near(context, guess)
}

/// Guesses the solution from the normal of the contact against the direction (frame of the moving body). `None` if
/// the bodies seem to miss each other.
pub(super) fn opposite_solution<O: Observer>(
    context: &mut Context<O>,
    normal: DVec3,
) -> Option<LastSolution> {
    let other = context.difference.moving_normal_to_shadow(normal);
    let guess = NormalGuess::opposite_with_curvatures(&context.difference, other);
    solution_near(context, guess)
}

/// Guesses the solution from a guess of its normal.
fn solution_near<O: Observer>(
    context: &mut Context<O>,
    (NormalGuess { normal: first, .. }, curvatures): (NormalGuess, [DMat2; 2]),
) -> Option<LastSolution> {
    if first.z <= 0.0 {
        return None;
    }
    let setting = context.difference.setting;
    if setting.moving.may_have_rims() || setting.fixed.may_have_rims() {
        let found = solution_on_outlines(&context.difference, first.truncate());
        if found.is_some() {
            return found;
        }
    }
    let point = context.support(first, None);
    if setting.moving.has_large_faces() || setting.fixed.has_large_faces() {
        let found = solution_on_large_face(context, &point, first);
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

/// Returns the contact of a large face with the vertex of the other body that is nearest to its plane. `None` if
/// neither body has a face whose plane is a higher lower bound than `point` along `first`.
fn solution_on_large_face<O: Observer>(
    context: &mut Context<O>,
    point: &ShadowPoint,
    first: DVec3,
) -> Option<LastSolution> {
    let setting = context.difference.setting;
    let mut highest = first.dot(point.coordinates);
    let mut found = None;
    for body in 0..2 {
        let difference = &context.difference;
        let normal = if body == 0 {
            let face = setting.moving.large_face_toward(difference.to_moving_frame(DVec3::Z));
            face.map(|face| difference.moving_normal_to_shadow(face.normal))
        } else {
            let face = setting.fixed.large_face_toward(-difference.to_fixed_frame(DVec3::Z));
            face.map(|face| -difference.fixed_normal_to_shadow(face.normal))
        };
        let Some(normal) = normal.filter(|normal| normal.z > MIN_FACE_COSINE) else { continue };
        let normal = normal / normal.z;
        let support = context.support(normal, Some(point.pair));
        let height = normal.dot(support.coordinates);
        if height > highest {
            highest = height;
            found = Some((body, normal, support));
        }
    }
    let (body, normal, support) = found?;
    let difference = &context.difference;
    let [p, q] = difference.points_on_line(support.pair, body, highest);
    Some(LastSolution {
        touching: [inside_box(setting.moving, p), inside_box(setting.fixed, q)],
        half_side: mean_edge(difference),
        normal: difference.to_moving_frame(normal),
        pair: Some(support.pair),
    })
}

/// Moves a point towards the centre of a body with few vertices. Sections through its boundary may miss those of the
/// other body, if an edge touches instead of the face. Its cells are large, so that a shift returns to the contact.
fn inside_box(body: &ConvexPolyhedron, point: DVec3) -> DVec3 {
    let is_box = body.vertices().len() <= MAX_BOX_VERTICES;
    if is_box { point.lerp(body.inertia().center, INSIDE_SHARE) } else { point }
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
