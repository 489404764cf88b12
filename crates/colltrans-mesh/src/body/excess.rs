//! By how much a convex hull exceeds the part that it was taken of.
//!
//! Depth of a point of the part: its distance from the nearest face plane of the hull, which is
//! its distance from the hull's surface. It is looked at where the library looks when it judges
//! convexity, at the corners, the middles of the edges and the centres of all faces: for curved
//! surfaces that is all there is, in a large flat face some other point may lie a little deeper.

use colltrans::ConvexPolyhedron;
use glam::DVec3;

use crate::Mesh;

/// Whether depths are looked at; volumes are in any case.
const DEEP: bool = cfg!(feature = "depth");

/// Planes and nodes that are looked at before the search for the deepest point is given up: some seconds.
const MOST_LOOKS: u64 = 1_000_000_000;

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
    let mut looks = 0;
    depth_counted(mesh, hull, &mut looks)
}

/// [`depth`], and how many planes and nodes were looked at.
fn depth_counted(mesh: &Mesh, hull: &ConvexPolyhedron, looks: &mut u64) -> Option<f64> {
    if hull.dimension() < 3 {
        return Some(0.0);
    }
    let planes = Planes::of(hull);
    // Less than this is rounding.
    let noise = 1e-13 * mesh.extent();
    let mut deepest = noise;
    // Points in the order of the mesh are near each other, and mostly below the same face.
    let mut near = 0;
    for p in mesh.faces.iter().flat_map(|face| samples(mesh, face)) {
        deepest = deepest.max(planes.least_depth(p, deepest, &mut near, looks));
        if *looks > MOST_LOOKS {
            return None;
        }
    }
    Some(if deepest == noise { 0.0 } else { deepest })
}

/// Planes of a leaf.
const LEAF: usize = 8;

/// The face planes of a hull in a tree of boxes of their normals and offsets, as the depth of a point below the
/// nearest of them is the least value of a function that is linear in both.
struct Planes {
    /// A point inside.
    centre: DVec3,
    /// Unit normal and distance from the centre of each face's plane, leaf by leaf.
    faces: Vec<(DVec3, f64)>,
    /// Each node before its children, the first child right behind it.
    nodes: Vec<Node>,
}

/// Planes that follow each other, and bounds of their numbers.
struct Node {
    low: DVec3,
    high: DVec3,
    least_offset: f64,
    range: std::ops::Range<usize>,
    /// The second child; none for a leaf.
    second: Option<usize>,
}

impl Planes {
    fn of(hull: &ConvexPolyhedron) -> Self {
        let vertices = hull.vertices();
        let centre = vertices.iter().sum::<DVec3>() / vertices.len() as f64;
        let plane = |face: u32| {
            let normal = hull.face_normal(face);
            let corners = hull.face_vertices(face).map(|v| vertices[v as usize]);
            let heights = corners.map(|corner| normal.dot(corner - centre));
            (normal, heights.fold(f64::NEG_INFINITY, f64::max))
        };
        let faces = (0..hull.face_count() as u32).map(plane).collect();
        let mut tree = Self { centre, faces, nodes: Vec::new() };
        tree.build(0..tree.faces.len());
        tree
    }

    fn build(&mut self, range: std::ops::Range<usize>) {
        let part = &mut self.faces[range.clone()];
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let mut least_offset = f64::INFINITY;
        for (normal, offset) in part.iter() {
            (low, high) = (low.min(*normal), high.max(*normal));
            least_offset = least_offset.min(*offset);
        }
        let number = self.nodes.len();
        self.nodes.push(Node { low, high, least_offset, range: range.clone(), second: None });
        if range.len() <= LEAF {
            return;
        }
        let axis = (high - low).max_position();
        let half = range.len() / 2;
        part.select_nth_unstable_by(half, |a, b| a.0[axis].total_cmp(&b.0[axis]));
        let middle = range.start + half;
        self.build(range.start..middle);
        self.nodes[number].second = Some(self.nodes.len());
        self.build(middle..range.end);
    }

    /// How far a point is below the plane that it is nearest to, or some plane that it is not deeper below than
    /// `enough`. `near` is the plane to begin with, and the one that was found.
    fn least_depth(&self, p: DVec3, enough: f64, near: &mut usize, looks: &mut u64) -> f64 {
        let ray = p - self.centre;
        let below = |plane: usize| self.faces[plane].1 - self.faces[plane].0.dot(ray);
        // What rounding can make of a bound.
        let slack = 1e-14 * ray.abs().element_sum();
        let bound = |node: &Node| {
            let most = (node.low * ray).max(node.high * ray).element_sum();
            node.least_offset - most - 1e-14 * node.least_offset.abs() - slack
        };
        let mut least = below(*near);
        let mut stack = vec![0];
        *looks += 1;
        while let Some(number) = stack.pop().filter(|_| least > enough) {
            let node = &self.nodes[number];
            *looks += 1;
            if bound(node) >= least {
                continue;
            }
            let Some(second) = node.second else {
                for plane in node.range.clone() {
                    *looks += 1;
                    let depth = below(plane);
                    if depth < least {
                        (least, *near) = (depth, plane);
                    }
                }
                continue;
            };
            let children = [number + 1, second];
            let [first, last] = children.map(|child| bound(&self.nodes[child]));
            stack.extend(if first < last { [second, number + 1] } else { children });
        }
        least
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

    /// The prism over a regular polygon, which is its own hull, and a ring of teeth within such a polygon.
    fn wheel(corners: u32, teeth: f64) -> Mesh {
        let outline = |z: f64| {
            (0..corners).map(move |k| {
                let angle = f64::from(k) / f64::from(corners) * std::f64::consts::TAU;
                let radius = if k % 2 == 0 { 1.0 } else { 1.0 - teeth };
                DVec3::new(radius * angle.cos(), radius * angle.sin(), z)
            })
        };
        let n = corners;
        let mut faces = vec![(0..n).rev().collect(), (n..2 * n).collect()];
        faces.extend((0..n).map(|i| vec![i, (i + 1) % n, (i + 1) % n + n, i + n]));
        Mesh::new(outline(0.0).chain(outline(1.0)).collect(), faces)
    }

    /// Faces with many corners have as many neighbours, and none of their points looks at all of them.
    #[test]
    fn planes_looked_at_grow_little_faster_than_the_mesh() {
        for teeth in [0.0, 1e-3, 0.1] {
            let looks = [1_000, 8_000].map(|corners| {
                let mesh = wheel(corners, teeth);
                let hull = ConvexPolyhedron::from_points(&mesh.vertices).unwrap();
                let mut looks = 0;
                let deep = depth_counted(&mesh, &hull, &mut looks).unwrap();
                assert!((deep > 0.0) == (teeth > 0.0), "{teeth}: {deep}");
                looks
            });
            // Eight times the corners: 64 times the looks would be quadratic.
            assert!(looks[1] < 24 * looks[0] && looks[0] < 500_000, "{teeth}: {looks:?}");
        }
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
