//! Two convex solids in motion, searched like two convex bodies.
//!
//! The hulls guess the plane at a time. Its gap is that of the shrunk vertices. One list of planes for both bodies replaces
//! the cover of a search by trees. Near a contact the hulls overlap before the shrunk solids do. Other
//! guesses are then the last normal, the plane between two shrunk facets around the last nearest points, and the
//! direction of least depth. Two such facets prove a contact. Derivation: `docs/theory/hulls-of-solids.md`.
//!
//! Invariant: a claimed gap is at most that of a scan of all shrunk vertices, and a support bound at least their
//! maximum.

use glam::DVec3;

use super::super::answer::MotionSteps;
use super::super::crossing_time::MIN_WIDTH;
use super::super::curvature::SupportSearch;
use super::super::proof::{Entry, FacetContactProof, RecordedProof};
use super::super::relative_motion::RelativeMotion;
use super::super::sample::{ConvexSampler, Sample, Sampler, closing_speed};
use super::super::search::{SpanEnd, SpanResult, prove_span};
use super::super::span::Span;
use super::facets::{placed_corners, prove_contact};
use super::search::{EarliestContact, SearchMode};
use super::tree::SolidTree;
use colltrans_convex::body::VertexHull;
use colltrans_convex::setting::TwoBodies;
use colltrans_solid::solve::hulls::{FacetGroup, NEAR_NOISES, Surface, SurfacePoint};
use colltrans_solid::solve::nearest::triangle;

/// Rounding error of a gap of shrunk vertices, in noises, with the errors of both heights.
const HEIGHT_NOISES: f64 = 2.0;
/// Maximum number of vertices that are scanned for the highest one if many of them may be highest.
const MAX_SCANNED_VERTICES: usize = 1_000;

/// Maximum displacement of a vertex, in multiples of the reach of its body. Beyond it, the facets around the nearest
/// points of the hulls may not be the nearest ones of the shrunk solids.
const MAX_DISPLACEMENT_SHARE: f64 = 1e-6;

/// Depth along the last normal, in multiples of the largest depth at which the shrunk solids may be apart, above which
/// the facets around the last points are not compared.
const DEEP_FACTOR: f64 = 1_000.0;

/// A plane between two convex solids: its normal and gap, and the nearest points in the frames of the bodies.
#[derive(Clone, Copy)]
struct GuessedPlane {
    normal: DVec3,
    /// Gap of the shrunk cores, less rounding errors.
    gap: f64,
    points: [DVec3; 2],
}

/// Samples distances of two convex solids.
struct HullSampler<'t> {
    surfaces: [Surface<'t>; 2],
    convex: ConvexSampler,
    /// Points of both bodies at the last sampled plane, and the normals there, each in the frame of its body.
    last_points: Option<[SurfacePoint; 2]>,
    /// The facets that were nearest, or crossed, when facets were last compared.
    last_facets: Option<[u32; 2]>,
}

/// Bounds supports by those of the hull.
struct HullSupport;

impl SupportSearch<SolidTree<'_>> for HullSupport {
    fn support_bound(&self, body: &SolidTree<'_>, normal: DVec3) -> f64 {
        let length = normal.length();
        if length == 0.0 {
            return 0.0;
        }
        let Some(surface) = body.surface() else { return f64::INFINITY };
        let (hull, unit) = (&surface.body.hull, normal / length);
        let (vertex, beyond) = hull.support_with_excess(unit, hull.support(unit).0);
        let beyond = beyond + hull.hull_error() + body.max_displacement();
        normal.dot(hull.vertices()[vertex as usize]) + beyond * length
    }
}

impl<'t> HullSampler<'t> {
    /// Returns the sampler of two bodies; `None` if one is not convex or shrunk by more than
    /// [`MAX_DISPLACEMENT_SHARE`].
    fn new(bodies: [&SolidTree<'t>; 2]) -> Option<Self> {
        let is_shrunk_far = |tree: &SolidTree| {
            tree.max_displacement() > MAX_DISPLACEMENT_SHARE * VertexHull::reach(tree)
        };
        if bodies.into_iter().any(is_shrunk_far) {
            return None;
        }
        Some(Self {
            surfaces: [bodies[0].surface()?, bodies[1].surface()?],
            convex: ConvexSampler::default(),
            last_points: None,
            last_facets: None,
        })
    }

    /// Returns the hulls of two bodies in the same poses.
    fn hulls(&self, bodies: &TwoBodies<'_, SolidTree<'t>>) -> TwoBodies<'t> {
        bodies.with_bodies(self.surfaces.map(|surface| &surface.body.hull))
    }

