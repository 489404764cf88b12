//! Where a minimisation starts.

use glam::{DVec2, DVec3};

use super::piece::Piece;
use super::planar::{Hint, Last};
use super::region::Square;
use super::section_pair::SectionPair;
use crate::body::convex::sections::AXIS_LENGTH;
use crate::setting::VertexPair;

/// What a minimisation starts from.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Origin {
    /// Nothing: the centre of the levels.
    Center,
    /// The solution of an earlier query.
    Region(RegionFocus),
}

/// The solution of an earlier query.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RegionFocus {
    /// The points of contact, in the frames of P and of Q.
    pub(crate) touching: [DVec3; 2],
    /// Half-side `delta` of the square around it that is searched first, in units of length.
    pub(crate) half_side: f64,
    /// The normal of contact or separation, in the frame of P.
    pub(crate) normal: DVec3,
    /// Vertices near the points of contact.
    pub(crate) pair: VertexPair,
}

/// A search does not start nearer to the ends of the levels than this share of their range: a
/// section has to have an area.
const MARGIN: f64 = 0.005;

/// What a minimisation begins with.
pub(super) struct Begin {
    pub(super) floor: Piece,
    /// The first levels.
    pub(super) at: DVec2,
    /// The levels to search first.
    pub(super) square: Option<Square>,
    /// What is known of the first planar problem.
    pub(super) hint: Hint,
}

impl SectionPair<'_> {
    pub(super) fn begin(&self, origin: &Origin) -> Begin {
        match origin {
            Origin::Center => {
                Begin { floor: self.nothing(), at: self.origin, square: None, hint: Hint::NONE }
            }
            Origin::Region(focus) => {
                let at = self.inner_levels(focus.touching);
                let half = focus.half_side * AXIS_LENGTH;
                let square = Some(Square { center: at - self.origin, half });
                let hint = self.hint(focus, at.to_array());
                Begin { floor: self.nothing(), at, square, hint }
            }
        }
    }

    /// The sections face each other as the bodies did, at the points of contact.
    fn hint(&self, focus: &RegionFocus, levels: [f64; 2]) -> Hint {
        let normal = self.setting.moving_matrix * focus.normal;
        let lateral = normal - self.frame.axes[0] * normal.dot(self.setting.unit);
        let right = usize::from(lateral.dot(self.frame.shadow[1]) > 0.0);
        let vertices = focus.pair.numbers();
        let [p, q] = [0, 1].map(|body| self.sides[body].height_of(focus.touching[body]));
        let edges = [0, 1].map(|body| self.sides[body].edge_at(vertices[body]));
        Hint { height: p.max(q), levels, last: Last::Facing { right, edges } }
    }

    /// A bound that says nothing.
    fn nothing(&self) -> Piece {
        let base = self.frame.base(self.origin.to_array());
        Piece::constant(base + self.sides[0].least_height() - self.extent, DVec3::ZERO)
    }

    /// The levels of two points in the bodies' frames, or the nearest where a section has an area.
    fn inner_levels(&self, points: [DVec3; 2]) -> DVec2 {
        DVec2::from_array([0, 1].map(|body| {
            let [low, high] = self.sides[body].range();
            let margin = MARGIN * (high - low);
            self.sides[body].level_of(points[body]).clamp(low + margin, high - margin)
        }))
    }
}
