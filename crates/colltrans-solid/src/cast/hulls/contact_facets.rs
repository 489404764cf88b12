//! The facets around a place of the hulls' contact, as the search would take them: where bodies are shrunk by more than
//! rounding, or the hulls leave something in doubt.

use glam::DVec3;

use super::{Hulls, Spot, Surface};
use crate::solve::bound::box_gaps;
use crate::solve::overlap::{Overlap, is_overlap};
use crate::solve::projected::Projected;
use crate::solve::scene::{Scene, Side};
use crate::solve::search::{Aim, Found, SLACK, Search};
use crate::solve::separate::{HEIGHTS, farthest};
use colltrans_convex::answer::{Contact, Outcome};

/// Facets at a place that are held against each other; how near a place is to a facet's sides for those across to be
/// among them, in noises.
const MOST_FACETS: usize = 4;
const NEAR: f64 = 64.0;
/// Share of the size up to which bodies that overlap are looked at where their hulls meet.
const SUNK: f64 = 1e-3;
/// Vertices that are held against each other for the farthest.
const MOST_TOP: usize = 32;

/// What the hulls tell of gaps below a limit.
pub(in crate::cast) enum Guessed {
    /// Nothing stops the moving body.
    Free,
    /// Two facets do, and no gap is less than a length.
    Stop(Found, f64),
}

impl Hulls<'_> {
    /// What the facets around their contact tell of gaps below a limit; `None` if that is nothing. Counts pairs of facets.
    pub(in crate::cast) fn guessed(
        &self,
        scene: &Scene,
        limit: f64,
        leaves: &mut u32,
    ) -> Option<Guessed> {
        match &self.first {
            Outcome::Contact(contact) if contact.certificate.upper >= 0.0 => {
                stop(scene, &self.bodies, contact, limit, leaves)
            }
            Outcome::Contact(_) => {
                (margin(scene, &self.bodies, self.last()?) > 0.0).then_some(Guessed::Free)
            }
            _ => None,
        }
    }

    /// Whether the bodies overlap by as little, as far as their hulls tell, as facets around their contact may show.
    pub(in crate::cast) fn are_sunk(&self) -> bool {
        let Outcome::Contact(contact) = &self.first else { return false };
        let proof = &contact.certificate;
        let depth = -proof.lower * proof.normal.dot(self.cast.setting.direction);
        proof.upper < 0.0 && depth < SUNK * self.cast.setting.scale()
    }

    /// A place where they do: two of these facets. Counts pairs of them.
    pub(in crate::cast) fn sunk(&self, scene: &Scene, leaves: &mut u32) -> Option<Overlap> {
        let Outcome::Contact(contact) = &self.first else { return None };
        if !self.are_sunk() {
            return None;
        }
        let [p, q] = around(scene, &self.bodies, contact)?;
        let pairs = p.facets().iter().flat_map(|&f| q.facets().iter().map(move |&g| (f, g)));
        let mut places = pairs.map(|(f, g)| Overlap::Facets(f, g));
        places.find(|&place| {
            *leaves += 1;
            is_overlap(scene, place)
        })
    }
}

impl Surface<'_> {
    /// No vertex of the solid, shrunk, is farther along a normal than this, up to rounding. What lies lower than one
    /// vertex by twice what shrinking moves is not; what does not is found from there over edges, as the plateau of a
    /// support point is.
    fn reach(&self, scene: &Scene, side: &Side, normal: DVec3, from: u32) -> f64 {
        let Self { body, .. } = self;
        let local = side.matrix.transpose() * normal;
        let height = |v: u32| local.dot(body.hull.vertices()[v as usize]);
        let end = height(from) - 2.0 * side.moved() - scene.noise - body.hull.plateau_depth();
        let (mut top, mut count, mut next) = ([from; MOST_TOP], 1, 0);
        let mut reach = f64::NEG_INFINITY;
        while body.whole && next < count {
            reach = reach.max(local.dot(side.vertex(body.number(top[next]))));
            for &v in body.hull.neighbours(top[next]) {
                if height(v) < end || top[..count].contains(&v) {
                    continue;
                }
                if count == MOST_TOP {
                    return farthest(side, normal);
                }
                top[count] = v;
                count += 1;
            }
            next += 1;
        }
        if body.whole { reach } else { farthest(side, normal) }
    }
}

