//! Answer for the solids from the certificate of the hulls' cast.
//!
//! - *Lower bound:* the solids lie in their hulls, to within the hulls' errors, so planes that bound the hulls
//!   bound the solids.
//! - *Upper bound:* the line pierces a triangle of the hulls' `M`. Each corner of this triangle is near a point of
//!   the solids' `M`. If the weights are large enough, the line pierces the triangle of these points too.
//! - *Facets:* the contact point lies clearly on a vertex, on an edge or within a facet of each body. Then the gap
//!   of two such facets that face each other is the answer.
//!
//! Derivation: `docs/theory/hulls-of-solids.md`.

use glam::{DMat3, DVec3};

use super::contact_facets::gap_lower_bound;
use super::{Hulls, Surface};
use crate::body::Solid;
use crate::cast::SolidFree;
use crate::cast::boxes::moves_away;
use crate::cast::{check_thickness, default_tolerance};
use crate::solve::contact::{SolidContact, feature_at};
use crate::solve::hulls::SurfacePoint;
use crate::solve::scene::{PairFrame, permutes_axes};
use crate::solve::search::{LeastGap, SLACK};
use crate::solve::separate;
use crate::solve::steps::SolidSteps;
use colltrans_convex::answer::{Bounded, Certificate, Clearance, Contact, Outcome, Separation};
use colltrans_convex::body::Feature;
use colltrans_convex::cast::Cast;
use colltrans_convex::setting::VertexPair;

/// Bound on the relative error that a pose's matrix, which is not exactly a rotation, causes in lengths and in
/// normals of facets.
const POSE_SKEW: f64 = 1e-5;
/// Minimum component along the direction of the unit contact normal. Contacts in steeper planes are not
/// transferred.
const MIN_SLOPE: f64 = 1.0 / 16.0;
/// Bound on the lateral error of a point, in noises.
const LATERAL_NOISES: f64 = 8.0;
/// Minimum altitude of a pierced triangle, in noises; it must exceed this.
const MIN_ALTITUDE_NOISES: f64 = 1024.0;
/// Error bound of heights of vertices above a plane in its verification, in noises, with one noise added.
const HEIGHT_NOISES: f64 = separate::ROUNDING + 1.0;

impl Hulls<'_> {
    /// Returns the clearance of the solids if the certificate of the hulls proves it; otherwise `None`.
    pub(in crate::cast) fn transferred_clearance(
        &self,
        solids: &Cast<'_, Solid>,
    ) -> Option<Clearance<Solid>> {
        let transfer = HullTransfer::new(solids, self)?;
        match &self.first_outcome {
            Outcome::Separated(apart) => transfer.separated_clearance(&apart.certificate),
            Outcome::Contact(contact) if contact.certificate.lower > 0.0 => {
                transfer.blocked_clearance(contact, 0.0, None)
            }
            Outcome::Contact(contact) if contact.certificate.upper < 0.0 => {
                if moves_away(solids, transfer.sides[0].amount) {
                    let pierced = PiercedTriangle::new(&self.cast, contact, transfer.noise)?;
                    return pierced
                        .max_rise(transfer.difference_error(true))
                        .map(|_| free_clearance(None));
                }
                // Shadows that overlap are not separated by any plane parallel to the direction.
                let last = self.last_contact()?;
                let pierced = PiercedTriangle::new(&self.cast.reversed(), last, transfer.noise)?;
                let missing = transfer.missing_extent() / (pierced.slope * solids.setting.length);
                let is_behind = last.certificate.lower - missing > 0.0;
                is_behind
                    .then(|| pierced.max_rise(transfer.difference_error(true)))
                    .flatten()
                    .map(|_| free_clearance(None))
            }
            _ => None,
        }
    }

    /// Returns the first contact of solids without an offset, which may be behind; `None` if the certificate of the hulls
    /// does not prove it.
    pub(in crate::cast) fn first_contact(
        &self,
        solids: &Cast<'_, Solid>,
    ) -> Option<Outcome<Solid>> {
        let transfer = HullTransfer::new(solids, self)?;
        let found = match &self.first_outcome {
            Outcome::Separated(apart) => transfer.separated_clearance(&apart.certificate)?,
            Outcome::Contact(contact) => {
                transfer.blocked_clearance(contact, f64::NEG_INFINITY, None)?
            }
            Outcome::Grazing(_) => return None,
        };
        Some(match found {
            Clearance::Blocked { contact, .. } => Outcome::Contact(contact),
            Clearance::Free(free) => Outcome::Separated(free),
            Clearance::Overlapping(_) => return None,
        })
    }

    /// Returns the clearance of solids whose hulls touch to within the bounds of their certificate. The bodies of
    /// `scene` prove the lower bound and that there is no overlap; `None` if they do not.
    pub(in crate::cast) fn touching_clearance(
        &self,
        solids: &Cast<'_, Solid>,
        scene: &PairFrame,
    ) -> Option<Clearance<Solid>> {
        let Outcome::Contact(contact) = &self.first_outcome else { return None };
        let proof = &contact.certificate;
        if proof.lower > 0.0 || proof.upper < 0.0 {
            return None;
        }
        let transfer = HullTransfer::new(solids, self)?;
        let least = gap_lower_bound(scene, &self.bodies, contact)?;
        transfer.blocked_clearance(contact, least, None)
    }

    /// Returns the clearance of solids that the facets of `found` block, where no gap is less than `least` (a
    /// length); `None` if the certificate of the hulls does not prove the bounds. `steps` is the work done before.
    pub(in crate::cast) fn clearance_by_facets(
        &self,
        solids: &Cast<'_, Solid>,
        found: &LeastGap,
        least: f64,
        steps: SolidSteps,
    ) -> Option<Clearance<Solid>> {
        let Outcome::Contact(contact) = &self.first_outcome else { return None };
        let transfer = HullTransfer::new(solids, self)?;
        transfer.blocked_clearance(contact, least, Some(([found.moving, found.fixed], steps)))
    }
}

