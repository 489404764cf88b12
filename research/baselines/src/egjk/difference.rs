//! The Minkowski difference of two bodies, by its support points only.

use colltrans::{ConvexPolyhedron, VertexId, VertexPair};
use glam::DVec3;

use super::SupportSearch;
use super::climb::{climb, scan};
use super::simplex::{Corner, Simplex};
use crate::placed::Relative;

/// `M = {q - p}` in the fixed body's frame.
#[derive(Debug, Clone)]
pub(crate) struct Difference<'a> {
    moving: &'a ConvexPolyhedron,
    fixed: &'a ConvexPolyhedron,
    /// Reach of the moving body plus that of the fixed one.
    reach: f64,
    /// Where the last support points were found.
    seed: VertexPair,
    pub(super) search: SupportSearch,
}

impl<'a> Difference<'a> {
    /// Rounding error of a point of `M` in units of the size: `32 u`, as in `colltrans`.
    pub(crate) const NOISE: f64 = 16.0 * f64::EPSILON;

    pub(crate) fn new(moving: &'a ConvexPolyhedron, fixed: &'a ConvexPolyhedron) -> Self {
        let reach = |body: &ConvexPolyhedron| {
            body.vertices().iter().map(|v| v.length()).fold(0.0, f64::max)
        };
        let reach = reach(moving) + reach(fixed);
        let (seed, search) = (VertexPair::default(), SupportSearch::default());
        Self { moving, fixed, reach, seed, search }
    }

    /// Climbing starts from the first vertices again.
    pub(crate) fn reset(&mut self) {
        self.seed = VertexPair::default();
    }

    /// The size `S`: no point of `M` is farther from the origin.
    pub(crate) fn size(&self, relative: &Relative) -> f64 {
        self.reach + relative.translation.length()
    }

    /// The corner of the vertices where the last climb ended.
    pub(crate) fn last(&self, relative: &Relative) -> Corner {
        self.corner(relative, self.seed)
    }

    /// The corner of a vertex pair.
    pub(crate) fn corner(&self, relative: &Relative, pair: VertexPair) -> Corner {
        let p = relative.point(self.moving.vertices()[pair.moving.index()]);
        Corner { pair, point: self.fixed.vertices()[pair.fixed.index()] - p }
    }

    /// The lowest point of `M` along `direction`; `climbed` counts as in [`climb`].
    pub(crate) fn lowest(
        &mut self,
        relative: &Relative,
        direction: DVec3,
        climbed: &mut u32,
    ) -> Corner {
        let in_moving = relative.to_moving(direction);
        let mut find = |body: &ConvexPolyhedron, along: DVec3, from: VertexId| {
            VertexId(match self.search {
                SupportSearch::Climbing => climb(body, along, from.0, climbed),
                SupportSearch::Linear => scan(body, along, climbed),
            })
        };
        self.seed = VertexPair {
            moving: find(self.moving, in_moving, self.seed.moving),
            fixed: find(self.fixed, -direction, self.seed.fixed),
        };
        self.last(relative)
    }

    /// The points of the moving and the fixed body, each in its own frame, that the weights of a
    /// simplex stand for.
    pub(crate) fn nearest_points(&self, simplex: &Simplex) -> [DVec3; 2] {
        let mut points = [DVec3::ZERO; 2];
        for (pair, weight) in simplex.weighted_pairs() {
            points[0] += self.moving.vertices()[pair.moving.index()] * weight;
            points[1] += self.fixed.vertices()[pair.fixed.index()] * weight;
        }
        points
    }
}
