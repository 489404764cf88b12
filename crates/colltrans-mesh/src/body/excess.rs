//! By how much a convex hull exceeds the part that it was taken of.
//!
//! Depth of a point of the part: its distance from the nearest face plane of the hull, which is
//! its distance from the hull's surface. It is looked at where the library looks when it judges
//! convexity, at the corners, the middles of the edges and the centres of all faces: for curved
//! surfaces that is all there is, in a large flat face some other point may lie a little deeper.

use colltrans::ConvexPolyhedron;
use glam::DVec3;

use crate::Mesh;
use crate::edges::sides;

/// Whether depths are looked at; volumes are in any case.
const DEEP: bool = cfg!(feature = "depth");

/// Planes that are compared before the search for the deepest point is given up: some seconds.
const MOST_COMPARISONS: u64 = 4_000_000_000;

/// Faces that were nearest to points before, which are tried first.
const RECENT: usize = 8;

/// What a hull has and its part has not.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Excess {
    /// Volume of the hull.
    pub hull_volume: f64,
    /// Volume of the part; `None` if its surface is open or oriented inwards.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub part_volume: Option<f64>,
    /// Whether the part's surface is closed.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub is_closed: bool,
    /// How deep the part's surface lies below the hull's; `None` without a surface, if there is more of
    /// it than can be looked at, and without the feature `depth`.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub depth: Option<f64>,
}

impl Excess {
    /// By how much the convex hull of a mesh exceeds it.
    pub fn of(mesh: &Mesh, hull: &ConvexPolyhedron) -> Self {
        let volume = mesh.signed_volume();
        let is_closed = !mesh.faces.is_empty() && mesh.open_edges().is_empty();
        Self {
            hull_volume: hull.volume(),
            part_volume: (is_closed && volume >= 0.0).then_some(volume),
            is_closed,
            depth: if DEEP && !mesh.faces.is_empty() { depth(mesh, hull) } else { None },
        }
    }

    /// Whether the part is its hull to within a depth below it, as it would be taken for convex
    /// without asking for the hull: what is said of one holds for the other.
    pub fn is_within(&self, tolerance: f64, extent: f64) -> bool {
        // A box with sides of this extent has six faces.
        let most = 6.0 * tolerance * extent * extent;
        let is_filled = self.part_volume.is_some_and(|volume| self.hull_volume - volume <= most);
        is_filled && self.depth.map_or(!DEEP, |depth| depth <= tolerance)
    }
}

/// Depth of the deepest point of the faces of a mesh below a hull.
fn depth(mesh: &Mesh, hull: &ConvexPolyhedron) -> Option<f64> {
    if hull.dimension() < 3 {
        return Some(0.0);
    }
    let faces = Faces::of(hull);
    // Less than this is rounding.
    let noise = 1e-13 * mesh.extent();
    let mut deepest = noise;
    // Points in the order of the mesh are near each other, and so are the faces they are below.
    let mut passed = 0;
    let mut recent = [0; RECENT];
    let mut comparisons = 0;
    for p in mesh.faces.iter().flat_map(|face| samples(mesh, face)) {
        // Most points are seen to be no deeper by one face or by those around them.
        if recent.iter().any(|&face| faces.below(face, p) <= deepest)
            || faces.bound(p, &mut passed) <= deepest
        {
            continue;
        }
        let mut least = (f64::INFINITY, 0);
        for face in 0..faces.planes.len() {
            let depth = faces.below(face, p);
            if depth < least.0 {
                least = (depth, face);
            }
            comparisons += 1;
            if least.0 <= deepest {
                break;
            }
        }
        deepest = deepest.max(least.0);
        recent.rotate_right(1);
        recent[0] = least.1;
        if comparisons > MOST_COMPARISONS {
            return None;
        }
    }
    Some(if deepest == noise { 0.0 } else { deepest })
}

/// The faces of a hull, to walk along.
struct Faces {
    /// A point inside.
    centre: DVec3,
    /// Unit normal and distance from the centre of each face's plane.
    planes: Vec<(DVec3, f64)>,
    /// For each face where its neighbours begin, and one entry past the end.
    start: Vec<u32>,
    neighbours: Vec<u32>,
}

impl Faces {
    fn of(hull: &ConvexPolyhedron) -> Self {
        let vertices = hull.vertices();
        let centre = vertices.iter().sum::<DVec3>() / vertices.len() as f64;
        let faces = (0..hull.face_count() as u32).map(|face| hull.face_vertices(face).collect());
        let faces: Vec<Vec<u32>> = faces.collect();
        let (mut planes, mut start, mut owner) = (Vec::new(), vec![0], Vec::new());
        for (face, corners) in faces.iter().enumerate() {
            let normal = hull.face_normal(face as u32);
            let heights = corners.iter().map(|v| normal.dot(vertices[*v as usize] - centre));
            planes.push((normal, heights.fold(f64::NEG_INFINITY, f64::max)));
            owner.resize(owner.len() + corners.len(), face as u32);
            start.push(owner.len() as u32);
        }
        let mut neighbours = vec![0; owner.len()];
        for edge in sides(&faces).chunk_by(|(a, _), (b, _)| a == b) {
            if let [(_, x), (_, y)] = *edge {
                let [x, y] = [x, y].map(|side| (side >> 1) as usize);
                (neighbours[x], neighbours[y]) = (owner[y], owner[x]);
            }
        }
        Self { centre, planes, start, neighbours }
    }

