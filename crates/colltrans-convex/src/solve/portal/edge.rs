//! Edges of a portal, and the position of the line relative to a portal.

use glam::DVec2;

use super::gift_wrap::RotatingPlane;
use super::ties::line_position_with_ties;
use super::{Context, LinePosition, Portal, PortalStatus};
use crate::setting::minkowski::ShadowPoint;
use crate::solve::observe::Observer;
use colltrans_kernel::plane::triangle_normal;

/// Index of the next corner, counter-clockwise.
const NEXT_CORNER: [usize; 3] = [1, 2, 0];

/// Directed edge of a portal. The third corner is on its left, the line on its right.
pub(super) struct Edge {
    pub(super) from: ShadowPoint,
    pub(super) to: ShadowPoint,
    pub(super) third: ShadowPoint,
}

/// Locates the line relative to a portal. Decides ties if rounded determinants cannot.
#[inline]
pub(super) fn line_position<O: Observer>(
    context: &mut Context<O>,
    portal: &Portal,
) -> LinePosition {
    match context.difference.is_left_rounded(&portal[0], &portal[1]) {
        Some(true) => line_position_after_crossing(context, portal),
        Some(false) => LinePosition::BeyondEdge(0),
        None => line_position_with_ties(context, portal),
    }
}

/// Locates the line relative to a portal, given that it is on the left of the first edge.
#[inline]
pub(super) fn line_position_after_crossing<O: Observer>(
    context: &mut Context<O>,
    portal: &Portal,
) -> LinePosition {
    let second = context.difference.is_left_rounded(&portal[1], &portal[2]);
    let third = context.difference.is_left_rounded(&portal[2], &portal[0]);
    match (second, third) {
        (Some(true), Some(true)) => LinePosition::Inside(PortalStatus::ReachedByWalk),
        (Some(false), _) => LinePosition::BeyondEdge(1),
        (_, Some(false)) => LinePosition::BeyondEdge(2),
        _ => line_position_with_ties(context, portal),
    }
}

impl Edge {
    /// Returns the edge that begins at the corner `from`.
    #[inline]
    pub(super) fn from_corner(portal: &Portal, from: usize) -> Self {
        let [to, third] = [NEXT_CORNER[from], NEXT_CORNER[NEXT_CORNER[from]]];
        Self { from: portal[from], to: portal[to], third: portal[third] }
    }

    /// Returns the outward normal of the edge in the shadow plane. It is as long as the edge.
    #[inline]
    pub(super) fn outward(&self) -> DVec2 {
        -(self.to.shadow() - self.from.shadow()).perp()
    }

    /// Returns the distance of the third corner from the edge, times the length of the edge.
    #[inline]
    pub(super) fn scaled_width(&self) -> f64 {
        self.outward().dot(self.from.shadow() - self.third.shadow())
    }

    /// Returns the distance of the line beyond the edge, times the length of the edge.
    #[inline]
    pub(super) fn scaled_distance(&self) -> f64 {
        -self.outward().dot(self.from.shadow())
    }

    /// Returns the plane of the triangle, to be rotated about the edge. `None` if the plane is vertical
    /// or inverted.
    #[inline]
    pub(super) fn rotating_plane(&self) -> Option<RotatingPlane> {
        let normal =
            triangle_normal([self.from.coordinates, self.to.coordinates, self.third.coordinates]);
        (normal.z > 0.0).then_some(RotatingPlane { normal, outward: self.outward() })
    }
}
