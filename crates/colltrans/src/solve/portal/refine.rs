//! From a portal to the lowest face of `M` on the line.
//!
//! Invariant: the three shadows, counter-clockwise, contain the line (decided exactly, with ties
//! broken consistently). Each step asks for the support point along a normal; if it lies below the
//! portal's plane it replaces one of the three, and the height at which the line passes the portal
//! falls. The end: no point of `M` is below the plane by more than rounding error; then the plane
//! proves the lower bound and the portal the upper one.

use glam::{DVec2, DVec3};

use super::Portal;
use super::enclose::{Enclosure, Guide, SeparatingLine, complete, nearest_share};
use super::graze::{Overlap, overlap};
use super::plane::{Face, Plane};
use crate::number::determinant::accurate_det;
use crate::number::plane::triangle_normal;
use crate::setting::VertexPair;
use crate::setting::minkowski::{MinkowskiDifference, Point};
use crate::solve::observe::{Observer, Support, Watch};

/// The lowest face on the line.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Optimum {
    /// Normal of its plane (shadow frame; height component > 0, any length).
    pub(crate) normal: DVec3,
    /// A pair that is lowest along `normal`.
    pub(crate) lowest: VertexPair,
    /// Barycentric weights of the line in the portal that was reached.
    pub(crate) weights: [f64; 3],
}

/// More portals than any body needs: then ties within rounding error keep following each other, and
/// points below the plane by less than what counts as touching are taken to lie on it.
const LONG: usize = 200;

/// Bound on the number of portals; reaching it is reported, never hidden.
pub(crate) const MAX_PORTALS: usize = 10_000;

/// More narrow portals than this are not widened, because that leads back to higher ones and, where rounding
/// decides, in a circle: planes through one edge are turned instead, so many times through the lowest,
/// then as often through the longest.
const MOST_WIDENED: usize = 200;
const LONG_OR_LOW: usize = 16;

/// What following portals ends with.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Refined {
    /// The lowest face.
    Lowest(Face),
    /// The line passes the rim of the shadow of `M`.
    Rim(SeparatingLine),
}

/// A portal as a face, if it is seen to be in the lowest: as it is after gift wrapping, and mostly if it
/// was followed.
#[inline(always)]
#[expect(clippy::inline_always, reason = "passed through memory it stalls its reader")]
pub(crate) fn face<O: Observer>(
    difference: &MinkowskiDifference,
    portal: &Portal,
    watch: &mut Watch<O>,
) -> Option<Face> {
    let normal = plane_normal(difference, portal)?;
    let plane = Plane::at(difference, normal, portal[2].pair)?;
    watch.portal(|| portal.map(|p| p.at));
    watch.support(|| Support::of(normal, &difference.vertex(plane.lowest)));
    Some(Face { plane, weights: weights(portal) })
}

/// Follows portals down to the optimum, and leaves the last one in place of the first. `None` if
/// there are more than `most`, for one because rounding makes them run in a circle.
#[inline]
pub(crate) fn refine<O: Observer>(
    difference: &MinkowskiDifference,
    portal: &mut Portal,
    most: usize,
    watch: &mut Watch<O>,
) -> Option<Refined> {
    let mut newest = 2;
    let (mut last, mut narrow) = (DVec3::Z, 0);
    for round in 0..most {
        watch.portal(|| portal.map(|p| p.at));
        let edge;
        let (plane, base) = match plane_normal(difference, portal) {
            Some(plane) => (plane, portal.each_ref()),
            None if narrow < MOST_WIDENED => {
                narrow += 1;
                match widen(difference, portal, watch)? {
                    Enclosure::Portal(wide) => *portal = wide,
                    Enclosure::Beside(rim) => return Some(Refined::Rim(rim)),
                }
                continue;
            }
            None => {
                narrow += 1;
                let by_length = narrow / LONG_OR_LOW % 2 == 1;
                edge =
                    if by_length { longest_edge(portal) } else { lowest_edge(difference, portal) };
                (through_edge(&edge, last), [&edge[0], &edge[1], &edge[0]])
            }
        };
        last = plane;
        let point = difference.support_from(plane, portal[newest].pair);
        watch.support(|| Support::of(plane, &point));
        let rounding = difference.noise.plane(round >= LONG);
        let below = match lowest(difference, &base.map(|p| *p), plane, point, rounding) {
            Ok(plane) => return Some(Refined::Lowest(Face { plane, weights: weights(portal) })),
            Err(point) => point,
        };
        newest = exchange(difference, portal, below);
    }
    None
}

