//! Answer from the facets around the contact of the hulls, with gaps computed as in the search.
//!
//! Used if the bodies are offset by more than rounding, or if the certificate of the hulls proves too little.

use glam::DVec3;

use super::{Hulls, Surface, SurfacePoint};
use crate::solve::bound::box_gaps;
use crate::solve::overlap::{Overlap, is_overlap};
use crate::solve::projected::Projected;
use crate::solve::scene::{PairFrame, PlacedBody};
use crate::solve::search::{Aim, GapSearch, LeastGap, SLACK};
use crate::solve::separate::{HEIGHTS, max_height_along};
use colltrans_convex::answer::{Contact, Outcome};
use colltrans_convex::setting::VertexPair;

/// Maximum number of facets of one body that are compared.
const MAX_FACETS: usize = 4;
/// Distance of the contact point from a side, in noises, up to which the facet across counts too.
pub(super) const NEAR_NOISES: f64 = 64.0;
/// Depth of an overlap, as a share of the size, up to which the facets around the contact are tested.
const MAX_SHALLOW_DEPTH: f64 = 1e-3;
/// Maximum number of vertices that are compared for the farthest one.
const MAX_TOP_VERTICES: usize = 32;

/// Result of the facets around the contact.
pub(in crate::cast) enum ContactGuess {
    /// Nothing blocks the moving body below the limit.
    Free,
    /// Two facets block, and no gap is less than the length.
    Stop(LeastGap, f64),
}

impl Hulls<'_> {
    /// Decides the clearance with gaps below `limit` (a length) by the facets around the contact; `None` if they do
    /// not decide it. Adds the number of compared pairs to `leaves`.
    pub(in crate::cast) fn guess_at_contact(
        &self,
        scene: &PairFrame,
        limit: f64,
        leaves: &mut u32,
    ) -> Option<ContactGuess> {
        match &self.first_outcome {
            Outcome::Contact(contact) if contact.certificate.upper >= 0.0 => {
                blocking_pair(scene, &self.bodies, contact, limit, leaves)
            }
            Outcome::Contact(_) => (contact_margin(scene, &self.bodies, self.last_contact()?)
                > 0.0)
                .then_some(ContactGuess::Free),
            _ => None,
        }
    }

    /// Checks whether the first contact of the hulls is certainly behind, by less than [`MAX_SHALLOW_DEPTH`] along
    /// its normal. The facets around it may then show an overlap.
    pub(in crate::cast) fn has_shallow_contact(&self) -> bool {
        let Outcome::Contact(contact) = &self.first_outcome else { return false };
        let proof = &contact.certificate;
        let depth = -proof.lower * proof.normal.dot(self.cast.setting.direction);
        proof.upper < 0.0 && depth < MAX_SHALLOW_DEPTH * self.cast.setting.size()
    }

    /// Finds two facets around such a contact that show an overlap of the bodies of `scene`; `None` if there are
    /// none. Adds the number of tested pairs to `leaves`.
    pub(in crate::cast) fn shallow_overlap(
        &self,
        scene: &PairFrame,
        leaves: &mut u32,
    ) -> Option<Overlap> {
        let Outcome::Contact(contact) = &self.first_outcome else { return None };
        if !self.has_shallow_contact() {
            return None;
        }
        let [p, q] = facets_around_contact(scene, &self.bodies, contact)?;
        let pairs = p.facets().iter().flat_map(|&f| q.facets().iter().map(move |&g| (f, g)));
        let mut places = pairs.map(|(f, g)| Overlap::Facets(f, g));
        places.find(|&place| {
            *leaves += 1;
            is_overlap(scene, place)
        })
    }
}

impl Surface<'_> {
    /// Computes the maximum height of the offset solid's vertices along a normal of the world, above the origin of
    /// the body, up to rounding.
    ///
    /// Vertices lower than the hull vertex `from` by twice the displacement of the offset and by rounding cannot be
    /// highest. The others are found from `from` over edges of the hull, as the plateau of a support point is. If
    /// the hull lacks vertices, or more than [`MAX_TOP_VERTICES`] remain, the tree is searched.
    fn max_height(&self, scene: &PairFrame, side: &PlacedBody, normal: DVec3, from: u32) -> f64 {
        let Self { body, .. } = self;
        let local = side.matrix.transpose() * normal;
        let height = |v: u32| local.dot(body.hull.vertices()[v as usize]);
        let end =
            height(from) - 2.0 * side.max_displacement() - scene.noise - body.hull.plateau_depth();
        let (mut top, mut count, mut next) = ([from; MAX_TOP_VERTICES], 1, 0);
        let mut reach = f64::NEG_INFINITY;
        while body.has_all_vertices && next < count {
            reach = reach.max(local.dot(side.offset_vertex(body.solid_vertex(top[next]))));
            for &v in body.hull.neighbours(top[next]) {
                if height(v) < end || top[..count].contains(&v) {
                    continue;
                }
                if count == MAX_TOP_VERTICES {
                    return max_height_along(side, normal);
                }
                top[count] = v;
                count += 1;
            }
            next += 1;
        }
        if body.has_all_vertices { reach } else { max_height_along(side, normal) }
    }
}

/// Computes a lower bound of the distance of the offset bodies along the normal of a contact of their hulls. It is
/// not positive if no plane with that normal certainly separates them.
fn contact_margin(scene: &PairFrame, bodies: &[Surface; 2], contact: &Contact) -> f64 {
    plane_margin(scene, bodies, contact.certificate.normal, contact.certificate.pairs[0])
}

