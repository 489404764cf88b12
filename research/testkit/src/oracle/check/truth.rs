//! Compares answers with the linear programme ([`simplex`](crate::oracle::simplex)) and the exact lateral
//! overlap ([`shadow`](crate::oracle::shadow)), for the vertices and for the input points of the bodies.

use std::cmp::Ordering;

use colltrans::{Certificate, Contact, Outcome};

use super::{Judge, Objection, TWO_ROUNDINGS};
use crate::oracle::exact::Ratio;
use crate::oracle::scene::Scene;
use crate::oracle::shadow::{SignedDistance, sideways_overlap};
use crate::oracle::simplex::collision_translation;

/// The results of the oracle for a scene. They are computed once, because that is slow.
#[derive(Debug)]
pub(super) struct Truth {
    pub(super) translation: Option<Ratio>,
    overlap: SignedDistance,
}

impl Truth {
    /// Computes the results of the oracle.
    fn of(scene: &Scene) -> Self {
        Self { translation: collision_translation(scene), overlap: sideways_overlap(scene) }
    }
}

impl Judge<'_> {
    /// Returns the results of the oracle for the vertices.
    pub(super) fn truth(&self) -> &Truth {
        self.truth.get_or_init(|| Truth::of(&self.scene))
    }

    /// Compares an answer with the linear programme and the exact lateral overlap of the vertices: its outcome
    /// exactly, its value up to the stated bound. For the input points, the value must be within the stated
    /// bounds ([`input`](crate::oracle::input)).
    ///
    /// # Errors
    /// [`Objection`] with the difference.
    pub fn compare_with_oracle(&self, outcome: &Outcome) -> Result<(), Objection> {
        self.compare_vertices(outcome)?;
        let Some(input) = &self.input else { return Ok(()) };
        self.compare_input(outcome, input).map_err(|e| Objection(format!("of the input: {e}")))
    }

    /// Checks the consequences for the input points, see [`input`](crate::oracle::input).
    fn compare_input(&self, outcome: &Outcome, input: &Scene) -> Result<(), Objection> {
        let Truth { translation: truth, overlap } =
            self.truth_of_input.get_or_init(|| Truth::of(input));
        let off = self.hull_errors();
        match outcome {
            Outcome::Separated(separated) => {
                let margin = separated.certificate.margin;
                require!(
                    truth.is_none() && !overlap.exceeds(-margin),
                    "separated by {margin:e}, but the shadows overlap by {:e}",
                    overlap.to_f64()
                );
                Ok(())
            }
            Outcome::Contact(contact) => {
                require!(truth.is_some(), "contact, but the bodies never meet");
                Self::encloses(contact, truth.as_ref())
            }
            Outcome::Grazing(grazing) => {
                let allowed = grazing.overlap + off + TWO_ROUNDINGS * self.scene.noise;
                require!(
                    !overlap.exceeds(allowed),
                    "grazing, but the shadows overlap by {:e}",
                    overlap.to_f64()
                );
                Self::encloses(&grazing.contact, truth.as_ref())
            }
        }
    }

    /// Checks that the bounds enclose the exact value.
    fn encloses(contact: &Contact, truth: Option<&Ratio>) -> Result<(), Objection> {
        let Some(truth) = truth else { return Ok(()) };
        let Certificate { lower, upper, .. } = contact.certificate;
        require!(
            Ratio::from_f64(lower) <= *truth
                && (upper == f64::INFINITY || *truth <= Ratio::from_f64(upper)),
            "the true value {:e} is not between {lower:e} and {upper:e}",
            truth.to_f64()
        );
        Ok(())
    }

    /// Returns the sum of the hull errors of both bodies in the world. Poses may scale lengths by up to a
    /// millionth, and normals are unit vectors up to rounding.
    pub(super) fn hull_errors(&self) -> f64 {
        (self.cast.moving().hull_error() + self.cast.fixed().hull_error()) * (1.0 + 4e-6)
    }

    /// Compares an answer with the results of the oracle for the vertices.
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
                    !overlap.exceeds(border + slack)
                        && overlap.exceeds(-slack - self.hull_errors()),
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

    /// Checks that the value agrees with the exact one up to the tolerance of the certificate, and that the
    /// bounds enclose the exact value.
    #[expect(clippy::unused_self, reason = "has the same form as the other checks")]
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

    /// Checks that the value is the exact one or less, up to the tolerance of the certificate. The bodies may
    /// have been widened laterally, and widened bodies meet earlier, by an amount that depends on the slope of
    /// their faces at the boundary.
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

    /// Checks that the lower bound does not exceed the exact value.
    fn not_below(contact: &Contact, truth: &Ratio) -> Result<(), Objection> {
        let lower = contact.certificate.lower;
        require!(
            Ratio::from_f64(lower) <= *truth,
            "lower bound {lower:e} is more than the true value {:e}",
            truth.to_f64()
        );
        Ok(())
    }
}
