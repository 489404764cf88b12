//! Finds a first portal, three points of `M` whose shadows enclose the line, or a separating line (*portal discovery*
//! in Snethen's method).
//!
//! Invariant: the search holds one or two points. Two points `from`, `to` have the line on their left.
//!
//! Each step searches for a point across the line:
//! 1. Along a tilted normal. This finds points near the lowest face, so that the first portal is small.
//! 2. If this point is not across the line, along a lateral normal. Either its support point is across
//!    the line, or all of `M` is on this side and the normal separates.
//!
//! Every step increases the angle that the points subtend at the line; therefore the search ends.

use glam::{DMat2, DVec2, DVec3};

use super::normal_guess::{slope_per_shadow, steepest_slope};
use super::{Context, NormalGuess, Plane, Portal, PortalStatus, normal_of};
use crate::setting::VertexPair;
use crate::setting::minkowski::{MinkowskiDifference, ShadowPoint};
use crate::solve::observe::{Observer, Support};
use colltrans_kernel::determinant::accurate_det;

/// Result of the search for a first portal.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Enclosure {
    /// A portal, and how much is proven about it.
    Portal(Portal, PortalStatus),
    /// A separating line: all of `M` is on one side of it.
    Separated(SeparatingLine),
}

/// Line in the shadow plane with `normal . s >= margin` for the shadow `s` of every point of `M`, up
/// to rounding.
///
/// If the shadow of `M` ends at the line `t d`, the margin may be negative, down to minus the touching
/// distance.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SeparatingLine {
    /// Unit normal in the shadow plane.
    pub(crate) normal: DVec2,
    /// Smallest `normal . s`, the signed distance from the line `t d`.
    pub(crate) margin: f64,
    /// Support point that attains the margin.
    pub(crate) point: ShadowPoint,
    /// Other end of an edge of the silhouette that the line may touch, if one is known. Otherwise the
    /// pair of `point`.
    pub(crate) end: VertexPair,
}

/// Point of `M` with a slope along which it is lowest. For a point found along a lateral normal the
/// slope is an estimate.
#[derive(Debug, Clone, Copy)]
struct Tangent {
    point: ShadowPoint,
    slope: DVec2,
}

/// Step sizes of the tries, in multiples of the step that would reach the line for ellipsoids.
const STEP_FACTORS: [f64; 2] = [1.6, 6.0];

/// Maximum number of consecutive points that bring the segment no nearer to the line. Three are known
/// to be needed.
const MAX_STALLS: usize = 4;

/// Smallest decrease of the distance that counts as progress, in noises.
const PROGRESS: f64 = 1.0 / 64.0;

/// Maximum number of points, far above what any body needs. If [`enclose`] reaches it, it returns
/// `None`, and the cast fails if this happens in all frames. [`widest_margin`] returns its best line.
const MAX_POINTS: usize = 10_000;

/// Finds a first portal or a separating line. `None` if rounding makes the search cycle.
pub(crate) fn enclose<O: Observer>(
    context: &mut Context<O>,
    start: &NormalGuess,
) -> Option<Enclosure> {
    let first = match first_tangent(context, start) {
        Ok(tangent) => tangent,
        Err(line) => return Some(Enclosure::Separated(line)),
    };
    let slope_per_shadow = slope_per_shadow(&context.difference, first.slope);
    let mut search = PortalSearch { context, slope_per_shadow };
    let second = match search.tangent_across(&[first], first.point.shadow(), first.slope) {
        Ok(tangent) => tangent,
        Err(line) => return Some(Enclosure::Separated(line)),
    };
    search.enclose_line([first, second])
}

/// Returns the tangent along the guess. If the guess is lateral and separates, returns the separating
/// line as the error.
#[inline(always)]
#[expect(clippy::inline_always, reason = "a tangent copied through memory stalls")]
fn first_tangent<O: Observer>(
    context: &mut Context<O>,
    start: &NormalGuess,
) -> Result<Tangent, SeparatingLine> {
    let normal = start.normal;
    let point = context.support(normal, start.near);
    if normal.z != 0.0 {
        return Ok(Tangent { point, slope: normal.truncate() });
    }
    let lateral = normal.truncate().normalize_or_zero();
    let margin = lateral.dot(point.shadow());
    if margin > 0.0 {
        return Err(SeparatingLine { normal: lateral, margin, point, end: point.pair });
    }
    Ok(Tangent { point, slope: steepest_slope(lateral) })
}

/// Replaces a lateral guess by the steepest one on the same side. If the lateral guess separates,
/// returns the separating line as the error.
pub(crate) fn upward_guess<O: Observer>(
    context: &mut Context<O>,
    start: &NormalGuess,
) -> Result<NormalGuess, SeparatingLine> {
    let Tangent { point, slope } = first_tangent(context, start)?;
    Ok(NormalGuess { normal: normal_of(slope), near: Some(point.pair) })
}

