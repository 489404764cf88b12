//! The facets around a place of the hulls' contact, as the search would take them: where bodies are shrunk by more than
//! rounding, or the hulls leave something in doubt.

use glam::{DVec2, DVec3, Vec3Swizzles};

use super::{Body, Hulls};
use crate::answer::{Contact, Outcome};
use crate::solve::solid::scene::{Scene, Side};
use crate::solve::solid::search::{Aim, Found, SLACK, Search};
use crate::solve::solid::separate::{HEIGHTS, farthest};

/// Steps from facet to facet towards a place; facets there that are held against each other.
const MOST_STEPS: usize = 32;
const MOST_FACETS: usize = 4;
/// Vertices that are held against each other for the farthest.
const MOST_TOP: usize = 32;

/// What the hulls tell of gaps below a limit.
pub(in crate::cast::solid) enum Guessed {
    /// Nothing stops the moving body.
    Free,
    Stop(Found),
}

impl Hulls<'_> {
    /// What the facets around their contact tell of gaps below a limit; `None` if that is nothing. Counts pairs of facets.
    pub(in crate::cast::solid) fn guessed(
        &self,
        scene: &Scene,
        limit: f64,
        leaves: &mut u32,
    ) -> Option<Guessed> {
        match &self.first {
            Outcome::Contact(contact) if contact.certificate.lower > 0.0 => {
                stop(scene, self.bodies, contact, limit, leaves)
            }
            Outcome::Contact(contact) if contact.certificate.upper < 0.0 => {
                (margin(scene, self.bodies, self.last()?) > 0.0).then_some(Guessed::Free)
            }
            _ => None,
        }
    }
}

impl Body {
    /// No vertex of the solid, shrunk, is farther along a normal than this, up to rounding. What lies lower than one
    /// vertex by twice what shrinking moves is not; what does not is found from there over edges, as the plateau of a
    /// support point is.
    fn reach(&self, scene: &Scene, side: &Side, normal: DVec3, from: u32) -> f64 {
        let local = side.matrix.transpose() * normal;
        let height = |v: u32| local.dot(self.hull.vertices()[v as usize]);
        let end = height(from) - 2.0 * side.moved() - scene.noise - self.hull.plateau_depth();
        let (mut top, mut count, mut next) = ([from; MOST_TOP], 1, 0);
        let mut reach = f64::NEG_INFINITY;
        while self.whole && next < count {
            reach = reach.max(local.dot(side.vertex(self.number(top[next]))));
            for &v in self.hull.neighbours(top[next]) {
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
        if self.whole { reach } else { farthest(side, normal) }
    }
}

/// How far apart the bodies are along the normal of a contact of their hulls, for certain; negative if they are not.
fn margin(scene: &Scene, [p, q]: [&Body; 2], contact: &Contact) -> f64 {
    let (normal, pair) = (contact.certificate.normal, contact.certificate.pairs[0]);
    let moving = p.reach(scene, &scene.moving, normal, pair.moving.0);
    let fixed = q.reach(scene, &scene.fixed, -normal, pair.fixed.0);
    normal.dot(scene.fixed.offset[0]) - fixed - moving - HEIGHTS * scene.noise
}

/// What stops the moving body, if it is the facets around a contact of the hulls.
fn stop(
    scene: &Scene,
    bodies: [&Body; 2],
    contact: &Contact,
    limit: f64,
    leaves: &mut u32,
) -> Option<Guessed> {
    let proof = &contact.certificate;
    let slope = proof.normal.dot(scene.setting.direction) / scene.setting.length;
    let least = margin(scene, bodies, contact) / slope;
    if least <= 0.0 {
        return None;
    }
    // So that a search, which rounds otherwise, finds nothing below the limit either.
    if least >= limit + SLACK * scene.noise {
        return Some(Guessed::Free);
    }
    let around = |k: usize| {
        let side = [&scene.moving, &scene.fixed][k];
        let vertex = |i: usize| [proof.pairs[i].moving, proof.pairs[i].fixed][k];
        let local = |i: usize| bodies[k].hull.vertices()[vertex(i).index()] * proof.weights[i];
        let at = side.view * (local(0) + local(1) + local(2)) + side.view_offset;
        let first = vertex(0);
        let from = [bodies[k].at[first.index()], bodies[k].number(first.0)];
        Around::new(scene, side, from, at.xy())
    };
    let [p, q] = [around(0), around(1)];
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
    best.map(|found| Guessed::Stop(found.among_all(scene)))
}

/// Facets of one body around a place, by shadows.
struct Around {
    facets: [u32; MOST_FACETS],
    count: usize,
}

impl Around {
    /// From a facet of a convex body on, first around its corner to one that faces the other body, then towards the
    /// place: the shadows of such facets lie side by side.
    fn new(scene: &Scene, side: &Side, [from, corner]: [u32; 2], at: DVec2) -> Self {
        let solid = side.solid;
        let near = 64.0 * scene.noise + 2.0 * side.moved();
        let mut shadow = Shadow::new(side, from);
        for _ in 0..MOST_STEPS {
            if shadow.faces {
                break;
            }
            let own = solid.triangles()[shadow.facet as usize];
            let k = own.iter().position(|&v| v == corner).unwrap_or(0);
            shadow = Shadow::new(side, solid.neighbours()[shadow.facet as usize][k]);
        }
        for _ in 0..MOST_STEPS {
            let (k, outside) = shadow.farthest_outside(at);
            if outside <= near {
                break;
            }
            let next = Shadow::new(side, solid.neighbours()[shadow.facet as usize][k]);
            if !next.faces {
                break;
            }
            shadow = next;
        }
        // Those across a side that the place is near, too.
        let mut around = Self { facets: [shadow.facet; MOST_FACETS], count: 1 };
        for k in (0..3).filter(|&k| shadow.outside(k, at) >= -near) {
            around.facets[around.count] = solid.neighbours()[shadow.facet as usize][k];
            around.count += 1;
        }
        around
    }

    fn facets(&self) -> &[u32] {
        &self.facets[..self.count]
    }
}

/// The shadow of a facet, counter-clockwise if the facet faces the other body.
struct Shadow {
    facet: u32,
    corners: [DVec2; 3],
    /// 1 if it runs as the body lists it, else -1.
    way: f64,
    faces: bool,
}

impl Shadow {
    fn new(side: &Side, facet: u32) -> Self {
        let corners = side.corners(facet as usize).map(|c| c.at.xy());
        let way = if side.moving { 1.0 } else { -1.0 };
        let area = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]);
        Self { facet, corners, way, faces: area * way > 0.0 }
    }

    /// How far outside of side `k` a point lies.
    fn outside(&self, k: usize, at: DVec2) -> f64 {
        let [a, b] = [self.corners[k], self.corners[(k + 1) % 3]];
        self.way * (b - a).normalize_or_zero().perp_dot(a - at)
    }

    /// Outside of which side it lies farthest, and how far.
    fn farthest_outside(&self, at: DVec2) -> (usize, f64) {
        let of = [0, 1, 2].map(|k| (k, self.outside(k, at)));
        of.into_iter().fold(of[0], |best, next| if next.1 > best.1 { next } else { best })
    }
}
