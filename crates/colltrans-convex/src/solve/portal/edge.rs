//! The edges of a portal, and over which of them the line has left it.

use glam::DVec2;

use super::gift_wrap::Tilt;
use super::ties::crossed_or_tied;
use super::{Context, Known, Line, Portal};
use crate::setting::minkowski::Point;
use crate::solve::observe::Observer;
use colltrans_kernel::plane::triangle_normal;

/// The corner after another.
const NEXT: [usize; 3] = [1, 2, 0];

/// A directed edge of a portal with the third corner on its left and the line on its right.
pub(super) struct Edge {
    pub(super) from: Point,
    pub(super) to: Point,
    pub(super) third: Point,
}

/// Where the line is, seen from a portal.
#[inline]
pub(super) fn crossed<O: Observer>(context: &mut Context<O>, portal: &Portal) -> Line {
    match context.difference.is_left_rounded(&portal[0], &portal[1]) {
        Some(true) => left_behind(context, portal),
        Some(false) => Line::Beyond(0),
        None => crossed_or_tied(context, portal),
    }
}

/// The same, if the line is known to be on the left of the first edge.
#[inline]
pub(super) fn left_behind<O: Observer>(context: &mut Context<O>, portal: &Portal) -> Line {
    let second = context.difference.is_left_rounded(&portal[1], &portal[2]);
    let third = context.difference.is_left_rounded(&portal[2], &portal[0]);
    match (second, third) {
        (Some(true), Some(true)) => Line::Inside(Known::FaceByFace),
        (Some(false), _) => Line::Beyond(1),
        (_, Some(false)) => Line::Beyond(2),
        _ => crossed_or_tied(context, portal),
    }
}

impl Edge {
    /// The edge that begins at a corner.
    #[inline]
    pub(super) fn of(portal: &Portal, from: usize) -> Self {
        let [to, third] = [NEXT[from], NEXT[NEXT[from]]];
        Self { from: portal[from], to: portal[to], third: portal[third] }
    }

    /// From the edge away from the triangle, as long as the edge.
    #[inline]
    pub(super) fn outward(&self) -> DVec2 {
        -(self.to.shadow() - self.from.shadow()).perp()
    }

    /// How wide the triangle is over the edge, times the edge's length.
    #[inline]
    pub(super) fn width(&self) -> f64 {
        self.outward().dot(self.from.shadow() - self.third.shadow())
    }

    /// How far the line is beyond the edge, times the edge's length.
    #[inline]
    pub(super) fn distance(&self) -> f64 {
        -self.outward().dot(self.from.shadow())
    }

    /// The turn of the triangle's plane about the edge; `None` if the plane stands upright.
    #[inline]
    pub(super) fn tilt(&self) -> Option<Tilt> {
        let normal = triangle_normal([self.from.at, self.to.at, self.third.at]);
        (normal.z > 0.0).then_some(Tilt { normal, outward: self.outward() })
    }
}
