//! Converts bodies and settings for `parry3d-f64`.

use colltrans::{ConvexPolyhedron, Pose};
use colltrans_lab::settings::{Meeting, Setting};
use colltrans_lab::shapes::Bodies;
use colltrans_testkit::random::Random;
use colltrans_testkit::timing::Stopwatch;
use glam::DVec3;
use parry3d_f64::math as parry_math;
use parry3d_f64::query::{self, ShapeCastOptions, cast_shapes};
pub use parry3d_f64::shape::ConvexPolyhedron as ParryPolyhedron;
use parry3d_f64::shape::{Compound, Shape, SharedShape, TriMesh};

use crate::times::Times;

/// Converts a body, with its faces cut into fans of triangles; `None` if parry rejects it.
pub fn convert_body(body: &ConvexPolyhedron) -> Option<ParryPolyhedron> {
    let points = body.vertices().iter().map(|v| convert_vector(*v)).collect();
    let mut triangles = Vec::new();
    for face in 0..body.face_count() as u32 {
        let mut corners = body.face_vertices(face);
        let (first, mut second) = (corners.next()?, corners.next()?);
        for third in corners {
            triangles.push([first, second, third]);
            second = third;
        }
    }
    ParryPolyhedron::from_convex_mesh(points, &triangles)
}

/// Poses and a direction in parry's types, converted before the clock starts.
#[derive(Debug, Clone, Copy)]
pub struct ParrySetting {
    poses: [parry_math::Pose; 2],
    velocity: parry_math::Vector,
}

impl ParrySetting {
    /// Converts a setting.
    pub fn new(setting: &Setting) -> Self {
        Self::from_poses([&setting.moving, &setting.fixed], setting.direction)
    }

    /// Converts the poses of the moving and of the fixed body, and a direction.
    pub fn from_poses(poses: [&Pose; 2], direction: DVec3) -> Self {
        Self { poses: poses.map(convert_pose), velocity: convert_vector(direction) }
    }

    /// Returns parry's distance; 0 if the bodies overlap.
    pub fn distance(&self, moving: &dyn Shape, fixed: &dyn Shape) -> Option<f64> {
        let [a, b] = &self.poses;
        query::distance(a, moving, b, fixed).ok().map(|found| found.distance)
    }

    /// Returns parry's penetration depth.
    pub fn depth(&self, moving: &dyn Shape, fixed: &dyn Shape) -> Option<f64> {
        let [a, b] = &self.poses;
        query::contact(a, moving, b, fixed, 0.0).ok()?.map(|contact| -contact.dist)
    }

    /// Returns parry's time of impact, if there is one.
    pub fn cast(&self, moving: &dyn Shape, fixed: &dyn Shape) -> Option<f64> {
        let options = ShapeCastOptions {
            compute_impact_geometry_on_penetration: false,
            ..ShapeCastOptions::default()
        };
        let still = parry_math::Vector::ZERO;
        let [a, b] = &self.poses;
        cast_shapes(a, self.velocity, moving, b, still, fixed, options)
            .ok()?
            .map(|hit| hit.time_of_impact)
    }
}

/// A reference measurement: parry's casts of two bodies with 8 vertices, measured along with every row. Changes
/// of the machine's speed affect it like our queries.
pub struct ReferenceCasts {
    bodies: [ParryPolyhedron; 2],
    settings: Vec<ParrySetting>,
}

impl ReferenceCasts {
    /// Draws `settings` settings in which the bodies collide.
    ///
    /// # Panics
    /// If parry rejects a body.
    pub fn new(small: &Bodies, settings: usize, random: &mut Random) -> Self {
        let mut draw = || ParrySetting::new(&Setting::draw(small, Meeting::Colliding, random));
        let settings = (0..settings).map(|_| draw()).collect();
        let convert = |small| convert_body(small).expect("a body that parry takes");
        Self { bodies: small.pair.each_ref().map(convert), settings }
    }

    /// Measures every setting once.
    pub fn measure(&self, times: &mut Times) {
        let stopwatch = Stopwatch::new();
        let [moving, fixed] = &self.bodies;
        for setting in &self.settings {
            times.add(stopwatch.time(|| setting.cast(moving, fixed)).1);
        }
    }
}

/// Converts a vector.
pub fn convert_vector(v: DVec3) -> parry_math::Vector {
    parry_math::Vector::from_array(v.to_array())
}

/// Converts a pose.
fn convert_pose(pose: &Pose) -> parry_math::Pose {
    let rotation = parry_math::Rotation::from_array(pose.rotation().to_array());
    parry_math::Pose::from_parts(convert_vector(pose.translation()), rotation)
}

/// Builds a triangle mesh with its tree.
///
/// # Panics
/// If there are no triangles.
pub fn triangle_mesh(vertices: &[DVec3], triangles: &[[u32; 3]]) -> TriMesh {
    let points = vertices.iter().map(|v| convert_vector(*v)).collect();
    TriMesh::new(points, triangles.to_vec()).expect("triangles")
}

/// Builds a compound of boxes at these poses, with its tree. `half` returns the half-sides of a box by number.
///
/// # Panics
/// If there are no poses.
pub fn compound(poses: &[Pose], half: impl Fn(usize) -> DVec3) -> Compound {
    let boxed = |(k, at): (usize, &Pose)| {
        let half = half(k);
        (convert_pose(at), SharedShape::cuboid(half.x, half.y, half.z))
    };
    Compound::new(poses.iter().enumerate().map(boxed).collect())
}

/// A body that spins about a uniformly moving point, and a body at rest, in parry's types.
pub struct Spin {
    moving: query::NonlinearRigidMotion,
    fixed: query::NonlinearRigidMotion,
}

impl Spin {
    /// Converts the motion; the point and both velocities are in the world.
    pub fn new(start: &Pose, center: DVec3, velocity: DVec3, spin: DVec3, there: &Pose) -> Self {
        let own = start.matrix().transpose() * (center - start.translation());
        let moving = query::NonlinearRigidMotion::new(
            convert_pose(start),
            convert_vector(own),
            convert_vector(velocity),
            convert_vector(spin),
        );
        Self { moving, fixed: query::NonlinearRigidMotion::constant_position(convert_pose(there)) }
    }

    /// Returns parry's time of impact from 0 to 1, if there is one.
    pub fn cast(&self, moving: &dyn Shape, fixed: &dyn Shape) -> Option<f64> {
        query::cast_shapes_nonlinear(&self.moving, moving, &self.fixed, fixed, 0.0, 1.0, true)
            .ok()?
            .map(|hit| hit.time_of_impact)
    }
}
