//! Rounded bodies: a convex polyhedron, the *core*, swept by a ball.
//!
//! Notation: the body is `K + B(r)`, the Minkowski sum of the core `K` and a ball of radius `r`. Its support along a
//! unit vector `n` is that of `K`, farther by `r`. Therefore the distance of two bodies is that of their cores, less
//! both radii, and each query about rounded bodies is a query about the cores with a gap.

use std::f64::consts::PI;

use glam::DVec3;

use super::ConvexPolyhedron;
use crate::body::error::BuildError;
use colltrans_kernel::range::{MAX_MAGNITUDE, MIN_MAGNITUDE};

impl ConvexPolyhedron {
    /// Returns the body swept by a ball: all points at a distance of at most `radius` from it. A body that is already
    /// rounded is rounded further, by the rounded sum of the radii.
    ///
    /// The vertices, faces and features of the result are those of the core, the body without radius. A point becomes
    /// a sphere, a segment a capsule, a box a rounded box. The mathematical shape is exact: nothing is tessellated.
    ///
    /// # Errors
    /// [`BuildError::Radius`] if the radius is negative, not finite or outside the exact range, or without the feature
    /// `min-gap` not 0.
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::{Cast, ConvexPolyhedron, Outcome, Pose};
    ///
    /// // A ball of radius 1 falls onto the edge of a box with rounded edges.
    /// let ball = ConvexPolyhedron::sphere(DVec3::ZERO, 1.0)?;
    /// let table = ConvexPolyhedron::cuboid(DVec3::splat(-2.0), DVec3::splat(2.0))?.rounded(0.25)?;
    /// let start = Pose::from_translation(DVec3::new(2.75, 0.0, 10.0))?;
    /// let cast = Cast::new(ball.at(start), table.at(Pose::IDENTITY), DVec3::NEG_Z)?;
    /// let Outcome::Contact(contact) = cast.first_contact()? else {
    ///     unreachable!("it hits the rounded edge")
    /// };
    /// // At a height of 2 + sqrt(1.25^2 - 0.75^2) = 3.
    /// assert!((contact.translation - 7.0).abs() < 1e-12);
    /// assert!(cast.verify(&contact.certificate)? < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn rounded(self, radius: f64) -> Result<Self, BuildError> {
        let sum = self.radius + radius;
        let most = if cfg!(feature = "min-gap") { MAX_MAGNITUDE } else { 0.0 };
        let is_sound = radius == 0.0 || (MIN_MAGNITUDE..=most).contains(&radius);
        if !is_sound || sum > most {
            return Err(BuildError::Radius { radius });
        }
        // Data that other crates derive from the body do not fit the new one.
        Ok(Self { radius: sum, kept: crate::body::DerivedDataSlot::default(), ..self })
    }

    /// Builds a sphere: a point with a radius.
    ///
    /// # Errors
    /// A center that is not finite or out of range, and the errors of [`Self::rounded`].
    pub fn sphere(center: DVec3, radius: f64) -> Result<Self, BuildError> {
        Self::from_points(&[center])?.rounded(radius)
    }

    /// Builds a capsule: a segment with a radius. It is a sphere if both ends coincide.
    ///
    /// # Errors
    /// An end that is not finite or out of range, and the errors of [`Self::rounded`].
    pub fn capsule(ends: [DVec3; 2], radius: f64) -> Result<Self, BuildError> {
        Self::from_points(&ends)?.rounded(radius)
    }

    /// Returns the radius of the ball that sweeps the body, in the unit of the input; 0 unless it is
    /// [rounded](Self::rounded).
    #[inline]
    pub fn radius(&self) -> f64 {
        // Without the feature no body is rounded, and the compiler removes code that only a radius reaches.
        if cfg!(feature = "min-gap") { self.radius } else { 0.0 }
    }

    /// Returns the volume that rounding adds to that of the core (Steiner's formula): the area times `r`, the edges'
    /// sectors of cylinders, and the vertices' sectors of spheres.
    pub(super) fn volume_of_rounding(&self) -> f64 {
        let r = self.radius;
        if r == 0.0 {
            return 0.0;
        }
        let vertices = &self.vertices;
        let ball = 4.0 / 3.0 * PI * r * r * r;
        match self.dimension {
            0 => ball,
            1 => ball + PI * r * r * vertices[0].distance(vertices[1]),
            _ => {
                let normals: Vec<DVec3> =
                    (0..self.face_count() as u32).map(|face| self.face_normal(face)).collect();
                let mut area = 0.0;
                // Sum of length times exterior angle, over all half-edges: twice that over the edges.
                let mut edges = 0.0;
                for face in 0..self.face_count() as u32 {
                    let normal = normals[face as usize];
                    let corners: Vec<DVec3> =
                        self.face_vertices(face).map(|v| vertices[v as usize]).collect();
                    for k in 0..corners.len() {
                        let [a, b] = [corners[k], corners[(k + 1) % corners.len()]];
                        area += 0.5 * normal.dot((a - corners[0]).cross(b - corners[0]));
                    }
                    for (half_edge, k) in self.face_half_edges(face).zip(0..) {
                        let [a, b] = [corners[k], corners[(k + 1) % corners.len()]];
                        let across = self.topology.half_edges()[half_edge as usize].twin;
                        let other =
                            normals[self.topology.half_edges()[across as usize].face as usize];
                        let angle = normal.cross(other).length().atan2(normal.dot(other));
                        edges += a.distance(b) * angle;
                    }
                }
                area * r + 0.25 * edges * r * r + ball
            }
        }
    }
}
