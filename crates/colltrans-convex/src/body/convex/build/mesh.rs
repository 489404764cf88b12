//! Bodies from closed, oriented, convex meshes that form a single sphere.
//!
//! Convexity is measured by the *defect*: the depth of the surface below its convex hull. A face whose vertices lie
//! on one face of the hull has a defect of 0. In contrast to a test by the face's own plane, the depth does not
//! depend on normals of slivers, which rounding makes arbitrary.

use std::cell::OnceCell;

use glam::DVec3;

use super::hull::{self, IndexedHull, Locator};
use crate::body::error::{BuildError, TopologyError};
use crate::body::{ConvexPolyhedron, Inertia, InputVertex};
use colltrans_kernel::plane::polygon_normal;
use colltrans_kernel::plane_tree::PlaneTree;
use colltrans_kernel::topology::Topology;

/// Deviation of a mesh from convexity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConvexityDefect {
    /// Index of the face that lies deepest below the convex hull.
    pub face: usize,
    /// Depth of this face, in the unit of the mesh; 0 if every face lies on the hull.
    pub depth: f64,
}

/// Computes the depth of a closed mesh's surface below its convex hull.
///
/// Vertices are in any frame and unit, faces as in [`ConvexPolyhedron::from_mesh`]. That function rejects a mesh
/// whose depth exceeds its tolerance.
///
/// # Errors
/// Invalid points, topology or orientation.
///
/// ```
/// use colltrans::convexity_defect;
/// use colltrans::glam::DVec3;
///
/// // An octahedron whose top is pushed in: its apex lies below the square of the other four.
/// let rim = [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y];
/// let vertices = [rim[0], rim[1], rim[2], rim[3], DVec3::Z * -1.0, DVec3::Z * -0.25];
/// let faces: Vec<[u32; 3]> =
///     (0..4).flat_map(|i| [[i, (i + 1) % 4, 5], [(i + 1) % 4, i, 4]]).collect();
/// let defect = convexity_defect(&vertices, &faces)?;
/// assert!((defect.depth - 0.25).abs() < 1e-12);
/// # Ok::<(), colltrans::BuildError>(())
/// ```
pub fn convexity_defect<F: AsRef<[u32]>>(
    vertices: &[DVec3],
    faces: &[F],
) -> Result<ConvexityDefect, BuildError> {
    let surface = Surface::new(vertices, faces)?;
    Ok(surface.convexity_defect(&surface.convex_hull()))
}

/// Builds the hull of a mesh, if the mesh is convex within `tolerance` or rounding error.
///
/// # Errors
/// The errors of [`ConvexPolyhedron::from_mesh`].
pub(super) fn from_mesh<F: AsRef<[u32]>>(
    vertices: &[DVec3],
    faces: &[F],
    tolerance: f64,
) -> Result<ConvexPolyhedron, BuildError> {
    let surface = Surface::new(vertices, faces)?;
    // Checked after the vertices because the caller may compute it from their extent.
    if tolerance.is_nan() || tolerance < 0.0 {
        return Err(BuildError::Tolerance { tolerance });
    }
    let hull = surface.convex_hull();
    let ConvexityDefect { face, depth } = surface.convexity_defect(&hull);
    let rounding = hull::coplanar_tolerance(&surface.points);
    let tolerance = rounding.max(tolerance);
    if depth > tolerance {
        return Err(BuildError::NotConvex { face, depth, tolerance });
    }
    let dent = if depth > rounding { depth } else { 0.0 };
    Ok(ConvexPolyhedron { dent, ..surface.build_body(hull) })
}

/// Builds the topology of a body's own faces, and checks that they are convex.
#[cfg(feature = "json")]
pub(super) fn own_faces(vertices: &[DVec3], faces: &[Vec<u32>]) -> Result<Topology, BuildError> {
    let surface = Surface::new(vertices, faces)?;
    if surface.points.len() < vertices.len() {
        return Err(BuildError::NotABody { vertices: vertices.len(), faces: faces.len() });
    }
    let ConvexityDefect { face, depth } = surface.convexity_defect(&surface.convex_hull());
    // The polygons of the body were merged within the tolerance of a hull of other points.
    let tolerance = 4.0 * hull::coplanar_tolerance(vertices);
    if depth > tolerance {
        return Err(BuildError::NotConvex { face, depth, tolerance });
    }
    Ok(surface.topology)
}

/// A closed, oriented surface over the vertices in use.
struct Surface {
    /// Positions of the vertices in use.
    points: Vec<DVec3>,
    /// Their indices in the mesh.
    index: Vec<u32>,
    topology: Topology,
}