/// Computes a lower bound of the distance of the offset bodies along a normal. It is not positive if no plane with that
/// normal certainly separates them. `pair` has a highest vertex of the moving hull and a lowest one of the fixed hull.
pub(super) fn plane_margin(
    scene: &PairFrame,
    [p, q]: &[Surface; 2],
    normal: DVec3,
    pair: VertexPair,
) -> f64 {
    let moving = p.max_height(scene, &scene.moving, normal, pair.moving.0);
    let fixed = q.max_height(scene, &scene.fixed, -normal, pair.fixed.0);
    normal.dot(scene.fixed.offset[0]) - fixed - moving - HEIGHTS * scene.noise
}

/// Computes a lower bound, a length, of all gaps of facets along the direction, up to the rounding of one division. It
/// also proves that the bodies do not overlap. The gap of the boxes is used if the direction is an axis of both bodies
/// and the gap is neither negative nor below the lower bound of the hulls' contact. Otherwise a plane with the normal
/// of that contact is tested. `None` if it does not separate the bodies.
pub(super) fn gap_lower_bound(
    scene: &PairFrame,
    bodies: &[Surface; 2],
    contact: &Contact,
) -> Option<f64> {
    let (proof, length) = (&contact.certificate, scene.setting.length);
    if scene.moving.aligned[2] && scene.fixed.aligned[2] {
        let [p, q] = Projected::root_bounds(scene);
        let gap = box_gaps(&p, &q)[0];
        if gap >= (proof.lower * length).max(0.0) {
            return Some(gap);
        }
    }
    // One noise covers the component of the normal along the direction.
    let margin = contact_margin(scene, bodies, contact) - scene.noise;
    (margin > 0.0).then(|| margin * length / proof.normal.dot(scene.setting.direction))
}

/// Finds the blocking pair among the facets around a contact of the hulls. The result is free if the lower bound of
/// all gaps reaches `limit`, and `None` if no pair attains that bound to within the slack of a search.
fn blocking_pair(
    scene: &PairFrame,
    bodies: &[Surface; 2],
    contact: &Contact,
    limit: f64,
    leaves: &mut u32,
) -> Option<ContactGuess> {
    let least = gap_lower_bound(scene, bodies, contact)?;
    // With this slack a search, which rounds differently, finds nothing below the limit either.
    if least >= limit + SLACK * scene.noise {
        return Some(ContactGuess::Free);
    }
    let [p, q] = facets_around_contact(scene, bodies, contact)?;
    let pairs = p.facets().iter().flat_map(|&f| q.facets().iter().map(move |&g| [f, g]));
    let mut best: Option<LeastGap> = None;
    for pair in pairs {
        *leaves += 1;
        let Some(found) =
            GapSearch::new(scene, Aim::Stop, limit, |_, _| ()).compare_triangles(pair)
        else {
            continue;
        };
        if found.gap <= least + SLACK * scene.noise
            && best.is_none_or(|best| found.error < best.error)
        {
            best = Some(found);
        }
        // Gaps of steep facets have large errors, so another pair may be more accurate.
        if best.is_some_and(|best| best.error <= SLACK * scene.noise) {
            break;
        }
    }
    best.map(|found| ContactGuess::Stop(found.with_least_others(scene), least))
}

/// Finds the facets of both bodies around a contact of their hulls; `None` if a body has no facet there.
fn facets_around_contact(
    scene: &PairFrame,
    bodies: &[Surface; 2],
    contact: &Contact,
) -> Option<[FacetGroup; 2]> {
    let proof = &contact.certificate;
    let facet_group = |k: usize| {
        let side = [&scene.moving, &scene.fixed][k];
        let vertex = |i: usize| [proof.pairs[i].moving, proof.pairs[i].fixed][k];
        let local = |i: usize| bodies[k].body.hull.vertices()[vertex(i).index()] * proof.weights[i];
        let outward = if side.moving { proof.normal } else { -proof.normal };
        let point = SurfacePoint {
            position: local(0) + local(1) + local(2),
            outward: side.matrix.transpose() * outward,
        };
        FacetGroup::new(
            &bodies[k],
            vertex(0).0,
            &point,
            NEAR_NOISES * scene.noise + 2.0 * side.max_displacement(),
        )
    };
    Some([facet_group(0)?, facet_group(1)?])
}

/// Facets of one body around a point.
pub(super) struct FacetGroup {
    facets: [u32; MAX_FACETS],
    count: usize,
}

impl FacetGroup {
    /// Collects the facet at a point, and the facets across its sides within the distance `near` of the point. The
    /// search begins at the hull vertex `corner`. `None` if no facet is found.
    pub(super) fn new(
        surface: &Surface,
        corner: u32,
        point: &SurfacePoint,
        near: f64,
    ) -> Option<Self> {
        let triangle = surface.facet_at(corner, point, near)?;
        let mut group = Self { facets: [triangle; MAX_FACETS], count: 1 };
        for (k, inside) in surface.distances_inside(triangle, point, near).into_iter().enumerate() {
            if inside <= 0.0 {
                group.facets[group.count] = surface.solid.neighbours()[triangle as usize][k];
                group.count += 1;
            }
        }
        Some(group)
    }

    pub(super) fn facets(&self) -> &[u32] {
        &self.facets[..self.count]
    }
}
