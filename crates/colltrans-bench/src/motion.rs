//! Sequences of settings that change a little from one to the next.

use std::f64::consts::FRAC_1_SQRT_2;

use colltrans::{ConvexPolyhedron, Pose};
use colltrans_oracle::settings::Rng;
use glam::{DQuat, DVec3};

use crate::settings::{Meeting, Setting};

/// How the moving body's start changes from one setting to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// It is displaced.
    Translation,
    /// It turns about its own centre.
    Rotation,
    /// It turns about an axis through its centre and is displaced along it, by as much.
    Screw,
}

impl Motion {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Translation, Self::Rotation, Self::Screw];

    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Translation => "translation",
            Self::Rotation => "rotation",
            Self::Screw => "screw",
        }
    }

    /// A turn and a displacement that move the points of a body of this diameter by up to `delta`
    /// diameters, about and along `axis`.
    fn step(self, axis: DVec3, diameter: f64, delta: f64) -> (DQuat, DVec3) {
        let (turned, displaced) = match self {
            Self::Translation => (0.0, delta),
            Self::Rotation => (delta, 0.0),
            Self::Screw => (delta * FRAC_1_SQRT_2, delta * FRAC_1_SQRT_2),
        };
        // A point half a diameter from the axis moves by `delta` diameters.
        (DQuat::from_axis_angle(axis, 2.0 * turned), axis * (displaced * diameter))
    }
}

/// The diameter of a body, nearly: twice the largest distance of a vertex from the mean of all.
fn diameter(body: &ConvexPolyhedron) -> f64 {
    let middle = middle(body);
    2.0 * body.vertices().iter().map(|v| v.distance(middle)).fold(0.0, f64::max)
}

fn middle(body: &ConvexPolyhedron) -> DVec3 {
    body.vertices().iter().sum::<DVec3>() / body.vertices().len() as f64
}

/// `count` settings about a random one in which the bodies meet, or do not, each `delta` diameters
/// from the next.
///
/// # Panics
/// If there are no bodies, or their vertices are out of range.
pub fn sequence(
    bodies: &[ConvexPolyhedron],
    meeting: Meeting,
    motion: Motion,
    delta: f64,
    count: usize,
    rng: &mut Rng,
) -> Vec<Setting> {
    let middle_setting = Setting::draw(bodies, meeting, rng);
    let body = &bodies[middle_setting.moving];
    let (center, diameter, axis) = (middle(body), diameter(body), rng.direction());
    let start = middle_setting.moving_pose;
    let center_in_world = start.transform_point(center);
    (0..count)
        .map(|k| {
            let steps = k as f64 - count as f64 / 2.0;
            let (turn, displacement) = motion.step(axis, diameter, delta * steps);
            let rotation = (turn * start.rotation()).normalize();
            let translation = center_in_world + displacement - rotation * center;
            let moving_pose = Pose::new(rotation, translation).expect("a rotation");
            Setting { moving_pose, ..middle_setting }
        })
        .collect()
}

/// The paper's sequence of variable coherence (section V-E), for a pair of spheres of radius 1: the
/// moving one goes round the fixed one by `alpha_rad` a step, aiming at a point near its centre,
/// and turns about an axis of its own by as much.
///
/// Body 0 of a list is both spheres.
///
/// # Panics
/// Never: the poses are in range.
pub fn orbit(alpha_rad: f64, count: usize, rng: &mut Rng) -> Vec<Setting> {
    const RADIUS: f64 = 4.0;
    let (axis, spin_axis) = (rng.direction(), rng.direction());
    let (start, aim) = (axis.any_orthonormal_vector(), rng.direction() * rng.range(0.0, 1.5));
    let (turn_p, turn_q) = (rng.rotation(), rng.rotation());
    let fixed_pose = Pose::new(turn_q, DVec3::ZERO).expect("a rotation");
    (0..count)
        .map(|k| {
            let angle = alpha_rad * k as f64;
            let at = DQuat::from_axis_angle(axis, angle) * start * RADIUS;
            let spin = DQuat::from_axis_angle(spin_axis, angle);
            let moving_pose = Pose::new((spin * turn_p).normalize(), at).expect("a rotation");
            let direction = (aim - at).normalize();
            Setting { moving: 0, fixed: 0, moving_pose, fixed_pose, direction }
        })
        .collect()
}
