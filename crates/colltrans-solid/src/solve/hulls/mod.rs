//! Convex solids with their hulls.
//!
//! [`HullPair`] is the one place where two solids become two convex bodies: casts, distances and tests for a common
//! point use it first. The hulls guess planes and facets. Planes are proven over the vertices of the solids
//! ([`Surface::max_height`]). The hull of a solid is computed on the first request and stored with it.
//!
//! - [`surface`]: facets around a vertex, at an edge and at a point of a convex solid.
//! - [`nearest`]: separating planes and the nearest facets.

mod nearest;
mod surface;

use glam::DVec3;

use crate::body::Solid;
use colltrans_convex::body::{ConvexPolyhedron, DerivedData};
use colltrans_convex::cast::Cast;
use colltrans_convex::setting::{Setting, TwoBodies};
use colltrans_convex::solve::options::Options;
pub(crate) use nearest::{is_plane_between, nearest_facets, plane_margin};
pub use surface::{FacetGroup, NEAR_NOISES, Surface, SurfacePoint};

/// Maximum height of a vertex above the plane of an adjacent facet in a body that counts as convex, as a share of
/// its reach.
const CONVEXITY_TOLERANCE: f64 = 1e-9;
/// Rounding error of a height above a plane of a body, as a share of its reach.
pub(crate) const HEIGHT_ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Two placed convex solids, and their hulls in the same poses.
#[derive(Debug, Clone, Copy)]
pub struct HullPair<'a> {
    pub surfaces: [Surface<'a>; 2],
    pub hulls: TwoBodies<'a>,
}

impl<'a> HullPair<'a> {
    /// Returns the hulls of two solids; `None` if a solid is not convex.
    pub fn of_convex(solids: &TwoBodies<'a, Solid>) -> Option<Self> {
        let surfaces = [Surface::of_convex(solids.moving)?, Surface::of_convex(solids.fixed)?];
        let hulls = solids.with_bodies(surfaces.map(|surface| &surface.body.hull));
        Some(Self { surfaces, hulls })
    }

    /// Returns the cast of the hulls with the direction of a query.
    pub(crate) fn cast(&self, setting: &Setting<'a, Solid>) -> Cast<'a> {
        let Setting { direction, length, unit, .. } = *setting;
        let setting = Setting { bodies: self.hulls, direction, length, unit };
        Cast { setting, options: Options::default() }
    }
}

/// Convex hull stored with a solid; `None` if the solid is not convex.
#[derive(Debug)]
struct CachedBody(Option<ConvexBody>);

/// Convex hull of a convex solid.
#[derive(Debug)]
pub struct ConvexBody {
    pub hull: ConvexPolyhedron,
    /// For each vertex of the hull, a triangle of the solid with this vertex.
    pub(crate) triangle_at: Vec<u32>,
    /// Whether each vertex of the solid is a vertex of the hull.
    pub(crate) has_all_vertices: bool,
    /// Depth, a length: points of the hull deeper than this below its surface are inside the solid.
    pub(crate) dent: f64,
    /// Radius of a ball inside the hull.
    pub(crate) inner_radius: f64,
    /// Whether each ray from the centre of this ball is proven to leave the solid once.
    pub(crate) is_star_shaped: bool,
}

impl DerivedData for CachedBody {
    fn heap_bytes(&self) -> usize {
        self.0.as_ref().map_or(0, |body| {
            body.hull.memory_bytes() + body.triangle_at.capacity() * size_of::<u32>()
        })
    }
}

impl CachedBody {
    fn new(solid: &Solid) -> Self {
        Self(is_convex(solid).then(|| ConvexBody::new(solid)).flatten())
    }
}

impl ConvexBody {
    /// Returns the hull of a solid, computed on the first request; `None` if the solid is not convex.
    pub(crate) fn cached(solid: &Solid) -> Option<&Self> {
        solid.derived_data().get_or_make(|| CachedBody::new(solid))?.0.as_ref()
    }

