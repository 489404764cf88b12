//! Settings to measure: bodies in random orientations that collide, or pass each other, by
//! construction.

use colltrans::{ConvexPolyhedron, Options, Outcome, Pose, QueryError, Solver};
use colltrans_oracle::settings::Rng;
use glam::{DQuat, DVec3};

/// Whether the bodies of a row meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Meeting {
    /// They do.
    Colliding,
    /// Their shadows are apart.
    Separated,
}

impl Meeting {
    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Colliding => "colliding",
            Self::Separated => "separated",
        }
    }
}

/// Two bodies of a list, their poses and a unit direction.
#[derive(Debug, Clone, Copy)]
pub struct Setting {
    /// Which body moves.
    pub moving: usize,
    /// Which body stands.
    pub fixed: usize,
    /// Its pose at the start.
    pub moving_pose: Pose,
    /// The other's pose.
    pub fixed_pose: Pose,
    /// The direction.
    pub direction: DVec3,
}

impl Setting {
    /// A random setting of bodies that are apart at the start.
    ///
    /// # Panics
    /// If there are no bodies, or their vertices are out of range.
    pub fn draw(bodies: &[ConvexPolyhedron], meeting: Meeting, rng: &mut Rng) -> Self {
        let index = |rng: &mut Rng| rng.int(0, bodies.len() as i64 - 1) as usize;
        let (moving, fixed) = (index(rng), index(rng));
        let (p, q) = (&bodies[moving], &bodies[fixed]);
        let (turn_p, turn_q) = (rng.rotation(), rng.rotation());
        let direction = rng.direction();
        let lateral = direction.cross(rng.direction()).normalize();
        // First so that a point inside P is opposite to one inside Q.
        let mut offset = turn_p * inside(p, rng) - turn_q * inside(q, rng);
        if meeting == Meeting::Separated {
            let gap = 10.0_f64.powf(rng.range(-3.0, -0.3));
            let overlap = distance_along(lateral, (p, turn_p), (q, turn_q)) + offset.dot(lateral);
            offset += lateral * (gap - overlap);
        }
        let ahead = distance_along(direction, (p, turn_p), (q, turn_q)) + offset.dot(direction);
        offset += direction * (rng.range(0.5, 3.0) - ahead);
        let pose = |rotation, at| Pose::new(rotation, at).expect("a rotation");
        Self {
            moving,
            fixed,
            moving_pose: pose(turn_p, DVec3::ZERO),
            fixed_pose: pose(turn_q, offset),
            direction,
        }
    }

    /// Asks `colltrans`.
    ///
    /// # Errors
    /// As [`colltrans::cast_with`].
    pub fn cast(&self, bodies: &[ConvexPolyhedron], solver: Solver) -> Result<Outcome, QueryError> {
        colltrans::cast_with(
            &bodies[self.moving],
            &self.moving_pose,
            &bodies[self.fixed],
            &self.fixed_pose,
            self.direction,
            &Options { solver, ..Options::default() },
        )
    }
}

/// A point inside a body: between its middle and a vertex.
fn inside(body: &ConvexPolyhedron, rng: &mut Rng) -> DVec3 {
    let vertices = body.vertices();
    let middle = vertices.iter().sum::<DVec3>() / vertices.len() as f64;
    let vertex = vertices[rng.int(0, vertices.len() as i64 - 1) as usize];
    middle.lerp(vertex, 0.95 * rng.unit().sqrt())
}

/// `min_Q n.q - max_P n.p` for bodies turned about the origin.
fn distance_along(
    normal: DVec3,
    (p, turn_p): (&ConvexPolyhedron, DQuat),
    (q, turn_q): (&ConvexPolyhedron, DQuat),
) -> f64 {
    let extreme = |body: &ConvexPolyhedron, direction: DVec3| {
        body.vertices().iter().map(|v| direction.dot(*v)).fold(f64::NEG_INFINITY, f64::max)
    };
    -extreme(q, turn_q.inverse() * -normal) - extreme(p, turn_p.inverse() * normal)
}
