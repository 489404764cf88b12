//! The answer of the hulls' cast as that of the solids.
//!
//! *Below.* The solids, and the smaller ones that they are shrunk to, lie in their hulls, to within the hulls' errors
//! where those lack a vertex: what is proven of the hulls holds of them.
//!
//! *Above.* The line pierces a triangle of `M`. If what is deeper than `e` below the surface of a hull is in the smaller
//! body, that holds the hull shrunk about a point by the share `e / r`, where a ball of radius `r` around the point lies in
//! the hull: each point of the hull is within `2 R e / r` of one of it, `R` being how far the hull reaches. So each corner
//! of the triangle is within some `s` of a point of the smaller bodies' `M`, whose differences are convex too. With `a` the
//! triangle's least altitude across the line, the line's weights change by at most `s / (a - 2 s)`, and the line still
//! pierces the triangle if all of them are larger, along the contact's normal no higher than the highest corner and `s`.
//! And what is deeper than the dent of a convex solid ([`Body`]) and than its vertices are moved when it is shrunk is in
//! the smaller body: a surface that moves by no more than that passes no such point.
//!
//! *Facets.* The contact point lies on a corner, on an edge or within a facet of either body: clearly, or it is not told
//! here. Then the shadows of two such facets that face each other overlap, and their gap is the answer: not both points are
//! corners, nor one a corner and the other on an edge, nor do edges line up, as the triangle has an altitude.

use glam::{DMat3, DVec3};

use super::contact_facets::least_gap;
use super::{Hulls, Spot, Surface};
use crate::body::Solid;
use crate::cast::SolidFree;
use crate::cast::boxes::leaves_behind;
use crate::cast::{check_left, default_tolerance};
use crate::solve::contact::{SolidContact, feature};
use crate::solve::scene::{Scene, permutes};
use crate::solve::search::{Found, SLACK};
use crate::solve::separate;
use crate::solve::steps::SolidSteps;
use colltrans_convex::answer::{Bounded, Certificate, Clearance, Contact, Outcome, Separation};
use colltrans_convex::body::Feature;
use colltrans_convex::cast::Cast;
use colltrans_convex::setting::VertexPair;

/// Poses may be off rotations, and facets off their plane across the direction, by such a share.
const SHEARED: f64 = 1e-5;
/// Contacts in planes that are steeper along the direction are not told.
const STEEPEST: f64 = 1.0 / 16.0;
/// Noises that a place may be off sideways, and an altitude has to be more than.
const SIDEWAYS: f64 = 8.0;
const ALTITUDES: f64 = 1024.0;
/// Noises that the heights of vertices over a plane may be off in its check, and another one.
const MARGIN: f64 = separate::ROUNDING + 1.0;

impl Hulls<'_> {
    /// The clearance of the solids, if what is proven of their hulls is proven of them.
    pub(in crate::cast) fn certain(&self, solids: &Cast<'_, Solid>) -> Option<Clearance<Solid>> {
        let told = Told::new(solids, self)?;
        match &self.first {
            Outcome::Separated(apart) => told.apart(&apart.certificate),
            Outcome::Contact(contact) if contact.certificate.lower > 0.0 => {
                told.stopped(contact, 0.0, None)
            }
            Outcome::Contact(contact) if contact.certificate.upper < 0.0 => {
                if leaves_behind(solids, told.sides[0].amount) {
                    let pierced = Pierced::new(&self.cast, contact, told.noise)?;
                    return pierced.height(told.shift(true)).map(|_| free(None));
                }
                // Along the direction no plane parts shadows that overlap.
                let last = self.last()?;
                let pierced = Pierced::new(&self.cast.reversed(), last, told.noise)?;
                let lacking = told.lacking() / (pierced.slope * solids.setting.length);
                let is_behind = last.certificate.lower - lacking > 0.0;
                is_behind.then(|| pierced.height(told.shift(true))).flatten().map(|_| free(None))
            }
            _ => None,
        }
    }

    /// The same of bodies that touch, as far as their hulls tell, but do not, or do not overlap, as `scene` has them.
    pub(in crate::cast) fn touching(
        &self,
        solids: &Cast<'_, Solid>,
        scene: &Scene,
    ) -> Option<Clearance<Solid>> {
        let Outcome::Contact(contact) = &self.first else { return None };
        let proof = &contact.certificate;
        if proof.lower > 0.0 || proof.upper < 0.0 {
            return None;
        }
        let told = Told::new(solids, self)?;
        let least = least_gap(scene, &self.bodies, contact)?;
        told.stopped(contact, least, None)
    }

    /// The same of bodies that two facets are known to stop, and of whose gaps none is known to be less than a length.
    pub(in crate::cast) fn stopped_by(
        &self,
        solids: &Cast<'_, Solid>,
        found: &Found,
        least: f64,
        steps: SolidSteps,
    ) -> Option<Clearance<Solid>> {
        let Outcome::Contact(contact) = &self.first else { return None };
        let told = Told::new(solids, self)?;
        told.stopped(contact, least, Some(([found.moving, found.fixed], steps)))
    }
}