    /// How far a point is below a face.
    fn below(&self, face: usize, p: DVec3) -> f64 {
        let (normal, offset) = self.planes[face];
        offset - normal.dot(p - self.centre)
    }

    /// An upper bound of the depth of a point, from the face that the ray from the centre to it
    /// passes, found by a walk from `near`, and from the faces around.
    fn bound(&self, p: DVec3, near: &mut usize) -> f64 {
        let ray = p - self.centre;
        let passing = |face: usize| {
            let (normal, offset) = self.planes[face];
            normal.dot(ray) / offset.max(f64::MIN_POSITIVE)
        };
        let around = |face: usize| {
            let range = self.start[face] as usize..self.start[face + 1] as usize;
            self.neighbours[range].iter().map(|&f| f as usize)
        };
        let mut value = passing(*near);
        // Every step goes up; the bound is for rounding.
        for _ in 0..self.planes.len() {
            let best = around(*near)
                .map(|f| (passing(f), f))
                .fold((value, *near), |a, b| if b.0 > a.0 { b } else { a });
            if best.1 == *near {
                break;
            }
            (value, *near) = best;
        }
        around(*near).map(|f| self.below(f, p)).fold(self.below(*near, p), f64::min)
    }
}

/// The corners of a face, the middles of its edges and its centre.
fn samples<'a>(mesh: &'a Mesh, face: &'a [u32]) -> impl Iterator<Item = DVec3> + 'a {
    let at = |v: &u32| mesh.vertices[*v as usize];
    let centre = face.iter().map(at).sum::<DVec3>() / face.len() as f64;
    let next = face.iter().cycle().skip(1);
    let middles = face.iter().zip(next).map(move |(a, b)| (at(a) + at(b)) * 0.5);
    face.iter().map(at).chain(middles).chain([centre])
}

#[cfg(test)]
mod tests {
    use super::*;
    use colltrans_testkit::random::Random;

    /// A square tube along x: 3 x 3 outside, 1 x 1 inside, 4 long.
    fn tube() -> Mesh {
        let square = |half: f64| [[-half, -half], [half, -half], [half, half], [-half, half]];
        let mut vertices = Vec::new();
        for x in [0.0, 4.0] {
            for half in [1.5, 0.5] {
                vertices.extend(square(half).map(|[y, z]| DVec3::new(x, y, z)));
            }
        }
        let mut faces = Vec::new();
        for i in 0..4 {
            let j = (i + 1) % 4;
            faces.push(vec![i, j, j + 8, i + 8]);
            faces.push(vec![j + 4, i + 4, i + 12, j + 12]);
            faces.push(vec![j, i, i + 4, j + 4]);
            faces.push(vec![i + 8, j + 8, j + 12, i + 12]);
        }
        for face in &mut faces {
            face.reverse();
        }
        Mesh::new(vertices, faces)
    }

    #[test]
    fn a_tube_is_filled() {
        let mut mesh = tube();
        if mesh.signed_volume() < 0.0 {
            mesh.faces.iter_mut().for_each(|face| face.reverse());
        }
        let hull = ConvexPolyhedron::from_points(&mesh.vertices).unwrap();
        let excess = Excess::of(&mesh, &hull);
        assert_eq!((excess.hull_volume, excess.part_volume), (36.0, Some(32.0)));
        assert_eq!(excess.depth, Some(1.0), "the middle of the wall inside");
        assert!(excess.is_within(1.0, 4.0) && !excess.is_within(0.99, 4.0));
        mesh.faces.pop();
        assert_eq!(Excess::of(&mesh, &hull).part_volume, None, "open");
        mesh.faces.clear();
        assert_eq!(Excess::of(&mesh, &hull).depth, None, "points have no surface");
    }

    /// Against all planes for all points.
    #[test]
    fn the_deepest_point_is_the_deepest() {
        let mut random = Random::new(3);
        for _ in 0..20 {
            let vertices: Vec<DVec3> = (0..40).map(|_| random.vector()).collect();
            let faces = (0..38).map(|i| vec![i, i + 1, i + 2]).collect();
            let mesh = Mesh::new(vertices, faces);
            let hull = ConvexPolyhedron::from_points(&mesh.vertices).unwrap();
            let below = |p: DVec3| {
                (0..hull.face_count() as u32)
                    .map(|f| {
                        let corner = hull.face_vertices(f).next().unwrap();
                        hull.face_normal(f).dot(hull.vertices()[corner as usize] - p)
                    })
                    .fold(f64::INFINITY, f64::min)
            };
            let slow = mesh.faces.iter().flat_map(|face| samples(&mesh, face)).map(below);
            let slow = slow.fold(0.0, f64::max);
            assert!((depth(&mesh, &hull).unwrap() - slow).abs() < 1e-14);
        }
    }
}
