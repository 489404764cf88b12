//! Builds answers from the results of a solver: bounds with proofs, in the world frame.

use glam::DVec2;

use crate::answer::{
    Certificate, Contact, Grazing, NormalBound, Separation, Solver, Steps, gap_rounding,
};
use crate::setting::error::Stalled;
use crate::setting::minkowski::{MinkowskiDifference, ShadowPoint};
use crate::solve::WarmStart;
use crate::solve::portal::{ContactPortal, Plane, Portal};
use colltrans_kernel::noise::UNIT_VECTOR;

/// The lowest face of `M` on the line and the bounds that it proves, in the world.
///
/// It is small and refers to the portal and the plane, because copies of an outcome go through memory.
pub(crate) struct ProvenFace<'a> {
    portal: &'a Portal,
    plane: &'a Plane,
    weights: [f64; 3],
    /// Estimate of the collision translation, in multiples of the direction, like the fields below.
    translation: f64,
    /// Proven lower bound.
    lower: f64,
    /// Proven upper bound; infinite for widened bodies.
    upper: f64,
    /// Bound on the part of `upper - lower` that rounding and the excess of the bodies cause.
    rounding: f64,
}

impl<'a> ProvenFace<'a> {
    /// Computes the bounds that a plane and a portal prove.
    ///
    /// # Errors
    /// [`Stalled::Gap`] if rounding alone does not explain the gap between the bounds, or the plane is nearly parallel
    /// to the direction.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a copy through memory stalls its reader")]
    pub(crate) fn new(
        difference: &MinkowskiDifference,
        portal: &'a Portal,
        plane: &'a Plane,
        weights: [f64; 3],
    ) -> Result<Self, Stalled> {
        let setting = difference.setting;
        let noise = difference.noise;
        let &Plane { normal, ref normals, lowest, excess } = plane;
        let steepness = normal.dot(setting.direction);
        let bound = NormalBound::new(setting, noise, normal, normals, lowest, excess);
        let [_, v, w] = weights;
        let [a, b, c] = portal.each_ref().map(ShadowPoint::height);
        // For corners of equal height this is exactly their height, however the weights are rounded.
        let estimate = (a + (b - a) * v + (c - a) * w) / setting.length;
        let most = gap_rounding(setting, normal, noise, difference.widening);
        let lower = bound.distance / steepness;
        let gap = estimate - lower;
        // A plane parallel to the direction proves no bound.
        let is_upward = steepness > UNIT_VECTOR * setting.length;
        if !is_upward || gap.is_nan() || gap > most {
            return Err(Stalled::Gap { lower, upper: estimate, tolerance: most });
        }
        let lower = bound.lower_bound(steepness);
        // Widened bodies prove no upper bound for the given ones.
        let upper = if difference.widening == 0.0 {
            (estimate + noise.upper_bound_margin() / steepness).next_up()
        } else {
            f64::INFINITY
        };
        let rounding = most + (noise.upper_bound_margin() + bound.error) / steepness;
        let translation = estimate.max(lower);
        Ok(Self { portal, plane, weights, translation, lower, upper, rounding })
    }

    /// Returns the portal from which a later cast may start.
    #[inline]
    pub(crate) fn contact_portal(&self) -> ContactPortal {
        ContactPortal {
            pairs: self.portal.each_ref().map(|p| p.pair),
            weights: self.weights,
            normals: self.plane.normals,
        }
    }

    /// Builds the contact with its certificate.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "built in the return slot")]
    pub(crate) fn contact(&self, solver: Solver, steps: Steps) -> Contact {
        Contact {
            translation: self.translation,
            normal: self.plane.normal,
            support: self.plane.lowest,
            certificate: Certificate {
                normal: self.plane.normal,
                lower: self.lower,
                pairs: self.portal.each_ref().map(|p| p.pair),
                weights: self.weights,
                upper: self.upper,
                rounding: self.rounding,
            },
            solver,
            steps,
        }
    }
}

/// Builds the grazing outcome of a contact.
///
/// `inward` is the lateral normal of the silhouette (shadow frame), `overlap` the lateral overlap in world units.
pub(crate) fn grazing_contact(
    difference: &MinkowskiDifference,
    inward: DVec2,
    overlap: f64,
    contact: Contact,
) -> Grazing {
    let separating_direction = (difference.setting_from_shadow * inward.extend(0.0)).normalize();
    // Adding 0 turns an overlap of -0 into 0.
    Grazing { separating_direction, overlap: overlap + 0.0, contact }
}

/// Builds the separation that a plane parallel to the direction proves, and the start of a later cast.
///
/// The margin is lowered by its rounding error and by the excess of the bodies beyond the support points.
#[inline]
pub(crate) fn plane_separation(
    difference: &MinkowskiDifference,
    plane: &Plane,
    margin: f64,
) -> (Separation, WarmStart) {
    let margin = margin - difference.noise.lower_bound_margin() - plane.excess;
    let start = WarmStart::Apart { normals: plane.normals, pair: plane.lowest };
    (Separation { normal: plane.normal, margin }, start)
}
