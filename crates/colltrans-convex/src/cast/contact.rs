//! Details of a contact, computed on request: witness points, features, and a pose just before the contact.

use glam::DVec3;

use super::Cast;
use crate::answer::Contact;
use crate::body::{Features, Pose, feature_in_plane};
use colltrans_kernel::error::PoseError;
use colltrans_kernel::noise::Noise;

/// A contact point on each body, in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WitnessPoints {
    /// Point on the moving body, in its *start* pose.
    pub on_moving: DVec3,
    /// Point on the fixed body: the contact point. It equals `on_moving + translation * direction` up to the difference
    /// of the certificate's bounds, or up to the minimum gap of the cast. It is not unique if an edge or a face lies on
    /// the other body.
    pub on_fixed: DVec3,
}

/// Maximum number of steps back from a contact, after which [`Contact::pose_before`] returns the start pose.
const MAX_STEPS_BACK: u32 = 64;

impl Contact {
    /// Computes the witness points, where the bodies touch.
    ///
    /// `cast` is the answered cast, or the reversed one for the `last` contact of a
    /// [`ContactRange`](crate::ContactRange).
    ///
    /// # Panics
    /// If `cast` is about other bodies, which lack the vertices of the certificate.
    pub fn witness_points(&self, cast: &Cast) -> WitnessPoints {
        let setting = &cast.setting;
        let certificate = &self.certificate;
        let cores = setting.core_points(&certificate.pairs, &certificate.weights);
        // The points of the cores are proven to be near each other at the upper bound, which may be far from the
        // translation if the bodies slide along each other.
        let end = certificate.upper;
        let by = setting.direction * if end.is_finite() { end } else { self.translation };
        let [on_moving, on_fixed] = setting.surface_points(cores, by, self.normal);
        WitnessPoints { on_moving, on_fixed }
    }

    /// Computes the features of the bodies that touch.
    ///
    /// `cast` is the answered cast, or the reversed one for the `last` contact of a
    /// [`ContactRange`](crate::ContactRange).
    ///
    /// # Panics
    /// If `cast` is about other bodies, which lack the vertices of the certificate.
    pub fn features(&self, cast: &Cast) -> Features {
        let setting = &cast.setting;
        let [_, gap] = setting.core_gap_bounds(cast.options.min_gap);
        let noise = Noise::for_size(setting.size() + gap).point_error();
        let outward = [setting.moving_normal(self.normal), -setting.fixed_normal(self.normal)];
        let [p, q] = self.support.indices();
        Features {
            moving: feature_in_plane(setting.moving, outward[0], p, noise)
                .with_input_numbers(setting.moving),
            fixed: feature_in_plane(setting.fixed, outward[1], q, noise)
                .with_input_numbers(setting.fixed),
        }
    }

    /// Computes the moving body's pose at this contact, or slightly before it.
    ///
    /// The contact plane separates the interiors of the bodies along the whole motion and at the pose,
    /// including the rounding error of the new translation. Returns the start pose if the contact lies
    /// behind.
    ///
    /// # Errors
    /// Returns an error if the new translation is out of range.
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
            // Compares the rounded displacement along the normal with the proven bound.
            let moved = to - from;
            let rounding = 8.0 * f64::EPSILON * (n.abs().dot(moved.abs()) + along * t);
            let beyond = n.dot(moved) + rounding - along * self.certificate.lower;
            if beyond <= 0.0 {
                return start.with_translation(to);
            }
            t -= (2.0 * beyond / along).max(t * f64::EPSILON);
        }
        Ok(start)
    }
}
