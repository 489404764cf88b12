//! Overlap of the shadows: the distance from the line to the silhouette of `M`.
//!
//! Invariant: the shadows of some points of `M` form a convex polygon that contains the line. The
//! distance to its nearest edge is a lower bound of the overlap. The support point beyond this edge
//! yields an upper bound and becomes a corner. If balls inside the bodies already prove an overlap
//! above the tolerance, no polygon is built.

use glam::DVec2;

use super::{Context, Plane};
use crate::setting::minkowski::ShadowPoint;
use crate::solve::observe::{Observer, Support};
use colltrans_kernel::determinant::accurate_det;

/// Comparison of the overlap with a tolerance.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Overlap {
    /// The overlap exceeds the tolerance.
    Ample,
    /// The overlap is at most the tolerance: `inward . s >= -depth` for every shadow `s`, with
    /// equality up to rounding.
    Slight {
        /// Unit vector from the silhouette inwards.
        inward: DVec2,
        /// The overlap.
        depth: f64,
        /// Support point that attains the overlap.
        point: ShadowPoint,
    },
}

/// Maximum number of corners of the polygon. A tolerance of the size of rounding errors needs a few, a
/// large one on a smooth body about 20.
const MAX_CORNERS: usize = 64;

/// Compares the overlap with `tolerance`, starting at a portal around the line.
#[inline]
pub(crate) fn overlap<O: Observer>(
    context: &mut Context<O>,
    portal: &[ShadowPoint; 3],
    tolerance: f64,
) -> Overlap {
    let Some(edge) = edge_within(portal, tolerance) else { return Overlap::Ample };
    if context.difference.shadow_contains_disc(tolerance) {
        return Overlap::Ample;
    }
    overlap_near_edge(context, portal, edge, tolerance)
}

/// Compares the overlap with `tolerance` if the line is within `tolerance` of an edge of the portal.
#[cold]
#[inline(never)]
fn overlap_near_edge<O: Observer>(
    context: &mut Context<O>,
    portal: &[ShadowPoint; 3],
    edge: [&ShadowPoint; 2],
    tolerance: f64,
) -> Overlap {
    if context.difference.shadow_contains_disc_near_edge(edge, tolerance) {
        return Overlap::Ample;
    }
    overlap_by_polygon(context, portal, tolerance)
}

/// Compares the overlap with `tolerance` by growing a polygon until it decides.
#[inline(never)]
fn overlap_by_polygon<O: Observer>(
    context: &mut Context<O>,
    portal: &[ShadowPoint; 3],
    tolerance: f64,
) -> Overlap {
    let mut corners = [portal[0]; MAX_CORNERS];
    corners[..3].copy_from_slice(portal);
    let mut count = order_first_corners(&mut corners);
    let mut last_slight = Overlap::Ample;
    for _ in 0..MAX_ROUNDS {
        // If all corners coincide, there is no edge, and any direction will do.
        let anywhere = (0, DVec2::X, corners[0].shadow().x);
        let (edge, outward, reach) = nearest_edge(&corners[..count]).unwrap_or(anywhere);
        if reach > tolerance {
            return Overlap::Ample;
        }
        let inward = (-outward).extend(0.0);
        let is_last = |depth: f64| depth - reach <= context.difference.noise.point_error();
        let mut point = context.difference.support_point_from(inward, corners[edge].pair);
        if is_last(outward.dot(point.shadow())) {
            point = Plane::verified_support_point(&context.difference, inward, point);
        }
        context.watch.support(|| Support::from_point(inward, &point));
        let depth = outward.dot(point.shadow());
        if is_last(depth) || count == MAX_CORNERS {
            return if depth > tolerance {
                Overlap::Ample
            } else {
                Overlap::Slight { inward: -outward, depth, point }
            };
        }
        if depth <= tolerance {
            last_slight = Overlap::Slight { inward: -outward, depth, point };
        }
        count = insert_corner(&mut corners, count, edge, point);
    }
    last_slight
}

/// Maximum number of rounds. Each adds a corner, unless rounding makes them repeat. In that case the
/// last overlap found within the tolerance is returned, or [`Overlap::Ample`] if there was none.
const MAX_ROUNDS: usize = 200;

/// Orders the first three corners counter-clockwise and returns the number of corners. If the three are
/// collinear, the outermost two, or the only one, are the polygon.
fn order_first_corners(corners: &mut [ShadowPoint; MAX_CORNERS]) -> usize {
    let [a, b, c] = [0, 1, 2].map(|k| corners[k].shadow());
    let area = accurate_det(b - a, c - a);
    if area < 0.0 {
        corners.swap(1, 2);
    }
    if area != 0.0 {
        return 3;
    }
    let order = |p: &ShadowPoint, q: &ShadowPoint| {
        let (p, q) = (p.shadow(), q.shadow());
        p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y))
    };
    corners[..3].sort_unstable_by(order);
    corners.swap(1, 2);
    if corners[0].shadow() == corners[1].shadow() { 1 } else { 2 }
}

/// Inserts a corner beyond the edge that begins at corner `edge` of a counter-clockwise polygon,
/// removes those that are no longer corners, and returns the number of corners.
fn insert_corner(
    corners: &mut [ShadowPoint; MAX_CORNERS],
    count: usize,
    edge: usize,
    new: ShadowPoint,
) -> usize {
    let new_at = new.shadow();
    let mut count = count;
    // First the corners after the new one, in a polygon rotated so that the edge is the last one.
    corners[..count].rotate_left(edge + 1);
    let mut skip = 0;
    while count - skip > 2 {
        let [a, b] = [corners[skip], corners[skip + 1]].map(|p| p.shadow());
        if accurate_det(a - new_at, b - new_at) > 0.0 {
            break;
        }
        skip += 1;
    }
    while count - skip > 2 {
        let [a, b] = [corners[count - 2], corners[count - 1]].map(|p| p.shadow());
        if accurate_det(b - a, new_at - a) > 0.0 {
            break;
        }
        count -= 1;
    }
    corners.copy_within(skip..count, 0);
    count -= skip;
    corners[count] = new;
    count + 1
}

/// Returns the first edge of the portal within `tolerance` of the line.
#[inline]
fn edge_within(portal: &[ShadowPoint; 3], tolerance: f64) -> Option<[&ShadowPoint; 2]> {
    let is_within = |i: usize, j: usize| {
        let (a, b) = (portal[i].shadow(), portal[j].shadow());
        let area = a.perp_dot(b);
        let is_farther =
            area > 0.0 && area * area > tolerance * tolerance * (b - a).length_squared();
        !is_farther
    };
    [(0, 1), (1, 2), (2, 0)]
        .into_iter()
        .find_map(|(i, j)| is_within(i, j).then(|| [&portal[i], &portal[j]]))
}

/// Returns the edge of a counter-clockwise polygon nearest to the line: its index, outward unit normal
/// and distance. `None` if all corners coincide.
fn nearest_edge(corners: &[ShadowPoint]) -> Option<(usize, DVec2, f64)> {
    let mut nearest: Option<(usize, DVec2, f64)> = None;
    for (i, corner) in corners.iter().enumerate() {
        let a = corner.shadow();
        let b = corners[(i + 1) % corners.len()].shadow();
        let Some(along) = (b - a).try_normalize() else { continue };
        let outward = -along.perp();
        let reach = outward.dot(a);
        if nearest.is_none_or(|(_, _, least)| reach < least) {
            nearest = Some((i, outward, reach));
        }
    }
    nearest
}
