//! Checks an answer of the library in exact arithmetic: what its certificate proves, and whether
//! that is what it says.
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

use std::cell::OnceCell;
use std::cmp::Ordering;
use std::fmt;

use colltrans::{
    Cast, Certificate, Contact, Feature, Grazing, Outcome, Separated, VertexPair, WitnessPoints,
};
use glam::DVec3;

use crate::oracle::exact::{Dyadic, Ratio, Vector};
use crate::oracle::scene::Scene;
use crate::oracle::shadow::{SignedDistance, sideways_overlap};
use crate::oracle::simplex::collision_translation;

/// How many units of rounding error ([`Scene::noise`]) two different computations of the same
/// sideways distance may differ by: each is allowed one.
const TWO_ROUNDINGS: f64 = 2.0;

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

/// What an answer was found to prove.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Proof {
    /// Whether outcome and value are proven by the certificate alone, without a rounding error.
    pub exact: bool,
    /// `U - L`, in world units, divided by the size of the configuration.
    pub gap_over_size: f64,
    /// `U - L` divided by the tolerance that the certificate states.
    pub gap_over_tolerance: f64,
    /// How far the witness points miss each other, in units of rounding error.
    pub residual_in_noises: f64,
}

impl Proof {
    /// The larger numbers of both.
    #[must_use]
    pub fn worse(&self, other: &Self) -> Self {
        Self {
            exact: self.exact && other.exact,
            gap_over_size: self.gap_over_size.max(other.gap_over_size),
            gap_over_tolerance: self.gap_over_tolerance.max(other.gap_over_tolerance),
            residual_in_noises: self.residual_in_noises.max(other.residual_in_noises),
        }
    }
}

/// Why an answer is wrong.
#[derive(Debug, Clone, PartialEq)]
pub struct Objection(pub String);

impl fmt::Display for Objection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Objection {}

/// `Err` with a formatted [`Objection`] unless the condition holds; a comparison with NaN does not.
macro_rules! require {
    ($condition:expr, $($text:tt)+) => {
        let holds: bool = $condition;
        if !holds {
            return Err(Objection(format!($($text)+)));
        }
    };
}

/// The two bodies and what is needed to judge an answer about them.
#[derive(Debug)]
pub struct Judge<'a> {
    /// The setting in exact coordinates.
    pub scene: Scene,
    /// The query.
    pub cast: Cast<'a>,
    /// The points that the bodies were made of, where these are known and are not the vertices alone.
    input: Option<Scene>,
    truth: OnceCell<Truth>,
    truth_of_input: OnceCell<Truth>,
}

/// What the oracle says of a scene: it takes long, so it is asked once.
#[derive(Debug)]
struct Truth {
    translation: Option<Ratio>,
    overlap: SignedDistance,
}

impl Truth {
    fn of(scene: &Scene) -> Self {
        Self { translation: collision_translation(scene), overlap: sideways_overlap(scene) }
    }
}

impl<'a> Judge<'a> {
    /// Of answers to a query.
    pub fn new(cast: Cast<'a>) -> Self {
        Self {
            scene: Scene::of(&cast),
            cast,
            input: None,
            truth: OnceCell::new(),
            truth_of_input: OnceCell::new(),
        }
    }

    /// Of answers about bodies that were made of these points.
    #[must_use]
    pub fn with_input(mut self, moving: &[DVec3], fixed: &[DVec3]) -> Self {
        let has_dropped =
            moving.len() > self.scene.moving.len() || fixed.len() > self.scene.fixed.len();
        self.input = has_dropped.then(|| {
            let poses = (self.cast.moving_pose(), self.cast.fixed_pose());
            Scene::new((moving, &poses.0), (fixed, &poses.1), self.cast.direction())
        });
        self
    }

    fn truth(&self) -> &Truth {
        self.truth.get_or_init(|| Truth::of(&self.scene))
    }

    /// Re-verifies everything an answer carries.
    ///
    /// # Errors
    /// The first statement of the answer that is not true.
    pub fn check(&self, outcome: &Outcome) -> Result<Proof, Objection> {
        match outcome {
            Outcome::Contact(contact) => self.check_contact(contact, RESIDUAL_ROUNDINGS),
            Outcome::Grazing(grazing) => self.check_grazing(grazing),
            Outcome::Separated(separated) => self.check_separated(separated),
        }
    }

    /// Compares an answer with the linear programme and the exact sideways overlap, of the vertices:
    /// outcome exactly, value within the stated bound; and of the input points: within what the
    /// bodies' hull errors allow ([`input`](crate::oracle::input)).
    ///
    /// # Errors
    /// How they disagree.
    pub fn compare_with_oracle(&self, outcome: &Outcome) -> Result<(), Objection> {
        self.compare_vertices(outcome)?;
        let Some(input) = &self.input else { return Ok(()) };
        self.compare_input(outcome, input).map_err(|e| Objection(format!("of the input: {e}")))
    }

