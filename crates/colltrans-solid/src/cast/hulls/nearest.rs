//! The nearest facets of two convex solids, from the distance of their hulls.
//!
//! - *Lower bound:* the vertices of both solids lie on different sides of two planes with the normal of the hulls'
//!   distance. The solids are apart by at least the distance of these planes, so neither is inside the other.
//! - *Upper bound:* the distance of two facets around the nearest points of the hulls.
//!
//! The hulls only guess the normal and the facets. If the bounds differ by more than rounding, there is no answer.

use super::contact_facets::{FacetGroup, NEAR_NOISES, plane_margin};
use super::{Surface, SurfacePoint};
use crate::body::Solid;
use crate::solve::nearest::{NearestPoints, triangle};
use crate::solve::scene::PairFrame;
use colltrans_convex::pair::Pair;
use colltrans_convex::setting::VertexPair;

/// Maximum difference of the bounds, in noises: below that of a search through the trees.
const MAX_WIDTH_NOISES: f64 = 4.5;

/// The nearest facets of two bodies that a plane separates.
pub(crate) struct NearestFacets {
    pub(crate) spot: NearestPoints,
    /// Lower bound of the distance of the bodies.
    pub(crate) lower: f64,
    /// Number of compared pairs of facets.
    pub(crate) leaves: u32,
}

/// Finds the nearest facets of two solids in the frame of `scene`, without an offset. Returns `None` if a solid is not
/// convex, if the solids may meet, or if the bounds differ by more than rounding.
pub(crate) fn nearest_facets(pair: &Pair<'_, Solid>, scene: &PairFrame) -> Option<NearestFacets> {
    let bodies = [Surface::of_convex(pair.moving())?, Surface::of_convex(pair.fixed())?];
    let hulls = pair.bodies.with_bodies(bodies.map(|surface| &surface.body.hull));
    let found = Pair { bodies: hulls }.distance().ok()?;
    let normal = found.normal?;
    let sides = [&scene.moving, &scene.fixed];
    let outward = [0, 1].map(|k| sides[k].matrix.transpose() * [normal, -normal][k]);
    let support = |k: usize| bodies[k].body.hull.support(outward[k]).index() as u32;
    let highest = VertexPair::from_indices(support(0), support(1));
    // One noise covers the length of the normal.
    let lower = plane_margin(scene, &bodies, normal, highest) - scene.noise;
    if lower <= 0.0 {
        return None;
    }
    let weights = found.near.weights;
    let heaviest = (1..4).fold(0, |best, k| if weights[k] > weights[best] { k } else { best });
    let corner = found.near.pairs[heaviest];
    let facets_around = |k: usize| {
        let place = [found.on_moving, found.on_fixed][k] - pair.bodies.translations[k];
        let position = sides[k].matrix.transpose() * place;
        let corner = [corner.moving, corner.fixed][k].0;
        let point = SurfacePoint { position, outward: outward[k] };
        FacetGroup::new(&bodies[k], corner, &point, NEAR_NOISES * scene.noise)
    };
    let [p, q] = [facets_around(0)?, facets_around(1)?];
    let most = lower + (MAX_WIDTH_NOISES - triangle::LENGTH_NOISES) * scene.noise;
    let mut leaves = 0;
    let mut pairs = p.facets().iter().flat_map(|&f| q.facets().iter().map(move |&g| [f, g]));
    pairs.find_map(|triangles| {
        leaves += 1;
        let spot = NearestPoints::from_triangles(scene, triangles);
        (spot.nearest.length <= most).then_some(NearestFacets { spot, lower, leaves })
    })
}