fn free(separation: Option<Separation>) -> Clearance<Solid> {
    Clearance::Free(SolidFree { separation, steps: SolidSteps::default() })
}

/// The solids of a query beside their hulls.
struct Told<'h, 'a> {
    solids: &'h Cast<'a, Solid>,
    hulls: &'h Hulls<'a>,
    sides: [Side<'a>; 2],
    noise: f64,
}

/// One of them.
struct Side<'a> {
    surface: Surface<'a>,
    matrix: DMat3,
    /// By how much it is shrunk.
    pub amount: f64,
    /// How far that moves a vertex, at most.
    moved: f64,
    /// The direction, of the fixed body against it, at length 1 in the body's frame.
    ahead: DVec3,
}

impl<'h, 'a> Told<'h, 'a> {
    /// `None` where shrinking is more than rounding asks for, or bodies are dented by more: then the facets of a place may
    /// lie below it, or lean out over those that have it.
    fn new(solids: &'h Cast<'a, Solid>, hulls: &'h Hulls<'a>) -> Option<Self> {
        let setting = &solids.setting;
        let noise = setting.noise().point();
        let squared = permutes(setting.moving_matrix) && permutes(setting.fixed_matrix);
        let tolerance = solids.options.tolerance.unwrap_or(default_tolerance(squared, noise));
        let is_dented = |surface: &Surface| surface.body.dent > SIDEWAYS * noise;
        if tolerance > default_tolerance(false, noise)
            || hulls.bodies.iter().any(is_dented)
            || check_left(solids, tolerance).is_err()
        {
            return None;
        }
        let amount = 0.5 * tolerance;
        let side = |surface: Surface<'a>, matrix: DMat3, ahead: DVec3| {
            let moved = surface.solid.max_offset_displacement(amount);
            Side { surface, matrix, amount, moved, ahead: matrix.transpose() * ahead }
        };
        let [p, q] = hulls.bodies;
        let sides = [
            side(p, setting.moving_matrix, setting.unit),
            side(q, setting.fixed_matrix, -setting.unit),
        ];
        Some(Self { solids, hulls, sides, noise })
    }

    /// What the hulls may lack of the solids, together.
    fn lacking(&self) -> f64 {
        let lacking = |surface: &Surface| {
            if surface.body.whole { 0.0 } else { surface.body.hull.hull_error() }
        };
        lacking(&self.sides[0].surface) + lacking(&self.sides[1].surface)
    }

    /// How far a point of `M` may be from one of the solids' own, as they are or shrunk.
    fn shift(&self, shrunk: bool) -> f64 {
        let of = |side: &Side| {
            let Surface { solid, body } = side.surface;
            let depth = body.dent + if shrunk { side.moved } else { 0.0 };
            let share = depth / body.inner;
            // A plate without an inside has no share of it.
            if (0.0..1.0).contains(&share) { 2.0 * solid.reach() * share } else { f64::INFINITY }
        };
        (1.0 + SHEARED) * (of(&self.sides[0]) + of(&self.sides[1]))
    }

    fn apart(&self, plane: &Separation) -> Option<Clearance<Solid>> {
        let normal = plane.normal;
        let closing = separate::closing(&self.solids.setting, normal, self.noise);
        let margin = plane.margin - self.lacking() - MARGIN * self.noise - closing;
        let told = self.solids.options.before.is_none().then_some(Separation { normal, margin });
        (margin > 0.0).then(|| free(told))
    }

    /// By a contact of the hulls, of bodies of whose gaps, shrunk, none is known to be less than a length; and by which facets,
    /// if that is known, with the work that it took.
    fn stopped(
        &self,
        contact: &Contact,
        least: f64,
        known: Option<([u32; 2], SolidSteps)>,
    ) -> Option<Clearance<Solid>> {
        let (setting, proof) = (&self.solids.setting, &contact.certificate);
        let (normal, length) = (contact.normal, setting.length);
        let pierced = Pierced::new(&self.hulls.cast, contact, self.noise)?;
        let lower = proof.lower - self.lacking() / (pierced.slope * length);
        let touching = proof.lower <= 0.0;
        if !touching && lower <= 0.0 {
            return None;
        }
        // Less by what dividing may round away.
        let least = lower.max(least / length * (1.0 - 2.0 * f64::EPSILON));
        let end = self.solids.options.before.unwrap_or(f64::INFINITY);
        // So that a search, which rounds otherwise, finds nothing before the end either.
        if least >= end + SLACK * self.noise / length {
            return Some(free(None));
        }
        let upper = |shrunk| Some(proof.upper + pierced.height(self.shift(shrunk))? / length);
        let shrunk = self.sides[0].amount != 0.0;
        let back =
            if shrunk { normal.dot(self.moved(contact)) / (pierced.slope * length) } else { 0.0 };
        let (value, most) = (contact.translation + back, upper(shrunk)?);
        if most < least || most >= end {
            return None;
        }
        let shrunk_distance =
            Bounded { value: value.clamp(least, most), lower: least, upper: most };
        let translation = if shrunk {
            Bounded { value: contact.translation, lower, upper: upper(false)? }
        } else {
            shrunk_distance
        };
        let spots = self.spots(contact);
        let (triangles, steps) = match known {
            Some(known) => known,
            None => (self.facets(contact, &spots, pierced.sine)?, SolidSteps::default()),
        };
        let points = contact.points(&self.hulls.cast);
        let contact = SolidContact {
            translation,
            shrunk_distance,
            normal,
            point_on_moving: points.on_moving,
            point_on_fixed: points.on_fixed,
            moving_feature: self.sides[0].feature(triangles[0], &spots[0], self.noise),
            fixed_feature: self.sides[1].feature(triangles[1], &spots[1], self.noise),
            triangles,
            steps,
        };
        Some(Clearance::Blocked { distance: translation.lower.max(0.0), contact })
    }

    /// By how much shrinking moves the point of the fixed body against that of the moving one.
    fn moved(&self, contact: &Contact) -> DVec3 {
        let proof = &contact.certificate;
        let of = |k: usize| {
            let Side { surface: Surface { solid, body }, matrix, amount, .. } = self.sides[k];
            let field = &solid.shrinking().field;
            let terms = proof.pairs.iter().zip(proof.weights);
            let mean = terms.map(|(pair, w)| field[body.number(pair.numbers()[k]) as usize] * w);
            matrix * (mean.sum::<DVec3>() * amount)
        };
        of(1) - of(0)
    }

    /// Where the bodies touch.
    fn spots(&self, contact: &Contact) -> [Spot; 2] {
        let Certificate { pairs, weights, .. } = &contact.certificate;
        let points = self.hulls.cast.setting.weighted(pairs, weights);
        [(0, contact.normal), (1, -contact.normal)].map(|(k, outward)| Spot {
            at: points[k],
            outward: self.sides[k].matrix.transpose() * outward,
        })
    }

    /// A facet of either body there; edges cross with at least this sine of their angle.
    fn facets(&self, contact: &Contact, spots: &[Spot; 2], sine: f64) -> Option<[u32; 2]> {
        let facet = |k: usize| {
            let place = Place::of(&contact.certificate.pairs, k);
            self.sides[k].facet(place, &spots[k], [self.noise, sine])
        };
        Some([facet(0)?, facet(1)?])
    }
}

