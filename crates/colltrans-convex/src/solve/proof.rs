//! From what a solver found to the answer: bounds, and where they come from, in the world.

use glam::DVec2;

use crate::answer::{
    Certificate, Contact, Grazing, NormalBound, Separation, Solver, Steps, gap_rounding,
};
use crate::setting::error::Stalled;
use crate::setting::minkowski::{MinkowskiDifference, Point};
use crate::solve::WarmStart;
use crate::solve::portal::{ContactPortal, Plane, Portal};
use colltrans_kernel::noise::UNIT_VECTOR;

/// The lowest face of `M` on the line and what it proves, in the world. Small and passed by reference:
/// moved about, an outcome goes through memory.
pub(crate) struct Proven<'a> {
    portal: &'a Portal,
    plane: &'a Plane,
    weights: [f64; 3],
    /// The estimate of the collision translation.
    translation: f64,
    lower: f64,
    upper: f64,
    rounding: f64,
}

impl<'a> Proven<'a> {
    /// # Errors
    /// Bounds that rounding alone does not explain.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory it stalls its reader")]
    pub(crate) fn new(
        difference: &MinkowskiDifference,
        portal: &'a Portal,
        plane: &'a Plane,
        weights: [f64; 3],
    ) -> Result<Self, Stalled> {
        let setting = difference.setting;
        let noise = difference.noise;
        let &Plane { normal, ref normals, lowest, beyond } = plane;
        let steepness = normal.dot(setting.direction);
        let bound = NormalBound::new(setting, noise, normal, normals, lowest, beyond);
        let [_, v, w] = weights;
        let [a, b, c] = portal.each_ref().map(Point::height);
        // Of corners at one height it is theirs, whatever the weights were rounded to.
        let estimate = (a + (b - a) * v + (c - a) * w) / setting.length;
        let most = gap_rounding(setting, normal, noise, difference.widening);
        let lower = bound.distance / steepness;
        let gap = estimate - lower;
        // A plane along the direction bounds nothing.
        let is_upward = steepness > UNIT_VECTOR * setting.length;
        if !is_upward || gap.is_nan() || gap > most {
            return Err(Stalled::Gap { lower, upper: estimate, tolerance: most });
        }
        let lower = bound.lower_bound(steepness);
        // Of widened bodies nothing is known from above.
        let upper = if difference.widening == 0.0 {
            (estimate + noise.raised() / steepness).next_up()
        } else {
            f64::INFINITY
        };
        let rounding = most + (noise.raised() + bound.error) / steepness;
        let translation = estimate.max(lower);
        Ok(Self { portal, plane, weights, translation, lower, upper, rounding })
    }

    /// What a later query may start from.
    #[inline]
    pub(crate) fn contact_portal(&self) -> ContactPortal {
        ContactPortal {
            pairs: self.portal.each_ref().map(|p| p.pair),
            weights: self.weights,
            normals: self.plane.normals,
        }
    }

    #[inline(always)]
    #[expect(clippy::inline_always, reason = "built where it is to stay")]
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

pub(crate) fn grazing(
    difference: &MinkowskiDifference,
    inward: DVec2,
    overlap: f64,
    contact: Contact,
) -> Grazing {
    let separating_direction = (difference.setting_from_shadow * inward.extend(0.0)).normalize();
    // Of a margin of 0 the overlap is not -0.
    Grazing { separating_direction, overlap: overlap + 0.0, contact }
}

/// What a plane parallel to the direction proves: the margin along it, less what rounding and bodies
/// that reach beyond the support points may take from it; and where a later query may begin.
#[inline]
pub(crate) fn separation(
    difference: &MinkowskiDifference,
    plane: &Plane,
    margin: f64,
) -> (Separation, WarmStart) {
    let margin = margin - difference.noise.lowered() - plane.beyond;
    let start = WarmStart::Apart { normals: plane.normals, pair: plane.lowest };
    (Separation { normal: plane.normal, margin }, start)
}
