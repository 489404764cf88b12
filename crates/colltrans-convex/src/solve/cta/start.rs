//! The start of a minimisation.

use glam::{DVec2, DVec3};

use super::piece::LinearPiece;
use super::planar::{LastAnswer, PlanarHint};
use super::region::Neighbourhood;
use super::section_pair::SectionPair;
use crate::body::convex::sections::AXIS_LENGTH;
use crate::setting::VertexPair;

/// Choice of the first levels of a minimisation.
#[derive(Debug, Clone, Copy)]
pub(crate) enum MinimisationStart {
    /// The middle of the levels.
    Center,
    /// The solution of an earlier query, or a guess of the solution.
    Region(LastSolution),
}

/// The solution of an earlier query, or a guess of the solution.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LastSolution {
    /// Points of contact, in the frames of P and of Q.
    pub(crate) touching: [DVec3; 2],
    /// Half-side `delta` of the square around the solution that is searched first, a length.
    pub(crate) half_side: f64,
    /// Normal of the contact or of the separating plane, in the frame of P.
    pub(crate) normal: DVec3,
    /// Vertices near the points of contact, if known.
    pub(crate) pair: Option<VertexPair>,
}

/// Distance of the first levels from the ends of their range, as a share of the range: the section needs an
/// area. Bodies with rims often touch near an end.
pub(super) const LEVEL_MARGIN: f64 = 1e-6;

/// First state of a minimisation.
pub(super) struct InitialState {
    pub(super) floor: LinearPiece,
    /// First levels.
    pub(super) levels: DVec2,
    /// Levels that are searched first.
    pub(super) neighbourhood: Option<Neighbourhood>,
    /// Hint for the first planar problem.
    pub(super) hint: PlanarHint,
}

impl SectionPair<'_> {
    /// Returns the first state for an origin.
    pub(super) fn initial_state(&self, origin: &MinimisationStart) -> InitialState {
        match origin {
            MinimisationStart::Center => InitialState {
                floor: self.trivial_bound(),
                levels: self.origin,
                neighbourhood: None,
                hint: PlanarHint::NONE,
            },
            MinimisationStart::Region(focus) => {
                let levels = self.inner_levels(focus.touching);
                let half = focus.half_side * AXIS_LENGTH;
                let neighbourhood = Some(Neighbourhood { center: levels - self.origin, half });
                let hint = self.facing_hint(focus, levels.to_array());
                InitialState { floor: self.trivial_bound(), levels, neighbourhood, hint }
            }
        }
    }

    /// Builds a hint from an earlier solution: the sections face each other along its normal, at the height of
    /// its points of contact. The hint is empty if no vertices near them are known.
    fn facing_hint(&self, focus: &LastSolution, levels: [f64; 2]) -> PlanarHint {
        let Some(pair) = focus.pair else { return PlanarHint::NONE };
        let normal = self.setting.moving_matrix * focus.normal;
        let lateral = normal - self.frame.axes[0] * normal.dot(self.setting.unit);
        let right = usize::from(lateral.dot(self.frame.shadow[1]) > 0.0);
        let vertices = pair.indices();
        let height = |body: usize| self.sides[body].point_height(focus.touching[body]);
        let edge = |body: usize| self.sides[body].upward_edge_at(vertices[body]);
        let edges = [edge(0), edge(1)];
        PlanarHint {
            height: height(0).max(height(1)),
            levels,
            last: LastAnswer::Facing { right, edges },
        }
    }

    /// Returns a constant below all values of `phi`, with a zero normal.
    fn trivial_bound(&self) -> LinearPiece {
        let base = self.frame.base_height(self.origin.to_array());
        LinearPiece::from_supporting_plane(
            base + self.sides[0].height_lower_bound() - self.extent,
            DVec3::ZERO,
        )
    }

    /// Returns the levels of two points in the bodies' frames, moved away from the ends of the ranges by
    /// [`LEVEL_MARGIN`].
    fn inner_levels(&self, points: [DVec3; 2]) -> DVec2 {
        let level = |body: usize| {
            let [low, high] = self.sides[body].level_range();
            let margin = LEVEL_MARGIN * (high - low);
            self.sides[body].point_level(points[body]).clamp(low + margin, high - margin)
        };
        DVec2::new(level(0), level(1))
    }
}
