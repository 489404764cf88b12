//! Builds meshes for measurements, of about unit size, mostly centred at the origin.
//!
//! Notation. A *ring body* has `rings` parallels of `around` vertices each between two poles.

use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::random::Random;

/// Vertices, and faces that are counter-clockwise seen from outside. Without faces, the mesh represents the
/// convex hull of its vertices.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// The vertices.
    pub vertices: Vec<DVec3>,
    /// The faces, as lists of vertices. Trapezoids are flat up to rounding.
    pub faces: Vec<Vec<u32>>,
}

impl Mesh {
    /// Builds a mesh without faces.
    pub fn of_points(vertices: Vec<DVec3>) -> Self {
        Self { vertices, faces: Vec::new() }
    }

    /// Returns the image under a map that preserves the orientation and flat faces.
    #[must_use]
    pub fn mapped(mut self, map: impl Fn(DVec3) -> DVec3) -> Self {
        for v in &mut self.vertices {
            *v = map(*v);
        }
        self
    }

    /// Returns the mesh translated by a vector.
    #[must_use]
    pub fn translated(self, by: DVec3) -> Self {
        self.mapped(|v| v + by)
    }

    /// Returns the union of the vertices and faces of two meshes.
    #[must_use]
    pub fn joined(mut self, other: &Self) -> Self {
        let base = self.vertices.len() as u32;
        self.vertices.extend_from_slice(&other.vertices);
        self.faces.extend(other.faces.iter().map(|f| f.iter().map(|v| v + base).collect()));
        self
    }

    /// Returns the mesh with its orientation reversed.
    #[must_use]
    pub fn reversed(mut self) -> Self {
        self.faces.iter_mut().for_each(|f| f.reverse());
        self
    }

    /// Returns the mesh with each face triangulated from its first corner.
    #[must_use]
    pub fn triangulated(mut self) -> Self {
        self.faces = self.triangles().map(Vec::from).collect();
        self
    }

    /// Returns the same surface, with each triangle cut into four at the midpoints of its edges.
    #[must_use]
    pub fn quartered(&self) -> Self {
        let mut made = Self::of_points(self.vertices.clone());
        let mut known: HashMap<[u32; 2], u32> = HashMap::new();
        for [a, b, c] in self.triangles() {
            let [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(|[from, to]| {
                *known.entry([from.min(to), from.max(to)]).or_insert_with(|| {
                    let ends = [from, to].map(|v| self.vertices[v as usize]);
                    made.vertices.push(ends[0].midpoint(ends[1]));
                    made.vertices.len() as u32 - 1
                })
            });
            made.faces.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]].map(Vec::from));
        }
        made
    }

    /// Returns the triangles into which the faces are cut from their first corners.
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        self.faces.iter().flat_map(|f| f[1..].windows(2).map(|pair| [f[0], pair[0], pair[1]]))
    }
}

/// Returns the largest distance of points from the origin.
pub fn reach(points: &[DVec3]) -> f64 {
    points.iter().map(|v| v.length()).fold(0.0, f64::max)
}

/// Returns points given by the bits of their coordinates, for exact reproduction of cases.
pub fn of_bits(bits: &[[u64; 3]]) -> Vec<DVec3> {
    bits.iter().map(|point| DVec3::from_array(point.map(f64::from_bits))).collect()
}

/// Builds a unit sphere in rings. Its inner faces are trapezoids.
pub fn ring_sphere(around: u32, rings: u32) -> Mesh {
    let vertices = ring_points(around, rings, 0.0);
    let at = |ring: u32, k: u32| 1 + ring * around + k % around;
    let south = rings * around + 1;
    let mut faces = Vec::new();
    for k in 0..around {
        faces.push(vec![0, at(0, k), at(0, k + 1)]);
        for ring in 1..rings {
            faces.push(vec![at(ring - 1, k), at(ring, k), at(ring, k + 1), at(ring - 1, k + 1)]);
        }
        faces.push(vec![at(rings - 1, k), south, at(rings - 1, k + 1)]);
    }
    Mesh { vertices, faces }
}

