//! From what a solver found to the answer: bounds, witness points and contact features, in the
//! world.

use glam::{DVec2, DVec3};

use crate::answer::{Certificate, Separation, gap_tolerance};
use crate::answer::{Contact, Grazing, Separated, Solver, Steps};
use crate::body::{Pose, feature};
use crate::error::QueryError;
use crate::setting::VertexPair;
use crate::setting::minkowski::{MinkowskiDifference, Point};
use crate::solve::portal::{ContactPortal, Optimum, Portal, SeparatingLine};

/// An optimum and what it proves, in the world. Small and passed by reference: moving an outcome
/// about costs a tenth of a coherent query.
pub(crate) struct Proven<'a> {
    difference: &'a MinkowskiDifference<'a>,
    portal: &'a Portal,
    optimum: &'a Optimum,
    /// The unit contact normal, in the world.
    normal: DVec3,
    /// The same in the frames of the moving and of the fixed body.
    normals: [DVec3; 2],
    lower: f64,
    upper: f64,
    tolerance: f64,
}

impl<'a> Proven<'a> {
    /// # Errors
    /// Bounds that rounding alone does not explain.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory it stalls its reader: 5 %")]
    pub(crate) fn new(
        difference: &'a MinkowskiDifference,
        portal: &'a Portal,
        optimum: &'a Optimum,
    ) -> Result<Self, QueryError> {
        let setting = difference.setting;
        let normal = (difference.setting_from_shadow * optimum.normal).normalize();
        let normals = [setting.moving_normal(normal), setting.fixed_normal(normal)];
        let [p, q] = setting.vertices(optimum.lowest);
        let distance = (normals[1].dot(q) - normals[0].dot(p)) + normal.dot(setting.offset);
        let lower = distance / normal.dot(setting.direction);
        let [u, v, w] = optimum.weights;
        let [a, b, c] = portal.each_ref().map(Point::height);
        let upper = (a * u + b * v + c * w) / setting.length;
        let tolerance = gap_tolerance(setting, normal, difference.noise, difference.widening);
        let gap = upper - lower;
        if gap.is_nan() || gap > tolerance {
            return Err(QueryError::NotConverged { lower, upper, tolerance });
        }
        Ok(Self { difference, portal, optimum, normal, normals, lower, upper, tolerance })
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
    #[expect(clippy::inline_always, reason = "built where it is to stay: 5 %")]
    pub(crate) fn contact(&self, moving_pose: &Pose, solver: Solver, steps: Steps) -> Contact {
        let setting = self.difference.setting;
        let pairs = self.portal.each_ref().map(|p| p.pair);
        let [on_moving, on_fixed] = setting.weighted(&pairs, &self.optimum.weights);
        let origin = moving_pose.translation();
        let VertexPair { moving, fixed } = self.optimum.lowest;
        let noise = self.difference.noise.point();
        Contact {
            translation: self.upper,
            normal: self.normal,
            point_on_moving: setting.moving_matrix * on_moving + origin,
            point_on_fixed: setting.fixed_matrix * on_fixed + setting.offset + origin,
            moving_feature: feature(setting.moving, self.normals[0], moving, noise),
            fixed_feature: feature(setting.fixed, -self.normals[1], fixed, noise),
            certificate: Certificate {
                normal: self.normal,
                lower: self.lower,
                pairs,
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

pub(crate) fn separated(
    difference: &MinkowskiDifference,
    found: &SeparatingLine,
    solver: Solver,
    steps: Steps,
) -> Separated {
    let normal = (difference.setting_from_shadow * found.normal.extend(0.0)).normalize();
    let certificate = Separation { normal, margin: found.margin };
    Separated { certificate, solver, steps }
}
