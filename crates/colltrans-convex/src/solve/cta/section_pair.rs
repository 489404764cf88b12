//! A setting in section coordinates.

use glam::{DMat3, DVec2, DVec3};

use super::piece::SectionFrame;
use super::region::Neighbourhood;
use super::sectioned_body::SectionedBody;
use crate::body::ConvexPolyhedron;
use crate::body::convex::sections::AxisPair;
use crate::setting::Setting;
use crate::solve::observe::Sections;

/// Two placed bodies with the pair of section axes that suits the direction.
pub(super) struct SectionPair<'a> {
    pub(super) setting: &'a Setting<'a>,
    /// The bodies, P first.
    pub(super) sides: [SectionedBody<'a>; 2],
    pub(super) frame: SectionFrame,
    /// Value of `t` at level 0 of both bodies and `h = 0`.
    pub(super) constant: f64,
    /// Middle of all levels.
    pub(super) origin: DVec2,
    /// Half the extent of the levels.
    pub(super) half: DVec2,
    /// Extent of both bodies together along the direction.
    pub(super) extent: f64,
}

impl SectionFrame {
    /// Places a body in section coordinates. `matrix` and `offset` map its frame to that of the setting, `axis` is the
    /// index of its section axis, and `along` is the component of this axis along the direction.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a copy through memory")]
    fn sectioned_body<'a>(
        &self,
        body: &'a ConvexPolyhedron,
        matrix: DMat3,
        axis: usize,
        along: f64,
        offset: DVec3,
    ) -> SectionedBody<'a> {
        let to_body = matrix.transpose();
        let [h, g] = self.shadow;
        let shadow = [to_body * h, to_body * g];
        let constant = DVec2::new(h.dot(offset), g.dot(offset));
        let sections = body.sections().axis(axis);
        SectionedBody::new((body.vertices(), body.topology(), sections), along, shadow, constant)
    }
}

impl<'a> SectionPair<'a> {
    /// Chooses the section axes, and places both bodies in section coordinates.
    pub(super) fn new(setting: &'a Setting<'a>) -> Self {
        let d = setting.unit;
        let pair = AxisPair::most_general(&setting.moving_matrix, &setting.fixed_matrix, d);
        let along = [pair.moving.1.dot(d), pair.fixed.1.dot(d)];
        let axes = [pair.moving.1 / along[0], pair.fixed.1 / along[1]];
        let c = axes[0] - axes[1];
        let frame = SectionFrame { axes, along, shadow: [c, d.cross(c)] };
        let (p, q) = (setting.moving_matrix, setting.fixed_matrix);
        let sides = [
            frame.sectioned_body(setting.moving, p, pair.moving.0, along[0], DVec3::ZERO),
            frame.sectioned_body(setting.fixed, q, pair.fixed.0, along[1], setting.offset),
        ];
        let ranges = [sides[0].level_range(), sides[1].level_range()];
        let half = DVec2::from_array(ranges.map(|r| 0.5 * (r[1] - r[0])));
        Self {
            setting,
            sides,
            frame,
            // Levels of Q are measured in its own frame.
            constant: axes[1].dot(setting.offset),
            origin: DVec2::from_array(ranges.map(|r| f64::midpoint(r[0], r[1]))),
            half,
            extent: 2.0 * (half.x / along[0].abs() + half.y / along[1].abs()),
        }
    }

    /// Returns the axes, the ranges of levels and the neighbourhood, for an observer.
    pub(super) fn observed_sections(&self, neighbourhood: Option<Neighbourhood>) -> Sections {
        let frame = &self.frame;
        Sections {
            neighbourhood: neighbourhood
                .map(|Neighbourhood { center, half }| (self.origin + center, half)),
            axes: [0, 1].map(|body| frame.axes[body] * frame.along[body]),
            ranges: [0, 1].map(|body| self.sides[body].level_range()),
        }
    }
}
