//! What the certificate of an answer proves, and whether that is what it says.
//!
//! Notation as in [`scene`](crate::oracle::scene). Every number of a certificate is taken as exact.
//!
//! - *Lower bound.* `L = (min_Q n.q - max_P n.p) / n.d` over all vertices; the one stated must not be
//!   larger, exactly.
//! - *Upper bound.* If the line passes through the triangle of the three differences `q - p`,
//!   exactly, it does so at `U`, and the bodies provably meet. Then `L <= coll <= U`, `U - L`
//!   is the gap that is proven, and the upper bound stated must not be less than `U`, exactly. Rounding can make the line miss a triangle that ends at it (a
//!   contact at a vertex, an edge or the rim), or cross one without area somewhere else; the answer
//!   is then *near*: its witness points miss each other by a residual, which must be rounding
//!   error, and outcome and value have to be decided by the oracle.
//! - *Separation.* `n' = n (d.d) - d (n.d)` is exactly orthogonal to `d`; `min_Q n'.q > max_P n'.p`
//!   proves that the bodies never meet. Nothing depends on how well `n` itself is orthogonal.
//! - *Grazing.* `n'` from the separating direction bounds the overlap from above, the residual of
//!   the witness points from below: two bodies whose witness points come within `r` overlap by at
//!   least `-r`.

use colltrans::{
    Certificate, Contact, Feature, Grazing, Separated, VertexId, VertexPair, WitnessPoints,
};
use glam::DVec3;

use super::{Judge, Objection, Proof, TWO_ROUNDINGS};
use crate::oracle::exact::{Dyadic, Ratio, Vector};

/// How many units of rounding error a margin may be rounded down by: one for its own, two for what
/// either body may reach beyond its support point.
const MARGIN_ROUNDINGS: f64 = 5.0;

/// How many units of rounding error the witness points of a contact may miss each other by: each of
/// the two is allowed one.
const RESIDUAL_ROUNDINGS: f64 = 2.0;

/// The same for a grazing contact, whose bodies the library widens by up to 33 units along either
/// lateral axis.
const GRAZING_RESIDUAL_ROUNDINGS: f64 = 48.0;

/// Relative error that computing a unit vector may leave.
const UNIT_ERROR: f64 = 16.0 * f64::EPSILON;

impl Judge<'_> {
    pub(super) fn check_contact(&self, contact: &Contact) -> Result<Proof, Objection> {
        self.check_contact_within(contact, RESIDUAL_ROUNDINGS)
    }

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
            "lower bound {lower:e} is {:e} below what the plane proves (tolerated: {tolerance:e})",
            off.to_f64()
        );

        let residual = self.residual(certificate, translation)? / self.scene.noise;
        require!(
            residual <= roundings,
            "the witness points miss each other by {residual} roundings"
        );
        // An infinite one claims nothing: what is widened meets earlier than what is not.
        let claimed_upper = Ratio::from_f64(if upper.is_finite() { upper } else { translation });
        let crossing = self.crossing(&certificate.pairs);
        if let Some(crossing) = &crossing {
            require!(*crossing >= exact_lower, "the bounds contradict each other");
        }
        // A triangle without area to speak of crosses the line anywhere: it proves nothing.
        let crossing = crossing.filter(|u| u.minus(&claimed_upper).is_within(tolerance));
        // Nor does one that stands steeply on the edge where the line passes: the witness points, which
        // miss each other by rounding, are lower there than the line's crossing of it. The truth decides.
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

    /// `min_Q n.q - max_P n.p`.
    fn distance_along(&self, normal: &Vector) -> Dyadic {
        let nearest = self.scene.fixed.iter().map(|q| normal.dot(q)).min();
        let farthest = self.scene.moving.iter().map(|p| normal.dot(p)).max();
        &nearest.expect("a body has a point") - &farthest.expect("a body has a point")
    }

    /// The three differences `q - p` of a certificate.
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

    /// Where the line passes through the triangle of the three differences, if it does so exactly.
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

    /// `|sum w_i (q_i - p_i) - t d|`, in world units.
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

    /// The length of a miss; sideways only where nothing is claimed from above: the witness points of
    /// widened bodies come together earlier.
    fn across(&self, miss: &Vector, certificate: &Certificate) -> f64 {
        if certificate.upper.is_finite() {
            return miss.to_f64().length();
        }
        let d = &self.scene.direction;
        let square = d.dot(d);
        let sideways = miss.times(&square).minus(&d.times(&miss.dot(d)));
        Ratio::new(sideways.dot(&sideways), &square * &square).sqrt_to_f64()
    }

    /// The witness points come together after the translation, and lie in the contact plane of
    /// their bodies.
    fn check_points(&self, contact: &Contact, roundings: f64) -> Result<(), Objection> {
        let Contact { translation, normal, .. } = *contact;
        let WitnessPoints { on_moving, on_fixed } = contact.points(&self.cast);
        // In the world, at whatever distance from its origin.
        let away = on_moving.length().max(on_fixed.length());
        let tolerance = (roundings + 1.0) * self.scene.noise + 8.0 * f64::EPSILON * away;
        let [p, q] = [on_moving, on_fixed].map(Vector::new);
        let moved = p.plus(&self.scene.direction.times(&Dyadic::new(translation)));
        let miss = self.across(&q.minus(&moved), &contact.certificate);
        require!(miss <= tolerance, "the witness points miss each other by {miss:e}");
        // The points are those of the upper bound, the plane is that of the lower one.
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

    /// The vertices of a contact feature lie in the contact plane.
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
        // A body's own faces are flat up to what its hull states.
        let tolerance = (TWO_ROUNDINGS + 1.0) * self.scene.noise + 2.0 * body.hull_error();
        for VertexId(vertex) in feature.own_vertices(body) {
            let depth = (&top - &normal.dot(&points[vertex as usize])).to_f64();
            require!(
                depth <= tolerance,
                "vertex {vertex} of {feature:?} is {depth:e} below the contact plane"
            );
        }
        Ok(())
    }

    /// A unit vector orthogonal to `d`, made exactly orthogonal: `(min_Q n'.q - max_P n'.p) /
    /// |n'|`, whose sign is exact.
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
        let proof = self.check_contact_within(&grazing.contact, GRAZING_RESIDUAL_ROUNDINGS)?;
        // The residual has just bounded the overlap from below.
        Ok(Proof { exact: true, ..proof })
    }
}

fn is_unit(v: DVec3) -> bool {
    (v.length() - 1.0).abs() <= UNIT_ERROR
}