fn free_clearance(separation: Option<Separation>) -> Clearance<Solid> {
    Clearance::Free(SolidFree { separation, steps: SolidSteps::default() })
}

/// Solids of a query with their hulls, between which answers are transferred.
struct HullTransfer<'h, 'a> {
    solids: &'h Cast<'a, Solid>,
    hulls: &'h Hulls<'a>,
    sides: [TransferSide<'a>; 2],
    noise: f64,
}

/// One of the two solids.
struct TransferSide<'a> {
    surface: Surface<'a>,
    matrix: DMat3,
    /// Inward offset, a length.
    pub amount: f64,
    /// Maximum displacement of a vertex by the offset.
    max_displacement: f64,
    /// Unit vector of the motion of this body relative to the other one, in the body's frame.
    forward: DVec3,
}

impl<'h, 'a> HullTransfer<'h, 'a> {
    /// Relates solids to their hulls. `None` if the tolerance is above the default of rotated bodies or leaves
    /// nothing of a body, or if a dent is more than rounding. With larger tolerances or dents, the facets at a
    /// point may lie below it, or overhang the facets that contain it.
    fn new(solids: &'h Cast<'a, Solid>, hulls: &'h Hulls<'a>) -> Option<Self> {
        let setting = &solids.setting;
        let noise = setting.noise().point_error();
        let is_axis_aligned =
            permutes_axes(setting.moving_matrix) && permutes_axes(setting.fixed_matrix);
        let tolerance =
            solids.options.tolerance.unwrap_or(default_tolerance(is_axis_aligned, noise));
        let is_dented = |surface: &Surface| surface.body.dent > LATERAL_NOISES * noise;
        if tolerance > default_tolerance(false, noise)
            || hulls.bodies.iter().any(is_dented)
            || check_thickness(solids, tolerance).is_err()
        {
            return None;
        }
        let amount = 0.5 * tolerance;
        let side = |surface: Surface<'a>, matrix: DMat3, forward: DVec3| {
            let max_displacement = surface.solid.max_offset_displacement(amount);
            TransferSide {
                surface,
                matrix,
                amount,
                max_displacement,
                forward: matrix.transpose() * forward,
            }
        };
        let [p, q] = hulls.bodies;
        let sides = [
            side(p, setting.moving_matrix, setting.unit),
            side(q, setting.fixed_matrix, -setting.unit),
        ];
        Some(Self { solids, hulls, sides, noise })
    }

    /// Returns the sum of the lengths by which the solids may extend beyond their hulls.
    fn missing_extent(&self) -> f64 {
        let missing = |surface: &Surface| {
            if surface.body.has_all_vertices { 0.0 } else { surface.body.hull.hull_error() }
        };
        missing(&self.sides[0].surface) + missing(&self.sides[1].surface)
    }

    /// Bounds the distance of a point of the hulls' `M` from the `M` of the solids, offset (`shrunk`) or nominal.
    /// Infinity if no ball inside a hull is larger than its dent and displacement.
    fn difference_error(&self, shrunk: bool) -> f64 {
        let side_error = |side: &TransferSide| {
            let Surface { solid, body } = side.surface;
            let depth = body.dent + if shrunk { side.max_displacement } else { 0.0 };
            let share = depth / body.inner_radius;
            // A plate may have no ball inside.
            if (0.0..1.0).contains(&share) { 2.0 * solid.reach() * share } else { f64::INFINITY }
        };
        (1.0 + POSE_SKEW) * (side_error(&self.sides[0]) + side_error(&self.sides[1]))
    }

    /// Returns a free clearance with the hulls' separating plane, whose margin is reduced by the errors of the
    /// hulls and rounding; `None` if no margin remains.
    fn separated_clearance(&self, plane: &Separation) -> Option<Clearance<Solid>> {
        let normal = plane.normal;
        let closing = separate::closing_bound(&self.solids.setting, normal, self.noise);
        let margin = plane.margin - self.missing_extent() - HEIGHT_NOISES * self.noise - closing;
        let separation =
            self.solids.options.before.is_none().then_some(Separation { normal, margin });
        (margin > 0.0).then(|| free_clearance(separation))
    }

    /// Returns the clearance by a contact of the hulls; free if the contact is beyond the end of the query. `None`
    /// if the certificate does not prove the bounds or no facets are found.
    ///
    /// No gap of the offset bodies is less than `least` (a length). `known` has the blocking facets and the work to
    /// find them.
    fn blocked_clearance(
        &self,
        contact: &Contact,
        least: f64,
        known: Option<([u32; 2], SolidSteps)>,
    ) -> Option<Clearance<Solid>> {
        let (setting, proof) = (&self.solids.setting, &contact.certificate);
        let (normal, length) = (contact.normal, setting.length);
        let pierced = PiercedTriangle::new(&self.hulls.cast, contact, self.noise)?;
        let lower = proof.lower - self.missing_extent() / (pierced.slope * length);
        let touching = proof.lower <= 0.0;
        if !touching && lower <= 0.0 {
            return None;
        }
        // The factor covers the rounding of the division.
        let least = lower.max(least / length * (1.0 - 2.0 * f64::EPSILON));
        let end = self.solids.options.before.unwrap_or(f64::INFINITY);
        // With this slack a search, which rounds differently, finds nothing before the end either.
        if least >= end + SLACK * self.noise / length {
            return Some(free_clearance(None));
        }
        let upper =
            |shrunk| Some(proof.upper + pierced.max_rise(self.difference_error(shrunk))? / length);
        let shrunk = self.sides[0].amount != 0.0;
        let back = if shrunk {
            normal.dot(self.relative_displacement(contact)) / (pierced.slope * length)
        } else {
            0.0
        };
        let (value, most) = (contact.translation + back, upper(shrunk)?);
        if most < least || most >= end {
            return None;
        }
        let offset_distance =
            Bounded { value: value.clamp(least, most), lower: least, upper: most };
        let translation = if shrunk {
            Bounded { value: contact.translation, lower, upper: upper(false)? }
        } else {
            offset_distance
        };
        let surface_points = self.contact_points(contact);
        let (triangles, steps) = match known {
            Some(known) => known,
            None => (
                self.contact_facets(contact, &surface_points, pierced.sine)?,
                SolidSteps::default(),
            ),
        };
        let points = contact.witness_points(&self.hulls.cast);
        let contact = SolidContact {
            translation,
            offset_distance,
            normal,
            point_on_moving: points.on_moving,
            point_on_fixed: points.on_fixed,
            moving_feature: self.sides[0].contact_feature(
                triangles[0],
                &surface_points[0],
                self.noise,
            ),
            fixed_feature: self.sides[1].contact_feature(
                triangles[1],
                &surface_points[1],
                self.noise,
            ),
            triangles,
            steps,
        };
        Some(Clearance::Blocked { distance: translation.lower.max(0.0), contact })
    }

    /// Computes the displacement of the contact point on the fixed body by the offset, less that on the moving
    /// body, in the axes of the world.
    fn relative_displacement(&self, contact: &Contact) -> DVec3 {
        let proof = &contact.certificate;
        let displacement = |k: usize| {
            let TransferSide { surface: Surface { solid, body }, matrix, amount, .. } =
                self.sides[k];
            let field = &solid.offset_field().displacements;
            let terms = proof.pairs.iter().zip(proof.weights);
            let mean =
                terms.map(|(pair, w)| field[body.solid_vertex(pair.indices()[k]) as usize] * w);
            matrix * (mean.sum::<DVec3>() * amount)
        };
        displacement(1) - displacement(0)
    }

    /// Returns the contact point on each body, with its normal.
    fn contact_points(&self, contact: &Contact) -> [SurfacePoint; 2] {
        let Certificate { pairs, weights, .. } = &contact.certificate;
        let points = self.hulls.cast.setting.weighted_points(pairs, weights);
        [(0, contact.normal), (1, -contact.normal)].map(|(k, outward)| SurfacePoint {
            position: points[k],
            outward: self.sides[k].matrix.transpose() * outward,
        })
    }

    /// Finds a facet of each body at the contact point. The sine of the angle between crossing edges is at least
    /// `sine`. `None` if a facet does not clearly contain its point.
    fn contact_facets(
        &self,
        contact: &Contact,
        points: &[SurfacePoint; 2],
        sine: f64,
    ) -> Option<[u32; 2]> {
        let facet = |k: usize| {
            let place = HullFeature::from_pairs(&contact.certificate.pairs, k);
            self.sides[k].contact_facet(place, &points[k], [self.noise, sine])
        };
        Some([facet(0)?, facet(1)?])
    }
}

