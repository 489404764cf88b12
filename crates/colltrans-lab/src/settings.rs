//! Settings: two poses and a direction, for bodies that meet, or pass each other at a known
//! distance, by construction.
//!
//! Notation. `D` is the bodies' diameter. The *shadow gap* is the distance of the bodies'
//! projections along the direction, measured along one random lateral direction; the *gap ahead* is
//! by how much a plane across the direction keeps the bodies apart at the start.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use colltrans::{Cast, ConvexPolyhedron, Options, Pose, QueryError};
use glam::{DQuat, DVec3};

use crate::shapes::Bodies;
use colltrans_kit::random::Random;

/// Where the bodies are and where the moving one goes.
#[derive(Debug, Clone, Copy)]
pub struct Setting {
    /// The moving body's pose at the start.
    pub moving: Pose,
    /// The fixed body's pose.
    pub fixed: Pose,
    /// Of unit length.
    pub direction: DVec3,
}

/// Whether the bodies meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Meeting {
    /// They do.
    Colliding,
    /// They pass with this shadow gap, in `D`.
    Passing(f64),
    /// They pass with a shadow gap up to this many `D`.
    PassingWithin(f64),
}

/// Bounds of the gap ahead, in `D`.
const AHEAD: [f64; 2] = [0.05, 1.0];

impl Setting {
    /// The query about two bodies.
    ///
    /// # Errors
    /// As [`Cast::new`] and [`Cast::with_options`].
    #[inline]
    pub fn cast<'a>(&self, bodies: &'a Bodies, options: &Options) -> Result<Cast<'a>, QueryError> {
        let [moving, fixed] = &bodies.pair;
        Cast::new(moving.at(self.moving), fixed.at(self.fixed), self.direction)?
            .with_options(*options)
    }

    /// A random setting of bodies that are apart at the start, in random orientations.
    ///
    /// # Panics
    /// If the bodies are out of the range of poses.
    pub fn draw(bodies: &Bodies, meeting: Meeting, random: &mut Random) -> Self {
        let [p, q] = &bodies.pair;
        let (turn_p, turn_q) = (random.rotation(), random.rotation());
        let direction = random.direction();
        let lateral = direction.cross(random.direction()).normalize();
        // First so that a point inside P is opposite to one inside Q.
        let mut offset = turn_p * inside(p, random) - turn_q * inside(q, random);
        let shadow_gap = match meeting {
            Meeting::Colliding => None,
            Meeting::Passing(gap) => Some(gap),
            Meeting::PassingWithin(most) => Some(random.range(0.0, most)),
        };
        if let Some(gap) = shadow_gap {
            let now = gap_along(lateral, (p, turn_p), (q, turn_q)) + offset.dot(lateral);
            offset += lateral * (gap * bodies.diameter - now);
        }
        let now = gap_along(direction, (p, turn_p), (q, turn_q)) + offset.dot(direction);
        offset += direction * (random.range(AHEAD[0], AHEAD[1]) * bodies.diameter - now);
        Self { moving: pose(turn_p, DVec3::ZERO), fixed: pose(turn_q, offset), direction }
    }

    /// `count` settings about a random one, each `delta` diameters from the next: the moving body
    /// is displaced, or turns about its centre, or half of either as a screw does.
    ///
    /// # Panics
    /// If the bodies are out of the range of poses.
    pub fn sequence(
        bodies: &Bodies,
        meeting: Meeting,
        delta: f64,
        count: usize,
        random: &mut Random,
    ) -> Vec<Self> {
        let middle = Self::draw(bodies, meeting, random);
        let axis = random.direction();
        let [displaced, turned] =
            [[1.0, 0.0], [0.0, 1.0], [FRAC_1_SQRT_2, FRAC_1_SQRT_2]][random.index(3)];
        (0..count)
            .map(|k| {
                let by = delta * (k as f64 - 0.5 * (count - 1) as f64);
                // A point half a diameter from the axis moves by `delta` diameters.
                let turn = DQuat::from_axis_angle(axis, 2.0 * by * turned);
                let rotation = (turn * middle.moving.rotation()).normalize();
                Self { moving: pose(rotation, axis * (by * displaced * bodies.diameter)), ..middle }
            })
            .collect()
    }

    /// The paper's motion of variable coherence (section V-E), for spheres: the moving one goes
    /// round the fixed one, aiming at a point in its neighbourhood, and turns about an axis of its
    /// own by as much, `alpha_deg` a step.
    ///
    /// # Panics
    /// Never: the poses are in range.
    pub fn orbit(bodies: &Bodies, alpha_deg: f64, count: usize, random: &mut Random) -> Vec<Self> {
        let (axis, spin_axis) = (random.direction(), random.direction());
        let start = axis.any_orthonormal_vector() * (2.0 * bodies.diameter);
        // Up to three quarters of a diameter from the centre: one in four or so passes.
        let aim = random.direction() * (random.range(0.0, 0.75) * bodies.diameter);
        let (turn_p, turn_q) = (random.rotation(), random.rotation());
        (0..count)
            .map(|k| {
                let angle_rad = alpha_deg * PI / 180.0 * k as f64;
                let at = DQuat::from_axis_angle(axis, angle_rad) * start;
                let spin = DQuat::from_axis_angle(spin_axis, angle_rad);
                Self {
                    moving: pose((spin * turn_p).normalize(), at),
                    fixed: pose(turn_q, DVec3::ZERO),
                    direction: (aim - at).normalize(),
                }
            })
            .collect()
    }
}

