//! Bodies from meshes: closed, oriented, one sphere, convex.
//!
//! Convexity is judged by the *defect*: how deep the surface lies below its convex hull. A face
//! whose vertices lie on one face of the hull has none. Unlike a face's own plane, depth does not
//! depend on the normals of slivers, which rounding makes arbitrary.

use glam::DVec3;

use super::hull::{self, Hull};
use super::{ConvexPolyhedron, Measure};
use crate::error::{BuildError, TopologyError};
use crate::plane::polygon_normal;
use crate::topology::Topology;

/// How far a mesh is from convex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConvexityDefect {
    /// The face that lies deepest below the convex hull.
    pub face: usize,
    /// How deep, in the units of the mesh; 0 if every face lies on the hull.
    pub depth: f64,
}

/// How deep the surface of a closed mesh lies below its convex hull.
///
/// Vertices in any frame and unit, faces as in [`ConvexPolyhedron::from_mesh`], which refuses a
/// mesh when this depth exceeds its tolerance.
///
/// # Errors
/// What is wrong with the points, the topology or the orientation.
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
    Ok(surface.defect(&surface.hull()))
}

pub(super) fn from_mesh<F: AsRef<[u32]>>(
    vertices: &[DVec3],
    faces: &[F],
    tolerance: f64,
) -> Result<ConvexPolyhedron, BuildError> {
    let surface = Surface::new(vertices, faces)?;
    let hull = surface.hull();
    let ConvexityDefect { face, depth } = surface.defect(&hull);
    // A tolerance that is no number tolerates nothing.
    let tolerance = hull::tolerance(&surface.points).max(tolerance);
    if depth > tolerance {
        return Err(BuildError::NotConvex { face, depth, tolerance });
    }
    Ok(surface.body(hull))
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
        let topology = Topology::from_faces(vertices.len(), face_start, &corners)?;
        let surface = if used.iter().all(|&u| u) {
            Self {
                points: vertices.to_vec(),
                index: (0..vertices.len() as u32).collect(),
                topology,
            }
        } else {
            Self::compact(vertices, &used, &topology)?
        };
        surface.check_orientation()?;
        Ok(surface)
    }

    /// The same surface over the vertices in use alone.
    fn compact(
        vertices: &[DVec3],
        used: &[bool],
        topology: &Topology,
    ) -> Result<Self, TopologyError> {
        let index: Vec<u32> = (0..vertices.len() as u32).filter(|&v| used[v as usize]).collect();
        let mut position = vec![0; vertices.len()];
        for (k, &v) in index.iter().enumerate() {
            position[v as usize] = k as u32;
        }
        let corners: Vec<u32> =
            topology.half_edges().iter().map(|h| position[h.origin as usize]).collect();
        let face_start = (0..topology.face_count() as u32).map(|f| topology.face(f).start);
        let face_start = face_start.chain([corners.len() as u32]).collect();
        let topology = Topology::from_faces(index.len(), face_start, &corners)?;
        Ok(Self { points: index.iter().map(|&v| vertices[v as usize]).collect(), index, topology })
    }

    /// Refuses a surface that encloses a negative volume, beyond what rounding can make of a flat
    /// one.
    fn check_orientation(&self) -> Result<(), BuildError> {
        let signed_volume = Measure::signed_volume(&self.points, &self.topology);
        let extent = self.points.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let thickness = hull::tolerance(&self.points);
        if signed_volume < -thickness * extent * extent {
            return Err(BuildError::InsideOut { signed_volume });
        }
        Ok(())
    }

    fn hull(&self) -> Hull {
        hull::convex_hull(&self.points)
    }

    fn body(&self, mut hull: Hull) -> ConvexPolyhedron {
        let mut body_index = std::mem::take(&mut hull.vertices);
        hull.vertices.clone_from(&body_index);
        for v in &mut body_index {
            *v = self.index[*v as usize];
        }
        let mut body = ConvexPolyhedron::from_hull(&self.points, hull);
        body.input_index = body_index;
        body
    }

    fn defect(&self, hull: &Hull) -> ConvexityDefect {
        let depths = Depths::new(self, hull);
        let mut worst = ConvexityDefect { face: 0, depth: 0.0 };
        for face in 0..self.topology.face_count() as u32 {
            let depth = depths.of_face(face);
            if depth > worst.depth {
                worst = ConvexityDefect { face: face as usize, depth };
            }
        }
        worst
    }
}

/// Depths below the faces of a hull.
struct Depths<'a> {
    surface: &'a Surface,
    hull: &'a Hull,
    /// Unit normal and offset of each face.
    planes: Vec<(DVec3, f64)>,
    /// For each vertex of the surface, its number in the hull, if it is one of its vertices.
    in_hull: Vec<Option<u32>>,
}

impl<'a> Depths<'a> {
    fn new(surface: &'a Surface, hull: &'a Hull) -> Self {
        let mut in_hull = vec![None; surface.points.len()];
        for (k, &v) in hull.vertices.iter().enumerate() {
            in_hull[v as usize] = Some(k as u32);
        }
        let at = |v: u32| surface.points[hull.vertices[v as usize] as usize];
        let plane = |face: u32| {
            let corners = hull.topology.face_vertices(face).map(at);
            let normal = polygon_normal(corners.clone());
            (normal, corners.map(|p| normal.dot(p)).fold(f64::NEG_INFINITY, f64::max))
        };
        let planes = (0..hull.topology.face_count() as u32).map(plane).collect();
        Self { surface, hull, planes, in_hull }
    }

    /// Greatest depth of a face's corners, edge midpoints and centre; 0 if its corners lie on one
    /// face of the hull.
    fn of_face(&self, face: u32) -> f64 {
        if self.hull.dimension < 3 || self.lies_on_hull(face) {
            return 0.0;
        }
        let corners = self.surface.topology.face_vertices(face);
        let corners = corners.map(|v| self.surface.points[v as usize]);
        let next = corners.clone().cycle().skip(1);
        let middles = corners.clone().zip(next).map(|(a, b)| (a + b) * 0.5);
        let center = corners.clone().sum::<DVec3>() / corners.len() as f64;
        corners.chain(middles).chain([center]).map(|p| self.of_point(p)).fold(0.0, f64::max)
    }

    fn of_point(&self, p: DVec3) -> f64 {
        self.planes.iter().map(|(n, o)| o - n.dot(p)).fold(f64::INFINITY, f64::min)
    }

    fn lies_on_hull(&self, face: u32) -> bool {
        let topology = &self.hull.topology;
        let corners = self.surface.topology.face_vertices(face);
        let corners = corners.map(|v| self.in_hull[v as usize]);
        if !corners.clone().all(|v| v.is_some()) {
            return false;
        }
        let corners = corners.flatten();
        let Some(fewest) = corners.clone().min_by_key(|&v| topology.outgoing(v).len()) else {
            return false;
        };
        let face_of = |h: &u32| topology.half_edge(*h).face;
        // Whichever is shorter: the faces at a vertex (not at an apex) or the vertices of a face
        // (not of a cap).
        let contains = |f: u32, v: u32| {
            if topology.outgoing(v).len() <= topology.face(f).len() {
                topology.outgoing(v).iter().any(|h| face_of(h) == f)
            } else {
                topology.face_vertices(f).any(|w| w == v)
            }
        };
        let faces = topology.outgoing(fewest).iter().map(face_of);
        faces.into_iter().any(|f| corners.clone().all(|v| contains(f, v)))
    }
}