struct PortalSearch<'c, 'a, 'o, O> {
    context: &'c mut Context<'a, 'o, O>,
    /// Change of slope that moves the shadow of a support point by minus a given vector, if the bodies
    /// were ellipsoids.
    slope_per_shadow: DMat2,
}

impl<O: Observer> PortalSearch<'_, '_, '_, O> {
    /// Adds points until they enclose the line. `None` if rounding makes the search cycle.
    fn enclose_line(&mut self, [first, second]: [Tangent; 2]) -> Option<Enclosure> {
        let mut edge = if self.context.difference.is_left(&first.point, &second.point) {
            [first, second]
        } else {
            [second, first]
        };
        for _ in 0..MAX_POINTS {
            let (toward_edge, slope) = nearest_point_and_slope(&edge);
            let third = match self.tangent_across(&edge, toward_edge, slope) {
                Ok(tangent) => tangent,
                Err(line) => return Some(Enclosure::Separated(line)),
            };
            let [from, to] = edge;
            if !self.context.difference.is_left(&to.point, &third.point) {
                edge = [third, to];
            } else if !self.context.difference.is_left(&third.point, &from.point) {
                edge = [from, third];
            } else {
                return Some(Enclosure::Portal(
                    [from, to, third].map(|t| t.point),
                    PortalStatus::EnclosesLine,
                ));
            }
        }
        None
    }

    /// Finds a tangent on the other side of the line than `near_side`. If there is no such point, returns
    /// a separating line as the error.
    ///
    /// `near_side` is the point nearest to the line on the shadow of the known points, and `slope` the
    /// slope interpolated there.
    fn tangent_across(
        &mut self,
        known: &[Tangent],
        near_side: DVec2,
        slope: DVec2,
    ) -> Result<Tangent, SeparatingLine> {
        let outward = separating_candidate(known, near_side);
        // A point nearer to the line than this may be on either side of it.
        let least_margin = -self.context.difference.touching_distance();
        let least_scaled = least_margin * outward.length();
        let near = known[known.len() - 1].point.pair;
        for factor in STEP_FACTORS {
            let slope = slope + self.slope_per_shadow * near_side * factor;
            if !slope.is_finite() {
                break;
            }
            let point = self.context.difference.support_point_from(normal_of(slope), near);
            self.context.watch.support(|| Support::from_point(normal_of(slope), &point));
            if outward.dot(point.shadow()) < least_scaled {
                return Ok(Tangent { point, slope });
            }
        }
        let outward = outward.normalize();
        let point = self.context.difference.support_point(outward.extend(0.0));
        self.context.watch.support(|| Support::from_point(outward.extend(0.0), &point));
        let margin = outward.dot(point.shadow());
        if margin < least_margin {
            return Ok(Tangent { point, slope });
        }
        // The hill climb may have stopped short of the support point.
        let line = verified_line(&self.context.difference, outward, point);
        if line.margin >= least_margin {
            Err(line)
        } else {
            Ok(Tangent { point: line.point, slope })
        }
    }
}

/// Returns the candidate for a separating normal, long enough to be normalised.
///
/// For two known points it is perpendicular to their edge and points from the line to the edge. If there is only one
/// point, or the edge is too short, it is `near_side`, or `X` if `near_side` is too short as well.
fn separating_candidate(known: &[Tangent], near_side: DVec2) -> DVec2 {
    if let [from, to] = known {
        // The line is on the left of the edge; therefore the edge is on the right of the line.
        let right = -(to.point.shadow() - from.point.shadow()).perp();
        if can_normalize(right) {
            return right;
        }
    }
    if can_normalize(near_side) { near_side } else { DVec2::X }
}

/// Checks that a vector is long enough to be normalised.
fn can_normalize(v: DVec2) -> bool {
    v.length_squared() > f64::MIN_POSITIVE
}

/// Returns the point of the edge's shadow nearest to the line, and the slope interpolated there.
fn nearest_point_and_slope(edge: &[Tangent; 2]) -> (DVec2, DVec2) {
    let [from, to] = edge;
    let (a, b) = (from.point.shadow(), to.point.shadow());
    let share = nearest_parameter([a, b]);
    (a + (b - a) * share, from.slope + (to.slope - from.slope) * share)
}

/// Returns the parameter of the point of a segment nearest to the line, from 0 at its start to 1 at
/// its end.
pub(super) fn nearest_parameter([from, to]: [DVec2; 2]) -> f64 {
    let along = to - from;
    let square = along.length_squared();
    if square > 0.0 { (-from.dot(along) / square).clamp(0.0, 1.0) } else { 0.0 }
}