/// The plane of a portal, if no point of `M` lies below it by more than rounding, given the support
/// point that a climb has found; else a point that does.
#[inline]
fn lowest(
    difference: &MinkowskiDifference,
    portal: &Portal,
    normal: DVec3,
    found: Point,
    rounding: f64,
) -> Result<Plane, Point> {
    if is_below(portal, normal, &found, rounding) {
        return Err(found);
    }
    settled(difference, portal, normal, found.pair, rounding)
}

/// The same of a support point that does not lie below the portal; the climb to it may have stuck.
#[inline]
fn settled(
    difference: &MinkowskiDifference,
    portal: &Portal,
    normal: DVec3,
    found: VertexPair,
    rounding: f64,
) -> Result<Plane, Point> {
    let plane = Plane::of(difference, normal, found);
    if plane.lowest == found {
        return Ok(plane);
    }
    let point = difference.vertex(plane.lowest);
    if is_below(portal, normal, &point, rounding) { Err(point) } else { Ok(plane) }
}

/// The face of an optimum that is not the portal's own, if nothing lies below it.
#[inline]
pub(crate) fn proven(
    difference: &MinkowskiDifference,
    portal: &Portal,
    optimum: &Optimum,
) -> Option<Face> {
    let Optimum { normal, lowest, weights } = *optimum;
    let rounding = difference.noise.plane(false);
    let plane = settled(difference, portal, normal, lowest, rounding).ok()?;
    Some(Face { plane, weights })
}

/// Whether a point lies below a portal by more than rounding.
#[inline]
fn is_below(portal: &Portal, normal: DVec3, point: &Point, rounding: f64) -> bool {
    depth_below(portal, normal, point) > rounding * normal.length()
}

/// The edges of a portal.
fn edges(portal: &Portal) -> [[Point; 2]; 3] {
    [(0, 1), (1, 2), (2, 0)].map(|(i, j)| [portal[i], portal[j]])
}

/// The longest edge of a portal.
fn longest_edge(portal: &Portal) -> [Point; 2] {
    let edges = edges(portal);
    edges[largest(edges.each_ref().map(|[from, to]| from.at.distance_squared(to.at)))]
}

/// The upward normal nearest to another among those of planes through an edge; the other itself if the
/// edge stands upright.
fn through_edge([from, to]: &[Point; 2], normal: DVec3) -> DVec3 {
    let edge = to.at - from.at;
    let turned = normal - edge * (normal.dot(edge) / edge.length_squared());
    if turned.z > 0.0 { turned } else { normal }
}

/// A portal with a plane in place of one too narrow to have one: over the edge that the line passes
/// lowest or, if that gives the new portal no width, around its lower point. `None` if there is
/// none.
fn widen<O: Observer>(
    difference: &MinkowskiDifference,
    portal: &Portal,
    watch: &mut Watch<O>,
) -> Option<Enclosure> {
    let edge = lowest_edge(difference, portal);
    let [from, to] = edge;
    let low = if from.height() <= to.height() { from } else { to };
    let far = farthest(difference, low, watch);
    let long = from.shadow().distance(to.shadow()) > difference.touching();
    let stars = difference.corners(&low).map(|corner| [corner, far]);
    for edge in long.then_some(edge).into_iter().chain(stars) {
        for guide in [Guide::Tilt, Guide::Lateral] {
            match complete(difference, edge, guide, watch)? {
                Enclosure::Portal(wide) if plane_normal(difference, &wide).is_none() => {}
                found => return Some(found),
            }
        }
    }
    // Only narrow portals contain a line that passes the rim.
    match overlap(difference, portal, difference.touching(), watch) {
        Overlap::Slight { inward, depth } => {
            Some(Enclosure::Beside(SeparatingLine { normal: inward, margin: -depth, point: low }))
        }
        Overlap::Ample => None,
    }
}

/// A point of `M` whose shadow is far from that of another.
fn farthest<O: Observer>(
    difference: &MinkowskiDifference,
    from: Point,
    watch: &mut Watch<O>,
) -> Point {
    let candidates = [DVec2::X, DVec2::NEG_X, DVec2::Y, DVec2::NEG_Y].map(|lateral| {
        let point = difference.support(lateral.extend(0.0));
        watch.support(|| Support::of(lateral.extend(0.0), &point));
        point
    });
    let distance = |p: &Point| p.shadow().distance_squared(from.shadow());
    candidates.into_iter().fold(from, |far, p| if distance(&p) > distance(&far) { p } else { far })
}