/// Returns the poles and rings of a unit sphere. Odd rings are rotated by `twist` steps.
pub fn ring_points(around: u32, rings: u32, twist: f64) -> Vec<DVec3> {
    let mut vertices = vec![DVec3::Z];
    for ring in 1..=rings {
        let polar_rad = PI * f64::from(ring) / f64::from(rings + 1);
        for k in 0..around {
            let angle_rad = TAU * (f64::from(k) + twist * f64::from(ring % 2)) / f64::from(around);
            vertices.push(DVec3::new(
                polar_rad.sin() * angle_rad.cos(),
                polar_rad.sin() * angle_rad.sin(),
                polar_rad.cos(),
            ));
        }
    }
    vertices.push(DVec3::NEG_Z);
    vertices
}

/// Returns the numbers of vertices around and of rings of a ring body with about `n` vertices. Both numbers are
/// about equal.
pub fn even_rings(n: usize) -> [u32; 2] {
    let inner = n.saturating_sub(2) as f64;
    let around = inner.sqrt().round().max(3.0);
    [around as u32, (inner / around).round().max(1.0) as u32]
}

/// Returns about `n` vertices in rings on `|x|^e + |y|^e + |z|^e = 1`, which is round for 2 and box-like for
/// larger exponents.
///
/// The rings have no faces, because those would not be flat. The mesh represents the hull.
pub fn superellipsoid(n: usize, exponent: f64) -> Mesh {
    let [around, rings] = even_rings(n);
    let onto = |v: DVec3| {
        let sum: f64 = v.abs().to_array().into_iter().map(|c| c.powf(exponent)).sum();
        v * sum.powf(-exponent.recip())
    };
    // The twist of the rings prevents rings in symmetry planes.
    Mesh::of_points(ring_points(around, rings, 0.3).into_iter().map(onto).collect())
}

/// Returns the upper half of a ring sphere of about `2 n` vertices, with a flat base, as points.
pub fn half_sphere(n: usize) -> Mesh {
    let [around, rings] = even_rings(2 * n);
    let rings = (rings - 1) | 1;
    let upper =
        ring_points(around, rings, 0.0).into_iter().take(1 + (around * (rings / 2 + 1)) as usize);
    Mesh::of_points(upper.map(|v| if v.z.abs() < 1e-9 { v.with_z(0.0) } else { v }).collect())
}

/// Returns the corners of a regular polygon about `z`. The first one has y = 0.
pub fn ring(sides: usize, radius: f64, z: f64) -> impl Iterator<Item = DVec3> + Clone {
    (0..sides).map(move |k| {
        let (sine, cosine) = (TAU * k as f64 / sides as f64).sin_cos();
        DVec3::new(radius * cosine, radius * sine, z)
    })
}

/// Returns the corners of regular polygons about `z`, each with a radius and a height, and tips on the axis.
/// The mesh represents the hull.
pub fn revolved(rings: &[[f64; 2]], tips: &[f64], sides: usize) -> Mesh {
    let corners = rings.iter().flat_map(|&[radius, z]| ring(sides, radius, z));
    Mesh::of_points(corners.chain(tips.iter().map(|&z| DVec3::Z * z)).collect())
}

/// Builds a prism over a regular polygon with `sides` corners of radius 1, from `z = -half_height` to
/// `half_height`. The first corner is on the x axis, and the bottom ring comes first.
pub fn prism(sides: usize, half_height: f64) -> Mesh {
    let outline: Vec<DVec3> = ring(sides, 1.0, 0.0).collect();
    extruded(&outline, [-half_height, half_height])
}