/// A triangle of `M` that the line pierces.
struct Pierced {
    /// The least one across the direction, and as a share of the longest side.
    altitude: f64,
    sine: f64,
    least_weight: f64,
    /// How much higher along the contact's normal a corner is than where the line pierces.
    rise: f64,
    /// The normal's part along the direction.
    slope: f64,
    noise: f64,
}

impl Pierced {
    fn new(cast: &Cast, contact: &Contact, noise: f64) -> Option<Self> {
        let (proof, unit) = (&contact.certificate, cast.setting.unit);
        let [a, b, c] = proof.pairs.each_ref().map(|pair| cast.setting.difference(*pair));
        let [u, v] = [b - a, c - a];
        let sides = [u, v, c - b].map(DVec3::length_squared);
        let longest = sides.into_iter().fold(0.0, f64::max).sqrt();
        let altitude = u.cross(v).dot(unit).abs() / longest;
        let least_weight = proof.weights.into_iter().fold(1.0, f64::min);
        let rises = [0.0, contact.normal.dot(u), contact.normal.dot(v)];
        let mean = proof.weights[1] * rises[1] + proof.weights[2] * rises[2];
        let rise = rises.into_iter().fold(0.0, f64::max) - mean;
        let slope = contact.normal.dot(unit);
        let clear = altitude > ALTITUDES * noise && slope >= STEEPEST;
        let sine = altitude / longest;
        clear.then_some(Self { altitude, sine, least_weight, rise, slope, noise })
    }

