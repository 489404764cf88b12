//! Settings: two poses and a direction for bodies that meet, or that pass each other at a known distance, by
//! construction.
//!
//! - `D` is the diameter of the bodies.
//! - The *least distance* is that of the bodies during the motion along the direction. It equals the distance
//!   of their shadows (`shadow`) and has the requested value up to rounding.
//! - The *gap ahead* is the distance by which a plane perpendicular to the direction separates the bodies at
//!   the start. The paper does not state it. Here it is uniform between 0.05 and 1 `D`, for sequences between
//!   0.75 and 1.25 `D`, so that the motion causes no overlap.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use colltrans::{Cast, ConvexPolyhedron, Options, Pose, QueryError};
use glam::{DQuat, DVec2, DVec3};

use crate::shadow::Shadow;
use crate::shapes::Bodies;
use colltrans_testkit::random::Random;

/// Poses of the bodies, and the direction of motion.
#[derive(Debug, Clone, Copy)]
pub struct Setting {
    /// The moving body's pose at the start.
    pub moving: Pose,
    /// The fixed body's pose.
    pub fixed: Pose,
    /// Direction of length 1.
    pub direction: DVec3,
}

/// Whether the bodies meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Meeting {
    /// The bodies meet.
    Colliding,
    /// The bodies pass with this least distance, in `D`.
    Passing(f64),
    /// The bodies pass with a uniformly distributed least distance up to this one, in `D`.
    PassingWithin(f64),
}

/// Motion of a body from setting to setting.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// Displacement.
    Translation,
    /// Rotation about the centre.
    Rotation,
    /// Both, along and about one axis.
    Screw,
}

/// All motions.
pub const MOTIONS: [Motion; 3] = [Motion::Translation, Motion::Rotation, Motion::Screw];

/// Minimum and maximum of the gap ahead, in `D`.
const AHEAD: [f64; 2] = [0.05, 1.0];
/// Minimum and maximum of the gap ahead of sequences, in `D`.
const AHEAD_OF_SEQUENCES: [f64; 2] = [0.75, 1.25];

