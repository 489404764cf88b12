//! Portal refinement: the exact lowest face of `M` on the line, from a guess of its normal.
//!
//! Notation. A *tangent* is a point of `M` with the slope `a` of the normal `n = (a, 1)` (shadow
//! frame) along which it is lowest. A *portal* is a triangle of points of `M` whose shadow contains
//! the line. With `f(a) = min_M n.m` (concave, piecewise linear) the collision translation is `max
//! f`; a tangent is a cutting plane of `f`, a portal three of them that bound it.
//!
//! The way: [`mod@opposed_faces`] answers for parts that stand on each other; else [`mod@normal_guess`] guesses a
//! slope, and [`mod@outline`] a better one of bodies with rims, [`mod@face_walk`] goes face by face from there to the line,
//! or [`mod@enclose`] finds a first portal or a separating direction, [`mod@refine`] exchanges one point of the portal
//! after another until its plane supports `M`, [`mod@overlap`] measures how far the shadows overlap. Section 1 of the paper for the
//! bounds; the exchange is the dual of the simplex method with two variables.

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
use crate::setting::minkowski::{MinkowskiDifference, Point};
use crate::solve::observe::{Observer, Support, Watch};
pub(crate) use enclose::{Enclosure, SeparatingLine, around, enclose, upward, widest_margin};
pub(crate) use face_walk::{ContactPortal, Followed, OF_ELLIPSOIDS, approach, follow};
pub(crate) use normal_guess::FirstNormal;
pub(crate) use opposed_faces::facing;
pub(crate) use outline::between_outlines;
pub(crate) use overlap::{Overlap, overlap};
pub(crate) use plane::{Face, Plane};
pub(crate) use refine::{MAX_PORTALS, Refined, face, refine};

/// Three points of `M` whose shadows, counter-clockwise, contain the line.
pub(crate) type Portal = [Point; 3];

/// What all stages of one cast share.
pub(crate) struct Context<'a, 'o, O> {
    pub(crate) difference: MinkowskiDifference<'a>,
    pub(crate) watch: Watch<'o, O>,
}

impl<O: Observer> Context<'_, '_, O> {
    /// The support point along a normal, which may be known to be near a pair.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a direction passed through memory stalls the scan")]
    fn support(&mut self, normal: DVec3, near: Option<VertexPair>) -> Point {
        let point = match near {
            Some(near) => self.difference.support_from(normal, near),
            None => self.difference.support(normal),
        };
        self.watch.support(|| Support::of(normal, &point));
        point
    }
}

/// What a stage knows of the portal that it hands on.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Known {
    /// It is around the line.
    Around,
    /// It was reached face by face, so that it probably is the lowest.
    FaceByFace,
    /// A plane that supports `M` is proven to be the lowest where the line passes it.
    Lowest(Face),
}

/// Where the line is, seen from a portal that was reached face by face.
enum Line {
    /// It has left the portal over the edge that begins at this corner.
    Beyond(usize),
    /// It pierces the portal.
    Inside(Known),
}

/// `(a, 1)`.
fn normal_of(slope: DVec2) -> DVec3 {
    slope.extend(1.0)
}
