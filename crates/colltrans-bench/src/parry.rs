//! The same bodies and settings in `parry3d-f64`.

use colltrans::{ConvexPolyhedron, Pose};
use colltrans_lab::settings::Setting;
use glam::DVec3;
use parry3d_f64::math as parry_math;
use parry3d_f64::query::{ShapeCastOptions, cast_shapes};
use parry3d_f64::shape::{ConvexPolyhedron as ParryPolyhedron, TriMesh};

/// Our vertices and faces, the latter cut into fans of triangles; `None` if parry refuses them.
pub fn body(body: &ConvexPolyhedron) -> Option<ParryPolyhedron> {
    let points = body.vertices().iter().map(|v| vector(*v)).collect();
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

/// A setting in parry's types, converted before the clock starts.
#[derive(Debug, Clone, Copy)]
pub struct ParrySetting {
    moving_pose: parry_math::Pose,
    fixed_pose: parry_math::Pose,
    velocity: parry_math::Vector,
}

impl ParrySetting {
    /// Converts.
    pub fn new(setting: &Setting) -> Self {
        Self {
            moving_pose: pose(&setting.moving),
            fixed_pose: pose(&setting.fixed),
            velocity: vector(setting.direction),
        }
    }

    /// Asks parry: the time of impact, if there is one.
    pub fn cast(&self, moving: &ParryPolyhedron, fixed: &ParryPolyhedron) -> Option<f64> {
        let options = ShapeCastOptions {
            compute_impact_geometry_on_penetration: false,
            ..ShapeCastOptions::default()
        };
        let still = parry_math::Vector::ZERO;
        cast_shapes(
            &self.moving_pose,
            self.velocity,
            moving,
            &self.fixed_pose,
            still,
            fixed,
            options,
        )
        .ok()?
        .map(|hit| hit.time_of_impact)
    }
}

fn vector(v: DVec3) -> parry_math::Vector {
    parry_math::Vector::from_array(v.to_array())
}

fn pose(pose: &Pose) -> parry_math::Pose {
    let rotation = parry_math::Rotation::from_array(pose.rotation().to_array());
    parry_math::Pose::from_parts(vector(pose.translation()), rotation)
}

/// A triangle mesh with its tree.
pub struct TriangleMesh(TriMesh);

impl TriangleMesh {
    /// From our vertices and triangles.
    ///
    /// # Panics
    /// If there are no triangles.
    pub fn new(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Self {
        let points = vertices.iter().map(|v| vector(*v)).collect();
        Self(TriMesh::new(points, triangles.to_vec()).expect("triangles"))
    }
}

/// Poses and a direction in parry's types, converted before the clock starts.
#[derive(Debug, Clone, Copy)]
pub struct Placed {
    poses: [parry_math::Pose; 2],
    velocity: parry_math::Vector,
}

impl Placed {
    /// Converts.
    pub fn new(poses: [&Pose; 2], direction: DVec3) -> Self {
        Self { poses: poses.map(pose), velocity: vector(direction) }
    }

    /// Asks parry: the time of impact, if there is one.
    pub fn cast(&self, moving: &TriangleMesh, fixed: &TriangleMesh) -> Option<f64> {
        let options = ShapeCastOptions {
            compute_impact_geometry_on_penetration: false,
            ..ShapeCastOptions::default()
        };
        let still = parry_math::Vector::ZERO;
        let [a, b] = &self.poses;
        cast_shapes(a, self.velocity, &moving.0, b, still, &fixed.0, options)
            .ok()?
            .map(|hit| hit.time_of_impact)
    }
}
