//! Answer from the facets around the contact of the hulls, with gaps computed as in the search.
//!
//! Used if the bodies are offset by more than rounding, or if the certificate of the hulls proves too little.

use super::{Hulls, Surface};
use crate::solve::bound::box_gaps;
use crate::solve::hulls::{FacetGroup, NEAR_NOISES, SurfacePoint, plane_margin};
use crate::solve::overlap::{Overlap, is_overlap};
use crate::solve::projected::Projected;
use crate::solve::scene::PairFrame;
use crate::solve::search::{Aim, GapSearch, LeastGap, SLACK};
use colltrans_convex::answer::{Contact, Outcome};

/// Depth of an overlap, as a share of the size, up to which the facets around the contact are tested.
const MAX_SHALLOW_DEPTH: f64 = 1e-3;

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

/// Computes a lower bound of the distance of the offset bodies along the normal of a contact of their hulls. It is
/// not positive if no plane with that normal certainly separates them.
fn contact_margin(scene: &PairFrame, bodies: &[Surface; 2], contact: &Contact) -> f64 {
    plane_margin(scene, bodies, contact.certificate.normal, contact.certificate.pairs[0])
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
