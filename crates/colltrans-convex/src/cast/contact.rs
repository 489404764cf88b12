//! What can be asked of a contact: witness points, features, and a pose just before it.

use glam::DVec3;

use super::Cast;
use crate::answer::Contact;
use crate::body::{Features, Pose, feature};
use colltrans_kernel::error::PoseError;
use colltrans_kernel::noise::Noise;

/// A contact point on each body, in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WitnessPoints {
    /// On the moving body, at its *start* pose.
    pub on_moving: DVec3,
    /// On the fixed body: the contact point. It is `on_moving + translation * direction` up to
    /// rounding. Where an edge or a face lies on the other body, it is one of many.
    pub on_fixed: DVec3,
}

/// Steps back from a contact before the pose is left where it was.
const MAX_STEPS_BACK: u32 = 64;

impl Contact {
    /// The witness points: where the bodies touch. `cast` is the one that was answered; for the
    /// `last` contact of a [`ContactRange`](crate::ContactRange), the reversed one.
    ///
    /// # Panics
    /// If `cast` is about other bodies, which lack the vertices of the certificate.
    pub fn points(&self, cast: &Cast) -> WitnessPoints {
        let setting = &cast.setting;
        let certificate = &self.certificate;
        let [p, q] = setting.weighted(&certificate.pairs, &certificate.weights);
        let origin = setting.translations[0];
        WitnessPoints {
            on_moving: setting.moving_matrix * p + origin,
            on_fixed: setting.fixed_matrix * q + setting.offset + origin,
        }
    }

    /// The parts of the bodies that touch. `cast` as in [`Self::points`].
    ///
    /// # Panics
    /// If `cast` is about other bodies, which lack the vertices of the certificate.
    pub fn features(&self, cast: &Cast) -> Features {
        let setting = &cast.setting;
        let noise = Noise::of(setting.scale() + cast.options.keep).point();
        let outward = [setting.moving_normal(self.normal), -setting.fixed_normal(self.normal)];
        let [p, q] = self.support.numbers();
        Features {
            moving: feature(setting.moving, outward[0], p, noise).named(setting.moving),
            fixed: feature(setting.fixed, outward[1], q, noise).named(setting.fixed),
        }
    }

    /// The moving body's pose after the motion up to this contact and not beyond, whatever rounding
    /// makes of the new translation: on the way and there, the contact plane lies between the
    /// interiors of the bodies. The start pose itself if the contact lies behind.
    ///
    /// # Errors
    /// The new translation is out of range.
    ///
    /// ```
    /// # use colltrans::glam::DVec3;
    /// # use colltrans::{Cast, ConvexPolyhedron, Outcome, Pose};
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// let start = Pose::from_translation(DVec3::new(-3.1, 0.3, 0.1))?;
    /// let cast = Cast::new(cube.at(start), cube.at(Pose::IDENTITY), DVec3::X)?;
    /// let Outcome::Contact(contact) = cast.first_contact()? else {
    ///     unreachable!("the other cube is in the way")
    /// };
    /// let there = contact.pose_before(&cast)?;
    /// assert!(there.translation().x <= -1.0 && there.translation().x > -1.0 - 1e-13);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn pose_before(&self, cast: &Cast) -> Result<Pose, PoseError> {
        let start = cast.moving_pose();
        let (from, d, n) = (start.translation(), cast.direction(), self.normal);
        let along = n.dot(d);
        let mut t = self.certificate.lower;
        for _ in 0..MAX_STEPS_BACK {
            if t.is_nan() || t <= 0.0 {
                break;
            }
            let to = from + d * t;
            // What was really moved, towards the contact plane, against what may be.
            let moved = to - from;
            let rounding = 8.0 * f64::EPSILON * (n.abs().dot(moved.abs()) + along * t);
            let beyond = n.dot(moved) + rounding - along * self.certificate.lower;
            if beyond <= 0.0 {
                return start.moved_to(to);
            }
            t -= (2.0 * beyond / along).max(t * f64::EPSILON);
        }
        Ok(start)
    }
}