    /// Computes the gap of the shrunk cores along a unit normal, less its rounding error `HEIGHT_NOISES * noise`.
    fn shrunk_gap(&self, bodies: &TwoBodies<'_, SolidTree<'t>>, normal: DVec3, noise: f64) -> f64 {
        let height = |k: usize, tree: &SolidTree, local: DVec3| {
            let surface = &self.surfaces[k];
            let hull = &surface.body.hull;
            let from = hull.support(local).0;
            surface.max_height(local, from, tree.amount(), noise).unwrap_or_else(|| {
                if tree.vertex_count() <= MAX_SCANNED_VERTICES {
                    let heights = tree.hull_vertices().iter().map(|v| local.dot(*v));
                    heights.fold(f64::NEG_INFINITY, f64::max)
                } else {
                    HullSupport.support_bound(tree, local)
                }
            })
        };
        let moving = height(0, bodies.moving, bodies.moving_matrix.transpose() * normal);
        let fixed = height(1, bodies.fixed, bodies.fixed_matrix.transpose() * -normal);
        normal.dot(bodies.offset) - fixed - moving - HEIGHT_NOISES * noise
    }

    /// Returns a plane whose gap is above `least`: between the hulls, with the last normal, between two facets, or of
    /// the least depth of the hulls. Returns `None` if there is none.
    fn guess_plane(
        &mut self,
        bodies: &TwoBodies<'_, SolidTree<'t>>,
        [noise, core_gap, least]: [f64; 3],
    ) -> Option<GuessedPlane> {
        let too_near = least + HEIGHT_NOISES * noise;
        if let Some(pair) = self.last_facets
            && Self::plane_of_pair(bodies, pair, noise).0 <= too_near
        {
            return None;
        }
        let plane = |sampler: &Self, normal, points| {
            let gap = sampler.shrunk_gap(bodies, normal, noise);
            (gap > least).then_some(GuessedPlane { normal, gap, points })
        };
        let hulls = self.hulls(bodies);
        if let Some((normal, points)) = self.convex.plane_between(&hulls, core_gap) {
            let found = plane(self, normal, points);
            return found.or_else(|| {
                let (_, near) = self.nearest_facets(bodies, noise, too_near)?;
                plane(self, near.normal, near.points)
            });
        }
        let last = self.last_points?;
        let normal = (bodies.moving_matrix * last[0].outward).normalize();
        let points = last.map(|point| point.position);
        let shrinkage = bodies.moving.max_displacement() + bodies.fixed.max_displacement();
        let most_depth = shrinkage + 4.0 * noise + least - core_gap;
        let gap = self.shrunk_gap(bodies, normal, noise);
        if gap > least {
            return Some(GuessedPlane { normal, gap, points });
        }
        if gap > -DEEP_FACTOR * most_depth
            && let Some((length, near)) = self.nearest_facets(bodies, noise, too_near)
        {
            let found = plane(self, near.normal, near.points);
            if length <= too_near || found.is_some() {
                return found;
            }
        }
        let normal = self.convex.shallow_normal(&hulls, most_depth)?;
        plane(self, normal, points)
    }

    /// Computes the distance of two shrunk facets, and the plane between them without its gap.
    fn plane_of_pair(
        bodies: &TwoBodies<'_, SolidTree<'t>>,
        triangles: [u32; 2],
        noise: f64,
    ) -> (f64, GuessedPlane) {
        let facets = [bodies.moving.facet(triangles[0]), bodies.fixed.facet(triangles[1])];
        let [f, g] = placed_corners(&bodies.with_bodies(facets.each_ref()));
        let near = triangle::nearest_points(&f, &g, noise);
        let points = [0, 1].map(|k| triangle::weighted_point(&facets[k].corners, near.weights[k]));
        let length = triangle::weighted_distance(&f, &g, near.weights);
        (length, GuessedPlane { normal: near.normal, gap: 0.0, points })
    }

    /// Finds the nearest shrunk facets around the last nearest points, or two facets that are at most `too_near` apart,
    /// and stores them. Returns their distance and plane; `None` if there are no such points or facets.
    fn nearest_facets(
        &mut self,
        bodies: &TwoBodies<'_, SolidTree<'t>>,
        noise: f64,
        too_near: f64,
    ) -> Option<(f64, GuessedPlane)> {
        let mut best: Option<(f64, [u32; 2], GuessedPlane)> = None;
        self.find_facets(bodies, |pair| {
            let (length, plane) = Self::plane_of_pair(bodies, pair, noise);
            if best.is_none_or(|(least, ..)| length < least) {
                best = Some((length, pair, plane));
            }
            (length <= too_near).then_some(())
        });
        let (length, pair, plane) = best?;
        self.last_facets = Some(pair);
        Some((length, plane))
    }

    /// Finds the facets of both bodies around the last nearest points, and calls `test` for their pairs until it
    /// returns a result.
    fn find_facets<T>(
        &self,
        bodies: &TwoBodies<'_, SolidTree<'t>>,
        mut test: impl FnMut([u32; 2]) -> Option<T>,
    ) -> Option<T> {
        let points = self.last_points?;
        let noise = bodies.noise().point_error();
        let groups = |k: usize, tree: &SolidTree| {
            let surface = &self.surfaces[k];
            let corner = surface.body.hull.support(points[k].outward).0;
            let near = NEAR_NOISES * noise + 2.0 * tree.max_displacement();
            FacetGroup::new(surface, corner, &points[k], near)
        };
        let [p, q] = [groups(0, bodies.moving)?, groups(1, bodies.fixed)?];
        let mut pairs = p.facets().iter().flat_map(|&f| q.facets().iter().map(move |&g| [f, g]));
        pairs.find_map(&mut test)
    }
}