/// How far apart the bodies are along the normal of a contact of their hulls, for certain; negative if they are not.
fn margin(scene: &Scene, [p, q]: &[Surface; 2], contact: &Contact) -> f64 {
    let (normal, pair) = (contact.certificate.normal, contact.certificate.pairs[0]);
    let moving = p.reach(scene, &scene.moving, normal, pair.moving.0);
    let fixed = q.reach(scene, &scene.fixed, -normal, pair.fixed.0);
    normal.dot(scene.fixed.offset[0]) - fixed - moving - HEIGHTS * scene.noise
}

/// No gap of facets is less, but for the rounding of a division, and the bodies do not overlap: by boxes along the direction,
/// where that is an axis of both, or by a plane between them along the normal of a contact of their hulls.
pub(super) fn least_gap(scene: &Scene, bodies: &[Surface; 2], contact: &Contact) -> Option<f64> {
    let (proof, length) = (&contact.certificate, scene.setting.length);
    if scene.moving.aligned[2] && scene.fixed.aligned[2] {
        let [p, q] = Projected::roots(scene);
        let gap = box_gaps(&p, &q)[0];
        if gap >= (proof.lower * length).max(0.0) {
            return Some(gap);
        }
    }
    // A little less, for the normal's part along the direction.
    let margin = margin(scene, bodies, contact) - scene.noise;
    (margin > 0.0).then(|| margin * length / proof.normal.dot(scene.setting.direction))
}

/// What stops the moving body, if it is the facets around a contact of the hulls.
fn stop(
    scene: &Scene,
    bodies: &[Surface; 2],
    contact: &Contact,
    limit: f64,
    leaves: &mut u32,
) -> Option<Guessed> {
    let least = least_gap(scene, bodies, contact)?;
    // So that a search, which rounds otherwise, finds nothing below the limit either.
    if least >= limit + SLACK * scene.noise {
        return Some(Guessed::Free);
    }
    let [p, q] = around(scene, bodies, contact)?;
    let pairs = p.facets().iter().flat_map(|&f| q.facets().iter().map(move |&g| [f, g]));
    let mut best: Option<Found> = None;
    for pair in pairs {
        *leaves += 1;
        let Some(found) = Search::new(scene, Aim::Stop, limit, |_, _| ()).of_pair(pair) else {
            continue;
        };
        if found.gap <= least + SLACK * scene.noise
            && best.is_none_or(|best| found.error < best.error)
        {
            best = Some(found);
        }
        // Of steep facets others may tell it better.
        if best.is_some_and(|best| best.error <= SLACK * scene.noise) {
            break;
        }
    }
    best.map(|found| Guessed::Stop(found.among_all(scene), least))
}

/// The facets of both bodies around a contact of their hulls.
fn around(scene: &Scene, bodies: &[Surface; 2], contact: &Contact) -> Option<[Around; 2]> {
    let proof = &contact.certificate;
    let around = |k: usize| {
        let side = [&scene.moving, &scene.fixed][k];
        let vertex = |i: usize| [proof.pairs[i].moving, proof.pairs[i].fixed][k];
        let local = |i: usize| bodies[k].body.hull.vertices()[vertex(i).index()] * proof.weights[i];
        let outward = if side.moving { proof.normal } else { -proof.normal };
        let spot =
            Spot { at: local(0) + local(1) + local(2), outward: side.matrix.transpose() * outward };
        Around::new(&bodies[k], vertex(0).0, &spot, NEAR * scene.noise + 2.0 * side.moved())
    };
    Some([around(0)?, around(1)?])
}

/// Facets of one body around a place.
struct Around {
    facets: [u32; MOST_FACETS],
    count: usize,
}

impl Around {
    /// The facet there, and those across a side that the place is near, too; from a corner of its face on.
    fn new(surface: &Surface, corner: u32, spot: &Spot, near: f64) -> Option<Self> {
        let triangle = surface.facet_at(corner, spot, near)?;
        let mut around = Self { facets: [triangle; MOST_FACETS], count: 1 };
        for (k, inside) in surface.inside(triangle, spot, near).into_iter().enumerate() {
            if inside <= 0.0 {
                around.facets[around.count] = surface.solid.neighbours()[triangle as usize][k];
                around.count += 1;
            }
        }
        Some(around)
    }

    fn facets(&self) -> &[u32] {
        &self.facets[..self.count]
    }
}
