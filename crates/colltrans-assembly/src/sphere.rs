//! Directions on the unit sphere: normalisation, angles, and samples by subdivision of an icosahedron.
//!
//! Invariant: a vertex is the normalised midpoint of an edge, and is stored once for each edge. Adjacent triangles
//! share its bits.

use std::collections::HashMap;

use glam::DVec3;

use crate::error::AssemblyError;

/// A hierarchy of triangles that covers the sphere.
#[derive(Debug, Clone)]
pub struct Sphere {
    /// The vertices, directions of length 1.
    pub directions: Vec<DVec3>,
    /// The triangles; the first 20 are those of the icosahedron.
    pub triangles: Vec<SphereTriangle>,
    middles: HashMap<[u32; 2], u32>,
}

/// A spherical triangle.
#[derive(Debug, Clone, Copy)]
pub struct SphereTriangle {
    /// Indices of its corners, counter-clockwise from outside.
    pub corners: [u32; 3],
    /// Index of the first of its four consecutive parts; 0 if it is not subdivided.
    pub first_child: u32,
}

impl Sphere {
    /// Builds the icosahedron with each triangle subdivided `levels` times. It has `10 * 4^levels + 2` directions.
    pub fn new(levels: u32) -> Self {
        let (directions, corners) = icosahedron();
        let triangles =
            corners.iter().map(|&corners| SphereTriangle { corners, first_child: 0 }).collect();
        let mut sphere = Self { directions, triangles, middles: HashMap::new() };
        for _ in 0..levels {
            let leaves: Vec<usize> = sphere.leaf_triangles().collect();
            for t in leaves {
                sphere.subdivide(t);
            }
        }
        sphere
    }

    /// Builds the coarsest sphere with at least `count` directions, up to 9 levels.
    pub fn with_directions(count: usize) -> Self {
        let mut levels = 0;
        while 10 * 4_usize.pow(levels) + 2 < count && levels < 9 {
            levels += 1;
        }
        Self::new(levels)
    }

    /// Returns the triangles that are not subdivided.
    pub fn leaf_triangles(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.triangles.len()).filter(|&t| self.triangles[t].first_child == 0)
    }

    /// Subdivides a triangle into four, unless it is subdivided already.
    pub fn subdivide(&mut self, triangle: usize) {
        if self.triangles[triangle].first_child != 0 {
            return;
        }
        let [a, b, c] = self.triangles[triangle].corners;
        let (ab, bc, ca) =
            (self.edge_midpoint(a, b), self.edge_midpoint(b, c), self.edge_midpoint(c, a));
        self.triangles[triangle].first_child = self.triangles.len() as u32;
        for corners in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
            self.triangles.push(SphereTriangle { corners, first_child: 0 });
        }
    }

    fn edge_midpoint(&mut self, a: u32, b: u32) -> u32 {
        let next = self.directions.len() as u32;
        let index = *self.middles.entry([a.min(b), a.max(b)]).or_insert(next);
        if index == next {
            let sum = self.directions[a as usize] + self.directions[b as usize];
            self.directions.push(sum.normalize());
        }
        index
    }

    /// Returns the undivided triangle that contains a direction, and the barycentric weights of its corners.
    pub fn locate(&self, d: DVec3) -> (usize, DVec3) {
        let nearest = |range: std::ops::Range<usize>| {
            range
                .map(|t| (t, self.corner_weights(t, d)))
                .max_by(|x, y| x.1.min_element().total_cmp(&y.1.min_element()))
                .unwrap_or((0, DVec3::X))
        };
        let mut best = nearest(0..20);
        while self.triangles[best.0].first_child != 0 {
            let first = self.triangles[best.0].first_child as usize;
            best = nearest(first..first + 4);
        }
        best
    }

    fn corner_weights(&self, triangle: usize, d: DVec3) -> DVec3 {
        let [a, b, c] = self.triangles[triangle].corners.map(|k| self.directions[k as usize]);
        let weights = DVec3::new(d.dot(b.cross(c)), d.dot(c.cross(a)), d.dot(a.cross(b)));
        let sum = weights.element_sum();
        // Directions on the opposite side get weights below all others.
        if sum > 0.0 { weights / sum } else { DVec3::splat(-1e9) }
    }

    /// Returns the angle of a triangle's longest side, in radians.
    pub fn longest_side(&self, triangle: usize) -> f64 {
        let [a, b, c] = self.triangles[triangle].corners.map(|k| self.directions[k as usize]);
        angle_between(a, b).max(angle_between(b, c)).max(angle_between(c, a))
    }

    /// Returns the solid angle of a triangle.
    pub fn solid_angle(&self, triangle: usize) -> f64 {
        let [a, b, c] = self.triangles[triangle].corners.map(|k| self.directions[k as usize]);
        let volume = a.dot(b.cross(c));
        2.0 * volume.atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
    }
}