impl<'t> Sampler<SolidTree<'t>> for HullSampler<'t> {
    type Met = ([u32; 2], FacetContactProof);
    type SupportSearch = HullSupport;
    const SUPPORT_SEARCH: HullSupport = HullSupport;
    // The volumes that prove a crossing have errors of many noises.
    const PROVING_DEPTH: f64 = 16.0;

    fn sample<'a, C>(&mut self, motion: &C, time: f64) -> Sample<'a, C::Moved, SolidTree<'t>>
    where
        SolidTree<'t>: 'a,
        C: RelativeMotion<'a, Body = SolidTree<'t>>,
    {
        let at = motion.instant_at(time);
        let [min_gap, error] = [motion.min_gap(), motion.position_error()];
        let noise = at.bodies.noise().point_error();
        let [_, core_gap] = at.bodies.core_gap_bounds(min_gap);
        let plane = self.guess_plane(&at.bodies, [noise, core_gap, core_gap + error]);
        let none =
            GuessedPlane { normal: DVec3::X, gap: f64::NEG_INFINITY, points: [DVec3::ZERO; 2] };
        let GuessedPlane { normal, gap, points } = plane.unwrap_or(none);
        let gap = at.bodies.less_radii(gap) - min_gap - error;
        if gap > 0.0 {
            let [p, q] = [at.bodies.moving_matrix, at.bodies.fixed_matrix];
            let outward = [p.transpose() * normal, q.transpose() * -normal];
            let point = |k: usize| SurfacePoint { position: points[k], outward: outward[k] };
            self.last_points = Some([point(0), point(1)]);
        }
        let rate = if gap > 0.0 { closing_speed(motion, &at, points, normal) } else { 0.0 };
        Sample { at, normal, gap, rate, points, floor: 4.0 * noise + error }
    }

    fn prove_contact<'a, C>(&mut self, motion: &C, time: f64) -> Option<Self::Met>
    where
        SolidTree<'t>: 'a,
        C: RelativeMotion<'a, Body = SolidTree<'t>>,
    {
        let bodies = motion.instant_at(time).bodies;
        self.convex.steps.looks += 1;
        let test = |pair: [u32; 2]| {
            let facets = [bodies.moving.facet(pair[0]), bodies.fixed.facet(pair[1])];
            let facets = bodies.with_bodies(facets.each_ref());
            let met = prove_contact(&facets, [motion.min_gap(), motion.position_error()]);
            met.map(|met| (pair, met))
        };
        let found = self.last_facets.and_then(test).or_else(|| self.find_facets(&bodies, test))?;
        self.last_facets = Some(found.0);
        Some(found)
    }
}

/// Searches a span of two convex solids. Returns the earliest contact, if any, and the proof up to it in
/// [`SearchMode::Recording`].
///
/// Returns `None` where the trees decide: if a solid is not convex or is shrunk far, if overlaps at the start are ignored,
/// if the solids are not separated at the start of the span, or if no contact is proven where the planes end.
pub(super) fn search_convex<'a>(
    span: &Span<'a, SolidTree<'a>>,
    mode: SearchMode,
    steps: &mut MotionSteps,
) -> Option<(Option<EarliestContact>, RecordedProof)> {
    if mode == SearchMode::IgnoringStartOverlaps {
        return None;
    }
    let mut sampler = HullSampler::new([span.body(0), span.body(1)])?;
    let SpanResult { planes, end } = prove_span(span, &mut sampler);
    *steps += sampler.convex.steps;
    let lower = planes.last()?.time;
    let found = match end {
        SpanEnd::Free => None,
        SpanEnd::Indeterminate | SpanEnd::Stalled => return None,
        SpanEnd::Met(mut time, (mut triangles, mut met)) => {
            // The facets meet from some time on, which is bisected.
            let mut before = lower;
            while time - before > MIN_WIDTH {
                let middle = before + 0.5 * (time - before);
                match sampler.prove_contact(span, middle) {
                    Some(earlier) => (time, (triangles, met)) = (middle, earlier),
                    None => before = middle,
                }
            }
            let met = Some((time, triangles, met));
            Some(EarliestContact { lower, triangles, is_open: false, met, is_refined: true })
        }
    };
    let is_recorded = mode == SearchMode::Recording && lower > span.from;
    let recorded = if is_recorded {
        RecordedProof { entries: vec![Entry::PlaneList], lists: vec![planes] }
    } else {
        RecordedProof::default()
    };
    Some((found, recorded))
}
