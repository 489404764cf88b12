//! Checks of removal paths, without a search.

use glam::DVec3;

use super::answer::{MAX_BODIES, RemovalPath};
use super::proof::{LegProof, group_members, leg_cast, proves_leg};
use super::scene::RemovalScene;
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
        self.verify_in(&RemovalScene::with_tolerance(bodies, self.tolerance))
    }

    /// Checks all legs against the bodies of a scene in their initial poses, without a search. Pairs that do not block
    /// each other have no proof, and joined bodies must move together.
    ///
    /// # Errors
    /// Returns the errors of [`Self::verify`].
    pub fn verify_in(&self, scene: &RemovalScene<'_>) -> Result<(), FreeError> {
        let count = scene.count();
        if self.legs.is_empty() {
            return Err(CertificateError::Cover { entry: 0 }.into());
        }
        let mut at = vec![DVec3::ZERO; count];
        for (k, leg) in self.legs.iter().enumerate() {
            let last = k + 1 == self.legs.len();
            let travel = if last { f64::INFINITY } else { leg.motion.length() };
            let told_well = leg.travel == travel && leg.direction == leg.motion.normalize();
            let all = (1..=MAX_BODIES).contains(&count);
            let own = leg.bodies.iter().filter(|&&b| all && b < count);
            let group = own.fold(0, |mask, &b| mask | 1 << b);
            let all_pairs = moving_pairs(group, count);
            let separates = !all_pairs.is_empty();
            let pairs = scene.pairs_to_prove(all_pairs);
            let told: Vec<[usize; 2]> = leg.proofs.iter().map(|proof| proof.bodies).collect();
            let told_well = told_well && leg.bodies == group_members(group);
            if !separates || pairs.as_ref() != Some(&told) || !told_well {
                return Err(CertificateError::Cover { entry: 0 }.into());
            }
            for LegProof { bodies: [i, j], certificate } in &leg.proofs {
                let by = at[*i] - at[*j];
                let Some((bodies, tolerance)) = scene.proven_pair([*i, *j]) else { continue };
                let cast = leg_cast(bodies, by, leg.motion, last, tolerance)?;
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