impl Surface {
    /// Builds the surface, and checks points, topology and orientation.
    fn new<F: AsRef<[u32]>>(vertices: &[DVec3], faces: &[F]) -> Result<Self, BuildError> {
        hull::check_points(vertices)?;
        let mut face_start = vec![0];
        let mut corners = Vec::new();
        let mut used = vec![false; vertices.len()];
        for (face, list) in faces.iter().enumerate() {
            for &v in list.as_ref() {
                let vertex = v as usize;
                *used.get_mut(vertex).ok_or(TopologyError::UnknownVertex {
                    face,
                    vertex,
                    vertices: vertices.len(),
                })? = true;
                corners.push(v);
            }
            face_start.push(corners.len() as u32);
        }
        let topology = Topology::from_sphere_faces(vertices.len(), face_start, corners)?;
        let surface = if used.iter().all(|&u| u) {
            Self {
                points: vertices.to_vec(),
                index: (0..vertices.len() as u32).collect(),
                topology,
            }
        } else {
            Self::without_unused_vertices(vertices, &used, &topology)?
        };
        surface.check_orientation()?;
        Ok(surface)
    }

    /// Builds the surface over the vertices in use, without the others.
    fn without_unused_vertices(
        vertices: &[DVec3],
        used: &[bool],
        topology: &Topology,
    ) -> Result<Self, TopologyError> {
        let index: Vec<u32> = (0..vertices.len() as u32).filter(|&v| used[v as usize]).collect();
        let mut position = vec![0; vertices.len()];
        for (k, &v) in index.iter().enumerate() {
            position[v as usize] = k as u32;
        }
        let corners: Vec<u32> = topology.origins().iter().map(|&v| position[v as usize]).collect();
        let face_start =
            (0..topology.face_count() as u32).map(|f| topology.face_half_edges(f).start);
        let face_start = face_start.chain([corners.len() as u32]).collect();
        let topology = Topology::from_sphere_faces(index.len(), face_start, corners)?;
        Ok(Self { points: index.iter().map(|&v| vertices[v as usize]).collect(), index, topology })
    }

    /// Rejects a surface that encloses a negative volume, beyond the rounding error of a flat surface.
    fn check_orientation(&self) -> Result<(), BuildError> {
        let signed_volume = Inertia::signed_volume(&self.points, &self.topology);
        let extent = self.points.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let thickness = hull::coplanar_tolerance(&self.points);
        if signed_volume < -thickness * extent * extent {
            return Err(BuildError::InsideOut { signed_volume });
        }
        Ok(())
    }

    fn convex_hull(&self) -> IndexedHull {
        hull::hull_of_mesh(&self.points, &self.topology)
    }

    /// Builds a body from the hull, with the indices of the mesh.
    fn build_body(&self, hull: IndexedHull) -> ConvexPolyhedron {
        let mut body = ConvexPolyhedron::from_hull(&self.points, hull);
        for v in &mut body.input_index {
            *v = InputVertex(self.index[v.index()]);
        }
        body
    }

    /// Computes the face that lies deepest below the hull.
    fn convexity_defect(&self, hull: &IndexedHull) -> ConvexityDefect {
        let depths = Depths::new(self, hull);
        let mut worst = ConvexityDefect { face: 0, depth: 0.0 };
        let mut near = 0;
        for face in 0..self.topology.face_count() as u32 {
            let depth = depths.face_depth(face, worst.depth, &mut near);
            if depth > worst.depth {
                worst = ConvexityDefect { face: face as usize, depth };
            }
        }
        worst
    }
}

/// Measures depths below the faces of a hull; for a flat hull, behind the edges of its polygon.
struct Depths<'a> {
    surface: &'a Surface,
    hull: &'a IndexedHull,
    /// Planes to measure from. They are built for the first face that is not on the hull, because most meshes have
    /// none.
    planes: OnceCell<PlaneTree>,
    /// For each vertex of the surface its number in the hull; `None` if the hull lacks it.
    in_hull: Vec<Option<u32>>,
}

impl<'a> Depths<'a> {
    fn new(surface: &'a Surface, hull: &'a IndexedHull) -> Self {
        let mut in_hull = vec![None; surface.points.len()];
        for (k, &v) in hull.vertices.iter().enumerate() {
            in_hull[v as usize] = Some(k as u32);
        }
        Self { surface, hull, planes: OnceCell::new(), in_hull }
    }

