//! The first portal: three points of `M` whose shadows contain the line, or a proof that there are
//! none.
//!
//! Invariant. The search holds one or two points; two of them, `from` and `to`, have the line on
//! their left. The next point is sought beyond the line. A tilted normal is tried first, which
//! finds one near the lowest face, so that the first portal is small; if that one does not pass the
//! line, a lateral normal decides: either its support point passes the line, or the whole of `M`
//! lies on this side of it and the normal separates. Every step widens the angle under which the
//! line sees the points, so the search ends.

use glam::{DMat2, DVec2, DVec3};

use super::normal_guess::{slope_per_shadow, steep};
use super::{Context, FirstNormal, Known, Plane, Portal, normal_of};
use crate::setting::VertexPair;
use crate::setting::minkowski::{MinkowskiDifference, Point};
use crate::solve::observe::{Observer, Support};
use colltrans_kernel::determinant::accurate_det;

/// What the search for a first portal ends with.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Enclosure {
    /// A portal.
    Portal(Portal, Known),
    /// All of `M` lies on one side.
    Beside(SeparatingLine),
}

/// `normal . s >= margin` for every shadow `s` of `M`, up to rounding. The margin may be negative
/// by what counts as touching, when the shadow of `M` ends at the line.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SeparatingLine {
    /// Unit normal in the shadow plane.
    pub(crate) normal: DVec2,
    /// The margin.
    pub(crate) margin: f64,
    /// The support point that gives it.
    pub(crate) point: Point,
    /// Another end of an edge of the shadow, if one is known that the line may pass; else the same.
    pub(crate) end: VertexPair,
}

/// A point of `M` and the slope along which it was found lowest.
#[derive(Debug, Clone, Copy)]
struct Tangent {
    point: Point,
    slope: DVec2,
}

/// How far beyond the line the model aims, in multiples of the distance to it, try by try.
const OVERSHOOT: [f64; 2] = [1.6, 6.0];

/// Points in a row that bring the segment no nearer to the line: three are known to be needed.
const MOST_STALLS: usize = 4;

/// What counts as nearer, in noises.
const PROGRESS: f64 = 1.0 / 64.0;

/// Bound on the number of points: far beyond what any body needs; reaching it is reported, never
/// hidden.
const MAX_POINTS: usize = 10_000;

/// Finds a first portal. `None` if rounding makes the search run in a circle.
pub(crate) fn enclose<O: Observer>(
    context: &mut Context<O>,
    start: &FirstNormal,
) -> Option<Enclosure> {
    let first = match first(context, start) {
        Ok(tangent) => tangent,
        Err(line) => return Some(Enclosure::Beside(line)),
    };
    let slope_per_shadow = slope_per_shadow(&context.difference, first.slope);
    let mut search = Enclosing { context, slope_per_shadow };
    let second = match search.beyond(&[first], first.point.shadow(), first.slope) {
        Ok(tangent) => tangent,
        Err(line) => return Some(Enclosure::Beside(line)),
    };
    search.close([first, second])
}

/// The support point along the guess; if the guess is lateral, it may already separate.
#[inline(always)]
#[expect(clippy::inline_always, reason = "passed through memory a tangent stalls its reader")]
fn first<O: Observer>(
    context: &mut Context<O>,
    start: &FirstNormal,
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
    Ok(Tangent { point, slope: steep(lateral) })
}

/// In place of a guess that is lateral, if it does not separate, the steepest one on that side.
pub(crate) fn upward<O: Observer>(
    context: &mut Context<O>,
    start: &FirstNormal,
) -> Result<FirstNormal, SeparatingLine> {
    let Tangent { point, slope } = first(context, start)?;
    Ok(FirstNormal { normal: normal_of(slope), near: Some(point.pair) })
}

struct Enclosing<'c, 'a, 'o, O> {
    context: &'c mut Context<'a, 'o, O>,
    /// The change of slope that would move the shadow of a support point by minus a given vector if the
    /// bodies were ellipsoids.
    slope_per_shadow: DMat2,
}

