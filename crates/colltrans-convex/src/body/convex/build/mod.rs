//! Construction of bodies from points, from meshes and from corners of a box.

mod hull;
mod mesh;
mod offset;

use std::sync::OnceLock;

use glam::DVec3;

use super::ConvexPolyhedron;
use super::support::SupportIndex;
use crate::body::error::BuildError;
use crate::body::{Aabb, Inertia, InputVertex};
#[cfg(any(test, feature = "json"))]
use colltrans_kernel::topology::Topology;
use hull::IndexedHull;
pub use mesh::{ConvexityDefect, convexity_defect};
pub use offset::OffsetReport;

impl ConvexPolyhedron {
    /// Builds the convex hull of `points` (body frame, any unit).
    ///
    /// Coplanar triangles are merged into polygons. Points within rounding error of a face or an edge are not
    /// vertices. [`Self::hull_error`] bounds the distance of an input point from the body. It takes `O(n log n)`
    /// time for points in general position.
    ///
    /// # Errors
    /// An empty list of points, more points than the limit, a point that is not finite, a coordinate outside the
    /// exact range.
    ///
    /// ```
    /// use colltrans::ConvexPolyhedron;
    /// use colltrans::glam::DVec3;
    ///
    /// // A grid of 3 x 3 x 3 points: a cube of 8 vertices and 6 faces.
    /// let grid: Vec<DVec3> = (0..27)
    ///     .map(|i| DVec3::new((i % 3) as f64, (i / 3 % 3) as f64, (i / 9) as f64))
    ///     .collect();
    /// let cube = ConvexPolyhedron::from_points(&grid)?;
    /// assert_eq!((cube.vertices().len(), cube.edge_count(), cube.face_count()), (8, 12, 6));
    /// assert_eq!(cube.volume(), 8.0);
    ///
    /// assert!(ConvexPolyhedron::from_points(&[DVec3::NAN]).is_err());
    /// # Ok::<(), colltrans::BuildError>(())
    /// ```
    pub fn from_points(points: &[DVec3]) -> Result<Self, BuildError> {
        hull::check_points(points)?;
        Ok(Self::from_hull(points, hull::convex_hull(points)))
    }

    /// Builds the [hull](Self::from_points) of points that are a selection of an input, each with its number there.
    ///
    /// Features of answers and `input_indices` name the points by these numbers.
    ///
    /// # Errors
    /// The errors of [`Self::from_points`], which also name a point by its number.
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::{ConvexPolyhedron, InputVertex};
    ///
    /// let input = [DVec3::splat(1e6), DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// let numbered = (1..5).map(|k| (InputVertex(k), input[k as usize]));
    /// let tetrahedron = ConvexPolyhedron::from_numbered_points(numbered)?;
    /// assert_eq!(tetrahedron.input_indices(), [1, 2, 3, 4].map(InputVertex));
    /// # Ok::<(), colltrans::BuildError>(())
    /// ```
    pub fn from_numbered_points(
        points: impl IntoIterator<Item = (InputVertex, DVec3)>,
    ) -> Result<Self, BuildError> {
        let (numbers, points): (Vec<InputVertex>, Vec<DVec3>) = points.into_iter().unzip();
        let number = |index: usize| numbers[index].index();
        let body = Self::from_points(&points).map_err(|error| match error {
            BuildError::NotFinite { index, point } => {
                BuildError::NotFinite { index: number(index), point }
            }
            BuildError::OutOfRange { index, point } => {
                BuildError::OutOfRange { index: number(index), point }
            }
            other => other,
        });
        let mut body = body?;
        for v in &mut body.input_index {
            *v = numbers[v.index()];
        }
        Ok(body)
    }

    /// Builds the box between two opposite corners, with 8 vertices and 6 faces. It is flat if the corners have a
    /// coordinate in common. The order of the corners is irrelevant.
    ///
    /// # Errors
    /// A corner that is not finite or out of range.
    ///
    /// ```
    /// use colltrans::ConvexPolyhedron;
    /// use colltrans::glam::DVec3;
    ///
    /// let plate = ConvexPolyhedron::cuboid(DVec3::new(-2.0, -2.0, -1.0), DVec3::new(2.0, 2.0, 0.0))?;
    /// assert_eq!((plate.vertices().len(), plate.face_count()), (8, 6));
    /// assert_eq!(plate.volume(), 16.0);
    /// # Ok::<(), colltrans::BuildError>(())
    /// ```
    pub fn cuboid(min: DVec3, max: DVec3) -> Result<Self, BuildError> {
        let of = |high: bool, axis: usize| if high { max[axis] } else { min[axis] };
        let corner = |i: usize| DVec3::new(of(i & 1 > 0, 0), of(i & 2 > 0, 1), of(i & 4 > 0, 2));
        Self::from_points(&std::array::from_fn::<DVec3, 8, _>(corner))
    }