/// Builds the prism over a polygon between two heights. The polygon is counter-clockwise seen from above. Its
/// corners at the lower height come first.
pub fn extruded(outline: &[DVec3], heights: [f64; 2]) -> Mesh {
    let n = outline.len() as u32;
    let mut faces: Vec<Vec<u32>> = vec![(0..n).rev().collect(), (n..2 * n).collect()];
    faces.extend((0..n).map(|k| vec![k, (k + 1) % n, n + (k + 1) % n, n + k]));
    let vertices = heights.into_iter().flat_map(|z| outline.iter().map(move |p| p.with_z(z)));
    Mesh { vertices: vertices.collect(), faces }
}

/// Builds a cone over a regular polygon of radius 1, from its base to its apex, which is the last vertex.
pub fn cone(sides: usize, [base, apex]: [f64; 2]) -> Mesh {
    let n = sides as u32;
    let mut faces: Vec<Vec<u32>> = vec![(0..n).rev().collect()];
    faces.extend((0..n).map(|k| vec![k, (k + 1) % n, n]));
    Mesh { vertices: ring(sides, 1.0, base).chain([DVec3::Z * apex]).collect(), faces }
}

/// Builds the box from `-half` to `half`.
pub fn cuboid(half: DVec3) -> Mesh {
    block(-half, half)
}

/// Builds the box from one corner to the opposite one. Bit `k` of a vertex index is 1 if the vertex is high
/// along axis `k`. The faces point down and up `z`, `y` and `x`.
pub fn block(low: impl Into<DVec3>, high: impl Into<DVec3>) -> Mesh {
    let ends = [low.into(), high.into()];
    let corner = |i: usize| DVec3::new(ends[i & 1].x, ends[i >> 1 & 1].y, ends[i >> 2].z);
    let faces =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Mesh { vertices: (0..8).map(corner).collect(), faces: faces.map(Vec::from).to_vec() }
}

/// Returns the points of a grid with `counts` points along the axes. The first is at the origin.
pub fn grid(counts: [usize; 3], spacing: DVec3) -> Vec<DVec3> {
    let mut points = Vec::new();
    for i in 0..counts[0] {
        for j in 0..counts[1] {
            points
                .extend((0..counts[2]).map(|k| DVec3::new(i as f64, j as f64, k as f64) * spacing));
        }
    }
    points
}

/// Returns `n` random points on the unit sphere. Their hull has only triangles.
pub fn random_hull(n: usize, random: &mut Random) -> Mesh {
    Mesh::of_points((0..n).map(|_| random.direction()).collect())
}