    /// Returns the planes to measure from, which the first call builds.
    fn hull_planes(&self) -> &PlaneTree {
        self.planes.get_or_init(|| {
            let (hull, points) = (self.hull, &self.surface.points);
            let vertices: Vec<DVec3> = hull.vertices.iter().map(|&v| points[v as usize]).collect();
            let planes = if hull.dimension == 2 {
                edge_planes(&vertices, &hull.topology)
            } else {
                Locator::of_faces(&vertices, &hull.topology).planes_from_origin().collect()
            };
            PlaneTree::new(&vertices, planes)
        })
    }

    /// Returns the largest depth of a face's corners, edge midpoints and centre. If this depth is at most `known`,
    /// any number up to `known` may be returned. It is 0 if the corners lie on one face of the hull.
    ///
    /// A flat surface covers its inside twice; its edges are where it turns back.
    fn face_depth(&self, face: u32, known: f64, near: &mut usize) -> f64 {
        let topology = &self.surface.topology;
        let at = |v: u32| self.surface.points[v as usize];
        let middle = |h: u32| (at(topology.origin(h)) + at(topology.target(h))) * 0.5;
        match self.hull.dimension {
            0 | 1 => 0.0,
            2 => {
                let rim = topology.face_half_edges(face).filter(|&h| self.turns_back(h));
                let points = rim.flat_map(|h| [at(topology.origin(h)), middle(h)]);
                self.max_depth(points, known, near)
            }
            _ if self.lies_on_hull(face) => 0.0,
            _ => {
                let corners = topology.face_vertices(face).map(at);
                let center = corners.clone().sum::<DVec3>() / corners.len() as f64;
                let points =
                    corners.chain(topology.face_half_edges(face).map(middle)).chain([center]);
                self.max_depth(points, known, near)
            }
        }
    }

    /// Returns the largest depth of some points. If this depth is at most `known`, any number up to `known` may be
    /// returned.
    fn max_depth(&self, points: impl Iterator<Item = DVec3>, known: f64, near: &mut usize) -> f64 {
        // The search may stop at a depth that does not change the maximum.
        points.fold(0.0, |worst, p| {
            worst.max(self.hull_planes().least_depth(p, worst.max(known), near, &mut 0))
        })
    }

    /// Checks whether the faces at an edge of a flat surface face opposite sides.
    fn turns_back(&self, h: u32) -> bool {
        let topology = &self.surface.topology;
        let normal = |h: u32| {
            let corners = topology.face_vertices(topology.half_edge(h).face);
            area_vector(corners.map(|v| self.surface.points[v as usize]))
        };
        normal(h).dot(normal(topology.half_edge(h).twin)) < 0.0
    }

    /// Checks whether all corners of a face are vertices of one face of the hull.
    fn lies_on_hull(&self, face: u32) -> bool {
        let topology = &self.hull.topology;
        let corners = self.surface.topology.face_vertices(face);
        let corners = corners.map(|v| self.in_hull[v as usize]);
        if !corners.clone().all(|v| v.is_some()) {
            return false;
        }
        let corners = corners.flatten();
        let Some(fewest) = corners.clone().min_by_key(|&v| topology.outgoing_half_edges(v).len())
        else {
            return false;
        };
        let face_of = |h: &u32| topology.half_edge(*h).face;
        // Search the shorter list: the faces at a vertex (not at an apex) or the vertices of a face (not of a cap).
        let contains = |f: u32, v: u32| {
            if topology.outgoing_half_edges(v).len() <= topology.face_half_edges(f).len() {
                topology.outgoing_half_edges(v).iter().any(|h| face_of(h) == f)
            } else {
                topology.face_vertices(f).any(|w| w == v)
            }
        };
        let faces = topology.outgoing_half_edges(fewest).iter().map(face_of);
        faces.into_iter().any(|f| corners.clone().all(|v| contains(f, v)))
    }
}

/// Returns the half-planes of a flat polygon, as planes through the edges of its front face.
fn edge_planes(vertices: &[DVec3], topology: &Topology) -> Vec<(DVec3, f64)> {
    let corners: Vec<DVec3> = topology.face_vertices(0).map(|v| vertices[v as usize]).collect();
    let up = polygon_normal(corners.iter().copied());
    let next = corners.iter().cycle().skip(1);
    let plane = |(a, b): (&DVec3, &DVec3)| {
        let outward = (*b - *a).cross(up).normalize_or_zero();
        (outward, outward.dot(*a))
    };
    corners.iter().zip(next).map(plane).collect()
}

/// Computes twice the area of a polygon times its unit normal. The polygon need not be convex.
fn area_vector(corners: impl Iterator<Item = DVec3> + Clone) -> DVec3 {
    let Some(first) = corners.clone().next() else { return DVec3::ZERO };
    let rest = corners.map(|c| c - first);
    rest.clone().zip(rest.skip(1)).map(|(a, b)| a.cross(b)).sum()
}