    /// The consequences of [`input`](crate::oracle::input).
    fn compare_input(&self, outcome: &Outcome, input: &Scene) -> Result<(), Objection> {
        let Truth { translation: truth, overlap } =
            self.truth_of_input.get_or_init(|| Truth::of(input));
        let off = self.hull_errors();
        match outcome {
            Outcome::Separated(separated) => {
                let allowed = off - separated.certificate.margin;
                require!(
                    if allowed < 0.0 { truth.is_none() } else { !overlap.exceeds(allowed) },
                    "separated, but the shadows overlap by {:e}",
                    overlap.to_f64()
                );
                Ok(())
            }
            Outcome::Contact(contact) => {
                require!(truth.is_some(), "contact, but they never meet");
                self.encloses(contact, truth.as_ref(), off)
            }
            Outcome::Grazing(grazing) => {
                let allowed = grazing.overlap + off + TWO_ROUNDINGS * self.scene.noise;
                require!(
                    !overlap.exceeds(allowed),
                    "grazing, but the shadows overlap by {:e}",
                    overlap.to_f64()
                );
                self.encloses(&grazing.contact, truth.as_ref(), off)
            }
        }
    }

    /// The bounds enclose the true value of bodies that reach up to `off` beyond these.
    fn encloses(
        &self,
        contact: &Contact,
        truth: Option<&Ratio>,
        off: f64,
    ) -> Result<(), Objection> {
        let Some(truth) = truth else { return Ok(()) };
        let Certificate { normal, lower, upper, .. } = contact.certificate;
        let along = Vector::new(normal).dot(&self.scene.direction);
        let lower = Ratio::from_f64(lower).minus(&Ratio::new(Dyadic::new(off), along));
        require!(
            lower <= *truth && (upper == f64::INFINITY || *truth <= Ratio::from_f64(upper)),
            "the true value {:e} is not between {:e} and {upper:e}",
            truth.to_f64(),
            lower.to_f64()
        );
        Ok(())
    }

    /// The hull errors of both bodies together, in the world: poses may stretch lengths by a
    /// millionth, and normals are unit vectors up to rounding.
    fn hull_errors(&self) -> f64 {
        (self.cast.moving().hull_error() + self.cast.fixed().hull_error()) * (1.0 + 4e-6)
    }

    fn compare_vertices(&self, outcome: &Outcome) -> Result<(), Objection> {
        let Truth { translation: truth, overlap } = self.truth();
        let meets = overlap.sign != Ordering::Less;
        require!(truth.is_some() == meets, "the oracle contradicts itself");
        let slack = TWO_ROUNDINGS * self.scene.noise;
        let border = self.border();
        let is = overlap.to_f64();
        match outcome {
            Outcome::Contact(contact) => {
                let Some(truth) = truth else {
                    return Err(Objection(format!("contact, but the shadows are {is:e} apart")));
                };
                require!(
                    overlap.exceeds(border - slack),
                    "contact, but the shadows overlap by {is:e} only (grazing up to {border:e})"
                );
                self.agrees(contact, truth)
            }
            Outcome::Separated(_) => {
                require!(!meets, "separated, but the shadows overlap by {is:e}");
                Ok(())
            }
            Outcome::Grazing(grazing) => {
                require!(
                    !overlap.exceeds(border + slack) && overlap.exceeds(-slack),
                    "grazing, but the shadows overlap by {is:e} (grazing up to {border:e})"
                );
                match truth {
                    Some(truth) if overlap.exceeds(self.scene.touching + slack) => {
                        self.agrees(&grazing.contact, truth)
                    }
                    Some(truth) => Self::not_later(&grazing.contact, truth),
                    None => Ok(()),
                }
            }
        }
    }

    /// The value agrees with the true one within the tolerance that the certificate states, and the
    /// bounds enclose the true one exactly.
    #[expect(clippy::unused_self, reason = "reads like its siblings")]
    fn agrees(&self, contact: &Contact, truth: &Ratio) -> Result<(), Objection> {
        Self::not_below(contact, truth)?;
        let Certificate { upper, rounding, .. } = contact.certificate;
        require!(
            upper == f64::INFINITY || *truth <= Ratio::from_f64(upper),
            "upper bound {upper:e} is less than the true value {:e}",
            truth.to_f64()
        );
        let error = Ratio::from_f64(contact.translation).minus(truth);
        require!(
            error.is_within(rounding),
            "translation {:e}, true value {:e}, off by {:e} (tolerated: {rounding:e})",
            contact.translation,
            truth.to_f64(),
            error.to_f64()
        );
        Ok(())
    }