/// Builds a screw, or a nut if `inner` is a radius beyond the thread. The function `outer` is the radius for
/// the phase `z / pitch - turn` from 0 to 1. The mesh is a tube of rings from `z = 0`, closed at its ends. Its
/// facets follow the helix.
pub fn helical(inner: Option<f64>, outer: impl Fn(f64) -> f64, pitch: f64, turns: usize) -> Mesh {
    const SIDES: usize = 24;
    // A turn has as many rows as sides, so that edges follow the crest.
    const ROWS: usize = SIDES;
    let (rows, length) = (turns * ROWS, pitch.abs() * turns as f64);
    let mut vertices = Vec::new();
    for row in 0..=rows {
        for side in 0..SIDES {
            let (turn, z) = (side as f64 / SIDES as f64, length * row as f64 / rows as f64);
            let phase = (z / pitch - turn).rem_euclid(1.0);
            let r = outer(phase);
            let angle = TAU * turn;
            vertices.push(DVec3::new(r * angle.cos(), r * angle.sin(), z));
        }
    }
    let wall = vertices.len();
    for z in [0.0, length] {
        match inner {
            None => vertices.push(DVec3::Z * z),
            Some(r) => vertices.extend((0..SIDES).map(|side| {
                let angle = TAU * side as f64 / SIDES as f64;
                DVec3::new(r * angle.cos(), r * angle.sin(), z)
            })),
        }
    }
    let mut faces: Vec<Vec<u32>> = Vec::new();
    let at = |row: usize, side: usize| (row * SIDES + side % SIDES) as u32;
    let rim = |end: usize, side: usize| {
        (wall + if inner.is_some() { end * SIDES + side % SIDES } else { end }) as u32
    };
    for side in 0..SIDES {
        for row in 0..rows {
            let q = [at(row, side), at(row, side + 1), at(row + 1, side + 1), at(row + 1, side)];
            // The diagonal along the crest.
            let split = if pitch > 0.0 { [0, 1, 2, 0, 2, 3] } else { [0, 1, 3, 1, 2, 3] };
            faces.push(split[..3].iter().map(|&k| q[k]).collect());
            faces.push(split[3..].iter().map(|&k| q[k]).collect());
        }
        let ends = [
            vec![rim(0, side), rim(0, side + 1), at(0, side + 1), at(0, side)],
            vec![rim(1, side), at(rows, side), at(rows, side + 1), rim(1, side + 1)],
        ];
        for mut end in ends {
            end.dedup();
            if end.first() == end.last() {
                end.pop();
            }
            faces.push(end);
        }
        if inner.is_some() {
            faces.push(vec![rim(0, side + 1), rim(0, side), rim(1, side), rim(1, side + 1)]);
        }
    }
    if inner.is_some_and(|r| r > outer(0.0)) {
        for face in &mut faces {
            face.reverse();
        }
    }
    Mesh { vertices, faces }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that each directed edge occurs once, as does its reverse, and that each face is oriented
    /// outwards.
    fn assert_closed_and_outward(mesh: &Mesh) {
        let mut edges = std::collections::BTreeSet::new();
        for face in &mesh.faces {
            for (k, &from) in face.iter().enumerate() {
                assert!(edges.insert((from, face[(k + 1) % face.len()])), "twice: {face:?}");
            }
            let [a, b, c] = [0, 1, 2].map(|k| mesh.vertices[face[k] as usize]);
            assert!((b - a).cross(c - a).dot(a + b + c) > 0.0, "inwards: {face:?}");
        }
        assert!(edges.iter().all(|&(a, b)| edges.contains(&(b, a))));
        assert_eq!(mesh.vertices.len() + mesh.faces.len(), edges.len() / 2 + 2);
    }

    #[test]
    fn meshes_are_closed() {
        for mesh in [
            ring_sphere(5, 3),
            prism(24, 1.0),
            ring_sphere(3, 1),
            prism(3, 0.5),
            cone(7, [-1.0, 1.0]),
        ] {
            assert_closed_and_outward(&mesh);
        }
        let cuboid = cuboid(DVec3::new(1.0, 2.0, 3.0));
        assert_closed_and_outward(&cuboid);
        assert_eq!(cuboid.clone().triangulated().faces.len(), 12);
        assert_closed_and_outward(&cuboid.triangulated());
    }

    #[test]
    fn ring_bodies_have_about_the_vertices_asked_for() {
        for (n, expected) in [(8, 8), (32, 32), (128, 123), (512, 508), (2_000, 1_982)] {
            let [around, rings] = even_rings(n);
            assert_eq!(ring_sphere(around, rings).vertices.len(), expected);
            assert_eq!(superellipsoid(n, 4.0).vertices.len(), expected);
            let half = half_sphere(n).vertices.len();
            assert!(half.abs_diff(n) <= 2 + n / 4, "{n}: {half}");
        }
    }

    #[test]
    fn shapes_lie_where_they_should() {
        for v in superellipsoid(500, 4.0).vertices {
            let sum: f64 = v.to_array().into_iter().map(|c| c.powi(4)).sum();
            assert!((sum - 1.0).abs() < 1e-12);
        }
        let half = half_sphere(500);
        let base = half.vertices.iter().filter(|v| v.z == 0.0).count();
        assert!(base >= 20 && half.vertices.iter().all(|v| v.z >= 0.0), "{base}");
    }
}
