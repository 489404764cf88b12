//! Minkowski portal refinement (Snethen, `XenoCollide`, Game Programming Gems 7, 2008) along the line `t d`: computes
//! the lowest face of `M` on the line (`docs/theory/portals.md`; what is added: `docs/theory/related.md`).
//!
//! In the shadow frame, in which `d` has length 1, a *slope* `a` stands for the normal `n = (a, 1)`. The collision
//! translation is the maximum of the concave function `f(a) = min over m in M of n.m`.
//! - A *tangent* is a point of `M` with a slope along which it is lowest.
//! - A *portal* is a triangle of points of `M` whose shadow contains the line.
//!
//! Stages: [`mod@opposed_faces`] handles parts that rest on each other. Otherwise [`mod@normal_guess`] and, for bodies
//! with rims, [`mod@outline`] guess a slope. A [`mod@face_walk`] leads from there to the line. If it fails,
//! [`mod@enclose`] finds a portal or a separating line. [`mod@refine`] exchanges corners until the plane supports `M`
//! (the dual simplex method in two variables). [`mod@overlap`] measures the overlap of the shadows.

mod coplanar;
mod edge;
mod enclose;
mod face_walk;
mod gift_wrap;
mod normal_guess;
mod opposed_faces;
mod outline;
mod outline_maximum;
mod overlap;
mod plane;
mod refine;
mod ties;

use glam::{DVec2, DVec3};

use crate::setting::VertexPair;
use crate::setting::minkowski::{MinkowskiDifference, ShadowPoint};
use crate::solve::observe::{Observer, Support, Watch};
pub(crate) use enclose::{
    Enclosure, SeparatingLine, enclose, pierced_triangle, upward_guess, widest_margin,
};
pub(crate) use face_walk::{
    ContactPortal, ELLIPSOID_LIMITS, WalkResult, walk_from_guess, walk_from_last,
};
pub(crate) use normal_guess::NormalGuess;
pub(crate) use opposed_faces::opposed_face_contact;
pub(crate) use outline::{outline_contact, walk_from_outlines};
pub(crate) use overlap::{Overlap, overlap};
pub(crate) use plane::{Face, Plane};
pub(crate) use refine::{MAX_PORTALS, Refined, refine, supported_face};

/// Three points of `M` whose shadows contain the line, counter-clockwise.
pub(crate) type Portal = [ShadowPoint; 3];

/// State that all stages of one cast share.
pub(crate) struct Context<'a, 'o, O> {
    pub(crate) difference: MinkowskiDifference<'a>,
    pub(crate) watch: Watch<'o, O>,
}

impl<O: Observer> Context<'_, '_, O> {
    /// Returns the support point along `normal`. Starts the search at `near`, if a nearby pair is known.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a direction in memory stalls the scan")]
    pub(crate) fn support(&mut self, normal: DVec3, near: Option<VertexPair>) -> ShadowPoint {
        let point = match near {
            Some(near) => self.difference.support_point_from(normal, near),
            None => self.difference.support_point(normal),
        };
        self.watch.support(|| Support::from_point(normal, &point));
        point
    }
}

/// How much is proven about a portal that contains the line.
#[derive(Debug, Clone, Copy)]
pub(crate) enum PortalStatus {
    /// The portal encloses the line.
    EnclosesLine,
    /// The portal was reached by a face walk or an exit test, or lies in a cap; it is probably in the lowest face.
    ReachedByWalk,
    /// This face is proven to be the lowest on the line.
    Lowest(Face),
}

/// Position of the line relative to a portal that was reached by a face walk.
enum LinePosition {
    /// The line is beyond the edge that begins at this corner.
    BeyondEdge(usize),
    /// The line pierces the portal.
    Inside(PortalStatus),
}

/// Returns the normal `(a, 1)` of slope `a`.
fn normal_of(slope: DVec2) -> DVec3 {
    slope.extend(1.0)
}
