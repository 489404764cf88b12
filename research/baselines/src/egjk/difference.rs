//! The Minkowski difference of two bodies, evaluated by its support points only.

use colltrans::{ConvexPolyhedron, VertexId, VertexPair};
use glam::DVec3;

use super::SupportSearch;
use super::climb::{climb_to_support, scan_for_support};
use super::simplex::{Corner, Simplex};
use crate::placed::Relative;

/// The Minkowski difference `M = {q - p}` in the fixed body's frame.
#[derive(Debug, Clone)]
pub(crate) struct Difference<'a> {
    moving: &'a ConvexPolyhedron,
    fixed: &'a ConvexPolyhedron,
    /// Sum of the largest distances of vertices from the origin, of both bodies.
    reach: f64,
    /// The last support vertices.
    seed: VertexPair,
    /// Whether a query since the last reset has ended.
    pub(super) has_seed: bool,
    pub(super) search: SupportSearch,
}

impl<'a> Difference<'a> {
    /// Rounding error of a point of `M` in units of the size: `32 u`, as in `colltrans`.
    pub(crate) const NOISE: f64 = 16.0 * f64::EPSILON;

    /// Creates the difference of two bodies.
    pub(crate) fn new(moving: &'a ConvexPolyhedron, fixed: &'a ConvexPolyhedron) -> Self {
        let reach = |body: &ConvexPolyhedron| {
            body.vertices().iter().map(|v| v.length()).fold(0.0, f64::max)
        };
        let reach = reach(moving) + reach(fixed);
        let (seed, search) = (VertexPair::default(), SupportSearch::default());
        Self { moving, fixed, reach, seed, has_seed: false, search }
    }

    /// Resets the start of climbing to the first vertices.
    pub(crate) fn reset(&mut self) {
        (self.seed, self.has_seed) = (VertexPair::default(), false);
    }

    /// Returns the size `S`, a bound on the distance of points of `M` from the origin.
    pub(crate) fn size(&self, relative: &Relative) -> f64 {
        self.reach + relative.translation.length()
    }

    /// Returns the point of `M` of the last support vertices.
    pub(crate) fn last_support(&self, relative: &Relative) -> Corner {
        self.corner(relative, self.seed)
    }

    /// Returns the point of `M` of a vertex pair.
    pub(crate) fn corner(&self, relative: &Relative, pair: VertexPair) -> Corner {
        let p = relative.point(self.moving.vertices()[pair.moving.index()]);
        Corner { pair, point: self.fixed.vertices()[pair.fixed.index()] - p }
    }

    /// Returns the lowest point of `M` along `direction`; `climbed` counts as in [`climb_to_support`].
    pub(crate) fn lowest_point(
        &mut self,
        relative: &Relative,
        direction: DVec3,
        climbed: &mut u32,
    ) -> Corner {
        let in_moving = relative.to_moving(direction);
        if self.search == SupportSearch::FirstVertex && !self.has_seed {
            self.seed = VertexPair::default();
        }
        let mut find = |body: &ConvexPolyhedron, along: DVec3, from: VertexId| {
            VertexId(match self.search {
                SupportSearch::Climbing | SupportSearch::FirstVertex => {
                    climb_to_support(body, along, from.0, climbed)
                }
                SupportSearch::Linear => scan_for_support(body, along, climbed),
            })
        };
        self.seed = VertexPair {
            moving: find(self.moving, in_moving, self.seed.moving),
            fixed: find(self.fixed, -direction, self.seed.fixed),
        };
        self.last_support(relative)
    }

    /// Returns the points of the moving and the fixed body, each in its own frame, for the weights of a
    /// simplex.
    pub(crate) fn nearest_points(&self, simplex: &Simplex) -> [DVec3; 2] {
        let mut points = [DVec3::ZERO; 2];
        for (pair, weight) in simplex.weighted_pairs() {
            points[0] += self.moving.vertices()[pair.moving.index()] * weight;
            points[1] += self.fixed.vertices()[pair.fixed.index()] * weight;
        }
        points
    }
}