impl<O: Observer> Enclosing<'_, '_, '_, O> {
    /// Adds points until they enclose the line. `None` if rounding makes the search run in a
    /// circle.
    fn close(&mut self, [first, second]: [Tangent; 2]) -> Option<Enclosure> {
        let mut edge = if self.context.difference.is_left(&first.point, &second.point) {
            [first, second]
        } else {
            [second, first]
        };
        for _ in 0..MAX_POINTS {
            let (toward_edge, slope) = nearest_on(&edge);
            let third = match self.beyond(&edge, toward_edge, slope) {
                Ok(tangent) => tangent,
                Err(line) => return Some(Enclosure::Beside(line)),
            };
            let [from, to] = edge;
            if !self.context.difference.is_left(&to.point, &third.point) {
                edge = [third, to];
            } else if !self.context.difference.is_left(&third.point, &from.point) {
                edge = [from, third];
            } else {
                return Some(Enclosure::Portal([from, to, third].map(|t| t.point), Known::Around));
            }
        }
        None
    }

    /// A point on the other side of the line than `near_side`, the point nearest to the line of
    /// what is known.
    ///
    /// `slope` is the slope that belongs to `near_side` by interpolation.
    fn beyond(
        &mut self,
        known: &[Tangent],
        near_side: DVec2,
        slope: DVec2,
    ) -> Result<Tangent, SeparatingLine> {
        let outward = outward(known, near_side);
        // Points closer to the line than this may be on either side of it.
        let clearly = -self.context.difference.touching();
        let clearly_scaled = clearly * outward.length();
        let near = known[known.len() - 1].point.pair;
        for factor in OVERSHOOT {
            let slope = slope + self.slope_per_shadow * near_side * factor;
            if !slope.is_finite() {
                break;
            }
            let point = self.context.difference.support_from(normal_of(slope), near);
            self.context.watch.support(|| Support::of(normal_of(slope), &point));
            if outward.dot(point.shadow()) < clearly_scaled {
                return Ok(Tangent { point, slope });
            }
        }
        let outward = outward.normalize();
        let point = self.context.difference.support(outward.extend(0.0));
        self.context.watch.support(|| Support::of(outward.extend(0.0), &point));
        let margin = outward.dot(point.shadow());
        if margin < clearly {
            return Ok(Tangent { point, slope });
        }
        // The climb may have stuck.
        let line = settled(&self.context.difference, outward, point);
        if line.margin >= clearly { Err(line) } else { Ok(Tangent { point: line.point, slope }) }
    }
}

/// From the line towards what is known: the candidate for a separating normal, of a length fit to
/// be normalised.
fn outward(known: &[Tangent], near_side: DVec2) -> DVec2 {
    if let [from, to] = known {
        // The line is on the left of the edge, so the edge is on the right of the line.
        let right = -(to.point.shadow() - from.point.shadow()).perp();
        if can_normalize(right) {
            return right;
        }
    }
    if can_normalize(near_side) { near_side } else { DVec2::X }
}

fn can_normalize(v: DVec2) -> bool {
    v.length_squared() > f64::MIN_POSITIVE
}

/// The point of the edge's shadow nearest to the line, and the slope interpolated there.
fn nearest_on(edge: &[Tangent; 2]) -> (DVec2, DVec2) {
    let [from, to] = edge;
    let (a, b) = (from.point.shadow(), to.point.shadow());
    let share = nearest_share([a, b]);
    (a + (b - a) * share, from.slope + (to.slope - from.slope) * share)
}

/// Where on a segment the line passes nearest, from 0 at its start to 1 at its end.
pub(super) fn nearest_share([from, to]: [DVec2; 2]) -> f64 {
    let along = to - from;
    let square = along.length_squared();
    if square > 0.0 { (-from.dot(along) / square).clamp(0.0, 1.0) } else { 0.0 }
}