    /// By how much the line may pierce it higher when its corners are moved by so much; `None` if it may miss it.
    fn height(&self, shift: f64) -> Option<f64> {
        let room = self.altitude - 2.0 * shift;
        let clear = 2.0 * shift / room + SIDEWAYS * self.noise / self.altitude;
        let pierces = room > 0.5 * self.altitude && self.least_weight > clear;
        pierces.then_some((shift + self.rise + 2.0 * self.noise) / self.slope)
    }
}

/// What of a hull is in a contact, by its vertices.
#[derive(Clone, Copy)]
enum Place {
    Corner(u32),
    Edge([u32; 2]),
    Face([u32; 3]),
}

impl Place {
    fn of(pairs: &[VertexPair; 3], k: usize) -> Self {
        let [a, b, c] = pairs.each_ref().map(|pair| pair.numbers()[k]);
        match (a == b, b == c, a == c) {
            (true, true, _) => Self::Corner(a),
            (true, false, _) | (_, false, true) => Self::Edge([b, c]),
            (false, true, _) => Self::Edge([a, b]),
            (false, false, false) => Self::Face([a, b, c]),
        }
    }
}

impl Side<'_> {
    /// What of the body touches, with a triangle at a place.
    fn feature(&self, triangle: u32, spot: &Spot, noise: f64) -> Feature {
        feature(self.surface.solid, triangle, (spot.at, spot.outward), noise)
    }

    /// A facet that looks at the other body, shrunk or not, with a point in it, or on an edge or a corner, clearly.
    fn facet(&self, place: Place, spot: &Spot, [noise, sine]: [f64; 2]) -> Option<u32> {
        let looks = |t: u32| self.looks_ahead(t, noise).then_some(t);
        match place {
            Place::Corner(v) => self.surface.around(v).find_map(|(t, _)| looks(t)),
            Place::Edge([a, b]) => {
                let beside = self.surface.beside(a, b).or_else(|| self.surface.beside(b, a));
                let beside = beside.or_else(|| self.part_of_edge([a, b], spot, noise, sine))?;
                beside.into_iter().find_map(looks)
            }
            Place::Face([corner, ..]) => looks(self.face(corner, spot, noise)?),
        }
    }

    /// Whether a facet looks along the direction, or against it, by more than shrinking and poses turn it.
    fn looks_ahead(&self, triangle: u32, noise: f64) -> bool {
        let [a, b, c] = self.surface.corners(triangle);
        let [u, v] = [b - a, c - a];
        let (area, sides) = (u.cross(v), (u.abs() + v.abs()).element_sum());
        let least = SHEARED * area.abs().element_sum() + 8.0 * (self.moved + noise) * sides;
        area.dot(self.ahead) > least
    }

    /// The facets on either side of a part of an edge of the hull with a point clearly on it: so
    /// far from its ends as edges may be off each other along it; the same facet twice if it has the point clearly inside,
    /// as where the edge is no more than a line across a face. A side that crosses such a line is no part of it: it may run
    /// along the other body's edge, and facets beside that have no more than the edge in common.
    fn part_of_edge(&self, ends: [u32; 2], spot: &Spot, noise: f64, sine: f64) -> Option<[u32; 2]> {
        let near = self.near(noise);
        let triangle = self.surface.facet_at(ends[0], spot, near)?;
        let [beside, clear] =
            [near, near / sine].map(|slack| self.surface.inside(triangle, spot, slack));
        let Some(k) = beside.iter().position(|&side| side <= 0.0) else {
            return Some([triangle; 2]);
        };
        let [from, to] = ends.map(|v| self.surface.body.hull.vertices()[v as usize]);
        let along = (to - from).try_normalize()?;
        let corners = self.surface.corners(triangle);
        let lies = |at: DVec3| along.cross(at - from).length() <= noise;
        let runs_along = lies(corners[k]) && lies(corners[(k + 1) % 3]);
        let on = runs_along && clear[(k + 1) % 3] > 0.0 && clear[(k + 2) % 3] > 0.0;
        on.then(|| [triangle, self.surface.solid.neighbours()[triangle as usize][k]])
    }

    /// How near to a facet's sides a point has to be to be in doubt.
    fn near(&self, noise: f64) -> f64 {
        2.0 * self.moved + SIDEWAYS * noise
    }

    /// The facet with a point clearly inside, of a face with a corner.
    fn face(&self, corner: u32, spot: &Spot, noise: f64) -> Option<u32> {
        let near = self.near(noise);
        let triangle = self.surface.facet_at(corner, spot, near)?;
        let inside = self.surface.inside(triangle, spot, near);
        inside.iter().all(|&side| side > 0.0).then_some(triangle)
    }
}