/// Of the edges of a narrow portal near which the line passes, the one it passes lowest.
fn lowest_edge(difference: &MinkowskiDifference, portal: &Portal) -> [Point; 2] {
    let edges = edges(portal);
    let passing = edges.map(|edge| {
        let shadows = edge.map(|p| p.shadow());
        let share = nearest_share(shadows);
        let [from, to] = edge.map(|p| p.height());
        let near = shadows[0] + (shadows[1] - shadows[0]) * share;
        (near.length(), from + (to - from) * share)
    });
    let nearest = passing.iter().map(|p| p.0).fold(f64::INFINITY, f64::min);
    let close = |k: &usize| passing[*k].0 <= nearest.max(difference.touching());
    let lowest = (0..3).filter(close).min_by(|&i, &j| passing[i].1.total_cmp(&passing[j].1));
    edges[lowest.unwrap_or(0)]
}

/// How far a point lies below all three of the portal's along `normal`, times the normal's length.
#[inline]
pub(super) fn depth_below(portal: &Portal, normal: DVec3, point: &Point) -> f64 {
    let depth = |corner: &Point| normal.dot(corner.at - point.at);
    depth(&portal[0]).min(depth(&portal[1])).min(depth(&portal[2]))
}

/// Replaces the one point whose exchange keeps the line inside, and says which.
fn exchange(difference: &MinkowskiDifference, portal: &mut Portal, new: Point) -> usize {
    let left = |i: usize| difference.is_left(&portal[i], &new);
    let (first, second) = (left(0), left(1));
    // Seen from the new point, the line is inside the triangle with the edge `i -> j` where the
    // sides change from right to left; the third point goes.
    let gone = match (first, second) {
        (false, true) => Some(2),
        (true, false) => Some(usize::from(!left(2))),
        (false, false) => left(2).then_some(0),
        (true, true) => (!left(2)).then_some(1),
    };
    if let Some(k) = gone {
        portal[k] = new;
        return k;
    }
    // All on one side: the shadows coincide, and the new point takes the place of the one it lies
    // under.
    let distances = portal.map(|p| -p.shadow().distance_squared(new.shadow()));
    let same = largest(distances);
    portal[same] = new;
    same
}

/// The upward normal of the plane through the three points; `None` if the portal is too narrow to
/// have one.
#[inline]
pub(super) fn plane_normal(difference: &MinkowskiDifference, portal: &Portal) -> Option<DVec3> {
    let normal = triangle_normal(portal.map(|p| p.at));
    is_wide(difference, portal, normal.z).then_some(normal)
}

/// Whether a portal, with twice this area, is wider than what counts as touching.
#[inline]
pub(super) fn is_wide(difference: &MinkowskiDifference, portal: &Portal, area: f64) -> bool {
    let [a, b, c] = portal.each_ref().map(Point::shadow);
    let longest = (b - a).length_squared().max((c - b).length_squared());
    let longest = longest.max((a - c).length_squared());
    let least = difference.touching();
    area > 0.0 && area * area > least * least * longest
}

/// Barycentric coordinates of the line in the shadow of the portal.
///
/// From determinants without cancellation, so that narrow portals have accurate ones; if the line
/// is outside in the rounded coordinates, those of the nearest point of the rim.
#[inline]
pub(super) fn weights(portal: &Portal) -> [f64; 3] {
    let shadows = portal.map(|p| p.shadow());
    let [a, b, c] = shadows;
    let parts = [accurate_det(b, c), accurate_det(c, a), accurate_det(a, b)];
    let sum = parts[0] + parts[1] + parts[2];
    if sum > 0.0 && parts.iter().all(|&part| part >= 0.0) {
        return parts.map(|part| part / sum);
    }
    let mut nearest = (f64::INFINITY, [1.0, 0.0, 0.0]);
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let along = shadows[j] - shadows[i];
        let share = nearest_share([shadows[i], shadows[j]]);
        let distance = (shadows[i] + along * share).length_squared();
        if distance < nearest.0 {
            let mut weights = [0.0; 3];
            (weights[i], weights[j]) = (1.0 - share, share);
            nearest = (distance, weights);
        }
    }
    nearest.1
}

pub(super) fn largest(values: [f64; 3]) -> usize {
    if values[0] >= values[1] && values[0] >= values[2] {
        0
    } else if values[1] >= values[2] {
        1
    } else {
        2
    }
}