    /// Builds the hull of a convex solid; `None` if the points have no hull or it is flat.
    fn new(solid: &Solid) -> Option<Self> {
        let hull = ConvexPolyhedron::from_points(solid.vertices()).ok()?.without_input_excess();
        if hull.dimension() < 3 {
            return None;
        }
        let mut triangle = vec![0; solid.vertices().len()];
        for (t, corners) in solid.triangles().iter().enumerate() {
            for &v in corners {
                triangle[v as usize] = t as u32;
            }
        }
        let triangle_at = hull.input_indices().iter().map(|v| triangle[v.index()]).collect();
        let has_all_vertices = hull.vertices().len() == solid.vertices().len();
        let (dent, inner_radius) = (max_dent(solid, &hull), inner_ball_radius(solid, &hull));
        let is_star_shaped = is_star_shaped(solid, &hull, dent / inner_radius);
        Some(Self { hull, triangle_at, has_all_vertices, dent, inner_radius, is_star_shaped })
    }

    /// Returns the dent as a share of the radius of a ball inside the hull; `None` from one half on. The hull scaled by 1
    /// less this share about the ball's centre is inside the solid.
    pub(crate) fn dent_share(&self) -> Option<f64> {
        Some(self.dent / self.inner_radius).filter(|share| (0.0..0.5).contains(share))
    }

    /// Returns the number in the solid of a vertex of the hull.
    pub(crate) fn solid_vertex(&self, vertex: u32) -> u32 {
        self.hull.input_indices()[vertex as usize].0
    }
}

/// Checks whether a solid is one closed shell that bends outwards at each edge, to within [`CONVEXITY_TOLERANCE`].
fn is_convex(solid: &Solid) -> bool {
    let (triangles, vertices) = (solid.triangles(), solid.vertices());
    let place = |v: u32| vertices[v as usize];
    let bends_outwards = |t: usize| {
        let [a, b, c] = triangles[t].map(place);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let mut across = solid.neighbours()[t].iter().flat_map(|&n| triangles[n as usize]);
        across.all(|v| normal.dot(place(v) - a) <= CONVEXITY_TOLERANCE * solid.reach())
    };
    solid.is_closed() && solid.shell_bounds().len() == 1 && (0..triangles.len()).all(bends_outwards)
}

/// Computes the maximum height of the hull above the planes of a convex solid's facets. No point of a facet is
/// deeper below the surface of the hull.
fn max_dent(solid: &Solid, hull: &ConvexPolyhedron) -> f64 {
    let above = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|v| solid.vertices()[v as usize]);
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { return f64::INFINITY };
        // The normal of a narrow facet may be inaccurate, so the height counts from its lowest corner.
        let low = [a, b, c].map(|p| normal.dot(p)).into_iter().fold(f64::INFINITY, f64::min);
        normal.dot(hull.vertices()[hull.support(normal).index()]) - low
    };
    let most = solid.triangles().iter().map(above).fold(0.0, f64::max);
    most + hull.hull_error() + HEIGHT_ROUNDING * solid.reach()
}

/// Checks whether each ray from the centre of the ball inside the hull leaves the solid once. `share` is the dent as a
/// share of the ball's radius.
///
/// All facets face away from the centre, so that each ray leaves the same number of times, `d >= 1`. The hull `H`, scaled
/// by `1 - share`, is inside the surface. Hence the signed volume is at most that of `H` if `d = 1`, and at least
/// `2 (1 - share)^3` of it otherwise, which is 1.024 for a share of 0.2.
fn is_star_shaped(solid: &Solid, hull: &ConvexPolyhedron, share: f64) -> bool {
    (0.0..=0.2).contains(&share) && solid.volume() <= 1.01 * hull.volume()
}

/// Computes the radius of a ball inside the hull, around the mean of the hull's vertices.
fn inner_ball_radius(solid: &Solid, hull: &ConvexPolyhedron) -> f64 {
    let middle = hull.vertices().iter().sum::<DVec3>() / hull.vertices().len() as f64;
    let depth = |face: u32| {
        let on = hull.face_vertices(face).next().map_or(middle, |v| hull.vertices()[v as usize]);
        hull.face_normal(face).dot(on - middle)
    };
    let least = (0..hull.face_count() as u32).map(depth).fold(f64::INFINITY, f64::min);
    least - hull.hull_error() - HEIGHT_ROUNDING * solid.reach()
}