    /// The value is the true one, or less, within the tolerance that the certificate states: the
    /// bodies may have been widened sideways, and widened bodies meet earlier, how much earlier is
    /// for the slope of their faces at the rim to say.
    fn not_later(contact: &Contact, truth: &Ratio) -> Result<(), Objection> {
        Self::not_below(contact, truth)?;
        let tolerance = contact.certificate.rounding;
        let late = Ratio::from_f64(contact.translation).minus(truth);
        require!(
            late.is_within(tolerance) || contact.translation < truth.to_f64(),
            "translation {:e} of widened bodies is {:e} later than the true one (tolerated: \
             {tolerance:e})",
            contact.translation,
            late.to_f64()
        );
        Ok(())
    }

    /// The lower bound is one, exactly.
    fn not_below(contact: &Contact, truth: &Ratio) -> Result<(), Objection> {
        let lower = contact.certificate.lower;
        require!(
            Ratio::from_f64(lower) <= *truth,
            "lower bound {lower:e} is more than the true value {:e}",
            truth.to_f64()
        );
        Ok(())
    }

    /// Overlaps up to this are grazing.
    fn border(&self) -> f64 {
        self.cast.options().graze_tolerance.max(self.scene.touching)
    }

    fn check_contact(&self, contact: &Contact, roundings: f64) -> Result<Proof, Objection> {
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
        require!(is_unit(normal), "the normal {normal} is no unit vector");
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
                (pair.moving as usize) < self.scene.moving.len()
                    && (pair.fixed as usize) < self.scene.fixed.len(),
                "{pair:?} names a vertex that does not exist"
            );
        }
        Ok(pairs.map(|pair| {
            self.scene.fixed[pair.fixed as usize].minus(&self.scene.moving[pair.moving as usize])
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
        for vertex in feature.own_vertices(body) {
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
        require!(is_unit(normal), "the normal {normal} is no unit vector");
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

    fn check_separated(&self, separated: &Separated) -> Result<Proof, Objection> {
        let claimed = separated.certificate.margin;
        let margin = self.margin(separated.certificate.normal)?;
        require!(margin > 0.0, "the plane does not separate the bodies: margin {margin:e}");
        require!(
            claimed > 0.0
                && claimed <= margin
                && margin - claimed <= MARGIN_ROUNDINGS * self.scene.noise,
            "margin {claimed:e} claimed, {margin:e} proven"
        );
        Ok(Proof { exact: true, ..Proof::default() })
    }

    fn check_grazing(&self, grazing: &Grazing) -> Result<Proof, Objection> {
        let claimed = grazing.overlap;
        let overlap = -self.margin(grazing.separating_direction)?;
        let noise = self.scene.noise;
        require!(
            (overlap - claimed).abs() <= TWO_ROUNDINGS * noise,
            "overlap {claimed:e} claimed, {overlap:e} along the separating direction"
        );
        let tolerated = self.border();
        require!(claimed <= tolerated, "overlap {claimed:e} tolerated as {tolerated:e}");
        let proof = self.check_contact(&grazing.contact, GRAZING_RESIDUAL_ROUNDINGS)?;
        // The residual has just bounded the overlap from below.
        Ok(Proof { exact: true, ..proof })
    }
}

/// Compares two answers to the same question: outcomes of one kind, and translations within
/// both tolerances.
///
/// # Errors
/// How they differ. At the rim of the shadow both may still be admissible: that is for
/// [`Judge::compare_with_oracle`] to say of each.
pub fn same(first: &Outcome, second: &Outcome) -> Result<(), Objection> {
    let (a, b) = match (first, second) {
        (Outcome::Separated(_), Outcome::Separated(_)) => return Ok(()),
        (Outcome::Contact(a), Outcome::Contact(b)) => (a, b),
        (Outcome::Grazing(a), Outcome::Grazing(b)) => (&a.contact, &b.contact),
        _ => return Err(Objection(format!("{} and {}", kind(first), kind(second)))),
    };
    let (error, tolerance) =
        ((a.translation - b.translation).abs(), a.certificate.rounding + b.certificate.rounding);
    require!(
        error <= tolerance,
        "translations {:e} and {:e}, {error:e} apart (tolerated: {tolerance:e})",
        a.translation,
        b.translation
    );
    Ok(())
}

/// The name of an outcome.
pub fn kind(outcome: &Outcome) -> &'static str {
    match outcome {
        Outcome::Contact(_) => "contact",
        Outcome::Grazing(_) => "grazing",
        Outcome::Separated(_) => "separated",
    }
}

fn is_unit(v: DVec3) -> bool {
    (v.length() - 1.0).abs() <= UNIT_ERROR
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::settings::{Setting, setting};
    use colltrans::Solver;

    /// An answer, and what the judge says about it after a change.
    fn objects(setting: &Setting, outcome: &Outcome) -> bool {
        let bodies = setting.bodies().expect("bodies");
        let judge = setting.judge(&bodies);
        judge.check(outcome).and_then(|_| judge.compare_with_oracle(outcome)).is_err()
    }

    fn answers(kind: fn(&Outcome) -> bool) -> Vec<(Setting, Outcome)> {
        let ask = |seed| {
            let setting = setting(["random", "boxes", "peg"][seed as usize % 3], seed);
            let outcome = setting.cast(&setting.bodies().expect("bodies"), Solver::Portal);
            outcome.ok().map(|outcome| (setting, outcome))
        };
        (0..240).filter_map(ask).filter(|(_, outcome)| kind(outcome)).take(20).collect()
    }

    #[test]
    fn changed_contacts_are_refused() {
        type Change = fn(&mut Contact);
        let changes: [(&str, Change); 8] = [
            ("later", |c| c.translation += 4.0 * c.certificate.rounding),
            ("earlier", |c| c.translation -= 4.0 * c.certificate.rounding),
            ("lower bound", |c| c.certificate.lower += 4.0 * c.certificate.rounding),
            ("upper bound", |c| c.certificate.upper -= 100.0 * c.certificate.rounding),
            ("turned normal", |c| {
                let aside = c.normal.any_orthonormal_vector();
                c.normal = (c.normal + aside * 1e-3).normalize();
                c.certificate.normal = c.normal;
            }),
            ("opposite normal", |c| {
                c.normal = -c.normal;
                c.certificate.normal = c.normal;
            }),
            ("weights", |c| c.certificate.weights = [1.0, -1.0, 1.0]),
            ("vertex", |c| c.certificate.pairs[0].fixed = 99),
        ];
        let contacts = answers(|o| matches!(o, Outcome::Contact(_)));
        assert_eq!(contacts.len(), 20);
        for (setting, outcome) in contacts {
            assert!(!objects(&setting, &outcome), "{setting}");
            let Outcome::Contact(contact) = outcome else { unreachable!() };
            for (name, change) in changes {
                let mut changed = contact;
                change(&mut changed);
                assert!(objects(&setting, &Outcome::Contact(changed)), "{setting}: {name}");
            }
            let Certificate { normal, .. } = contact.certificate;
            let orthogonal = normal.cross(setting.direction).normalize();
            let mut separated = Separated {
                certificate: colltrans::Separation { normal: orthogonal, margin: 1e-3 },
                solver: Solver::Portal,
                steps: contact.steps,
            };
            if !orthogonal.is_finite() {
                separated.certificate.normal = setting.direction.any_orthonormal_vector();
            }
            assert!(objects(&setting, &Outcome::Separated(separated)), "{setting}: separated");
            let grazing = Grazing {
                separating_direction: separated.certificate.normal,
                overlap: 0.0,
                contact,
            };
            assert!(objects(&setting, &Outcome::Grazing(grazing)), "{setting}: grazing");
        }
    }

    #[test]
    fn changed_separations_are_refused() {
        let separations = answers(|o| matches!(o, Outcome::Separated(_)));
        assert_eq!(separations.len(), 20);
        for (setting, outcome) in separations {
            assert!(!objects(&setting, &outcome), "{setting}");
            let Outcome::Separated(separated) = outcome else { unreachable!() };
            let changes: [fn(&mut Separated, DVec3); 4] = [
                |s, _| s.certificate.margin += 1e-9,
                |s, _| s.certificate.normal = -s.certificate.normal,
                |s, d| s.certificate.normal = (s.certificate.normal + d * 1e-9).normalize(),
                |s, _| s.certificate.normal *= 1.001,
            ];
            for (index, change) in changes.into_iter().enumerate() {
                let mut changed = separated;
                change(&mut changed, setting.direction.normalize());
                assert!(objects(&setting, &Outcome::Separated(changed)), "{setting}: {index}");
            }
        }
    }

    #[test]
    fn grazing_is_no_contact() {
        let grazings = answers(|o| matches!(o, Outcome::Grazing(_)));
        assert_eq!(grazings.len(), 20);
        for (setting, outcome) in grazings {
            assert!(!objects(&setting, &outcome), "{setting}");
            let Outcome::Grazing(grazing) = outcome else { unreachable!() };
            assert!(objects(&setting, &Outcome::Contact(grazing.contact)), "{setting}");
            let aside = Grazing { overlap: grazing.overlap - 1e-3, ..grazing };
            assert!(objects(&setting, &Outcome::Grazing(aside)), "{setting}: overlap");
        }
    }
}