    /// Builds a body from a closed convex surface: vertices (body frame, any unit) and polygonal faces as lists of
    /// vertex indices, counter-clockwise as seen from outside.
    ///
    /// The surface must be closed, consistently oriented and a single sphere. It must lie at most `tolerance` (a
    /// length) below its convex hull; rounding error is always tolerated. The body is this hull. Vertices that no
    /// face uses are ignored.
    ///
    /// # Errors
    /// Invalid points, topology or orientation; a surface that is not convex (with the worst face and its depth); a
    /// tolerance that is negative or not a number.
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::{BuildError, ConvexPolyhedron, TopologyError};
    ///
    /// let vertices = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    /// let tetrahedron = ConvexPolyhedron::from_mesh(&vertices, &faces, 0.0)?;
    /// assert_eq!(tetrahedron.face_count(), 4);
    ///
    /// let open = ConvexPolyhedron::from_mesh(&vertices, &faces[..3], 0.0);
    /// let Err(BuildError::Topology(TopologyError::OpenEdge { .. })) = open else {
    ///     unreachable!("a face is missing")
    /// };
    /// # Ok::<(), BuildError>(())
    /// ```
    pub fn from_mesh<F: AsRef<[u32]>>(
        vertices: &[DVec3],
        faces: &[F],
        tolerance: f64,
    ) -> Result<Self, BuildError> {
        mesh::from_mesh(vertices, faces, tolerance)
    }

    /// Rebuilds a body from its stored data: its vertices, its faces in their order, its input indices, its hull
    /// error and its input excess. It checks that the faces are convex.
    ///
    /// # Errors
    /// The errors of [`Self::from_mesh`]. [`BuildError::NotABody`] if the counts or the stored errors are
    /// inconsistent, or if the hull of the vertices lacks some of them.
    #[cfg(feature = "json")]
    pub(crate) fn from_own_faces(
        vertices: &[DVec3],
        faces: &[Vec<u32>],
        input_indices: &[InputVertex],
        [hull_error, input_excess]: [f64; 2],
    ) -> Result<Self, BuildError> {
        hull::check_points(vertices)?;
        let sound_error = (0.0..=crate::MAX_MAGNITUDE).contains(&hull_error)
            && (0.0..=hull_error).contains(&input_excess);
        let vertex_count = vertices.len();
        let dimension = match faces.len() {
            0 => vertex_count.min(2) as u8 - 1,
            2 => 2,
            _ => 3,
        };
        let is_own = |hull: &IndexedHull| hull.vertices.len() == vertex_count;
        let like = hull::convex_hull(vertices);
        // A body hardly thicker than the tolerance may be flat without the points that it left out. It may also have
        // all corners of the exact hull.
        let same = is_own(&like)
            || like.dimension < dimension && hull::are_distinct(vertices)
            || is_own(&hull::exact_hull(vertices));
        let flat = if faces.is_empty() { vertex_count <= 2 } else { vertex_count >= 3 };
        if !(same && flat && sound_error && input_indices.len() == vertex_count) {
            return Err(BuildError::NotABody { vertices: vertex_count, faces: faces.len() });
        }
        let topology = if faces.is_empty() {
            Topology::without_faces(vertex_count)
        } else {
            mesh::own_faces(vertices, faces)?
        };
        let in_order = (0..vertex_count as u32).collect();
        let hull = IndexedHull {
            dimension,
            vertices: in_order,
            topology,
            violation: hull_error,
            input_excess,
        };
        let mut body = Self::from_hull(vertices, hull);
        body.input_index = input_indices.to_vec();
        Ok(body)
    }

    /// Builds a body and its indices from a hull of `points`.
    fn from_hull(points: &[DVec3], hull: IndexedHull) -> Self {
        let IndexedHull { dimension, vertices: input, topology, violation, input_excess } = hull;
        let vertices: Vec<DVec3> = input.iter().map(|&i| points[i as usize]).collect();
        let inertia = Inertia::new(&vertices, &topology, dimension);
        let support = SupportIndex::build(&vertices, &topology, &inertia);
        let mut body = Self {
            is_upright_box: are_corners_of_box(&vertices),
            vertices,
            input_index: input.into_iter().map(InputVertex).collect(),
            dimension,
            hull_error: violation,
            input_excess,
            dent: 0.0,
            flatness: 0.0,
            radius: 0.0,
            large_faces: Vec::new(),
            topology,
            inertia,
            support,
            sections: OnceLock::new(),
            kept: crate::body::DerivedDataSlot::default(),
        };
        body.measure_faces();
        // Queries use the links to walk around faces of small bodies and along rims of large faces. Other bodies
        // drop them.
        if body.vertices.len() > hull::MAX_INPUT_ORDER && body.large_faces.is_empty() {
            body.topology.drop_links();
        }
        body
    }

    /// Builds a body of dimension 3 from faces that the caller guarantees to be convex.
    #[cfg(test)]
    pub(crate) fn from_convex_faces(vertices: &[DVec3], faces: &[Vec<u32>]) -> Self {
        let mut face_start = vec![0];
        let mut face_vertices = Vec::new();
        for face in faces {
            face_vertices.extend_from_slice(face);
            face_start.push(face_vertices.len() as u32);
        }
        let topology =
            Topology::from_sphere_faces(vertices.len(), face_start, face_vertices).unwrap();
        let vertices_in_order = (0..vertices.len() as u32).collect();
        let hull = IndexedHull {
            dimension: 3,
            vertices: vertices_in_order,
            topology,
            violation: 0.0,
            input_excess: 0.0,
        };
        Self::from_hull(vertices, hull)
    }
}

/// Checks whether distinct points are the corners of a box with sides along the axes, exactly.
fn are_corners_of_box(points: &[DVec3]) -> bool {
    if points.len() != 8 {
        return false;
    }
    let Aabb { low, high } = Aabb::from_points(points.iter().copied());
    low.cmplt(high).all() && points.iter().all(|v| (v.cmpeq(low) | v.cmpeq(high)).all())
}
