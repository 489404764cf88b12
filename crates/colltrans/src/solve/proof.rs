//! From what a solver found to the answer: bounds, and where they come from, in the world.

use glam::{DVec2, DVec3};

use crate::answer::{Along, Certificate, Contact, Grazing, Solver, Steps, gap_tolerance};
use crate::error::{QueryError, Stalled};
use crate::setting::minkowski::{MinkowskiDifference, Point};
use crate::solve::portal::{ContactPortal, Optimum, Portal, SeparatingLine};

/// An optimum and what it proves, in the world. Small and passed by reference: moved about, an outcome
/// goes through memory.
pub(crate) struct Proven<'a> {
    portal: &'a Portal,
    optimum: &'a Optimum,
    /// The unit contact normal, in the world.
    normal: DVec3,
    /// The same in the frames of the moving and of the fixed body.
    normals: [DVec3; 2],
    /// The estimate of the collision translation.
    translation: f64,
    lower: f64,
    upper: f64,
    tolerance: f64,
}

impl<'a> Proven<'a> {
    /// # Errors
    /// Bounds that rounding alone does not explain.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory it stalls its reader")]
    pub(crate) fn new(
        difference: &MinkowskiDifference,
        portal: &'a Portal,
        optimum: &'a Optimum,
    ) -> Result<Self, QueryError> {
        let setting = difference.setting;
        let noise = difference.noise;
        let normal = (difference.setting_from_shadow * optimum.normal).normalize();
        let normals = [setting.moving_normal(normal), setting.fixed_normal(normal)];
        let steepness = normal.dot(setting.direction);
        let along = Along::new(setting, noise, normal, &normals, optimum.lowest);
        let [u, v, w] = optimum.weights;
        let [a, b, c] = portal.each_ref().map(Point::height);
        let estimate = (a * u + b * v + c * w) / setting.length;
        let tolerance = gap_tolerance(setting, normal, noise, difference.widening);
        let lower = along.distance / steepness;
        let gap = estimate - lower;
        if gap.is_nan() || gap > tolerance {
            let reason = Stalled::Gap { lower, upper: estimate, tolerance };
            return Err(QueryError::NotConverged { reason });
        }
        let lower = along.lower(steepness);
        // Of widened bodies nothing is known from above.
        let upper = if difference.widening == 0.0 {
            (estimate + noise.raised() / steepness).next_up()
        } else {
            f64::INFINITY
        };
        let tolerance = tolerance + (noise.raised() + along.error) / steepness;
        let translation = estimate.max(lower);
        Ok(Self { portal, optimum, normal, normals, translation, lower, upper, tolerance })
    }

    /// What a later query may start from.
    #[inline]
    pub(crate) fn contact_portal(&self) -> ContactPortal {
        let weights = self.optimum.weights;
        ContactPortal {
            pairs: self.portal.each_ref().map(|p| p.pair),
            weights,
            normals: self.normals,
        }
    }

    #[inline(always)]
    #[expect(clippy::inline_always, reason = "built where it is to stay")]
    pub(crate) fn contact(&self, solver: Solver, steps: Steps) -> Contact {
        Contact {
            translation: self.translation,
            normal: self.normal,
            support: self.optimum.lowest,
            certificate: Certificate {
                normal: self.normal,
                lower: self.lower,
                pairs: self.portal.each_ref().map(|p| p.pair),
                weights: self.optimum.weights,
                upper: self.upper,
                tolerance: self.tolerance,
            },
            solver,
            steps,
        }
    }
}

pub(crate) fn grazing(
    difference: &MinkowskiDifference,
    inward: DVec2,
    overlap: f64,
    contact: Contact,
) -> Grazing {
    let separating_direction = (difference.setting_from_shadow * inward.extend(0.0)).normalize();
    Grazing { separating_direction, overlap, contact }
}

/// The margin of a separating line, given in both bodies' frames, less what rounding and bodies that
/// reach beyond the support points may take from it.
#[inline]
pub(crate) fn safe_margin(
    difference: &MinkowskiDifference,
    found: &SeparatingLine,
    normals: &[DVec3; 2],
) -> f64 {
    let (setting, pair) = (difference.setting, found.point.pair);
    let beyond = setting.moving.excess(normals[0], pair.moving)
        + setting.fixed.excess(-normals[1], pair.fixed);
    found.margin - difference.noise.lowered() - beyond
}