/// The lateral normal along which the shadow of `M` keeps the largest distance from the line, from
/// one that seems to separate it.
///
/// Used when the margin found is too small to tell separation from touching: it converges to the
/// true distance of the line from the shadow (Gilbert's algorithm with segments). A margin that is
/// clearly negative says that the line is inside after all, and the climb to a support point had stuck.
pub(crate) fn widest_margin<O: Observer>(
    context: &mut Context<O>,
    found: SeparatingLine,
) -> SeparatingLine {
    let mut best = settled(&context.difference, found.normal, found.point);
    let mut segment = [best.point, context.difference.point(found.end, found.normal.extend(0.0))];
    if is_along(&segment, &best, context.difference.noise.point()) {
        return best;
    }
    let (mut nearest, mut stalls) = (f64::INFINITY, 0);
    for _ in 0..MAX_POINTS {
        let Some((normal, distance)) = from_segment(&segment) else { break };
        let lateral: DVec3 = normal.extend(0.0);
        let climbed = context.difference.support_from(lateral, segment[0].pair);
        let line = settled(&context.difference, normal, climbed);
        let SeparatingLine { margin, point, .. } = line;
        context.watch.support(|| Support::of(lateral, &point));
        if margin > best.margin {
            best = line;
        }
        let options = [[segment[0], point], [segment[1], point]];
        let away = options.map(|s| from_segment(&s).map_or(0.0, |(_, distance)| distance));
        let nearer = usize::from(away[1] < away[0]);
        // As far up to rounding, a new segment may still have the better normal.
        let closer = nearest - away[nearer] > PROGRESS * context.difference.noise.point();
        (nearest, stalls) = if closer { (away[nearer], 0) } else { (nearest, stalls + 1) };
        if distance - margin <= context.difference.noise.point() || stalls > MOST_STALLS {
            break;
        }
        segment = options[nearer];
    }
    best
}

/// Whether a segment lies in a separating line, up to rounding, and is passed between its ends no farther than
/// that says: then no normal separates more.
fn is_along(segment: &[Point; 2], found: &SeparatingLine, rounding: f64) -> bool {
    let [a, b] = segment.map(|p| p.shadow());
    let along = b - a;
    let is_between = a.dot(along) < 0.0 && b.dot(along) > 0.0;
    let is_near =
        || from_segment(segment).is_none_or(|(_, away)| away - found.margin.abs() <= rounding);
    is_between
        && [a, b].iter().all(|end| found.normal.dot(*end) - found.margin <= rounding)
        && is_near()
}

/// What a lateral unit normal separates, from where a climb to its support point has ended.
fn settled(difference: &MinkowskiDifference, normal: DVec2, climbed: Point) -> SeparatingLine {
    let point = Plane::settled(difference, normal.extend(0.0), climbed);
    SeparatingLine { normal, margin: normal.dot(point.shadow()), point, end: point.pair }
}

/// Unit normal from the line towards a segment of shadows, and the distance; without cancellation,
/// also where a long segment passes the line closely. `None` if it touches it.
fn from_segment(segment: &[Point; 2]) -> Option<(DVec2, f64)> {
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

/// The triangle of a convex quadrilateral of points of `M`, in order, that the line pierces; the last
/// two corners of a triangle are the same.
pub(crate) fn around(
    difference: &MinkowskiDifference,
    corners: &[VertexPair; 4],
) -> Option<Portal> {
    let [a, b, c, d] = corners.map(|pair| difference.vertex(pair));
    let halves = if corners[2] == corners[3] { 1 } else { 2 };
    [[a, b, c], [a, c, d]].into_iter().take(halves).find_map(|[a, b, c]| {
        match [(&a, &b), (&b, &c), (&c, &a)].map(|(from, to)| difference.is_left(from, to)) {
            [true, true, true] => Some([a, b, c]),
            [false, false, false] => Some([a, c, b]),
            _ => None,
        }
    })
}
