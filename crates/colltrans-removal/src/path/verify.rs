//! Checks of removal paths, without a search.

use glam::DVec3;

use super::answer::{MAX_BODIES, RemovalPath};
use super::proof::{LegProof, group_members, leg_cast, proves_leg};
use super::search::moving_pairs;
use crate::directions::FreeError;
use colltrans_convex::answer::CertificateError;
use colltrans_convex::body::Placed;
use colltrans_solid::body::Solid;

impl RemovalPath {
    /// Checks all legs against the bodies in their initial poses, without a search. For the cast of a leg,
    /// the moving body is displaced against the body at rest by the difference of the sums of their previous
    /// motions. Adding this displacement to the translation of the pose may round.
    ///
    /// # Errors
    /// Returns [`FreeError::NotProven`] for the first leg that is not proven, and [`FreeError::Query`] for
    /// bodies that a cast rejects.
    pub fn verify(&self, bodies: &[Placed<'_, Solid>]) -> Result<(), FreeError> {
        if self.legs.is_empty() {
            return Err(CertificateError::Cover { entry: 0 }.into());
        }
        let mut at = vec![DVec3::ZERO; bodies.len()];
        for (k, leg) in self.legs.iter().enumerate() {
            let last = k + 1 == self.legs.len();
            let travel = if last { f64::INFINITY } else { leg.motion.length() };
            let told_well = leg.travel == travel && leg.direction == leg.motion.normalize();
            let all = (1..=MAX_BODIES).contains(&bodies.len());
            let own = leg.bodies.iter().filter(|&&b| all && b < bodies.len());
            let group = own.fold(0, |mask, &b| mask | 1 << b);
            let pairs = moving_pairs(group, bodies.len());
            let told: Vec<[usize; 2]> = leg.proofs.iter().map(|proof| proof.bodies).collect();
            if pairs.is_empty() || told != pairs || !told_well || leg.bodies != group_members(group)
            {
                return Err(CertificateError::Cover { entry: 0 }.into());
            }
            for LegProof { bodies: [i, j], certificate } in &leg.proofs {
                let by = at[*i] - at[*j];
                let cast =
                    leg_cast([bodies[*i], bodies[*j]], by, leg.motion, last, self.tolerance)?;
                cast.verify(certificate)?;
                if !proves_leg(certificate, last) {
                    let claimed = if last { f64::INFINITY } else { 1.0 };
                    let proven = certificate.lower;
                    return Err(CertificateError::Bound { proven, claimed }.into());
                }
            }
            for &b in &leg.bodies {
                at[b] += leg.motion;
            }
        }
        Ok(())
    }
}