/// Triangle of the hulls' `M` that the line pierces.
struct PiercedTriangle {
    /// Lower bound of the altitudes of its projection across the direction.
    altitude: f64,
    /// Ratio of the altitude and the longest side.
    sine: f64,
    /// Least weight of a corner in the pierced point.
    least_weight: f64,
    /// Height of the highest corner above the pierced point, along the normal of the contact.
    rise: f64,
    /// Component of the unit normal along the unit direction.
    slope: f64,
    noise: f64,
}

impl PiercedTriangle {
    /// Computes the triangle of a contact; `None` if it is narrow or the contact plane is steep.
    fn new(cast: &Cast, contact: &Contact, noise: f64) -> Option<Self> {
        let (proof, unit) = (&contact.certificate, cast.setting.unit);
        let [a, b, c] = proof.pairs.each_ref().map(|pair| cast.setting.difference_point(*pair));
        let [u, v] = [b - a, c - a];
        let sides = [u, v, c - b].map(DVec3::length_squared);
        let longest = sides.into_iter().fold(0.0, f64::max).sqrt();
        let altitude = u.cross(v).dot(unit).abs() / longest;
        let least_weight = proof.weights.into_iter().fold(1.0, f64::min);
        let rises = [0.0, contact.normal.dot(u), contact.normal.dot(v)];
        let mean = proof.weights[1] * rises[1] + proof.weights[2] * rises[2];
        let rise = rises.into_iter().fold(0.0, f64::max) - mean;
        let slope = contact.normal.dot(unit);
        let clear = altitude > MIN_ALTITUDE_NOISES * noise && slope >= MIN_SLOPE;
        let sine = altitude / longest;
        clear.then_some(Self { altitude, sine, least_weight, rise, slope, noise })
    }

