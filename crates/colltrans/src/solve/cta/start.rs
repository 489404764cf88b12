//! Where a minimisation starts.

use glam::{DVec2, DVec3};

use super::pair::SectionPair;
use super::piece::Piece;
use super::planar::Near;
use super::region::Square;
use crate::body::convex::sections::AXIS_LENGTH;

/// What a minimisation starts from.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Origin {
    /// Nothing: the centre of the levels.
    Center,
    /// A guess of the contact.
    Contact(ContactGuess),
    /// The solution of an earlier query.
    Region(RegionFocus),
}

/// A guess of the contact.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ContactGuess {
    /// Guess of the contact normal, in the setting frame, of any length; `normal . d > 0`.
    pub(crate) normal: DVec3,
    /// The support points of P along it and of Q against it, as vertices.
    pub(crate) supports: [u32; 2],
    /// Guesses of the points of contact, in the frames of P and of Q.
    pub(crate) touching: [DVec3; 2],
}

/// The solution of an earlier query.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RegionFocus {
    /// The points of contact, in the frames of P and of Q.
    pub(crate) touching: [DVec3; 2],
    /// Half-side `delta` of the square around it that is searched first, in units of length.
    pub(crate) half_side: f64,
}

/// A search does not start nearer to the ends of the levels than this share of their range: a
/// section has to have an area.
const MARGIN: f64 = 0.005;

/// What a minimisation begins with.
pub(super) struct Begin {
    pub(super) floor: Piece,
    /// The first levels.
    pub(super) at: DVec2,
    /// A guess of the edges that cross there.
    pub(super) near: Option<Near>,
    /// The levels to search first.
    pub(super) square: Option<Square>,
}

impl SectionPair<'_> {
    pub(super) fn begin(&self, origin: &Origin) -> Begin {
        match origin {
            Origin::Center => {
                Begin { floor: self.nothing(), at: self.origin, near: None, square: None }
            }
            Origin::Contact(guess) => self.begin_at(guess),
            Origin::Region(focus) => {
                let at = self.inner_levels(focus.touching);
                let half = focus.half_side * AXIS_LENGTH;
                let square = Some(Square { center: at - self.origin, half });
                Begin { floor: self.nothing(), at, near: None, square }
            }
        }
    }

    /// A bound that says nothing.
    fn nothing(&self) -> Piece {
        let base = self.frame.base(self.origin.to_array());
        Piece::constant(base + self.sides[0].least_height() - self.extent, DVec3::ZERO)
    }

    /// From the supporting plane of a start, at the levels of its touching points.
    fn begin_at(&self, start: &ContactGuess) -> Begin {
        let setting = self.setting;
        let normal = start.normal / start.normal.dot(setting.unit);
        let p = setting.moving_matrix * setting.moving.vertices()[start.supports[0] as usize];
        let q = setting.fixed_matrix * setting.fixed.vertices()[start.supports[1] as usize];
        let t = normal.dot(q + setting.offset - p) - self.constant;
        let at = self.inner_levels(start.touching);
        let levels = at.to_array();
        let normals = [setting.moving_normal(normal), setting.fixed_normal(normal)];
        let edge = |body: usize| {
            self.sides[body].edge_near(start.supports[body], normals[body], levels[body])
        };
        // In their sections P ends, and Q begins, towards what the normal has besides the axes.
        let in_section = normal - self.frame.axes[0];
        let right = usize::from(in_section.dot(self.frame.shadow[1]) > 0.0);
        let near = edge(0).zip(edge(1)).map(|(p, q)| Near { ups: [p, q], right });
        Begin { floor: Piece::constant(t, normal), at, near, square: None }
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
