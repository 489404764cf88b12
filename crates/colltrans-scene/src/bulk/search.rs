//! The faces of `M0` as a line sees them, and the walk over them to where it enters.
//!
//! Notation. A face is *entered* if its normal, inwards, has a component along the direction. The shadows of the entered
//! faces tile the shadow of `M0`; the walk goes from face to face over the side beyond which the line is farthest.

use glam::DVec3;

use super::faces::{Faces, Side};
use super::proof::{Clear, Line, Rim, contact, separated};
use colltrans_convex::answer::{Outcome, StartedFrom, Steps};
use colltrans_kernel::noise::UNIT_VECTOR;

/// A component along the direction beyond what rounding makes of none.
pub(super) const ENTERED: f64 = 0.25 * UNIT_VECTOR;

/// Bound on the faces that a walk looks at; few need ten.
const MOST_FACES: u32 = 256;

/// Faces as seen along a direction, relative to a line.
pub(super) trait Seen {
    /// A side of a face.
    type Side;
    /// The sides of a face, counter-clockwise.
    fn sides(&self, face: u32) -> &[Self::Side];
    /// Where a side begins: across the direction, and along it last.
    fn corner(&self, side: &Self::Side) -> DVec3;
    /// The face beyond a side, if it is entered.
    fn beyond(&self, side: &Self::Side) -> Option<u32>;
}

/// What a walk ends with.
#[derive(Debug, Clone, Copy)]
pub(super) enum Reached {
    /// The face that the line seems to enter, and whether it does so for certain, and amply.
    Face { face: u32, certain: bool },
    /// A side of a face beyond which it passes, and no face is entered.
    Rim { face: u32, side: usize },
}

/// Walks from an entered face; how many were looked at, too. `None` if rounding makes it run in a circle.
#[inline(always)]
#[expect(clippy::inline_always, reason = "passed through memory its end stalls its reader")]
pub(super) fn walk(seen: &impl Seen, mut face: u32, clear: &Clear) -> Option<(Reached, u32)> {
    for looked in 1..=MOST_FACES {
        let sides = seen.sides(face);
        let (mut side, mut farthest, mut over, mut certain) = (sides.len() - 1, 0.0, None, true);
        let mut from = seen.corner(&sides[side]).truncate();
        for (next, corner) in sides.iter().enumerate() {
            let to = seen.corner(corner).truncate();
            let area = from.perp_dot(to);
            certain &= clear.is_inside(area, from, to);
            if area < farthest {
                (farthest, over) = (area, Some(side));
            }
            (side, from) = (next, to);
        }
        let Some(side) = over else { return Some((Reached::Face { face, certain }, looked)) };
        match seen.beyond(&sides[side]) {
            Some(beyond) => face = beyond,
            None => return Some((Reached::Rim { face, side }, looked)),
        }
    }
    None
}

/// Work done by looking at so many faces.
pub(super) fn steps(looked: u32) -> Steps {
    Steps::from_pivots(looked, StartedFrom::Difference)
}

/// All faces, along any direction.
pub(super) struct Sight<'f> {
    faces: &'f Faces,
    axes: [DVec3; 3],
    /// `offset` along the axes.
    at: DVec3,
}

impl<'f> Sight<'f> {
    #[inline]
    pub(super) fn new(faces: &'f Faces, line: &Line) -> Self {
        let axes = line.axes();
        Self { faces, axes, at: axes_of(&axes, line.setting.offset) }
    }

    /// What the faces say of the line.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "moved about, an outcome goes through memory")]
    pub(super) fn found(&self, line: &Line) -> Option<Outcome> {
        let setting = line.setting;
        let guess = self.faces.star.guess(setting.offset, setting.direction);
        match walk(self, self.entered_near(guess)?, &line.clear)? {
            (Reached::Face { face, certain: true }, looked) => {
                contact(self.faces, face, (self, face), line, steps(looked)).map(Outcome::Contact)
            }
            (Reached::Face { .. }, _) => None,
            (Reached::Rim { face, side }, looked) => {
                let beyond = self.faces.sides(face)[side].beyond;
                let [face, beyond] = [face, beyond].map(|face| self.faces.plane(face));
                let rim = Rim::new(face, beyond, setting.unit)?;
                separated(&rim, line, steps(looked)).map(Outcome::Separated)
            }
        }
    }

    /// A face that is entered, by a climb from one.
    fn entered_near(&self, mut face: u32) -> Option<u32> {
        let along = |face: u32| self.faces.plane(face).normal.dot(self.axes[2]);
        while along(face) <= ENTERED {
            let best = self.faces.sides(face).iter().map(|side| side.beyond);
            let best = best.max_by(|a, b| along(*a).total_cmp(&along(*b)))?;
            if along(best) <= along(face) {
                return None;
            }
            face = best;
        }
        Some(face)
    }
}

impl Seen for Sight<'_> {
    type Side = Side;

    #[inline]
    fn sides(&self, face: u32) -> &[Side] {
        self.faces.sides(face)
    }

    #[inline]
    fn corner(&self, side: &Side) -> DVec3 {
        axes_of(&self.axes, self.faces.points[side.corner as usize]) + self.at
    }

    #[inline]
    fn beyond(&self, side: &Side) -> Option<u32> {
        let along = self.faces.plane(side.beyond).normal.dot(self.axes[2]);
        (along > ENTERED).then_some(side.beyond)
    }
}

/// The coordinates of a point along axes.
#[inline]
pub(super) fn axes_of(axes: &[DVec3; 3], point: DVec3) -> DVec3 {
    DVec3::from_array(axes.each_ref().map(|axis| axis.dot(point)))
}
