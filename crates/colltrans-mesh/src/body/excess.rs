//! Measures the difference between a mesh and its convex hull.
//!
//! The depth of a point of the part is its distance from the nearest face plane of the hull, which is its
//! distance from the hull's surface. The depth is sampled where the library judges convexity: at the corners,
//! the edge midpoints and the centres of all faces. Between the samples of a large flat face, a point may be
//! slightly deeper.

use colltrans::ConvexPolyhedron;
use colltrans_kernel::plane_tree::PlaneTree;
use glam::DVec3;

use crate::Mesh;

/// Whether depths are computed. Volumes are always computed.
const COMPUTES_DEPTH: bool = cfg!(feature = "depth");

/// Maximum number of planes and nodes visited in the search for the deepest point, which takes some seconds.
const MAX_VISITS: usize = 1_000_000_000;

/// The difference between a convex hull and its part.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Excess {
    /// The volume of the hull.
    pub hull_volume: f64,
    /// The volume of the part; `None` if its surface is open or oriented inwards.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub part_volume: Option<f64>,
    /// Whether the part's surface is closed.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub is_closed: bool,
    /// The largest depth of the part's surface below the hull's. `None` if the mesh has no faces, the search
    /// exceeds its limit, or the feature `depth` is off.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub depth: Option<f64>,
}

impl Excess {
    /// Measures the difference between a mesh and its convex hull.
    pub fn measure(mesh: &Mesh, hull: &ConvexPolyhedron) -> Self {
        let volume = mesh.signed_volume();
        let is_closed = !mesh.faces.is_empty() && mesh.open_edges().is_empty();
        Self {
            hull_volume: hull.volume(),
            part_volume: (is_closed && volume >= 0.0).then_some(volume),
            is_closed,
            depth: if COMPUTES_DEPTH && !mesh.faces.is_empty() {
                surface_depth(mesh, hull)
            } else {
                None
            },
        }
    }

    /// Checks whether the part equals its hull up to a depth of `tolerance`, a length. The volumes may differ by at
    /// most the tolerance times the surface of a cube with edges of length `extent`. If this holds, the part counts
    /// as convex, and results for the hull hold for the part up to the tolerance. Returns `false` if the part has no
    /// volume, or if the search for the depth exceeded its limit.
    pub fn is_within(&self, tolerance: f64, extent: f64) -> bool {
        // A cube with edges of this extent has six faces.
        let most = 6.0 * tolerance * extent * extent;
        let is_filled = self.part_volume.is_some_and(|volume| self.hull_volume - volume <= most);
        is_filled && self.depth.map_or(!COMPUTES_DEPTH, |depth| depth <= tolerance)
    }
}

/// Returns the depth of the deepest sample of a mesh below a hull; `None` if the search exceeds its limit.
fn surface_depth(mesh: &Mesh, hull: &ConvexPolyhedron) -> Option<f64> {
    let mut visits = 0;
    depth_with_visits(mesh, hull, &mut visits)
}

/// Computes [`surface_depth`], and adds the number of visited planes and nodes to `visits`.
fn depth_with_visits(mesh: &Mesh, hull: &ConvexPolyhedron, visits: &mut usize) -> Option<f64> {
    if hull.dimension() < 3 {
        return Some(0.0);
    }
    let centre = hull.vertices().iter().sum::<DVec3>() / hull.vertices().len() as f64;
    let facets_around_edge: Vec<DVec3> = hull.vertices().iter().map(|v| *v - centre).collect();
    let plane = |face: u32| {
        let normal = hull.face_normal(face);
        let heights = hull.face_vertices(face).map(|v| normal.dot(facets_around_edge[v as usize]));
        (normal, heights.fold(f64::NEG_INFINITY, f64::max))
    };
    let planes =
        PlaneTree::new(&facets_around_edge, (0..hull.face_count() as u32).map(plane).collect());
    // Smaller depths are rounding errors.
    let noise = 1e-13 * mesh.extent();
    let mut deepest = noise;
    // Consecutive points of the mesh are near each other, and mostly below the same face.
    let mut near = 0;
    for p in mesh.faces.iter().flat_map(|face| face_samples(mesh, face)) {
        deepest = deepest.max(planes.least_depth(p - centre, deepest, &mut near, visits));
        if *visits > MAX_VISITS {
            return None;
        }
    }
    Some(if deepest == noise { 0.0 } else { deepest })
}

/// Returns the corners of a face, the midpoints of its edges and its centre.
fn face_samples<'a>(mesh: &'a Mesh, face: &'a [u32]) -> impl Iterator<Item = DVec3> + 'a {
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

    /// A square tube along x: 3 x 3 outside, 1 x 1 inside, length 4.
    fn square_tube() -> Mesh {
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
    fn hull_of_tube_exceeds_its_volume_and_depth() {
        let mut mesh = square_tube();
        if mesh.signed_volume() < 0.0 {
            mesh.faces.iter_mut().for_each(|face| face.reverse());
        }
        let hull = ConvexPolyhedron::from_points(&mesh.vertices).unwrap();
        let excess = Excess::measure(&mesh, &hull);
        assert_eq!((excess.hull_volume, excess.part_volume), (36.0, Some(32.0)));
        assert_eq!(excess.depth, Some(1.0), "the middle of the wall inside");
        assert!(excess.is_within(1.0, 4.0) && !excess.is_within(0.99, 4.0));
        mesh.faces.pop();
        assert_eq!(Excess::measure(&mesh, &hull).part_volume, None, "open");
        mesh.faces.clear();
        assert_eq!(Excess::measure(&mesh, &hull).depth, None, "points have no surface");
    }

    /// A prism over a regular polygon, which is its own hull (`teeth` is 0), or over a ring of teeth within
    /// that polygon.
    fn toothed_wheel(corners: u32, teeth: f64) -> Mesh {
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

    /// Faces with many corners have as many neighbours. The search must not visit all of them for each point.
    #[test]
    fn visits_grow_little_faster_than_the_mesh() {
        for teeth in [0.0, 1e-3, 0.1] {
            let visits = [1_000, 8_000].map(|corners| {
                let mesh = toothed_wheel(corners, teeth);
                let hull = ConvexPolyhedron::from_points(&mesh.vertices).unwrap();
                let mut visits = 0;
                let deep = depth_with_visits(&mesh, &hull, &mut visits).unwrap();
                assert!((deep > 0.0) == (teeth > 0.0), "{teeth}: {deep}");
                visits
            });
            // With eight times the corners, quadratic growth would be a factor of 64.
            assert!(visits[1] < 24 * visits[0] && visits[0] < 500_000, "{teeth}: {visits:?}");
        }
    }

    /// Compares with all planes for all points.
    #[test]
    fn depth_equals_search_over_all_planes() {
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
            let slow = mesh.faces.iter().flat_map(|face| face_samples(&mesh, face)).map(below);
            let slow = slow.fold(0.0, f64::max);
            assert!((surface_depth(&mesh, &hull).unwrap() - slow).abs() < 1e-14);
        }
    }
}