    /// Bounds how much higher the line may pierce the triangle if each corner moves by at most `shift`; `None` if
    /// it may miss the triangle. All are lengths.
    fn max_rise(&self, shift: f64) -> Option<f64> {
        let room = self.altitude - 2.0 * shift;
        let clear = 2.0 * shift / room + LATERAL_NOISES * self.noise / self.altitude;
        let pierces = room > 0.5 * self.altitude && self.least_weight > clear;
        pierces.then_some((shift + self.rise + 2.0 * self.noise) / self.slope)
    }
}

/// Feature of a hull at a contact, by its vertices.
#[derive(Clone, Copy)]
enum HullFeature {
    Vertex(u32),
    Edge([u32; 2]),
    Face([u32; 3]),
}

impl HullFeature {
    /// Returns the feature of the moving (`k = 0`) or the fixed body in the vertex pairs of a certificate.
    fn from_pairs(pairs: &[VertexPair; 3], k: usize) -> Self {
        let [a, b, c] = pairs.each_ref().map(|pair| pair.indices()[k]);
        match (a == b, b == c, a == c) {
            (true, true, _) => Self::Vertex(a),
            (true, false, _) | (_, false, true) => Self::Edge([b, c]),
            (false, true, _) => Self::Edge([a, b]),
            (false, false, false) => Self::Face([a, b, c]),
        }
    }
}

