//! Checks what the certificate of an answer proves.
//!
//! Notation as in [`scene`](crate::oracle::scene). Every number of a certificate is taken as exact.
//!
//! - *Lower bound.* `L = (min_Q n.q - max_P n.p) / n.d` over all vertices. The stated bound must not exceed
//!   `L`.
//! - *Upper bound.* If the line intersects the triangle of the three differences `q - p`, exactly, at `U`, the
//!   bodies provably meet. Then `L <= coll <= U`, `U - L` is the proven gap, and the stated bound must not be
//!   less than `U`. Rounding may make the line miss a triangle that ends at it (a contact at a vertex, an edge
//!   or the boundary of the shadow), or intersect a triangle without area at a different place. Then the answer
//!   is *near*: its witness points differ by a residual, which must be a rounding error, and the oracle decides
//!   outcome and value.
//! - *Separation.* `n' = n (d.d) - d (n.d)` is exactly orthogonal to `d`, and `min_Q n'.q > max_P n'.p` proves
//!   that the bodies never meet. The orthogonality of `n` itself is not used.
//! - *Grazing.* `n'` of the separating direction bounds the overlap from above, and the residual of the witness
//!   points from below: two bodies whose witness points differ by `r` overlap by at least `-r`.

use colltrans::{
    Certificate, Contact, Feature, Grazing, Separated, VertexId, VertexPair, WitnessPoints,
};
use glam::DVec3;

use super::{Judge, Objection, Proof, TWO_ROUNDINGS};
use crate::oracle::exact::{Dyadic, Ratio, Vector};

/// Maximum rounding of a margin in noises: one for itself, two for the excess of each body beyond its support
/// point.
const MARGIN_ROUNDINGS: f64 = 5.0;

/// Maximum residual of the witness points of a contact in noises: one for each point.
const RESIDUAL_ROUNDINGS: f64 = 2.0;

/// Maximum residual of the witness points of a grazing contact in noises. The library widens such bodies by up
/// to 49 noises and their hull errors along each lateral axis.
const GRAZING_RESIDUAL_ROUNDINGS: f64 = 69.0;

/// Upper bound on the length of the library's widening in multiples of its longer half-side.
const WIDENING_CORNER: f64 = 1.3;

/// Maximum relative error of the length of a unit vector.
const UNIT_ERROR: f64 = 16.0 * f64::EPSILON;