fn pose(rotation: DQuat, translation: DVec3) -> Pose {
    Pose::new(rotation, translation).expect("a rotation, and a translation of a few diameters")
}

/// A point inside a body: between its middle and a vertex.
fn inside(body: &ConvexPolyhedron, random: &mut Random) -> DVec3 {
    let vertices = body.vertices();
    let middle = vertices.iter().sum::<DVec3>() / vertices.len() as f64;
    middle.lerp(vertices[random.index(vertices.len())], 0.95 * random.unit().sqrt())
}

/// `min_Q n.q - max_P n.p` for bodies turned about the origin.
fn gap_along(
    normal: DVec3,
    (p, turn_p): (&ConvexPolyhedron, DQuat),
    (q, turn_q): (&ConvexPolyhedron, DQuat),
) -> f64 {
    let extreme = |body: &ConvexPolyhedron, direction: DVec3| {
        body.vertices().iter().map(|v| direction.dot(*v)).fold(f64::NEG_INFINITY, f64::max)
    };
    -extreme(q, turn_q.inverse() * -normal) - extreme(p, turn_p.inverse() * normal)
}

#[cfg(test)]
mod tests {
    use colltrans::{Outcome, cast};

    use super::*;
    use crate::shapes::{Kind, bodies};

    #[test]
    fn bodies_meet_or_pass_as_asked() {
        for kind in [Kind::Balanced, Kind::Thin] {
            let bodies = bodies(5, kind, 200, 0);
            let mut random = Random::new(5, &[]);
            for meeting in [Meeting::Colliding, Meeting::Passing(0.005), Meeting::Passing(1.5)] {
                for _ in 0..100 {
                    let s = Setting::draw(&bodies, meeting, &mut random);
                    let [p, q] = &bodies.pair;
                    let outcome = cast(p, &s.moving, q, &s.fixed, s.direction).unwrap();
                    match (meeting, outcome) {
                        (Meeting::Colliding, Outcome::Contact(contact)) => {
                            assert!(contact.translation >= 0.049 * bodies.diameter);
                        }
                        (Meeting::Passing(_), Outcome::Separated(_)) => {}
                        (meeting, outcome) => panic!("{meeting:?}: {outcome:?}"),
                    }
                }
            }
        }
    }

    #[test]
    fn steps_of_sequences_move_points_by_delta() {
        let bodies = bodies(5, Kind::Spheres, 200, 0);
        let mut random = Random::new(6, &[]);
        for _ in 0..30 {
            let settings = Setting::sequence(&bodies, Meeting::Colliding, 0.01, 5, &mut random);
            for pair in settings.windows(2) {
                let moved = |v: &DVec3| {
                    pair[1].moving.transform_point(*v).distance(pair[0].moving.transform_point(*v))
                };
                let most = bodies.pair[0].vertices().iter().map(moved).fold(0.0, f64::max);
                assert!((most / (0.01 * bodies.diameter) - 1.0).abs() < 0.05, "{most}");
            }
        }
    }
}