impl TransferSide<'_> {
    /// Names the feature of the solid at a point of a triangle, by the numbers of the input.
    fn contact_feature(&self, triangle: u32, point: &SurfacePoint, noise: f64) -> Feature {
        feature_at(self.surface.solid, triangle, (point.position, point.outward), noise)
    }

    /// Finds a facet that faces the other body, nominal and offset, and clearly contains a point, or has it on an
    /// edge or a vertex. `None` if there is no such facet.
    fn contact_facet(
        &self,
        place: HullFeature,
        point: &SurfacePoint,
        [noise, sine]: [f64; 2],
    ) -> Option<u32> {
        let if_ahead = |t: u32| self.faces_ahead(t, noise).then_some(t);
        match place {
            HullFeature::Vertex(v) => {
                self.surface.triangles_around(v).find_map(|(t, _)| if_ahead(t))
            }
            HullFeature::Edge([a, b]) => {
                let beside = self
                    .surface
                    .triangles_at_edge(a, b)
                    .or_else(|| self.surface.triangles_at_edge(b, a));
                let beside =
                    beside.or_else(|| self.facets_at_edge_point([a, b], point, noise, sine))?;
                beside.into_iter().find_map(if_ahead)
            }
            HullFeature::Face([corner, ..]) => {
                if_ahead(self.facet_inside_face(corner, point, noise)?)
            }
        }
    }

    /// Checks whether a facet faces along `forward` by more than the offset and the pose can turn it.
    fn faces_ahead(&self, triangle: u32, noise: f64) -> bool {
        let [a, b, c] = self.surface.triangle_corners(triangle);
        let [u, v] = [b - a, c - a];
        let (area, sides) = (u.cross(v), (u.abs() + v.abs()).element_sum());
        let least =
            POSE_SKEW * area.abs().element_sum() + 8.0 * (self.max_displacement + noise) * sides;
        area.dot(self.forward) > least
    }

    /// Finds the facets on both sides of that part of the hull edge `ends` which clearly contains a point. The
    /// point must be as far from the ends of the part as crossing edges may be displaced along it.
    ///
    /// Returns the same facet twice if the point is clearly inside it, for example where the hull edge only crosses
    /// a face. `None` if the facet's side crosses the edge. Such a side may run along the other body's edge, and
    /// facets next to it then share nothing but the edge.
    fn facets_at_edge_point(
        &self,
        ends: [u32; 2],
        point: &SurfacePoint,
        noise: f64,
        sine: f64,
    ) -> Option<[u32; 2]> {
        let near = self.edge_margin(noise);
        let triangle = self.surface.facet_at(ends[0], point, near)?;
        let [beside, clear] =
            [near, near / sine].map(|slack| self.surface.distances_inside(triangle, point, slack));
        let Some(k) = beside.iter().position(|&side| side <= 0.0) else {
            return Some([triangle; 2]);
        };
        let [from, to] = ends.map(|v| self.surface.body.hull.vertices()[v as usize]);
        let along = (to - from).try_normalize()?;
        let corners = self.surface.triangle_corners(triangle);
        let is_on_line = |at: DVec3| along.cross(at - from).length() <= noise;
        let runs_along = is_on_line(corners[k]) && is_on_line(corners[(k + 1) % 3]);
        let on = runs_along && clear[(k + 1) % 3] > 0.0 && clear[(k + 2) % 3] > 0.0;
        on.then(|| [triangle, self.surface.solid.neighbours()[triangle as usize][k]])
    }

    /// Returns the distance from a facet's side up to which the position of a point relative to the side is
    /// uncertain.
    fn edge_margin(&self, noise: f64) -> f64 {
        2.0 * self.max_displacement + LATERAL_NOISES * noise
    }

    /// Finds the facet that contains a point, farther from its sides than their position is uncertain
    /// ([`Self::edge_margin`]). The search starts at the hull vertex `corner`. `None` if it finds no such facet.
    fn facet_inside_face(&self, corner: u32, point: &SurfacePoint, noise: f64) -> Option<u32> {
        let near = self.edge_margin(noise);
        let triangle = self.surface.facet_at(corner, point, near)?;
        let inside = self.surface.distances_inside(triangle, point, near);
        inside.iter().all(|&side| side > 0.0).then_some(triangle)
    }
}