impl Judge<'_> {
    /// Checks a contact with its certificate, points and features.
    pub(super) fn check_contact(&self, contact: &Contact) -> Result<Proof, Objection> {
        self.check_contact_within(contact, RESIDUAL_ROUNDINGS)
    }

    /// Checks a contact whose witness points differ by at most `roundings` noises.
    fn check_contact_within(&self, contact: &Contact, roundings: f64) -> Result<Proof, Objection> {
        let certificate = &contact.certificate;
        require!(contact.normal == certificate.normal, "two different normals");
        require!(
            (certificate.lower..=certificate.upper).contains(&contact.translation),
            "translation {:e} outside its bounds",
            contact.translation
        );
        let proof = self.check_certificate(certificate, contact.translation, roundings)?;
        self.check_points(contact, roundings)?;
        let features = contact.features(&self.cast);
        self.check_feature(contact, features.moving, true)?;
        self.check_feature(contact, features.fixed, false)?;
        Ok(proof)
    }

    /// Checks the certificate of a contact.
    fn check_certificate(
        &self,
        certificate: &Certificate,
        translation: f64,
        roundings: f64,
    ) -> Result<Proof, Objection> {
        let Certificate { normal, lower, upper, rounding: tolerance, .. } = *certificate;
        require!(is_unit(normal), "the normal {normal} is not a unit vector");
        let normal = Vector::new(normal);
        let along = normal.dot(&self.scene.direction);
        require!(along.is_positive(), "the normal does not point along the direction");
        let exact_lower = Ratio::new(self.distance_along(&normal), along);
        let off = exact_lower.minus(&Ratio::from_f64(lower));
        require!(
            off.is_within(tolerance) && exact_lower >= Ratio::from_f64(lower),
            "lower bound {lower:e} is {:e} below the value that the plane proves (tolerated: {tolerance:e})",
            off.to_f64()
        );

        let residual = self.residual(certificate, translation)? / self.scene.noise;
        require!(
            residual <= roundings,
            "the witness points miss each other by {residual} roundings"
        );
        // An infinite upper bound claims nothing, because widened bodies meet earlier than the nominal ones.
        let claimed_upper = Ratio::from_f64(if upper.is_finite() { upper } else { translation });
        let crossing = self.crossing(&certificate.pairs);
        if let Some(crossing) = &crossing {
            require!(*crossing >= exact_lower, "the bounds contradict each other");
        }
        // A triangle almost without area may intersect the line anywhere, and proves nothing.
        let crossing = crossing.filter(|u| u.minus(&claimed_upper).is_within(tolerance));
        // A triangle that is steep where the line passes its edge proves nothing either: its witness points,
        // which differ by rounding, are lower than the intersection with the line. The oracle decides.
        let is_later =
            upper < f64::INFINITY && crossing.as_ref().is_some_and(|u| *u > claimed_upper);
        if is_later {
            let truth = &self.truth().translation;
            require!(
                truth.as_ref().is_some_and(|truth| *truth <= claimed_upper),
                "upper bound {upper:e} is less than what the pairs prove, and less than the truth"
            );
        }
        let crossing = crossing.filter(|_| !is_later);
        let exact = crossing.is_some();
        let gap = crossing.unwrap_or(claimed_upper).minus(&exact_lower);
        require!(
            gap.is_within(tolerance),
            "the proven gap is {:e} (tolerated: {tolerance:e})",
            gap.to_f64()
        );
        let gap = gap.to_f64().abs();
        let unit = self.scene.direction.to_f64().length();
        Ok(Proof {
            exact,
            gap_over_size: gap * unit / self.scene.size,
            gap_over_tolerance: gap / tolerance,
            residual_in_noises: residual,
        })
    }

    /// Returns `min_Q n.q - max_P n.p`.
    fn distance_along(&self, normal: &Vector) -> Dyadic {
        let nearest = self.scene.fixed.iter().map(|q| normal.dot(q)).min();
        let farthest = self.scene.moving.iter().map(|p| normal.dot(p)).max();
        &nearest.expect("a body has a point") - &farthest.expect("a body has a point")
    }

    /// Returns the three differences `q - p` of a certificate.
    fn differences(&self, pairs: &[VertexPair; 3]) -> Result<[Vector; 3], Objection> {
        for pair in pairs {
            require!(
                pair.moving.index() < self.scene.moving.len()
                    && pair.fixed.index() < self.scene.fixed.len(),
                "{pair:?} names a vertex that does not exist"
            );
        }
        Ok(pairs.map(|pair| {
            self.scene.fixed[pair.fixed.index()].minus(&self.scene.moving[pair.moving.index()])
        }))
    }

    /// Returns the `t` at which the line intersects the triangle of the three differences, exactly; `None` if
    /// it does not.
    fn crossing(&self, pairs: &[VertexPair; 3]) -> Option<Ratio> {
        let corners = self.differences(pairs).ok()?;
        let [a, b, c] = corners.each_ref().map(|m| self.scene.shadow(m));
        let cross = |u: &[Dyadic; 2], v: &[Dyadic; 2]| &(&u[0] * &v[1]) - &(&u[1] * &v[0]);
        let mut weights = [cross(&b, &c), cross(&c, &a), cross(&a, &b)];
        let mut sum = &(&weights[0] + &weights[1]) + &weights[2];
        if sum.is_negative() {
            weights = weights.map(|w| -w);
            sum = -sum;
        }
        if sum.is_zero() || weights.iter().any(Dyadic::is_negative) {
            return None;
        }
        let height = corners
            .iter()
            .zip(&weights)
            .map(|(m, w)| &self.scene.height(m) * w)
            .fold(Dyadic::ZERO, |s, x| &s + &x);
        Some(Ratio::new(height, &sum * &self.scene.height_unit()))
    }

    /// Returns `|sum w_i (q_i - p_i) - t d|` in world units.
    fn residual(&self, certificate: &Certificate, translation: f64) -> Result<f64, Objection> {
        let Certificate { pairs, weights, .. } = certificate;
        let sum: f64 = weights.iter().sum();
        require!(
            weights.iter().all(|w| *w >= 0.0) && (sum - 1.0).abs() <= UNIT_ERROR,
            "{weights:?} are no barycentric coordinates"
        );
        let miss = self
            .differences(pairs)?
            .iter()
            .zip(weights)
            .map(|(m, w)| m.times(&Dyadic::new(*w)))
            .fold(self.scene.direction.times(&Dyadic::new(-translation)), |sum, m| sum.plus(&m));
        Ok(self.across(&miss, certificate))
    }

    /// Returns the length of a residual. Without an upper bound only the lateral part counts, because the
    /// witness points of widened bodies meet earlier.
    fn across(&self, miss: &Vector, certificate: &Certificate) -> f64 {
        if certificate.upper.is_finite() {
            return miss.to_f64().length();
        }
        let d = &self.scene.direction;
        let square = d.dot(d);
        let sideways = miss.times(&square).minus(&d.times(&miss.dot(d)));
        Ratio::new(sideways.dot(&sideways), &square * &square).sqrt_to_f64()
    }

    /// Checks that the witness points coincide after the translation, and are in the contact plane of their
    /// bodies.
    fn check_points(&self, contact: &Contact, roundings: f64) -> Result<(), Objection> {
        let Contact { translation, normal, .. } = *contact;
        let WitnessPoints { on_moving, on_fixed } = contact.witness_points(&self.cast);
        // In world coordinates, whose rounding error depends on the distance from the origin.
        let away = on_moving.length().max(on_fixed.length());
        let tolerance = (roundings + 1.0) * self.scene.noise + 8.0 * f64::EPSILON * away;
        let [p, q] = [on_moving, on_fixed].map(Vector::new);
        let moved = p.plus(&self.scene.direction.times(&Dyadic::new(translation)));
        let miss = self.across(&q.minus(&moved), &contact.certificate);
        require!(miss <= tolerance, "the witness points miss each other by {miss:e}");
        // The points belong to the upper bound, the plane to the lower one.
        let gap = contact.certificate.gap().min(contact.certificate.rounding);
        let off_plane = tolerance + gap * normal.dot(self.scene.direction.to_f64());
        let normal = Vector::new(normal);
        let below = |points: &[Vector], sign: f64, at: &Vector| {
            let n = normal.times(&Dyadic::new(sign));
            let top = points.iter().map(|v| n.dot(v)).max().expect("a body has a point");
            (&top - &n.dot(at)).to_f64()
        };
        for (body, points, sign, at) in
            [("moving", &self.scene.moving, 1.0, &p), ("fixed", &self.scene.fixed, -1.0, &q)]
        {
            let depth = below(points, sign, at).abs();
            require!(
                depth <= off_plane,
                "the witness point on the {body} body is {depth:e} off its contact plane"
            );
        }
        Ok(())
    }

    /// Checks that the vertices of a contact feature are in the contact plane.
    fn check_feature(
        &self,
        contact: &Contact,
        feature: Feature,
        moving: bool,
    ) -> Result<(), Objection> {
        let (body, points, sign) = if moving {
            (self.cast.moving(), &self.scene.moving, 1.0)
        } else {
            (self.cast.fixed(), &self.scene.fixed, -1.0)
        };
        let normal = Vector::new(contact.normal * sign);
        let top = points.iter().map(|v| normal.dot(v)).max().expect("a body has a point");
        // The faces of a body are flat up to its hull error.
        let tolerance = (TWO_ROUNDINGS + 1.0) * self.scene.noise + 2.0 * body.hull_error();
        for VertexId(vertex) in feature.vertex_positions(body) {
            let depth = (&top - &normal.dot(&points[vertex as usize])).to_f64();
            require!(
                depth <= tolerance,
                "vertex {vertex} of {feature:?} is {depth:e} below the contact plane"
            );
        }
        Ok(())
    }

    /// Returns `(min_Q n'.q - max_P n'.p) / |n'|` for the unit vector `n'` that results from making `normal`
    /// exactly orthogonal to `d`. The sign is exact.
    fn margin(&self, normal: DVec3) -> Result<f64, Objection> {
        require!(is_unit(normal), "the normal {normal} is not a unit vector");
        let (n, d) = (Vector::new(normal), &self.scene.direction);
        let skew = n.dot(d).to_f64() / d.to_f64().length();
        require!(
            skew.abs() <= UNIT_ERROR,
            "the normal {normal} is not orthogonal to the direction by {skew:e}"
        );
        let orthogonal = n.times(&d.dot(d)).minus(&d.times(&n.dot(d)));
        let margin = self.distance_along(&orthogonal);
        let square = Ratio::new(&margin * &margin, orthogonal.dot(&orthogonal));
        let length = square.to_f64().sqrt();
        Ok(if margin.is_negative() { -length } else { length })
    }

    /// Checks a separation.
    pub(super) fn check_separated(&self, separated: &Separated) -> Result<Proof, Objection> {
        let claimed = separated.certificate.margin;
        let margin = self.margin(separated.certificate.normal)?;
        require!(margin > 0.0, "the plane does not separate the bodies: margin {margin:e}");
        require!(
            claimed > 0.0
                && claimed <= margin
                && margin - claimed <= MARGIN_ROUNDINGS * self.scene.noise + self.hull_errors(),
            "margin {claimed:e} claimed, {margin:e} proven"
        );
        Ok(Proof { exact: true, ..Proof::default() })
    }

    /// Checks a grazing contact.
    pub(super) fn check_grazing(&self, grazing: &Grazing) -> Result<Proof, Objection> {
        let claimed = grazing.overlap;
        let overlap = -self.margin(grazing.separating_direction)?;
        let noise = self.scene.noise;
        require!(
            (overlap - claimed).abs() <= TWO_ROUNDINGS * noise,
            "overlap {claimed:e} claimed, {overlap:e} along the separating direction"
        );
        let tolerated = self.border();
        require!(claimed <= tolerated, "overlap {claimed:e} tolerated as {tolerated:e}");
        let roundings = GRAZING_RESIDUAL_ROUNDINGS + WIDENING_CORNER * self.hull_errors() / noise;
        let proof = self.check_contact_within(&grazing.contact, roundings)?;
        // The residual bounds the overlap from below.
        Ok(Proof { exact: true, ..proof })
    }
}

/// Checks whether the length is 1 up to rounding.
fn is_unit(v: DVec3) -> bool {
    (v.length() - 1.0).abs() <= UNIT_ERROR
}