/// Maximises the margin of a separating line: finds the lateral normal along which the shadow of `M` is
/// farthest from the line `t d`.
///
/// Used if the margin of `found` is too small to distinguish separation from touching. Converges to
/// the distance of the line from the shadow (Gilbert's algorithm with segments). If the margin is
/// clearly negative, the line is inside the shadow, and an earlier hill climb had stopped short.
pub(crate) fn widest_margin<O: Observer>(
    context: &mut Context<O>,
    found: SeparatingLine,
) -> SeparatingLine {
    let mut best = verified_line(&context.difference, found.normal, found.point);
    let mut segment =
        [best.point, context.difference.widened_point(found.end, found.normal.extend(0.0))];
    if is_widest_segment(&segment, &best, context.difference.noise.point_error()) {
        return best;
    }
    let (mut nearest, mut stalls) = (f64::INFINITY, 0);
    for _ in 0..MAX_POINTS {
        let Some((normal, distance)) = normal_and_distance(&segment) else { break };
        let lateral: DVec3 = normal.extend(0.0);
        let climbed = context.difference.support_point_from(lateral, segment[0].pair);
        let line = verified_line(&context.difference, normal, climbed);
        let SeparatingLine { margin, point, .. } = line;
        context.watch.support(|| Support::from_point(lateral, &point));
        if margin > best.margin {
            best = line;
        }
        let options = [[segment[0], point], [segment[1], point]];
        let away = options.map(|s| normal_and_distance(&s).map_or(0.0, |(_, distance)| distance));
        let nearer = usize::from(away[1] < away[0]);
        // A segment at the same distance, up to rounding, may still have a better normal.
        let closer = nearest - away[nearer] > PROGRESS * context.difference.noise.point_error();
        (nearest, stalls) = if closer { (away[nearer], 0) } else { (nearest, stalls + 1) };
        if distance - margin <= context.difference.noise.point_error() || stalls > MAX_STALLS {
            break;
        }
        segment = options[nearer];
    }
    best
}

/// Checks that a segment lies in the separating line, up to rounding, and that the line `t d` passes
/// it between its ends at a distance of no more than `|margin|`. Then no normal has a larger margin.
fn is_widest_segment(segment: &[ShadowPoint; 2], found: &SeparatingLine, rounding: f64) -> bool {
    let [a, b] = segment.map(|p| p.shadow());
    let along = b - a;
    let is_between = a.dot(along) < 0.0 && b.dot(along) > 0.0;
    let is_near = || {
        normal_and_distance(segment).is_none_or(|(_, away)| away - found.margin.abs() <= rounding)
    };
    is_between
        && [a, b].iter().all(|end| found.normal.dot(*end) - found.margin <= rounding)
        && is_near()
}

/// Returns the separating line of a lateral unit normal, given the vertex at which a climb stopped.
fn verified_line(
    difference: &MinkowskiDifference,
    normal: DVec2,
    climbed: ShadowPoint,
) -> SeparatingLine {
    let point = Plane::verified_support_point(difference, normal.extend(0.0), climbed);
    SeparatingLine { normal, margin: normal.dot(point.shadow()), point, end: point.pair }
}

/// Returns the unit normal from the line towards a segment of shadows, and their distance. `None` if
/// the line touches the segment.
///
/// There is no cancellation, not even if the line is close to a long segment.
fn normal_and_distance(segment: &[ShadowPoint; 2]) -> Option<(DVec2, f64)> {
    let [a, b] = segment.map(|p| p.shadow());
    let along = b - a;
    if a.dot(along) < 0.0 && b.dot(along) > 0.0 {
        let length = along.length();
        let distance = accurate_det(a, b) / length;
        let right = -along.perp() / length;
        return (distance != 0.0).then(|| (right * distance.signum(), distance.abs()));
    }
    let end = if a.dot(along) >= 0.0 { a } else { b };
    Some((end.try_normalize()?, end.length()))
}

/// Returns the triangle that the line pierces, of a convex quadrilateral of points of `M` in order. If
/// it is a triangle, its last two corners are equal.
pub(crate) fn pierced_triangle(
    difference: &MinkowskiDifference,
    corners: &[VertexPair; 4],
) -> Option<Portal> {
    let [a, b, c, d] = corners.map(|pair| difference.vertex_point(pair));
    let halves = if corners[2] == corners[3] { 1 } else { 2 };
    [[a, b, c], [a, c, d]].into_iter().take(halves).find_map(|[a, b, c]| {
        match [(&a, &b), (&b, &c), (&c, &a)].map(|(from, to)| difference.is_left(from, to)) {
            [true, true, true] => Some([a, b, c]),
            [false, false, false] => Some([a, c, b]),
            _ => None,
        }
    })
}
