//! Checks of ways out, without a search.

use glam::DVec3;

use super::answer::{MOST_BODIES, WayOut};
use super::proof::{LegProof, members, of_leg, passes};
use super::search::border;
use crate::free::FreeError;
use colltrans_convex::answer::CertificateError;
use colltrans_convex::body::Placed;
use colltrans_solid::body::Solid;

impl WayOut {
    /// Checks all legs against the bodies, placed as they were asked about; no search plays a part. A place is a pose
    /// displaced by the sum of the motions so far, rounded where the pose itself is no whole multiple of their grid.
    ///
    /// # Errors
    /// What is not proven.
    pub fn verify(&self, bodies: &[Placed<'_, Solid>]) -> Result<(), FreeError> {
        if self.legs.is_empty() {
            return Err(CertificateError::Cover { entry: 0 }.into());
        }
        let mut at = vec![DVec3::ZERO; bodies.len()];
        for (k, leg) in self.legs.iter().enumerate() {
            let last = k + 1 == self.legs.len();
            let travel = if last { f64::INFINITY } else { leg.motion.length() };
            let told_well = leg.travel == travel && leg.direction == leg.motion.normalize();
            let all = (1..=MOST_BODIES).contains(&bodies.len());
            let own = leg.bodies.iter().filter(|&&b| all && b < bodies.len());
            let group = own.fold(0, |mask, &b| mask | 1 << b);
            let pairs = border(group, bodies.len());
            let told: Vec<[usize; 2]> = leg.proofs.iter().map(|proof| proof.bodies).collect();
            if pairs.is_empty() || told != pairs || !told_well || leg.bodies != members(group) {
                return Err(CertificateError::Cover { entry: 0 }.into());
            }
            for LegProof { bodies: [i, j], certificate } in &leg.proofs {
                let by = at[*i] - at[*j];
                let cast = of_leg([bodies[*i], bodies[*j]], by, leg.motion, last, self.tolerance)?;
                cast.verify(certificate)?;
                if !passes(certificate, last) {
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