impl Setting {
    /// Returns the query about two bodies.
    ///
    /// # Errors
    /// Those of [`Cast::new`] and [`Cast::with_options`].
    #[inline]
    pub fn cast<'a>(&self, bodies: &'a Bodies, options: &Options) -> Result<Cast<'a>, QueryError> {
        let [moving, fixed] = &bodies.pair;
        Cast::new(moving.at(self.moving), fixed.at(self.fixed), self.direction)?
            .with_options(*options)
    }

    /// Draws a random setting of bodies that are apart at the start, in random orientations.
    ///
    /// # Panics
    /// If the bodies are out of the range of poses.
    pub fn draw(bodies: &Bodies, meeting: Meeting, random: &mut Random) -> Self {
        Self::draw_ahead(bodies, meeting, AHEAD, random)
    }

    /// Draws a random setting with a range of the gap ahead.
    fn draw_ahead(bodies: &Bodies, meeting: Meeting, ahead: [f64; 2], random: &mut Random) -> Self {
        let [p, q] = &bodies.pair;
        let (turn_p, turn_q) = (random.rotation(), random.rotation());
        let direction = random.direction();
        let lateral = direction.cross(random.direction()).normalize();
        // Places the bodies such that a point inside P is opposite to one inside Q.
        let [inside_p, inside_q] = [0, 1].map(|k| random_interior_point(bodies, k, random));
        let mut offset = turn_p * inside_p - turn_q * inside_q;
        let least_distance = match meeting {
            Meeting::Colliding => None,
            Meeting::Passing(gap) => Some(gap),
            Meeting::PassingWithin(most) => Some(random.range(0.0, most)),
        };
        if let Some(gap) = least_distance {
            let plane = [lateral, direction.cross(lateral)];
            let [p, q] = [(p, turn_p), (q, turn_q)].map(|(b, turn)| Shadow::of(b, turn, plane));
            let here = DVec2::from_array(plane.map(|axis| axis.dot(offset)));
            let way = DVec2::X;
            offset += lateral
                * p.differences(&q.displaced(here)).ray_to_distance(-way, gap * bodies.diameter);
        }
        let now = gap_along(direction, (p, turn_p), (q, turn_q)) + offset.dot(direction);
        offset += direction * (random.range(ahead[0], ahead[1]) * bodies.diameter - now);
        Self { moving: pose(turn_p, DVec3::ZERO), fixed: pose(turn_q, offset), direction }
    }

    /// Returns the setting with the moving body displaced along the direction, in world units.
    ///
    /// # Panics
    /// If the body leaves the range of poses.
    #[must_use]
    pub fn advanced(&self, by: f64) -> Self {
        let moving = self.moving.translated_by(self.direction * by).expect("a few diameters");
        Self { moving, ..*self }
    }

    /// Draws `count` settings about a random one, each `delta` diameters from the next: the moving body is
    /// displaced, rotated about its centre, or moved along a screw.
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
        let middle = Self::draw_ahead(bodies, meeting, AHEAD_OF_SEQUENCES, random);
        let motion = MOTIONS[random.index(3)];
        middle.along_motion(bodies, motion, delta, count, random)
    }

    /// Draws a sequence like [`sequence`](Self::sequence), of bodies that meet, with this kind of motion.
    ///
    /// # Panics
    /// If the bodies are out of the range of poses.
    pub fn sequence_of(
        bodies: &Bodies,
        motion: Motion,
        delta: f64,
        count: usize,
        random: &mut Random,
    ) -> Vec<Self> {
        let middle = Self::draw_ahead(bodies, Meeting::Colliding, AHEAD_OF_SEQUENCES, random);
        middle.along_motion(bodies, motion, delta, count, random)
    }

    /// Returns settings along a motion, with this setting in the middle.
    fn along_motion(
        &self,
        bodies: &Bodies,
        motion: Motion,
        delta: f64,
        count: usize,
        random: &mut Random,
    ) -> Vec<Self> {
        let axis = random.direction();
        let [displaced, turned] = match motion {
            Motion::Translation => [1.0, 0.0],
            Motion::Rotation => [0.0, 1.0],
            Motion::Screw => [FRAC_1_SQRT_2; 2],
        };
        (0..count)
            .map(|k| {
                let by = delta * (k as f64 - 0.5 * (count - 1) as f64);
                // A point at half a diameter from the axis moves by `delta` diameters.
                let turn = DQuat::from_axis_angle(axis, 2.0 * by * turned);
                let rotation = (turn * self.moving.rotation()).normalize();
                Self { moving: pose(rotation, axis * (by * displaced * bodies.diameter)), ..*self }
            })
            .collect()
    }

    /// Draws the paper's motion of variable coherence (section V-E) for spheres. The moving sphere orbits the
    /// fixed one, directed at a point near it, and rotates about an axis of its own by the same `alpha_deg`
    /// in each step. The spheres always meet, because lines of motion pass the fixed centre at no more than
    /// three quarters of the sum of both radii.
    ///
    /// The settings are given in a frame that rotates along, so that all directions are similar. A
    /// [`Tracker`](colltrans::Tracker) stores the solutions of opposite directions separately. Otherwise it
    /// would start with the solution before the last one, which at 180 degrees is that of the same
    /// configuration.
    ///
    /// # Panics
    /// Never, because the poses are in range.
    pub fn orbit(bodies: &Bodies, alpha_deg: f64, count: usize, random: &mut Random) -> Vec<Self> {
        let (axis, spin_axis) = (random.direction(), random.direction());
        let start = axis.any_orthonormal_vector() * (2.0 * bodies.diameter);
        let aim = random.direction() * (random.range(0.0, 0.75) * bodies.diameter);
        let (turn_p, turn_q) = (random.rotation(), random.rotation());
        (0..count)
            .map(|k| {
                let angle_rad = alpha_deg * PI / 180.0 * k as f64;
                let back = DQuat::from_axis_angle(axis, -angle_rad);
                let spin = DQuat::from_axis_angle(spin_axis, angle_rad);
                Self {
                    moving: pose((back * spin * turn_p).normalize(), start),
                    fixed: pose((back * turn_q).normalize(), DVec3::ZERO),
                    direction: (back * aim - start).normalize(),
                }
            })
            .collect()
    }
}

/// Creates a pose.
fn pose(rotation: DQuat, translation: DVec3) -> Pose {
    Pose::new(rotation, translation).expect("a rotation, and a translation of a few diameters")
}

/// Returns a random point inside a body, between its centre and a vertex.
fn random_interior_point(bodies: &Bodies, which: usize, random: &mut Random) -> DVec3 {
    let vertices = bodies.pair[which].vertices();
    let middle = bodies.middles[which];
    middle.lerp(vertices[random.index(vertices.len())], 0.95 * random.unit().sqrt())
}

/// Returns `min_Q n.q - max_P n.p` for bodies rotated about the origin.
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
    fn bodies_meet_or_pass_as_requested() {
        for kind in [Kind::Balanced, Kind::Thin] {
            let bodies = bodies(5, kind, 200, 0);
            let mut random = Random::new(5);
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
    fn settings_of_orbits_collide() {
        let bodies = bodies(5, Kind::Spheres, 200, 0);
        let mut random = Random::new(7);
        for alpha_deg in [0.1, 30.0, 180.0] {
            for _ in 0..20 {
                let orbit = Setting::orbit(&bodies, alpha_deg, 20, &mut random);
                assert!(orbit.windows(2).all(|s| s[0].direction.dot(s[1].direction) > 0.0));
                for s in orbit {
                    let [p, q] = &bodies.pair;
                    let outcome = cast(p, &s.moving, q, &s.fixed, s.direction).unwrap();
                    assert!(matches!(outcome, Outcome::Contact(_)), "{outcome:?}");
                }
            }
        }
    }

    #[test]
    fn sequence_steps_move_points_by_delta() {
        let bodies = bodies(5, Kind::Spheres, 200, 0);
        let mut random = Random::new(6);
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
