//! A plane between two convex solids and their nearest facets, from the distance of their hulls.
//!
//! - *Lower bound:* the vertices of both solids lie on different sides of two planes with the normal of the hulls'
//!   distance. The solids are apart by at least the distance of these planes, so neither is inside the other.
//! - *Upper bound:* the distance of two facets around the nearest points of the hulls.
//!
//! The hulls only guess the normal and the facets. If the bounds differ by more than rounding, there is no answer.

use glam::DVec3;

use super::HullPair;
use super::surface::{FacetGroup, NEAR_NOISES, Surface, SurfacePoint};
use crate::solve::nearest::search::{max_height_of_node, nearest_plane_bound};
use crate::solve::nearest::{NearestPoints, triangle};
use crate::solve::scene::{PairFrame, PlacedBody};
use crate::solve::separate::{HEIGHTS, max_height_along};
use colltrans_convex::answer::{Grazing, Intersection, Outcome};
use colltrans_convex::pair::Pair;
use colltrans_convex::setting::VertexPair;

/// Maximum difference of the bounds, in noises: below that of a search through the trees.
const MAX_WIDTH_NOISES: f64 = 4.5;

/// The nearest facets of two bodies that a plane separates.
pub(crate) struct NearestFacets {
    pub(crate) spot: NearestPoints,
    /// Lower bound of the distance of the bodies.
    pub(crate) lower: f64,
    /// Lower bound that the plane between the nearest facets proves ([`nearest_plane_bound`]), if it was requested.
    pub(crate) proven: Option<f64>,
    /// Number of compared pairs of facets.
    pub(crate) leaves: u32,
}

/// Computes a lower bound of the distance of two bodies as they are offset in `scene`, along a unit normal. It is not
/// positive if the plane does not certainly separate them.
fn distance_bound_along(scene: &PairFrame, pair: &HullPair, normal: DVec3) -> f64 {
    let support = |k: usize, side: &PlacedBody, normal: DVec3| {
        pair.surfaces[k].body.hull.support(side.matrix.transpose() * normal).index() as u32
    };
    let highest = VertexPair::from_indices(
        support(0, &scene.moving, normal),
        support(1, &scene.fixed, -normal),
    );
    // One noise covers the length of the normal.
    plane_margin(scene, &pair.surfaces, normal, highest) - scene.noise
}

/// Computes a lower bound of the distance of the offset bodies along a normal. It is not positive if no plane with that
/// normal certainly separates them. `pair` has a highest vertex of the moving hull and a lowest one of the fixed hull.
pub(crate) fn plane_margin(
    scene: &PairFrame,
    surfaces: &[Surface; 2],
    normal: DVec3,
    pair: VertexPair,
) -> f64 {
    let height = |k: usize, side: &PlacedBody, normal: DVec3| {
        let local = side.matrix.transpose() * normal;
        surfaces[k]
            .max_height(local, pair.indices()[k], side.amount, scene.noise)
            .unwrap_or_else(|| max_height_along(side, normal))
    };
    let (moving, fixed) = (height(0, &scene.moving, normal), height(1, &scene.fixed, -normal));
    normal.dot(scene.fixed.offset[0]) - fixed - moving - HEIGHTS * scene.noise
}

/// Checks whether a plane certainly separates the offset bodies of a scene by more than the minimum gap: that of a cast
/// of their hulls along the line through their centres. Returns `false` if a body is not convex.
pub(crate) fn is_plane_between(scene: &PairFrame) -> bool {
    let separated = |pair: HullPair| {
        let normal = match pair.cast(&scene.setting).intersects() {
            Ok(Intersection { meets: false, evidence }) => match evidence.outcome {
                Outcome::Separated(apart) => apart.certificate.normal,
                Outcome::Contact(contact) | Outcome::Grazing(Grazing { contact, .. }) => {
                    contact.certificate.normal
                }
            },
            _ => return false,
        };
        distance_bound_along(scene, &pair, normal) > scene.min_gap()
    };
    HullPair::of_convex(&scene.setting.bodies).is_some_and(separated)
}

/// Finds the nearest facets of two solids in the frame of `scene`, without an offset. Returns `None` if a solid is not
/// convex, if the solids may meet, or if the bounds differ by more than rounding. If `prove` is set, also `None` if the
/// plane between the facets proves less.
pub(crate) fn nearest_facets(scene: &PairFrame, prove: bool) -> Option<NearestFacets> {
    let pair = HullPair::of_convex(&scene.setting.bodies)?;
    let found = Pair { bodies: pair.hulls }.distance().ok()?;
    let normal = found.normal?;
    let lower = Some(distance_bound_along(scene, &pair, normal)).filter(|margin| *margin > 0.0)?;
    let sides = [&scene.moving, &scene.fixed];
    let weights = found.near.weights;
    let heaviest = (1..4).fold(0, |best, k| if weights[k] > weights[best] { k } else { best });
    let corner = found.near.pairs[heaviest];
    let facets_around = |k: usize| {
        let place = [found.on_moving, found.on_fixed][k] - pair.hulls.translations[k];
        let back = sides[k].matrix.transpose();
        let point = SurfacePoint { position: back * place, outward: back * [normal, -normal][k] };
        let corner = [corner.moving, corner.fixed][k].0;
        FacetGroup::new(&pair.surfaces[k], corner, &point, NEAR_NOISES * scene.noise)
    };
    let [p, q] = [facets_around(0)?, facets_around(1)?];
    let most = lower + (MAX_WIDTH_NOISES - triangle::LENGTH_NOISES) * scene.noise;
    let mut leaves = 0;
    let mut pairs = p.facets().iter().flat_map(|&f| q.facets().iter().map(move |&g| [f, g]));
    pairs.find_map(|triangles| {
        leaves += 1;
        let spot = NearestPoints::from_triangles(scene, triangles);
        if spot.nearest.length > most {
            return None;
        }
        let proven = prove.then(|| {
            nearest_plane_bound(scene, triangles, |side, local| {
                let surface = &pair.surfaces[usize::from(!side.moving)];
                let from = surface.body.hull.support(local).index() as u32;
                let height = surface.max_height(local, from, side.amount, scene.noise);
                height.unwrap_or_else(|| max_height_of_node(side, 0, local))
            })
        });
        let is_proven = proven.is_none_or(|proven| proven > 0.0 && proven >= lower - scene.noise);
        is_proven.then_some(NearestFacets { spot, lower, proven, leaves })
    })
}
