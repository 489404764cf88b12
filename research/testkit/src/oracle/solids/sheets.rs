//! Draws settings of open surfaces, most of them with ties, and judges the answers.

use colltrans::solid::{SolidCast, SolidFree};
use colltrans::{Clearance, Pose, Solid};
use glam::{DMat3, DQuat, DVec3};

use super::cells::Cells;
use super::settings::{AGREEMENT, MotionOutcome, any_rotation, sheared, way};
use super::squares::{Mixed, SquareCrossing, Squares};
use super::{encloses, exactly};
use crate::oracle::exact::{Ratio, Vector};
use crate::oracle::scene::size;
use crate::random::Random;

/// The families.
pub const FAMILIES: [&str; 3] = ["sheets", "sheets-sheared", "sheets-rotated"];

/// Two placed bodies, at least one of them open.
#[derive(Debug, Clone)]
pub struct Setting {
    /// The moving and the fixed body, in the grid.
    pub bodies: [Mixed; 2],
    /// Their surfaces in the body frames.
    pub solids: [Solid; 2],
    /// The poses: one rotation, two translations.
    pub poses: [Pose; 2],
    /// The direction.
    pub direction: DVec3,
    shear: DMat3,
}

impl Setting {
    /// Draws the setting of a family with a seed.
    ///
    /// # Errors
    /// A message if the family is unknown, or the library rejects a body.
    pub fn draw(family: &str, seed: u64) -> Result<Self, String> {
        let mut rng = Random::new(seed.wrapping_mul(0x2545_f491_4f6c_dd1d) ^ 0x5ee7);
        let rng = &mut rng;
        // Draws which bodies have cubes and which have squares. At least one must have squares.
        let mut kinds = [rng.int(0, 2), rng.int(0, 2)];
        if kinds == [0, 0] {
            kinds[rng.int(0, 1) as usize] = rng.int(1, 2);
        }
        let bodies = kinds.map(|kind| Mixed {
            cubes: (kind != 1).then(|| Cells::random(rng.int(1, 4) as usize, rng)),
            squares: if kind == 0 {
                Squares::default()
            } else {
                Squares::random(rng.int(1, 9) as usize, rng)
            },
        });
        let half = if rng.one_in(3) { 0.5 } else { 1.0 };
        let mut direction = way(rng);
        let mut translations = [rng.grid(-3, 3) * half, rng.grid(-3, 3) * half];
        if !rng.one_in(4) {
            // The moving body is mostly behind the other one.
            let behind = direction * rng.whole(0, 3);
            translations[0] = translations[1] + rng.grid(-1, 1) * half - behind;
        }
        let mut shear = DMat3::IDENTITY;
        let mut rotation = DQuat::IDENTITY;
        match family {
            "sheets" => direction *= [1.0, 0.25, 3.0][rng.int(0, 2) as usize],
            "sheets-sheared" => {
                shear = sheared(rng);
                // Directions in planes of the grid, or general ones.
                direction = if rng.one_in(4) { direction } else { shear * direction };
                translations = translations.map(|t| shear * t);
            }
            "sheets-rotated" => {
                shear = if rng.one_in(2) { sheared(rng) } else { shear };
                rotation = any_rotation(rng);
                let map = Pose::new(rotation, DVec3::ZERO).map_err(|e| e.to_string())?.matrix();
                let zero = rng.one_in(2);
                let place = |t| if zero { DVec3::ZERO } else { map * (shear * t) };
                translations = translations.map(place);
                direction = map * (shear * direction);
            }
            _ => return Err(format!("no such family: {family}")),
        }
        let mut solid = |body: &Mixed| body.solid(shear, rng).map_err(|e| e.to_string());
        let solids = [solid(&bodies[0])?, solid(&bodies[1])?];
        let pose = |t| Pose::new(rotation, t).map_err(|e| e.to_string());
        let poses = [pose(translations[0])?, pose(translations[1])?];
        Ok(Self { bodies, solids, poses, direction, shear })
    }

    /// Returns the exact result.
    pub fn expected(&self) -> SquareCrossing {
        let [s, t] = self.poses.map(|pose| Vector::new(pose.translation()));
        let maps = [self.poses[0].matrix(), self.shear];
        let [a, b] = &self.bodies;
        SquareCrossing::new([a, b], maps, &t.minus(&s), self.direction)
    }

    /// Computes the answers, and judges them.
    ///
    /// # Errors
    /// A description of the first disagreement.
    pub fn examine(&self) -> Result<MotionOutcome, String> {
        let [a, b] = &self.solids;
        let cast = exactly([a, b], self.poses, self.direction)?;
        let expected = self.expected();
        let tolerance = self.tolerance();
        if let Some(last) = &expected.last {
            let late = cast.exit().is_some_and(|exit| *last <= Ratio::from_f64(exit.upper));
            if !late && last.to_f64() > tolerance {
                return Err(format!("exit {:?}, not {}", cast.exit(), last.to_f64()));
            }
        }
        let (found, certificate) = cast.certified_clearance().map_err(|e| e.to_string())?;
        cast.verify(&certificate).map_err(|e| format!("{found:?}: {e}: {certificate:?}"))?;
        if Ok(found) != cast.clearance() {
            return Err(format!("{found:?}, and without a proof {:?}", cast.clearance()));
        }
        if let Clearance::Free(SolidFree { separation: Some(separation), .. }) = &found {
            cast.verify(separation).map_err(|e| format!("{found:?}: {e}"))?;
        }
        let not_before = |stop: &Ratio| *stop >= Ratio::from_f64(certificate.lower);
        match (&found, expected.overlaps, &expected.stop) {
            (Clearance::Overlapping(overlap), true, _) if overlap.least_tolerance.is_none() => {
                Ok(MotionOutcome::Overlapping)
            }
            (Clearance::Free(_), false, None) => Ok(MotionOutcome::Free),
            (Clearance::Blocked { distance, contact }, false, Some(stop))
                if stop.minus(&Ratio::from_f64(*distance)).is_within(tolerance)
                    && encloses(&contact.translation, stop)
                    && not_before(stop)
                    && contact.normal.dot(self.direction) > -1e-12
                    && contact.point_on_moving.is_finite()
                    && contact.point_on_fixed.is_finite() =>
            {
                Ok(if stop.is_zero() { MotionOutcome::BlockedNow } else { MotionOutcome::Blocked })
            }
            (found, overlaps, stop) => Err(format!(
                "{found:?}, but overlapping: {overlaps}, stop: {:?}",
                stop.as_ref().map(Ratio::to_f64)
            )),
        }
    }

    fn tolerance(&self) -> f64 {
        let size = size(self.solids.each_ref().map(Solid::vertices), self.poses.each_ref());
        AGREEMENT * 16.0 * f64::EPSILON * size / self.direction.length()
    }
}