/// Returns the direction with length 1. Directions of axes keep their exact components.
///
/// # Errors
/// Returns an error if a component is not finite, or if all are below `colltrans::MIN_MAGNITUDE` in
/// magnitude.
pub fn normalized_direction(direction: DVec3) -> Result<DVec3, AssemblyError> {
    let scale = direction.abs().max_element();
    let sound = scale.is_finite() && scale >= colltrans::MIN_MAGNITUDE;
    let scaled = if sound { direction / scale } else { DVec3::ZERO };
    let refused = AssemblyError::InvalidDirection { direction: direction.to_array() };
    scaled.try_normalize().filter(|d| d.is_finite()).ok_or(refused)
}

/// Returns the angle between two vectors of length 1, in radians. It is accurate for small angles too.
pub fn angle_between(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

fn icosahedron() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let golden = f64::midpoint(1.0, 5.0_f64.sqrt());
    let mut directions = Vec::with_capacity(12);
    for axis in 0..3 {
        for (u, v) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
            let mut d = DVec3::ZERO;
            (d[axis], d[(axis + 1) % 3]) = (u, golden * v);
            directions.push(d.normalize());
        }
    }
    // Faces are triples of neighbours, whose dot product is 1 / sqrt(5), oriented outwards.
    let close = |a: usize, b: usize| directions[a].dot(directions[b]) > 0.4;
    let mut faces = Vec::with_capacity(20);
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if close(a, b) && close(b, c) && close(c, a) {
                    let out = directions[a].dot(directions[b].cross(directions[c])) > 0.0;
                    let [b, c] = if out { [b, c] } else { [c, b] };
                    faces.push([a as u32, b as u32, c as u32]);
                }
            }
        }
    }
    (directions, faces)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn triangles_of_all_levels_have_the_area_of_the_sphere() {
        for levels in 0..4 {
            let sphere = Sphere::new(levels);
            assert_eq!(sphere.directions.len(), 10 * 4_usize.pow(levels) + 2);
            let area: f64 = sphere.leaf_triangles().map(|t| sphere.solid_angle(t)).sum();
            assert!((area - 4.0 * PI).abs() < 1e-12, "{area}");
        }
    }

    #[test]
    fn located_triangle_contains_the_direction() {
        let mut sphere = Sphere::new(2);
        let t = sphere.locate(DVec3::new(0.3, 0.2, 0.9).normalize()).0;
        sphere.subdivide(t);
        let mut random = colltrans_testkit::random::Random::new(3);
        for _ in 0..1_000 {
            let d = random.direction();
            let (t, weights) = sphere.locate(d);
            assert!(weights.min_element() > -1e-12);
            let corners = sphere.triangles[t].corners.map(|k| sphere.directions[k as usize]);
            let back = corners[0] * weights.x + corners[1] * weights.y + corners[2] * weights.z;
            assert!(angle_between(back.normalize(), d) < 1e-12);
        }
    }
}
